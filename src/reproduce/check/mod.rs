//! The check of an experiment: everything invalid in it, with the path of the field and the fix.
//!
//! Scenarios and presets that it names are checked when they are loaded.
//!
//! | file | contents |
//! |---|---|
//! | `arms.rs` | arms, conditions, and the points at which arms are tested |
//! | `sizes.rs` | limits on the size of the file |
//! | `collector.rs` | the diagnostics found |

mod arms;
mod collector;
mod sizes;

use collector::Collector;
pub(super) use sizes::training_runs;

use super::claim::Claim;
use super::experiment::{Arm, Experiment};
use super::figure_spec::FigureKind;
use super::measure::Measure;
use super::table_spec::TableKind;
use super::test_point::{TestPoint, contrast_points};
use crate::limits::experiment::{MAX_ROUNDS, MAX_SEEDS, MAX_SMOOTHING, MAX_TEST_EPISODES, MAX_TRAINING_RUNS};
use crate::limits::{MAX_EVALUATION_EPISODES, MAX_STEPS};
use crate::scenario::{Diagnostic, closest_name, overlap};

/// All diagnostics of `experiment`. The values at the paths `unknown` could not be read. If a list is too long, only sizes are
/// checked.
pub(super) fn diagnostics(experiment: &Experiment, unknown: &[String]) -> Vec<Diagnostic> {
    let names_are_known = !unknown.iter().any(|path| overlap(path, "arms"));
    let mut check = Check { arms: &experiment.arms, names_are_known, found: Collector::default() };
    sizes::check(&mut check.found, experiment);
    if !check.found.is_too_large {
        check.header(experiment);
        check.arms();
        check.conditions(experiment);
        check.figures(experiment);
        check.tables(experiment);
    }
    check.found.diagnostics
}

/// Whether the lists of `experiment` are short enough, and its training runs per seed few enough, to be checked one by one.
pub(super) fn is_small(experiment: &Experiment) -> bool {
    let mut found = Collector::default();
    sizes::check(&mut found, experiment);
    !found.is_too_large && sizes::training_runs_per_seed(experiment) <= MAX_TRAINING_RUNS
}

/// The check of a file within the size limits.
struct Check<'a> {
    arms: &'a [Arm],
    /// Whether the names of arms, and of their scenarios, could be read.
    names_are_known: bool,
    found: Collector,
}

