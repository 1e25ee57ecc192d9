//! Entering and leaving the editor, with a question about unsaved changes.
//!
//! The simulation is paused while the editor is open, and resumes afterwards if it was running.

use egui::{Button, Rect, RichText, Ui, vec2};

use super::actions::save_command;
use crate::app::app_status::AppStatus;
use crate::app::commands::Command;
use crate::app::editor::{Editor, EditorInteraction, ExitRequest};
use crate::app::screen::input::ScreenInput;
use crate::app::screen::theme::{BODY, Palette};
use crate::app::screen::widgets::buttons::primary_button_ui;
use crate::app::screen::widgets::question::question_ui;
use crate::app::view_state::ViewState;

/// Opens the editor on the running scenario. If a newer version was saved to its file but is not running yet, opens
/// that one: otherwise the next save would overwrite it with the old one.
///
/// A set of scenarios cannot be edited: asks whether to edit a copy of one of its scenarios.
pub fn enter_editor(view: &ScreenInput<'_>, view_state: &mut ViewState, commands: &mut Vec<Command>) {
    let (scene, status) = (view.scene, view.status);
    if status.is_set {
        view_state.interaction.set_question = true;
        return;
    }
    let newer = status.saved_scenario.as_ref().filter(|(path, scenario)| {
        status.scenario_modified && *path == status.scenario_from && *scenario != scene.scenario
    });
    let (scenario, saved) =
        newer.map_or((&scene.scenario, !status.scenario_modified), |(_, scenario)| (scenario, true));
    let editor = Editor::open(scenario.clone(), status.scenario_from.clone(), saved);
    show_editor(editor, status, view_state, commands);
}

/// Shows `editor` in place of the arenas, and pauses the simulation.
pub fn show_editor(
    editor: Editor,
    status: &AppStatus,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    view_state.editor = Some(Box::new(editor));
    view_state.interaction.editor =
        EditorInteraction { resume_on_exit: !status.paused, ..EditorInteraction::default() };
    view_state.setup_open = true;
    if !status.paused {
        commands.push(Command::Pause(true));
    }
}

/// Leaves the editor and sends `then`. With unsaved changes, asks first.
pub fn request_exit(view_state: &mut ViewState, then: Option<Command>, commands: &mut Vec<Command>) {
    if view_state.editor.as_ref().is_some_and(|editor| editor.is_modified()) {
        view_state.interaction.editor.exit_request = Some(ExitRequest { then, once_saved: false });
    } else {
        exit_editor(view_state, then, commands);
    }
}

/// Leaves the editor without asking, and sends `then`.
pub fn exit_editor(view_state: &mut ViewState, then: Option<Command>, commands: &mut Vec<Command>) {
    view_state.editor = None;
    let interaction = std::mem::take(&mut view_state.interaction.editor);
    commands.extend(then);
    if interaction.resume_on_exit {
        commands.push(Command::Pause(false));
    }
}

/// Shows the question about unsaved changes in the middle of `canvas`, if it is open. If the answer was to save, leaves the
/// editor once the scenario is saved.
pub fn confirm_exit_ui(
    ui: &Ui,
    canvas: Rect,
    status: &AppStatus,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let request = view_state.interaction.editor.exit_request.clone();
    let Some((request, editor)) = request.zip(view_state.editor.as_deref()) else { return };
    if request.once_saved && !editor.is_modified() {
        return exit_editor(view_state, request.then, commands);
    }
    let text = editor.unfinished_drawing().map_or("Unsaved changes will be lost.".into(), |drawing| {
        format!("The unfinished {drawing} and all unsaved changes will be lost.")
    });
    question_ui(ui, canvas, "leave the editor", 248.0, |ui| {
        ui.label(RichText::new(text).size(BODY).color(Palette::from_ui(ui).text));
        let size = vec2(ui.available_width(), 28.0);
        if primary_button_ui(ui, "Save and leave", BODY, size).clicked() {
            commands.extend(view_state.editor.as_deref_mut().map(|editor| save_command(editor, status)));
            view_state.interaction.editor.exit_request = Some(ExitRequest { once_saved: true, ..request });
            return;
        }
        ui.horizontal(|ui| {
            let width = (ui.available_width() - ui.spacing().item_spacing.x) / 2.0;
            let size = vec2(width, 28.0);
            if ui.add_sized(size, Button::new("Discard changes")).clicked() {
                exit_editor(view_state, request.then, commands);
            }
            let stay = ui.add_sized(size, Button::new("Keep editing"));
            if stay.clicked() || ui.input(|input| input.key_pressed(egui::Key::Escape)) {
                view_state.interaction.editor.exit_request = None;
            }
        });
    });
}

/// Whether the question is open.
pub fn is_open(view_state: &ViewState) -> bool {
    view_state.editor.is_some() && view_state.interaction.editor.exit_request.is_some()
}
