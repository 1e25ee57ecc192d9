//! The dynamic window approach: every motion is simulated some seconds ahead, and the one with the highest score is chosen.
//!
//! Source: D. Fox, W. Burgard and S. Thrun, *The dynamic window approach to collision avoidance*, IEEE Robotics and Automation
//! Magazine 4(1), 1997. The score is their eq. (13) without smoothing: heading, clearance (as time until a collision) and
//! speed. The window is the robot's set of motions, with the lag of its drive. A motion is admissible if, after it, the
//! robot can still stop before it collides; for a robot that cannot stop, the motion must be free of collisions over the
//! whole horizon. If no motion is admissible, the one with the latest collision is chosen.

use std::collections::VecDeque;
use std::f32::consts::PI;

use glam::Vec2;
use wayfield_scenario::{Drive, Motion};

use crate::Driver;
use crate::config::{DwaParameters, TrackingParameters};
use crate::percept::{Odometry, Percept};
use crate::robot::{Robot, argmin};
use crate::tracks::Tracks;

/// The maximum number of samples of a simulated motion.
const MAX_SAMPLES: f32 = 100.0;

/// A point of an obstacle, with its velocity, in the robot's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MovingPoint {
    pub(crate) at_m: Vec2,
    pub(crate) velocity_m_s: Vec2,
}

/// The dynamic window approach for a robot.
pub(crate) struct Dwa {
    robot: Robot,
    parameters: DwaParameters,
    /// The time between two samples of a simulated motion, in s.
    sample_s: f32,
    /// The drive over steps of `sample_s`.
    drive: Drive,
    /// The time for which an admissible motion must be free of collisions, in s.
    admissible_s: f32,
}

/// The result of simulating a motion.
struct Rollout {
    /// The time until a collision, in s; the horizon if there is none.
    free_s: f32,
    /// The alignment with the direction of the goal, 0 to 1, after `heading_time_s`; 0 if the motion collides before.
    heading: f32,
}

impl Dwa {
    pub(crate) fn new(robot: Robot, parameters: DwaParameters) -> Self {
        let Robot { control_period_s, drive, .. } = robot;
        let samples = (parameters.horizon_s / control_period_s)
            .max(2.0 * robot.max_speed_m_s() * parameters.horizon_s / robot.unit_m)
            .ceil()
            .clamp(1.0, MAX_SAMPLES);
        let can_stop = robot.motions.iter().any(|motion| motion.v_m_s == 0.0);
        let stopping_s = 2.0 * control_period_s + drive.settling_time_s(robot.max_speed_m_s());
        let admissible_s = if can_stop { stopping_s.min(parameters.horizon_s) } else { parameters.horizon_s };
        let sample_s = parameters.horizon_s / samples;
        Self { sample_s, drive: drive.over(sample_s), admissible_s, robot, parameters }
    }

    /// The index of the best motion towards `aim_m` (in the robot's frame) among obstacles. `clearance(point_m, after_s)` is
    /// the distance in m from a point in the robot's present frame to the nearest surface after `after_s`. The simulation of a
    /// motion ends when it gets within `aim_radius_m` of that point.
    pub(crate) fn choose(
        &self,
        twist: &Motion,
        aim_m: Vec2,
        aim_radius_m: f32,
        clearance: impl Fn(Vec2, f32) -> f32,
    ) -> usize {
        let DwaParameters { heading, clearance: weight, speed, horizon_s, margin, .. } = self.parameters;
        // A robot that is already inside the margin must not come any closer.
        let keep_m = self.robot.unit_m;
        let limit_m = (keep_m * (1.0 + margin)).min(clearance(Vec2::ZERO, 0.0) - 1e-4);
        let max_speed = self.robot.max_forward_speed_m_s();
        let cost = |motion: &Motion| {
            let rollout = self.simulate(twist, motion, aim_m, aim_radius_m, limit_m, &clearance);
            if rollout.free_s < self.admissible_s {
                // Worse than any admissible motion. Among inadmissible ones, the latest collision is the best.
                let all = heading + weight + speed;
                return 1.0 + all + 1.0 - rollout.free_s / horizon_s;
            }
            -(heading * rollout.heading
                + weight * rollout.free_s / horizon_s
                + speed * (motion.v_m_s / max_speed).max(0.0))
        };
        argmin(self.robot.motions.iter().map(cost))
    }

