//! Undo and redo: the world as it was before each step.
//!
//! In: each moment before a change. Out: the moment before or after. A moment is the whole world, shared, not copied;
//! so nothing can be forgotten on the way back.

use std::collections::VecDeque;
use std::sync::Arc;

use super::selection::Selection;
use super::things;
use crate::scenario::Scenario;

/// The most steps that are kept.
const MAX_UNDO_STEPS: usize = 500;
/// The most things in all worlds that are kept together: in very large worlds there are fewer steps.
const MAX_TOTAL_ITEMS: usize = 1_000_000;

/// A world, and what was selected in it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EditSnapshot {
    pub scenario: Arc<Scenario>,
    pub selection: Selection,
    /// Where it came from, if the step to or from it opened another world.
    pub origin: Option<Origin>,
}

/// Where a world came from.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Origin {
    /// A name or a file.
    pub from: String,
    /// As it stands there, if it does.
    pub saved: Option<Arc<Scenario>>,
}

impl EditSnapshot {
    /// With its origin only if the step to `other` has to do with that: a world that was saved between is saved still.
    fn for_step(mut self, other: &Self) -> Self {
        self.origin = self.origin.filter(|_| other.origin.is_some());
        self
    }
}

/// The way back and the way forward.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct UndoStack {
    before: VecDeque<EditSnapshot>,
    after: Vec<EditSnapshot>,
    /// The field that the last step is of, while it may go on.
    field: Option<String>,
}

impl UndoStack {
    /// Notes the moment before a change; there is no way forward any more.
    pub fn push(&mut self, moment: EditSnapshot) {
        self.field = None;
        self.after.clear();
        let most = (MAX_TOTAL_ITEMS / things(&moment.scenario).max(1)).clamp(20, MAX_UNDO_STEPS);
        while self.before.len() >= most {
            self.before.pop_front();
        }
        self.before.push_back(moment);
    }

    /// The last step is of this field, and may go on.
    pub fn open_group(&mut self, field: &str) {
        self.field = Some(field.to_owned());
    }

    /// Whether a change of this field belongs to the last step.
    pub fn continues_group(&self, field: &str) -> bool {
        self.field.as_deref() == Some(field)
    }

    pub fn close_group(&mut self) {
        self.field = None;
    }

    /// The moment before the last step, in place of this one.
    pub fn undo(&mut self, now: EditSnapshot) -> Option<EditSnapshot> {
        self.field = None;
        let moment = self.before.pop_back()?;
        self.after.push(now.for_step(&moment));
        Some(moment)
    }

    /// The moment after this one, if the way here was [`back`](Self::back).
    pub fn redo(&mut self, now: EditSnapshot) -> Option<EditSnapshot> {
        self.field = None;
        let moment = self.after.pop()?;
        self.before.push_back(now.for_step(&moment));
        Some(moment)
    }

    /// The worlds before and after this moment, as far as no other was opened between.
    pub fn snapshots_of_document(&self) -> impl Iterator<Item = &Arc<Scenario>> {
        let same = |moment: &&EditSnapshot| moment.origin.is_none();
        let before = self.before.iter().rev().take_while(same);
        before.chain(self.after.iter().rev().take_while(same)).map(|moment| &moment.scenario)
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

    fn moment(name: &str, origin: Option<Origin>) -> EditSnapshot {
        let scenario = Arc::new(Scenario { name: name.into(), ..Scenario::default() });
        EditSnapshot { scenario, selection: Selection::Nothing, origin }
    }

    #[test]
    fn the_oldest_steps_are_forgotten() {
        let mut steps = UndoStack::default();
        for k in 0..600 {
            steps.push(moment(&k.to_string(), None));
        }
        let (mut oldest, mut count) = (None, 0);
        while let Some(found) = steps.undo(moment("now", None)) {
            count += 1;
            oldest = Some(found.scenario.name.clone());
        }
        assert_eq!((count, oldest.as_deref()), (500, Some("100")));
    }

    #[test]
    fn an_origin_goes_along_only_where_another_world_was_opened() {
        let origin = |from: &str| Some(Origin { from: from.into(), saved: None });
        let mut steps = UndoStack::default();
        steps.push(moment("a", origin("a.ron")));
        steps.push(moment("b", None));
        let b = steps.undo(moment("b changed", origin("b.ron"))).expect("a step");
        assert_eq!(b.origin, None, "nothing was opened in this step");
        let a = steps.undo(moment("b", origin("b, saved elsewhere.ron"))).expect("a step");
        assert_eq!(a.origin, origin("a.ron"));
        let b = steps.redo(moment("a", origin("a, saved elsewhere.ron"))).expect("a step");
        assert_eq!(b.origin, origin("b, saved elsewhere.ron"));
        let changed = steps.redo(moment("b", origin("b.ron"))).expect("a step");
        assert_eq!((changed.scenario.name.as_str(), changed.origin), ("b changed", None));
    }
}
