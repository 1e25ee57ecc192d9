//! BARN: 300 worlds of cylinders, with a start, a goal and the length of a shortest path (Perille, Truong, Xiao and Stone,
//! *Benchmarking Metric Ground Navigation*, 2020).
//!
//! In: a world's file `world_N.world` with `path_files/path_N.npy` next to it, as in the repository of the BARN Challenge; or
//! a JSON file with many worlds. Out: a scenario with BARN's start, goal and time limit, and with its robot unless another one is
//! chosen.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use glam::{DVec2, dvec2};
use serde::Deserialize;
use wayfield_scenario::{
    BenchmarkRoute, Enclosure, FileError, Lidar, Motion, PlacementRule, Robot, Scenario, TaskRules,
    read_bytes,
};

use crate::Imported;
use crate::draft;
use crate::findings::Findings;
use crate::frame::Frame;
use crate::json;
use crate::limits::COORDINATE_M;
use crate::map::file_name;
use crate::npy;
use crate::options::ImportOptions;
use crate::round::{metres, point};
use crate::solid::{Outline, Solid, bounds};

/// Radius of the cylinders, half the side of a cell of BARN's grid, in m.
const RADIUS_M: f64 = 0.075;
/// Space around the world, in m.
const MARGIN_M: f64 = 1.0;
/// The text before the length of a shortest path in the `about` of an imported world.
const SHORTEST_PATH: &str = "Shortest path: ";
/// Largest path file, in bytes.
const MAX_PATH_BYTES: u64 = 1 << 20;

/// A file of worlds.
#[derive(Deserialize)]
pub struct BarnFile {
    radius_m: f64,
    start_m: [f64; 2],
    heading_rad: f64,
    goal_m: [f64; 2],
    goal_radius_m: f64,
    time_limit_s: f64,
    worlds: Vec<BarnWorld>,
}

/// One world of the file.
#[derive(Deserialize)]
pub struct BarnWorld {
    world: u32,
    circles_m: Vec<[f64; 2]>,
    #[serde(default)]
    metric_path_length_m: Option<f64>,
}

/// The task of a world.
struct Task {
    start_m: DVec2,
    heading_rad: f64,
    goal_m: DVec2,
    goal_radius_m: f64,
    time_limit_s: f64,
    path_length_m: Option<f64>,
}

impl Task {
    /// BARN's own task, as in `run.py` of the BARN Challenge.
    fn usual(path_length_m: Option<f64>) -> Self {
        Self {
            start_m: dvec2(-2.25, 3.0),
            heading_rad: 1.57,
            goal_m: dvec2(-2.25, 13.0),
            goal_radius_m: 1.0,
            time_limit_s: 100.0,
            path_length_m,
        }
    }
}

/// The path file of the BARN world in the file at `path`, if there is one.
pub fn path_file(path: &Path) -> Option<PathBuf> {
    let number: u32 = path.file_stem()?.to_str()?.strip_prefix("world_")?.parse().ok()?;
    let file = path.parent()?.join(format!("path_files/path_{number}.npy"));
    file.is_file().then_some(file)
}

/// The scenario of a world's file with `solids` and the path in the file `path_file`.
///
/// # Errors
/// The path file is invalid, or the scenario would be.
pub fn import_world(
    path: &Path,
    path_file: &Path,
    solids: &[Solid],
    findings: &Findings,
    options: &ImportOptions,
) -> Result<Imported, FileError> {
    let fail = |message: String| FileError::for_file(path_file, message);
    let bytes =
        read_bytes(path_file, MAX_PATH_BYTES + 1).map_err(|error| fail(format!("can't be read: {error}")))?;
    if bytes.len() as u64 > MAX_PATH_BYTES {
        return Err(fail(format!("is larger than {MAX_PATH_BYTES} bytes; help: fetch the file again")));
    }
    let task = Task::usual(Some(path_length_m(&bytes, path_file)?));
    scenario(path, file_name(path), solids, &task, findings, options)
}

/// The length in m of the path in `bytes`, the contents of the file `path_file`, including straight lines from the start to the
/// path and from the path to the goal.
///
/// # Errors
/// The bytes are not a path file.
pub fn path_length_m(bytes: &[u8], path_file: &Path) -> Result<f64, FileError> {
    let cells = npy::points(bytes)
        .map_err(|error| FileError::for_file(path_file, format!("{error}; help: fetch the file again")))?;
    let task = Task::usual(None);
    // BARN counts cells of its grid from a corner of the field.
    let corner = dvec2(-RADIUS_M - 60.0 * RADIUS_M, RADIUS_M + 5.0);
    let path = cells.into_iter().map(|cell| corner + cell * 2.0 * RADIUS_M);
    let path: Vec<DVec2> = [task.start_m].into_iter().chain(path).chain([task.goal_m]).collect();
    Ok(path.windows(2).map(|ends| ends[0].distance(ends[1])).sum())
}

/// Reads a JSON file of worlds.
///
/// # Errors
/// The text is not such a file.
pub fn parse(text: &str, path: &Path) -> Result<BarnFile, FileError> {
    json::parse(text, path, "BARN worlds")
}

