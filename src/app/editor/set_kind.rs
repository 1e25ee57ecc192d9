//! Changing the kind of a motion, a start or goal rule, or the enclosure, with new values that fit the scenario. A motion keeps
//! its path and speed, and a rule its clearance and first position, if the new kind has them, too.

use bevy::math::{Vec2, vec2};

use super::document::Editor;
use super::free_space;
use super::kinds::{EnclosureKind, PlacementKind, PlacementRole};
use super::limits::new_clearance_m;
use super::new_motion;
use super::points::{centre_of, point_to_mm, to_mm};
use super::selection::Selection;
use super::snap::Snap;
use crate::scenario::{Enclosure, MotionKind, PlacementRule, Scenario, clearance};

impl Editor {
    /// Changes the motion of the selected obstacle to another kind.
    pub fn set_motion(&mut self, kind: MotionKind) {
        self.step(|scenario, selection| {
            let Selection::Obstacle(k) = *selection else { return };
            if scenario.obstacles.get(k).is_some_and(|obstacle| obstacle.motion.kind() != kind) {
                scenario.obstacles[k].motion = new_motion::of_kind(scenario, k, kind);
            }
        });
    }

    /// Changes the rule for starts or goals to another kind, and selects it.
    pub fn set_rule(&mut self, role: PlacementRole, kind: PlacementKind) {
        let snap = self.snap;
        self.step(|scenario, selection| {
            *selection = role.selection();
            if PlacementKind::from_rule(role.of(scenario)) != kind {
                *role.of_mut(scenario) = converted_rule(scenario, role, kind, snap);
            }
        });
    }

    /// Changes the enclosure to a polygon with the same four corners, or to the smallest rectangle centred at (0, 0)
    /// that contains it.
    pub fn set_enclosure(&mut self, kind: EnclosureKind) {
        self.step(|scenario, selection| {
            *selection = Selection::Enclosure;
            let enclosure = match (kind, &scenario.enclosure) {
                (EnclosureKind::Polygon, Enclosure::Rectangle { .. }) => Enclosure::Polygon {
                    corners_m: scenario.enclosure.corners_m().into_iter().map(point_to_mm).collect(),
                },
                (EnclosureKind::Rectangle, Enclosure::Polygon { .. }) => {
                    let (low, high) = scenario.enclosure.bounds_m();
                    let extent = |a: f32, b: f32| to_mm(2.0 * a.abs().max(b.abs()));
                    Enclosure::Rectangle { width_m: extent(low.x, high.x), height_m: extent(low.y, high.y) }
                }
                _ => return,
            };
            scenario.enclosure = enclosure;
        });
    }
}

/// A rule of another kind with the clearance and the first position of the old rule.
fn converted_rule(
    scenario: &Scenario,
    role: PlacementRole,
    kind: PlacementKind,
    snap: Snap,
) -> PlacementRule {
    let old = role.of(scenario);
    let clearance_m = old.clearance_m().unwrap_or_else(|| new_clearance_m(scenario));
    let position = || {
        let first = old.positions_m().first().copied();
        first.unwrap_or_else(|| free_position(scenario, role, clearance_m, snap))
    };
    match kind {
        PlacementKind::Random => PlacementRule::Random { clearance_m },
        PlacementKind::Within => {
            let (low, high) = scenario.enclosure.bounds_m();
            let quarter = |a: f32, b: f32| to_mm(a + (b - a) / 4.0);
            let min_m = vec2(quarter(low.x, high.x), quarter(low.y, high.y));
            let max_m = vec2(quarter(high.x, low.x), quarter(high.y, low.y));
            PlacementRule::Within { min_m, max_m, clearance_m }
        }
        PlacementKind::Fixed => PlacementRule::Fixed { position_m: position(), heading_rad: None },
        PlacementKind::OneOf => PlacementRule::OneOf { positions_m: vec![position()] },
    }
}

/// The start or goal of the benchmark route if it is free, else a free position near the centre.
fn free_position(scenario: &Scenario, role: PlacementRole, clearance_m: f32, snap: Snap) -> Vec2 {
    let end = scenario.benchmark_route.map(|route| match role {
        PlacementRole::Starts => route.start_m,
        PlacementRole::Goals => route.goal_m,
    });
    if let Some(end) = end.filter(|&end| clearance(scenario, end, 0) >= scenario.keep_out_m()) {
        return end;
    }
    free_space::nearest(scenario, centre_of(scenario), clearance_m, snap)
}
