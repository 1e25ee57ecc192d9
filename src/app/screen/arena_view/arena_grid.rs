//! All arenas as a grid of cells, to choose one from.
//!
//! In: the scene. Out: a small picture of each arena; a click follows that arena and leaves the grid.

use egui::{Align2, CursorIcon, Rect, Sense, Stroke, StrokeKind, Ui, Vec2, pos2, vec2};

use super::canvas::Canvas;
use super::single_arena::set_arena_name;
use super::transform::{ArenaBounds, ViewTransform};
use super::{arena, beams, floor, trajectories};
use crate::app::scene::{ArenaScene, Scene};
use crate::app::screen::theme::Palette;
use crate::app::view_state::{ViewCamera, ViewState};

const MARGIN: Vec2 = vec2(5.0, 5.0);
/// Cells from this size on show the beams.
const BEAMS_FROM: f32 = 190.0;

fn counted(count: u32, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Columns and rows that give `count` cells of the shape `aspect` (width by height) the most size.
fn columns_rows(count: usize, room: Vec2, aspect: f32) -> (usize, usize) {
    let size = |columns: usize| {
        let rows = count.div_ceil(columns);
        (room.x / columns as f32 / aspect).min(room.y / rows as f32)
    };
    let columns =
        (1..=count.max(1)).max_by(|&a, &b| size(a).total_cmp(&size(b)).then(b.cmp(&a))).unwrap_or(1);
    (columns, count.div_ceil(columns))
}

/// Fills `rect` with a cell for each arena.
pub(super) fn arena_grid_ui(ui: &Ui, rect: Rect, scene: &Scene, view_state: &mut ViewState) {
    let room = rect.shrink(8.0);
    let [width_m, height_m] = ArenaBounds::from_enclosure(&scene.scenario.enclosure).size_m();
    let (columns, rows) = columns_rows(scene.arenas.len(), room.size(), width_m / height_m);
    let each = vec2(room.width() / columns as f32, room.height() / rows as f32);
    for (index, arena) in scene.arenas.iter().enumerate() {
        let (column, row) = ((index % columns) as f32, (index / columns) as f32);
        let place = Rect::from_min_size(room.min + vec2(column * each.x, row * each.y), each);
        let cell = place.shrink((each.min_elem() * 0.03).min(4.0));
        let response = ui.interact(cell, ui.id().with(("cell", index)), Sense::click());
        set_arena_name(&response, index);
        if response.clicked() {
            view_state.followed = index;
            view_state.grid = false;
        }
        draw_cell(ui, cell, scene, arena, index, view_state, response.hovered());
        let (reached, hit) = (arena.goals_reached, arena.collisions);
        if !response.hovered() {
            continue;
        }
        response.on_hover_text(format!(
            "Arena {}: {}, {}. Click to look closer.",
            index + 1,
            counted(reached, "goal reached", "goals reached"),
            counted(hit, "collision", "collisions")
        ));
    }
}

fn draw_cell(
    ui: &Ui,
    cell: Rect,
    scene: &Scene,
    arena: &ArenaScene,
    index: usize,
    view_state: &ViewState,
    hovered: bool,
) {
    let (palette, painter, scenario) =
        (Palette::from_ui(ui), ui.painter_at(cell.expand(1.5)), &*scene.scenario);
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
    if view_state.overlays.beams && !arena.inactive && view.size().min_elem() >= BEAMS_FROM {
        beams::draw(&canvas, scenario, arena);
    }
    arena::draw_robot(&canvas, scenario, arena.pose, arena::robot_color(&canvas, arena));
    if caption > 0.0 {
        let (left, right) = (cell.left() + 7.0, cell.right() - 7.0);
        let y = cell.top() + 2.0 + caption / 2.0;
        let ink = if index == view_state.followed { palette.accent } else { palette.weak_text };
        canvas.small_text(pos2(left, y), Align2::LEFT_CENTER, &(index + 1).to_string(), ink);
        let hit = arena.collisions.to_string();
        let hit = canvas.small_text(pos2(right, y), Align2::RIGHT_CENTER, &hit, palette.error);
        let reached = arena.goals_reached.to_string();
        canvas.small_text(pos2(hit.left() - 8.0, y), Align2::RIGHT_CENTER, &reached, palette.success);
    }
    let (width, ink) = match (index == view_state.followed, hovered) {
        (true, _) => (2.0, palette.accent),
        (false, true) => (1.5, palette.weak_text),
        (false, false) => (1.0, palette.border),
    };
    painter.rect_stroke(cell, 4.0, Stroke::new(width, ink), StrokeKind::Inside);
    if hovered {
        ui.ctx().set_cursor_icon(CursorIcon::PointingHand);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grid_wastes_no_room() {
        assert_eq!(columns_rows(16, vec2(800.0, 800.0), 1.0), (4, 4));
        assert_eq!(columns_rows(16, vec2(1600.0, 400.0), 1.0), (8, 2));
        assert_eq!(columns_rows(3, vec2(300.0, 900.0), 1.0), (1, 3));
        assert_eq!(columns_rows(1, vec2(300.0, 900.0), 2.0), (1, 1));
    }
}
