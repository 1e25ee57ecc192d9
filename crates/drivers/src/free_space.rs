//! The space that earlier scans found free.
//!
//! A hit where an earlier beam had passed is on something that has moved there. Source: C.-C. Wang, C. Thorpe and S. Thrun,
//! *Online simultaneous localization and mapping with detection and tracking of moving objects*, ICRA 2003.

use std::collections::VecDeque;

use glam::Vec2;

use crate::percept::{Odometry, Percept};
use crate::robot::Robot;

/// How long a scan is remembered, in s: a driver of class A (docs/drivers.md) may use nothing older.
const MEMORY_S: f32 = 1.0;

/// The scans of the last second.
#[derive(Default)]
pub(crate) struct FreeSpace {
    /// Oldest first.
    scans: VecDeque<RecentScan>,
}

struct RecentScan {
    ranges_m: Vec<f32>,
    /// The robot's motion since this scan.
    since: Odometry,
}

impl FreeSpace {
    /// Adds a scan. Since the previous one, the robot has moved by `percept.odometry`.
    pub(crate) fn add(&mut self, robot: &Robot, percept: &Percept) {
        for scan in &mut self.scans {
            scan.since = scan.since.then(&percept.odometry);
        }
        let kept = 1 + (MEMORY_S / robot.control_period_s) as usize;
        let oldest = if self.scans.len() >= kept { self.scans.pop_front() } else { None };
        let mut ranges_m = oldest.map(|scan| scan.ranges_m).unwrap_or_default();
        ranges_m.clear();
        ranges_m.extend_from_slice(percept.ranges_m);
        self.scans.push_back(RecentScan { ranges_m, since: Odometry::default() });
    }

    /// Whether, in one of the scans, all beams within one beam spacing of `point_m` (in the robot's present frame) ended at
    /// least `margin_m` beyond it.
    pub(crate) fn contains(&self, robot: &Robot, point_m: Vec2, margin_m: f32) -> bool {
        self.scans.iter().any(|scan| scan.passed(robot, point_m, margin_m))
    }
}

impl RecentScan {
    fn passed(&self, robot: &Robot, point_m: Vec2, margin_m: f32) -> bool {
        let point_m = self.since.to_outer(point_m);
        let distance_m = point_m.length();
        let min_along_m = libm::cosf(robot.beam_spacing_rad) * distance_m;
        let ranges = robot.beams.iter().zip(&self.ranges_m);
        let mut next_to =
            ranges.filter(|(beam, _)| beam.dot(point_m) > min_along_m).map(|(_, range_m)| *range_m);
        next_to.next().is_some_and(|first_m| next_to.fold(first_m, f32::min) >= distance_m + margin_m)
    }
}

#[cfg(test)]
mod tests {
    use glam::vec2;
    use wayfield_scenario::{Motion, Scenario};

    use super::*;

    fn add(space: &mut FreeSpace, robot: &Robot, ranges_m: &[f32], odometry: Odometry) {
        let twist = Motion { v_m_s: 0.0, w_rad_s: 0.0 };
        let percept =
            Percept { ranges_m, goal_distance_m: 1.0, goal_bearing_rad: 0.0, twist, odometry, truth: None };
        space.add(robot, &percept);
    }

    #[test]
    fn a_point_is_free_if_a_beam_of_the_last_second_passed_it() {
        let robot = Robot::of(&Scenario::default());
        let mut space = FreeSpace::default();
        let step = Odometry { translation_m: vec2(0.1, 0.0), rotation_rad: 0.0 };
        // An obstacle is 1 m ahead. After the robot has driven 0.1 m, the obstacle is 0.4 m ahead.
        let (mut far, mut near) = ([3.5; 24], [3.5; 24]);
        far[0] = 1.0;
        near[0] = 0.4;
        add(&mut space, &robot, &far, Odometry::default());
        add(&mut space, &robot, &near, step);
        assert!(space.contains(&robot, vec2(0.4, 0.0), 0.1), "the first beam passed it by 0.5 m");
        assert!(!space.contains(&robot, vec2(0.4, 0.0), 0.6));
        assert!(!space.contains(&robot, vec2(0.9, 0.0), 0.1), "the obstacle itself was there");
        for _ in 0..6 {
            add(&mut space, &robot, &near, Odometry::default());
        }
        assert!(!space.contains(&robot, vec2(0.4, 0.0), 0.1), "the first scan is over a second old");
    }
}
