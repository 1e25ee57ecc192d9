//! Points at which an arm is tested.

use crate::report::format::counted;
use crate::run::preset::Budget;

/// A point of an arm's training: after a number of episodes or env steps, or at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TestPoint {
    /// The episodes or env steps; `None` at the end of the last stage.
    pub after: Option<Budget>,
    /// Whether they are counted from the start of the last stage.
    pub of_last_stage: bool,
}

impl TestPoint {
    /// A point counted over all stages.
    #[must_use]
    pub fn overall(after: Option<Budget>) -> Self {
        Self { after, of_last_stage: false }
    }

    /// The point in words: "1,000 episodes", or "the whole training run".
    #[must_use]
    pub fn words(self) -> String {
        match self.after {
            Some(length) if self.of_last_stage => format!("{} of the last stage", length_words(length)),
            Some(length) => length_words(length),
            None => "the whole training run".into(),
        }
    }
}

/// A length in words: "1,000 episodes", or "20,000 env steps".
fn length_words(length: Budget) -> String {
    match length {
        Budget::Episodes(n) => counted(n as f64, "episode"),
        Budget::EnvSteps(n) => counted(n as f64, "env step"),
    }
}

/// The points of a table of one arm against another: those in `after`, or the end.
pub fn contrast_points(after: &[Budget], of_last_stage: bool) -> Vec<TestPoint> {
    if after.is_empty() {
        return vec![TestPoint::overall(None)];
    }
    after.iter().map(|&after| TestPoint { after: Some(after), of_last_stage }).collect()
}

/// `a` - `b`, at least 0, if both are in the same unit.
pub fn difference(a: Budget, b: Budget) -> Option<Budget> {
    match (a, b) {
        (Budget::Episodes(a), Budget::Episodes(b)) => Some(Budget::Episodes(a.saturating_sub(b))),
        (Budget::EnvSteps(a), Budget::EnvSteps(b)) => Some(Budget::EnvSteps(a.saturating_sub(b))),
        _ => None,
    }
}

/// The shorter of two lengths, if both are in the same unit.
pub fn shorter(a: Budget, b: Budget) -> Option<Budget> {
    difference(a, b).map(|_| a.min(b))
}

/// The unit of a length: "episodes" or "env steps".
pub fn unit_name(length: Budget) -> &'static str {
    match length {
        Budget::Episodes(_) => "episodes",
        Budget::EnvSteps(_) => "env steps",
    }
}

/// The number of episodes or env steps.
pub fn amount(length: Budget) -> u64 {
    let (Budget::Episodes(n) | Budget::EnvSteps(n)) = length;
    n
}
