//! The rule that places starts or goals: anywhere, in a region, or at given positions.

use bevy::math::{Vec2, vec2};

use super::super::handle::{Handle, HandleKind};
use super::super::kinds::PlacementRole;
use super::super::points::{LocalFrame, degrees_text, distance, place_text};
use super::editable::{Body, DragTarget, Editable};
use super::{corners, rectangles};
use crate::scenario::{PlacementRule, Scenario};

/// Distance of the heading handle from its start, in m.
const HEADING_HANDLE_M: f32 = 0.3;

pub(super) struct RuleItem(pub PlacementRole);

impl RuleItem {
    fn mark_radius_m(&self, scenario: &Scenario) -> f32 {
        match self.0 {
            PlacementRole::Starts => scenario.robot.reach_m(),
            PlacementRole::Goals => scenario.task.goal_radius_m,
        }
    }
}

impl Editable for RuleItem {
    fn title(&self, _scenario: &Scenario) -> String {
        self.0.title().into()
    }

    fn body(&self, scenario: &Scenario) -> Body {
        let rule = self.0.of(scenario);
        match (rule.region(), rule.positions_m()) {
            (Some(region), _) => Body::Region(region),
            (None, []) => Body::Nothing,
            (None, places) => {
                Body::Marks { positions_m: places.to_vec(), radius_m: self.mark_radius_m(scenario) }
            }
        }
    }

    fn handles(&self, scenario: &Scenario) -> Vec<Handle> {
        let rule = self.0.of(scenario);
        let mut handles = rule.region().map_or_else(Vec::new, rectangles::region_handles);
        if let Some((position_m, heading_rad)) = self.rotation(scenario) {
            handles.push(heading_handle(position_m, heading_rad));
        }
        let about = match rule {
            PlacementRule::OneOf { .. } => "Move this position; double-click removes it",
            _ => "Move this position",
        };
        let place =
            |(k, &at): (usize, &Vec2)| Handle::new(HandleKind::Position(k), at, place_text(at), about);
        handles.extend(rule.positions_m().iter().enumerate().map(place));
        handles
    }

    /// Listed positions have no common middle; the nearest one is dragged.
    fn dragged_handle(&self, scenario: &Scenario, kind: HandleKind, position_m: Vec2) -> HandleKind {
        if kind != HandleKind::Middle {
            return kind;
        }
        let away = |place: &Vec2| distance(*place, position_m);
        let places = self.0.of(scenario).positions_m().iter().enumerate();
        let nearest = places.min_by(|a, b| away(a.1).total_cmp(&away(b.1)));
        nearest.map_or(kind, |(k, _)| HandleKind::Position(k))
    }

    fn drag(&self, scenario: &mut Scenario, kind: HandleKind, target: DragTarget) -> Option<()> {
        match (kind, self.0.of_mut(scenario)) {
            (HandleKind::Position(_), PlacementRule::Fixed { position_m, .. }) => {
                *position_m = target.snapped_m;
            }
            (HandleKind::Position(k), PlacementRule::OneOf { positions_m }) => {
                *positions_m.get_mut(k)? = target.snapped_m;
            }
            (_, PlacementRule::Within { min_m, max_m, .. }) => {
                return rectangles::drag_region((min_m, max_m), kind, target);
            }
            _ => return None,
        }
        Some(())
    }

    fn remove(&self, scenario: &mut Scenario, kind: HandleKind) -> Option<()> {
        match (kind, self.0.of_mut(scenario)) {
            (HandleKind::Position(k), PlacementRule::OneOf { positions_m }) => {
                corners::remove(positions_m, k, 1)
            }
            _ => None,
        }
    }

    /// The heading of a fixed start. A goal has no heading.
    fn rotation(&self, scenario: &Scenario) -> Option<(Vec2, f32)> {
        match (self.0, self.0.of(scenario)) {
            (PlacementRole::Starts, PlacementRule::Fixed { position_m, heading_rad: Some(heading) }) => {
                Some((*position_m, *heading))
            }
            _ => None,
        }
    }

    fn rotate(&self, scenario: &mut Scenario, angle_rad: f32) -> Option<()> {
        match (self.0, self.0.of_mut(scenario)) {
            (PlacementRole::Starts, PlacementRule::Fixed { heading_rad, .. }) => {
                *heading_rad = Some(angle_rad);
                Some(())
            }
            _ => None,
        }
    }

    fn translate(&self, scenario: &mut Scenario, by_m: Vec2) -> Option<()> {
        corners::translate(self.0.of_mut(scenario).points_mut(), by_m);
        Some(())
    }

    fn can_delete(&self, scenario: &Scenario) -> bool {
        !matches!(self.0.of(scenario), PlacementRule::Random { .. })
    }

    fn delete(&self, scenario: &mut Scenario) -> Option<()> {
        *self.0.of_mut(scenario) = PlacementRule::default();
        Some(())
    }
}

/// The handle that changes a start's heading.
pub(super) fn heading_handle(start_m: Vec2, heading_rad: f32) -> Handle {
    let tip = LocalFrame::new(start_m, heading_rad).to_world(vec2(HEADING_HANDLE_M, 0.0));
    Handle::new(HandleKind::Rotate, tip, degrees_text(heading_rad), "Turn the heading")
}
