//! The editor: a world that is being changed, as a document beside the one that runs.
//!
//! In: what the pointer and the fields on the screen ask for. Out: the changed [`Scenario`], with what is wrong with it
//! at every moment, and the way back by undo. Nothing is drawn here, and nothing here reaches the world that runs: that
//! takes an order. All of it is plain data and rules; every place is in m, every angle in rad.
//!
//! | file | duty |
//! |---|---|
//! | `selection.rs` | what can be selected, what is under the pointer, what a finding is about |
//! | `handles.rs` | what can be dragged; `body.rs`, `obstacle_path.rs`, `corners.rs`, `rectangles.rs`, `start_goal_handles.rs` of what |
//! | `drag.rs` | one drag, from taking hold to letting go |
//! | `snap.rs`, `points.rs` | even numbers |
//! | `items.rs` | what is added, copied, deleted |
//! | `kinds.rs` | another kind of motion, of rule, of enclosure, with numbers that fit |
//! | `tools.rs` | what is drawn corner by corner |
//! | `undo.rs` | undo and redo |

mod body;
mod corners;
mod drag;
mod handles;
mod items;
mod kinds;
mod obstacle_path;
mod points;
mod rectangles;
mod selection;
mod snap;
mod start_goal_handles;
#[cfg(test)]
mod tests;
mod tools;
mod undo;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::scenario::{Diagnostic, Scenario, diagnostics};

pub use handles::{Handle, HandleKind};
pub use items::NewItem;
pub use kinds::{EnclosureKind, MotionKind, PlacementKind, PlacementRole};
pub use points::format_metres;
pub use selection::Selection;
pub use snap::Snap;
pub use tools::Tool;

use bevy::math::Vec2;
use drag::Drag;
use items::EditorItem;
use undo::{EditSnapshot, Origin, UndoStack};

/// Of more things than this the findings wait for the end of a drag.
const MAX_ITEMS_CHECKED_WHILE_DRAGGING: usize = 1_000;

/// A world in the hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Editor {
    /// Whether what is dragged goes to even numbers.
    pub snap: Snap,
    scenario: Arc<Scenario>,
    selection: Selection,
    tool: Tool,
    drag: Option<Drag>,
    undo_stack: UndoStack,
    clipboard: Option<EditorItem>,
    diagnostics: Vec<Diagnostic>,
    revision: u64,
    from: String,
    /// As the file has it, if there is one.
    saved: Option<Arc<Scenario>>,
}

impl Editor {
    /// Begins with `scenario`. `from` is the name or the file it came from, and `saved` whether it is still the same
    /// there.
    #[must_use]
    pub fn open(scenario: Arc<Scenario>, from: String, saved: bool) -> Self {
        Self {
            snap: Snap::default(),
            selection: Selection::Nothing,
            tool: Tool::Select,
            drag: None,
            undo_stack: UndoStack::default(),
            clipboard: None,
            diagnostics: diagnostics(&scenario),
            revision: 0,
            from,
            saved: saved.then(|| Arc::clone(&scenario)),
            scenario,
        }
    }

    /// Takes note that `scenario` was saved to `file`. Ignored if it is not a state of this document: the file dialog may
    /// answer after another document was opened.
    pub fn mark_saved(&mut self, file: &str, scenario: &Arc<Scenario>) {
        if !self.has_had(scenario) {
            return;
        }
        // The next change begins a new undo step, so that undo stops at what was saved.
        self.close_group();
        file.clone_into(&mut self.from);
        self.saved = Some(Arc::clone(scenario));
    }

    /// Whether it is this world, now or some steps ago, and not one that was edited before it was opened: files are
    /// chosen at leisure.
    fn has_had(&self, world: &Arc<Scenario>) -> bool {
        let mut all = std::iter::once(&self.scenario).chain(self.undo_stack.snapshots_of_document());
        all.any(|had| Arc::ptr_eq(had, world) || had == world)
    }

    /// Edits another scenario from now on, opened from `from`. Undo leads back to the previous one.
    pub fn open_other(&mut self, from: &str, world: &Arc<Scenario>) {
        self.end_drag();
        let before = self.now();
        self.undo_stack.push(before);
        self.scenario = Arc::clone(world);
        self.saved = Some(Arc::clone(world));
        self.from = from.to_owned();
        (self.selection, self.tool) = (Selection::Nothing, Tool::Select);
        self.changed();
    }

    /// This moment, with where the world came from.
    fn now(&self) -> EditSnapshot {
        let origin = Origin { from: self.from.clone(), saved: self.saved.clone() };
        EditSnapshot { scenario: Arc::clone(&self.scenario), selection: self.selection, origin: Some(origin) }
    }

    /// Notes this moment before a change.
    fn record(&mut self) {
        self.undo_stack.push(EditSnapshot { origin: None, ..self.now() });
    }

