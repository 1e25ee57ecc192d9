//! One drag of a handle.
//!
//! Each position of the pointer is applied to the scenario as it was at the beginning of the drag, so that rounding and
//! snapping do not add up.

use std::sync::Arc;

use bevy::math::Vec2;

use super::handle::HandleKind;
use super::items::{self, DragTarget};
use super::points::{centre_of, point_to_mm};
use super::selection::Selection;
use super::snap::Snap;
use crate::scenario::Scenario;

/// A drag in progress.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Drag {
    /// The dragged handle; for an insert handle, the handle of the inserted point.
    pub kind: HandleKind,
    /// The scenario before the drag.
    pub before: Arc<Scenario>,
    /// The item that is dragged.
    pub selection: Selection,
    /// `before`, with the point that an insert handle inserted.
    pub begun: Arc<Scenario>,
    /// Offset from the pointer to the handle, in m.
    offset_m: Vec2,
    /// Offset from the pointer's direction to the angle, in rad, for a rotation.
    offset_rad: f32,
}

impl Drag {
    /// Begins to drag a handle of the selected item with the pointer at `pointer_m`. Returns `None` if the item has no
    /// such handle. Every solid item can be dragged by [`HandleKind::Middle`].
    pub fn begin(
        scenario: &Arc<Scenario>,
        selection: Selection,
        kind: HandleKind,
        pointer_m: Vec2,
    ) -> Option<Self> {
        let item = items::selected(selection)?;
        let mut kind = item.dragged_handle(scenario, kind, pointer_m);
        let handle_m = item.handle_position_m(scenario, kind)?;
        let mut begun = Arc::clone(scenario);
        if kind.is_insert() {
            let mut inserted = Scenario::clone(scenario);
            kind = item.insert(&mut inserted, kind, point_to_mm(handle_m))?;
            begun = Arc::new(inserted);
        }
        let offset_rad = match (kind, item.rotation(&begun)) {
            (HandleKind::Rotate, Some((centre, angle))) => angle - direction(centre, pointer_m),
            _ => 0.0,
        };
        let (before, offset_m) = (Arc::clone(scenario), handle_m - pointer_m);
        Some(Self { kind, before, selection, begun, offset_m, offset_rad })
    }

    /// The scenario with the pointer at `pointer_m`.
    pub fn scenario_at(&self, pointer_m: Vec2, snap: Snap) -> Option<Scenario> {
        let item = items::selected(self.selection)?;
        let mut scenario = Scenario::clone(&self.begun);
        match (self.kind, item.rotation(&self.begun)) {
            (HandleKind::Rotate, Some((centre, _))) => {
                let angle_rad = snap.angle(direction(centre, pointer_m) + self.offset_rad);
                item.rotate(&mut scenario, angle_rad)?;
            }
            (kind, _) => {
                let (position_m, centre_m) = (pointer_m + self.offset_m, centre_of(&scenario));
                let snapped_m = snap.point(position_m, centre_m);
                let target = DragTarget { position_m, snapped_m, snap, centre_m };
                item.drag(&mut scenario, kind, target)?;
            }
        }
        Some(scenario)
    }
}

/// The direction from one point to another, in rad.
fn direction(from: Vec2, to: Vec2) -> f32 {
    let Vec2 { x, y } = to - from;
    y.atan2(x)
}
