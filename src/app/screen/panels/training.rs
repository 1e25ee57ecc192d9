//! The first part of the setup panel: which world, which learner, which seed, and beginning a training with them.
//!
//! In: the status, and what was chosen ([`SetupForm`]). Out: orders; one that gives up a training of some worth comes only
//! after the user was asked back.

use egui::{Button, ComboBox, DragValue, Frame, Margin, RichText, Slider, Stroke, Ui, vec2};

use crate::app::app_snapshot::{AppSnapshot, Choice};
use crate::app::commands::Command;
use crate::app::screen::numbers;
use crate::app::screen::theme::{BODY, GAP, Palette};
use crate::app::screen::widgets::buttons;
use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::text::{section_title_ui, weak_text};
use crate::app::setup_form::SetupForm;

/// The height of the wide buttons.
const TALL: f32 = 30.0;

/// Draws it.
pub fn training_ui(
    ui: &mut Ui,
    status: &AppSnapshot,
    setup_form: &mut SetupForm,
    commands: &mut Vec<Command>,
) {
    let changed = status.scenario_modified && setup_form.scenario == status.scenario_from;
    choice_ui(ui, "World", &status.scenarios, &mut setup_form.scenario, changed);
    ui.add_space(GAP);
    choice_ui(ui, "Learner", &status.presets, &mut setup_form.preset, false);
    ui.add_space(GAP);
    seed_ui(ui, setup_form);
    ui.add_space(GAP);
    start_ui(ui, status, setup_form, commands);
    let elsewhere = setup_form.scenario != status.scenario_from;
    if elsewhere {
        let about = "Training goes on in the chosen world with the weights as they are: knowledge transfer";
        if wide_button_ui(ui, "Go on here with what it has learnt").on_hover_text(about).clicked() {
            let (scenario, epsilon) = (setup_form.scenario.clone(), setup_form.epsilon);
            commands.push(Command::Transfer { scenario, epsilon });
        }
    }
    match &status.opened_policy {
        Some(name) => adopt_ui(ui, name, status, setup_form, commands),
        None => {
            setup_form.awaiting_confirmation = setup_form
                .awaiting_confirmation
                .take()
                .filter(|asked| !matches!(asked, Command::TrainFromOpened { .. }))
        }
    }
    if elsewhere || status.opened_policy.is_some() {
        epsilon_ui(ui, setup_form);
    }
}

fn seed_ui(ui: &mut Ui, setup_form: &mut SetupForm) {
    let label = section_title_ui(ui, "Seed");
    ui.horizontal(|ui| {
        let side = ui.spacing().interact_size.y;
        let width = ui.available_width() - side - ui.spacing().item_spacing.x;
        // Beyond 2^53 a number loses digits on its way through a drag; what is written is what is meant.
        let seed = setup_form.seed;
        let exact =
            move |shown: f64, _| if shown == seed as f64 { seed.to_string() } else { format!("{shown:.0}") };
        let value = DragValue::new(&mut setup_form.seed).speed(1.0).custom_formatter(exact);
        ui.add_sized(vec2(width, side), value)
            .labelled_by(label.id)
            .on_hover_text("The same seed gives the same training; drag, or click to type");
        if icons::icon_button_ui(
            ui,
            Icon::Dice,
            ButtonStyle::Framed,
            side,
            "New seed",
            "Another seed, by chance",
        )
        .clicked()
        {
            setup_form.seed = random_seed(setup_form.seed, ui.input(|i| i.time));
        }
    });
}

fn start_ui(ui: &mut Ui, status: &AppSnapshot, setup_form: &mut SetupForm, commands: &mut Vec<Command>) {
    if matches!(setup_form.awaiting_confirmation, Some(Command::StartTraining { .. })) {
        return confirm_ui(ui, status, setup_form, "Start again", commands);
    }
    let about = if status.scenario_modified {
        "A new training from nothing, in this world as its file has it, without what you moved, and with this learner; \
         what was learnt is given up"
    } else {
        "A new training from nothing, in this world and with this learner; what was learnt is given up"
    };
    // Loud only when there is something to begin that isn't going on already.
    let button = if setup_form.differs_from_running() {
        buttons::primary_button_ui(ui, "Start again", BODY, vec2(ui.available_width(), TALL))
    } else {
        wide_button_ui(ui, "Start again")
    };
    if button.on_hover_text(about).clicked() {
        let (scenario, preset) = (setup_form.scenario.clone(), setup_form.preset.clone());
        give_up_for(
            Command::StartTraining { scenario, preset, seed: setup_form.seed },
            status,
            setup_form,
            commands,
        );
    }
}

