//! The panels around the arena: setup (or the editor) and plots, at the sides or, in a narrow window, below.

use egui::containers::panel::PanelState;
use egui::{Frame, Id, Margin, Panel, Rangef, Ui};

use super::bottom_panel::{BottomPanel, visible_bottom_panel};
use super::input::ScreenInput;
use super::panels::setup;
use super::{editor, plots};
use crate::app::app_status::AppStatus;
use crate::app::commands::{Command, SessionMode};
use crate::app::view_state::ViewState;

const SETUP_WIDTH: f32 = 248.0;
const PLOTS_MARGIN: Margin = Margin { left: 14, right: 4, top: 10, bottom: 0 };
const PLOTS_MIN_WIDTH: f32 = 240.0;
/// The bottom panel's height as a fraction of a narrow window's height below the toolbar.
const BOTTOM_FRACTION: f32 = 0.45;

/// Draws the panel below the arena in a narrow window.
pub fn bottom_panel_ui(
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
        .exact_size(ui.available_height() * BOTTOM_FRACTION)
        .resizable(false)
        .frame(Frame::side_top_panel(ui.style()).inner_margin(margin));
    panel.show(ui, |ui| match below {
        BottomPanel::Setup => left_panel_ui(ui, view, view_state, commands),
        BottomPanel::Plots => right_panel_ui(ui, view, view_state, commands),
    });
}

/// Draws the panel on the left. Its edge is fixed; a button in the toolbar opens and closes it.
pub fn setup_panel_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    // egui leaves `open` as it is, because the edge cannot be dragged; the contents may change `setup_open`.
    let mut open = view_state.setup_open;
    let panel = Panel::left("setup")
        .exact_size(SETUP_WIDTH)
        .resizable(false)
        .frame(Frame::side_top_panel(ui.style()).inner_margin(Margin::ZERO));
    panel.show_collapsible(ui, &mut open, |ui| left_panel_ui(ui, view, view_state, commands));
    view_state.setup_open &= open;
}

/// Draws the setup panel, or the panel of the editor while a scenario is edited.
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

/// Draws the plots on the right. The user can drag the edge; the width is remembered.
pub fn plots_panel_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let id = Id::new("plots");
    let width = |ui: &Ui| PanelState::load(ui.ctx(), id).map(|panel| panel.size().x);
    let (before, available) = (width(ui), ui.available_width());
    let range = Rangef::new(PLOTS_MIN_WIDTH, (available * 0.6).max(PLOTS_MIN_WIDTH + 20.0));
    let wanted = view_state
        .plots_width
        .filter(|width| width.is_finite())
        .unwrap_or((available * 0.34).clamp(310.0, 460.0));
    let mut open = view_state.plots_open;
    let frame = Frame::side_top_panel(ui.style());
    let panel = Panel::right(id)
        .default_size(range.clamp(wanted))
        .size_range(range)
        .drag_to_open(false)
        .frame(frame.inner_margin(PLOTS_MARGIN));
    panel.show_collapsible(ui, &mut open, |ui| right_panel_ui(ui, view, view_state, commands));
    // Remember the width only when the user releases the edge, not when the window shrinks.
    let after = width(ui);
    if open && before.is_some() && after != before && ui.input(|i| i.pointer.any_released()) {
        view_state.plots_width = after;
    }
    view_state.plots_open &= open;
}

/// Draws the plots.
fn right_panel_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let more_open = &mut view_state.interaction.more_plots_open;
    plots::plots_ui(ui, view.history, plot_context(view.status), more_open, commands);
}

fn plot_context(status: &AppStatus) -> plots::PlotContext {
    plots::PlotContext {
        is_paper_scenario_1: status.is_paper_scenario_1,
        is_training: status.mode == SessionMode::Train,
        best: status.best.map(|best| (best.env_steps, best.success_rate)),
        has_disk: status.has_disk,
    }
}
