//! Starts, goals and what is drawn anew for each episode: regions, places, and the ends of the benchmark route.
//!
//! In: the rules of a scenario. Out: shaded regions and marks on a [`Canvas`]; starts in the robot's colour, goals in
//! the goal's.

use bevy::math;
use egui::{Align2, Color32, Pos2, Rect, Shape, Stroke, StrokeKind, Vec2, vec2};

use crate::app::editor::{Editor, Selection};
use crate::app::screen::arena_view::arena;
use crate::app::screen::arena_view::canvas::Canvas;
use crate::app::screen::arena_view::transform::screen_direction;
use crate::scenario::{PlacementRule, Region, Scenario};
use crate::task::Pose;

/// How much room a name takes below a mark, or above it, in points.
const NAME: f32 = 14.0;
/// Of more places than these not each has its name beside it.
const NAMED: usize = 6;

/// The rectangles of the rules and of the generators.
pub fn draw_regions(canvas: &Canvas, editor: &Editor) {
    let (scenario, palette) = (editor.scenario(), &canvas.palette);
    for (k, generator) in scenario.generators.iter().enumerate() {
        if let Some(region) = generator.within {
            let ink = own_color(canvas, editor, Selection::Generator(k), palette.weak_text);
            shade(canvas, region, ink, 0.07, &format!("{} drawn anew", generator.count));
        }
    }
    for (rule, selection, ink, words) in [
        (&scenario.starts, Selection::Starts, palette.accent, "Starts"),
        (&scenario.goals, Selection::Goals, palette.success, "Goals"),
    ] {
        if let Some(region) = region_of(rule) {
            shade(canvas, region, own_color(canvas, editor, selection, ink), 0.13, words);
        }
    }
}

/// The colour of something, or that of what is wrong.
fn own_color(canvas: &Canvas, editor: &Editor, selection: Selection, ink: Color32) -> Color32 {
    if editor.has_error(selection) { canvas.palette.error } else { ink }
}

fn region_of(rule: &PlacementRule) -> Option<Region> {
    match *rule {
        PlacementRule::Within { min_m, max_m, .. } => Some(Region { min_m, max_m }),
        _ => None,
    }
}

fn shade(canvas: &Canvas, region: Region, ink: Color32, strength: f32, words: &str) {
    let rect = canvas.transform.to_screen_rect(region.min_m.into(), region.max_m.into());
    if !rect.is_finite() {
        return;
    }
    canvas.painter.rect_filled(rect, 0.0, ink.gamma_multiply(strength));
    let corners =
        [rect.left_top(), rect.right_top(), rect.right_bottom(), rect.left_bottom(), rect.left_top()];
    canvas.painter.extend(Shape::dashed_line(&corners, Stroke::new(1.25, ink), 5.0, 4.0));
    // Over the region where it has no room within.
    let (at, anchor) = if rect.width() > 84.0 && rect.height() > 34.0 {
        (rect.left_top() + vec2(4.0, 3.0), Align2::LEFT_TOP)
    } else {
        (rect.left_top() - vec2(0.0, 2.0), Align2::LEFT_BOTTOM)
    };
    if canvas.painter.clip_rect().intersects(rect) {
        canvas.label(at, anchor, words, ink);
    }
}

/// The places of the rules, and the ends of the benchmark route.
pub fn draw_places(canvas: &Canvas, editor: &Editor) {
    let (scenario, palette) = (&**editor.scenario(), &canvas.palette);
    let benchmark_route = &scenario.benchmark_route;
    let goal = own_color(canvas, editor, Selection::BenchmarkGoal, palette.success);
    let start = own_color(canvas, editor, Selection::BenchmarkStart, palette.accent);
    arena::draw_goal(canvas, scenario, benchmark_route.goal_m.into());
    if goal == palette.error {
        draw_highlight(canvas, scenario, Selection::BenchmarkGoal, Stroke::new(2.0, goal));
    }
    let math::Vec2 { x: x_m, y: y_m } = benchmark_route.start_m;
    arena::draw_robot(canvas, scenario, Pose { x_m, y_m, heading_rad: benchmark_route.heading_rad }, start);
    name(
        canvas,
        benchmark_route.goal_m,
        reach(canvas, scenario, Selection::BenchmarkGoal),
        "Course goal",
        goal,
    );
    // The name is where the start doesn't look: there is the handle that turns it.
    let radius = reach(canvas, scenario, Selection::BenchmarkStart);
    let over = benchmark_route.heading_rad.sin() < 0.0;
    name(canvas, benchmark_route.start_m, if over { -radius } else { radius }, "Benchmark start", start);
    for (rule, selection, own, words) in [
        (&scenario.goals, Selection::Goals, palette.success, "Target"),
        (&scenario.starts, Selection::Starts, palette.accent, "Start"),
    ] {
        let all = places_of(rule);
        for (k, &place) in all.iter().enumerate() {
            let ink = if has_error(editor, selection, k) { palette.error } else { own };
            let (at, radius) = (canvas.to_screen(place.into()), reach(canvas, scenario, selection));
            canvas.painter.circle(at, radius, ink.gamma_multiply(0.14), Stroke::new(1.75, ink));
            match rule {
                PlacementRule::Fixed { heading_rad: Some(heading), .. } if selection == Selection::Starts => {
                    pointing(canvas, at, radius, *heading, ink);
                }
                _ => {
                    canvas.painter.circle_filled(at, 2.5, ink);
                }
            }
            if all.len() <= NAMED {
                name(canvas, place, radius, words, ink);
            }
        }
    }
}