impl Check<'_> {
    fn header(&mut self, experiment: &Experiment) {
        let found = &mut self.found;
        if experiment.title.trim().is_empty() {
            found.add("title", "is empty; help: write what the experiment is about");
        }
        found.range("seeds", experiment.seeds.count(), 1, MAX_SEEDS);
        if let Some(seed) = experiment.seeds.duplicate() {
            found.add("seeds", format!("has {seed} twice; help: give each seed once"));
        }
        found.range("test.rounds", experiment.test.rounds as u64, 1, MAX_ROUNDS as u64);
        found.range("test.episodes", experiment.test.episodes as u64, 1, MAX_TEST_EPISODES);
        if let Some(rule) = &experiment.evaluation {
            found.range("evaluation.every_env_steps", rule.every_env_steps, 1, MAX_STEPS);
            found.range("evaluation.episodes", rule.episodes as u64, 1, MAX_EVALUATION_EPISODES as u64);
        }
        if experiment.figures.is_empty() && experiment.tables.is_empty() {
            found.add("tables", "is empty, and so is figures; help: give at least one figure or table");
        }
    }

    fn figures(&mut self, experiment: &Experiment) {
        for (i, figure) in experiment.figures.iter().enumerate() {
            let at = format!("figures[{i}]");
            self.found.file_name(&format!("{at}.name"), &figure.name);
            match &figure.draw {
                FigureKind::LearningCurves { series, smoothing, .. } => {
                    if series.is_empty() {
                        self.found.add(&format!("{at}.draw.series"), "is empty; help: give [Return]");
                    }
                    self.found.range(&format!("{at}.draw.smoothing"), *smoothing as u64, 1, MAX_SMOOTHING);
                }
                FigureKind::DotPlot { measures, after } => {
                    self.measures(&format!("{at}.draw.measures"), measures);
                    self.after(&format!("{at}.draw.after"), TestPoint::overall(*after), measures, None);
                }
                FigureKind::BenchmarkRoute { after } => {
                    self.after(&format!("{at}.draw.after"), TestPoint::overall(*after), &[], None);
                }
            }
            self.claims(&at, &figure.claims);
        }
    }

    fn tables(&mut self, experiment: &Experiment) {
        for (i, table) in experiment.tables.iter().enumerate() {
            let at = format!("tables[{i}]");
            self.found.file_name(&format!("{at}.name"), &table.name);
            self.table_kind(&format!("{at}.show"), &table.show);
            self.claims(&at, &table.claims);
        }
        let names = experiment.figures.iter().map(|f| f.name.as_str());
        self.found.names("figures", names.chain(experiment.tables.iter().map(|t| t.name.as_str())));
    }

    fn table_kind(&mut self, at: &str, kind: &TableKind) {
        let after_path = format!("{at}.after");
        match kind {
            TableKind::Seeds { measure, after, paper } => {
                self.measures(&format!("{at}.measure"), &[*measure]);
                self.after(&after_path, TestPoint::overall(*after), &[*measure], None);
                paper.iter().for_each(|(name, _)| self.arm(&format!("{at}.paper"), name));
            }
            TableKind::Rounds { after, paper } => {
                self.after(&after_path, TestPoint::overall(*after), &[], None);
                paper.iter().for_each(|(name, _)| self.arm(&format!("{at}.paper"), name));
            }
            TableKind::Measures { measures, after } => {
                self.measures(&format!("{at}.measures"), measures);
                self.after(&after_path, TestPoint::overall(*after), measures, None);
            }
            TableKind::Contrast { measures, better, than, after, of_last_stage } => {
                self.measures(&format!("{at}.measures"), measures);
                self.arm(&format!("{at}.better"), better);
                self.arm(&format!("{at}.than"), than);
                for point in contrast_points(after, *of_last_stage) {
                    self.after(&after_path, point, measures, Some([better.as_str(), than.as_str()]));
                }
            }
        }
    }

    fn claims(&mut self, at: &str, claims: &[Claim]) {
        for (i, claim) in claims.iter().enumerate() {
            let at = format!("{at}.claims[{i}]");
            self.measures(&format!("{at}.measure"), &[claim.measure]);
            self.arm(&format!("{at}.better"), &claim.better);
            self.arm(&format!("{at}.than"), &claim.than);
            let names = Some([claim.better.as_str(), claim.than.as_str()]);
            self.after(&format!("{at}.after"), claim.point(), &[claim.measure], names);
        }
    }

    /// Checks that an arm has this name.
    fn arm(&mut self, path: &str, name: &str) {
        if !self.names_are_known || self.arms.iter().any(|arm| arm.name == name) {
            return;
        }
        let names = || self.arms.iter().map(|arm| arm.name.as_str());
        let help = match closest_name(name, names()) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("the arms are: {}", names().collect::<Vec<_>>().join(", ")),
        };
        self.found.add(path, format!("names \"{name}\", but there is no such arm; help: {help}"));
    }

    fn measures(&mut self, path: &str, measures: &[Measure]) {
        if measures.is_empty() {
            self.found.add(path, "is empty; help: give [Success]");
        }
        for reason in measures.iter().filter_map(|measure| measure.invalid_reason()) {
            self.found.add(path, reason);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::seeds::Seeds;
    use crate::run::preset::{Budget, EvaluationConfig};
    use crate::run::shipped;

    /// The path of the field that must be reported, and a change that makes a valid experiment invalid.
    type Breakage = (&'static str, fn(&mut Experiment));

    #[test]
    fn invalid_values_are_reported_with_their_paths() {
        let text = shipped::experiments().find(|(from, _)| from.ends_with("fig10.ron")).expect("shipped").1;
        let valid = Experiment::parse(text, "fig10.ron").expect("it is valid");
        let breakages: &[Breakage] = &[
            ("title", |e| e.title = "x".repeat(201)),
            ("arms", |e| e.arms = vec![e.arms[0].clone(); 201]),
            ("arms[0].stages", |e| e.arms[0].stages = vec![e.arms[0].stages[0].clone(); 21]),
            ("arms[0].stages[0].scenario", |e| e.arms[0].stages[0].scenario = "x".repeat(4097)),
            ("arms[0].stages[0].budget", |e| {
                e.arms[0].stages[0].budget = Some(Budget::Episodes(u64::MAX));
            }),
            ("figures", |e| e.figures = vec![e.figures[0].clone(); 201]),
            ("tables", |e| e.tables = vec![e.tables[0].clone(); 201]),
            ("tables[0].claims", |e| {
                let claim = Claim {
                    statement: String::new(),
                    measure: Measure::Success,
                    better: "nobody".into(),
                    than: "nobody".into(),
                    after: None,
                    of_last_stage: false,
                };
                e.tables[0].claims = vec![claim; 201];
            }),
            // 1,000 seeds with at least 11 training runs each.
            ("seeds", |e| {
                let stage = e.arms[0].stages[0].clone();
                (e.seeds, e.arms[0].stages) = (Seeds::First(1000), vec![stage; 11]);
            }),
            ("seeds", |e| e.seeds = Seeds::First(u64::MAX)),
            ("seeds", |e| e.seeds = Seeds::List(vec![7, 1, 7])),
            ("seeds", |e| e.seeds = Seeds::List(Vec::new())),
            ("evaluation.every_env_steps", |e| {
                let every = EvaluationConfig { every_env_steps: u64::MAX, ..EvaluationConfig::default() };
                e.evaluation = Some(every);
            }),
            ("arms[0].runs", |e| e.arms[0].runs = vec!["runs/a".into()]),
            ("arms[0].runs", |e| {
                (e.arms[0].stages, e.arms[0].runs) = (Vec::new(), vec!["x".into(); 1001]);
            }),
            ("tables[0].show.paper[0][1]", |e| {
                let paper = vec![("nobody".into(), f64::NAN)];
                e.tables[0].show = TableKind::Seeds { measure: Measure::Success, after: None, paper };
            }),
        ];
        for (path, breakage) in breakages {
            let mut broken = valid.clone();
            breakage(&mut broken);
            let found = diagnostics(&broken, &[]);
            assert!(found.iter().any(|diagnostic| diagnostic.path == *path), "{path}: {found:?}");
            assert!(found.len() < 10, "{path}: too many other diagnostics: {found:?}");
        }
    }

    #[test]
    fn a_condition_may_leave_out_an_arm_with_finished_runs() {
        let text = |only_arms: &str| {
            format!(
                r#"(
                    title: "T",
                    arms: [
                        (name: "a", stages: [(scenario: "empty", preset: "dqn")]),
                        (name: "b", runs: ["runs/b"]),
                    ],
                    conditions: [(name: "c", overrides: {{"learning.gamma": 0.5}}, only_arms: [{only_arms}])],
                    tables: [(name: "t", title: "T", show: Seeds(measure: Success))],
                )"#
            )
        };
        Experiment::parse(&text("\"a\""), "t.ron").expect("only the other arm is changed");
        for only_arms in ["", "\"b\""] {
            let error = Experiment::parse(&text(only_arms), "t.ron").expect_err("the runs are finished");
            assert!(error.to_string().contains("cannot change \"b\"; help: "), "{error}");
        }
    }

    #[test]
    fn only_the_compared_arms_must_be_trained_up_to_the_comparison() {
        let text = |than: &str| {
            let arm = |name: &str, episodes: u64| {
                format!(
                    r#"(name: "{name}", stages: [(scenario: "empty", preset: "dqn", budget: Episodes({episodes}))])"#
                )
            };
            format!(
                r#"(title: "T", arms: [{}, {}, {}], tables: [(
                    name: "t",
                    title: "T",
                    show: Contrast(measures: [Success], better: "a", than: "{than}", after: [Episodes(100)]),
                    claims: [(statement: "S", measure: Success, better: "a", than: "{than}", after: Episodes(100))],
                )])"#,
                arm("a", 100),
                arm("b", 100),
                arm("short", 50),
            )
        };
        Experiment::parse(&text("b"), "t.ron").expect("the third arm may be shorter");
        let error = Experiment::parse(&text("short"), "t.ron").expect_err("it is too short").to_string();
        assert_eq!(error.matches("but arm \"short\" is trained for 50 episodes").count(), 2, "{error}");
    }
}
