//! The least number of control steps from a start to a target: the yardstick that policies are measured by.
//!
//! In: a [`Scenario`], a start, a target, the clock. Out: a [`Plan`], whose actions can be replayed, and
//! [`lower_bound_steps`], which no plan can beat. No Bevy and no physics engine: the robot is a point that must keep
//! its distance.
//!
//! **The world as searched.** A motion (v, w) held for a control period takes the robot along an arc; the search
//! goes from arc's end to arc's end in f64, by the same formula as the world. A step is allowed when the true
//! distance from its end to every wall and obstacle (where [`pose_at`] puts it after that step) is at least
//! `collision_range_m`; the target is reached by an allowed step that ends nearer than `goal_radius_m`. What lies
//! between the ends of steps isn't judged. Both distances are kept with [`MARGIN_M`] to spare, so that a plan holds
//! in the world's f32 too.
//!
//! **How near the plan is to the optimum.** [`least_time`] is a best-first search over exact states that keeps one
//! state for each cell of a grid over (x, y, heading), and also step where anything moves. So a plan is always
//! feasible, an upper bound; merging states in a cell may cost steps, fewer the smaller the cells. Where `steps`
//! equals the lower bound the plan is proven optimal. Measured over 500 random navigations at the default resolution:
//! the mean is 0.16 % above the mean bound in the empty enclosure and in Scenario I (nine plans of ten proven optimal),
//! 2.4 % in Scenario II, where the bound knows little of what moves. The paper's course in Scenario I, heading 0:
//! 54 steps = 10.8 s, proven optimal.
//!
//! **What is proven below.** Everything that guides the search, and [`lower_bound_steps`], rests on bounds that
//! hold for the world with its margins on the other side (goal radius larger, collision range smaller by
//! [`MARGIN_M`]):
//! 1. *Geodesic.* A step moves the robot by the chord s of the fastest motion at most. Of two points at least R from
//!    an obstacle and at most s apart, every point between is at least sqrt(R^2 - s^2 / 4) from it (Stewart's
//!    theorem), so the polyline through the steps' ends keeps out of each obstacle grown by that much, and out of
//!    any convex polygon inscribed in it. The shortest way round these polygons, by their corners, less the goal
//!    radius, is no longer than s a step. Obstacles that move, that stand within the goal radius of the target, or
//!    that are too many, are left out, which can only shorten the way; so are all where R <= s / 2.
//! 2. *Turning.* Where every motion drives forward, the path bends no tighter than some radius r. The shortest
//!    such path to a point q outside both turning circles is an arc and its tangent (Bui et al. 1994), and its length
//!    changes by no more than q does. So if the goal's disc is clear of both circles, that length to the target less
//!    the goal radius is a bound.
//!
//! **The judge is a hair more lenient**: it takes the shortest of the LIDAR's beams, which may pass the nearest point
//! by. With 24 beams and a collision range of 0.13 m that is 2.1 mm at most at a cylinder of 0.15 m, 1.1 mm at a wall,
//! 18 mm at a box's corner. So the true optimum may seldom be a step shorter; take that off `collision_range_m` for a
//! bound on it too.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};
use std::f64::consts::{PI, TAU};
use std::hash::{BuildHasherDefault, Hasher};

use crate::scenario::{Enclosure, Obstacle, ObstacleMotion, Scenario, Shape, pose_at};

/// How far, in m, a plan stays within the rules, and how far beyond them the lower bound still holds: more than the
/// world's f32 arithmetic adds up to in some hundred steps.
pub const MARGIN_M: f64 = 2e-5;
/// The first search gives up when it has made so many states.
const MOST_STATES: usize = 4_000_000;
/// So many states are looked at, without merging any, for the lower bound.
const LOOKAHEAD: usize = 5_000;
/// Corners of the polygon in a circle.
const CIRCLE_CORNERS: usize = 32;
/// Points along the arc at the corner of a grown box.
const BOX_CORNER_POINTS: usize = 3;
/// At most so many corners of polygons: obstacles far from the straight line are left out first.
const MOST_CORNERS: usize = 400;
/// Parts of a step that the queue tells apart.
const PARTS: f64 = 64.0;

/// A way to the target.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Control steps until the target is reached.
    pub steps: u32,
    /// The same as simulated time, in s.
    pub time_s: f32,
    /// The motion of each step, as an index into the robot's motions.
    pub actions: Vec<u8>,
}

/// How finely states are told apart. The search is run with the coarsest cells first, then with halved ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Side of the coarsest cells along x and y, in m.
    pub cell_m: f64,
    /// Their extent in heading, in rad.
    pub heading_rad: f64,
    /// How often all sides are halved. Each search has only to beat the one before, so one more is never worse.
    pub halvings: u32,
    /// A search with halved cells gives up, and what the coarser ones found stands, when it has made so many states
    /// (48 bytes and about 0.3 us each). Only moving obstacles make it need so many. The first search may make
    /// 4,000,000.
    pub refining_states: usize,
}

impl Default for Resolution {
    /// 0.04 m and 0.16 rad, then 0.02 m and 0.08 rad. (From 0.08 m on cells are too coarse: a step of 0.03 m that
    /// ends in its own cell is lost.)
    fn default() -> Self {
        Self { cell_m: 0.04, heading_rad: 0.16, halvings: 1, refining_states: 100_000 }
    }
}

