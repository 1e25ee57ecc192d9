//! The description of a map of ROS's `map_server`: a few YAML keys.
//!
//! In: the text of the `.yaml` file. Out: [`MapFile`], or an error with line and column. Keys that `map_server` does not read
//! are ignored. A value is on one line; the list of `origin` may also extend over several lines.

use std::path::Path;

use wayfield_scenario::FileError;

use crate::findings::shown;
use crate::limits::{COORDINATE_M, RESOLUTION_M};

/// The description of a `map_server` map.
#[derive(Clone, Debug, PartialEq)]
pub struct MapFile {
    /// The path of the image, as written in the file.
    pub image: String,
    /// Byte offset of `image` in the file, for messages.
    pub image_at: usize,
    /// Side of a pixel in m.
    pub resolution_m: f64,
    /// Pose of the lower left corner of the image in the map's frame: x and y in m, yaw in rad.
    pub origin: [f64; 3],
    /// How to read the pixels.
    pub reading: PixelReading,
}

/// How brightness becomes occupancy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelReading {
    /// Whether white is occupied. Otherwise black is.
    pub negate: bool,
    /// Least occupancy, 0 to 1, of an occupied cell.
    pub occupied: f64,
    /// Largest occupancy, 0 to 1, of a free cell.
    pub free: f64,
    /// The mode.
    pub mode: MapMode,
}

/// The three modes of `map_server`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapMode {
    /// Free, occupied, or, between the thresholds, unknown.
    Trinary,
    /// Like [`MapMode::Trinary`], but with a probability between the thresholds.
    Scale,
    /// The pixel is the occupancy in percent; values above 100 are unknown.
    Raw,
}

impl PixelReading {
    /// The reading of a plain image: dark is occupied.
    pub const IMAGE: Self = Self { negate: false, occupied: 0.5, free: 0.5, mode: MapMode::Trinary };

    /// Whether a cell of this brightness, 0 to 255, is free. All other cells count as walls: occupied, unknown, and in the mode
    /// `scale` those between the thresholds. As in Nav2's `map_server`, occupancy is f32, and a cell at both thresholds is free.
    pub fn is_free(self, brightness: u8) -> bool {
        if self.mode == MapMode::Raw {
            return brightness <= 100 && f64::from(brightness) / 100.0 <= self.free;
        }
        let bright = f32::from(brightness) / 255.0;
        let occupancy = if self.negate { bright } else { 1.0 - bright };
        f64::from(occupancy) <= self.free
    }
}

impl MapFile {
    /// The map that `text` describes. Errors name `path`.
    ///
    /// # Errors
    /// A key is missing, or has a value that `map_server` or the limits do not allow.
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        let keys = Keys { text, path, entries: entries(text) };
        let image = keys.required("image", "name the image, such as `image: map.pgm`")?;
        if image.text.is_empty() {
            return Err(keys.error(&image, "names no image; help: name it, such as `image: map.pgm`"));
        }
        let resolution_m = keys.number(
            "resolution",
            "write the side of a pixel in m, such as `resolution: 0.05`",
            RESOLUTION_M,
        )?;
        let fraction = |key: &str, usual: f64| {
            let help = format!("write a fraction from 0 to 1, such as `{key}: {usual}`");
            keys.number(key, &help, 0.0..=1.0)
        };
        let (occupied, free) = (fraction("occupied_thresh", 0.65)?, fraction("free_thresh", 0.196)?);
        if free > occupied {
            let entry = keys.required("free_thresh", "")?;
            let message = format!("is {free}, more than occupied_thresh, {occupied}; help: swap them");
            return Err(keys.error(&entry, message));
        }
        let reading = PixelReading { negate: keys.negate()?, occupied, free, mode: keys.mode()? };
        let image_at = image.at;
        Ok(Self { image: image.text, image_at, resolution_m, origin: keys.origin()?, reading })
    }
}

/// A key with its value.
#[derive(Clone, Debug)]
struct Entry {
    key: String,
    /// The value without quotes and comments. The lines of a list are joined with commas.
    text: String,
    /// Byte offset of the value.
    at: usize,
}

/// The keys of a file.
struct Keys<'a> {
    text: &'a str,
    path: &'a Path,
    entries: Vec<Entry>,
}

