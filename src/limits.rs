//! The limits of presets, experiments, run folders and checkpoints.
//!
//! Every number in a user's file or on the command line is checked against its limit before it is used, so that no input
//! can exhaust the memory or overflow a sum. Each limit is defined once, in the lowest crate that checks it:
//!
//! | file | limits of |
//! |---|---|
//! | `crates/scenario/src/limits.rs` | RON files, scenarios, level generators |
//! | `crates/policy/src/limits.rs` | networks |
//! | `crates/learning/src/limits.rs` | learning configurations, replay buffers, learner checkpoints |
//! | `crates/import/src/limits.rs` | imported maps and worlds |
//! | this one | presets, run folders, policy files, checkpoints |
//! | `limits/experiment.rs` | experiments |
//! | `limits/table.rs` | all of these: the tables in `docs/trust.md`, and a test that none is missing |

pub mod experiment;
#[cfg(test)]
mod table;

/// Maximum number of parallel arenas.
pub const MAX_ARENAS: usize = 4096;

/// Maximum number of env steps or episodes in a budget or an interval. No run is that long, and sums of such counts stay far
/// below the maximum of a `u64`.
pub const MAX_STEPS: u64 = 1_000_000_000_000_000;

/// Maximum number of episodes in an evaluation during training.
pub const MAX_EVALUATION_EPISODES: usize = 100_000;

/// Maximum number of episodes in one `--eval`, over all rounds.
pub const MAX_EVAL_EPISODES: u64 = 1_000_000;

/// Maximum size in bytes of the results of a test (`--eval --json`), which list the success rate of every round.
pub const MAX_EVAL_RESULTS_BYTES: u64 = 1 << 25;

/// Maximum width and height of an image, in pixels.
pub const MAX_IMAGE_SIDE: u16 = 8192;

/// Maximum number of levels on a contact sheet.
pub const MAX_SHEET_LEVELS: u64 = 100;

/// Maximum number of characters in a preset's `about`.
pub const MAX_ABOUT_CHARS: usize = 20_000;

/// Maximum number of bodies (robots, obstacles, straight wall segments) in all arenas together. They take about 2 GB.
pub const MAX_BODIES: usize = 1_000_000;

/// Maximum number of floats in the scans and observations of all arenas together: 1 GiB.
pub const MAX_OBSERVED_FLOATS: usize = 1 << 28;

/// Maximum number of levels of a set whose levels are drawn by learning progress. Training keeps the results of each level, which
/// takes 100 MB.
pub const MAX_LEVELS_BY_PROGRESS: usize = 4_000_000;

/// Maximum size of `config.ron` in bytes. (A scenario of 1 MiB grows when every default is written out.)
pub const MAX_CONFIG_BYTES: u64 = 1 << 24;

/// Maximum size of a policy file in bytes: 2^24 parameters and a header.
pub const MAX_POLICY_BYTES: u64 = 1 << 27;

/// Maximum size in bytes of the run's header in a checkpoint: [`MAX_OBSERVED_FLOATS`] and a policy.
pub const MAX_HEAD_BYTES: u64 = (1 << 30) + (1 << 27);

/// Maximum number of recent returns in a checkpoint, over which the progress display averages.
pub const MAX_RECENT_RETURNS: usize = 100;

/// Maximum time in a checkpoint in s, about 30,000 years.
pub const MAX_TIME_S: f64 = 1e12;

/// Maximum size in bytes of the journal of interventions, the user's changes during training. It contains every scenario that
/// training was switched to.
pub const MAX_JOURNAL_BYTES: u64 = 1 << 28;

/// Maximum absolute value of a reward parameter. With it, potentials over a kilometre and sums of rewards are finite.
pub const MAX_REWARD_PARAMETER: f32 = 1e9;
