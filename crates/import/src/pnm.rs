//! The pixels of a PBM, PGM or PPM file: the formats P1 to P6 of Netpbm.
//!
//! (The crate `image` reads them with a feature that nothing else needs; with it, Bevy would have to be compiled again.)

use crate::limits::MAX_CELLS;

/// A decoded image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PnmImage {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Brightness of every pixel, 0 to 255, row by row from the top.
    pub brightness: Vec<u8>,
}

/// Whether `bytes` start like a file in one of the formats.
pub fn is_pnm(bytes: &[u8]) -> bool {
    matches!(bytes, [b'P', b'1'..=b'6', separator, ..] if separator.is_ascii_whitespace() || *separator == b'#')
}

/// Decodes the image in `bytes`, for which [`is_pnm`] must hold.
///
/// # Errors
/// As a message: the image is incomplete, has an invalid number, or is too large.
pub fn decode(bytes: &[u8]) -> Result<PnmImage, String> {
    let format = bytes.get(1).copied().unwrap_or(0);
    let mut reader = Reader { rest: bytes.get(2..).unwrap_or_default() };
    let (width, height) = (reader.number("the width")?, reader.number("the height")?);
    if width.saturating_mul(height) > MAX_CELLS {
        return Err(too_many_pixels(width, height));
    }
    let is_bitmap = matches!(format, b'1' | b'4');
    let max_value = if is_bitmap { 1 } else { reader.number("the maximum value")? };
    if !(1..=65_535).contains(&max_value) {
        return Err(format!(
            "not a valid image: the maximum value is {max_value}, not 1 to 65535; help: save it again"
        ));
    }
    let samples = width * height * if matches!(format, b'3' | b'6') { 3 } else { 1 };
    let values = match format {
        b'1' => reader.bits(samples)?,
        b'2' | b'3' => (0..samples).map(|_| reader.number("a pixel")).collect::<Result<_, _>>()?,
        b'4' => reader.packed_bits(width, height)?,
        _ => reader.binary(samples, max_value)?,
    };
    let bright = |value: usize| ((value.min(max_value) * 255 + max_value / 2) / max_value) as u8;
    let brightness = match format {
        // In a bitmap, 1 is black.
        b'1' | b'4' => values.into_iter().map(|bit| if bit == 0 { 255 } else { 0 }).collect(),
        b'3' | b'6' => {
            values.chunks_exact(3).map(|pixel| luma([0, 1, 2].map(|k| bright(pixel[k])))).collect()
        }
        _ => values.into_iter().map(bright).collect(),
    };
    Ok(PnmImage { width, height, brightness })
}

/// The message about an image that is too large.
pub fn too_many_pixels(width: usize, height: usize) -> String {
    format!(
        "{width} x {height} pixels, more than {MAX_CELLS}; help: scale it down, with more metres per pixel"
    )
}

/// Brightness of a colour (ITU-R BT.709).
fn luma([red, green, blue]: [u8; 3]) -> u8 {
    ((2126 * u32::from(red) + 7152 * u32::from(green) + 722 * u32::from(blue) + 5000) / 10_000) as u8
}

fn incomplete() -> String {
    "not a complete image: it ends too early; help: save it again".into()
}

/// The part of a file that is still to be read.
struct Reader<'a> {
    rest: &'a [u8],
}

