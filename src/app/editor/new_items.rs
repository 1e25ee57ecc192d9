//! New items, added by one click.

use std::f32::consts::{FRAC_PI_2, TAU};

use bevy::math::{Vec2, vec2};

use super::document::Editor;
use super::free_space;
use super::items::ListItem;
use super::points::to_mm;
use crate::scenario::{Generator, Obstacle, ObstacleMotion, RandomShape, Shape};

/// An item that can be added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NewItem {
    /// A circular obstacle.
    Circle,
    /// A rectangular obstacle.
    Box,
    /// A rod with round ends.
    Capsule,
    /// A polygon with three corners.
    Triangle,
    /// A polygon with six corners.
    Hexagon,
    /// A generator of random obstacles.
    Generator,
}

impl NewItem {
    /// The shape of a new obstacle; `None` for a generator.
    fn shape(self) -> Option<Shape> {
        Some(match self {
            Self::Circle => Shape::Circle { radius_m: 0.15 },
            Self::Box => Shape::Rectangle { width_m: 0.4, height_m: 0.4 },
            Self::Capsule => Shape::Capsule { length_m: 0.4, radius_m: 0.1 },
            Self::Triangle => regular_polygon(3, 0.25, FRAC_PI_2),
            Self::Hexagon => regular_polygon(6, 0.2, 0.0),
            Self::Generator => return None,
        })
    }
}

impl Editor {
    /// Adds an item at the free position nearest to `near_m`, and selects it.
    pub fn add(&mut self, item: NewItem, near_m: Vec2) {
        let new = match item.shape() {
            Some(shape) => ListItem::Obstacle(Obstacle {
                position_m: free_space::nearest(
                    self.scenario(),
                    near_m,
                    shape.bounding_radius_m(),
                    self.snap,
                ),
                shape,
                rotation_rad: 0.0,
                motion: ObstacleMotion::Static,
            }),
            None => ListItem::Generator(Generator {
                count: 4,
                shape: RandomShape::Circle { radius_m: (0.1, 0.2) },
                gap_m: 0.4,
                within: None,
            }),
        };
        self.append(new);
    }

    /// Appends an item to its list, and selects it.
    pub(super) fn append(&mut self, item: ListItem) {
        self.step(|scenario, selection| *selection = item.add_to(scenario));
    }
}

/// A regular polygon with its first corner in the direction `first_rad`.
fn regular_polygon(count: u8, radius_m: f32, first_rad: f32) -> Shape {
    let angle = |k: u8| first_rad + f32::from(k) / f32::from(count) * TAU;
    let corner = |k| vec2(to_mm(radius_m * angle(k).cos()), to_mm(radius_m * angle(k).sin()));
    Shape::Polygon { corners_m: (0..count).map(corner).collect() }
}
