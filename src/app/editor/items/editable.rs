//! The trait behind all items that can be selected.

use bevy::math::{Vec2, vec2};

use super::super::handle::{Handle, HandleKind};
use super::super::selection::Selection;
use super::super::snap::Snap;
use crate::scenario::{Generator, Obstacle, Region, Scenario, Wall};

/// The shape of an item in the plane.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// An item without a position.
    Nothing,
    /// An obstacle.
    Obstacle(Obstacle),
    /// An inner wall.
    Wall(Wall),
    /// A closed line through these corners, in m.
    Outline(Vec<Vec2>),
    /// An axis-aligned rectangle.
    Region(Region),
    /// Round marks.
    Marks {
        /// The marks' centres, in m.
        positions_m: Vec<Vec2>,
        /// The marks' radius, in m.
        radius_m: f32,
    },
}

/// An item of one of the scenario's lists, detached from it: on the clipboard or about to be added.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) enum ListItem {
    Obstacle(Obstacle),
    Wall(Wall),
    Generator(Generator),
}

impl ListItem {
    /// Appends the item to its list. Returns its selection.
    pub fn add_to(self, scenario: &mut Scenario) -> Selection {
        match self {
            Self::Obstacle(obstacle) => {
                scenario.obstacles.push(obstacle);
                Selection::Obstacle(scenario.obstacles.len() - 1)
            }
            Self::Wall(wall) => {
                scenario.walls.push(wall);
                Selection::Wall(scenario.walls.len() - 1)
            }
            Self::Generator(generator) => {
                scenario.generators.push(generator);
                Selection::Generator(scenario.generators.len() - 1)
            }
        }
    }
}

/// The target of a drag.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct DragTarget {
    /// Position of the handle without snapping, in m.
    pub position_m: Vec2,
    /// Position of the handle with snapping, in m.
    pub snapped_m: Vec2,
    /// The snapping of sizes and angles.
    pub snap: Snap,
    /// Centre of the scenario, in m.
    pub centre_m: Vec2,
}

/// The operations of the editor on one kind of item. An implementation stores the item's index, not the item. A method
/// that returns `None` leaves the scenario unchanged.
pub(in super::super) trait Editable {
    /// The item's name in the inspector.
    fn title(&self, scenario: &Scenario) -> String;

    /// Whether the scenario has this item.
    fn exists(&self, _scenario: &Scenario) -> bool {
        true
    }

    /// The item's shape in the plane.
    fn body(&self, scenario: &Scenario) -> Body;

    /// Distance from `point_m` to a solid item, in m; negative inside, `None` for an item that is not solid.
    fn solid_distance_m(&self, _scenario: &Scenario, _point_m: Vec2) -> Option<f32> {
        None
    }

    /// The item's handles; later ones are drawn above earlier ones.
    fn handles(&self, scenario: &Scenario) -> Vec<Handle>;

    /// Position of a handle in m, or `None` if the item has no such handle.
    fn handle_position_m(&self, scenario: &Scenario, kind: HandleKind) -> Option<Vec2> {
        let handle = self.handles(scenario).into_iter().find(|handle| handle.kind == kind);
        handle.map(|handle| handle.position_m)
    }

    /// The handle that moves when `kind` is dragged from `position_m`: `kind` itself, except that the middle of a start or
    /// goal rule stands for the nearest of its positions.
    fn dragged_handle(&self, _scenario: &Scenario, kind: HandleKind, _position_m: Vec2) -> HandleKind {
        kind
    }

    /// Drags a handle.
    fn drag(&self, scenario: &mut Scenario, kind: HandleKind, target: DragTarget) -> Option<()>;

    /// Inserts a corner or waypoint at `position_m`, if `kind` is a handle for that. Returns the handle of the new point.
    fn insert(&self, _scenario: &mut Scenario, _kind: HandleKind, _position_m: Vec2) -> Option<HandleKind> {
        None
    }

    /// Removes the corner, waypoint or position of a handle, unless too few would remain.
    fn remove(&self, _scenario: &mut Scenario, _kind: HandleKind) -> Option<()> {
        None
    }

    /// The centre of rotation in m and the current angle in rad, for an item that can be rotated.
    fn rotation(&self, _scenario: &Scenario) -> Option<(Vec2, f32)> {
        None
    }

    /// Sets the angle in rad.
    fn rotate(&self, _scenario: &mut Scenario, _angle_rad: f32) -> Option<()> {
        None
    }

    /// Moves the whole item.
    fn translate(&self, scenario: &mut Scenario, by_m: Vec2) -> Option<()>;

    /// A copy of the item, if it belongs to a list.
    fn copy(&self, _scenario: &Scenario) -> Option<ListItem> {
        None
    }

    /// Makes a copy differ from its original where two equal items would be useless.
    fn vary(&self, _scenario: &mut Scenario) {}

    /// The point that [`move_to`](Self::move_to) moves, in m.
    fn anchor_m(&self, _scenario: &Scenario) -> Option<Vec2> {
        None
    }

    /// The anchor, in m, that puts a copy next to the item. `others` is the scenario without the copy.
    fn copy_anchor_m(&self, scenario: &Scenario, _others: &Scenario, snap: Snap) -> Option<Vec2> {
        let step_m = if snap.on { snap.step_m.max(0.2) } else { 0.2 };
        self.anchor_m(scenario).map(|at| at + vec2(step_m, -step_m))
    }

    /// Moves the whole item so that its anchor is at `position_m`.
    fn move_to(&self, scenario: &mut Scenario, position_m: Vec2) {
        if let Some(from) = self.anchor_m(scenario) {
            self.translate(scenario, position_m - from);
        }
    }

    /// Whether the user can delete the item.
    fn can_delete(&self, scenario: &Scenario) -> bool {
        self.copy(scenario).is_some()
    }

    /// Deletes the item; resets a start or goal rule.
    fn delete(&self, _scenario: &mut Scenario) -> Option<()> {
        None
    }
}

/// Removes element `index`, if there is one.
pub(super) fn remove_at<T>(list: &mut Vec<T>, index: usize) -> Option<()> {
    (index < list.len()).then(|| drop(list.remove(index)))
}

/// A title such as `Obstacle 3 of 4`.
pub(super) fn numbered(noun: &str, index: usize, count: usize) -> String {
    format!("{noun} {} of {count}", index + 1)
}
