//! The cursor icon on the editor's canvas.

use egui::{CursorIcon, Response, Ui, Vec2};

use super::handles;
use crate::app::editor::{Editor, HandleKind, PointerHit, Selection, Tool};
use crate::app::screen::arena_view::transform::ViewTransform;

/// Sets the cursor icon for what is under the pointer.
pub fn set_icon(ui: &Ui, response: &Response, transform: &ViewTransform, editor: &Editor, hit: PointerHit) {
    if !(response.contains_pointer() || response.is_pointer_button_down_on()) {
        return;
    }
    let dragged = editor.dragged().is_some();
    let icon = match hit {
        _ if *editor.tool() != Tool::Select => CursorIcon::Crosshair,
        PointerHit::Nothing => return,
        PointerHit::Handle(HandleKind::Middle | HandleKind::Rotate) | PointerHit::Body(_) if dragged => {
            CursorIcon::Grabbing
        }
        PointerHit::Body(Selection::Enclosure) => CursorIcon::PointingHand,
        PointerHit::Body(_) | PointerHit::Handle(HandleKind::Middle) => CursorIcon::Move,
        PointerHit::Handle(kind) if kind.is_insert() => CursorIcon::Copy,
        PointerHit::Handle(HandleKind::Rotate) => CursorIcon::Grab,
        PointerHit::Handle(kind) => resize_icon(transform, editor, kind),
    };
    ui.ctx().set_cursor_icon(icon);
}

/// A double arrow for a handle that changes a size, else a cross of arrows.
fn resize_icon(transform: &ViewTransform, editor: &Editor, kind: HandleKind) -> CursorIcon {
    let resizes =
        matches!(kind, HandleKind::Side(..) | HandleKind::Radius | HandleKind::End(_) | HandleKind::Reach);
    let handles = handles::screen_handles(transform, editor);
    let handle = handles.iter().find(|handle| handle.handle.kind == kind);
    match (resizes, handle, handles::center(transform, editor)) {
        (true, Some(handle), Some(center)) => double_arrow(handle.at - center),
        _ => CursorIcon::Move,
    }
}

/// The double arrow closest to a direction on the screen, y down.
fn double_arrow(direction: Vec2) -> CursorIcon {
    let eighth = (direction.angle() / std::f32::consts::FRAC_PI_4).round() as i32;
    match eighth.rem_euclid(4) {
        0 => CursorIcon::ResizeHorizontal,
        1 => CursorIcon::ResizeNwSe,
        2 => CursorIcon::ResizeVertical,
        _ => CursorIcon::ResizeNeSw,
    }
}

#[cfg(test)]
mod tests {
    use egui::vec2;

    use super::*;

    #[test]
    fn the_double_arrow_points_across_the_side() {
        for (direction, icon) in [
            (vec2(5.0, 0.4), CursorIcon::ResizeHorizontal),
            (vec2(-5.0, 0.4), CursorIcon::ResizeHorizontal),
            (vec2(0.0, -3.0), CursorIcon::ResizeVertical),
            (vec2(2.0, -2.0), CursorIcon::ResizeNeSw),
            (vec2(-2.0, 2.0), CursorIcon::ResizeNeSw),
            (vec2(2.0, 2.0), CursorIcon::ResizeNwSe),
        ] {
            assert_eq!(double_arrow(direction), icon, "{direction:?}");
        }
    }
}
