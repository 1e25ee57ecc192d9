//! The body of an obstacle: its place, its turn, its sizes.
//!
//! In: the obstacle, a handle. Out: the obstacle, resized in its own frame so that what is opposite stays, or turned.
//! Where its middle goes by that, its way goes along.

use super::corners;
use super::handles::{Handle, HandleKind};
use super::obstacle_path;
use super::points::{LocalFrame, degrees_text, format_metres, minus, place_text, point_to_mm, size_text};
use super::snap::Snap;
use crate::scenario::{Obstacle, Shape};
use bevy::math::{Vec2, vec2};

/// How few and how many corners a polygon has.
const POLYGON: (usize, usize) = (3, 32);
/// How far beyond the shape the handle is that turns it, in m.
const TURN_M: f32 = 0.15;

/// From a shape's middle to its farthest point, in m.
pub(super) fn bounding_radius(shape: &Shape) -> f32 {
    match shape {
        Shape::Circle { radius_m } => *radius_m,
        Shape::Rectangle { width_m, height_m } => (width_m / 2.0).hypot(height_m / 2.0),
        Shape::Polygon { corners_m } => corners_m.iter().map(|&Vec2 { x, y }| x.hypot(y)).fold(0.0, f32::max),
        Shape::Capsule { length_m, radius_m } => length_m / 2.0 + radius_m,
    }
}

/// Whether it looks another when it is turned.
pub(super) fn turns(shape: &Shape) -> bool {
    !matches!(shape, Shape::Circle { .. })
}

fn frame_of(obstacle: &Obstacle) -> LocalFrame {
    LocalFrame::new(obstacle.position_m, obstacle.rotation_rad)
}

/// Its handles.
pub(super) fn handles(obstacle: &Obstacle) -> Vec<Handle> {
    let frame = frame_of(obstacle);
    let mut all = Vec::new();
    let mut add = |kind, own: Vec2, text: String, about| {
        all.push(Handle::new(kind, frame.to_world(own), text, about));
    };
    match &obstacle.shape {
        Shape::Circle { radius_m } => {
            add(
                HandleKind::Radius,
                vec2(*radius_m, 0.0),
                format!("r {} m", format_metres(*radius_m)),
                "Its radius",
            );
        }
        Shape::Rectangle { width_m, height_m } => {
            for (x, y) in SIDES {
                let at = vec2(f32::from(x) * width_m / 2.0, f32::from(y) * height_m / 2.0);
                add(HandleKind::Side(x, y), at, size_text(*width_m, *height_m), "Its size");
            }
        }
        Shape::Capsule { length_m, radius_m } => {
            add(
                HandleKind::Radius,
                vec2(0.0, *radius_m),
                format!("r {} m", format_metres(*radius_m)),
                "Half its width",
            );
            for (right, side) in [(false, -1.0), (true, 1.0)] {
                let at = vec2(side * (length_m / 2.0 + radius_m), 0.0);
                add(
                    HandleKind::CapsuleEnd(right),
                    at,
                    format!("{} m long", format_metres(*length_m)),
                    "Its length",
                );
            }
        }
        Shape::Polygon { corners_m } => {
            let outline: Vec<Vec2> = corners_m.iter().map(|&corner| frame.to_world(corner)).collect();
            all = corners::handles(&outline, true, POLYGON.1);
        }
    }
    if turns(&obstacle.shape) {
        let at = frame.to_world(vec2(bounding_radius(&obstacle.shape) + TURN_M, 0.0));
        all.push(Handle::new(HandleKind::Rotate, at, degrees_text(obstacle.rotation_rad), "Turns it"));
    }
    let about = "Moves it, and its path with it";
    let at = obstacle.position_m;
    all.push(Handle::new(HandleKind::Middle, at, place_text(at), about));
    all
}

/// The sides, and on top of them the corners, of a rectangle in its own frame.
pub(super) const SIDES: [(i8, i8); 8] =
    [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (1, 1), (-1, 1)];

/// Drags a handle of it to `to`, or to `snapped`.
pub(super) fn drag(
    obstacle: &mut Obstacle,
    kind: HandleKind,
    to: Vec2,
    snapped: Vec2,
    snap: Snap,
) -> Option<()> {
    let frame = frame_of(obstacle);
    let own = frame.to_local(to);
    let at = obstacle.position_m;
    match (kind, &mut obstacle.shape) {
        (HandleKind::Middle, _) => obstacle_path::shift(obstacle, minus(snapped, at)),
        (HandleKind::Radius, Shape::Circle { radius_m }) => *radius_m = snap.size(own.x.hypot(own.y)),
        (HandleKind::Radius, Shape::Capsule { radius_m, .. }) => *radius_m = snap.size(own.y.abs()),
        (HandleKind::CapsuleEnd(right), Shape::Capsule { length_m, radius_m }) => {
            let side = if right { 1.0 } else { -1.0 };
            let stays = -side * *length_m / 2.0;
            *length_m = snap.size((own.x - stays) * side - *radius_m);
            let middle = vec2(stays + side * *length_m / 2.0, 0.0);
            obstacle_path::shift(obstacle, minus(point_to_mm(frame.to_world(middle)), at));
        }
        (HandleKind::Side(x, y), Shape::Rectangle { width_m, height_m }) => {
            let along = |side: i8, size: &mut f32, own: f32| {
                if side == 0 {
                    return 0.0;
                }
                let side = f32::from(side);
                let stays = -side * *size / 2.0;
                *size = snap.size((own - stays) * side);
                stays + side * *size / 2.0
            };
            let middle = vec2(along(x, width_m, own.x), along(y, height_m, own.y));
            obstacle_path::shift(obstacle, minus(point_to_mm(frame.to_world(middle)), at));
        }
        (HandleKind::Corner(k), Shape::Polygon { corners_m }) => {
            *corners_m.get_mut(k)? = point_to_mm(frame.to_local(snapped));
        }
        _ => return None,
    }
    Some(())
}

/// A new corner of a polygon.
pub(super) fn insert(obstacle: &mut Obstacle, kind: HandleKind, at: Vec2) -> Option<HandleKind> {
    let own = point_to_mm(frame_of(obstacle).to_local(at));
    match (kind, &mut obstacle.shape) {
        (HandleKind::InsertCorner(k), Shape::Polygon { corners_m }) => corners::insert(corners_m, k, own),
        _ => None,
    }
}

/// A corner of a polygon taken out.
pub(super) fn remove(obstacle: &mut Obstacle, kind: HandleKind) -> Option<()> {
    match (kind, &mut obstacle.shape) {
        (HandleKind::Corner(k), Shape::Polygon { corners_m }) => corners::remove(corners_m, k, POLYGON.0),
        _ => None,
    }
}
