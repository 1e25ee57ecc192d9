//! The check of an experiment: everything in it that cannot be meant, with the path of the field and the mend.
//!
//! In: an [`Experiment`] as its file spells it. Out: findings; none for one that can be carried out (its scenarios and
//! presets are looked at when they are loaded).

use std::collections::BTreeSet;

use super::experiment::{Arm, Claim, Experiment, FigureKind, TableKind, TestedPolicy};
use super::measure::Measure;
use crate::run::limits::MAX_STEPS;
use crate::run::preset::Budget;
use crate::scenario::{Diagnostic, closest_name};

/// The most entries that a list of arms, conditions, figures, tables or claims has, or one of numbers or names in them.
const MAX_ENTRIES: usize = 200;
/// The most panels of a figure and columns of a table.
const MAX_SERIES: usize = 10;
const MAX_MEASURES: usize = 20;
/// The most stages of an arm.
const MAX_STAGES: usize = 20;
/// The most trainings of an experiment: a plan of more takes long to make, and for ever to carry out.
const MAX_TRAININGS: u64 = 10_000;
/// The most characters that a name, a heading or a path has, and a text.
const MAX_NAME_CHARS: usize = 200;
const MAX_PATH_CHARS: usize = 4096;
const MAX_TEXT_CHARS: usize = 20_000;
/// The largest number that may be written to be shown.
const MAX_VALUE: f64 = 1e9;

/// Everything in `experiment` that cannot be meant. What it names is looked at only where there is no more of it than
/// there may be.
pub(super) fn diagnostics(experiment: &Experiment) -> Vec<Diagnostic> {
    let mut check = Check { arms: &experiment.arms, diagnostics: Vec::new() };
    check.sizes(experiment);
    if !check.diagnostics.is_empty() {
        return check.diagnostics;
    }
    check.header(experiment);
    check.arms();
    let conditions = experiment.conditions.iter().map(|condition| condition.name.as_str());
    check.names("conditions", conditions);
    for (i, figure) in experiment.figures.iter().enumerate() {
        let at = format!("figures[{i}]");
        check.file_name(&format!("{at}.name"), &figure.name);
        match &figure.draw {
            FigureKind::LearningCurves { series, smoothing, .. } => {
                if series.is_empty() {
                    check.found(&format!("{at}.draw.series"), "names nothing to draw; give [Return]".into());
                }
                check.range(&format!("{at}.draw.smoothing"), *smoothing as u64, 1, 10_000);
            }
            FigureKind::DotPlot { measures, after } => {
                check.measures(&format!("{at}.draw.measures"), measures);
                check.after(&format!("{at}.draw.after"), *after);
            }
            FigureKind::BenchmarkRoute { after } => check.after(&format!("{at}.draw.after"), *after),
        }
        check.claims(&at, &figure.claims);
    }
    for (i, table) in experiment.tables.iter().enumerate() {
        let at = format!("tables[{i}]");
        check.file_name(&format!("{at}.name"), &table.name);
        match &table.show {
            TableKind::Seeds { measure, after, paper } => {
                check.measures(&format!("{at}.show.measure"), &[*measure]);
                check.after(&format!("{at}.show.after"), *after);
                for (name, _) in paper {
                    check.arm(&format!("{at}.show.paper"), name);
                }
            }
            TableKind::Rounds { after, paper } => {
                check.after(&format!("{at}.show.after"), *after);
                for (name, _) in paper {
                    check.arm(&format!("{at}.show.paper"), name);
                }
            }
            TableKind::Measures { measures, after } => {
                check.measures(&format!("{at}.show.measures"), measures);
                check.after(&format!("{at}.show.after"), *after);
            }
            TableKind::Contrast { measures, better, than, after, of_last_stage } => {
                check.measures(&format!("{at}.show.measures"), measures);
                check.arm(&format!("{at}.show.better"), better);
                check.arm(&format!("{at}.show.than"), than);
                if after.is_empty() {
                    check.found(&format!("{at}.show.after"), "names no number of episodes".into());
                }
                for after in after {
                    check.after_of(&format!("{at}.show.after"), *after, *of_last_stage);
                }
            }
        }
        check.claims(&at, &table.claims);
    }
    let items = experiment.figures.iter().map(|f| f.name.as_str());
    check.names("figures", items.chain(experiment.tables.iter().map(|t| t.name.as_str())));
    check.diagnostics
}

/// The sum of counts, if all are known.
fn total(mut counts: impl Iterator<Item = Option<u64>>) -> Option<u64> {
    counts.try_fold(0_u64, |sum, count| Some(sum.saturating_add(count?)))
}

