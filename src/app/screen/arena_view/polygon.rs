//! Polygons on the plane: filled, wherever their corners point; grown; and which parts of a line lie within.
//!
//! In: corners in order, either way round. Out: triangles, corners, spans. What crosses itself is filled somehow, never a
//! panic: a drawing may be unfinished.

use bevy::math::{Vec2, vec2};
use egui::{Color32, Mesh, Pos2, Shape};

use super::canvas::Canvas;
use crate::scenario::polygon;


/// How far a grown corner may be from where it was, in times of the growth.
const MITRE: f32 = 3.0;

/// Twice the signed area of the triangle a, b, c: positive where they go counterclockwise.
fn turn(a: Vec2, b: Vec2, c: Vec2) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// Whether the corners go counterclockwise.
fn is_counterclockwise(corners: &[Vec2]) -> bool {
    polygon::area(corners) >= 0.0
}

/// Whether no corner points inwards and it goes round once.
#[must_use]
pub fn is_convex(corners: &[Vec2]) -> bool {
    let n = corners.len();
    let left = is_counterclockwise(corners);
    let bends = (0..n).all(|k| {
        let by = turn(corners[k], corners[(k + 1) % n], corners[(k + 2) % n]);
        if left { by >= 0.0 } else { by <= 0.0 }
    });
    // A star bends one way only, but goes round twice: it crosses its own middle height more than twice.
    let falls = (0..n).filter(|&k| {
        let rises = |k: usize| corners[(k + 1) % n].y > corners[k % n].y;
        rises(k) != rises(k + 1)
    });
    bends && falls.count() <= 2
}

/// The corners' numbers, three for each triangle of the polygon's area.
#[must_use]
pub fn triangles(corners: &[Vec2]) -> Vec<[usize; 3]> {
    clip_ears(corners).0
}

/// The triangles: ears are cut off until one is left. And whether there always was an ear: where a polygon crosses itself
/// there may be none, and any corner is taken for one.
fn clip_ears(corners: &[Vec2]) -> (Vec<[usize; 3]>, bool) {
    let mut valid = true;
    let mut left: Vec<usize> = (0..corners.len()).collect();
    if !is_counterclockwise(corners) {
        left.reverse();
    }
    let mut found = Vec::with_capacity(corners.len().saturating_sub(2));
    while left.len() > 3 {
        let n = left.len();
        let around = |k: usize| [left[(k + n - 1) % n], left[k], left[(k + 1) % n]];
        let ear = (0..n).find(|&k| is_ear(corners, &left, around(k)));
        valid &= ear.is_some();
        let cut = ear.unwrap_or(0);
        found.push(around(cut));
        left.remove(cut);
    }
    if let [a, b, c] = left[..] {
        found.push([a, b, c]);
    }
    (found, valid)
}

/// Whether the triangle points outwards and holds none of the other corners.
fn is_ear(corners: &[Vec2], left: &[usize], [a, b, c]: [usize; 3]) -> bool {
    let [pa, pb, pc] = [a, b, c].map(|k| corners[k]);
    if turn(pa, pb, pc) <= 0.0 {
        return false;
    }
    let within = |p: Vec2| turn(pa, pb, p) >= 0.0 && turn(pb, pc, p) >= 0.0 && turn(pc, pa, p) >= 0.0;
    // Where a polygon touches itself, another corner is in the same place.
    !left.iter().map(|&k| corners[k]).any(|p| ![pa, pb, pc].contains(&p) && within(p))
}

/// Fills it, without soft edges.
pub fn fill(canvas: &Canvas, corners: &[Vec2], ink: Color32) {
    paint(canvas, corners, &triangles(corners), ink);
}

/// Fills what is around it, as far as the box from `low` to `high` goes, which has it well inside; nothing around one that
/// crosses itself.
pub fn fill_outside(canvas: &Canvas, corners: &[Vec2], low: Vec2, high: Vec2, ink: Color32) {
    let ring = ring(corners, low, high);
    let (triangles, valid) = clip_ears(&ring);
    if valid {
        paint(canvas, &ring, &triangles, ink);
    }
}

/// The box with the polygon cut out of it, as one polygon: there is a cut from the box's right side to the corner that is
/// furthest on the right.
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

fn paint(canvas: &Canvas, corners: &[Vec2], triangles: &[[usize; 3]], ink: Color32) {
    let mut mesh = Mesh::default();
    for &Vec2 { x, y } in corners {
        let at: Pos2 = canvas.to_screen([x, y]);
        mesh.colored_vertex(at, ink);
    }
    for &[a, b, c] in triangles {
        mesh.add_triangle(a as u32, b as u32, c as u32);
    }
    if mesh.vertices.iter().all(|vertex| vertex.pos.is_finite()) {
        canvas.painter.add(Shape::mesh(mesh));
    }
}