/// Whether something is wrong with a rule's place `k`, or with the rule as a whole.
fn has_error(editor: &Editor, selection: Selection, k: usize) -> bool {
    let mut about =
        editor.diagnostics().iter().filter(|finding| Selection::from_field_path(&finding.path) == selection);
    about.any(|finding| {
        let place = finding.path.split("positions_m[").nth(1).and_then(|rest| rest.split(']').next());
        place.is_none_or(|place| place == k.to_string())
    })
}

fn places_of(rule: &PlacementRule) -> &[math::Vec2] {
    match rule {
        PlacementRule::Fixed { position_m, .. } => std::slice::from_ref(position_m),
        PlacementRule::OneOf { positions_m } => positions_m,
        PlacementRule::Random { .. } | PlacementRule::Within { .. } => &[],
    }
}

/// An arrow from the middle to the rim.
fn pointing(canvas: &Canvas, at: Pos2, radius: f32, heading_rad: f32, ink: Color32) {
    let along = screen_direction(heading_rad);
    let tip = at + along * (radius - 2.0).max(6.0);
    canvas.painter.line_segment([at - along * radius * 0.5, tip - along * 4.0], Stroke::new(1.75, ink));
    canvas.arrow_head(tip, along, 6.0, ink);
}

/// How large a mark is on the screen, in points.
fn reach(canvas: &Canvas, scenario: &Scenario, selection: Selection) -> f32 {
    let radius_m = match selection {
        Selection::Starts => scenario.robot.radius_m,
        Selection::BenchmarkStart => scenario.task.collision_range_m.max(scenario.robot.radius_m),
        _ => scenario.task.goal_radius_m,
    };
    canvas.transform.to_screen_length(radius_m).max(6.0)
}

/// A name below a mark of this radius, or above it if that is negative.
fn name(canvas: &Canvas, position_m: math::Vec2, radius: f32, words: &str, ink: Color32) {
    let at = canvas.to_screen(position_m.into());
    let anchor = if radius < 0.0 { Align2::CENTER_BOTTOM } else { Align2::CENTER_TOP };
    if canvas.painter.clip_rect().expand(radius.abs()).contains(at) {
        canvas.label(at + vec2(0.0, radius + 5.0 * radius.signum()), anchor, words, ink);
    }
}

/// Draws around a rule's region or places, or an end of the benchmark route.
pub fn draw_highlight(canvas: &Canvas, scenario: &Scenario, selection: Selection, stroke: Stroke) {
    let frame = |region: Region| {
        let rect = canvas.transform.to_screen_rect(region.min_m.into(), region.max_m.into());
        canvas.painter.rect_stroke(rect, 0.0, stroke, StrokeKind::Middle);
    };
    let radius = reach(canvas, scenario, selection) + 4.0;
    let around = |place: math::Vec2| {
        canvas.painter.circle_stroke(canvas.to_screen(place.into()), radius, stroke);
    };
    match selection {
        Selection::Generator(k) => {
            if let Some(region) = scenario.generators.get(k).and_then(|generator| generator.within) {
                frame(region);
            }
        }
        Selection::Starts | Selection::Goals => {
            let rule = if selection == Selection::Starts { &scenario.starts } else { &scenario.goals };
            region_of(rule).into_iter().for_each(frame);
            places_of(rule).iter().copied().for_each(around);
        }
        Selection::BenchmarkStart => around(scenario.benchmark_route.start_m),
        Selection::BenchmarkGoal => around(scenario.benchmark_route.goal_m),
        _ => {}
    }
}

/// The box around what is drawn of it, with its name, on the screen.
pub fn screen_rect(canvas: &Canvas, scenario: &Scenario, selection: Selection) -> Option<Rect> {
    let side = 2.0 * reach(canvas, scenario, selection);
    let around = |place: math::Vec2| {
        Rect::from_center_size(canvas.to_screen(place.into()), Vec2::splat(side)).expand2(vec2(0.0, NAME))
    };
    let rule = match selection {
        Selection::BenchmarkStart => return Some(around(scenario.benchmark_route.start_m)),
        Selection::BenchmarkGoal => return Some(around(scenario.benchmark_route.goal_m)),
        Selection::Starts => &scenario.starts,
        Selection::Goals => &scenario.goals,
        _ => return None,
    };
    match region_of(rule) {
        Some(region) => Some(canvas.transform.to_screen_rect(region.min_m.into(), region.max_m.into())),
        None => places_of(rule).first().copied().map(around),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scenario::{Obstacle, ObstacleMotion, Shape};

    #[test]
    fn only_the_place_that_is_wrong_is_shown_so() {
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
        let wrong = |k| has_error(&editor, Selection::Goals, k);
        assert_eq!([wrong(0), wrong(1)], [false, true], "{:?}", editor.diagnostics());
        assert!(!has_error(&editor, Selection::Starts, 0));
    }
}
