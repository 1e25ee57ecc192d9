//! The motion of an obstacle: its waypoints, the centre of its orbit, the radius of its random walk.

use bevy::math::{Vec2, vec2};

use super::super::handle::{Handle, HandleKind};
use super::super::limits::MAX_POINTS;
use super::super::points::{distance, format_metres, place_text, point_to_mm};
use super::corners;
use super::editable::DragTarget;
use crate::scenario::{Obstacle, Quantity, Track};

/// Handles of the path, the centre or the reach.
pub(super) fn handles(obstacle: &Obstacle) -> Vec<Handle> {
    let at = obstacle.position_m;
    match obstacle.track() {
        Track::Point => Vec::new(),
        Track::Lines { corners_m, closed } => path_handles(&corners_m, closed),
        Track::Circle { centre_m } => {
            let text = format!("r {} m", format_metres(distance(centre_m, at)));
            vec![Handle::new(HandleKind::Centre, centre_m, text, "Move the centre of the orbit")]
        }
        Track::Disc { radius_m } => {
            let (edge, text) = (at + vec2(0.0, radius_m), format!("{} m", format_metres(radius_m)));
            vec![Handle::new(HandleKind::Reach, edge, text, "Change the largest distance from the position")]
        }
    }
}

/// Handles of the path: new waypoints on its legs, then its start and waypoints. A path with more waypoints than can be
/// drawn has a handle only at its start.
fn path_handles(path: &[Vec2], closed: bool) -> Vec<Handle> {
    let mut handles = Vec::new();
    let path = if path.len() > MAX_POINTS + 1 { &path[..1] } else { path };
    if path.len() <= MAX_POINTS {
        let legs = if closed && path.len() > 2 { path.len() } else { path.len() - 1 };
        handles.extend((0..legs).map(|k| {
            let at = path[k].midpoint(path[(k + 1) % path.len()]);
            Handle::new(HandleKind::InsertWaypoint(k), at, place_text(at), "Drag to add a waypoint")
        }));
    }
    handles.extend(path.iter().enumerate().map(|(k, &at)| {
        let (kind, about) = match k.checked_sub(1) {
            None => (HandleKind::PathStart, "Move the start of the path; the waypoints stay"),
            Some(k) => (HandleKind::Waypoint(k), "Move this waypoint; double-click removes it"),
        };
        Handle::new(kind, at, place_text(at), about)
    }));
    handles
}

/// Drags a handle of the motion.
pub(super) fn drag(obstacle: &mut Obstacle, kind: HandleKind, target: DragTarget) -> Option<()> {
    let motion = &mut obstacle.motion;
    match kind {
        HandleKind::PathStart => {
            motion.waypoint_mut(0)?;
            obstacle.position_m = target.snapped_m;
        }
        HandleKind::Waypoint(k) => *motion.waypoint_mut(k)? = target.snapped_m,
        HandleKind::Centre => *motion.centre_mut()? = target.snapped_m,
        HandleKind::Reach => {
            let reach_m = distance(obstacle.position_m, target.position_m);
            *motion.number_mut(Quantity::Reach)? = target.snap.size(reach_m);
        }
        _ => return None,
    }
    Some(())
}

/// Inserts a waypoint.
pub(super) fn insert(obstacle: &mut Obstacle, kind: HandleKind, position_m: Vec2) -> Option<HandleKind> {
    let HandleKind::InsertWaypoint(k) = kind else { return None };
    obstacle.motion.insert_waypoint(k, position_m)?;
    Some(HandleKind::Waypoint(k))
}

/// Removes a waypoint, unless it is the only one.
pub(super) fn remove(obstacle: &mut Obstacle, kind: HandleKind) -> Option<()> {
    let HandleKind::Waypoint(k) = kind else { return None };
    obstacle.motion.remove_waypoint(k)
}

/// Moves the obstacle and its motion.
pub(super) fn translate(obstacle: &mut Obstacle, by_m: Vec2) {
    obstacle.position_m = point_to_mm(obstacle.position_m + by_m);
    corners::translate(obstacle.motion.points_mut(), by_m);
}
