//! One arena: floor, walls, obstacles, goal, robot, and the ways that were driven.
//!
//! In: the scenario and an [`ArenaScene`]. Out: shapes on a [`Canvas`], drawn from the ground up: [`draw_floor`], then a
//! field if there is one, then [`draw_trajectories`], [`draw_solids`], [`draw_goal`], [`draw_robot`].

use bevy::math::{self, Vec2Swizzles};
use egui::{Color32, Pos2, Rangef, Rect, Shape as Mark, Stroke, StrokeKind, pos2, vec2};

use super::canvas::Canvas;
use super::polygon;
use super::silhouette::{self, ObstaclePose, Silhouette};
use super::transform::{ArenaBounds, screen_direction};
use crate::app::scene::{ArenaScene, Trail, TrailEnd};
use crate::app::view_state::Overlays;
use crate::scenario::{Enclosure, Scenario, Wall};
use crate::task::Pose;

/// The floor within the walls, with faint lines every so often.
pub fn draw_floor(canvas: &Canvas, enclosure: &Enclosure) {
    let (painter, transform, palette) = (&canvas.painter, &canvas.transform, &canvas.palette);
    let bounds = ArenaBounds::from_enclosure(enclosure);
    let whole = transform.to_screen_rect(bounds.min_m, bounds.max_m);
    let corners = enclosure.corners_m();
    match enclosure {
        Enclosure::Rectangle { .. } => {
            painter.rect_filled(whole, 0.0, palette.floor);
        }
        Enclosure::Polygon { .. } => polygon::fill(canvas, &corners, palette.floor),
    }
    let seen = whole.intersect(painter.clip_rect());
    if canvas.compact || !seen.is_positive() {
        return;
    }
    let faint = Stroke::new(1.0, palette.grid);
    draw_grid_lines(canvas, seen, &corners, grid_step_m(transform.scale), faint);
}

/// Lines `step_m` apart through what is `seen` of the inside of a polygon.
pub fn draw_grid_lines(canvas: &Canvas, seen: Rect, corners: &[math::Vec2], step_m: f32, stroke: Stroke) {
    let (painter, transform) = (&canvas.painter, &canvas.transform);
    let (low, high) = (transform.to_world(seen.left_bottom()), transform.to_world(seen.right_top()));
    let part = |from: f32, to: f32, seen: Rangef| Rangef::new(from.min(to), from.max(to)).intersection(seen);
    for k in lines_between(low[0], high[0], step_m) {
        for [from, to] in beside(corners, k, step_m) {
            let (from, to) = (canvas.to_screen([k, from]), canvas.to_screen([k, to]));
            painter.vline(from.x, part(from.y, to.y, seen.y_range()), stroke);
        }
    }
    let lying: Vec<math::Vec2> = corners.iter().map(|corner| corner.yx()).collect();
    for k in lines_between(low[1], high[1], step_m) {
        for [from, to] in beside(&lying, k, step_m) {
            let (from, to) = (canvas.to_screen([from, k]), canvas.to_screen([to, k]));
            painter.hline(part(from.x, to.x, seen.x_range()), from.y, stroke);
        }
    }
}

/// The parts of the line x = `at_m` within a polygon. Where a side lies on the line, it counts as within.
fn beside(corners: &[math::Vec2], at_m: f32, step_m: f32) -> Vec<[f32; 2]> {
    let [left, right] = [-1e-3, 1e-3].map(|by| polygon::spans(corners, at_m + by * step_m));
    let long = |spans: &[[f32; 2]]| spans.iter().map(|[from, to]| to - from).sum::<f32>();
    if long(&left) >= long(&right) { left } else { right }
}

/// The distance of the floor's lines: 1, 2 or 5 times a power of ten, in m, that is 56 points or more.
#[must_use]
pub fn grid_step_m(points_per_m: f32) -> f32 {
    let least = 56.0 / points_per_m.max(1e-6);
    let power = 10.0_f32.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|k| k * power).into_iter().find(|&step| step >= least).unwrap_or(least)
}

fn lines_between(low: f32, high: f32, step: f32) -> impl Iterator<Item = f32> {
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last.min(first + 200)).map(move |k| k as f32 * step)
}

