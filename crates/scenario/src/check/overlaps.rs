//! Notes on obstacles that overlap walls or other obstacles, or pass through them.
//!
//! Obstacles do not stop each other, so such a scenario can be run. Moving obstacles that meet are not reported: they are
//! like people who pass each other.

use std::collections::HashSet;
use std::fmt;

use super::swept_path::{StaticSolid, SweptPath};
use super::{Note, NoteLevel};
use crate::file_error::Diagnostic;
use crate::limits::{MAX_OVERLAP_WORK, MAX_PROBLEMS};
use crate::schema::Scenario;
use crate::track::Track;

/// A wall or an obstacle, by its index.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum SolidId {
    Wall(usize),
    Obstacle(usize),
}

impl fmt::Display for SolidId {
    /// The number that the app shows, from 1, and the field in the file.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Wall(k) => write!(f, "wall {} (`walls[{k}]`)", k + 1),
            Self::Obstacle(k) => write!(f, "obstacle {} (`obstacles[{k}]`)", k + 1),
        }
    }
}

pub(super) fn check(scenario: &Scenario, notes: &mut Vec<Note>) {
    let solids = static_solids(scenario);
    let mut work_left = MAX_OVERLAP_WORK;
    for (k, obstacle) in scenario.obstacles.iter().enumerate() {
        let is_moving = obstacle.motion.is_moving();
        let path = SweptPath::of(obstacle);
        let mut found: HashSet<SolidId> = HashSet::new();
        for (id, solid) in &solids {
            // A pair of static obstacles is noted once, at the second of them.
            let skip = matches!(id, SolidId::Obstacle(j) if *j >= k && !is_moving) || found.contains(id);
            if skip {
                continue;
            }
            let Some(left) = work_left.checked_sub(path.work(solid)) else { return };
            work_left = left;
            if path.overlaps(solid) {
                found.insert(*id);
                notes.push(note(scenario, k, &path, (*id, solid)));
            }
            if notes.len() >= MAX_PROBLEMS {
                return;
            }
        }
    }
}

/// The static obstacles, and the segments of the walls.
fn static_solids(scenario: &Scenario) -> Vec<(SolidId, StaticSolid)> {
    let mut solids = Vec::new();
    for (k, wall) in scenario.walls.iter().enumerate() {
        solids.extend(wall.pieces().map(|piece| (SolidId::Wall(k), StaticSolid::new(piece))));
    }
    for (k, obstacle) in scenario.obstacles.iter().enumerate() {
        if !obstacle.motion.is_moving() {
            solids.push((SolidId::Obstacle(k), StaticSolid::new(obstacle.clone())));
        }
    }
    solids
}

fn note(scenario: &Scenario, k: usize, path: &SweptPath<'_>, (id, solid): (SolidId, &StaticSolid)) -> Note {
    let position_m = path.position_m(solid);
    // Adding 0 turns -0 into 0.
    let round = |x: f32| (100.0 * x).round() / 100.0 + 0.0;
    let at = format!("({:.2}, {:.2})", round(position_m.x), round(position_m.y));
    let crossing = |crosses: &str| {
        let why = if scenario.obstacles[k].motion.is_pedestrian() {
            "pedestrians don't find a way around; add goals on the way"
        } else {
            "moving obstacles pass through everything; change the path, unless that is intended"
        };
        let message = format!("{crosses} {id} at {at}: {why}");
        (format!("obstacles[{k}].motion"), message)
    };
    let (path, message) = match scenario.obstacles[k].actual_track() {
        Track::Point => {
            let message = format!("overlaps {id} at {at}: move one of them, unless they form one shape");
            (format!("obstacles[{k}]"), message)
        }
        Track::Disc { .. } => crossing("may cross"),
        Track::Circle { .. } | Track::Lines { .. } => crossing("crosses"),
    };
    Note { level: NoteLevel::Note, diagnostic: Diagnostic { path, message }, position_m: Some(position_m) }
}
