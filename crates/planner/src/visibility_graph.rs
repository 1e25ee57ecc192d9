//! The length of the shortest path around the static obstacles.
//!
//! Each inflated obstacle is replaced by a convex polygon inside it. The shortest path around polygons bends only at corners, so
//! Dijkstra's algorithm on the visibility graph of the corners finds it. The proof is in `docs/optimum.md`.

use std::f64::consts::{PI, TAU};

use super::MARGIN_M;
use super::configuration_space::{GoalRegion, InflatedObstacle, distance, static_obstacles};
use glam::Vec2;
use wayfield_scenario::{Obstacle, Scenario, polygon, pose_at};

/// The number of corners of the polygon inscribed in a circle.
const CIRCLE_CORNERS: usize = 32;
/// The number of polygon corners on each rounded corner of an inflated rectangle.
const RECTANGLE_CORNER_POINTS: usize = 3;
/// The maximum number of corners of all polygons together. If there are more, the obstacles with the largest sum of
/// distances to start and goal are left out.
const MAX_CORNERS: usize = 400;
/// Shorter sides of a polygon are left out, in m.
const SHORTEST_SIDE_M: f64 = 1e-9;

/// A convex region that blocks the line of sight.
pub(super) enum Occluder {
    Disc {
        centre: (f64, f64),
        radius: f64,
    },
    /// The half planes (a, b, c) of the sides. A point inside satisfies a x + b y < c for each.
    Polygon(Vec<(f64, f64, f64)>),
}

impl Occluder {
    /// Whether the segment passes through the interior.
    fn blocks(&self, from: (f64, f64), to: (f64, f64)) -> bool {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        match self {
            Self::Disc { centre, radius } => {
                let (px, py) = (centre.0 - from.0, centre.1 - from.1);
                let along = (px * dx + py * dy).clamp(0.0, dx * dx + dy * dy);
                let square = dx * dx + dy * dy;
                let part = if square > 0.0 { along / square } else { 0.0 };
                let (ex, ey) = (px - part * dx, py - part * dy);
                ex * ex + ey * ey < radius * radius
            }
            Self::Polygon(sides) => {
                let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
                for &(a, b, c) in sides {
                    let before = c - a * from.0 - b * from.1;
                    let slope = a * dx + b * dy;
                    if slope == 0.0 {
                        if before <= 0.0 {
                            return false;
                        }
                    } else if slope > 0.0 {
                        leave = leave.min(before / slope);
                    } else {
                        enter = enter.max(before / slope);
                    }
                    if enter >= leave {
                        return false;
                    }
                }
                true
            }
        }
    }
}

/// The corners at which the shortest paths to one goal bend.
pub(super) struct VisibilityGraph {
    goal: (f64, f64),
    pub(super) occluders: Vec<Occluder>,
    /// The corners from which the goal can be reached, with the length in m of the path to it, shortest first.
    pub(super) corners: Vec<((f64, f64), f64)>,
}

impl VisibilityGraph {
    /// The graph of the paths from `start` to the goal, in m, for a robot that moves at most `stride` m per step. It has no
    /// occluders if one step is long enough to jump over a small obstacle.
    pub(super) fn new(scenario: &Scenario, start: (f64, f64), goal_region: &GoalRegion, stride: f64) -> Self {
        let goal = (goal_region.x, goal_region.y);
        let range = f64::from(scenario.sure_collision_m()) - MARGIN_M;
        let mut graph = Self { goal, occluders: Vec::new(), corners: Vec::new() };
        if range <= stride / 2.0 {
            return graph;
        }
        let mut corners = graph.add_occluders(scenario, start, goal_region, stride, range);
        // A shortest path does not bend outside the rectangle that contains the robot's centre and the goal.
        let (_, Vec2 { x: half_width, y: half_height }) = scenario.enclosure.bounds_m();
        let (reach_x, reach_y) = (f64::from(half_width) - range, f64::from(half_height) - range);
        let (reach_x, reach_y) = (reach_x.max(goal_region.x.abs()), reach_y.max(goal_region.y.abs()));
        corners.retain(|&(x, y)| x.abs() <= reach_x && y.abs() <= reach_y);
        graph.measure(corners);
        graph
    }

    /// Adds the occluders of the static obstacles, and returns the corners of their polygons.
    fn add_occluders(
        &mut self,
        scenario: &Scenario,
        start: (f64, f64),
        goal_region: &GoalRegion,
        stride: f64,
        range: f64,
    ) -> Vec<(f64, f64)> {
        let period = scenario.task.control_period_s;
        let detour = |o: &Obstacle| {
            let centre = (f64::from(o.position_m.x), f64::from(o.position_m.y));
            distance(start, centre) + distance(centre, self.goal)
        };
        let mut obstacles: Vec<_> = static_obstacles(scenario).collect();
        obstacles.sort_by(|a, b| detour(a).total_cmp(&detour(b)));
        let mut corners = Vec::new();
        for obstacle in obstacles {
            let mut inflated = InflatedObstacle::new(&obstacle.shape, pose_at(&obstacle, 0, period), range);
            // A step's ends keep the full radius; its chord may come this close between them.
            inflated.radius = (inflated.radius * inflated.radius - stride * stride / 4.0).sqrt();
            let reach = InflatedObstacle { radius: inflated.radius + goal_region.radius, ..inflated };
            if !reach.is_clear(self.goal.0, self.goal.1) {
                continue;
            }
            let (occluder, polygon) = occluder(&inflated);
            if corners.len() + polygon.len() > MAX_CORNERS {
                break;
            }
            self.occluders.push(occluder);
            corners.extend(polygon);
        }
        corners
    }

