//! The question before a training run is discarded.

use egui::{Button, Frame, Margin, RichText, Stroke, Ui, vec2};

use crate::app::app_status::AppStatus;
use crate::app::commands::{Command, PolicySource};
use crate::app::screen::numbers;
use crate::app::screen::theme::Palette;
use crate::app::setup_form::SetupForm;

/// Sends `command`, or first opens the question if the command would discard training worth keeping.
pub(super) fn send_or_ask(
    command: Command,
    status: &AppStatus,
    form: &mut SetupForm,
    commands: &mut Vec<Command>,
) {
    if status.restart_loses_training {
        form.awaiting_confirmation = Some(command);
    } else {
        commands.push(command);
    }
}

/// Draws the question in place of the button that opened it. Its text is under the pointer, so that a double
/// click on that button does not answer it.
pub(super) fn discard_question_ui(
    ui: &mut Ui,
    status: &AppStatus,
    form: &mut SetupForm,
    commands: &mut Vec<Command>,
) {
    let palette = Palette::from_ui(ui);
    let frame = Frame::new()
        .stroke(Stroke::new(1.0, palette.warning))
        .corner_radius(5.0)
        .inner_margin(Margin::same(8));
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        let (text, answer) = question(status, form.awaiting_confirmation.as_ref());
        ui.label(RichText::new(text).color(palette.text));
        ui.horizontal(|ui| {
            ui.spacing_mut().button_padding.x = 2.0;
            let size = vec2((ui.available_width() - 2.0 * ui.spacing().item_spacing.x) / 3.0, 26.0);
            let save_first =
                ui.add_sized(size, Button::new("Save first")).on_hover_text(save_help(status)).clicked();
            let discard = ui.add_sized(size, Button::new(answer)).clicked();
            let cancel = ui.add_sized(size, Button::new("Cancel")).clicked();
            if save_first || discard {
                let asked = form.awaiting_confirmation.take().map(|asked| with_current_choices(&asked, form));
                commands.extend(
                    asked.map(|asked| if save_first { Command::SaveFirst(Box::new(asked)) } else { asked }),
                );
            } else if cancel {
                form.awaiting_confirmation = None;
            }
        });
    });
}

fn save_help(status: &AppStatus) -> &'static str {
    if status.has_disk {
        "Save the run in the folder runs, then continue"
    } else {
        "Save the policy, then continue"
    }
}

/// The command that was asked about, with the choices as they are now: the user may have changed them since.
fn with_current_choices(asked: &Command, form: &SetupForm) -> Command {
    match asked {
        Command::StartTraining { .. } => form.start_training(),
        Command::Transfer { policy, .. } => form.transfer(*policy),
        other => other.clone(),
    }
}

/// The question to ask before `asked` is sent, and the text of the button that confirms it.
fn question(status: &AppStatus, asked: Option<&Command>) -> (String, &'static str) {
    let episodes = numbers::format_episodes(status.episodes);
    match asked {
        Some(Command::Transfer { policy: PolicySource::Current | PolicySource::Best, .. }) => {
            (format!("End this training run ({episodes})? Its policy continues."), "Continue")
        }
        _ => (format!("Discard this training run ({episodes})?"), "Discard"),
    }
}
