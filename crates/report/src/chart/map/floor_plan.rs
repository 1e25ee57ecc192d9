//! The floor plan: converts metres to drawn pixels, and draws everything that is to scale.

use std::f64::consts::TAU;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::model::MapShape;
use crate::style::{
    Axis, Canvas, DrawResult, GRID, HAIRLINE, INK, Pixel, SOFT_INK, STROKE, TEXT, area, bounds, is_drawable,
    line, write,
};

/// The enclosure's bounding box, in metres and in drawn pixels.
pub(super) struct FloorPlan {
    x: Axis,
    y: Axis,
    pub(super) left: i32,
    pub(super) right: i32,
    pub(super) upper: i32,
    pub(super) lower: i32,
}

impl FloorPlan {
    /// The plan of an enclosure with its upper left corner at the given pixel, at the largest scale that fits into `available`
    /// (width and height in drawn pixels); `None` if the enclosure has no area.
    pub(super) fn new(enclosure: &[(f64, f64)], (left, upper): Pixel, available: (f64, f64)) -> Option<Self> {
        if !enclosure.iter().all(|corner| is_drawable(corner.0) && is_drawable(corner.1)) {
            return None;
        }
        let (low_x, high_x) = bounds(enclosure.iter().map(|corner| corner.0));
        let (low_y, high_y) = bounds(enclosure.iter().map(|corner| corner.1));
        let (width_m, height_m) = (high_x - low_x, high_y - low_y);
        if enclosure.len() < 3 || width_m.min(height_m) < 1e-6 {
            return None;
        }
        let scale = (available.0 / width_m).min(available.1 / height_m);
        let step = Axis::within([0.0, width_m.max(height_m)].into_iter(), 6.0).step;
        Some(Self {
            x: Axis { range: low_x..high_x, step },
            y: Axis { range: low_y..high_y, step },
            left,
            right: left + ((width_m * scale).round() as i32).max(1),
            upper,
            lower: upper + ((height_m * scale).round() as i32).max(1),
        })
    }

    /// The pixel of a point in m; a point outside the bounding box is moved to its edge.
    pub(super) fn pixel(&self, (x, y): (f64, f64)) -> Pixel {
        (self.x.pixel(x, (self.left, self.right)), self.y.pixel(y, (self.lower, self.upper)))
    }

    /// The pixels of the points; those that cannot be drawn are left out.
    pub(super) fn pixels(&self, points: &[(f64, f64)]) -> Vec<Pixel> {
        points.iter().filter(|p| is_drawable(p.0) && is_drawable(p.1)).map(|&p| self.pixel(p)).collect()
    }

    /// The plan moved so that its middle is at `(x, y)`.
    pub(super) fn centred(mut self, (x, y): Pixel) -> Self {
        let (right, down) = ((2 * x - self.left - self.right) / 2, (2 * y - self.upper - self.lower) / 2);
        (self.left, self.right) = (self.left + right, self.right + right);
        (self.upper, self.lower) = (self.upper + down, self.lower + down);
        self
    }

    fn pixels_per_m(&self) -> f64 {
        f64::from(self.right - self.left) / (self.x.range.end - self.x.range.start)
    }

    pub(super) fn draw_grid(&self, root: &Canvas) -> DrawResult {
        for tick in self.x.ticks() {
            let at = self.pixel((tick, self.y.range.start)).0;
            line(root, vec![(at, self.upper), (at, self.lower)], GRID.stroke_width(HAIRLINE))?;
        }
        for tick in self.y.ticks() {
            let at = self.pixel((self.x.range.start, tick)).1;
            line(root, vec![(self.left, at), (self.right, at)], GRID.stroke_width(HAIRLINE))?;
        }
        Ok(())
    }

    pub(super) fn draw_numbers(&self, root: &Canvas) -> DrawResult {
        for tick in self.x.ticks() {
            let at = self.pixel((tick, self.y.range.start)).0;
            line(root, vec![(at, self.lower), (at, self.lower + 12)], SOFT_INK.stroke_width(HAIRLINE))?;
            write(root, &self.x.label(tick), (at, self.lower + 36), TEXT, &SOFT_INK, HPos::Center)?;
        }
        for tick in self.y.ticks() {
            let at = self.pixel((self.x.range.start, tick)).1;
            write(root, &self.y.label(tick), (self.left - 20, at), TEXT, &SOFT_INK, HPos::Right)?;
        }
        let middle = ((self.left + self.right) / 2, self.lower + 80);
        write(root, "x and y in m", middle, TEXT, &SOFT_INK, HPos::Center)
    }

