//! The tables of limits in `docs/trust.md`, with the values of the constants.

use std::fmt::{Display, LowerExp, Write as _};
use std::ops::RangeInclusive;

use super::{
    MAX_ABOUT_CHARS, MAX_ARENAS, MAX_BODIES, MAX_CONFIG_BYTES, MAX_EVAL_EPISODES, MAX_EVAL_RESULTS_BYTES,
    MAX_EVALUATION_EPISODES, MAX_HEAD_BYTES, MAX_IMAGE_SIDE, MAX_JOURNAL_BYTES, MAX_LEVELS_BY_PROGRESS,
    MAX_OBSERVED_FLOATS, MAX_POLICY_BYTES, MAX_RECENT_RETURNS, MAX_REWARD_PARAMETER, MAX_SHEET_LEVELS,
    MAX_STEPS, MAX_TIME_S, experiment,
};
use crate::import::limits as import;
use crate::learning::limits as learning;
use crate::policy::limits as policy;
use crate::scenario::limits as scenario;

/// A table: the limits of one kind of file.
struct Table {
    title: &'static str,
    limits: &'static [Limit],
}

/// A row: what is limited, the limit, its unit ("" for a count), and the reason.
struct Limit(&'static str, Value, &'static str, &'static str);

/// A limit: a maximum, a minimum, or a range that includes both ends.
enum Value {
    Max(u64),
    Bytes(u64),
    Range(u64, u64),
    MaxReal(f64),
    MaxReal32(f32),
    Min(f64),
    RealRange(f32, f32),
}

use Value::{Bytes, Max, MaxReal, MaxReal32, Min};

const fn count(value: usize) -> Value {
    Max(value as u64)
}

const fn counts(range: &RangeInclusive<usize>) -> Value {
    Value::Range(*range.start() as u64, *range.end() as u64)
}

const fn counts32(range: &RangeInclusive<u32>) -> Value {
    Value::Range(*range.start() as u64, *range.end() as u64)
}

const fn reals(range: &RangeInclusive<f32>) -> Value {
    Value::RealRange(*range.start(), *range.end())
}

const fn reals64(range: &RangeInclusive<f64>) -> Value {
    Value::RealRange(*range.start() as f32, *range.end() as f32)
}

const TABLES: &[Table] = &[
    Table { title: "RON files", limits: RON_FILES },
    Table { title: "Scenarios", limits: SCENARIOS },
    Table { title: "Level generators", limits: LEVEL_GENERATORS },
    Table { title: "Sets of scenarios", limits: SETS },
    Table { title: "Suites", limits: SUITES },
    Table { title: "Presets", limits: PRESETS },
    Table { title: "Preset and scenario together", limits: TRAINING },
    Table { title: "Experiments", limits: EXPERIMENTS },
    Table { title: "Policies", limits: POLICIES },
    Table { title: "Checkpoints", limits: CHECKPOINTS },
    Table { title: "Imported files", limits: IMPORTS },
    Table { title: "Command line", limits: COMMAND_LINE },
];

const RON_FILES: &[Limit] = &[
    Limit(
        "size of a scenario, set, suite, level generator, driver, preset or experiment",
        Bytes(scenario::MAX_FILE_BYTES),
        "",
        "memory",
    ),
    Limit(
        "size of a run's `config.ron`",
        Bytes(MAX_CONFIG_BYTES),
        "",
        "a scenario grows when all its defaults are written out",
    ),
    Limit(
        "size of a run's `journal.ron`",
        Bytes(MAX_JOURNAL_BYTES),
        "",
        "it contains every scenario adopted in the run",
    ),
    Limit(
        "nesting of brackets in a RON file",
        count(scenario::MAX_NESTING),
        "levels",
        "the parser is recursive",
    ),
    Limit(
        "problems reported for one file",
        count(scenario::MAX_PROBLEMS),
        "",
        "the message stays readable; the rest are counted",
    ),
];

const SETS: &[Limit] = &[
    Limit("entries", counts(&scenario::SET_SCENARIOS), "", "memory"),
    Limit("`share` of an entry, relative to the others", reals(&scenario::SET_SHARE), "", "mistyped values"),
    Limit("levels of a generator", counts32(&scenario::SET_LEVELS), "", "evaluations use larger seeds"),
];

const SUITES: &[Limit] = &[
    Limit("families", counts(&scenario::SUITE_FAMILIES), "", "memory"),
    Limit("scenarios of a family", counts(&scenario::SUITE_SCENARIOS), "", "memory"),
    Limit("levels of a family", counts32(&scenario::SUITE_LEVELS), "", "time"),
    Limit("episodes in each scenario or level", counts32(&scenario::SUITE_EPISODES), "", "time"),
    Limit("time limit of a family", reals(&scenario::SUITE_TIME_LIMIT_S), "s", "time"),
];

const SCENARIOS: &[Limit] = &[
    Limit("name", count(scenario::MAX_NAME_CHARS), "characters", "one line in the app"),
    Limit("`about`", count(scenario::MAX_ABOUT_CHARS), "characters", "memory"),
    Limit("coordinates", reals(&scenario::COORDINATE_M), "m", "rounding"),
    Limit("width and height of the enclosure", reals(&scenario::ENCLOSURE_SIDE_M), "m", "rounding"),
    Limit("corners of a polygonal enclosure", counts(&scenario::ENCLOSURE_CORNERS), "", "time of the checks"),
    Limit("inner walls", count(scenario::MAX_WALLS), "", "memory, time of the checks"),
    Limit("corners of an inner wall", counts(&scenario::WALL_CORNERS), "", "memory, time of the checks"),
    Limit("cells of an inner wall", count(scenario::MAX_WALL_CELLS), "", "memory, time of the checks"),
    Limit("side of a cell of an inner wall", reals(&scenario::WALL_CELL_M), "m", "mistyped values"),
    Limit(
        "segments of all inner walls, and rectangles of their cells",
        count(scenario::MAX_WALL_SEGMENTS),
        "",
        "memory, time of the checks",
    ),
    Limit("thickness of an inner wall", reals(&scenario::WALL_THICKNESS_M), "m", "mistyped values"),
    Limit("obstacles", count(scenario::MAX_OBSTACLES), "", "memory, time of the checks"),
    Limit("sizes of shapes", reals(&scenario::SHAPE_SIZE_M), "m", "rounding"),
    Limit("corners of a polygonal obstacle", counts(&scenario::POLYGON_CORNERS), "", "time of a step"),
    Limit(
        "coordinates of a polygonal obstacle's corners in its own frame",
        reals(&scenario::POLYGON_COORDINATE_M),
        "m",
        "rounding",
    ),
    Limit(
        "area of a polygonal obstacle",
        Min(scenario::MIN_POLYGON_AREA_M2),
        "m²",
        "the area of the smallest square",
    ),
    Limit(
        "rotations and headings",
        reals(&scenario::ANGLE_RAD),
        "rad",
        "a full turn, with room for rounding",
    ),
    Limit(
        "speeds of the robot and of obstacles",
        MaxReal32(scenario::MAX_SPEED_M_S),
        "m/s",
        "mistyped values",
    ),
    Limit(
        "angular speeds of the robot and of obstacles",
        MaxReal32(scenario::MAX_ANGULAR_SPEED_RAD_S),
        "rad/s",
        "mistyped values",
    ),
    Limit(
        "distance that an obstacle moves in a control step",
        MaxReal32(scenario::MAX_STEP_M),
        "m",
        "no obstacle jumps over a robot",
    ),
    Limit(
        "waypoints of a path, goals of a pedestrian",
        counts(&scenario::WAYPOINTS),
        "",
        "memory, time of a step",
    ),
    Limit("pedestrians", count(scenario::MAX_PEDESTRIANS), "", "time of a step"),
    Limit("key frames of all obstacles", count(scenario::MAX_KEY_FRAMES), "", "memory, time of the checks"),
    Limit("times of key frames", reals(&scenario::KEY_FRAME_TIME_S), "s", "rounding"),
    Limit("radius of a random walk", reals(&scenario::WALK_RADIUS_M), "m", "rounding"),
    Limit("generators of random obstacles", count(scenario::MAX_GENERATORS), "", "time of a reset"),
    Limit("obstacles of a generator", counts32(&scenario::GENERATOR_COUNT), "", "time of a reset"),
    Limit("obstacles of all generators", Max(scenario::MAX_GENERATED_OBSTACLES), "", "time of a reset"),
    Limit(
        "clearance of starts and goals, gap around generated obstacles",
        reals(&scenario::CLEARANCE_M),
        "m",
        "mistyped values",
    ),
    Limit("positions of a `OneOf` rule", counts(&scenario::POSITIONS), "", "time of the checks"),
    Limit("radius of the robot", reals(&scenario::ROBOT_RADIUS_M), "m", "mistyped values"),
    Limit("motions of the robot", counts(&scenario::MOTIONS), "", "size of the network's output"),
    Limit("minimum turning radius", reals(&scenario::TURNING_RADIUS_M), "m", "mistyped values"),
    Limit("actuator lag", reals(&scenario::ACTUATOR_LAG_S), "s", "mistyped values"),
    Limit("acceleration of the drive", reals(&scenario::ACCELERATION_M_S2), "m/s^2", "mistyped values"),
    Limit(
        "angular acceleration of the drive",
        reals(&scenario::ANGULAR_ACCELERATION_RAD_S2),
        "rad/s^2",
        "mistyped values",
    ),
    Limit("slip of the wheels", reals(&scenario::SLIP), "", "mistyped values"),
    Limit("standard deviation of the slip", reals(&scenario::SLIP_STD), "", "mistyped values"),
    Limit("relative errors of odometry", reals(&scenario::ODOMETRY_ERROR), "", "mistyped values"),
    Limit("drift of the heading", reals(&scenario::HEADING_DRIFT_RAD_M), "rad/m", "mistyped values"),
    Limit("LIDAR beams", counts(&scenario::BEAMS), "", "memory, time of a step"),
    Limit("field of view of the LIDAR", reals(&scenario::FIELD_OF_VIEW_RAD), "rad", "a full turn"),
    Limit("LIDAR range", reals(&scenario::LIDAR_RANGE_M), "m", "rounding"),
    Limit("standard deviation of LIDAR noise", reals(&scenario::LIDAR_NOISE_M), "m", "mistyped values"),
    Limit("LIDAR latency", counts32(&scenario::LIDAR_LATENCY_STEPS), "steps", "memory"),
    Limit("goal radius", reals(&scenario::GOAL_RADIUS_M), "m", "mistyped values"),
    Limit("collision range", reals(&scenario::COLLISION_RANGE_M), "m", "mistyped values"),
    Limit(
        "smallest distance of a new goal from the robot",
        reals(&scenario::GOAL_DISTANCE_M),
        "m",
        "mistyped values",
    ),
    Limit("time limit of an episode", counts32(&scenario::EPISODE_STEPS), "steps", "time of an evaluation"),
    Limit("control period", reals(&scenario::CONTROL_PERIOD_S), "s", "mistyped values"),
    Limit(
        "cells in the check of reachability, approximately",
        Max(scenario::MAX_CELLS as u64),
        "",
        "time of the checks",
    ),
    Limit(
        "sides of obstacles and walls tested per position, over all moments",
        count(scenario::MAX_EDGE_CHECKS),
        "",
        "time of the checks; larger scenarios are checked at fewer moments",
    ),
    Limit(
        "number of obstacles to place, multiplied by the number of sides to test",
        count(scenario::MAX_GENERATION_WORK),
        "",
        "time of the checks",
    ),
    Limit("points tested on paths", Max(scenario::MAX_SAMPLED_POINTS as u64), "", "time of the checks"),
    Limit(
        "pairs of sides tested for overlaps",
        count(scenario::MAX_OVERLAP_WORK),
        "",
        "time of the checks; a larger scenario is tested in part",
    ),
];

const LEVEL_GENERATORS: &[Limit] = &[
    Limit(
        "name",
        count(scenario::MAX_GENERATOR_NAME_CHARS),
        "characters",
        "room for a seed in the name of a level",
    ),
    Limit("width and height of the enclosure", reals(&scenario::LEVEL_SIDE_M), "m", "time of a level"),
    Limit(
        "`gap_m`, widths of doors, passages and traps",
        reals(&scenario::LEVEL_GAP_M),
        "m",
        "mistyped values",
    ),
    Limit("clearance of starts and goals", reals(&scenario::LEVEL_CLEARANCE_M), "m", "mistyped values"),
    Limit(
        "smallest clearance as a multiple of `gap_m`",
        Min(scenario::MIN_CLEARANCE_GAPS),
        "",
        "size of the grid that is searched for paths",
    ),
    Limit(
        "depth of the free strips of a route `Across` (`margin_m`)",
        reals(&scenario::LEVEL_MARGIN_M),
        "m",
        "mistyped values",
    ),
    Limit("layouts in a list, shapes of a layout", count(scenario::MAX_LEVEL_LAYOUTS), "", "memory"),
    Limit(
        "fill of a cellular automaton",
        reals(&scenario::AUTOMATON_FILL),
        "",
        "fuller levels have no paths",
    ),
    Limit("smoothings of a cellular automaton", counts32(&scenario::SMOOTHINGS), "", "time of a level"),
    Limit("fill of cells", reals(&scenario::SOLID_FILL), "", "fuller levels have no paths"),
    Limit("smallest side of a room", reals(&scenario::ROOM_SIDE_M), "m", "mistyped values"),
    Limit("sides of cells, thickness of walls", reals(&scenario::LEVEL_CELL_M), "m", "mistyped values"),
    Limit("cells of a layout", Max(scenario::MAX_LEVEL_CELLS as u64), "", "time of a step"),
    Limit("rooms, approximately", Max(scenario::MAX_LEVEL_ROOMS as u64), "", "time of a step"),
    Limit("obstacles of a layout", counts32(&scenario::LEVEL_COUNT), "", "time of a step"),
    Limit("pairs of lanes", counts32(&scenario::LANE_PAIRS), "", "time of a step"),
    Limit("circles with obstacles on them", counts32(&scenario::ORBIT_CIRCLES), "", "time of a step"),
    Limit(
        "sizes of moving obstacles, reach of walks",
        reals(&scenario::TRAFFIC_SIZE_M),
        "m",
        "mistyped values",
    ),
    Limit("radius of a crossed circle", reals(&scenario::LEVEL_CIRCLE_M), "m", "mistyped values"),
    Limit(
        "radius of a circle with obstacles on it",
        reals(&scenario::LEVEL_ORBIT_M),
        "m",
        "highest angular speed",
    ),
    Limit("noise of starts on a crossed circle", reals(&scenario::LEVEL_NOISE_M), "m", "mistyped values"),
    Limit("goals of a pedestrian of a level", counts32(&scenario::LEVEL_GOALS), "", "time of a level"),
    Limit(
        "cells of the grid that is searched for paths",
        Max(scenario::MAX_FLOOR_CELLS as u64),
        "",
        "memory",
    ),
];

const PRESETS: &[Limit] = &[
    Limit("`about`", count(MAX_ABOUT_CHARS), "characters", "memory"),
    Limit("arenas", count(MAX_ARENAS), "", "memory"),
    Limit("budget, evaluation interval", Max(MAX_STEPS), "steps or episodes", "sums do not overflow"),
    Limit(
        "episodes of an evaluation during training, and of the final test",
        count(MAX_EVALUATION_EPISODES),
        "",
        "time of an evaluation",
    ),
    Limit(
        "parameters of the reward",
        MaxReal32(MAX_REWARD_PARAMETER),
        "in magnitude",
        "rewards and their sums stay finite",
    ),
    Limit(
        "`reward_scale`",
        MaxReal32(learning::MAX_REWARD_SCALE),
        "",
        "scaled rewards and their sums stay finite",
    ),
    Limit("learning rate", MaxReal32(learning::MAX_LEARNING_RATE), "", "mistyped values"),
    Limit("batch size", count(learning::MAX_BATCH_SIZE), "", "memory, time of a gradient step"),
    Limit(
        "gradient steps per update",
        Max(learning::MAX_GRADIENT_STEPS as u64),
        "",
        "time of a control step",
    ),
    Limit("n of n-step returns", count(learning::MAX_N_STEP), "", "memory"),
    Limit("quantiles of a return", count(learning::MAX_QUANTILES), "", "memory, time of a gradient step"),
    Limit("transitions in the replay buffer", count(learning::MAX_REPLAY_CAPACITY), "", "memory"),
    Limit("hidden layers", count(policy::MAX_LAYERS), "", "memory"),
    Limit("units of a layer", count(policy::MAX_UNITS), "", "memory"),
    Limit("parameters of the network", count(policy::MAX_PARAMETERS), "", "64 MiB per copy"),
];

const TRAINING: &[Limit] = &[
    Limit("bodies in all arenas", count(MAX_BODIES), "", "about 2 GB"),
    Limit("numbers in the scans and observations of all arenas", count(MAX_OBSERVED_FLOATS), "", "1 GiB"),
    Limit(
        "numbers in the replay buffer's observations",
        count(learning::MAX_STORED_FLOATS),
        "",
        "9 GiB with the 1/8 that the buffer has in reserve; 2^28, 1.1 GiB, on 32-bit systems",
    ),
    Limit(
        "levels of all generators of a set, if levels are drawn by progress",
        count(MAX_LEVELS_BY_PROGRESS),
        "",
        "100 MB",
    ),
    Limit("environments of a learner", count(learning::MAX_ENVS), "", "memory"),
];

const IMPORTS: &[Limit] = &[
    Limit("size of an image file", Bytes(import::MAX_IMAGE_BYTES), "", "memory"),
    Limit("pixels of an image", count(import::MAX_CELLS), "", "memory; checked before it is decoded"),
    Limit(
        "corners of an outline of a map's floor",
        count(import::MAX_RING_CORNERS),
        "",
        "time of the import",
    ),
    Limit(
        "size of an SDF or JSON file, and of all included models together",
        Bytes(import::MAX_WORLD_BYTES),
        "",
        "memory",
    ),
    Limit("elements, texts and comments of an SDF file", Max(import::MAX_XML_NODES as u64), "", "memory"),
    Limit(
        "models that enclose a model in an SDF file",
        count(import::MAX_MODEL_NESTING),
        "",
        "the reader is recursive",
    ),
    Limit("models that an SDF file includes", count(import::MAX_INCLUDES), "", "time of the import"),
    Limit("side of a map's cell", reals64(&import::RESOLUTION_M), "m", "mistyped values"),
    Limit("numbers of an imported file", reals64(&import::COORDINATE_M), "", "rounding"),
    Limit("`--tolerance`", reals64(&import::TOLERANCE_M), "m", "mistyped values"),
    Limit("`--lidar-height`", reals64(&import::LIDAR_HEIGHT_M), "m", "mistyped values"),
];

const COMMAND_LINE: &[Limit] = &[
    Limit("levels of a contact sheet (`--levels`)", Max(MAX_SHEET_LEVELS), "", "size of the image"),
    Limit("episodes of one `--eval`, over all rounds", Max(MAX_EVAL_EPISODES), "", "memory"),
    Limit("width and height of an image (`--size`)", Max(MAX_IMAGE_SIDE as u64), "pixels", "memory: 256 MiB"),
];

const EXPERIMENTS: &[Limit] = &[
    Limit("training runs", Max(experiment::MAX_TRAINING_RUNS), "", "a larger plan would not finish"),
    Limit("seeds, and finished runs of an arm", Max(experiment::MAX_SEEDS), "", "time of the plan"),
    Limit(
        "arms, conditions, figures, tables, claims; entries of their lists",
        count(experiment::MAX_ENTRIES),
        "each",
        "time of the plan",
    ),
    Limit("stages of an arm", count(experiment::MAX_STAGES), "", "time of the plan"),
    Limit("rounds of a test, and of the paper's values", count(experiment::MAX_ROUNDS), "", "time of a test"),
    Limit("episodes per round of a test", Max(experiment::MAX_TEST_EPISODES), "", "time of a test"),
    Limit("panels of a figure", count(experiment::MAX_SERIES), "", "size of the image"),
    Limit("columns of a figure or table", count(experiment::MAX_MEASURES), "", "size of the image"),
    Limit("moving average in a figure", Max(experiment::MAX_SMOOTHING), "episodes", "mistyped values"),
    Limit("a number in a figure or table", MaxReal(experiment::MAX_VALUE), "in magnitude", "width of a cell"),
    Limit("a name or heading", count(experiment::MAX_NAME_CHARS), "characters", "width of the report"),
    Limit("a path", count(experiment::MAX_PATH_CHARS), "characters", "Linux's own limit"),
    Limit("a text", count(experiment::MAX_TEXT_CHARS), "characters", "memory"),
];

const POLICIES: &[Limit] = &[
    Limit("size of the file", Bytes(MAX_POLICY_BYTES), "", "the parameters and a header"),
    Limit(
        "size of the results of a test (`--eval-results`)",
        Bytes(MAX_EVAL_RESULTS_BYTES),
        "",
        "they list the rounds",
    ),
    Limit(
        "size of the policy's header with the card",
        Bytes(policy::MAX_HEADER_BYTES as u64),
        "",
        "a scenario grows when all its defaults are written out",
    ),
    Limit("inputs", count(policy::MAX_UNITS), "", "memory"),
    Limit("actions", count(policy::MAX_ACTIONS), "", "replay buffers store an action in one byte"),
    Limit("parameters", count(policy::MAX_PARAMETERS), "", "64 MiB"),
];

const CHECKPOINTS: &[Limit] = &[
    Limit(
        "size of the run's header",
        Bytes(MAX_HEAD_BYTES),
        "and never more than the file contains",
        "all scans and observations, and a policy",
    ),
    Limit(
        "size of the learner's header",
        Bytes(learning::MAX_HEADER_BYTES),
        "and never more than the file contains",
        "four arrays of the network's parameters",
    ),
    Limit("counters of the learner", Max(learning::MAX_COUNT), "", "sums do not overflow"),
    Limit("recent returns", count(MAX_RECENT_RETURNS), "", "memory"),
    Limit("times", MaxReal(MAX_TIME_S), "s", "about 30,000 years"),
];

impl Value {
    /// The limit with its unit, such as "10,000 characters", "at least 0.55" or "0.001 to 10 s". A maximum is just the number.
    fn with_unit(&self, unit: &str) -> String {
        let value = match *self {
            Self::Max(max) => whole(max),
            Self::Bytes(max) => mebibytes(max),
            Self::Range(min, max) => format!("{} to {}", whole(min), whole(max)),
            Self::MaxReal(max) => real(max),
            Self::MaxReal32(max) => real(max),
            Self::Min(min) => format!("at least {}", real(min)),
            Self::RealRange(min, max) => format!("{} to {}", real(min), real(max)),
        };
        match unit {
            "" => value,
            unit if unit.starts_with("and") => format!("{value}, {unit}"),
            unit => format!("{value} {unit}"),
        }
    }
}

/// Formats a whole number: a large power of two or ten as a power, any other with separators.
fn whole(value: u64) -> String {
    let digits = value.to_string();
    if value >= 1 << 24 && value.is_power_of_two() {
        return format!("2^{}", value.ilog2());
    }
    if value >= 1 << 24 && digits.trim_end_matches('0') == "1" {
        return format!("10^{}", digits.len() - 1);
    }
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

fn mebibytes(bytes: u64) -> String {
    format!("{} MiB", whole(bytes >> 20))
}

/// Formats a real number, a very large or small one in scientific notation: 0.001, 1,000, 1e9.
fn real<T: Display + LowerExp + Into<f64> + Copy>(value: T) -> String {
    let size = value.into().abs();
    if size != 0.0 && !(1e-4..1e6).contains(&size) {
        format!("{value:e}")
    } else if size >= 1e3 {
        format!("{}{}", if value.into() < 0.0 { "-" } else { "" }, whole(size as u64))
    } else {
        value.to_string()
    }
}

/// The Markdown tables, one per kind of file.
fn tables() -> String {
    let mut text = String::new();
    for Table { title, limits } in TABLES {
        let _ = write!(text, "\n### {title}\n\n| what | limit | reason |\n|---|---|---|\n");
        for Limit(what, value, unit, reason) in *limits {
            let _ = writeln!(text, "| {what} | {} | {reason} |", value.with_unit(unit));
        }
    }
    text
}

#[test]
fn the_limits_in_the_docs_are_those_of_the_code() {
    crate::generated_section::check("docs/trust.md", &tables());
}

#[test]
fn every_limit_is_in_a_table() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |file: &str| std::fs::read_to_string(root.join(file)).expect("the file exists");
    let table = read("src/limits/table.rs");
    let rows = table.split_once("const RON_FILES").expect("the rows come after the imports").1;
    for (file, module) in [
        ("crates/scenario/src/limits.rs", "scenario::"),
        ("crates/policy/src/limits.rs", "policy::"),
        ("crates/learning/src/limits.rs", "learning::"),
        ("crates/import/src/limits.rs", "import::"),
        ("src/limits.rs", "("),
        ("src/limits/experiment.rs", "experiment::"),
    ] {
        let text = read(file);
        let names = text.lines().filter_map(|line| line.strip_prefix("pub const ")?.split(':').next());
        for name in names {
            let name = name.trim();
            let is_there = [")", " as u64)"].iter().any(|end| rows.contains(&format!("{module}{name}{end}")));
            assert!(is_there, "{name} of {file} is in no table; help: add it to src/limits/table.rs");
        }
    }
}
