//! Lists of corners: walls, and enclosures that are polygons.
//!
//! In: the corners, a handle. Out: the corners, one of them dragged, put in or taken out.

use super::handles::{Handle, HandleKind};
use super::points::{middle, minus, place_text, plus, point_to_mm};
use bevy::math::Vec2;

/// How few and how many corners a wall has.
pub(super) const WALL: (usize, usize) = (2, 256);
/// How few and how many corners an enclosure has.
pub(super) const ENCLOSURE: (usize, usize) = (3, 64);

/// A handle for each corner, and one for a new corner on each straight piece unless there are as many as there may be.
pub(super) fn handles(corners: &[Vec2], closed: bool, most: usize) -> Vec<Handle> {
    let mut all = Vec::new();
    if corners.len() < most {
        let pieces = corners.len().saturating_sub(usize::from(!closed));
        all.extend((0..pieces).map(|k| {
            let at = middle(corners[k], corners[(k + 1) % corners.len()]);
            Handle::new(HandleKind::InsertCorner(k + 1), at, place_text(at), "Drag a new corner out of here")
        }));
    }
    all.extend(corners.iter().enumerate().map(|(k, &at)| {
        Handle::new(HandleKind::Corner(k), at, place_text(at), "A corner; double click takes it out")
    }));
    all
}

/// Drags a corner, or by the middle (which is the first corner) all of them.
pub(super) fn drag(corners: &mut [Vec2], kind: HandleKind, to: Vec2) -> Option<()> {
    match kind {
        HandleKind::Corner(k) => *corners.get_mut(k)? = to,
        HandleKind::Middle => {
            let by = minus(to, *corners.first()?);
            shift(corners, by);
        }
        _ => return None,
    }
    Some(())
}

/// Puts a corner in before corner `k`.
pub(super) fn insert(corners: &mut Vec<Vec2>, k: usize, at: Vec2) -> Option<HandleKind> {
    if k > corners.len() {
        return None;
    }
    corners.insert(k, at);
    Some(HandleKind::Corner(k))
}

/// Takes corner `k` out, if more than `least` are there.
pub(super) fn remove(corners: &mut Vec<Vec2>, k: usize, least: usize) -> Option<()> {
    if k >= corners.len() || corners.len() <= least {
        return None;
    }
    corners.remove(k);
    Some(())
}

/// Moves them all.
pub(super) fn shift<'a>(corners: impl IntoIterator<Item = &'a mut Vec2>, by: Vec2) {
    for corner in corners {
        *corner = point_to_mm(plus(*corner, by));
    }
}
