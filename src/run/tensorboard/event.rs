//! The format of event files, for scalars.
//!
//! It has two thin layers. An *event* is a protobuf message with four fields; a *record* frames it with its length and two
//! masked CRC-32C checksums. Both are written by hand: the crates for them are unmaintained, and depend on a protobuf runtime
//! and an image codec that scalars don't need.

use std::io::{self, ErrorKind, Read};

use wayfield_protobuf::{Message, Reader};

/// The maximum length of an event in bytes. This program's events are far shorter.
const MAX_EVENT_BYTES: u64 = 1 << 16;
/// The length of a record without its event, in bytes.
pub const FRAME_BYTES: u64 = 16;

// Field numbers in `Event`, `Summary` and `Summary.Value` in TensorFlow's event.proto and summary.proto.
const WALL_TIME: u32 = 1;
const STEP: u32 = 2;
const FILE_VERSION: u32 = 3;
const SUMMARY: u32 = 5;
const SUMMARY_VALUE: u32 = 1;
const VALUE_TAG: u32 = 1;
const VALUE_SIMPLE: u32 = 2;

/// The first event of a file, written at `wall_s` in s since 1970.
pub fn version(wall_s: f64) -> Vec<u8> {
    let mut event = Message::default();
    event.double(WALL_TIME, wall_s).text(FILE_VERSION, "brain.Event:2");
    event.into_bytes()
}

/// The event of a scalar.
pub fn scalar(wall_s: f64, tag: &str, step: u64, value: f32) -> Vec<u8> {
    let [mut point, mut summary, mut event] = <[Message; 3]>::default();
    point.text(VALUE_TAG, tag).float(VALUE_SIMPLE, value);
    summary.message(SUMMARY_VALUE, &point);
    event.double(WALL_TIME, wall_s).uint(STEP, step).message(SUMMARY, &summary);
    event.into_bytes()
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

/// A point of a curve, without its value.
#[derive(Debug, PartialEq)]
pub struct Point<'a> {
    /// Wall time in s since 1970.
    pub wall_s: f64,
    /// The name of the curve.
    pub tag: &'a str,
    /// The position on the horizontal axis.
    pub step: u64,
}

/// The point in an event that [`scalar`] wrote; `None` if it is another event, or its time is not finite.
pub fn point(event: &[u8]) -> Option<Point<'_>> {
    let mut event = Reader::new(event);
    let wall_s = event.double(WALL_TIME)?;
    let step = event.uint(STEP)?;
    let tag = event.message(SUMMARY)?.message(SUMMARY_VALUE)?.bytes(VALUE_TAG)?;
    wall_s.is_finite().then_some(())?;
    Some(Point { wall_s, tag: std::str::from_utf8(tag).ok()?, step })
}

/// The masked CRC-32C of TensorFlow's record format. The mask is needed because a CRC over data that contains its
/// own CRC is weak.
pub fn masked_crc(data: &[u8]) -> u32 {
    crc32c::crc32c(data).rotate_right(15).wrapping_add(0xA282_EAD8)
}
