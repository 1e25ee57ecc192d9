//! An arm under a condition with a seed: its training runs, and its policies at each point.

use serde::{Deserialize, Serialize};

use super::experiment::TestedPolicy;
use super::plan::PlannedRun;
use super::test_point::{TestPoint, difference};
use crate::run::preset::Budget;

/// A policy of a training run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum PolicyId {
    /// The policy after a number of episodes or env steps of the run.
    After(Budget),
    /// The best policy by the evaluations during training.
    Best,
    /// The policy at the end of a run that was trained elsewhere.
    Last,
}

/// An arm under a condition with a seed: its training runs, one per stage that is needed.
#[derive(Clone, Debug)]
pub struct ArmRun {
    /// For each stage, the index into [`RunPlan::training_runs`](super::plan::RunPlan::training_runs) and how much of that
    /// training run belongs to the stage.
    pub stages: Vec<(usize, Budget)>,
}

impl ArmRun {
    /// The stage that the arm is in at `point`, as an index into `stages`, and how much of that stage is done by then.
    /// `None` if the arm is shorter, or if a stage's length is not given in the same unit.
    #[must_use]
    pub fn stage_at(&self, point: TestPoint) -> Option<(usize, Budget)> {
        let last = self.stages.len().checked_sub(1)?;
        let Some(mut after) = point.after else { return Some((last, self.stages[last].1)) };
        for index in if point.of_last_stage { last } else { 0 }..=last {
            let length = self.stages[index].1;
            let beyond = difference(after, length)?;
            if after <= length {
                return Some((index, after));
            }
            after = beyond;
        }
        None
    }

    /// The index of the training run, and which of its policies is tested at `point`. `None` if the arm is shorter,
    /// or if a stage's length is not given in the same unit.
    #[must_use]
    pub fn policy(
        &self,
        training_runs: &[PlannedRun],
        tested: TestedPolicy,
        point: TestPoint,
    ) -> Option<(usize, PolicyId)> {
        let &(last, _) = self.stages.last()?;
        if tested == TestedPolicy::Best {
            return Some((last, PolicyId::Best));
        }
        if let Some(run) = &training_runs[last].elsewhere {
            return run.policy_at(point.after).map(|policy| (last, policy));
        }
        let (stage, length) = self.stage_at(point)?;
        Some((self.stages[stage].0, PolicyId::After(length)))
    }
}
