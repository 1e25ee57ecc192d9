//! The fields of an obstacle and of a wall.

use bevy::math::Vec2;
use egui::Ui;

use super::controls::{button_row_ui, choice_ui};
use super::fields::FieldRows;
use super::number::NumberSpec;
use crate::app::editor::{Editor, MotionKind, Tool, format_metres};
use crate::app::screen::widgets::text::weak_text;
use crate::scenario::{Obstacle, ObstacleMotion, Shape};

/// A size of an obstacle.
pub const SIZE: NumberSpec = NumberSpec::length(0.001, 1000.0);

const MOTIONS: [(MotionKind, &str, &str); 5] = [
    (MotionKind::Static, "Static", "Does not move"),
    (MotionKind::Orbit, "Orbit", "Around a point, rotating with it"),
    (MotionKind::Patrol, "Patrol", "Along a closed path"),
    (MotionKind::BackAndForth, "Back and forth", "Along a path and back"),
    (MotionKind::RandomWalk, "Random walk", "Between random points near its position"),
];

/// Shows the fields of an obstacle.
pub fn obstacle_ui(ui: &mut Ui, editor: &mut Editor, index: usize) {
    let Some(mut obstacle) = editor.scenario().obstacles.get(index).cloned() else { return };
    let mut rows = FieldRows::new(ui);
    rows.position("Position", "Centre at the start of an episode", &mut obstacle.position_m);
    shape_rows(&mut rows, &mut obstacle.shape);
    if !matches!(obstacle.shape, Shape::Circle { .. }) {
        rows.number("Rotation", "Counterclockwise", &mut obstacle.rotation_rad, NumberSpec::ANGLE);
    }
    let kind = choice_ui(rows.ui, "Motion", MotionKind::from_motion(&obstacle.motion), &MOTIONS);
    motion_rows(&mut rows, &mut obstacle);
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

/// The button that begins and finishes drawing the path.
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

fn shape_rows(rows: &mut FieldRows<'_>, shape: &mut Shape) {
    match shape {
        Shape::Circle { radius_m } => rows.number("Radius", "", radius_m, SIZE),
        Shape::Rectangle { width_m, height_m } => {
            rows.pair("Size", "Before rotation", [("width", width_m), ("height", height_m)], SIZE);
        }
        Shape::Capsule { length_m, radius_m } => {
            rows.number("Length", "Between the centres of the round ends", length_m, SIZE);
            rows.number("Radius", "Half the width", radius_m, SIZE);
        }
        Shape::Polygon { corners_m } => rows.positions("Corner", corners_m, 3),
    }
}

fn motion_rows(rows: &mut FieldRows<'_>, obstacle: &mut Obstacle) {
    let path = obstacle.path_m();
    let position = obstacle.position_m;
    match &mut obstacle.motion {
        ObstacleMotion::Static => {}
        ObstacleMotion::Orbit { centre_m, speed_rad_s } => {
            rows.position("Centre", "Centre of the orbit", centre_m);
            rows.number("Speed", "Counterclockwise", speed_rad_s, NumberSpec::ANGULAR_VELOCITY);
            let radius_m = position.distance(*centre_m);
            let (radius, speed) = (format_metres(radius_m), format_metres((radius_m * *speed_rad_s).abs()));
            rows.ui.label(weak_text(&format!("Radius {radius} m, {speed} m/s")));
        }
        ObstacleMotion::Patrol { waypoints_m, speed_m_s }
        | ObstacleMotion::BackAndForth { waypoints_m, speed_m_s } => {
            rows.number("Speed", "Along the path", speed_m_s, NumberSpec::SPEED);
            rows.positions("Point", waypoints_m, 1);
            if let Some((corners, closed)) = path {
                rows.ui.label(weak_text(&round_trip(&corners, closed, *speed_m_s)));
            }
        }
        ObstacleMotion::RandomWalk { radius_m, speed_m_s, seed } => {
            let reach = NumberSpec::length(0.01, 500.0);
            rows.number("Walk radius", "Largest distance from its position", radius_m, reach);
            rows.number("Speed", "Largest speed", speed_m_s, NumberSpec::SPEED);
            rows.count("Seed", "Obstacles with the same seed walk alike", seed, 0..=u32::MAX);
        }
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
    rows.number("Thickness", "", &mut wall.thickness_m, NumberSpec::length(0.01, 100.0));
    rows.positions("Corner", &mut wall.corners_m, 2);
    rows.commit(editor, &format!("wall {index}"), |scenario| {
        if let Some(old) = scenario.walls.get_mut(index) {
            *old = wall;
        }
    });
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
}
