//! The complete state of one arena, for checkpoints, and the check of a state that was read from a file.

use serde::{Deserialize, Serialize};

use super::{
    ArenaScenario, Clock, Episode, Goal, ObservationLayout, Pedestrians, PendingReset, Pose, Scan, Streams,
    Twist,
};
use crate::policy::observation::ObserverMemory;
use crate::random;
use crate::scenario::Scenario;
use crate::scenario::limits::{
    COORDINATE_M, EPISODE_STEPS, LIDAR_RANGE_M, MAX_ANGULAR_SPEED_RAD_S, MAX_SPEED_M_S,
};

/// The state of an arena that a checkpoint stores, so that a resumed run equals an uninterrupted one bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArenaState {
    /// The robot's pose.
    pub pose: Pose,
    /// The robot's estimate of its pose ([`EstimatedPose`](super::EstimatedPose)). Checkpoints store it separately.
    #[serde(skip)]
    pub estimated_pose: Pose,
    /// The robot's speed and turning rate.
    pub twist: Twist,
    /// The last scan.
    pub scan: Scan,
    /// The last readings of plugins' sensors; empty without such plugins. Checkpoints store them separately.
    #[serde(skip)]
    pub readings: Vec<f32>,
    /// What the robot remembers for an observation by sectors; empty otherwise. Checkpoints store it separately.
    #[serde(skip)]
    pub observer_memory: ObserverMemory,
    /// The current goal.
    pub goal: Goal,
    /// The obstacles' clock.
    pub clock: Clock,
    /// The pedestrians. Checkpoints store them separately.
    #[serde(skip)]
    pub pedestrians: Pedestrians,
    /// The seed of what varies by episode ([`ArenaLayout::layout_seed`](super::ArenaLayout::layout_seed)).
    pub layout_seed: u64,
    /// The scenario drawn from the [`ScenarioPool`](super::ScenarioPool), if there is one. Checkpoints store it separately.
    #[serde(skip)]
    pub scenario: Option<ArenaScenario>,
    /// The current episode.
    pub episode: Episode,
    /// The current states of the random streams.
    pub streams: Streams,
}

/// The largest coordinate of a robot or goal, in m: twice that of any wall.
const MAX_COORDINATE_M: f32 = 2.0 * *COORDINATE_M.end();
/// The largest heading, in rad. The heading of a benchmark route may be a full turn.
const MAX_HEADING_RAD: f32 = 7.0;
/// The largest speeds, in m/s and rad/s: the limits of a scenario, with a margin for rounding.
const MAX_TWIST: (f32, f32) = (MAX_SPEED_M_S + 0.01, MAX_ANGULAR_SPEED_RAD_S + 0.01);
/// The most control steps of an episode that any scenario allows. The app may have changed this scenario's own limit.
const MAX_EPISODE_STEPS: u32 = *EPISODE_STEPS.end();
/// The longest range that any scenario allows, in m. The app may have changed this scenario's own limit.
const MAX_RANGE_M: f32 = *LIDAR_RANGE_M.end();

