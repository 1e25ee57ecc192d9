//! Dragging the robot, the goal or an obstacle with the pointer.
//!
//! In: the pointer and one arena. Out: [`Command::Move`] while something is dragged, and the drag itself. The object under
//! the pointer at the press stays the dragged one, even if it moves on meanwhile.

use egui::{Response, Ui};

use super::drag_target::{hit_test, middle_of, rejection_at};
use super::transform::ViewTransform;
use crate::app::commands::{Command, MoveRequest};
use crate::app::interaction::{ActiveDrag, DragTarget};
use crate::app::screen::input::ScreenInput;

/// The tooltip of an object that can be dragged.
pub fn tooltip(target: DragTarget) -> &'static str {
    match target {
        DragTarget::Goal => "The goal: drag it to another place",
        DragTarget::Robot => "The robot: drag it to another place",
        DragTarget::Obstacle(_) => "An obstacle: drag it, and it moves in every arena",
    }
}

/// Follows the pointer in the view of arena `index`; gives what it holds there.
pub fn update(
    ui: &Ui,
    response: &Response,
    transform: &ViewTransform,
    view: &ScreenInput<'_>,
    index: usize,
    drag: &mut Option<ActiveDrag>,
    commands: &mut Vec<Command>,
) -> Option<ActiveDrag> {
    let scene = view.scene;
    let arena = scene.arenas.get(index)?;
    if response.is_pointer_button_down_on() && ui.input(|input| input.pointer.any_pressed()) {
        let pressed = ui.input(|input| input.pointer.press_origin());
        *drag = pressed.and_then(|at| {
            let drag_target = hit_test(transform, scene, arena, at)?;
            let (middle, taken) = (middle_of(drag_target, arena)?, transform.to_world(at));
            let offset_m = [middle[0] - taken[0], middle[1] - taken[1]];
            Some(ActiveDrag { arena: index, drag_target, to_m: middle, rejection: None, offset_m })
        });
    }
    let mut held = (*drag).filter(|held| held.arena == index)?;
    if !response.is_pointer_button_down_on() || middle_of(held.drag_target, arena).is_none() {
        *drag = None;
        return None;
    }
    // Until it is dragged, it may still be a click.
    let pointer = response.interact_pointer_pos().filter(|_| response.dragged())?;
    let at = transform.to_world(pointer);
    held.to_m = [at[0] + held.offset_m[0], at[1] + held.offset_m[1]];
    held.rejection = rejection_at(arena, held.drag_target, held.to_m);
    // A robot would drive out of a hand that rests, and a goal that it reaches would go elsewhere.
    let slips = !view.status.paused && !matches!(held.drag_target, DragTarget::Obstacle(_));
    let moves = ui.input(|input| input.pointer.delta() != egui::Vec2::ZERO);
    if held.rejection.is_none() && (moves || slips) {
        let to_m = held.to_m.into();
        commands.push(Command::Move(match held.drag_target {
            DragTarget::Goal => MoveRequest::Goal { arena: index, to_m },
            DragTarget::Robot => MoveRequest::Robot { arena: index, to_m },
            DragTarget::Obstacle(obstacle) => MoveRequest::Obstacle { arena: index, index: obstacle, to_m },
        }));
    }
    *drag = Some(held);
    Some(held)
}
