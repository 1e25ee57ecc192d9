//! Moving objects by hand: what can be moved, and where it may go.
//!
//! In: an arena and the requested position. Out: `Ok`, or the reason why the object cannot go there. The screen asks while
//! an object is dragged; the session asks again before it moves the object.

use std::fmt;

use bevy::math::{Vec2, vec2};
use serde::{Deserialize, Serialize};

use crate::scenario::{
    Obstacle, ObstacleMotion, Scenario, diagnostics, enclosure_distance, inner_wall_distance, shape_distance,
};

/// Position (x in m, y in m) and rotation in rad of an obstacle.
pub type ObstaclePose = (f32, f32, f32);

/// An object that can be moved by hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Movable {
    /// The goal of one arena.
    Goal,
    /// The robot of one arena. Its heading does not change.
    Robot,
    /// An obstacle, by its index in the scenario. It moves in every arena, because the scenario itself changes.
    Obstacle(usize),
}

/// The object's name on the screen. Obstacles are numbered from 1.
impl fmt::Display for Movable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Goal => f.write_str("Goal"),
            Self::Robot => f.write_str("Robot"),
            Self::Obstacle(index) => write!(f, "Obstacle {}", index + 1),
        }
    }
}

/// A request to move an object, in the coordinates of the arena where the user sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoveRequest {
    /// Index of the arena.
    pub arena: usize,
    /// The object.
    pub object: Movable,
    /// Requested position of the object's centre, in m.
    pub to_m: Vec2,
}

/// The parts of an arena that decide where an object may go.
#[derive(Clone, Copy, Debug)]
pub struct MoveContext<'a> {
    /// The scenario as it would be saved, without generated obstacles.
    pub scenario: &'a Scenario,
    /// The scenario as it is laid out in this arena, with generated obstacles.
    pub layout: &'a Scenario,
    /// Current pose of each obstacle of `layout`.
    pub obstacles: &'a [ObstaclePose],
    /// Position of the robot, in m.
    pub robot_m: Vec2,
    /// Position of the goal, in m.
    pub goal_m: Vec2,
}

/// The reason why an object cannot be moved to a position.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MoveRejection {
    /// The position lies outside the enclosure, or is not finite.
    #[error("Outside the walls")]
    OutsideWalls,
    /// A goal would lie in an inner wall.
    #[error("Inside a wall")]
    InsideWall,
    /// A goal would lie in an obstacle.
    #[error("Inside an obstacle")]
    InsideObstacle,
    /// A robot would collide with a wall.
    #[error("Too close to a wall")]
    TooCloseToWall,
    /// A robot would collide with an obstacle.
    #[error("Too close to an obstacle")]
    TooCloseToObstacle,
    /// An obstacle would collide with the robot.
    #[error("Too close to the robot")]
    TooCloseToRobot,
    /// An obstacle would cover the goal.
    #[error("Covers the goal")]
    CoversGoal,
    /// An obstacle would cover the start or the goal of the benchmark route.
    #[error("Blocks the benchmark route")]
    BlocksBenchmarkRoute,
    /// There is no such arena or obstacle, or the obstacle is generated for each episode or belongs to a set of scenarios.
    #[error("This object cannot be moved")]
    NotMovable,
    /// The scenario would become invalid for another reason, which the diagnostic states.
    #[error("{0}")]
    InvalidScenario(String),
}

/// Checks whether `object` may be moved to `to_m`.
///
/// # Errors
/// The reason why the object may not be moved there.
pub fn check_move(arena: &MoveContext<'_>, object: Movable, to_m: Vec2) -> Result<(), MoveRejection> {
    let enclosure_m = enclosure_distance(&arena.layout.enclosure, to_m);
    if !(to_m.x.is_finite() && to_m.y.is_finite() && enclosure_m > 0.0) {
        return Err(MoveRejection::OutsideWalls);
    }
    let keep_out_m = arena.layout.keep_out_m();
    match object {
        Movable::Goal if obstacle_gap(arena, to_m) <= 0.0 => Err(MoveRejection::InsideObstacle),
        Movable::Goal if inner_wall_gap(arena, to_m) <= 0.0 => Err(MoveRejection::InsideWall),
        Movable::Robot if enclosure_m.min(inner_wall_gap(arena, to_m)) <= keep_out_m => {
            Err(MoveRejection::TooCloseToWall)
        }
        Movable::Robot if obstacle_gap(arena, to_m) <= keep_out_m => Err(MoveRejection::TooCloseToObstacle),
        Movable::Goal | Movable::Robot => Ok(()),
        Movable::Obstacle(index) => check_obstacle(arena, index, to_m),
    }
}

/// Distance in m from `point_m` to the nearest obstacle; negative inside one.
fn obstacle_gap(arena: &MoveContext<'_>, point_m: Vec2) -> f32 {
    let obstacles = arena.layout.obstacles.iter().zip(arena.obstacles);
    obstacles.map(|(o, &pose)| shape_distance(&o.shape, pose, point_m)).fold(f32::INFINITY, f32::min)
}

/// Distance in m from `point_m` to the nearest inner wall; negative inside one.
fn inner_wall_gap(arena: &MoveContext<'_>, point_m: Vec2) -> f32 {
    let walls = arena.layout.walls.iter().map(|wall| inner_wall_distance(wall, point_m));
    walls.fold(f32::INFINITY, f32::min)
}

