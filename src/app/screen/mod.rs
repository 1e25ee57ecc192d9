//! The screen: the whole window, drawn anew every frame.
//!
//! In: what there is to see ([`View`]) and what the user looks at ([`Desk`]). Out: [`Order`]s. Nothing here reaches the
//! world or the learner, so nothing that is opened, hovered or pressed can touch what is learnt but by an order.

mod arena;
mod beams;
mod canvas;
mod field_view;
mod grasp;
mod help;
mod icons;
mod keys;
mod legend;
mod notices;
mod numbers;
mod overlays;
mod pending;
mod plane;
mod plot_axis;
mod plot_band;
mod plot_card;
mod plot_list;
mod plots;
mod press;
mod q_bars;
mod readouts;
mod segments;
mod setup;
mod steer;
pub mod theme;
mod toolbar;
mod welcome;
mod world_view;

use egui::{CentralPanel, Frame, Margin, Panel, ThemePreference, Ui};

use super::desk::{Desk, Look};
use super::history::History;
use super::orders::Order;
use super::scene::Scene;
use super::status::Status;
use pending::Pending;
use theme::Inks;

/// What there is to see this frame.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// The world.
    pub scene: &'a Scene,
    /// How the session stands.
    pub status: &'a Status,
    /// What has happened so far.
    pub history: &'a History,
}

const SETUP_WIDTH: f32 = 248.0;
const BAR_HEIGHT: f32 = 56.0;

/// Draws the window into `ui`, and writes down what the user asks for. The typeface and the colours are those of
/// [`theme::install`].
pub fn show(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    ui.ctx().set_theme(match desk.look {
        Look::System => ThemePreference::System,
        Look::Light => ThemePreference::Light,
        Look::Dark => ThemePreference::Dark,
    });
    desk.followed = desk.followed.min(view.scene.arenas.len().saturating_sub(1));
    keys::handle(ui, view, desk, orders);
    steer::handle(ui, view, orders);
    let inks = Inks::of(ui);
    let side = |ui: &Ui| Frame::side_top_panel(ui.style());
    let bar = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(10, 0));
    Panel::top("bar").exact_size(BAR_HEIGHT).frame(bar).show(ui, |ui| toolbar::show(ui, view, desk, orders));
    // Panels can be closed by their edge, and from inside.
    let mut open = desk.setup_open;
    let panel = Panel::left("setup")
        .exact_size(SETUP_WIDTH)
        .resizable(false)
        .frame(side(ui).inner_margin(Margin::ZERO));
    panel.show_collapsible(ui, &mut open, |ui| setup::show(ui, view, desk, orders));
    desk.setup_open &= open;
    let width = ui.available_width();
    let mut open = desk.plots_open;
    let panel = Panel::right("plots")
        .default_size((width * 0.34).clamp(310.0, 460.0))
        .size_range(240.0..=(width * 0.6).max(260.0))
        .drag_to_open(false)
        .frame(side(ui).inner_margin(Margin { left: 14, right: 14, top: 10, bottom: 0 }));
    panel.show_collapsible(ui, &mut open, |ui| plots::show(ui, view.history, desk, orders));
    desk.plots_open &= open;
    let world = CentralPanel::default()
        .frame(Frame::new().fill(inks.paper))
        .show(ui, |ui| world_view::show(ui, view.scene, desk, orders))
        .response
        .rect;
    welcome::show(ui, world, view, orders);
    notices::show(ui, world, &view.status.notices, orders);
    help::show(ui, &mut desk.help_open);
}
