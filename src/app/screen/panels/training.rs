//! The first section of the setup panel: the choices for a training run, and the buttons that start it.
//!
//! In: the session state and the choices so far ([`SetupForm`]). Out: commands. A command that discards
//! training worth keeping is sent only after the user has confirmed it.

use egui::{Label, Slider, Ui, vec2};

use super::choices::{choice_in_words, choices_ui};
use super::discard_question::{discard_question_ui, send_or_ask};
use super::tested_policy::policy_choice_ui;
use crate::app::app_status::AppStatus;
use crate::app::commands::{Command, PolicySource};
use crate::app::screen::theme::{BODY, GAP};
use crate::app::screen::widgets::buttons::{primary_button_ui, wide_button_ui};
use crate::app::screen::widgets::text::{section_title_ui, weak_text};
use crate::app::setup_form::SetupForm;

/// The height of the buttons, in points.
const TALL: f32 = 30.0;

/// Draws the section.
pub fn training_ui(ui: &mut Ui, status: &AppStatus, form: &mut SetupForm, commands: &mut Vec<Command>) {
    choices_ui(ui, status, form);
    ui.add_space(GAP);
    start_buttons_ui(ui, status, form, commands);
    let has_opened = status.opened_policy.is_some();
    if let Some(name) = &status.opened_policy {
        opened_policy_ui(ui, name, status, form, commands);
    }
    let is_other_scenario = form.scenario != status.scenario_from;
    if has_opened && !is_other_scenario {
        epsilon_ui(ui, form);
    }
    // A confirmation is obsolete without the button that asked for it.
    let transfer_from = form.transfer_from;
    form.cancel_confirmation(|command| match command {
        Command::Transfer { policy: PolicySource::Opened, .. } => !has_opened,
        Command::Transfer { policy, .. } => !is_other_scenario || *policy != transfer_from,
        _ => false,
    });
}

/// Draws the buttons that start training with the choices, and the button that undoes the choices.
fn start_buttons_ui(ui: &mut Ui, status: &AppStatus, form: &mut SetupForm, commands: &mut Vec<Command>) {
    restart_ui(ui, status, form, commands);
    if form.scenario != status.scenario_from {
        let text = format!("Continue training{}", choice_in_words(status, form));
        let about = "Continue training in the chosen scenario with this policy (knowledge transfer)";
        transfer_button_ui(ui, &text, about, form.transfer_from, status, form, commands);
        form.transfer_from = status.best.map_or(PolicySource::Current, |best| {
            let names = ["Continue with the current policy", "Continue with the best policy"];
            policy_choice_ui(ui, names, status, best, form.transfer_from).unwrap_or(form.transfer_from)
        });
        epsilon_ui(ui, form);
    }
    if form.differs_from_running() && wide_button_ui(ui, "Undo choice", TALL).clicked() {
        form.reset(status);
    }
}

fn restart_ui(ui: &mut Ui, status: &AppStatus, form: &mut SetupForm, commands: &mut Vec<Command>) {
    if matches!(form.awaiting_confirmation, Some(Command::StartTraining { .. })) {
        return discard_question_ui(ui, status, form, commands);
    }
    let about = if status.scenario_modified {
        "Train from scratch with these settings, in the scenario as it is in its file, without your changes. The current \
         training run is discarded"
    } else {
        "Train from scratch with these settings. The current training run is discarded"
    };
    // In the accent colour only if the settings differ from the running ones.
    let button = if form.differs_from_running() {
        let text = format!("Train from scratch{}", choice_in_words(status, form));
        primary_button_ui(ui, &text, BODY, vec2(ui.available_width(), TALL))
    } else {
        wide_button_ui(ui, "Restart training", TALL)
    };
    if button.on_hover_text(about).clicked() {
        send_or_ask(form.start_training(), status, form, commands);
    }
}

/// Draws a button that starts training from `policy`, or the question that the button has opened.
fn transfer_button_ui(
    ui: &mut Ui,
    text: &str,
    about: &str,
    policy: PolicySource,
    status: &AppStatus,
    form: &mut SetupForm,
    commands: &mut Vec<Command>,
) {
    if matches!(&form.awaiting_confirmation, Some(Command::Transfer { policy: asked, .. }) if *asked == policy)
    {
        discard_question_ui(ui, status, form, commands);
    } else if wide_button_ui(ui, text, TALL).on_hover_text(about).clicked() {
        send_or_ask(form.transfer(policy), status, form, commands);
    }
}

fn opened_policy_ui(
    ui: &mut Ui,
    name: &str,
    status: &AppStatus,
    form: &mut SetupForm,
    commands: &mut Vec<Command>,
) {
    ui.add_space(GAP);
    section_title_ui(ui, "Opened policy");
    ui.add(Label::new(weak_text(name)).truncate()).on_hover_text(name);
    let (text, about) = if form.differs_from_running() {
        let text = format!("Train this policy{}", choice_in_words(status, form));
        (text, "Start training with these settings from this policy. The current training run is discarded")
    } else {
        let about = "Start training the same learner in the same scenario from this policy. The current training run is \
                     discarded";
        ("Continue training this policy".into(), about)
    };
    transfer_button_ui(ui, &text, about, PolicySource::Opened, status, form, commands);
}

fn epsilon_ui(ui: &mut Ui, form: &mut SetupForm) {
    ui.horizontal(|ui| {
        let label = ui.label(weak_text("Initial epsilon"));
        // The number field keeps its width from 5% to 100% and is as high as the slider.
        (ui.spacing_mut().interact_size, ui.spacing_mut().button_padding.y) = (vec2(52.0, 18.0), 1.0);
        ui.spacing_mut().slider_width = (ui.available_width() - 58.0).max(40.0);
        let percent = |fraction: f64, _| format!("{:.0}%", fraction * 100.0);
        let slider = Slider::new(&mut form.epsilon, 0.0..=1.0).step_by(0.05).custom_formatter(percent);
        let slider =
            slider.custom_parser(|text| Some(text.trim_end_matches(['%', ' ']).parse::<f64>().ok()? / 100.0));
        ui.add(slider)
            .labelled_by(label.id)
            .on_hover_text("Probability of a random action at the start (50% in the paper)");
    });
}
