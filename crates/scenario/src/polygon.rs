//! Polygons: their sides, how far a point is from them and on which side, and which way round they go.
//!
//! In: corners in order, either way round. Out: sides, signed distances, areas. Plain f32 arithmetic, alike on every
//! platform.

use super::geometry::length;

/// From `point` to the nearest side, in m; negative outside. Sides may point inwards, but must not cross.
pub(super) fn signed_distance(corners: &[(f32, f32)], point: (f32, f32)) -> f32 {
    let (mut nearest, mut inside) = (f32::INFINITY, false);
    for (from, to) in sides(corners) {
        nearest = nearest.min(distance_to_segment(from, to, point));
        // Even and odd crossings of the ray from the point towards +x.
        if (from.1 > point.1) != (to.1 > point.1) {
            let x = from.0 + (point.1 - from.1) / (to.1 - from.1) * (to.0 - from.0);
            inside ^= point.0 < x;
        }
    }
    if inside { nearest } else { -nearest }
}

/// Each side as its two ends; the last joins the first corner.
pub fn sides<T: Copy>(corners: &[T]) -> impl Iterator<Item = (T, T)> {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

/// From `point` to the segment between two points, in m.
#[must_use]
pub fn distance_to_segment(from: (f32, f32), to: (f32, f32), point: (f32, f32)) -> f32 {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let (px, py) = (point.0 - from.0, point.1 - from.1);
    let square = dx * dx + dy * dy;
    let part = if square > 0.0 { ((px * dx + py * dy) / square).clamp(0.0, 1.0) } else { 0.0 };
    length(px - part * dx, py - part * dy)
}

/// The area, in m^2; negative where the corners go clockwise.
#[must_use]
pub fn area(corners: &[(f32, f32)]) -> f32 {
    sides(corners).map(|(from, to)| from.0 * to.1 - to.0 * from.1).sum::<f32>() / 2.0
}

/// The same corners, counterclockwise.
#[must_use]
pub fn counterclockwise(corners: &[(f32, f32)]) -> Vec<(f32, f32)> {
    let mut corners = corners.to_vec();
    if area(&corners) < 0.0 {
        corners.reverse();
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An L: a square of 2 m without its upper right quarter.
    const L: [(f32, f32); 6] = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)];

    #[test]
    fn depth_is_positive_within_an_l_and_negative_in_its_notch() {
        for (point, expected) in [
            ((0.5, 0.5), 0.5),
            ((1.5, 0.4), 0.4),
            ((0.9, 1.5), 0.1),
            ((1.2, 1.5), -0.2),
            ((-3.0, -4.0), -5.0),
            // From the corner that points inwards: 0.3 and 0.4.
            ((0.7, 0.6), 0.5),
        ] {
            let found = signed_distance(&L, point);
            assert!((found - expected).abs() < 1e-6, "{point:?}: {found}");
        }
        let clockwise: Vec<_> = L.iter().rev().copied().collect();
        assert_eq!(signed_distance(&clockwise, (0.5, 0.5)), 0.5);
    }

    #[test]
    fn an_l_has_the_area_of_three_squares_and_can_be_turned_round() {
        assert_eq!(area(&L), 3.0);
        let clockwise: Vec<_> = L.iter().rev().copied().collect();
        assert_eq!(area(&clockwise), -3.0);
        assert_eq!(counterclockwise(&clockwise), L);
    }

    #[test]
    fn the_way_to_a_segment_ends_at_its_ends() {
        let (from, to) = ((0.0, 0.0), (2.0, 0.0));
        let found = [(1.0, 0.5), (5.0, 4.0), (-3.0, 4.0)].map(|point| distance_to_segment(from, to, point));
        assert_eq!(found, [0.5, 5.0, 5.0]);
        assert_eq!(distance_to_segment(from, from, (3.0, 4.0)), 5.0, "a segment without length");
    }
}