struct Check<'a> {
    arms: &'a [Arm],
    diagnostics: Vec<Diagnostic>,
}

impl Check<'_> {
    /// How many there are of everything, and how long texts are.
    fn sizes(&mut self, experiment: &Experiment) {
        let Experiment { title, about, arms, conditions, figures, tables, .. } = experiment;
        self.text("title", title, MAX_NAME_CHARS);
        self.text("about", about, MAX_TEXT_CHARS);
        self.count("arms", arms.len(), MAX_ENTRIES);
        for (i, arm) in arms.iter().enumerate().take(MAX_ENTRIES) {
            self.text(&format!("arms[{i}].name"), &arm.name, MAX_NAME_CHARS);
            self.count(&format!("arms[{i}].stages"), arm.stages.len(), MAX_STAGES);
            for (k, stage) in arm.stages.iter().enumerate().take(MAX_STAGES) {
                let at = format!("arms[{i}].stages[{k}]");
                self.text(&format!("{at}.scenario"), &stage.scenario, MAX_PATH_CHARS);
                self.text(&format!("{at}.preset"), &stage.preset, MAX_PATH_CHARS);
                let other = stage.overrides.scenario.as_deref().unwrap_or_default();
                self.text(&format!("{at}.overrides.scenario"), other, MAX_PATH_CHARS);
            }
        }
        self.count("conditions", conditions.len(), MAX_ENTRIES);
        for (i, condition) in conditions.iter().enumerate().take(MAX_ENTRIES) {
            self.text(&format!("conditions[{i}].name"), &condition.name, MAX_NAME_CHARS);
            let other = condition.overrides.scenario.as_deref().unwrap_or_default();
            self.text(&format!("conditions[{i}].overrides.scenario"), other, MAX_PATH_CHARS);
        }
        self.count("figures", figures.len(), MAX_ENTRIES);
        for (i, figure) in figures.iter().enumerate().take(MAX_ENTRIES) {
            let at = format!("figures[{i}]");
            self.text(&format!("{at}.title"), &figure.title, MAX_NAME_CHARS);
            self.text(&format!("{at}.caption"), &figure.caption, MAX_TEXT_CHARS);
            self.claim_sizes(&at, &figure.claims);
            match &figure.draw {
                FigureKind::LearningCurves { series, reference_lines, .. } => {
                    self.count(&format!("{at}.draw.series"), series.len(), MAX_SERIES);
                    self.count(&format!("{at}.draw.reference_lines"), reference_lines.len(), MAX_ENTRIES);
                    for (k, level) in reference_lines.iter().enumerate().take(MAX_ENTRIES) {
                        self.number(&format!("{at}.draw.reference_lines[{k}].value"), level.value);
                        self.text(
                            &format!("{at}.draw.reference_lines[{k}].label"),
                            &level.label,
                            MAX_NAME_CHARS,
                        );
                    }
                }
                FigureKind::DotPlot { measures, .. } => {
                    self.count(&format!("{at}.draw.measures"), measures.len(), MAX_MEASURES);
                }
                FigureKind::BenchmarkRoute { .. } => {}
            }
        }
        self.count("tables", tables.len(), MAX_ENTRIES);
        for (i, table) in tables.iter().enumerate().take(MAX_ENTRIES) {
            let at = format!("tables[{i}]");
            self.text(&format!("{at}.title"), &table.title, MAX_NAME_CHARS);
            self.count(&format!("{at}.aliases"), table.aliases.len(), MAX_ENTRIES);
            for (k, name) in table.aliases.iter().enumerate().take(MAX_ENTRIES) {
                self.text(&format!("{at}.aliases[{k}]"), name, MAX_NAME_CHARS);
            }
            self.claim_sizes(&at, &table.claims);
            self.table_sizes(&format!("{at}.show"), &table.show);
        }
        let stages: u64 = arms.iter().map(|arm| arm.stages.len() as u64).sum();
        let conditions = conditions.len().max(1) as u64;
        let trainings = experiment.seeds.saturating_mul(stages).saturating_mul(conditions);
        if trainings > MAX_TRAININGS && experiment.seeds <= 1000 {
            let message = format!(
                "are {}: with so many arms and conditions that makes {trainings} trainings; give fewer, for \
                 {MAX_TRAININGS} at most",
                experiment.seeds
            );
            self.found("seeds", message);
        }
    }

    fn table_sizes(&mut self, at: &str, show: &TableKind) {
        match show {
            TableKind::Seeds { paper, .. } => {
                self.count(&format!("{at}.paper"), paper.len(), MAX_ENTRIES);
                for (k, (_, value)) in paper.iter().enumerate().take(MAX_ENTRIES) {
                    self.number(&format!("{at}.paper[{k}][1]"), *value);
                }
            }
            TableKind::Rounds { paper, .. } => {
                self.count(&format!("{at}.paper"), paper.len(), MAX_ENTRIES);
                for (k, (_, rounds)) in paper.iter().enumerate().take(MAX_ENTRIES) {
                    self.count(&format!("{at}.paper[{k}][1]"), rounds.len(), 1000);
                    for (j, value) in rounds.iter().enumerate().take(1000) {
                        self.number(&format!("{at}.paper[{k}][1][{j}]"), *value);
                    }
                }
            }
            TableKind::Measures { measures, .. } => {
                self.count(&format!("{at}.measures"), measures.len(), MAX_MEASURES);
            }
            TableKind::Contrast { measures, after, .. } => {
                self.count(&format!("{at}.measures"), measures.len(), MAX_MEASURES);
                self.count(&format!("{at}.after"), after.len(), MAX_ENTRIES);
            }
        }
    }

    fn claim_sizes(&mut self, at: &str, claims: &[Claim]) {
        self.count(&format!("{at}.claims"), claims.len(), MAX_ENTRIES);
        for (k, claim) in claims.iter().enumerate().take(MAX_ENTRIES) {
            self.text(&format!("{at}.claims[{k}].statement"), &claim.statement, MAX_TEXT_CHARS);
        }
    }

    fn count(&mut self, path: &str, count: usize, most: usize) {
        if count > most {
            self.found(path, format!("has {count} entries; give at most {most}"));
        }
    }

    fn text(&mut self, path: &str, text: &str, most: usize) {
        let long = text.chars().count();
        if long > most {
            self.found(path, format!("has {long} characters; write at most {most}"));
        }
    }

    fn number(&mut self, path: &str, value: f64) {
        if !(-MAX_VALUE..=MAX_VALUE).contains(&value) {
            self.found(path, format!("is {value}; give a number from {} to {MAX_VALUE}", -MAX_VALUE));
        }
    }

    fn found(&mut self, path: &str, message: String) {
        self.diagnostics.push(Diagnostic { path: path.into(), message });
    }

    fn range(&mut self, path: &str, value: u64, least: u64, most: u64) {
        if !(least..=most).contains(&value) {
            self.found(path, format!("is {value}; give {least} to {most}"));
        }
    }

    fn header(&mut self, experiment: &Experiment) {
        if experiment.title.trim().is_empty() {
            self.found("title", "is empty; say what the experiment is about".into());
        }
        self.range("seeds", experiment.seeds, 1, 1000);
        self.range("test.rounds", experiment.test.rounds as u64, 1, 1000);
        self.range("test.episodes", experiment.test.episodes as u64, 1, 10_000);
        if let Some(rule) = &experiment.evaluation {
            self.range("evaluation.every_env_steps", rule.every_env_steps, 1, u64::MAX);
            self.range("evaluation.episodes", rule.episodes as u64, 1, 100_000);
        }
        if experiment.figures.is_empty() && experiment.tables.is_empty() {
            self.found("tables", "nothing is to be shown; give at least one figure or table".into());
        }
    }

    fn arms(&mut self) {
        if self.arms.is_empty() {
            self.found("arms", "is empty; give at least one".into());
        }
        self.names("arms", self.arms.iter().map(|arm| arm.name.as_str()));
        for (i, arm) in self.arms.iter().enumerate() {
            if arm.stages.is_empty() {
                self.found(&format!("arms[{i}].stages"), "is empty; give at least one".into());
            }
            for (k, stage) in arm.stages.iter().enumerate() {
                let at = format!("arms[{i}].stages[{k}]");
                if let Some(Budget::Episodes(n) | Budget::EnvSteps(n)) = stage.budget {
                    self.range(&format!("{at}.budget"), n, 1, MAX_STEPS);
                }
                match stage.epsilon {
                    Some(x) if !(0.0..=1.0).contains(&x) => {
                        self.found(&format!("{at}.epsilon"), format!("is {x}; give 0 to 1"));
                    }
                    Some(_) if k == 0 => self.found(
                        &format!("{at}.epsilon"),
                        "is for stages that take up another's weights; set it in the preset for the first"
                            .into(),
                    ),
                    _ => {}
                }
            }
        }
    }

    /// Names that stand for one thing each.
    fn names<'b>(&mut self, path: &str, names: impl Iterator<Item = &'b str>) {
        let mut seen = BTreeSet::new();
        for name in names {
            if name.trim().is_empty() {
                self.found(path, "one has an empty name".into());
            } else if !seen.insert(name) {
                self.found(path, format!("two are called \"{name}\"; give each a name of its own"));
            }
        }
    }

    fn file_name(&mut self, path: &str, name: &str) {
        let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        if name.is_empty() || name.len() > 60 || !name.chars().all(fits) {
            let mend = "it becomes a file's name: give 1 to 60 of a-z, 0-9 and -";
            self.found(path, format!("is \"{name}\"; {mend}"));
        }
    }

    fn arm(&mut self, path: &str, name: &str) {
        if self.arms.iter().any(|arm| arm.name == name) {
            return;
        }
        let names = || self.arms.iter().map(|arm| arm.name.as_str());
        let mend = match closest_name(name, names()) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("the arms are: {}", names().collect::<Vec<_>>().join(", ")),
        };
        self.found(path, format!("no arm is called \"{name}\"; {mend}"));
    }

    fn measures(&mut self, path: &str, measures: &[Measure]) {
        if measures.is_empty() {
            self.found(path, "names nothing to measure; give [Success]".into());
        }
        for invalid_reason in measures.iter().filter_map(|measure| measure.invalid_reason()) {
            self.found(path, invalid_reason);
        }
    }

    fn after(&mut self, path: &str, after: u64) {
        self.after_of(path, after, false);
    }

    /// Every arm tested as it stands must get so far.
    fn after_of(&mut self, path: &str, after: u64, of_last_stage: bool) {
        self.range(path, after, 1, MAX_STEPS);
        for arm in self.arms.iter().filter(|arm| arm.policy == TestedPolicy::AtEpisode) {
            // Budgets left to the preset are looked at when it is loaded.
            let first = if of_last_stage { arm.stages.len().saturating_sub(1) } else { 0 };
            let budgets = arm.stages[first..].iter().map(|stage| match stage.budget {
                Some(Budget::Episodes(n)) => Some(n),
                _ => None,
            });
            if let Some(total) = total(budgets).filter(|&total| total < after) {
                let name = &arm.name;
                self.diagnostics.push(Diagnostic {
                    path: path.into(),
                    message: format!("is {after}, but arm \"{name}\" has {total} episodes"),
                });
            }
        }
    }

    fn claims(&mut self, at: &str, claims: &[Claim]) {
        for (i, claim) in claims.iter().enumerate() {
            let at = format!("{at}.claims[{i}]");
            self.measures(&format!("{at}.measure"), &[claim.measure]);
            self.arm(&format!("{at}.better"), &claim.better);
            self.arm(&format!("{at}.than"), &claim.than);
            self.after_of(&format!("{at}.after"), claim.after, claim.of_last_stage);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::shipped;

    /// What is changed in a sound experiment, and the field that must be blamed for it.
    type Breakage = (&'static str, fn(&mut Experiment));

    #[test]
    fn more_than_anybody_needs_is_refused_before_it_is_looked_at() {
        let text = shipped::experiments().find(|(from, _)| from.ends_with("fig10.ron")).expect("shipped").1;
        let sound = Experiment::parse(text, "fig10.ron").expect("it is sound");
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
                    after: 1,
                    of_last_stage: false,
                };
                e.tables[0].claims = vec![claim; 201];
            }),
            // 1,000 seeds of at least 11 trainings each.
            ("seeds", |e| {
                let stage = e.arms[0].stages[0].clone();
                (e.seeds, e.arms[0].stages) = (1000, vec![stage; 11]);
            }),
            ("seeds", |e| e.seeds = u64::MAX),
            ("tables[0].show.paper[0][1]", |e| {
                let paper = vec![("nobody".into(), f64::NAN)];
                e.tables[0].show = TableKind::Seeds { measure: Measure::Success, after: 1, paper };
            }),
        ];
        for (path, breakage) in breakages {
            let mut broken = sound.clone();
            breakage(&mut broken);
            let found = diagnostics(&broken);
            assert!(found.iter().any(|finding| finding.path == *path), "{path}: {found:?}");
            assert!(found.len() < 10, "{path}: and little else: {found:?}");
        }
    }

    #[test]
    fn sums_of_episodes_stop_at_the_largest_number() {
        assert_eq!(total([Some(3), Some(4)].into_iter()), Some(7));
        assert_eq!(total([Some(u64::MAX), Some(4)].into_iter()), Some(u64::MAX));
        assert_eq!(total([Some(3), None].into_iter()), None);
    }
}
