//! The simulation in the ECS: arenas, bodies, motion and LIDAR.
//!
//! In: a scenario, a number of arenas, a seed ([`spawn_arenas`]); then one action per arena and step. Out: poses and scans.
//!
//! | file | purpose |
//! |---|---|
//! | `arena.rs` | arenas: spawned from a scenario, reset, saved, restored, edited |
//! | `physics.rs` | the interface to bevy_rapier: bodies, physics step |
//! | `colliders.rs` | the rapier shapes of obstacles and of the enclosure |
//! | `robot.rs` | the differential drive |
//! | `contact.rs` | the moment in a step at which the robot first touches something |
//! | `footprint.rs` | the same for a robot that is not a disc |
//! | `obstacles.rs` | moving obstacles as a function of the clock, and generated obstacles |
//! | `lidar.rs` | scans with noise, dropout and latency |
//! | `ray_cast.rs` | exact ranges along the beams |
//! | `four_shapes.rs` | casts against four shapes at once |
//! | `static_shapes.rs` | a grid over the static shapes of large scenarios |
//! | `probe.rs` | scans from arbitrary poses, for displays |

mod arena;
mod colliders;
mod contact;
mod footprint;
mod four_shapes;
pub mod lidar;
mod obstacles;
mod physics;
mod probe;
mod ray_cast;
mod robot;
mod static_shapes;

use bevy::prelude::*;

pub use arena::{
    assign_scenarios, change_scenario, move_goal, move_robot, reset_arenas, reset_with_scenario,
    restart_arenas, restore, snapshot, spawn_arenas,
};
pub use physics::Bodies;
pub use probe::Probe;
pub use robot::{chord_velocity, integrate_heading};

pub(crate) use arena::seed_scenarios;

use crate::control_step::{ControlSet, ControlStep, Reset, ResetSet, SenseSet};

/// Simulates bodies, motion and sensing. [`spawn_arenas`] makes the arenas.
pub(crate) struct SimPlugin;

impl Plugin for SimPlugin {
    fn build(&self, app: &mut App) {
        physics::build(app);
        app.add_systems(
            ControlStep,
            (
                (obstacles::advance, robot::actuate).chain().in_set(ControlSet::Actuate),
                (robot::read_pose, lidar::scan).chain().in_set(SenseSet::Scan),
            ),
        )
        .add_systems(
            Reset,
            (
                (physics::replace_bodies, obstacles::place, robot::place).chain().in_set(ResetSet::Place),
                lidar::scan_after_reset.in_set(ResetSet::Scan),
            ),
        );
    }
}
