//! Handles: the points of a selected item that can be dragged.

use bevy::math::Vec2;

/// The part of an item that a handle changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandleKind {
    /// The whole item, with its path or the centre of its orbit.
    Middle,
    /// A side or a corner of a rectangle in its local frame: (1, 0) is the right side, (-1, 1) the upper left corner.
    /// The opposite side stays; for the enclosure, the centre stays.
    Side(i8, i8),
    /// A radius.
    Radius,
    /// An end of a capsule in its local frame: the right end (1) or the left end (-1). The other end stays.
    End(i8),
    /// A corner of a polygon or a wall.
    Corner(usize),
    /// A new corner before corner k.
    InsertCorner(usize),
    /// The rotation of an obstacle or the heading of a start.
    Rotate,
    /// The obstacle alone, at the beginning of its path; its waypoints stay.
    PathStart,
    /// A waypoint of an obstacle's path.
    Waypoint(usize),
    /// A new waypoint before waypoint k.
    InsertWaypoint(usize),
    /// The centre of an orbit.
    Centre,
    /// The largest distance of a random walk from the obstacle's position.
    Reach,
    /// One of the positions of a start or goal rule.
    Position(usize),
}

impl HandleKind {
    /// Whether dragging the handle inserts a point.
    #[must_use]
    pub fn is_insert(self) -> bool {
        matches!(self, Self::InsertCorner(_) | Self::InsertWaypoint(_))
    }
}

/// A point that can be dragged.
#[derive(Clone, Debug, PartialEq)]
pub struct Handle {
    /// The part that the handle changes.
    pub kind: HandleKind,
    /// The handle's position in m.
    pub position_m: Vec2,
    /// The value that the handle changes, formatted with its unit.
    pub text: String,
    /// A short description for the hint line.
    pub about: &'static str,
}

impl Handle {
    pub(super) fn new(kind: HandleKind, position_m: Vec2, text: String, about: &'static str) -> Self {
        Self { kind, position_m, text, about }
    }
}
