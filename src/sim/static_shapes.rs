//! The static shapes of a scenario in a grid, for ray casts and contacts in scenarios with many shapes.
//!
//! In: rapier's colliders of what never moves. Out: ranges along beams, and the shapes near a point. Arenas of the same scenario
//! share one [`StaticShapes`], unless it generates many obstacles. The results equal those of testing every shape, bit for bit.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_rapier2d::rapier::geometry::{
    Ball, ColliderHandle, ColliderSet, Cuboid, Ray, Segment, Shape, SharedShape, TypedShape,
};
use bevy_rapier2d::rapier::math::Pose as BodyPose;

use super::contact::distance_m;
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
    /// Boxes around the shapes, which are cheaper to test.
    boxes: Vec<BeamBox>,
    /// The longest beam, in m, for which the grid lists every shape that the beam hits.
    max_range_m: f32,
}

/// A shape at its position.
#[derive(Clone, Debug)]
pub(super) struct StaticShape {
    pub(super) position: BodyPose,
    /// Whether the shape is rotated. Without a rotation, a cast needs no transformation.
    is_rotated: bool,
    kind: Kind,
}

/// A box around a shape, with a margin above the rounding errors of a cast.
#[derive(Clone, Copy, Debug)]
struct BeamBox {
    low: Vec2,
    high: Vec2,
}

/// A LIDAR beam. Heading and directions have length 1.
struct Beam {
    origin: Vec2,
    /// The reciprocals of the coordinates of `direction`.
    per_direction: Vec2,
    /// The robot's heading.
    heading: Vec2,
    /// The beam's direction in the robot's frame.
    in_robot: Vec2,
    /// The beam's direction in the scenario's frame.
    direction: Vec2,
}

/// A copy of a shape. Common kinds are stored inline, so that a cast follows no pointers.
#[derive(Clone, Debug)]
enum Kind {
    Ball(Ball),
    Cuboid(Cuboid),
    Segment(Segment),
    Other(SharedShape),
}

impl StaticShape {
    fn new(position: BodyPose, shape: &SharedShape) -> Self {
        let kind = match shape.as_typed_shape() {
            TypedShape::Ball(ball) => Kind::Ball(*ball),
            TypedShape::Cuboid(cuboid) => Kind::Cuboid(*cuboid),
            TypedShape::Segment(segment) => Kind::Segment(*segment),
            _ => Kind::Other(shape.clone()),
        };
        let is_rotated = position.rotation != BodyPose::IDENTITY.rotation;
        Self { position, is_rotated, kind }
    }

    pub(super) fn shape(&self) -> &dyn Shape {
        match &self.kind {
            Kind::Ball(ball) => ball,
            Kind::Cuboid(cuboid) => cuboid,
            Kind::Segment(segment) => segment,
            Kind::Other(shape) => &**shape,
        }
    }

    /// The distance along a beam, if it is at most `max_m`.
    #[inline]
    fn cast(&self, beam: &Beam, max_m: f32) -> Option<f32> {
        let ray = if self.is_rotated {
            // Rounded as in casts without the grid.
            let local_heading = self.position.inverse_transform_vector(beam.heading);
            Ray::new(self.position.inverse_transform_point(beam.origin), local_heading.rotate(beam.in_robot))
        } else {
            Ray::new(beam.origin - self.position.translation, beam.direction)
        };
        let shape = match &self.kind {
            Kind::Ball(ball) => TypedShape::Ball(ball),
            Kind::Cuboid(cuboid) => TypedShape::Cuboid(cuboid),
            Kind::Segment(segment) => TypedShape::Segment(segment),
            Kind::Other(shape) => shape.as_typed_shape(),
        };
        cast_ray(&shape, &ray, max_m)
    }
}

