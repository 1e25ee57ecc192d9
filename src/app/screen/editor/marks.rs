//! Starts, goals and regions on the canvas: starts in the robot's colour, goals in the goal's colour, those with a problem in
//! the error colour.

use bevy::math;
use egui::{Align2, Color32, Pos2, Stroke, vec2};

use super::outlines::{self, mark_radius};
use crate::app::editor::{Body, Editor, PlacementRole, Selection};
use crate::app::screen::arena_view::arena;
use crate::app::screen::arena_view::canvas::Canvas;
use crate::app::screen::arena_view::transform::screen_direction;
use crate::scenario::{BenchmarkRoute, PlacementRule, Region, Scenario};
use crate::task::Pose;

/// A rule with more positions than this is drawn without their names.
const MAX_NAMED: usize = 6;

/// Draws the regions of the rules and the generators.
pub fn draw_regions(canvas: &Canvas, editor: &Editor) {
    for (k, generator) in editor.scenario().generators.iter().enumerate() {
        let selection = Selection::Generator(k);
        let label = format!("{} random", generator.count);
        draw_region(canvas, editor, selection, canvas.palette.weak_text, 0.07, &label);
    }
    for role in [PlacementRole::Starts, PlacementRole::Goals] {
        let color = role_color(canvas, role);
        draw_region(canvas, editor, role.selection(), color, 0.13, role.title());
    }
}

fn role_color(canvas: &Canvas, role: PlacementRole) -> Color32 {
    match role {
        PlacementRole::Starts => canvas.palette.accent,
        PlacementRole::Goals => canvas.palette.success,
    }
}

/// `color`, or the error colour if the item has a problem.
fn color_or_error(canvas: &Canvas, editor: &Editor, selection: Selection, color: Color32) -> Color32 {
    if editor.has_error(selection) { canvas.palette.error } else { color }
}

fn draw_region(
    canvas: &Canvas,
    editor: &Editor,
    selection: Selection,
    color: Color32,
    strength: f32,
    label: &str,
) {
    if let Body::Region(region) = selection.body(editor.scenario()) {
        shade(canvas, region, color_or_error(canvas, editor, selection, color), strength, label);
    }
}

/// Fills a region, with a dashed outline and a label inside or, where that does not fit, above it.
fn shade(canvas: &Canvas, region: Region, color: Color32, strength: f32, label: &str) {
    let rect = canvas.transform.to_screen_rect(region.min_m.into(), region.max_m.into());
    if !rect.is_finite() {
        return;
    }
    canvas.painter.rect_filled(rect, 0.0, color.gamma_multiply(strength));
    let corners =
        [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom(), rect.left_top()];
    canvas.dashed_line(&corners, Stroke::new(1.25, color), (5.0, 4.0));
    let (at, anchor) = if rect.width() > 84.0 && rect.height() > 34.0 {
        (rect.left_top() + vec2(4.0, 3.0), Align2::LEFT_TOP)
    } else {
        (rect.left_top() - vec2(0.0, 2.0), Align2::LEFT_BOTTOM)
    };
    if canvas.painter.clip_rect().intersects(rect) {
        canvas.label(at, anchor, label, color);
    }
}

/// Draws the ends of the benchmark route, and the positions that the rules for starts and goals list.
pub fn draw_starts_and_goals(canvas: &Canvas, editor: &Editor) {
    if let Some(route) = editor.scenario().benchmark_route {
        draw_benchmark_goal(canvas, editor, route);
        draw_benchmark_start(canvas, editor, route);
    }
    draw_rule(canvas, editor, PlacementRole::Goals, "Goal");
    draw_rule(canvas, editor, PlacementRole::Starts, "Start");
}

fn draw_benchmark_goal(canvas: &Canvas, editor: &Editor, BenchmarkRoute { goal_m, .. }: BenchmarkRoute) {
    let (scenario, palette) = (&**editor.scenario(), &canvas.palette);
    let color = color_or_error(canvas, editor, Selection::BenchmarkGoal, palette.success);
    arena::draw_goal(canvas, scenario, goal_m.into());
    if color == palette.error {
        outlines::draw_outline(canvas, scenario, Selection::BenchmarkGoal, Stroke::new(2.0, color));
    }
    draw_name(canvas, goal_m, radius(canvas, scenario, Selection::BenchmarkGoal), "Benchmark goal", color);
}

