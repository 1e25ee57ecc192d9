//! The scenario made from what an importer has found: starts and goals, the time limit, a benchmark route, and a description.

use glam::{DVec2, dvec2};
use wayfield_scenario::limits::{
    EPISODE_STEPS, MAX_ABOUT_CHARS, MAX_NAME_CHARS, MAX_OBSTACLES, MAX_WALL_SEGMENTS, MAX_WALLS,
};
use wayfield_scenario::{
    BenchmarkRoute, Enclosure, MAX_FILE_BYTES, PlacementRule, Scenario, Wall, clearance, diagnostics,
    is_unprintable, to_text,
};

use crate::floor::{Floor, MIN_CLEARANCE, Margins};
use crate::frame::Frame;
use crate::grid::Cell;
use crate::round::{metres, point};
use crate::trace::{Scale, Surroundings};

/// Within the time limit, the robot can drive this many times the length of the path between the floor's two ends, because a
/// robot that is still learning takes detours. The ends are two positions about as far apart as any. The length is counted in
/// steps between cells that share a side.
const PATH_FACTOR: f64 = 1.5;

/// Where a scenario comes from.
#[derive(Clone, Debug)]
pub struct Source {
    /// The file's name, without its folder.
    pub file: String,
    /// Sentences about what was read.
    pub about: String,
    /// The pose of the scenario in the source's frame.
    pub frame: Frame,
}

/// The clearance, in m, that every start of the robot of `base` must exceed.
pub fn needed_m(base: &Scenario) -> f64 {
    MIN_CLEARANCE * f64::from(base.keep_out_m())
}

/// The margins of the robot of `base` in cells of `cell_m`.
pub fn margins(base: &Scenario, cell_m: f64) -> Margins {
    let usual = |rule: &PlacementRule| rule.clearance_m().map_or(0.0, f64::from);
    let clearance_m = usual(&base.starts).max(usual(&base.goals)).max(needed_m(base));
    Margins { keep_out: f64::from(base.keep_out_m()) / cell_m, clearance: clearance_m / cell_m }
}

/// The scenario with the robot, the LIDAR and the task of `base` in these surroundings. `size_m` is the size of its enclosure.
pub fn scenario(
    base: &Scenario,
    source: &Source,
    size_m: DVec2,
    floor: &Floor,
    scale: Scale,
    found: &Surroundings,
) -> Scenario {
    let clearance_m = metres(floor.clearance * scale.cell_m);
    let mut scenario = Scenario {
        name: name(&source.file),
        about: about(&format!("Imported from {}. {} {}", source.file, source.about, source.frame)),
        enclosure: Enclosure::Rectangle { width_m: metres(size_m.x), height_m: metres(size_m.y) },
        walls: found.walls.clone(),
        obstacles: found.obstacles.clone(),
        generators: Vec::new(),
        starts: PlacementRule::Random { clearance_m },
        goals: PlacementRule::Random { clearance_m },
        benchmark_route: None,
        ..base.clone()
    };
    // A moving obstacle may stand at an end of the floor.
    let is_clear = |at_m| clearance(&scenario, at_m, 0) >= base.keep_out_m();
    let route = Some(route(floor, scale)).filter(|route| {
        route.start_m.distance(route.goal_m) > base.task.goal_radius_m.max(base.task.min_goal_distance_m)
            && is_clear(route.start_m)
            && is_clear(route.goal_m)
    });
    scenario.benchmark_route = route;
    scenario.task.max_episode_steps = steps(base, floor.longest_path as f64 * scale.cell_m);
    scenario
}

/// The name of a scenario from the file `file`.
pub fn name(file: &str) -> String {
    let name: String = file.chars().filter(|&c| !is_unprintable(c)).take(MAX_NAME_CHARS).collect();
    if name.trim().is_empty() { "Imported".into() } else { name }
}

/// `text` as a description.
pub fn about(text: &str) -> String {
    text.chars().filter(|&c| !is_unprintable(c)).take(MAX_ABOUT_CHARS).collect()
}

/// The benchmark route between the ends of the floor, with the robot facing the goal.
fn route(floor: &Floor, scale: Scale) -> BenchmarkRoute {
    let at = |(column, row): Cell| point(scale.point_m(dvec2(column as f64 + 0.5, row as f64 + 0.5)));
    let (start_m, goal_m) = (at(floor.ends.0), at(floor.ends.1));
    let line = goal_m - start_m;
    BenchmarkRoute { start_m, heading_rad: (libm::atan2f(line.y, line.x) * 100.0).round() / 100.0, goal_m }
}

/// The time limit, in control steps: that of `base`, or more if a path with a length of `path_m` needs it.
fn steps(base: &Scenario, path_m: f64) -> u32 {
    let fastest = base.robot.motions.iter().map(|motion| motion.v_m_s.abs()).fold(0.0, f32::max);
    let step_m = f64::from(fastest) * f64::from(base.task.control_period_s);
    if step_m <= 0.0 {
        return base.task.max_episode_steps;
    }
    let hundreds = (PATH_FACTOR * path_m / step_m / 100.0).ceil();
    let needed = (100.0 * hundreds).min(f64::from(*EPISODE_STEPS.end())) as u32;
    base.task.max_episode_steps.max(needed)
}

/// Checks the scenario, and that it fits into a file.
///
/// # Errors
/// The first problem, as a message without a suggested fix: the caller adds `; help: ...`.
pub fn check(scenario: &Scenario) -> Result<(), String> {
    let segments: usize = scenario.walls.iter().map(Wall::piece_count).sum();
    for (count, most, what) in [
        (scenario.walls.len(), MAX_WALLS, "walls"),
        (segments, MAX_WALL_SEGMENTS, "wall segments"),
        (scenario.obstacles.len(), MAX_OBSTACLES, "obstacles"),
    ] {
        if count > most {
            return Err(format!("the scenario would have {count} {what}, more than {most}"));
        }
    }
    if let Some(first) = diagnostics(scenario).first() {
        return Err(format!("the scenario would be invalid: {first}"));
    }
    let bytes = to_text(scenario, None).len() as u64;
    if bytes > MAX_FILE_BYTES {
        return Err(format!("the scenario's file would be larger than {} MiB", MAX_FILE_BYTES >> 20));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::vec2;

    use super::*;

    #[test]
    fn the_limit_of_wall_segments_counts_segments_not_corners() {
        let wall = |corners: usize| Wall {
            corners_m: (0..corners).map(|k| vec2(k as f32 * 0.01, 0.0)).collect(),
            ..Wall::default()
        };
        let mut scenario = Scenario { walls: vec![wall(11); 1000], ..Scenario::default() };
        assert!(!check(&scenario).is_err_and(|problem| problem.contains("would have")));
        scenario.walls[0] = wall(12);
        let problem = "the scenario would have 10001 wall segments, more than 10000";
        assert_eq!(check(&scenario), Err(problem.into()));
    }
}
