//! A policy as a driver: converts a percept to the network's inputs and takes the greedy action, or with relative actions the
//! one that the `Decider` chooses. Optionally with a map.

use std::sync::Arc;

use wayfield_policy::observation::{self, SectorObserver, Sensed};
use wayfield_policy::{ActionSet, Decider, Encoding, MotionLimits, Policy, Scratch, greedy};
use wayfield_scenario::{Motion, Scenario};

use crate::actions::{action_motions, motion_limits};
use crate::observer::sector_observer;
use crate::percept::{Odometry, Percept};
use crate::robot::Robot;
use crate::waypoints::{Waypoint, Waypoints};
use crate::{Driver, DriverClass, DriverPlan};

/// A policy that acts on percepts. It must have been trained without sensors from plugins.
#[derive(Clone, Debug)]
pub struct DrivingPolicy {
    /// The policy.
    pub policy: Arc<Policy>,
    /// The encoding of its observations.
    pub encoding: Encoding,
    /// The motions that it chooses among.
    pub actions: ActionSet,
    /// Whether it builds a map as it drives. While the straight line to the goal is not free in the map, it drives to a
    /// point on the cheapest path instead, with the same weights.
    pub has_map: bool,
}

impl DrivingPolicy {
    /// Its class, which states what it may perceive.
    #[must_use]
    pub fn class(&self) -> DriverClass {
        if self.has_map { DriverClass::B } else { DriverClass::A }
    }

    /// A driver of the robot of `scenario` for one episode. The policy must fit the scenario.
    #[must_use]
    pub fn driver(&self, scenario: &Scenario) -> Box<dyn Driver> {
        let driver = PolicyDriver::new(self, scenario);
        if self.has_map {
            let waypoints = Waypoints::new(&Robot::of(scenario));
            return Box::new(MapDriver { driver, waypoints });
        }
        Box::new(driver)
    }
}

/// Converts percepts to observations.
enum Observer {
    /// The paper's observation, which needs no memory.
    Paper,
    /// Observations by sectors.
    Sectors {
        observer: Box<SectorObserver>,
        /// The robot's pose since the episode's start.
        pose: Odometry,
    },
}

/// A policy in one episode: class A. After its first steps, a decision allocates no memory.
struct PolicyDriver {
    policy: Arc<Policy>,
    encoding: Encoding,
    observer: Observer,
    /// The motions of its actions; `None` for those of the robot.
    motions: Option<Vec<Motion>>,
    /// The limits of the robot's motions.
    limits: MotionLimits,
    decider: Decider,
    /// The length of an observation.
    width: usize,
    observation: Vec<f32>,
    /// The Q-values of the last decision.
    q_values: Vec<f32>,
    scratch: Scratch,
}

impl PolicyDriver {
    fn new(of: &DrivingPolicy, scenario: &Scenario) -> Self {
        let DrivingPolicy { policy, encoding, actions, .. } = of;
        let observer = match encoding.sectors() {
            Some(layout) => Observer::Sectors {
                observer: Box::new(sector_observer(layout, scenario)),
                pose: Odometry::default(),
            },
            None => Observer::Paper,
        };
        let motions = (*actions != ActionSet::Robot).then(|| action_motions(actions, &scenario.robot));
        let width = encoding.width(scenario.lidar.beams);
        // A policy that does not fit one of the scenarios of a set drives badly there, but does not fail.
        let observation = vec![0.0; width.max(policy.shape().inputs)];
        Self {
            policy: policy.clone(),
            encoding: *encoding,
            observer,
            motions,
            limits: motion_limits(&scenario.robot),
            decider: Decider::default(),
            width,
            observation,
            q_values: Vec::new(),
            scratch: Scratch::default(),
        }
    }

    /// The action towards a goal at the bearing `goal.0`, in rad, and at the distance `goal.1`, in m.
    fn act_towards(&mut self, percept: &Percept, goal: (f32, f32)) -> usize {
        let row = &mut self.observation[..self.width];
        match &mut self.observer {
            Observer::Paper => {
                observation::encode(self.encoding, percept.ranges_m, goal.0, goal.1, row);
            }
            Observer::Sectors { observer, pose } => {
                *pose = pose.then(&percept.odometry);
                observer.sense(&Sensed {
                    ranges_m: percept.ranges_m,
                    pose: (pose.translation_m.x, pose.translation_m.y, pose.rotation_rad),
                    twist: (percept.twist.v_m_s, percept.twist.w_rad_s),
                });
                observer.encode(goal, row);
            }
        }
        let q_values = self.policy.q_values(&self.observation, &mut self.scratch);
        self.q_values.clear();
        self.q_values.extend_from_slice(q_values);
        let Some(motions) = &self.motions else { return greedy(q_values) };
        self.decider.sense((percept.twist.v_m_s, percept.twist.w_rad_s), &self.limits);
        let moves = self.encoding.shows_motion(&self.observation);
        let motion = |action: usize| (motions[action].v_m_s, motions[action].w_rad_s);
        let steps_to_collision = |first, then| match &self.observer {
            Observer::Sectors { observer, .. } => observer.steps_to_collision(first, then),
            Observer::Paper => f32::INFINITY,
        };
        self.decider.choose(q_values, motion, moves, steps_to_collision)
    }
}

impl Driver for PolicyDriver {
    fn act(&mut self, percept: &Percept) -> usize {
        self.act_towards(percept, (percept.goal_bearing_rad, percept.goal_distance_m))
    }

    fn motions(&self) -> Option<&[Motion]> {
        self.motions.as_deref()
    }

    fn observation(&self) -> Option<&[f32]> {
        Some(&self.observation)
    }

    fn q_values(&self) -> Option<&[f32]> {
        Some(&self.q_values)
    }
}

/// A policy with a map, in one episode: class B.
struct MapDriver {
    driver: PolicyDriver,
    waypoints: Waypoints,
}

impl Driver for MapDriver {
    fn act(&mut self, percept: &Percept) -> usize {
        match self.waypoints.update(percept) {
            Some(Waypoint { at_m, path_length_m }) => {
                let bearing_rad = libm::atan2f(at_m.y, at_m.x);
                let distance_m = match self.driver.observer {
                    // A path may be longer than any distance in training, so the policy gets the distance to the waypoint.
                    Observer::Paper => at_m.length(),
                    Observer::Sectors { .. } => path_length_m,
                };
                self.driver.act_towards(percept, (bearing_rad, distance_m))
            }
            None => self.driver.act(percept),
        }
    }

    fn motions(&self) -> Option<&[Motion]> {
        self.driver.motions()
    }

    fn observation(&self) -> Option<&[f32]> {
        self.driver.observation()
    }

    fn q_values(&self) -> Option<&[f32]> {
        self.driver.q_values()
    }

    fn plan(&self, pose: (f32, f32, f32)) -> Option<DriverPlan> {
        Some(self.waypoints.plan(pose))
    }
}