impl BeamBox {
    /// Whether a beam may hit the box within `max_m`. If not, it cannot hit the shape.
    #[inline]
    fn may_be_hit(&self, beam: &Beam, max_m: f32) -> bool {
        let to_side = |side: Vec2| (side - beam.origin) * beam.per_direction;
        let (a, b) = (to_side(self.low), to_side(self.high));
        let (enter, exit) = (a.min(b).max_element(), a.max(b).min_element());
        // Along a side of the box, these may be NaN, which is no reason to skip the cast.
        !(enter > exit || exit < 0.0 || enter > max_m)
    }
}

impl StaticShapes {
    /// The grid over the static colliders `solids`, for beams of up to `max_range_m`. None if a test of every shape is as fast.
    pub(super) fn new(
        colliders: &ColliderSet,
        solids: impl Iterator<Item = ColliderHandle>,
        max_range_m: f32,
    ) -> Option<Self> {
        let solids: Vec<_> = solids.filter_map(|handle| colliders.get(handle)).collect();
        if solids.len() < UniformGrid::MIN_ITEMS {
            return None;
        }
        let boxes: Vec<_> = solids
            .iter()
            .map(|solid| solid.compute_aabb())
            .map(|bounds| (bounds.mins, bounds.maxs))
            .collect();
        let shapes: Vec<_> =
            solids.iter().map(|solid| StaticShape::new(*solid.position(), solid.shared_shape())).collect();
        // As in `BeamFilter`.
        let largest_m = shapes.iter().map(|one| one.shape().compute_local_bounding_sphere().radius);
        let farthest_m = boxes.iter().flat_map(|(low, high)| [low, high]).map(|at| at.abs().max_element());
        let margin_m = MARGIN * (max_range_m + largest_m.fold(0.0, f32::max))
            + ROUNDING * farthest_m.fold(0.0, f32::max);
        let distance_m = |item: usize, at| distance_m(&shapes[item].position, shapes[item].shape(), at);
        let grid = UniformGrid::new(&boxes, margin_m, distance_m)?;
        let with_margin = |(low, high): (Vec2, Vec2)| BeamBox { low: low - margin_m, high: high + margin_m };
        Some(Self { grid, shapes, boxes: boxes.into_iter().map(with_margin).collect(), max_range_m })
    }

    /// The shapes at most `radius_m` from `at`, and possibly others. A shape may occur more than once.
    pub(super) fn near(&self, at: Vec2, radius_m: f32) -> impl Iterator<Item = &StaticShape> {
        self.grid.near(at, radius_m).map(|item| &self.shapes[item])
    }

    /// Shortens `ranges_m`, one per beam, to the nearest shapes. `heading` and `beams` are unit vectors; `beams` are in the
    /// robot's frame.
    pub(super) fn cast(&self, origin: Vec2, heading: Vec2, beams: &[Vec2], ranges_m: &mut [f32]) {
        let is_inside = self.grid.contains(origin);
        for (&in_robot, range_m) in beams.iter().zip(ranges_m) {
            let direction = heading.rotate(in_robot);
            let beam = Beam { origin, per_direction: direction.recip(), heading, in_robot, direction };
            if is_inside && *range_m <= self.max_range_m {
                *range_m = self.cast_along_cells(&beam, *range_m);
            } else {
                let nearer = |range_m, shape: &StaticShape| shape.cast(&beam, range_m).unwrap_or(range_m);
                *range_m = self.shapes.iter().fold(*range_m, nearer);
            }
        }
    }

    /// The distance along a beam, at most `range_m`, to the nearest shape in the cells that it crosses.
    fn cast_along_cells(&self, beam: &Beam, mut range_m: f32) -> f32 {
        // The shapes of the previous cell, which are not tested again. If there are many, a search in them would take longer.
        let mut tested: &[u32] = &[];
        self.grid.walk(beam.origin, beam.direction, |items, exit_m| {
            let known = if tested.len() <= 4 { tested } else { &[] };
            for item in items {
                let index = *item as usize;
                if self.boxes[index].may_be_hit(beam, range_m) && !known.contains(item) {
                    range_m = self.shapes[index].cast(beam, range_m).unwrap_or(range_m);
                }
            }
            tested = items;
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

    /// Indexes all solids.
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
