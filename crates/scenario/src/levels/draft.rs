//! A level under construction: its scenario, and the areas that are occupied.

use glam::{Vec2, vec2};
use wayfield_random::{Stream, uniform};

use super::floor::Floor;
use super::number;
use super::schema::{LevelGenerator, Route};
use crate::check::RoundedArea;
use crate::geometry::length;
use crate::schema::{Enclosure, Obstacle, ObstacleMotion, Region, Scenario, Shape, Wall};

/// A level under construction.
pub(super) struct Draft {
    /// The level so far.
    pub(super) scenario: Scenario,
    /// Smallest width of the passages, in m.
    pub(super) gap_m: f32,
    /// The starts and goals.
    pub(super) route: Route,
    /// The part of the enclosure for clutter, traps and traffic.
    pub(super) field: Region,
    /// The four corners of each pair of lanes.
    pub(super) lanes_m: Vec<[Vec2; 4]>,
    /// The static obstacles and wall segments.
    bodies: Vec<Body>,
}

/// The area of an obstacle, with a circle around it.
struct Body {
    area: RoundedArea,
    centre_m: Vec2,
    reach_m: f32,
}

impl Body {
    fn new(obstacle: &Obstacle) -> Self {
        let reach_m = obstacle.shape.bounding_radius_m();
        Self { area: RoundedArea::within(obstacle, 0.0), centre_m: obstacle.position_m, reach_m }
    }

    /// Whether the distance to `other` is less than `gap_m`.
    fn is_near(&self, other: &Self, gap_m: f32) -> bool {
        let offset = self.centre_m - other.centre_m;
        length(offset.x, offset.y) < self.reach_m + other.reach_m + gap_m
            && self.area.grown(gap_m).overlaps(&other.area)
    }
}

impl Draft {
    /// An enclosure of random size, without anything in it.
    pub(super) fn new(generator: &LevelGenerator, stream: &mut Stream, seed: u64) -> Self {
        let (width_m, height_m) = (number(stream, generator.width_m), number(stream, generator.height_m));
        let margin_m = match generator.route {
            Route::Random { .. } | Route::Fixed { .. } => 0.0,
            Route::Across { margin_m } => margin_m,
        };
        let high = vec2(width_m / 2.0, height_m / 2.0 - margin_m);
        let (starts, goals) = generator.route.rules(height_m);
        let scenario = Scenario {
            name: format!("{} {seed}", generator.name),
            about: generator.about.clone(),
            enclosure: Enclosure::Rectangle { width_m, height_m },
            robot: generator.robot.clone(),
            lidar: generator.lidar.clone(),
            task: generator.task.clone(),
            starts,
            goals,
            ..Scenario::default()
        };
        Self {
            scenario,
            gap_m: generator.gap_m,
            route: generator.route,
            field: Region { min_m: -high, max_m: high },
            lanes_m: Vec::new(),
            bodies: Vec::new(),
        }
    }

    /// Extent of the enclosure along x and y, in m.
    pub(super) fn size_m(&self) -> Vec2 {
        let (low, high) = self.scenario.enclosure.bounds_m();
        high - low
    }

    /// Adds a static obstacle.
    pub(super) fn add_obstacle(&mut self, obstacle: Obstacle) {
        self.bodies.push(Body::new(&obstacle));
        self.scenario.obstacles.push(obstacle);
    }

    /// Adds a moving obstacle. Others may cross its path.
    pub(super) fn add_moving(&mut self, obstacle: Obstacle) {
        self.scenario.obstacles.push(obstacle);
    }

    /// A random point of the field.
    pub(super) fn random_point(&self, stream: &mut Stream) -> Vec2 {
        let (low, high) = (self.field.min_m, self.field.max_m);
        vec2(uniform(stream, low.x, high.x), uniform(stream, low.y, high.y))
    }

    /// Whether a circle can move from one point to another inside the field without touching anything static.
    pub(super) fn is_free(&self, from: Vec2, to: Vec2, radius_m: f32) -> bool {
        let along = to - from;
        let swept = Body::new(&Obstacle {
            shape: Shape::Capsule { length_m: length(along.x, along.y), radius_m },
            position_m: (from + to) / 2.0,
            rotation_rad: libm::atan2f(along.y, along.x),
            motion: ObstacleMotion::Static,
        });
        let in_field = self.is_in_field(from, radius_m) && self.is_in_field(to, radius_m);
        in_field && !self.bodies.iter().any(|other| swept.is_near(other, 0.0))
    }

    /// Whether a point is in the field, at least `margin_m` away from its edges.
    fn is_in_field(&self, point: Vec2, margin_m: f32) -> bool {
        let (low, high) = (self.field.min_m + margin_m, self.field.max_m - margin_m);
        point.cmpge(low).all() && point.cmple(high).all()
    }

    /// Adds an inner wall.
    pub(super) fn add_wall(&mut self, wall: Wall) {
        self.bodies.extend(wall.pieces().map(|piece| Body::new(&piece)));
        self.scenario.walls.push(wall);
    }

    /// Whether `obstacle` would be at least `gap_m` away from the edges of the field and from everything static.
    pub(super) fn has_space_for(&self, obstacle: &Obstacle) -> bool {
        let (points, radius_m) = obstacle.shape.support_points(obstacle.rotation_rad);
        let margin_m = self.gap_m + radius_m;
        let body = Body::new(obstacle);
        points.iter().all(|&point| self.is_in_field(obstacle.position_m + point, margin_m))
            && !self.bodies.iter().any(|other| body.is_near(other, self.gap_m))
    }

    /// The space that is free of walls and static obstacles.
    pub(super) fn floor(&self) -> Floor<'_> {
        Floor::new(&self.scenario, self.gap_m / 2.0, self.route)
    }
}