    /// Draws an arrowhead in front of an obstacle that moves in the direction `heading`, in rad; nothing if it would
    /// leave the plan.
    pub(super) fn draw_arrow(
        &self,
        root: &Canvas,
        outline: &MapShape,
        heading: f64,
        colour: RGBColor,
    ) -> DrawResult {
        let pixels = match outline {
            MapShape::Disc(x, y, radius) => self.pixels(&ring((*x, *y, *radius))),
            MapShape::Polygon(corners) => self.pixels(corners),
        };
        let (ahead_x, ahead_y) = (heading.cos(), -heading.sin());
        let (left_x, left_y) = (ahead_y, -ahead_x);
        let count = pixels.len() as f64;
        let (x, y) = pixels
            .iter()
            .fold((0.0, 0.0), |sum, at| (sum.0 + f64::from(at.0) / count, sum.1 + f64::from(at.1) / count));
        let reach = pixels.iter().map(|at| (f64::from(at.0) - x) * ahead_x + (f64::from(at.1) - y) * ahead_y);
        let reach = reach.fold(0.0, f64::max);
        let corner = |ahead: f64, left: f64| {
            let (x, y) = (x + ahead_x * ahead + left_x * left, y + ahead_y * ahead + left_y * left);
            (x.round() as i32, y.round() as i32)
        };
        let corners = vec![corner(reach + 24.0, 0.0), corner(reach + 7.0, 10.0), corner(reach + 7.0, -10.0)];
        let inside =
            |at: &Pixel| self.left < at.0 && at.0 < self.right && self.upper < at.1 && at.1 < self.lower;
        if corners.iter().all(inside) { area(root, corners, colour.filled()) } else { Ok(()) }
    }

    /// Draws a filled shape with an outline, cut off at the plan's edges.
    pub(super) fn draw_shape(
        &self,
        root: &Canvas,
        shape: &MapShape,
        fill: ShapeStyle,
        edge: RGBColor,
    ) -> DrawResult {
        match shape {
            MapShape::Disc(x, y, radius) => self.draw_disc(root, (*x, *y, *radius), fill, edge),
            MapShape::Polygon(corners) => self.draw_polygon(root, corners, fill, edge),
        }
    }

    /// Draws a filled polygon with an outline, cut off at the plan's edges.
    pub(super) fn draw_polygon(
        &self,
        root: &Canvas,
        corners: &[(f64, f64)],
        fill: ShapeStyle,
        edge: RGBColor,
    ) -> DrawResult {
        let corners = self.pixels(corners);
        area(root, corners.clone(), fill)?;
        line(root, closed(corners), edge.stroke_width(HAIRLINE))
    }

    /// Draws a filled disc (x, y and radius in m) with an outline, cut off at the plan's edges.
    pub(super) fn draw_disc(
        &self,
        root: &Canvas,
        disc: (f64, f64, f64),
        fill: ShapeStyle,
        edge: RGBColor,
    ) -> DrawResult {
        let (x, y, radius) = disc;
        let within = |axis: &Axis, at: f64| axis.range.start <= at - radius && at + radius <= axis.range.end;
        if !within(&self.x, x) || !within(&self.y, y) {
            return self.draw_polygon(root, &ring(disc), fill, edge);
        }
        let pixels = (radius.max(0.0) * self.pixels_per_m()).round() as i32;
        root.draw(&Circle::new(self.pixel((x, y)), pixels, fill))?;
        root.draw(&Circle::new(self.pixel((x, y)), pixels, edge.stroke_width(HAIRLINE)))?;
        Ok(())
    }

    /// Draws the enclosing walls, and covers the area outside them up to the edges of `field`.
    pub(super) fn draw_enclosure(
        &self,
        root: &Canvas,
        corners: &[(f64, f64)],
        field: (Pixel, Pixel),
        cover: RGBColor,
    ) -> DrawResult {
        let ((left, upper), (right, lower)) = field;
        let corners = self.pixels(corners);
        // A polygon with a hole: the edge of the field in one direction, then the walls in the other.
        let edge = [(left, lower), (left, upper), (right, upper), (right, lower)];
        let sheet = closed(edge.to_vec()).into_iter().chain(closed(corners.clone()));
        area(root, sheet.collect(), cover.filled())?;
        // The first side is drawn twice, so that the first corner has no gap.
        let second = corners.get(1).copied();
        line(root, closed(corners).into_iter().chain(second).collect(), INK.stroke_width(STROKE + 2))
    }
}

/// The corners of a polygon that approximates a circle.
pub(super) fn ring((x, y, radius): (f64, f64, f64)) -> Vec<(f64, f64)> {
    (0..64).map(|i| f64::from(i) / 64.0 * TAU).map(|a| (x + radius * a.cos(), y + radius * a.sin())).collect()
}

/// The corners, with the first one repeated at the end.
pub(super) fn closed(mut corners: Vec<Pixel>) -> Vec<Pixel> {
    corners.extend(corners.first().copied());
    corners
}
