//! The observer of the sectors around a scenario's robot.

use glam::vec2;
use wayfield_policy::observation::{BodyScale, LidarBeams, SectorLayout, SectorObserver};
use wayfield_scenario::{Scenario, Shape};

/// Steps of the bisection that finds the edge of a body: to a millionth of its extent.
const HALVINGS: u32 = 20;

/// A new observer for the robot of `scenario`.
#[must_use]
pub fn sector_observer(layout: SectorLayout, scenario: &Scenario) -> SectorObserver {
    let Scenario { robot, lidar, task, .. } = scenario;
    let angles_rad: Vec<f32> = (0..lidar.beams).map(|beam| lidar.beam_angle_rad(beam) as f32).collect();
    let (low, high) = robot.motion_limits();
    let extent_m = |&angle_rad: &f32| {
        let body_m = robot.shape.as_ref().map_or(robot.radius_m, |shape| extent(shape, angle_rad));
        body_m.max(task.collision_range_m)
    };
    let body = BodyScale {
        unit_m: scenario.robot_unit_m(),
        extents_m: angles_rad.iter().map(extent_m).collect(),
        max_speed_m_s: high.v_m_s.max(-low.v_m_s).max(0.001),
        max_turn_rad_s: high.w_rad_s.max(-low.w_rad_s).max(0.001),
        control_period_s: task.control_period_s,
        goal_radius_m: task.goal_radius_m,
    };
    let (spacing_rad, max_range_m) = (lidar.beam_spacing_rad(), lidar.max_range_m);
    let beams = LidarBeams { angles_rad, spacing_rad, max_range_m };
    SectorObserver::new(layout, &beams, body)
}

/// The extent of a body from its origin in a direction, in m.
fn extent(shape: &Shape, angle_rad: f32) -> f32 {
    let (sin, cos) = libm::sincosf(angle_rad);
    let (mut inside, mut outside) = (0.0, shape.bounding_radius_m());
    for _ in 0..HALVINGS {
        let middle = 0.5 * (inside + outside);
        if shape.distance(vec2(cos, sin) * middle) < 0.0 {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    outside
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extent_of_a_rectangle_is_the_distance_to_its_edge() {
        let shape = Shape::Rectangle { width_m: 0.4, height_m: 0.2 };
        for (angle_rad, expected) in
            [(0.0, 0.2), (0.5 * std::f32::consts::PI, 0.1), (0.3, 0.2 / 0.3_f32.cos())]
        {
            let found = extent(&shape, angle_rad);
            assert!((found - expected).abs() < 1e-5, "at {angle_rad} rad: {found}, not {expected}");
        }
    }
}
