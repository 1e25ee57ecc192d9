//! The types of a scenario file, with the paper's numbers as defaults.
//!
//! In: RON text, through [`Scenario::load`](super::Scenario::load). Out: plain numbers for the task and the simulation.
//! [`diagnostics`](super::diagnostics) checks them.
//!
//! Lengths are in metres, times in seconds, angles in radians (counterclockwise positive, 0 along +x). The origin is the
//! centre of a rectangular enclosure.

use std::f32::consts::TAU;

use glam::{Vec2, vec2};
use serde::{Deserialize, Serialize};

use super::ranged::Ranged;
use super::wall_cells::CellBlocks;

/// A scenario: enclosure, walls, obstacles, robot, LIDAR, and the rules of the task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Name, 1 to 100 characters on one line. The only required field.
    pub name: String,
    /// Purpose of the scenario, at most 2,000 characters.
    #[serde(default)]
    pub about: String,
    /// The outer walls. Contact with them is a collision.
    #[serde(default)]
    pub enclosure: Enclosure,
    /// Inner walls, at most 1,000.
    #[serde(default)]
    pub walls: Vec<Wall>,
    /// Static and moving obstacles, at most 10,000.
    #[serde(default)]
    pub obstacles: Vec<Obstacle>,
    /// Generators of random obstacles, which change with every episode; at most 16.
    #[serde(default)]
    pub generators: Vec<Generator>,
    /// The robot: its size and its motions.
    #[serde(default)]
    pub robot: Robot,
    /// The robot's LIDAR.
    #[serde(default)]
    pub lidar: Lidar,
    /// Goal radius, collision range, time limit and control period.
    #[serde(default)]
    pub task: TaskRules,
    /// Where episodes start.
    #[serde(default)]
    pub starts: PlacementRule,
    /// Where goals are placed.
    #[serde(default)]
    pub goals: PlacementRule,
    /// The benchmark route, on which `--course` measures the time (the paper's tables 3, 4, 6 and 7).
    #[serde(default)]
    pub benchmark_route: Option<BenchmarkRoute>,
}

impl Default for Scenario {
    /// The paper's enclosure without obstacles.
    fn default() -> Self {
        Self {
            name: "Empty".into(),
            about: String::new(),
            enclosure: Enclosure::default(),
            walls: Vec::new(),
            obstacles: Vec::new(),
            generators: Vec::new(),
            robot: Robot::default(),
            lidar: Lidar::default(),
            task: TaskRules::default(),
            starts: PlacementRule::default(),
            goals: PlacementRule::default(),
            benchmark_route: None,
        }
    }
}

/// The outer walls.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Enclosure {
    /// A rectangle centred on (0, 0) with sides along x and y, each 0.5 to 1,000 m long.
    Rectangle {
        /// Inner extent along x.
        width_m: f32,
        /// Inner extent along y.
        height_m: f32,
    },
    /// Any polygon whose sides don't cross, such as an L. Its extent along x and along y is 0.5 to 1,000 m.
    Polygon {
        /// The 3 to 64 corners in order, clockwise or counterclockwise. The last is connected to the first.
        corners_m: Vec<Vec2>,
    },
}

impl Default for Enclosure {
    /// The paper's square of 4 m x 4 m.
    fn default() -> Self {
        Self::Rectangle { width_m: 4.0, height_m: 4.0 }
    }
}

/// An inner wall: straight segments from corner to corner, or solid cells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// The 2 to 256 corners of its centre line. Each segment extends half the thickness beyond its ends, which closes the
    /// corners. Omit them for a wall of `cells`.
    #[serde(default)]
    pub corners_m: Vec<Vec2>,
    /// Thickness of the segments, 0.01 to 100 m.
    #[serde(default = "default_thickness_m")]
    pub thickness_m: f32,
    /// Solid cells of a grid, instead of segments.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cells: Option<WallCells>,
}

impl Default for Wall {
    fn default() -> Self {
        Self { corners_m: Vec::new(), thickness_m: default_thickness_m(), cells: None }
    }
}

fn default_thickness_m() -> f32 {
    0.1
}

