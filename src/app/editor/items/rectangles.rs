//! Axis-aligned rectangles: a rectangular enclosure, the region of a rule or of a generator.

use bevy::math::{Vec2, vec2};

use super::super::handle::{Handle, HandleKind};
use super::super::points::{point_to_mm, size_text};
use super::editable::DragTarget;
use crate::scenario::Region;

/// The sides of a rectangle, then its corners, as directions from its centre.
pub(super) const SIDES: [(i8, i8); 8] =
    [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (1, 1), (-1, 1)];

/// Handles on the sides and corners.
pub(super) fn side_handles(centre: Vec2, size: Vec2, about: &'static str) -> Vec<Handle> {
    let handle = |(x, y): (i8, i8)| {
        let at = centre + vec2(f32::from(x), f32::from(y)) * size / 2.0;
        Handle::new(HandleKind::Side(x, y), at, size_text(size), about)
    };
    SIDES.map(handle).into()
}

/// Handles of a region: its sides, corners and middle.
pub(super) fn region_handles(region: Region) -> Vec<Handle> {
    let centre = region.min_m.midpoint(region.max_m);
    let size = region.max_m - region.min_m;
    let mut handles = side_handles(centre, size, "Resize the region");
    handles.push(Handle::new(HandleKind::Middle, centre, size_text(size), "Move the region"));
    handles
}

/// Drags a handle of the region between these corners. A side snaps to the grid; the region keeps a minimum size. `None` if a
/// region has no handle of this kind.
pub(super) fn drag_region(
    (min_m, max_m): (&mut Vec2, &mut Vec2),
    kind: HandleKind,
    target: DragTarget,
) -> Option<()> {
    let DragTarget { position_m: to, snapped_m: snapped, snap, centre_m } = target;
    match kind {
        HandleKind::Middle => {
            let size = *max_m - *min_m;
            *min_m = snap.point(to - size / 2.0, centre_m);
            *max_m = point_to_mm(*min_m + size);
        }
        HandleKind::Side(x, y) => {
            let min_size_m = snap.size(0.0);
            drag_side(x, snapped.x, (&mut min_m.x, &mut max_m.x), min_size_m);
            drag_side(y, snapped.y, (&mut min_m.y, &mut max_m.y), min_size_m);
            (*min_m, *max_m) = (point_to_mm(*min_m), point_to_mm(*max_m));
        }
        _ => return None,
    }
    Some(())
}

/// Moves one end of the interval from `low` to `high`: the high end for side 1, the low end for -1, none for 0.
fn drag_side(side: i8, to: f32, (low, high): (&mut f32, &mut f32), min_size_m: f32) {
    match side {
        1 => *high = to.max(*low + min_size_m),
        -1 => *low = to.min(*high - min_size_m),
        _ => {}
    }
}