fn check_obstacle(arena: &MoveContext<'_>, index: usize, to_m: Vec2) -> Result<(), MoveRejection> {
    let (Some(obstacle), Some(&pose)) = (arena.scenario.obstacles.get(index), arena.obstacles.get(index))
    else {
        return Err(MoveRejection::NotMovable);
    };
    let gap_to = |point_m| shape_distance(&obstacle.shape, (to_m.x, to_m.y, pose.2), point_m);
    if gap_to(arena.robot_m) <= arena.layout.keep_out_m() {
        return Err(MoveRejection::TooCloseToRobot);
    }
    if gap_to(arena.goal_m) <= 0.0 {
        return Err(MoveRejection::CoversGoal);
    }
    let moved = with_obstacle_at(arena.scenario, index, initial_position(obstacle, pose, to_m));
    let Some(moved) = moved else { return Ok(()) };
    match diagnostics(&moved).into_iter().next() {
        Some(found) if found.path.starts_with("benchmark_route") => Err(MoveRejection::BlocksBenchmarkRoute),
        Some(found) => Err(MoveRejection::InvalidScenario(found.to_string())),
        None => Ok(()),
    }
}

/// The position in m at step 0 with which `obstacle` would be at `to_m` instead of at its current `pose`.
#[must_use]
pub fn initial_position(obstacle: &Obstacle, pose: ObstaclePose, to_m: Vec2) -> Vec2 {
    match obstacle.motion {
        ObstacleMotion::Static => to_m,
        _ => vec2(obstacle.position_m.x + to_m.x - pose.0, obstacle.position_m.y + to_m.y - pose.1),
    }
}

/// `scenario` with obstacle `index` at `position_m` at step 0. Its path moves with it. `None` if there is no such obstacle.
#[must_use]
pub fn with_obstacle_at(scenario: &Scenario, index: usize, position_m: Vec2) -> Option<Scenario> {
    let mut changed = scenario.clone();
    let obstacle = changed.obstacles.get_mut(index)?;
    obstacle.motion.translate(position_m - obstacle.position_m);
    obstacle.position_m = position_m;
    Some(changed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{BenchmarkRoute, Shape, Wall};

    const TURNED_RAD: f32 = std::f32::consts::FRAC_PI_2;

    fn scenario() -> Scenario {
        let shape = Shape::Rectangle { width_m: 1.0, height_m: 0.2 };
        let obstacle = Obstacle {
            shape,
            position_m: vec2(1.0, 1.0),
            rotation_rad: TURNED_RAD,
            motion: ObstacleMotion::Static,
        };
        let wall =
            Wall { corners_m: vec![vec2(-2.0, -1.5), vec2(0.0, -1.5)], thickness_m: 0.2, ..Wall::default() };
        Scenario { obstacles: vec![obstacle], walls: vec![wall], ..Scenario::default() }
    }

    fn check(object: Movable, to_m: Vec2) -> Result<(), MoveRejection> {
        let scenario = scenario();
        let obstacles = [(1.0, 1.0, TURNED_RAD)];
        let arena = MoveContext {
            scenario: &scenario,
            layout: &scenario,
            obstacles: &obstacles,
            robot_m: vec2(0.0, 0.0),
            goal_m: vec2(-1.0, 0.0),
        };
        check_move(&arena, object, to_m)
    }

    #[test]
    fn a_goal_stays_out_of_walls_and_obstacles() {
        for (to_m, expected) in [
            (vec2(1.2, 1.0), Ok(())),
            (vec2(-1.0, -1.35), Ok(())),
            (vec2(1.0, 1.4), Err(MoveRejection::InsideObstacle)),
            (vec2(-1.0, -1.45), Err(MoveRejection::InsideWall)),
            (vec2(2.1, 0.0), Err(MoveRejection::OutsideWalls)),
        ] {
            assert_eq!(check(Movable::Goal, to_m), expected, "{to_m:?}");
        }
    }

    #[test]
    fn a_robot_is_not_put_where_it_would_collide() {
        for (to_m, expected) in [
            (vec2(1.3, 1.0), Ok(())),
            (vec2(-1.0, -1.25), Ok(())),
            (vec2(1.2, 1.0), Err(MoveRejection::TooCloseToObstacle)),
            (vec2(1.9, 0.0), Err(MoveRejection::TooCloseToWall)),
            (vec2(-1.0, -1.35), Err(MoveRejection::TooCloseToWall)),
            (vec2(f32::NAN, 0.0), Err(MoveRejection::OutsideWalls)),
        ] {
            assert_eq!(check(Movable::Robot, to_m), expected, "{to_m:?}");
        }
    }

    #[test]
    fn an_obstacle_stays_off_the_robot_and_the_goal() {
        for (index, to_m, expected) in [
            (0, vec2(0.5, 0.0), Ok(())),
            (0, vec2(0.2, 0.0), Err(MoveRejection::TooCloseToRobot)),
            (0, vec2(-1.0, 0.2), Err(MoveRejection::CoversGoal)),
            (1, vec2(0.5, 0.0), Err(MoveRejection::NotMovable)),
        ] {
            assert_eq!(check(Movable::Obstacle(index), to_m), expected, "{index}, {to_m:?}");
        }
    }

    #[test]
    fn an_obstacle_stays_off_the_benchmark_route() {
        let with_route = Scenario { benchmark_route: Some(BenchmarkRoute::default()), ..scenario() };
        let free = with_obstacle_at(&with_route, 0, vec2(-1.0, 1.0)).expect("there is one");
        let arena = MoveContext {
            scenario: &free,
            layout: &free,
            obstacles: &[(-1.0, 1.0, TURNED_RAD)],
            robot_m: vec2(0.0, 0.0),
            goal_m: vec2(-1.0, 0.0),
        };
        let onto_its_goal = check_move(&arena, Movable::Obstacle(0), vec2(1.2, 0.8));
        assert_eq!(onto_its_goal, Err(MoveRejection::BlocksBenchmarkRoute));
        assert_eq!(check(Movable::Obstacle(0), vec2(1.2, 0.8)), Ok(()), "without a route");
    }
}
