//! Limits on the values in a learning configuration, and on the size of a learner's memory and checkpoint.

/// The maximum number of transitions per gradient step.
pub const MAX_BATCH_SIZE: usize = 65_536;
/// The maximum n of n-step returns.
pub const MAX_N_STEP: usize = 100;
/// The maximum number of gradient steps per update.
pub const MAX_GRADIENT_STEPS: u32 = 10_000;
/// The maximum number of quantiles of a return.
pub const MAX_QUANTILES: usize = 200;
/// The maximum learning rate.
pub const MAX_LEARNING_RATE: f32 = 10.0;
/// The maximum `reward_scale`, small enough that scaled rewards and their sums stay finite.
pub const MAX_REWARD_SCALE: f32 = 1e20;
/// The maximum number of transitions in a replay buffer.
pub const MAX_REPLAY_CAPACITY: usize = 1 << 24;
/// The maximum of replay capacity times observation length: 8 GiB of f32 values, or 1 GiB on 32-bit systems. The replay buffer
/// allocates 1/8 more, because an episode of k steps has k + 1 states.
pub const MAX_STORED_FLOATS: usize = if usize::BITS > 32 { 1 << 31 } else { 1 << 28 };
/// The maximum number of parallel environments.
pub const MAX_ENVS: usize = 1 << 16;
/// The maximum size of a checkpoint's header in bytes. A header has four arrays of at most 2^24 f32 values each.
pub const MAX_HEADER_BYTES: u64 = 1 << 29;
/// A bound on every counter in a checkpoint, so that no sum of counters overflows.
pub const MAX_COUNT: u64 = 1 << 62;
