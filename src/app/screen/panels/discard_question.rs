//! The question before a training is discarded.

use egui::{Button, Frame, Margin, RichText, Stroke, Ui, vec2};

use crate::app::app_snapshot::AppSnapshot;
use crate::app::commands::{Command, PolicySource};
use crate::app::screen::numbers;
use crate::app::screen::theme::Palette;
use crate::app::setup_form::SetupForm;

/// The width of the Cancel button, in points.
const CANCEL_WIDTH: f32 = 74.0;

/// Sends `command`, or first opens the question if the command would discard a training worth keeping.
pub(super) fn send_or_ask(
    command: Command,
    status: &AppSnapshot,
    form: &mut SetupForm,
    commands: &mut Vec<Command>,
) {
    if status.restart_loses_training {
        form.awaiting_confirmation = Some(command);
    } else {
        commands.push(command);
    }
}

/// Draws the question in place of the button that asked it. Its text is under the pointer, so that a double
/// click on that button does not answer it.
pub(super) fn discard_question_ui(
    ui: &mut Ui,
    status: &AppSnapshot,
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
            let width = ui.available_width() - ui.spacing().item_spacing.x - CANCEL_WIDTH;
            let discard = ui.add_sized(vec2(width, 26.0), Button::new(answer)).clicked();
            let cancel = ui.add_sized(vec2(CANCEL_WIDTH, 26.0), Button::new("Cancel")).clicked();
            if discard {
                let asked = form.awaiting_confirmation.take();
                commands.extend(asked.map(|asked| with_current_choices(&asked, form)));
            } else if cancel {
                form.awaiting_confirmation = None;
            }
        });
    });
}

/// The command that was asked about, with the choices as they are now: the user may have changed them since.
fn with_current_choices(asked: &Command, form: &SetupForm) -> Command {
    match asked {
        Command::StartTraining { .. } => form.start_training(),
        Command::Transfer { policy, .. } => form.transfer(*policy),
        other => other.clone(),
    }
}

/// The question before `asked`, and the text of the button that confirms it.
fn question(status: &AppSnapshot, asked: Option<&Command>) -> (String, &'static str) {
    let episodes = if status.episodes == 1 { "episode" } else { "episodes" };
    let count = numbers::format_count(status.episodes);
    match asked {
        Some(Command::Transfer { policy: PolicySource::Current | PolicySource::Best, .. }) => {
            (format!("End this training ({count} {episodes})? Its policy continues."), "Continue")
        }
        _ => (format!("Discard this training ({count} {episodes})?"), "Discard"),
    }
}
