//! How far a point is from the walls and the obstacles, and how far those reach.
//!
//! In: a [`Scenario`], a point, a step. Out: signed distances, positive in the open; extents. f32 by plain arithmetic
//! and `libm`, so that what is drawn by them is the same on every platform.

use super::motion::pose_at;
use super::polygon;
use super::schema::{Enclosure, Lidar, Obstacle, ObstacleMotion, Scenario, Shape, Wall};
use super::shape::to_local;
use glam::{Vec2, vec2};

/// The distance, in m, from `point_m` to the nearest surface of an obstacle (where it is at `step`) or of a
/// wall; negative inside an obstacle or a wall or outside the enclosure.
#[must_use]
pub fn clearance(scenario: &Scenario, point_m: Vec2, step: u64) -> f32 {
    let to_wall = enclosure_distance(&scenario.enclosure, point_m);
    let to_inner = scenario.walls.iter().map(|wall| inner_wall_distance(wall, point_m));
    let period = scenario.task.control_period_s;
    let to_obstacle = scenario.obstacles.iter().map(|o| obstacle_distance(o, point_m, step, period));
    to_inner.chain(to_obstacle).fold(to_wall, f32::min)
}

/// Whether `point_m` is at least `clearance_m` from everything: [`clearance`] with an early end.
pub(super) fn is_clear(scenario: &Scenario, point_m: Vec2, step: u64, clearance_m: f32) -> bool {
    let period = scenario.task.control_period_s;
    enclosure_distance(&scenario.enclosure, point_m) >= clearance_m
        && scenario.walls.iter().all(|wall| inner_wall_distance(wall, point_m) >= clearance_m)
        && scenario.obstacles.iter().all(|o| obstacle_distance(o, point_m, step, period) >= clearance_m)
}

/// From a point to the nearest wall of the enclosure, in m, negative beyond it.
#[must_use]
pub fn enclosure_distance(enclosure: &Enclosure, Vec2 { x, y }: Vec2) -> f32 {
    match enclosure {
        Enclosure::Rectangle { width_m, height_m } => (width_m / 2.0 - x.abs()).min(height_m / 2.0 - y.abs()),
        Enclosure::Polygon { corners_m } => polygon::signed_distance(corners_m, vec2(x, y)),
    }
}

/// From a point to an inner wall, in m, negative within it.
#[must_use]
pub fn inner_wall_distance(wall: &Wall, point: Vec2) -> f32 {
    let half = wall.thickness_m / 2.0;
    let to_piece = |ends: &[Vec2]| {
        let (from, to) = (ends[0], ends[1]);
        let (dx, dy) = (to.x - from.x, to.y - from.y);
        let long = length(dx, dy);
        let (ux, uy) = if long > 0.0 { (dx / long, dy / long) } else { (1.0, 0.0) };
        let (px, py) = (point.x - (from.x + to.x) / 2.0, point.y - (from.y + to.y) / 2.0);
        box_distance(vec2((px * ux + py * uy).abs() - long / 2.0 - half, (py * ux - px * uy).abs() - half))
    };
    wall.corners_m.windows(2).map(to_piece).fold(f32::INFINITY, f32::min)
}

fn obstacle_distance(obstacle: &Obstacle, point: Vec2, step: u64, control_period_s: f32) -> f32 {
    shape_distance(&obstacle.shape, pose_at(obstacle, step, control_period_s), point)
}

/// Signed distance, in m, from a point to the surface of a shape at a pose (x in m, y in m, rotation in rad); negative
/// inside the shape.
#[must_use]
pub fn shape_distance(shape: &Shape, pose: (f32, f32, f32), point: Vec2) -> f32 {
    let offset = vec2(point.x - pose.0, point.y - pose.1);
    // A circle looks the same from every direction: skip the sine and cosine.
    shape.distance(if shape.has_orientation() { to_local(offset, pose.2) } else { offset })
}

/// Signed distance, in m, to a box from a point whose coordinates, measured outwards from the box's corner, are `past`.
pub(super) fn box_distance(past: Vec2) -> f32 {
    length(past.x.max(0.0), past.y.max(0.0)) + past.x.max(past.y).min(0.0)
}

impl Enclosure {
    /// The lower left and the upper right corner of the box around it, in m.
    #[must_use]
    pub fn bounds_m(&self) -> (Vec2, Vec2) {
        match self {
            Self::Rectangle { width_m, height_m } => {
                (vec2(-width_m / 2.0, -height_m / 2.0), vec2(width_m / 2.0, height_m / 2.0))
            }
            Self::Polygon { corners_m } => {
                let first = corners_m.first().copied().unwrap_or_default();
                corners_m.iter().fold((first, first), |(low, high), &Vec2 { x, y }| {
                    (vec2(low.x.min(x), low.y.min(y)), vec2(high.x.max(x), high.y.max(y)))
                })
            }
        }
    }