/// The walls around and within, and the obstacles of an arena layout at their poses.
pub fn draw_solids(canvas: &Canvas, room: &Scenario, poses: &[ObstaclePose]) {
    walls(canvas, room, canvas.palette.obstacle);
    for (obstacle, &pose) in room.obstacles.iter().zip(poses) {
        let outline = Silhouette::Obstacle { shape: obstacle.shape.clone(), pose };
        silhouette::draw(canvas, &outline, canvas.palette.obstacle, Stroke::NONE);
    }
}

/// The walls around and within; where those within end at one around, they don't show beyond it.
fn walls(canvas: &Canvas, room: &Scenario, ink: Color32) {
    let thick = if canvas.compact { 1.5 } else { 4.0 };
    for piece in room.walls.iter().flat_map(Wall::segments) {
        silhouette::draw(canvas, &Silhouette::from_obstacle(&piece), ink, Stroke::NONE);
    }
    if !room.walls.is_empty() {
        let beyond = room.walls.iter().map(|wall| wall.thickness_m).fold(0.0, f32::max);
        let (low, high) = room.enclosure.bounds_m();
        let behind = if canvas.compact { canvas.palette.panel } else { canvas.palette.background };
        polygon::fill_outside(canvas, &room.enclosure.corners_m(), low - beyond, high + beyond, behind);
    }
    match &room.enclosure {
        Enclosure::Rectangle { .. } => {
            let bounds = ArenaBounds::from_enclosure(&room.enclosure);
            let inside = canvas.transform.to_screen_rect(bounds.min_m, bounds.max_m);
            canvas.painter.rect_stroke(inside, 0.0, Stroke::new(thick, ink), StrokeKind::Outside);
        }
        Enclosure::Polygon { .. } => {
            silhouette::draw_closed_line(canvas, &room.enclosure.corners_m(), thick, ink)
        }
    }
}

/// The goal: where it is, and from how far it counts as reached.
pub fn draw_goal(canvas: &Canvas, scenario: &Scenario, at_m: [f32; 2]) {
    let palette = &canvas.palette;
    let centre = canvas.to_screen(at_m);
    let radius = canvas.transform.to_screen_length(scenario.task.goal_radius_m).max(3.0);
    let painter = &canvas.painter;
    let width = if canvas.compact { 1.5 } else { 2.5 };
    if !canvas.compact {
        painter.circle_stroke(centre, radius, Stroke::new(width + 4.0, palette.floor.gamma_multiply(0.75)));
        painter.circle_filled(centre, radius, palette.floor.gamma_multiply(0.5));
    }
    painter.circle(centre, radius, palette.success.gamma_multiply(0.16), Stroke::new(width, palette.success));
    if !canvas.compact {
        painter.circle_filled(centre, (radius * 0.14).clamp(2.5, 6.0), palette.success);
    } else if radius > 6.0 {
        painter.circle_filled(centre, 1.5, palette.success);
    }
}

/// The robot's colour: grey where nothing moves any more.
#[must_use]
pub fn robot_color(canvas: &Canvas, arena: &ArenaScene) -> Color32 {
    if arena.inactive { canvas.palette.weak_text } else { canvas.palette.accent }
}

/// The robot: its body, where it looks, and how near anything may come.
pub fn draw_robot(canvas: &Canvas, scenario: &Scenario, pose: Pose, skin: Color32) {
    let (painter, palette) = (&canvas.painter, &canvas.palette);
    let Pose { x_m, y_m, heading_rad } = pose;
    let centre = canvas.to_screen([x_m, y_m]);
    let body = canvas.transform.to_screen_length(scenario.robot.radius_m);
    if !canvas.compact {
        let guard = canvas.transform.to_screen_length(scenario.task.collision_range_m);
        painter.circle_stroke(centre, guard, Stroke::new(1.0, palette.weak_text.gamma_multiply(0.55)));
    }
    let least = if canvas.compact { 4.0 } else { 6.0 };
    let radius = body.max(least);
    let halo = if canvas.compact { 1.0 } else { 1.5 };
    painter.circle_filled(centre, radius + halo, palette.floor);
    painter.circle_filled(centre, radius, skin);
    let along = screen_direction(heading_rad) * radius;
    let across = along.rot90();
    // An arrow with a notch is no convex polygon: two halves, and a line over their seam.
    let (tip, notch) = (centre + along * 0.84, centre - along * 0.24);
    for side in [across, -across] {
        let half = vec![tip, centre - along * 0.56 + side * 0.58, notch];
        painter.add(Mark::convex_polygon(half, palette.on_accent, Stroke::NONE));
    }
    let seam = Stroke::new((radius * 0.16).max(1.0), palette.on_accent);
    painter.line_segment([tip - along * 0.2, notch + along * 0.06], seam);
}

