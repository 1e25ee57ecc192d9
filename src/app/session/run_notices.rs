//! The notice about questionable settings of the current training run.
//!
//! In: the training run's configuration. Out: one notice that stays until it is dismissed or the settings change.

use bevy::prelude::*;

use super::notices::{NoticeTopic, Notices, notify};
use super::training_run::TrainingRun;
use crate::app::app_status::Severity;
use crate::run::notes::run_notes;

/// Maximum number of notes that the notice lists.
const MAX_LISTED: usize = 3;

/// Shows the notes about the current training run, in place of those about an earlier one.
pub(super) fn show_notes(world: &mut World) {
    world.resource_mut::<Notices>().remove(&NoticeTopic::Settings);
    let notes = run_notes(&world.resource::<TrainingRun>().config);
    let mut lines: Vec<String> = notes.iter().take(MAX_LISTED).map(ToString::to_string).collect();
    match notes.len().saturating_sub(MAX_LISTED) {
        0 => {}
        more => lines.push(format!("and {more} more")),
    }
    if !lines.is_empty() {
        notify(world, NoticeTopic::Settings, Severity::Warning, lines.join("\n"));
    }
}
