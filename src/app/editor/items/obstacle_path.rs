//! The motion of an obstacle: its waypoints, the centre of its orbit, the radius of its random walk.

use bevy::math::{Vec2, vec2};

use super::super::handle::{Handle, HandleKind};
use super::super::limits::MAX_POINTS;
use super::super::points::{distance, format_metres, place_text, point_to_mm};
use super::corners;
use super::editable::DragTarget;
use crate::scenario::{Obstacle, ObstacleMotion};

/// Handles of the path, the orbit or the random walk.
pub(super) fn handles(obstacle: &Obstacle) -> Vec<Handle> {
    let mut handles = path_handles(obstacle);
    match &obstacle.motion {
        ObstacleMotion::Orbit { centre_m, .. } => {
            let text = format!("r {} m", format_metres(distance(*centre_m, obstacle.position_m)));
            let about = "Move the centre of the orbit";
            handles.push(Handle::new(HandleKind::OrbitCentre, *centre_m, text, about));
        }
        ObstacleMotion::RandomWalk { radius_m, .. } => {
            let at = obstacle.position_m + vec2(0.0, *radius_m);
            let text = format!("{} m", format_metres(*radius_m));
            let about = "Change the radius of the random walk";
            handles.push(Handle::new(HandleKind::WalkRadius, at, text, about));
        }
        _ => {}
    }
    handles
}

/// Handles of the path: new waypoints on its legs, then its start and waypoints.
fn path_handles(obstacle: &Obstacle) -> Vec<Handle> {
    let Some((path, closed)) = obstacle.path_m() else { return Vec::new() };
    let mut handles = Vec::new();
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

fn waypoints(obstacle: &mut Obstacle) -> Option<&mut Vec<Vec2>> {
    match &mut obstacle.motion {
        ObstacleMotion::Patrol { waypoints_m, .. } | ObstacleMotion::BackAndForth { waypoints_m, .. } => {
            Some(waypoints_m)
        }
        _ => None,
    }
}

/// Drags a handle of the motion.
pub(super) fn drag(obstacle: &mut Obstacle, kind: HandleKind, target: DragTarget) -> Option<()> {
    match (kind, &mut obstacle.motion) {
        (HandleKind::PathStart, _) => {
            waypoints(obstacle)?;
            obstacle.position_m = target.snapped_m;
        }
        (HandleKind::Waypoint(k), _) => *waypoints(obstacle)?.get_mut(k)? = target.snapped_m,
        (HandleKind::OrbitCentre, ObstacleMotion::Orbit { centre_m, .. }) => *centre_m = target.snapped_m,
        (HandleKind::WalkRadius, ObstacleMotion::RandomWalk { radius_m, .. }) => {
            *radius_m = target.snap.size(distance(obstacle.position_m, target.position_m));
        }
        _ => return None,
    }
    Some(())
}

/// Inserts a waypoint.
pub(super) fn insert(obstacle: &mut Obstacle, kind: HandleKind, position_m: Vec2) -> Option<HandleKind> {
    let HandleKind::InsertWaypoint(k) = kind else { return None };
    corners::insert(waypoints(obstacle)?, k, position_m)?;
    Some(HandleKind::Waypoint(k))
}

/// Removes a waypoint, unless it is the last.
pub(super) fn remove(obstacle: &mut Obstacle, kind: HandleKind) -> Option<()> {
    let HandleKind::Waypoint(k) = kind else { return None };
    corners::remove(waypoints(obstacle)?, k, 1)
}

/// Moves the obstacle and its motion.
pub(super) fn translate(obstacle: &mut Obstacle, by_m: Vec2) {
    obstacle.position_m = point_to_mm(obstacle.position_m + by_m);
    if let Some(waypoints) = waypoints(obstacle) {
        corners::translate(waypoints, by_m);
    }
    if let ObstacleMotion::Orbit { centre_m, .. } = &mut obstacle.motion {
        *centre_m = point_to_mm(*centre_m + by_m);
    }
}
