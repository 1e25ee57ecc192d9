//! The inspector: the numbers of what is selected.
//!
//! In: the editor. Out: its changes.

use bevy::math::{Vec2, vec2};
use egui::{Align, Layout, Ui};

use super::fields::{FieldRows, NumberSpec, button_row_ui, choice_ui};
use super::scenario_panel;
use crate::app::editor::{Editor, MotionKind, PlacementRole, Selection, Tool, format_metres};
use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::text::{section_title_ui, weak_text};
use crate::scenario::{Generator, Obstacle, ObstacleMotion, RandomShape, Region, Shape};

/// What a size may be.
const SIZE: NumberSpec = NumberSpec::format_metres(0.001, 1000.0);

const MOTIONS: [(MotionKind, &str, &str); 5] = [
    (MotionKind::Static, "Static", "It stays where it is"),
    (MotionKind::Orbit, "Orbit", "Around a point, turning with the revolution"),
    (MotionKind::Patrol, "Patrol", "Along a closed path, forever"),
    (MotionKind::BackAndForth, "Back and forth", "Along a path to its end and back"),
    (MotionKind::RandomWalk, "Random walk", "From one random point near its place to the next"),
];

/// What it is called, among how many.
fn name(editor: &Editor) -> String {
    let scenario = editor.scenario();
    let of = |word: &str, k: usize, count: usize| format!("{word} {} of {count}", k + 1);
    match editor.selection() {
        Selection::Nothing => "World".into(),
        Selection::Enclosure => "Enclosure".into(),
        Selection::Obstacle(k) => of("Obstacle", k, scenario.obstacles.len()),
        Selection::Wall(k) => of("Wall", k, scenario.walls.len()),
        Selection::Generator(k) => of("Random obstacles", k, scenario.generators.len()),
        Selection::Starts => "Starts".into(),
        Selection::Goals => "Goals".into(),
        Selection::BenchmarkStart => "Benchmark route: start".into(),
        Selection::BenchmarkGoal => "Benchmark route: goal".into(),
    }
}

/// Draws it.
pub fn inspector_ui(ui: &mut Ui, editor: &mut Editor) {
    let selection = editor.selection();
    ui.horizontal(|ui| {
        section_title_ui(ui, &name(editor));
        if selection != Selection::Nothing {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let tip = "Back to the world's own numbers";
                if icons::icon_button_ui(ui, Icon::Close, ButtonStyle::Quiet, 18.0, "Select nothing", tip)
                    .clicked()
                {
                    editor.select(Selection::Nothing);
                }
            });
        }
    });
    if editor.can_copy() {
        let all = [
            ("Duplicate", "Another one like it  (Ctrl+D)", true),
            ("Delete", "Takes it away  (Delete)", true),
        ];
        match button_row_ui(ui, &all) {
            Some(0) => return editor.duplicate(),
            Some(_) => return editor.delete(),
            None => {}
        }
    }
    // Each thing has fields of its own: what is being written in one must not end up in another.
    ui.push_id(format!("{selection:?}"), |ui| match selection {
        Selection::Nothing => scenario_panel::scenario_ui(ui, editor),
        Selection::Enclosure => scenario_panel::enclosure_ui(ui, editor),
        Selection::Obstacle(k) => obstacle_ui(ui, editor, k),
        Selection::Wall(k) => wall_ui(ui, editor, k),
        Selection::Generator(k) => generator_ui(ui, editor, k),
        Selection::Starts => scenario_panel::place_rule_ui(ui, editor, PlacementRole::Starts),
        Selection::Goals => scenario_panel::place_rule_ui(ui, editor, PlacementRole::Goals),
        Selection::BenchmarkStart => scenario_panel::benchmark_start_ui(ui, editor),
        Selection::BenchmarkGoal => scenario_panel::benchmark_goal_ui(ui, editor),
    });
}

