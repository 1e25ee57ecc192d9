//! The choices for a training run on the setup panel: scenario, learner and seed. A note marks a choice that is not running.
//!
//! In: the session state and the choices so far ([`SetupForm`]). Out: changed choices.

use egui::{ComboBox, Label, Ui};

use super::seed::seed_ui;
use crate::app::app_status::{AppStatus, Choice};
use crate::app::screen::theme::GAP;
use crate::app::screen::widgets::text::{note_ui, section_title_ui, weak_text};
use crate::app::setup_form::SetupForm;

/// Draws the choices.
pub(super) fn choices_ui(ui: &mut Ui, status: &AppStatus, form: &mut SetupForm) {
    choice_ui(ui, "Scenario", &status.scenarios, &mut form.scenario);
    let running = title_of(&status.scenarios, &status.scenario_from);
    if form.scenario != status.scenario_from {
        note_ui(ui, &format!("Not running yet: the training run is in {running}"));
    } else {
        scenario_notes_ui(ui, status);
    }
    about_ui(ui, &status.scenarios, &form.scenario);
    ui.add_space(GAP);
    choice_ui(ui, "Learner", &status.presets, &mut form.preset);
    if form.preset != status.preset_from {
        let running = title_of(&status.presets, &status.preset_from);
        note_ui(ui, &format!("Not running yet: the training run uses {running}"));
    }
    about_ui(ui, &status.presets, &form.preset);
    ui.add_space(GAP);
    seed_ui(ui, form);
    if form.seed != status.seed {
        note_ui(ui, &format!("Not running yet: the training run has seed {}", status.seed));
    }
}

/// Shows notes on the running scenario: the policy that the training run started from, and changes by hand.
fn scenario_notes_ui(ui: &mut Ui, status: &AppStatus) {
    if let Some(from) = &status.transfer_from {
        let text = format!("policy from {from}");
        ui.add(Label::new(weak_text(&text)).truncate()).on_hover_text(text);
    }
    if status.scenario_modified {
        ui.label(weak_text("changed by hand"));
    }
}

/// The most important choice that differs from the current training run, as the end of a sentence.
pub(super) fn choice_in_words(status: &AppStatus, form: &SetupForm) -> String {
    if form.scenario != status.scenario_from {
        format!(" in {}", title_of(&status.scenarios, &form.scenario))
    } else if form.preset != status.preset_from {
        format!(" with {}", title_of(&status.presets, &form.preset))
    } else if form.seed != status.seed {
        format!(" with seed {}", form.seed)
    } else {
        String::new()
    }
}

/// The title of the choice whose name or file is `from`; `from` itself if there is none.
fn title_of<'a>(choices: &'a [Choice], from: &'a str) -> &'a str {
    choices.iter().find(|choice| choice.from == from).map_or(from, |choice| choice.title.as_str())
}

/// Shows a drop-down list titled `title`; `from` is the name or file of the chosen entry.
fn choice_ui(ui: &mut Ui, title: &str, choices: &[Choice], from: &mut String) {
    let label = section_title_ui(ui, title);
    let text = title_of(choices, from).to_owned();
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
}

/// Shows the description of the choice whose name or file is `from`.
fn about_ui(ui: &mut Ui, choices: &[Choice], from: &str) {
    let chosen = choices.iter().find(|choice| choice.from == from);
    if let Some(Choice { about, .. }) = chosen.filter(|choice| !choice.about.is_empty()) {
        ui.label(weak_text(about));
    }
}
