//! The start button in the middle of the arena, shown before anything has been learned.

use egui::{Align2, Area, Frame, Id, Margin, Rect, RichText, Stroke, Ui, vec2};

use crate::app::commands::{Command, SessionMode};
use crate::app::screen::input::ScreenInput;
use crate::app::screen::theme::{HEADING, Palette, SMALL};
use crate::app::screen::widgets::buttons;

/// Draws the start button in the middle of `arena` while training is paused at step 0 with random initial weights.
pub fn welcome_ui(ui: &mut Ui, arena: Rect, view: &ScreenInput<'_>, commands: &mut Vec<Command>) {
    let status = view.status;
    let fresh = status.env_steps == 0 && status.transfer_from.is_none();
    if !(status.paused && fresh && status.mode == SessionMode::Train) {
        return;
    }
    let palette = Palette::from_ui(ui);
    Area::new(Id::new("welcome"))
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(arena.center())
        .constrain_to(arena)
        .show(ui.ctx(), |ui| {
            let frame = Frame::new()
                .fill(palette.panel)
                .stroke(Stroke::new(1.0, palette.border))
                .corner_radius(10.0)
                .shadow(ui.visuals().popup_shadow)
                .inner_margin(Margin::same(18));
            frame.show(ui, |ui| {
                ui.set_width(210.0);
                ui.vertical_centered(|ui| {
                    if buttons::primary_button_ui(ui, "Start learning", HEADING, vec2(210.0, 42.0)).clicked()
                    {
                        commands.push(Command::Pause(false));
                    }
                    ui.add_space(4.0);
                    let text = "The robot knows nothing yet. It learns by trial and error to reach the goal.";
                    ui.label(RichText::new(text).size(SMALL).color(palette.weak_text));
                });
            });
        });
}
