//! The check of arms and conditions, and of the points at which arms are tested.

use super::Check;
use crate::limits::MAX_STEPS;
use crate::reproduce::experiment::{Arm, Experiment, TestedPolicy};
use crate::reproduce::measure::Measure;
use crate::reproduce::test_point::{TestPoint, amount, difference, unit_name};
use crate::run::preset::Budget;
use crate::scenario::closest_name;

impl Check<'_> {
    pub(super) fn arms(&mut self) {
        if self.arms.is_empty() {
            self.found.add("arms", "is empty; help: give at least one arm");
        }
        self.found.names("arms", self.arms.iter().map(|arm| arm.name.as_str()));
        for (i, arm) in self.arms.iter().enumerate() {
            match (arm.stages.is_empty(), arm.runs.is_empty()) {
                (true, true) => self.found.add(
                    &format!("arms[{i}].stages"),
                    "is empty; help: give at least one stage, or finished runs (`runs: [\"runs/a\"]`)",
                ),
                (false, false) => self.found.add(
                    &format!("arms[{i}].runs"),
                    "is given together with stages; help: give either stages to train, or finished runs",
                ),
                _ => {}
            }
            for (k, stage) in arm.stages.iter().enumerate() {
                let at = format!("arms[{i}].stages[{k}]");
                if let Some(Budget::Episodes(n) | Budget::EnvSteps(n)) = stage.budget {
                    self.found.range(&format!("{at}.budget"), n, 1, MAX_STEPS);
                }
                self.epsilon(&format!("{at}.epsilon"), stage.epsilon, k == 0);
            }
        }
    }

    /// Checks the conditions, and that no condition or override applies to an arm with finished runs, which cannot be changed.
    pub(super) fn conditions(&mut self, experiment: &Experiment) {
        self.found.names("conditions", experiment.conditions.iter().map(|c| c.name.as_str()));
        for (i, condition) in experiment.conditions.iter().enumerate() {
            condition.only_arms.iter().for_each(|name| self.arm(&format!("conditions[{i}].only_arms"), name));
            self.only_scenarios(&format!("conditions[{i}].only_scenarios"), &condition.only_scenarios);
        }
        let is_changed = |arm: &Arm| {
            !experiment.overrides.is_empty()
                || experiment.conditions.iter().any(|condition| condition.includes(arm))
        };
        let finished = self.arms.iter().enumerate().filter(|(_, arm)| !arm.runs.is_empty());
        for (i, arm) in finished.filter(|(_, arm)| is_changed(arm)) {
            let message = format!(
                "are finished, so conditions and overrides cannot change \"{}\"; help: leave them out, limit the conditions to \
                 other arms with `only_arms`, or give the arm stages",
                arm.name
            );
            self.found.add(&format!("arms[{i}].runs"), message);
        }
    }

    /// Checks that each of `names` is the scenario of a stage.
    fn only_scenarios(&mut self, path: &str, names: &[String]) {
        let known = || self.arms.iter().flat_map(|arm| &arm.stages).map(|stage| stage.scenario.as_str());
        for name in names {
            if !self.names_are_known || known().any(|known| known == name) {
                continue;
            }
            let help = match closest_name(name, known()) {
                Some(near) => format!("did you mean \"{near}\"?"),
                None => "write it as the stage does".into(),
            };
            self.found.add(path, format!("names \"{name}\", but no stage has this scenario; help: {help}"));
        }
    }

    fn epsilon(&mut self, path: &str, epsilon: Option<f32>, is_first_stage: bool) {
        match epsilon {
            Some(x) if !(0.0..=1.0).contains(&x) => {
                self.found.add(path, format!("is {x}; help: give 0 to 1"));
            }
            Some(_) if is_first_stage => self.found.add(
                path,
                "is only for stages that start from another stage's weights; help: set epsilon in the preset",
            ),
            _ => {}
        }
    }

    /// Checks that `measures` have values at `point`, and that the arms called `names` (by default, all arms) are trained that
    /// long, in the same unit.
    pub(super) fn after(
        &mut self,
        path: &str,
        point: TestPoint,
        measures: &[Measure],
        names: Option<[&str; 2]>,
    ) {
        let Some(after) = point.after else { return };
        self.found.range(path, amount(after), 0, MAX_STEPS);
        if let Some(measure) = measures.iter().find(|m| m.is_of_episodes() && amount(after) == 0) {
            let message = format!(
                "is 0, where no episode has ended, so that \"{}\" has no value; help: give at least 1, or measure SuccessRate",
                measure.heading()
            );
            self.found.add(path, message);
        }
        let is_tested = |arm: &&Arm| names.is_none_or(|names| names.contains(&arm.name.as_str()));
        let is_trained = |arm: &&Arm| arm.policy == TestedPolicy::After && !arm.stages.is_empty();
        for arm in self.arms.iter().filter(is_tested).filter(is_trained) {
            let first = if point.of_last_stage { arm.stages.len() - 1 } else { 0 };
            // A budget of the preset is checked when the preset is loaded.
            let budgets = || arm.stages[first..].iter().map(|stage| stage.budget);
            let in_unit = |budget: Budget| difference(after, budget).is_some();
            if let Some(budget) = budgets().flatten().find(|&budget| !in_unit(budget)) {
                let (unit, other) = (unit_name(after), unit_name(budget));
                let message = format!(
                    "is a number of {unit}, but arm \"{}\" is trained for a number of {other}; help: use the same unit, or \
                     give the arm `policy: Best`",
                    arm.name
                );
                self.found.add(path, message);
            } else if let Some(total) = total(budgets().map(|b| b.map(amount))).filter(|&n| n < amount(after))
            {
                let message = format!(
                    "is {}, but arm \"{}\" is trained for {total} {}; help: reduce it, or train longer",
                    amount(after),
                    arm.name,
                    unit_name(after)
                );
                self.found.add(path, message);
            }
        }
    }
}

/// The sum of counts, saturating; `None` if any is unknown.
fn total(mut counts: impl Iterator<Item = Option<u64>>) -> Option<u64> {
    counts.try_fold(0_u64, |sum, count| Some(sum.saturating_add(count?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_budgets_saturate_and_are_unknown_if_a_budget_is() {
        assert_eq!(total([Some(3), Some(4)].into_iter()), Some(7));
        assert_eq!(total([Some(u64::MAX), Some(4)].into_iter()), Some(u64::MAX));
        assert_eq!(total([Some(3), None].into_iter()), None);
    }
}