/// The solid cells of a grid that is written as text: a map in one wall. Adjacent cells are merged into rectangles, which
/// count as segments.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WallCells {
    /// The rows of cells from top to bottom, all of the same length: `#` is a solid cell, `.` or a space a free one. 1 to
    /// 250,000 cells, of which at least one is solid.
    pub(super) rows: Vec<String>,
    /// Side of a cell, 0.01 to 100 m.
    pub(super) cell_m: f32,
    /// Centre of the grid.
    #[serde(default)]
    pub(super) centre_m: Vec2,
    #[serde(skip)]
    pub(super) blocks: CellBlocks,
}

/// An obstacle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// Shape.
    pub shape: Shape,
    /// Position of its origin at step 0.
    pub position_m: Vec2,
    /// Rotation at step 0, -6.3 to 6.3 (a full turn either way).
    #[serde(default)]
    pub rotation_rad: f32,
    /// Motion.
    #[serde(default)]
    pub motion: ObstacleMotion,
}

/// The shape of an obstacle or of a robot, in its own frame. Sizes are 0.001 to 1,000 m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Shape {
    /// A circle; the paper's cylinders have a radius of 0.15 m.
    Circle {
        /// Radius.
        radius_m: f32,
    },
    /// A rectangle.
    Rectangle {
        /// Extent along its own x axis.
        width_m: f32,
        /// Extent along its own y axis.
        height_m: f32,
    },
    /// A convex polygon. Build a concave shape from several obstacles.
    Polygon {
        /// The 3 to 32 corners in order, clockwise or counterclockwise, in its own frame; an obstacle's `position_m` is the
        /// position of its (0, 0).
        corners_m: Vec<Vec2>,
    },
    /// A capsule: a rectangle with semicircular ends.
    Capsule {
        /// Distance between the centres of the two ends, along its own x axis.
        length_m: f32,
        /// Radius of the ends, which is half the width.
        radius_m: f32,
    },
}

/// The motion of an obstacle: a function of the step count alone, except for pedestrians.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ObstacleMotion {
    /// No motion.
    #[default]
    Static,
    /// A revolution about a point. The obstacle rotates with it, as if fixed to a turntable.
    Orbit {
        /// Centre of the revolution.
        centre_m: Vec2,
        /// Angular speed, counterclockwise positive, -20 to 20 rad/s. The obstacle's origin may move at up to 5 m/s.
        speed_rad_s: Ranged<f32>,
    },
    /// A closed loop along straight lines from its position through all waypoints and back, without rotation. The position
    /// is the first corner of the loop; don't repeat it as a waypoint.
    Patrol {
        /// The other corners of the path, 1 to 256.
        waypoints_m: Vec<Vec2>,
        /// Speed along the path, 0 to 5 m/s.
        speed_m_s: Ranged<f32>,
    },
    /// A path along straight lines from its position through all waypoints to the last, and the same path back, without
    /// rotation.
    BackAndForth {
        /// The other corners of the path, 1 to 256.
        waypoints_m: Vec<Vec2>,
        /// Speed along the path, 0 to 5 m/s.
        speed_m_s: Ranged<f32>,
    },
    /// A walk along straight lines between random points near its position, without rotation. All legs take the same time,
    /// that of the longest possible leg, so most are slower than `speed_m_s`.
    RandomWalk {
        /// Largest distance of the points from its position, 0.01 to 500 m.
        radius_m: f32,
        /// Highest speed, 0 to 5 m/s.
        speed_m_s: Ranged<f32>,
        /// Seed of the walk. The same seed gives the same walk in every run.
        #[serde(default)]
        seed: u32,
    },
    /// A pedestrian that walks to goals one after another and avoids the other pedestrians, walls and static obstacles by
    /// ORCA (van den Berg et al. 2011), without rotation. It ignores all other moving obstacles, and does not find its way
    /// around walls. At the start of every episode it stands at its position. At most 200 obstacles may be pedestrians.
    Pedestrian {
        /// The goals, 1 to 256.
        goals_m: Vec<Vec2>,
        /// Highest speed, 0 to 5 m/s.
        speed_m_s: Ranged<f32>,
        /// Whether it returns from the last goal to its position and begins again. Otherwise it stops at the last goal.
        #[serde(default = "default_loops")]
        loops: bool,
        /// Whether it also avoids the robot, as a disc that contains the robot's collision range and shape. It leaves half of
        /// the avoidance to the robot.
        #[serde(default)]
        sees_robot: bool,
    },
    /// Recorded positions, each with its time, and straight lines between them, without rotation. At time 0 the obstacle is at
    /// its position; don't repeat that as a frame. The clock of an arena's obstacles runs on from episode to episode of a
    /// training run, and episodes of an evaluation begin at a random time: a motion that stops is mostly seen at rest.
    KeyFrames {
        /// The 1 to 10,000 frames, in the order of their times; at most 10,000 for all obstacles together.
        frames: Vec<KeyFrame>,
        /// What happens after the last frame.
        #[serde(default)]
        end: KeyFrameEnd,
    },
}

