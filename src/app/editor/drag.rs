//! One drag: from taking hold of a handle to letting go.
//!
//! In: the pointer. Out: the world at each moment of it, worked from the world at its beginning; one step for undo.

use std::sync::Arc;

use bevy::math::{Vec2, vec2};

use super::handles::{self, HandleKind};
use super::points::{distance, is_finite, minus, plus};
use super::selection::{Selection, places};
use super::undo::EditSnapshot;
use super::{Editor, PlacementRole, Tool};
use crate::scenario::Scenario;

/// What is in the hand.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Drag {
    kind: HandleKind,
    /// The world before it.
    before: Arc<Scenario>,
    selected: Selection,
    /// The same with what an inserting handle made.
    begun: Arc<Scenario>,
    /// From the pointer to the handle, in m.
    offset_m: Vec2,
    /// From the pointer's direction to the angle, in rad, where something is turned.
    offset_rad: f32,
}

impl Editor {
    /// Takes hold of a handle of what is selected, with the pointer at `position_m`; what can't be dragged answers no. By
    /// [`HandleKind::Middle`] everything can be taken that has a place; an inserting handle makes its corner and goes
    /// on with that.
    pub fn begin_drag(&mut self, kind: HandleKind, position_m: Vec2) -> bool {
        self.end_drag();
        self.close_group();
        if !is_finite(position_m) {
            return false;
        }
        let selection = self.selection;
        let kind = match (selection, kind) {
            // A rule of places has no middle: the nearest place is meant.
            (Selection::Starts | Selection::Goals, HandleKind::Middle) => {
                let rule =
                    if selection == Selection::Starts { PlacementRole::Starts } else { PlacementRole::Goals };
                let all = places(rule.of(&self.scenario)).iter().enumerate();
                let nearest =
                    all.min_by(|a, b| distance(*a.1, position_m).total_cmp(&distance(*b.1, position_m)));
                nearest.map_or(kind, |(k, _)| HandleKind::Place(k))
            }
            _ => kind,
        };
        let Some(place) = handles::place(&self.scenario, selection, kind) else { return false };
        let before = Arc::clone(&self.scenario);
        let (mut kind, mut begun) = (kind, Arc::clone(&before));
        if kind.is_insert() {
            let mut with = Scenario::clone(&before);
            let Some(made) = handles::insert(&mut with, selection, kind, place) else { return false };
            (kind, begun) = (made, Arc::new(with));
        }
        let offset_rad = match (kind, handles::rotation_of(&begun, selection)) {
            (HandleKind::Rotate, Some((about, angle))) => angle - direction(about, position_m),
            _ => 0.0,
        };
        let inserted = begun != before;
        let offset_m = minus(place, position_m);
        self.tool = Tool::Select;
        self.drag =
            Some(Drag { kind, before, selected: selection, begun: Arc::clone(&begun), offset_m, offset_rad });
        if inserted {
            self.scenario = begun;
            self.changed();
        }
        true
    }

    /// The pointer is at `position_m` now; `free` is without snapping.
    pub fn drag_to(&mut self, position_m: Vec2, free: bool) {
        let Some(drag) = &self.drag else { return };
        if !is_finite(position_m) {
            return;
        }
        let snap = self.snap.disabled_if(free);
        let mut scenario = Scenario::clone(&drag.begun);
        let done = match (drag.kind, handles::rotation_of(&drag.begun, drag.selected)) {
            (HandleKind::Rotate, Some((about, _))) => {
                let angle = snap.angle(direction(about, position_m) + drag.offset_rad);
                handles::turn(&mut scenario, drag.selected, angle)
            }
            (kind, _) => {
                handles::drag(&mut scenario, drag.selected, kind, plus(position_m, drag.offset_m), snap)
            }
        };
        if done.is_some() && scenario != *self.scenario {
            self.scenario = Arc::new(scenario);
            self.changed();
        }
    }

    /// Lets go: one step for undo, none if nothing has changed.
    pub fn end_drag(&mut self) {
        let Some(drag) = self.drag.take() else { return };
        if self.scenario != drag.before {
            let (scenario, selection) = (drag.before, drag.selected);
            self.undo_stack.push(EditSnapshot { scenario, selection, origin: None });
            self.changed();
        }
    }

    /// Lets go, and everything is as it was before.
    pub fn cancel_drag(&mut self) {
        let Some(drag) = self.drag.take() else { return };
        self.scenario = drag.before;
        self.changed();
    }

    /// What is in the hand: of an inserting handle the corner that it made.
    #[must_use]
    pub fn dragged(&self) -> Option<HandleKind> {
        self.drag.as_ref().map(|drag| drag.kind)
    }

    /// Takes out the corner, waypoint or place that a handle of what is selected is of; says no if it is none of these,
    /// or if too few would be left.
    pub fn remove_handle(&mut self, kind: HandleKind) -> bool {
        let before = self.revision;
        self.step(|scenario, selection| {
            handles::remove(scenario, *selection, kind);
        });
        self.revision != before
    }

    /// Moves what is selected by so many of the snap's steps (1 cm each if it is off, or if it is to be `fine`). Move after
    /// move along the same axis is one step for undo.
    pub fn nudge(&mut self, right: i32, up: i32, fine: bool) {
        let step_m = if self.snap.on && !fine { self.snap.step_m } else { 0.01 };
        let (selection, by) = (self.selection, vec2(right as f32 * step_m, up as f32 * step_m));
        let field = match (right, up) {
            (_, 0) => "nudge along x",
            (0, _) => "nudge along y",
            _ => "nudge",
        };
        self.edit(field, |scenario| {
            handles::shift(scenario, selection, by);
        });
    }
}

fn direction(from: Vec2, to: Vec2) -> f32 {
    let Vec2 { x, y } = minus(to, from);
    y.atan2(x)
}