/// The corners of the polygon whose sides are `by_m` further out.
#[must_use]
pub fn inflated(corners: &[Vec2], by_m: f32) -> Vec<Vec2> {
    let n = corners.len();
    let out = if is_counterclockwise(corners) { 1.0 } else { -1.0 };
    // The unit vector out of side k.
    let normal = |k: usize| {
        let (a, b) = (corners[k % n], corners[(k + 1) % n]);
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        let long = dx.hypot(dy);
        if long > 0.0 { (out * dy / long, -out * dx / long) } else { (0.0, 0.0) }
    };
    let moved = |k: usize| {
        let (before, after) = (normal(k + n - 1), normal(k));
        let (sx, sy) = (before.0 + after.0, before.1 + after.1);
        // The sum of two unit vectors is 2 cos of half the bend long, and the corner goes by 1 / cos.
        let square = sx * sx + sy * sy;
        let by = (2.0 / square.max(1e-6)).min(MITRE / square.max(1e-6).sqrt()) * by_m;
        vec2(corners[k].x + sx * by, corners[k].y + sy * by)
    };
    (0..n).map(moved).collect()
}

/// The parts of the line x = `at_m` that lie within, from where to where along y, in order.
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

    /// An L: a square of 2 m without its upper right quarter.
    const L: [Vec2; 6] = [vec2(0.0, 0.0), vec2(2.0, 0.0), vec2(2.0, 1.0), vec2(1.0, 1.0), vec2(1.0, 2.0), vec2(0.0, 2.0)];
    const STAR: [Vec2; 5] = [vec2(0.0, 1.0), vec2(0.6, -0.8), vec2(-1.0, 0.3), vec2(1.0, 0.3), vec2(-0.6, -0.8)];

    #[test]
    fn an_l_is_filled_without_its_notch_either_way_round() {
        let mut corners = L;
        for _ in 0..2 {
            let found = triangles(&corners);
            assert_eq!(found.len(), 4);
            let area: f32 =
                found.iter().map(|t| turn(corners[t[0]], corners[t[1]], corners[t[2]]) / 2.0).sum();
            assert_eq!(area, 3.0, "three quarters of 4, none of it twice");
            for t in found {
                let middle = |of: fn(&Vec2) -> f32| t.iter().map(|&k| of(&corners[k])).sum::<f32>() / 3.0;
                assert!(middle(|c| c.x) < 1.0 || middle(|c| c.y) < 1.0, "{t:?} is in the notch");
            }
            corners.reverse();
        }
    }

    #[test]
    fn around_an_l_there_is_its_box_less_the_l() {
        for turned in [false, true] {
            let mut corners = L;
            if turned {
                corners.reverse();
            }
            let ring = ring(&corners, vec2(-1.0, -1.0), vec2(3.0, 3.0));
            let (found, valid) = clip_ears(&ring);
            let area: f32 = found.iter().map(|t| turn(ring[t[0]], ring[t[1]], ring[t[2]]) / 2.0).sum();
            assert!(valid && (area - 13.0).abs() < 1e-5, "{area}: 16 less 3");
            assert!(found.iter().all(|t| turn(ring[t[0]], ring[t[1]], ring[t[2]]) >= 0.0), "nothing twice");
        }
        assert!(!clip_ears(&ring(&STAR, vec2(-2.0, -2.0), vec2(2.0, 2.0))).1);
    }

    #[test]
    fn what_crosses_itself_or_has_no_area_is_no_panic() {
        assert_eq!(triangles(&STAR).len(), 3);
        assert_eq!(triangles(&[vec2(0.0, 0.0); 5]).len(), 3);
        assert_eq!(triangles(&L[..2]), Vec::<[usize; 3]>::new());
        assert_eq!(triangles(&[vec2(f32::NAN, 0.0), vec2(1.0, 0.0), vec2(0.0, 1.0), vec2(2.0, 2.0)]).len(), 2);
        assert!(inflated(&[], 1.0).is_empty() && spans(&[], 0.0).is_empty());
    }

    #[test]
    fn only_a_square_is_convex_among_these() {
        let square = [vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(1.0, 1.0), vec2(0.0, 1.0)];
        assert!(is_convex(&square) && !is_convex(&L) && !is_convex(&STAR));
    }

    #[test]
    fn a_grown_square_is_as_much_wider_on_each_side() {
        let square = [vec2(0.0, 0.0), vec2(0.0, 2.0), vec2(2.0, 2.0), vec2(2.0, 0.0)];
        let expected = [vec2(-0.5, -0.5), vec2(-0.5, 2.5), vec2(2.5, 2.5), vec2(2.5, -0.5)];
        for (found, expected) in inflated(&square, 0.5).into_iter().zip(expected) {
            assert!((found.x - expected.x).abs() < 1e-6 && (found.y - expected.y).abs() < 1e-6, "{found:?}");
        }
        let needle = [vec2(0.0, 0.0), vec2(10.0, 0.01), vec2(0.0, 0.02)];
        assert!(inflated(&needle, 0.1)[1].x < 10.31, "a sharp corner does not run away");
    }

    #[test]
    fn a_line_through_a_u_is_within_it_twice() {
        let u =
            [vec2(0.0, 0.0), vec2(3.0, 0.0), vec2(3.0, 2.0), vec2(2.0, 2.0), vec2(2.0, 1.0), vec2(1.0, 1.0), vec2(1.0, 2.0), vec2(0.0, 2.0)];
        assert_eq!(spans(&u, 1.5), [[0.0, 1.0]]);
        let lying = u.map(|corner| vec2(corner.y, corner.x));
        assert_eq!(spans(&lying, 1.5), [[0.0, 1.0], [2.0, 3.0]]);
        assert!(spans(&u, 5.0).is_empty());
    }
}