/// A position at a time. The obstacle moves there from the previous position at constant speed, at most 5 m/s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KeyFrame {
    /// Time, 0.001 to 100,000 s, later than that of the previous frame.
    pub time_s: f32,
    /// Position of the obstacle's origin.
    pub position_m: Vec2,
}

/// What an obstacle does after its last key frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum KeyFrameEnd {
    /// It stays at the last frame.
    #[default]
    Stop,
    /// It returns to its position on a straight line, and starts again.
    Loop {
        /// Time at which it is back at its position, later than that of the last frame, up to 100,000 s.
        period_s: f32,
    },
}

fn default_loops() -> bool {
    true
}

/// A generator of random static obstacles. Every episode of every arena draws new ones, so that a policy learns to cope with
/// unseen layouts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Generator {
    /// Number of obstacles, 1 to 200, and at most 200 for all generators together. Fewer are placed if space runs out.
    pub count: u32,
    /// Shape.
    pub shape: RandomShape,
    /// Smallest gap between the obstacle's bounding circle and walls, other obstacles (moving ones at step 0), the ends of
    /// the benchmark route, and positions named by the rules for starts and goals. Must be more than twice the collision
    /// range and twice the reach of the robot's `shape`, so that the robot fits through.
    #[serde(default = "default_gap_m")]
    pub gap_m: f32,
    /// Region for their positions; the whole enclosure if omitted.
    #[serde(default)]
    pub within: Option<Region>,
}

fn default_gap_m() -> f32 {
    0.4
}

/// A shape with random sizes, uniform over ranges that are written `(lowest, highest)`. Sizes are 0.001 to 1,000 m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum RandomShape {
    /// A circle.
    Circle {
        /// Radius.
        radius_m: (f32, f32),
    },
    /// A rectangle with a random rotation.
    Rectangle {
        /// Extent along its own x axis.
        width_m: (f32, f32),
        /// Extent along its own y axis.
        height_m: (f32, f32),
    },
}

/// A rectangle with sides along x and y.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Lower left corner.
    pub min_m: Vec2,
    /// Upper right corner.
    pub max_m: Vec2,
}

/// The robot: a body with a differential drive. Its origin is the midpoint between its wheels, about which it turns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Robot {
    /// Radius of a robot that is a disc, 0.01 to 10 m. Omit it for a robot with a `shape`.
    pub radius_m: f32,
    /// Shape of a robot that is not a disc, in its own frame: x points ahead, y to the left. `Rectangle`, `Polygon` or
    /// `Capsule`. The origin must be at least 0.01 m inside, and no point farther than 10 m from it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shape: Option<Shape>,
    /// Minimum turning radius of a robot that steers like a car, 0.001 to 100 m: for each motion, |v / w| must be at least
    /// this. Without it, the robot can also turn on the spot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min_turning_radius_m: Option<f32>,
    /// The 1 to 64 motions; action k of the policy selects motion k.
    pub motions: Vec<Motion>,
    /// Time constant of the drive, 0 to 10 s. The actual (v, w) follows the commanded motion with a first-order lag,
    /// d(v, w)/dt = (commanded - actual) / lag. With 0 it follows immediately.
    pub actuator_lag_s: Ranged<f32>,
    /// Highest acceleration of v, forwards, backwards and in braking, 0.01 to 1,000 m/s^2; unlimited if omitted. With a lag, it
    /// limits the rate at which v follows the command.
    pub max_acceleration_m_s2: Option<f32>,
    /// Highest angular acceleration, of w, 0.01 to 10,000 rad/s^2; unlimited if omitted.
    pub max_angular_acceleration_rad_s2: Option<f32>,
    /// Slip of the wheels: the robot moves less than they do.
    pub slip: Option<Slip>,
    /// The robot knows its pose by odometry alone, which drifts. If omitted, it knows its pose exactly.
    pub odometry_drift: Option<OdometryDrift>,
}