fn obstacle_ui(ui: &mut Ui, editor: &mut Editor, k: usize) {
    let Some(mut obstacle) = editor.scenario().obstacles.get(k).cloned() else { return };
    let mut rows = FieldRows::new(ui);
    rows.position("Position", "Where its middle is at first", &mut obstacle.position_m);
    shape(&mut rows, &mut obstacle.shape);
    if !matches!(obstacle.shape, Shape::Circle { .. }) {
        rows.number("Turned", "Counterclockwise", &mut obstacle.rotation_rad, NumberSpec::ANGLE);
    }
    let kind = choice_ui(rows.ui, "Motion", MotionKind::from_motion(&obstacle.motion), &MOTIONS);
    motion(&mut rows, &mut obstacle);
    let (still, has_path) = (obstacle.motion == ObstacleMotion::Static, obstacle.path_m().is_some());
    rows.commit(editor, &format!("obstacle {k}"), |scenario| {
        if let Some(there) = scenario.obstacles.get_mut(k) {
            *there = obstacle;
        }
    });
    if still || has_path {
        let drawing = matches!(editor.tool(), Tool::Path { .. });
        let text = match (drawing, has_path) {
            (true, _) => "Path is done",
            (false, true) => "Draw its path anew",
            (false, false) => "Draw its path",
        };
        if button_row_ui(ui, &[(text, "Click the path in the world, corner by corner", true)]) == Some(0) {
            if drawing {
                editor.finish_tool();
            } else {
                editor.set_tool(Tool::Path { waypoints_m: Vec::new() });
            }
        }
    }
    if let Some(kind) = kind {
        editor.set_motion(kind);
    }
}

fn shape(rows: &mut FieldRows<'_>, shape: &mut Shape) {
    match shape {
        Shape::Circle { radius_m } => rows.number("Radius", "From the middle to the rim", radius_m, SIZE),
        Shape::Rectangle { width_m, height_m } => {
            rows.pair("Size", "Along its own x and y", [("width", width_m), ("height", height_m)], SIZE);
        }
        Shape::Capsule { length_m, radius_m } => {
            let tip = "From the middle of one round end to that of the other";
            rows.number("Length", tip, length_m, SIZE);
            rows.number("Radius", "Half its width, and of its ends", radius_m, SIZE);
        }
        Shape::Polygon { corners_m } => rows.positions("Corner", corners_m, 3),
    }
}

fn motion(rows: &mut FieldRows<'_>, obstacle: &mut Obstacle) {
    let path = obstacle.path_m();
    let position = obstacle.position_m;
    match &mut obstacle.motion {
        ObstacleMotion::Static => {}
        ObstacleMotion::Orbit { centre_m, speed_rad_s } => {
            rows.position("Centre", "What it revolves about", centre_m);
            rows.number("Speed", "Counterclockwise", speed_rad_s, NumberSpec::ANGULAR_VELOCITY);
            let arm_m = (position.x - centre_m.x).hypot(position.y - centre_m.y);
            let speed_m_s = (arm_m * *speed_rad_s).abs();
            rows.ui.label(weak_text(&format!(
                "{} m away: {} m/s",
                format_metres(arm_m),
                format_metres(speed_m_s)
            )));
        }
        ObstacleMotion::Patrol { waypoints_m, speed_m_s }
        | ObstacleMotion::BackAndForth { waypoints_m, speed_m_s } => {
            rows.number("Speed", "Along the path", speed_m_s, NumberSpec::SPEED);
            rows.positions("Point", waypoints_m, 1);
            if let Some((corners, closed)) = path {
                rows.ui.label(weak_text(&round(&corners, closed, *speed_m_s)));
            }
        }
        ObstacleMotion::RandomWalk { radius_m, speed_m_s, seed } => {
            rows.number(
                "Reach",
                "How far it strays at most",
                radius_m,
                NumberSpec::format_metres(0.01, 500.0),
            );
            rows.number("Speed", "The fastest it ever is", speed_m_s, NumberSpec::SPEED);
            rows.count("Walk", "The same number is the same walk", seed, 0..=u32::MAX);
        }
    }
}

/// How long a round takes.
fn round(corners: &[Vec2], closed: bool, speed_m_s: f32) -> String {
    let leg = |a: Vec2, b: Vec2| (a.x - b.x).hypot(a.y - b.y);
    let there: f32 = corners.windows(2).map(|ends| leg(ends[0], ends[1])).sum();
    let back = match (closed, corners.first(), corners.last()) {
        (true, Some(&first), Some(&last)) => leg(last, first),
        _ => there,
    };
    let round_m = there + back;
    if speed_m_s > 0.0 {
        format!("{} m there and back in {:.0} s", format_metres(round_m), round_m / speed_m_s)
    } else {
        format!("{} m there and back", format_metres(round_m))
    }
}

