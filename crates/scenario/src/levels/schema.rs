//! The types of a level generator file.
//!
//! In: RON text, through [`LevelGenerator::load`]. Out: plain numbers for the modules of `levels`.
//! [`level_generator_diagnostics`](super::level_generator_diagnostics) checks them. A pair of numbers is the lowest and the
//! highest value of a range, from which each level draws.

use glam::Vec2;
use serde::{Deserialize, Serialize};

use crate::schema::{Lidar, RandomShape, Robot, TaskRules};

/// A level generator: a family of scenarios. Each seed gives one of them, a level.
///
/// A level has one layout of `wall_layouts`, one of `clutter` and one of `traffic`, each drawn from its list with equal
/// probabilities. So a level can have rooms with clutter and traffic in them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LevelGenerator {
    /// Name of the family, 1 to 79 characters on one line. The name of a level is this name and its seed, as in `Clutter 17`.
    pub name: String,
    /// Purpose of the family, at most 2,000 characters.
    #[serde(default)]
    pub about: String,
    /// Inner extent of the enclosure along x, 1 to 100 m.
    #[serde(default = "default_side_m")]
    pub width_m: (f32, f32),
    /// Inner extent of the enclosure along y, 1 to 100 m.
    #[serde(default = "default_side_m")]
    pub height_m: (f32, f32),
    /// The passages that connect all starts and goals are at least this wide, and scattered obstacles are at least this far
    /// apart, 0.02 to 50 m. Must be more than twice the collision range and twice the reach of the robot's `shape`, so that
    /// the robot fits through.
    #[serde(default = "default_gap_m")]
    pub gap_m: f32,
    /// Layouts of inner walls, at most 16.
    #[serde(default)]
    pub wall_layouts: Vec<WallLayout>,
    /// Layouts of static obstacles, at most 16.
    #[serde(default)]
    pub clutter: Vec<Clutter>,
    /// Layouts of moving obstacles, at most 16.
    #[serde(default)]
    pub traffic: Vec<Traffic>,
    /// Where episodes start and where goals are.
    #[serde(default)]
    pub route: Route,
    /// The robot of all levels.
    #[serde(default)]
    pub robot: Robot,
    /// The robot's LIDAR.
    #[serde(default)]
    pub lidar: Lidar,
    /// Goal radius, collision range, time limit and control period of all levels.
    #[serde(default)]
    pub task: TaskRules,
}

fn default_side_m() -> (f32, f32) {
    (4.0, 6.0)
}

fn default_gap_m() -> f32 {
    0.35
}

/// A layout of inner walls.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum WallLayout {
    /// Solid square cells at random, as in the levels of JaxNav. Cells that are cut off from the largest free area become
    /// solid, too.
    Cells {
        /// Side of a cell, 0.02 to 10 m. It is increased so that the cells cover the enclosure.
        #[serde(default = "default_solid_m")]
        cell_m: (f32, f32),
        /// Fraction of the cells that are solid, 0 to 0.8.
        #[serde(default = "default_solid")]
        fill: (f32, f32),
    },
    /// A grid of cells as text, such as `["#.#", "...", "#.#"]`. The cells cover the enclosure, which stretches them. Free
    /// cells that are cut off from the largest free area become solid.
    Grid {
        /// The rows from top to bottom, all of the same length: `#` is solid, `.` and a space are free. At most 4,000 cells
        /// in total, each at least 0.02 m wide and high.
        rows: Vec<String>,
    },
    /// Rooms: a wall with a door divides the enclosure, then each part, until they are too small.
    Rooms {
        /// Smallest side of a room between the centre lines of its walls, 0.2 to 50 m. Must be more than `gap_m` plus 0.1, or
        /// twice that if walls can have two doors.
        #[serde(default = "default_room_m")]
        side_m: (f32, f32),
        /// Width of the doors, 0.02 to 50 m. Must be more than `gap_m`.
        #[serde(default = "default_door_m")]
        door_m: (f32, f32),
        /// Probability that a wall has two doors, 0 to 1.
        #[serde(default = "default_loops")]
        loops: (f32, f32),
    },
    /// A maze of straight passages. With thick walls, these are corridors between solid blocks.
    Maze {
        /// Width of the passages, 0.02 to 50 m. It is increased so that the maze covers the enclosure. Must be more than
        /// `gap_m`.
        #[serde(default = "default_passage_m")]
        passage_m: (f32, f32),
        /// Thickness of the walls, 0.02 to 10 m.
        #[serde(default = "default_wall_m")]
        wall_m: (f32, f32),
        /// Probability that a dead end gets a second exit, 0 to 1.
        #[serde(default = "default_loops")]
        loops: (f32, f32),
    },
    /// U-shaped traps at random positions, at least `gap_m` from each other and from the enclosure.
    Traps {
        /// Number of traps, 0 to 200. Fewer are placed if space runs out.
        #[serde(default = "default_traps")]
        count: (u32, u32),
        /// Inner width, 0.02 to 50 m. Must be more than `gap_m`.
        #[serde(default = "default_trap_m")]
        width_m: (f32, f32),
        /// Inner depth minus 0.1 m, 0.02 to 50 m. The inner depth is measured from the opening to the back wall.
        #[serde(default = "default_trap_m")]
        depth_m: (f32, f32),
    },
}

