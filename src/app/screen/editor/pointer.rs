//! The pointer on the world that is edited: it selects, drags, and draws corner by corner.
//!
//! In: the pointer, the [`Editor`]. Out: the editor's changes, and what is under the pointer or in its hand. A press
//! selects; what was pressed is dragged from where it was pressed, once the pointer has moved.

use bevy::math;
use egui::{CursorIcon, Id, PointerButton, Pos2, Response, Ui, Vec2};

use super::handles;
use crate::app::editor::{Editor, HandleKind, Selection, Tool};
use crate::app::screen::arena_view::transform::ViewTransform;

/// So far beside a small thing, in points, it is still hit.
const SLACK: f32 = 5.0;
/// The same by a finger.
const SLACK_TOUCH: f32 = 14.0;

/// What is under the pointer, or in its hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointerHit {
    /// The floor.
    Nothing,
    /// A handle of what is selected.
    Handle(HandleKind),
    /// A thing.
    Body(Selection),
}

/// What was pressed, and where in the world, in m.
type Pressed = Option<(PointerHit, math::Vec2)>;

fn hand() -> Id {
    Id::new("wayfield editor hand")
}

/// Follows the pointer; gives what is under it, or while something is dragged what that is.
pub fn update(ui: &Ui, response: &Response, transform: &ViewTransform, editor: &mut Editor) -> PointerHit {
    let free = ui.input(|input| input.modifiers.alt);
    let place = |at: Pos2| -> math::Vec2 { transform.to_world(at).into() };
    let at = response.interact_pointer_pos();
    if response.is_pointer_button_down_on() && ui.input(|input| input.pointer.primary_pressed()) {
        let pressed = ui.input(|input| input.pointer.press_origin());
        let pressed = pressed.map(|at| press(ui, transform, editor, at));
        ui.data_mut(|data| data.insert_temp(hand(), pressed));
    }
    let mut pressed = ui.data(|data| data.get_temp::<Pressed>(hand())).flatten();
    // A tap may begin and end within a frame.
    if let (None, true, Some(at)) = (pressed, response.clicked(), at) {
        pressed = Some(press(ui, transform, editor, at));
    }
    if !response.is_pointer_button_down_on() {
        if let Some(at) = at.filter(|_| response.drag_stopped()) {
            editor.drag_to(place(at), free);
        }
        click(ui, response, transform, editor, pressed, free);
        editor.end_drag();
        if pressed.take().is_some() {
            ui.data_mut(|data| data.insert_temp(hand(), None::<(PointerHit, math::Vec2)>));
        }
        let hovered = response.hover_pos().filter(|_| response.contains_pointer());
        return hovered.map_or(PointerHit::Nothing, |at| under(ui, transform, editor, at));
    }
    if let Some((what, from_m)) = pressed
        && response.drag_started_by(PointerButton::Primary)
        && !take(ui, editor, what, from_m)
    {
        pressed = Some((PointerHit::Nothing, from_m));
        ui.data_mut(|data| data.insert_temp(hand(), pressed));
    }
    if let Some(at) = at.filter(|_| editor.dragged().is_some() && response.dragged()) {
        editor.drag_to(place(at), free);
    }
    match (editor.dragged(), pressed) {
        (Some(kind), _) => PointerHit::Handle(kind),
        (None, Some((what, _))) => what,
        (None, None) => PointerHit::Nothing,
    }
}

/// What is pressed at `at`; a thing is selected by that.
fn press(ui: &Ui, transform: &ViewTransform, editor: &mut Editor, at: Pos2) -> (PointerHit, math::Vec2) {
    let what = under(ui, transform, editor, at);
    if let PointerHit::Body(selection) = what {
        editor.select(selection);
    }
    (what, transform.to_world(at).into())
}

/// What is under `at`; with a tool only the floor.
fn under(ui: &Ui, transform: &ViewTransform, editor: &Editor, at: Pos2) -> PointerHit {
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

/// Begins to drag what was pressed; says no if it can't be dragged.
fn take(ui: &Ui, editor: &mut Editor, what: PointerHit, from_m: math::Vec2) -> bool {
    match what {
        PointerHit::Nothing => false,
        PointerHit::Handle(kind) => editor.begin_drag(kind, from_m),
        PointerHit::Body(_) => {
            let alone = ui.input(|input| input.modifiers.shift);
            (alone && editor.begin_drag(HandleKind::PathStart, from_m))
                || editor.begin_drag(HandleKind::Middle, from_m)
        }
    }
}

/// What a click, a double click or the other button does.
fn click(
    ui: &Ui,
    response: &Response,
    transform: &ViewTransform,
    editor: &mut Editor,
    pressed: Pressed,
    free: bool,
) {
    let drawing = *editor.tool() != Tool::Select;
    let at = response.interact_pointer_pos();
    if drawing && (response.double_clicked() || response.secondary_clicked()) {
        editor.finish_tool();
    } else if let (true, true, Some(at)) = (drawing, response.clicked(), at) {
        editor.click_with_tool(transform.to_world(at).into(), free);
    } else if response.double_clicked() {
        let knob = at.map(|at| under(ui, transform, editor, at));
        match knob {
            Some(PointerHit::Handle(kind)) if kind.is_insert() => {
                editor.begin_drag(kind, at.map_or(math::vec2(0.0, 0.0), |at| transform.to_world(at).into()));
            }
            Some(PointerHit::Handle(kind)) => {
                editor.remove_handle(kind);
            }
            _ => {}
        }
    } else if response.clicked() && matches!(pressed, Some((PointerHit::Nothing, _))) {
        editor.select(Selection::Nothing);
    }
}

/// Shows by the pointer's form what it would do.
pub fn set_cursor_icon(
    ui: &Ui,
    response: &Response,
    transform: &ViewTransform,
    editor: &Editor,
    under: PointerHit,
) {
    if !(response.contains_pointer() || response.is_pointer_button_down_on()) {
        return;
    }
    let dragged = editor.dragged().is_some();
    let icon = match under {
        _ if *editor.tool() != Tool::Select => CursorIcon::Crosshair,
        PointerHit::Nothing => return,
        PointerHit::Handle(HandleKind::Middle) | PointerHit::Body(_) if dragged => CursorIcon::Grabbing,
        PointerHit::Body(Selection::Enclosure) => CursorIcon::PointingHand,
        PointerHit::Body(_) | PointerHit::Handle(HandleKind::Middle) => CursorIcon::Move,
        PointerHit::Handle(kind) if kind.is_insert() => CursorIcon::Copy,
        PointerHit::Handle(HandleKind::Rotate) => {
            if dragged {
                CursorIcon::Grabbing
            } else {
                CursorIcon::Grab
            }
        }
        PointerHit::Handle(kind) => resizing(transform, editor, kind),
    };
    ui.ctx().set_cursor_icon(icon);
}

/// The double arrow across a side; a cross of arrows for what goes anywhere.
fn resizing(transform: &ViewTransform, editor: &Editor, kind: HandleKind) -> CursorIcon {
    let sized = matches!(
        kind,
        HandleKind::Side(..) | HandleKind::Radius | HandleKind::CapsuleEnd(_) | HandleKind::WalkReach
    );
    let knobs = handles::screen_handles(transform, editor);
    let knob = knobs.iter().find(|knob| knob.handle.kind == kind);
    let middle = handles::center(transform, editor);
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