    fn sees(&self, from: (f64, f64), to: (f64, f64)) -> bool {
        !self.occluders.iter().any(|occluder| occluder.blocks(from, to))
    }

    /// Computes the length of each corner's shortest path to the goal, by Dijkstra's algorithm on the visibility graph.
    fn measure(&mut self, corners: Vec<(f64, f64)>) {
        let mut open: Vec<_> = corners
            .into_iter()
            .map(|at| (at, if self.sees(at, self.goal) { distance(at, self.goal) } else { f64::INFINITY }))
            .collect();
        while let Some(nearest) = (0..open.len()).min_by(|&a, &b| open[a].1.total_cmp(&open[b].1)) {
            let (at, length) = open.swap_remove(nearest);
            if length.is_infinite() {
                break;
            }
            for (other, other_length) in &mut open {
                let through_here = length + distance(at, *other);
                if through_here < *other_length && self.sees(at, *other) {
                    *other_length = through_here;
                }
            }
            self.corners.push((at, length));
        }
    }

    /// The length of the shortest path from a point to the goal, in m; infinite if there is none.
    pub(super) fn length(&self, from: (f64, f64)) -> f64 {
        if self.sees(from, self.goal) {
            return distance(from, self.goal);
        }
        let mut shortest = f64::INFINITY;
        for &(corner, length) in &self.corners {
            if length >= shortest {
                break;
            }
            let through_corner = length + distance(from, corner);
            if through_corner < shortest && self.sees(from, corner) {
                shortest = through_corner;
            }
        }
        shortest
    }
}

/// The convex polygon inscribed in `inflated`: the region that blocks the line of sight, and its corners. The region is
/// slightly smaller than the polygon, so that neighbouring corners are visible from each other.
fn occluder(inflated: &InflatedObstacle) -> (Occluder, Vec<(f64, f64)>) {
    if inflated.half_width == 0.0 && inflated.half_height == 0.0 {
        circle_occluder(inflated)
    } else {
        rectangle_occluder(inflated)
    }
}

fn circle_occluder(inflated: &InflatedObstacle) -> (Occluder, Vec<(f64, f64)>) {
    let corner = |k: usize| {
        let (sin, cos) = libm::sincos(TAU * k as f64 / CIRCLE_CORNERS as f64);
        to_arena(inflated, inflated.radius * cos, inflated.radius * sin)
    };
    let incircle = inflated.radius * libm::cos(PI / CIRCLE_CORNERS as f64) - 1e-9;
    let disc = Occluder::Disc { centre: (inflated.x, inflated.y), radius: incircle.max(0.0) };
    (disc, (0..CIRCLE_CORNERS).map(corner).collect())
}

fn rectangle_occluder(inflated: &InflatedObstacle) -> (Occluder, Vec<(f64, f64)>) {
    let corner = |k: usize| {
        let (quarter, point) = (k / RECTANGLE_CORNER_POINTS, k % RECTANGLE_CORNER_POINTS);
        let angle = quarter as f64 + point as f64 / (RECTANGLE_CORNER_POINTS - 1) as f64;
        let (sin, cos) = libm::sincos(angle * PI / 2.0);
        let x = if matches!(quarter, 0 | 3) { inflated.half_width } else { -inflated.half_width };
        let y = if quarter < 2 { inflated.half_height } else { -inflated.half_height };
        to_arena(inflated, x + inflated.radius * cos, y + inflated.radius * sin)
    };
    let corners: Vec<_> = (0..4 * RECTANGLE_CORNER_POINTS).map(corner).collect();
    let sides = polygon::sides(&corners).filter_map(|(p, q)| {
        let length = distance(p, q);
        // At the ends of a capsule, two corners differ by rounding errors only: the side between them has no direction.
        (length > SHORTEST_SIDE_M).then(|| {
            let (a, b) = ((q.1 - p.1) / length, (p.0 - q.0) / length);
            (a, b, a * p.0 + b * p.1 - 1e-9)
        })
    });
    (Occluder::Polygon(sides.collect()), corners)
}

/// The point (x, y) in the obstacle's frame, transformed to the arena's frame.
fn to_arena(obstacle: &InflatedObstacle, x: f64, y: f64) -> (f64, f64) {
    let InflatedObstacle { sin, cos, .. } = obstacle;
    (obstacle.x + x * cos - y * sin, obstacle.y + x * sin + y * cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayfield_scenario::Shape;

    #[test]
    fn a_rotated_capsule_blocks_the_whole_polygon() {
        let capsule = Shape::Capsule { length_m: 0.4, radius_m: 0.1 };
        for k in 0..126_u8 {
            let rotation_rad = 0.05 * f32::from(k);
            let inflated = InflatedObstacle::new(&capsule, (0.1, 0.0, rotation_rad), 0.15);
            let (Occluder::Polygon(sides), corners) = rectangle_occluder(&inflated) else {
                panic!("a capsule is replaced by a polygon");
            };
            for corner in corners {
                let (x, y) = (inflated.x + 0.999 * (corner.0 - inflated.x), 0.999 * corner.1);
                let is_inside = sides.iter().all(|&(a, b, c)| a * x + b * y < c);
                assert!(is_inside, "rotated by {rotation_rad} rad, ({x}, {y}) is outside");
            }
        }
    }
}
