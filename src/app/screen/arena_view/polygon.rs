//! Polygons: filling, and intersection with a line.
//!
//! In: corners in order, clockwise or counterclockwise. Out: triangles, spans. A polygon that
//! crosses itself, such as an unfinished drawing, is filled in some way, but never causes a panic.

use bevy::math::{Vec2, vec2};
use egui::{Color32, Mesh, Pos2, Shape};

use super::canvas::Canvas;
use crate::scenario::polygon;

/// Twice the signed area of the triangle a, b, c; positive if they are in counterclockwise order.
fn turn(a: Vec2, b: Vec2, c: Vec2) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// Whether the corners are in counterclockwise order.
fn is_counterclockwise(corners: &[Vec2]) -> bool {
    polygon::area(corners) >= 0.0
}

/// Whether the polygon is convex and winds around once.
#[must_use]
pub fn is_convex(corners: &[Vec2]) -> bool {
    let n = corners.len();
    let counterclockwise = is_counterclockwise(corners);
    let turns_one_way = (0..n).all(|k| {
        let by = turn(corners[k], corners[(k + 1) % n], corners[(k + 2) % n]);
        if counterclockwise { by >= 0.0 } else { by <= 0.0 }
    });
    // A star also turns in one direction only, but winds around twice: it rises and falls more than once.
    let extrema = (0..n).filter(|&k| {
        let rises = |k: usize| corners[(k + 1) % n].y > corners[k % n].y;
        rises(k) != rises(k + 1)
    });
    turns_one_way && extrema.count() <= 2
}

/// The triangles that make up the polygon, as indices of its corners.
#[must_use]
pub fn triangles(corners: &[Vec2]) -> Vec<[usize; 3]> {
    clip_ears(corners).0
}

/// The triangles by ear clipping, and whether there was an ear in every step. In a polygon that crosses
/// itself there may be none; then the first remaining corner is cut off.
fn clip_ears(corners: &[Vec2]) -> (Vec<[usize; 3]>, bool) {
    let mut valid = true;
    let mut remaining: Vec<usize> = (0..corners.len()).collect();
    if !is_counterclockwise(corners) {
        remaining.reverse();
    }
    let mut found = Vec::with_capacity(corners.len().saturating_sub(2));
    while remaining.len() > 3 {
        let n = remaining.len();
        let around = |k: usize| [remaining[(k + n - 1) % n], remaining[k], remaining[(k + 1) % n]];
        let ear = (0..n).find(|&k| is_ear(corners, &remaining, around(k)));
        valid &= ear.is_some();
        let cut = ear.unwrap_or(0);
        found.push(around(cut));
        remaining.remove(cut);
    }
    if let [a, b, c] = remaining[..] {
        found.push([a, b, c]);
    }
    (found, valid)
}

/// Whether the corner b is convex, and the triangle a, b, c contains none of the other `remaining` corners.
fn is_ear(corners: &[Vec2], remaining: &[usize], [a, b, c]: [usize; 3]) -> bool {
    let [pa, pb, pc] = [a, b, c].map(|k| corners[k]);
    if turn(pa, pb, pc) <= 0.0 {
        return false;
    }
    let within = |p: Vec2| turn(pa, pb, p) >= 0.0 && turn(pb, pc, p) >= 0.0 && turn(pc, pa, p) >= 0.0;
    // If the polygon touches itself, another corner may be at the same point.
    !remaining.iter().map(|&k| corners[k]).any(|p| ![pa, pb, pc].contains(&p) && within(p))
}

/// Fills a polygon, without anti-aliasing.
pub fn fill(canvas: &Canvas, corners: &[Vec2], color: Color32) {
    paint(canvas, corners, &triangles(corners), color);
}

/// Fills the area between a polygon and the box from `low` to `high` around it; nothing if the polygon
/// crosses itself.
pub fn fill_outside(canvas: &Canvas, corners: &[Vec2], low: Vec2, high: Vec2, color: Color32) {
    let ring = ring(corners, low, high);
    let (triangles, valid) = clip_ears(&ring);
    if valid {
        paint(canvas, &ring, &triangles, color);
    }
}

/// The box with a hole in the shape of the polygon, as one polygon: a cut leads from the right side of the
/// box to the rightmost corner.
fn ring(corners: &[Vec2], low: Vec2, high: Vec2) -> Vec<Vec2> {
    let mut hole = corners.to_vec();
    if is_counterclockwise(&hole) {
        hole.reverse();
    }
    let by_x = |a: &usize, b: &usize| hole[*a].x.total_cmp(&hole[*b].x);
    let Some(first) = (0..hole.len()).max_by(by_x) else { return Vec::new() };
    hole.rotate_left(first);
    let edge = vec2(high.x, hole[0].y);
    let frame = [edge, high, vec2(low.x, high.y), low, vec2(high.x, low.y), edge];
    frame.into_iter().chain(hole.iter().copied()).chain(hole.first().copied()).collect()
}