impl Default for Robot {
    /// The paper's five motions in the order of its equation (9) (large left, small left, forward, small right,
    /// large right) with v0 = 0.15 m/s and w0 = 0.75 rad/s from table 1. The paper does not specify the radius (here 0.1 m), the
    /// lag (here none) or the highest accelerations (here unlimited).
    fn default() -> Self {
        let motions = [1.5, 0.75, 0.0, -0.75, -1.5].map(|w_rad_s| Motion { v_m_s: 0.15, w_rad_s });
        Self {
            radius_m: 0.1,
            shape: None,
            min_turning_radius_m: None,
            motions: motions.into(),
            actuator_lag_s: Ranged::Number(0.0),
            max_acceleration_m_s2: None,
            max_angular_acceleration_rad_s2: None,
            slip: None,
            odometry_drift: None,
        }
    }
}

/// Slip of the wheels. In each control step, the robot moves with (1 - s) v and (1 - s') w, where (v, w) is the motion of its
/// wheels, s = `forward` + n, s' = `turning` + n', and n and n' are normally distributed with the standard deviation `std`.
/// Each factor is kept between 0 and 1: slip never makes the robot faster than its wheels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slip {
    /// The fraction of v that is lost, 0 to 0.9.
    pub forward: Ranged<f32>,
    /// The fraction of w that is lost, 0 to 0.9.
    pub turning: Ranged<f32>,
    /// Standard deviation of both fractions from step to step, 0 to 0.5.
    pub std: Ranged<f32>,
}

impl Default for Slip {
    /// No slip.
    fn default() -> Self {
        let none = Ranged::Number(0.0);
        Self { forward: none, turning: none, std: none }
    }
}

/// Odometry that drifts. The policy observes the direction and the distance of the goal from the pose that odometry reports.
/// This pose is exact when an episode begins or the robot is put somewhere else. From then on, the robot adds up the motion of
/// its wheels with the errors below, and does not notice slip. A new goal in the same episode corrects nothing. Rewards,
/// collisions and reached goals are decided by the true pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OdometryDrift {
    /// Error of distances per metre, -0.5 to 0.5: 0.02 if odometry reports 1.02 m for each metre that the wheels roll.
    pub distance_error: Ranged<f32>,
    /// Error of rotations per radian, -0.5 to 0.5.
    pub rotation_error: Ranged<f32>,
    /// Rotation that is reported per metre although the robot does not turn, counterclockwise positive, -1 to 1 rad/m.
    pub heading_drift_rad_m: Ranged<f32>,
}

/// A motion of the robot, commanded for one control period.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// Linear speed along the heading, -5 to 5 m/s.
    pub v_m_s: f32,
    /// Angular speed, positive to the left, -20 to 20 rad/s.
    pub w_rad_s: f32,
}

/// The LIDAR at the robot's origin, with beams at equal angles over its field of view.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Lidar {
    /// Number of beams, 1 to 4,096. If the field of view is a full circle, beam 0 points along the heading and the others
    /// follow counterclockwise.
    pub beams: usize,
    /// Field of view, 0.01 to 6.2832; from 6.2732 on it is a full circle. A narrower field is centred on the heading: the
    /// first beam is its right edge, the last its left edge. A single beam points ahead.
    pub field_of_view_rad: f32,
    /// Maximum range, 0.01 to 1,000 m. A beam that hits nothing within it reports this range.
    pub max_range_m: f32,
    /// Standard deviation of the Gaussian noise of each range, 0 to 10 m.
    pub noise_std_m: Ranged<f32>,
    /// Probability that a beam drops out and reports the maximum range, 0 to 1.
    pub dropout: Ranged<f32>,
    /// Delay of the scans that the policy observes, in control steps, 0 to 50. Collisions and rewards use the current
    /// distances.
    pub latency_steps: Ranged<u32>,
}