fn default_solid_m() -> (f32, f32) {
    (0.5, 0.8)
}

fn default_solid() -> (f32, f32) {
    (0.1, 0.5)
}

fn default_room_m() -> (f32, f32) {
    (1.2, 1.8)
}

fn default_door_m() -> (f32, f32) {
    (0.5, 0.8)
}

fn default_loops() -> (f32, f32) {
    (0.0, 0.6)
}

fn default_passage_m() -> (f32, f32) {
    (0.6, 1.0)
}

fn default_wall_m() -> (f32, f32) {
    (0.1, 0.1)
}

fn default_traps() -> (u32, u32) {
    (1, 4)
}

fn default_trap_m() -> (f32, f32) {
    (0.6, 1.4)
}

/// A layout of static obstacles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Clutter {
    /// Circles on a grid of cells, by a cellular automaton as in the BARN dataset. Cells are filled at random at first. Then,
    /// in each smoothing, a cell with at least 5 filled neighbours of 8 is filled, and one with at most 1 is emptied. Space
    /// that the robot can't reach is filled, too.
    Automaton {
        /// Fraction of the cells that are filled at first, 0 to 0.5.
        #[serde(default = "default_fill")]
        fill: (f32, f32),
        /// Number of smoothings, 0 to 10.
        #[serde(default = "default_smoothings")]
        smoothings: (u32, u32),
        /// Side of a cell, which is the diameter of a circle, 0.02 to 10 m.
        #[serde(default = "default_cell_m")]
        cell_m: (f32, f32),
    },
    /// Obstacles at random positions, at least `gap_m` from each other and from all walls. Fewer are placed if space runs out.
    Scatter {
        /// Number of obstacles, 0 to 200.
        #[serde(default = "default_scatter")]
        count: (u32, u32),
        /// Shapes, 1 to 16; each obstacle has one of them with equal probability. A rod is a thin rectangle.
        shapes: Vec<RandomShape>,
    },
}

fn default_scatter() -> (u32, u32) {
    (5, 15)
}

fn default_fill() -> (f32, f32) {
    (0.15, 0.3)
}

fn default_smoothings() -> (u32, u32) {
    (2, 4)
}

fn default_cell_m() -> (f32, f32) {
    (0.15, 0.15)
}

