//! Protobuf messages, written and read field by field. TensorBoard events and ONNX models need a dozen fields each, which
//! does not justify a protobuf runtime and a schema compiler.
//!
//! ```
//! use wayfield_protobuf::{Message, Reader};
//!
//! let mut point = Message::default();
//! point.text(1, "loss").float(2, 0.5);
//! let mut event = Message::default();
//! event.uint(2, 300).message(5, &point);
//!
//! let bytes = event.into_bytes();
//! let mut reader = Reader::new(&bytes);
//! assert_eq!(reader.uint(2), Some(300));
//! let mut point = reader.message(5).expect("a message");
//! assert_eq!(point.bytes(1), Some(&b"loss"[..]));
//! ```

// Wire types.
const VARINT: u8 = 0;
const FIXED64: u8 = 1;
const BYTES: u8 = 2;
const FIXED32: u8 = 5;

/// A message under construction: each field is its key (number and wire type), then its content. A repeated field is
/// written once per element.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Message(Vec<u8>);

impl Message {
    /// Writes an unsigned integer or an enum.
    pub fn uint(&mut self, field: u32, value: u64) -> &mut Self {
        self.key(field, VARINT).varint(value)
    }

    /// Writes an `int64` or `int32` (in two's complement, not zigzag).
    pub fn int(&mut self, field: u32, value: i64) -> &mut Self {
        self.uint(field, value.cast_unsigned())
    }

    /// Writes a `float`.
    pub fn float(&mut self, field: u32, value: f32) -> &mut Self {
        self.key(field, FIXED32).0.extend(value.to_le_bytes());
        self
    }

    /// Writes a `double`.
    pub fn double(&mut self, field: u32, value: f64) -> &mut Self {
        self.key(field, FIXED64).0.extend(value.to_le_bytes());
        self
    }

    /// Writes `bytes`.
    pub fn bytes(&mut self, field: u32, value: &[u8]) -> &mut Self {
        self.key(field, BYTES).varint(value.len() as u64).0.extend(value);
        self
    }

    /// Writes a `string`.
    pub fn text(&mut self, field: u32, value: &str) -> &mut Self {
        self.bytes(field, value.as_bytes())
    }

    /// Writes a message.
    pub fn message(&mut self, field: u32, value: &Self) -> &mut Self {
        self.bytes(field, &value.0)
    }

    /// The bytes of the message.
    #[must_use]
    pub fn into_bytes(self) -> Vec<u8> {
        self.0
    }

    fn key(&mut self, field: u32, wire_type: u8) -> &mut Self {
        self.varint(u64::from(field) << 3 | u64::from(wire_type))
    }

    /// Writes seven bits per byte, lowest first; the high bit is set on all bytes but the last.
    fn varint(&mut self, mut value: u64) -> &mut Self {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
        self
    }
}

/// A reader of a message whose fields have a known order. Each method takes the next field, and returns `None` if that is
/// another field or the message is damaged. After `None`, the rest of the message cannot be read.
#[derive(Debug, Clone)]
pub struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    /// A reader of the message in `bytes`.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    /// Takes an unsigned integer.
    pub fn uint(&mut self, field: u32) -> Option<u64> {
        self.expect(field, VARINT)?;
        self.varint()
    }

    /// Takes a `double`.
    pub fn double(&mut self, field: u32) -> Option<f64> {
        self.expect(field, FIXED64)?;
        self.take(8)?.try_into().ok().map(f64::from_le_bytes)
    }

    /// Takes `bytes` or a `string`.
    pub fn bytes(&mut self, field: u32) -> Option<&'a [u8]> {
        self.expect(field, BYTES)?;
        let length = self.varint()?;
        self.take(usize::try_from(length).ok()?)
    }

    /// Takes a message.
    pub fn message(&mut self, field: u32) -> Option<Self> {
        self.bytes(field).map(Self)
    }

    fn expect(&mut self, field: u32, wire_type: u8) -> Option<()> {
        (self.varint()? == u64::from(field) << 3 | u64::from(wire_type)).then_some(())
    }

    fn take(&mut self, bytes: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(bytes)?;
        self.0 = rest;
        Some(taken)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_have_the_bytes_of_the_protobuf_documentation() {
        let mut message = Message::default();
        message.uint(1, 150);
        assert_eq!(message.clone().into_bytes(), [0x08, 0x96, 0x01], "a: 150");
        let mut outer = Message::default();
        outer.message(3, &message).text(2, "testing");
        let expected = [&[0x1A, 0x03, 0x08, 0x96, 0x01, 0x12, 0x07][..], b"testing"].concat();
        assert_eq!(outer.into_bytes(), expected, "c: {{a: 150}}, b: \"testing\"");
        let mut message = Message::default();
        message.int(20, -2);
        let expected = [0xA0, 0x01, 0xFE, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x01];
        assert_eq!(message.into_bytes(), expected, "a key of two bytes, and -2 in ten bytes");
    }

    #[test]
    fn a_truncated_message_is_never_read_as_another_one() {
        let mut message = Message::default();
        message.double(1, -0.5).uint(2, 1 << 40).bytes(16, b"abc");
        let bytes = message.into_bytes();
        let read = |bytes: &[u8]| {
            let mut reader = Reader::new(bytes);
            Some((reader.double(1)?, reader.uint(2)?, reader.bytes(16)?.to_vec()))
        };
        assert_eq!(read(&bytes), Some((-0.5, 1 << 40, b"abc".to_vec())));
        for length in 0..bytes.len() {
            assert_eq!(read(&bytes[..length]), None, "{length} bytes");
        }
        assert_eq!(Reader::new(&bytes).uint(1), None, "another wire type");
        assert_eq!(
            Reader::new(&[0x08, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF]).uint(1),
            None
        );
    }
}
