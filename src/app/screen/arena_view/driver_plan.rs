//! The plan of a driver: the occupied cells of the map that it builds, and its path to the goal.

use bevy::math::{Vec2, vec2};
use egui::{Color32, Mesh, Pos2, Shape, Stroke};

use super::canvas::Canvas;
use crate::drivers::DriverPlan;

/// Lengths of a dash of the path and of the gap after it, in points.
const DASH: (f32, f32) = (5.0, 4.0);

/// Draws the occupied cells and the path of `plan`.
pub fn draw(canvas: &Canvas, plan: &DriverPlan) {
    canvas.painter.add(Shape::mesh(cells(canvas, plan, canvas.palette.warning.gamma_multiply(0.5))));
    let path: Vec<Pos2> = plan.path_m.iter().map(|at| canvas.to_screen(at.to_array())).collect();
    let stroke = Stroke::new(1.5, canvas.palette.warning);
    canvas.dashed_line(&path, stroke, DASH);
}

/// The occupied cells, as one mesh.
fn cells(canvas: &Canvas, plan: &DriverPlan, color: Color32) -> Mesh {
    let half = Vec2::from_angle(plan.rotation_rad) * plan.cell_m / 2.0;
    let corners =
        [vec2(-1.0, -1.0), vec2(1.0, -1.0), vec2(1.0, 1.0), vec2(-1.0, 1.0)].map(|c| half.rotate(c));
    let mut mesh = Mesh::default();
    for centre in &plan.occupied_m {
        let first = mesh.vertices.len() as u32;
        for corner in corners {
            mesh.colored_vertex(canvas.to_screen((*centre + corner).to_array()), color);
        }
        mesh.add_triangle(first, first + 1, first + 2);
        mesh.add_triangle(first, first + 2, first + 3);
    }
    mesh
}
