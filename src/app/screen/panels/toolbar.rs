//! The bar at the top: time, who drives, and how learning stands.
//!
//! In: the status. Out: orders, and which panels are open.

use egui::{Align, FontId, Layout, Sense, Ui, vec2};

use super::readouts;
use super::segments::{self, Segment};
use crate::app::desk::{Desk, Look};
use crate::app::orders::{Mode, Order};
use crate::app::screen::editor::leave;
use crate::app::screen::icons::{self, Icon, Tone};
use crate::app::screen::keys::{Deed, PACES, tip};
use crate::app::screen::theme::{BODY, GAP, Inks};
use crate::app::screen::{Below, View, shown_below};

/// What the upper of two rows takes with all its buttons.
const UPPER_ROW: f32 = 348.0;

/// What stands beside the modes in the lower row: the success rate and two buttons.
const BESIDE_MODES: f32 = 134.0;
/// What the modes take where there is room.
const MODES_WIDTH: f32 = 280.0;

/// Draws it.
pub fn show(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    ui.horizontal_centered(|ui| {
        if setup_button(ui, desk.setup_open, "Show or hide the panel on the left") {
            desk.setup_open = !desk.setup_open;
        }
        if ui.available_width() > 1060.0 {
            name(ui);
        }
        ui.add_space(GAP);
        run(ui, view, orders);
        step(ui, orders);
        ui.add_space(2.0 * GAP);
        pace(ui, view, orders);
        ui.add_space(2.0 * GAP);
        mode(ui, view, desk, None, orders);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if plots_button(ui, desk.plots_open, "Show or hide the curves on the right") {
                desk.plots_open = !desk.plots_open;
            }
            help(ui, desk);
            look(ui, desk);
            ui.add_space(GAP);
            readouts::show(ui, view.status, false);
        });
    });
}

/// Draws it in two rows; the setup and the plots take turns below the world.
pub fn show_narrow(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    ui.spacing_mut().item_spacing.y = 0.0;
    let row = vec2(ui.available_width(), ui.available_height() / 2.0);
    let (along, back) = (Layout::left_to_right(Align::Center), Layout::right_to_left(Align::Center));
    let below = shown_below(desk);
    ui.allocate_ui_with_layout(row, along, |ui| {
        let open = below == Some(Below::Setup);
        if setup_button(ui, open, "Show or hide the setup below") {
            (desk.setup_open, desk.plots_open) = (!open, false);
        }
        run(ui, view, orders);
        if row.x >= UPPER_ROW {
            step(ui, orders);
        }
        pace(ui, view, orders);
        ui.with_layout(back, |ui| {
            let open = below == Some(Below::Plots);
            if plots_button(ui, open, "Show or hide the curves below") {
                (desk.setup_open, desk.plots_open) = (false, !open);
            }
        });
    });
    ui.allocate_ui_with_layout(row, along, |ui| {
        let room = row.x - BESIDE_MODES;
        mode(ui, view, desk, (room < MODES_WIDTH).then_some(room), orders);
        ui.with_layout(back, |ui| {
            ui.spacing_mut().item_spacing.x = 2.0;
            help(ui, desk);
            look(ui, desk);
            readouts::show(ui, view.status, true);
        });
    });
}

fn setup_button(ui: &mut Ui, open: bool, about: &str) -> bool {
    icons::button(ui, Icon::LeftPanel(open), Tone::Quiet, 28.0, "Setup panel", about).clicked()
}

fn plots_button(ui: &mut Ui, open: bool, about: &str) -> bool {
    icons::button(ui, Icon::RightPanel(open), Tone::Quiet, 28.0, "Plots panel", about).clicked()
}

fn help(ui: &mut Ui, desk: &mut Desk) {
    let about = tip("Keys, and what one sees", Deed::Help);
    if icons::button(ui, Icon::Help, Tone::Quiet, 28.0, "Help", &about).clicked() {
        desk.help_open = !desk.help_open;
    }
}

