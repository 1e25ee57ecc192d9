//! The fields of an obstacle and of a wall.

use bevy::math::Vec2;
use egui::Ui;

use super::controls::{button_row_ui, choice_ui};
use super::fields::{FieldRows, MAX_SHOWN};
use super::number::NumberSpec;
use crate::app::editor::{Editor, Tool, format_metres};
use crate::app::screen::widgets::text::weak_text;
use crate::scenario::limits::{
    KEY_FRAME_TIME_S, POLYGON_CORNERS, WALL_CELL_M, WALL_CORNERS, WALL_THICKNESS_M, WAYPOINTS,
};
use crate::scenario::{
    Field, FieldValue, KeyFrame, KeyFrameEnd, MotionKind, Obstacle, ObstacleMotion, Track, WallCells,
};

/// Longest text of wall cells that is shown, in bytes.
const MAX_SHOWN_BYTES: usize = 10_000;

/// Shows the fields of an obstacle.
pub fn obstacle_ui(ui: &mut Ui, editor: &mut Editor, index: usize) {
    let Some(mut obstacle) = editor.scenario().obstacles.get(index).cloned() else { return };
    let mut rows = FieldRows::new(ui);
    rows.position("Position", "Centre at the start of an episode", &mut obstacle.position_m);
    described_rows(&mut rows, obstacle.shape.fields_mut());
    if obstacle.shape.has_orientation() {
        rows.number("Rotation", "Counterclockwise", &mut obstacle.rotation_rad, NumberSpec::ANGLE);
    }
    let kind = choice_ui(rows.ui, "Motion", obstacle.motion.kind(), &MotionKind::ALL);
    described_rows(&mut rows, obstacle.motion.fields_mut());
    if let Some(summary) = track_summary(&obstacle) {
        rows.ui.label(weak_text(&summary));
    }
    let (is_static, has_path) = (obstacle.motion == ObstacleMotion::Static, obstacle.path_m().is_some());
    rows.commit(editor, &format!("obstacle {index}"), |scenario| {
        if let Some(old) = scenario.obstacles.get_mut(index) {
            *old = obstacle;
        }
    });
    if is_static || has_path {
        path_button_ui(ui, editor, has_path);
    }
    if let Some(kind) = kind {
        editor.set_motion(kind);
    }
}

/// Shows the button that begins and finishes drawing the path.
fn path_button_ui(ui: &mut Ui, editor: &mut Editor, has_path: bool) {
    let drawing = matches!(editor.tool(), Tool::Path { .. });
    let text = match (drawing, has_path) {
        (true, _) => "Finish path",
        (false, true) => "Redraw path",
        (false, false) => "Draw path",
    };
    let tip = "Click the waypoints; double-click or press Enter to finish";
    if button_row_ui(ui, &[(text, tip, true)]) == Some(0) {
        if drawing {
            editor.finish_tool();
        } else {
            editor.set_tool(Tool::Path { waypoints_m: Vec::new() });
        }
    }
}

/// Shows the fields of a shape or a motion.
pub(super) fn described_rows(rows: &mut FieldRows<'_>, fields: Vec<Field<'_>>) {
    for Field { names, label, about, value } in fields {
        match value {
            FieldValue::Number(number, quantity) => {
                rows.number(label, about, number, NumberSpec::of(quantity));
            }
            FieldValue::Ranged(number, quantity) => {
                rows.ranged(label, about, number, NumberSpec::of(quantity));
            }
            FieldValue::Pair([first, second], quantity) => {
                let name = |k: usize| names[k].trim_end_matches("_m");
                let pair = [(name(0), first), (name(1), second)];
                rows.pair(label, about, pair, NumberSpec::of(quantity));
            }
            FieldValue::Seed(seed) => rows.count(label, about, seed, 0..=u32::MAX),
            FieldValue::Flag(flag) => rows.checkbox(label, about, flag),
            FieldValue::Centre(centre_m) => rows.position(label, about, centre_m),
            FieldValue::Waypoints(waypoints_m) => rows.positions(label, waypoints_m, *WAYPOINTS.start()),
            FieldValue::KeyFrames(frames, end) => {
                end_rows(rows, frames, end);
                key_frame_rows(rows, label, frames);
            }
            FieldValue::Corners(corners_m) => rows.positions(label, corners_m, *POLYGON_CORNERS.start()),
        }
    }
}

/// Adds rows for the times of key frames, then for their positions.
fn key_frame_rows(rows: &mut FieldRows<'_>, label: &str, frames: &mut Vec<KeyFrame>) {
    let time = NumberSpec::seconds(KEY_FRAME_TIME_S);
    for (k, frame) in frames.iter_mut().enumerate().take(MAX_SHOWN) {
        rows.number(&format!("Time {}", k + 1), "Since the start of the motion", &mut frame.time_s, time);
    }
    let specs = [NumberSpec::POSITION; 2];
    rows.list(label, frames, 1, "edit them in the file", specs, |KeyFrame { position_m, .. }| {
        [("x", &mut position_m.x), ("y", &mut position_m.y)]
    });
}

