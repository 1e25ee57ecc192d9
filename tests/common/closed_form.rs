//! Reference distances in a scenario, computed in f64 from its numbers, to compare LIDAR ranges and clearances with.

use bevy::math::Vec2;
use wayfield::scenario::{Obstacle, Scenario, Shape, pose_at};

/// The distance from `origin` along `angle_rad` to the nearest surface at `step`, at most `max_m`; 0 inside an obstacle.
pub fn range(scenario: &Scenario, step: u64, origin: (f64, f64), angle_rad: f64, max_m: f64) -> f64 {
    range_to_grown(scenario, step, origin, angle_rad, max_m, Growth::NONE)
}

/// By how much the rounding of f32 may make shapes appear larger or smaller to a beam.
#[derive(Clone, Copy)]
struct Growth {
    /// How far the sides of polygons reach past their corners, as a fraction of their length. The simulator extends them
    /// by 1e-5, so that no beam slips through a corner.
    sides: f64,
    /// What is added to the square of a circle's radius, as a fraction of the squared distance to its centre: the
    /// rounding of the quadratic equation's terms.
    circles: f64,
}

impl Growth {
    const NONE: Self = Self { sides: 0.0, circles: 0.0 };
    const LARGEST: Self = Self { sides: 1.1e-5, circles: 4e-7 };
    const SMALLEST: Self = Self { sides: 0.0, circles: -4e-7 };
}

/// [`range`] to shapes that are larger or smaller by `growth`.
fn range_to_grown(
    scenario: &Scenario,
    step: u64,
    origin: (f64, f64),
    angle_rad: f64,
    max_m: f64,
    growth: Growth,
) -> f64 {
    let (sin, cos) = angle_rad.sin_cos();
    let corners = scenario.enclosure.corners_m();
    let to_side = |from, direction, side| to_side(from, direction, side, growth.sides);
    let to_circle = |from, direction, radius| to_circle(from, direction, radius, growth.circles);
    let walls = sides(&corners);
    let mut nearest = walls.filter_map(|side| to_side(origin, (cos, sin), side)).fold(max_m, f64::min);
    for obstacle in obstacles_and_walls(scenario) {
        let (x, y, turn) = pose_at(&obstacle, step, scenario.task.control_period_s);
        let (from, direction) = in_frame(origin, (cos, sin), (f64::from(x), f64::from(y)), f64::from(turn));
        let hit = match obstacle.shape {
            Shape::Circle { radius_m } => to_circle(from, direction, f64::from(radius_m)),
            Shape::Rectangle { width_m, height_m } => {
                to_box(from, direction, (f64::from(width_m) / 2.0, f64::from(height_m) / 2.0))
            }
            Shape::Capsule { length_m, radius_m } => {
                // A box with a disc at each end.
                let (half, radius) = (f64::from(length_m) / 2.0, f64::from(radius_m));
                let ends = [-half, half].map(|x| to_circle((from.0 - x, from.1), direction, radius));
                let parts = [to_box(from, direction, (half, radius)), ends[0], ends[1]];
                parts.into_iter().flatten().reduce(f64::min)
            }
            Shape::Polygon { ref corners_m } if depth(corners_m, from) >= 0.0 => Some(0.0),
            Shape::Polygon { ref corners_m } => {
                sides(corners_m).filter_map(|side| to_side(from, direction, side)).reduce(f64::min)
            }
        };
        nearest = nearest.min(hit.unwrap_or(f64::INFINITY));
    }
    nearest.max(0.0)
}

/// The smallest and largest [`range`] of the beam shifted sideways by at most 10 um, to shapes within their [`Growth`]. If
/// a beam grazes a surface or a corner, the rounding of f32 decides whether it hits.
pub fn range_bounds(
    scenario: &Scenario,
    step: u64,
    origin: (f64, f64),
    angle_rad: f64,
    max_m: f64,
) -> (f64, f64) {
    let (sin, cos) = angle_rad.sin_cos();
    let bounds = [-1e-5, 0.0, 1e-5].map(|by| {
        let shifted = (origin.0 - by * sin, origin.1 + by * cos);
        let at = |growth| range_to_grown(scenario, step, shifted, angle_rad, max_m, growth);
        (at(Growth::LARGEST), at(Growth::SMALLEST))
    });
    bounds.into_iter().fold((f64::INFINITY, 0.0), |(low, high), (a, b)| (a.min(low), b.max(high)))
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
    obstacles_and_walls(scenario).map(to_obstacle).fold(to_walls, f64::min)
}

