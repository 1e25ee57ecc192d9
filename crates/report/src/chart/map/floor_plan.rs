//! The plan's floor: where a place in metres lies on the drawing, and what is drawn in metres.
//!
//! In: the enclosure's extent and its place on the drawing. Out: grid, tracks, outlines and walls, drawn.

use std::f64::consts::TAU;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::{MOVING_EDGE, Silhouette, TRACK, Track};
use crate::style::{
    Area, At, Axis, DrawResult, GRID, HAIRLINE, INK, SOFT_INK, STROKE, TEXT, along, area, is_drawable, line,
    write,
};

/// Between the dots of a track, and their size, in drawn pixels.
const DOTS: f64 = 16.0;
const DOT: i32 = 3;

/// The enclosure on the drawing.
pub(super) struct FloorPlan {
    pub x: Axis,
    pub y: Axis,
    pub left: i32,
    pub right: i32,
    pub upper: i32,
    pub lower: i32,
}

impl FloorPlan {
    /// Of a place in m; one outside the walls lies on them.
    pub fn place(&self, (x, y): (f64, f64)) -> At {
        (self.x.place(x, (self.left, self.right)), self.y.place(y, (self.lower, self.upper)))
    }

    pub fn places(&self, points: &[(f64, f64)]) -> Vec<At> {
        points.iter().filter(|p| is_drawable(p.0) && is_drawable(p.1)).map(|&p| self.place(p)).collect()
    }

    /// Moved into the middle of a drawing of that size.
    pub fn centred(mut self, (width, height): (i32, i32)) -> Self {
        let (right, down) = ((width - self.left - self.right) / 2, (height - self.upper - self.lower) / 2);
        (self.left, self.right) = (self.left + right, self.right + right);
        (self.upper, self.lower) = (self.upper + down, self.lower + down);
        self
    }

    fn pixels_per_m(&self) -> f64 {
        f64::from(self.right - self.left) / (self.x.range.end - self.x.range.start)
    }

    pub fn draw_grid(&self, root: &Area) -> DrawResult {
        for tick in self.x.ticks() {
            let at = self.place((tick, self.y.range.start)).0;
            line(root, vec![(at, self.upper), (at, self.lower)], GRID.stroke_width(HAIRLINE))?;
        }
        for tick in self.y.ticks() {
            let at = self.place((self.x.range.start, tick)).1;
            line(root, vec![(self.left, at), (self.right, at)], GRID.stroke_width(HAIRLINE))?;
        }
        Ok(())
    }

    pub fn draw_numbers(&self, root: &Area) -> DrawResult {
        for tick in self.x.ticks() {
            let at = self.place((tick, self.y.range.start)).0;
            line(root, vec![(at, self.lower), (at, self.lower + 12)], SOFT_INK.stroke_width(HAIRLINE))?;
            write(root, &self.x.label(tick), (at, self.lower + 36), TEXT, &SOFT_INK, HPos::Center)?;
        }
        for tick in self.y.ticks() {
            let at = self.place((self.x.range.start, tick)).1;
            write(root, &self.y.label(tick), (self.left - 20, at), TEXT, &SOFT_INK, HPos::Right)?;
        }
        let middle = ((self.left + self.right) / 2, self.lower + 80);
        write(root, "x and y in m", middle, TEXT, &SOFT_INK, HPos::Center)
    }

    /// Dots along all tracks; where several share a piece, it is drawn once.
    pub fn draw_tracks(&self, root: &Area, tracks: &[Track]) -> DrawResult {
        let mut rings = Vec::new();
        let mut pieces = Vec::new();
        for track in tracks {
            match track {
                Track::Lines(places) => {
                    let places = self.places(places);
                    pieces.extend(places.windows(2).map(|ends| (ends[0], ends[1])));
                }
                Track::Ring(x, y, radius) => rings.push(self.places(&ring((*x, *y, *radius)))),
            }
        }
        rings.dedup();
        // The longest first: a shorter one may lie on it.
        pieces.sort_by_key(|&(from, to)| std::cmp::Reverse(squared(from, to)));
        let mut drawn: Vec<(At, At)> = Vec::new();
        for (from, to) in pieces {
            if !drawn.iter().any(|&piece| lies_on(from, piece) && lies_on(to, piece)) {
                draw_dots(root, &[from, to])?;
                drawn.push((from, to));
            }
        }
        for places in rings {
            draw_dots(root, &closed(places))?;
        }
        Ok(())
    }

