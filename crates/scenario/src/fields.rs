//! Descriptions of the fields of shapes and motions. The range checks and the app's editor are built from them.
//!
//! In: a shape or a motion ([`Shape::fields_mut`](super::Shape::fields_mut),
//! [`ObstacleMotion::fields_mut`](super::ObstacleMotion::fields_mut)). Out: its fields, with names, texts, units, ranges and
//! references to their values.

use std::ops::RangeInclusive;

use super::limits::{MAX_ANGULAR_SPEED_RAD_S, MAX_SPEED_M_S, SHAPE_SIZE_M, WALK_RADIUS_M};
use super::ranged::Ranged;
use super::schema::{KeyFrame, KeyFrameEnd};
use glam::Vec2;

/// A field of a shape or a motion, or two fields that are shown together.
#[derive(Debug)]
pub struct Field<'a> {
    /// Names in scenario files, such as `radius_m`: both names of a [`FieldValue::Pair`], otherwise the field's own name,
    /// followed by those of the fields in it.
    pub names: &'static [&'static str],
    /// Name on the screen.
    pub label: &'static str,
    /// Short description; may be empty.
    pub about: &'static str,
    /// The value.
    pub value: FieldValue<'a>,
}

/// The value of a field.
#[derive(Debug)]
pub enum FieldValue<'a> {
    /// A number.
    Number(&'a mut f32, Quantity),
    /// A number or a range.
    Ranged(&'a mut Ranged<f32>, Quantity),
    /// Two numbers of the same quantity.
    Pair([&'a mut f32; 2], Quantity),
    /// The seed of random numbers.
    Seed(&'a mut u32),
    /// A choice between yes and no.
    Flag(&'a mut bool),
    /// The centre of a revolution, in m. An edit that moves the obstacle moves it, too.
    Centre(&'a mut Vec2),
    /// The corners of a path after the obstacle's position, in m. An edit that moves the obstacle moves them, too.
    Waypoints(&'a mut Vec<Vec2>),
    /// The frames of a recorded path, and what happens after the last. An edit that moves the obstacle moves them, too.
    KeyFrames(&'a mut Vec<KeyFrame>, &'a mut KeyFrameEnd),
    /// The corners of a convex polygon in the shape's own frame, in m.
    Corners(&'a mut Vec<Vec2>),
}

/// The quantity that a number measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A size of a shape, in m.
    Size,
    /// The largest distance of an obstacle from its position, in m.
    Reach,
    /// A speed, in m/s.
    Speed,
    /// An angular speed, in rad/s, counterclockwise positive.
    AngularSpeed,
}

impl Quantity {
    /// Smallest and largest valid value.
    #[must_use]
    pub fn range(self) -> RangeInclusive<f32> {
        match self {
            Self::Size => SHAPE_SIZE_M,
            Self::Reach => WALK_RADIUS_M,
            Self::Speed => 0.0..=MAX_SPEED_M_S,
            Self::AngularSpeed => -MAX_ANGULAR_SPEED_RAD_S..=MAX_ANGULAR_SPEED_RAD_S,
        }
    }
}
