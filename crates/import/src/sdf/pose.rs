//! Poses with a rotation about the vertical axis.

use std::f64::consts::TAU;

use glam::{DVec2, dvec2};
use roxmltree::Node;
use wayfield_scenario::FileError;

use super::xml::{XmlFile, children, is_true, numbers};

/// Roll and pitch up to this, in rad, count as rounding errors.
pub const LEVEL_RAD: f64 = 1e-3;

/// A pose in the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Position in the plane in m.
    pub position_m: DVec2,
    /// Height in m.
    pub height_m: f64,
    /// Rotation about the vertical axis in rad.
    pub yaw_rad: f64,
    /// Whether it, or a pose that it is relative to, is rolled or pitched.
    pub is_tilted: bool,
}

impl Pose {
    /// The composition of this pose with `inner`, which is relative to it.
    pub fn then(self, inner: Self) -> Self {
        Self {
            position_m: self.position_m + DVec2::from_angle(self.yaw_rad).rotate(inner.position_m),
            height_m: self.height_m + inner.height_m,
            yaw_rad: self.yaw_rad + inner.yaw_rad,
            is_tilted: self.is_tilted || inner.is_tilted,
        }
    }
}

/// The pose of an element, zero if it states none. `None` if it is relative to a frame other than its parent's, or its rotation
/// is a quaternion.
///
/// # Errors
/// The numbers are invalid.
pub fn of(file: &XmlFile<'_>, element: Node<'_, '_>) -> Result<Option<Pose>, FileError> {
    match children(element, "pose").next() {
        Some(node) => read(file, node),
        None => Ok(Some(Pose::default())),
    }
}

/// The pose in an element `<pose>`. `None` if it is relative to a frame other than its parent's, or its rotation is a quaternion.
///
/// # Errors
/// The numbers are invalid.
pub fn read(file: &XmlFile<'_>, node: Node<'_, '_>) -> Result<Option<Pose>, FileError> {
    let frame = node.attribute("relative_to").or_else(|| node.attribute("frame")).unwrap_or("");
    let parent = node.parent_element().map_or("", |element| element.tag_name().name());
    let is_relative_to_parent = match frame {
        "" => true,
        // The parent of a collision is its link.
        "__model__" => parent != "collision",
        "world" => matches!(parent, "model" | "include"),
        _ => false,
    };
    let is_quaternion = node.attribute("rotation_format").is_some_and(|format| format != "euler_rpy");
    if !is_relative_to_parent || is_quaternion {
        return Ok(None);
    }
    if super::xml::text(node).is_empty() {
        return Ok(Some(Pose::default()));
    }
    let [x, y, height_m, roll, pitch, yaw] = numbers(file, node)?;
    let unit = if node.attribute("degrees").is_some_and(is_true) { 1_f64.to_radians() } else { 1.0 };
    let is_level = |angle: f64| {
        let turned = angle * unit / TAU;
        (turned - turned.round()).abs() * TAU <= LEVEL_RAD
    };
    let is_tilted = !(is_level(roll) && is_level(pitch));
    Ok(Some(Pose { position_m: dvec2(x, y), height_m, yaw_rad: yaw * unit % TAU, is_tilted }))
}
