//! The first section of the setup panel: scenario, learner and seed, and the buttons that start a training
//! with them.
//!
//! In: the session state and the choices so far ([`SetupForm`]). Out: commands. One that discards a training
//! worth keeping is sent only after the user has confirmed it.

use egui::{ComboBox, Label, Slider, Ui, vec2};

use super::discard_question::{discard_question_ui, send_or_ask};
use super::seed::seed_ui;
use crate::app::app_snapshot::{AppSnapshot, Choice};
use crate::app::commands::Command;
use crate::app::screen::theme::{BODY, GAP};
use crate::app::screen::widgets::buttons::{primary_button_ui, wide_button_ui};
use crate::app::screen::widgets::text::{section_title_ui, weak_text};
use crate::app::setup_form::SetupForm;

/// The height of the buttons, in points.
const TALL: f32 = 30.0;

/// Draws the section.
pub fn training_ui(ui: &mut Ui, status: &AppSnapshot, form: &mut SetupForm, commands: &mut Vec<Command>) {
    let changed = status.scenario_modified && form.scenario == status.scenario_from;
    choice_ui(ui, "Scenario", &status.scenarios, &mut form.scenario, changed);
    ui.add_space(GAP);
    choice_ui(ui, "Learner", &status.presets, &mut form.preset, false);
    ui.add_space(GAP);
    seed_ui(ui, &mut form.seed);
    ui.add_space(GAP);
    restart_ui(ui, status, form, commands);
    let other_scenario = form.scenario != status.scenario_from;
    if other_scenario {
        transfer_ui(ui, form, commands);
    }
    match &status.opened_policy {
        Some(name) => opened_policy_ui(ui, name, status, form, commands),
        None => {
            // Without the policy, the question no longer applies.
            let asked = form.awaiting_confirmation.take();
            form.awaiting_confirmation =
                asked.filter(|asked| !matches!(asked, Command::TrainFromOpened { .. }));
        }
    }
    if other_scenario || status.opened_policy.is_some() {
        epsilon_ui(ui, form);
    }
}

fn restart_ui(ui: &mut Ui, status: &AppSnapshot, form: &mut SetupForm, commands: &mut Vec<Command>) {
    if matches!(form.awaiting_confirmation, Some(Command::StartTraining { .. })) {
        return discard_question_ui(ui, status, form, commands);
    }
    let about = if status.scenario_modified {
        "Train from scratch with these settings, in the scenario as in its file, without your changes. The current training \
         is discarded"
    } else {
        "Train from scratch with these settings. The current training is discarded"
    };
    // In the accent colour only if the settings differ from those that run.
    let button = if form.differs_from_running() {
        primary_button_ui(ui, "Restart training", BODY, vec2(ui.available_width(), TALL))
    } else {
        wide_button_ui(ui, "Restart training", TALL)
    };
    if button.on_hover_text(about).clicked() {
        send_or_ask(form.start_training(), status, form, commands);
    }
}

fn transfer_ui(ui: &mut Ui, form: &SetupForm, commands: &mut Vec<Command>) {
    let about = "Continue training in the chosen scenario with the current weights (knowledge transfer)";
    if wide_button_ui(ui, "Continue here with this policy", TALL).on_hover_text(about).clicked() {
        commands.push(Command::Transfer { scenario: form.scenario.clone(), epsilon: form.epsilon });
    }
}

fn opened_policy_ui(
    ui: &mut Ui,
    name: &str,
    status: &AppSnapshot,
    form: &mut SetupForm,
    commands: &mut Vec<Command>,
) {
    ui.add_space(GAP);
    section_title_ui(ui, "Opened policy");
    ui.add(Label::new(weak_text(name)).truncate());
    if matches!(form.awaiting_confirmation, Some(Command::TrainFromOpened { .. })) {
        return discard_question_ui(ui, status, form, commands);
    }
    let about = "Start a new training of the same learner in the same scenario from this policy. The current training is \
                 discarded";
    if wide_button_ui(ui, "Continue training this policy", TALL).on_hover_text(about).clicked() {
        send_or_ask(Command::TrainFromOpened { epsilon: form.epsilon }, status, form, commands);
    }
}

fn epsilon_ui(ui: &mut Ui, form: &mut SetupForm) {
    ui.horizontal(|ui| {
        let label = ui.label(weak_text("Initial epsilon"));
        // The number field keeps its width from 5% to 100% and is as high as the slider.
        (ui.spacing_mut().interact_size, ui.spacing_mut().button_padding.y) = (vec2(52.0, 18.0), 1.0);
        ui.spacing_mut().slider_width = (ui.available_width() - 58.0).max(40.0);
        let percent = |share: f64, _| format!("{:.0}%", share * 100.0);
        let slider = Slider::new(&mut form.epsilon, 0.0..=1.0).step_by(0.05).custom_formatter(percent);
        let slider =
            slider.custom_parser(|text| Some(text.trim_end_matches(['%', ' ']).parse::<f64>().ok()? / 100.0));
        ui.add(slider)
            .labelled_by(label.id)
            .on_hover_text("Share of random actions at the start (the paper: 50%)");
    });
}

/// A drop-down list titled `title` with the description of the chosen entry below; `from` is the name or file
/// of the chosen one, and `changed` notes that the user has modified it.
fn choice_ui(ui: &mut Ui, title: &str, choices: &[Choice], from: &mut String, changed: bool) {
    let label = section_title_ui(ui, title);
    let chosen = choices.iter().find(|choice| choice.from == *from);
    let text = chosen.map_or(from.as_str(), |choice| choice.title.as_str()).to_owned();
    let about = chosen.map_or("", |choice| choice.about.as_str());
    let width = ui.available_width();
    let combo = ComboBox::from_id_salt(title).selected_text(text).width(width).truncate();
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
