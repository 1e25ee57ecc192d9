//! The tool: the effect of a click on the canvas.

use bevy::math::Vec2;

/// What a click on the canvas does.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Tool {
    /// Selects items.
    #[default]
    Select,
    /// Draws a wall; a click sets its next corner.
    Wall {
        /// The corners so far, in m.
        corners_m: Vec<Vec2>,
    },
    /// Draws the path of the selected obstacle; a click sets its next waypoint.
    Path {
        /// The waypoints so far, in m.
        waypoints_m: Vec<Vec2>,
    },
    /// A click adds a position to the selected start or goal rule.
    Positions,
}

impl Tool {
    /// The points of an unfinished wall or path, in m; empty for the other tools.
    #[must_use]
    pub fn points_m(&self) -> &[Vec2] {
        match self {
            Self::Wall { corners_m: points } | Self::Path { waypoints_m: points } => points,
            Self::Select | Self::Positions => &[],
        }
    }

    pub(super) fn points_mut(&mut self) -> Option<&mut Vec<Vec2>> {
        match self {
            Self::Wall { corners_m: points } | Self::Path { waypoints_m: points } => Some(points),
            Self::Select | Self::Positions => None,
        }
    }
}
