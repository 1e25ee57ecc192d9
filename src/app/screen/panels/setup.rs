//! The panel on the left: what is learnt where (`training.rs`), what is drawn, what is kept.
//!
//! In: the status and the desk. Out: orders. What is chosen here waits in [`Pending`] until a button is pressed.

use egui::{Button, Frame, Margin, Response, RichText, ScrollArea, Ui, vec2};

use super::pending::Pending;
use super::segments::{self, Segment};
use super::{help, overlays, training};
use crate::app::desk::{Camera, Desk};
use crate::app::orders::{Mode, Order, Saved};
use crate::app::screen::View;
use crate::app::screen::icons::{self, Icon, Tone};
use crate::app::screen::keys::{Deed, tip};
use crate::app::screen::theme::{BODY, GAP, SMALL};
use crate::app::status::Status;

/// What can be opened.
const OPENS: &str = "Opens a policy to set against the present one, a saved run to go on with, or a world or preset of \
                     your own.";

/// The same where there is no disk.
const OPENS_WITHOUT_DISK: &str = "Opens a policy to set against the present one, or a world or preset of your own. It \
                                  stays on your machine.";

/// Draws it.
pub fn show(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    // The scroll bar has its place in the margin.
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        Frame::new().inner_margin(Margin::symmetric(14, 12)).show(ui, |ui| content(ui, view, desk, orders));
    });
}

fn content(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    if view.status.mode == Mode::Drive {
        drive(ui);
        gap(ui);
    }
    let mut pending = Pending::load(ui.ctx(), view.status);
    training::show(ui, view.status, &mut pending, orders);
    pending.store(ui.ctx());
    gap(ui);
    title(ui, "Overlays");
    overlays::show(ui, &mut desk.overlays);
    gap(ui);
    framing(ui, view, desk);
    gap(ui);
    files(ui, view.status, orders);
}

fn framing(ui: &mut Ui, view: &View<'_>, desk: &mut Desk) {
    title(ui, "View");
    ui.horizontal(|ui| {
        let side = 28.0;
        if view.status.mode == Mode::Train {
            one_or_all(ui, view, desk, side);
        }
        let about = tip("Show the whole enclosure", Deed::Fit);
        if icons::button(ui, Icon::Fit, Tone::Framed, side, "Fit", &about).clicked() {
            desk.camera = Camera::default();
        }
    });
}

/// The followed arena or all of them; leaves room for a button `beside` points wide.
fn one_or_all(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, beside: f32) {
    let all = format!("All {}", view.scene.arenas.len());
    let segments = [
        Segment::new("One arena", tip("The arena that is followed, large", Deed::Grid)),
        Segment {
            name: "All arenas".into(),
            ..Segment::new(&all, tip("All arenas side by side", Deed::Grid))
        },
    ];
    let width = ui.available_width() - beside - ui.spacing().item_spacing.x;
    if let Some(k) = segments::show(ui, "framing", &segments, Some(usize::from(desk.grid)), Some(width)) {
        desk.grid = k == 1;
    }
}

fn files(ui: &mut Ui, status: &Status, orders: &mut Vec<Order>) {
    title(ui, "Files");
    if let Some(expert) = &status.expert {
        let about = format!("A policy that comes with the program drives beside the present one: {expert}");
        let button = ui.add_sized(vec2(ui.available_width(), 26.0), Button::new("Watch an expert"));
        if button.on_hover_text(about).clicked() {
            orders.push(Order::OpenExpert);
        }
    }
    let opens = if status.disk { OPENS } else { OPENS_WITHOUT_DISK };
    let mut all = vec![
        ("Open…", tip(opens, Deed::Open), Order::OpenDialog),
        ("Save policy", tip("What it has learnt", Deed::Save), Order::SaveDialog(Saved::Policy)),
    ];
    if status.disk {
        all.push(("Save run", "All of the training, to go on from".into(), Order::SaveDialog(Saved::Run)));
    }
    let world = "The world as it stands, with what you moved";
    all.push(("Save world", world.into(), Order::SaveDialog(Saved::Scenario)));
    let width = (ui.available_width() - ui.spacing().item_spacing.x) / 2.0;
    for row in all.chunks(2) {
        ui.horizontal(|ui| {
            for (text, about, order) in row {
                if ui.add_sized(vec2(width, 26.0), Button::new(*text)).on_hover_text(about).clicked() {
                    orders.push(order.clone());
                }
            }
        });
    }
}

fn drive(ui: &mut Ui) {
    title(ui, "You drive");
    for (keys, what) in [
        (&["↑"][..], "straight on, as without a key"),
        (&["↑", "←"], "or → with it: a gentle turn"),
        (&["←"], "or → alone: a sharp turn"),
    ] {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            keys.iter().for_each(|key| help::cap(ui, key));
            ui.add_space(3.0);
            ui.label(soft(what));
        });
    }
}

/// A part's heading.
pub fn title(ui: &mut Ui, text: &str) -> Response {
    ui.label(RichText::new(text).size(BODY).strong())
}

/// A sentence to be read second.
pub fn soft(text: &str) -> RichText {
    RichText::new(text).size(SMALL).weak()
}

fn gap(ui: &mut Ui) {
    ui.add_space(GAP);
    ui.separator();
    ui.add_space(GAP * 0.5);
}
