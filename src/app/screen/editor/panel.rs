//! The editor's panel, from top to bottom: header, items to add, inspector, diagnostics, actions.
//!
//! In: the session's state and the [`Editor`] of the view state. Out: the editor's changes and commands.

use egui::{Frame, Margin, Panel, ScrollArea, Ui};

use super::actions::{self, Action};
use super::{add_panel, confirm_exit, diagnostics, header, inspector};
use crate::app::commands::Command;
use crate::app::editor::{Editor, EditorInteraction};
use crate::app::screen::input::ScreenInput;
use crate::app::screen::theme::GAP;
use crate::app::view_state::ViewState;

/// Minimum height of a panel that keeps diagnostics and actions visible below the rest, in points.
const TALL: f32 = 560.0;
/// Maximum height of the list of diagnostics in a tall panel, as a fraction of the app's height.
const MAX_DIAGNOSTICS_FRACTION: f32 = 0.16;

/// Shows the panel.
pub fn panel_ui(
    ui: &mut Ui,
    input: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let camera = view_state.camera;
    let ViewState { editor: Some(editor), interaction, .. } = view_state else { return };
    let interaction = &mut interaction.editor;
    let inner = Frame::new().inner_margin(Margin::symmetric(14, 12));
    let mut action = None;
    let tall = ui.available_height() >= TALL;
    if tall {
        let footer = Panel::bottom("editor footer").resizable(false).frame(inner);
        footer.show(ui, |ui| {
            let max_height = ui.ctx().content_rect().height() * MAX_DIAGNOSTICS_FRACTION;
            let list = ScrollArea::vertical().id_salt("diagnostics").max_height(max_height);
            list.show(ui, |ui| diagnostics::diagnostics_ui(ui, editor, interaction));
            action = actions::actions_ui(ui, input, editor, interaction, commands);
        });
    }
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        inner.show(ui, |ui| {
            action = header::header_ui(ui, editor).or(action);
            header::open_ui(ui, input, commands);
            separator_ui(ui);
            add_panel::add_ui(ui, editor, camera);
            separator_ui(ui);
            inspector::inspector_ui(ui, editor, interaction);
            if !tall {
                separator_ui(ui);
                diagnostics::diagnostics_ui(ui, editor, interaction);
                action = actions::actions_ui(ui, input, editor, interaction, commands).or(action);
            }
        });
    });
    if let Some(action) = action {
        let command = prepare(action, input, editor, interaction);
        perform(action, command, view_state, commands);
    }
}

/// Dismisses the question whether to restart, and finishes an unfinished drawing unless the action is to close the editor.
/// Returns the command that applies the scenario; `None` if the action is to close, or is blocked.
fn prepare(
    action: Action,
    input: &ScreenInput<'_>,
    editor: &mut Editor,
    interaction: &mut EditorInteraction,
) -> Option<Command> {
    interaction.confirm_restart = false;
    if action == Action::Close {
        return None;
    }
    editor.finish_drawing();
    let restart = action != Action::Continue;
    let blocked = match action {
        Action::Continue => actions::continue_blocker(input, editor).is_some(),
        _ => actions::restart_blocker(editor).is_some(),
    };
    let (scenario, from) = (editor.scenario().clone(), editor.from().to_owned());
    let apply = Command::ApplyScenario { scenario, from, restart };
    let command = if action == Action::SaveAndRestart { Command::SaveFirst(Box::new(apply)) } else { apply };
    (!blocked).then_some(command)
}

/// Closes the editor. [`Action::Close`] asks about unsaved changes first; the other actions send `command`, or do nothing if they
/// are blocked.
fn perform(
    action: Action,
    command: Option<Command>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    if action == Action::Close {
        confirm_exit::request_exit(view_state, None, commands);
    } else if command.is_some() {
        confirm_exit::exit_editor(view_state, command, commands);
    }
}

fn separator_ui(ui: &mut Ui) {
    ui.add_space(GAP);
    ui.separator();
    ui.add_space(GAP * 0.5);
}
