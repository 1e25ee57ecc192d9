//! The first part of the setup panel: which world, which learner, which seed, and beginning a training with them.
//!
//! In: the status, and what was chosen ([`Pending`]). Out: orders; one that gives up a training of some worth comes only
//! after the user was asked back.

use egui::{Button, ComboBox, DragValue, Frame, Margin, RichText, Slider, Stroke, Ui, vec2};

use super::pending::Pending;
use super::press;
use super::setup::{soft, title};
use crate::app::orders::Order;
use crate::app::screen::icons::{self, Icon, Tone};
use crate::app::screen::numbers;
use crate::app::screen::theme::{BODY, GAP, Inks};
use crate::app::status::{Choice, Status};

/// The height of the wide buttons.
const TALL: f32 = 30.0;

/// Draws it.
pub fn show(ui: &mut Ui, status: &Status, pending: &mut Pending, orders: &mut Vec<Order>) {
    let changed = status.world_changed && pending.scenario == status.scenario_from;
    choose(ui, "World", &status.scenarios, &mut pending.scenario, changed);
    ui.add_space(GAP);
    choose(ui, "Learner", &status.presets, &mut pending.preset, false);
    ui.add_space(GAP);
    seed(ui, pending);
    ui.add_space(GAP);
    begin(ui, status, pending, orders);
    let elsewhere = pending.scenario != status.scenario_from;
    if elsewhere {
        let about = "Training goes on in the chosen world with the weights as they are: knowledge transfer";
        if wide(ui, "Go on here with what it has learnt").on_hover_text(about).clicked() {
            let (scenario, epsilon) = (pending.scenario.clone(), pending.epsilon);
            orders.push(Order::Transfer { scenario, epsilon });
        }
    }
    match &status.opened {
        Some(name) => adopt(ui, name, status, pending, orders),
        None => pending.asked = pending.asked.take().filter(|asked| !matches!(asked, Order::Adopt { .. })),
    }
    if elsewhere || status.opened.is_some() {
        epsilon(ui, pending);
    }
}

fn seed(ui: &mut Ui, pending: &mut Pending) {
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
}

fn begin(ui: &mut Ui, status: &Status, pending: &mut Pending, orders: &mut Vec<Order>) {
    if matches!(pending.asked, Some(Order::Begin { .. })) {
        return ask_back(ui, status, pending, "Start again", orders);
    }
    let about = if status.world_changed {
        "A new training from nothing, in this world as its file has it, without what you moved, and with this learner; \
         what was learnt is given up"
    } else {
        "A new training from nothing, in this world and with this learner; what was learnt is given up"
    };
    // Loud only when there is something to begin that isn't going on already.
    let button = if pending.is_another() {
        press::primary(ui, "Start again", BODY, vec2(ui.available_width(), TALL))
    } else {
        wide(ui, "Start again")
    };
    if button.on_hover_text(about).clicked() {
        let (scenario, preset) = (pending.scenario.clone(), pending.preset.clone());
        give_up_for(Order::Begin { scenario, preset, seed: pending.seed }, status, pending, orders);
    }
}

fn adopt(ui: &mut Ui, name: &str, status: &Status, pending: &mut Pending, orders: &mut Vec<Order>) {
    ui.add_space(GAP);
    title(ui, "Opened policy");
    ui.add(egui::Label::new(soft(name)).truncate());
    if matches!(pending.asked, Some(Order::Adopt { .. })) {
        return ask_back(ui, status, pending, "Learn on from it", orders);
    }
    let about = "A new training of the same learner in the same world that starts from this policy; what was learnt \
                 here is given up";
    if wide(ui, "Learn on from it").on_hover_text(about).clicked() {
        give_up_for(Order::Adopt { epsilon: pending.epsilon }, status, pending, orders);
    }
}

/// Orders it, or asks back first if a training of some worth would be gone.
fn give_up_for(order: Order, status: &Status, pending: &mut Pending, orders: &mut Vec<Order>) {
    if status.restart_discards {
        pending.asked = Some(order);
    } else {
        orders.push(order);
    }
}

/// The question in the place of the button that was pressed: its text is where the pointer is, so that a double click
/// answers nothing.
fn ask_back(ui: &mut Ui, status: &Status, pending: &mut Pending, yes: &str, orders: &mut Vec<Order>) {
    let inks = Inks::of(ui);
    let frame =
        Frame::new().stroke(Stroke::new(1.0, inks.warn)).corner_radius(5.0).inner_margin(Margin::same(8));
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        let episodes = if status.episodes == 1 { "episode" } else { "episodes" };
        let text = format!("This training of {} {episodes} will be gone.", numbers::count(status.episodes));
        ui.label(RichText::new(text).color(inks.ink));
        ui.horizontal(|ui| {
            let keep = 74.0;
            let width = ui.available_width() - ui.spacing().item_spacing.x - keep;
            let gone = ui.add_sized(vec2(width, 26.0), Button::new(yes));
            let kept = ui.add_sized(vec2(keep, 26.0), Button::new("Keep it"));
            if gone.clicked() {
                // What is chosen now: it may have changed since.
                orders.extend(pending.asked.take().map(|asked| match asked {
                    Order::Begin { .. } => Order::Begin {
                        scenario: pending.scenario.clone(),
                        preset: pending.preset.clone(),
                        seed: pending.seed,
                    },
                    _ => Order::Adopt { epsilon: pending.epsilon },
                }));
            } else if kept.clicked() {
                pending.asked = None;
            }
        });
    });
}

fn epsilon(ui: &mut Ui, pending: &mut Pending) {
    ui.horizontal(|ui| {
        let label = ui.label(soft("Random at first"));
        // The number's box as wide for 5% as for 100%, and as low as the slider, or it would hang below it.
        (ui.spacing_mut().interact_size, ui.spacing_mut().button_padding.y) = (vec2(52.0, 18.0), 1.0);
        ui.spacing_mut().slider_width = (ui.available_width() - 58.0).max(40.0);
        let percent = |share: f64, _| format!("{:.0}%", share * 100.0);
        let slider = Slider::new(&mut pending.epsilon, 0.0..=1.0).step_by(0.05).custom_formatter(percent);
        let slider =
            slider.custom_parser(|text| Some(text.trim_end_matches(['%', ' ']).parse::<f64>().ok()? / 100.0));
        ui.add(slider)
            .labelled_by(label.id)
            .on_hover_text("Epsilon, the share of random actions (the paper: 50%)");
    });
}

fn choose(ui: &mut Ui, what: &str, choices: &[Choice], from: &mut String, changed: bool) {
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
    if changed {
        ui.label(soft("changed by hand"));
    }
    if !about.is_empty() {
        ui.label(soft(about));
    }
}

fn wide(ui: &mut Ui, text: &str) -> egui::Response {
    ui.add_sized(vec2(ui.available_width(), TALL), Button::new(text))
}

/// Another seed than `before`, one that can be read out: splitmix64 of it and the time.
fn thrown(before: u64, time_s: f64) -> u64 {
    let mut z = before ^ time_s.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    let seed = (z ^ (z >> 31)) % 1_000_000;
    if seed == before { seed + 1 } else { seed }
}
