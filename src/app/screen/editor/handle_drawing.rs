//! The drawing of the selected item's handles.

use egui::{Align2, Color32, FontId, Pos2, Rect, Stroke, StrokeKind, Vec2, vec2};

use super::handles::{ROTATION_HANDLE, ScreenHandle, screen_handles};
use crate::app::editor::{Editor, HandleKind, PointerHit, Selection};
use crate::app::screen::arena_view::canvas::Canvas;
use crate::app::screen::theme::SMALL;

/// Half the side of a handle, in points.
const HALF: f32 = 4.0;

/// Draws the handles, and the value of the one under the pointer or being dragged. During a drag only the dragged handle
/// is drawn.
pub fn draw(canvas: &Canvas, editor: &Editor, hit: PointerHit) {
    let handles = screen_handles(&canvas.transform, editor);
    let active = match hit {
        PointerHit::Handle(kind) => Some(kind),
        _ => None,
    };
    // A benchmark start or goal is drawn as a mark, which has its own centre.
    let is_mark = matches!(editor.selection(), Selection::BenchmarkStart | Selection::BenchmarkGoal);
    for handle in &handles {
        let kind = handle.kind();
        let only_when_active = kind == HandleKind::PathStart || is_mark && kind == HandleKind::Middle;
        let is_hidden = only_when_active && active != Some(kind);
        if !is_hidden && editor.dragged().is_none_or(|dragged| dragged == kind) {
            draw_handle(canvas, editor, handle, active == Some(kind));
        }
    }
    // Last, so that the label is on top of all handles.
    if let Some(handle) = handles.iter().find(|handle| Some(handle.kind()) == active) {
        let others = if editor.dragged().is_some() { &[][..] } else { &handles };
        draw_value(canvas, handle, others);
    }
}

fn draw_handle(canvas: &Canvas, editor: &Editor, handle: &ScreenHandle, is_active: bool) {
    let (painter, palette, at) = (&canvas.painter, &canvas.palette, handle.at);
    let (fill, half) = if is_active { (palette.accent, HALF + 1.0) } else { (palette.floor, HALF) };
    let edge = Stroke::new(1.5, palette.accent);
    match handle.kind() {
        HandleKind::Side(..) => {
            let square = Rect::from_center_size(at, Vec2::splat(2.0 * half));
            painter.rect(square, 1.5, fill, edge, StrokeKind::Middle);
        }
        HandleKind::Middle if !is_active => {
            painter.circle(at, 2.5, palette.accent, Stroke::new(1.0, palette.floor));
        }
        HandleKind::InsertCorner(_) | HandleKind::InsertWaypoint(_) => draw_plus(canvas, at, half),
        HandleKind::Rotate => {
            if let Some((centre_m, _)) = editor.rotation_of() {
                let stalk = (at - canvas.to_screen(centre_m.into())).normalized();
                painter.line_segment([at - stalk * (ROTATION_HANDLE - 4.0), at], edge);
            }
            painter.circle(at, half, fill, edge);
        }
        _ => {
            painter.circle(at, half, fill, edge);
        }
    }
}

/// Draws a circle with a plus sign.
fn draw_plus(canvas: &Canvas, at: Pos2, half: f32) {
    let accent: Color32 = canvas.palette.accent;
    canvas.painter.circle(at, half, canvas.palette.floor, Stroke::new(1.0, accent.gamma_multiply(0.7)));
    for arm in [vec2(half - 1.5, 0.0), vec2(0.0, half - 1.5)] {
        canvas.painter.line_segment([at - arm, at + arm], Stroke::new(1.25, accent));
    }
}

/// Draws the value that a handle changes: to its upper right or, where that would cover one of `others` or leave the canvas, on
/// another side.
fn draw_value(canvas: &Canvas, handle: &ScreenHandle, others: &[ScreenHandle]) {
    let (painter, palette, text) = (&canvas.painter, &canvas.palette, &handle.handle.text);
    let size = painter.layout_no_wrap(text.clone(), FontId::proportional(SMALL), palette.text).size();
    let offset = vec2(HALF + 9.0, HALF + 5.0);
    let places = [
        (vec2(offset.x, -offset.y), Align2::LEFT_BOTTOM),
        (offset, Align2::LEFT_TOP),
        (-offset, Align2::RIGHT_BOTTOM),
        (vec2(-offset.x, offset.y), Align2::RIGHT_TOP),
    ];
    let is_free = |(shift, anchor): &(Vec2, Align2)| {
        let label = anchor.anchor_size(handle.at + *shift, size + vec2(8.0, 3.0));
        let covers = |other: &ScreenHandle| label.expand(HALF).contains(other.at);
        canvas.transform.rect.contains_rect(label) && !others.iter().any(covers)
    };
    let (shift, anchor) = places.into_iter().find(is_free).unwrap_or(places[0]);
    canvas.label(handle.at + shift, anchor, text, palette.text);
}
