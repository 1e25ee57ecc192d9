//! The limits of files and of the numbers in them.
//!
//! They keep a hostile or mistaken file from taking too much memory or time. Lengths are in m, angles in rad, times in s; ranges
//! include both ends.

use std::ops::RangeInclusive;

// Files.

/// Largest RON file, in bytes.
pub const MAX_FILE_BYTES: u64 = 1 << 20;
/// Deepest nesting of brackets in a RON file.
pub const MAX_NESTING: usize = 64;
/// Maximum number of problems that are reported for one file; the rest are counted.
pub const MAX_PROBLEMS: usize = 100;

// Texts.

/// Longest scenario name, in characters.
pub const MAX_NAME_CHARS: usize = 100;
/// Longest description of a scenario, in characters.
pub const MAX_ABOUT_CHARS: usize = 2_000;

// Sets of scenarios.

/// Number of scenarios of a set.
pub const SET_SCENARIOS: RangeInclusive<usize> = 1..=64;
/// Weight of a scenario in a set (`share`), relative to the others.
pub const SET_SHARE: RangeInclusive<f32> = 0.001..=1000.0;
/// Number of levels of a generator in a set.
pub const SET_LEVELS: RangeInclusive<u32> = 1..=1_000_000;

// Suites.

/// Number of families of a suite.
pub const SUITE_FAMILIES: RangeInclusive<usize> = 1..=64;
/// Number of scenarios of a family.
pub const SUITE_SCENARIOS: RangeInclusive<usize> = 1..=10_000;
/// Number of levels of a family.
pub const SUITE_LEVELS: RangeInclusive<u32> = 1..=10_000;
/// Number of episodes in a scenario of a suite.
pub const SUITE_EPISODES: RangeInclusive<u32> = 1..=10_000;
/// Time limit of a family, in s.
pub const SUITE_TIME_LIMIT_S: RangeInclusive<f32> = 0.1..=100_000.0;

// Enclosure and walls.

/// Coordinates of points, in m.
pub const COORDINATE_M: RangeInclusive<f32> = -500.0..=500.0;
/// Extent of the enclosure along x and along y, in m.
pub const ENCLOSURE_SIDE_M: RangeInclusive<f32> = 0.5..=1000.0;
/// Number of corners of a polygonal enclosure.
pub const ENCLOSURE_CORNERS: RangeInclusive<usize> = 3..=64;
/// Maximum number of inner walls.
pub const MAX_WALLS: usize = 1_000;
/// Number of corners of an inner wall.
pub const WALL_CORNERS: RangeInclusive<usize> = 2..=256;
/// Thickness of an inner wall, in m.
pub const WALL_THICKNESS_M: RangeInclusive<f32> = 0.01..=100.0;
/// Maximum number of cells of an inner wall.
pub const MAX_WALL_CELLS: usize = 250_000;
/// Side of a cell of an inner wall, in m.
pub const WALL_CELL_M: RangeInclusive<f32> = 0.01..=100.0;
/// Maximum number of segments of all inner walls together. Solid cells count as the rectangles that they form.
pub const MAX_WALL_SEGMENTS: usize = 10_000;

// Obstacles.

/// Maximum number of obstacles.
pub const MAX_OBSTACLES: usize = 10_000;
/// Sizes of shapes, in m.
pub const SHAPE_SIZE_M: RangeInclusive<f32> = 0.001..=1000.0;
/// Number of corners of a polygonal obstacle.
pub const POLYGON_CORNERS: RangeInclusive<usize> = 3..=32;
/// Coordinates of the corners of a polygonal obstacle in its own frame, in m.
pub const POLYGON_COORDINATE_M: RangeInclusive<f32> = -1000.0..=1000.0;
/// Smallest area of a polygonal obstacle, in m^2: that of the smallest square.
pub const MIN_POLYGON_AREA_M2: f64 = 1e-6;
/// Rotations and headings, in rad: a full turn either way, with some room for rounding.
pub const ANGLE_RAD: RangeInclusive<f32> = -6.3..=6.3;
/// Highest speed of an obstacle or the robot, in m/s.
pub const MAX_SPEED_M_S: f32 = 5.0;
/// Highest angular speed of an obstacle or the robot, in rad/s.
pub const MAX_ANGULAR_SPEED_RAD_S: f32 = 20.0;
/// Longest distance that an obstacle may move in one control step, in m.
pub const MAX_STEP_M: f32 = 0.5;
/// Number of waypoints of a path, or of goals of a pedestrian.
pub const WAYPOINTS: RangeInclusive<usize> = 1..=256;
/// Maximum number of pedestrians.
pub const MAX_PEDESTRIANS: usize = 200;
/// Reach of a random walk, in m.
pub const WALK_RADIUS_M: RangeInclusive<f32> = 0.01..=500.0;
/// Maximum number of key frames of all obstacles together.
pub const MAX_KEY_FRAMES: usize = 10_000;
/// Times of key frames, in s.
pub const KEY_FRAME_TIME_S: RangeInclusive<f32> = 0.001..=100_000.0;