/// The shortest plan found from `start` (x in m, y in m, heading in rad) to `target` (in m) when the obstacles are
/// where `clock` steps have brought them. At least one step is taken. None when there is no way within the
/// scenario's time limit, or none at this resolution and within some million states.
#[must_use]
pub fn least_time(
    scenario: &Scenario,
    start: (f32, f32, f32),
    target: (f32, f32),
    clock: u64,
    resolution: Resolution,
) -> Option<Plan> {
    let mut world = World::new(scenario, clock, MARGIN_M);
    let bound = Bound::new(scenario, start, target);
    let goal = Goal::new(scenario, target, -MARGIN_M);
    let least = look_ahead(scenario, start, target, clock, &bound, 64);
    let mut best = None;
    let mut fewer_than = scenario.task.time_limit_steps.saturating_add(1);
    for halving in 0..=resolution.halvings {
        let part = 0.5_f64.powi(i32::try_from(halving).unwrap_or(i32::MAX));
        let mut cells =
            Cells::new(resolution.cell_m * part, resolution.heading_rad * part, world.anything_moves());
        let limits = Limits {
            fewer_than,
            states: if halving == 0 { MOST_STATES } else { resolution.refining_states },
        };
        if let Some(plan) = search(&mut world, &bound, &goal, start, &mut cells, &limits) {
            fewer_than = plan.len() as u32;
            best = Some(plan);
        }
        if fewer_than <= least {
            break;
        }
    }
    best.map(|actions| {
        let steps = actions.len() as u32;
        let time_s = (f64::from(steps) * f64::from(scenario.task.control_period_s)) as f32;
        Plan { steps, time_s, actions }
    })
}

/// A number of steps that no plan undercuts, whatever the resolution: proven as the module's docs say, by the
/// geodesic and the turning bound after every sequence of the first few motions. `u32::MAX` where there is no way.
#[must_use]
pub fn lower_bound_steps(scenario: &Scenario, start: (f32, f32, f32), target: (f32, f32), clock: u64) -> u32 {
    look_ahead(scenario, start, target, clock, &Bound::new(scenario, start, target), LOOKAHEAD)
}

/// Robot's centre in m and heading in rad, not wrapped.
#[derive(Clone, Copy)]
struct State {
    x: f64,
    y: f64,
    heading: f64,
}

impl State {
    fn new((x, y, heading): (f32, f32, f32)) -> Self {
        Self { x: x.into(), y: y.into(), heading: heading.into() }
    }

    /// Where a step leads from here, given the sine and cosine of the heading.
    fn after(&self, step: &Move, (sin, cos): (f64, f64)) -> Self {
        Self {
            x: self.x + step.ahead * cos - step.left * sin,
            y: self.y + step.ahead * sin + step.left * cos,
            heading: self.heading + step.turn,
        }
    }
}

/// What one step of a motion does, seen from the robot: forward, to the left (in m), and the turn (in rad).
#[derive(Clone, Copy)]
struct Move {
    ahead: f64,
    left: f64,
    turn: f64,
}

/// The end of each motion's arc: its chord points half the turn aside and is sinc of that long.
fn moves(scenario: &Scenario) -> Vec<Move> {
    let period = scenario.task.control_period_s;
    let of = |motion: &crate::scenario::Motion| {
        // Rounded to f32 as the world rounds it, lest the headings drift apart.
        let turn = f64::from(motion.w_rad_s * period);
        let half = turn / 2.0;
        let sinc = if half.abs() < 1e-6 { 1.0 } else { libm::sin(half) / half };
        let chord = f64::from(motion.v_m_s) * f64::from(period) * sinc;
        Move { ahead: chord * libm::cos(half), left: chord * libm::sin(half), turn }
    };
    scenario.robot.motions.iter().map(of).collect()
}

/// An obstacle grown by the collision range: a box with rounded corners, which a circle is too.
struct Solid {
    x: f64,
    y: f64,
    cos: f64,
    sin: f64,
    half_width: f64,
    half_height: f64,
    /// Of the corners, in m; positive.
    radius: f64,
}

impl Solid {
    fn new(shape: &Shape, (x, y, rotation): (f32, f32, f32), growth: f64) -> Self {
        let (sin, cos) = libm::sincos(rotation.into());
        let (half_width, half_height, radius) = match *shape {
            Shape::Circle { radius_m } => (0.0, 0.0, f64::from(radius_m) + growth),
            Shape::Rectangle { width_m, height_m } => {
                (f64::from(width_m) / 2.0, f64::from(height_m) / 2.0, growth)
            }
        };
        Self { x: x.into(), y: y.into(), cos, sin, half_width, half_height, radius }
    }

    /// Whether the point is outside or on the rim.
    fn is_clear(&self, x: f64, y: f64) -> bool {
        let (dx, dy) = (x - self.x, y - self.y);
        let past_x = ((dx * self.cos + dy * self.sin).abs() - self.half_width).max(0.0);
        let past_y = ((dy * self.cos - dx * self.sin).abs() - self.half_height).max(0.0);
        past_x * past_x + past_y * past_y >= self.radius * self.radius
    }
}

