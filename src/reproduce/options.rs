//! The options of `--reproduce`.

use std::path::PathBuf;

use super::seeds::Seeds;
use super::shard::Shard;
use crate::run::settings::Settings;

/// The options of a reproduction.
#[derive(Clone, Debug, Default)]
pub struct ReproduceOptions {
    /// Experiment files of the user; if there are none, all shipped experiments.
    pub experiments: Vec<PathBuf>,
    /// Names of figures, tables or experiments; if there are none, all of them.
    pub only: Vec<String>,
    /// The seeds, instead of the experiments' own.
    pub seeds: Option<Seeds>,
    /// Settings of all stages, after the experiments' own.
    pub settings: Settings,
    /// Whether to run a short version with a tenth of the episodes.
    pub quick: bool,
    /// The report's folder, instead of the default one.
    pub out: Option<PathBuf>,
    /// The part of the trainings to run, without a report; all of them and the report if there is none.
    pub shard: Option<Shard>,
    /// The number of runs in parallel, instead of one per core.
    pub jobs: Option<usize>,
}