// Generators.

/// Maximum number of generators.
pub const MAX_GENERATORS: usize = 16;
/// Number of obstacles of one generator.
pub const GENERATOR_COUNT: RangeInclusive<u32> = 1..=200;
/// Maximum number of obstacles of all generators together.
pub const MAX_GENERATED_OBSTACLES: u64 = 200;
/// Smallest gap around generated obstacles, and the clearance of placement rules, in m.
pub const CLEARANCE_M: RangeInclusive<f32> = 0.0..=1000.0;

// Level generators.

/// Longest name of a level generator, in characters. A seed follows it in the name of a level.
pub const MAX_GENERATOR_NAME_CHARS: usize = 79;
/// Extent of the enclosure of a level along x and along y, in m.
pub const LEVEL_SIDE_M: RangeInclusive<f32> = 1.0..=100.0;
/// Width of the passages of a level, in m.
pub const LEVEL_GAP_M: RangeInclusive<f32> = 0.02..=50.0;
/// Clearance of the starts and goals of a level, in m.
pub const LEVEL_CLEARANCE_M: RangeInclusive<f32> = 0.01..=50.0;
/// Smallest clearance of starts and goals, as a multiple of the width of the passages.
pub const MIN_CLEARANCE_GAPS: f64 = 0.55;
/// Depth of the free strips at both ends of a level, in m.
pub const LEVEL_MARGIN_M: RangeInclusive<f32> = 0.1..=50.0;
/// Maximum number of layouts in a list of a level generator, and of shapes of a layout.
pub const MAX_LEVEL_LAYOUTS: usize = 16;
/// Fraction of cells that a cellular automaton fills at first.
pub const AUTOMATON_FILL: RangeInclusive<f32> = 0.0..=0.5;
/// Number of smoothings of a cellular automaton.
pub const SMOOTHINGS: RangeInclusive<u32> = 0..=10;
/// Fraction of solid cells in a level.
pub const SOLID_FILL: RangeInclusive<f32> = 0.0..=0.8;
/// Smallest side of a room of a level, in m.
pub const ROOM_SIDE_M: RangeInclusive<f32> = 0.2..=50.0;
/// Side of a cell of a level, in m.
pub const LEVEL_CELL_M: RangeInclusive<f32> = 0.02..=10.0;
/// Maximum number of cells of a layout of a level.
pub const MAX_LEVEL_CELLS: u32 = 4_000;
/// Approximate maximum number of rooms of a level.
pub const MAX_LEVEL_ROOMS: u32 = 250;
/// Number of pairs of lanes of a level.
pub const LANE_PAIRS: RangeInclusive<u32> = 0..=10;
/// Radius of a moving obstacle and reach of a random walk in a level, in m.
pub const TRAFFIC_SIZE_M: RangeInclusive<f32> = 0.01..=10.0;
/// Radius of the circle that the obstacles of a level cross, in m.
pub const LEVEL_CIRCLE_M: RangeInclusive<f32> = 0.1..=50.0;
/// Number of circles of a level on which obstacles drive.
pub const ORBIT_CIRCLES: RangeInclusive<u32> = 0..=20;
/// Radius of a circle of a level on which obstacles drive, in m. On the smallest one, the highest speed corresponds to the
/// highest angular speed.
pub const LEVEL_ORBIT_M: RangeInclusive<f32> = MAX_SPEED_M_S / MAX_ANGULAR_SPEED_RAD_S..=50.0;
/// Largest distance of a pedestrian's start from the circle of a level along x and along y, in m.
pub const LEVEL_NOISE_M: RangeInclusive<f32> = 0.0..=10.0;
/// Number of goals of a pedestrian of a level.
pub const LEVEL_GOALS: RangeInclusive<u32> = 1..=256;
/// Number of obstacles of a layout.
pub const LEVEL_COUNT: RangeInclusive<u32> = 0..=200;
/// Maximum number of cells of the grid on which a level is searched for paths.
pub const MAX_FLOOR_CELLS: u32 = 1 << 24;