type Pair = (f64, f64);

/// The obstacles and the segments of inner walls.
fn obstacles_and_walls(scenario: &Scenario) -> impl Iterator<Item = Obstacle> {
    scenario.obstacles.iter().cloned().chain(scenario.walls.iter().flat_map(wayfield_scenario::Wall::pieces))
}

fn sides(corners: &[Vec2]) -> impl Iterator<Item = (Pair, Pair)> {
    let to_f64 = |Vec2 { x, y }: Vec2| (f64::from(x), f64::from(y));
    corners.iter().zip(corners.iter().cycle().skip(1)).map(move |(a, b)| (to_f64(*a), to_f64(*b)))
}

/// The distance from a point to the nearest side of a polygon; negative outside, by the winding number.
fn depth(corners: &[Vec2], point: Pair) -> f64 {
    let (mut nearest, mut turns) = (f64::INFINITY, 0.0);
    for (a, b) in sides(corners) {
        let (from, to) = ((a.0 - point.0, a.1 - point.1), (b.0 - point.0, b.1 - point.1));
        turns += (from.0 * to.1 - from.1 * to.0).atan2(from.0 * to.0 + from.1 * to.1);
        let side = (b.0 - a.0, b.1 - a.1);
        let projection = -(from.0 * side.0 + from.1 * side.1) / (side.0 * side.0 + side.1 * side.1);
        let fraction = projection.clamp(0.0, 1.0);
        nearest = nearest.min((from.0 + fraction * side.0).hypot(from.1 + fraction * side.1));
    }
    if turns.abs() > 3.0 { nearest } else { -nearest }
}

/// The distance along a ray to a segment, if the ray hits it.
fn to_side(from: Pair, direction: Pair, (a, b): (Pair, Pair), extension: f64) -> Option<f64> {
    let (side, gap) = ((b.0 - a.0, b.1 - a.1), (a.0 - from.0, a.1 - from.1));
    let cross = direction.0 * side.1 - direction.1 * side.0;
    let distance = (gap.0 * side.1 - gap.1 * side.0) / cross;
    let fraction = (gap.0 * direction.1 - gap.1 * direction.0) / cross;
    (distance >= 0.0 && (-extension..=1.0 + extension).contains(&fraction)).then_some(distance)
}

/// A point and a direction in the frame with its origin at `centre`, rotated by `turn_rad`.
fn in_frame(point: Pair, direction: Pair, centre: Pair, turn_rad: f64) -> (Pair, Pair) {
    let (sin, cos) = turn_rad.sin_cos();
    let rotated = |(x, y): Pair| (x * cos + y * sin, y * cos - x * sin);
    (rotated((point.0 - centre.0, point.1 - centre.1)), rotated(direction))
}

/// The distance along a ray to a circle around the origin, if the ray hits it.
fn to_circle(from: Pair, direction: Pair, radius: f64, growth: f64) -> Option<f64> {
    let squared = from.0 * from.0 + from.1 * from.1;
    let outside = squared * (1.0 - growth) - radius * radius;
    if outside <= 0.0 {
        return Some(0.0);
    }
    let ahead = -(from.0 * direction.0 + from.1 * direction.1);
    let discriminant = ahead * ahead - outside;
    (ahead > 0.0 && discriminant >= 0.0).then(|| ahead - discriminant.sqrt())
}

/// The distance along a ray to a box around the origin with half sizes `half`, if the ray hits it.
fn to_box(from: Pair, direction: Pair, half: Pair) -> Option<f64> {
    let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
    for (at, component, half) in [(from.0, direction.0, half.0), (from.1, direction.1, half.1)] {
        let (a, b) = ((-half - at) / component, (half - at) / component);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter <= leave).then_some(enter)
}
