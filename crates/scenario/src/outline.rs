//! The outlines of shapes, for drawing.
//!
//! In: a [`Shape`]. Out: a circle, or the corners of a polygon, in f64.

use std::f64::consts::TAU;

use super::schema::Shape;
use glam::{DVec2, dvec2};

/// The outline of a shape in its own frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Outline {
    /// A circle about the origin with this radius in m.
    Circle(f64),
    /// A polygon with these corners in m.
    Polygon(Vec<DVec2>),
}

impl Shape {
    /// The outline. Each rounded corner or end has `segments` straight segments, at least 1.
    #[must_use]
    pub fn outline(&self, segments: u32) -> Outline {
        if !self.has_orientation() {
            return Outline::Circle(self.bounding_radius_m().into());
        }
        let (points, radius_m) = self.support_points(0.0);
        let points: Vec<DVec2> = points.iter().map(|point| point.as_dvec2()).collect();
        if radius_m == 0.0 {
            return Outline::Polygon(points);
        }
        let (radius_m, n) = (f64::from(radius_m), points.len());
        // The direction of the outward normal of the side that starts at point k; the points are counterclockwise.
        let normal_rad = |k: usize| {
            let side = points[(k + 1) % n] - points[k % n];
            libm::atan2(-side.x, side.y)
        };
        let corner = |k: usize| {
            let (from_rad, middle) = (normal_rad(k + n - 1), points[k]);
            let turn_rad = (normal_rad(k) - from_rad).rem_euclid(TAU);
            (0..=segments).map(move |i| {
                let (sin, cos) = libm::sincos(from_rad + turn_rad * f64::from(i) / f64::from(segments));
                middle + radius_m * dvec2(cos, sin)
            })
        };
        Outline::Polygon((0..n).flat_map(corner).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outline_of_a_capsule_is_at_its_radius_from_its_axis() {
        let outline = Shape::Capsule { length_m: 2.0, radius_m: 0.5 }.outline(4);
        let Outline::Polygon(corners) = outline else { panic!("a polygon") };
        assert_eq!(corners.len(), 10);
        for DVec2 { x, y } in &corners {
            let beyond = (x.abs() - 1.0).max(0.0);
            assert!((beyond.hypot(*y) - 0.5).abs() < 1e-9, "{x} {y}");
        }
        let rightmost = corners.iter().map(|corner| corner.x).fold(0.0, f64::max);
        assert!((rightmost - 1.5).abs() < 1e-9, "the ends are round outwards: {rightmost}");
    }

    #[test]
    fn the_outline_of_a_rectangle_has_its_corners() {
        let outline = Shape::Rectangle { width_m: 3.0, height_m: 1.0 }.outline(4);
        let corners = [(1.5, 0.5), (-1.5, 0.5), (-1.5, -0.5), (1.5, -0.5)];
        assert_eq!(outline, Outline::Polygon(corners.map(|(x, y)| dvec2(x, y)).into()));
        assert_eq!(Shape::Circle { radius_m: 0.5 }.outline(4), Outline::Circle(0.5));
    }
}
