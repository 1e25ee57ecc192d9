//! The static shapes of a scenario in a grid, for ray casts and contacts in scenarios with many shapes.
//!
//! In: rapier's colliders of what never moves. Out: ranges along beams, and the shapes near a point. Arenas of the same scenario
//! share one [`StaticShapes`], unless the scenario generates many obstacles. The results equal those of testing every shape, bit
//! for bit.

use std::sync::Arc;

use bevy::math::Vec4;
use bevy::prelude::*;
use bevy_rapier2d::rapier::geometry::{ColliderHandle, ColliderSet, Ray, SharedShape};
use bevy_rapier2d::rapier::math::Pose as BodyPose;

use super::contact::distance_m;
use super::four_shapes::{Beam, FourCircles, FourRectangles};
use super::physics::Bodies;
use super::ray_cast::{MARGIN, cast_ray};
use crate::scenario::UniformGrid;

/// The rounding error of coordinates in a cast, relative to the coordinates.
const ROUNDING: f32 = 1e-5;

/// Shapes that never move, and a grid over them.
#[derive(Debug)]
pub(super) struct StaticShapes {
    grid: UniformGrid,
    shapes: Vec<StaticShape>,
    /// The circles and rectangles of every cell of the grid, cell by cell, in groups of up to four.
    circles: Vec<FourCircles>,
    rectangles: Vec<FourRectangles>,
    /// Shapes of other kinds, cell by cell, as indices into `shapes`.
    others: Vec<u32>,
    /// Where the shapes of each cell begin; one more entry than cells.
    starts: Vec<CellStart>,
    /// The longest beam, in m, for which the grid lists every shape that the beam hits.
    max_range_m: f32,
}

/// The indices at which a cell's shapes begin in the lists of [`StaticShapes`].
#[derive(Clone, Copy, Debug)]
struct CellStart {
    circles: u32,
    rectangles: u32,
    others: u32,
}

/// A shape at its position.
#[derive(Debug)]
pub(super) struct StaticShape {
    pub(super) position: BodyPose,
    pub(super) shape: SharedShape,
    /// A box around it, with a margin above the rounding errors of a cast: its lower left and upper right corners, in m.
    low: Vec2,
    high: Vec2,
}

impl StaticShape {
    /// The distance along a beam, if it is at most `max_m`.
    fn cast(&self, beam: &Beam, max_m: f32) -> Option<f32> {
        let local_heading = self.position.inverse_transform_vector(beam.heading);
        let origin = self.position.inverse_transform_point(beam.origin);
        cast_ray(&self.shape.as_typed_shape(), &Ray::new(origin, local_heading.rotate(beam.in_robot)), max_m)
    }

    /// Whether a beam may hit the box within `max_m`. If not, it cannot hit the shape.
    fn may_be_hit(&self, beam: &Beam, max_m: f32) -> bool {
        let to_side = |side: Vec2| (side - beam.origin) / beam.direction;
        let (a, b) = (to_side(self.low), to_side(self.high));
        let (enter, exit) = (a.min(b).max_element(), a.max(b).min_element());
        // Along a side of the box, these may be NaN, which is no reason to skip the cast.
        !(enter > exit || exit < 0.0 || enter > max_m)
    }

    /// Whether the shape may be at most `radius_m` from a point.
    fn may_be_near(&self, at: Vec2, radius_m: f32) -> bool {
        self.low.cmple(at + radius_m).all() && self.high.cmpge(at - radius_m).all()
    }

    /// The radius of a circle, in m; `None` if it is rotated, since [`FourCircles`] would then round differently.
    fn circle(&self) -> Option<f32> {
        let is_rotated = self.position.rotation != BodyPose::IDENTITY.rotation;
        self.shape.as_ball().filter(|_| !is_rotated).map(|ball| ball.radius)
    }

    /// The half extents of a rectangle, in m.
    fn rectangle(&self) -> Option<Vec2> {
        self.shape.as_cuboid().map(|cuboid| cuboid.half_extents)
    }
}

impl StaticShapes {
    /// The grid over the static colliders `solids`, for beams of up to `max_range_m`. `None` if a test of every shape is as fast.
    pub(super) fn new(
        colliders: &ColliderSet,
        solids: impl Iterator<Item = ColliderHandle>,
        max_range_m: f32,
    ) -> Option<Self> {
        let solids: Vec<_> = solids.filter_map(|handle| colliders.get(handle)).collect();
        if solids.len() < UniformGrid::MIN_ITEMS {
            return None;
        }
        let bounds: Vec<_> = solids.iter().map(|solid| solid.compute_aabb()).collect();
        let farthest_m = bounds.iter().flat_map(|bounds| [bounds.mins, bounds.maxs]);
        let farthest_m = farthest_m.map(|at| at.abs().max_element()).fold(0.0, f32::max);
        // As in `BeamFilter`, for a shape that a beam reaches.
        let margin_m = |shape: &SharedShape| {
            MARGIN * (max_range_m + 2.0 * shape.compute_local_bounding_sphere().radius)
                + ROUNDING * farthest_m
        };
        let shapes = solids.iter().zip(bounds).map(|(solid, bounds)| {
            let (position, shape) = (*solid.position(), solid.shared_shape().clone());
            let margin_m = margin_m(&shape);
            StaticShape { position, shape, low: bounds.mins - margin_m, high: bounds.maxs + margin_m }
        });
        let shapes: Vec<_> = shapes.collect();
        let boxes: Vec<_> = shapes.iter().map(|shape| (shape.low, shape.high)).collect();
        let distance_m = |index: usize, at| {
            let StaticShape { position, shape, .. } = &shapes[index];
            distance_m(position, &**shape, at) - margin_m(shape)
        };
        let grid = UniformGrid::new(&boxes, distance_m)?;
        let (circles, rectangles, others, starts) = Default::default();
        let mut static_shapes = Self { grid, shapes, circles, rectangles, others, starts, max_range_m };
        static_shapes.fill_cells();
        Some(static_shapes)
    }

