//! One arena: floor, walls, obstacles, target, robot, and the ways that were driven.
//!
//! In: the scenario and an [`ArenaScene`]. Out: shapes on a [`Canvas`], drawn from the ground up: [`ground`], then a
//! field if there is one, then [`ways`], [`solids`], [`target`], [`robot`].

use egui::{Color32, Pos2, Rect, Shape as Mark, Stroke, StrokeKind, pos2, vec2};

use super::canvas::Canvas;
use super::plane::direction;
use crate::app::desk::Overlays;
use crate::app::scene::{ArenaScene, Trail, TrailEnd};
use crate::scenario::{Scenario, Shape};
use crate::task::Pose;

/// The outline of something in the world, in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Outline {
    /// A disc.
    Disc {
        /// Its middle.
        at_m: [f32; 2],
        /// From the middle to the rim.
        radius_m: f32,
    },
    /// An obstacle's shape at a pose.
    Solid {
        /// The shape.
        shape: Shape,
        /// x in m, y in m, rotation in rad.
        pose: (f32, f32, f32),
    },
}

impl Outline {
    /// From its middle to its farthest point, in m.
    #[must_use]
    pub fn reach_m(&self) -> f32 {
        match self {
            Self::Disc { radius_m, .. } | Self::Solid { shape: Shape::Circle { radius_m }, .. } => *radius_m,
            Self::Solid { shape: Shape::Rectangle { width_m, height_m }, .. } => {
                width_m.hypot(*height_m) / 2.0
            }
        }
    }

    /// The outline `by_m` further out.
    #[must_use]
    pub fn grown(self, by_m: f32) -> Self {
        match self {
            Self::Disc { at_m, radius_m } => Self::Disc { at_m, radius_m: radius_m + by_m },
            Self::Solid { shape: Shape::Circle { radius_m }, pose } => {
                Self::Solid { shape: Shape::Circle { radius_m: radius_m + by_m }, pose }
            }
            Self::Solid { shape: Shape::Rectangle { width_m, height_m }, pose } => {
                let (width_m, height_m) = (width_m + 2.0 * by_m, height_m + 2.0 * by_m);
                Self::Solid { shape: Shape::Rectangle { width_m, height_m }, pose }
            }
        }
    }
}

