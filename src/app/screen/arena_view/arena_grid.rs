//! The grid of all arenas.
//!
//! In: the scene. Out: a cell with a small view of each arena; a click on one follows that arena and leaves
//! the grid.

use egui::{Align2, Color32, CursorIcon, Rect, Sense, Stroke, StrokeKind, Ui, Vec2, pos2, vec2};

use super::canvas::Canvas;
use super::single_arena::set_arena_name;
use super::transform::{ArenaBounds, ViewTransform};
use super::{arena, beams, floor, trajectories};
use crate::app::scene::{ArenaScene, Scene, Score};
use crate::app::screen::theme::{Palette, SMALL};
use crate::app::screen::widgets::text::paint_truncated;
use crate::app::view_state::{ViewCamera, ViewState};

/// Space around an arena in its cell, in points.
const MARGIN: Vec2 = vec2(5.0, 5.0);
/// Views at least this wide and high, in points, show the beams.
const MIN_SIZE_FOR_BEAMS: f32 = 190.0;

/// A count with its noun in the singular or plural.
fn counted(count: u32, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// The columns and rows that make `count` cells of the aspect ratio `aspect` (width by height) largest.
fn columns_rows(count: usize, available: Vec2, aspect: f32) -> (usize, usize) {
    let size = |columns: usize| {
        let rows = count.div_ceil(columns);
        (available.x / columns as f32 / aspect).min(available.y / rows as f32)
    };
    let columns =
        (1..=count.max(1)).max_by(|&a, &b| size(a).total_cmp(&size(b)).then(b.cmp(&a))).unwrap_or(1);
    (columns, count.div_ceil(columns))
}

/// Draws a cell in `rect` for each arena.
pub(super) fn arena_grid_ui(ui: &Ui, rect: Rect, scene: &Scene, view_state: &mut ViewState) {
    let area = rect.shrink(8.0);
    let [width_m, height_m] = ArenaBounds::from_enclosure(&scene.scenario.enclosure).size_m();
    let (columns, rows) = columns_rows(scene.arenas.len(), area.size(), width_m / height_m);
    let cell_size = vec2(area.width() / columns as f32, area.height() / rows as f32);
    for (index, arena) in scene.arenas.iter().enumerate() {
        let (column, row) = ((index % columns) as f32, (index / columns) as f32);
        let slot = Rect::from_min_size(area.min + vec2(column * cell_size.x, row * cell_size.y), cell_size);
        let cell = slot.shrink((cell_size.min_elem() * 0.03).min(4.0));
        let response = ui.interact(cell, ui.id().with(("cell", index)), Sense::click());
        set_arena_name(&response, index);
        if response.clicked() {
            view_state.followed = index;
            view_state.grid = false;
        }
        draw_cell(ui, cell, arena, index, view_state, response.hovered());
        let Score { reached, collided, timed_out, .. } = arena.score;
        if !response.hovered() {
            continue;
        }
        let member = arena.set_member.as_ref().map_or(String::new(), |member| format!(", in {member}"));
        response.on_hover_text(format!(
            "Arena {}{member}: {}, {}, {timed_out} timed out. Click to follow it",
            index + 1,
            counted(reached, "goal reached", "goals reached"),
            counted(collided, "collision", "collisions")
        ));
    }
}

/// Draws a small view of an arena, with a caption if the cell is large enough.
fn draw_cell(ui: &Ui, cell: Rect, arena: &ArenaScene, index: usize, view_state: &ViewState, hovered: bool) {
    let (palette, painter, scenario) =
        (Palette::from_ui(ui), ui.painter_at(cell.expand(1.5)), &*arena.written);
    painter.rect_filled(cell, 4.0, palette.panel);
    let caption = if cell.width().min(cell.height()) >= 90.0 { 18.0 } else { 0.0 };
    let view = Rect::from_min_max(pos2(cell.left(), cell.top() + caption), cell.max);
    let transform = ViewTransform::new(
        view,
        MARGIN,
        ViewCamera::default(),
        ArenaBounds::from_enclosure(&scenario.enclosure),
    );
    let canvas = Canvas { painter: painter.clone(), transform, palette, compact: true };
    floor::draw_floor(&canvas, &scenario.enclosure);
    trajectories::draw(&canvas, arena, &view_state.overlays);
    arena::draw_solids(&canvas, &arena.scenario, &arena.obstacles);
    arena::draw_goal(&canvas, scenario, [arena.goal.x_m, arena.goal.y_m]);
    if view_state.overlays.beams && !arena.inactive && view.size().min_elem() >= MIN_SIZE_FOR_BEAMS {
        beams::draw(&canvas, scenario, arena);
    }
    arena::draw_robot(&canvas, scenario, arena.pose, arena::robot_color(&canvas, arena));
    let followed = index == view_state.followed;
    if caption > 0.0 {
        let color = if followed { palette.accent } else { palette.weak_text };
        draw_caption(&canvas, cell, cell.top() + 2.0 + caption / 2.0, arena, index, color);
    }
    let (width, color) = match (followed, hovered) {
        (true, _) => (2.0, palette.accent),
        (false, true) => (1.5, palette.weak_text),
        (false, false) => (1.0, palette.border),
    };
    painter.rect_stroke(cell, 4.0, Stroke::new(width, color), StrokeKind::Inside);
    if hovered {
        ui.ctx().set_cursor_icon(CursorIcon::PointingHand);
    }
}

/// Draws the number of the arena on the left, followed by its scenario in a set, cut off if it is too long; on the right, the
/// numbers of goals reached and of collisions.
fn draw_caption(canvas: &Canvas, cell: Rect, y: f32, arena: &ArenaScene, index: usize, color: Color32) {
    let (left, right) = (cell.left() + 7.0, cell.right() - 7.0);
    let number = canvas.small_text(pos2(left, y), Align2::LEFT_CENTER, &(index + 1).to_string(), color);
    let collisions = arena.score.collided.to_string();
    let right = canvas.small_text(pos2(right, y), Align2::RIGHT_CENTER, &collisions, canvas.palette.error);
    let reached = arena.score.reached.to_string();
    let at = pos2(right.left() - 8.0, y);
    let right = canvas.small_text(at, Align2::RIGHT_CENTER, &reached, canvas.palette.success);
    if let Some(member) = &arena.set_member {
        let (from, to) = (number.right() + 8.0, right.left() - 8.0);
        let at = (pos2(from, y), Align2::LEFT_CENTER);
        paint_truncated(&canvas.painter, at, member, (SMALL, canvas.palette.weak_text), to - from);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_makes_its_cells_as_large_as_possible() {
        assert_eq!(columns_rows(16, vec2(800.0, 800.0), 1.0), (4, 4));
        assert_eq!(columns_rows(16, vec2(1600.0, 400.0), 1.0), (8, 2));
        assert_eq!(columns_rows(3, vec2(300.0, 900.0), 1.0), (1, 3));
        assert_eq!(columns_rows(1, vec2(300.0, 900.0), 2.0), (1, 1));
    }
}