impl Default for Lidar {
    /// 24 beams (equation (8)) without noise. The range of 3.5 m is that of the TurtleBot3, the robot of the paper's setting.
    fn default() -> Self {
        Self {
            beams: 24,
            field_of_view_rad: TAU,
            max_range_m: 3.5,
            noise_std_m: Ranged::Number(0.0),
            dropout: Ranged::Number(0.0),
            latency_steps: Ranged::Number(0),
        }
    }
}

impl Lidar {
    /// Whether it measures exactly: no noise and no dropout.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.noise_std_m.value() <= 0.0 && self.dropout.value() <= 0.0
    }

    /// Whether its field of view is a full circle.
    #[must_use]
    pub fn is_all_around(&self) -> bool {
        self.field_of_view_rad >= TAU - 0.01
    }
}

/// The rules of the task: reaching a goal, collisions, and time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TaskRules {
    /// The paper's l_a, 0.001 to 100 m: a goal is reached when the robot's centre is closer than this.
    pub goal_radius_m: f32,
    /// The paper's l_c, 0.01 to 100 m: the robot collides if a beam range, measured from its centre, is below this, or if its
    /// body touches something. Must be less than the LIDAR's maximum range and more than the radius of a robot that is a disc.
    /// With a `shape`, it may be smaller than the body: where the body reaches farther, contact alone counts.
    pub collision_range_m: f32,
    /// Steps after which an episode is truncated, 1 to 1,000,000.
    pub max_episode_steps: u32,
    /// Simulated time per control step, 0.001 to 10 s.
    pub control_period_s: f32,
    /// Smallest distance of a new goal from the robot, at most 1,000 m. Must be more than the goal radius.
    pub min_goal_distance_m: f32,
}

impl Default for TaskRules {
    /// l_a = 0.2 m and the control period of 0.2 s are the paper's. The paper does not specify l_c or the smallest goal
    /// distance, and its time limit of 6000 steps does not fit its returns (detail 15 of docs/algorithm.md); the values here are
    /// this project's.
    fn default() -> Self {
        Self {
            goal_radius_m: 0.2,
            collision_range_m: 0.13,
            max_episode_steps: 500,
            control_period_s: 0.2,
            min_goal_distance_m: 0.5,
        }
    }
}

/// A rule for the positions of starts or goals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum PlacementRule {
    /// A random position, uniform over the space that is clear of walls and of obstacles at that moment.
    Random {
        /// Smallest distance to any surface, 0 to 1,000 m. Must be more than the collision range and the reach of the robot's
        /// `shape`.
        #[serde(default = "default_clearance_m")]
        clearance_m: f32,
    },
    /// Like `Random`, but inside a rectangle.
    Within {
        /// Lower left corner of the rectangle.
        min_m: Vec2,
        /// Upper right corner.
        max_m: Vec2,
        /// Smallest distance to any surface, 0 to 1,000 m. Must be more than the collision range and the reach of the robot's
        /// `shape`.
        #[serde(default = "default_clearance_m")]
        clearance_m: f32,
    },
    /// A fixed position.
    Fixed {
        /// The position.
        position_m: Vec2,
        /// Heading of the robot at its start, -6.3 to 6.3; random if omitted. Not allowed for goals.
        #[serde(default)]
        heading_rad: Option<f32>,
    },
    /// One of several positions with equal probability. The heading is random.
    OneOf {
        /// The positions, 1 to 256.
        positions_m: Vec<Vec2>,
    },
}

impl Default for PlacementRule {
    /// A random position with a clearance of 0.35 m.
    fn default() -> Self {
        Self::Random { clearance_m: default_clearance_m() }
    }
}

fn default_clearance_m() -> f32 {
    0.35
}

/// The benchmark route: an episode from a fixed start to a fixed goal.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BenchmarkRoute {
    /// Start of the robot.
    pub start_m: Vec2,
    /// Heading at the start, -6.3 to 6.3 (a full turn either way).
    pub heading_rad: f32,
    /// Goal.
    pub goal_m: Vec2,
}

impl Default for BenchmarkRoute {
    /// The paper's route from (0, 0) to (1.2, 1.2). The heading along +x is this project's choice.
    fn default() -> Self {
        Self { start_m: vec2(0.0, 0.0), heading_rad: 0.0, goal_m: vec2(1.2, 1.2) }
    }
}
