//! Interventions: changes to a training run, made between two control steps.
//!
//! In: a [`MoveRequest`], or another scenario. Out: an [`Intervention`] that has the same effect whenever it is replayed, and
//! the world changed by it. It truncates the learner's trajectories, because the next observation does not follow from
//! the last action.

use std::sync::Arc;

use bevy::math::{Vec2, vec2};
use bevy::prelude::World;
use serde::{Deserialize, Serialize};

use crate::agent::{ActionSelection, ActiveLearner};
use crate::app::moves::{
    Movable, MoveContext, MoveRejection, MoveRequest, ObstaclePose, check_move, initial_position,
    with_obstacle_at,
};
use crate::scenario::{Obstacle, ObstacleMotion, Scenario};
use crate::sim;
use crate::task::{Arena, ArenaLayout, Clock, CurrentScenario, Goal, Pedestrians, Pose, ScenarioPool};

/// A change to a training run while it runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Intervention {
    /// An object was moved.
    Move {
        /// Index of the arena. An obstacle moves in all of them.
        arena: usize,
        /// The object.
        object: Movable,
        /// The object's new position in m; for an obstacle, the position at step 0.
        to_m: Vec2,
    },
    /// Another scenario was adopted from the editor or from its file. Every arena began a new episode.
    Scenario(Box<Scenario>),
}

impl Intervention {
    /// Whether it changed the training run's scenario, not only one arena.
    #[must_use]
    pub fn changes_scenario(&self) -> bool {
        matches!(self, Self::Scenario(_) | Self::Move { object: Movable::Obstacle(_), .. })
    }

    /// Whether both moved the same object.
    #[must_use]
    pub fn affects_same_object(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Move { arena: a, object, .. }, Self::Move { arena: b, object: moved, .. }) => {
                object == moved && (a == b || matches!(object, Movable::Obstacle(_)))
            }
            _ => false,
        }
    }

    /// Whether only the last of several moves of this object between two control steps has an effect, if every LIDAR is exact.
    /// False for an obstacle of a scenario with generators, because each move begins new episodes, and for a moving obstacle,
    /// because each move shifts its path by an offset and rounding errors add up.
    #[must_use]
    pub fn overrides_earlier(&self, scenario: &Scenario) -> bool {
        let &Self::Move { object: Movable::Obstacle(index), .. } = self else { return true };
        let is_static = |obstacle: &Obstacle| matches!(obstacle.motion, ObstacleMotion::Static);
        scenario.generators.is_empty() && scenario.obstacles.get(index).is_some_and(is_static)
    }
}

/// The intervention that carries out `request` in the current state of `world`.
///
/// # Errors
/// The reason why the object cannot be moved there.
pub fn resolve(world: &mut World, request: &MoveRequest) -> Result<Intervention, MoveRejection> {
    let &MoveRequest { arena, object, to_m } = request;
    if matches!(object, Movable::Obstacle(_)) && world.contains_resource::<ScenarioPool>() {
        return Err(MoveRejection::NotMovable);
    }
    let mut arenas = world.query::<(&Arena, (&ArenaLayout, &Pedestrians), &Clock, &Pose, &Goal)>();
    let found = arenas.iter(world).find(|(other, ..)| other.0 == arena);
    let (_, (layout, pedestrians), clock, robot, goal) = found.ok_or(MoveRejection::NotMovable)?;
    let indexed = layout.indexed(pedestrians);
    let (scenario, layout) = (&*layout.written, &*layout.scenario);
    let obstacles: Vec<ObstaclePose> =
        (0..layout.obstacles.len()).map(|index| indexed.pose_at(index, clock.0)).collect();
    let view = MoveContext {
        scenario,
        layout,
        obstacles: &obstacles,
        robot_m: vec2(robot.x_m, robot.y_m),
        goal_m: vec2(goal.x_m, goal.y_m),
    };
    check_move(&view, object, to_m)?;
    let to_m = match object {
        Movable::Goal | Movable::Robot => to_m,
        Movable::Obstacle(index) => initial_position(&scenario.obstacles[index], obstacles[index], to_m),
    };
    Ok(Intervention::Move { arena, object, to_m })
}

/// Applies `intervention` to the world. An arena or obstacle that does not exist is ignored.
pub fn apply(world: &mut World, intervention: &Intervention) {
    match intervention {
        &Intervention::Move { arena, object, to_m } => match object {
            Movable::Goal => sim::move_goal(world, arena, to_m),
            Movable::Robot => sim::move_robot(world, arena, to_m),
            Movable::Obstacle(index) => move_obstacle(world, index, to_m),
        },
        Intervention::Scenario(scenario) => {
            sim::reset_with_scenario(world, &Arc::new(Scenario::clone(scenario)));
        }
    }
    if *world.resource::<ActionSelection>() == ActionSelection::EpsilonGreedy
        && let Some(mut learner) = world.get_resource_mut::<ActiveLearner>()
    {
        learner.0.truncate_trajectories();
    }
}

/// Moves an obstacle in all arenas; `position_m` is its position at step 0.
fn move_obstacle(world: &mut World, index: usize, position_m: Vec2) {
    let changed = with_obstacle_at(&world.resource::<CurrentScenario>().0, index, position_m);
    let Some(changed) = changed.map(Arc::new) else { return };
    if changed.generators.is_empty() {
        sim::change_scenario(world, &changed);
    } else {
        // Generated obstacles would get other positions, perhaps on a robot: every arena begins a new episode.
        sim::reset_with_scenario(world, &changed);
    }
}
