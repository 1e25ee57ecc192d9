//! The choice of mode in the toolbar: Train, Test, Drive, Compare, and the editor.

use egui::Ui;

use crate::app::commands::{Command, SessionMode};
use crate::app::screen::editor::confirm_exit;
use crate::app::screen::input::ScreenInput;
use crate::app::screen::key_bindings::{Shortcut, with_key_hint};
use crate::app::screen::widgets::segments::{self, Segment};
use crate::app::view_state::ViewState;

const MODES: [SessionMode; 4] =
    [SessionMode::Train, SessionMode::Test, SessionMode::Drive, SessionMode::Compare];

/// Draws the choice of mode at its natural width or `width` points wide. If nothing to compare with has been opened, Compare
/// opens the expert (a shipped policy that can drive here) or, if there is none, a file dialog.
pub(super) fn mode_switch_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    width: Option<f32>,
    commands: &mut Vec<Command>,
) {
    let opened = view.status.opened_driver.as_deref().or(view.status.opened_policy.as_deref());
    let expert = view.status.expert.as_ref().map(|expert| expert.name.as_str());
    let current = MODES.iter().position(|mode| *mode == view.status.mode);
    let editing = view_state.editor.is_some();
    let selected = if editing { Some(MODES.len()) } else { current };
    let segments = segments(opened, expert);
    let Some(clicked) = segments::segments_ui(ui, "mode", &segments, selected, width) else { return };
    let command = MODES.get(clicked).map(|mode| match (*mode, opened, expert) {
        (SessionMode::Compare, None, Some(_)) => Command::OpenExpert,
        (SessionMode::Compare, None, None) => Command::OpenDialog,
        (mode, ..) => Command::SetMode(mode),
    });
    match command {
        Some(command) if editing => {
            let command = (Some(clicked) != current).then_some(command);
            confirm_exit::request_exit(view_state, command, commands);
        }
        Some(command) => commands.push(command),
        None if !editing => confirm_exit::enter_editor(view, view_state, commands),
        None => {}
    }
}

fn segments(opened: Option<&str>, expert: Option<&str>) -> [Segment; 5] {
    let compare = match (opened, expert) {
        (Some(name), _) => format!("Compare the current policy with {name}, on the same goals"),
        (None, Some(expert)) => format!("Compare the current policy with the {expert}, or with one you open"),
        (None, None) => "Open a second policy to compare with the current one".into(),
    };
    let edit = "Edit the scenario, save it, train in it";
    [
        Segment::new("Train", "Robots explore and learn"),
        Segment::new(
            "Test",
            "Test the current policy: no exploration, no learning. Click on the floor to set the goal",
        ),
        Segment::new("Drive", "Race the policy to the same goals: steer with the arrow keys"),
        Segment::new("Compare", compare),
        Segment::new("Edit", with_key_hint(edit, Shortcut::Edit)),
    ]
}
