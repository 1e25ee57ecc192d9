//! Clipboard operations of the editor: copy, cut, paste, duplicate and delete.

use std::sync::Arc;

use bevy::math::Vec2;

use super::document::Editor;
use super::items::{self, ListItem};
use super::selection::Selection;

impl Editor {
    fn selected_copy(&self) -> Option<ListItem> {
        items::selected(self.selection()).and_then(|item| item.copy(self.scenario()))
    }

    /// Whether the selected item can be copied.
    #[must_use]
    pub fn can_copy(&self) -> bool {
        self.selected_copy().is_some()
    }

    /// Adds a copy next to the selected item, and selects it.
    pub fn duplicate(&mut self) {
        if let Some(item) = self.selected_copy() {
            self.add_copy(item, None);
        }
    }

    /// Copies the selected item to the clipboard.
    pub fn copy(&mut self) {
        self.clipboard = self.selected_copy().or_else(|| self.clipboard.take());
    }

    /// Copies the selected item to the clipboard, and deletes it.
    pub fn cut(&mut self) {
        if self.can_copy() {
            self.copy();
            self.delete();
        }
    }

    /// Whether the clipboard holds an item.
    #[must_use]
    pub fn can_paste(&self) -> bool {
        self.clipboard.is_some()
    }

    /// Adds the clipboard's item at `position_m`, or next to the place it was copied from or last pasted to.
    pub fn paste(&mut self, position_m: Option<Vec2>) {
        if let Some(item) = self.clipboard.clone() {
            let to = position_m.map(|at| self.snapped(at, false));
            self.add_copy(item, to);
            self.clipboard = self.selected_copy();
        }
    }

    /// Adds a copy of `item` with its anchor at `to_m`, or next to the position that `item` has.
    fn add_copy(&mut self, item: ListItem, to_m: Option<Vec2>) {
        let (others, snap) = (Arc::clone(self.scenario()), self.snap);
        self.step(|scenario, selection| {
            *selection = item.add_to(scenario);
            let Some(copy) = items::selected(*selection) else { return };
            copy.vary(scenario);
            if let Some(to) = to_m.or_else(|| copy.copy_anchor_m(scenario, &others, snap)) {
                copy.move_to(scenario, to);
            }
        });
    }

    /// Whether the selected item can be deleted.
    #[must_use]
    pub fn can_delete(&self) -> bool {
        items::selected(self.selection()).is_some_and(|item| item.can_delete(self.scenario()))
    }

    /// Deletes the selected item. A start or goal rule is reset instead, so that starts or goals may be anywhere.
    pub fn delete(&mut self) {
        self.step(|scenario, selection| {
            let deleted = items::selected(*selection).and_then(|item| item.delete(scenario));
            if deleted.is_some() {
                *selection = Selection::Nothing;
            }
        });
    }
}
