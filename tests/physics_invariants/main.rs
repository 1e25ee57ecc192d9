//! Physics can be believed: what is promised of bodies, beams and arenas, held over random worlds and at the extremes.
//!
//! | file | promise |
//! |---|---|
//! | `motion.rs` | the robot has the speed and the energy that are commanded, and goes the arc of them |
//! | `no_tunnelling.rs` | nothing is driven through, and nothing drives through the robot, at any allowed speed |
//! | `contact.rs` | LIDAR, contact and geometry agree to 1 mm, over a million poses |
//! | `arenas.rs` | arenas never see each other |
//!
//! Truth is worked in f64 without rapier (`random_scenarios.rs`, and `closed_form` of the common helpers). All draws are seeded:
//! each run asks the same. Measured figures: docs/physics.md.

#[path = "../common/mod.rs"]
mod common;
#[allow(dead_code, reason = "these tests need sane worlds only")]
#[path = "../../crates/scenario/tests/scenario_strategies/mod.rs"]
mod scenario_strategies;

mod arenas;
mod contact;
mod motion;
mod no_tunnelling;
mod random_scenarios;
