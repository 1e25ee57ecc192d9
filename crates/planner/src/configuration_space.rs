//! The world as it is searched: states, motions, what stands in the way, the goal.
//!
//! In: a scenario and a clock. Out: the state after a motion, and whether it is allowed.

use std::f64::consts::TAU;

use glam::Vec2;
use wayfield_scenario::{Obstacle, ObstacleMotion, Scenario, Shape, pose_at};

/// Robot's centre in m and heading in rad, not wrapped.
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

    /// Where a step leads from here, given the sine and cosine of the heading.
    pub(super) fn after(&self, step: &MotionPrimitive, (sin, cos): (f64, f64)) -> Self {
        Self {
            x: self.x + step.ahead * cos - step.left * sin,
            y: self.y + step.ahead * sin + step.left * cos,
            heading: self.heading + step.turn,
        }
    }

    /// The state as others write it, the heading wrapped.
    pub(super) fn pose(&self) -> (f32, f32, f32) {
        (self.x as f32, self.y as f32, libm::remainder(self.heading, TAU) as f32)
    }
}

/// What one step of a motion does, seen from the robot: forward, to the left (in m), and the turn (in rad).
#[derive(Clone, Copy)]
pub(super) struct MotionPrimitive {
    pub(super) ahead: f64,
    pub(super) left: f64,
    pub(super) turn: f64,
}

/// The end of each motion's arc: its chord points half the turn aside and is sinc of that long.
pub(super) fn motion_primitives(scenario: &Scenario) -> Vec<MotionPrimitive> {
    let period = scenario.task.control_period_s;
    let of = |motion: &wayfield_scenario::Motion| {
        // Rounded to f32 as the world rounds it, lest the headings drift apart.
        let turn = f64::from(motion.w_rad_s * period);
        let half = turn / 2.0;
        let sinc = if half.abs() < 1e-6 { 1.0 } else { libm::sin(half) / half };
        let chord = f64::from(motion.v_m_s) * f64::from(period) * sinc;
        MotionPrimitive { ahead: chord * libm::cos(half), left: chord * libm::sin(half), turn }
    };
    scenario.robot.motions.iter().map(of).collect()
}

/// An obstacle grown by the collision range: a box with rounded corners, which a circle and a rod are too.
pub(super) struct InflatedObstacle {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) cos: f64,
    pub(super) sin: f64,
    pub(super) half_width: f64,
    pub(super) half_height: f64,
    /// Of the corners, in m; positive.
    pub(super) radius: f64,
}

impl InflatedObstacle {
    pub(super) fn new(shape: &Shape, (x, y, rotation): (f32, f32, f32), inflation: f64) -> Self {
        let (sin, cos) = libm::sincos(rotation.into());
        let (half_width, half_height, radius) = match *shape {
            Shape::Circle { radius_m } => (0.0, 0.0, f64::from(radius_m) + inflation),
            Shape::Rectangle { width_m, height_m } => {
                (f64::from(width_m) / 2.0, f64::from(height_m) / 2.0, inflation)
            }
            Shape::Capsule { length_m, radius_m } => {
                (f64::from(length_m) / 2.0, 0.0, f64::from(radius_m) + inflation)
            }
            // Not modelled: whoever plans asks first (`is_supported`).
            Shape::Polygon { .. } => (0.0, 0.0, f64::INFINITY),
        };
        Self { x: x.into(), y: y.into(), cos, sin, half_width, half_height, radius }
    }

    /// Whether the point is outside or on the rim.
    pub(super) fn is_clear(&self, x: f64, y: f64) -> bool {
        let (dx, dy) = (x - self.x, y - self.y);
        let past_x = ((dx * self.cos + dy * self.sin).abs() - self.half_width).max(0.0);
        let past_y = ((dy * self.cos - dx * self.sin).abs() - self.half_height).max(0.0);
        past_x * past_x + past_y * past_y >= self.radius * self.radius
    }
}

