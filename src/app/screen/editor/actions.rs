//! The buttons at the bottom of the editor's panel: continue or restart training in the edited scenario, or save it.
//!
//! A restart that would discard a training run worth keeping needs a confirmation.

use egui::{Button, Frame, Margin, Response, RichText, Stroke, Ui, Vec2, vec2};

use super::controls::button_row_ui;
use crate::app::app_status::AppStatus;
use crate::app::commands::Command;
use crate::app::editor::{Editor, EditorInteraction};
use crate::app::screen::input::ScreenInput;
use crate::app::screen::numbers;
use crate::app::screen::theme::{BODY, GAP, Palette};
use crate::app::screen::widgets::buttons;
use crate::app::screen::widgets::text::weak_text;
use crate::scenario::Scenario;

/// Height of the wide buttons, in points.
const HEIGHT: f32 = 30.0;

/// The action that the user has chosen for the scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Continue the training in the edited scenario.
    Continue,
    /// Begin a new training run in the edited scenario.
    Restart,
    /// Like [`Action::Restart`], after saving the current training run.
    SaveAndRestart,
    /// Close the editor.
    Close,
}

/// Shows the buttons.
pub fn actions_ui(
    ui: &mut Ui,
    input: &ScreenInput<'_>,
    editor: &mut Editor,
    interaction: &mut EditorInteraction,
    commands: &mut Vec<Command>,
) -> Option<Action> {
    ui.add_space(GAP);
    let blocker = continue_blocker(input, editor);
    interaction.confirm_restart &= restart_blocker(editor).is_none();
    // The question is above the buttons, which are disabled meanwhile: a double-click on one cannot answer the question.
    let asking = interaction.confirm_restart;
    let mut action = if asking { confirm_restart_ui(ui, input, interaction) } else { None };
    let size = vec2((ui.available_width() - ui.spacing().item_spacing.x) / 2.0, HEIGHT);
    ui.horizontal(|ui| {
        ui.spacing_mut().button_padding.x = 2.0;
        if continue_button_ui(ui, size, asking, blocker.as_deref()).clicked() {
            action = Some(Action::Continue);
        }
        if restart_button_ui(ui, size, asking, restart_blocker(editor)).clicked() {
            if input.status.restart_loses_training {
                editor.finish_drawing();
                interaction.confirm_restart = true;
            } else {
                action = Some(Action::Restart);
            }
        }
    });
    if let Some(reason) = &blocker {
        ui.label(weak_text(reason));
    }
    save_ui(ui, input, editor, commands);
    action
}

fn continue_button_ui(ui: &mut Ui, size: Vec2, asking: bool, blocker: Option<&str>) -> Response {
    let (text, tip) = ("Continue here", "Continue training in the edited scenario with the current weights");
    let button = if asking || blocker.is_some() {
        ui.add_enabled_ui(false, |ui| ui.add_sized(size, Button::new(text))).inner
    } else {
        buttons::primary_button_ui(ui, text, BODY, size)
    };
    button.on_hover_text(tip).on_disabled_hover_text(blocker.unwrap_or(tip))
}

fn restart_button_ui(ui: &mut Ui, size: Vec2, asking: bool, blocker: Option<&str>) -> Response {
    let tip = "Start training from scratch in the edited scenario. The current training run is discarded";
    let button = Button::new("Restart here");
    let response = ui.add_enabled_ui(blocker.is_none() && !asking, |ui| ui.add_sized(size, button)).inner;
    response.on_hover_text(tip).on_disabled_hover_text(blocker.unwrap_or(tip))
}

/// The reason why the training cannot continue in the edited scenario.
pub fn continue_blocker(input: &ScreenInput<'_>, editor: &Editor) -> Option<String> {
    if let Some(reason) = restart_blocker(editor) {
        return Some(reason.into());
    }
    if input.status.is_set {
        return Some("Training uses a set of scenarios. Restart to train in this scenario.".into());
    }
    let (edited, running) = (&**editor.scenario(), &*input.scene.scenario);
    let needs = |scenario: &Scenario| {
        let beams = input.status.needs.lidar.then(|| format!("{} beams", scenario.lidar.beams));
        let motions = input.status.needs.motions.then(|| format!("{} motions", scenario.robot.motions.len()));
        [beams, motions].into_iter().flatten().collect::<Vec<_>>().join(" and ")
    };
    let needed = needs(running);
    if needs(edited) != needed {
        return Some(format!("The network expects {needed}. Restart to train with other numbers."));
    }
    (edited == running && !editor.is_drafting()).then(|| "This scenario is already running".into())
}

/// The reason why no training run can start in the edited scenario.
pub fn restart_blocker(editor: &Editor) -> Option<&'static str> {
    (!editor.diagnostics().is_empty()).then_some("Fix the problems first")
}

fn save_ui(ui: &mut Ui, input: &ScreenInput<'_>, editor: &mut Editor, commands: &mut Vec<Command>) {
    let buttons = [
        ("Save", "Save as a RON text file; its comments are kept  (Ctrl+S)", true),
        ("Save as…", "Save to another file", true),
    ];
    let Some(clicked) = button_row_ui(ui, &buttons) else { return };
    let mut command = save_command(editor, input.status);
    if let (Command::SaveScenario { path, .. }, 1) = (&mut command, clicked) {
        *path = None;
    }
    commands.push(command);
}

/// The command that saves the scenario, to its file if it has one. An unfinished drawing becomes part of it.
pub fn save_command(editor: &mut Editor, status: &AppStatus) -> Command {
    editor.finish_drawing();
    Command::SaveScenario {
        scenario: editor.scenario().clone(),
        based_on: editor.from().to_owned(),
        path: editor.file().filter(|_| status.has_disk),
    }
}

/// Asks before the current training run is discarded.
fn confirm_restart_ui(
    ui: &mut Ui,
    input: &ScreenInput<'_>,
    interaction: &mut EditorInteraction,
) -> Option<Action> {
    let palette = Palette::from_ui(ui);
    let frame = Frame::new()
        .stroke(Stroke::new(1.0, palette.warning))
        .corner_radius(5.0)
        .inner_margin(Margin::same(8));
    let clicked = frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        let text =
            format!("Discard this training run ({})?", numbers::format_episodes(input.status.episodes));
        ui.label(RichText::new(text).color(palette.text));
        let buttons = [
            ("Save first", "Save the current training run, then start a new one", true),
            ("Discard", "Start a new training run", true),
            ("Cancel", "Keep the current training run", true),
        ];
        ui.spacing_mut().button_padding.x = 2.0;
        button_row_ui(ui, &buttons)
    });
    let clicked = clicked.inner?;
    interaction.confirm_restart = false;
    [Action::SaveAndRestart, Action::Restart].get(clicked).copied()
}
