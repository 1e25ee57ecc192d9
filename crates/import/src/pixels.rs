//! The pixels of a PNG or PNM file.
//!
//! In: a path, or the bytes of a file. Out: brightness and opacity of every pixel, with row 0 at the bottom. The size is
//! checked before anything is decoded, so that a small file cannot ask for much memory.

use std::io::{Cursor, ErrorKind};
use std::path::Path;

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use wayfield_scenario::{FileError, is_special_file, read_bytes};

use crate::grid::Grid;
use crate::limits::{MAX_CELLS, MAX_IMAGE_BYTES};
use crate::pnm;

/// The brightness of every pixel, 0 to 255; `None` if it is not opaque.
pub type Pixels = Grid<Option<u8>>;

const FORMATS: &str = "give a PGM, PPM, PBM or PNG file";

/// Reads the pixels of the image at `path`.
///
/// # Errors
/// The file is missing, is not an image in one of the formats, is incomplete, or is too large.
pub fn read(path: &Path) -> Result<Pixels, FileError> {
    let fail = |message: String| FileError::for_file(path, message);
    if is_special_file(path) {
        return Err(fail(format!("it is a device or a pipe; help: {FORMATS}")));
    }
    let bytes = read_bytes(path, MAX_IMAGE_BYTES + 1).map_err(|error| match error.kind() {
        ErrorKind::NotFound => fail("no such file".into()),
        ErrorKind::IsADirectory => fail(format!("this is a folder; help: {FORMATS}")),
        _ => fail(format!("can't be read: {error}")),
    })?;
    if bytes.len() as u64 > MAX_IMAGE_BYTES {
        return Err(fail(format!("larger than {} MiB, the limit for images", MAX_IMAGE_BYTES >> 20)));
    }
    decode(&bytes).map_err(fail)
}

/// Decodes the pixels of the image in `bytes`.
///
/// # Errors
/// As a message: the image is not in one of the formats, is incomplete, or is too large.
pub fn decode(bytes: &[u8]) -> Result<Pixels, String> {
    if pnm::is_pnm(bytes) {
        let image = pnm::decode(bytes)?;
        return Ok(upright(image.width, &image.brightness, |&brightness| Some(brightness)));
    }
    if !matches!(image::guess_format(bytes), Ok(ImageFormat::Png)) {
        return Err(format!("not an image that can be read; help: {FORMATS}"));
    }
    let broken = |error: image::ImageError| format!("not a complete image: {error}; help: save it again");
    let mut reader = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png);
    let mut limits = Limits::default();
    limits.max_alloc = Some(16 * MAX_CELLS as u64);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let (columns, rows) = (width as usize, height as usize);
    if columns.saturating_mul(rows) > MAX_CELLS {
        return Err(pnm::too_many_pixels(columns, rows));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(broken)?.into_luma_alpha8();
    let pixels: Vec<_> = image.pixels().collect();
    Ok(upright(columns, &pixels, |pixel| (pixel.0[1] == u8::MAX).then_some(pixel.0[0])))
}

/// The grid of an image whose rows of `columns` pixels are given from the top.
fn upright<T>(columns: usize, from_above: &[T], pixel: impl Fn(&T) -> Option<u8>) -> Pixels {
    let rows = from_above.chunks(columns.max(1));
    let count = rows.len();
    Grid { columns, rows: count, values: rows.rev().flatten().map(pixel).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_flipped_and_levels_scaled() {
        let pixels = decode(b"P2\n# CREATOR: by hand\n2 2\n100\n0 50\n100 100\n").expect("a valid image");
        assert_eq!(pixels.values, [Some(255), Some(255), Some(0), Some(128)]);
        let bits = decode(b"P1\n2 1\n1 0\n").expect("a valid image");
        assert_eq!(bits.values, [Some(0), Some(255)]);
    }

    #[test]
    fn incomplete_and_foreign_files_are_errors_and_huge_ones_are_not_decoded() {
        let half_a_png = |width: u32, height: u32| {
            let mut file = Cursor::new(Vec::new());
            image::GrayImage::new(width, height).write_to(&mut file, ImageFormat::Png).expect("encoded");
            let mut bytes = file.into_inner();
            bytes.truncate(bytes.len() / 2);
            bytes
        };
        let (small, huge) = (half_a_png(64, 64), half_a_png(8192, 1025));
        for (bytes, expected) in [
            (&b"P5\n4 4\n255\n\0\0\0"[..], "not a complete image: "),
            (b"P5\n400000 400000\n255\n", "400000 x 400000 pixels, more than 8388608; help: "),
            (b"P5\n4 4\n", "not a complete image: "),
            (&small[..], "not a complete image: "),
            (&huge[..], "8192 x 1025 pixels, more than 8388608; help: "),
            (b"GIF89a......", "not an image that can be read; help: give a PGM, PPM, PBM or PNG file"),
            (b"", "not an image that can be read; help: "),
        ] {
            let error = decode(bytes).expect_err("invalid");
            assert!(error.starts_with(expected), "{error}");
        }
    }
}
