//! The potential field: the goal attracts, surfaces repel, and the robot drives along the sum of the forces.
//!
//! Source: O. Khatib, *Real-time obstacle avoidance for manipulators and mobile robots*, International Journal of Robotics
//! Research 5(1), 1986: each point that a beam hit repels by eq. (16), the force of Khatib's "FIRAS" potential. The attraction is
//! that of a conic potential, so its strength does not depend on the distance.

use glam::Vec2;

use crate::Driver;
use crate::config::FieldParameters;
use crate::percept::Percept;
use crate::robot::Robot;

/// Surfaces closer to the keep-out circle than this, in units of its radius, repel as if they were at this distance.
const MIN_DISTANCE: f32 = 0.05;

/// A robot in a potential field.
pub(crate) struct Field {
    pub(crate) robot: Robot,
    pub(crate) parameters: FieldParameters,
}

impl Driver for Field {
    fn act(&mut self, percept: &Percept) -> usize {
        let force = self.attraction(percept) + self.repulsion(percept.ranges_m);
        let nearest_m = percept.ranges_m.iter().copied().fold(self.robot.max_range_m, f32::min);
        let slow_m = self.parameters.slow_distance * self.robot.unit_m;
        // At least a tenth, so that the robot does not stop near surfaces.
        let speed_fraction = ((nearest_m - self.robot.unit_m) / slow_m).clamp(0.1, 1.0);
        let velocity = force.normalize_or_zero() * (self.robot.max_forward_speed_m_s() * speed_fraction);
        self.robot.motion_towards(velocity, self.parameters.turn_time_s)
    }
}

impl Field {
    /// The attraction of the goal: a force of 1 towards it.
    fn attraction(&self, percept: &Percept) -> Vec2 {
        percept.goal_m().normalize_or_zero()
    }

    /// The sum of the repulsions of all points of a scan, each weighted by the angle that its beam stands for, so that the
    /// number of beams doesn't matter. With the distance d from the keep-out circle, in units of its radius:
    /// `repulsion` (1 / d - 1 / `influence_distance`) / d^2 away from the point.
    fn repulsion(&self, ranges_m: &[f32]) -> Vec2 {
        let FieldParameters { repulsion, influence_distance, .. } = self.parameters;
        let keep_out_m = self.robot.unit_m;
        let force = |(beam, range_m): (&Vec2, &f32)| {
            let d = ((range_m - keep_out_m) / keep_out_m).max(MIN_DISTANCE);
            let strength = repulsion * (1.0 / d - 1.0 / influence_distance).max(0.0) / (d * d);
            -*beam * (strength * self.robot.beam_spacing_rad)
        };
        let hits =
            self.robot.beams.iter().zip(ranges_m).filter(|(_, range)| **range < self.robot.max_range_m);
        hits.map(force).sum()
    }
}

#[cfg(test)]
mod tests {
    use glam::vec2;
    use wayfield_scenario::{Motion, Scenario};

    use super::*;
    use crate::percept::Odometry;

    fn field() -> Field {
        let parameters =
            FieldParameters { repulsion: 0.5, influence_distance: 4.0, ..FieldParameters::default() };
        Field { robot: Robot::of(&Scenario::default()), parameters }
    }

    fn percept(ranges_m: &[f32], goal_bearing_rad: f32) -> Percept<'_> {
        Percept {
            ranges_m,
            goal_distance_m: 2.0,
            goal_bearing_rad,
            twist: Motion { v_m_s: 0.0, w_rad_s: 0.0 },
            odometry: Odometry::default(),
            truth: None,
        }
    }

    #[test]
    fn attraction_and_repulsion_are_those_worked_out_by_hand() {
        let field = field();
        let mut ranges_m = [3.5; 24];
        let attraction = field.attraction(&percept(&ranges_m, std::f32::consts::FRAC_PI_2));
        assert!((attraction - vec2(0.0, 1.0)).length() < 1e-6, "a goal to the left: {attraction}");
        assert_eq!(field.repulsion(&ranges_m), Vec2::ZERO, "nothing in sight repels");
        // The keep-out distance is 0.13 m. A hit 0.39 m ahead is 2 such distances beyond it:
        // 0.5 (1/2 - 1/4) / 4 = 0.03125, times 2 pi / 24 for the beam.
        ranges_m[0] = 0.39;
        let expected = -0.031_25 * std::f32::consts::TAU / 24.0;
        let repulsion = field.repulsion(&ranges_m);
        assert!((repulsion - vec2(expected, 0.0)).length() < 1e-5, "{repulsion}");
        // Beyond the influence distance of 4, nothing repels: 0.13 (1 + 4) = 0.65 m.
        ranges_m[0] = 0.66;
        assert_eq!(field.repulsion(&ranges_m), Vec2::ZERO);
    }

    #[test]
    fn it_turns_away_from_a_surface_between_it_and_its_goal() {
        let mut ranges_m = [3.5; 24];
        assert_eq!(field().act(&percept(&ranges_m, 0.0)), 2, "straight ahead while nothing is near");
        (ranges_m[0], ranges_m[1], ranges_m[2]) = (0.16, 0.16, 0.16);
        assert_eq!(field().act(&percept(&ranges_m, 0.0)), 4, "hits ahead and to the left");
    }
}