    /// Its corners, counterclockwise, in m.
    #[must_use]
    pub fn corners_m(&self) -> Vec<Vec2> {
        match self {
            Self::Rectangle { .. } => {
                let (low, high) = self.bounds_m();
                vec![low, vec2(high.x, low.y), high, vec2(low.x, high.y)]
            }
            Self::Polygon { corners_m } => polygon::counterclockwise(corners_m),
        }
    }
}

impl Wall {
    /// Its straight pieces, as boxes that stand still; each reaches half the thickness past its ends.
    pub fn segments(&self) -> impl Iterator<Item = Obstacle> {
        self.corners_m.windows(2).map(|ends| {
            let (from, to) = (ends[0], ends[1]);
            let (dx, dy) = (to.x - from.x, to.y - from.y);
            Obstacle {
                shape: Shape::Rectangle {
                    width_m: length(dx, dy) + self.thickness_m,
                    height_m: self.thickness_m,
                },
                position_m: vec2((from.x + to.x) / 2.0, (from.y + to.y) / 2.0),
                rotation_rad: libm::atan2f(dy, dx),
                motion: ObstacleMotion::Static,
            }
        })
    }
}

impl Lidar {
    /// The direction of beam `beam` from the heading, counterclockwise, in rad.
    #[must_use]
    pub fn beam_angle_rad(&self, beam: usize) -> f64 {
        if self.is_all_around() {
            return beam as f64 * (std::f64::consts::TAU / self.beams as f64);
        }
        if self.beams < 2 {
            return 0.0;
        }
        let view = f64::from(self.field_of_view_rad);
        view * (beam as f64 / (self.beams - 1) as f64 - 0.5)
    }
}