fn name(ui: &mut Ui) {
    let inks = Inks::of(ui);
    let text = ui.painter().layout_no_wrap("wayfield".into(), FontId::proportional(BODY), inks.soft);
    let (rect, response) = ui.allocate_exact_size(vec2(text.size().x + 2.0, 28.0), Sense::hover());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Label, true, "wayfield"));
    ui.painter().galley(rect.left_center() - vec2(0.0, text.size().y / 2.0), text, inks.soft);
}

fn run(ui: &mut Ui, view: &View<'_>, orders: &mut Vec<Order>) {
    let paused = view.status.paused;
    let (icon, tone, word, about) = if paused {
        (Icon::Play, Tone::Primary, "Run", "Let time go on")
    } else {
        (Icon::Pause, Tone::Framed, "Pause", "Let time stand still")
    };
    if icons::button(ui, icon, tone, 36.0, word, &tip(about, Deed::Pause)).clicked() {
        orders.push(Order::Pause(!paused));
    }
}

fn step(ui: &mut Ui, orders: &mut Vec<Order>) {
    let about = tip("One control step, then stand still", Deed::Step);
    if icons::button(ui, Icon::Step, Tone::Framed, 28.0, "Step", &about).clicked() {
        orders.push(Order::Step);
    }
}

fn pace(ui: &mut Ui, view: &View<'_>, orders: &mut Vec<Order>) {
    let segments: Vec<_> = PACES
        .iter()
        .enumerate()
        .map(|(k, (_, text, about))| Segment::new(text, format!("{about}  ({})", k + 1)))
        .collect();
    let on = PACES.iter().position(|(pace, ..)| *pace == view.status.pace);
    if let Some(k) = segments::show(ui, "pace", &segments, on, None) {
        orders.push(Order::SetPace(PACES[k].0));
    }
}

fn mode(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, width: Option<f32>, orders: &mut Vec<Order>) {
    const MODES: [Mode; 4] = [Mode::Train, Mode::Test, Mode::Drive, Mode::Compare];
    let opened = view.status.opened.as_deref();
    let expert = view.status.expert.as_deref();
    let compare = match (opened, expert) {
        (Some(name), _) => format!("The present policy and {name}, side by side to the same targets"),
        (None, Some(_)) => {
            "The present policy and an expert, side by side to the same targets; or a policy that you open"
                .into()
        }
        (None, None) => "Opens a second policy to drive beside the present one".into(),
    };
    let segments = [
        Segment::new("Train", "The robots explore, and learn from it"),
        Segment::new("Test", "The policy as it is drives alone; nothing is left to chance, nothing learnt"),
        Segment::new("Drive", "You drive with the arrow keys, and the policy beside you to the same targets"),
        Segment::new("Compare", compare),
        Segment::new("Edit", tip("The world as a drawing: change it, save it, train in it", Deed::Edit)),
    ];
    let now = MODES.iter().position(|mode| *mode == view.status.mode);
    let editing = desk.editor.is_some();
    let on = if editing { Some(MODES.len()) } else { now };
    let Some(k) = segments::show(ui, "mode", &segments, on, width) else { return };
    let order = MODES.get(k).map(|mode| match (*mode, opened, expert) {
        (Mode::Compare, None, Some(_)) => Order::OpenExpert,
        (Mode::Compare, None, None) => Order::OpenDialog,
        (mode, ..) => Order::SetMode(mode),
    });
    match order {
        Some(order) if editing => leave::ask(ui.ctx(), desk, (Some(k) != now).then_some(order), orders),
        Some(order) => orders.push(order),
        None if !editing => leave::enter(ui.ctx(), view, desk, orders),
        None => {}
    }
}

fn look(ui: &mut Ui, desk: &mut Desk) {
    let dark = ui.visuals().dark_mode;
    let (icon, word, next) =
        if dark { (Icon::Sun, "Light", Look::Light) } else { (Icon::Moon, "Dark", Look::Dark) };
    let about = tip(if dark { "Dark on light" } else { "Light on dark" }, Deed::Look);
    if icons::button(ui, icon, Tone::Quiet, 28.0, word, &about).clicked() {
        desk.look = next;
    }
}
