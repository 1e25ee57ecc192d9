//! The limits of a policy file.

/// The maximum number of parameters of a network: 64 MiB of f32.
pub const MAX_PARAMETERS: usize = 1 << 24;
/// The maximum number of units in a layer, and of inputs.
pub const MAX_UNITS: usize = 4096;
/// The maximum number of hidden layers.
pub const MAX_LAYERS: usize = 8;
/// The maximum number of actions. Replay buffers store an action in one byte.
pub const MAX_ACTIONS: usize = 255;
/// The maximum size of a policy's header with its card, in bytes. The scenario in the card can be larger than a scenario file
/// (at most 1 MiB), because every default is written out.
pub const MAX_HEADER_BYTES: usize = 1 << 24;
