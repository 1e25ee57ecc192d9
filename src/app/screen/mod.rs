//! The screen: the whole window, drawn anew every frame.
//!
//! In: what there is to see ([`ScreenInput`]) and what the user looks at ([`ViewState`]). Out: [`Command`]s. Nothing here reaches the
//! world or the learner, so nothing that is opened, hovered or pressed can touch what is learnt but by an order.
//!
//! | file | duty |
//! |---|---|
//! | `world/` | the middle: the arenas, what is drawn over them, and the hand on them |
//! | `editor/` | in place of it and of the setup: a world that is being changed |
//! | `plots/` | the right: how the learning goes |
//! | `panels/` | the bar at the top, the setup on the left, notices, help |
//! | `shortcuts.rs` | the keyboard: which key does what |
//! | `theme.rs` | the typeface, the scale of type, the colours |
//! | `icons.rs` | the icons, and the buttons that bear them |
//! | `numbers.rs` | numbers for people |
//!
//! In a window narrower than `NARROW` the bar has two rows, and the setup or the plots are below the world.

mod editor;
mod icons;
mod numbers;
mod panels;
mod plots;
mod shortcuts;
pub mod theme;
mod world;

use egui::containers::panel::PanelState;
use egui::{CentralPanel, Frame, Id, Margin, Panel, Rangef, ThemePreference, Ui};

use super::app_snapshot::AppSnapshot;
use super::commands::{Command, SessionMode};
use super::editor::Editor;
use super::history::History;
use super::scene::Scene;
use super::view_state::{ThemeChoice, ViewState};
use panels::{help, notices, setup, toolbar};
use theme::Palette;

/// What there is to see this frame.
#[derive(Clone, Copy)]
pub struct ScreenInput<'a> {
    /// The world.
    pub scene: &'a Scene,
    /// How the session stands.
    pub status: &'a AppSnapshot,
    /// What has happened so far.
    pub history: &'a History,
}

const SETUP_WIDTH: f32 = 248.0;
const BAR_HEIGHT: f32 = 56.0;
const PLOTS_MARGIN: Margin = Margin { left: 14, right: 4, top: 10, bottom: 0 };
const PLOTS_MIN_WIDTH: f32 = 240.0;
/// Narrower windows have no room for anything beside the world.
const NARROW: f32 = 700.0;
const NARROW_BAR_HEIGHT: f32 = 92.0;
/// The part of a narrow window under the bar that the setup or the plots take.
const BELOW: f32 = 0.45;

/// What can be seen below the world in a narrow window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BottomPanel {
    Setup,
    Plots,
}

/// What is seen there: one of the panels that are open, the plots before the setup, but not before the editor's.
fn visible_bottom_panel(view_state: &ViewState) -> Option<BottomPanel> {
    let panel_first = view_state.editor.is_some() && view_state.setup_open;
    if view_state.plots_open && !panel_first {
        Some(BottomPanel::Plots)
    } else {
        view_state.setup_open.then_some(BottomPanel::Setup)
    }
}

/// Draws the window into `ui`, and writes down what the user asks for. The typeface and the colours are those of
/// [`theme::install`].
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
    if std::mem::take(&mut view_state.open_editor) && view_state.editor.is_none() {
        editor::confirm_exit::enter_editor(view, view_state, commands);
        if let Some((_, from, world)) = &view.status.draft {
            view_state.editor = Some(Box::new(Editor::open(world.clone(), from.clone(), true)));
        }
    }
    shortcuts::handle(ui, view, view_state, commands);
    if view_state.editor.is_none() {
        world::steer::handle(ui, view, commands);
    }
    let palette = Palette::from_ui(ui);
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
    let middle = CentralPanel::default()
        .frame(Frame::new().fill(palette.background))
        .show(ui, |ui| {
            if view_state.editor.is_some() {
                editor::editor_ui(ui, view.status, view_state);
            } else {
                world::arenas_ui(ui, view, view_state, commands);
            }
        })
        .response
        .rect;
    if view_state.editor.is_none() {
        world::welcome::welcome_ui(ui, middle, view, commands);
    }
    editor::confirm_exit::confirm_exit_ui(ui, middle, view_state, commands);
    notices::notices_ui(ui, middle, &view.status.notices, commands);
    help::help_ui(ui, view_state);
}

/// The panel below the world in a narrow window.
fn bottom_panel_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let Some(below) = visible_bottom_panel(view_state) else { return };
    let (id, margin) = match below {
        BottomPanel::Setup => ("setup below", Margin::ZERO),
        BottomPanel::Plots => ("plots below", PLOTS_MARGIN),
    };
    let panel = Panel::bottom(id)
        .exact_size(ui.available_height() * BELOW)
        .resizable(false)
        .frame(Frame::side_top_panel(ui.style()).inner_margin(margin));
    panel.show(ui, |ui| match below {
        BottomPanel::Setup => left_panel_ui(ui, view, view_state, commands),
        BottomPanel::Plots => plots::plots_ui(ui, view.history, when(view.status), commands),
    });
}

/// The panel on the left. Panels can be closed by their edge, and from inside.
fn setup_panel_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let mut open = view_state.setup_open;
    let panel = Panel::left("setup")
        .exact_size(SETUP_WIDTH)
        .resizable(false)
        .frame(Frame::side_top_panel(ui.style()).inner_margin(Margin::ZERO));
    panel.show_collapsible(ui, &mut open, |ui| left_panel_ui(ui, view, view_state, commands));
    view_state.setup_open &= open;
}

/// What is in the panel on the left, or below a narrow window's world.
fn left_panel_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    if view_state.editor.is_some() {
        editor::panel::panel_ui(ui, view, view_state, commands);
    } else {
        setup::setup_ui(ui, view, view_state, commands);
    }
}

/// The panel on the right; the user may drag its edge, and finds it as it was left.
fn plots_panel_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let id = Id::new("plots");
    let width = |ui: &Ui| PanelState::load(ui.ctx(), id).map(|panel| panel.size().x);
    let (before, room) = (width(ui), ui.available_width());
    let range = Rangef::new(PLOTS_MIN_WIDTH, (room * 0.6).max(PLOTS_MIN_WIDTH + 20.0));
    let wanted =
        view_state.plots_width.filter(|width| width.is_finite()).unwrap_or((room * 0.34).clamp(310.0, 460.0));
    let mut open = view_state.plots_open;
    let frame = Frame::side_top_panel(ui.style());
    let panel = Panel::right(id)
        .default_size(range.clamp(wanted))
        .size_range(range)
        .drag_to_open(false)
        .frame(frame.inner_margin(PLOTS_MARGIN));
    panel
        .show_collapsible(ui, &mut open, |ui| plots::plots_ui(ui, view.history, when(view.status), commands));
    // egui takes note of the width when the edge is let go; a window made smaller is not the user's choice.
    let after = width(ui);
    if open && before.is_some() && after != before && ui.input(|i| i.pointer.any_released()) {
        view_state.plots_width = after;
    }
    view_state.plots_open &= open;
}

/// Under what circumstances the curves are seen.
fn when(status: &AppSnapshot) -> plots::PlotContext {
    plots::PlotContext {
        is_paper_scenario_1: status.is_paper_scenario_1,
        training: status.mode == SessionMode::Train,
        has_disk: status.has_disk,
    }
}
