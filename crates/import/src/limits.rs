//! The limits of imported files and of the values in them.

use std::ops::RangeInclusive;

/// Maximum size of an image file, in bytes.
pub const MAX_IMAGE_BYTES: u64 = 1 << 26;
/// Maximum number of pixels of an image.
pub const MAX_CELLS: usize = 1 << 23;
/// Maximum number of corners of one outline of a map's free space.
pub const MAX_RING_CORNERS: usize = 50_000;
/// Maximum size of an SDF or JSON file, and of all included models together, in bytes.
pub const MAX_WORLD_BYTES: u64 = 1 << 25;
/// Maximum number of nodes of an XML file: elements, texts and comments, but not attributes.
pub const MAX_XML_NODES: u32 = 1 << 20;
/// Maximum nesting depth of models: how many models may enclose a model, in the same file or through includes.
pub const MAX_MODEL_NESTING: usize = 8;
/// Maximum number of models that a world includes.
pub const MAX_INCLUDES: usize = 1_000;
/// Side of a map's cell, in m.
pub const RESOLUTION_M: RangeInclusive<f64> = 0.001..=10.0;
/// Numbers in an imported file, such as coordinates in m.
pub const COORDINATE_M: RangeInclusive<f64> = -1e6..=1e6;
/// Tolerance of the simplification of walls, in m.
pub const TOLERANCE_M: RangeInclusive<f64> = 0.0..=10.0;
/// Height of the LIDAR above the ground, in m.
pub const LIDAR_HEIGHT_M: RangeInclusive<f64> = 0.0..=10.0;
