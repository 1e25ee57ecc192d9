//! A policy as a driver: from a percept to the network's inputs, and to its greedy action; and the same policy with a map.

use std::sync::Arc;

use wayfield_policy::{Encoding, Policy, Scratch, observation};

use crate::percept::Percept;
use crate::robot::Robot;
use crate::waypoints::Waypoints;
use crate::{Driver, DriverPlan};

/// A policy in one episode: class A. A decision allocates no memory.
pub struct PolicyDriver {
    policy: Arc<Policy>,
    encoding: Encoding,
    observation: Vec<f32>,
    scratch: Scratch,
}

impl PolicyDriver {
    /// A driver of `robot` by `policy`, whose observations have the encoding `encoding`. The policy must have been trained with
    /// as many beams and motions, and without sensors of plugins.
    #[must_use]
    pub fn new(policy: Arc<Policy>, encoding: Encoding, robot: &Robot) -> Self {
        let width = observation::width(robot.beams.len()).max(policy.shape().inputs);
        Self { policy, encoding, observation: vec![0.0; width], scratch: Scratch::default() }
    }
}

impl Driver for PolicyDriver {
    fn act(&mut self, percept: &Percept) -> usize {
        let Percept { ranges_m, goal_bearing_rad, goal_distance_m, .. } = *percept;
        observation::encode(
            self.encoding,
            ranges_m,
            goal_bearing_rad,
            goal_distance_m,
            &mut self.observation,
        );
        self.policy.act(&self.observation, &mut self.scratch)
    }
}

/// A policy that also builds a map as it drives: class B. While the straight way to the goal is not free in the map, the policy
/// drives to a point of the shortest path instead, with the same weights.
#[derive(Clone, Debug)]
pub struct PolicyWithMap {
    /// The policy.
    pub policy: Arc<Policy>,
    /// The encoding of its observations.
    pub encoding: Encoding,
}

impl PolicyWithMap {
    /// A driver of `robot` for one episode. The policy must fit, as for [`PolicyDriver::new`].
    #[must_use]
    pub fn driver(&self, robot: &Robot) -> Box<dyn Driver> {
        let inner = PolicyDriver::new(self.policy.clone(), self.encoding, robot);
        Box::new(MapDriver { inner, waypoints: Waypoints::new(robot) })
    }
}

/// A policy with a map, in one episode.
struct MapDriver {
    inner: PolicyDriver,
    waypoints: Waypoints,
}

impl Driver for MapDriver {
    fn act(&mut self, percept: &Percept) -> usize {
        let Some(waypoint_m) = self.waypoints.update(percept) else { return self.inner.act(percept) };
        let goal_bearing_rad = libm::atan2f(waypoint_m.y, waypoint_m.x);
        let goal_distance_m = waypoint_m.length();
        self.inner.act(&Percept { goal_bearing_rad, goal_distance_m, ..*percept })
    }

    fn plan(&self, pose: (f32, f32, f32)) -> Option<DriverPlan> {
        Some(self.waypoints.plan(pose))
    }
}
