//! The limits of a network's size.

/// The maximum number of parameters of a network: 64 MB of f32.
pub const MAX_PARAMETERS: usize = 1 << 24;
/// The maximum number of units of a layer, and of inputs.
pub const MAX_UNITS: usize = 4096;
/// The maximum number of hidden layers.
pub const MAX_LAYERS: usize = 8;
/// The maximum number of actions. Replay buffers store an action in one byte.
pub const MAX_ACTIONS: usize = 255;
