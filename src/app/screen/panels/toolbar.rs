//! The bar at the top: time, who drives, and how learning stands.
//!
//! In: the status. Out: orders, and which panels are open.

use egui::{Align, FontId, Layout, Sense, Ui, vec2};

use super::readouts;
use crate::app::commands::{Command, SessionMode};
use crate::app::screen::bottom_panel::{BottomPanel, visible_bottom_panel};
use crate::app::screen::editor::confirm_exit;
use crate::app::screen::input::ScreenInput;
use crate::app::screen::key_bindings::{PACES, Shortcut, with_key_hint};
use crate::app::screen::theme::{BODY, GAP, Palette};
use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::segments::{self, Segment};
use crate::app::view_state::{ThemeChoice, ViewState};

/// What the upper of two rows takes with all its buttons.
const UPPER_ROW: f32 = 348.0;

/// What stands beside the modes in the lower row: the success rate and two buttons.
const BESIDE_MODES: f32 = 134.0;
/// What the modes take where there is room.
const MODES_WIDTH: f32 = 280.0;

/// Draws it.
pub fn toolbar_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    ui.horizontal_centered(|ui| {
        if setup_button_ui(ui, view_state.setup_open, "Show or hide the panel on the left") {
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
        mode_ui(ui, view, view_state, None, commands);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if plots_button_ui(ui, view_state.plots_open, "Show or hide the curves on the right") {
                view_state.plots_open = !view_state.plots_open;
            }
            help_button_ui(ui, view_state);
            theme_button(ui, view_state);
            ui.add_space(GAP);
            readouts::readouts_ui(ui, view.status, false);
        });
    });
}

/// Draws it in two rows; the setup and the plots take turns below the world.
pub fn narrow_toolbar_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    ui.spacing_mut().item_spacing.y = 0.0;
    let row = vec2(ui.available_width(), ui.available_height() / 2.0);
    let (along, back) = (Layout::left_to_right(Align::Center), Layout::right_to_left(Align::Center));
    let below = visible_bottom_panel(view_state);
    ui.allocate_ui_with_layout(row, along, |ui| {
        let open = below == Some(BottomPanel::Setup);
        if setup_button_ui(ui, open, "Show or hide the setup below") {
            (view_state.setup_open, view_state.plots_open) = (!open, false);
        }
        run_button_ui(ui, view, commands);
        if row.x >= UPPER_ROW {
            step_button_ui(ui, commands);
        }
        pace_ui(ui, view, commands);
        ui.with_layout(back, |ui| {
            let open = below == Some(BottomPanel::Plots);
            if plots_button_ui(ui, open, "Show or hide the curves below") {
                (view_state.setup_open, view_state.plots_open) = (false, !open);
            }
        });
    });
    ui.allocate_ui_with_layout(row, along, |ui| {
        let room = row.x - BESIDE_MODES;
        mode_ui(ui, view, view_state, (room < MODES_WIDTH).then_some(room), commands);
        ui.with_layout(back, |ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            help_button_ui(ui, view_state);
            theme_button(ui, view_state);
            readouts::readouts_ui(ui, view.status, true);
        });
    });
}

fn setup_button_ui(ui: &mut Ui, open: bool, about: &str) -> bool {
    icons::icon_button_ui(ui, Icon::LeftPanel(open), ButtonStyle::Quiet, 28.0, "Setup panel", about).clicked()
}

fn plots_button_ui(ui: &mut Ui, open: bool, about: &str) -> bool {
    icons::icon_button_ui(ui, Icon::RightPanel(open), ButtonStyle::Quiet, 28.0, "Plots panel", about)
        .clicked()
}

fn help_button_ui(ui: &mut Ui, view_state: &mut ViewState) {
    let about = with_key_hint("Keys, and what one sees", Shortcut::Help);
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
    let (icon, tone, word, about) = if paused {
        (Icon::Play, ButtonStyle::Primary, "Run", "Let time go on")
    } else {
        (Icon::Pause, ButtonStyle::Framed, "Pause", "Let time stand still")
    };
    if icons::icon_button_ui(ui, icon, tone, 36.0, word, &with_key_hint(about, Shortcut::Pause)).clicked() {
        commands.push(Command::Pause(!paused));
    }
}

fn step_button_ui(ui: &mut Ui, commands: &mut Vec<Command>) {
    let about = with_key_hint("One control step, then stand still", Shortcut::Step);
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
    let on = PACES.iter().position(|(pace, ..)| *pace == view.status.pace);
    if let Some(k) = segments::segments_ui(ui, "pace", &segments, on, None) {
        commands.push(Command::SetPace(PACES[k].0));
    }
}

fn mode_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    width: Option<f32>,
    commands: &mut Vec<Command>,
) {
    const MODES: [SessionMode; 4] =
        [SessionMode::Train, SessionMode::Test, SessionMode::Drive, SessionMode::Compare];
    let opened_policy = view.status.opened_policy.as_deref();
    let expert = view.status.expert.as_deref();
    let compare = match (opened_policy, expert) {
        (Some(name), _) => format!("The present policy and {name}, side by side to the same goals"),
        (None, Some(_)) => {
            "The present policy and an expert, side by side to the same goals; or a policy that you open"
                .into()
        }
        (None, None) => "Opens a second policy to drive beside the present one".into(),
    };
    let segments = [
        Segment::new("Train", "The robots explore, and learn from it"),
        Segment::new("Test", "The policy as it is drives alone; nothing is left to chance, nothing learnt"),
        Segment::new("Drive", "You drive with the arrow keys, and the policy beside you to the same goals"),
        Segment::new("Compare", compare),
        Segment::new(
            "Edit",
            with_key_hint("The world as a drawing: change it, save it, train in it", Shortcut::Edit),
        ),
    ];
    let now = MODES.iter().position(|mode| *mode == view.status.mode);
    let editing = view_state.editor.is_some();
    let on = if editing { Some(MODES.len()) } else { now };
    let Some(k) = segments::segments_ui(ui, "mode", &segments, on, width) else { return };
    let command = MODES.get(k).map(|mode| match (*mode, opened_policy, expert) {
        (SessionMode::Compare, None, Some(_)) => Command::OpenExpert,
        (SessionMode::Compare, None, None) => Command::OpenDialog,
        (mode, ..) => Command::SetMode(mode),
    });
    match command {
        Some(command) if editing => {
            confirm_exit::request_exit(view_state, (Some(k) != now).then_some(command), commands)
        }
        Some(command) => commands.push(command),
        None if !editing => confirm_exit::enter_editor(view, view_state, commands),
        None => {}
    }
}

fn theme_button(ui: &mut Ui, view_state: &mut ViewState) {
    let dark = ui.visuals().dark_mode;
    let (icon, word, next) =
        if dark { (Icon::Sun, "Light", ThemeChoice::Light) } else { (Icon::Moon, "Dark", ThemeChoice::Dark) };
    let about = with_key_hint(if dark { "Dark on light" } else { "Light on dark" }, Shortcut::ThemeChoice);
    if icons::icon_button_ui(ui, icon, ButtonStyle::Quiet, 28.0, word, &about).clicked() {
        view_state.theme = next;
    }
}