/// All that stands still within the enclosure: obstacles, and the pieces of inner walls.
pub(super) fn static_obstacles(scenario: &Scenario) -> impl Iterator<Item = Obstacle> {
    let obstacles = scenario.obstacles.iter().filter(|o| o.motion == ObstacleMotion::Static).cloned();
    obstacles.chain(scenario.walls.iter().flat_map(|wall| wall.segments()))
}

/// Where the robot may be, and how it moves.
pub(super) struct ConfigurationSpace<'a> {
    pub(super) motion_primitives: Vec<MotionPrimitive>,
    /// Of the rectangle that the robot's centre must keep to, in m.
    pub(super) half_width: f64,
    pub(super) half_height: f64,
    pub(super) inflation: f64,
    pub(super) still: Vec<InflatedObstacle>,
    pub(super) moving: Vec<&'a Obstacle>,
    /// The moving obstacles after 0, 1, ... steps, as far as they have been asked for.
    pub(super) at_step: Vec<Vec<InflatedObstacle>>,
    pub(super) clock: u64,
    pub(super) period_s: f32,
}

impl<'a> ConfigurationSpace<'a> {
    /// The world with a collision range larger by `margin_m`.
    pub(super) fn new(scenario: &'a Scenario, clock: u64, margin_m: f64) -> Self {
        let inflation = (f64::from(scenario.task.collision_range_m) + margin_m).max(0.0);
        let (_, Vec2 { x: half_width, y: half_height }) = scenario.enclosure.bounds_m();
        let period_s = scenario.task.control_period_s;
        let still = static_obstacles(scenario)
            .map(|o| InflatedObstacle::new(&o.shape, pose_at(&o, 0, period_s), inflation))
            .collect();
        let moving = scenario.obstacles.iter().filter(|o| o.motion != ObstacleMotion::Static).collect();
        Self {
            motion_primitives: motion_primitives(scenario),
            half_width: f64::from(half_width) - inflation,
            half_height: f64::from(half_height) - inflation,
            inflation,
            still,
            moving,
            at_step: Vec::new(),
            clock,
            period_s,
        }
    }

    /// The states after 0, 1, ... of these actions.
    pub(super) fn rollout(&self, start: (f32, f32, f32), actions: &[u8]) -> impl Iterator<Item = State> {
        let start = State::new(start);
        let after = actions.iter().scan(start, |state, &action| {
            *state = state.after(&self.motion_primitives[usize::from(action)], libm::sincos(state.heading));
            Some(*state)
        });
        std::iter::once(start).chain(after)
    }

    /// Whether any obstacle moves.
    pub(super) fn has_moving_obstacles(&self) -> bool {
        !self.moving.is_empty()
    }

    /// Works out where the moving obstacles are after `steps` steps.
    pub(super) fn prepare(&mut self, steps: u32) {
        while self.has_moving_obstacles() && self.at_step.len() <= steps as usize {
            let clock = self.clock.saturating_add(self.at_step.len() as u64);
            let placed = |o: &&Obstacle| {
                InflatedObstacle::new(&o.shape, pose_at(o, clock, self.period_s), self.inflation)
            };
            self.at_step.push(self.moving.iter().map(placed).collect());
        }
    }

    /// Whether the robot may be at (x, y) after `steps` steps, which have been prepared.
    pub(super) fn is_clear(&self, x: f64, y: f64, steps: u32) -> bool {
        x.abs() <= self.half_width
            && y.abs() <= self.half_height
            && self.still.iter().all(|solid| solid.is_clear(x, y))
            && self.at_step.get(steps as usize).is_none_or(|all| all.iter().all(|s| s.is_clear(x, y)))
    }
}

/// The disc to reach.
pub(super) struct GoalRegion {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) radius: f64,
}

impl GoalRegion {
    /// The target's disc with a radius larger by `margin_m`.
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
