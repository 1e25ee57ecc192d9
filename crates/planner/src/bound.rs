//! The lower bound on the remaining steps, from the shortest path around the obstacles and the turning radius.
//!
//! In: a scenario, a start, a goal. Out: the bound from any state. The proofs are in `docs/optimum.md`.

use std::f64::consts::TAU;

use super::MARGIN_M;
use super::configuration_space::{GoalRegion, State};
use super::visibility_graph::VisibilityGraph;
use glam::Vec2;
use wayfield_scenario::Scenario;

/// The lower bound on the number of steps to one goal, as a function of the state.
pub(super) struct LowerBound {
    goal_region: GoalRegion,
    /// The length of the longest arc of one step, in m. No step moves the robot farther.
    stride: f64,
    /// The smallest turning radius, in m; `None` if a motion turns on the spot or drives backward, or if none turns.
    pub(super) turning_radius: Option<f64>,
    pub(super) visibility_graph: VisibilityGraph,
}

impl LowerBound {
    pub(super) fn new(scenario: &Scenario, start: (f32, f32, f32), goal: Vec2) -> Self {
        let period = f64::from(scenario.task.control_period_s);
        let motions = &scenario.robot.motions;
        let stride = motions.iter().map(|m| f64::from(m.v_m_s).abs() * period).fold(0.0, f64::max);
        // A motion that stands still gives 0 / 0, which `min` ignores; a turn on the spot gives 0, and a backward motion a
        // negative radius.
        let radii = motions.iter().map(|m| f64::from(m.v_m_s) / f64::from(m.w_rad_s).abs());
        let turning_radius = radii.fold(f64::INFINITY, f64::min);
        let goal_region = GoalRegion::new(scenario, goal, MARGIN_M);
        let visibility_graph =
            VisibilityGraph::new(scenario, (start.0.into(), start.1.into()), &goal_region, stride);
        Self {
            goal_region,
            stride,
            turning_radius: Some(turning_radius).filter(|radius| radius.is_finite() && *radius > 0.0),
            visibility_graph,
        }
    }

    /// The bound from an allowed state: a number of steps, not rounded, or infinity if there is no path.
    pub(super) fn steps(&self, state: &State) -> f64 {
        let length = self.visibility_graph.length((state.x, state.y)).max(self.turning_length(state));
        ((length - self.goal_region.radius) / self.stride).max(0.0)
    }

    /// The length, in m, of the shortest path around the static obstacles, from a point to the edge of the goal region; infinite
    /// if there is none.
    pub(super) fn path_m(&self, from: (f64, f64)) -> f64 {
        (self.visibility_graph.length(from) - self.goal_region.radius).max(0.0)
    }

    /// The length, in m, of the shortest path to the goal that curves no more tightly than the turning radius: an arc, then its
    /// tangent. 0 if the goal region touches a turning circle, because the proof does not cover that case.
    fn turning_length(&self, state: &State) -> f64 {
        let Some(r) = self.turning_radius else { return 0.0 };
        let (dx, dy) = (self.goal_region.x - state.x, self.goal_region.y - state.y);
        let (sin, cos) = libm::sincos(state.heading);
        // The frame is mirrored so that the goal is on the left. The nearer turning circle is then the left one, centred
        // at (0, r).
        let (ahead, left) = (dx * cos + dy * sin, (dy * cos - dx * sin).abs());
        let square = ahead * ahead + (left - r) * (left - r);
        let minimum = r + self.goal_region.radius;
        if square < minimum * minimum {
            return 0.0;
        }
        let tangent = (square - r * r).sqrt();
        let turn = libm::atan2(left - r, ahead) + libm::atan2(r, tangent);
        // The tolerance keeps rounding from making a full turn out of an angle of 0, when the goal is straight ahead.
        let turn = if turn < -1e-9 { turn + TAU } else { turn.max(0.0) };
        r * turn + tangent
    }
}

/// `steps`, a lower bound, rounded up to whole steps; at least 1.
pub(super) fn ceil_steps(steps: f64) -> u32 {
    ((steps - 1e-9).ceil() as u32).max(1)
}
