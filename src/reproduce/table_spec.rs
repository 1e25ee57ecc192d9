//! The schema of an experiment's tables.

use serde::{Deserialize, Serialize};

use super::claim::Claim;
use super::measure::Measure;
use crate::run::preset::Budget;

/// A table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableSpec {
    /// The name of the table's files, also used by `--only`: lower-case letters, digits and `-`.
    pub name: String,
    /// Other names for `--only`.
    #[serde(default)]
    pub aliases: Vec<String>,
    /// The title.
    pub title: String,
    /// The kind of table.
    pub show: TableKind,
    /// Claims to test.
    #[serde(default)]
    pub claims: Vec<Claim>,
}

/// The kind of a table. `after` is a number of episodes or env steps, after which the policy is tested; 0 is before the
/// first step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum TableKind {
    /// A row for each arm: the value of every seed, their mean with its 95 % interval, the paper's value and the
    /// difference.
    Seeds {
        /// The measure.
        measure: Measure,
        /// Episodes or env steps over all stages; without it, after training.
        #[serde(default)]
        after: Option<Budget>,
        /// The paper's values, by arm.
        #[serde(default)]
        paper: Vec<(String, f64)>,
    },
    /// Success in percent, with a column for each round of the test. Each arm has a row for the paper's results, if given, and
    /// a row for each seed.
    Rounds {
        /// Episodes or env steps over all stages; without it, after training.
        #[serde(default)]
        after: Option<Budget>,
        /// The paper's success rates in each round, in percent, by arm.
        #[serde(default)]
        paper: Vec<(String, Vec<f64>)>,
    },
    /// Means with their 95 % intervals: a row for each arm (and condition), a column for each measure.
    Measures {
        /// The measures, one column each.
        measures: Vec<Measure>,
        /// Episodes or env steps over all stages; without it, after training.
        #[serde(default)]
        after: Option<Budget>,
    },
    /// One arm against another: a row for each condition and each entry of `after`.
    Contrast {
        /// The measures, a group of columns each.
        measures: Vec<Measure>,
        /// The arm that is expected to be better.
        better: String,
        /// The other arm.
        than: String,
        /// Episodes or env steps, a row each; without them, after training.
        #[serde(default)]
        after: Vec<Budget>,
        /// Whether `after` counts from the start of the last stage; otherwise it counts over all stages.
        #[serde(default)]
        of_last_stage: bool,
    },
}
