//! Dragging the robot, the goal or an obstacle with the pointer.
//!
//! In: the pointer and one arena. Out: [`Command::Move`] while an object is dragged, and the drag itself. The
//! object under the pointer when the button is pressed stays the dragged one, even if it moves away from the pointer.

use egui::{PointerButton, Response, Ui};

use super::drag_target::{centre_of, hit_test, move_context};
use super::transform::ViewTransform;
use crate::app::commands::Command;
use crate::app::interaction::ActiveDrag;
use crate::app::moves::{Movable, MoveRequest, check_move};
use crate::app::screen::input::ScreenInput;

/// The tooltip of an object that can be dragged.
pub fn tooltip(object: Movable) -> &'static str {
    match object {
        Movable::Goal => "Goal: drag to move",
        Movable::Robot => "Robot: drag to move",
        Movable::Obstacle(_) => "Obstacle: drag to move it in all arenas",
    }
}

/// Starts, continues or ends the drag in the view of arena `index`. Returns the drag in progress
/// there, once the pointer has moved.
pub fn update(
    ui: &Ui,
    response: &Response,
    transform: &ViewTransform,
    input: &ScreenInput<'_>,
    index: usize,
    drag: &mut Option<ActiveDrag>,
    commands: &mut Vec<Command>,
) -> Option<ActiveDrag> {
    let arena = input.scene.arenas.get(index)?;
    if response.is_pointer_button_down_on() && ui.input(|state| state.pointer.primary_pressed()) {
        let pressed = ui.input(|state| state.pointer.press_origin());
        *drag = pressed.and_then(|at| {
            let object = hit_test(transform, arena, at)?;
            let (centre, grabbed) = (centre_of(object, arena)?, transform.to_world(at));
            let offset_m = [centre[0] - grabbed[0], centre[1] - grabbed[1]];
            Some(ActiveDrag { arena: index, object, to_m: centre, rejection: None, offset_m })
        });
    }
    let mut active = drag.clone().filter(|active| active.arena == index)?;
    if !response.is_pointer_button_down_on() || centre_of(active.object, arena).is_none() {
        *drag = None;
        return None;
    }
    // Before the pointer has moved, it may still be a click.
    let pointer = response.interact_pointer_pos().filter(|_| response.dragged_by(PointerButton::Primary))?;
    let at = transform.to_world(pointer);
    active.to_m = [at[0] + active.offset_m[0], at[1] + active.offset_m[1]];
    active.rejection = check_move(&move_context(arena), active.object, active.to_m.into()).err();
    // Unless paused, the robot would drive away from a stationary pointer, and a reached goal would be replaced:
    // send a command in every frame.
    let drifts = !input.status.paused && !matches!(active.object, Movable::Obstacle(_));
    let pointer_moved = ui.input(|state| state.pointer.delta() != egui::Vec2::ZERO);
    if active.rejection.is_none() && (pointer_moved || drifts) {
        let request = MoveRequest { arena: index, object: active.object, to_m: active.to_m.into() };
        commands.push(Command::Move(request));
    }
    *drag = Some(active.clone());
    Some(active)
}
