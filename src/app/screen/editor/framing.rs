//! The part of the plane that the editor's canvas shows.

use bevy::math;
use egui::{Id, Rect, Ui, Vec2};

use crate::app::editor::Editor;
use crate::app::screen::arena_view::transform::{ArenaBounds, ViewTransform};
use crate::app::view_state::ViewCamera;

/// The id of the canvas, which can have the keyboard focus.
pub fn canvas_id() -> Id {
    Id::new("scenario editor")
}

/// The point in the middle of the view, in m.
pub fn view_centre_m(ui: &Ui, editor: &Editor, camera: ViewCamera) -> math::Vec2 {
    let bounds = bounds(ui, editor, camera);
    ViewTransform::new(Rect::ZERO, Vec2::ZERO, camera, bounds).centre_m.into()
}

/// The part of the plane that zoom 1 shows: the bounding box of the enclosure. During a drag or with a moved camera it stays
/// as it was, so that the scenario does not shift under the pointer.
pub fn bounds(ui: &Ui, editor: &Editor, camera: ViewCamera) -> ArenaBounds {
    let now = ArenaBounds::from_enclosure(&editor.scenario().enclosure);
    let before = ui.data(|data| data.get_temp::<(String, ArenaBounds)>(canvas_id()));
    let stays = editor.dragged().is_some() || camera != ViewCamera::default();
    let kept = before.filter(|(from, _)| stays && from == editor.from());
    let bounds = kept.map_or(now, |(_, bounds)| bounds);
    ui.data_mut(|data| data.insert_temp(canvas_id(), (editor.from().to_owned(), bounds)));
    bounds
}