fn paint(canvas: &Canvas, corners: &[Vec2], triangles: &[[usize; 3]], color: Color32) {
    let mut mesh = Mesh::default();
    for &Vec2 { x, y } in corners {
        let at: Pos2 = canvas.to_screen([x, y]);
        mesh.colored_vertex(at, color);
    }
    for &[a, b, c] in triangles {
        mesh.add_triangle(a as u32, b as u32, c as u32);
    }
    if mesh.vertices.iter().all(|vertex| vertex.pos.is_finite()) {
        canvas.painter.add(Shape::mesh(mesh));
    }
}

/// The parts of the line x = `at_m` inside the polygon, each from its lowest to its highest y, in order.
#[must_use]
pub fn spans(corners: &[Vec2], at_m: f32) -> Vec<[f32; 2]> {
    let crossed = polygon::sides(corners).filter(|(a, b)| (a.x > at_m) != (b.x > at_m));
    let mut crossings: Vec<f32> =
        crossed.map(|(a, b)| a.y + (at_m - a.x) / (b.x - a.x) * (b.y - a.y)).collect();
    crossings.sort_unstable_by(f32::total_cmp);
    crossings.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An L: a square with sides of 2 m without its upper right quarter.
    const L: [Vec2; 6] =
        [vec2(0.0, 0.0), vec2(2.0, 0.0), vec2(2.0, 1.0), vec2(1.0, 1.0), vec2(1.0, 2.0), vec2(0.0, 2.0)];
    const STAR: [Vec2; 5] =
        [vec2(0.0, 1.0), vec2(0.6, -0.8), vec2(-1.0, 0.3), vec2(1.0, 0.3), vec2(-0.6, -0.8)];

    #[test]
    fn an_l_is_filled_without_its_notch_in_either_order() {
        let mut corners = L;
        for _ in 0..2 {
            let found = triangles(&corners);
            assert_eq!(found.len(), 4);
            let area: f32 =
                found.iter().map(|t| turn(corners[t[0]], corners[t[1]], corners[t[2]]).abs() / 2.0).sum();
            assert_eq!(area, 3.0, "three quarters of 4, no area covered twice");
            for t in found {
                let middle = |of: fn(&Vec2) -> f32| t.iter().map(|&k| of(&corners[k])).sum::<f32>() / 3.0;
                assert!(middle(|c| c.x) < 1.0 || middle(|c| c.y) < 1.0, "{t:?} is in the notch");
            }
            corners.reverse();
        }
    }

    #[test]
    fn the_outside_of_an_l_is_its_box_without_the_l() {
        for clockwise in [false, true] {
            let mut corners = L;
            if clockwise {
                corners.reverse();
            }
            let ring = ring(&corners, vec2(-1.0, -1.0), vec2(3.0, 3.0));
            let (found, valid) = clip_ears(&ring);
            let area: f32 = found.iter().map(|t| turn(ring[t[0]], ring[t[1]], ring[t[2]]) / 2.0).sum();
            assert!(valid && (area - 13.0).abs() < 1e-5, "{area}: 16 minus 3");
            assert!(
                found.iter().all(|t| turn(ring[t[0]], ring[t[1]], ring[t[2]]) >= 0.0),
                "no area is covered twice"
            );
        }
        assert!(!clip_ears(&ring(&STAR, vec2(-2.0, -2.0), vec2(2.0, 2.0))).1);
    }

    #[test]
    fn polygons_that_cross_themselves_or_have_no_area_cause_no_panic() {
        assert_eq!(triangles(&STAR).len(), 3);
        assert_eq!(triangles(&[vec2(0.0, 0.0); 5]).len(), 3);
        assert_eq!(triangles(&L[..2]), Vec::<[usize; 3]>::new());
        assert_eq!(
            triangles(&[vec2(f32::NAN, 0.0), vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(2.0, 2.0)]).len(),
            2
        );
        assert!(spans(&[], 0.0).is_empty());
    }

    #[test]
    fn a_square_is_convex_but_an_l_and_a_star_are_not() {
        let square = [vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(1.0, 1.0), vec2(0.0, 1.0)];
        assert!(is_convex(&square) && !is_convex(&L) && !is_convex(&STAR));
    }

    #[test]
    fn a_line_through_a_u_has_two_parts_inside() {
        let u = [
            vec2(0.0, 0.0),
            vec2(3.0, 0.0),
            vec2(3.0, 2.0),
            vec2(2.0, 2.0),
            vec2(2.0, 1.0),
            vec2(1.0, 1.0),
            vec2(1.0, 2.0),
            vec2(0.0, 2.0),
        ];
        assert_eq!(spans(&u, 1.5), [[0.0, 1.0]]);
        let transposed = u.map(|corner| vec2(corner.y, corner.x));
        assert_eq!(spans(&transposed, 1.5), [[0.0, 1.0], [2.0, 3.0]]);
        assert!(spans(&u, 5.0).is_empty());
    }
}
