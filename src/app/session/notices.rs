//! Notices: messages to the user, one per topic.
//!
//! In: events. Out: the [`Notice`]s that the screen shows. A confirmation disappears after a while. A warning or an
//! error stays until it is dismissed, replaced or no longer true.

use std::time::Duration;

use bevy::platform::time::Instant;
use bevy::prelude::*;

use crate::app::app_status::{Notice, Severity};
use crate::scenario::printable_lines;

/// Maximum number of notices; beyond it, the oldest confirmation is removed, or the oldest notice if there is none.
const MAX_NOTICES: usize = 4;

/// Time after which a confirmation disappears.
const INFO_NOTICE_DURATION: Duration = Duration::from_secs(8);

/// The subject of a notice. A newer notice replaces the one with the same topic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoticeTopic {
    /// No particular subject. The notice replaces only one with the same text.
    General,
    /// A file or folder, by its path.
    File(String),
    /// An object that the user tried to move.
    Move,
    /// A warning or an error about the second policy of a comparison.
    Comparison,
    /// Questionable settings of the current training run.
    Settings,
    /// A warning about the current training run. A new training run removes it.
    TrainingWarning,
    /// The error that stopped the current training run. A new training run removes it.
    TrainingFailure,
    /// Evaluation during training.
    Evaluation,
    /// The autosave of the training run.
    Autosave,
}

struct Entry {
    topic: NoticeTopic,
    notice: Notice,
    since: Instant,
}

/// The notices that are shown, oldest first.
#[derive(Resource, Default)]
pub struct Notices(Vec<Entry>);

impl Notices {
    /// Adds a notice, in place of an earlier one with the same topic. Text from files is made printable.
    pub fn add(&mut self, topic: NoticeTopic, severity: Severity, text: impl Into<String>) {
        let text = printable_lines(&text.into()).into_owned();
        match topic {
            NoticeTopic::General => self.0.retain(|entry| entry.notice.text != text),
            _ => self.remove(&topic),
        }
        if self.0.len() == MAX_NOTICES {
            let confirmation = self.0.iter().position(|entry| entry.notice.severity == Severity::Info);
            self.0.remove(confirmation.unwrap_or(0));
        }
        self.0.push(Entry { topic, notice: Notice { severity, text }, since: Instant::now() });
    }

    /// Removes the notice about `topic`, if there is one.
    pub(super) fn remove(&mut self, topic: &NoticeTopic) {
        self.0.retain(|entry| entry.topic != *topic);
    }

    /// Removes an error about `topic`; a confirmation stays.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn remove_error(&mut self, topic: &NoticeTopic) {
        self.0.retain(|entry| entry.topic != *topic || entry.notice.severity != Severity::Error);
    }

    /// Removes the notices about a training run that is being replaced, and about a comparison with it.
    pub(super) fn remove_training(&mut self) {
        self.remove(&NoticeTopic::Comparison);
        self.remove(&NoticeTopic::TrainingWarning);
        self.remove(&NoticeTopic::TrainingFailure);
        self.remove(&NoticeTopic::Evaluation);
    }

    /// Removes `notice`, if it is still shown.
    pub(super) fn dismiss(&mut self, notice: &Notice) {
        self.0.retain(|entry| entry.notice != *notice);
    }

    /// The error that stopped the current training run, if it is shown.
    #[cfg(not(target_arch = "wasm32"))]
    pub(in crate::app) fn training_failure(&self) -> Option<&str> {
        let failure = self.0.iter().find(|entry| entry.topic == NoticeTopic::TrainingFailure);
        failure.map(|entry| entry.notice.text.as_str())
    }

    /// The notices, oldest first.
    #[must_use]
    pub fn list(&self) -> Vec<Notice> {
        self.0.iter().map(|entry| entry.notice.clone()).collect()
    }

    fn remove_expired(&mut self) {
        self.0.retain(|entry| {
            entry.notice.severity != Severity::Info || entry.since.elapsed() < INFO_NOTICE_DURATION
        });
    }
}

/// Removes confirmations that have been shown long enough.
pub(super) fn expire(mut notices: ResMut<Notices>) {
    notices.remove_expired();
}

/// Adds a notice to the world's [`Notices`].
pub(crate) fn notify(world: &mut World, topic: NoticeTopic, severity: Severity, text: impl Into<String>) {
    world.resource_mut::<Notices>().add(topic, severity, text);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(notices: &Notices) -> Vec<String> {
        notices.list().into_iter().map(|notice| notice.text).collect()
    }

    #[test]
    fn a_newer_notice_replaces_the_one_with_the_same_topic() {
        let mut notices = Notices::default();
        let file = |name: &str| NoticeTopic::File(name.into());
        notices.add(file("a.ron"), Severity::Error, "a is broken");
        notices.add(file("b.ron"), Severity::Error, "b is broken");
        notices.add(file("a.ron"), Severity::Info, "a is loaded");
        assert_eq!(texts(&notices), ["b is broken", "a is loaded"]);
        notices.add(NoticeTopic::General, Severity::Error, "one");
        notices.add(NoticeTopic::General, Severity::Error, "two");
        notices.add(NoticeTopic::General, Severity::Error, "one");
        assert_eq!(texts(&notices), ["b is broken", "a is loaded", "two", "one"]);
    }

    #[test]
    fn no_more_than_four_notices_are_kept() {
        let mut notices = Notices::default();
        for k in 0..9 {
            notices.add(NoticeTopic::General, Severity::Error, k.to_string());
        }
        assert_eq!(texts(&notices), ["5", "6", "7", "8"]);
        let second = notices.list().swap_remove(1);
        notices.dismiss(&second);
        notices.dismiss(&second);
        assert_eq!(texts(&notices), ["5", "7", "8"]);
        notices.add(NoticeTopic::General, Severity::Info, "saved");
        notices.add(NoticeTopic::General, Severity::Error, "9");
        assert_eq!(texts(&notices), ["5", "7", "8", "9"], "a confirmation goes before an error");
    }
}
