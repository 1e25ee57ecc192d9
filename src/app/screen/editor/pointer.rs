//! The pointer on the editor's canvas: it selects, drags, and draws click by click.
//!
//! A press selects the item under the pointer. The pressed item is dragged once the pointer moves.

use egui::{PointerButton, Pos2, Response, Ui};

use super::handles;
use crate::app::editor::{Editor, EditorInteraction, HandleKind, PointerHit, Press, Selection, Tool};
use crate::app::screen::arena_view::transform::ViewTransform;

/// Distance at which a small item is still hit, in points.
const SLACK: f32 = 5.0;
/// Distance at which a finger still hits a small item, in points.
const SLACK_TOUCH: f32 = 14.0;

/// Handles the pointer. Returns what is under it or, while a button is down, what was pressed or is dragged.
pub fn update(
    ui: &Ui,
    response: &Response,
    transform: &ViewTransform,
    editor: &mut Editor,
    interaction: &mut EditorInteraction,
) -> PointerHit {
    let free = ui.input(|input| input.modifiers.alt);
    let at = response.interact_pointer_pos();
    let is_down = response.is_pointer_button_down_on();
    if is_down && ui.input(|input| input.pointer.primary_pressed()) {
        let origin = ui.input(|input| input.pointer.press_origin());
        interaction.press = origin.map(|at| press(ui, transform, editor, at));
    }
    // A tap can begin and end within one frame.
    if let (None, true, Some(at)) = (interaction.press, response.clicked(), at) {
        interaction.press = Some(press(ui, transform, editor, at));
    }
    if !is_down {
        if let Some(at) = at.filter(|_| response.drag_stopped()) {
            editor.drag_to(transform.to_world(at).into(), free);
        }
        let press = interaction.press.take();
        click(ui, response, transform, editor, press);
        editor.end_drag();
        let hovered = response.hover_pos().filter(|_| response.contains_pointer());
        return hovered.map_or(PointerHit::Nothing, |at| hit_at(ui, transform, editor, at));
    }
    if let Some(press) = &mut interaction.press
        && response.drag_started_by(PointerButton::Primary)
        && !begin_drag(ui, editor, *press)
    {
        press.hit = PointerHit::Nothing;
    }
    if let Some(at) = at.filter(|_| editor.dragged().is_some() && response.dragged()) {
        editor.drag_to(transform.to_world(at).into(), free);
    }
    let pressed = interaction.press.map_or(PointerHit::Nothing, |press| press.hit);
    editor.dragged().map_or(pressed, PointerHit::Handle)
}

/// Selects the item at `at`. Returns the press.
fn press(ui: &Ui, transform: &ViewTransform, editor: &mut Editor, at: Pos2) -> Press {
    let hit = hit_at(ui, transform, editor, at);
    if let PointerHit::Body(selection) = hit {
        editor.select(selection);
    }
    Press { hit, position_m: transform.to_world(at).into() }
}

/// The handle or item at `at`; with a drawing tool, always [`PointerHit::Nothing`].
fn hit_at(ui: &Ui, transform: &ViewTransform, editor: &Editor, at: Pos2) -> PointerHit {
    if *editor.tool() != Tool::Select {
        return PointerHit::Nothing;
    }
    let (touch, shift) = ui.input(|input| (input.any_touches(), input.modifiers.shift));
    let slack = if touch { SLACK_TOUCH } else { SLACK };
    if let Some(kind) = handles::hit_test(&handles::screen_handles(transform, editor), at, slack + 4.0, shift)
    {
        return PointerHit::Handle(kind);
    }
    match editor.pick(transform.to_world(at).into(), slack / transform.scale) {
        Selection::Nothing => PointerHit::Nothing,
        selection => PointerHit::Body(selection),
    }
}

/// Begins to drag the pressed handle or item. Returns whether it can be dragged.
fn begin_drag(ui: &Ui, editor: &mut Editor, Press { hit, position_m }: Press) -> bool {
    match hit {
        PointerHit::Nothing => false,
        PointerHit::Handle(kind) => editor.begin_drag(kind, position_m),
        PointerHit::Body(_) => {
            let without_path = ui.input(|input| input.modifiers.shift);
            (without_path && editor.begin_drag(HandleKind::PathStart, position_m))
                || editor.begin_drag(HandleKind::Middle, position_m)
        }
    }
}

/// Handles a click, a double-click or a secondary click.
fn click(ui: &Ui, response: &Response, transform: &ViewTransform, editor: &mut Editor, press: Option<Press>) {
    let drawing = *editor.tool() != Tool::Select;
    let at = response.interact_pointer_pos();
    let free = ui.input(|input| input.modifiers.alt);
    if drawing && (response.double_clicked() || response.secondary_clicked()) {
        editor.finish_tool();
    } else if let (true, true, Some(at)) = (drawing, response.clicked(), at) {
        editor.click_with_tool(transform.to_world(at).into(), free);
    } else if response.double_clicked() {
        double_click(ui, transform, editor, at);
    } else if response.clicked() && press.is_some_and(|press| press.hit == PointerHit::Nothing) {
        editor.select(Selection::Nothing);
    }
}

/// Handles a double-click: on a handle, inserts or removes its point.
fn double_click(ui: &Ui, transform: &ViewTransform, editor: &mut Editor, at: Option<Pos2>) {
    let Some(at) = at else { return };
    match hit_at(ui, transform, editor, at) {
        PointerHit::Handle(kind) if kind.is_insert() => {
            editor.begin_drag(kind, transform.to_world(at).into());
        }
        PointerHit::Handle(kind) => {
            editor.remove_handle(kind);
        }
        _ => {}
    }
}
