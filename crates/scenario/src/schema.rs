//! What a world is: the types that a scenario file spells, with the paper's numbers as their defaults.
//!
//! In: RON text, through [`Scenario::load`](super::Scenario::load). Out: plain numbers that the task and the
//! world read. Nothing here is checked yet; [`diagnostics`](super::findings) does that.
//!
//! Lengths are metres, times seconds, angles radians (counterclockwise positive, 0 along +x). The origin is
//! the middle of the enclosure.

use std::f32::consts::TAU;

use glam::{Vec2, vec2};
use serde::{Deserialize, Serialize};

/// One world: enclosure, walls, obstacles, robot, LIDAR, and the rules of the task in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// What to call it, 1 to 100 characters. The only field a file must have.
    pub name: String,
    /// What it is for or what it teaches, at most 2,000 characters.
    #[serde(default)]
    pub about: String,
    /// The walls around it; hitting them is hitting an obstacle.
    #[serde(default)]
    pub enclosure: Enclosure,
    /// Inner walls, at most 1,000.
    #[serde(default)]
    pub walls: Vec<Wall>,
    /// What stands or moves inside, at most 10,000.
    #[serde(default)]
    pub obstacles: Vec<Obstacle>,
    /// Obstacles that are drawn anew for every episode, at most 16 kinds of them.
    #[serde(default)]
    pub generators: Vec<Generator>,
    /// The robot's body and its motions.
    #[serde(default)]
    pub robot: Robot,
    /// The robot's range finder.
    #[serde(default)]
    pub lidar: Lidar,
    /// When an episode ends, and how long a step lasts.
    #[serde(default)]
    pub task: TaskRules,
    /// Where the robot starts.
    #[serde(default)]
    pub starts: PlacementRule,
    /// Where goals are put.
    #[serde(default)]
    pub goals: PlacementRule,
    /// The benchmark route of the paper's tables 3, 4, 6 and 7.
    #[serde(default)]
    pub benchmark_route: BenchmarkRoute,
}

impl Default for Scenario {
    /// The paper's enclosure with nothing in it.
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
            benchmark_route: BenchmarkRoute::default(),
        }
    }
}

/// The walls around the world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Enclosure {
    /// A rectangle, centred on (0, 0), its sides along x and y; each side 0.5 to 1,000 m.
    Rectangle {
        /// Inner extent along x.
        width_m: f32,
        /// Inner extent along y.
        height_m: f32,
    },
    /// Any outline whose sides don't cross, such as an L. Its extent along x and along y is 0.5 to 1,000 m.
    Polygon {
        /// Its corners in order, either way round, 3 to 64; the last is joined to the first.
        corners_m: Vec<Vec2>,
    },
}

impl Default for Enclosure {
    /// The paper's square of 4 m x 4 m.
    fn default() -> Self {
        Self::Rectangle { width_m: 4.0, height_m: 4.0 }
    }
}

/// An inner wall: straight pieces from corner to corner.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Where it goes, 2 to 256 corners. Each piece reaches half the thickness past its ends, so that corners are closed.
    pub corners_m: Vec<Vec2>,
    /// How thick it is, 0.01 to 100 m.
    #[serde(default = "default_thickness_m")]
    pub thickness_m: f32,
}

fn default_thickness_m() -> f32 {
    0.1
}

/// One thing to keep clear of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// Its outline.
    pub shape: Shape,
    /// Where its middle is at step 0.
    pub position_m: Vec2,
    /// How it is turned at step 0, -6.3 to 6.3 (a full turn either way).
    #[serde(default)]
    pub rotation_rad: f32,
    /// How it moves.
    #[serde(default)]
    pub motion: ObstacleMotion,
}

/// The outline of an obstacle, about its middle. Sizes are 0.001 to 1,000 m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Shape {
    /// A cylinder seen from above; the paper's have radius 0.15 m.
    Circle {
        /// From the middle to the rim.
        radius_m: f32,
    },
    /// A box seen from above.
    Rectangle {
        /// Whole extent along its own x axis.
        width_m: f32,
        /// Whole extent along its own y axis.
        height_m: f32,
    },
    /// Straight sides, without a corner that points inwards. (What has one is put together of several.)
    Polygon {
        /// Its corners in order, either way round, 3 to 32, in its own frame: (0, 0) is what `position_m` places.
        corners_m: Vec<Vec2>,
    },
    /// A rod with round ends.
    Capsule {
        /// From the middle of one round end to that of the other, along its own x axis.
        length_m: f32,
        /// Half its width, and the radius of its ends.
        radius_m: f32,
    },
}

