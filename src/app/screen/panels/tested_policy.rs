//! The choice between the current and the best policy: for Test, Drive and Compare, and for a transfer.
//!
//! In: the session state. Out: commands, or the chosen policy.

use egui::Ui;

use crate::app::app_status::{AppStatus, BestSoFar};
use crate::app::commands::{Command, PolicySource, SessionMode};
use crate::app::screen::numbers::{format_count, format_percent};
use crate::app::screen::widgets::buttons::wide_button_ui;
use crate::app::screen::widgets::segments::{self, Segment};
use crate::app::screen::widgets::text::{section_title_ui, separator_ui};

const POLICIES: [PolicySource; 2] = [PolicySource::Current, PolicySource::Best];

/// Draws the section about the policy that is tested, in all modes but Train, once there is a best policy.
pub(super) fn tested_policy_ui(ui: &mut Ui, status: &AppStatus, commands: &mut Vec<Command>) {
    let Some(best) = status.best.filter(|_| status.mode != SessionMode::Train) else { return };
    section_title_ui(ui, "Policy");
    let names = ["Current policy", "Best policy"];
    commands.extend(policy_choice_ui(ui, names, status, best, status.tested).map(Command::SetTested));
    if status.mode == SessionMode::Compare {
        let about = "Drive the current and the best policy side by side";
        if wide_button_ui(ui, "Compare both", 26.0).on_hover_text(about).clicked() {
            commands.push(Command::OpenBest);
        }
    }
    separator_ui(ui);
}

/// Draws the choice between the current and the best policy, with these accessible names. Returns the one that was clicked.
pub(super) fn policy_choice_ui(
    ui: &mut Ui,
    names: [&str; 2],
    status: &AppStatus,
    best: BestSoFar,
    selected: PolicySource,
) -> Option<PolicySource> {
    let rate = format_percent(best.success_rate);
    let steps = format_count(best.env_steps);
    let texts = [
        ("Current".to_owned(), format!("The policy after {} env steps", format_count(status.env_steps))),
        (
            format!("Best {rate}"),
            format!("The best policy so far: {rate} in the evaluation at {steps} env steps"),
        ),
    ];
    let segment = |(name, (text, tip)): (&str, (String, String))| Segment { text, name: name.into(), tip };
    let segments: Vec<Segment> = names.into_iter().zip(texts).map(segment).collect();
    let selected = POLICIES.iter().position(|policy| *policy == selected);
    let width = ui.available_width();
    segments::segments_ui(ui, names[0], &segments, selected, Some(width)).map(|clicked| POLICIES[clicked])
}
