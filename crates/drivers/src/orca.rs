//! The ORCA driver: it knows the true poses and velocities, and steers towards the velocity that [`wayfield_orca`] returns.

use glam::{Vec2, vec2};
use wayfield_orca::{Avoidance, Disc, avoiding_velocity};
use wayfield_scenario::{ObstacleMotion, nearest_points};

use crate::Driver;
use crate::config::OrcaParameters;
use crate::percept::{Odometry, Percept, Truth};
use crate::robot::Robot;

/// A driver that knows the true poses and velocities.
pub(crate) struct OrcaDriver {
    pub(crate) robot: Robot,
    pub(crate) parameters: OrcaParameters,
}

impl Driver for OrcaDriver {
    fn act(&mut self, percept: &Percept) -> usize {
        let Some(truth) = &percept.truth else { return 0 };
        let OrcaParameters { time_horizon_s, static_horizon_s, responsibility, margin, turn_time_s } =
            self.parameters;
        let (x, y, rotation_rad) = truth.pose;
        let frame = Odometry { translation_m: Vec2::ZERO, rotation_rad };
        let max_speed = self.robot.max_forward_speed_m_s();
        let agent = Disc {
            at_m: vec2(x, y),
            velocity_m_s: frame.to_outer(vec2(percept.twist.v_m_s, 0.0)),
            radius_m: self.robot.unit_m * (1.0 + margin),
        };
        let to_goal = truth.goal_m - agent.at_m;
        let wanted = to_goal.normalize_or_zero() * max_speed;
        let reach_m = agent.radius_m + max_speed * static_horizon_s;
        let avoidance = Avoidance {
            discs: &discs(truth, self.robot.control_period_s),
            points_m: &nearest_points(truth.layout.scenario, agent.at_m, reach_m),
            time_horizon_s,
            static_horizon_s,
            responsibility,
            period_s: self.robot.control_period_s,
        };
        let velocity = avoiding_velocity(&agent, wanted, max_speed, &avoidance);
        self.robot.motion_towards(frame.to_inner(velocity), turn_time_s)
    }
}

/// The moving obstacles as discs, with their velocities over the next step; for pedestrians, over the last one.
fn discs(truth: &Truth, period_s: f32) -> Vec<Disc> {
    let layout = truth.layout;
    let disc = |index: usize| {
        let at = |step| {
            let (x, y, _) = layout.pose_at(index, step);
            vec2(x, y)
        };
        let now_m = at(truth.clock);
        let velocity_m_s = match layout.pedestrian(index) {
            Some(pedestrian) => pedestrian.velocity_m_s,
            None => (at(truth.clock + 1) - now_m) / period_s,
        };
        let radius_m = layout.scenario.obstacles[index].shape.bounding_radius_m();
        Disc { at_m: now_m, velocity_m_s, radius_m }
    };
    let obstacles = layout.scenario.obstacles.iter().enumerate();
    obstacles.filter(|(_, o)| o.motion != ObstacleMotion::Static).map(|(index, _)| disc(index)).collect()
}