/// Adds rows for whether key frames repeat, and for the period; no rows if there is no time left to return.
fn end_rows(rows: &mut FieldRows<'_>, frames: &[KeyFrame], end: &mut KeyFrameEnd) {
    let was_loop = *end != KeyFrameEnd::Stop;
    let looping = new_period_s(frames).map(|period_s| KeyFrameEnd::Loop { period_s });
    if !was_loop && looping.is_none() {
        return;
    }
    let mut is_loop = was_loop;
    rows.checkbox("Repeat", "Return to the position and start again", &mut is_loop);
    if is_loop != was_loop {
        *end = looping.filter(|_| is_loop).unwrap_or(KeyFrameEnd::Stop);
    }
    if let KeyFrameEnd::Loop { period_s } = end {
        let time = NumberSpec::seconds(KEY_FRAME_TIME_S);
        rows.number("Period", "Time at which it is back at its position", period_s, time);
    }
}

/// The first value for the period of key frames that are set to repeat: twice the time of the last frame, or the longest allowed
/// period if that is shorter. `None` if the last frame is at the latest allowed time.
fn new_period_s(frames: &[KeyFrame]) -> Option<f32> {
    let last_s = frames.last().map_or(1.0, |frame| frame.time_s);
    Some((2.0 * last_s).min(*KEY_FRAME_TIME_S.end())).filter(|period_s| *period_s > last_s)
}

/// The radius and the speed of an orbit, the highest speed of key frames, or the length and the duration of a round trip.
fn track_summary(obstacle: &Obstacle) -> Option<String> {
    let speed_m_s = obstacle.origin_speed_m_s();
    match obstacle.track() {
        Track::Circle { centre_m } => {
            let radius_m = format_metres(obstacle.position_m.distance(centre_m));
            Some(format!("Radius {radius_m} m, {} m/s", format_metres(speed_m_s)))
        }
        Track::Lines { .. } if obstacle.motion.kind() == MotionKind::KeyFrames => {
            Some(format!("At most {} m/s", format_metres(speed_m_s)))
        }
        Track::Lines { .. } if obstacle.motion.is_pedestrian() => None,
        Track::Lines { corners_m, closed } => Some(round_trip(&corners_m, closed, speed_m_s)),
        Track::Point | Track::Disc { .. } => None,
    }
}

/// Length and duration of a round trip along a path.
fn round_trip(corners: &[Vec2], closed: bool, speed_m_s: f32) -> String {
    let there_m: f32 = corners.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
    let back_m = match (closed, corners.first(), corners.last()) {
        (true, Some(&first), Some(&last)) => last.distance(first),
        _ => there_m,
    };
    let length_m = there_m + back_m;
    if speed_m_s > 0.0 {
        format!("Round trip: {} m, {:.0} s", format_metres(length_m), length_m / speed_m_s)
    } else {
        format!("Round trip: {} m", format_metres(length_m))
    }
}

/// Shows the fields of a wall.
pub fn wall_ui(ui: &mut Ui, editor: &mut Editor, index: usize) {
    let Some(mut wall) = editor.scenario().walls.get(index).cloned() else { return };
    let mut rows = FieldRows::new(ui);
    if let Some(cells) = &mut wall.cells {
        cell_rows(&mut rows, cells);
    } else {
        rows.number("Thickness", "", &mut wall.thickness_m, NumberSpec::length(WALL_THICKNESS_M));
        rows.positions("Corner", &mut wall.corners_m, *WALL_CORNERS.start());
    }
    rows.commit(editor, &format!("wall {index}"), |scenario| {
        if let Some(old) = scenario.walls.get_mut(index) {
            *old = wall;
        }
    });
}

/// Adds rows for the cells of a wall: their size, the centre of their grid, and their text.
fn cell_rows(rows: &mut FieldRows<'_>, cells: &mut WallCells) {
    let (mut cell_m, mut centre_m, mut text) = (cells.cell_m(), cells.centre_m(), cells.rows().join("\n"));
    rows.number("Cell", "Side of a cell", &mut cell_m, NumberSpec::length(WALL_CELL_M));
    rows.position("Centre", "Centre of the grid", &mut centre_m);
    if text.len() > MAX_SHOWN_BYTES {
        rows.ui.label(weak_text(&format!("{} rows of cells: edit them in the file", cells.rows().len())));
    } else {
        rows.text("Cells", "# is solid, . is free", &mut text);
    }
    *cells = WallCells::new(text.split('\n').map(String::from).collect(), cell_m, centre_m);
}

#[cfg(test)]
mod tests {
    use bevy::math::vec2;

    use super::*;

    #[test]
    fn a_round_trip_goes_to_the_end_and_back() {
        let corners = [Vec2::ZERO, vec2(3.0, 0.0), vec2(3.0, 4.0)];
        assert_eq!(round_trip(&corners, true, 0.5), "Round trip: 12.00 m, 24 s");
        assert_eq!(round_trip(&corners, false, 0.5), "Round trip: 14.00 m, 28 s");
        assert_eq!(round_trip(&corners, false, 0.0), "Round trip: 14.00 m");
    }

    #[test]
    fn the_period_of_key_frames_is_later_than_the_last_frame() {
        let period_s = |time_s| new_period_s(&[KeyFrame { time_s, position_m: Vec2::ZERO }]);
        assert_eq!((period_s(20.0), period_s(60_000.0)), (Some(40.0), Some(100_000.0)));
        assert_eq!(period_s(100_000.0), None);
    }
}
