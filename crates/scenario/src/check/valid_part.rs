//! The valid part of a scenario that has invalid values, for the checks of how its parts fit together.
//!
//! In: a scenario, and the paths of its invalid values. Out: a [`ValidPart`]. Walls, obstacles and generators with an invalid
//! value are left out of it. That can only make more space, so a problem of the valid part is one of the whole scenario.

use crate::file_error::{Diagnostic, overlap};
use crate::schema::*;

/// A speed that an obstacle gets in place of an invalid one. How far the obstacle reaches does not depend on it.
const ANY_SPEED: f32 = 0.01;

/// The valid part of a scenario.
pub(super) struct ValidPart {
    /// The scenario without its invalid walls, obstacles and generators, and with the default in every other invalid field that
    /// the checks use.
    pub(super) scenario: Scenario,
    /// The obstacles that are valid apart from their speed, with their index in the whole scenario. An invalid speed is replaced.
    pub(super) obstacles_at_any_speed: Vec<(usize, Obstacle)>,
    /// For each list, the indices of its valid elements in the whole scenario.
    kept: [(&'static str, Vec<usize>); 3],
    invalid: Vec<String>,
}

impl ValidPart {
    pub(super) fn new(whole: &Scenario, invalid: Vec<String>) -> Self {
        let indices = |list: &str, count: usize| {
            let is_valid = |k: &usize| !touches(&invalid, &format!("{list}[{k}]"));
            let count = if invalid.iter().any(|path| path.is_empty() || path == list) { 0 } else { count };
            (0..count).filter(is_valid).collect::<Vec<_>>()
        };
        let kept = [
            ("walls", indices("walls", whole.walls.len())),
            ("obstacles", indices("obstacles", whole.obstacles.len())),
            ("generators", indices("generators", whole.generators.len())),
        ];
        let mut scenario = Scenario {
            walls: kept[0].1.iter().map(|&k| whole.walls[k].clone()).collect(),
            obstacles: kept[1].1.iter().map(|&k| whole.obstacles[k].clone()).collect(),
            generators: kept[2].1.iter().map(|&k| whole.generators[k].clone()).collect(),
            ..whole.clone()
        };
        let default = Scenario::default();
        let is_invalid = |path: &str| touches(&invalid, path);
        if is_invalid("enclosure") {
            scenario.enclosure = default.enclosure;
        }
        if is_invalid("starts") {
            scenario.starts = default.starts;
        }
        if is_invalid("goals") {
            scenario.goals = default.goals;
        }
        if is_invalid("benchmark_route") {
            scenario.benchmark_route = None;
        }
        if is_invalid("robot.motions") {
            scenario.robot.motions = default.robot.motions;
        }
        if is_invalid("robot.shape") {
            scenario.robot.shape = None;
        }
        let collision_range_m = scenario.task.collision_range_m;
        if is_invalid("task") {
            scenario.task = default.task;
        }
        if !is_invalid("task.collision_range_m") {
            scenario.task.collision_range_m = collision_range_m;
        }
        Self { obstacles_at_any_speed: obstacles_at_any_speed(whole, &invalid), scenario, kept, invalid }
    }

    /// Whether the part of the scenario at `path` is valid.
    pub(super) fn has(&self, path: &str) -> bool {
        !touches(&self.invalid, path)
    }

    /// Whether the distance that the robot keeps from surfaces is valid.
    pub(super) fn has_keep_out(&self) -> bool {
        self.has("task.collision_range_m") && self.has("robot.shape")
    }

    /// The path of an element of a list in the whole scenario.
    pub(super) fn path_in_whole(&self, list: &str, index: usize) -> String {
        let kept = self.kept.iter().find(|(name, _)| *name == list).and_then(|(_, kept)| kept.get(index));
        format!("{list}[{}]", kept.unwrap_or(&index))
    }

    /// A diagnostic of the valid part, with its path in the whole scenario.
    pub(super) fn in_whole(&self, mut found: Diagnostic) -> Diagnostic {
        for (list, _) in &self.kept {
            let Some(rest) = found.path.strip_prefix(list).and_then(|rest| rest.strip_prefix('[')) else {
                continue;
            };
            let Some((index, rest)) = rest.split_once(']') else { continue };
            if let Ok(index) = index.parse() {
                found.path = self.path_in_whole(list, index) + rest;
                break;
            }
        }
        found
    }
}

/// Whether one of the `invalid` fields is the field at `path`, is inside it or contains it.
fn touches(invalid: &[String], path: &str) -> bool {
    invalid.iter().any(|other| overlap(other, path))
}

/// The obstacles that are valid apart from their speed, with their index. An invalid speed is replaced.
fn obstacles_at_any_speed(whole: &Scenario, invalid: &[String]) -> Vec<(usize, Obstacle)> {
    if invalid.iter().any(|path| path.is_empty() || path == "obstacles") {
        return Vec::new();
    }
    let at_any_speed = |(k, obstacle): (usize, &Obstacle)| {
        let at = format!("obstacles[{k}]");
        let speed = format!("{at}.motion.speed_");
        let mut here = invalid.iter().filter(|other| overlap(other, &at)).peekable();
        let mut obstacle = obstacle.clone();
        if here.peek().is_some() {
            if !here.all(|other| other.starts_with(&speed)) {
                return None;
            }
            obstacle.motion.given_speed_mut().into_iter().for_each(|speed| *speed = ANY_SPEED.into());
        }
        Some((k, obstacle))
    };
    whole.obstacles.iter().enumerate().filter_map(at_any_speed).collect()
}