/// The path of this navigation, fading out towards its start, and the last navigations by outcome.
pub fn draw_trajectories(canvas: &Canvas, arena: &ArenaScene, overlays: &Overlays) {
    if overlays.trails {
        let count = arena.trails.len().min(if canvas.compact { 3 } else { usize::MAX });
        for (age, trail) in arena.trails.iter().rev().take(count).enumerate().rev() {
            let newness = 1.0 - age as f32 / count as f32;
            draw_trail(canvas, trail, 0.22 + 0.38 * newness);
        }
    }
    if overlays.path && !arena.path_m.is_empty() {
        let path = arena.path_m.iter().copied().chain([[arena.pose.x_m, arena.pose.y_m]]);
        let ink = canvas.palette.accent;
        let width = if canvas.compact { 1.25 } else { 2.5 };
        canvas.gradient_line(path, width, |part| ink.gamma_multiply(0.06 + 0.84 * part * part));
    }
}

/// The colour of an outcome.
#[must_use]
pub fn outcome_color(palette: &crate::app::screen::theme::Palette, end: TrailEnd) -> Color32 {
    match end {
        TrailEnd::Reached => palette.success,
        TrailEnd::Collided => palette.error,
        TrailEnd::TimedOut => palette.warning,
    }
}

fn draw_trail(canvas: &Canvas, trail: &Trail, strength: f32) {
    let ink = outcome_color(&canvas.palette, trail.end);
    let width = if canvas.compact { 1.0 } else { 1.5 };
    canvas.gradient_line(trail.points_m.iter().copied(), width, |part| {
        ink.gamma_multiply(strength * (0.35 + 0.65 * part))
    });
    if let (Some(&end), false) = (trail.points_m.last(), canvas.compact) {
        outcome_mark(&canvas.painter, canvas.to_screen(end), trail.end, ink.gamma_multiply(strength + 0.25));
    }
}

/// The mark at a trail's end: a dot where the goal was reached, a cross at a collision, a square out of time.
pub fn outcome_mark(painter: &egui::Painter, at: Pos2, end: TrailEnd, ink: Color32) {
    let stroke = Stroke::new(1.75, ink);
    match end {
        TrailEnd::Reached => {
            painter.circle_filled(at, 2.75, ink);
        }
        TrailEnd::Collided => {
            painter.line_segment([at - vec2(3.0, 3.0), at + vec2(3.0, 3.0)], stroke);
            painter.line_segment([at + vec2(-3.0, 3.0), at + vec2(3.0, -3.0)], stroke);
        }
        TrailEnd::TimedOut => {
            let square = Rect::from_center_size(pos2(at.x, at.y), vec2(5.0, 5.0));
            painter.rect_stroke(square, 0.0, Stroke::new(1.25, ink), StrokeKind::Middle);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_floors_lines_are_round_numbers_apart() {
        for (scale, step) in [(56.0, 1.0), (150.0, 0.5), (40.0, 2.0), (6.0, 10.0), (1000.0, 0.1)] {
            assert!((grid_step_m(scale) / step - 1.0).abs() < 1e-4, "{scale}: {}", grid_step_m(scale));
        }
        let lines: Vec<f32> = lines_between(-1.1, 1.0, 0.5).collect();
        assert_eq!(lines, [-1.0, -0.5, 0.0, 0.5, 1.0]);
    }

    #[test]
    fn a_line_along_a_side_is_within() {
        let square = [math::vec2(0.0, 0.0), math::vec2(2.0, 0.0), math::vec2(2.0, 3.0), math::vec2(0.0, 3.0)];
        for (at, spans) in [(0.0, vec![[0.0, 3.0]]), (2.0, vec![[0.0, 3.0]]), (2.1, vec![])] {
            assert_eq!(beside(&square, at, 0.5), spans, "{at}");
        }
    }
}
