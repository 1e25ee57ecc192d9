//! Places: the ends of the benchmark route, and where the rules put starts and goals.
//!
//! In: a rule or the benchmark route, a handle. Out: the same with a place moved or taken out.

use super::corners;
use super::handles::{Handle, HandleKind};
use super::points::{LocalFrame, degrees_text, place_text};
use super::rectangles;
use super::selection::{Selection, region};
use super::snap::Snap;
use crate::scenario::{BenchmarkRoute, PlacementRule};
use bevy::math::{Vec2, vec2};

/// How far from a start the handle is that turns it, in m.
const TURN_M: f32 = 0.3;

/// The handles of a rule of starts or goals.
pub(super) fn of_rule(rule: &PlacementRule) -> Vec<Handle> {
    let mut all = region(rule).map_or_else(Vec::new, rectangles::of_region);
    if let PlacementRule::Fixed { position_m, heading_rad: Some(heading) } = *rule {
        all.push(turn(position_m, heading));
    }
    all.extend(super::selection::places(rule).iter().enumerate().map(|(k, &at)| {
        let about = match rule {
            PlacementRule::OneOf { .. } => "One of the places; double click takes it out",
            _ => "The place",
        };
        Handle::new(HandleKind::Place(k), at, place_text(at), about)
    }));
    all
}

/// Those of an end of the benchmark route.
pub(super) fn of_benchmark_route(benchmark_route: &BenchmarkRoute, end: Selection) -> Vec<Handle> {
    let place = |at, about| Handle::new(HandleKind::Middle, at, place_text(at), about);
    if end == Selection::BenchmarkGoal {
        return vec![place(benchmark_route.goal_m, "Where the benchmark route ends")];
    }
    vec![
        turn(benchmark_route.start_m, benchmark_route.heading_rad),
        place(benchmark_route.start_m, "Where the benchmark route starts"),
    ]
}

fn turn(at: Vec2, heading_rad: f32) -> Handle {
    let tip = LocalFrame::new(at, heading_rad).to_world(vec2(TURN_M, 0.0));
    Handle::new(HandleKind::Rotate, tip, degrees_text(heading_rad), "Where it looks")
}

/// Drags a handle of a rule.
pub(super) fn drag_rule(
    rule: &mut PlacementRule,
    kind: HandleKind,
    to: Vec2,
    snap: Snap,
    centre: Vec2,
) -> Option<()> {
    match (kind, rule) {
        (HandleKind::Place(_), PlacementRule::Fixed { position_m, .. }) => {
            *position_m = snap.point(to, centre)
        }
        (HandleKind::Place(k), PlacementRule::OneOf { positions_m }) => {
            *positions_m.get_mut(k)? = snap.point(to, centre);
        }
        (_, PlacementRule::Within { min_m, max_m, .. }) => {
            return rectangles::drag_region((min_m, max_m), kind, to, snap, centre);
        }
        _ => return None,
    }
    Some(())
}

/// Drags an end of the benchmark route by its middle.
pub(super) fn drag_benchmark_route(
    benchmark_route: &mut BenchmarkRoute,
    end: Selection,
    kind: HandleKind,
    snapped: Vec2,
) -> Option<()> {
    if kind != HandleKind::Middle {
        return None;
    }
    match end {
        Selection::BenchmarkStart => benchmark_route.start_m = snapped,
        _ => benchmark_route.goal_m = snapped,
    }
    Some(())
}

/// Takes a place out; one stays.
pub(super) fn remove(rule: &mut PlacementRule, k: usize) -> Option<()> {
    match rule {
        PlacementRule::OneOf { positions_m } => corners::remove(positions_m, k, 1),
        _ => None,
    }
}

/// All points of a rule.
pub(super) fn points(rule: &mut PlacementRule) -> Vec<&mut Vec2> {
    match rule {
        PlacementRule::Random { .. } => Vec::new(),
        PlacementRule::Within { min_m, max_m, .. } => vec![min_m, max_m],
        PlacementRule::Fixed { position_m, .. } => vec![position_m],
        PlacementRule::OneOf { positions_m } => positions_m.iter_mut().collect(),
    }
}
