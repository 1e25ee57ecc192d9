//! Image files: figures in the format that a file's name asks for.

use std::ffi::OsStr;
use std::io::Write;
use std::path::Path;

use super::RunError;
use super::output_file::{is_stream, write_atomic};
use crate::report::{DrawError, pdf, raster, resized};

/// The format of an image file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFormat {
    /// Vector graphics for pages and editors.
    Svg,
    /// Pixels.
    Png,
    /// Vector graphics for print.
    Pdf,
}

/// The size of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ImageSize {
    /// The figure's own size; a PNG has that many pixels.
    Screen,
    /// The figure's own size; a PNG has four times as many pixels in each direction, enough for print.
    Print,
    /// Width and height in pixels, 96 per inch in a PDF. The figure is scaled to fit.
    Pixels(u32, u32),
}

impl ImageFormat {
    /// The format that the extension of `path` names. A device or a pipe without such an extension gets SVG.
    ///
    /// # Errors
    /// The extension is not `svg`, `png` or `pdf`.
    pub fn of(path: &Path) -> Result<Self, RunError> {
        let extension = path.extension().map(OsStr::to_ascii_lowercase);
        match extension.as_ref().and_then(|extension| extension.to_str()) {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            Some("pdf") => Ok(Self::Pdf),
            _ if is_stream(path) => Ok(Self::Svg),
            _ => Err(RunError::invalid_input(
                path,
                "unknown image format; help: give a file name that ends in .svg, .png or .pdf",
            )),
        }
    }

    /// The contents of an image file of this format that shows the figure `svg`.
    fn encode(self, svg: String, size: ImageSize) -> Result<Vec<u8>, DrawError> {
        let (svg, scale) = match size {
            ImageSize::Screen => (svg, 1.0),
            ImageSize::Print => (svg, 4.0),
            ImageSize::Pixels(width, height) => (resized(&svg, (width, height)), 1.0),
        };
        match self {
            Self::Svg => Ok(svg.into_bytes()),
            Self::Png => raster::png(&svg, scale),
            Self::Pdf => pdf::pdf(&svg),
        }
    }
}

/// Writes the figure `svg` to `path`, in the format that its extension names.
///
/// # Errors
/// The extension names no format, the figure cannot be converted, or the file cannot be written.
pub fn write(svg: String, size: ImageSize, path: &Path) -> Result<(), RunError> {
    let bytes = ImageFormat::of(path)?.encode(svg, size).map_err(|error| RunError::failed(path, error))?;
    write_atomic(path, |file| file.write_all(&bytes)).map_err(|error| RunError::not_written(path, error))
}

#[cfg(test)]
mod tests {
    use crate::run::scenario_image;
    use crate::scenario::Scenario;

    #[test]
    fn the_extension_decides_the_format() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |name: &str| folder.path().join(name);
        let draw = |name: &str| scenario_image::draw(&Scenario::default(), &file(name));
        for (name, first) in [("a.svg", &b"<svg"[..]), ("b.PNG", b"\x89PNG"), ("c.pdf", b"%PDF-")] {
            draw(name).expect("is drawn");
            let bytes = std::fs::read(file(name)).expect("is there");
            assert!(bytes.starts_with(first), "{name}");
        }
        let error = draw("d.gif").expect_err("no such format");
        assert_eq!(error.exit_status(), 2);
        let expected = "d.gif: unknown image format; help: give a file name that ends in .svg, .png or .pdf";
        assert!(error.to_string().ends_with(expected), "{error}");
        assert!(!file("d.gif").exists());
        let error = draw("no/e.svg").expect_err("the folder is missing");
        assert!(error.to_string().contains("can't be written"), "{error}");
    }
}
