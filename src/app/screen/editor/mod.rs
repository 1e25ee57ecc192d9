//! The editor on the screen: a world is changed by pointer and keys, in place of the one that runs, and by numbers in a
//! panel beside it.
//!
//! In: the [`Editor`](crate::app::editor::Editor) on the desk. Out: its changes, and orders that save or take the world.
//!
//! | file | duty |
//! |---|---|
//! | `canvas.rs`, `marks.rs` | the world as it is drawn: solids and their ways; starts, targets, what is drawn anew |
//! | `handles.rs` | what can be dragged of the thing that is selected |
//! | `pointer.rs` | the pointer: selecting, dragging, drawing corner by corner |
//! | `keys.rs` | the keyboard |
//! | `hints.rs` | the line that says what can be done now |
//! | `leave.rs` | into the editor and out of it |
//! | `panel.rs` | the panel on the left, from top to bottom |
//! | `world.rs`, `inspector.rs`, `findings.rs` | its parts: the world, what is selected, what is wrong |
//! | `fields.rs` | its controls |

mod canvas;
mod fields;
mod findings;
mod handles;
mod hints;
mod inspector;
pub mod keys;
pub mod leave;
mod marks;
pub mod panel;
mod pointer;
mod world;

use egui::{EventFilter, Id, Rect, Sense, Ui, Vec2, WidgetInfo, WidgetType, vec2};

use self::pointer::Under;
use super::theme::Inks;
use super::world::canvas::Canvas;
use super::world::plane::{Bounds, Plane};
use super::world::steer_camera;
use crate::app::desk::{Camera, Desk};
use crate::app::editor::{Editor, Tool};
use crate::app::status::Status;

/// Space around the walls, where the hint is.
const MARGIN: Vec2 = vec2(30.0, 38.0);

/// Of the world that is edited: it may have the keyboard's focus.
fn canvas_id() -> Id {
    Id::new("world editor")
}

/// Fills what is left of `ui` with the world that is edited.
pub fn show(ui: &mut Ui, status: &Status, desk: &mut Desk) {
    let rect = ui.available_rect_before_wrap();
    ui.advance_cursor_after_rect(rect);
    let Desk { editor: Some(editor), camera, .. } = desk else { return };
    // The panel may be closed.
    editor.follow(status.saved_world.as_ref(), status.draft.as_ref());
    if !rect.is_positive() {
        return;
    }
    let inks = Inks::of(ui);
    ui.painter_at(rect).rect_filled(rect, 0.0, inks.paper);
    let id = canvas_id();
    // The panels' edges can be taken hold of from this side, too.
    let response = ui.interact(rect.shrink2(vec2(4.0, 0.0)), id, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "World being edited"));
    if response.has_focus() {
        // The arrows move what is selected, not the focus.
        let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id, arrows));
    }
    let mut plane = Plane::new(rect, MARGIN, *camera, bounds(ui, id, editor, *camera));
    let under = pointer::follow(ui, &response, &plane, editor);
    let drawing = *editor.tool() != Tool::Select && response.double_clicked();
    steer_camera(ui, &response, &mut plane, camera, under == Under::Nothing && !drawing);
    pointer::show_cursor(ui, &response, &plane, editor, under);
    let canvas = Canvas { painter: ui.painter_at(rect), plane, inks, small: false };
    canvas::draw(ui, &canvas, id, editor, under);
    let tip = response.hover_pos().filter(|_| response.contains_pointer() || response.dragged());
    canvas::draw_draft(ui, &canvas, editor, tip);
    handles::draw(&canvas, editor, under);
    hints::draw(&canvas, editor, under);
}

/// What is half drawn, if something is, as it is called.
fn half_drawn(editor: &Editor) -> Option<&'static str> {
    match editor.tool() {
        Tool::Wall { corners_m } if !corners_m.is_empty() => Some("wall"),
        Tool::Path { waypoints_m } if !waypoints_m.is_empty() => Some("path"),
        _ => None,
    }
}

/// What is half drawn is done, before the world is saved or taken.
fn end_drawing(editor: &mut Editor) {
    if half_drawn(editor).is_some() {
        editor.tool_end();
    }
}

/// The point of the world in the view's middle, in m.
fn centre_m(ui: &Ui, editor: &Editor, camera: Camera) -> (f32, f32) {
    let bounds = bounds(ui, canvas_id(), editor, camera);
    Plane::new(Rect::ZERO, Vec2::ZERO, camera, bounds).centre_m.into()
}

/// What zoom 1 shows: the box around the enclosure, but in the middle of a drag or seen closer it stays what it was, or
/// the world would shift under the pointer.
fn bounds(ui: &Ui, id: Id, editor: &Editor, camera: Camera) -> Bounds {
    let now = Bounds::of(&editor.scenario().enclosure);
    let before = ui.data(|data| data.get_temp::<(String, Bounds)>(id));
    let stays = editor.dragged().is_some() || camera != Camera::default();
    let kept = before.filter(|(from, _)| stays && from == editor.from());
    let bounds = kept.map_or(now, |(_, bounds)| bounds);
    ui.data_mut(|data| data.insert_temp(id, (editor.from().to_owned(), bounds)));
    bounds
}
