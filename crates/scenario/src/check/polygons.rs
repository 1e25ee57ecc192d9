//! Whether corners make an outline: sides that don't cross, and for obstacles none that points inwards.

use super::{Diagnostics, METRES};
use glam::{DVec2, Vec2};

/// The least area of an obstacle, in m^2: that of the smallest square.
const MIN_AREA_M2: f64 = 1e-6;
/// The sine of a turn to the wrong side that still counts as straight.
const STRAIGHT: f64 = 1e-4;

/// The corners of an obstacle: 3 to 32, and with all sides bent the same way.
pub(super) fn check_convex(path: std::fmt::Arguments<'_>, corners: &[Vec2], diagnostics: &mut Diagnostics) {
    let before = diagnostics.0.len();
    diagnostics.check_count(path, corners.len(), 3..=32);
    for (k, &Vec2 { x, y }) in corners.iter().enumerate().take(32) {
        diagnostics.check_range(format_args!("{path}[{k}][0]"), x, -1000.0..=1000.0, METRES);
        diagnostics.check_range(format_args!("{path}[{k}][1]"), y, -1000.0..=1000.0, METRES);
    }
    if diagnostics.0.len() > before {
        return;
    }
    let corners = wide(corners);
    let n = corners.len();
    if twice(path, &corners, diagnostics) {
        return;
    }
    let area = area(&corners);
    if area.abs() < MIN_AREA_M2 {
        let message =
            "enclose no area: move them apart, off one line, and list them in their order around it";
        diagnostics.push(path, message);
        return;
    }
    let inwards = |k: usize| {
        let (before, here, after) = (corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n]);
        let (a, b) = (here - before, after - here);
        a.perp_dot(b) * area.signum() < -STRAIGHT * a.length() * b.length()
    };
    if let Some(k) = (0..n).find(|&k| inwards(k)) {
        let message = "points inwards: move it outwards, leave it out, or put the outline together of several \
                       obstacles";
        diagnostics.push(format_args!("{path}[{k}]"), message);
        return;
    }
    // Corners that all turn the same way may still go around more than once.
    check_simple(path, &corners.iter().map(|corner| corner.as_vec2()).collect::<Vec<_>>(), diagnostics);
}

/// Reports the first two sides that cross or touch one another. There must be three corners at least.
pub(super) fn check_simple(path: std::fmt::Arguments<'_>, corners: &[Vec2], diagnostics: &mut Diagnostics) {
    let corners = wide(corners);
    let n = corners.len();
    let end = |k: usize| corners[(k + 1) % n];
    if twice(path, &corners, diagnostics) {
        return;
    }
    for first in 0..n {
        for second in first + 1..n {
            let neighbours = second == first + 1 || (first == 0 && second == n - 1);
            let meet = if neighbours {
                // They share a corner, and touch elsewhere only where the one goes back along the other.
                let (before, after) = if second == first + 1 { (first, second) } else { (second, first) };
                let (a, b) = (end(before) - corners[before], end(after) - corners[after]);
                a.dot(b) < 0.0 && a.perp_dot(b).abs() <= 1e-9 * a.length() * b.length()
            } else {
                meet((corners[first], end(first)), (corners[second], end(second)))
            };
            if meet {
                let sides = [first, second].map(|k| format!("corners_m[{k}] to corners_m[{}]", (k + 1) % n));
                let message = format!(
                    "begins a side ({}) that meets the one from {}: move a corner, or list them in their order around \
                     it",
                    sides[1], sides[0]
                );
                diagnostics.push(format_args!("{path}[{second}]"), message);
                return;
            }
        }
    }
}

/// Reports the first corner that is where the one before it is; gives whether there is one.
fn twice(path: std::fmt::Arguments<'_>, corners: &[DVec2], diagnostics: &mut Diagnostics) -> bool {
    let n = corners.len();
    let found = (0..n).find(|&k| corners[k] == corners[(k + n - 1) % n]);
    if let Some(k) = found {
        diagnostics
            .push(format_args!("{path}[{k}]"), "is where the corner before it is: leave one of them out");
    }
    found.is_some()
}

/// Whether two segments have a point in common.
fn meet((a, b): (DVec2, DVec2), (c, d): (DVec2, DVec2)) -> bool {
    let side = |from: DVec2, to: DVec2, point: DVec2| (to - from).perp_dot(point - from);
    let (to_c, to_d) = (side(a, b, c), side(a, b, d));
    let (to_a, to_b) = (side(c, d, a), side(c, d, b));
    if to_c * to_d > 0.0 || to_a * to_b > 0.0 {
        return false;
    }
    // Each reaches the other's line: they meet, unless all four lie on one line, apart.
    let overlap = |a: f64, b: f64, c: f64, d: f64| a.min(b) <= c.max(d) && c.min(d) <= a.max(b);
    overlap(a.x, b.x, c.x, d.x) && overlap(a.y, b.y, c.y, d.y)
}

fn wide(corners: &[Vec2]) -> Vec<DVec2> {
    corners.iter().map(|corner| corner.as_dvec2()).collect()
}

fn area(corners: &[DVec2]) -> f64 {
    let n = corners.len();
    // About the first corner, so that a small outline far from (0, 0) loses nothing.
    let from = |k: usize| corners[k % n] - corners[0];
    (0..n).map(|k| from(k).perp_dot(from(k + 1))).sum::<f64>() / 2.0
}
