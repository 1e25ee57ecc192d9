//! Undo and redo. Each step stores the whole scenario as it was before (shared in memory), so undo cannot miss a change.

use std::collections::VecDeque;
use std::sync::Arc;

use super::limits::{MAX_SNAPSHOT_ITEMS, MAX_UNDO_STEPS, item_count};
use super::selection::Selection;
use crate::scenario::Scenario;

/// Number of undo steps that are kept even for the largest scenario.
const MIN_UNDO_STEPS: usize = 20;

/// A scenario and its selection.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EditSnapshot {
    pub scenario: Arc<Scenario>,
    pub selection: Selection,
    /// The origin of the scenario, if the step to or from this snapshot replaced the document.
    pub origin: Option<Origin>,
}

/// The origin of a scenario.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Origin {
    /// A name or a file.
    pub from: String,
    /// The scenario as shipped or as saved in its file; `None` if unknown.
    pub saved: Option<Arc<Scenario>>,
}

impl EditSnapshot {
    /// The snapshot as it is stored for the step to `other`. It keeps its origin only if that step replaces the document:
    /// if the document was saved after an ordinary step, undoing that step must not restore the origin from before the save.
    fn for_step_to(mut self, other: &Self) -> Self {
        self.origin = self.origin.filter(|_| other.origin.is_some());
        self
    }
}

/// The steps before and after the present state.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct UndoStack {
    before: VecDeque<EditSnapshot>,
    after: Vec<EditSnapshot>,
    /// The field that the last step changes, while further changes of it belong to the same step.
    open_field: Option<String>,
}

impl UndoStack {
    /// Begins a step: records the state before it and drops the steps to redo.
    pub fn push(&mut self, snapshot: EditSnapshot) {
        self.open_field = None;
        self.after.clear();
        let items = item_count(&snapshot.scenario).max(1);
        let max_steps = (MAX_SNAPSHOT_ITEMS / items).clamp(MIN_UNDO_STEPS, MAX_UNDO_STEPS);
        while self.before.len() >= max_steps {
            self.before.pop_front();
        }
        self.before.push_back(snapshot);
    }

    /// Lets further changes of `field` belong to the last step.
    pub fn open_group(&mut self, field: &str) {
        self.open_field = Some(field.to_owned());
    }

    /// Whether a change of `field` belongs to the last step.
    pub fn continues_group(&self, field: &str) -> bool {
        self.open_field.as_deref() == Some(field)
    }

    /// Ends the last step: the next change begins a new one.
    pub fn close_group(&mut self) {
        self.open_field = None;
    }

    /// Returns the state before the last step; keeps the present state `now` for redo.
    pub fn undo(&mut self, now: EditSnapshot) -> Option<EditSnapshot> {
        self.open_field = None;
        let snapshot = self.before.pop_back()?;
        self.after.push(now.for_step_to(&snapshot));
        Some(snapshot)
    }

    /// Returns the state after the step that was undone last; keeps the present state `now` for undo.
    pub fn redo(&mut self, now: EditSnapshot) -> Option<EditSnapshot> {
        self.open_field = None;
        let snapshot = self.after.pop()?;
        self.before.push_back(now.for_step_to(&snapshot));
        Some(snapshot)
    }

    /// The versions before and after the present one, up to the steps that replaced the document.
    pub fn snapshots_of_document(&self) -> impl Iterator<Item = &Arc<Scenario>> {
        let same = |snapshot: &&EditSnapshot| snapshot.origin.is_none();
        let before = self.before.iter().rev().take_while(same);
        before.chain(self.after.iter().rev().take_while(same)).map(|snapshot| &snapshot.scenario)
    }

    pub fn can_undo(&self) -> bool {
        !self.before.is_empty()
    }

    pub fn can_redo(&self) -> bool {
        !self.after.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn snapshot(name: &str, origin: Option<Origin>) -> EditSnapshot {
        let scenario = Arc::new(Scenario { name: name.into(), ..Scenario::default() });
        EditSnapshot { scenario, selection: Selection::Nothing, origin }
    }

    #[test]
    fn the_oldest_steps_are_dropped() {
        let mut stack = UndoStack::default();
        for k in 0..600 {
            stack.push(snapshot(&k.to_string(), None));
        }
        let (mut oldest, mut count) = (None, 0);
        while let Some(found) = stack.undo(snapshot("now", None)) {
            count += 1;
            oldest = Some(found.scenario.name.clone());
        }
        assert_eq!((count, oldest.as_deref()), (500, Some("100")));
    }

    #[test]
    fn an_origin_is_restored_only_where_the_document_was_replaced() {
        let origin = |from: &str| Some(Origin { from: from.into(), saved: None });
        let mut stack = UndoStack::default();
        stack.push(snapshot("a", origin("a.ron")));
        stack.push(snapshot("b", None));
        let b = stack.undo(snapshot("b changed", origin("b.ron"))).expect("a step");
        assert_eq!(b.origin, None, "this step did not replace the document");
        let a = stack.undo(snapshot("b", origin("b, saved elsewhere.ron"))).expect("a step");
        assert_eq!(a.origin, origin("a.ron"));
        let b = stack.redo(snapshot("a", origin("a, saved elsewhere.ron"))).expect("a step");
        assert_eq!(b.origin, origin("b, saved elsewhere.ron"));
        let changed = stack.redo(snapshot("b", origin("b.ron"))).expect("a step");
        assert_eq!((changed.scenario.name.as_str(), changed.origin), ("b changed", None));
    }
}
