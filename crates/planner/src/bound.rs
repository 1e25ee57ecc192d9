//! Bounds that no plan can beat: the shortest way round the obstacles, and the least turning.
//!
//! In: a scenario, a start, a target. Out: how many steps are needed at least from any state. What is proven, and how,
//! stands in docs/optimum.md.

use std::f64::consts::{PI, TAU};

use super::MARGIN_M;
use super::configuration_space::{GoalRegion, InflatedObstacle, State, distance, static_obstacles};
use glam::Vec2;
use wayfield_scenario::{Obstacle, Scenario, polygon, pose_at};

/// Corners of the polygon in a circle.
const CIRCLE_CORNERS: usize = 32;
/// Points along the arc at the corner of a grown box.
const BOX_CORNER_POINTS: usize = 3;
/// At most so many corners of polygons: obstacles far from the straight line are left out first.
const MAX_CORNERS: usize = 400;

/// The lower bounds on the way to the target.
pub(super) struct LowerBound {
    pub(super) goal_region: GoalRegion,
    /// The most that one step advances, in m: along the arc, so no less than the chord.
    pub(super) stride: f64,
    /// The tightest turn, in m, where every motion drives forward.
    pub(super) turning_radius: Option<f64>,
    pub(super) geodesic: Geodesic,
}

impl LowerBound {
    pub(super) fn new(scenario: &Scenario, start: (f32, f32, f32), goal: Vec2) -> Self {
        let period = f64::from(scenario.task.control_period_s);
        let motions = &scenario.robot.motions;
        let stride = motions.iter().map(|m| f64::from(m.v_m_s).abs() * period).fold(0.0, f64::max);
        // Standing still is 0 / 0: `min` passes it over. Turning on the spot gives 0, driving backward less.
        let radii = motions.iter().map(|m| f64::from(m.v_m_s) / f64::from(m.w_rad_s).abs());
        let turning_radius = radii.fold(f64::INFINITY, f64::min);
        let goal_region = GoalRegion::new(scenario, goal, MARGIN_M);
        let geodesic = Geodesic::new(scenario, (start.0.into(), start.1.into()), &goal_region, stride);
        Self {
            goal_region,
            stride,
            turning_radius: Some(turning_radius).filter(|radius| radius.is_finite() && *radius > 0.0),
            geodesic,
        }
    }

    /// At least so many steps, a fraction included, from a state that is allowed; infinite where there is no way.
    pub(super) fn steps(&self, state: &State) -> f64 {
        let way = self.geodesic.length((state.x, state.y)).max(self.turning_length(state));
        ((way - self.goal_region.radius) / self.stride).max(0.0)
    }

    /// The length of the shortest path that bends no tighter than the turning radius, in m, or 0 where that would
    /// prove nothing.
    pub(super) fn turning_length(&self, state: &State) -> f64 {
        let Some(r) = self.turning_radius else { return 0.0 };
        let (dx, dy) = (self.goal_region.x - state.x, self.goal_region.y - state.y);
        let (sin, cos) = libm::sincos(state.heading);
        // Mirrored so that the target lies to the left, and the left circle is the nearer one, at (0, r).
        let (ahead, left) = (dx * cos + dy * sin, (dy * cos - dx * sin).abs());
        let square = ahead * ahead + (left - r) * (left - r);
        let clear = r + self.goal_region.radius;
        if square < clear * clear {
            return 0.0;
        }
        let tangent = (square - r * r).sqrt();
        let turn = libm::atan2(left - r, ahead) + libm::atan2(r, tangent);
        // A target straight ahead makes a turn of 0, which rounding mustn't make a full one.
        let turn = if turn < -1e-9 { turn + TAU } else { turn.max(0.0) };
        r * turn + tangent
    }
}

/// `steps`, a lower bound, rounded up to whole steps; at least one.
pub(super) fn ceil_steps(steps: f64) -> u32 {
    ((steps - 1e-9).ceil() as u32).max(1)
}

/// A convex thing that bars the view.
pub(super) enum Occluder {
    Disc {
        centre: (f64, f64),
        radius: f64,
    },
    /// Half planes a x + b y < c; the inside satisfies all.
    Polygon(Vec<(f64, f64, f64)>),
}