// Robot and LIDAR.

/// Radius of the robot, in m.
pub const ROBOT_RADIUS_M: RangeInclusive<f32> = 0.01..=10.0;
/// Number of motions of the robot.
pub const MOTIONS: RangeInclusive<usize> = 1..=64;
/// Minimum turning radius of the robot, in m.
pub const TURNING_RADIUS_M: RangeInclusive<f32> = 0.001..=100.0;
/// Time constant of the drive, in s.
pub const ACTUATOR_LAG_S: RangeInclusive<f32> = 0.0..=10.0;
/// Highest acceleration of the drive, in m/s^2.
pub const ACCELERATION_M_S2: RangeInclusive<f32> = 0.01..=1000.0;
/// Highest angular acceleration of the drive, in rad/s^2.
pub const ANGULAR_ACCELERATION_RAD_S2: RangeInclusive<f32> = 0.01..=10_000.0;
/// Fraction of the wheels' motion that is lost to slip.
pub const SLIP: RangeInclusive<f32> = 0.0..=0.9;
/// Standard deviation of the slip from step to step.
pub const SLIP_STD: RangeInclusive<f32> = 0.0..=0.5;
/// Relative errors of odometry.
pub const ODOMETRY_ERROR: RangeInclusive<f32> = -0.5..=0.5;
/// Drift of the heading in odometry, in rad/m.
pub const HEADING_DRIFT_RAD_M: RangeInclusive<f32> = -1.0..=1.0;
/// Number of LIDAR beams.
pub const BEAMS: RangeInclusive<usize> = 1..=4096;
/// Field of view of the LIDAR, in rad; a full turn may be written as 6.2832.
pub const FIELD_OF_VIEW_RAD: RangeInclusive<f32> = 0.01..=62_832.0 / 10_000.0;
/// Maximum range of the LIDAR, in m.
pub const LIDAR_RANGE_M: RangeInclusive<f32> = 0.01..=1000.0;
/// Standard deviation of the range noise, in m.
pub const LIDAR_NOISE_M: RangeInclusive<f32> = 0.0..=10.0;
/// Delay of a scan, in control steps.
pub const LIDAR_LATENCY_STEPS: RangeInclusive<u32> = 0..=50;

// Task and placement.

/// Radius of the goal, in m.
pub const GOAL_RADIUS_M: RangeInclusive<f32> = 0.001..=100.0;
/// Collision range, in m.
pub const COLLISION_RANGE_M: RangeInclusive<f32> = 0.01..=100.0;
/// Time limit of an episode, in control steps.
pub const EPISODE_STEPS: RangeInclusive<u32> = 1..=1_000_000;
/// Control period, in s.
pub const CONTROL_PERIOD_S: RangeInclusive<f32> = 0.001..=10.0;
/// Smallest distance of a new goal from the robot, in m.
pub const GOAL_DISTANCE_M: RangeInclusive<f32> = 0.001..=1000.0;
/// Number of positions of a `OneOf` rule.
pub const POSITIONS: RangeInclusive<usize> = 1..=256;

// Work of the checks.

/// Approximate maximum number of grid cells in the reachability check.
pub const MAX_CELLS: u32 = 1 << 20;
/// Maximum number of sides of obstacles and walls that are tested per position, over all moments. A scenario with more sides is
/// checked at fewer moments.
pub const MAX_EDGE_CHECKS: usize = 80_000;
/// Maximum number of obstacles to place, multiplied by the number of sides to test; above it, no layout is generated for the
/// check.
pub const MAX_GENERATION_WORK: usize = 400_000;
/// Maximum number of pairs of sides that are tested for overlaps of obstacles and walls; of a scenario with more, only
/// a part is tested.
pub const MAX_OVERLAP_WORK: usize = 1_000_000;
/// Maximum number of points on paths that are tested against the enclosure.
pub const MAX_SAMPLED_POINTS: u32 = 100_000;
