//! Signed distances from a point to walls and obstacles, the extent of the enclosure, and the directions of the LIDAR's beams.
//!
//! In: a [`Scenario`], a point, a step. Out: distances in m, positive in free space. Their arithmetic is f32 with `libm`, so
//! that random placement gives the same result on every platform.

use super::polygon;
use super::schema::{Enclosure, Lidar, Obstacle, ObstacleMotion, Scenario, Shape, Wall, WallCells};
use super::shape::to_local;
use super::spatial_index::IndexedScenario;
use super::wall_cells::CellBlock;
use glam::{Vec2, vec2};
use serde::{Deserialize, Serialize};

/// A part of a scenario that the robot can collide with. The variants are in the order in which they are searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Solid {
    /// The enclosure.
    Enclosure,
    /// The inner wall with this index in [`Scenario::walls`].
    Wall(usize),
    /// The obstacle with this index in [`Scenario::obstacles`], where generated obstacles follow those of the file.
    Obstacle(usize),
}

/// The part of `scenario` that is nearest to `point_m` (at `step`), and the distance, in m, to its surface: the
/// [`clearance`]. Of equally near parts, the first in the order of [`Solid`].
#[must_use]
pub fn nearest(scenario: &Scenario, point_m: Vec2, step: u64) -> (Solid, f32) {
    nearest_of(scenario.into(), point_m, step)
}

/// Like [`nearest`], without the spatial index: tests all parts.
pub(super) fn nearest_of(space: IndexedScenario, point_m: Vec2, step: u64) -> (Solid, f32) {
    let scenario = space.scenario;
    let walls = scenario.walls.iter().map(|wall| inner_wall_distance(wall, point_m));
    let obstacles = (0..scenario.obstacles.len()).map(|index| space.obstacle_distance(index, point_m, step));
    let walls = walls.enumerate().map(|(index, distance)| (Solid::Wall(index), distance));
    let obstacles = obstacles.enumerate().map(|(index, distance)| (Solid::Obstacle(index), distance));
    let enclosure = (Solid::Enclosure, enclosure_distance(&scenario.enclosure, point_m));
    walls.chain(obstacles).fold(enclosure, |best, other| if other.1 < best.1 { other } else { best })
}

/// Distance, in m, from `point_m` to the nearest surface of a wall or an obstacle (at `step`). Negative inside an obstacle or
/// a wall, and outside the enclosure.
#[must_use]
pub fn clearance(scenario: &Scenario, point_m: Vec2, step: u64) -> f32 {
    nearest(scenario, point_m, step).1
}

/// Whether [`clearance`] is at least `clearance_m`; stops at the first object that is too close.
pub(super) fn is_clear(space: IndexedScenario, point_m: Vec2, step: u64, clearance_m: f32) -> bool {
    let scenario = space.scenario;
    enclosure_distance(&scenario.enclosure, point_m) >= clearance_m
        && scenario.walls.iter().all(|wall| inner_wall_distance(wall, point_m) >= clearance_m)
        && (0..scenario.obstacles.len())
            .all(|index| space.obstacle_distance(index, point_m, step) >= clearance_m)
}

/// Distance from a point to the nearest wall of the enclosure, in m; negative outside.
#[must_use]
pub fn enclosure_distance(enclosure: &Enclosure, Vec2 { x, y }: Vec2) -> f32 {
    match enclosure {
        Enclosure::Rectangle { width_m, height_m } => (width_m / 2.0 - x.abs()).min(height_m / 2.0 - y.abs()),
        Enclosure::Polygon { corners_m } => polygon::signed_distance(corners_m, vec2(x, y)),
    }
}

/// Distance from a point to an inner wall, in m; negative inside it.
#[must_use]
pub fn inner_wall_distance(wall: &Wall, point: Vec2) -> f32 {
    let to_segment = |ends: &[Vec2]| wall_segment_distance(ends[0], ends[1], wall.thickness_m, point);
    let blocks = wall.blocks().iter().map(|block| block.distance_m(point));
    wall.corners_m.windows(2).map(to_segment).chain(blocks).fold(f32::INFINITY, f32::min)
}

/// Distance from a point to a segment of a wall between two of its corners, in m; negative inside it.
fn wall_segment_distance(from: Vec2, to: Vec2, thickness_m: f32, point: Vec2) -> f32 {
    let half = thickness_m / 2.0;
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let long = length(dx, dy);
    let (ux, uy) = if long > 0.0 { (dx / long, dy / long) } else { (1.0, 0.0) };
    let (px, py) = (point.x - (from.x + to.x) / 2.0, point.y - (from.y + to.y) / 2.0);
    box_distance(vec2((px * ux + py * uy).abs() - long / 2.0 - half, (py * ux - px * uy).abs() - half))
}

