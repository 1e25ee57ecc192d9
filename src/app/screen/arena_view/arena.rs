//! The objects of an arena: walls, obstacles, goal and robot.
//!
//! In: the scenario and an [`ArenaScene`]. Out: shapes on a [`Canvas`]. The order of drawing is floor, field,
//! trajectories, solids, the driver's plan, goal, beams, robot.

use egui::{Color32, Shape as Mark, Stroke, StrokeKind};

use super::canvas::Canvas;
use super::polygon;
use super::silhouette::{self, Silhouette};
use super::transform::{ArenaBounds, screen_direction};
use crate::app::moves::ObstaclePose;
use crate::app::scene::ArenaScene;
use crate::scenario::{Enclosure, Scenario, Wall};
use crate::task::Pose;

/// Draws the walls of `scenario`, and its obstacles at `poses`.
pub fn draw_solids(canvas: &Canvas, scenario: &Scenario, poses: &[ObstaclePose]) {
    draw_walls(canvas, scenario, canvas.palette.obstacle);
    for (obstacle, &pose) in scenario.obstacles.iter().zip(poses) {
        let outline = Silhouette::Obstacle { shape: obstacle.shape.clone(), pose };
        silhouette::draw(canvas, &outline, canvas.palette.obstacle, Stroke::NONE);
    }
}

/// Draws the inner walls, covers the parts of them outside the enclosure, and draws the enclosure.
fn draw_walls(canvas: &Canvas, scenario: &Scenario, color: Color32) {
    let thickness = if canvas.compact { 1.5 } else { 4.0 };
    for piece in scenario.walls.iter().flat_map(Wall::pieces) {
        silhouette::draw(canvas, &Silhouette::from_obstacle(&piece), color, Stroke::NONE);
    }
    if !scenario.walls.is_empty() {
        let margin_m = scenario.walls.iter().map(|wall| wall.thickness_m).fold(0.0, f32::max);
        let (low, high) = scenario.enclosure.bounds_m();
        let outside = if canvas.compact { canvas.palette.panel } else { canvas.palette.background };
        polygon::fill_outside(
            canvas,
            &scenario.enclosure.corners_m(),
            low - margin_m,
            high + margin_m,
            outside,
        );
    }
    match &scenario.enclosure {
        Enclosure::Rectangle { .. } => {
            let bounds = ArenaBounds::from_enclosure(&scenario.enclosure);
            let inside = canvas.transform.to_screen_rect(bounds.min_m, bounds.max_m);
            canvas.painter.rect_stroke(inside, 0.0, Stroke::new(thickness, color), StrokeKind::Outside);
        }
        Enclosure::Polygon { .. } => {
            silhouette::draw_closed_line(canvas, &scenario.enclosure.corners_m(), thickness, color);
        }
    }
}

/// Draws the goal at `at_m` as a disc with the radius within which it counts as reached.
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

/// The colour of the robot: grey in an inactive arena.
#[must_use]
pub fn robot_color(canvas: &Canvas, arena: &ArenaScene) -> Color32 {
    if arena.inactive { canvas.palette.weak_text } else { canvas.palette.accent }
}

/// Draws the robot: its body, its heading, and the collision range around it.
pub fn draw_robot(canvas: &Canvas, scenario: &Scenario, pose: Pose, color: Color32) {
    let (painter, palette) = (&canvas.painter, &canvas.palette);
    let Pose { x_m, y_m, heading_rad } = pose;
    let centre = canvas.to_screen([x_m, y_m]);
    let body = canvas.transform.to_screen_length(scenario.robot.inner_radius_m());
    if !canvas.compact {
        let collision_range = canvas.transform.to_screen_length(scenario.task.collision_range_m);
        painter.circle_stroke(
            centre,
            collision_range,
            Stroke::new(1.0, palette.weak_text.gamma_multiply(0.55)),
        );
    }
    let min_radius = if canvas.compact { 4.0 } else { 6.0 };
    let radius = body.max(min_radius);
    let halo = if canvas.compact { 1.0 } else { 1.5 };
    if let Some(shape) = &scenario.robot.shape {
        let outline = Silhouette::Obstacle { shape: shape.clone(), pose: (x_m, y_m, heading_rad) };
        silhouette::draw(canvas, &outline, color, Stroke::new(halo, palette.floor));
    }
    if scenario.robot.shape.is_none() || body < min_radius {
        painter.circle_filled(centre, radius + halo, palette.floor);
        painter.circle_filled(centre, radius, color);
    }
    let along = screen_direction(heading_rad) * radius;
    let across = along.rot90();
    // An arrow with a notch is not convex: draw two halves, and a line over their seam.
    let (tip, notch) = (centre + along * 0.84, centre - along * 0.24);
    for side in [across, -across] {
        let half = vec![tip, centre - along * 0.56 + side * 0.58, notch];
        painter.add(Mark::convex_polygon(half, palette.on_accent, Stroke::NONE));
    }
    let seam = Stroke::new((radius * 0.16).max(1.0), palette.on_accent);
    painter.line_segment([tip - along * 0.2, notch + along * 0.06], seam);
}