fn adopt_ui(
    ui: &mut Ui,
    name: &str,
    status: &AppSnapshot,
    setup_form: &mut SetupForm,
    commands: &mut Vec<Command>,
) {
    ui.add_space(GAP);
    section_title_ui(ui, "Opened policy");
    ui.add(egui::Label::new(weak_text(name)).truncate());
    if matches!(setup_form.awaiting_confirmation, Some(Command::TrainFromOpened { .. })) {
        return confirm_ui(ui, status, setup_form, "Learn on from it", commands);
    }
    let about = "A new training of the same learner in the same world that starts from this policy; what was learnt \
                 here is given up";
    if wide_button_ui(ui, "Learn on from it").on_hover_text(about).clicked() {
        give_up_for(Command::TrainFromOpened { epsilon: setup_form.epsilon }, status, setup_form, commands);
    }
}

/// Orders it, or asks back first if a training of some worth would be gone.
fn give_up_for(
    command: Command,
    status: &AppSnapshot,
    setup_form: &mut SetupForm,
    commands: &mut Vec<Command>,
) {
    if status.restart_loses_training {
        setup_form.awaiting_confirmation = Some(command);
    } else {
        commands.push(command);
    }
}

/// The question in the place of the button that was pressed: its text is where the pointer is, so that a double click
/// answers nothing.
fn confirm_ui(
    ui: &mut Ui,
    status: &AppSnapshot,
    setup_form: &mut SetupForm,
    yes: &str,
    commands: &mut Vec<Command>,
) {
    let palette = Palette::from_ui(ui);
    let frame = Frame::new()
        .stroke(Stroke::new(1.0, palette.warning))
        .corner_radius(5.0)
        .inner_margin(Margin::same(8));
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        let episodes = if status.episodes == 1 { "episode" } else { "episodes" };
        let text =
            format!("This training of {} {episodes} will be gone.", numbers::format_count(status.episodes));
        ui.label(RichText::new(text).color(palette.text));
        ui.horizontal(|ui| {
            let keep = 74.0;
            let width = ui.available_width() - ui.spacing().item_spacing.x - keep;
            let gone = ui.add_sized(vec2(width, 26.0), Button::new(yes));
            let kept = ui.add_sized(vec2(keep, 26.0), Button::new("Keep it"));
            if gone.clicked() {
                // What is chosen now: it may have changed since.
                commands.extend(setup_form.awaiting_confirmation.take().map(|asked| match asked {
                    Command::StartTraining { .. } => Command::StartTraining {
                        scenario: setup_form.scenario.clone(),
                        preset: setup_form.preset.clone(),
                        seed: setup_form.seed,
                    },
                    _ => Command::TrainFromOpened { epsilon: setup_form.epsilon },
                }));
            } else if kept.clicked() {
                setup_form.awaiting_confirmation = None;
            }
        });
    });
}

fn epsilon_ui(ui: &mut Ui, setup_form: &mut SetupForm) {
    ui.horizontal(|ui| {
        let label = ui.label(weak_text("Random at first"));
        // The number's box as wide for 5% as for 100%, and as low as the slider, or it would hang below it.
        (ui.spacing_mut().interact_size, ui.spacing_mut().button_padding.y) = (vec2(52.0, 18.0), 1.0);
        ui.spacing_mut().slider_width = (ui.available_width() - 58.0).max(40.0);
        let percent = |share: f64, _| format!("{:.0}%", share * 100.0);
        let slider = Slider::new(&mut setup_form.epsilon, 0.0..=1.0).step_by(0.05).custom_formatter(percent);
        let slider =
            slider.custom_parser(|text| Some(text.trim_end_matches(['%', ' ']).parse::<f64>().ok()? / 100.0));
        ui.add(slider)
            .labelled_by(label.id)
            .on_hover_text("Epsilon, the share of random actions (the paper: 50%)");
    });
}

fn choice_ui(ui: &mut Ui, what: &str, choices: &[Choice], from: &mut String, changed: bool) {
    let label = section_title_ui(ui, what);
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
        ui.label(weak_text("changed by hand"));
    }
    if !about.is_empty() {
        ui.label(weak_text(about));
    }
}

fn wide_button_ui(ui: &mut Ui, text: &str) -> egui::Response {
    ui.add_sized(vec2(ui.available_width(), TALL), Button::new(text))
}

/// Another seed than `before`, one that can be read out: splitmix64 of it and the time.
fn random_seed(before: u64, time_s: f64) -> u64 {
    let mut z = before ^ time_s.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    let seed = (z ^ (z >> 31)) % 1_000_000;
    if seed == before { seed + 1 } else { seed }
}
