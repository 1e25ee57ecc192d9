//! The defaults of the fields of enum variants, for serde.

use super::Schedule;

/// The error at which PyTorch's Huber loss becomes linear; alpha of algorithm 1; epsilon in the first episode of eq. (10).
pub(super) fn one() -> f32 {
    1.0
}

/// PyTorch's smoothing constant of RMSProp; the decay of epsilon in eq. (10).
pub(super) fn decay() -> f32 {
    0.99
}

/// PyTorch's beta1 of Adam.
pub(super) fn beta1() -> f32 {
    0.9
}

/// PyTorch's beta2 of Adam.
pub(super) fn beta2() -> f32 {
    0.999
}

/// PyTorch's epsilon of RMSProp and Adam.
pub(super) fn optimizer_epsilon() -> f32 {
    1e-8
}

/// The beta of prioritized replay: 0, with which all importance weights are 1.
pub(super) fn beta() -> Schedule {
    Schedule::Constant(0.0)
}

/// The constant added to |TD error| in a priority.
pub(super) fn priority_epsilon() -> f32 {
    0.01
}

/// The gradient steps between two copies of the weights to the target network (Table 1).
pub(super) fn copy_interval() -> u64 {
    2000
}

/// The minimum of epsilon in eq. (10).
pub(super) fn least_epsilon() -> f32 {
    0.05
}
