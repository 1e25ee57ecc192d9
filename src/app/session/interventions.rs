//! The hand in the world: a goal, a robot or an obstacle is put elsewhere, between two control steps.
//!
//! In: what the user moves ([`MoveRequest`]). Out: a [`Intervention`], if it can be done, which says the same whenever it is done
//! again; and the world changed by it, with a learner that knows its chains of observations to be broken.

use std::sync::Arc;

use bevy::math::{Vec2, vec2};
use bevy::prelude::World;
use serde::{Deserialize, Serialize};

use crate::agent::{ActionSelection, ActiveLearner};
use crate::app::commands::MoveRequest;
use crate::scenario::{ObstacleMotion, Scenario, clearance, diagnostics, pose_at};
use crate::sim;
use crate::task::{Arena, ArenaLayout, Clock, CurrentScenario};

/// What the hand did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Intervention {
    /// The goal of an arena was put there.
    Goal {
        /// Which arena.
        arena: usize,
        /// Where to, in m.
        to_m: Vec2,
    },
    /// The robot of an arena was put there; its heading stayed.
    Robot {
        /// Which arena.
        arena: usize,
        /// Where to, in m.
        to_m: Vec2,
    },
    /// An obstacle was moved in all arenas: its position at step 0 is this now, and its way is shifted with it.
    Obstacle {
        /// Its number in the scenario.
        index: usize,
        /// Its position at step 0, in m.
        position_m: Vec2,
    },
    /// Another world was taken, from the editor or from its file: all arenas began anew in it.
    World(Box<Scenario>),
}

impl Intervention {
    /// Whether both moved the same thing.
    #[must_use]
    pub fn affects_same_object(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Goal { arena: a, .. }, Self::Goal { arena: b, .. })
            | (Self::Robot { arena: a, .. }, Self::Robot { arena: b, .. })
            | (Self::Obstacle { index: a, .. }, Self::Obstacle { index: b, .. }) => a == b,
            _ => false,
        }
    }
}

/// What `moved` comes to in the world as it stands.
///
/// # Errors
/// It cannot be done, and why: beyond the walls, in what is solid, or, for an obstacle, to where no file could put it.
pub fn resolve(world: &mut World, moved: &MoveRequest) -> Result<Intervention, String> {
    let nowhere = || "there is no such thing".to_string();
    let (MoveRequest::Goal { to_m, .. }
    | MoveRequest::Robot { to_m, .. }
    | MoveRequest::Obstacle { to_m, .. }) = *moved;
    if !(to_m.x.is_finite() && to_m.y.is_finite()) {
        return Err("that is no place".into());
    }
    let scenario = world.resource::<CurrentScenario>().0.clone();
    match *moved {
        MoveRequest::Goal { arena, to_m } => {
            let (room, clock) = room(world, arena).ok_or_else(nowhere)?;
            let room_m = clearance(&room, to_m, clock);
            if room_m > 0.0 {
                Ok(Intervention::Goal { arena, to_m })
            } else {
                Err("something stands there".into())
            }
        }
        MoveRequest::Robot { arena, to_m } => {
            let (room, clock) = room(world, arena).ok_or_else(nowhere)?;
            let room_m = clearance(&room, to_m, clock);
            let free = room_m > scenario.task.collision_range_m;
            if free {
                Ok(Intervention::Robot { arena, to_m })
            } else {
                Err("the robot would collide there".into())
            }
        }
        MoveRequest::Obstacle { arena, index, to_m } => {
            let generated = || "it is drawn anew for every episode".to_string();
            let obstacle = scenario.obstacles.get(index).ok_or_else(generated)?;
            let (_, clock) = room(world, arena).ok_or_else(nowhere)?;
            let (x, y, _) = pose_at(obstacle, clock, scenario.task.control_period_s);
            let position_m = match obstacle.motion {
                ObstacleMotion::Static => to_m,
                _ => vec2(obstacle.position_m.x + to_m.x - x, obstacle.position_m.y + to_m.y - y),
            };
            let changed = with_obstacle_at(&scenario, index, position_m).ok_or_else(nowhere)?;
            match diagnostics(&changed).first() {
                None => Ok(Intervention::Obstacle { index, position_m }),
                Some(finding) if finding.path.starts_with("benchmark_route") => {
                    Err("the benchmark route starts or ends there".into())
                }
                Some(finding) => Err(finding.to_string()),
            }
        }
    }
}

/// Does it.
pub fn apply(world: &mut World, intervention: &Intervention) {
    match intervention {
        Intervention::Goal { arena, to_m } => sim::move_goal(world, *arena, *to_m),
        Intervention::Robot { arena, to_m } => sim::move_robot(world, *arena, *to_m),
        Intervention::World(scenario) => {
            sim::reset_with_scenario(world, &Arc::new(Scenario::clone(scenario)))
        }
        &Intervention::Obstacle { index, position_m } => {
            let changed = with_obstacle_at(&world.resource::<CurrentScenario>().0, index, position_m);
            match changed.map(Arc::new) {
                // What is drawn anew would stand elsewhere, perhaps where a robot is.
                Some(changed) if !changed.generators.is_empty() => sim::reset_with_scenario(world, &changed),
                Some(changed) => sim::change_scenario(world, &changed),
                None => {}
            }
        }
    }
    if *world.resource::<ActionSelection>() == ActionSelection::EpsilonGreedy
        && let Some(mut trainer) = world.get_resource_mut::<ActiveLearner>()
    {
        trainer.0.truncate_trajectories();
    }
}

/// `scenario` with the obstacle `index` at `position_m` at step 0, its way shifted with it.
fn with_obstacle_at(scenario: &Scenario, index: usize, position_m: Vec2) -> Option<Scenario> {
    let mut changed = scenario.clone();
    let obstacle = changed.obstacles.get_mut(index)?;
    let (dx, dy) = (position_m.x - obstacle.position_m.x, position_m.y - obstacle.position_m.y);
    let shift = |point: &mut Vec2| *point = vec2(point.x + dx, point.y + dy);
    match &mut obstacle.motion {
        ObstacleMotion::Static | ObstacleMotion::RandomWalk { .. } => {}
        ObstacleMotion::Orbit { centre_m, .. } => shift(centre_m),
        ObstacleMotion::Patrol { waypoints_m, .. } | ObstacleMotion::BackAndForth { waypoints_m, .. } => {
            waypoints_m.iter_mut().for_each(shift);
        }
    }
    obstacle.position_m = position_m;
    Some(changed)
}

/// The world as it stands in `arena`, and its obstacles' clock.
fn room(world: &mut World, arena: usize) -> Option<(Arc<Scenario>, u64)> {
    let mut arenas = world.query::<(&Arena, &ArenaLayout, &Clock)>();
    let found = arenas.iter(world).find(|(other, ..)| other.0 == arena);
    found.map(|(_, room, clock)| (room.scenario.clone(), clock.0))
}
