//! Clutter at random positions, with a gap around every obstacle.

use std::f32::consts::PI;

use wayfield_random::{Stream, uniform};

use super::draft::Draft;
use super::{number, one_of, whole};
use crate::schema::{Obstacle, ObstacleMotion, RandomShape, Shape};

/// Attempts to place an obstacle before it is omitted.
const TRIES: usize = 50;

/// Adds a random number of obstacles with random shapes.
pub(super) fn add(draft: &mut Draft, count: (u32, u32), shapes: &[RandomShape], stream: &mut Stream) {
    for _ in 0..whole(stream, count) {
        let Some(shape) = one_of(shapes, stream).map(|shape| sized(shape, stream)) else { return };
        let placed = (0..TRIES).map(|_| placed(draft, &shape, stream)).find(|it| draft.has_space_for(it));
        if let Some(obstacle) = placed {
            draft.add_obstacle(obstacle);
        }
    }
}

fn sized(shape: &RandomShape, stream: &mut Stream) -> Shape {
    match *shape {
        RandomShape::Circle { radius_m } => Shape::Circle { radius_m: number(stream, radius_m) },
        RandomShape::Rectangle { width_m, height_m } => {
            Shape::Rectangle { width_m: number(stream, width_m), height_m: number(stream, height_m) }
        }
    }
}

/// An obstacle at a random position in the field, with a random rotation unless its shape is a circle.
fn placed(draft: &Draft, shape: &Shape, stream: &mut Stream) -> Obstacle {
    let position_m = draft.random_point(stream);
    let rotation_rad = if shape.has_orientation() { uniform(stream, -PI, PI) } else { 0.0 };
    Obstacle { shape: shape.clone(), position_m, rotation_rad, motion: ObstacleMotion::Static }
}
