//! Rectangles along the world's axes: the enclosure, the region of a rule or of a generator.
//!
//! In: the rectangle, a handle. Out: the rectangle, resized or moved.

use super::body::SIDES;
use super::handles::{Handle, HandleKind};
use super::points::{middle, minus, plus, point_to_mm, size_text};
use super::snap::Snap;
use crate::scenario::Region;
use bevy::math::{Vec2, vec2};

/// The least extent of an enclosure, in m.
const MIN_ENCLOSURE_M: f32 = 0.5;

/// The handles of an enclosure of this size.
pub(super) fn of_enclosure(width_m: f32, height_m: f32) -> Vec<Handle> {
    sides(Vec2::ZERO, vec2(width_m, height_m), "The world's size; its middle stays")
}

/// Those of a region.
pub(super) fn of_region(region: Region) -> Vec<Handle> {
    let at = middle(region.min_m, region.max_m);
    let Vec2 { x: width, y: height } = minus(region.max_m, region.min_m);
    let mut all = sides(at, vec2(width, height), "The region's size");
    all.push(Handle::new(HandleKind::Middle, at, size_text(width, height), "Moves the region"));
    all
}

fn sides(centre: Vec2, Vec2 { x: width, y: height }: Vec2, about: &'static str) -> Vec<Handle> {
    let handle = |(x, y): (i8, i8)| {
        let at = plus(centre, vec2(f32::from(x) * width / 2.0, f32::from(y) * height / 2.0));
        Handle::new(HandleKind::Side(x, y), at, size_text(width, height), about)
    };
    SIDES.map(handle).into()
}

/// Drags a side or corner of the enclosure; its middle stays, so that what is opposite goes as far.
pub(super) fn drag_enclosure(
    (width_m, height_m): (&mut f32, &mut f32),
    (x, y): (i8, i8),
    to: Vec2,
    snap: Snap,
) {
    for (size, side, at) in [(width_m, x, to.x), (height_m, y, to.y)] {
        if side != 0 {
            *size = snap.size(2.0 * at * f32::from(side)).max(MIN_ENCLOSURE_M);
        }
    }
}

/// Drags a side, a corner or the middle of a region. A side goes on the grid; one step or a centimetre is left.
pub(super) fn drag_region(
    (min_m, max_m): (&mut Vec2, &mut Vec2),
    kind: HandleKind,
    to: Vec2,
    snap: Snap,
    centre: Vec2,
) -> Option<()> {
    match kind {
        HandleKind::Middle => {
            let size = minus(*max_m, *min_m);
            *min_m = snap.point(minus(to, vec2(size.x / 2.0, size.y / 2.0)), centre);
            *max_m = point_to_mm(plus(*min_m, size));
        }
        HandleKind::Side(x, y) => {
            let to = snap.point(to, centre);
            let least = snap.size(0.0);
            for (side, at, low, high) in
                [(x, to.x, &mut min_m.x, &mut max_m.x), (y, to.y, &mut min_m.y, &mut max_m.y)]
            {
                match side {
                    1 => *high = at.max(*low + least),
                    -1 => *low = at.min(*high - least),
                    _ => {}
                }
            }
            (*min_m, *max_m) = (point_to_mm(*min_m), point_to_mm(*max_m));
        }
        _ => return None,
    }
    Some(())
}
