//! The format of event files, for scalars.
//!
//! It has two thin layers. An *event* is a protobuf message with four fields; a *record* frames it with its length and two
//! masked CRC-32C checksums. Both are written by hand: the crates for it are unmaintained, and depend on a protobuf runtime and
//! an image codec that scalars don't need.

use std::io::{self, ErrorKind, Read};

/// The maximum length of an event in bytes. This program's events are far shorter.
const MAX_EVENT_BYTES: u64 = 1 << 16;
/// The length of a record without its event, in bytes.
pub const FRAME_BYTES: u64 = 16;

// Field numbers in `Event`, `Summary` and `Summary.Value` in TensorFlow's event.proto and summary.proto.
const WALL_TIME: u8 = 1;
const STEP: u8 = 2;
const FILE_VERSION: u8 = 3;
const SUMMARY: u8 = 5;
const SUMMARY_VALUE: u8 = 1;
const VALUE_TAG: u8 = 1;
const VALUE_SIMPLE: u8 = 2;

// Wire types.
const VARINT: u8 = 0;
const FIXED64: u8 = 1;
const BYTES: u8 = 2;
const FIXED32: u8 = 5;

/// The first event of a file, written at `wall_s` in s since 1970.
pub fn version(wall_s: f64) -> Vec<u8> {
    let mut event = Message::event(wall_s);
    event.bytes(FILE_VERSION, b"brain.Event:2");
    event.0
}

/// The event of a scalar.
pub fn scalar(wall_s: f64, tag: &str, step: u64, value: f32) -> Vec<u8> {
    let mut point = Message::default();
    point.bytes(VALUE_TAG, tag.as_bytes());
    point.key(VALUE_SIMPLE, FIXED32);
    point.0.extend(value.to_le_bytes());
    let mut summary = Message::default();
    summary.bytes(SUMMARY_VALUE, &point.0);
    let mut event = Message::event(wall_s);
    event.key(STEP, VARINT);
    event.varint(step);
    event.bytes(SUMMARY, &summary.0);
    event.0
}

/// The record of an event.
pub fn record(event: &[u8]) -> Vec<u8> {
    let length = (event.len() as u64).to_le_bytes();
    let checksum = |data| masked_crc(data).to_le_bytes();
    [&length[..], &checksum(&length), event, &checksum(event)].concat()
}

/// Reads the event of the next record; `None` at the end of the file, and where the file is damaged.
pub fn read(file: &mut impl Read) -> io::Result<Option<Vec<u8>>> {
    match read_valid(file) {
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => Ok(None),
        read => read,
    }
}

fn read_valid(file: &mut impl Read) -> io::Result<Option<Vec<u8>>> {
    let (mut length, mut checksum) = ([0; 8], [0; 4]);
    file.read_exact(&mut length)?;
    file.read_exact(&mut checksum)?;
    let bytes = u64::from_le_bytes(length);
    if checksum != masked_crc(&length).to_le_bytes() || bytes > MAX_EVENT_BYTES {
        return Ok(None);
    }
    let mut event = vec![0; bytes as usize];
    file.read_exact(&mut event)?;
    file.read_exact(&mut checksum)?;
    Ok((checksum == masked_crc(&event).to_le_bytes()).then_some(event))
}

/// The place of a scalar in its curve.
#[derive(Debug, PartialEq)]
pub struct Point<'a> {
    /// Wall time in s since 1970.
    pub wall_s: f64,
    /// The name of the curve.
    pub tag: &'a str,
    /// The horizontal axis.
    pub step: u64,
}

/// The point in an event that [`scalar`] wrote; `None` if it is another event, or its time is not finite.
pub fn point(event: &[u8]) -> Option<Point<'_>> {
    let mut event = Reader(event);
    event.expect(WALL_TIME, FIXED64)?;
    let wall_s = f64::from_le_bytes(event.take(8)?.try_into().ok()?);
    event.expect(STEP, VARINT)?;
    let step = event.varint()?;
    let mut summary = event.message(SUMMARY)?;
    let mut value = summary.message(SUMMARY_VALUE)?;
    let tag = value.message(VALUE_TAG)?;
    wall_s.is_finite().then_some(())?;
    Some(Point { wall_s, tag: std::str::from_utf8(tag.0).ok()?, step })
}

/// A protobuf message under construction: each field is its key (number and wire type), then its content.
#[derive(Default)]
struct Message(Vec<u8>);

impl Message {
    fn event(wall_s: f64) -> Self {
        let mut event = Self::default();
        event.key(WALL_TIME, FIXED64);
        event.0.extend(wall_s.to_le_bytes());
        event
    }

    fn key(&mut self, field: u8, wire_type: u8) {
        self.0.push(field << 3 | wire_type);
    }

    fn bytes(&mut self, field: u8, value: &[u8]) {
        self.key(field, BYTES);
        self.varint(value.len() as u64);
        self.0.extend(value);
    }

    /// Seven bits per byte, lowest first; the high bit is set on all bytes but the last.
    fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
    }
}

/// The rest of a protobuf message that is read.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, bytes: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(bytes)?;
        self.0 = rest;
        Some(taken)
    }

    /// Takes the key of a field.
    fn expect(&mut self, field: u8, wire_type: u8) -> Option<()> {
        (self.take(1)? == [field << 3 | wire_type]).then_some(())
    }

    fn message(&mut self, field: u8) -> Option<Self> {
        self.expect(field, BYTES)?;
        let length = self.varint()?;
        self.take(usize::try_from(length).ok()?).map(Self)
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = *self.take(1)?.first()?;
            value |= u64::from(byte & 0x7F) << shift;
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }
}

/// The masked CRC-32C of TensorFlow's record format. The mask is needed because a CRC over data that contains its
/// own CRC is weak.
pub fn masked_crc(data: &[u8]) -> u32 {
    crc32c::crc32c(data).rotate_right(15).wrapping_add(0xA282_EAD8)
}