/// How an obstacle moves: always a function of the step count alone.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ObstacleMotion {
    /// It stands still.
    #[default]
    Static,
    /// Around a point at a constant distance, turning with the revolution as if fixed to a turntable.
    Orbit {
        /// The point it revolves about.
        centre_m: Vec2,
        /// How fast, counterclockwise positive; the obstacle's middle may move at 5 m/s at most.
        speed_rad_s: f32,
    },
    /// Along straight lines from its position through each waypoint in order and back to its position,
    /// forever, without turning. (The position is the first corner of the loop: don't repeat it.)
    Patrol {
        /// The further corners, 1 to 256.
        waypoints_m: Vec<Vec2>,
        /// Along the path, 0 to 5 m/s.
        speed_m_s: f32,
    },
    /// Along straight lines from its position through each waypoint in order to the last, and the same way back,
    /// forever, without turning.
    BackAndForth {
        /// The further corners, 1 to 256.
        waypoints_m: Vec<Vec2>,
        /// Along the path, 0 to 5 m/s.
        speed_m_s: f32,
    },
    /// From one random point near its position straight to the next, forever, without turning. Each leg takes as long as
    /// the longest there could be, so most are slower than the speed that is given.
    RandomWalk {
        /// How far from its position the points are at most, 0.01 to 500 m.
        radius_m: f32,
        /// The fastest it ever is, 0 to 5 m/s.
        speed_m_s: f32,
        /// Which walk: the same number is the same one in every run.
        #[serde(default)]
        seed: u32,
    },
}

/// Obstacles that are drawn anew for every episode, in each arena for itself: for policies that must cope with worlds
/// they have not seen. They stand still.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Generator {
    /// How many, 1 to 200 (and no more than 200 by all generators together); fewer where there is no room.
    pub count: u32,
    /// Their outline.
    pub shape: RandomShape,
    /// The least gap from each one's bounding circle to walls, to other obstacles, to the benchmark route's ends and to places
    /// that the rules of starts and goals name; what moves is where it is at step 0. More than twice the collision range,
    /// so that the robot fits through.
    #[serde(default = "default_gap_m")]
    pub gap_m: f32,
    /// Where their middles may be; anywhere, if this is left out.
    #[serde(default)]
    pub within: Option<Region>,
}

fn default_gap_m() -> f32 {
    0.4
}

/// An outline whose sizes are drawn evenly from ranges, each written `(lowest, highest)`; 0.001 to 1,000 m.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum RandomShape {
    /// A cylinder seen from above.
    Circle {
        /// From the middle to the rim.
        radius_m: (f32, f32),
    },
    /// A box seen from above, turned by any angle.
    Rectangle {
        /// Whole extent along its own x axis.
        width_m: (f32, f32),
        /// Whole extent along its own y axis.
        height_m: (f32, f32),
    },
}

/// A rectangle with its sides along x and y.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Region {
    /// Its lower left corner.
    pub min_m: Vec2,
    /// Its upper right corner.
    pub max_m: Vec2,
}

/// The robot: a disc with a differential drive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Robot {
    /// The disc's radius, 0.01 to 10 m.
    pub radius_m: f32,
    /// What it can do, 1 to 64; action k of the policy is motion k.
    pub motions: Vec<Motion>,
    /// Time constant of the drive, 0 to 10 s: the robot's actual (v, w) follows the chosen motion as a first-order lag,
    /// d(v, w)/dt = (chosen - actual) / lag. 0: at once.
    pub actuator_lag_s: f32,
}

impl Default for Robot {
    /// The paper's five motions, equation (9) in its order (large left, small left, forward, small right,
    /// large right) with v0 = 0.15 m/s and w0 = 0.75 rad/s of table 1. The radius, 0.1 m, and a drive without lag are
    /// ours: the paper says nothing of either.
    fn default() -> Self {
        let motions = [1.5, 0.75, 0.0, -0.75, -1.5].map(|w_rad_s| Motion { v_m_s: 0.15, w_rad_s });
        Self { radius_m: 0.1, motions: motions.into(), actuator_lag_s: 0.0 }
    }
}

/// One motion of the robot, held for a control period.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Motion {
    /// Speed along the heading, -5 to 5 m/s.
    pub v_m_s: f32,
    /// Turning speed, left positive, -20 to 20 rad/s.
    pub w_rad_s: f32,
}

