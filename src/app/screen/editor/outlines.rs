//! Outlines of items: around the selected item, the one under the pointer, and those with a problem.

use bevy::math;
use egui::{Align2, Color32, Id, Pos2, Rect, Stroke, StrokeKind, Ui, Vec2, vec2};

use crate::app::editor::{Body, Editor, Selection};
use crate::app::screen::arena_view::canvas::Canvas;
use crate::app::screen::arena_view::silhouette::{self, Silhouette};
use crate::app::screen::arena_view::single_arena::name_object;
use crate::scenario::{Obstacle, Scenario, Wall};

/// Width of the line along the enclosure, in points.
const BOUNDARY_WIDTH: f32 = 4.0;
/// Distance from a mark to its outline, in points.
const MARK_GAP: f32 = 4.0;
/// Smallest radius of a mark on the screen, in points.
const MIN_MARK_RADIUS: f32 = 6.0;
/// Radius of the mark of a note, in points.
const NOTE_RADIUS: f32 = 7.0;
/// Height of a mark's name, above or below the mark, in points.
const NAME_HEIGHT: f32 = 14.0;

/// Radius of a mark on the screen, in points.
pub fn mark_radius(canvas: &Canvas, radius_m: f32) -> f32 {
    canvas.transform.to_screen_length(radius_m).max(MIN_MARK_RADIUS)
}

/// Draws an outline around an item. A selected wall has its own, see [`draw_selected_wall`].
pub fn draw_outline(canvas: &Canvas, scenario: &Scenario, selection: Selection, stroke: Stroke) {
    match selection.body(scenario) {
        Body::Nothing => {}
        Body::Obstacle(obstacle) => draw_solid(canvas, &obstacle, 3.0, Color32::TRANSPARENT, stroke),
        Body::Wall(wall) => {
            wall.pieces().for_each(|piece| draw_solid(canvas, &piece, 2.0, Color32::TRANSPARENT, stroke));
        }
        Body::Outline(corners) => {
            silhouette::draw_closed_line(canvas, &corners, BOUNDARY_WIDTH, stroke.color);
        }
        Body::Region(region) => {
            let rect = canvas.transform.to_screen_rect(region.min_m.into(), region.max_m.into());
            canvas.painter.rect_stroke(rect, 0.0, stroke, StrokeKind::Middle);
        }
        Body::Marks { positions_m, radius_m } => {
            let radius = mark_radius(canvas, radius_m) + MARK_GAP;
            for at in positions_m {
                canvas.painter.circle_stroke(canvas.to_screen(at.into()), radius, stroke);
            }
        }
    }
}

/// Draws a wall with one rim around all its pieces.
pub fn draw_selected_wall(canvas: &Canvas, wall: &Wall) {
    let palette = &canvas.palette;
    for (by, fill) in [(5.0, palette.accent), (3.0, palette.floor), (0.0, palette.obstacle)] {
        wall.pieces().for_each(|piece| draw_solid(canvas, &piece, by, fill, Stroke::NONE));
    }
}

/// Draws obstacles, walls and the enclosure in the error colour if they have a problem. `marks.rs` does so for all other items.
pub fn draw_errors(canvas: &Canvas, editor: &Editor) {
    let error = canvas.palette.error;
    let mut done = Vec::new();
    for problem in editor.diagnostics() {
        let selection = Selection::from_field_path(&problem.path);
        if done.contains(&selection) {
            continue;
        }
        done.push(selection);
        match selection.body(editor.scenario()) {
            Body::Obstacle(obstacle) => {
                draw_solid(canvas, &obstacle, 0.0, error.gamma_multiply(0.45), Stroke::new(2.0, error));
            }
            Body::Wall(wall) => {
                let fill = error.gamma_multiply(0.6);
                wall.pieces().for_each(|piece| draw_solid(canvas, &piece, 0.0, fill, Stroke::NONE));
            }
            Body::Outline(corners) => {
                silhouette::draw_closed_line(canvas, &corners, BOUNDARY_WIDTH, error);
            }
            Body::Nothing | Body::Region(_) | Body::Marks { .. } => {}
        }
    }
}

/// Draws a ring with an exclamation mark for each note that has a position.
pub fn draw_notes(canvas: &Canvas, editor: &Editor) {
    let (painter, palette) = (&canvas.painter, &canvas.palette);
    for position_m in editor.notes().iter().filter_map(|note| note.position_m) {
        let at = canvas.to_screen(position_m.into());
        painter.circle(at, NOTE_RADIUS, palette.panel, Stroke::new(2.0, palette.warning));
        canvas.small_text(at, Align2::CENTER_CENTER, "!", palette.warning);
    }
}

/// Draws an obstacle or a piece of a wall, inflated by `by` points.
fn draw_solid(canvas: &Canvas, obstacle: &Obstacle, by: f32, fill: Color32, stroke: Stroke) {
    let shape = Silhouette::from_obstacle(obstacle);
    let shape = if by > 0.0 { shape.inflated(by / canvas.transform.scale) } else { shape };
    silhouette::draw(canvas, &shape, fill, stroke);
}

/// Adds the obstacles and inner walls to the accessibility tree, if egui builds one.
pub fn name_solids(ui: &Ui, canvas: &Canvas, scenario: &Scenario) {
    let obstacles = (0..scenario.obstacles.len()).map(|k| ("Obstacle", k, Selection::Obstacle(k)));
    let walls = (0..scenario.walls.len()).map(|k| ("Wall", k, Selection::Wall(k)));
    for (noun, k, selection) in obstacles.chain(walls) {
        name_object(ui, Id::new((noun, k)), || {
            Some((format!("{noun} {}", k + 1), screen_rect(canvas, scenario, selection)?))
        });
    }
}

/// The bounding box of an item on the screen; for a rule with several positions, the box of the first. `None` for the
/// enclosure and for items without a position.
pub fn screen_rect(canvas: &Canvas, scenario: &Scenario, selection: Selection) -> Option<Rect> {
    let to_screen = |at: math::Vec2| canvas.to_screen(at.into());
    let rect = match selection.body(scenario) {
        Body::Nothing | Body::Outline(_) => return None,
        Body::Obstacle(obstacle) => Silhouette::from_obstacle(&obstacle).screen_rect(canvas),
        Body::Wall(wall) => {
            let grid = wall.cells.iter().flat_map(|cells| <[math::Vec2; 2]>::from(cells.bounds_m()));
            let corners: Vec<Pos2> = wall.corners_m.iter().copied().chain(grid).map(to_screen).collect();
            Rect::from_points(&corners)
        }
        Body::Region(region) => canvas.transform.to_screen_rect(region.min_m.into(), region.max_m.into()),
        Body::Marks { positions_m, radius_m } => {
            let side = 2.0 * mark_radius(canvas, radius_m);
            let mark = Rect::from_center_size(to_screen(*positions_m.first()?), Vec2::splat(side));
            mark.expand2(vec2(0.0, NAME_HEIGHT))
        }
    };
    rect.is_finite().then_some(rect)
}
