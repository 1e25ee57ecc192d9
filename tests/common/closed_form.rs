//! Distances in a scenario, worked in f64 from its numbers: the truth that LIDAR and clearances are held against.

use wayfield::scenario::{Enclosure, Scenario, Shape, pose_at};

/// The distance from `origin` along `angle_rad` to the nearest surface at `step`, at most `max_m`; 0 from inside.
pub fn range(scenario: &Scenario, step: u64, origin: (f64, f64), angle_rad: f64, max_m: f64) -> f64 {
    let Enclosure::Rectangle { width_m, height_m } = scenario.enclosure;
    let (half_width, half_height) = (f64::from(width_m) / 2.0, f64::from(height_m) / 2.0);
    let (sin, cos) = angle_rad.sin_cos();
    let to_wall = |half: f64, at: f64, along: f64| (half * along.signum() - at) / along;
    let mut nearest = max_m.min(to_wall(half_width, origin.0, cos)).min(to_wall(half_height, origin.1, sin));
    for obstacle in &scenario.obstacles {
        let (x, y, turn) = pose_at(obstacle, step, scenario.task.control_period_s);
        let (from, way) = in_frame(origin, (cos, sin), (f64::from(x), f64::from(y)), f64::from(turn));
        let hit = match obstacle.shape {
            Shape::Circle { radius_m } => to_circle(from, way, f64::from(radius_m)),
            Shape::Rectangle { width_m, height_m } => {
                to_box(from, way, (f64::from(width_m) / 2.0, f64::from(height_m) / 2.0))
            }
        };
        nearest = nearest.min(hit.unwrap_or(f64::INFINITY));
    }
    nearest.max(0.0)
}

/// [`range`], and how far it moves when the beam is shifted sideways by 10 um: where a beam grazes a surface or a
/// corner, the rounding of f32 decides whether it hits.
pub fn range_within(
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
    let Enclosure::Rectangle { width_m, height_m } = scenario.enclosure;
    let to_walls = (f64::from(width_m) / 2.0 - point.0.abs()).min(f64::from(height_m) / 2.0 - point.1.abs());
    let to_obstacle = |obstacle: &wayfield::scenario::Obstacle| {
        let (x, y, turn) = pose_at(obstacle, step, scenario.task.control_period_s);
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
        }
    };
    scenario.obstacles.iter().map(to_obstacle).fold(to_walls, f64::min)
}

type Pair = (f64, f64);

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
