//! The body of an obstacle: its position, rotation and size.
//!
//! Resizing works in the obstacle's local frame and keeps the opposite side in place. Where that moves the obstacle's
//! centre, its path moves with it.

use bevy::math::{Vec2, vec2};

use super::super::handle::{Handle, HandleKind};
use super::super::limits::POLYGON_CORNERS;
use super::super::points::{LocalFrame, degrees_text, format_metres, place_text, point_to_mm, size_text};
use super::super::snap::Snap;
use super::editable::DragTarget;
use super::rectangles::SIDES;
use super::{corners, obstacle_path};
use crate::scenario::{Obstacle, Shape};

/// Distance of the rotation handle from the shape, in m.
const ROTATION_HANDLE_M: f32 = 0.15;

/// Whether rotating the shape changes it.
pub(super) fn can_rotate(shape: &Shape) -> bool {
    !matches!(shape, Shape::Circle { .. })
}

fn frame_of(obstacle: &Obstacle) -> LocalFrame {
    LocalFrame::new(obstacle.position_m, obstacle.rotation_rad)
}

/// Handles of the shape, the rotation and the position.
pub(super) fn handles(obstacle: &Obstacle) -> Vec<Handle> {
    let frame = frame_of(obstacle);
    let mut handles = shape_handles(&obstacle.shape, frame);
    if can_rotate(&obstacle.shape) {
        let at = frame.to_world(vec2(obstacle.shape.bounding_radius_m() + ROTATION_HANDLE_M, 0.0));
        handles.push(Handle::new(HandleKind::Rotate, at, degrees_text(obstacle.rotation_rad), "Rotate"));
    }
    let at = obstacle.position_m;
    handles.push(Handle::new(HandleKind::Middle, at, place_text(at), "Move the obstacle and its path"));
    handles
}

fn shape_handles(shape: &Shape, frame: LocalFrame) -> Vec<Handle> {
    let handle =
        |kind, local: Vec2, text: String, about| Handle::new(kind, frame.to_world(local), text, about);
    let radius_text = |radius_m: f32| format!("r {} m", format_metres(radius_m));
    match shape {
        Shape::Circle { radius_m: r } => {
            vec![handle(HandleKind::Radius, vec2(*r, 0.0), radius_text(*r), "Change the radius")]
        }
        Shape::Rectangle { width_m, height_m } => {
            let side = |(x, y): (i8, i8)| {
                let local = vec2(f32::from(x) * width_m / 2.0, f32::from(y) * height_m / 2.0);
                handle(HandleKind::Side(x, y), local, size_text(vec2(*width_m, *height_m)), "Resize")
            };
            SIDES.map(side).into()
        }
        Shape::Capsule { length_m, radius_m: r } => {
            let end = |right: bool, sign: f32| {
                let text = format!("{} m long", format_metres(*length_m));
                handle(
                    HandleKind::CapsuleEnd(right),
                    vec2(sign * (length_m / 2.0 + r), 0.0),
                    text,
                    "Change the length",
                )
            };
            let radius = handle(HandleKind::Radius, vec2(0.0, *r), radius_text(*r), "Change the radius");
            vec![radius, end(false, -1.0), end(true, 1.0)]
        }
        Shape::Polygon { corners_m } => {
            let outline: Vec<Vec2> = corners_m.iter().map(|&corner| frame.to_world(corner)).collect();
            corners::handles(&outline, true, *POLYGON_CORNERS.end())
        }
    }
}

/// Drags a handle of the body.
pub(super) fn drag(obstacle: &mut Obstacle, kind: HandleKind, target: DragTarget) -> Option<()> {
    let DragTarget { position_m: to, snapped_m: snapped, snap, .. } = target;
    let frame = frame_of(obstacle);
    let local = frame.to_local(to);
    match (kind, &mut obstacle.shape) {
        (HandleKind::Middle, _) => {
            obstacle_path::translate(obstacle, snapped - obstacle.position_m);
        }
        (HandleKind::Radius, Shape::Circle { radius_m }) => *radius_m = snap.size(local.x.hypot(local.y)),
        (HandleKind::Radius, Shape::Capsule { radius_m, .. }) => *radius_m = snap.size(local.y.abs()),
        (HandleKind::CapsuleEnd(right), Shape::Capsule { length_m, radius_m }) => {
            let side = if right { 1 } else { -1 };
            let x = resize(side, length_m, local.x - f32::from(side) * *radius_m, snap);
            move_centre(obstacle, frame, vec2(x, 0.0));
        }
        (HandleKind::Side(x, y), Shape::Rectangle { width_m, height_m }) => {
            let centre = vec2(resize(x, width_m, local.x, snap), resize(y, height_m, local.y, snap));
            move_centre(obstacle, frame, centre);
        }
        (HandleKind::Corner(k), Shape::Polygon { corners_m }) => {
            *corners_m.get_mut(k)? = point_to_mm(frame.to_local(snapped));
        }
        _ => return None,
    }
    Some(())
}

/// Resizes one axis of a shape: its side (-1 or 1) goes to the local coordinate `to_m`, the other side stays; side 0
/// changes nothing. Returns the local coordinate of the new centre.
fn resize(side: i8, size_m: &mut f32, to_m: f32, snap: Snap) -> f32 {
    if side == 0 {
        return 0.0;
    }
    let side = f32::from(side);
    let fixed_m = -side * *size_m / 2.0;
    *size_m = snap.size((to_m - fixed_m) * side);
    fixed_m + side * *size_m / 2.0
}

/// Moves the obstacle so that its centre is at a point of its old local frame.
fn move_centre(obstacle: &mut Obstacle, frame: LocalFrame, local_m: Vec2) {
    let centre = point_to_mm(frame.to_world(local_m));
    obstacle_path::translate(obstacle, centre - obstacle.position_m);
}

/// Inserts a corner of a polygon.
pub(super) fn insert(obstacle: &mut Obstacle, kind: HandleKind, position_m: Vec2) -> Option<HandleKind> {
    let local = point_to_mm(frame_of(obstacle).to_local(position_m));
    match (kind, &mut obstacle.shape) {
        (HandleKind::InsertCorner(k), Shape::Polygon { corners_m }) => corners::insert(corners_m, k, local),
        _ => None,
    }
}

/// Removes a corner of a polygon.
pub(super) fn remove(obstacle: &mut Obstacle, kind: HandleKind) -> Option<()> {
    match (kind, &mut obstacle.shape) {
        (HandleKind::Corner(k), Shape::Polygon { corners_m }) => {
            corners::remove(corners_m, k, *POLYGON_CORNERS.start())
        }
        _ => None,
    }
}
