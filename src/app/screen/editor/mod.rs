//! The editor on the screen: a canvas in place of the arena view, and a panel of fields next to it.
//!
//! In: the [`Editor`](crate::app::editor::Editor) of the [`ViewState`]. Out: its changes, and commands that save, open or
//! apply the scenario.
//!
//! | file | purpose |
//! |---|---|
//! | `confirm_exit.rs`, `set_question.rs` | entering and leaving the editor; the question that replaces it while training on a set of scenarios |
//! | `framing.rs` | the part of the plane that the canvas shows |
//! | `pointer.rs`, `cursor.rs`, `shortcuts.rs` | pointer, cursor icon and keyboard on the canvas |
//! | `drawing.rs`, `outlines.rs`, `marks.rs`, `draft.rs` | drawing: the scenario, outlines of items, starts and goals, an unfinished wall or path |
//! | `handles.rs` | handles on the screen: positions and hit test |
//! | `handle_drawing.rs`, `hints.rs`, `problem_note.rs` | drawing: handles, the hint line, the problem of the selected item |
//! | `panel.rs` | the panel; `header.rs`, `add_panel.rs`, `actions.rs` are its fixed parts |
//! | `inspector.rs`, `obstacle_fields.rs`, `generator_fields.rs`, `placement_fields.rs` | fields of the selected item |
//! | `scenario_panel.rs`, `robot_fields.rs` | fields of the scenario, in groups |
//! | `diagnostics.rs` | the list of problems |
//! | `fields.rs`, `number.rs`, `controls.rs` | rows of fields, numbers with units, choices and buttons |

mod actions;
mod add_panel;
pub mod confirm_exit;
mod controls;
mod cursor;
mod diagnostics;
mod draft;
mod drawing;
mod fields;
mod framing;
mod generator_fields;
mod handle_drawing;
mod handles;
mod header;
mod hints;
mod inspector;
mod marks;
mod number;
mod obstacle_fields;
mod outlines;
pub mod panel;
mod placement_fields;
mod pointer;
mod problem_note;
mod robot_fields;
mod scenario_panel;
pub mod set_question;
pub mod shortcuts;

use egui::{EventFilter, Sense, Ui, Vec2, WidgetInfo, WidgetType, vec2};

use super::arena_view::camera::steer_camera;
use super::arena_view::canvas::Canvas;
use super::arena_view::transform::ViewTransform;
use super::theme::Palette;
use crate::app::editor::{PointerHit, Tool};
use crate::app::view_state::ViewState;

/// Margin around the enclosure, in points, with space for the hint line.
const MARGIN: Vec2 = vec2(30.0, 38.0);

/// Draws the edited scenario into the rest of `ui`, and handles the pointer.
pub fn editor_ui(ui: &mut Ui, view_state: &mut ViewState) {
    let rect = ui.available_rect_before_wrap();
    ui.advance_cursor_after_rect(rect);
    let ViewState { editor: Some(editor), interaction, camera, .. } = view_state else { return };
    if !rect.is_positive() {
        return;
    }
    let palette = Palette::from_ui(ui);
    ui.painter_at(rect).rect_filled(rect, 0.0, palette.background);
    let id = framing::canvas_id();
    // Narrower than the canvas, so that the edges of the panels can be dragged from this side too.
    let response = ui.interact(rect.shrink2(vec2(4.0, 0.0)), id, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "Scenario editor"));
    if response.has_focus() {
        // The arrow keys move the selected item, not the focus.
        let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id, arrows));
    }
    let bounds = framing::bounds(ui, editor, *camera);
    let mut transform = ViewTransform::new(rect, MARGIN, *camera, bounds);
    // Read before `update` deselects the tool: a double-click that finishes a drawing must not also fit the view.
    let finishes_drawing = *editor.tool() != Tool::Select && response.double_clicked();
    let hit = pointer::update(ui, &response, &transform, editor, &mut interaction.editor);
    let on_floor = hit == PointerHit::Nothing && !finishes_drawing;
    steer_camera(ui, &response, &mut transform, camera, on_floor);
    cursor::set_icon(ui, &response, &transform, editor, hit);
    let canvas = Canvas { painter: ui.painter_at(rect), transform, palette, compact: false };
    drawing::draw(ui, &canvas, id, editor, hit);
    outlines::name_solids(ui, &canvas, editor.scenario());
    let pointer_pos = response.hover_pos().filter(|_| response.contains_pointer() || response.dragged());
    draft::draw(ui, &canvas, editor, pointer_pos);
    handle_drawing::draw(&canvas, editor, hit);
    hints::draw(&canvas, editor, hit);
}