    /// Simulates `motion` until the horizon, the aim or a collision, which is a clearance below `limit_m`. The other arguments
    /// are those of [`Dwa::choose`].
    fn simulate(
        &self,
        twist: &Motion,
        motion: &Motion,
        aim_m: Vec2,
        aim_radius_m: f32,
        limit_m: f32,
        clearance: &impl Fn(Vec2, f32) -> f32,
    ) -> Rollout {
        let DwaParameters { horizon_s, heading_time_s, .. } = self.parameters;
        let mut pose = Odometry::default();
        let mut actual = *twist;
        let mut after_s = 0.0;
        let mut rollout = Rollout { free_s: horizon_s, heading: 0.0 };
        let mut is_scored = false;
        while after_s < horizon_s - 0.5 * self.sample_s {
            let (mean, next) = self.drive.step(&actual, motion);
            pose = pose.then(&Robot::arc(&mean, self.sample_s));
            actual = next;
            after_s += self.sample_s;
            let is_there = (aim_m - pose.translation_m).length() < aim_radius_m;
            if !is_scored && (is_there || after_s >= heading_time_s || after_s + self.sample_s > horizon_s) {
                is_scored = true;
                rollout.heading = if is_there { 1.0 } else { alignment(&pose, aim_m) };
            }
            if clearance(pose.translation_m, after_s) < limit_m {
                rollout.free_s = after_s - self.sample_s;
                break;
            }
            if is_there {
                break;
            }
        }
        rollout
    }

    /// The argument `clearance` of [`Dwa::choose`] for obstacles at `points`. Points out of reach are left out.
    pub(crate) fn clearance_from<I: Iterator<Item = MovingPoint>>(
        &self,
        points: I,
    ) -> impl Fn(Vec2, f32) -> f32 + use<I> {
        let DwaParameters { horizon_s, margin, .. } = self.parameters;
        let reach_m = self.robot.unit_m * (1.0 + margin) + self.robot.max_speed_m_s() * horizon_s;
        let near: Vec<MovingPoint> = points
            .filter(|point| point.at_m.length() <= reach_m + point.velocity_m_s.length() * horizon_s)
            .collect();
        move |at_m, after_s| {
            let squared =
                |point: &MovingPoint| (point.at_m + point.velocity_m_s * after_s - at_m).length_squared();
            near.iter().map(squared).fold(f32::INFINITY, f32::min).sqrt()
        }
    }
}

/// How well a robot at `pose` points at `aim_m`: 1 if that point lies straight ahead, 0 if it lies behind.
fn alignment(pose: &Odometry, aim_m: Vec2) -> f32 {
    let aim = pose.to_inner(aim_m);
    1.0 - libm::atan2f(aim.y, aim.x).abs() / PI
}

/// The points of the last scans that are taken as static.
#[derive(Default)]
struct Memory {
    /// The points of each scan in the present frame, oldest scan first.
    scans: VecDeque<Vec<Vec2>>,
}

impl Memory {
    /// Moves the points by `odometry`, adds those of a new scan, and forgets those that are too old.
    fn add(&mut self, dwa: &Dwa, odometry: &Odometry, new: Vec<Vec2>) {
        for point in self.scans.iter_mut().flatten() {
            *point = odometry.to_inner(*point);
        }
        self.scans.push_back(new);
        let kept = 1 + (dwa.parameters.memory_s / dwa.robot.control_period_s) as usize;
        while self.scans.len() > kept {
            self.scans.pop_front();
        }
    }

    fn points(&self) -> impl Iterator<Item = MovingPoint> + '_ {
        let still = |at_m: &Vec2| MovingPoint { at_m: *at_m, velocity_m_s: Vec2::ZERO };
        self.scans.iter().flatten().map(still)
    }
}

/// The dynamic window approach on the scans, in which all points are taken as static.
pub(crate) struct DwaDriver {
    dwa: Dwa,
    memory: Memory,
}

impl DwaDriver {
    pub(crate) fn new(robot: Robot, parameters: DwaParameters) -> Self {
        Self { dwa: Dwa::new(robot, parameters), memory: Memory::default() }
    }
}

impl Driver for DwaDriver {
    fn act(&mut self, percept: &Percept) -> usize {
        let hits = self.dwa.robot.hits(percept.ranges_m).collect();
        self.memory.add(&self.dwa, &percept.odometry, hits);
        let clearance = self.dwa.clearance_from(self.memory.points());
        self.dwa.choose(&percept.twist, percept.goal_m(), self.dwa.robot.goal_radius_m, clearance)
    }
}

/// The dynamic window approach with estimated velocities.
pub(crate) struct TrackingDwaDriver {
    dwa: Dwa,
    tracks: Tracks,
    memory: Memory,
}

impl TrackingDwaDriver {
    pub(crate) fn new(robot: Robot, parameters: TrackingParameters) -> Self {
        Self {
            dwa: Dwa::new(robot, parameters.dwa),
            tracks: Tracks::new(parameters),
            memory: Memory::default(),
        }
    }
}

