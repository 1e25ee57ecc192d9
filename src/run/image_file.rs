//! Image files: the format that a file's name asks for.

use std::ffi::OsStr;
use std::path::Path;

use super::RunError;
use super::output_file::is_stream;
use crate::report::{DrawError, raster};

/// The format of an image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFormat {
    /// Vector graphics.
    Svg,
    /// Pixels.
    Png,
}

impl ImageFormat {
    /// The format that the extension of `path` names. A device or a pipe gets an SVG file.
    ///
    /// # Errors
    /// The extension is neither `svg` nor `png`.
    pub fn of(path: &Path) -> Result<Self, RunError> {
        let extension = path.extension().map(OsStr::to_ascii_lowercase);
        match extension.as_ref().and_then(|extension| extension.to_str()) {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ if is_stream(path) => Ok(Self::Svg),
            _ => Err(RunError::invalid_input(
                path,
                "unknown image format; help: give a file name that ends in .svg or .png",
            )),
        }
    }

    /// The contents of a file with the figure `svg`, for PNG with `scale` pixels per SVG pixel.
    ///
    /// # Errors
    /// `svg` cannot be converted.
    pub fn encode(self, svg: String, scale: f32) -> Result<Vec<u8>, DrawError> {
        match self {
            Self::Svg => Ok(svg.into_bytes()),
            Self::Png => raster::png(&svg, scale),
        }
    }
}
