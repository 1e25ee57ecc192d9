//! Polygons: sides, signed distance, area and orientation.
//!
//! In: corners in order, clockwise or counterclockwise. Out: sides, distances in m, areas in m^2. Plain f32 arithmetic with
//! the same result on every platform.

use super::geometry::length;
use glam::Vec2;

/// Distance from `point` to the nearest side, in m; negative outside. The polygon may be concave, but its sides must not
/// cross.
pub(super) fn signed_distance(corners: &[Vec2], point: Vec2) -> f32 {
    let (mut nearest, mut inside) = (f32::INFINITY, false);
    for (from, to) in sides(corners) {
        nearest = nearest.min(distance_to_segment(from, to, point));
        // Even and odd crossings of the ray from the point towards +x.
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

#[cfg(test)]
mod tests {
    use glam::vec2;

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
}
