//! The pointer on the world that is edited: it selects, drags, and draws corner by corner.
//!
//! In: the pointer, the [`Editor`]. Out: the editor's changes, and what is under the pointer or in its hand. A press
//! selects; what was pressed is dragged from where it was pressed, once the pointer has moved.

use egui::{CursorIcon, Id, PointerButton, Pos2, Response, Ui, Vec2};

use super::handles;
use crate::app::editor::{Editor, HandleKind, Selection, Tool};
use crate::app::screen::world::plane::Plane;

/// So far beside a small thing, in points, it is still hit.
const SLACK: f32 = 5.0;
/// The same by a finger.
const SLACK_TOUCH: f32 = 14.0;

/// What is under the pointer, or in its hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Under {
    /// The floor.
    Nothing,
    /// A handle of what is selected.
    Handle(HandleKind),
    /// A thing.
    Body(Selection),
}

/// What was pressed, and where in the world, in m.
type Pressed = Option<(Under, (f32, f32))>;

fn hand() -> Id {
    Id::new("wayfield editor hand")
}

/// Follows the pointer; gives what is under it, or while something is dragged what that is.
pub fn follow(ui: &Ui, response: &Response, plane: &Plane, editor: &mut Editor) -> Under {
    let free = ui.input(|input| input.modifiers.alt);
    let place = |at: Pos2| -> (f32, f32) { plane.to_world(at).into() };
    let at = response.interact_pointer_pos();
    if response.is_pointer_button_down_on() && ui.input(|input| input.pointer.primary_pressed()) {
        let pressed = ui.input(|input| input.pointer.press_origin());
        let pressed = pressed.map(|at| press(ui, plane, editor, at));
        ui.data_mut(|data| data.insert_temp(hand(), pressed));
    }
    let mut pressed = ui.data(|data| data.get_temp::<Pressed>(hand())).flatten();
    // A tap may begin and end within a frame.
    if let (None, true, Some(at)) = (pressed, response.clicked(), at) {
        pressed = Some(press(ui, plane, editor, at));
    }
    if !response.is_pointer_button_down_on() {
        if let Some(at) = at.filter(|_| response.drag_stopped()) {
            editor.drag_to(place(at), free);
        }
        click(ui, response, plane, editor, pressed, free);
        editor.end_drag();
        if pressed.take().is_some() {
            ui.data_mut(|data| data.insert_temp(hand(), None::<(Under, (f32, f32))>));
        }
        let hovered = response.hover_pos().filter(|_| response.contains_pointer());
        return hovered.map_or(Under::Nothing, |at| under(ui, plane, editor, at));
    }
    if let Some((what, from_m)) = pressed
        && response.drag_started_by(PointerButton::Primary)
        && !take(ui, editor, what, from_m)
    {
        pressed = Some((Under::Nothing, from_m));
        ui.data_mut(|data| data.insert_temp(hand(), pressed));
    }
    if let Some(at) = at.filter(|_| editor.dragged().is_some() && response.dragged()) {
        editor.drag_to(place(at), free);
    }
    match (editor.dragged(), pressed) {
        (Some(kind), _) => Under::Handle(kind),
        (None, Some((what, _))) => what,
        (None, None) => Under::Nothing,
    }
}

/// What is pressed at `at`; a thing is selected by that.
fn press(ui: &Ui, plane: &Plane, editor: &mut Editor, at: Pos2) -> (Under, (f32, f32)) {
    let what = under(ui, plane, editor, at);
    if let Under::Body(selection) = what {
        editor.select(selection);
    }
    (what, plane.to_world(at).into())
}

/// What is under `at`; with a tool only the floor.
fn under(ui: &Ui, plane: &Plane, editor: &Editor, at: Pos2) -> Under {
    if *editor.tool() != Tool::Select {
        return Under::Nothing;
    }
    let (touch, shift) = ui.input(|input| (input.any_touches(), input.modifiers.shift));
    let slack = if touch { SLACK_TOUCH } else { SLACK };
    if let Some(kind) = handles::hit(&handles::knobs(plane, editor), at, slack + 4.0, shift) {
        return Under::Handle(kind);
    }
    match editor.pick(plane.to_world(at).into(), slack / plane.scale) {
        Selection::Nothing => Under::Nothing,
        selection => Under::Body(selection),
    }
}

