//! The toolbar: run and step buttons, pace, mode, readouts, and the buttons of the panels.
//!
//! In: the session state. Out: commands, and which panels are open.

use egui::{Align, FontId, Layout, Sense, Ui, vec2};

use super::mode_switch::mode_switch_ui;
use super::readouts;
use crate::app::commands::Command;
use crate::app::screen::bottom_panel::{BottomPanel, visible_bottom_panel};
use crate::app::screen::input::ScreenInput;
use crate::app::screen::key_bindings::{PACES, Shortcut, with_key_hint};
use crate::app::screen::theme::{BODY, GAP, Palette};
use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::segments::{self, Segment};
use crate::app::view_state::{ThemeChoice, ViewState};

/// The width at which all buttons fit into the upper of two rows, in points.
const UPPER_ROW: f32 = 348.0;
/// The width of the lower row without the mode switch, in points: success rate and two buttons.
const LOWER_ROW_WITHOUT_MODES: f32 = 134.0;
/// The natural width of the mode switch, in points.
const MODES_WIDTH: f32 = 280.0;

/// Draws the toolbar in one row.
pub fn toolbar_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    ui.horizontal_centered(|ui| {
        if setup_button_ui(ui, view_state.setup_open) {
            view_state.setup_open = !view_state.setup_open;
        }
        if ui.available_width() > 1060.0 {
            app_name_ui(ui);
        }
        ui.add_space(GAP);
        run_button_ui(ui, view, commands);
        step_button_ui(ui, commands);
        ui.add_space(2.0 * GAP);
        pace_ui(ui, view, commands);
        ui.add_space(2.0 * GAP);
        mode_switch_ui(ui, view, view_state, None, commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if plots_button_ui(ui, view_state.plots_open) {
                view_state.plots_open = !view_state.plots_open;
            }
            help_button_ui(ui, view_state);
            theme_button_ui(ui, view_state);
            ui.add_space(GAP);
            readouts::readouts_ui(ui, view.status, false);
        });
    });
}

/// Draws the toolbar in two rows, for a narrow window, where either the setup or the plots are below the
/// arena.
pub fn narrow_toolbar_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    ui.spacing_mut().item_spacing.y = 0.0;
    let row = vec2(ui.available_width(), ui.available_height() / 2.0);
    let (rightwards, leftwards) =
        (Layout::left_to_right(Align::Center), Layout::right_to_left(Align::Center));
    let bottom = visible_bottom_panel(view_state);
    ui.allocate_ui_with_layout(row, rightwards, |ui| {
        let open = bottom == Some(BottomPanel::Setup);
        if setup_button_ui(ui, open) {
            (view_state.setup_open, view_state.plots_open) = (!open, false);
        }
        run_button_ui(ui, view, commands);
        if row.x >= UPPER_ROW {
            step_button_ui(ui, commands);
        }
        pace_ui(ui, view, commands);
        ui.with_layout(leftwards, |ui| {
            let open = bottom == Some(BottomPanel::Plots);
            if plots_button_ui(ui, open) {
                (view_state.setup_open, view_state.plots_open) = (false, !open);
            }
        });
    });
    ui.allocate_ui_with_layout(row, rightwards, |ui| {
        let width = row.x - LOWER_ROW_WITHOUT_MODES;
        mode_switch_ui(ui, view, view_state, (width < MODES_WIDTH).then_some(width), commands);
        ui.with_layout(leftwards, |ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            help_button_ui(ui, view_state);
            theme_button_ui(ui, view_state);
            readouts::readouts_ui(ui, view.status, true);
        });
    });
}

fn setup_button_ui(ui: &mut Ui, open: bool) -> bool {
    let (icon, about) = (Icon::LeftPanel(open), "Show or hide the setup panel");
    icons::icon_button_ui(ui, icon, ButtonStyle::Quiet, 28.0, "Setup panel", about).clicked()
}

fn plots_button_ui(ui: &mut Ui, open: bool) -> bool {
    let (icon, about) = (Icon::RightPanel(open), "Show or hide the plots");
    icons::icon_button_ui(ui, icon, ButtonStyle::Quiet, 28.0, "Plots panel", about).clicked()
}

fn help_button_ui(ui: &mut Ui, view_state: &mut ViewState) {
    let about = with_key_hint("Help and shortcuts", Shortcut::Help);
    if icons::icon_button_ui(ui, Icon::Help, ButtonStyle::Quiet, 28.0, "Help", &about).clicked() {
        view_state.help_open = !view_state.help_open;
    }
}

fn app_name_ui(ui: &mut Ui) {
    let palette = Palette::from_ui(ui);
    let text = ui.painter().layout_no_wrap("wayfield".into(), FontId::proportional(BODY), palette.weak_text);
    let (rect, response) = ui.allocate_exact_size(vec2(text.size().x + 2.0, 28.0), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Label, true, "wayfield"));
    ui.painter().galley(rect.left_center() - vec2(0.0, text.size().y / 2.0), text, palette.weak_text);
}

fn run_button_ui(ui: &mut Ui, view: &ScreenInput<'_>, commands: &mut Vec<Command>) {
    let paused = view.status.paused;
    let (icon, style, name, about) = if paused {
        (Icon::Play, ButtonStyle::Primary, "Run", "Resume")
    } else {
        (Icon::Pause, ButtonStyle::Framed, "Pause", "Pause")
    };
    if icons::icon_button_ui(ui, icon, style, 36.0, name, &with_key_hint(about, Shortcut::Pause)).clicked() {
        commands.push(Command::Pause(!paused));
    }
}

fn step_button_ui(ui: &mut Ui, commands: &mut Vec<Command>) {
    let about = with_key_hint("Advance one control step", Shortcut::Step);
    if icons::icon_button_ui(ui, Icon::Step, ButtonStyle::Framed, 28.0, "Step", &about).clicked() {
        commands.push(Command::Step);
    }
}

fn pace_ui(ui: &mut Ui, view: &ScreenInput<'_>, commands: &mut Vec<Command>) {
    let segments: Vec<_> = PACES
        .iter()
        .enumerate()
        .map(|(k, (_, text, about))| Segment::new(text, format!("{about}  ({})", k + 1)))
        .collect();
    let selected = PACES.iter().position(|(pace, ..)| *pace == view.status.pace);
    if let Some(k) = segments::segments_ui(ui, "pace", &segments, selected, None) {
        commands.push(Command::SetPace(PACES[k].0));
    }
}

fn theme_button_ui(ui: &mut Ui, view_state: &mut ViewState) {
    let dark = ui.visuals().dark_mode;
    let (icon, name, next) =
        if dark { (Icon::Sun, "Light", ThemeChoice::Light) } else { (Icon::Moon, "Dark", ThemeChoice::Dark) };
    let about = with_key_hint(if dark { "Light theme" } else { "Dark theme" }, Shortcut::Theme);
    if icons::icon_button_ui(ui, icon, ButtonStyle::Quiet, 28.0, name, &about).clicked() {
        view_state.theme = next;
    }
}
