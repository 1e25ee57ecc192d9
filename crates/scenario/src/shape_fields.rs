//! The editable fields of shapes, and templates for new obstacles.

use super::fields::{Field, FieldValue, Quantity};
use super::polygon;
use super::schema::Shape;
use glam::{Vec2, vec2};

/// The editable sizes of a shape, in m, along its own axes. A circle and a capsule count as rounded boxes; a polygon has none.
#[derive(Debug, Default)]
pub struct Sizes<'a> {
    /// Extent along x without the rounding.
    pub width_m: Option<&'a mut f32>,
    /// Extent along y without the rounding.
    pub height_m: Option<&'a mut f32>,
    /// Radius of the rounding.
    pub radius_m: Option<&'a mut f32>,
}

impl Shape {
    /// The shapes that a new obstacle may have: name and shape, with its initial size.
    #[must_use]
    pub fn templates() -> [(&'static str, Self); 5] {
        let polygon = |corners: &[(f32, f32)]| Self::Polygon {
            corners_m: corners.iter().map(|&(x, y)| vec2(x, y)).collect(),
        };
        [
            ("Circle", Self::Circle { radius_m: 0.15 }),
            ("Box", Self::Rectangle { width_m: 0.4, height_m: 0.4 }),
            ("Capsule", Self::Capsule { length_m: 0.4, radius_m: 0.1 }),
            ("Triangle", polygon(&[(0.0, 0.25), (-0.217, -0.125), (0.217, -0.125)])),
            (
                "Hexagon",
                polygon(&[
                    (0.2, 0.0),
                    (0.1, 0.173),
                    (-0.1, 0.173),
                    (-0.2, 0.0),
                    (-0.1, -0.173),
                    (0.1, -0.173),
                ]),
            ),
        ]
    }

    /// The fields, in the order in which they are shown.
    #[must_use]
    pub fn fields_mut(&mut self) -> Vec<Field<'_>> {
        match self {
            Self::Circle { radius_m } => vec![size("Radius", "", &["radius_m"], radius_m)],
            Self::Rectangle { width_m, height_m } => vec![Field {
                names: &["width_m", "height_m"],
                label: "Size",
                about: "Before rotation",
                value: FieldValue::Pair([width_m, height_m], Quantity::Size),
            }],
            Self::Polygon { corners_m } => vec![Field {
                names: &["corners_m"],
                label: "Corner",
                about: "",
                value: FieldValue::Corners(corners_m),
            }],
            Self::Capsule { length_m, radius_m } => vec![
                size("Length", "Between the centres of the round ends", &["length_m"], length_m),
                size("Radius", "Half the width", &["radius_m"], radius_m),
            ],
        }
    }

    /// The sizes, each of which can be changed on its own.
    #[must_use]
    pub fn sizes_mut(&mut self) -> Sizes<'_> {
        match self {
            Self::Circle { radius_m } => Sizes { radius_m: Some(radius_m), ..Sizes::default() },
            Self::Rectangle { width_m, height_m } => {
                Sizes { width_m: Some(width_m), height_m: Some(height_m), radius_m: None }
            }
            Self::Polygon { .. } => Sizes::default(),
            Self::Capsule { length_m, radius_m } => {
                Sizes { width_m: Some(length_m), height_m: None, radius_m: Some(radius_m) }
            }
        }
    }

    /// The corners of a polygon in its own frame, in m.
    #[must_use]
    pub fn corners_mut(&mut self) -> Option<&mut Vec<Vec2>> {
        match self {
            Self::Polygon { corners_m } => Some(corners_m),
            _ => None,
        }
    }

    /// The shape with its outline moved outwards by `by_m`. Corners stay sharp.
    #[must_use]
    pub fn inflated(mut self, by_m: f32) -> Self {
        if let Some(corners_m) = self.corners_mut() {
            *corners_m = polygon::inflated(corners_m, by_m);
        }
        match self.sizes_mut() {
            Sizes { radius_m: Some(radius_m), .. } => *radius_m += by_m,
            Sizes { width_m, height_m, .. } => {
                width_m.into_iter().chain(height_m).for_each(|side_m| *side_m += 2.0 * by_m);
            }
        }
        self
    }
}

fn size<'a>(
    label: &'static str,
    about: &'static str,
    names: &'static [&'static str],
    value: &'a mut f32,
) -> Field<'a> {
    Field { names, label, about, value: FieldValue::Number(value, Quantity::Size) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_grows_by_the_same_amount() {
        let square = vec![vec2(1.0, 1.0), vec2(-1.0, 1.0), vec2(-1.0, -1.0), vec2(1.0, -1.0)];
        for (shape, radius_m, inflated_m) in [
            (Shape::Circle { radius_m: 1.0 }, 1.0, 1.5),
            (Shape::Rectangle { width_m: 6.0, height_m: 8.0 }, 5.0, 3.5_f32.hypot(4.5)),
            (Shape::Polygon { corners_m: square }, 2.0_f32.sqrt(), 1.5 * 2.0_f32.sqrt()),
            (Shape::Capsule { length_m: 2.0, radius_m: 0.3 }, 1.3, 1.8),
        ] {
            assert!((shape.bounding_radius_m() - radius_m).abs() < 1e-6, "{shape:?}");
            assert!((shape.clone().inflated(0.5).bounding_radius_m() - inflated_m).abs() < 1e-5, "{shape:?}");
        }
    }
}
