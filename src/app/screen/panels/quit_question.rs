//! The question before the app closes, if unsaved training would be lost.

use egui::{Key, Rect, RichText, Ui, vec2};

use crate::app::app_status::AppStatus;
use crate::app::commands::Command;
use crate::app::screen::numbers;
use crate::app::screen::theme::{BODY, GAP, Palette};
use crate::app::screen::widgets::buttons::{primary_button_ui, wide_button_ui};
use crate::app::screen::widgets::question::question_ui;
use crate::app::screen::widgets::text::weak_text;

const WIDTH: f32 = 248.0;
const BUTTON_HEIGHT: f32 = 30.0;

/// Draws the question in the middle of `canvas`, if it is open. Escape cancels.
pub fn quit_question_ui(ui: &Ui, canvas: Rect, status: &AppStatus, commands: &mut Vec<Command>) {
    if !status.quit_question {
        return;
    }
    question_ui(ui, canvas, "quit", WIDTH, |ui| {
        let palette = Palette::from_ui(ui);
        let text = format!("This training run ({}) is not saved.", numbers::format_episodes(status.episodes));
        ui.label(RichText::new(text).size(BODY).color(palette.text));
        ui.label(weak_text("The run can be saved in the folder runs."));
        ui.add_space(GAP);
        if primary_button_ui(ui, "Save run and quit", BODY, vec2(WIDTH, BUTTON_HEIGHT)).clicked() {
            commands.push(Command::Quit { save: true });
        }
        if wide_button_ui(ui, "Quit without saving", BUTTON_HEIGHT).clicked() {
            commands.push(Command::Quit { save: false });
        }
        let cancel = wide_button_ui(ui, "Cancel", BUTTON_HEIGHT).clicked();
        if cancel || ui.input(|input| input.key_pressed(Key::Escape)) {
            commands.push(Command::KeepOpen);
        }
    });
}
