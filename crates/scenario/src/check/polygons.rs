//! The checks of polygons: no crossing sides and, except for the enclosure, no concave corner.

use super::{Diagnostics, METRES};
use crate::limits::*;
use glam::{DVec2, Vec2};

/// Sine of the largest bend to the wrong side that still counts as straight.
const STRAIGHT: f64 = 1e-4;

/// Checks the corners of a shape: their number and coordinates, and that the polygon is convex.
pub(super) fn check_convex(path: std::fmt::Arguments<'_>, corners: &[Vec2], diagnostics: &mut Diagnostics) {
    let before = diagnostics.found.len();
    diagnostics.check_count(path, corners.len(), POLYGON_CORNERS);
    for (k, &Vec2 { x, y }) in corners.iter().enumerate().take(*POLYGON_CORNERS.end()) {
        diagnostics.check_range(format_args!("{path}[{k}][0]"), x, POLYGON_COORDINATE_M, METRES);
        diagnostics.check_range(format_args!("{path}[{k}][1]"), y, POLYGON_COORDINATE_M, METRES);
    }
    if diagnostics.found.len() > before {
        return;
    }
    let points = in_f64(corners);
    let n = points.len();
    if repeats_corner(path, &points, diagnostics) {
        return;
    }
    let area = area(&points);
    if area.abs() < MIN_POLYGON_AREA_M2 {
        let message = "enclose no area: spread them out, and list them in order around the outline";
        diagnostics.push(path, message);
        return;
    }
    let is_concave = |k: usize| {
        let (before, here, after) = (points[(k + n - 1) % n], points[k], points[(k + 1) % n]);
        let (a, b) = (here - before, after - here);
        a.perp_dot(b) * area.signum() < -STRAIGHT * a.length() * b.length()
    };
    if let Some(k) = (0..n).find(|&k| is_concave(k)) {
        let message =
            "is a concave corner: move it outwards, remove it, or build the outline from several obstacles";
        diagnostics.push(format_args!("{path}[{k}]"), message);
        return;
    }
    // Corners that all bend the same way may still go around more than once, like a star.
    check_simple(path, corners, diagnostics);
}

/// Reports the first two sides that cross or touch. Needs at least three corners.
pub(super) fn check_simple(path: std::fmt::Arguments<'_>, corners: &[Vec2], diagnostics: &mut Diagnostics) {
    let corners = in_f64(corners);
    let n = corners.len();
    let end = |k: usize| corners[(k + 1) % n];
    if repeats_corner(path, &corners, diagnostics) {
        return;
    }
    for first in 0..n {
        for second in first + 1..n {
            let neighbours = second == first + 1 || (first == 0 && second == n - 1);
            let meet = if neighbours {
                // Adjacent sides share a corner; they touch elsewhere only if one runs back along the other.
                let (before, after) = if second == first + 1 { (first, second) } else { (second, first) };
                let (a, b) = (end(before) - corners[before], end(after) - corners[after]);
                a.dot(b) < 0.0 && a.perp_dot(b).abs() <= 1e-9 * a.length() * b.length()
            } else {
                meet((corners[first], end(first)), (corners[second], end(second)))
            };
            if meet {
                let sides = [first, second].map(|k| format!("corners_m[{k}] to corners_m[{}]", (k + 1) % n));
                let message = format!(
                    "starts a side ({}) that touches the side from {}: move a corner, or list the corners in order around \
                     the outline",
                    sides[1], sides[0]
                );
                diagnostics.push(format_args!("{path}[{second}]"), message);
                return;
            }
        }
    }
}

/// Reports the first corner that repeats the one before it. Returns whether there is one.
fn repeats_corner(path: std::fmt::Arguments<'_>, corners: &[DVec2], diagnostics: &mut Diagnostics) -> bool {
    let n = corners.len();
    let found = (0..n).find(|&k| corners[k] == corners[(k + n - 1) % n]);
    if let Some(k) = found {
        diagnostics.push(format_args!("{path}[{k}]"), "repeats the corner before it: remove one of them");
    }
    found.is_some()
}

/// Whether two segments share a point.
pub(super) fn meet((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> bool {
    let side = |from: DVec2, to: DVec2, point: DVec2| (to - from).perp_dot(point - from);
    let (to_c, to_d) = (side(a, b, c), side(a, b, d));
    let (to_a, to_b) = (side(c, d, a), side(c, d, b));
    if to_c * to_d > 0.0 || to_a * to_b > 0.0 {
        return false;
    }
    // Each segment reaches the other's line: they meet unless they are on one line with a gap between them.
    let overlap = |a: f64, b: f64, c: f64, d: f64| a.min(b) <= c.max(d) && c.min(d) <= a.max(b);
    overlap(a.x, b.x, c.x, d.x) && overlap(a.y, b.y, c.y, d.y)
}

fn in_f64(corners: &[Vec2]) -> Vec<DVec2> {
    corners.iter().map(|corner| corner.as_dvec2()).collect()
}

fn area(corners: &[DVec2]) -> f64 {
    let n = corners.len();
    // Relative to the first corner, so that a small outline far from (0, 0) loses no precision.
    let from = |k: usize| corners[k % n] - corners[0];
    (0..n).map(|k| from(k).perp_dot(from(k + 1))).sum::<f64>() / 2.0
}
