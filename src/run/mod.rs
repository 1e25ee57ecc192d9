//! What a user does without a window: train, evaluate, transfer, resume.
//!
//! In: a scenario, a preset, a seed (or a run's folder, or a policy). Out: run folders, results, progress.
//!
//! | file | duty |
//! |---|---|
//! | `preset.rs` | how to learn: the file of all switches and numbers |
//! | `check_files.rs` | whether scenarios and presets can be used, without using them |
//! | `shipped.rs` | the scenarios, presets and policies that come with the program, by name |
//! | `training_setup.rs` | what a training starts with |
//! | `train.rs` | the training loop: step, record, evaluate, keep the best, stop |
//! | `metrics.rs` | what is noted of a training as it goes on: rows, the best policy |
//! | `evaluate.rs` | success over rounds of episodes, and the benchmark route |
//! | `background_evaluator.rs` | evaluation during training, on a thread of its own (in a browser, in slices) |
//! | `optimum/` | the least time that any policy could need |
//! | `folder.rs` | a run's folder: what is written where, whole or not at all |
//! | `lock.rs` | one process at a time in a folder |
//! | `metric_rows.rs`, `metrics_writer.rs` | the rows of `episodes.csv` and `evaluations.csv`, and who writes them |
//! | `policy_card.rs` | what the user of a policy needs to know |
//! | `checkpoint.rs` | everything that a run needs to go on to the bit |
//! | `fingerprint.rs` | whether two builds simulate alike to the bit |
//! | `scenario_image.rs` | a world from above, as an SVG or PNG |
//! | `tensorboard.rs`, `progress.rs` | the same rows for TensorBoard, and for whoever waits |

pub mod background_evaluator;
#[cfg(not(target_arch = "wasm32"))]
pub mod check_files;
pub mod checkpoint;
pub mod evaluate;
pub mod fingerprint;
pub mod folder;
pub mod limits;
#[cfg(not(target_arch = "wasm32"))]
pub mod lock;
pub mod memory;
pub mod metric_rows;
pub mod metrics;
#[cfg(not(target_arch = "wasm32"))]
pub mod metrics_writer;
pub mod policy_card;
pub mod preset;
#[cfg(not(target_arch = "wasm32"))]
pub mod progress;
#[cfg(not(target_arch = "wasm32"))]
pub mod scenario_image;
pub mod shipped;
#[cfg(not(target_arch = "wasm32"))]
pub mod tensorboard;
#[cfg(not(target_arch = "wasm32"))]
pub mod train;
pub mod training_setup;

/// Why a command could not do what it was asked.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RunError {
    /// Arguments or files that cannot be used: nothing was begun. Exit status 2.
    #[error("{0}")]
    InvalidInput(String),
    /// The work itself failed. Exit status 1.
    #[error("{0}")]
    Failed(String),
}

impl RunError {
    /// The process's exit status.
    #[must_use]
    pub fn exit_status(&self) -> u8 {
        match self {
            Self::InvalidInput(_) => 2,
            Self::Failed(_) => 1,
        }
    }

    /// A file that cannot be used, and why.
    pub(crate) fn invalid_input(path: &std::path::Path, why: impl std::fmt::Display) -> Self {
        Self::InvalidInput(format!("{}: {why}", path.display()))
    }

    /// A file that could not be written while at work, and why.
    pub(crate) fn failed(path: &std::path::Path, why: impl std::fmt::Display) -> Self {
        Self::Failed(format!("{}: {why}", path.display()))
    }
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
