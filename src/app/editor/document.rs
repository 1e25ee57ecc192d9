//! The document: the edited scenario, its selection, its diagnostics and its notes.

use std::sync::Arc;

use bevy::math::Vec2;

use super::drag::Drag;
use super::handle::Handle;
use super::items::{self, ListItem};
use super::limits::{MAX_ITEMS_CHECKED_WHILE_DRAGGING, item_count};
use super::pick;
use super::points::centre_of;
use super::selection::Selection;
use super::snap::Snap;
use super::tool::Tool;
use super::undo::{EditSnapshot, Origin, UndoStack};
use crate::scenario::{Diagnostic, Note, Scenario, diagnostics, notes};

/// The editor of one scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Editor {
    /// Snapping of positions, sizes and angles.
    pub snap: Snap,
    pub(super) scenario: Arc<Scenario>,
    pub(super) selection: Selection,
    pub(super) tool: Tool,
    pub(super) drag: Option<Drag>,
    pub(super) undo_stack: UndoStack,
    pub(super) clipboard: Option<ListItem>,
    diagnostics: Vec<Diagnostic>,
    notes: Vec<Note>,
    revision: u64,
    /// The scenario's name or file.
    pub(super) from: String,
    /// The scenario as shipped or as saved in its file; `None` if unknown.
    pub(super) saved: Option<Arc<Scenario>>,
}

impl Editor {
    /// An editor of `scenario`. `from` is the scenario's name or file; `saved` is whether it equals the scenario stored there.
    #[must_use]
    pub fn open(scenario: Arc<Scenario>, from: String, saved: bool) -> Self {
        let in_file = saved.then(|| scenario.clone());
        Self::with_changes(scenario, from, in_file)
    }

    /// An editor of `scenario`, which may differ from `in_file`, the scenario as shipped or as saved in its file; `None` if
    /// unknown.
    #[must_use]
    pub fn with_changes(scenario: Arc<Scenario>, from: String, in_file: Option<Arc<Scenario>>) -> Self {
        Self {
            snap: Snap::default(),
            selection: Selection::Nothing,
            tool: Tool::Select,
            drag: None,
            undo_stack: UndoStack::default(),
            clipboard: None,
            diagnostics: diagnostics(&scenario),
            notes: notes(&scenario),
            revision: 0,
            from,
            saved: in_file,
            scenario,
        }
    }

    /// The edited scenario, also during a drag.
    #[must_use]
    pub fn scenario(&self) -> &Arc<Scenario> {
        &self.scenario
    }

    /// A number that grows with every change to the scenario.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// The problems of the scenario.
    #[must_use]
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Notes on values of the scenario that are valid but questionable.
    #[must_use]
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Whether an item has a problem.
    #[must_use]
    pub fn has_error(&self, selection: Selection) -> bool {
        selection != Selection::Nothing
            && self.diagnostics.iter().any(|problem| Selection::from_field_path(&problem.path) == selection)
    }

    /// The selected item.
    #[must_use]
    pub fn selection(&self) -> Selection {
        self.selection
    }

    /// Selects an item, or nothing if the scenario does not have it. Selecting another item deselects the tool.
    pub fn select(&mut self, selection: Selection) {
        self.end_drag();
        self.close_group();
        if selection != self.selection {
            self.tool = Tool::Select;
        }
        self.selection = selection.if_present(&self.scenario);
    }

    /// The item at `position_m`. Small and thin items are hit within `slack_m`; the selected item wins where solid items
    /// overlap.
    #[must_use]
    pub fn pick(&self, position_m: Vec2, slack_m: f32) -> Selection {
        pick::pick(&self.scenario, self.selection, position_m, slack_m)
    }

    /// The handles of the selected item; later ones are drawn above earlier ones.
    #[must_use]
    pub fn handles(&self) -> Vec<Handle> {
        items::selected(self.selection).map_or_else(Vec::new, |item| item.handles(&self.scenario))
    }

