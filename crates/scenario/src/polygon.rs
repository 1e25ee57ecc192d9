//! Polygons: sides, signed distance, area, orientation and growth.
//!
//! In: corners in order, clockwise or counterclockwise. Out: sides, distances in m, areas in m^2. Plain f32 arithmetic with
//! the same result on every platform.

use super::geometry::length;
use glam::{Vec2, vec2};

/// The maximum distance that a corner moves when a polygon grows, as a multiple of the growth.
const MITRE: f32 = 3.0;

/// Distance from `point` to the nearest side, in m; negative outside. The polygon may be concave, but its sides must not
/// cross.
pub(super) fn signed_distance(corners: &[Vec2], point: Vec2) -> f32 {
    let (mut nearest, mut inside) = (f32::INFINITY, false);
    for (from, to) in sides(corners) {
        nearest = nearest.min(distance_to_segment(from, to, point));
        // The point is inside if its ray towards +x crosses an odd number of sides.
        if (from.y > point.y) != (to.y > point.y) {
            let x = from.x + (point.y - from.y) / (to.y - from.y) * (to.x - from.x);
            inside ^= point.x < x;
        }
    }
    if inside { nearest } else { -nearest }
}

/// The sides as pairs of ends; the last side ends at the first corner.
pub fn sides<T: Copy>(corners: &[T]) -> impl Iterator<Item = (T, T)> {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// Distance from `point` to the segment between two points, in m.
#[must_use]
pub fn distance_to_segment(from: Vec2, to: Vec2, point: Vec2) -> f32 {
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    let (px, py) = (point.x - from.x, point.y - from.y);
    let square = dx * dx + dy * dy;
    let part = if square > 0.0 { ((px * dx + py * dy) / square).clamp(0.0, 1.0) } else { 0.0 };
    length(px - part * dx, py - part * dy)
}

/// Signed area, in m^2; negative if the corners are in clockwise order.
#[must_use]
pub fn area(corners: &[Vec2]) -> f32 {
    sides(corners).map(|(from, to)| from.x * to.y - to.x * from.y).sum::<f32>() / 2.0
}

/// The corners in counterclockwise order.
#[must_use]
pub fn counterclockwise(corners: &[Vec2]) -> Vec<Vec2> {
    let mut corners = corners.to_vec();
    if area(&corners) < 0.0 {
        corners.reverse();
    }
    corners
}

/// The corners of the polygon with its sides moved outwards by `by_m`. No corner moves by more than 3 `by_m`; where a
/// corner is too sharp for that, its sides move less.
#[must_use]
pub fn inflated(corners: &[Vec2], by_m: f32) -> Vec<Vec2> {
    let n = corners.len();
    let out = if area(corners) >= 0.0 { 1.0 } else { -1.0 };
    // The outward unit normal of side k.
    let normal = |k: usize| {
        let (a, b) = (corners[k % n], corners[(k + 1) % n]);
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        let long = length(dx, dy);
        if long > 0.0 { (out * dy / long, -out * dx / long) } else { (0.0, 0.0) }
    };
    let moved = |k: usize| {
        let (before, after) = (normal(k + n - 1), normal(k));
        let (sx, sy) = (before.0 + after.0, before.1 + after.1);
        // The sum of the two unit normals has length 2 cos(bend / 2), and the corner moves by by_m / cos(bend / 2).
        let square = sx * sx + sy * sy;
        let by = (2.0 / square.max(1e-6)).min(MITRE / square.max(1e-6).sqrt()) * by_m;
        vec2(corners[k].x + sx * by, corners[k].y + sy * by)
    };
    (0..n).map(moved).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An L: a square of 2 m without its upper right quarter.
    const L: [Vec2; 6] =
        [vec2(0.0, 0.0), vec2(2.0, 0.0), vec2(2.0, 1.0), vec2(1.0, 1.0), vec2(1.0, 2.0), vec2(0.0, 2.0)];

    #[test]
    fn the_distance_is_positive_inside_an_l_and_negative_in_its_notch() {
        for (point, expected) in [
            (vec2(0.5, 0.5), 0.5),
            (vec2(1.5, 0.4), 0.4),
            (vec2(0.9, 1.5), 0.1),
            (vec2(1.2, 1.5), -0.2),
            (vec2(-3.0, -4.0), -5.0),
            // From the concave corner: 0.3 and 0.4.
            (vec2(0.7, 0.6), 0.5),
        ] {
            let found = signed_distance(&L, point);
            assert!((found - expected).abs() < 1e-6, "{point:?}: {found}");
        }
        let clockwise: Vec<_> = L.iter().rev().copied().collect();
        assert_eq!(signed_distance(&clockwise, vec2(0.5, 0.5)), 0.5);
    }

    #[test]
    fn an_l_has_the_area_of_three_squares_and_can_be_reversed() {
        assert_eq!(area(&L), 3.0);
        let clockwise: Vec<_> = L.iter().rev().copied().collect();
        assert_eq!(area(&clockwise), -3.0);
        assert_eq!(counterclockwise(&clockwise), L);
    }

    #[test]
    fn the_distance_to_a_segment_is_limited_by_its_ends() {
        let (from, to) = (vec2(0.0, 0.0), vec2(2.0, 0.0));
        let found = [vec2(1.0, 0.5), vec2(5.0, 4.0), vec2(-3.0, 4.0)]
            .map(|point| distance_to_segment(from, to, point));
        assert_eq!(found, [0.5, 5.0, 5.0]);
        assert_eq!(distance_to_segment(from, from, vec2(3.0, 4.0)), 5.0, "a segment without length");
    }

    #[test]
    fn a_square_grows_equally_on_all_sides() {
        let square = [vec2(0.0, 0.0), vec2(0.0, 2.0), vec2(2.0, 2.0), vec2(2.0, 0.0)];
        let expected = [vec2(-0.5, -0.5), vec2(-0.5, 2.5), vec2(2.5, 2.5), vec2(2.5, -0.5)];
        for (found, expected) in inflated(&square, 0.5).into_iter().zip(expected) {
            assert!((found.x - expected.x).abs() < 1e-6 && (found.y - expected.y).abs() < 1e-6, "{found:?}");
        }
        let needle = [vec2(0.0, 0.0), vec2(10.0, 0.01), vec2(0.0, 0.02)];
        assert!(inflated(&needle, 0.1)[1].x < 10.31, "a sharp corner stays near");
        assert!(inflated(&[], 1.0).is_empty());
    }
}
