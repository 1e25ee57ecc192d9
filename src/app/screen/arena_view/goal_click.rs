//! Sets the goal by a click on free floor, while a policy, a driver or the user drives.
//!
//! In: the pointer over an arena. Out: [`Command::SetGoal`], and a preview of the goal under the pointer.

use bevy::math::Vec2;
use egui::{CursorIcon, Response, Stroke, Ui};

use super::canvas::Canvas;
use super::{drag_target, silhouette};
use crate::app::commands::{Command, SessionMode};
use crate::app::moves::{Movable, MoveRequest, check_move};
use crate::app::screen::input::ScreenInput;

/// Handles the pointer over free floor in arena `index`: shows where the goal would be, and sends it on a click.
pub fn update(
    ui: &Ui,
    response: &Response,
    canvas: &Canvas,
    view: &ScreenInput<'_>,
    index: usize,
    commands: &mut Vec<Command>,
) {
    let pointer = response.interact_pointer_pos().or(response.hover_pos());
    let (Some(arena), Some(at)) = (view.scene.arenas.get(index), pointer) else { return };
    if view.status.mode == SessionMode::Train || response.dragged() || !response.contains_pointer() {
        return;
    }
    let to_m = canvas.transform.to_world(at);
    let request = MoveRequest { arena: index, object: Movable::Goal, to_m: Vec2::from(to_m) };
    if check_move(&drag_target::move_context(arena), request.object, request.to_m).is_err() {
        return;
    }
    // A double-click fits the view. Its second click, and further ones, are not for the goal.
    if response.clicked() && !response.double_clicked() && !response.triple_clicked() {
        commands.push(Command::SetGoal(request));
    }
    ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
    if let Some(outline) = drag_target::silhouette(arena, Movable::Goal, Some(to_m)) {
        let color = canvas.palette.success;
        silhouette::draw(
            canvas,
            &outline,
            color.gamma_multiply(0.12),
            Stroke::new(1.5, color.gamma_multiply(0.6)),
        );
    }
    response.clone().on_hover_text_at_pointer("Click: set the goal here");
}
