//! Distances in a scenario, worked in f64 from its numbers: the truth that LIDAR and clearances are held against.

use bevy::math::Vec2;
use wayfield::scenario::{Obstacle, Scenario, Shape, pose_at};

/// The distance from `origin` along `angle_rad` to the nearest surface at `step`, at most `max_m`; 0 from inside.
pub fn range(scenario: &Scenario, step: u64, origin: (f64, f64), angle_rad: f64, max_m: f64) -> f64 {
    let (sin, cos) = angle_rad.sin_cos();
    let corners = scenario.enclosure.corners_m();
    let walls = sides(&corners);
    let mut nearest = walls.filter_map(|side| to_side(origin, (cos, sin), side)).fold(max_m, f64::min);
    for obstacle in all(scenario) {
        let (x, y, turn) = pose_at(&obstacle, step, scenario.task.control_period_s);
        let (from, way) = in_frame(origin, (cos, sin), (f64::from(x), f64::from(y)), f64::from(turn));
        let hit = match obstacle.shape {
            Shape::Circle { radius_m } => to_circle(from, way, f64::from(radius_m)),
            Shape::Rectangle { width_m, height_m } => {
                to_box(from, way, (f64::from(width_m) / 2.0, f64::from(height_m) / 2.0))
            }
            Shape::Capsule { length_m, radius_m } => {
                // A box with a disc at either end.
                let (half, radius) = (f64::from(length_m) / 2.0, f64::from(radius_m));
                let ends = [-half, half].map(|x| to_circle((from.0 - x, from.1), way, radius));
                let parts = [to_box(from, way, (half, radius)), ends[0], ends[1]];
                parts.into_iter().flatten().reduce(f64::min)
            }
            Shape::Polygon { ref corners_m } if depth(corners_m, from) >= 0.0 => Some(0.0),
            Shape::Polygon { ref corners_m } => {
                sides(corners_m).filter_map(|side| to_side(from, way, side)).reduce(f64::min)
            }
        };
        nearest = nearest.min(hit.unwrap_or(f64::INFINITY));
    }
    nearest.max(0.0)
}

/// [`range`], and how far it moves when the beam is shifted sideways by 10 um: where a beam grazes a surface or a
/// corner, the rounding of f32 decides whether it hits.
pub fn range_bounds(
    scenario: &Scenario,
    step: u64,
    origin: (f64, f64),
    angle_rad: f64,
    max_m: f64,
) -> (f64, f64) {
    let (sin, cos) = angle_rad.sin_cos();
    let shifted = [-1e-5, 0.0, 1e-5]
        .map(|by| range(scenario, step, (origin.0 - by * sin, origin.1 + by * cos), angle_rad, max_m));
    (shifted.into_iter().fold(f64::INFINITY, f64::min), shifted.into_iter().fold(0.0, f64::max))
}

/// The distance from a point to the nearest surface at `step`; negative inside an obstacle or beyond a wall.
pub fn clearance(scenario: &Scenario, step: u64, point: (f64, f64)) -> f64 {
    let to_walls = depth(&scenario.enclosure.corners_m(), point);
    let to_obstacle = |obstacle: Obstacle| {
        let (x, y, turn) = pose_at(&obstacle, step, scenario.task.control_period_s);
        let ((x, y), _) = in_frame(point, (1.0, 0.0), (f64::from(x), f64::from(y)), f64::from(turn));
        match obstacle.shape {
            Shape::Circle { radius_m } => x.hypot(y) - f64::from(radius_m),
            Shape::Rectangle { width_m, height_m } => {
                let (past_x, past_y) =
                    (x.abs() - f64::from(width_m) / 2.0, y.abs() - f64::from(height_m) / 2.0);
                if past_x < 0.0 && past_y < 0.0 {
                    past_x.max(past_y)
                } else {
                    past_x.max(0.0).hypot(past_y.max(0.0))
                }
            }
            Shape::Capsule { length_m, radius_m } => {
                (x.abs() - f64::from(length_m) / 2.0).max(0.0).hypot(y) - f64::from(radius_m)
            }
            Shape::Polygon { ref corners_m } => -depth(corners_m, (x, y)),
        }
    };
    all(scenario).map(to_obstacle).fold(to_walls, f64::min)
}

type Pair = (f64, f64);

/// Obstacles, and the pieces of inner walls.
fn all(scenario: &Scenario) -> impl Iterator<Item = Obstacle> {
    scenario
        .obstacles
        .iter()
        .cloned()
        .chain(scenario.walls.iter().flat_map(wayfield_scenario::Wall::segments))
}

fn sides(corners: &[Vec2]) -> impl Iterator<Item = (Pair, Pair)> {
    let wide = |Vec2 { x, y }: Vec2| (f64::from(x), f64::from(y));
    corners.iter().zip(corners.iter().cycle().skip(1)).map(move |(a, b)| (wide(*a), wide(*b)))
}

/// From a point to the nearest side of a polygon; negative outside (by its winding number).
fn depth(corners: &[Vec2], point: Pair) -> f64 {
    let (mut nearest, mut turns) = (f64::INFINITY, 0.0);
    for (a, b) in sides(corners) {
        let (from, to) = ((a.0 - point.0, a.1 - point.1), (b.0 - point.0, b.1 - point.1));
        turns += (from.0 * to.1 - from.1 * to.0).atan2(from.0 * to.0 + from.1 * to.1);
        let way = (b.0 - a.0, b.1 - a.1);
        let along = -(from.0 * way.0 + from.1 * way.1) / (way.0 * way.0 + way.1 * way.1);
        let part = along.clamp(0.0, 1.0);
        nearest = nearest.min((from.0 + part * way.0).hypot(from.1 + part * way.1));
    }
    if turns.abs() > 3.0 { nearest } else { -nearest }
}

/// How far a ray goes to a segment, if it meets it.
fn to_side(from: Pair, way: Pair, (a, b): (Pair, Pair)) -> Option<f64> {
    let (side, gap) = ((b.0 - a.0, b.1 - a.1), (a.0 - from.0, a.1 - from.1));
    let cross = way.0 * side.1 - way.1 * side.0;
    let (distance, part) =
        ((gap.0 * side.1 - gap.1 * side.0) / cross, (gap.0 * way.1 - gap.1 * way.0) / cross);
    (distance >= 0.0 && (0.0..=1.0).contains(&part)).then_some(distance)
}

/// A point and a direction as seen from a frame at `centre`, turned by `turn_rad`.
fn in_frame(point: Pair, way: Pair, centre: Pair, turn_rad: f64) -> (Pair, Pair) {
    let (sin, cos) = turn_rad.sin_cos();
    let turned = |(x, y): Pair| (x * cos + y * sin, y * cos - x * sin);
    (turned((point.0 - centre.0, point.1 - centre.1)), turned(way))
}

fn to_circle(from: Pair, way: Pair, radius: f64) -> Option<f64> {
    let outside = from.0 * from.0 + from.1 * from.1 - radius * radius;
    if outside <= 0.0 {
        return Some(0.0);
    }
    let ahead = -(from.0 * way.0 + from.1 * way.1);
    let discriminant = ahead * ahead - outside;
    (ahead > 0.0 && discriminant >= 0.0).then(|| ahead - discriminant.sqrt())
}

fn to_box(from: Pair, way: Pair, half: Pair) -> Option<f64> {
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for (at, along, half) in [(from.0, way.0, half.0), (from.1, way.1, half.1)] {
        let (a, b) = ((-half - at) / along, (half - at) / along);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter <= leave).then_some(enter)
}
