//! The positions and the region of a start or goal rule.

use bevy::math::Vec2;

use crate::scenario::{PlacementRule, Region};

/// The given positions of a rule, in m.
pub(in super::super) fn positions(rule: &PlacementRule) -> &[Vec2] {
    match rule {
        PlacementRule::Fixed { position_m, .. } => std::slice::from_ref(position_m),
        PlacementRule::OneOf { positions_m } => positions_m,
        PlacementRule::Random { .. } | PlacementRule::Within { .. } => &[],
    }
}

/// The region of a rule.
pub(in super::super) fn region(rule: &PlacementRule) -> Option<Region> {
    match *rule {
        PlacementRule::Within { min_m, max_m, .. } => Some(Region { min_m, max_m }),
        _ => None,
    }
}

/// All points of a rule: its positions, or the corners of its region.
pub(super) fn points_mut(rule: &mut PlacementRule) -> Vec<&mut Vec2> {
    match rule {
        PlacementRule::Random { .. } => Vec::new(),
        PlacementRule::Within { min_m, max_m, .. } => vec![min_m, max_m],
        PlacementRule::Fixed { position_m, .. } => vec![position_m],
        PlacementRule::OneOf { positions_m } => positions_m.iter_mut().collect(),
    }
}