impl Driver for TrackingDwaDriver {
    fn act(&mut self, percept: &Percept) -> usize {
        let points = self.tracks.update(&self.dwa.robot, percept);
        let (still, moving): (Vec<_>, Vec<_>) =
            points.into_iter().partition(|point| point.velocity_m_s == Vec2::ZERO);
        let still = still.iter().map(|point| point.at_m).collect();
        self.memory.add(&self.dwa, &percept.odometry, still);
        let clearance = self.dwa.clearance_from(self.memory.points().chain(moving));
        self.dwa.choose(&percept.twist, percept.goal_m(), self.dwa.robot.goal_radius_m, clearance)
    }
}

#[cfg(test)]
mod tests {
    use glam::vec2;
    use wayfield_scenario::Scenario;

    use super::*;

    const STILL: Motion = Motion { v_m_s: 0.0, w_rad_s: 0.0 };

    /// A robot with these motions (m/s, rad/s) that keeps 0.13 m from obstacles and decides every 0.2 s.
    fn dwa(motions: &[(f32, f32)]) -> Dwa {
        let motions = motions.iter().map(|&(v_m_s, w_rad_s)| Motion { v_m_s, w_rad_s }).collect();
        let robot = Robot { motions, ..Robot::of(&Scenario::default()) };
        Dwa::new(robot, DwaParameters { margin: 0.0, horizon_s: 2.0, ..DwaParameters::default() })
    }

    fn point(x: f32, y: f32, velocity: (f32, f32)) -> MovingPoint {
        MovingPoint { at_m: vec2(x, y), velocity_m_s: velocity.into() }
    }

    fn choose(dwa: &Dwa, aim_m: (f32, f32), points: &[MovingPoint]) -> usize {
        dwa.choose(&STILL, aim_m.into(), 0.2, dwa.clearance_from(points.iter().copied()))
    }

    #[test]
    fn a_motion_is_admissible_only_if_the_robot_can_stop_after_it() {
        // At 0.5 m/s the robot covers 0.2 m in two periods and then stops: a wall 0.13 + 0.25 m ahead allows that, one
        // 0.13 + 0.15 m ahead does not.
        let dwa = dwa(&[(0.0, 0.0), (0.25, 0.0), (0.5, 0.0)]);
        assert_eq!(choose(&dwa, (5.0, 0.0), &[]), 2, "as fast as possible without obstacles");
        let free_s = |distance_m: f32, motion: usize| {
            let motion = dwa.robot.motions[motion];
            let clearance = dwa.clearance_from([point(0.13 + distance_m, 0.0, (0.0, 0.0))].into_iter());
            dwa.simulate(&STILL, &motion, vec2(5.0, 0.0), 0.2, 0.13, &clearance).free_s
        };
        assert!(free_s(0.25, 2) >= dwa.admissible_s && free_s(0.15, 2) < dwa.admissible_s);
        assert!(free_s(0.15, 1) >= dwa.admissible_s, "half as fast, 0.1 m");
        let near = |distance_m: f32| choose(&dwa, (5.0, 0.0), &[point(0.13 + distance_m, 0.0, (0.0, 0.0))]);
        assert_eq!((near(0.25), near(0.15), near(0.05)), (2, 1, 0), "the fastest admissible motion");
    }

    #[test]
    fn a_robot_that_cannot_stop_takes_the_motion_that_is_free_for_the_whole_horizon() {
        let dwa = dwa(&[(0.15, 1.5), (0.15, 0.75), (0.15, 0.0), (0.15, -0.75), (0.15, -1.5)]);
        assert_eq!(choose(&dwa, (2.0, 0.0), &[]), 2);
        // Walls 0.3 m ahead and to the left.
        let walls: Vec<MovingPoint> = (0..14)
            .flat_map(|k| {
                let along = 0.3 - 0.05 * k as f32;
                [point(0.3, along, (0.0, 0.0)), point(along, 0.3, (0.0, 0.0))]
            })
            .collect();
        assert_eq!(choose(&dwa, (2.0, 0.0), &walls), 4, "only the tightest arc to the right is free");
    }

    #[test]
    fn the_velocity_of_an_obstacle_decides_whether_the_path_is_free() {
        let dwa = dwa(&[(0.0, 0.0), (0.5, 0.0)]);
        let crossing = |velocity| choose(&dwa, (5.0, 0.0), &[point(0.5, 0.5, velocity)]);
        assert_eq!(crossing((0.0, 0.0)), 1, "an obstacle that stands still is not in the way");
        assert_eq!(crossing((0.0, -1.0)), 1, "it passes before the robot arrives");
        let coming = point(0.6, 0.0, (-1.0, 0.0));
        assert_eq!(choose(&dwa, (5.0, 0.0), &[coming]), 0, "on a collision course, within two periods");
    }
}