/// The LIDAR: beams spread evenly over its field of view, from the robot's centre.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Lidar {
    /// How many beams, 1 to 4,096. All around, beam 0 looks along the heading and the others follow counterclockwise.
    pub beams: usize,
    /// How wide it sees, 0.01 to 6.2832 (all around, where 6.28 is enough). A narrower one is centred on the heading: the
    /// first beam is its right edge, the last its left edge; a single beam looks ahead.
    pub field_of_view_rad: f32,
    /// What a beam reports when it meets nothing nearer, 0.01 to 1,000 m.
    pub max_range_m: f32,
    /// Standard deviation of the Gaussian noise on each range, 0 to 10 m.
    pub noise_std_m: f32,
    /// Probability that a beam is lost and reports the maximum range, 0 to 1.
    pub dropout: f32,
    /// How many control steps old a scan is when the policy sees it, 0 to 50. (Collisions and rewards go by what is
    /// there now.)
    pub latency_steps: u32,
}

impl Default for Lidar {
    /// 24 beams (equation (8)), without noise; the range of 3.5 m is that of the robot the paper's setting
    /// follows.
    fn default() -> Self {
        Self {
            beams: 24,
            field_of_view_rad: TAU,
            max_range_m: 3.5,
            noise_std_m: 0.0,
            dropout: 0.0,
            latency_steps: 0,
        }
    }
}

impl Lidar {
    /// Whether it reports what is there: no noise, no beam lost.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.noise_std_m <= 0.0 && self.dropout <= 0.0
    }

    /// Whether it sees all around.
    #[must_use]
    pub fn is_all_around(&self) -> bool {
        self.field_of_view_rad >= TAU - 0.01
    }
}

/// The rules of the task: when a goal counts as reached, what counts as a collision, how long an episode
/// is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TaskRules {
    /// The paper's l_a: the goal is reached when nearer than this, 0.001 to 100 m.
    pub goal_radius_m: f32,
    /// The paper's l_c: it is a collision when the smallest distance that a beam measures, from the robot's centre, is
    /// under this, or its body touches something. More than the robot's radius, less than the LIDAR's range.
    pub collision_range_m: f32,
    /// Steps until an episode is cut off, 1 to 1,000,000.
    pub max_episode_steps: u32,
    /// Simulated time of one step, 0.001 to 10 s.
    pub control_period_s: f32,
    /// How far a new goal is from the robot at least; more than the goal radius.
    pub min_goal_distance_m: f32,
}

impl Default for TaskRules {
    /// l_a = 0.2 m and the control period of 0.2 s are the paper's; l_c, the time limit and the least
    /// distance of a goal are chosen, since the paper leaves them open.
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

/// Where starts or goals may be.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum PlacementRule {
    /// Anywhere, evenly, that is clear of the walls and of every obstacle where it is at that moment.
    Random {
        /// The least distance from the point to any surface, 0 to 1,000 m.
        #[serde(default = "default_clearance_m")]
        clearance_m: f32,
    },
    /// Like `Random`, but within a rectangle.
    Within {
        /// The rectangle's lower left corner.
        min_m: Vec2,
        /// Its upper right corner.
        max_m: Vec2,
        /// The least distance from the point to any surface, 0 to 1,000 m.
        #[serde(default = "default_clearance_m")]
        clearance_m: f32,
    },
    /// Always the same place.
    Fixed {
        /// The place.
        position_m: Vec2,
        /// Where the robot looks at its start, -6.3 to 6.3; anywhere, if this is left out. A goal has none.
        #[serde(default)]
        heading_rad: Option<f32>,
    },
    /// One of a few places, each as likely as the others; the heading is random.
    OneOf {
        /// The places, 1 to 256.
        positions_m: Vec<Vec2>,
    },
}

impl Default for PlacementRule {
    /// Anywhere that is 0.35 m clear of everything.
    fn default() -> Self {
        Self::Random { clearance_m: default_clearance_m() }
    }
}

fn default_clearance_m() -> f32 {
    0.35
}

/// The benchmark route: one navigation from a fixed start to a fixed goal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BenchmarkRoute {
    /// Where the robot starts.
    pub start_m: Vec2,
    /// Where it looks at first, -6.3 to 6.3 (a full turn either way).
    pub heading_rad: f32,
    /// Where it must go.
    pub goal_m: Vec2,
}

impl Default for BenchmarkRoute {
    /// The paper's, from (0, 0) to (1.2, 1.2); the heading along +x is ours.
    fn default() -> Self {
        Self { start_m: vec2(0.0, 0.0), heading_rad: 0.0, goal_m: vec2(1.2, 1.2) }
    }
}
