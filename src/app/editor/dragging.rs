//! Dragging and nudging the selected item.

use std::sync::Arc;

use bevy::math::{Vec2, vec2};

use super::document::Editor;
use super::drag::Drag;
use super::handle::HandleKind;
use super::items;
use super::tool::Tool;
use super::undo::EditSnapshot;

/// Distance of a nudge without snapping, in m.
const FINE_STEP_M: f32 = 0.01;

impl Editor {
    /// Begins to drag a handle of the selected item with the pointer at `position_m`. Returns whether the item has such
    /// a handle. An insert handle inserts its point, which is then dragged.
    pub fn begin_drag(&mut self, kind: HandleKind, position_m: Vec2) -> bool {
        self.end_drag();
        self.close_group();
        if !position_m.is_finite() {
            return false;
        }
        let Some(drag) = Drag::begin(&self.scenario, self.selection, kind, position_m) else { return false };
        let begun = Arc::clone(&drag.begun);
        self.tool = Tool::Select;
        self.drag = Some(drag);
        if begun != self.scenario {
            self.scenario = begun;
            self.changed();
        }
        true
    }

    /// Continues the drag with the pointer at `position_m`; `free` disables snapping.
    pub fn drag_to(&mut self, position_m: Vec2, free: bool) {
        let Some(drag) = self.drag.as_ref().filter(|_| position_m.is_finite()) else { return };
        let scenario = drag.scenario_at(position_m, self.snap.disabled_if(free));
        if let Some(scenario) = scenario.filter(|scenario| *scenario != *self.scenario) {
            self.scenario = Arc::new(scenario);
            self.changed();
        }
    }

    /// Ends the drag: one undo step, or none if nothing changed.
    pub fn end_drag(&mut self) {
        let Some(drag) = self.drag.take() else { return };
        if self.scenario != drag.before {
            let (scenario, selection) = (drag.before, drag.selection);
            self.undo_stack.push(EditSnapshot { scenario, selection, origin: None });
            self.changed();
        }
    }

    /// Cancels the drag and restores the scenario.
    pub fn cancel_drag(&mut self) {
        let Some(drag) = self.drag.take() else { return };
        self.scenario = drag.before;
        self.changed();
    }

    /// The dragged handle; for an insert handle, the handle of the inserted point.
    #[must_use]
    pub fn dragged(&self) -> Option<HandleKind> {
        self.drag.as_ref().map(|drag| drag.kind)
    }

    /// Removes the corner, the waypoint, or the start or goal position at a handle of the selected item. Returns false if
    /// the handle is at none of these or too few would remain.
    pub fn remove_handle(&mut self, kind: HandleKind) -> bool {
        // The end of a drag changes the revision too.
        self.end_drag();
        let before = self.revision();
        self.step(|scenario, selection| {
            items::selected(*selection).and_then(|item| item.remove(scenario, kind));
        });
        self.revision() != before
    }

    /// Moves the selected item by this many grid steps, or centimetres if snapping is off or `fine` is set. Repeated
    /// nudges along the same axis are one undo step.
    pub fn nudge(&mut self, right: i32, up: i32, fine: bool) {
        let step_m = if self.snap.on && !fine { self.snap.step_m } else { FINE_STEP_M };
        let (selection, by_m) = (self.selection, vec2(right as f32, up as f32) * step_m);
        let field = match (right, up) {
            (_, 0) => "nudge along x",
            (0, _) => "nudge along y",
            _ => "nudge",
        };
        self.edit(field, |scenario| {
            items::selected(selection).and_then(|item| item.translate(scenario, by_m));
        });
    }
}