fn wall_ui(ui: &mut Ui, editor: &mut Editor, k: usize) {
    let Some(mut wall) = editor.scenario().walls.get(k).cloned() else { return };
    let mut rows = FieldRows::new(ui);
    rows.number("Thickness", "Across", &mut wall.thickness_m, NumberSpec::format_metres(0.01, 100.0));
    rows.positions("Corner", &mut wall.corners_m, 2);
    rows.commit(editor, &format!("wall {k}"), |scenario| {
        if let Some(there) = scenario.walls.get_mut(k) {
            *there = wall;
        }
    });
}

fn generator_ui(ui: &mut Ui, editor: &mut Editor, k: usize) {
    let Some(mut generator) = editor.scenario().generators.get(k).cloned() else { return };
    ui.label(weak_text(
        "Drawn anew for every episode, so that a policy learns to cope with what it hasn't seen.",
    ));
    let mut rows = FieldRows::new(ui);
    rows.count("How many", "Fewer where there is no room", &mut generator.count, 1..=200);
    random_shape(&mut rows, &mut generator);
    let tip =
        "The least to walls and to each other: more than twice the collision range, for the robot to fit";
    rows.number("Gap", tip, &mut generator.gap_m, NumberSpec::format_metres(0.0, 1000.0));
    let mut given = generator.within.is_some();
    rows.checkbox("Only in a region", "Or else anywhere", &mut given);
    match (given, &mut generator.within) {
        (true, Some(region)) => scenario_panel::region_rows(&mut rows, &mut region.min_m, &mut region.max_m),
        (true, none) => {
            *none = Some(middle_half(editor.scenario().enclosure.bounds_m()));
        }
        (false, some) => *some = None,
    }
    rows.commit(editor, &format!("generator {k}"), |scenario| {
        if let Some(there) = scenario.generators.get_mut(k) {
            *there = generator;
        }
    });
}

/// The region of half the width and half the height in the middle of a box, to the millimetre.
fn middle_half((low, high): (Vec2, Vec2)) -> Region {
    let between = |a: f32, b: f32| ((a + (b - a) / 4.0) * 1000.0).round() / 1000.0;
    Region {
        min_m: vec2(between(low.x, high.x), between(low.y, high.y)),
        max_m: vec2(between(high.x, low.x), between(high.y, low.y)),
    }
}

fn random_shape(rows: &mut FieldRows<'_>, generator: &mut Generator) {
    let boxes = matches!(generator.shape, RandomShape::Rectangle { .. });
    let kinds = [(false, "Circles", "Cylinders seen from above"), (true, "Boxes", "Turned by any angle")];
    if let Some(boxes) = choice_ui(rows.ui, "Shape", boxes, &kinds) {
        generator.shape = match (boxes, &generator.shape) {
            (true, RandomShape::Circle { radius_m: (low, high) }) => {
                let sizes = (2.0 * low, 2.0 * high);
                RandomShape::Rectangle { width_m: sizes, height_m: sizes }
            }
            (false, RandomShape::Rectangle { width_m: (low, high), .. }) => {
                RandomShape::Circle { radius_m: (low / 2.0, high / 2.0) }
            }
            (_, same) => same.clone(),
        };
        rows.mark_changed("shape");
    }
    let mut range = |name: &str, (low, high): &mut (f32, f32)| {
        rows.pair(name, "From the smallest to the largest", [("least", low), ("most", high)], SIZE);
    };
    match &mut generator.shape {
        RandomShape::Circle { radius_m } => range("Radius", radius_m),
        RandomShape::Rectangle { width_m, height_m } => {
            range("Width", width_m);
            range("Height", height_m);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_half_is_about_the_middle() {
        let region = middle_half((vec2(10.0, 0.0), vec2(16.0, 6.0)));
        assert_eq!((region.min_m, region.max_m), (vec2(11.5, 1.5), vec2(14.5, 4.5)));
    }

    #[test]
    fn a_round_is_there_and_back() {
        let corners = [vec2(0.0, 0.0), vec2(3.0, 0.0), vec2(3.0, 4.0)];
        assert_eq!(round(&corners, true, 0.5), "12.00 m there and back in 24 s");
        assert_eq!(round(&corners, false, 0.5), "14.00 m there and back in 28 s");
        assert_eq!(round(&corners, false, 0.0), "14.00 m there and back");
    }
}