/// sqrt(x^2 + y^2), by operations that IEEE 754 rounds alike everywhere.
pub(super) fn length(x: f32, y: f32) -> f32 {
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;
    use crate::ObstacleMotion;

    fn near(a: f32, b: f32) -> bool {
        (a - b).abs() < 1e-5
    }

    #[test]
    fn distances_to_a_circle_and_a_turned_box_are_those_worked_by_hand() {
        let circle = Shape::Circle { radius_m: 0.15 };
        assert!(near(shape_distance(&circle, (0.6, 0.6, 0.0), vec2(0.0, 0.6)), 0.45));
        assert!(near(shape_distance(&circle, (0.6, 0.6, 0.0), vec2(0.6, 0.6)), -0.15));
        let slab = Shape::Rectangle { width_m: 2.0, height_m: 1.0 };
        assert!(near(shape_distance(&slab, (0.0, 0.0, 0.0), vec2(4.0, 4.5)), 5.0), "from a corner: 3, 4, 5");
        assert!(
            near(shape_distance(&slab, (0.0, 0.0, 0.0), vec2(0.9, 0.0)), -0.1),
            "inside, the nearest side"
        );
        assert!(
            near(shape_distance(&slab, (0.0, 0.0, FRAC_PI_2), vec2(2.0, 0.0)), 1.5),
            "upright after a quarter turn"
        );
    }

    #[test]
    fn clearance_is_the_nearest_of_walls_and_obstacles_at_the_step() {
        let mut scenario = Scenario::default();
        assert!(near(clearance(&scenario, vec2(1.5, 0.0), 0), 0.5));
        assert!(near(clearance(&scenario, vec2(0.0, 2.5), 0), -0.5), "outside is negative");
        scenario.task.control_period_s = 1.0;
        scenario.obstacles.push(Obstacle {
            shape: Shape::Circle { radius_m: 0.2 },
            position_m: vec2(1.0, 0.0),
            rotation_rad: 0.0,
            motion: ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s: FRAC_PI_2 },
        });
        assert!(near(clearance(&scenario, vec2(0.0, 0.5), 0), 1.25_f32.sqrt() - 0.2));
        assert!(
            near(clearance(&scenario, vec2(0.0, 0.5), 1), 0.3),
            "a quarter turn later it is straight ahead"
        );
        assert!(
            is_clear(&scenario, vec2(0.0, 0.5), 1, 0.299) && !is_clear(&scenario, vec2(0.0, 0.5), 1, 0.301)
        );
    }

    #[test]
    fn distances_to_polygons_and_rods_are_those_worked_by_hand() {
        let triangle = Shape::Polygon { corners_m: vec![vec2(0.0, 0.0), vec2(3.0, 0.0), vec2(0.0, 4.0)] };
        // The long side is 4 x + 3 y = 12: (3, 4) is 12 / 5 beyond it, (0.5, 0.5) inside by its distance to x = 0.
        assert!(near(shape_distance(&triangle, (0.0, 0.0, 0.0), vec2(3.0, 4.0)), 2.4));
        assert!(near(shape_distance(&triangle, (0.0, 0.0, 0.0), vec2(0.5, 0.5)), -0.5));
        // A quarter turn later its long leg points along -x.
        assert!(near(shape_distance(&triangle, (1.0, 0.0, FRAC_PI_2), vec2(-3.5, 0.0)), 0.5));
        let rod = Shape::Capsule { length_m: 2.0, radius_m: 0.25 };
        assert!(
            near(shape_distance(&rod, (0.0, 0.0, 0.0), vec2(4.0, 4.0)), 4.75),
            "3, 4, 5 from its end's middle"
        );
        assert!(
            near(shape_distance(&rod, (0.0, 0.0, FRAC_PI_2), vec2(1.0, 0.5)), 0.75),
            "beside it when upright"
        );
        assert!(near(shape_distance(&rod, (0.0, 0.0, 0.0), vec2(0.3, 0.0)), -0.25));
        assert!(near(rod.bounding_radius_m(), 1.25) && near(triangle.bounding_radius_m(), 4.0));
    }

    #[test]
    fn an_inner_wall_is_its_pieces() {
        let wall = Wall { corners_m: vec![vec2(0.0, 0.0), vec2(2.0, 0.0), vec2(2.0, 3.0)], thickness_m: 0.2 };
        for (point, expected) in [
            (vec2(1.0, 1.0), 0.9),
            (vec2(1.0, -0.5), 0.4),
            (vec2(2.05, 2.0), -0.05),
            // Past the corner the two pieces make a square end: the nearest point is (2.1, -0.1).
            (vec2(2.4, -0.5), 0.5),
            (vec2(2.0, 3.5), 0.4),
        ] {
            assert!(near(inner_wall_distance(&wall, point), expected), "{point:?}");
            let by_pieces = wall.segments().map(|piece| obstacle_distance(&piece, point, 0, 0.2));
            assert!(near(by_pieces.fold(f32::INFINITY, f32::min), expected), "{point:?} by its pieces");
        }
        let scenario = Scenario { walls: vec![wall], ..Scenario::default() };
        assert!(near(clearance(&scenario, vec2(1.0, 0.3), 0), 0.2));
        assert!(
            is_clear(&scenario, vec2(1.0, 0.3), 0, 0.19) && !is_clear(&scenario, vec2(1.0, 0.3), 0, 0.21)
        );
    }

    #[test]
    fn beams_go_all_around_or_from_right_to_left() {
        let lidar = |beams, field_of_view_rad| Lidar { beams, field_of_view_rad, ..Lidar::default() };
        let all = lidar(4, std::f32::consts::TAU);
        assert!(
            (all.beam_angle_rad(1) - std::f64::consts::FRAC_PI_2).abs() < 1e-9,
            "a quarter turn to the left"
        );
        let ahead = lidar(5, 2.0);
        let angles: Vec<f64> = (0..5).map(|beam| ahead.beam_angle_rad(beam)).collect();
        assert_eq!(angles, [-1.0, -0.5, 0.0, 0.5, 1.0]);
        assert_eq!(lidar(1, 2.0).beam_angle_rad(0), 0.0, "a single beam looks ahead");
    }

    #[test]
    fn reach_follows_a_shapes_turn() {
        let shape = Shape::Rectangle { width_m: 2.0, height_m: 1.0 };
        let motion = ObstacleMotion::Static;
        let o = Obstacle { shape, position_m: vec2(3.0, 0.0), rotation_rad: FRAC_PI_2, motion };
        assert!(near(o.max_distance_from(Vec2::ZERO), length(3.5, 1.0)));
        let shape = Shape::Polygon { corners_m: vec![vec2(0.0, 0.0), vec2(4.0, 0.0), vec2(0.0, 1.0)] };
        let o = Obstacle {
            shape,
            position_m: vec2(3.0, 0.0),
            rotation_rad: FRAC_PI_2,
            motion: ObstacleMotion::Static,
        };
        assert!(near(o.max_distance_from(Vec2::ZERO), 5.0), "its far corner is at (3, 4)");
        let shape = Shape::Capsule { length_m: 2.0, radius_m: 0.5 };
        let o =
            Obstacle { shape, position_m: vec2(3.0, 0.0), rotation_rad: 0.0, motion: ObstacleMotion::Static };
        assert!(near(o.max_distance_from(Vec2::ZERO), 4.5));
    }
}
