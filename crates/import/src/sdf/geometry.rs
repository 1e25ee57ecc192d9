//! The horizontal section of a shape at the height of the LIDAR.

use std::ops::RangeInclusive;

use glam::dvec2;
use roxmltree::Node;
use wayfield_scenario::FileError;

use super::pose::{LEVEL_RAD, Pose};
use super::xml::{XmlFile, children, numbers};
use crate::findings::shown;
use crate::solid::{Outline, Solid};

/// The allowed sizes of shapes, in m, as in a scenario.
const SIZE_M: RangeInclusive<f64> = 0.001..=1000.0;

/// What becomes of a shape.
pub enum Section {
    /// A solid.
    Solid(Solid),
    /// Nothing: it is the ground, is below the ground, or is empty.
    Floor,
    /// Nothing: it is left out, for this reason.
    LeftOut(String),
}

/// The section of the shape in `geometry` at `height_m`.
///
/// # Errors
/// A size is missing, or a number is invalid.
pub fn section(
    file: &XmlFile<'_>,
    geometry: Node<'_, '_>,
    pose: Pose,
    height_m: f64,
) -> Result<Section, FileError> {
    let Some(shape) = geometry.children().find(Node::is_element) else { return Ok(Section::Floor) };
    // The height of the section above the shape's centre.
    let above_m = height_m - pose.height_m;
    let (outline, half_height_m) = match shape.tag_name().name() {
        "empty" => return Ok(Section::Floor),
        "plane" => return plane(file, shape, pose),
        "box" => {
            let [x, y, z] = sizes(file, shape, "size")?;
            (Outline::Rectangle(dvec2(x, y)), z / 2.0)
        }
        "cylinder" => {
            let ([radius], [length]) = (sizes(file, shape, "radius")?, sizes(file, shape, "length")?);
            (Outline::Circle(radius), length / 2.0)
        }
        "capsule" => {
            let ([radius], [length]) = (sizes(file, shape, "radius")?, sizes(file, shape, "length")?);
            let beyond_m = (above_m.abs() - length / 2.0).max(0.0);
            (Outline::Circle(section_radius(radius, beyond_m)), length / 2.0 + radius)
        }
        "sphere" => {
            let [radius] = sizes(file, shape, "radius")?;
            (Outline::Circle(section_radius(radius, above_m)), radius)
        }
        "mesh" => return Ok(Section::LeftOut("meshes are left out".into())),
        _ => return Ok(Section::LeftOut("heightmaps, polylines and other shapes are left out".into())),
    };
    if pose.is_tilted {
        return Ok(Section::LeftOut("rolled or pitched shapes are left out".into()));
    }
    if above_m.abs() >= half_height_m {
        if pose.height_m + half_height_m <= 0.0 {
            return Ok(Section::Floor);
        }
        let side = if above_m > 0.0 { "below" } else { "above" };
        return Ok(Section::LeftOut(format!(
            "shapes {side} the LIDAR, which is at a height of {height_m} m, are left out"
        )));
    }
    Ok(Section::Solid(Solid { outline, centre_m: pose.position_m, yaw_rad: pose.yaw_rad }))
}

/// What becomes of a plane: the ground if it is level and not above the ground.
fn plane(file: &XmlFile<'_>, shape: Node<'_, '_>, pose: Pose) -> Result<Section, FileError> {
    let [x, y, z] = match children(shape, "normal").next() {
        Some(normal) => numbers(file, normal)?,
        None => [0.0, 0.0, 1.0],
    };
    let is_level = !pose.is_tilted && x.abs().max(y.abs()) <= LEVEL_RAD * z.abs();
    if is_level && pose.height_m <= 0.0 {
        return Ok(Section::Floor);
    }
    Ok(Section::LeftOut("planes that are sloping, vertical or above the ground are left out".into()))
}

/// Radius of a sphere's section at a distance from its centre, in m; at least the smallest size of a shape.
fn section_radius(radius_m: f64, distance_m: f64) -> f64 {
    (radius_m * radius_m - distance_m * distance_m).max(0.0).sqrt().max(*SIZE_M.start())
}

/// The sizes in the child element `tag` of a shape.
fn sizes<const N: usize>(file: &XmlFile<'_>, shape: Node<'_, '_>, tag: &str) -> Result<[f64; N], FileError> {
    let kind = shape.tag_name().name();
    let child = shape.children().find(|child| child.tag_name().name() == tag);
    let child = child.ok_or_else(|| file.error(shape, format!("<{kind}> has no <{tag}>; help: add it")))?;
    let values = numbers(file, child)?;
    if !values.iter().all(|value| SIZE_M.contains(value)) {
        let (low, high) = (SIZE_M.start(), SIZE_M.end());
        let message = format!(
            "<{tag}> of the {kind} is `{}`; help: write sizes from {low} to {high} m",
            shown(super::xml::text(child))
        );
        return Err(file.error(child, message));
    }
    Ok(values)
}
