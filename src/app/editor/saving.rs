//! The scenario's file, and whether the scenario is saved.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::document::Editor;
use super::selection::Selection;
use super::tool::Tool;
use crate::scenario::Scenario;

impl Editor {
    /// Records that `scenario` was saved to `file`. Ignored unless it is a version of this document: a file dialog may
    /// return after another scenario was opened.
    pub fn mark_saved(&mut self, file: &str, scenario: &Arc<Scenario>) {
        if !self.is_version(scenario) {
            return;
        }
        // The next change begins a new undo step, so that undo stops at the saved scenario.
        self.close_group();
        file.clone_into(&mut self.from);
        self.saved = Some(Arc::clone(scenario));
    }

    /// Whether `scenario` is the current state of this document, or one that undo or redo can restore.
    fn is_version(&self, scenario: &Arc<Scenario>) -> bool {
        let mut versions = std::iter::once(&self.scenario).chain(self.undo_stack.snapshots_of_document());
        versions.any(|version| Arc::ptr_eq(version, scenario) || version == scenario)
    }

    /// Replaces the document with another scenario, opened from `from`; undo brings the old one back.
    pub fn open_other(&mut self, from: &str, scenario: &Arc<Scenario>) {
        self.end_drag();
        let before = self.snapshot();
        self.undo_stack.push(before);
        self.scenario = Arc::clone(scenario);
        self.saved = Some(Arc::clone(scenario));
        self.from = from.to_owned();
        (self.selection, self.tool) = (Selection::Nothing, Tool::Select);
        self.changed();
    }

    /// The name or file that the scenario was opened from or last saved to.
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

    /// The scenario as shipped or as saved in its file; `None` if unknown, for example if the editor was opened with
    /// unsaved changes.
    #[must_use]
    pub fn scenario_in_file(&self) -> Option<&Arc<Scenario>> {
        self.saved.as_ref()
    }

    /// Whether the scenario differs from its file.
    #[must_use]
    pub fn has_unsaved_changes(&self) -> bool {
        let is_saved = |saved: &Arc<Scenario>| Arc::ptr_eq(saved, &self.scenario) || *saved == self.scenario;
        !self.saved.as_ref().is_some_and(is_saved)
    }

    /// Whether there are unsaved changes or an unfinished drawing.
    #[must_use]
    pub fn is_modified(&self) -> bool {
        self.is_drafting() || self.has_unsaved_changes()
    }
}
