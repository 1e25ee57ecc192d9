//! Lists of points: the corners of walls and polygons, and the points of paths and rules.

use bevy::math::Vec2;

use super::super::handle::{Handle, HandleKind};
use super::super::points::{place_text, point_to_mm};

/// A handle for each corner and, if there are fewer than `max` corners, a handle on each side that inserts a corner.
pub(super) fn handles(corners: &[Vec2], closed: bool, max: usize) -> Vec<Handle> {
    let mut handles = Vec::new();
    if corners.len() < max {
        let sides = corners.len().saturating_sub(usize::from(!closed));
        handles.extend((0..sides).map(|k| {
            let at = corners[k].midpoint(corners[(k + 1) % corners.len()]);
            Handle::new(HandleKind::InsertCorner(k + 1), at, place_text(at), "Drag to add a corner")
        }));
    }
    handles.extend(corners.iter().enumerate().map(|(k, &at)| {
        let about = "Move this corner; double-click removes it";
        Handle::new(HandleKind::Corner(k), at, place_text(at), about)
    }));
    handles
}

/// Inserts a corner before corner `k`.
pub(super) fn insert(corners: &mut Vec<Vec2>, k: usize, position_m: Vec2) -> Option<HandleKind> {
    if k > corners.len() {
        return None;
    }
    corners.insert(k, position_m);
    Some(HandleKind::Corner(k))
}

/// Removes corner `k` if at least `min` corners remain.
pub(super) fn remove(corners: &mut Vec<Vec2>, k: usize, min: usize) -> Option<()> {
    if k >= corners.len() || corners.len() <= min {
        return None;
    }
    corners.remove(k);
    Some(())
}

/// Moves all points, and rounds them to 1 mm.
pub(super) fn translate<'a>(corners: impl IntoIterator<Item = &'a mut Vec2>, by_m: Vec2) {
    for corner in corners {
        *corner = point_to_mm(*corner + by_m);
    }
}
