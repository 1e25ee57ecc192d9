//! Invariants of the physics, tested in random scenarios and at the limits of all parameters.
//!
//! | file | invariant |
//! |---|---|
//! | `motion.rs` | the robot has the commanded speed and energy, and drives along the commanded arc |
//! | `no_tunnelling.rs` | the robot passes through no wall or obstacle, and no obstacle through it, at any allowed speed |
//! | `contact.rs` | LIDAR, contact and geometry agree to 1 mm, in a million random poses |
//! | `arenas.rs` | arenas do not influence each other |
//!
//! Reference values are computed in f64 without rapier (`random_scenarios.rs`, and `closed_form` in `tests/common`). All
//! draws are seeded, so every run tests the same cases. For the measured errors, see docs/physics.md.

#[path = "../common/mod.rs"]
mod common;
#[allow(dead_code, reason = "these tests use valid scenarios only")]
#[path = "../../crates/scenario/tests/scenario_strategies/mod.rs"]
mod scenario_strategies;

mod arenas;
mod contact;
mod motion;
mod no_tunnelling;
mod random_scenarios;
