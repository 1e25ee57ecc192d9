//! The screen: the whole window, drawn anew every frame.
//!
//! In: what there is to see ([`View`]) and what the user looks at ([`Desk`]). Out: [`Order`]s. Nothing here reaches the
//! world or the learner, so nothing that is opened, hovered or pressed can touch what is learnt but by an order.
//!
//! | file | duty |
//! |---|---|
//! | `world/` | the middle: the arenas, what is drawn over them, and the hand on them |
//! | `editor/` | in place of it and of the setup: a world that is being changed |
//! | `plots/` | the right: how the learning goes |
//! | `panels/` | the bar at the top, the setup on the left, notices, help |
//! | `keys.rs` | the keyboard: which key does what |
//! | `theme.rs` | the typeface, the scale of type, the colours |
//! | `icons.rs` | the icons, and the buttons that bear them |
//! | `numbers.rs` | numbers for people |
//!
//! In a window narrower than `NARROW` the bar has two rows, and the setup or the plots are below the world.

mod editor;
mod icons;
mod keys;
mod numbers;
mod panels;
mod plots;
pub mod theme;
mod world;

use egui::containers::panel::PanelState;
use egui::{CentralPanel, Frame, Id, Margin, Panel, Rangef, ThemePreference, Ui};

use super::desk::{Desk, Look};
use super::editor::Editor;
use super::history::History;
use super::orders::{Mode, Order};
use super::scene::Scene;
use super::status::Status;
use panels::{help, notices, setup, toolbar};
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
const PLOTS_MARGIN: Margin = Margin { left: 14, right: 4, top: 10, bottom: 0 };
const PLOTS_LEAST: f32 = 240.0;
/// Narrower windows have no room for anything beside the world.
const NARROW: f32 = 700.0;
const NARROW_BAR_HEIGHT: f32 = 92.0;
/// The part of a narrow window under the bar that the setup or the plots take.
const BELOW: f32 = 0.45;

/// What can be seen below the world in a narrow window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Below {
    Setup,
    Plots,
}

/// What is seen there: one of the panels that are open, the plots before the setup, but not before the editor's.
fn shown_below(desk: &Desk) -> Option<Below> {
    let panel_first = desk.editor.is_some() && desk.setup_open;
    if desk.plots_open && !panel_first { Some(Below::Plots) } else { desk.setup_open.then_some(Below::Setup) }
}

/// Draws the window into `ui`, and writes down what the user asks for. The typeface and the colours are those of
/// [`theme::install`].
pub fn show(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    ui.ctx().set_theme(match desk.look {
        Look::System => ThemePreference::System,
        Look::Light => ThemePreference::Light,
        Look::Dark => ThemePreference::Dark,
    });
    desk.followed = desk.followed.min(view.scene.arenas.len().saturating_sub(1));
    if std::mem::take(&mut desk.editor_opens) && desk.editor.is_none() {
        editor::leave::enter(ui.ctx(), view, desk, orders);
        if let Some((_, from, world)) = &view.status.draft {
            desk.editor = Some(Box::new(Editor::open(world.clone(), from.clone(), true)));
        }
    }
    keys::handle(ui, view, desk, orders);
    if desk.editor.is_none() {
        world::steer::handle(ui, view, orders);
    }
    let inks = Inks::of(ui);
    if ui.available_width() < NARROW {
        let bar = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(6, 0));
        let panel = Panel::top("bar").exact_size(NARROW_BAR_HEIGHT).frame(bar);
        panel.show(ui, |ui| toolbar::show_narrow(ui, view, desk, orders));
        panel_below(ui, view, desk, orders);
    } else {
        let bar = Frame::side_top_panel(ui.style()).inner_margin(Margin::symmetric(10, 0));
        let panel = Panel::top("bar").exact_size(BAR_HEIGHT).frame(bar);
        panel.show(ui, |ui| toolbar::show(ui, view, desk, orders));
        setup_panel(ui, view, desk, orders);
        plots_panel(ui, view, desk, orders);
    }
    let middle = CentralPanel::default()
        .frame(Frame::new().fill(inks.paper))
        .show(ui, |ui| {
            if desk.editor.is_some() {
                editor::show(ui, view.status, desk);
            } else {
                world::show(ui, view, desk, orders);
            }
        })
        .response
        .rect;
    if desk.editor.is_none() {
        world::welcome::show(ui, middle, view, orders);
    }
    editor::leave::show(ui, middle, desk, orders);
    notices::show(ui, middle, &view.status.notices, orders);
    help::show(ui, desk);
}

/// The panel below the world in a narrow window.
fn panel_below(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    let Some(below) = shown_below(desk) else { return };
    let (id, margin) = match below {
        Below::Setup => ("setup below", Margin::ZERO),
        Below::Plots => ("plots below", PLOTS_MARGIN),
    };
    let panel = Panel::bottom(id)
        .exact_size(ui.available_height() * BELOW)
        .resizable(false)
        .frame(Frame::side_top_panel(ui.style()).inner_margin(margin));
    panel.show(ui, |ui| match below {
        Below::Setup => left(ui, view, desk, orders),
        Below::Plots => plots::show(ui, view.history, when(view.status), orders),
    });
}

/// The panel on the left. Panels can be closed by their edge, and from inside.
fn setup_panel(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    let mut open = desk.setup_open;
    let panel = Panel::left("setup")
        .exact_size(SETUP_WIDTH)
        .resizable(false)
        .frame(Frame::side_top_panel(ui.style()).inner_margin(Margin::ZERO));
    panel.show_collapsible(ui, &mut open, |ui| left(ui, view, desk, orders));
    desk.setup_open &= open;
}

/// What is in the panel on the left, or below a narrow window's world.
fn left(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    if desk.editor.is_some() {
        editor::panel::show(ui, view, desk, orders);
    } else {
        setup::show(ui, view, desk, orders);
    }
}

/// The panel on the right; the user may drag its edge, and finds it as it was left.
fn plots_panel(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    let id = Id::new("plots");
    let width = |ui: &Ui| PanelState::load(ui.ctx(), id).map(|panel| panel.size().x);
    let (before, room) = (width(ui), ui.available_width());
    let range = Rangef::new(PLOTS_LEAST, (room * 0.6).max(PLOTS_LEAST + 20.0));
    let wanted =
        desk.plots_width.filter(|width| width.is_finite()).unwrap_or((room * 0.34).clamp(310.0, 460.0));
    let mut open = desk.plots_open;
    let frame = Frame::side_top_panel(ui.style());
    let panel = Panel::right(id)
        .default_size(range.clamp(wanted))
        .size_range(range)
        .drag_to_open(false)
        .frame(frame.inner_margin(PLOTS_MARGIN));
    panel.show_collapsible(ui, &mut open, |ui| plots::show(ui, view.history, when(view.status), orders));
    // egui takes note of the width when the edge is let go; a window made smaller is not the user's choice.
    let after = width(ui);
    if open && before.is_some() && after != before && ui.input(|i| i.pointer.any_released()) {
        desk.plots_width = after;
    }
    desk.plots_open &= open;
}

/// Under what circumstances the curves are seen.
fn when(status: &Status) -> plots::When {
    plots::When { papers_world: status.papers_world, training: status.mode == Mode::Train, disk: status.disk }
}
