//! The search space: robot states, the effect of each motion, inflated obstacles and the goal region.
//!
//! In: a scenario and a clock (the number of steps that moving obstacles have already made). Out: the state after a motion, and
//! whether that state is allowed.

use std::f64::consts::TAU;

use glam::Vec2;
use wayfield_scenario::{Motion, Obstacle, ObstacleMotion, Scenario, Shape, pose_at};

/// The robot's pose: the centre in m, and the heading in rad, not wrapped.
#[derive(Clone, Copy)]
pub(super) struct State {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) heading: f64,
}

impl State {
    pub(super) fn new((x, y, heading): (f32, f32, f32)) -> Self {
        Self { x: x.into(), y: y.into(), heading: heading.into() }
    }

    /// The state after one step, given the sine and cosine of the heading.
    pub(super) fn after(&self, step: &MotionPrimitive, (sin, cos): (f64, f64)) -> Self {
        Self {
            x: self.x + step.ahead * cos - step.left * sin,
            y: self.y + step.ahead * sin + step.left * cos,
            heading: self.heading + step.turn,
        }
    }

    /// The state in f32, with the heading in [-pi, pi].
    pub(super) fn pose(&self) -> (f32, f32, f32) {
        (self.x as f32, self.y as f32, libm::remainder(self.heading, TAU) as f32)
    }
}

/// The effect of one step of a motion in the robot's frame: displacement ahead and to the left in m, turn in rad.
#[derive(Clone, Copy)]
pub(super) struct MotionPrimitive {
    pub(super) ahead: f64,
    pub(super) left: f64,
    pub(super) turn: f64,
}

impl MotionPrimitive {
    /// The effect of `motion` after `period` s: the end of an arc. The turn is w T; the chord has the length
    /// v T sinc(w T / 2) and the direction w T / 2.
    fn new(motion: &Motion, period: f32) -> Self {
        // The product is rounded to f32, as in the simulation, so that the headings stay equal.
        let turn = f64::from(motion.w_rad_s * period);
        let half = turn / 2.0;
        let sinc = if half.abs() < 1e-6 { 1.0 } else { libm::sin(half) / half };
        let chord = f64::from(motion.v_m_s) * f64::from(period) * sinc;
        Self { ahead: chord * libm::cos(half), left: chord * libm::sin(half), turn }
    }
}

/// An obstacle inflated by the distance that the robot keeps: a rectangle with rounded corners. Circles and capsules are
/// special cases.
pub(super) struct InflatedObstacle {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) cos: f64,
    pub(super) sin: f64,
    pub(super) half_width: f64,
    pub(super) half_height: f64,
    /// The radius of the corners, in m; positive.
    pub(super) radius: f64,
}

impl InflatedObstacle {
    pub(super) fn new(shape: &Shape, (x, y, rotation): (f32, f32, f32), inflation: f64) -> Self {
        let (sin, cos) = libm::sincos(rotation.into());
        let (half_width, half_height, radius) = match shape.rounded_box() {
            Some(rounded) => (
                f64::from(rounded.half_width_m),
                f64::from(rounded.half_height_m),
                f64::from(rounded.radius_m) + inflation,
            ),
            // Unsupported; callers check `is_supported` first.
            None => (0.0, 0.0, f64::INFINITY),
        };
        Self { x: x.into(), y: y.into(), cos, sin, half_width, half_height, radius }
    }

    /// Whether the point is outside the obstacle or on its boundary.
    pub(super) fn is_clear(&self, x: f64, y: f64) -> bool {
        let (dx, dy) = (x - self.x, y - self.y);
        let past_x = ((dx * self.cos + dy * self.sin).abs() - self.half_width).max(0.0);
        let past_y = ((dy * self.cos - dx * self.sin).abs() - self.half_height).max(0.0);
        past_x * past_x + past_y * past_y >= self.radius * self.radius
    }
}

/// The static obstacles inside the enclosure, and the segments of inner walls.
pub(super) fn static_obstacles(scenario: &Scenario) -> impl Iterator<Item = Obstacle> {
    let obstacles = scenario.obstacles.iter().filter(|o| o.motion == ObstacleMotion::Static).cloned();
    obstacles.chain(scenario.walls.iter().flat_map(wayfield_scenario::Wall::pieces))
}

