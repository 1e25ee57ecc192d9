//! U-shaped traps: three walls around a space that is open on one side.

use std::f32::consts::PI;

use glam::{Vec2, vec2};
use wayfield_random::{Stream, uniform};

use super::draft::Draft;
use super::{number, whole};
use crate::schema::Wall;

/// Thickness of the walls, in m.
const THICKNESS_M: f32 = 0.1;
/// Attempts to place a trap before it is omitted.
const TRIES: usize = 50;

/// Adds traps with random sizes, positions and rotations.
pub(super) fn add(
    draft: &mut Draft,
    count: (u32, u32),
    width_m: (f32, f32),
    depth_m: (f32, f32),
    stream: &mut Stream,
) {
    for _ in 0..whole(stream, count) {
        let size = vec2(number(stream, width_m), number(stream, depth_m)) + THICKNESS_M;
        let mut walls = (0..TRIES).map(|_| trap(draft, size, stream));
        if let Some(wall) = walls.find(|wall| wall.pieces().all(|piece| draft.has_space_for(&piece))) {
            draft.add_wall(wall);
        }
    }
}

/// A trap whose walls have centre lines of width and depth `size`, at a random position with a random rotation.
fn trap(draft: &Draft, size: Vec2, stream: &mut Stream) -> Wall {
    let middle = draft.random_point(stream);
    let (sin, cos) = libm::sincosf(uniform(stream, -PI, PI));
    let (x, y) = (size.x / 2.0, size.y / 2.0);
    let corners = [vec2(-x, y), vec2(-x, -y), vec2(x, -y), vec2(x, y)];
    let place = |at: Vec2| middle + vec2(at.x * cos - at.y * sin, at.x * sin + at.y * cos);
    Wall { corners_m: corners.map(place).to_vec(), thickness_m: THICKNESS_M, ..Wall::default() }
}