    /// The world as it is now, in the middle of a drag, too.
    #[must_use]
    pub fn scenario(&self) -> &Arc<Scenario> {
        &self.scenario
    }

    /// The name or the file that it came from, or was saved to.
    #[must_use]
    pub fn from(&self) -> &str {
        &self.from
    }

    /// The file that it can be saved to again; none of a world that came with the program.
    #[must_use]
    pub fn file(&self) -> Option<PathBuf> {
        let path = Path::new(&self.from);
        (path.extension() == Some("ron".as_ref())).then(|| path.into())
    }

    /// Another number after every change of the world.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// What is wrong with the world now.
    #[must_use]
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Whether something is wrong with this.
    #[must_use]
    pub fn has_error(&self, selection: Selection) -> bool {
        selection != Selection::Nothing
            && self.diagnostics.iter().any(|finding| Selection::from_field_path(&finding.path) == selection)
    }

    /// Whether it differs from what was opened or saved last, or something is half drawn.
    #[must_use]
    pub fn is_modified(&self) -> bool {
        self.is_drafting()
            || self
                .saved
                .as_ref()
                .is_none_or(|saved| !Arc::ptr_eq(saved, &self.scenario) && *saved != self.scenario)
    }

    /// What is selected.
    #[must_use]
    pub fn selection(&self) -> Selection {
        self.selection
    }

    /// Selects; nothing if there is no such thing. Ends the tool.
    pub fn select(&mut self, selection: Selection) {
        self.end_drag();
        self.close_group();
        if selection != self.selection {
            self.tool = Tool::Select;
        }
        self.selection = selection.if_present(&self.scenario);
    }

    /// What is under `position_m`, with so much slack for what is small or thin. What is selected wins where things overlap.
    #[must_use]
    pub fn pick(&self, position_m: Vec2, slack_m: f32) -> Selection {
        selection::pick(&self.scenario, self.selection, position_m, slack_m)
    }

    /// What can be dragged of what is selected; later ones lie on top.
    #[must_use]
    pub fn handles(&self) -> Vec<Handle> {
        handles::of(&self.scenario, self.selection)
    }

    /// The point about which the handle [`HandleKind::Rotate`] turns what is selected, and the angle now.
    #[must_use]
    pub fn rotation_of(&self) -> Option<(Vec2, f32)> {
        handles::rotation_of(&self.scenario, self.selection)
    }

    /// Where a point that is dragged or clicked to `position_m` goes.
    #[must_use]
    pub fn snapped(&self, position_m: Vec2, free: bool) -> Vec2 {
        self.snap.disabled_if(free).point(position_m, handles::middle_of(&self.scenario))
    }

    /// The world changed otherwise than by a drag: in one step of its own, unless `change` leaves it as it is.
    fn step(&mut self, change: impl FnOnce(&mut Scenario, &mut Selection)) {
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

    /// Changes `field` of the world, as it is typed or dragged in the inspector. The same field again is the same step,
    /// until [`close_group`](Self::seal) or anything else.
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

    /// What is typed next is another step, be it in the same field.
    pub fn close_group(&mut self) {
        self.undo_stack.close_group();
    }

    /// One step back; a drag that goes on is given up instead.
    pub fn undo(&mut self) {
        if self.drag.is_some() {
            return self.cancel_drag();
        }
        self.go(UndoStack::undo);
    }

    /// One step forward again.
    pub fn redo(&mut self) {
        self.end_drag();
        self.go(UndoStack::redo);
    }

    fn go(&mut self, way: impl FnOnce(&mut UndoStack, EditSnapshot) -> Option<EditSnapshot>) {
        let now = self.now();
        if let Some(moment) = way(&mut self.undo_stack, now) {
            self.scenario = moment.scenario;
            if let Some(origin) = moment.origin {
                (self.from, self.saved) = (origin.from, origin.saved);
            }
            self.selection = moment.selection.if_present(&self.scenario);
            self.tool = Tool::Select;
            self.changed();
        }
    }

    /// Whether there is a step to go back.
    #[must_use]
    pub fn can_undo(&self) -> bool {
        self.undo_stack.can_undo()
    }

    /// Whether there is a step to go forward.
    #[must_use]
    pub fn can_redo(&self) -> bool {
        self.undo_stack.can_redo()
    }

    fn changed(&mut self) {
        self.revision += 1;
        if self.drag.is_none() || things(&self.scenario) <= MAX_ITEMS_CHECKED_WHILE_DRAGGING {
            self.diagnostics = diagnostics(&self.scenario);
        }
    }
}

/// How many things there are in a world.
fn things(scenario: &Scenario) -> usize {
    let corners = scenario.walls.iter().map(|wall| wall.corners_m.len()).sum::<usize>();
    scenario.obstacles.len() + corners
}