/// The allowed positions of the robot, and its motions.
pub(super) struct ConfigurationSpace<'a> {
    pub(super) motion_primitives: Vec<MotionPrimitive>,
    /// Half the width and height, in m, of the rectangle in which the robot's centre must stay.
    half_width: f64,
    half_height: f64,
    /// The distance that the robot's centre keeps from surfaces, in m.
    inflation: f64,
    static_obstacles: Vec<InflatedObstacle>,
    moving_obstacles: Vec<&'a Obstacle>,
    /// The moving obstacles after 0, 1, ... steps, as far as computed by [`ConfigurationSpace::prepare`].
    moving_at_step: Vec<Vec<InflatedObstacle>>,
    clock: u64,
    period_s: f32,
}

impl<'a> ConfigurationSpace<'a> {
    /// The configuration space of `scenario` after `clock` steps, in which the robot's centre keeps `keep_out_m` from surfaces.
    pub(super) fn new(scenario: &'a Scenario, clock: u64, keep_out_m: f64) -> Self {
        let inflation = keep_out_m.max(0.0);
        let (_, Vec2 { x: half_width, y: half_height }) = scenario.enclosure.bounds_m();
        let period_s = scenario.task.control_period_s;
        let motions = scenario.robot.motions.iter();
        Self {
            motion_primitives: motions.map(|motion| MotionPrimitive::new(motion, period_s)).collect(),
            half_width: f64::from(half_width) - inflation,
            half_height: f64::from(half_height) - inflation,
            inflation,
            static_obstacles: static_obstacles(scenario)
                .map(|o| InflatedObstacle::new(&o.shape, pose_at(&o, 0, period_s), inflation))
                .collect(),
            moving_obstacles: scenario
                .obstacles
                .iter()
                .filter(|o| o.motion != ObstacleMotion::Static)
                .collect(),
            moving_at_step: Vec::new(),
            clock,
            period_s,
        }
    }

    /// The states after 0, 1, ... of `actions`, from `start`.
    pub(super) fn rollout(&self, start: (f32, f32, f32), actions: &[u8]) -> impl Iterator<Item = State> {
        let start = State::new(start);
        let after = actions.iter().scan(start, |state, &action| {
            *state = state.after(&self.motion_primitives[usize::from(action)], libm::sincos(state.heading));
            Some(*state)
        });
        std::iter::once(start).chain(after)
    }

    pub(super) fn has_moving_obstacles(&self) -> bool {
        !self.moving_obstacles.is_empty()
    }

    /// Computes the poses of the moving obstacles after up to `steps` steps.
    pub(super) fn prepare(&mut self, steps: u32) {
        while self.has_moving_obstacles() && self.moving_at_step.len() <= steps as usize {
            let clock = self.clock.saturating_add(self.moving_at_step.len() as u64);
            let inflated = |o: &&Obstacle| {
                InflatedObstacle::new(&o.shape, pose_at(o, clock, self.period_s), self.inflation)
            };
            self.moving_at_step.push(self.moving_obstacles.iter().map(inflated).collect());
        }
    }

    /// Whether the robot may be at (x, y) after `steps` steps. Call [`Self::prepare`] with at least `steps` first.
    pub(super) fn is_clear(&self, x: f64, y: f64, steps: u32) -> bool {
        x.abs() <= self.half_width
            && y.abs() <= self.half_height
            && self.static_obstacles.iter().all(|obstacle| obstacle.is_clear(x, y))
            && self.moving_at_step.get(steps as usize).is_none_or(|all| all.iter().all(|o| o.is_clear(x, y)))
    }
}

/// The goal region: the disc that the robot's centre must enter.
pub(super) struct GoalRegion {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) radius: f64,
}

impl GoalRegion {
    /// The goal region of `scenario`, with `margin_m` added to its radius.
    pub(super) fn new(scenario: &Scenario, goal: Vec2, margin_m: f64) -> Self {
        let radius = (f64::from(scenario.task.goal_radius_m) + margin_m).max(0.0);
        Self { x: goal.x.into(), y: goal.y.into(), radius }
    }

    pub(super) fn contains(&self, x: f64, y: f64) -> bool {
        distance((x, y), (self.x, self.y)) < self.radius
    }
}

pub(super) fn distance(from: (f64, f64), to: (f64, f64)) -> f64 {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    (dx * dx + dy * dy).sqrt()
}
