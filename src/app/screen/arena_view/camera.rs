//! Camera control: pan, zoom and fit with the pointer.

use egui::{CursorIcon, Response, Ui};

use super::transform::ViewTransform;
use crate::app::view_state::ViewCamera;

/// Zooms with the scroll wheel or a pinch. If the pointer is on free floor (`on_floor`), a drag pans the view and a double click
/// fits the arena to it.
pub fn steer_camera(
    ui: &Ui,
    response: &Response,
    transform: &mut ViewTransform,
    camera: &mut ViewCamera,
    on_floor: bool,
) {
    if on_floor && response.dragged() {
        *camera = transform.panned(*camera, response.drag_delta());
        // A zoom in the same frame is about the point that is now under the pointer.
        *transform = transform.with_camera(*camera);
        ui.ctx().set_cursor_icon(CursorIcon::AllScroll);
    }
    if let Some(at) = response.hover_pos().filter(|_| response.contains_pointer()) {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = pinch * (scroll * 0.0035).exp();
        if factor.is_finite() && factor != 1.0 {
            *camera = transform.zoomed(*camera, at, factor);
            *transform = transform.with_camera(*camera);
        }
    }
    if response.double_clicked() && on_floor {
        *camera = ViewCamera::default();
        *transform = transform.with_camera(*camera);
    }
}
