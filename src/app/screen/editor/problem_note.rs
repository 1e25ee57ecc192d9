//! A card on the canvas with a problem of the selected item or, if it has none, a note on it. During a drag, the problem may
//! be another item's.

use egui::{FontId, Rect, Vec2, pos2, vec2};

use super::outlines;
use crate::app::editor::{Editor, Selection};
use crate::app::screen::arena_view::canvas::Canvas;
use crate::app::screen::arena_view::transform::constrain_to;
use crate::app::screen::theme::SMALL;
use crate::scenario::Diagnostic;

/// Largest width of the card, in points.
const MAX_WIDTH: f32 = 250.0;
/// Distance from the item to the card, in points.
const GAP: f32 = 16.0;

/// Draws the card next to the item.
pub fn draw(canvas: &Canvas, editor: &Editor) {
    let (palette, painter) = (&canvas.palette, &canvas.painter);
    let problem = shown_problem(canvas, editor).map(|shown| (shown, palette.error));
    let note = || shown_note(canvas, editor).map(|shown| (shown, palette.warning));
    let Some(((item, problem), color)) = problem.or_else(note) else { return };
    let width = MAX_WIDTH.min(canvas.transform.rect.width() - 40.0).max(80.0);
    let text = painter.layout(problem.message.clone(), FontId::proportional(SMALL), color, width);
    let card = card_rect(canvas, item, text.size() + vec2(16.0, 10.0));
    canvas.card_background(card);
    painter.galley(card.min + vec2(8.0, 5.0), text, color);
}

/// The problem to show, with the bounding box of its item. The selected item's problems come first.
fn shown_problem<'e>(canvas: &Canvas, editor: &'e Editor) -> Option<(Rect, &'e Diagnostic)> {
    let selected = editor.selection();
    if selected == Selection::Nothing {
        return None;
    }
    let located = |problem: &'e Diagnostic| (Selection::from_field_path(&problem.path), problem);
    let mut problems: Vec<_> = editor.diagnostics().iter().map(located).collect();
    problems.retain(|(item, _)| *item == selected || editor.dragged().is_some());
    problems.sort_by_key(|(item, _)| *item != selected);
    problems
        .into_iter()
        .find_map(|(item, problem)| Some((outlines::screen_rect(canvas, editor.scenario(), item)?, problem)))
}

/// The first note on the selected item, and the item's bounding box.
fn shown_note<'e>(canvas: &Canvas, editor: &'e Editor) -> Option<(Rect, &'e Diagnostic)> {
    let selected = editor.selection();
    let mut notes = editor.notes().iter().map(|note| &note.diagnostic);
    let note = notes.find(|note| Selection::from_field_path(&note.path) == selected)?;
    Some((outlines::screen_rect(canvas, editor.scenario(), selected)?, note))
}

/// The rectangle of a card of this `size`: below the item, or above it where the canvas ends.
fn card_rect(canvas: &Canvas, item: Rect, size: Vec2) -> Rect {
    let view = canvas.transform.rect.shrink(6.0);
    let below = pos2(item.center().x - size.x / 2.0, item.bottom() + GAP);
    let above = pos2(below.x, item.top() - GAP - size.y);
    let corner = if below.y + size.y > view.bottom() - 24.0 { above } else { below };
    constrain_to(Rect::from_min_size(corner, size), view)
}