/// Where the robot may be, and how it moves.
struct World<'a> {
    moves: Vec<Move>,
    /// Of the rectangle that the robot's centre must keep to, in m.
    half_width: f64,
    half_height: f64,
    growth: f64,
    still: Vec<Solid>,
    moving: Vec<&'a Obstacle>,
    /// The moving obstacles after 0, 1, ... steps, as far as they have been asked for.
    at_step: Vec<Vec<Solid>>,
    clock: u64,
    period_s: f32,
}

impl<'a> World<'a> {
    /// The world with a collision range larger by `margin_m`.
    fn new(scenario: &'a Scenario, clock: u64, margin_m: f64) -> Self {
        let growth = (f64::from(scenario.task.collision_range_m) + margin_m).max(0.0);
        let Enclosure::Rectangle { width_m, height_m } = scenario.enclosure;
        let period_s = scenario.task.control_period_s;
        let (still, moving): (Vec<_>, Vec<_>) =
            scenario.obstacles.iter().partition(|obstacle| obstacle.motion == ObstacleMotion::Still);
        let still = still.iter().map(|o| Solid::new(&o.shape, pose_at(o, 0, period_s), growth)).collect();
        Self {
            moves: moves(scenario),
            half_width: f64::from(width_m) / 2.0 - growth,
            half_height: f64::from(height_m) / 2.0 - growth,
            growth,
            still,
            moving,
            at_step: Vec::new(),
            clock,
            period_s,
        }
    }

    /// Whether any obstacle moves.
    fn anything_moves(&self) -> bool {
        !self.moving.is_empty()
    }

    /// Works out where the moving obstacles are after `steps` steps.
    fn prepare(&mut self, steps: u32) {
        while self.anything_moves() && self.at_step.len() <= steps as usize {
            let clock = self.clock.saturating_add(self.at_step.len() as u64);
            let placed = |o: &&Obstacle| Solid::new(&o.shape, pose_at(o, clock, self.period_s), self.growth);
            self.at_step.push(self.moving.iter().map(placed).collect());
        }
    }

    /// Whether the robot may be at (x, y) after `steps` steps, which have been prepared.
    fn is_clear(&self, x: f64, y: f64, steps: u32) -> bool {
        x.abs() <= self.half_width
            && y.abs() <= self.half_height
            && self.still.iter().all(|solid| solid.is_clear(x, y))
            && self.at_step.get(steps as usize).is_none_or(|all| all.iter().all(|s| s.is_clear(x, y)))
    }
}

/// The disc to reach.
struct Goal {
    x: f64,
    y: f64,
    radius: f64,
}

impl Goal {
    /// The target's disc with a radius larger by `margin_m`.
    fn new(scenario: &Scenario, target: (f32, f32), margin_m: f64) -> Self {
        let radius = (f64::from(scenario.task.goal_radius_m) + margin_m).max(0.0);
        Self { x: target.0.into(), y: target.1.into(), radius }
    }

    fn holds(&self, x: f64, y: f64) -> bool {
        distance((x, y), (self.x, self.y)) < self.radius
    }
}

/// The lower bounds on the way to the target.
struct Bound {
    goal: Goal,
    /// The most that one step advances, in m: along the arc, so no less than the chord.
    stride: f64,
    /// The tightest turn, in m, where every motion drives forward.
    turning_radius: Option<f64>,
    geodesic: Geodesic,
}

impl Bound {
    fn new(scenario: &Scenario, start: (f32, f32, f32), target: (f32, f32)) -> Self {
        let period = f64::from(scenario.task.control_period_s);
        let motions = &scenario.robot.motions;
        let stride = motions.iter().map(|m| f64::from(m.v_m_s).abs() * period).fold(0.0, f64::max);
        // Standing still is 0 / 0: `min` passes it over. Turning on the spot gives 0, driving backward less.
        let radii = motions.iter().map(|m| f64::from(m.v_m_s) / f64::from(m.w_rad_s).abs());
        let turning_radius = radii.fold(f64::INFINITY, f64::min);
        let goal = Goal::new(scenario, target, MARGIN_M);
        let geodesic = Geodesic::new(scenario, (start.0.into(), start.1.into()), &goal, stride);
        Self {
            goal,
            stride,
            turning_radius: Some(turning_radius).filter(|radius| radius.is_finite() && *radius > 0.0),
            geodesic,
        }
    }

    /// At least so many steps, a fraction included, from a state that is allowed; infinite where there is no way.
    fn steps(&self, state: &State) -> f64 {
        let way = self.geodesic.length((state.x, state.y)).max(self.turning_length(state));
        ((way - self.goal.radius) / self.stride).max(0.0)
    }

