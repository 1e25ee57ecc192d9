//! Dragging the robot, the goal or an obstacle with the pointer.
//!
//! In: the pointer and one arena. Out: [`Command::Move`] while something is dragged, and the drag itself. The object under
//! the pointer at the press stays the dragged one, even if it moves on meanwhile.

use egui::{Response, Ui};

use super::drag_target::{centre_m, hit_test, rejection_at};
use super::transform::ViewTransform;
use crate::app::commands::{Command, MoveRequest};
use crate::app::interaction::{ActiveDrag, DragTarget};
use crate::app::screen::input::ScreenInput;

/// The tooltip of an object that can be dragged.
pub fn tooltip(target: DragTarget) -> &'static str {
    match target {
        DragTarget::Goal => "Goal: drag to move",
        DragTarget::Robot => "Robot: drag to move",
        DragTarget::Obstacle(_) => "Obstacle: drag to move it in all arenas",
    }
}

/// Starts, continues or ends the drag in the view of arena `index`; returns the drag in progress there.
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
            let (centre, pressed_m) = (centre_m(drag_target, arena)?, transform.to_world(at));
            let offset_m = [centre[0] - pressed_m[0], centre[1] - pressed_m[1]];
            Some(ActiveDrag { arena: index, drag_target, to_m: centre, rejection: None, offset_m })
        });
    }
    let mut active = (*drag).filter(|held| held.arena == index)?;
    if !response.is_pointer_button_down_on() || centre_m(active.drag_target, arena).is_none() {
        *drag = None;
        return None;
    }
    // Until the pointer moves, it may still be a click.
    let pointer = response.interact_pointer_pos().filter(|_| response.dragged())?;
    let at = transform.to_world(pointer);
    active.to_m = [at[0] + active.offset_m[0], at[1] + active.offset_m[1]];
    active.rejection = rejection_at(arena, active.drag_target, active.to_m);
    // Without a command in every frame the robot would drive away from a resting pointer, and a reached goal would be replaced.
    let moves_by_itself = !view.status.paused && !matches!(active.drag_target, DragTarget::Obstacle(_));
    let pointer_moved = ui.input(|input| input.pointer.delta() != egui::Vec2::ZERO);
    if active.rejection.is_none() && (pointer_moved || moves_by_itself) {
        let to_m = (active.to_m[0], active.to_m[1]);
        commands.push(Command::Move(match active.drag_target {
            DragTarget::Goal => MoveRequest::Goal { arena: index, to_m },
            DragTarget::Robot => MoveRequest::Robot { arena: index, to_m },
            DragTarget::Obstacle(obstacle) => MoveRequest::Obstacle { arena: index, index: obstacle, to_m },
        }));
    }
    *drag = Some(active);
    Some(active)
}
