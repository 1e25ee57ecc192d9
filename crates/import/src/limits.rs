//! The limits of imported files and of the numbers in them.

use std::ops::RangeInclusive;

/// Largest picture file, in bytes.
pub const MAX_PICTURE_BYTES: u64 = 1 << 26;
/// Most pixels of a picture, or cells of the grid over an SDF world.
pub const MAX_CELLS: usize = 1 << 23;
/// Most corners of one outline of a map's floor.
pub const MAX_RING_CORNERS: usize = 50_000;
/// Largest SDF or JSON file, in bytes; also of all included models together.
pub const MAX_WORLD_BYTES: u64 = 1 << 25;
/// Most elements of an XML file, with texts and attributes.
pub const MAX_XML_NODES: u32 = 1 << 20;
/// Deepest nesting of models in models.
pub const MAX_MODEL_NESTING: usize = 8;
/// Most models that a world includes.
pub const MAX_INCLUDES: usize = 1_000;
/// Side of a map's cell, in m.
pub const RESOLUTION_M: RangeInclusive<f64> = 0.001..=10.0;
/// Coordinates in an imported file, in m.
pub const COORDINATE_M: RangeInclusive<f64> = -1e6..=1e6;
/// Tolerance of the simplification of walls, in m.
pub const TOLERANCE_M: RangeInclusive<f64> = 0.0..=10.0;
/// Height of the LIDAR above the ground, in m.
pub const LIDAR_HEIGHT_M: RangeInclusive<f64> = 0.0..=10.0;