impl Occluder {
    /// Whether the segment passes through the inside.
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

/// The shortest ways to the target round the obstacles that stand still, by the corners of polygons inside them.
pub(super) struct Geodesic {
    goal: (f64, f64),
    pub(super) occluders: Vec<Occluder>,
    /// Corners with their distance to the target, in m, the nearest first; none that can't reach it.
    pub(super) corners: Vec<((f64, f64), f64)>,
}

impl Geodesic {
    fn new(scenario: &Scenario, start: (f64, f64), goal_region: &GoalRegion, stride: f64) -> Self {
        let goal = (goal_region.x, goal_region.y);
        let range = f64::from(scenario.task.collision_range_m) - MARGIN_M;
        let mut geodesic = Self { goal, occluders: Vec::new(), corners: Vec::new() };
        if range <= stride / 2.0 {
            return geodesic;
        }
        let period = scenario.task.control_period_s;
        let from_line = |o: &Obstacle| {
            let at = (f64::from(o.position_m.x), f64::from(o.position_m.y));
            distance(start, at) + distance(at, goal)
        };
        let mut still: Vec<_> = static_obstacles(scenario).collect();
        still.sort_by(|a, b| from_line(a).total_cmp(&from_line(b)));
        let mut points = Vec::new();
        for obstacle in still {
            let mut solid = InflatedObstacle::new(&obstacle.shape, pose_at(&obstacle, 0, period), range);
            // Grown by what the whole chord keeps clear of, not only its ends.
            solid.radius = (solid.radius * solid.radius - stride * stride / 4.0).sqrt();
            let reach = InflatedObstacle { radius: solid.radius + goal_region.radius, ..solid };
            if !reach.is_clear(goal.0, goal.1) {
                continue;
            }
            let (occluder, outline) = occluder(&solid);
            if points.len() + outline.len() > MAX_CORNERS {
                break;
            }
            geodesic.occluders.push(occluder);
            points.extend(outline);
        }
        // No way bends outside a rectangle that holds it all: the robot's centre's, and the target besides.
        let (_, Vec2 { x: half_width, y: half_height }) = scenario.enclosure.bounds_m();
        let (reach_x, reach_y) = (f64::from(half_width) - range, f64::from(half_height) - range);
        let (reach_x, reach_y) = (reach_x.max(goal_region.x.abs()), reach_y.max(goal_region.y.abs()));
        points.retain(|&(x, y)| x.abs() <= reach_x && y.abs() <= reach_y);
        geodesic.measure(points);
        geodesic
    }

    fn sees(&self, from: (f64, f64), to: (f64, f64)) -> bool {
        !self.occluders.iter().any(|occluder| occluder.blocks(from, to))
    }

    /// Dijkstra's algorithm from the target over the points that see each other.
    fn measure(&mut self, points: Vec<(f64, f64)>) {
        let mut open: Vec<_> = points
            .into_iter()
            .map(|at| (at, if self.sees(at, self.goal) { distance(at, self.goal) } else { f64::INFINITY }))
            .collect();
        while let Some(next) = (0..open.len()).min_by(|&a, &b| open[a].1.total_cmp(&open[b].1)) {
            let (at, way) = open.swap_remove(next);
            if way.is_infinite() {
                break;
            }
            for (other, its_way) in &mut open {
                let by_here = way + distance(at, *other);
                if by_here < *its_way && self.sees(at, *other) {
                    *its_way = by_here;
                }
            }
            self.corners.push((at, way));
        }
    }

    /// The length of the shortest way from a point to the target, in m; infinite where there is none.
    fn length(&self, from: (f64, f64)) -> f64 {
        if self.sees(from, self.goal) {
            return distance(from, self.goal);
        }
        let mut shortest = f64::INFINITY;
        for &(corner, way) in &self.corners {
            if way >= shortest {
                break;
            }
            let by_here = way + distance(from, corner);
            if by_here < shortest && self.sees(from, corner) {
                shortest = by_here;
            }
        }
        shortest
    }
}

/// A convex polygon inscribed in `solid`, as what bars the view (a little less than all of it, so that the corners
/// see along the sides) and its corners.
fn occluder(solid: &InflatedObstacle) -> (Occluder, Vec<(f64, f64)>) {
    let place =
        |x: f64, y: f64| (solid.x + x * solid.cos - y * solid.sin, solid.y + x * solid.sin + y * solid.cos);
    if solid.half_width == 0.0 && solid.half_height == 0.0 {
        let corner = |k: usize| {
            let (sin, cos) = libm::sincos(TAU * k as f64 / CIRCLE_CORNERS as f64);
            place(solid.radius * cos, solid.radius * sin)
        };
        let radius = solid.radius * libm::cos(PI / CIRCLE_CORNERS as f64) - 1e-9;
        let disc = Occluder::Disc { centre: (solid.x, solid.y), radius: radius.max(0.0) };
        return (disc, (0..CIRCLE_CORNERS).map(corner).collect());
    }
    let corner = |k: usize| {
        let (quarter, point) = (k / BOX_CORNER_POINTS, k % BOX_CORNER_POINTS);
        let angle = quarter as f64 + point as f64 / (BOX_CORNER_POINTS - 1) as f64;
        let (sin, cos) = libm::sincos(angle * PI / 2.0);
        let x = if matches!(quarter, 0 | 3) { solid.half_width } else { -solid.half_width };
        let y = if quarter < 2 { solid.half_height } else { -solid.half_height };
        place(x + solid.radius * cos, y + solid.radius * sin)
    };
    let corners: Vec<_> = (0..4 * BOX_CORNER_POINTS).map(corner).collect();
    let sides = polygon::sides(&corners).map(|(p, q)| {
        let length = distance(p, q);
        let (a, b) = ((q.1 - p.1) / length, (p.0 - q.0) / length);
        (a, b, a * p.0 + b * p.1 - 1e-9)
    });
    (Occluder::Polygon(sides.collect()), corners)
}
