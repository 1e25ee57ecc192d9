//! The editor on the screen: a world is changed by pointer and keys, in place of the one that runs, and by numbers in a
//! panel beside it.
//!
//! In: the [`Editor`](crate::app::editor::Editor) on the desk. Out: its changes, and orders that save or take the world.
//!
//! | file | duty |
//! |---|---|
//! | `drawing.rs`, `marks.rs` | the world as it is drawn: solids and their ways; starts, goals, what is drawn anew |
//! | `handles.rs` | what can be dragged of the thing that is selected |
//! | `pointer.rs` | the pointer: selecting, dragging, drawing corner by corner |
//! | `shortcuts.rs` | the keyboard |
//! | `hints.rs` | the line that says what can be done now |
//! | `confirm_exit.rs` | into the editor and out of it |
//! | `panel.rs` | the panel on the left, from top to bottom |
//! | `scenario_panel.rs`, `inspector.rs`, `diagnostics.rs` | its parts: the world, what is selected, what is wrong |
//! | `fields.rs` | its controls |

pub mod confirm_exit;
mod diagnostics;
mod drawing;
mod fields;
mod handles;
mod hints;
mod inspector;
mod marks;
pub mod panel;
mod pointer;
mod scenario_panel;
pub mod shortcuts;

use bevy::math;
use egui::{EventFilter, Id, Rect, Sense, Ui, Vec2, WidgetInfo, WidgetType, vec2};

use self::pointer::PointerHit;
use super::arena_view::camera::steer_camera;
use super::arena_view::canvas::Canvas;
use super::arena_view::transform::{ArenaBounds, ViewTransform};
use super::theme::Palette;
use crate::app::editor::{Editor, Tool};
use crate::app::view_state::{ViewCamera, ViewState};

/// Space around the walls, where the hint is.
const MARGIN: Vec2 = vec2(30.0, 38.0);

/// Of the world that is edited: it may have the keyboard's focus.
fn canvas_id() -> Id {
    Id::new("world editor")
}

/// Fills what is left of `ui` with the world that is edited.
pub fn editor_ui(ui: &mut Ui, view_state: &mut ViewState) {
    let rect = ui.available_rect_before_wrap();
    ui.advance_cursor_after_rect(rect);
    let ViewState { editor: Some(editor), camera, .. } = view_state else { return };
    if !rect.is_positive() {
        return;
    }
    let palette = Palette::from_ui(ui);
    ui.painter_at(rect).rect_filled(rect, 0.0, palette.background);
    let id = canvas_id();
    // The panels' edges can be taken hold of from this side, too.
    let response = ui.interact(rect.shrink2(vec2(4.0, 0.0)), id, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "World being edited"));
    if response.has_focus() {
        // The arrows move what is selected, not the focus.
        let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id, arrows));
    }
    let mut transform = ViewTransform::new(rect, MARGIN, *camera, bounds(ui, id, editor, *camera));
    let under = pointer::update(ui, &response, &transform, editor);
    let drawing = *editor.tool() != Tool::Select && response.double_clicked();
    steer_camera(ui, &response, &mut transform, camera, under == PointerHit::Nothing && !drawing);
    pointer::set_cursor_icon(ui, &response, &transform, editor, under);
    let canvas = Canvas { painter: ui.painter_at(rect), transform, palette, compact: false };
    drawing::draw(ui, &canvas, id, editor, under);
    let tip = response.hover_pos().filter(|_| response.contains_pointer() || response.dragged());
    drawing::draw_draft(ui, &canvas, editor, tip);
    handles::draw(&canvas, editor, under);
    hints::draw(&canvas, editor, under);
}

/// What is half drawn, if something is, as it is called.
fn unfinished_drawing(editor: &Editor) -> Option<&'static str> {
    match editor.tool() {
        Tool::Wall { corners_m } if !corners_m.is_empty() => Some("wall"),
        Tool::Path { waypoints_m } if !waypoints_m.is_empty() => Some("path"),
        _ => None,
    }
}

/// What is half drawn is done, before the world is saved or taken.
fn finish_drawing(editor: &mut Editor) {
    if unfinished_drawing(editor).is_some() {
        editor.finish_tool();
    }
}

/// The point of the world in the view's middle, in m.
fn view_center_m(ui: &Ui, editor: &Editor, camera: ViewCamera) -> math::Vec2 {
    let bounds = bounds(ui, canvas_id(), editor, camera);
    ViewTransform::new(Rect::ZERO, Vec2::ZERO, camera, bounds).centre_m.into()
}

/// What zoom 1 shows: the box around the enclosure, but in the middle of a drag or seen closer it stays what it was, or
/// the world would shift under the pointer.
fn bounds(ui: &Ui, id: Id, editor: &Editor, camera: ViewCamera) -> ArenaBounds {
    let now = ArenaBounds::from_enclosure(&editor.scenario().enclosure);
    let before = ui.data(|data| data.get_temp::<(String, ArenaBounds)>(id));
    let stays = editor.dragged().is_some() || camera != ViewCamera::default();
    let kept = before.filter(|(from, _)| stays && from == editor.from());
    let bounds = kept.map_or(now, |(_, bounds)| bounds);
    ui.data_mut(|data| data.insert_temp(id, (editor.from().to_owned(), bounds)));
    bounds
}
