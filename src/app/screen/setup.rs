//! The panel on the left: which world, which learner, what is drawn, what is kept.
//!
//! In: the status and the desk. Out: orders. What is chosen here waits in [`Pending`] until a button is pressed.

use egui::{Button, ComboBox, DragValue, Frame, Margin, Response, RichText, ScrollArea, Slider, Ui, vec2};

use super::icons::{self, Icon, Tone};
use super::keys::{Deed, tip};
use super::segments::{self, Segment};
use super::theme::{BODY, GAP, SMALL};
use super::{Pending, View, help, overlays, press};
use crate::app::desk::{Camera, Desk};
use crate::app::orders::{Mode, Order, Saved};
use crate::app::status::{Choice, Status};

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
    training(ui, view.status, &mut pending, orders);
    pending.store(ui.ctx());
    gap(ui);
    title(ui, "Overlays");
    overlays::show(ui, &mut desk.overlays);
    gap(ui);
    framing(ui, view, desk);
    gap(ui);
    files(ui, view.status, orders);
}

fn training(ui: &mut Ui, status: &Status, pending: &mut Pending, orders: &mut Vec<Order>) {
    choose(ui, "World", &status.scenarios, &mut pending.scenario);
    ui.add_space(GAP);
    choose(ui, "Learner", &status.presets, &mut pending.preset);
    ui.add_space(GAP);
    let label = title(ui, "Seed");
    ui.horizontal(|ui| {
        let side = ui.spacing().interact_size.y;
        let width = ui.available_width() - side - ui.spacing().item_spacing.x;
        // Beyond 2^53 a number loses digits on its way through a drag; what is written is what is meant.
        let seed = pending.seed;
        let exact =
            move |shown: f64, _| if shown == seed as f64 { seed.to_string() } else { format!("{shown:.0}") };
        let value = DragValue::new(&mut pending.seed).speed(1.0).custom_formatter(exact);
        ui.add_sized(vec2(width, side), value)
            .labelled_by(label.id)
            .on_hover_text("The same seed gives the same training; drag, or click to type");
        if icons::button(ui, Icon::Die, Tone::Framed, side, "New seed", "Another seed, by chance").clicked() {
            pending.seed = thrown(pending.seed, ui.input(|i| i.time));
        }
    });
    ui.add_space(GAP);
    let wide = vec2(ui.available_width(), 30.0);
    let about =
        "A new training from nothing, in this world and with this learner; what was learnt is given up";
    // Loud only when there is something to begin that isn't going on already.
    let button = if pending.is_another() {
        press::primary(ui, "Start again", BODY, wide)
    } else {
        ui.add_sized(wide, Button::new("Start again"))
    };
    if button.on_hover_text(about).clicked() {
        let (scenario, preset) = (pending.scenario.clone(), pending.preset.clone());
        orders.push(Order::Begin { scenario, preset, seed: pending.seed });
    }
    if pending.scenario != status.scenario_from {
        ui.add_space(2.0);
        transfer(ui, pending, orders);
    }
}

fn transfer(ui: &mut Ui, pending: &mut Pending, orders: &mut Vec<Order>) {
    let wide = vec2(ui.available_width(), 30.0);
    let about = "Training goes on in the chosen world with the weights as they are: knowledge transfer";
    let button = Button::new("Go on here with what it has learnt");
    if ui.add_sized(wide, button).on_hover_text(about).clicked() {
        let (scenario, epsilon) = (pending.scenario.clone(), pending.epsilon);
        orders.push(Order::Transfer { scenario, epsilon });
    }
    ui.horizontal(|ui| {
        let label = ui.label(soft("Random at first"));
        ui.spacing_mut().slider_width = (ui.available_width() - 58.0).max(40.0);
        let percent = |share: f64, _| format!("{:.0} %", share * 100.0);
        let slider = Slider::new(&mut pending.epsilon, 0.0..=1.0).step_by(0.05).custom_formatter(percent);
        let slider =
            slider.custom_parser(|text| Some(text.trim_end_matches(['%', ' ']).parse::<f64>().ok()? / 100.0));
        ui.add(slider)
            .labelled_by(label.id)
            .on_hover_text("Epsilon, the share of random actions (the paper: 50 %)");
    });
}

