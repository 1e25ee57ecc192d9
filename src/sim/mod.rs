//! The world alive: arenas, bodies, motion and LIDAR in the ECS.
//!
//! In: a scenario, a number of arenas, a seed ([`spawn_arenas`]); then actions, step by step. Out: poses and scans.
//!
//! | file | duty |
//! |---|---|
//! | `arena.rs` | arenas spawned from a scenario, saved and restored, changed by hand |
//! | `physics.rs` | everything of bevy_rapier: its plugin, its bodies, a step |
//! | `robot.rs` | the differential drive and its lag |
//! | `contact.rs` | when in a step the robot first touches something |
//! | `obstacles.rs` | moving obstacles as a function of the step count |
//! | `lidar.rs` | the scan |
//! | `probe.rs` | what a robot would see that stood elsewhere |

mod arena;
mod contact;
pub mod lidar;
mod obstacles;
mod physics;
mod probe;
mod robot;

use bevy::prelude::*;

pub use arena::{
    change_scenario, move_goal, move_robot, reset_arenas, reset_with_scenario, restore, snapshot,
    spawn_arenas,
};
pub use physics::Bodies;
pub use probe::Probe;
pub use robot::{ActuatorLag, chord_velocity, integrate_heading};

use crate::control_step::{ControlSet, ControlStep, Reset, ResetSet, SenseSet};

/// Responsible for bodies, motion and sensing. Arenas come with [`spawn_arenas`].
pub struct SimPlugin;

impl Plugin for SimPlugin {
    fn build(&self, app: &mut App) {
        physics::build(app);
        app.init_resource::<lidar::BeamDirections>()
            .add_systems(
                ControlStep,
                (
                    (obstacles::advance, robot::actuate).chain().in_set(ControlSet::Actuate),
                    (robot::read_pose, lidar::scan).chain().in_set(SenseSet::Scan),
                ),
            )
            .add_systems(
                Reset,
                (
                    (obstacles::place, robot::place).chain().in_set(ResetSet::Place),
                    lidar::scan_after_reset.in_set(ResetSet::Scan),
                ),
            );
    }
}
