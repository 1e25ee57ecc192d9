//! The serde serializer that turns a value into a [`Value`] tree.

use std::fmt::Display;

use serde::ser::{
    Impossible, Serialize, SerializeSeq, SerializeStruct, SerializeStructVariant, SerializeTuple,
    SerializeTupleStruct, Serializer,
};

use crate::value::{Record, Value};

/// The error for a value of an unsupported type, such as a map.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot be written as RON: {0}")]
pub struct Unsupported(String);

impl serde::ser::Error for Unsupported {
    fn custom<T: Display>(message: T) -> Self {
        Self(message.to_string())
    }
}

impl Value {
    /// The tree of a serde value.
    pub fn from_serde<T: Serialize + ?Sized>(value: &T) -> Result<Self, Unsupported> {
        value.serialize(ToValue)
    }
}

/// The serde serializer whose output is a [`Value`].
struct ToValue;

/// A list or tuple under construction: the elements so far, and the [`Value`] variant that they become.
struct Parts {
    wrap: fn(Vec<Value>) -> Value,
    parts: Vec<Value>,
}

fn scalar(value: impl Display) -> Result<Value, Unsupported> {
    Ok(Value::Scalar(value.to_string()))
}

fn unsupported<T>(what: &str) -> Result<T, Unsupported> {
    Err(Unsupported(what.into()))
}

impl Serializer for ToValue {
    type Ok = Value;
    type Error = Unsupported;
    type SerializeSeq = Parts;
    type SerializeTuple = Parts;
    type SerializeStruct = Record;
    type SerializeStructVariant = Record;
    type SerializeTupleStruct = Parts;
    type SerializeTupleVariant = Impossible<Value, Unsupported>;
    type SerializeMap = Impossible<Value, Unsupported>;

    fn serialize_bool(self, value: bool) -> Result<Value, Unsupported> {
        scalar(value)
    }
    fn serialize_i8(self, value: i8) -> Result<Value, Unsupported> {
        scalar(value)
    }
    fn serialize_i16(self, value: i16) -> Result<Value, Unsupported> {
        scalar(value)
    }
    fn serialize_i32(self, value: i32) -> Result<Value, Unsupported> {
        scalar(value)
    }
    fn serialize_i64(self, value: i64) -> Result<Value, Unsupported> {
        scalar(value)
    }
    fn serialize_u8(self, value: u8) -> Result<Value, Unsupported> {
        scalar(value)
    }
    fn serialize_u16(self, value: u16) -> Result<Value, Unsupported> {
        scalar(value)
    }
    fn serialize_u32(self, value: u32) -> Result<Value, Unsupported> {
        scalar(value)
    }
    fn serialize_u64(self, value: u64) -> Result<Value, Unsupported> {
        scalar(value)
    }
    // Rust's debug form is the shortest decimal that reads back to the same bits, always with a dot or an exponent.
    fn serialize_f32(self, value: f32) -> Result<Value, Unsupported> {
        scalar(format_args!("{value:?}"))
    }
    fn serialize_f64(self, value: f64) -> Result<Value, Unsupported> {
        scalar(format_args!("{value:?}"))
    }
    fn serialize_char(self, _: char) -> Result<Value, Unsupported> {
        unsupported("a single character")
    }
    fn serialize_str(self, value: &str) -> Result<Value, Unsupported> {
        Ok(Value::Text(value.into()))
    }
    fn serialize_bytes(self, _: &[u8]) -> Result<Value, Unsupported> {
        unsupported("bytes")
    }
    fn serialize_none(self) -> Result<Value, Unsupported> {
        Ok(Value::Null)
    }
    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<Value, Unsupported> {
        value.serialize(self)
    }
    fn serialize_unit(self) -> Result<Value, Unsupported> {
        unsupported("a unit")
    }
    fn serialize_unit_struct(self, _: &'static str) -> Result<Value, Unsupported> {
        unsupported("a unit")
    }
    fn serialize_unit_variant(
        self,
        kind: &'static str,
        _: u32,
        variant: &'static str,
    ) -> Result<Value, Unsupported> {
        Ok(Value::Record(Record { kind, variant, fields: Vec::new() }))
    }
    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: &T,
    ) -> Result<Value, Unsupported> {
        unsupported("a newtype")
    }
    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: &T,
    ) -> Result<Value, Unsupported> {
        unsupported("a variant with unnamed fields")
    }
    fn serialize_seq(self, _: Option<usize>) -> Result<Parts, Unsupported> {
        Ok(Parts { wrap: Value::List, parts: Vec::new() })
    }
    fn serialize_tuple(self, _: usize) -> Result<Parts, Unsupported> {
        Ok(Parts { wrap: Value::Tuple, parts: Vec::new() })
    }
    // A tuple struct such as a vector `(x, y)` is written without its name.
    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Parts, Unsupported> {
        Ok(Parts { wrap: Value::Tuple, parts: Vec::new() })
    }
    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self::SerializeTupleVariant, Unsupported> {
        unsupported("a variant with unnamed fields")
    }
    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, Unsupported> {
        unsupported("a map")
    }
    fn serialize_struct(self, kind: &'static str, _: usize) -> Result<Record, Unsupported> {
        Ok(Record { kind, variant: "", fields: Vec::new() })
    }
    fn serialize_struct_variant(
        self,
        kind: &'static str,
        _: u32,
        variant: &'static str,
        _: usize,
    ) -> Result<Record, Unsupported> {
        Ok(Record { kind, variant, fields: Vec::new() })
    }
}

impl SerializeSeq for Parts {
    type Ok = Value;
    type Error = Unsupported;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Unsupported> {
        self.parts.push(Value::from_serde(value)?);
        Ok(())
    }
    fn end(self) -> Result<Value, Unsupported> {
        Ok((self.wrap)(self.parts))
    }
}

impl SerializeTuple for Parts {
    type Ok = Value;
    type Error = Unsupported;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Unsupported> {
        SerializeSeq::serialize_element(self, value)
    }
    fn end(self) -> Result<Value, Unsupported> {
        SerializeSeq::end(self)
    }
}

impl SerializeTupleStruct for Parts {
    type Ok = Value;
    type Error = Unsupported;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Unsupported> {
        SerializeSeq::serialize_element(self, value)
    }
    fn end(self) -> Result<Value, Unsupported> {
        SerializeSeq::end(self)
    }
}

impl SerializeStruct for Record {
    type Ok = Value;
    type Error = Unsupported;

    fn serialize_field<T: Serialize + ?Sized>(
        &mut self,
        key: &'static str,
        value: &T,
    ) -> Result<(), Unsupported> {
        self.fields.push((key, Value::from_serde(value)?));
        Ok(())
    }
    /// A skipped field becomes `None`, because the old text may contain it.
    fn skip_field(&mut self, key: &'static str) -> Result<(), Unsupported> {
        self.fields.push((key, Value::Null));
        Ok(())
    }
    fn end(self) -> Result<Value, Unsupported> {
        Ok(Value::Record(self))
    }
}

impl SerializeStructVariant for Record {
    type Ok = Value;
    type Error = Unsupported;

    fn serialize_field<T: Serialize + ?Sized>(
        &mut self,
        key: &'static str,
        value: &T,
    ) -> Result<(), Unsupported> {
        SerializeStruct::serialize_field(self, key, value)
    }
    fn skip_field(&mut self, key: &'static str) -> Result<(), Unsupported> {
        SerializeStruct::skip_field(self, key)
    }
    fn end(self) -> Result<Value, Unsupported> {
        SerializeStruct::end(self)
    }
}
