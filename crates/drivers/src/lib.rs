//! Drivers behind one interface: trained policies, with or without a map, and classical drivers as baselines for them.
//!
//! In: a [`Percept`] per control step. Out: an action, an index into the robot's motions or the driver's own. A driver knows its
//! [`Robot`] and what it has perceived since its episode began, nothing else, so that its results can be compared with a
//! policy's. Its [`DriverClass`] states what it may perceive.
//!
//! ```
//! use wayfield_drivers::{Driver, DriverConfig, Odometry, Percept, Robot};
//! use wayfield_scenario::{Motion, Scenario};
//!
//! // The paper's robot, with nothing in sight and its goal to the left: it turns left as fast as it can.
//! let scenario = Scenario::default();
//! let mut driver = DriverConfig::shipped("field").ok_or("no such driver")?.driver(&Robot::of(&scenario));
//! let percept = Percept {
//!     ranges_m: &[3.5; 24],
//!     goal_distance_m: 2.0,
//!     goal_bearing_rad: 1.5,
//!     twist: Motion { v_m_s: 0.0, w_rad_s: 0.0 },
//!     odometry: Odometry::default(),
//!     truth: None,
//! };
//! assert_eq!(driver.act(&percept), 0);
//! # Ok::<(), &str>(())
//! ```
//!
//! | module | purpose |
//! |---|---|
//! | `actions` | the motions that the actions of a policy stand for |
//! | `config` | the parameters of each driver, as RON |
//! | `percept` | what a driver perceives |
//! | `observer` | the sector observer of a scenario's robot, for policies |
//! | `robot` | what a driver knows about its robot; arcs, and the motion that is closest to a wanted velocity |
//! | `field` | potential field (Khatib 1986) |
//! | `dwa` | dynamic window approach (Fox, Burgard and Thrun 1997) |
//! | `tracks` | velocities of moving obstacles, estimated from scans |
//! | `free_space` | the space that earlier scans found free |
//! | `grid`, `path_search` | grids of cells, and A* over them (Hart, Nilsson and Raphael 1968) |
//! | `rolling_map` | a map that is built from scans |
//! | `true_map` | a map of the true scenario |
//! | `path` | following a path: the point to pursue (Coulter 1992) |
//! | `planned` | the drivers with a map: A* with DWA or pure pursuit |
//! | `policy_driver` | a policy as a driver, with or without a map that it builds |
//! | `waypoints` | the point to drive to, in place of a goal that is out of sight in the map |
//! | `orca` | steering towards the velocities of [`wayfield_orca`] (van den Berg et al. 2011) |

mod actions;
mod config;
mod dwa;
mod field;
mod free_space;
mod grid;
mod observer;
mod orca;
mod path;
mod path_search;
mod percept;
mod planned;
mod policy_driver;
mod robot;
mod rolling_map;
mod tracks;
mod true_map;
mod waypoints;

use glam::Vec2;
use wayfield_scenario::Motion;

pub use actions::{action_motion, action_motions, motion_limits, relative_motion};
pub use config::{
    AstarParameters, DriverClass, DriverConfig, DwaParameters, FieldParameters, OrcaParameters,
    PlannerParameters, TrackingParameters,
};
pub use observer::sector_observer;
pub use percept::{Odometry, Percept, Truth};
pub use policy_driver::DrivingPolicy;
pub use robot::Robot;

/// A driver in one episode. A new episode gets a [new driver](DriverConfig::driver).
pub trait Driver: Send + Sync {
    /// The action for the next control step: an index into its own [motions](Driver::motions) or, if it has none, the robot's.
    ///
    /// It depends on the percepts of the episode alone: not on time, threads or chance.
    fn act(&mut self, percept: &Percept) -> usize;

    /// Its own motions, if its actions are indices into these; `None` if they are indices into the robot's motions.
    fn motions(&self) -> Option<&[Motion]> {
        None
    }

    /// The inputs of its network at the last decision, zeros before the first; `None` if it has no network.
    fn observation(&self) -> Option<&[f32]> {
        None
    }

    /// The Q-values of its last decision, one per action; empty before the first; `None` if it has no network.
    fn q_values(&self) -> Option<&[f32]> {
        None
    }

    /// The path that it has planned, and the map that it has built; `None` if it plans no path.
    ///
    /// `pose` is the robot's pose at the last decision, in the frame of the result (x in m, y in m, heading in rad).
    fn plan(&self, pose: (f32, f32, f32)) -> Option<DriverPlan> {
        let _ = pose;
        None
    }
}

/// The path that a driver has planned, and the map that it has built, to be displayed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DriverPlan {
    /// The path to the goal, in m; empty if there is none.
    pub path_m: Vec<Vec2>,
    /// The centres of the occupied cells of the map that it builds, in m; empty if it builds none.
    pub occupied_m: Vec<Vec2>,
    /// Side of a cell, in m.
    pub cell_m: f32,
    /// Rotation of the cells, counterclockwise, in rad.
    pub rotation_rad: f32,
}

impl DriverPlan {
    /// Transforms a `path` and the `occupied` cells from the frame of a map, where the robot has the pose `in_map`, to the frame
    /// where it has the pose of the first argument (x in m, y in m, heading in rad). All lengths are in m.
    fn seen_from(
        (x_m, y_m, heading_rad): (f32, f32, f32),
        in_map: &Odometry,
        path: &[Vec2],
        (occupied, cell_m): (Vec<Vec2>, f32),
    ) -> Self {
        let robot = Odometry { translation_m: Vec2::new(x_m, y_m), rotation_rad: heading_rad };
        let moved = |points: &[Vec2]| points.iter().map(|at| robot.to_outer(in_map.to_inner(*at))).collect();
        Self {
            path_m: moved(path),
            occupied_m: moved(&occupied),
            cell_m,
            rotation_rad: heading_rad - in_map.rotation_rad,
        }
    }
}
