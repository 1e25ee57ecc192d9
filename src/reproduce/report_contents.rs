//! The contents of a report, as its folder records them, and the check whether another report may replace it.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::options::ReproduceOptions;
use super::selected::SelectedExperiment;
use crate::scenario::printable_path;

/// Stands for the shipped experiments in the list of files.
const SHIPPED: &str = "the paper's experiments";

/// The fix for a folder whose report must stay.
pub const OTHER_FOLDER: &str = "choose another folder with --out";

/// The contents of a report.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ReportContents {
    /// Whether it is a quick report.
    pub quick: bool,
    /// The user's experiment files, with absolute paths where possible, or one entry for the shipped experiments.
    pub experiments: Vec<String>,
    /// The number of seeds of each experiment in the report, by the experiment's name.
    pub seeds: BTreeMap<String, u64>,
    /// The names of the figures and tables; empty in the file of a version that did not record them.
    #[serde(default)]
    pub items: BTreeSet<String>,
    /// Whether the user has selected them with `--only`.
    #[serde(skip)]
    pub is_selection: bool,
}

impl ReportContents {
    /// The contents of the report that `options` ask for.
    pub fn new(options: &ReproduceOptions, selected: &[SelectedExperiment]) -> Self {
        let mut experiments: Vec<String> = options.experiments.iter().map(|path| absolute(path)).collect();
        if experiments.is_empty() {
            experiments.push(SHIPPED.into());
        }
        let seeds = |of: &SelectedExperiment| (of.source.name(), of.source.experiment.seeds.count());
        Self {
            quick: options.quick,
            experiments,
            seeds: selected.iter().map(seeds).collect(),
            items: selected.iter().flat_map(SelectedExperiment::items).map(String::from).collect(),
            is_selection: !options.only.is_empty(),
        }
    }

    /// Why this report must not replace the full report `old`, with the fix: it lacks an experiment file, has fewer seeds of an
    /// experiment, or lacks figures or tables because of `--only`. `None` if it may.
    pub fn cannot_replace(&self, old: &Self) -> Option<String> {
        if let Some(other) = old.experiments.iter().find(|other| !self.includes(other)) {
            let other = printable_path(Path::new(other));
            let why = format!("holds a full report of {other}, which this one would replace");
            return Some(format!("{why}; help: {OTHER_FOLDER}"));
        }
        let fewer = |(name, &more): (&String, &u64)| {
            let now = *self.seeds.get(name)?;
            let why = format!(
                "holds a full report with {more} seeds of {name}, which one with {now} would replace"
            );
            (now < more).then(|| format!("{why}; help: {OTHER_FOLDER}"))
        };
        old.seeds.iter().find_map(fewer).or_else(|| self.leaves_out(old))
    }

    /// Why `--only` selects too little to replace `old`; `None` if it leaves out no figure and no table.
    fn leaves_out(&self, old: &Self) -> Option<String> {
        let left_out: Vec<&str> = old.items.difference(&self.items).map(String::as_str).collect();
        (self.is_selection && !left_out.is_empty()).then(|| {
            format!(
                "holds a full report with more than --only names: {}; help: name them as well, leave --only out (finished \
                 runs are not repeated), or {OTHER_FOLDER}",
                left_out.join(", ")
            )
        })
    }

    /// Whether `other` is one of these experiments, perhaps under the path that it had before it was moved.
    fn includes(&self, other: &String) -> bool {
        let path = Path::new(other);
        let moved = |own: &String| Path::new(own).file_name() == path.file_name() && !path.exists();
        self.experiments.iter().any(|own| own == other || moved(own))
    }
}

fn absolute(path: &Path) -> String {
    fs::canonicalize(path).unwrap_or_else(|_| path.into()).display().to_string()
}
