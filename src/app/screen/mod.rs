//! The screen: draws the whole window, every frame.
//!
//! In: the data to draw ([`ScreenInput`]) and the user's view settings ([`ViewState`]). Out: [`Command`]s.
//! The screen affects the simulation and the learner only through commands, so drawing, hovering and opening
//! panels never change training.
//!
//! | file | purpose |
//! |---|---|
//! | `arena_view/` | the middle: the arenas, the overlays, dragging |
//! | `editor/` | the scenario editor, in place of the arenas and of the setup panel |
//! | `plots/` | the right: learning curves |
//! | `panels/` | the toolbar, the setup panel on the left, notices, help |
//! | `side_panels.rs`, `bottom_panel.rs` | the placement of the panels in wide and in narrow windows |
//! | `shortcuts.rs`, `key_bindings.rs` | the keyboard, and the table of its shortcuts |
//! | `widgets/` | icons, buttons and text shared by all of them |
//! | `theme.rs` | typeface, font sizes, colours |
//! | `numbers.rs` | number formatting |
//! | `input.rs` | the data to draw |
//!
//! Modules depend on each other in one direction: `theme`, `numbers`, `input`, `key_bindings`, `bottom_panel` and
//! `widgets` at the bottom, then `plots` and `arena_view`, then `editor`, then `panels` and `shortcuts`, then
//! `side_panels`.

mod arena_view;
mod bottom_panel;
mod editor;
mod input;
mod key_bindings;
mod numbers;
mod panels;
mod plots;
mod shortcuts;
mod side_panels;
pub mod theme;
mod widgets;

use egui::{CentralPanel, Frame, Margin, Panel, Rect, ThemePreference, Ui};

use self::panels::{help, notices, offers, quit_question, toolbar};
use self::side_panels::{bottom_panel_ui, plots_panel_ui, setup_panel_ui};
use self::theme::Palette;
use super::commands::Command;
use super::editor::Editor;
use super::view_state::{EditorSource, ThemeChoice, ViewState};

pub use self::input::ScreenInput;

/// Height of the toolbar, in points.
const BAR_HEIGHT: f32 = 56.0;
/// Windows narrower than this, in points, have no space for panels next to the arena.
const NARROW: f32 = 700.0;
/// Height of the toolbar in a narrow window, where it has two rows, in points.
const NARROW_BAR_HEIGHT: f32 = 92.0;

/// Draws the window into `ui` and appends the user's requests to `commands`. Expects the typeface and the
/// colours of [`theme::install`].
pub fn screen_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    ui.ctx().set_theme(match view_state.theme {
        ThemeChoice::System => ThemePreference::System,
        ThemeChoice::Light => ThemePreference::Light,
        ThemeChoice::Dark => ThemePreference::Dark,
    });
    view_state.followed = view_state.followed.min(view.scene.arenas.len().saturating_sub(1));
    open_requested_editor(view, view_state, commands);
    shortcuts::handle(ui, view, view_state, commands);
    if view_state.editor.is_none() {
        let asked = shortcuts::question_is_open(view, view_state);
        arena_view::steer::handle(ui, view, asked, &mut view_state.interaction.steered, commands);
    }
    toolbar_and_panels_ui(ui, view, view_state, commands);
    let middle = middle_ui(ui, view, view_state, commands);
    if view_state.editor.is_none() {
        arena_view::welcome::welcome_ui(ui, middle, view, commands);
    }
    offers::offers_ui(ui, middle, view.status, view_state.editor.as_deref(), commands);
    editor::set_question::set_question_ui(ui, middle, view, view_state, commands);
    editor::confirm_exit::confirm_exit_ui(ui, middle, view.status, view_state, commands);
    quit_question::quit_question_ui(ui, middle, view.status, commands);
    notices::notices_ui(ui, middle, &view.status.notices, commands);
    help::help_ui(ui, view_state);
}

/// Handles the request to close the window: with unsaved changes in the editor, asks about them first.
pub fn request_close(view_state: &mut ViewState, commands: &mut Vec<Command>) {
    if view_state.editor.as_ref().is_some_and(|editor| editor.is_modified()) {
        editor::confirm_exit::request_exit(view_state, Some(Command::Close), commands);
    } else {
        commands.push(Command::Close);
    }
}

/// Opens the editor if that was requested since the last frame.
fn open_requested_editor(view: &ScreenInput<'_>, view_state: &mut ViewState, commands: &mut Vec<Command>) {
    let Some(source) = view_state.open_editor.take() else { return };
    match source {
        EditorSource::RunningScenario if view_state.editor.is_none() => {
            editor::confirm_exit::enter_editor(view, view_state, commands);
        }
        EditorSource::RunningScenario => {}
        EditorSource::Draft { from, scenario, in_file } => {
            let editor = Editor::with_changes(scenario, from, in_file);
            if view_state.editor.is_some() {
                view_state.editor = Some(Box::new(editor));
            } else {
                editor::confirm_exit::show_editor(editor, view.status, view_state, commands);
            }
        }
    }
}

/// Draws the toolbar, and the panels at the sides or, in a narrow window, below.
fn toolbar_and_panels_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    if ui.available_width() < NARROW {
        let bar = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(6, 0));
        let panel = Panel::top("bar").exact_size(NARROW_BAR_HEIGHT).frame(bar);
        panel.show(ui, |ui| toolbar::narrow_toolbar_ui(ui, view, view_state, commands));
        bottom_panel_ui(ui, view, view_state, commands);
    } else {
        let bar = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(10, 0));
        let panel = Panel::top("bar").exact_size(BAR_HEIGHT).frame(bar);
        panel.show(ui, |ui| toolbar::toolbar_ui(ui, view, view_state, commands));
        setup_panel_ui(ui, view, view_state, commands);
        plots_panel_ui(ui, view, view_state, commands);
    }
}

/// Draws the arenas, or the scenario that is edited; returns their rectangle.
fn middle_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) -> Rect {
    let frame = Frame::new().fill(Palette::from_ui(ui).background);
    let panel = CentralPanel::default().frame(frame).show(ui, |ui| {
        if view_state.editor.is_some() {
            editor::editor_ui(ui, view_state);
        } else {
            arena_view::arenas_ui(ui, view, view_state, commands);
        }
    });
    panel.response.rect
}