/// The floor within the walls, with faint lines every so often.
pub fn ground(canvas: &Canvas, scenario: &Scenario) {
    let (painter, plane, inks) = (&canvas.painter, &canvas.plane, &canvas.inks);
    let floor = plane.enclosure_rect(&scenario.enclosure);
    painter.rect_filled(floor, 0.0, inks.floor);
    if canvas.small {
        return;
    }
    let seen = floor.intersect(painter.clip_rect());
    if !seen.is_positive() {
        return;
    }
    let step_m = grid_step_m(plane.scale);
    let faint = Stroke::new(1.0, inks.grid);
    let (low, high) = (plane.to_world(seen.left_bottom()), plane.to_world(seen.right_top()));
    for k in lines_between(low[0], high[0], step_m) {
        painter.vline(canvas.at([k, 0.0]).x, seen.y_range(), faint);
    }
    for k in lines_between(low[1], high[1], step_m) {
        painter.hline(seen.x_range(), canvas.at([0.0, k]).y, faint);
    }
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

/// The walls and the obstacles.
pub fn solids(canvas: &Canvas, scenario: &Scenario, arena: &ArenaScene) {
    let (painter, inks) = (&canvas.painter, &canvas.inks);
    let walls = canvas.plane.enclosure_rect(&scenario.enclosure);
    let thick = if canvas.small { 1.5 } else { 4.0 };
    painter.rect_stroke(walls, 0.0, Stroke::new(thick, inks.solid), StrokeKind::Outside);
    for (obstacle, &pose) in scenario.obstacles.iter().zip(&arena.obstacles) {
        let outline = Outline::Solid { shape: obstacle.shape.clone(), pose };
        draw_outline(canvas, &outline, inks.solid, Stroke::NONE);
    }
}

/// Draws `outline` if it is in view and not too small to be seen.
pub fn draw_outline(canvas: &Canvas, outline: &Outline, fill: Color32, edge: Stroke) {
    let mark = match outline {
        Outline::Disc { at_m, radius_m } => disc(canvas, *at_m, *radius_m, fill, edge),
        Outline::Solid { shape: Shape::Circle { radius_m }, pose } => {
            disc(canvas, [pose.0, pose.1], *radius_m, fill, edge)
        }
        Outline::Solid { shape: Shape::Rectangle { width_m, height_m }, pose } => {
            let corners = box_corners(*pose, *width_m, *height_m).map(|corner| canvas.at(corner));
            Mark::convex_polygon(corners.to_vec(), fill, edge)
        }
    };
    let space = mark.visual_bounding_rect();
    if space.intersects(canvas.painter.clip_rect()) && space.size().max_elem() > 0.6 {
        canvas.painter.add(mark);
    }
}

fn disc(canvas: &Canvas, at_m: [f32; 2], radius_m: f32, fill: Color32, edge: Stroke) -> Mark {
    let (centre, radius) = (canvas.at(at_m), canvas.plane.length(radius_m));
    Mark::Circle(egui::epaint::CircleShape { center: centre, radius, fill, stroke: edge })
}

/// The corners of a box at a pose, in m, in order around it.
fn box_corners((x, y, rotation): (f32, f32, f32), width_m: f32, height_m: f32) -> [[f32; 2]; 4] {
    let (sin, cos) = rotation.sin_cos();
    let (w, h) = (width_m / 2.0, height_m / 2.0);
    [[w, h], [-w, h], [-w, -h], [w, -h]].map(|[a, b]| [x + a * cos - b * sin, y + a * sin + b * cos])
}

/// The target: where it is, and from how far it counts as reached.
pub fn target(canvas: &Canvas, scenario: &Scenario, arena: &ArenaScene) {
    let inks = &canvas.inks;
    let centre = canvas.at([arena.target.x_m, arena.target.y_m]);
    let radius = canvas.plane.length(scenario.task.goal_radius_m).max(3.0);
    let painter = &canvas.painter;
    let width = if canvas.small { 1.5 } else { 2.5 };
    if !canvas.small {
        painter.circle_stroke(centre, radius, Stroke::new(width + 4.0, inks.floor.gamma_multiply(0.75)));
        painter.circle_filled(centre, radius, inks.floor.gamma_multiply(0.5));
    }
    painter.circle(centre, radius, inks.good.gamma_multiply(0.16), Stroke::new(width, inks.good));
    if !canvas.small {
        painter.circle_filled(centre, (radius * 0.14).clamp(2.5, 6.0), inks.good);
    } else if radius > 6.0 {
        painter.circle_filled(centre, 1.5, inks.good);
    }
}

/// The robot: its body, where it looks, and how near anything may come.
pub fn robot(canvas: &Canvas, scenario: &Scenario, arena: &ArenaScene) {
    let (painter, inks) = (&canvas.painter, &canvas.inks);
    let Pose { x_m, y_m, heading_rad } = arena.pose;
    let centre = canvas.at([x_m, y_m]);
    let body = canvas.plane.length(scenario.robot.radius_m);
    if !canvas.small {
        let guard = canvas.plane.length(scenario.task.collision_range_m);
        painter.circle_stroke(centre, guard, Stroke::new(1.0, inks.soft.gamma_multiply(0.55)));
    }
    let least = if canvas.small { 4.0 } else { 6.0 };
    let radius = body.max(least);
    let halo = if canvas.small { 1.0 } else { 1.5 };
    let skin = if arena.parked { inks.soft } else { inks.accent };
    painter.circle_filled(centre, radius + halo, inks.floor);
    painter.circle_filled(centre, radius, skin);
    let along = direction(heading_rad) * radius;
    let across = along.rot90();
    // An arrow with a notch is no convex polygon: two halves, and a line over their seam.
    let (tip, notch) = (centre + along * 0.84, centre - along * 0.24);
    for side in [across, -across] {
        let half = vec![tip, centre - along * 0.56 + side * 0.58, notch];
        painter.add(Mark::convex_polygon(half, inks.on_accent, Stroke::NONE));
    }
    let seam = Stroke::new((radius * 0.16).max(1.0), inks.on_accent);
    painter.line_segment([tip - along * 0.2, notch + along * 0.06], seam);
}

/// The path of this navigation, fading out towards its start, and the last navigations by outcome.
pub fn ways(canvas: &Canvas, arena: &ArenaScene, overlays: &Overlays) {
    if overlays.trails {
        let count = arena.trails.len().min(if canvas.small { 3 } else { usize::MAX });
        for (age, trail) in arena.trails.iter().rev().take(count).enumerate().rev() {
            let newness = 1.0 - age as f32 / count as f32;
            draw_trail(canvas, trail, 0.22 + 0.38 * newness);
        }
    }
    if overlays.path && !arena.path_m.is_empty() {
        let path = arena.path_m.iter().copied().chain([[arena.pose.x_m, arena.pose.y_m]]);
        let ink = canvas.inks.accent;
        let width = if canvas.small { 1.25 } else { 2.5 };
        canvas.way(path, width, |part| ink.gamma_multiply(0.06 + 0.84 * part * part));
    }
}

/// The colour of an outcome.
#[must_use]
pub fn outcome_ink(inks: &crate::app::screen::theme::Inks, end: TrailEnd) -> Color32 {
    match end {
        TrailEnd::Reached => inks.good,
        TrailEnd::Collided => inks.bad,
        TrailEnd::TimedOut => inks.warn,
    }
}

fn draw_trail(canvas: &Canvas, trail: &Trail, strength: f32) {
    let ink = outcome_ink(&canvas.inks, trail.end);
    let width = if canvas.small { 1.0 } else { 1.5 };
    canvas.way(trail.points_m.iter().copied(), width, |part| {
        ink.gamma_multiply(strength * (0.35 + 0.65 * part))
    });
    if let (Some(&end), false) = (trail.points_m.last(), canvas.small) {
        outcome_mark(&canvas.painter, canvas.at(end), trail.end, ink.gamma_multiply(strength + 0.25));
    }
}

/// The mark at a trail's end: a dot where the target was reached, a cross at a collision, a square out of time.
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
    fn a_box_turns_counterclockwise() {
        let corners = box_corners((1.0, 0.0, std::f32::consts::FRAC_PI_2), 2.0, 1.0);
        assert!((corners[0][0] - 0.5).abs() < 1e-6 && (corners[0][1] - 1.0).abs() < 1e-6, "{corners:?}");
    }
}
