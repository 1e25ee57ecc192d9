//! The kinds of start and goal rules and of enclosures, without their values.

use super::selection::Selection;
use crate::scenario::{Enclosure, PlacementRule, Scenario};

/// The objects that a placement rule places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlacementRole {
    /// Starts of the robot.
    Starts,
    /// Goals.
    Goals,
}

impl PlacementRole {
    /// The name of the rule on the screen.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Starts => "Starts",
            Self::Goals => "Goals",
        }
    }

    /// The scenario's rule for this role.
    #[must_use]
    pub fn of(self, scenario: &Scenario) -> &PlacementRule {
        match self {
            Self::Starts => &scenario.starts,
            Self::Goals => &scenario.goals,
        }
    }

    /// The scenario's rule for this role, mutable.
    pub fn of_mut(self, scenario: &mut Scenario) -> &mut PlacementRule {
        match self {
            Self::Starts => &mut scenario.starts,
            Self::Goals => &mut scenario.goals,
        }
    }

    /// The selection of this rule.
    #[must_use]
    pub fn selection(self) -> Selection {
        match self {
            Self::Starts => Selection::Starts,
            Self::Goals => Selection::Goals,
        }
    }

    /// The role of the selected rule, or `None` if another item is selected.
    #[must_use]
    pub fn from_selection(selection: Selection) -> Option<Self> {
        [Self::Starts, Self::Goals].into_iter().find(|role| role.selection() == selection)
    }
}

/// Kind of a placement rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlacementKind {
    /// Anywhere in the scenario.
    Random,
    /// Anywhere in a rectangle.
    Within,
    /// One position.
    Fixed,
    /// One of several positions.
    OneOf,
}

impl PlacementKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Random, Self::Within, Self::Fixed, Self::OneOf];

    /// The kind of `rule`.
    #[must_use]
    pub fn from_rule(rule: &PlacementRule) -> Self {
        match rule {
            PlacementRule::Random { .. } => Self::Random,
            PlacementRule::Within { .. } => Self::Within,
            PlacementRule::Fixed { .. } => Self::Fixed,
            PlacementRule::OneOf { .. } => Self::OneOf,
        }
    }
}

/// Kind of the enclosure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnclosureKind {
    /// A rectangle centred at (0, 0).
    Rectangle,
    /// Any polygon.
    Polygon,
}

impl EnclosureKind {
    /// The kind of `enclosure`.
    #[must_use]
    pub fn from_enclosure(enclosure: &Enclosure) -> Self {
        match enclosure {
            Enclosure::Rectangle { .. } => Self::Rectangle,
            Enclosure::Polygon { .. } => Self::Polygon,
        }
    }
}
