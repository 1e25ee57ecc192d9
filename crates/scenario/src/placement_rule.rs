//! The parts of a placement rule.

use super::schema::{PlacementRule, Region};
use glam::Vec2;

impl PlacementRule {
    /// The positions that the rule lists, in m; empty for `Random` and `Within`.
    #[must_use]
    pub fn positions_m(&self) -> &[Vec2] {
        match self {
            Self::Fixed { position_m, .. } => std::slice::from_ref(position_m),
            Self::OneOf { positions_m } => positions_m,
            Self::Random { .. } | Self::Within { .. } => &[],
        }
    }

    /// The clearance of a `Random` or `Within` rule, in m.
    #[must_use]
    pub fn clearance_m(&self) -> Option<f32> {
        match *self {
            Self::Random { clearance_m } | Self::Within { clearance_m, .. } => Some(clearance_m),
            Self::Fixed { .. } | Self::OneOf { .. } => None,
        }
    }

    /// The rectangle of a `Within` rule.
    #[must_use]
    pub fn region(&self) -> Option<Region> {
        match *self {
            Self::Within { min_m, max_m, .. } => Some(Region { min_m, max_m }),
            _ => None,
        }
    }

    /// All points of the rule, in m: its positions, or the two corners that define its rectangle.
    #[must_use]
    pub fn points_mut(&mut self) -> Vec<&mut Vec2> {
        match self {
            Self::Random { .. } => Vec::new(),
            Self::Within { min_m, max_m, .. } => vec![min_m, max_m],
            Self::Fixed { position_m, .. } => vec![position_m],
            Self::OneOf { positions_m } => positions_m.iter_mut().collect(),
        }
    }
}