impl Reader<'_> {
    /// Reads the next number, after spaces and comments.
    fn number(&mut self, what: &str) -> Result<usize, String> {
        self.skip_spaces();
        let digits = self.rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let (number, rest) = self.rest.split_at(digits);
        self.rest = rest;
        let problem = match std::str::from_utf8(number).unwrap_or_default() {
            "" if rest.is_empty() => return Err(incomplete()),
            "" => "is not a number",
            digits => match digits.parse() {
                Ok(number) => return Ok(number),
                Err(_) => "is too large",
            },
        };
        Err(format!("not a valid image: {what} {problem}; help: save it again"))
    }

    fn skip_spaces(&mut self) {
        while let [first, rest @ ..] = self.rest {
            match first {
                b'#' => self.rest = &self.rest[self.rest.iter().take_while(|&&byte| byte != b'\n').count()..],
                first if first.is_ascii_whitespace() => self.rest = rest,
                _ => return,
            }
        }
    }

    /// Reads `count` digits 0 or 1, with or without spaces between them.
    fn bits(&mut self, count: usize) -> Result<Vec<usize>, String> {
        let bit = |_| {
            self.skip_spaces();
            let (&first, rest) = self.rest.split_first().ok_or_else(incomplete)?;
            self.rest = rest;
            match first {
                b'0' => Ok(0),
                b'1' => Ok(1),
                _ => Err("not a valid image: a pixel is not 0 or 1; help: save it again".to_owned()),
            }
        };
        (0..count).map(bit).collect()
    }

    /// Reads one bit per pixel, the most significant first, in rows of whole bytes, after one byte of white space.
    fn packed_bits(&mut self, width: usize, height: usize) -> Result<Vec<usize>, String> {
        let row_bytes = width.div_ceil(8);
        let data =
            self.rest.get(1..).and_then(|data| data.get(..row_bytes * height)).ok_or_else(incomplete)?;
        let bit = |row: &[u8], x: usize| usize::from(row[x / 8] >> (7 - x % 8) & 1);
        Ok(data.chunks_exact(row_bytes.max(1)).flat_map(|row| (0..width).map(move |x| bit(row, x))).collect())
    }

    /// Reads samples after one byte of white space: one byte each, or two if `max_value` needs them, big-endian.
    fn binary(&mut self, count: usize, max_value: usize) -> Result<Vec<usize>, String> {
        let size = if max_value > 255 { 2 } else { 1 };
        let data = self.rest.get(1..).and_then(|data| data.get(..count * size)).ok_or_else(incomplete)?;
        let sample = |part: &[u8]| part.iter().fold(0, |value, &byte| value * 256 + usize::from(byte));
        Ok(data.chunks_exact(size).map(sample).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_six_formats_are_read() {
        for (bytes, expected) in [
            (&b"P1\n2 2\n10\n0 1"[..], [0, 255, 255, 0]),
            (b"P2 #c\n2 2 # white\n100\n0 50 100 25", [0, 128, 255, 64]),
            (b"P3\n2 2\n255\n0 0 0 255 255 255 255 0 0 0 0 255", [0, 255, 54, 18]),
            (b"P4\n2 2\n\x80\x40", [0, 255, 255, 0]),
            (b"P5\n# CREATOR: by hand\n2 2\n255\n\x00\x80\xff\x01", [0, 128, 255, 1]),
            (b"P5\n2 2\n1000\n\x00\x00\x01\xf4\x03\xe8\x00\x04", [0, 128, 255, 1]),
            (b"P6\n2 2\n255\n\0\0\0\xff\xff\xff\xff\0\0\0\0\xff", [0, 255, 54, 18]),
        ] {
            let image = decode(bytes).expect("a valid image");
            assert_eq!((image.width, image.height), (2, 2));
            assert_eq!(image.brightness, expected, "{}", String::from_utf8_lossy(bytes));
        }
    }

    #[test]
    fn every_cut_off_or_invalid_file_is_an_error() {
        let whole = b"P5\n3 2\n255\n123456";
        for length in 3..whole.len() {
            assert!(decode(&whole[..length]).is_err(), "{length} bytes");
        }
        assert!(decode(whole).is_ok());
        for bytes in [
            &b"P2\n2 2\n0\n0 0 0 0"[..],
            b"P2\n2 2\n99999\n0 0 0 0",
            b"P5\n-1 2\n255\n",
            b"P5\nx",
            b"P1\n2 1\n0x",
        ] {
            assert!(decode(bytes).is_err(), "{}", String::from_utf8_lossy(bytes));
        }
        let error = decode(b"P5\n99999999999999999999999 2\n255\n").expect_err("2^64 is less");
        assert_eq!(error, "not a valid image: the width is too large; help: save it again");
    }
}
