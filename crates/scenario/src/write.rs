//! The RON text of a scenario, as people would write it.

use serde::Serialize;
use serde::de::DeserializeOwned;
use wayfield_ron_patch::{Style, patch};

use super::load::{parse_ron, to_ron};
use super::schema::{
    BenchmarkRoute, Generator, Lidar, Obstacle, ObstacleMotion, PlacementRule, Robot, Scenario, TaskRules,
    Wall, WallCells,
};
use super::text::without_mark;

/// `scenario` as the text of a RON file, which [`Scenario::load`] reads back as the same scenario, bit for bit.
///
/// `old_text` is the file that the scenario was read from, or any older version of it. Everything that has not changed
/// keeps its bytes, comments included; see [`patch`]. Without `old_text`, or if that is not a scenario, the text is
/// canonical: fields in the schema's order, four spaces per level, lines of up to 110 columns, and only what differs
/// from the defaults.
///
/// # Panics
/// Never: writing fails only for types that a scenario does not contain.
#[must_use]
pub fn to_text(scenario: &Scenario, old_text: Option<&str>) -> String {
    let old = old_text.map(without_mark);
    let written = match old {
        Some(old) => patch(old, scenario, &style(), |text| parse_ron(text, "").ok()),
        None => wayfield_ron_patch::to_text(scenario, &style()),
    };
    let text = written.or_else(|_| to_ron(scenario)).expect("a scenario can be written as RON");
    // The byte order mark of the old text stays.
    if old == old_text { text } else { format!("\u{feff}{text}") }
}

/// The defaults of the schema, each read from the shortest valid text of its type, and the blank lines of the shipped
/// files.
fn style() -> Style {
    let style = Style::default().with_blank_lines_except(&[("name", "about"), ("starts", "goals")]);
    let style = with_defaults::<Scenario>(style, "(name: \"\")", &["name"]);
    let style = with_defaults::<Wall>(style, "()", &[]);
    let style = with_defaults::<WallCells>(style, "(rows: [], cell_m: 1.0)", &["rows", "cell_m"]);
    let obstacle = "(shape: Circle(radius_m: 1.0), position_m: (0.0, 0.0))";
    let style = with_defaults::<Obstacle>(style, obstacle, &["shape", "position_m"]);
    let random_walk = "RandomWalk(radius_m: 1.0, speed_m_s: 1.0)";
    let style = with_defaults::<ObstacleMotion>(style, random_walk, &["radius_m", "speed_m_s"]);
    let pedestrian = "Pedestrian(goals_m: [], speed_m_s: 1.0)";
    let style = with_defaults::<ObstacleMotion>(style, pedestrian, &["goals_m", "speed_m_s"]);
    let key_frames = "KeyFrames(frames: [])";
    let style = with_defaults::<ObstacleMotion>(style, key_frames, &["frames"]);
    let generator = "(count: 1, shape: Circle(radius_m: (1.0, 1.0)))";
    let style = with_defaults::<Generator>(style, generator, &["count", "shape"]);
    let style = with_defaults::<Robot>(style, "()", &[]);
    let style = with_defaults::<Lidar>(style, "()", &[]);
    let style = with_defaults::<TaskRules>(style, "()", &[]);
    let style = with_defaults::<BenchmarkRoute>(style, "()", &[]);
    let style = with_defaults::<PlacementRule>(style, "Random()", &[]);
    let within = "Within(min_m: (0.0, 0.0), max_m: (0.0, 0.0))";
    let style = with_defaults::<PlacementRule>(style, within, &["min_m", "max_m"]);
    with_defaults::<PlacementRule>(style, "Fixed(position_m: (0.0, 0.0))", &["position_m"])
}

/// `style` with the defaults of the type `T`, whose shortest text with only the `required` fields is `text`.
fn with_defaults<T: Serialize + DeserializeOwned>(style: Style, text: &str, required: &[&str]) -> Style {
    match parse_ron::<T>(text, "") {
        Ok(value) => style.with_defaults(&value, required),
        Err(_) => style,
    }
}
