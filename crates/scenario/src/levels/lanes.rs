//! Lanes: obstacles one after the other on a loop of two straight lanes, one in each direction.

use glam::{Vec2, vec2};
use wayfield_random::{Stream, uniform, uniform_01};

use super::draft::Draft;
use super::traffic::Walker;
use crate::geometry::length;
use crate::schema::ObstacleMotion;

/// Attempts to find free lanes before a pair is omitted.
const TRIES: usize = 50;
/// Smallest distance along a loop between consecutive obstacles, centre to centre, in radii.
const MIN_SPACING_RADII: f32 = 4.0;

/// Adds a pair of lanes across the whole field, along x or y, with up to `count` obstacles; nothing if no free lanes are found.
pub(super) fn add(draft: &mut Draft, walker: Walker, count: u32, stream: &mut Stream) {
    let mut loops = (0..TRIES).map(|_| random_loop(draft, walker.radius_m, stream));
    let is_free = |corners: &[Vec2; 4]| {
        (0..4).all(|k| draft.is_free(corners[k], corners[(k + 1) % 4], walker.radius_m))
            && draft.lanes_m.iter().all(|other| !overlap(corners, other))
    };
    let Some(corners) = loops.find(is_free) else { return };
    let sides: [f32; 4] = std::array::from_fn(|k| distance(corners[k], corners[(k + 1) % 4]));
    let perimeter: f32 = sides.iter().sum();
    let count = count.min((perimeter / (MIN_SPACING_RADII * walker.radius_m)) as u32);
    let first = uniform_01(stream);
    for k in 0..count {
        let mut along = perimeter * (k as f32 + first) / count as f32;
        let mut side = 0;
        while side < 3 && along > sides[side] {
            along -= sides[side];
            side += 1;
        }
        let (from, to) = (corners[side], corners[(side + 1) % 4]);
        let position_m = from + (to - from) * (along / sides[side]).min(1.0);
        let waypoints_m = (1..=4).map(|next| corners[(side + next) % 4]).collect();
        draft.add_moving(
            walker.at(position_m, ObstacleMotion::Patrol { waypoints_m, speed_m_s: walker.speed_m_s.into() }),
        );
    }
    draft.lanes_m.push(corners);
}

/// The corners of a random pair of lanes in the order of travel. The lanes are just far enough apart for obstacles to pass each
/// other with the gap between them.
fn random_loop(draft: &Draft, radius_m: f32, stream: &mut Stream) -> [Vec2; 4] {
    let upright = uniform_01(stream) < 0.5;
    let swap = |point: Vec2| if upright { vec2(point.y, point.x) } else { point };
    let (low, high) = (swap(draft.field.min_m) + radius_m, swap(draft.field.max_m) - radius_m);
    let apart = 2.0 * radius_m + draft.gap_m;
    let lower = uniform(stream, low.y, (high.y - apart).max(low.y));
    let upper = lower + apart;
    let mut corners =
        [vec2(low.x, lower), vec2(high.x, lower), vec2(high.x, upper), vec2(low.x, upper)].map(swap);
    if uniform_01(stream) < 0.5 {
        corners.reverse();
    }
    corners
}

/// Whether two pairs of lanes along the same axis overlap, so that their obstacles would overlap again and again.
fn overlap(one: &[Vec2; 4], other: &[Vec2; 4]) -> bool {
    let is_upright = |corners: &[Vec2; 4]| {
        let (low, high) = bounds(corners);
        high.y - low.y > high.x - low.x
    };
    let ((low, high), (other_low, other_high)) = (bounds(one), bounds(other));
    is_upright(one) == is_upright(other) && low.cmple(other_high).all() && other_low.cmple(high).all()
}

fn bounds(corners: &[Vec2; 4]) -> (Vec2, Vec2) {
    corners.iter().fold((corners[0], corners[0]), |(low, high), &corner| (low.min(corner), high.max(corner)))
}

fn distance(from: Vec2, to: Vec2) -> f32 {
    length(to.x - from.x, to.y - from.y)
}
