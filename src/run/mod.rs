//! Headless training and evaluation: run folders, checkpoints, policies, results.
//!
//! In: a scenario, a preset and a seed, or a run folder, or a policy. Out: run folders, results, progress.
//!
//! | file | contents |
//! |---|---|
//! | `preset.rs` | training presets |
//! | `settings.rs` | single fields of a preset or scenario that are set from outside their files |
//! | `notes/` | questionable settings of a run |
//! | `memory.rs`, `memory_limit.rs` | the memory that a run needs, and the limits of the process |
//! | `scenario_set.rs` | the files of sets of scenarios |
//! | `shipped.rs` | the shipped scenarios, presets and policies, by name |
//! | `training_setup.rs` | the learner and the simulation of a new run |
//! | `mirror.rs` | the mirror image of a run's observations and actions |
//! | `train/` | the training loop |
//! | `metrics.rs` | metrics of episodes and evaluations, and the best policy |
//! | `evaluate/` | success over rounds of episodes and on the benchmark route; records and traces of episodes; comparison with optimal times |
//! | `suite/` | tests of drivers and policies in many scenarios, by families |
//! | `on_all_cores.rs` | work on all cores, with results in a fixed order |
//! | `background_evaluator.rs` | evaluation during training |
//! | `final_test.rs` | the test of the best policy after training |
//! | `folder/` | run folders: configuration, CSV files |
//! | `output_file/` | output files, written whole or not at all |
//! | `image_file.rs` | image files: SVG, PNG, PDF |
//! | `lock.rs` | the lock that keeps a second process out of a folder |
//! | `write_points.rs` | named points between writes, where a test can abort the process |
//! | `metric_rows.rs`, `metrics_writer.rs` | the rows of `episodes.csv` and `evaluations.csv`, and their writer |
//! | `policy_card/` | the card in a policy file, and its comparison with a scenario |
//! | `export.rs` | a policy for other programs, as an ONNX file with a model card |
//! | `provenance.rs` | the program and the scenario that a record of results names |
//! | `checkpoint/` | checkpoints, from which a run resumes bit-identically |
//! | `fingerprint.rs` | checksums that show whether two builds simulate bit-identically |
//! | `scenario_image.rs`, `run_image.rs` | the figure of a scenario, seen from above; the learning curves of a run |
//! | `processor.rs` | the kinds of processor that a run was trained on |
//! | `tensorboard/`, `progress/` | TensorBoard events; progress on stderr |
//! | `signals.rs` | the signals that ask the program to stop |

pub mod background_evaluator;
pub mod checkpoint;
pub mod evaluate;
#[cfg(not(target_arch = "wasm32"))]
pub mod export;
pub mod final_test;
pub mod fingerprint;
pub mod folder;
#[cfg(not(target_arch = "wasm32"))]
pub mod image_file;
#[cfg(not(target_arch = "wasm32"))]
pub mod lock;
pub mod memory;
#[cfg(unix)]
pub(crate) mod memory_limit;
pub mod metric_rows;
pub mod metrics;
#[cfg(not(target_arch = "wasm32"))]
pub mod metrics_writer;
mod mirror;
pub mod notes;
pub mod on_all_cores;
pub mod output_file;
pub mod policy_card;
pub mod preset;
#[cfg(not(target_arch = "wasm32"))]
pub mod processor;
#[cfg(not(target_arch = "wasm32"))]
pub mod progress;
pub mod provenance;
#[cfg(not(target_arch = "wasm32"))]
pub mod run_image;
#[cfg(not(target_arch = "wasm32"))]
pub mod scenario_image;
pub mod scenario_set;
pub mod settings;
pub mod shipped;
#[cfg(not(target_arch = "wasm32"))]
pub mod signals;
#[cfg(not(target_arch = "wasm32"))]
pub mod suite;
#[cfg(not(target_arch = "wasm32"))]
pub mod tensorboard;
#[cfg(not(target_arch = "wasm32"))]
pub mod train;
pub mod training_setup;
pub mod write_points;

/// The reason why a command failed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RunError {
    /// Invalid arguments or files, found before any work began. Exit status 2.
    #[error("{0}")]
    InvalidInput(String),
    /// A failure during the work. Exit status 1.
    #[error("{0}")]
    Failed(String),
    /// The work was stopped on request and can be continued. Exit status 128 plus the number of the
    /// [first signal](signals::received).
    #[error("{0}")]
    Stopped(String),
}

impl RunError {
    /// The exit status of the process.
    #[cfg(not(target_arch = "wasm32"))]
    #[must_use]
    pub fn exit_status(&self) -> u8 {
        match self {
            Self::InvalidInput(_) => 2,
            Self::Failed(_) => 1,
            Self::Stopped(_) => signals::received().map_or(1, signals::StopSignal::exit_status),
        }
    }

    /// The error for an invalid file.
    pub(crate) fn invalid_input(path: &std::path::Path, why: impl std::fmt::Display) -> Self {
        Self::InvalidInput(format!("{}: {why}", crate::scenario::printable_path(path)))
    }

    /// The error for a file on which the work failed.
    pub(crate) fn failed(path: &std::path::Path, why: impl std::fmt::Display) -> Self {
        Self::Failed(format!("{}: {why}", crate::scenario::printable_path(path)))
    }

    /// The error for a file that could not be written during the work.
    pub fn not_written(path: &std::path::Path, error: impl std::fmt::Display) -> Self {
        Self::failed(path, format_args!("can't be written: {error}"))
    }

    /// The error for a file that would not be writable after the work.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn not_writable(path: &std::path::Path, error: impl std::fmt::Display) -> Self {
        Self::invalid_input(path, format_args!("can't be written: {error}"))
    }

    /// The same error with a remark in parentheses: after the problem, before the help.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn with_remark(self, remark: &str) -> Self {
        let add = |text: String| match text.split_once("; help:") {
            Some((problem, help)) => format!("{problem} ({remark}); help:{help}"),
            None => format!("{text} ({remark})"),
        };
        match self {
            Self::InvalidInput(text) => Self::InvalidInput(add(text)),
            Self::Failed(text) => Self::Failed(add(text)),
            Self::Stopped(text) => Self::Stopped(add(text)),
        }
    }
}

/// The `message` of an error without its help, for a sentence that gives other advice or none.
pub(crate) fn without_help(message: &str) -> &str {
    message.split("; help:").next().unwrap_or(message)
}

impl From<crate::simulation::StepError> for RunError {
    fn from(error: crate::simulation::StepError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<crate::scenario::FileError> for RunError {
    fn from(error: crate::scenario::FileError) -> Self {
        Self::InvalidInput(error.to_string())
    }
}

#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests {
    use super::RunError;

    #[test]
    fn a_remark_comes_before_the_help_and_keeps_the_kind_of_error() {
        let with_remark = |error: RunError| error.with_remark("at step 7");
        assert_eq!(
            with_remark(RunError::Failed("learning diverged; help: try again".into())),
            RunError::Failed("learning diverged (at step 7); help: try again".into())
        );
        assert_eq!(
            with_remark(RunError::Stopped("stopped".into())),
            RunError::Stopped("stopped (at step 7)".into())
        );
    }
}
