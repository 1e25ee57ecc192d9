//! Clipping: lines and bands end exactly at the upper and lower edges of the plot.

use std::ops::Range;

/// A point (x, y), in units of the axes.
type Point = (f64, f64);

/// One side of a band: the points of a line with y clamped to `range`, and a point wherever the line crosses an end of `range`.
pub(super) fn clamped(points: impl Iterator<Item = Point>, range: &Range<f64>) -> Vec<Point> {
    with_crossings(points, range).into_iter().map(|(x, y)| (x, y.clamp(range.start, range.end))).collect()
}

/// The parts of a line whose y lies in `range`.
pub(super) fn parts_within(points: impl Iterator<Item = Point>, range: &Range<f64>) -> Vec<Vec<Point>> {
    let mut parts = vec![Vec::new()];
    for point in with_crossings(points, range) {
        let last = parts.len() - 1;
        if range.start <= point.1 && point.1 <= range.end {
            parts[last].push(point);
        } else if !parts[last].is_empty() {
            parts.push(Vec::new());
        }
    }
    parts
}

/// The points of a line, and those where it crosses an end of `range`.
fn with_crossings(points: impl Iterator<Item = Point>, range: &Range<f64>) -> Vec<Point> {
    let mut found: Vec<Point> = Vec::new();
    for to in points {
        if let Some(&from) = found.last() {
            let crosses = |end: f64| from.1.min(to.1) < end && end < from.1.max(to.1);
            let crossing = |end: f64| (from.0 + (to.0 - from.0) * (end - from.1) / (to.1 - from.1), end);
            let upwards = [range.start, range.end];
            let ends = if from.1 < to.1 { upwards } else { [upwards[1], upwards[0]] };
            found.extend(ends.into_iter().filter(|&end| crosses(end)).map(crossing));
        }
        found.push(to);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: [Point; 5] = [(0.0, 5.0), (1.0, 15.0), (2.0, 25.0), (3.0, -5.0), (4.0, 0.0)];

    #[test]
    fn a_line_is_drawn_inside_only_and_up_to_the_edges() {
        let parts = parts_within(LINE.into_iter(), &(0.0..10.0));
        let near = |a: Point, b: Point| (a.0 - b.0).abs() < 1e-9 && (a.1 - b.1).abs() < 1e-9;
        let expected: [&[Point]; 3] =
            [&[(0.0, 5.0), (0.5, 10.0)], &[(2.5, 10.0), (2.0 + 5.0 / 6.0, 0.0)], &[(4.0, 0.0)]];
        assert_eq!(parts.len(), expected.len(), "{parts:?}");
        for (part, expected) in parts.iter().zip(expected) {
            assert!(
                part.len() == expected.len() && part.iter().zip(expected).all(|(&a, &b)| near(a, b)),
                "{parts:?}"
            );
        }
    }

    #[test]
    fn a_band_follows_its_side_up_to_the_edge_and_then_the_edge() {
        let side = clamped(LINE[..3].iter().copied(), &(0.0..10.0));
        assert_eq!(side, [(0.0, 5.0), (0.5, 10.0), (1.0, 10.0), (2.0, 10.0)]);
    }
}
