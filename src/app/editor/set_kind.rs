//! Changes of the kind of a motion, a start or goal rule, or the enclosure, with numbers that fit the scenario. Values that
//! both kinds have are kept.

use bevy::math::{Vec2, vec2};

use super::document::Editor;
use super::free_space;
use super::items::rule_points::positions;
use super::kinds::{EnclosureKind, MotionKind, PlacementKind, PlacementRole};
use super::limits::{NEW_CLEARANCE_M, NEW_SPEED_M_S};
use super::new_motion;
use super::points::{centre_of, point_to_mm, to_mm};
use super::selection::Selection;
use super::snap::Snap;
use crate::scenario::{Enclosure, ObstacleMotion, PlacementRule, Scenario, clearance, enclosure_distance};

impl Editor {
    /// Changes the motion of the selected obstacle to another kind.
    pub fn set_motion(&mut self, kind: MotionKind) {
        let snap = self.snap;
        self.step(|scenario, selection| {
            let Selection::Obstacle(k) = *selection else { return };
            let Some(motion) = converted_motion(scenario, k, kind, snap) else { return };
            if let Some(obstacle) = scenario.obstacles.get_mut(k) {
                obstacle.motion = motion;
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

/// A motion of this kind for obstacle `index`; `None` if it has this kind already.
fn converted_motion(
    scenario: &Scenario,
    index: usize,
    kind: MotionKind,
    snap: Snap,
) -> Option<ObstacleMotion> {
    let obstacle = scenario.obstacles.get(index)?;
    if MotionKind::from_motion(&obstacle.motion) == kind {
        return None;
    }
    let path = |closed| match &obstacle.motion {
        ObstacleMotion::Patrol { waypoints_m, speed_m_s }
        | ObstacleMotion::BackAndForth { waypoints_m, speed_m_s } => (waypoints_m.clone(), *speed_m_s),
        _ => (new_motion::path(scenario, index, closed), NEW_SPEED_M_S),
    };
    Some(match kind {
        MotionKind::Static => ObstacleMotion::Static,
        MotionKind::Orbit => new_motion::orbit(scenario, obstacle),
        MotionKind::Patrol => {
            let (waypoints_m, speed_m_s) = path(true);
            ObstacleMotion::Patrol { waypoints_m, speed_m_s }
        }
        MotionKind::BackAndForth => {
            let (waypoints_m, speed_m_s) = path(false);
            ObstacleMotion::BackAndForth { waypoints_m, speed_m_s }
        }
        MotionKind::RandomWalk => {
            let free_m = enclosure_distance(&scenario.enclosure, obstacle.position_m);
            let radius_m = (free_m - obstacle.shape.bounding_radius_m()).min(0.5);
            // The index is the seed, so that no two obstacles have the same walk.
            let seed = u32::try_from(index).unwrap_or_default();
            let radius_m = snap.disabled_if(true).size(radius_m);
            ObstacleMotion::RandomWalk { radius_m, speed_m_s: NEW_SPEED_M_S, seed }
        }
    })
}

/// A rule of another kind with the clearance and the first position of the old rule.
fn converted_rule(
    scenario: &Scenario,
    role: PlacementRole,
    kind: PlacementKind,
    snap: Snap,
) -> PlacementRule {
    let old = role.of(scenario);
    let clearance_m = match old {
        PlacementRule::Random { clearance_m } | PlacementRule::Within { clearance_m, .. } => *clearance_m,
        PlacementRule::Fixed { .. } | PlacementRule::OneOf { .. } => NEW_CLEARANCE_M,
    };
    let place = || {
        let first = positions(old).first().copied();
        first.unwrap_or_else(|| free_place(scenario, role, clearance_m, snap))
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
        PlacementKind::Fixed => PlacementRule::Fixed { position_m: place(), heading_rad: None },
        PlacementKind::OneOf => PlacementRule::OneOf { positions_m: vec![place()] },
    }
}

/// The start or goal of the benchmark route if it is free, else a free position near the centre.
fn free_place(scenario: &Scenario, role: PlacementRole, clearance_m: f32, snap: Snap) -> Vec2 {
    let end = match role {
        PlacementRole::Starts => scenario.benchmark_route.start_m,
        PlacementRole::Goals => scenario.benchmark_route.goal_m,
    };
    if clearance(scenario, end, 0) >= scenario.task.collision_range_m {
        return end;
    }
    free_space::nearest(scenario, centre_of(scenario), clearance_m, snap)
}
