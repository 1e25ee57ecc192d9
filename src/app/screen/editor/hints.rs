//! The hint: one line at the foot of the world that says what can be done now.
//!
//! In: the tool, what is selected, what is under the pointer. Out: a soft line, cut off where it has no room.

use egui::text::{LayoutJob, TextFormat, TextWrapping};
use egui::{FontId, Rect, vec2};

use super::pointer::PointerHit;
use crate::app::editor::{Editor, HandleKind, Selection, Tool};
use crate::app::screen::arena_view::canvas::Canvas;
use crate::app::screen::theme::SMALL;

/// Draws it.
pub fn draw(canvas: &Canvas, editor: &Editor, under: PointerHit) {
    let view = canvas.transform.rect.shrink2(vec2(8.0, 5.0));
    if view.height() < 120.0 {
        return;
    }
    let words = words(editor, under);
    let format = TextFormat {
        font_id: FontId::proportional(SMALL),
        color: canvas.palette.weak_text,
        ..Default::default()
    };
    let mut job = LayoutJob::single_section(words, format);
    job.wrap = TextWrapping::truncate_at_width((view.width() - 12.0).max(20.0));
    let galley = canvas.painter.layout_job(job);
    let size = galley.size() + vec2(12.0, 6.0);
    let strip = Rect::from_min_size(view.left_bottom() - vec2(0.0, size.y), size);
    canvas.strip_background(strip);
    canvas.painter.galley(strip.min + vec2(6.0, 3.0), galley, canvas.palette.weak_text);
}

/// What it says.
fn words(editor: &Editor, under: PointerHit) -> String {
    match editor.tool() {
        Tool::Wall { corners_m } if corners_m.is_empty() => return "Click where the wall begins".into(),
        Tool::Path { waypoints_m } if waypoints_m.is_empty() => {
            return "Click where it goes first; in the end it comes back".into();
        }
        Tool::Wall { .. } | Tool::Path { .. } => {
            return "Click the next corner; double click or Enter: done, Backspace: one back".into();
        }
        Tool::Places => return "Click place by place; Enter: done".into(),
        Tool::Select => {}
    }
    if editor.dragged().is_some() {
        return "Alt: without snapping · Escape: back to where it was".into();
    }
    match under {
        PointerHit::Handle(HandleKind::Middle) | PointerHit::Body(_) | PointerHit::Nothing => {}
        PointerHit::Handle(kind) => {
            let about = editor.handles().into_iter().find(|handle| handle.kind == kind);
            return about.map_or_else(String::new, |handle| handle.about.into());
        }
    }
    match editor.selection() {
        Selection::Nothing => "Click a thing to change it; drag the floor and turn the wheel to look around",
        Selection::Enclosure => "Drag its sides or corners",
        Selection::Obstacle(_) | Selection::Wall(_) => {
            "Drag it or its handles · Delete · Ctrl+D: another one · Arrows: a little"
        }
        _ => "Drag it or its handles · Arrows: a little · Escape: select nothing",
    }
    .into()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scenario::Scenario;

    #[test]
    fn the_hint_goes_with_the_tool_and_the_hand() {
        let mut editor = Editor::open(Arc::new(Scenario::default()), "empty".into(), true);
        let says = |editor: &Editor, under| words(editor, under);
        assert!(says(&editor, PointerHit::Nothing).starts_with("Click a thing"));
        editor.select(Selection::BenchmarkStart);
        assert_eq!(says(&editor, PointerHit::Handle(HandleKind::Rotate)), "Where it looks");
        assert!(editor.begin_drag(HandleKind::Middle, bevy::math::Vec2::ZERO));
        assert!(says(&editor, PointerHit::Handle(HandleKind::Middle)).starts_with("Alt"));
        editor.end_drag();
        editor.set_tool(Tool::Wall { corners_m: Vec::new() });
        assert!(says(&editor, PointerHit::Nothing).ends_with("begins"));
        editor.click_with_tool(bevy::math::vec2(0.5, 0.5), true);
        assert!(says(&editor, PointerHit::Nothing).contains("Backspace"));
    }
}
