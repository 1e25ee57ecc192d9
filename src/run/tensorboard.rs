//! The writer of TensorBoard event files, for scalars only.
//!
//! In: a run's scalars, each with a tag and a step. Out: a file `events.out.tfevents.*` in the run folder.
//! TensorBoard plots it while the run is in progress.
//!
//! The format has two thin layers. An *event* is a protobuf message with four fields; a *record* frames it
//! with its length and two masked CRC-32C checksums. Both are written by hand: the crates for it are
//! unmaintained, and depend on a protobuf runtime and an image codec that scalars don't need.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::time::{Duration, SystemTime};

use super::write_points::write_point;

/// A writer of scalars to one event file. Buffered data reaches the file on [`flush`](Self::flush) or on
/// drop.
#[derive(Debug)]
pub struct EventWriter {
    file: BufWriter<File>,
}

impl EventWriter {
    /// Creates `events.out.tfevents.<unix seconds>.wayfield<name_suffix>` in the existing folder `dir`. If
    /// that file exists, a number is appended to the name.
    ///
    /// # Errors
    /// The file cannot be created or written. The message names it.
    pub fn create(dir: &Path, name_suffix: &str) -> io::Result<Self> {
        let name = format!("events.out.tfevents.{}.wayfield{name_suffix}", since_1970().as_secs());
        let mut path = dir.join(&name);
        let mut number = 0_u32;
        let file = loop {
            match File::create_new(&path) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                    number += 1;
                    path = dir.join(format!("{name}.{number}"));
                }
                other => break other,
            }
        }
        .map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", path.display())))?;
        write_point("events: created");

        let mut writer = Self { file: BufWriter::new(file) };
        let mut version = Message::event();
        version.bytes(FILE_VERSION, b"brain.Event:2");
        writer.record(&version.0)?;
        writer.flush()?;
        Ok(writer)
    }

    /// Writes the scalar `tag` (slashes make groups: `loss/mean`) with `value` at `step` (at most 2^63 - 1).
    /// Non-finite values are written too; TensorBoard marks them in the curve.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn scalar(&mut self, tag: &str, step: u64, value: f32) -> io::Result<()> {
        let mut point = Message::default();
        point.bytes(VALUE_TAG, tag.as_bytes());
        point.float(VALUE_SIMPLE, value);
        let mut summary = Message::default();
        summary.bytes(SUMMARY_VALUE, &point.0);
        let mut event = Message::event();
        event.varint(STEP, step);
        event.bytes(SUMMARY, &summary.0);
        self.record(&event.0)
    }

    /// Writes all buffered data to the file, where TensorBoard sees it.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }

    fn record(&mut self, data: &[u8]) -> io::Result<()> {
        let length = (data.len() as u64).to_le_bytes();
        self.file.write_all(&length)?;
        self.file.write_all(&masked_crc(&length).to_le_bytes())?;
        self.file.write_all(data)?;
        self.file.write_all(&masked_crc(data).to_le_bytes())
    }
}

// Field numbers in `Event`, `Summary` and `Summary.Value` in TensorFlow's event.proto and summary.proto.
const WALL_TIME: u64 = 1;
const STEP: u64 = 2;
const FILE_VERSION: u64 = 3;
const SUMMARY: u64 = 5;
const SUMMARY_VALUE: u64 = 1;
const VALUE_TAG: u64 = 1;
const VALUE_SIMPLE: u64 = 2;

/// A protobuf message under construction: each field is its key (number and wire type), then its content.
#[derive(Default)]
struct Message(Vec<u8>);

impl Message {
    /// An `Event` with the current time.
    fn event() -> Self {
        let mut event = Self::default();
        event.raw_varint(WALL_TIME << 3 | 1);
        event.0.extend(since_1970().as_secs_f64().to_le_bytes());
        event
    }

    fn varint(&mut self, field: u64, value: u64) {
        self.raw_varint(field << 3);
        self.raw_varint(value);
    }

    fn bytes(&mut self, field: u64, value: &[u8]) {
        self.raw_varint(field << 3 | 2);
        self.raw_varint(value.len() as u64);
        self.0.extend(value);
    }

    fn float(&mut self, field: u64, value: f32) {
        self.raw_varint(field << 3 | 5);
        self.0.extend(value.to_le_bytes());
    }

    /// Seven bits per byte, lowest first; the high bit is set on all bytes but the last.
    fn raw_varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
    }
}

/// The masked CRC-32C of TensorFlow's record format. The mask is needed because a CRC over data that contains its
/// own CRC is weak.
fn masked_crc(data: &[u8]) -> u32 {
    crc32c::crc32c(data).rotate_right(15).wrapping_add(0xA282_EAD8)
}