impl Keys<'_> {
    fn find(&self, key: &str) -> Option<Entry> {
        // As in most YAML readers, the last of several equal keys wins.
        self.entries.iter().rev().find(|entry| entry.key == key).cloned()
    }

    fn required(&self, key: &str, help: &str) -> Result<Entry, FileError> {
        let missing = || FileError::for_file(self.path, format!("`{key}` is missing; help: {help}"));
        self.find(key).ok_or_else(missing)
    }

    fn error(&self, entry: &Entry, message: impl std::fmt::Display) -> FileError {
        FileError::at_offset(self.path, self.text, entry.at, format!("`{}` {message}", entry.key))
    }

    fn number(&self, key: &str, help: &str, range: std::ops::RangeInclusive<f64>) -> Result<f64, FileError> {
        let entry = self.required(key, help)?;
        let wrong = || {
            let (low, high) = (range.start(), range.end());
            self.error(
                &entry,
                format!("is {}, not a number from {low} to {high}; help: {help}", shown(&entry.text)),
            )
        };
        number(&entry.text).filter(|value| range.contains(value)).ok_or_else(wrong)
    }

    fn origin(&self) -> Result<[f64; 3], FileError> {
        const HELP: &str =
            "write x, y and yaw of the image's lower left corner, such as `origin: [-10.0, -10.0, 0.0]`";
        let entry = self.required("origin", HELP)?;
        let inner = entry.text.trim_start_matches('[').trim_end_matches(']');
        let parts: Option<Vec<f64>> = inner.split(',').map(|part| number(part.trim())).collect();
        let valid = parts.filter(|parts| parts.iter().all(|part| COORDINATE_M.contains(part)));
        let Some([x, y, yaw]) = valid.as_deref() else {
            let (low, high) = (COORDINATE_M.start(), COORDINATE_M.end());
            let message =
                format!("is {}, not three numbers from {low} to {high}; help: {HELP}", shown(&entry.text));
            return Err(self.error(&entry, message));
        };
        Ok([*x, *y, *yaw])
    }

    fn negate(&self) -> Result<bool, FileError> {
        const HELP: &str = "write 0 if black is occupied, 1 if white is";
        let entry = self.required("negate", HELP)?;
        match entry.text.to_ascii_lowercase().as_str() {
            "true" | "yes" | "on" | "y" => Ok(true),
            "false" | "no" | "off" | "n" => Ok(false),
            text => match text.parse::<i64>() {
                Ok(number) => Ok(number != 0),
                Err(_) => {
                    Err(self.error(&entry, format!("is {}, not 0 or 1; help: {HELP}", shown(&entry.text))))
                }
            },
        }
    }

    fn mode(&self) -> Result<MapMode, FileError> {
        let Some(entry) = self.find("mode") else { return Ok(MapMode::Trinary) };
        match entry.text.as_str() {
            "trinary" => Ok(MapMode::Trinary),
            "scale" => Ok(MapMode::Scale),
            "raw" => Ok(MapMode::Raw),
            text => Err(self.error(&entry, format!("is {}; help: write trinary, scale or raw", shown(text)))),
        }
    }
}

/// `text` as a finite number; `None` if it is not one.
fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|value: &f64| value.is_finite())
}

/// The keys at the start of lines, with their values.
fn entries(text: &str) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let (content, offset) = (without_comment(line).trim_end(), at);
        at += line.len();
        let indent = content.len() - content.trim_start().len();
        let item = content.trim_start().strip_prefix("- ");
        if let (Some(item), Some(entry)) = (item, entries.last_mut()) {
            if !entry.text.is_empty() {
                entry.text.push_str(", ");
            } else {
                entry.at = offset + indent;
            }
            entry.text.push_str(item.trim());
        } else if let Some(entry) = entries.last_mut().filter(|entry| is_open(&entry.text)) {
            entry.text.push_str(content.trim());
        } else if let Some((key, value)) = content.split_once(':').filter(|_| indent == 0) {
            let start = offset + key.len() + 1 + (value.len() - value.trim_start().len());
            // Some editors begin a file with a byte order mark.
            let key = unquoted(key.trim_start_matches('\u{feff}'));
            entries.push(Entry { key: key.into(), text: unquoted(value).into(), at: start });
        }
    }
    entries
}

/// Whether `text` is a list in brackets that continues on the next line.
fn is_open(text: &str) -> bool {
    text.starts_with('[') && !text.ends_with(']')
}

/// `line` without its comment, which starts with a `#` outside of quotes, at the start of the line or after a space.
fn without_comment(line: &str) -> &str {
    let mut quote = None;
    let mut before = ' ';
    for (k, c) in line.char_indices() {
        match (quote, c) {
            (None, '#') if before.is_whitespace() => return &line[..k],
            // After a letter or digit, it is an apostrophe.
            (None, '"' | '\'') if !before.is_alphanumeric() => quote = Some(c),
            (Some(open), c) if c == open => quote = None,
            _ => {}
        }
        before = c;
    }
    line
}

