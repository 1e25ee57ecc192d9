//! The spatial index of a scenario with many wall segments and static obstacles: the clearance of a point is computed only from
//! those near it.
//!
//! In: a [`Scenario`]. Out: a [`SpatialIndex`], which gives the same results as a test of all of them, bit for bit.

use super::crowd::{Crowd, Pedestrian};
use super::geometry::{enclosure_distance, is_clear, nearest_of, shape_distance};
use super::motion::pose_at;
use super::schema::{ObstacleMotion, Scenario, Wall};
use super::uniform_grid::UniformGrid;
use super::{Solid, Vec2};

/// Upper bound on the rounding error of distances, relative to the coordinates.
const ROUNDING: f32 = 1e-5;

/// An index over the walls and the static obstacles of one scenario; it is not valid for any other.
#[derive(Clone, Debug)]
pub struct SpatialIndex {
    grid: UniformGrid,
    parts: Vec<Part>,
    /// Indices of the moving obstacles.
    moving: Vec<usize>,
}

/// A static part of a scenario.
#[derive(Clone, Copy, Debug)]
pub(super) enum Part {
    /// A piece of a wall: the indices of the wall and of the piece in it.
    WallPiece { wall: usize, index: usize },
    /// A static obstacle, by its index.
    Obstacle(usize),
}

impl Part {
    /// The static parts of `scenario` except the enclosure: pieces of walls, then static obstacles.
    pub(super) fn static_parts(scenario: &Scenario) -> impl Iterator<Item = Self> {
        let pieces = |(k, wall): (usize, &Wall)| {
            (0..wall.piece_count()).map(move |index| Self::WallPiece { wall: k, index })
        };
        let is_static = |index: &usize| scenario.obstacles[*index].motion == ObstacleMotion::Static;
        let obstacles = (0..scenario.obstacles.len()).filter(is_static);
        scenario.walls.iter().enumerate().flat_map(pieces).chain(obstacles.map(Self::Obstacle))
    }

    fn solid(self) -> Solid {
        match self {
            Self::WallPiece { wall, .. } => Solid::Wall(wall),
            Self::Obstacle(index) => Solid::Obstacle(index),
        }
    }

    /// The distance from a point to the part, in m; negative inside it.
    pub(super) fn distance_m(self, scenario: &Scenario, point_m: Vec2) -> f32 {
        match self {
            Self::WallPiece { wall, index } => scenario.walls[wall].piece_distance_m(index, point_m),
            Self::Obstacle(index) => IndexedScenario::from(scenario).obstacle_distance(index, point_m, 0),
        }
    }

    /// Lower left and upper right corner of a box around the part, in m.
    pub(super) fn bounds_m(self, scenario: &Scenario) -> (Vec2, Vec2) {
        match self {
            Self::WallPiece { wall, index } => scenario.walls[wall].piece_bounds_m(index),
            Self::Obstacle(index) => {
                let obstacle = &scenario.obstacles[index];
                let reach_m = obstacle.shape.bounding_radius_m();
                (obstacle.position_m - reach_m, obstacle.position_m + reach_m)
            }
        }
    }
}

impl SpatialIndex {
    /// The index of `scenario`. `None` if it has so few static parts that testing all of them is as fast, or if a number is not
    /// finite.
    #[must_use]
    pub fn new(scenario: &Scenario) -> Option<Self> {
        let parts: Vec<Part> = Part::static_parts(scenario).collect();
        if parts.len() < UniformGrid::MIN_ITEMS {
            return None;
        }
        let boxes: Vec<_> = parts.iter().map(|part| part.bounds_m(scenario)).collect();
        let farthest_m = boxes.iter().flat_map(|(low, high)| [low, high]).map(|at| at.abs().max_element());
        let margin_m = ROUNDING * farthest_m.fold(1.0, f32::max);
        let boxes: Vec<_> = boxes.into_iter().map(|(low, high)| (low - margin_m, high + margin_m)).collect();
        let distance_m = |part: usize, point| parts[part].distance_m(scenario, point) - margin_m;
        let grid = UniformGrid::new(&boxes, distance_m)?;
        let is_moving = |index: &usize| scenario.obstacles[*index].motion != ObstacleMotion::Static;
        let moving = (0..scenario.obstacles.len()).filter(is_moving).collect();
        Some(Self { grid, parts, moving })
    }

