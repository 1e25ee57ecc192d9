//! The robot's body: its extent, and its distance from walls and obstacles.

use glam::{Vec2, vec2};

use super::check::convex_distance;
use super::geometry::{Solid, enclosure_distance, inner_wall_distance, shape_distance};
use super::polygon::sides;
use super::schema::{Obstacle, Robot, Scenario, Shape, Wall};
use super::spatial_index::IndexedScenario;

impl Robot {
    /// Distance from the robot's origin to the farthest point of its body, in m; for a disc, its radius.
    #[must_use]
    pub fn reach_m(&self) -> f32 {
        self.shape.as_ref().map_or(self.radius_m, Shape::bounding_radius_m)
    }

    /// Distance from the robot's origin to the nearest point of its body's edge, in m; for a disc, its radius.
    #[must_use]
    pub fn inner_radius_m(&self) -> f32 {
        self.shape.as_ref().map_or(self.radius_m, |shape| -shape.distance(Vec2::ZERO))
    }

    /// The body, in the robot's frame.
    #[must_use]
    pub fn body(&self) -> Shape {
        self.shape.clone().unwrap_or(Shape::Circle { radius_m: self.radius_m })
    }
}

impl Scenario {
    /// The distance of the robot's origin from surfaces, in m, beyond which the robot collides at no heading: the collision
    /// range, or the reach of the robot's shape if that is more.
    #[must_use]
    pub fn keep_out_m(&self) -> f32 {
        let range_m = self.task.collision_range_m;
        self.robot.shape.as_ref().map_or(range_m, |shape| range_m.max(shape.bounding_radius_m()))
    }

    /// The unit, in m, of lengths relative to the robot: [`Self::keep_out_m`], or [`Robot::reach_m`] if that is more.
    #[must_use]
    pub fn robot_unit_m(&self) -> f32 {
        self.keep_out_m().max(self.robot.reach_m())
    }

    /// The distance of the robot's origin from surfaces, in m, below which the robot collides at every heading: the collision
    /// range, or the [`Robot::inner_radius_m`] of its shape if that is more.
    #[must_use]
    pub fn sure_collision_m(&self) -> f32 {
        let range_m = self.task.collision_range_m;
        if self.robot.shape.is_some() { range_m.max(self.robot.inner_radius_m()) } else { range_m }
    }

    /// The wall or obstacle that is nearest (at `step`) to the body of a robot at the pose (x in m, y in m, heading in rad),
    /// and the distance in m; 0 where they overlap. Of equally near ones, the first in the order of [`Solid`].
    #[must_use]
    pub fn nearest_to_body(&self, pose: (f32, f32, f32), step: u64) -> (Solid, f32) {
        IndexedScenario::from(self).nearest_to_body(pose, step)
    }
}

impl IndexedScenario<'_> {
    /// Like [`Scenario::nearest_to_body`], with the pedestrians where they are now.
    #[must_use]
    pub fn nearest_to_body(self, pose: (f32, f32, f32), step: u64) -> (Solid, f32) {
        let scenario = self.scenario;
        let body = PlacedBody::new(&scenario.robot.body(), pose);
        let mut best = (Solid::Enclosure, body.enclosure_distance(scenario));
        let mut consider = |solid: Solid, from_origin_m: f32, parts: &mut dyn Iterator<Item = Obstacle>| {
            if from_origin_m - body.reach_m < best.1 {
                let distance = parts.map(|part| body.distance(&part)).fold(f32::INFINITY, f32::min);
                best = if distance < best.1 { (solid, distance) } else { best };
            }
        };
        for (index, wall) in scenario.walls.iter().enumerate() {
            let from_origin_m = inner_wall_distance(wall, body.origin_m);
            consider(Solid::Wall(index), from_origin_m, &mut Wall::pieces(wall));
        }
        for (index, obstacle) in scenario.obstacles.iter().enumerate() {
            let at = self.pose_at(index, step);
            let from_origin_m = shape_distance(&obstacle.shape, at, body.origin_m);
            let placed = || Obstacle { position_m: vec2(at.0, at.1), rotation_rad: at.2, ..obstacle.clone() };
            consider(Solid::Obstacle(index), from_origin_m, &mut std::iter::once_with(placed));
        }
        best
    }
}

/// The body of a robot at a pose: all points within a radius of a convex polygon, a segment or a point.
struct PlacedBody {
    origin_m: Vec2,
    points_m: Vec<Vec2>,
    radius_m: f32,
    reach_m: f32,
}

impl PlacedBody {
    fn new(body: &Shape, (x, y, heading_rad): (f32, f32, f32)) -> Self {
        let (points, radius_m) = body.support_points(heading_rad);
        let points_m = points.into_iter().map(|point| vec2(x, y) + point).collect();
        Self { origin_m: vec2(x, y), points_m, radius_m, reach_m: body.bounding_radius_m() }
    }

    fn distance(&self, obstacle: &Obstacle) -> f32 {
        let (mut points, radius_m) = obstacle.shape.support_points(obstacle.rotation_rad);
        points.iter_mut().for_each(|point| *point += obstacle.position_m);
        (convex_distance(&self.points_m, &points) - self.radius_m - radius_m).max(0.0)
    }

    fn enclosure_distance(&self, scenario: &Scenario) -> f32 {
        if enclosure_distance(&scenario.enclosure, self.origin_m) <= 0.0 {
            return 0.0;
        }
        let corners = scenario.enclosure.corners_m();
        let to_side = |(from, to)| convex_distance(&self.points_m, &[from, to]) - self.radius_m;
        sides(&corners).map(to_side).fold(f32::INFINITY, f32::min).max(0.0)
    }
}