impl BarnFile {
    /// The worlds by their numbers; of several with the same number, the first.
    pub fn by_number(&self) -> BTreeMap<u32, &BarnWorld> {
        self.worlds.iter().rev().map(|world| (world.world, world)).collect()
    }
}

/// The scenario of a `world` of `file`.
///
/// # Errors
/// A coordinate is out of range, or the scenario would be invalid.
pub fn import_one(
    path: &Path,
    file: &BarnFile,
    world: &BarnWorld,
    options: &ImportOptions,
) -> Result<Imported, FileError> {
    let task = Task {
        start_m: file.start_m.into(),
        heading_rad: file.heading_rad,
        goal_m: file.goal_m.into(),
        goal_radius_m: file.goal_radius_m,
        time_limit_s: file.time_limit_s,
        path_length_m: world.metric_path_length_m,
    };
    let outline = Outline::Circle(file.radius_m);
    let solid = |&centre: &[f64; 2]| Solid { outline, centre_m: centre.into(), yaw_rad: 0.0 };
    let solids: Vec<Solid> = world.circles_m.iter().map(solid).collect();
    let points = world.circles_m.iter().chain([&file.start_m, &file.goal_m]);
    if !points.flatten().all(|value| COORDINATE_M.contains(value)) {
        let message = format!("world {} has a coordinate beyond ±1,000,000 m; help: correct it", world.world);
        return Err(FileError::for_file(path, message));
    }
    let label = format!("{} world {}", file_name(path), world.world);
    scenario(path, label, &solids, &task, &Findings::default(), options)
}

/// The scenario of a world.
fn scenario(
    path: &Path,
    label: String,
    solids: &[Solid],
    task: &Task,
    findings: &Findings,
    options: &ImportOptions,
) -> Result<Imported, FileError> {
    let (low, high) = bounds(solids, &[task.start_m, task.goal_m]);
    let (low, high) = (low - DVec2::splat(MARGIN_M), high + DVec2::splat(MARGIN_M));
    let centre = (low + high) / 2.0;
    let base = options.robot_from.clone().unwrap_or_else(robot);
    let (start_m, goal_m) = (point(task.start_m - centre), point(task.goal_m - centre));
    let heading_rad = task.heading_rad as f32;
    let length =
        task.path_length_m.map_or_else(String::new, |length| format!(" {SHORTEST_PATH}{length:.4} m."));
    let frame = Frame { origin_m: centre, yaw_rad: 0.0 };
    let period_s = f64::from(base.task.control_period_s);
    let scenario = Scenario {
        name: draft::name(&label),
        about: draft::about(&format!("Imported from {label}, a world of BARN.{length} {frame}")),
        enclosure: Enclosure::Rectangle { width_m: metres(high.x - low.x), height_m: metres(high.y - low.y) },
        walls: Vec::new(),
        obstacles: solids.iter().map(|solid| solid.obstacle(centre)).collect(),
        generators: Vec::new(),
        starts: PlacementRule::Fixed { position_m: start_m, heading_rad: Some(heading_rad) },
        goals: PlacementRule::Fixed { position_m: goal_m, heading_rad: None },
        benchmark_route: Some(BenchmarkRoute { start_m, heading_rad, goal_m }),
        task: TaskRules {
            goal_radius_m: task.goal_radius_m as f32,
            max_episode_steps: (task.time_limit_s / period_s).round().clamp(1.0, 1e6) as u32,
            min_goal_distance_m: base.task.min_goal_distance_m.max(task.goal_radius_m as f32 * 1.01),
            ..base.task.clone()
        },
        ..base.clone()
    };
    draft::check(&scenario).map_err(|problem| {
        let help = "change the file, or use another robot (--robot)";
        FileError::for_file(path, format!("{label}: {problem}; help: {help}"))
    })?;
    Ok(Imported { scenario, deviation_m: 0.0, path_length_m: task.path_length_m, findings: findings.lines() })
}

/// The length in m of a shortest path that the `about` of an imported world states.
#[must_use]
pub fn stated_path_length_m(about: &str) -> Option<f64> {
    let (_, rest) = about.split_once(SHORTEST_PATH)?;
    let length_m: f64 = rest.split_once(" m.")?.0.parse().ok()?;
    (length_m.is_finite() && length_m > 0.0).then_some(length_m)
}

/// The robot of the BARN Challenge, a Clearpath Jackal as a disc: up to 2 m/s, with a LIDAR of 270 degrees. It may also stop
/// and turn in place. Contact ends an episode.
pub fn robot() -> Scenario {
    let speeds = [0.0, 0.5, 1.0, 2.0];
    let turns = [1.5, 0.75, 0.0, -0.75, -1.5];
    let motions = speeds.iter().flat_map(|&v_m_s| turns.map(|w_rad_s| Motion { v_m_s, w_rad_s })).collect();
    Scenario {
        robot: Robot { radius_m: 0.3, motions, ..Robot::default() },
        lidar: Lidar { beams: 72, field_of_view_rad: 4.7124, max_range_m: 5.0, ..Lidar::default() },
        task: TaskRules { collision_range_m: 0.301, control_period_s: 0.2, ..TaskRules::default() },
        ..Scenario::default()
    }
}
