//! The body of an obstacle: its position, rotation and size.
//!
//! Resizing works in the obstacle's local frame and keeps the opposite side in place. If this moves the obstacle's
//! centre, its path moves with it.

use bevy::math::{Vec2, vec2};

use super::super::handle::{Handle, HandleKind};
use super::super::limits::POLYGON_CORNERS;
use super::super::points::{LocalFrame, degrees_text, format_metres, place_text, point_to_mm, size_text};
use super::super::snap::Snap;
use super::editable::DragTarget;
use super::rectangles::SIDES;
use super::{corners, obstacle_path};
use crate::scenario::{Obstacle, Shape, Sizes};

/// Distance of the rotation handle from the shape, in m.
const ROTATION_HANDLE_M: f32 = 0.15;

fn frame_of(obstacle: &Obstacle) -> LocalFrame {
    LocalFrame::new(obstacle.position_m, obstacle.rotation_rad)
}

/// Handles of the shape, the rotation and the position.
pub(super) fn handles(obstacle: &Obstacle) -> Vec<Handle> {
    let (shape, frame) = (&obstacle.shape, frame_of(obstacle));
    let mut handles = shape_handles(shape.clone(), frame);
    if shape.has_orientation() {
        let at = frame.to_world(vec2(shape.bounding_radius_m() + ROTATION_HANDLE_M, 0.0));
        handles.push(Handle::new(HandleKind::Rotate, at, degrees_text(obstacle.rotation_rad), "Rotate"));
    }
    let at = obstacle.position_m;
    handles.push(Handle::new(HandleKind::Middle, at, place_text(at), "Move the obstacle and its path"));
    handles
}

fn shape_handles(mut shape: Shape, frame: LocalFrame) -> Vec<Handle> {
    if let Some(corners_m) = shape.corners_mut() {
        let outline: Vec<Vec2> = corners_m.iter().map(|&corner| frame.to_world(corner)).collect();
        return corners::handles(&outline, true, *POLYGON_CORNERS.end());
    }
    let mut handles = Vec::new();
    let mut add = |kind, local: Vec2, text: String, about| {
        handles.push(Handle::new(kind, frame.to_world(local), text, about));
    };
    let Sizes { width_m, height_m, radius_m } = shape.sizes_mut();
    let value = |size_m: &Option<&mut f32>| size_m.as_deref().copied().unwrap_or_default();
    let (size_m, rounding_m) = (vec2(value(&width_m), value(&height_m)), value(&radius_m));
    let reach_m = size_m / 2.0 + rounding_m;
    if radius_m.is_some() {
        let at = if width_m.is_some() { vec2(0.0, reach_m.y) } else { vec2(rounding_m, 0.0) };
        add(HandleKind::Radius, at, format!("r {} m", format_metres(rounding_m)), "Change the radius");
    }
    match (width_m, height_m) {
        (Some(_), Some(_)) => SIDES.iter().for_each(|&(x, y)| {
            let local = vec2(f32::from(x), f32::from(y)) * reach_m;
            add(HandleKind::Side(x, y), local, size_text(size_m), "Resize");
        }),
        (Some(_), None) => [-1, 1].iter().for_each(|&end| {
            let text = format!("{} m long", format_metres(size_m.x));
            add(HandleKind::End(end), vec2(f32::from(end) * reach_m.x, 0.0), text, "Change the length");
        }),
        _ => {}
    }
    handles
}

/// Drags a handle of the body.
pub(super) fn drag(obstacle: &mut Obstacle, kind: HandleKind, target: DragTarget) -> Option<()> {
    let DragTarget { position_m: to, snapped_m: snapped, snap, .. } = target;
    let frame = frame_of(obstacle);
    let local = frame.to_local(to);
    let Sizes { width_m, height_m, radius_m } = obstacle.shape.sizes_mut();
    let rounding_m = radius_m.as_deref().copied().unwrap_or_default();
    match kind {
        HandleKind::Middle => obstacle_path::translate(obstacle, snapped - obstacle.position_m),
        HandleKind::Radius => {
            *radius_m? = snap.size(if width_m.is_some() { local.y.abs() } else { local.length() });
        }
        HandleKind::End(x) => {
            let x = resize(x, width_m?, local.x, rounding_m, snap);
            move_centre(obstacle, frame, vec2(x, 0.0));
        }
        HandleKind::Side(x, y) => {
            let (width_m, height_m) = (width_m?, height_m?);
            let x = resize(x, width_m, local.x, rounding_m, snap);
            let y = resize(y, height_m, local.y, rounding_m, snap);
            move_centre(obstacle, frame, vec2(x, y));
        }
        HandleKind::Corner(k) => {
            *obstacle.shape.corners_mut()?.get_mut(k)? = point_to_mm(frame.to_local(snapped));
        }
        _ => return None,
    }
    Some(())
}

/// Resizes one axis of a shape: its side (-1 or 1), which is rounded off by `rounding_m`, goes to the local coordinate
/// `to_m`; the other side stays. Side 0 changes nothing. Returns the local coordinate of the new centre.
fn resize(side: i8, size_m: &mut f32, to_m: f32, rounding_m: f32, snap: Snap) -> f32 {
    if side == 0 {
        return 0.0;
    }
    let side = f32::from(side);
    let fixed_m = -side * *size_m / 2.0;
    *size_m = snap.size((to_m - side * rounding_m - fixed_m) * side);
    fixed_m + side * *size_m / 2.0
}

/// Moves the obstacle so that its centre is at a point of its old local frame.
fn move_centre(obstacle: &mut Obstacle, frame: LocalFrame, local_m: Vec2) {
    let centre = point_to_mm(frame.to_world(local_m));
    obstacle_path::translate(obstacle, centre - obstacle.position_m);
}

/// Inserts a corner of a polygon.
pub(super) fn insert(obstacle: &mut Obstacle, kind: HandleKind, position_m: Vec2) -> Option<HandleKind> {
    let HandleKind::InsertCorner(k) = kind else { return None };
    let local = point_to_mm(frame_of(obstacle).to_local(position_m));
    corners::insert(obstacle.shape.corners_mut()?, k, local)
}

/// Removes a corner of a polygon.
pub(super) fn remove(obstacle: &mut Obstacle, kind: HandleKind) -> Option<()> {
    let HandleKind::Corner(k) = kind else { return None };
    corners::remove(obstacle.shape.corners_mut()?, k, *POLYGON_CORNERS.start())
}