/// `text` without spaces around it and without its quotes.
fn unquoted(text: &str) -> &str {
    let text = text.trim();
    let inner = |quote: char| text.strip_prefix(quote)?.strip_suffix(quote);
    inner('"').or_else(|| inner('\'')).unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAP: &str = "image: map.pgm\nresolution: 0.05\norigin: [-10, 2.5, 0.1]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

    fn parse(text: &str) -> Result<MapFile, String> {
        MapFile::parse(text, Path::new("map.yaml")).map_err(|error| error.to_string())
    }

    #[test]
    fn the_keys_of_map_server_are_read_in_all_their_spellings() {
        let map = parse(MAP).expect("a valid map");
        assert_eq!((map.image.as_str(), map.resolution_m, map.origin), ("map.pgm", 0.05, [-10.0, 2.5, 0.1]));
        assert_eq!(map.reading.mode, MapMode::Trinary);
        let other = "# made by hand\n---\nmode: \"scale\"\nimage: 'a #1.png' # a comment\nresolution: 5e-2\norigin:\n- -10\n- 2.5\n- 0.1\n\
            negate: true\noccupied_thresh: .65\nfree_thresh: 1.96e-1\nextra: {a: 1}\n";
        let map = parse(other).expect("a valid map");
        assert_eq!((map.image.as_str(), map.origin), ("a #1.png", [-10.0, 2.5, 0.1]));
        assert_eq!((map.reading.negate, map.reading.mode), (true, MapMode::Scale));
        let lines = MAP.replace("[-10, 2.5, 0.1]", "[-10,\n  2.5,\n  0.1]");
        assert_eq!(parse(&lines).expect("a valid map").origin, [-10.0, 2.5, 0.1]);
        assert_eq!(parse(&format!("\u{feff}{MAP}")).expect("a valid map").image, "map.pgm");
        let apostrophe = MAP.replace("map.pgm", "bob's.pgm # a comment");
        assert_eq!(parse(&apostrophe).expect("a valid map").image, "bob's.pgm");
    }

    #[test]
    fn invalid_values_are_rejected_with_the_file_and_the_key() {
        for (from, to, expected) in [
            (
                "resolution: 0.05",
                "resolution: 0",
                "map.yaml:2:13: `resolution` is 0, not a number from 0.001 to 10; help: ",
            ),
            ("resolution: 0.05", "resolution: .nan", "map.yaml:2:13: `resolution` is .nan, not a number"),
            ("resolution: 0.05\n", "", "map.yaml: `resolution` is missing; help: "),
            ("[-10, 2.5, 0.1]", "[nan, 0, 0]", "map.yaml:3:9: `origin` is [nan, 0, 0], not three numbers"),
            ("[-10, 2.5, 0.1]", "[0, 0]", "map.yaml:3:9: `origin` is [0, 0], not three numbers"),
            ("negate: 0", "negate: maybe", "map.yaml:4:9: `negate` is maybe, not 0 or 1"),
            ("free_thresh: 0.196", "free_thresh: 0.9", "map.yaml:6:14: `free_thresh` is 0.9, more than"),
            ("image: map.pgm", "image: ''", "map.yaml:1:8: `image` names no image"),
            (
                "negate: 0",
                "negate: 0\nmode: fancy",
                "map.yaml:5:7: `mode` is fancy; help: write trinary, scale or raw",
            ),
        ] {
            let error = parse(&MAP.replace(from, to)).expect_err("invalid");
            assert!(error.starts_with(expected), "{error}");
        }
    }

    #[test]
    fn the_grey_of_unknown_cells_is_free_only_if_the_threshold_exceeds_its_occupancy() {
        let reading = |free| PixelReading { negate: false, occupied: 0.65, free, mode: MapMode::Trinary };
        // A brightness of 205 is an occupancy of 0.19608.
        assert!(!reading(0.196).is_free(205) && reading(0.25).is_free(205));
        assert!(reading(0.196).is_free(254) && !reading(0.196).is_free(0));
        let negated = PixelReading { negate: true, ..reading(0.196) };
        assert!(negated.is_free(0) && !negated.is_free(254));
        let raw = PixelReading { mode: MapMode::Raw, ..reading(0.25) };
        assert!(raw.is_free(0) && raw.is_free(25) && !raw.is_free(26) && !raw.is_free(255));
        let raw = PixelReading { mode: MapMode::Raw, ..reading(0.29) };
        assert!(raw.is_free(29) && !raw.is_free(30), "100 * 0.29 is rounded to less than 29");
    }
}
