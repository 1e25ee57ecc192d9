//! The hint line at the bottom of the canvas: what the pointer and the keys do now. A line that does not fit is truncated.

use egui::text::{LayoutJob, TextFormat, TextWrapping};
use egui::{FontId, Rect, vec2};

use crate::app::editor::{Editor, HandleKind, PointerHit, Selection, Tool};
use crate::app::screen::arena_view::canvas::Canvas;
use crate::app::screen::theme::SMALL;

/// Draws the hint line, unless the canvas is too short for it.
pub fn draw(canvas: &Canvas, editor: &Editor, hit: PointerHit) {
    let view = canvas.transform.rect.shrink2(vec2(8.0, 5.0));
    if view.height() < 120.0 {
        return;
    }
    let format = TextFormat {
        font_id: FontId::proportional(SMALL),
        color: canvas.palette.weak_text,
        ..Default::default()
    };
    let mut job = LayoutJob::single_section(hint(editor, hit), format);
    job.wrap = TextWrapping::truncate_at_width((view.width() - 12.0).max(20.0));
    let galley = canvas.painter.layout_job(job);
    let size = galley.size() + vec2(12.0, 6.0);
    let strip = Rect::from_min_size(view.left_bottom() - vec2(0.0, size.y), size);
    canvas.strip_background(strip);
    canvas.painter.galley(strip.min + vec2(6.0, 3.0), galley, canvas.palette.weak_text);
}

/// The text of the hint line.
fn hint(editor: &Editor, hit: PointerHit) -> String {
    tool_hint(editor)
        .or_else(|| editor.dragged().map(|_| "Alt: no snapping · Escape: cancel"))
        .or_else(|| handle_hint(editor, hit))
        .unwrap_or_else(|| selection_hint(editor.selection()))
        .into()
}

fn tool_hint(editor: &Editor) -> Option<&'static str> {
    match editor.tool() {
        Tool::Wall { corners_m } if corners_m.is_empty() => Some("Click the first corner of the wall"),
        Tool::Path { waypoints_m } if waypoints_m.is_empty() => Some("Click the first waypoint"),
        Tool::Wall { .. } | Tool::Path { .. } => {
            Some("Click the next point · Double-click or Enter: finish · Backspace: remove the last point")
        }
        Tool::Positions => Some("Click to add positions · Enter: finish"),
        Tool::Select => None,
    }
}

fn handle_hint(editor: &Editor, hit: PointerHit) -> Option<&'static str> {
    match hit {
        PointerHit::Handle(HandleKind::Middle) | PointerHit::Body(_) | PointerHit::Nothing => None,
        PointerHit::Handle(kind) => {
            let handle = editor.handles().into_iter().find(|handle| handle.kind == kind);
            Some(handle.map_or("", |handle| handle.about))
        }
    }
}

fn selection_hint(selection: Selection) -> &'static str {
    match selection {
        Selection::Nothing => "Click an item to edit it · Drag the floor to pan · Scroll to zoom",
        Selection::Enclosure => "Drag a side or a corner to resize",
        Selection::Obstacle(_) | Selection::Wall(_) => {
            "Drag the item or its handles · Delete · Ctrl+D: duplicate · Arrow keys: move one step"
        }
        _ => "Drag the item or its handles · Arrow keys: move one step · Escape: deselect",
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use bevy::math::{Vec2, vec2};

    use super::{Editor, HandleKind, PointerHit, Selection, Tool, hint};
    use crate::scenario::Scenario;

    #[test]
    fn the_hint_follows_the_tool_the_drag_and_the_pointer() {
        let mut editor = Editor::open(Arc::new(Scenario::default()), "empty".into(), true);
        assert!(hint(&editor, PointerHit::Nothing).starts_with("Click an item"));
        editor.add_benchmark_route();
        editor.select(Selection::BenchmarkStart);
        assert_eq!(hint(&editor, PointerHit::Handle(HandleKind::Rotate)), "Turn the heading");
        assert!(editor.begin_drag(HandleKind::Middle, Vec2::ZERO));
        assert!(hint(&editor, PointerHit::Handle(HandleKind::Middle)).starts_with("Alt"));
        editor.end_drag();
        editor.set_tool(Tool::Wall { corners_m: Vec::new() });
        assert!(hint(&editor, PointerHit::Nothing).contains("first corner"));
        editor.click_with_tool(vec2(0.5, 0.5), true);
        assert!(hint(&editor, PointerHit::Nothing).contains("Backspace"));
    }
}