/// Begins to drag what was pressed; says no if it can't be dragged.
fn take(ui: &Ui, editor: &mut Editor, what: Under, from_m: (f32, f32)) -> bool {
    match what {
        Under::Nothing => false,
        Under::Handle(kind) => editor.begin_drag(kind, from_m),
        Under::Body(_) => {
            let alone = ui.input(|input| input.modifiers.shift);
            (alone && editor.begin_drag(HandleKind::PathStart, from_m))
                || editor.begin_drag(HandleKind::Middle, from_m)
        }
    }
}

/// What a click, a double click or the other button does.
fn click(ui: &Ui, response: &Response, plane: &Plane, editor: &mut Editor, pressed: Pressed, free: bool) {
    let drawing = *editor.tool() != Tool::Select;
    let at = response.interact_pointer_pos();
    if drawing && (response.double_clicked() || response.secondary_clicked()) {
        editor.tool_end();
    } else if let (true, true, Some(at)) = (drawing, response.clicked(), at) {
        editor.tool_click(plane.to_world(at).into(), free);
    } else if response.double_clicked() {
        let knob = at.map(|at| under(ui, plane, editor, at));
        match knob {
            Some(Under::Handle(kind)) if kind.is_insert() => {
                editor.begin_drag(kind, at.map_or((0.0, 0.0), |at| plane.to_world(at).into()));
            }
            Some(Under::Handle(kind)) => {
                editor.remove_handle(kind);
            }
            _ => {}
        }
    } else if response.clicked() && matches!(pressed, Some((Under::Nothing, _))) {
        editor.select(Selection::Nothing);
    }
}

/// Shows by the pointer's form what it would do.
pub fn show_cursor(ui: &Ui, response: &Response, plane: &Plane, editor: &Editor, under: Under) {
    if !(response.contains_pointer() || response.is_pointer_button_down_on()) {
        return;
    }
    let dragged = editor.dragged().is_some();
    let icon = match under {
        _ if *editor.tool() != Tool::Select => CursorIcon::Crosshair,
        Under::Nothing => return,
        Under::Handle(HandleKind::Middle) | Under::Body(_) if dragged => CursorIcon::Grabbing,
        Under::Body(Selection::Enclosure) => CursorIcon::PointingHand,
        Under::Body(_) | Under::Handle(HandleKind::Middle) => CursorIcon::Move,
        Under::Handle(kind) if kind.is_insert() => CursorIcon::Copy,
        Under::Handle(HandleKind::Turn) => {
            if dragged {
                CursorIcon::Grabbing
            } else {
                CursorIcon::Grab
            }
        }
        Under::Handle(kind) => resizing(plane, editor, kind),
    };
    ui.ctx().set_cursor_icon(icon);
}

/// The double arrow across a side; a cross of arrows for what goes anywhere.
fn resizing(plane: &Plane, editor: &Editor, kind: HandleKind) -> CursorIcon {
    let sized =
        matches!(kind, HandleKind::Side(..) | HandleKind::Rim | HandleKind::End(_) | HandleKind::Reach);
    let knobs = handles::knobs(plane, editor);
    let knob = knobs.iter().find(|knob| knob.handle.kind == kind);
    let middle = handles::middle(plane, editor);
    match (sized, knob, middle) {
        (true, Some(knob), Some(middle)) => across(knob.at - middle),
        _ => CursorIcon::Move,
    }
}

/// The arrow for a direction on the screen, y down.
fn across(way: Vec2) -> CursorIcon {
    let eighth = (way.angle() / std::f32::consts::FRAC_PI_4).round() as i32;
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
    fn the_arrow_points_across_the_side() {
        for (way, icon) in [
            (vec2(5.0, 0.4), CursorIcon::ResizeHorizontal),
            (vec2(-5.0, 0.4), CursorIcon::ResizeHorizontal),
            (vec2(0.0, -3.0), CursorIcon::ResizeVertical),
            (vec2(2.0, -2.0), CursorIcon::ResizeNeSw),
            (vec2(-2.0, 2.0), CursorIcon::ResizeNeSw),
            (vec2(2.0, 2.0), CursorIcon::ResizeNwSe),
        ] {
            assert_eq!(across(way), icon, "{way:?}");
        }
    }
}