/// Signed distance, in m, from a point to the surface of a shape at a pose (x in m, y in m, rotation in rad); negative
/// inside the shape.
#[must_use]
pub fn shape_distance(shape: &Shape, pose: (f32, f32, f32), point: Vec2) -> f32 {
    let offset = vec2(point.x - pose.0, point.y - pose.1);
    // A circle looks the same from every direction: skip the sine and cosine.
    shape.distance(if shape.has_orientation() { to_local(offset, pose.2) } else { offset })
}

/// Signed distance, in m, from a point to the surface of a box; negative inside. `past` is how far the point lies beyond the
/// box's sides along x and y, in m.
pub(super) fn box_distance(past: Vec2) -> f32 {
    length(past.x.max(0.0), past.y.max(0.0)) + past.x.max(past.y).min(0.0)
}

impl Enclosure {
    /// Lower left and upper right corner of its bounding box, in m.
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

    /// Corners in counterclockwise order, in m.
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
    /// Number of its [`pieces`](Self::pieces).
    #[must_use]
    pub fn piece_count(&self) -> usize {
        self.corners_m.len().saturating_sub(1) + self.blocks().len()
    }

    /// Distance from a point to the piece with this index, in m; negative inside it.
    pub(super) fn piece_distance_m(&self, index: usize, point: Vec2) -> f32 {
        match self.corners_m.get(index..index + 2) {
            Some(ends) => wall_segment_distance(ends[0], ends[1], self.thickness_m, point),
            None => self.blocks()[index + 1 - self.corners_m.len().max(1)].distance_m(point),
        }
    }

    /// Lower left and upper right corner of a box around the piece with this index, in m.
    pub(super) fn piece_bounds_m(&self, index: usize) -> (Vec2, Vec2) {
        match self.corners_m.get(index..index + 2) {
            Some(ends) => (ends[0].min(ends[1]) - self.thickness_m, ends[0].max(ends[1]) + self.thickness_m),
            None => self.blocks()[index + 1 - self.corners_m.len().max(1)].bounds_m(),
        }
    }

    /// The rectangles that its cells form.
    pub(super) fn blocks(&self) -> &[CellBlock] {
        self.cells.as_ref().map_or(&[], WallCells::blocks)
    }

    /// Its segments as static rectangular obstacles, each extended by half the thickness at both ends, and the rectangles that
    /// its cells form.
    pub fn pieces(&self) -> impl Iterator<Item = Obstacle> {
        let segments = self.corners_m.windows(2).map(|ends| {
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
        });
        segments.chain(self.blocks().iter().map(CellBlock::obstacle))
    }
}

impl Lidar {
    /// The directions of all beams in the robot's frame: unit vectors, in the sensor's order.
    #[must_use]
    pub fn beam_directions(&self) -> Vec<Vec2> {
        let direction = |beam| {
            let (sin, cos) = libm::sincos(self.beam_angle_rad(beam));
            vec2(cos as f32, sin as f32)
        };
        (0..self.beams).map(direction).collect()
    }

    /// Angle of a beam relative to the heading, in rad, counterclockwise positive.
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

    /// Angle between neighbouring beams, in rad; of a single beam, the field of view.
    #[must_use]
    pub fn beam_spacing_rad(&self) -> f32 {
        let gaps = if self.is_all_around() { self.beams } else { self.beams.saturating_sub(1) };
        self.field_of_view_rad / gaps.max(1) as f32
    }
}

