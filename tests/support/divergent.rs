//! A preset that diverges, because it lacks most of what stabilizes deep Q-learning.

/// Replacements in `fast.ron`: no target network, no double Q-learning, squared loss, a high learning rate,
/// and many gradient steps on little data.
pub const DIVERGENT: [(&str, &str); 7] = [
    ("hidden: [64, 64]", "hidden: [256, 256]"),
    ("gamma: 0.95", "gamma: 0.99"),
    ("double: true", "double: false"),
    ("Huber(delta: 1.0)", "MeanSquared"),
    ("Linear(from: 0.0015, to: 0.00001, env_steps: 600000)", "Constant(0.01)"),
    ("gradient_steps: 2", "gradient_steps: 16"),
    ("Soft(tau: 0.01)", "Soft(tau: 1.0)"),
];