    /// Sorts the shapes of every cell of the grid by kind.
    fn fill_cells(&mut self) {
        for cell in self.grid.cells() {
            self.starts.push(self.next_start());
            let (mut circles, mut rectangles) = (Vec::new(), Vec::new());
            for &index in cell {
                let shape = &self.shapes[index as usize];
                if let Some(radius_m) = shape.circle() {
                    circles.push((&shape.position, radius_m));
                } else if let Some(half_extents) = shape.rectangle() {
                    rectangles.push((&shape.position, half_extents));
                } else {
                    self.others.push(index);
                }
            }
            self.circles.extend(circles.chunks(4).map(FourCircles::new));
            self.rectangles.extend(rectangles.chunks(4).map(FourRectangles::new));
        }
        self.starts.push(self.next_start());
    }

    fn next_start(&self) -> CellStart {
        CellStart {
            circles: self.circles.len() as u32,
            rectangles: self.rectangles.len() as u32,
            others: self.others.len() as u32,
        }
    }

    /// The shapes at most `radius_m` from `at`, and possibly others. A shape may occur more than once.
    pub(super) fn near(&self, at: Vec2, radius_m: f32) -> impl Iterator<Item = &StaticShape> {
        let near = self.grid.near(at, radius_m).map(|index| &self.shapes[index]);
        near.filter(move |shape| shape.may_be_near(at, radius_m))
    }

    /// Shortens `ranges_m`, one per beam, to the nearest shapes. `heading` and `beams` are unit vectors; `beams` are in the
    /// robot's frame.
    pub(super) fn cast(&self, origin: Vec2, heading: Vec2, beams: &[Vec2], ranges_m: &mut [f32]) {
        let is_inside = self.grid.contains(origin);
        for (&in_robot, range_m) in beams.iter().zip(ranges_m) {
            let direction = heading.rotate(in_robot);
            let beam = Beam { origin, heading, in_robot, direction };
            if is_inside && *range_m <= self.max_range_m {
                *range_m = self.cast_along_cells(&beam, *range_m);
            } else {
                let nearer = |range_m, shape: &StaticShape| shape.cast(&beam, range_m).unwrap_or(range_m);
                *range_m = self.shapes.iter().fold(*range_m, nearer);
            }
        }
    }

    /// The distance along a beam, at most `range_m`, to the nearest shape in the cells that it crosses.
    #[inline(always)]
    fn cast_along_cells(&self, beam: &Beam, mut range_m: f32) -> f32 {
        self.grid.walk(beam.origin, beam.direction, |cell, exit_m| {
            let (start, end) = (self.starts[cell], self.starts[cell + 1]);
            let mut nearest_m = Vec4::splat(range_m);
            for circles in &self.circles[start.circles as usize..end.circles as usize] {
                nearest_m = nearest_m.min(circles.cast(beam));
            }
            for rectangles in &self.rectangles[start.rectangles as usize..end.rectangles as usize] {
                nearest_m = nearest_m.min(rectangles.cast(beam));
            }
            range_m = nearest_m.min_element();
            for &index in &self.others[start.others as usize..end.others as usize] {
                let shape = &self.shapes[index as usize];
                if shape.may_be_hit(beam, range_m) {
                    range_m = shape.cast(beam, range_m).unwrap_or(range_m);
                }
            }
            range_m > exit_m
        });
        range_m
    }
}

impl Bodies {
    /// Removes the grid. Every query then tests every solid, with the same results. For comparisons.
    pub fn remove_grid(&mut self) {
        self.set_grid(None);
    }

    /// The solids that are not in the grid, each with its index in `solids`.
    pub(super) fn not_in_grid(&self) -> impl Iterator<Item = (usize, ColliderHandle)> {
        self.not_in_grid.iter().map(|&index| (index, self.solids[index]))
    }

    /// Indexes all static solids.
    pub(super) fn index_solids(&mut self, colliders: &ColliderSet, max_range_m: f32) {
        let grid = self.make_grid(colliders, max_range_m);
        self.set_grid(grid);
    }

    /// Indexes the generated obstacles after they have been replaced. If there are only a few, they stay outside the grid.
    pub(super) fn index_generated(&mut self, colliders: &ColliderSet, max_range_m: f32) {
        if self.generated.len() < UniformGrid::MIN_ITEMS {
            let permanent = self.solids.iter().take_while(|solid| !self.generated.contains(solid)).count();
            self.not_in_grid.retain(|&index| index < permanent);
            self.not_in_grid.extend(permanent..self.solids.len());
        } else {
            self.index_solids(colliders, max_range_m);
        }
    }

    /// The grid over all static solids.
    fn make_grid(&self, colliders: &ColliderSet, max_range_m: f32) -> Option<Arc<StaticShapes>> {
        let indices = (0..self.solids.len()).filter(|&index| !self.moves(index));
        StaticShapes::new(colliders, indices.map(|index| self.solids[index]), max_range_m).map(Arc::new)
    }

    /// Uses the grid from [`Self::make_grid`].
    fn set_grid(&mut self, grid: Option<Arc<StaticShapes>>) {
        let indices = 0..self.solids.len();
        self.not_in_grid = indices.filter(|&index| grid.is_none() || self.moves(index)).collect();
        self.static_shapes = grid;
    }

    fn moves(&self, index: usize) -> bool {
        self.obstacles.get(index).is_some_and(Option::is_some)
    }
}