fn choose(ui: &mut Ui, what: &str, choices: &[Choice], from: &mut String) {
    let label = title(ui, what);
    let chosen = choices.iter().find(|choice| choice.from == *from);
    let text = chosen.map_or(from.as_str(), |choice| choice.title.as_str()).to_owned();
    let about = chosen.map_or("", |choice| choice.about.as_str());
    let width = ui.available_width();
    let combo = ComboBox::from_id_salt(what).selected_text(text).width(width).truncate();
    let shown = combo.show_ui(ui, |ui| {
        for choice in choices {
            let item = ui.selectable_label(choice.from == *from, &choice.title);
            if item.on_hover_text(&choice.about).clicked() {
                from.clone_from(&choice.from);
            }
        }
    });
    shown.response.labelled_by(label.id);
    if !about.is_empty() {
        ui.label(soft(about));
    }
}

fn framing(ui: &mut Ui, view: &View<'_>, desk: &mut Desk) {
    title(ui, "View");
    ui.horizontal(|ui| {
        let side = 28.0;
        let all = format!("All {}", view.scene.arenas.len());
        let segments = [
            Segment::new("One arena", tip("The arena that is followed, large", Deed::Grid)),
            Segment {
                name: "All arenas".into(),
                ..Segment::new(&all, tip("All arenas side by side", Deed::Grid))
            },
        ];
        let width = ui.available_width() - side - ui.spacing().item_spacing.x;
        if let Some(k) = segments::show(ui, "framing", &segments, Some(usize::from(desk.grid)), Some(width)) {
            desk.grid = k == 1;
        }
        let about = tip("Show the whole enclosure", Deed::Fit);
        if icons::button(ui, Icon::Fit, Tone::Framed, side, "Fit", &about).clicked() {
            desk.camera = Camera::default();
        }
    });
}

fn files(ui: &mut Ui, status: &Status, orders: &mut Vec<Order>) {
    title(ui, "Files");
    let rows = [
        [
            (
                "Open…",
                tip("A policy to drive or compare with, or a run to go on with", Deed::Open),
                Order::OpenDialog,
            ),
            ("Save policy", tip("What it has learnt", Deed::Save), Order::SaveDialog(Saved::Policy)),
        ],
        [
            ("Save run", "All of the training, to go on from".into(), Order::SaveDialog(Saved::Run)),
            (
                "Save world",
                "The world as it stands, with what you moved".into(),
                Order::SaveDialog(Saved::Scenario),
            ),
        ],
    ];
    let width = (ui.available_width() - ui.spacing().item_spacing.x) / 2.0;
    ui.add_enabled_ui(status.dialogs, |ui| {
        for row in rows {
            ui.horizontal(|ui| {
                for (text, about, order) in row {
                    let button = ui.add_sized(vec2(width, 26.0), Button::new(text));
                    let button = button.on_hover_text(about);
                    if button.on_disabled_hover_text("There are no file dialogs on this system").clicked() {
                        orders.push(order);
                    }
                }
            });
        }
    });
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

/// Another seed than `before`, one that can be read out: splitmix64 of it and the time.
fn thrown(before: u64, time_s: f64) -> u64 {
    let mut z = before ^ time_s.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    let seed = (z ^ (z >> 31)) % 1_000_000;
    if seed == before { seed + 1 } else { seed }
}

fn title(ui: &mut Ui, text: &str) -> Response {
    ui.label(RichText::new(text).size(BODY).strong())
}

fn soft(text: &str) -> RichText {
    RichText::new(text).size(SMALL).weak()
}

fn gap(ui: &mut Ui) {
    ui.add_space(GAP);
    ui.separator();
    ui.add_space(GAP * 0.5);
}