    /// A head in front of a moving shape.
    pub fn draw_arrow(&self, root: &Area, outline: &Silhouette, heading: f64) -> DrawResult {
        let places = match outline {
            Silhouette::Disc(x, y, radius) => self.places(&ring((*x, *y, *radius))),
            Silhouette::Polygon(corners) => self.places(corners),
        };
        let (ahead_x, ahead_y) = (heading.cos(), -heading.sin());
        let (left_x, left_y) = (ahead_y, -ahead_x);
        let count = places.len() as f64;
        let (x, y) = places
            .iter()
            .fold((0.0, 0.0), |sum, at| (sum.0 + f64::from(at.0) / count, sum.1 + f64::from(at.1) / count));
        let reach = places.iter().map(|at| (f64::from(at.0) - x) * ahead_x + (f64::from(at.1) - y) * ahead_y);
        let reach = reach.fold(0.0, f64::max);
        let corner = |ahead: f64, left: f64| {
            let (x, y) = (x + ahead_x * ahead + left_x * left, y + ahead_y * ahead + left_y * left);
            (x.round() as i32, y.round() as i32)
        };
        let corners = vec![corner(reach + 24.0, 0.0), corner(reach + 7.0, 10.0), corner(reach + 7.0, -10.0)];
        let (low, high) = ((self.left, self.upper), (self.right, self.lower));
        let inside = |at: &At| low.0 < at.0 && at.0 < high.0 && low.1 < at.1 && at.1 < high.1;
        if corners.iter().all(inside) { area(root, corners, MOVING_EDGE.filled()) } else { Ok(()) }
    }

    /// A shape with an edge; what is beyond the walls is cut off.
    pub fn draw_shape(
        &self,
        root: &Area,
        corners: &[(f64, f64)],
        fill: ShapeStyle,
        edge: RGBColor,
    ) -> DrawResult {
        let corners = self.places(corners);
        area(root, corners.clone(), fill)?;
        line(root, closed(corners), edge.stroke_width(HAIRLINE))
    }

    pub fn draw_disc(
        &self,
        root: &Area,
        disc: (f64, f64, f64),
        fill: ShapeStyle,
        edge: RGBColor,
    ) -> DrawResult {
        let (x, y, radius) = disc;
        let within = |axis: &Axis, at: f64| axis.range.start <= at - radius && at + radius <= axis.range.end;
        if !within(&self.x, x) || !within(&self.y, y) {
            return self.draw_shape(root, &ring(disc), fill, edge);
        }
        let pixels = (radius.max(0.0) * self.pixels_per_m()).round() as i32;
        root.draw(&Circle::new(self.place((x, y)), pixels, fill))?;
        root.draw(&Circle::new(self.place((x, y)), pixels, edge.stroke_width(HAIRLINE)))?;
        Ok(())
    }

    /// The walls around, and what is beyond them covered, up to the edges of a field.
    pub fn draw_enclosure(
        &self,
        root: &Area,
        corners: &[(f64, f64)],
        field: (At, At),
        cover: RGBColor,
    ) -> DrawResult {
        let ((left, upper), (right, lower)) = field;
        let corners = self.places(corners);
        // The field's outline one way round and then the walls the other way: a sheet with a hole.
        let edge = [(left, lower), (left, upper), (right, upper), (right, lower)];
        let sheet = closed(edge.to_vec()).into_iter().chain(closed(corners.clone()));
        area(root, sheet.collect(), cover.filled())?;
        // Once more along the first side, so that the first corner is closed, too.
        let again = corners.get(1).copied();
        line(root, closed(corners).into_iter().chain(again).collect(), INK.stroke_width(STROKE + 2))
    }
}

/// A circle's corners: so many that it looks round.
fn ring((x, y, radius): (f64, f64, f64)) -> Vec<(f64, f64)> {
    (0..64).map(|i| f64::from(i) / 64.0 * TAU).map(|a| (x + radius * a.cos(), y + radius * a.sin())).collect()
}

/// Dots from end to end, evenly.
fn draw_dots(root: &Area, places: &[At]) -> DrawResult {
    let length: f64 = places.windows(2).map(|ends| (squared(ends[0], ends[1]) as f64).sqrt()).sum();
    let between = length / (length / DOTS).round().max(1.0);
    // The last one may be missed by rounding; a little less is not seen.
    for at in along(places, 0.0, (between * 0.9999).max(1.0)) {
        root.draw(&Circle::new(at, DOT, TRACK.filled()))?;
    }
    Ok(())
}

fn squared((from_x, from_y): At, (to_x, to_y): At) -> i64 {
    let (dx, dy) = (i64::from(to_x - from_x), i64::from(to_y - from_y));
    dx * dx + dy * dy
}

/// Whether a place is on a piece, to two drawn pixels.
fn lies_on(place: At, (from, to): (At, At)) -> bool {
    let length = (squared(from, to) as f64).sqrt();
    if length < 1.0 {
        return squared(from, place) <= 4;
    }
    let (dx, dy) = (f64::from(to.0 - from.0) / length, f64::from(to.1 - from.1) / length);
    let (x, y) = (f64::from(place.0 - from.0), f64::from(place.1 - from.1));
    (x * dy - y * dx).abs() <= 2.0 && (-2.0..=length + 2.0).contains(&(x * dx + y * dy))
}

/// Back to where it began.
pub(super) fn closed(mut corners: Vec<At>) -> Vec<At> {
    corners.extend(corners.first().copied());
    corners
}
