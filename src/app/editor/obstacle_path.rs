//! The way of an obstacle that moves: the corners of its path, the centre of its orbit, how far it strays.
//!
//! In: the obstacle, a handle. Out: the obstacle with its motion changed.

use super::corners::{self, shift as shift_all};
use super::handles::{Handle, HandleKind};
use super::points::{distance, format_metres, middle, place_text, plus, point_to_mm};
use super::snap::Snap;
use crate::scenario::{Obstacle, ObstacleMotion};
use bevy::math::{Vec2, vec2};

/// The most waypoints of a path.
const MAX_WAYPOINTS: usize = 256;

/// Its handles.
pub(super) fn handles(obstacle: &Obstacle) -> Vec<Handle> {
    let mut all = Vec::new();
    if let Some((path, closed)) = obstacle.path_m() {
        let legs = if closed && path.len() > 2 { path.len() } else { path.len() - 1 };
        if path.len() <= MAX_WAYPOINTS {
            all.extend((0..legs).map(|k| {
                let at = middle(path[k], path[(k + 1) % path.len()]);
                let about = "Drag a new corner of the path out of here";
                Handle::new(HandleKind::InsertWaypoint(k), at, place_text(at), about)
            }));
        }
        all.extend(path.iter().enumerate().map(|(k, &at)| match k.checked_sub(1) {
            None => Handle::new(
                HandleKind::PathStart,
                at,
                place_text(at),
                "Where its path begins; the rest stays",
            ),
            Some(k) => {
                let about = "A corner of its path; double click takes it out";
                Handle::new(HandleKind::Waypoint(k), at, place_text(at), about)
            }
        }));
    }
    match &obstacle.motion {
        ObstacleMotion::Orbit { centre_m, .. } => {
            let text = format!("r {} m", format_metres(distance(*centre_m, obstacle.position_m)));
            all.push(Handle::new(HandleKind::OrbitCentre, *centre_m, text, "What it revolves about"));
        }
        ObstacleMotion::RandomWalk { radius_m, .. } => {
            let at = plus(obstacle.position_m, vec2(0.0, *radius_m));
            let text = format!("{} m", format_metres(*radius_m));
            all.push(Handle::new(HandleKind::WalkReach, at, text, "How far it strays"));
        }
        _ => {}
    }
    all
}

fn waypoints(obstacle: &mut Obstacle) -> Option<&mut Vec<Vec2>> {
    match &mut obstacle.motion {
        ObstacleMotion::Patrol { waypoints_m, .. } | ObstacleMotion::BackAndForth { waypoints_m, .. } => {
            Some(waypoints_m)
        }
        _ => None,
    }
}

/// Drags a handle of it to `to`, or to `snapped`.
pub(super) fn drag(
    obstacle: &mut Obstacle,
    kind: HandleKind,
    to: Vec2,
    snapped: Vec2,
    snap: Snap,
) -> Option<()> {
    let at = obstacle.position_m;
    match (kind, &mut obstacle.motion) {
        (HandleKind::PathStart, _) => {
            waypoints(obstacle)?;
            obstacle.position_m = snapped;
        }
        (HandleKind::Waypoint(k), _) => *waypoints(obstacle)?.get_mut(k)? = snapped,
        (HandleKind::OrbitCentre, ObstacleMotion::Orbit { centre_m, .. }) => *centre_m = snapped,
        (HandleKind::WalkReach, ObstacleMotion::RandomWalk { radius_m, .. }) => {
            *radius_m = snap.size(distance(at, to));
        }
        _ => return None,
    }
    Some(())
}

/// A new waypoint.
pub(super) fn insert(obstacle: &mut Obstacle, kind: HandleKind, at: Vec2) -> Option<HandleKind> {
    let HandleKind::InsertWaypoint(k) = kind else { return None };
    corners::insert(waypoints(obstacle)?, k, at)?;
    Some(HandleKind::Waypoint(k))
}

/// A waypoint taken out; one stays.
pub(super) fn remove(obstacle: &mut Obstacle, kind: HandleKind) -> Option<()> {
    let HandleKind::Waypoint(k) = kind else { return None };
    corners::remove(waypoints(obstacle)?, k, 1)
}

/// Moves it with all its way.
pub(super) fn shift(obstacle: &mut Obstacle, by: Vec2) {
    obstacle.position_m = point_to_mm(plus(obstacle.position_m, by));
    if let Some(waypoints) = waypoints(obstacle) {
        shift_all(waypoints, by);
    }
    if let ObstacleMotion::Orbit { centre_m, .. } = &mut obstacle.motion {
        *centre_m = point_to_mm(plus(*centre_m, by));
    }
}