/// sqrt(x^2 + y^2), with operations that IEEE 754 rounds the same way on every platform.
pub(super) fn length(x: f32, y: f32) -> f32 {
    (x * x + y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;
    use crate::{ObstacleMotion, pose_at};

    fn near(a: f32, b: f32) -> bool {
        (a - b).abs() < 1e-5
    }

    #[test]
    fn distances_to_a_circle_and_a_rotated_rectangle_match_hand_calculations() {
        let circle = Shape::Circle { radius_m: 0.15 };
        assert!(near(shape_distance(&circle, (0.6, 0.6, 0.0), vec2(0.0, 0.6)), 0.45));
        assert!(near(shape_distance(&circle, (0.6, 0.6, 0.0), vec2(0.6, 0.6)), -0.15));
        let slab = Shape::Rectangle { width_m: 2.0, height_m: 1.0 };
        assert!(
            near(shape_distance(&slab, (0.0, 0.0, 0.0), vec2(4.0, 4.5)), 5.0),
            "a 3-4-5 triangle from a corner"
        );
        assert!(
            near(shape_distance(&slab, (0.0, 0.0, 0.0), vec2(0.9, 0.0)), -0.1),
            "the nearest side from inside"
        );
        assert!(
            near(shape_distance(&slab, (0.0, 0.0, FRAC_PI_2), vec2(2.0, 0.0)), 1.5),
            "after a quarter turn"
        );
    }

    #[test]
    fn clearance_is_the_distance_to_the_nearest_wall_or_obstacle() {
        let mut scenario = Scenario::default();
        assert!(near(clearance(&scenario, vec2(1.5, 0.0), 0), 0.5));
        assert!(near(clearance(&scenario, vec2(0.0, 2.5), 0), -0.5), "outside is negative");
        assert_eq!(nearest(&scenario, vec2(1.5, 0.0), 0).0, Solid::Enclosure);
        scenario.task.control_period_s = 1.0;
        scenario.walls.push(Wall {
            corners_m: vec![vec2(-1.5, -1.0), vec2(-1.5, 1.0)],
            thickness_m: 0.2,
            ..Wall::default()
        });
        scenario.obstacles.push(Obstacle {
            shape: Shape::Circle { radius_m: 0.2 },
            position_m: vec2(1.0, 0.0),
            rotation_rad: 0.0,
            motion: ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s: FRAC_PI_2.into() },
        });
        assert!(near(clearance(&scenario, vec2(0.0, 0.5), 0), 1.25_f32.sqrt() - 0.2));
        assert!(
            near(clearance(&scenario, vec2(0.0, 0.5), 1), 0.3),
            "after a quarter turn the obstacle is at (0, 1)"
        );
        for (point, step, expected) in [
            (vec2(0.0, 0.5), 1, Solid::Obstacle(0)),
            (vec2(-0.7, 0.0), 0, Solid::Wall(0)),
            (vec2(0.0, 1.9), 0, Solid::Enclosure),
        ] {
            assert_eq!(nearest(&scenario, point, step).0, expected, "{point:?}");
        }
        assert!(
            is_clear((&scenario).into(), vec2(0.0, 0.5), 1, 0.299)
                && !is_clear((&scenario).into(), vec2(0.0, 0.5), 1, 0.301)
        );
    }

    #[test]
    fn distances_to_polygons_and_capsules_match_hand_calculations() {
        let triangle = Shape::Polygon { corners_m: vec![vec2(0.0, 0.0), vec2(3.0, 0.0), vec2(0.0, 4.0)] };
        // The long side is 4 x + 3 y = 12: (3, 4) is 12 / 5 beyond it, (0.5, 0.5) inside by its distance to x = 0.
        assert!(near(shape_distance(&triangle, (0.0, 0.0, 0.0), vec2(3.0, 4.0)), 2.4));
        assert!(near(shape_distance(&triangle, (0.0, 0.0, 0.0), vec2(0.5, 0.5)), -0.5));
        // A quarter turn later its long leg points along -x.
        assert!(near(shape_distance(&triangle, (1.0, 0.0, FRAC_PI_2), vec2(-3.5, 0.0)), 0.5));
        let rod = Shape::Capsule { length_m: 2.0, radius_m: 0.25 };
        assert!(
            near(shape_distance(&rod, (0.0, 0.0, 0.0), vec2(4.0, 4.0)), 4.75),
            "a 3-4-5 triangle from the centre of its end"
        );
        assert!(
            near(shape_distance(&rod, (0.0, 0.0, FRAC_PI_2), vec2(1.0, 0.5)), 0.75),
            "from its side after a quarter turn"
        );
        assert!(near(shape_distance(&rod, (0.0, 0.0, 0.0), vec2(0.3, 0.0)), -0.25));
        assert!(near(rod.bounding_radius_m(), 1.25) && near(triangle.bounding_radius_m(), 4.0));
    }

    #[test]
    fn an_inner_wall_equals_its_segments() {
        let wall = Wall {
            corners_m: vec![vec2(0.0, 0.0), vec2(2.0, 0.0), vec2(2.0, 3.0)],
            thickness_m: 0.2,
            ..Wall::default()
        };
        for (point, expected) in [
            (vec2(1.0, 1.0), 0.9),
            (vec2(1.0, -0.5), 0.4),
            (vec2(2.05, 2.0), -0.05),
            // Past the corner the two segments make a square end: the nearest point is (2.1, -0.1).
            (vec2(2.4, -0.5), 0.5),
            (vec2(2.0, 3.5), 0.4),
        ] {
            assert!(near(inner_wall_distance(&wall, point), expected), "{point:?}");
            let by_pieces =
                wall.pieces().map(|piece| shape_distance(&piece.shape, pose_at(&piece, 0, 0.2), point));
            assert!(near(by_pieces.fold(f32::INFINITY, f32::min), expected), "{point:?} by its pieces");
        }
        let scenario = Scenario { walls: vec![wall], ..Scenario::default() };
        assert!(near(clearance(&scenario, vec2(1.0, 0.3), 0), 0.2));
        let space = IndexedScenario::from(&scenario);
        assert!(space.is_clear(vec2(1.0, 0.3), 0, 0.19) && !space.is_clear(vec2(1.0, 0.3), 0, 0.21));
    }

    #[test]
    fn beams_cover_the_circle_or_go_from_right_to_left() {
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
    fn the_farthest_point_depends_on_the_rotation() {
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
