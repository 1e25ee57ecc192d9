//! Free space for new items.

use std::f32::consts::TAU;

use bevy::math::{Vec2, vec2};

use super::points::{centre_of, distance};
use super::snap::Snap;
use crate::scenario::{PlacementRule, Scenario, clearance};

/// Space between a new item and starts or goals beyond [`Scenario::keep_out_m`], in m.
const MARGIN_M: f32 = 0.02;
/// Number of rings that are searched around the wanted position.
const RINGS: u8 = 24;

/// A free position near `wanted_m` for an item with this bounding radius, snapped to the grid. Free means clear of walls
/// and obstacles, of the ends of the benchmark route, and of the positions of the start and goal rules. Returns
/// `wanted_m`, snapped, if no position searched is free.
pub(super) fn nearest(scenario: &Scenario, wanted_m: Vec2, radius_m: f32, snap: Snap) -> Vec2 {
    let centre = centre_of(scenario);
    let ends = scenario.benchmark_route.iter().flat_map(|route| [route.start_m, route.goal_m]);
    let listed = [&scenario.starts, &scenario.goals].into_iter().flat_map(PlacementRule::positions_m);
    let reserved: Vec<Vec2> = ends.chain(listed.copied()).collect();
    let apart_m = radius_m + scenario.keep_out_m() + MARGIN_M;
    let is_free = |at: &Vec2| {
        clearance(scenario, *at, 0) >= radius_m
            && reserved.iter().all(|&place| distance(place, *at) >= apart_m)
    };
    ring_offsets(radius_m.max(0.1))
        .map(|offset| snap.point(wanted_m + offset, centre))
        .find(is_free)
        .unwrap_or_else(|| snap.point(wanted_m, centre))
}

/// Zero, then six offsets on a ring of radius `ring_m`, twelve on the next ring, and so on.
fn ring_offsets(ring_m: f32) -> impl Iterator<Item = Vec2> {
    let count = |ring: u8| ring.saturating_mul(6).max(1);
    let steps = (0..RINGS).flat_map(move |ring| (0..count(ring)).map(move |k| (ring, k)));
    steps.map(move |(ring, k)| {
        let angle = f32::from(k) / f32::from(count(ring)) * TAU;
        let away = f32::from(ring) * ring_m;
        vec2(away * angle.cos(), away * angle.sin())
    })
}