    /// The length of the shortest path that bends no tighter than the turning radius, in m, or 0 where that would
    /// prove nothing.
    fn turning_length(&self, state: &State) -> f64 {
        let Some(r) = self.turning_radius else { return 0.0 };
        let (dx, dy) = (self.goal.x - state.x, self.goal.y - state.y);
        let (sin, cos) = libm::sincos(state.heading);
        // Mirrored so that the target lies to the left, and the left circle is the nearer one, at (0, r).
        let (ahead, left) = (dx * cos + dy * sin, (dy * cos - dx * sin).abs());
        let square = ahead * ahead + (left - r) * (left - r);
        let clear = r + self.goal.radius;
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
fn whole(steps: f64) -> u32 {
    ((steps - 1e-9).ceil() as u32).max(1)
}

/// A convex thing that bars the view.
enum Screen {
    Disc {
        centre: (f64, f64),
        radius: f64,
    },
    /// Half planes a x + b y < c; the inside satisfies all.
    Polygon(Vec<(f64, f64, f64)>),
}

impl Screen {
    /// Whether the segment passes through the inside.
    fn bars(&self, from: (f64, f64), to: (f64, f64)) -> bool {
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
struct Geodesic {
    target: (f64, f64),
    screens: Vec<Screen>,
    /// Corners with their distance to the target, in m, the nearest first; none that can't reach it.
    corners: Vec<((f64, f64), f64)>,
}

impl Geodesic {
    fn new(scenario: &Scenario, start: (f64, f64), goal: &Goal, stride: f64) -> Self {
        let target = (goal.x, goal.y);
        let range = f64::from(scenario.task.collision_range_m) - MARGIN_M;
        let mut geodesic = Self { target, screens: Vec::new(), corners: Vec::new() };
        if range <= stride / 2.0 {
            return geodesic;
        }
        let period = scenario.task.control_period_s;
        let from_line = |o: &Obstacle| {
            let at = (f64::from(o.position_m.0), f64::from(o.position_m.1));
            distance(start, at) + distance(at, target)
        };
        let mut still: Vec<_> =
            scenario.obstacles.iter().filter(|o| o.motion == ObstacleMotion::Still).collect();
        still.sort_by(|a, b| from_line(a).total_cmp(&from_line(b)));
        let mut points = Vec::new();
        for obstacle in still {
            let mut solid = Solid::new(&obstacle.shape, pose_at(obstacle, 0, period), range);
            // Grown by what the whole chord keeps clear of, not only its ends.
            solid.radius = (solid.radius * solid.radius - stride * stride / 4.0).sqrt();
            let reach = Solid { radius: solid.radius + goal.radius, ..solid };
            if !reach.is_clear(target.0, target.1) {
                continue;
            }
            let (screen, outline) = screen(&solid);
            if points.len() + outline.len() > MOST_CORNERS {
                break;
            }
            geodesic.screens.push(screen);
            points.extend(outline);
        }
        // No way bends outside the rectangle of the robot's centre, which is convex.
        let Enclosure::Rectangle { width_m, height_m } = scenario.enclosure;
        let (reach_x, reach_y) = (f64::from(width_m) / 2.0 - range, f64::from(height_m) / 2.0 - range);
        points.retain(|&(x, y)| x.abs() <= reach_x && y.abs() <= reach_y);
        geodesic.measure(points);
        geodesic
    }

    fn sees(&self, from: (f64, f64), to: (f64, f64)) -> bool {
        !self.screens.iter().any(|screen| screen.bars(from, to))
    }

    /// Dijkstra's algorithm from the target over the points that see each other.
    fn measure(&mut self, points: Vec<(f64, f64)>) {
        let mut open: Vec<_> = points
            .into_iter()
            .map(|at| {
                (at, if self.sees(at, self.target) { distance(at, self.target) } else { f64::INFINITY })
            })
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
        if self.sees(from, self.target) {
            return distance(from, self.target);
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
fn screen(solid: &Solid) -> (Screen, Vec<(f64, f64)>) {
    let place =
        |x: f64, y: f64| (solid.x + x * solid.cos - y * solid.sin, solid.y + x * solid.sin + y * solid.cos);
    if solid.half_width == 0.0 && solid.half_height == 0.0 {
        let corner = |k: usize| {
            let (sin, cos) = libm::sincos(TAU * k as f64 / CIRCLE_CORNERS as f64);
            place(solid.radius * cos, solid.radius * sin)
        };
        let radius = solid.radius * libm::cos(PI / CIRCLE_CORNERS as f64) - 1e-9;
        let disc = Screen::Disc { centre: (solid.x, solid.y), radius: radius.max(0.0) };
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
    let sides = corners.iter().zip(corners.iter().cycle().skip(1)).map(|(p, q)| {
        let length = distance(*p, *q);
        let (a, b) = ((q.1 - p.1) / length, (p.0 - q.0) / length);
        (a, b, a * p.0 + b * p.1 - 1e-9)
    });
    (Screen::Polygon(sides.collect()), corners)
}

fn distance(from: (f64, f64), to: (f64, f64)) -> f64 {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    (dx * dx + dy * dy).sqrt()
}

/// A state reached, and how.
struct Node {
    state: State,
    steps: u32,
    parent: u32,
    action: u8,
}

/// The nodes not yet gone on from, the most hopeful first: by the bound on the whole way, in parts of a step, then
/// the newest.
#[derive(Default)]
struct Queue(BinaryHeap<Reverse<(u32, Reverse<u32>)>>);

impl Queue {
    fn push(&mut self, parts: u32, node: usize) {
        self.0.push(Reverse((parts, Reverse(node as u32))));
    }

    fn pop(&mut self) -> Option<(u32, usize)> {
        self.0.pop().map(|Reverse((parts, Reverse(node)))| (parts, node as usize))
    }
}

/// The bound on the whole way in parts of a step.
fn parts(steps: u32, to_go: f64) -> u32 {
    ((f64::from(steps) + to_go) * PARTS) as u32
}

/// The grid that merges states: each cell knows the best bound on a whole way through it.
struct Cells {
    per_metre: f64,
    per_radian: f64,
    by_step: bool,
    best: HashMap<(i32, i32, i32, u32), u32, BuildHasherDefault<CellHasher>>,
}

impl Cells {
    fn new(cell_m: f64, heading_rad: f64, by_step: bool) -> Self {
        let (per_metre, per_radian) = (1.0 / cell_m.max(1e-6), 1.0 / heading_rad.max(1e-6));
        Self { per_metre, per_radian, by_step, best: HashMap::default() }
    }

    fn key(&self, state: &State, steps: u32) -> (i32, i32, i32, u32) {
        (
            (state.x * self.per_metre).floor() as i32,
            (state.y * self.per_metre).floor() as i32,
            (state.heading.rem_euclid(TAU) * self.per_radian) as i32,
            if self.by_step { steps } else { 0 },
        )
    }

    /// Whether no state as good as this has been in its cell; if so, it is now the cell's best.
    fn admit(&mut self, state: &State, steps: u32, parts: u32) -> bool {
        let best = self.best.entry(self.key(state, steps)).or_insert(u32::MAX);
        let better = parts < *best;
        if better {
            *best = parts;
        }
        better
    }

    /// Whether a state that was admitted has since been bettered.
    fn is_stale(&self, state: &State, steps: u32, parts: u32) -> bool {
        self.best.get(&self.key(state, steps)).is_some_and(|&best| best < parts)
    }
}

/// Multiplies and turns: quick, and good enough for cells.
#[derive(Default)]
struct CellHasher(u64);

impl Hasher for CellHasher {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u32(byte.into());
        }
    }

    fn write_i32(&mut self, number: i32) {
        self.write_u32(number as u32);
    }

    fn write_u32(&mut self, number: u32) {
        self.0 = (self.0.rotate_left(5) ^ u64::from(number)).wrapping_mul(0x517C_C1B7_2722_0A95);
    }
}

/// What a search may not exceed.
struct Limits {
    /// Only plans with fewer steps are of use.
    fewer_than: u32,
    /// How many states may be made, about.
    states: usize,
}

/// The actions of the best plan within `limits` that leads through `cells`, if any.
fn search(
    world: &mut World<'_>,
    bound: &Bound,
    goal: &Goal,
    start: (f32, f32, f32),
    cells: &mut Cells,
    limits: &Limits,
) -> Option<Vec<u8>> {
    let mut fewer_than = limits.fewer_than;
    let mut nodes = vec![Node { state: State::new(start), steps: 0, parent: 0, action: 0 }];
    let mut queue = Queue::default();
    queue.push(0, 0);
    let mut reached = None;
    while let Some((parts_here, index)) = queue.pop() {
        let Node { state, steps, .. } = nodes[index];
        if whole(f64::from(parts_here) / PARTS) >= fewer_than || nodes.len() > limits.states {
            break;
        }
        if index > 0 && cells.is_stale(&state, steps, parts_here) {
            continue;
        }
        let steps = steps + 1;
        world.prepare(steps);
        let facing = libm::sincos(state.heading);
        for (action, step) in world.moves.iter().enumerate() {
            let state = state.after(step, facing);
            if !world.is_clear(state.x, state.y, steps) {
                continue;
            }
            let node = Node { state, steps, parent: index as u32, action: action as u8 };
            if goal.holds(state.x, state.y) {
                if steps < fewer_than {
                    fewer_than = steps;
                    reached = Some(nodes.len());
                    nodes.push(node);
                }
                continue;
            }
            let to_go = bound.steps(&state);
            if steps.saturating_add(whole(to_go)) < fewer_than
                && cells.admit(&state, steps, parts(steps, to_go))
            {
                queue.push(parts(steps, to_go), nodes.len());
                nodes.push(node);
            }
        }
    }
    let mut at = reached?;
    let mut actions = vec![0; fewer_than as usize];
    while at > 0 {
        actions[nodes[at].steps as usize - 1] = nodes[at].action;
        at = nodes[at].parent as usize;
    }
    Some(actions)
}

/// The least bound, in whole steps, over the ends of every sequence of motions that is looked at, `states` in all:
/// the most hopeful are gone on from first, and none is left out.
fn look_ahead(
    scenario: &Scenario,
    start: (f32, f32, f32),
    target: (f32, f32),
    clock: u64,
    bound: &Bound,
    states: usize,
) -> u32 {
    let mut world = World::new(scenario, clock, -MARGIN_M);
    let goal = Goal::new(scenario, target, MARGIN_M);
    let mut nodes = vec![(State::new(start), 0)];
    let mut queue = Queue::default();
    queue.push(0, 0);
    while let Some((parts_here, index)) = queue.pop() {
        let (state, steps) = nodes[index];
        let so_far = whole(f64::from(parts_here) / PARTS);
        // A target that has been reached is queued with just its steps.
        if nodes.len() >= states || (index > 0 && goal.holds(state.x, state.y)) {
            return so_far;
        }
        let steps = steps + 1;
        world.prepare(steps);
        let facing = libm::sincos(state.heading);
        for step in &world.moves {
            let state = state.after(step, facing);
            if !world.is_clear(state.x, state.y, steps) {
                continue;
            }
            let reached = goal.holds(state.x, state.y);
            let to_go = if reached { 0.0 } else { bound.steps(&state).max(1.0) };
            if to_go.is_finite() {
                queue.push(parts(steps, to_go), nodes.len());
                nodes.push((state, steps));
            }
        }
    }
    u32::MAX
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::random::{between, stream};
    use crate::scenario::{clearance, draw_start, draw_target};

    fn circle(position_m: (f32, f32), radius_m: f32, motion: ObstacleMotion) -> Obstacle {
        Obstacle { shape: Shape::Circle { radius_m }, position_m, rotation_rad: 0.0, motion }
    }

    fn slab(position_m: (f32, f32), width_m: f32, height_m: f32) -> Obstacle {
        let shape = Shape::Rectangle { width_m, height_m };
        Obstacle { shape, position_m, rotation_rad: 0.0, motion: ObstacleMotion::Still }
    }

    /// The paper's four cylinders, revolving at `speed_rad_s`.
    fn cylinders(speed_rad_s: f32) -> Scenario {
        let motion = if speed_rad_s == 0.0 {
            ObstacleMotion::Still
        } else {
            ObstacleMotion::Orbit { centre_m: (0.0, 0.0), speed_rad_s }
        };
        let corners = [(0.6, 0.6), (-0.6, 0.6), (-0.6, -0.6), (0.6, -0.6)];
        let obstacles = corners.map(|corner| circle(corner, 0.15, motion.clone())).into();
        Scenario { obstacles, ..Scenario::default() }
    }

    /// Cylinders, and boxes that bar half of the enclosure.
    fn maze() -> Scenario {
        let tilted = Obstacle { rotation_rad: 0.5, ..slab((-1.0, 0.9), 0.8, 0.1) };
        let mut scenario = cylinders(0.0);
        scenario.obstacles.extend([slab((1.1, 0.0), 1.8, 0.1), slab((0.0, -1.2), 0.2, 1.0), tilted]);
        scenario
    }

    fn straight(scenario: &Scenario, to: (f32, f32)) -> Option<Plan> {
        least_time(scenario, (0.0, 0.0, 0.0), to, 0, Resolution::default())
    }

    /// Drives the plan as the world does, in f32: the collision-free step at which it arrives, if it does.
    fn replay(
        scenario: &Scenario,
        start: (f32, f32, f32),
        target: (f32, f32),
        clock: u64,
        actions: &[u8],
    ) -> Result<u32, String> {
        let period = scenario.task.control_period_s;
        let (mut x, mut y, mut heading) = start;
        for (steps, &action) in (1..).zip(actions) {
            let motion = scenario.robot.motions[usize::from(action)];
            let half = 0.5 * motion.w_rad_s * period;
            let sinc = if half.abs() < 1e-4 { 1.0 } else { libm::sinf(half) / half };
            let (sin, cos) = libm::sincosf(heading + half);
            x += cos * (motion.v_m_s * sinc) * period;
            y += sin * (motion.v_m_s * sinc) * period;
            heading = libm::remainderf(heading + motion.w_rad_s * period, std::f32::consts::TAU);
            let room = clearance(scenario, (x, y), clock + steps);
            if room < scenario.task.collision_range_m {
                return Err(format!("only {room} m clear after step {steps}"));
            }
            if libm::hypotf(target.0 - x, target.1 - y) < scenario.task.goal_radius_m {
                return Ok(steps as u32);
            }
        }
        Err("never arrives".into())
    }

    #[test]
    fn straight_ahead_it_just_drives() {
        // More than 1.0 m at 0.03 m a step: 34 steps.
        let plan = straight(&Scenario::default(), (1.2, 0.0)).expect("nothing is in the way");
        assert_eq!((plan.steps, plan.time_s, plan.actions.len()), (34, 6.8, 34));
        assert_eq!(lower_bound_steps(&Scenario::default(), (0.0, 0.0, 0.0), (1.2, 0.0), 0), 34);
    }

    #[test]
    fn a_target_behind_costs_the_turn() {
        // The turning circle's middle is 1 m ahead of the target and 0.1 m aside, so the tangent is 1 m long; the
        // turn is pi + 2 atan(0.1) = 3.3409 rad on a radius of 0.1 m. (0.33409 + 1 - 0.2) m / 0.03 m = 37.8.
        let start = (0.0, 0.0, 0.0);
        assert_eq!(lower_bound_steps(&Scenario::default(), start, (-1.0, 0.0), 0), 38);
        assert_eq!(straight(&Scenario::default(), (-1.0, 0.0)).map(|plan| plan.steps), Some(38));
    }

    #[test]
    fn on_the_target_it_still_takes_one_step() {
        assert_eq!(straight(&Scenario::default(), (0.05, 0.0)).map(|plan| plan.steps), Some(1));
        assert_eq!(lower_bound_steps(&Scenario::default(), (0.0, 0.0, 0.0), (0.05, 0.0), 0), 1);
    }

    #[test]
    fn the_papers_course_takes_54_steps_and_53_are_proven_too_few() {
        let (scenario, start, target) = (cylinders(0.0), (0.0, 0.0, 0.0), (1.2, 1.2));
        assert_eq!(lower_bound_steps(&scenario, start, target, 0), 54);
        for cell_m in [0.04, 0.02, 0.01, 0.005] {
            let resolution =
                Resolution { cell_m, heading_rad: 4.0 * cell_m, halvings: 0, ..Default::default() };
            let plan = least_time(&scenario, start, target, 0, resolution).expect("there is a way");
            assert_eq!(plan.steps, 54, "with cells of {cell_m} m");
            assert_eq!(replay(&scenario, start, target, 0, &plan.actions), Ok(54));
        }
    }

    #[test]
    fn the_way_round_a_slab_is_the_one_worked_by_hand() {
        // From (-1, 0) to (1, 0) past a slab 0.1 m thick that ends at y = 0.6 and meets the lower wall: by its upper
        // corners, 0.13 m off. By symmetry: to the corner (0.05, 0.6) at (0.95, 0.6), length 1.12361, the tangent
        // sqrt(1.12361^2 - 0.13^2) = 1.11606, the arc's angle atan(0.6 / 0.95) + asin(0.13 / 1.12361) = 0.67932
        // from the top. In all 2 (1.11606 + 0.13 * 0.67932) + 0.1 - 0.2 = 2.30874 m, 76.96 steps: 77 at least, and
        // the start's heading is along the tangent.
        let scenario = Scenario { obstacles: vec![slab((0.0, -0.7), 0.1, 2.6)], ..Scenario::default() };
        let (start, target) = ((-1.0, 0.0, 0.67932), (1.0, 0.0));
        let plan = least_time(&scenario, start, target, 0, Resolution::default()).expect("there is a way");
        assert!((76..=77).contains(&lower_bound_steps(&scenario, start, target, 0)));
        assert!((77..=78).contains(&plan.steps), "{} steps", plan.steps);
    }

    #[test]
    fn no_way_is_none() {
        let walled = Scenario { obstacles: vec![slab((0.8, 0.0), 0.1, 4.0)], ..Scenario::default() };
        assert_eq!(straight(&walled, (1.5, 0.0)), None);
        assert_eq!(lower_bound_steps(&walled, (0.0, 0.0, 0.0), (1.5, 0.0), 0), u32::MAX);
        let mut hasty = Scenario::default();
        hasty.task.time_limit_steps = 33;
        assert_eq!(straight(&hasty, (1.2, 0.0)), None, "34 steps are beyond the time limit");
        hasty.task.time_limit_steps = 34;
        assert!(straight(&hasty, (1.2, 0.0)).is_some());
    }

    #[test]
    fn moving_obstacles_are_met_where_the_clock_puts_them() {
        // A cylinder comes down the line x = 0.6 at 0.15 m/s, 0.03 m a step, as fast as the robot: from 0.6 m above,
        // it is in the robot's way just when the robot comes by. Started later, it has passed.
        let motion = ObstacleMotion::Patrol { waypoints_m: vec![(0.6, -1.8)], speed_m_s: 0.15 };
        let scenario = Scenario { obstacles: vec![circle((0.6, 0.6), 0.15, motion)], ..Scenario::default() };
        let go = |clock| {
            let start = (0.0, 0.0, 0.0);
            let plan = least_time(&scenario, start, (1.2, 0.0), clock, Resolution::default()).expect("a way");
            assert_eq!(replay(&scenario, start, (1.2, 0.0), clock, &plan.actions), Ok(plan.steps));
            assert!(lower_bound_steps(&scenario, start, (1.2, 0.0), clock) <= plan.steps);
            plan.steps
        };
        assert!(replay(&scenario, (0.0, 0.0, 0.0), (1.2, 0.0), 0, &[2; 34]).is_err(), "it is in the way");
        assert!((35..45).contains(&go(0)), "{}", go(0));
        assert_eq!(go(30), 34);
    }

    #[test]
    fn driving_backward_standing_still_and_turning_on_the_spot_are_motions_too() {
        let mut scenario = Scenario::default();
        let motion = |v_m_s, w_rad_s| crate::scenario::Motion { v_m_s, w_rad_s };
        scenario.robot.motions =
            vec![motion(0.0, 0.0), motion(0.15, 0.0), motion(0.0, 1.5), motion(-0.15, 0.0)];
        let plan = straight(&scenario, (-1.2, 0.0)).expect("backward");
        assert_eq!(plan.steps, 34);
        let plan = straight(&scenario, (0.0, 1.2)).expect("turn, then drive");
        // Five turns make 1.5 rad, 0.07 rad short of a right angle: 34 or 35 steps from there.
        assert!((39..=40).contains(&plan.steps), "{}", plan.steps);
        assert!(lower_bound_steps(&scenario, (0.0, 0.0, 0.0), (0.0, 1.2), 0) <= plan.steps);
        scenario.robot.motions.truncate(1);
        assert_eq!(straight(&scenario, (1.2, 0.0)), None, "it can only stand");
    }

    #[test]
    fn random_navigations_are_within_a_percent_of_the_proven_bound() {
        let scenario = cylinders(0.0);
        let mut draws = stream(1, "optimum", 0);
        let (mut steps, mut least) = (0, 0);
        for _ in 0..100 {
            let start = draw_start(&scenario, 0, &mut draws).expect("room");
            let target = draw_target(&scenario, 0, (start.0, start.1), &mut draws).expect("room");
            let plan = least_time(&scenario, start, target, 0, Resolution::default()).expect("a way");
            steps += plan.steps;
            least += lower_bound_steps(&scenario, start, target, 0);
        }
        assert!(least <= steps && f64::from(steps) < 1.01 * f64::from(least), "{steps} to {least}");
    }

    #[test]
    fn a_search_that_knows_only_the_straight_line_finds_nothing_below_the_bounds() {
        let mut draws = stream(2, "optimum", 0);
        for scenario in [Scenario::default(), cylinders(0.0), maze()] {
            for _ in 0..12 {
                let start = draw_start(&scenario, 0, &mut draws).expect("room");
                let target = draw_target(&scenario, 0, (start.0, start.1), &mut draws).expect("room");
                let bound = Bound::new(&scenario, start, target);
                let mut blind = Bound::new(&scenario, start, target);
                blind.turning_radius = None;
                (blind.geodesic.screens, blind.geodesic.corners) = (Vec::new(), Vec::new());
                let mut world = World::new(&scenario, 0, 0.0);
                let goal = Goal::new(&scenario, target, 0.0);
                let limits = Limits { fewer_than: 500, states: MOST_STATES };
                let mut cells = Cells::new(0.03, 0.16, false);
                let plan = search(&mut world, &blind, &goal, start, &mut cells, &limits).expect("a way");
                let mut state = State::new(start);
                for (steps, &action) in (1..).zip(&plan[..plan.len() - 1]) {
                    state = state.after(&world.moves[usize::from(action)], libm::sincos(state.heading));
                    let (to_go, left) = (bound.steps(&state), plan.len() - steps);
                    assert!(to_go <= left as f64, "{left} steps were enough, not {to_go}");
                }
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn a_plan_replayed_arrives_with_its_last_step_and_touches_nothing(
            seed: u64,
            clock in 0_u64..1_000,
            world in 0_usize..4,
        ) {
            let scenario = &[Scenario::default(), cylinders(0.0), cylinders(0.15), maze()][world];
            let mut draws = stream(seed, "optimum", 0);
            let start = draw_start(scenario, clock, &mut draws).expect("room");
            let target = draw_target(scenario, clock, (start.0, start.1), &mut draws).expect("room");
            let coarse = Resolution { halvings: 0, ..Resolution::default() };
            let first = least_time(scenario, start, target, clock, coarse).expect("a way");
            let plan = least_time(scenario, start, target, clock, Resolution::default()).expect("a way");
            prop_assert_eq!(plan.steps as usize, plan.actions.len());
            prop_assert_eq!(replay(scenario, start, target, clock, &plan.actions), Ok(plan.steps));
            prop_assert!(plan.steps <= first.steps, "a finer search is never worse");
            prop_assert!(lower_bound_steps(scenario, start, target, clock) <= plan.steps);
        }

        /// Wherever the robot gets by any drive at all, no bound on the way says it couldn't.
        #[test]
        fn no_drive_beats_the_bounds(seed: u64, world in 0_usize..3, turns in 1_usize..8, held in 1_u32..20) {
            let scenario = &[Scenario::default(), cylinders(0.0), maze()][world];
            let mut draws = stream(seed, "drive", 0);
            let start = draw_start(scenario, 0, &mut draws).expect("room");
            let free = World::new(scenario, 0, 0.0);
            let mut way = vec![State::new(start)];
            for _ in 0..turns {
                let step = &free.moves[crate::random::below(&mut draws, free.moves.len())];
                for _ in 0..held {
                    let last = way[way.len() - 1];
                    let next = last.after(step, libm::sincos(last.heading));
                    if !free.is_clear(next.x, next.y, 0) {
                        break;
                    }
                    way.push(next);
                }
            }
            let end = way[way.len() - 1];
            let radius = 0.199 * between(&mut draws, 0.0, 1.0);
            let angle = between(&mut draws, 0.0, std::f32::consts::TAU);
            let target = (end.x as f32 + radius * angle.cos(), end.y as f32 + radius * angle.sin());
            let bound = Bound::new(scenario, start, target);
            for (before, state) in way.iter().enumerate() {
                let to_go = bound.steps(state);
                let taken = (way.len() - 1 - before) as f64;
                prop_assert!(to_go <= taken + 1e-9, "{taken} steps from ({}, {}), not {to_go}", state.x, state.y);
            }
            if way.len() > 1 {
                prop_assert!(lower_bound_steps(scenario, start, target, 0) < way.len() as u32);
            }
        }
    }
}