impl ArenaState {
    /// Checks that an arena of `scenario` can have this state during training.
    ///
    /// # Errors
    /// A noun phrase that names the first invalid part, such as "the robot's pose".
    pub(crate) fn check(&self, scenario: &Scenario, layout: &ObservationLayout) -> Result<(), &'static str> {
        let Self {
            pose,
            estimated_pose,
            twist,
            scan,
            readings,
            observer_memory,
            goal,
            clock,
            pedestrians,
            layout_seed: _,
            scenario: _,
            episode,
            streams,
        } = self;
        let beams = scenario.lidar.beams;
        let [_, latency_steps] = scenario.lidar.latency_steps.ends();
        let within = |value: f32, max: f32| value.abs() <= max;
        let is_pose = |pose: &Pose| {
            within(pose.x_m, MAX_COORDINATE_M)
                && within(pose.y_m, MAX_COORDINATE_M)
                && within(pose.heading_rad, MAX_HEADING_RAD)
        };
        let is_estimate = |pose: &Pose| {
            pose.x_m.is_finite() && pose.y_m.is_finite() && within(pose.heading_rad, MAX_HEADING_RAD)
        };
        let is_range = |range: &f32| (0.0..=MAX_RANGE_M).contains(range);
        let are_ranges = |ranges: &[f32]| ranges.len() == beams && ranges.iter().all(is_range);
        let Episode { steps, goals, rewards, extra_rewards, potential, pending_reset, inactive } = episode;
        let are_finite = |values: &[f32]| values.iter().all(|value| value.is_finite());
        let is_memory = match layout.encoding.sectors() {
            Some(sectors) => observer_memory.fits(sectors),
            None => observer_memory.is_empty(),
        };
        for (what, is_valid) in [
            ("the robot's pose", is_pose(pose)),
            ("the robot's estimated pose", is_estimate(estimated_pose)),
            ("the robot's speed", within(twist.v_m_s, MAX_TWIST.0) && within(twist.w_rad_s, MAX_TWIST.1)),
            (
                "the LIDAR scan",
                are_ranges(&scan.ranges_m) && is_range(&scan.nearest_m) && is_pose(&scan.sensor_pose),
            ),
            ("the number of delayed scans", scan.delayed.len() <= latency_steps as usize + 1),
            ("a delayed scan", scan.delayed.iter().all(|(pose, ranges)| is_pose(pose) && are_ranges(ranges))),
            ("the sensor readings", readings.len() == layout.extra_width() && are_finite(readings)),
            ("the memory of earlier scans", is_memory),
            ("the goal", within(goal.x_m, MAX_COORDINATE_M) && within(goal.y_m, MAX_COORDINATE_M)),
            ("the clock", clock.0 < 1 << 62),
            ("the pedestrians", pedestrians.0.fits(scenario)),
            ("the episode's counters", *steps <= MAX_EPISODE_STEPS && goals <= steps),
            ("the episode's rewards", rewards.total().is_finite() && are_finite(extra_rewards)),
            ("the potential", potential.total().is_finite()),
            ("the pending reset", *pending_reset == PendingReset::None),
            ("the inactive flag", !inactive),
            ("a random stream", random::is_valid(&streams.placement) && random::is_valid(&streams.sensor)),
        ] {
            if !is_valid {
                return Err(what);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::VecDeque;

    use bevy::math::Vec2;

    use super::*;
    use crate::scenario::{Crowd, Obstacle, ObstacleMotion, Shape};

    /// The part that the check must name, and the change that makes it invalid.
    type Corruption = (&'static str, fn(&mut ArenaState));

    fn with_a_pedestrian() -> Scenario {
        let motion = ObstacleMotion::Pedestrian {
            goals_m: vec![Vec2::ONE],
            speed_m_s: 0.1.into(),
            loops: true,
            sees_robot: false,
        };
        let (shape, position_m) = (Shape::Circle { radius_m: 0.1 }, Vec2::ZERO);
        let obstacles = vec![Obstacle { shape, position_m, rotation_rad: 0.0, motion }];
        Scenario { obstacles, ..Scenario::default() }
    }

    #[test]
    fn an_invalid_state_is_rejected_with_the_name_of_the_invalid_part() {
        let mut scenario = Scenario::default();
        scenario.lidar.latency_steps = 1.into();
        let ranges = vec![1.0; scenario.lidar.beams];
        let valid = ArenaState {
            pose: Pose { x_m: 1.0, y_m: -1.0, heading_rad: 3.0 },
            estimated_pose: Pose { x_m: 1.1, y_m: -1.0, heading_rad: 3.0 },
            twist: Twist { v_m_s: 0.15, w_rad_s: -1.5 },
            scan: Scan {
                ranges_m: ranges.clone(),
                sensor_pose: Pose::default(),
                nearest_m: 0.5,
                touching: false,
                delayed: VecDeque::from([(Pose::default(), ranges.clone()), (Pose::default(), ranges)]),
            },
            readings: Vec::new(),
            observer_memory: ObserverMemory::default(),
            goal: Goal { x_m: 0.5, y_m: 0.5 },
            clock: Clock(1_000),
            pedestrians: Pedestrians::default(),
            layout_seed: u64::MAX,
            scenario: None,
            episode: Episode { steps: 7, goals: 1, ..Episode::default() },
            streams: Streams::new(1, 0),
        };
        assert_eq!(valid.check(&scenario, &ObservationLayout::default()), Ok(()));
        let corruptions: &[Corruption] = &[
            ("the robot's pose", |s| s.pose.x_m = f32::NAN),
            ("the robot's pose", |s| s.pose.y_m = 1e9),
            ("the robot's pose", |s| s.pose.heading_rad = f32::INFINITY),
            ("the robot's estimated pose", |s| s.estimated_pose.y_m = f32::NAN),
            ("the robot's speed", |s| s.twist.v_m_s = f32::NAN),
            ("the LIDAR scan", |s| s.scan.ranges_m.truncate(3)),
            ("the LIDAR scan", |s| s.scan.ranges_m[2] = -1.0),
            ("the LIDAR scan", |s| s.scan.nearest_m = f32::NAN),
            ("the number of delayed scans", |s| s.scan.delayed.push_back((Pose::default(), vec![1.0; 24]))),
            ("a delayed scan", |s| s.scan.delayed[1].1.push(1.0)),
            ("the sensor readings", |s| s.readings.push(0.0)),
            ("the goal", |s| s.goal.y_m = f32::NEG_INFINITY),
            ("the clock", |s| s.clock = Clock(u64::MAX)),
            ("the pedestrians", |s| s.pedestrians = Pedestrians(Crowd::at_start(&with_a_pedestrian()))),
            ("the episode's counters", |s| s.episode.steps = u32::MAX),
            ("the episode's counters", |s| s.episode.goals = 8),
            ("the episode's rewards", |s| s.episode.rewards.attraction = f32::NAN),
            ("the potential", |s| s.episode.potential.repulsion = f32::INFINITY),
            ("the pending reset", |s| s.episode.pending_reset = PendingReset::Full),
            ("the inactive flag", |s| s.episode.inactive = true),
            ("a random stream", |s| s.streams.sensor = postcard::from_bytes(&[0]).expect("a state")),
        ];
        for (what, corrupt) in corruptions {
            let mut state = valid.clone();
            corrupt(&mut state);
            assert_eq!(state.check(&scenario, &ObservationLayout::default()), Err(*what));
        }
    }
}
