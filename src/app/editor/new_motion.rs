//! New motions that fit the scenario, for an obstacle whose kind of motion is changed.

use std::collections::BTreeSet;

use bevy::math::{Vec2, vec2};

use super::limits::{MAX_POINTS, MAX_SPEED_M_S, NEW_ORBIT_SPEED_RAD_S, NEW_SPEED_M_S};
use super::points::{centre_of, distance, point_to_mm, to_mm};
use crate::scenario::{
    MotionKind, Obstacle, ObstacleMotion, Quantity, Scenario, clearance, enclosure_distance,
};

/// Directions that are tried in this order.
const DIRECTIONS: [Vec2; 4] = [Vec2::NEG_X, Vec2::X, Vec2::NEG_Y, Vec2::Y];

/// A motion of this kind for obstacle `index`. The path and the speed of the old motion are kept if both have them.
pub(super) fn of_kind(scenario: &Scenario, index: usize, kind: MotionKind) -> ObstacleMotion {
    let obstacle = &scenario.obstacles[index];
    let speed_m_s = obstacle.mean_speed_m_s().map_or(NEW_SPEED_M_S, |speed| to_mm(speed).max(0.001));
    let speed_or_range = match obstacle.motion {
        ObstacleMotion::Patrol { speed_m_s, .. }
        | ObstacleMotion::BackAndForth { speed_m_s, .. }
        | ObstacleMotion::RandomWalk { speed_m_s, .. }
        | ObstacleMotion::Pedestrian { speed_m_s, .. } => speed_m_s,
        _ => speed_m_s.into(),
    };
    let path_m = |closed| match obstacle.path_m() {
        Some((corners_m, _)) => corners_m[1..].to_vec(),
        None => path(scenario, index, closed),
    };
    let waypoints_m = |closed| {
        let mut waypoints_m = path_m(closed);
        waypoints_m.truncate(MAX_POINTS);
        waypoints_m
    };
    // An open path with several legs must not be closed: the straight way back may lead through a wall.
    let loops = obstacle.path_m().is_none_or(|(corners_m, closed)| closed || corners_m.len() == 2);
    match kind {
        MotionKind::Static => ObstacleMotion::Static,
        MotionKind::Orbit => orbit(scenario, obstacle),
        MotionKind::Patrol => {
            ObstacleMotion::Patrol { waypoints_m: waypoints_m(true), speed_m_s: speed_or_range }
        }
        MotionKind::BackAndForth => {
            ObstacleMotion::BackAndForth { waypoints_m: waypoints_m(false), speed_m_s: speed_or_range }
        }
        MotionKind::Pedestrian => {
            let goals_m = waypoints_m(false);
            ObstacleMotion::Pedestrian { goals_m, speed_m_s: speed_or_range, loops, sees_robot: false }
        }
        MotionKind::KeyFrames => {
            ObstacleMotion::key_frames_along(obstacle.position_m, &path_m(true), speed_m_s, loops)
        }
        MotionKind::RandomWalk => {
            let free_m = enclosure_distance(&scenario.enclosure, obstacle.position_m);
            let radius_m = to_mm((free_m - obstacle.shape.bounding_radius_m()).min(0.5));
            let seed = unused_seed(scenario, u32::try_from(index).unwrap_or_default());
            let radius_m = radius_m.max(*Quantity::Reach.range().start());
            ObstacleMotion::RandomWalk { radius_m, speed_m_s: speed_or_range, seed }
        }
    }
}

/// The first seed from `from` on that no random walk of the scenario has, so that no two obstacles walk alike.
pub(super) fn unused_seed(scenario: &Scenario, from: u32) -> u32 {
    let seed_of = |obstacle: &Obstacle| match obstacle.motion {
        ObstacleMotion::RandomWalk { seed, .. } => Some(seed),
        _ => None,
    };
    let used: BTreeSet<u32> = scenario.obstacles.iter().filter_map(seed_of).collect();
    (0..=u32::MAX).map(|k| from.wrapping_add(k)).find(|seed| !used.contains(seed)).unwrap_or(from)
}

/// An orbit around the centre of the scenario if it stays inside the enclosure, else a small one around a point nearby.
fn orbit(scenario: &Scenario, obstacle: &Obstacle) -> ObstacleMotion {
    let (at, radius_m) = (obstacle.position_m, obstacle.shape.bounding_radius_m());
    let centre = point_to_mm(centre_of(scenario));
    let radii = [0.5, 0.3, 0.2, 0.1];
    let nearby = radii.into_iter().flat_map(|r| DIRECTIONS.map(|direction| at + r * direction));
    let fits = |centre: &Vec2| {
        let orbit_m = distance(*centre, at);
        orbit_m >= 0.05 && enclosure_distance(&scenario.enclosure, *centre) >= orbit_m + radius_m
    };
    let centre_m = std::iter::once(centre).chain(nearby).find(fits).unwrap_or(at + vec2(-0.1, 0.0));
    let max_rad_s = MAX_SPEED_M_S / distance(centre_m, at).max(0.01);
    ObstacleMotion::Orbit {
        centre_m: point_to_mm(centre_m),
        speed_rad_s: NEW_ORBIT_SPEED_RAD_S.min(max_rad_s).into(),
    }
}

/// Waypoints for obstacle `index`: a square, or one straight line. If possible, the path is clear of other items;
/// otherwise, if possible, it is inside the enclosure.
fn path(scenario: &Scenario, index: usize, square: bool) -> Vec<Vec2> {
    let mut others = scenario.clone();
    let obstacle = others.obstacles.remove(index);
    let (at, radius_m) = (obstacle.position_m, obstacle.shape.bounding_radius_m());
    let lengths = [1.0, 0.75, 0.5, 0.3, 0.2, 0.1];
    let candidates: Vec<Vec<Vec2>> = lengths
        .into_iter()
        .flat_map(|length_m| DIRECTIONS.map(|direction| candidate(at, direction, length_m, square)))
        .collect();
    let clear = |path: &&Vec<Vec2>| {
        samples(at, path, square).iter().all(|&point| clearance(&others, point, 0) >= radius_m)
    };
    let inside = |path: &&Vec<Vec2>| {
        let free_m = |&point: &Vec2| enclosure_distance(&others.enclosure, point);
        samples(at, path, square).iter().all(|point| free_m(point) >= radius_m)
    };
    let found = candidates.iter().find(clear).or_else(|| candidates.iter().find(inside));
    found.or(candidates.last()).cloned().unwrap_or_default()
}

/// The far end of a line, or the three other corners of a square counterclockwise.
fn candidate(from: Vec2, Vec2 { x, y }: Vec2, length_m: f32, square: bool) -> Vec<Vec2> {
    let corners = [vec2(x, y), vec2(x - y, y + x), vec2(-y, x)];
    corners[..if square { 3 } else { 1 }]
        .iter()
        .map(|&corner| point_to_mm(from + length_m * corner))
        .collect()
}

/// Eight points of each leg and, for a square, one of the leg back to the start.
fn samples(from: Vec2, path: &[Vec2], square: bool) -> Vec<Vec2> {
    let corners: Vec<Vec2> = std::iter::once(from).chain(path.iter().copied()).collect();
    let legs = corners.windows(2).flat_map(|ends| {
        let (start, leg) = (ends[0], ends[1] - ends[0]);
        (1..=8_u8).map(move |k| start + leg * f32::from(k) / 8.0)
    });
    legs.chain(square.then(|| from.midpoint(*corners.last().unwrap_or(&from)))).collect()
}
