//! The scenario's file: where it came from, whether it is saved, and what the session reports about it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::document::Editor;
use super::selection::Selection;
use super::session_state::SessionState;
use super::tool::Tool;
use crate::scenario::Scenario;

impl Editor {
    /// Takes over what the session has saved or opened since the last frame: `saved` is a path and the scenario saved
    /// there, `draft` a serial number, a name or path, and the scenario opened from it. Whatever is reported in the first
    /// frame is ignored.
    pub fn sync_with_session(
        &mut self,
        saved: Option<&(String, Arc<Scenario>)>,
        draft: Option<&(u64, String, Arc<Scenario>)>,
    ) {
        let now = SessionState::new(saved.cloned(), draft.map(|draft| draft.0));
        let Some(last) = self.last_session.replace(now) else { return };
        if let Some((path, scenario)) = saved
            && !last.has_saved(path, scenario)
            && self.has_had(scenario)
        {
            // Undo must stop at the saved scenario.
            self.close_group();
            self.from.clone_from(path);
            self.saved = Some(Arc::clone(scenario));
        }
        if let Some((serial, from, scenario)) = draft
            && !last.has_opened(*serial)
        {
            self.replace(scenario, from);
        }
    }

    /// Whether `scenario` is this document, now or some undo steps away. A file dialog may return after another scenario
    /// was opened.
    fn has_had(&self, scenario: &Arc<Scenario>) -> bool {
        let mut versions = std::iter::once(&self.scenario).chain(self.undo_stack.snapshots_of_document());
        versions.any(|version| Arc::ptr_eq(version, scenario) || version == scenario)
    }

    /// Replaces the document by another scenario; undo brings the old one back.
    fn replace(&mut self, scenario: &Arc<Scenario>, from: &str) {
        self.end_drag();
        let before = self.snapshot();
        self.undo_stack.push(before);
        self.scenario = Arc::clone(scenario);
        self.saved = Some(Arc::clone(scenario));
        self.from = from.to_owned();
        (self.selection, self.tool) = (Selection::Nothing, Tool::Select);
        self.changed();
    }

    /// The name or file that the scenario came from or was last saved to.
    #[must_use]
    pub fn from(&self) -> &str {
        &self.from
    }

    /// The file that the scenario can be saved to; `None` for a built-in scenario.
    #[must_use]
    pub fn file(&self) -> Option<PathBuf> {
        let path = Path::new(&self.from);
        (path.extension() == Some("ron".as_ref())).then(|| path.into())
    }

    /// Whether there are unsaved changes or an unfinished drawing.
    #[must_use]
    pub fn is_modified(&self) -> bool {
        let is_saved = |saved: &Arc<Scenario>| Arc::ptr_eq(saved, &self.scenario) || *saved == self.scenario;
        self.is_drafting() || !self.saved.as_ref().is_some_and(is_saved)
    }
}
