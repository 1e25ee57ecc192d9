//! The check of an experiment: everything in it that cannot be meant, with the path of the field and the mend.
//!
//! In: an [`Experiment`] as its file spells it. Out: findings; none for one that can be carried out (its scenarios and
//! presets are looked at when they are loaded).

use std::collections::BTreeSet;

use super::experiment::{Arm, Draw, Experiment, Show, Tested};
use super::measure::Measure;
use crate::run::preset::Budget;
use crate::scenario::{Finding, nearest};

/// Everything in `experiment` that cannot be meant.
pub(super) fn findings(experiment: &Experiment) -> Vec<Finding> {
    let mut check = Check { arms: &experiment.arms, findings: Vec::new() };
    check.header(experiment);
    check.arms();
    let conditions = experiment.conditions.iter().map(|condition| condition.name.as_str());
    check.names("conditions", conditions);
    for (i, figure) in experiment.figures.iter().enumerate() {
        let at = format!("figures[{i}]");
        check.file_name(&format!("{at}.name"), &figure.name);
        match &figure.draw {
            Draw::Curves { series, smoothing, .. } => {
                if series.is_empty() {
                    check.found(&format!("{at}.draw.series"), "names nothing to draw; give [Return]".into());
                }
                check.range(&format!("{at}.draw.smoothing"), *smoothing as u64, 1, 10_000);
            }
            Draw::Dots { measures, after } => {
                check.measures(&format!("{at}.draw.measures"), measures);
                check.after(&format!("{at}.draw.after"), *after);
            }
            Draw::Course { after } => check.after(&format!("{at}.draw.after"), *after),
        }
        check.claims(&at, &figure.claims);
    }
    for (i, table) in experiment.tables.iter().enumerate() {
        let at = format!("tables[{i}]");
        check.file_name(&format!("{at}.name"), &table.name);
        match &table.show {
            Show::Seeds { measure, after, paper } => {
                check.measures(&format!("{at}.show.measure"), &[*measure]);
                check.after(&format!("{at}.show.after"), *after);
                for (name, _) in paper {
                    check.arm(&format!("{at}.show.paper"), name);
                }
            }
            Show::Rounds { after, paper } => {
                check.after(&format!("{at}.show.after"), *after);
                for (name, _) in paper {
                    check.arm(&format!("{at}.show.paper"), name);
                }
            }
            Show::Measures { measures, after } => {
                check.measures(&format!("{at}.show.measures"), measures);
                check.after(&format!("{at}.show.after"), *after);
            }
            Show::Contrast { measures, better, than, after, of_last_stage } => {
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
    check.findings
}

struct Check<'a> {
    arms: &'a [Arm],
    findings: Vec<Finding>,
}

impl Check<'_> {
    fn found(&mut self, path: &str, message: String) {
        self.findings.push(Finding { path: path.into(), message });
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
        self.range("test.navigations", experiment.test.navigations as u64, 1, 10_000);
        if let Some(rule) = &experiment.evaluation {
            self.range("evaluation.every_env_steps", rule.every_env_steps, 1, u64::MAX);
            self.range("evaluation.navigations", rule.navigations as u64, 1, 100_000);
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
                if matches!(stage.budget, Some(Budget::Episodes(0) | Budget::EnvSteps(0))) {
                    self.found(&format!("{at}.budget"), "is 0; give at least 1".into());
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
        let mend = match nearest(name, names()) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("the arms are: {}", names().collect::<Vec<_>>().join(", ")),
        };
        self.found(path, format!("no arm is called \"{name}\"; {mend}"));
    }

    fn measures(&mut self, path: &str, measures: &[Measure]) {
        if measures.is_empty() {
            self.found(path, "names nothing to measure; give [Success]".into());
        }
        for problem in measures.iter().filter_map(|measure| measure.problem()) {
            self.found(path, problem);
        }
    }

    fn after(&mut self, path: &str, after: u64) {
        self.after_of(path, after, false);
    }

    /// Every arm tested as it stands must get so far.
    fn after_of(&mut self, path: &str, after: u64, of_last_stage: bool) {
        if after == 0 {
            self.found(path, "is 0; give at least 1 episode".into());
        }
        for arm in self.arms.iter().filter(|arm| arm.policy == Tested::AsItStands) {
            // Budgets left to the preset are looked at when it is loaded.
            let first = if of_last_stage { arm.stages.len().saturating_sub(1) } else { 0 };
            let budgets = arm.stages[first..].iter().map(|stage| match stage.budget {
                Some(Budget::Episodes(n)) => Some(n),
                _ => None,
            });
            if let Some(total) = budgets.sum::<Option<u64>>().filter(|&total| total < after) {
                let name = &arm.name;
                self.findings.push(Finding {
                    path: path.into(),
                    message: format!("is {after}, but arm \"{name}\" has {total} episodes"),
                });
            }
        }
    }

    fn claims(&mut self, at: &str, claims: &[super::experiment::Claim]) {
        for (i, claim) in claims.iter().enumerate() {
            let at = format!("{at}.claims[{i}]");
            self.measures(&format!("{at}.measure"), &[claim.measure]);
            self.arm(&format!("{at}.better"), &claim.better);
            self.arm(&format!("{at}.than"), &claim.than);
            self.after_of(&format!("{at}.after"), claim.after, claim.of_last_stage);
        }
    }
}
