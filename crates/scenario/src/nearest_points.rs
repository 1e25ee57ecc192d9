//! The nearest points of walls and static obstacles, for pedestrians and robots that avoid them by ORCA.

use super::geometry::{enclosure_distance, inner_wall_distance, shape_distance};
use super::motion::pose_at;
use super::schema::{Obstacle, ObstacleMotion, Scenario, Wall};
use glam::{Vec2, vec2};

/// Margin in m for the rounding of distances.
const MARGIN_M: f32 = 0.01;

/// The point nearest to `at_m` of each wall segment, static obstacle and side of the enclosure that is within `reach_m`. Sides
/// count only if `at_m` is inside the enclosure.
#[must_use]
pub fn nearest_points(scenario: &Scenario, at_m: Vec2, reach_m: f32) -> Vec<Vec2> {
    let period_s = scenario.task.control_period_s;
    let is_near = |obstacle: &&Obstacle| {
        let around_m = obstacle.shape.bounding_radius_m() + reach_m + MARGIN_M;
        obstacle.motion == ObstacleMotion::Static
            && (obstacle.position_m - at_m).length_squared() <= around_m * around_m
    };
    let obstacles = scenario.obstacles.iter().filter(is_near).cloned();
    let walls = scenario.walls.iter();
    let walls = walls.filter(|wall| inner_wall_distance(wall, at_m) <= reach_m + MARGIN_M);
    let of_solid = |obstacle: Obstacle| {
        let pose = pose_at(&obstacle, 0, period_s);
        nearest_point(at_m, reach_m, |point| shape_distance(&obstacle.shape, pose, point))
    };
    let corners = scenario.enclosure.corners_m();
    let sides = corners.iter().zip(corners.iter().cycle().skip(1)).filter_map(|(&from, &to)| {
        let nearest = nearest_on_segment(from, to, at_m);
        ((nearest - at_m).length() <= reach_m).then_some(nearest)
    });
    let inside = enclosure_distance(&scenario.enclosure, at_m) > 0.0;
    let solids = obstacles.chain(walls.flat_map(Wall::pieces));
    solids.filter_map(of_solid).chain(sides.filter(|_| inside)).collect()
}

/// The point of a convex solid nearest to `at_m`, from the signed `distance` to the solid and its gradient. `None` if it is
/// farther than `reach_m`.
fn nearest_point(at_m: Vec2, reach_m: f32, distance: impl Fn(Vec2) -> f32) -> Option<Vec2> {
    const STEP_M: f32 = 1e-3;
    let away_m = distance(at_m);
    if away_m > reach_m {
        return None;
    }
    let slope = |step: Vec2| distance(at_m + step) - distance(at_m - step);
    let outwards = vec2(slope(Vec2::X * STEP_M), slope(Vec2::Y * STEP_M)).normalize_or_zero();
    Some(at_m - outwards * away_m.max(0.0))
}

fn nearest_on_segment(from: Vec2, to: Vec2, point: Vec2) -> Vec2 {
    let along = to - from;
    let fraction = (point - from).dot(along) / along.length_squared().max(f32::MIN_POSITIVE);
    from + along * fraction.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Shape;

    #[test]
    fn the_nearest_points_of_walls_and_obstacles_are_those_worked_out_by_hand() {
        let scenario = Scenario {
            walls: vec![Wall {
                corners_m: vec![vec2(-1.0, -1.0), vec2(1.0, -1.0)],
                thickness_m: 0.2,
                ..Wall::default()
            }],
            obstacles: vec![Obstacle {
                shape: Shape::Circle { radius_m: 0.2 },
                position_m: vec2(0.6, 0.8),
                rotation_rad: 0.0,
                motion: ObstacleMotion::Static,
            }],
            ..Scenario::default()
        };
        let points = nearest_points(&scenario, Vec2::ZERO, 1.5);
        let expected = [vec2(0.48, 0.64), vec2(0.0, -0.9)];
        assert_eq!(points.len(), 2, "the enclosure is 2 m away: {points:?}");
        for (point, expected) in points.iter().zip(expected) {
            assert!((*point - expected).length() < 2e-3, "{point}, not {expected}");
        }
    }
}
