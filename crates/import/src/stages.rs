//! Stages of turtlebot3_drlnav (<https://github.com/tomasvr/turtlebot3_drlnav>): rooms with boxes and cylinders, some of which
//! follow key frames.
//!
//! In: a JSON file with many stages. Out: a scenario for each, with the robot, the goal radius and the time limit of that project
//! unless the options give another robot.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DVec2, dvec2};
use serde::Deserialize;
use wayfield_scenario::{
    FileError, KeyFrame, KeyFrameEnd, Lidar, Motion, Obstacle, ObstacleMotion, Robot, Scenario, Shape,
    TaskRules,
};

use crate::Imported;
use crate::findings::Findings;
use crate::json;
use crate::limits::COORDINATE_M;
use crate::map::file_name;
use crate::options::ImportOptions;
use crate::round::{metres, point};
use crate::solid::{Outline, Solid};
use crate::world;

/// A file of stages, by number.
#[derive(Deserialize)]
struct StageFile {
    stages: BTreeMap<u32, Stage>,
}

/// The solids of a room.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    #[serde(rename = "static", default)]
    fixed: Vec<Fixed>,
    #[serde(default)]
    moving: Vec<MovingDisc>,
}

/// A solid that stands still.
#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum Fixed {
    /// Centre and size along its own axes in m, rotation in rad.
    Box([f64; 5]),
    /// Centre and radius in m.
    Circle([f64; 3]),
    /// Something that the file describes in words.
    Note(String),
}

/// A disc that moves in straight lines between key frames (time in s, x and y in m).
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MovingDisc {
    radius_m: f64,
    /// Time after which the motion repeats; if absent, it ends at the last key frame.
    #[serde(default)]
    period_s: Option<f64>,
    keys: Vec<[f64; 3]>,
}

impl MovingDisc {
    /// The obstacle in a scenario whose (0, 0) is at `origin_m`. `None` without key frames.
    pub fn obstacle(&self, origin_m: DVec2) -> Option<Obstacle> {
        let frame = |&[time_s, x, y]: &[f64; 3]| KeyFrame {
            time_s: metres(time_s),
            position_m: point(dvec2(x, y) - origin_m),
        };
        let mut frames: Vec<KeyFrame> = self.keys.iter().map(frame).collect();
        let position_m = frames.first()?.position_m;
        if frames[0].time_s == 0.0 {
            frames.remove(0);
        }
        let end = match self.period_s.map(metres) {
            Some(period_s) => {
                // A loop returns to the obstacle's position by itself.
                let returns = KeyFrame { time_s: period_s, position_m };
                frames.pop_if(|last| *last == returns);
                KeyFrameEnd::Loop { period_s }
            }
            None => KeyFrameEnd::Stop,
        };
        let is_still = frames.iter().all(|frame| frame.position_m == position_m);
        let motion =
            if is_still { ObstacleMotion::Static } else { ObstacleMotion::KeyFrames { frames, end } };
        let shape = Shape::Circle { radius_m: metres(self.radius_m) };
        Some(Obstacle { shape, position_m, rotation_rad: 0.0, motion })
    }

    fn numbers(&self) -> impl Iterator<Item = f64> {
        [self.radius_m].into_iter().chain(self.period_s).chain(self.keys.iter().flatten().copied())
    }
}

/// Reads the text of a file of stages.
///
/// # Errors
/// The text is not such a file.
pub fn parse(text: &str, path: &Path) -> Result<BTreeMap<u32, Stage>, FileError> {
    Ok(json::parse::<StageFile>(text, path, "stages")?.stages)
}

/// The scenario of stage `number`.
///
/// # Errors
/// A number is out of range, nothing in the stage stands still, a moving disc has no key frame, the robot fits nowhere, or the
/// scenario would be invalid.
pub fn import(
    path: &Path,
    number: u32,
    stage: Stage,
    options: &ImportOptions,
) -> Result<Imported, FileError> {
    let fail = |message: String| FileError::for_file(path, format!("stage {number}: {message}"));
    let (mut solids, mut findings) = (Vec::new(), Findings::default());
    for part in &stage.fixed {
        match *part {
            Fixed::Box([x, y, width, depth, yaw_rad]) => {
                solids.push(fixed(Outline::Rectangle(dvec2(width, depth)), x, y, yaw_rad));
            }
            Fixed::Circle([x, y, radius]) => solids.push(fixed(Outline::Circle(radius), x, y, 0.0)),
            Fixed::Note(ref text) => findings.add("notes are not read", text),
        }
    }
    let numbers =
        solids.iter().flat_map(Solid::numbers).chain(stage.moving.iter().flat_map(MovingDisc::numbers));
    if let Some(number) = numbers.into_iter().find(|value| !COORDINATE_M.contains(value)) {
        return Err(fail(format!("it has the number {number}, beyond a million; help: correct it")));
    }
    if solids.iter().any(|solid| !solid.is_solid()) || stage.moving.iter().any(|disc| disc.radius_m <= 0.0) {
        return Err(fail("a size is not above 0; help: correct it".into()));
    }
    if solids.is_empty() {
        return Err(fail("nothing stands still in it; help: add the walls of the room".into()));
    }
    if stage.moving.iter().any(|disc| disc.keys.is_empty()) {
        return Err(fail("something moves, but has no `keys`; help: add a key [0, x, y]".into()));
    }
    let base = options.robot_from.clone().unwrap_or_else(turtlebot);
    let world = world::World {
        label: format!("{} stage {number}", file_name(path)),
        about: "A stage of turtlebot3_drlnav.".into(),
        solids: &solids,
        moving: &stage.moving,
        findings: &findings,
    };
    let mut imported = world.import(&base).map_err(fail)?;
    // Other worlds get a longer time limit if the path to the goal is long. A stage keeps that of `base`.
    imported.scenario.task.max_episode_steps = base.task.max_episode_steps;
    Ok(imported)
}

fn fixed(outline: Outline, x: f64, y: f64, yaw_rad: f64) -> Solid {
    Solid { outline, centre_m: dvec2(x, y), yaw_rad }
}

/// The TurtleBot3 of turtlebot3_drlnav, with that project's rules: up to 0.22 m/s and 2 rad/s, 40 beams up to 3.5 m, a collision
/// below 0.13 m, a goal radius of 0.20 m, a time limit of 50 s. The robot may also stop and turn in place.
pub fn turtlebot() -> Scenario {
    let turns = [2.0, 1.0, 0.0, -1.0, -2.0];
    let motions =
        [0.0, 0.11, 0.22].iter().flat_map(|&v_m_s| turns.map(|w_rad_s| Motion { v_m_s, w_rad_s })).collect();
    Scenario {
        robot: Robot { radius_m: 0.105, motions, ..Robot::default() },
        lidar: Lidar { beams: 40, max_range_m: 3.5, ..Lidar::default() },
        task: TaskRules {
            collision_range_m: 0.13,
            goal_radius_m: 0.2,
            max_episode_steps: 250,
            ..TaskRules::default()
        },
        ..Scenario::default()
    }
}