fn since_1970() -> Duration {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CRC-32C bit by bit, from its polynomial.
    fn slow_crc(data: &[u8]) -> u32 {
        !data.iter().fold(!0_u32, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |c, _| (c >> 1) ^ (0x82F6_3B78 * (c & 1)))
        })
    }

    /// Removes the first `n` bytes of `data` and returns them.
    fn take<'a>(data: &mut &'a [u8], n: usize) -> &'a [u8] {
        let (head, tail) = data.split_at(n);
        *data = tail;
        head
    }

    fn take_varint(data: &mut &[u8]) -> u64 {
        let mut value = 0;
        for shift in (0..).step_by(7) {
            let byte = take(data, 1)[0];
            value |= u64::from(byte & 0x7F) << shift;
            if byte < 0x80 {
                break;
            }
        }
        value
    }

    /// The fields of a message: number, and content as bytes (a varint as 8 bytes).
    fn fields(mut data: &[u8]) -> Vec<(u64, Vec<u8>)> {
        let mut found = Vec::new();
        while !data.is_empty() {
            let key = take_varint(&mut data);
            let content = match key & 7 {
                0 => take_varint(&mut data).to_le_bytes().to_vec(),
                1 => take(&mut data, 8).to_vec(),
                2 => {
                    let length = take_varint(&mut data);
                    take(&mut data, length as usize).to_vec()
                }
                5 => take(&mut data, 4).to_vec(),
                wire => panic!("wire type {wire}"),
            };
            found.push((key >> 3, content));
        }
        found
    }

    /// The records of a file, with both checksums verified.
    fn records(mut data: &[u8]) -> Vec<Vec<u8>> {
        let unmasked = |bytes: &[u8]| {
            let masked = u32::from_le_bytes(bytes.try_into().expect("4 bytes"));
            masked.wrapping_sub(0xA282_EAD8).rotate_left(15)
        };
        let mut found = Vec::new();
        while !data.is_empty() {
            let length = take(&mut data, 8);
            assert_eq!(unmasked(take(&mut data, 4)), slow_crc(length), "checksum of the length");
            let content = take(&mut data, u64::from_le_bytes(length.try_into().expect("8 bytes")) as usize);
            assert_eq!(unmasked(take(&mut data, 4)), slow_crc(content), "checksum of the content");
            found.push(content.to_vec());
        }
        found
    }

    #[test]
    fn the_checksum_mask_matches_the_format() {
        assert_eq!(slow_crc(b"123456789"), 0xE306_9283, "the check value in CRC catalogues");
        // 0xE3069283 rotated right by 15 bits is 0x2507C60D; plus 0xA282EAD8 that is 0xC78AB0E5.
        assert_eq!(masked_crc(b"123456789"), 0xC78A_B0E5);
    }

    #[test]
    fn written_scalars_can_be_read_back() {
        let dir = tempfile::tempdir().expect("a temporary folder");
        let mut writer = EventWriter::create(dir.path(), ".test").expect("a new file");
        let points = [("episode/return", 0, -1.5_f32), ("loss", 300, 0.25), ("loss", 1 << 40, f32::MAX)];
        for (tag, step, value) in points {
            writer.scalar(tag, step, value).expect("a scalar");
        }
        writer.flush().expect("flushed");

        let entry =
            std::fs::read_dir(dir.path()).expect("the folder").next().expect("one file").expect("is there");
        let name = entry.file_name().into_string().expect("a plain name");
        assert!(name.starts_with("events.out.tfevents.") && name.ends_with(".wayfield.test"), "{name}");
        let records = records(&std::fs::read(entry.path()).expect("the file"));
        assert_eq!(records.len(), 1 + points.len());
        assert_eq!(
            fields(&records[0])[1],
            (3, b"brain.Event:2".to_vec()),
            "the first event holds the version"
        );
        for (record, (tag, step, value)) in records[1..].iter().zip(points) {
            let event = fields(record);
            assert_eq!(event.iter().map(|f| f.0).collect::<Vec<_>>(), [1, 2, 5]);
            let wall = f64::from_le_bytes(event[0].1.clone().try_into().expect("8 bytes"));
            assert!(wall > 1.7e9, "wall time is in seconds since 1970, not {wall}");
            assert_eq!(event[1].1, u64::to_le_bytes(step));
            let summary = fields(&event[2].1);
            assert_eq!((summary.len(), summary[0].0), (1, 1));
            let point = fields(&summary[0].1);
            assert_eq!(point, [(1, tag.as_bytes().to_vec()), (2, value.to_le_bytes().to_vec())]);
        }
    }

    #[test]
    fn a_second_writer_creates_a_new_file() {
        let dir = tempfile::tempdir().expect("a temporary folder");
        for _ in 0..3 {
            EventWriter::create(dir.path(), "").expect("a new file");
        }
        assert_eq!(std::fs::read_dir(dir.path()).expect("the folder").count(), 3);
    }

    #[test]
    fn the_error_for_a_missing_folder_names_it() {
        let error = EventWriter::create(Path::new("/no/such/folder"), "").expect_err("there is no folder");
        assert!(error.to_string().contains("/no/such/folder"), "{error}");
    }
}