    /// All static parts within `radius_m` of a point, and possibly others, with their distances in m. A part may occur more than
    /// once.
    fn near<'a>(
        &'a self,
        scenario: &'a Scenario,
        point_m: Vec2,
        radius_m: f32,
    ) -> impl Iterator<Item = (Solid, f32)> + 'a {
        let parts = self.grid.near(point_m, radius_m).map(|part| self.parts[part]);
        parts.map(move |part| (part.solid(), part.distance_m(scenario, point_m)))
    }

    fn moving<'a>(
        &'a self,
        scenario: IndexedScenario<'a>,
        point_m: Vec2,
        step: u64,
    ) -> impl Iterator<Item = (Solid, f32)> + 'a {
        let distance =
            move |&index| (Solid::Obstacle(index), scenario.obstacle_distance(index, point_m, step));
        self.moving.iter().map(distance)
    }
}

/// A scenario with its spatial index, if it has one, and the current state of its pedestrians. A `&Scenario` converts into
/// one without an index, whose pedestrians are as at the start of an episode.
#[derive(Clone, Copy, Debug)]
pub struct IndexedScenario<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// Its index.
    pub index: Option<&'a SpatialIndex>,
    /// Its pedestrians; `None` if they are as at the start of an episode.
    pub crowd: Option<&'a Crowd>,
}

impl<'a> From<&'a Scenario> for IndexedScenario<'a> {
    fn from(scenario: &'a Scenario) -> Self {
        Self { scenario, index: None, crowd: None }
    }
}

impl<'a> IndexedScenario<'a> {
    /// The state of the obstacle with this index, if it is a pedestrian; `None` if it is not, or if there is no `crowd`.
    #[must_use]
    pub fn pedestrian(self, obstacle: usize) -> Option<&'a Pedestrian> {
        self.crowd.and_then(|crowd| crowd.pedestrian(obstacle))
    }

    /// The pose of the obstacle with this index, at `step` or, if it is a pedestrian, now: x in m, y in m, rotation in rad.
    #[must_use]
    pub fn pose_at(self, obstacle: usize, step: u64) -> (f32, f32, f32) {
        let pose = pose_at(&self.scenario.obstacles[obstacle], step, self.scenario.task.control_period_s);
        match self.pedestrian(obstacle) {
            Some(Pedestrian { position_m, .. }) => (position_m.x, position_m.y, pose.2),
            None => pose,
        }
    }

    /// The distance in m from `point_m` to the obstacle with this index at `step`; negative inside it.
    pub(super) fn obstacle_distance(self, obstacle: usize, point_m: Vec2, step: u64) -> f32 {
        shape_distance(&self.scenario.obstacles[obstacle].shape, self.pose_at(obstacle, step), point_m)
    }

    /// Whether the [`clearance`](super::clearance) of `point_m` at `step` is at least `clearance_m`.
    #[must_use]
    pub fn is_clear(self, point_m: Vec2, step: u64, clearance_m: f32) -> bool {
        let Some(index) = self.index else { return is_clear(self, point_m, step, clearance_m) };
        enclosure_distance(&self.scenario.enclosure, point_m) >= clearance_m
            && index.near(self.scenario, point_m, clearance_m).all(|(_, other)| other >= clearance_m)
            && index.moving(self, point_m, step).all(|(_, other)| other >= clearance_m)
    }

    /// Like [`nearest`](super::nearest): the part that is nearest to `point_m` at `step`, and its distance in m.
    #[must_use]
    pub fn nearest(self, point_m: Vec2, step: u64) -> (Solid, f32) {
        let Some(index) = self.index else { return nearest_of(self, point_m, step) };
        let nearer = |best: (Solid, f32), other: (Solid, f32)| {
            let is_nearer = other.1 < best.1 || (other.1 == best.1 && other.0 < best.0);
            if is_nearer { other } else { best }
        };
        let enclosure = (Solid::Enclosure, enclosure_distance(&self.scenario.enclosure, point_m));
        let mut best = index.moving(self, point_m, step).fold(enclosure, nearer);
        let mut radius_m = index.grid.cell_m();
        loop {
            best = index.near(self.scenario, point_m, radius_m).fold(best, nearer);
            // There are no parts beyond the farthest cell. For a NaN point the reach is NaN, which ends the loop.
            let has_more = radius_m <= index.grid.max_distance_m(point_m);
            if best.1 <= radius_m || !has_more {
                return best;
            }
            radius_m *= 2.0;
        }
    }
}