    /// The centre of rotation of the selected item in m and its angle in rad, if it can be rotated.
    #[must_use]
    pub fn rotation_of(&self) -> Option<(Vec2, f32)> {
        items::selected(self.selection)?.rotation(&self.scenario)
    }

    /// `position_m` snapped, or rounded to a millimetre if `free`.
    #[must_use]
    pub fn snapped(&self, position_m: Vec2, free: bool) -> Vec2 {
        self.snap.disabled_if(free).point(position_m, centre_of(&self.scenario))
    }

    /// Changes the scenario and the selection in one undo step. If the scenario stays the same, there is no step.
    pub(super) fn step(&mut self, change: impl FnOnce(&mut Scenario, &mut Selection)) {
        self.end_drag();
        self.close_group();
        let (before, selected) = (Arc::clone(&self.scenario), self.selection);
        let (mut scenario, mut selection) = (Scenario::clone(&before), selected);
        change(&mut scenario, &mut selection);
        if scenario != *before {
            self.record();
            self.scenario = Arc::new(scenario);
            self.changed();
        }
        self.selection = selection.if_present(&self.scenario);
        self.check_tool(&before, selected);
    }

    /// Changes one field of the scenario. Repeated changes of the same field are one undo step, until
    /// [`close_group`](Self::close_group) is called or another operation follows.
    pub fn edit(&mut self, field: &str, change: impl FnOnce(&mut Scenario)) {
        self.end_drag();
        let mut scenario = Scenario::clone(&self.scenario);
        change(&mut scenario);
        if scenario == *self.scenario {
            return;
        }
        if !self.undo_stack.continues_group(field) {
            self.record();
            self.undo_stack.open_group(field);
        }
        let (before, selected) = (std::mem::replace(&mut self.scenario, Arc::new(scenario)), self.selection);
        self.changed();
        self.selection = selected.if_present(&self.scenario);
        self.check_tool(&before, selected);
    }

    /// Ends the current undo step. The next [`edit`](Self::edit) of the same field begins another one.
    pub fn close_group(&mut self) {
        self.undo_stack.close_group();
    }

    /// Undoes one step; during a drag, cancels the drag.
    pub fn undo(&mut self) {
        if self.drag.is_some() {
            return self.cancel_drag();
        }
        self.restore(UndoStack::undo);
    }

    /// Redoes one step.
    pub fn redo(&mut self) {
        self.end_drag();
        self.restore(UndoStack::redo);
    }

    fn restore(&mut self, travel: impl FnOnce(&mut UndoStack, EditSnapshot) -> Option<EditSnapshot>) {
        let now = self.snapshot();
        if let Some(snapshot) = travel(&mut self.undo_stack, now) {
            self.scenario = snapshot.scenario;
            if let Some(origin) = snapshot.origin {
                (self.from, self.saved) = (origin.from, origin.saved);
            }
            self.selection = snapshot.selection.if_present(&self.scenario);
            self.tool = Tool::Select;
            self.changed();
        }
    }

    /// Whether there is a step to undo.
    #[must_use]
    pub fn can_undo(&self) -> bool {
        self.undo_stack.can_undo()
    }

    /// Whether there is a step to redo.
    #[must_use]
    pub fn can_redo(&self) -> bool {
        self.undo_stack.can_redo()
    }

    /// The present state, with the origin of the scenario.
    pub(super) fn snapshot(&self) -> EditSnapshot {
        let origin = Origin { from: self.from.clone(), saved: self.saved.clone() };
        EditSnapshot { scenario: Arc::clone(&self.scenario), selection: self.selection, origin: Some(origin) }
    }

    /// Begins an undo step that restores the present state.
    fn record(&mut self) {
        self.undo_stack.push(EditSnapshot { origin: None, ..self.snapshot() });
    }

    /// Updates the revision, the diagnostics and the notes after a change.
    pub(super) fn changed(&mut self) {
        self.revision += 1;
        if self.drag.is_none() || item_count(&self.scenario) <= MAX_ITEMS_CHECKED_WHILE_DRAGGING {
            self.diagnostics = diagnostics(&self.scenario);
            self.notes = notes(&self.scenario);
        }
    }
}
