//! The limits of an experiment's file: numbers of entries, lengths of texts, and the number of training runs.

/// Maximum number of seeds, and of finished runs that an arm names, one for each seed.
pub const MAX_SEEDS: u64 = 1000;
/// Maximum number of arms, conditions, figures, tables or claims, and of entries in one of their lists.
pub const MAX_ENTRIES: usize = 200;
/// Maximum number of panels in a figure.
pub const MAX_SERIES: usize = 10;
/// Maximum number of columns in a figure or table.
pub const MAX_MEASURES: usize = 20;
/// Maximum number of rounds of a test, and of the paper's values for an arm in a table, one per round.
pub const MAX_ROUNDS: usize = 1000;
/// Maximum number of episodes per round of a test.
pub const MAX_TEST_EPISODES: u64 = 10_000;
/// Maximum width of the moving average in a figure, in episodes.
pub const MAX_SMOOTHING: u64 = 10_000;
/// Maximum number of stages of an arm.
pub const MAX_STAGES: usize = 20;
/// Maximum number of training runs. A larger plan would not finish.
pub const MAX_TRAINING_RUNS: u64 = 10_000;
/// Maximum number of characters in a name or heading.
pub const MAX_NAME_CHARS: usize = 200;
/// Maximum number of characters in a path.
pub const MAX_PATH_CHARS: usize = 4096;
/// Maximum number of characters in a text.
pub const MAX_TEXT_CHARS: usize = 20_000;
/// Maximum absolute value of a number in a figure or table.
pub const MAX_VALUE: f64 = 1e9;