/// A layout of moving obstacles: circles whose paths are clear of walls and static obstacles. Only pedestrians give way. Fewer
/// are placed if no free path is found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Traffic {
    /// Pairs of straight lanes across the enclosure, one in each direction, on which obstacles go round and round.
    Lanes {
        /// Number of pairs, 0 to 10.
        #[serde(default = "default_pairs")]
        pairs: (u32, u32),
        /// Number of obstacles on each pair of lanes, 0 to 200, evenly spaced along the loop of both lanes. Fewer if they would
        /// be closer than 4 radii, centre to centre.
        #[serde(default = "default_per_pair")]
        count: (u32, u32),
        /// Radius, 0.01 to 10 m; the same for all obstacles on a pair.
        #[serde(default = "default_radius_m")]
        radius_m: (f32, f32),
        /// Speed, 0 to 5 m/s; the same for all obstacles on a pair.
        #[serde(default = "default_speed_m_s")]
        speed_m_s: (f32, f32),
    },
    /// Obstacles that start all around a circle and cross it to the opposite points and back, as in CrowdNav.
    CircleCrossing {
        /// Number of obstacles, 0 to 200.
        #[serde(default = "default_count")]
        count: (u32, u32),
        /// Radius of an obstacle, 0.01 to 10 m.
        #[serde(default = "default_radius_m")]
        radius_m: (f32, f32),
        /// Speed, 0 to 5 m/s.
        #[serde(default = "default_speed_m_s")]
        speed_m_s: (f32, f32),
        /// Radius of the circle, 0.1 to 50 m. It is decreased to fit into the enclosure.
        #[serde(default = "default_circle_m")]
        circle_m: (f32, f32),
    },
    /// Obstacles that move back and forth between two random points each.
    RandomCrossing {
        /// Number of obstacles, 0 to 200.
        #[serde(default = "default_count")]
        count: (u32, u32),
        /// Radius, 0.01 to 10 m.
        #[serde(default = "default_radius_m")]
        radius_m: (f32, f32),
        /// Speed, 0 to 5 m/s.
        #[serde(default = "default_speed_m_s")]
        speed_m_s: (f32, f32),
    },
    /// Obstacles that walk at random around random points.
    RandomWalks {
        /// Number of obstacles, 0 to 200.
        #[serde(default = "default_count")]
        count: (u32, u32),
        /// Radius of an obstacle, 0.01 to 10 m.
        #[serde(default = "default_radius_m")]
        radius_m: (f32, f32),
        /// Highest speed, 0 to 5 m/s.
        #[serde(default = "default_speed_m_s")]
        speed_m_s: (f32, f32),
        /// Largest distance of a walk from its point, 0.01 to 10 m.
        #[serde(default = "default_reach_m")]
        reach_m: (f32, f32),
    },
    /// Circles around random points, on which obstacles drive one behind another.
    Orbits {
        /// Number of circles, 0 to 20.
        #[serde(default = "default_pairs")]
        circles: (u32, u32),
        /// Number of obstacles on each circle, 0 to 200, at about the same distance from each other. Fewer if they could overlap.
        #[serde(default = "default_per_circle")]
        count: (u32, u32),
        /// Radius of an obstacle, 0.01 to 10 m; the same for all obstacles on a circle.
        #[serde(default = "default_radius_m")]
        radius_m: (f32, f32),
        /// Speed, 0 to 5 m/s; the same for all obstacles on a circle.
        #[serde(default = "default_speed_m_s")]
        speed_m_s: (f32, f32),
        /// Radius of a circle, 0.25 to 50 m.
        #[serde(default = "default_orbit_m")]
        orbit_m: (f32, f32),
    },
    /// Pedestrians who start at random near a circle, walk to the opposite points and avoid each other by ORCA, as in CrowdNav.
    PedestrianCircle {
        /// Number of pedestrians, 0 to 200.
        #[serde(default = "default_count")]
        count: (u32, u32),
        /// Radius of a pedestrian, 0.01 to 10 m.
        #[serde(default = "default_radius_m")]
        radius_m: (f32, f32),
        /// Highest speed, 0 to 5 m/s.
        #[serde(default = "default_speed_m_s")]
        speed_m_s: (f32, f32),
        /// Radius of the circle, 0.1 to 50 m. Pedestrians who don't fit into the enclosure are omitted.
        #[serde(default = "default_circle_m")]
        circle_m: (f32, f32),
        /// Largest distance of a start from the circle along x and along y, 0 to 10 m.
        #[serde(default)]
        noise_m: f32,
        /// Whether they walk back and begin again. Otherwise they stop at the opposite points.
        #[serde(default = "default_walk_loops")]
        loops: bool,
        /// Whether they also avoid the robot.
        #[serde(default)]
        sees_robot: bool,
    },
    /// Pedestrians who walk between random points and avoid each other by ORCA.
    PedestrianCrowd {
        /// Number of pedestrians, 0 to 200.
        #[serde(default = "default_count")]
        count: (u32, u32),
        /// Radius of a pedestrian, 0.01 to 10 m.
        #[serde(default = "default_radius_m")]
        radius_m: (f32, f32),
        /// Highest speed, 0 to 5 m/s.
        #[serde(default = "default_speed_m_s")]
        speed_m_s: (f32, f32),
        /// Number of goals that each visits before returning, 1 to 256.
        #[serde(default = "default_goals")]
        goals: (u32, u32),
        /// Whether they also avoid the robot.
        #[serde(default)]
        sees_robot: bool,
    },
}

fn default_walk_loops() -> bool {
    true
}

fn default_goals() -> (u32, u32) {
    (1, 3)
}

fn default_pairs() -> (u32, u32) {
    (1, 2)
}

fn default_per_circle() -> (u32, u32) {
    (1, 4)
}

fn default_orbit_m() -> (f32, f32) {
    (0.4, 1.2)
}

fn default_per_pair() -> (u32, u32) {
    (2, 6)
}

fn default_count() -> (u32, u32) {
    (3, 8)
}

fn default_radius_m() -> (f32, f32) {
    (0.1, 0.2)
}

/// 0.2 to 1.0 times the speed of the paper's robot.
fn default_speed_m_s() -> (f32, f32) {
    (0.03, 0.15)
}

fn default_circle_m() -> (f32, f32) {
    (1.5, 2.5)
}

fn default_reach_m() -> (f32, f32) {
    (0.3, 1.0)
}

/// The starts and goals of a level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Route {
    /// Random starts and goals, which change with every episode. Every goal can be reached from every start.
    Random {
        /// Smallest distance to any surface, 0.01 to 50 m. Must be at least 0.55 `gap_m`.
        #[serde(default = "default_clearance_m")]
        clearance_m: f32,
    },
    /// A route from the middle of the lower side, heading along +y, to the middle of the upper side, as in the BARN dataset.
    Across {
        /// Depth of the two strips, along the lower and the upper side, that are kept free of clutter and traffic, 0.1 to 50 m.
        /// The start is in the middle of the lower strip, the goal in the middle of the upper one. Must be at least twice
        /// `gap_m` and at most a third of the smallest height.
        #[serde(default = "default_margin_m")]
        margin_m: f32,
    },
    /// The same start and goal in all levels.
    Fixed {
        /// Position of the start.
        start_m: Vec2,
        /// Heading at the start, -6.3 to 6.3.
        heading_rad: f32,
        /// Position of the goal.
        goal_m: Vec2,
    },
}

impl Default for Route {
    /// Random starts and goals with a clearance of 0.25 m.
    fn default() -> Self {
        Self::Random { clearance_m: default_clearance_m() }
    }
}

fn default_clearance_m() -> f32 {
    0.25
}

fn default_margin_m() -> f32 {
    1.0
}
