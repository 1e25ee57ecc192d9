//! How far a point is from the walls and the obstacles.
//!
//! In: a [`Scenario`], a point, a step. Out: signed distances, positive in the open. f32 by plain arithmetic
//! and `libm`, so that what is drawn by them is the same on every platform.

use super::motion::pose_at;
use super::schema::{Enclosure, Obstacle, Scenario, Shape};

/// The distance, in m, from `point_m` to the nearest surface of an obstacle (where it is at `step`) or of a
/// wall; negative inside an obstacle or outside the enclosure.
#[must_use]
pub fn clearance(scenario: &Scenario, point_m: (f32, f32), step: u64) -> f32 {
    let to_wall = wall_distance(&scenario.enclosure, point_m);
    let period = scenario.task.control_period_s;
    scenario.obstacles.iter().map(|o| obstacle_distance(o, point_m, step, period)).fold(to_wall, f32::min)
}

/// Whether `point_m` is at least `clearance_m` from everything: [`clearance`] with an early end.
pub(super) fn is_clear(scenario: &Scenario, point_m: (f32, f32), step: u64, clearance_m: f32) -> bool {
    let period = scenario.task.control_period_s;
    wall_distance(&scenario.enclosure, point_m) >= clearance_m
        && scenario.obstacles.iter().all(|o| obstacle_distance(o, point_m, step, period) >= clearance_m)
}

/// From a point to the nearest wall, in m, negative beyond it.
#[must_use]
pub fn wall_distance(enclosure: &Enclosure, (x, y): (f32, f32)) -> f32 {
    let Enclosure::Rectangle { width_m, height_m } = enclosure;
    (width_m / 2.0 - x.abs()).min(height_m / 2.0 - y.abs())
}

fn obstacle_distance(obstacle: &Obstacle, point: (f32, f32), step: u64, control_period_s: f32) -> f32 {
    shape_distance(&obstacle.shape, pose_at(obstacle, step, control_period_s), point)
}

/// From a point to the surface of a shape at a pose (x in m, y in m, rotation in rad), in m, negative inside it.
#[must_use]
pub fn shape_distance(shape: &Shape, pose: (f32, f32, f32), point: (f32, f32)) -> f32 {
    let (dx, dy) = (point.0 - pose.0, point.1 - pose.1);
    match shape {
        Shape::Circle { radius_m } => length(dx, dy) - radius_m,
        Shape::Rectangle { width_m, height_m } => {
            let (sin, cos) = libm::sincosf(pose.2);
            // In the box's own frame, folded into its first quadrant, measured from its corner.
            let past_x = (dx * cos + dy * sin).abs() - width_m / 2.0;
            let past_y = (dy * cos - dx * sin).abs() - height_m / 2.0;
            length(past_x.max(0.0), past_y.max(0.0)) + past_x.max(past_y).min(0.0)
        }
    }
}

/// The half extents of a shape's bounding box along x and y when it is turned by `rotation_rad`.
pub(super) fn half_extents(shape: &Shape, rotation_rad: f32) -> (f32, f32) {
    match shape {
        Shape::Circle { radius_m } => (*radius_m, *radius_m),
        Shape::Rectangle { width_m, height_m } => {
            let (sin, cos) = libm::sincosf(rotation_rad);
            let (w, h) = (width_m / 2.0, height_m / 2.0);
            (w * cos.abs() + h * sin.abs(), w * sin.abs() + h * cos.abs())
        }
    }
}

/// The distance from `centre_m` to the farthest point of an obstacle at step 0.
pub(super) fn reach_from(obstacle: &Obstacle, centre_m: (f32, f32)) -> f32 {
    let (dx, dy) = (obstacle.position_m.0 - centre_m.0, obstacle.position_m.1 - centre_m.1);
    match obstacle.shape {
        Shape::Circle { radius_m } => length(dx, dy) + radius_m,
        Shape::Rectangle { width_m, height_m } => {
            let (sin, cos) = libm::sincosf(obstacle.rotation_rad);
            length((dx * cos + dy * sin).abs() + width_m / 2.0, (dy * cos - dx * sin).abs() + height_m / 2.0)
        }
    }
}

/// sqrt(x^2 + y^2), by operations that IEEE 754 rounds alike everywhere.
pub(super) fn length(x: f32, y: f32) -> f32 {
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

    use super::*;
    use crate::scenario::ObstacleMotion;

    fn near(a: f32, b: f32) -> bool {
        (a - b).abs() < 1e-5
    }

    #[test]
    fn distances_to_a_circle_and_a_turned_box_are_those_worked_by_hand() {
        let circle = Shape::Circle { radius_m: 0.15 };
        assert!(near(shape_distance(&circle, (0.6, 0.6, 0.0), (0.0, 0.6)), 0.45));
        assert!(near(shape_distance(&circle, (0.6, 0.6, 0.0), (0.6, 0.6)), -0.15));
        let slab = Shape::Rectangle { width_m: 2.0, height_m: 1.0 };
        assert!(near(shape_distance(&slab, (0.0, 0.0, 0.0), (4.0, 4.5)), 5.0), "from a corner: 3, 4, 5");
        assert!(near(shape_distance(&slab, (0.0, 0.0, 0.0), (0.9, 0.0)), -0.1), "inside, the nearest side");
        assert!(
            near(shape_distance(&slab, (0.0, 0.0, FRAC_PI_2), (2.0, 0.0)), 1.5),
            "upright after a quarter turn"
        );
    }

    #[test]
    fn clearance_is_the_nearest_of_walls_and_obstacles_at_the_step() {
        let mut scenario = Scenario::default();
        assert!(near(clearance(&scenario, (1.5, 0.0), 0), 0.5));
        assert!(near(clearance(&scenario, (0.0, 2.5), 0), -0.5), "outside is negative");
        scenario.task.control_period_s = 1.0;
        scenario.obstacles.push(Obstacle {
            shape: Shape::Circle { radius_m: 0.2 },
            position_m: (1.0, 0.0),
            rotation_rad: 0.0,
            motion: ObstacleMotion::Orbit { centre_m: (0.0, 0.0), speed_rad_s: FRAC_PI_2 },
        });
        assert!(near(clearance(&scenario, (0.0, 0.5), 0), 1.25_f32.sqrt() - 0.2));
        assert!(near(clearance(&scenario, (0.0, 0.5), 1), 0.3), "a quarter turn later it is straight ahead");
        assert!(is_clear(&scenario, (0.0, 0.5), 1, 0.299) && !is_clear(&scenario, (0.0, 0.5), 1, 0.301));
    }

    #[test]
    fn a_boxs_extents_and_reach_follow_its_turn() {
        let shape = Shape::Rectangle { width_m: 2.0, height_m: 1.0 };
        let (x, y) = half_extents(&shape, FRAC_PI_2);
        assert!(near(x, 0.5) && near(y, 1.0));
        let (x, y) = half_extents(&shape, FRAC_PI_4);
        assert!(near(x, 1.5 / 2.0_f32.sqrt()) && near(y, x));
        let motion = ObstacleMotion::Still;
        let o = Obstacle { shape, position_m: (3.0, 0.0), rotation_rad: FRAC_PI_2, motion };
        assert!(near(reach_from(&o, (0.0, 0.0)), length(3.5, 1.0)));
    }
}