fn draw_benchmark_start(canvas: &Canvas, editor: &Editor, route: BenchmarkRoute) {
    let scenario = &**editor.scenario();
    let color = color_or_error(canvas, editor, Selection::BenchmarkStart, canvas.palette.accent);
    let math::Vec2 { x: x_m, y: y_m } = route.start_m;
    arena::draw_robot(canvas, scenario, Pose { x_m, y_m, heading_rad: route.heading_rad }, color);
    // The name is on the side opposite to the heading, away from the rotation handle.
    let radius = radius(canvas, scenario, Selection::BenchmarkStart);
    let above = route.heading_rad.sin() < 0.0;
    draw_name(canvas, route.start_m, if above { -radius } else { radius }, "Benchmark start", color);
}

fn draw_rule(canvas: &Canvas, editor: &Editor, role: PlacementRole, label: &str) {
    let (scenario, selection) = (&**editor.scenario(), role.selection());
    let Body::Marks { positions_m, radius_m } = selection.body(scenario) else { return };
    let radius = mark_radius(canvas, radius_m);
    let heading_rad = match role.of(scenario) {
        PlacementRule::Fixed { heading_rad, .. } if role == PlacementRole::Starts => *heading_rad,
        _ => None,
    };
    for (k, &position_m) in positions_m.iter().enumerate() {
        let error = position_has_error(editor, selection, k);
        let color = if error { canvas.palette.error } else { role_color(canvas, role) };
        let at = canvas.to_screen(position_m.into());
        canvas.painter.circle(at, radius, color.gamma_multiply(0.14), Stroke::new(1.75, color));
        match heading_rad {
            Some(heading) => draw_heading(canvas, at, radius, heading, color),
            None => drop(canvas.painter.circle_filled(at, 2.5, color)),
        }
        if positions_m.len() <= MAX_NAMED {
            draw_name(canvas, position_m, radius, label, color);
        }
    }
}

/// Whether position `k` of a rule, or the rule as a whole, has a problem.
fn position_has_error(editor: &Editor, selection: Selection, k: usize) -> bool {
    let mut problems =
        editor.diagnostics().iter().filter(|problem| Selection::from_field_path(&problem.path) == selection);
    problems.any(|problem| {
        let index = problem.path.split("positions_m[").nth(1).and_then(|rest| rest.split(']').next());
        index.is_none_or(|index| index == k.to_string())
    })
}

/// Draws an arrow in the direction of the heading.
fn draw_heading(canvas: &Canvas, at: Pos2, radius: f32, heading_rad: f32, color: Color32) {
    let along = screen_direction(heading_rad);
    let tip = at + along * (radius - 2.0).max(6.0);
    canvas.painter.line_segment([at - along * radius * 0.5, tip - along * 4.0], Stroke::new(1.75, color));
    canvas.arrow_head(tip, along, 6.0, color);
}

/// Radius of the marks of an item on the screen, in points.
fn radius(canvas: &Canvas, scenario: &Scenario, selection: Selection) -> f32 {
    match selection.body(scenario) {
        Body::Marks { radius_m, .. } => mark_radius(canvas, radius_m),
        _ => mark_radius(canvas, 0.0),
    }
}

/// Draws a name below a mark of this radius, or above it if the radius is negative.
fn draw_name(canvas: &Canvas, position_m: math::Vec2, radius: f32, name: &str, color: Color32) {
    let at = canvas.to_screen(position_m.into());
    let anchor = if radius < 0.0 { Align2::CENTER_BOTTOM } else { Align2::CENTER_TOP };
    if canvas.painter.clip_rect().expand(radius.abs()).contains(at) {
        canvas.label(at + vec2(0.0, radius + 5.0 * radius.signum()), anchor, name, color);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scenario::{Obstacle, ObstacleMotion, Shape};

    #[test]
    fn only_the_position_with_the_problem_is_marked() {
        let block = Obstacle {
            shape: Shape::Circle { radius_m: 0.3 },
            position_m: math::vec2(-1.0, -1.0),
            rotation_rad: 0.0,
            motion: ObstacleMotion::Static,
        };
        let scenario = Scenario {
            obstacles: vec![block],
            goals: PlacementRule::OneOf { positions_m: vec![math::vec2(1.0, 1.0), math::vec2(-1.0, -1.0)] },
            ..Scenario::default()
        };
        let editor = Editor::open(Arc::new(scenario), "mine.ron".into(), true);
        let has_error = |k| position_has_error(&editor, Selection::Goals, k);
        assert_eq!([has_error(0), has_error(1)], [false, true], "{:?}", editor.diagnostics());
        assert!(!position_has_error(&editor, Selection::Starts, 0));
    }
}
