//! A value of the schema as a tree: names, fields in the schema's order, numbers as they are spelled.
//!
//! In: anything that derives `Serialize` out of what the schema uses. Out: [`Node`]. Two trees are equal when the
//! values are, to the bit (0.0 and -0.0 differ; all NaN are the same).

use std::fmt::Display;

use serde::de::value::Error;
use serde::ser::{
    Error as _, Impossible, Serialize, SerializeSeq, SerializeStruct, SerializeStructVariant, SerializeTuple,
    SerializeTupleStruct, Serializer,
};

/// One value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    /// A number or truth value, as RON spells it.
    Scalar(String),
    /// A text, not yet in quotes.
    Text(String),
    /// An option that has nothing.
    Null,
    /// `(a, b)`.
    Tuple(Vec<Node>),
    /// `[a, b]`.
    List(Vec<Node>),
    /// `(field: a)`, or `Variant(field: a)`, or `Variant`.
    Record(Record),
}

/// A struct, or a variant of an enum.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Record {
    /// Its type.
    pub kind: &'static str,
    /// Which of the enum's variants; empty for a struct.
    pub variant: &'static str,
    /// Its fields in the schema's order.
    pub fields: Vec<(&'static str, Node)>,
}

impl Node {
    /// The tree of `value`; an error only for what the schema has nothing of (maps, bytes, unnamed structs).
    pub fn from_value<T: Serialize + ?Sized>(value: &T) -> Result<Self, Error> {
        value.serialize(Spelling)
    }

    /// The record that this is, if it is one.
    pub fn record(&self) -> Option<&Record> {
        if let Self::Record(record) = self { Some(record) } else { None }
    }
}

/// Turns values into trees.
struct Spelling;

/// The parts of a list or tuple so far.
struct Parts {
    wrap: fn(Vec<Node>) -> Node,
    parts: Vec<Node>,
}

fn word(value: impl Display) -> Result<Node, Error> {
    Ok(Node::Scalar(value.to_string()))
}

fn foreign<T>(what: &str) -> Result<T, Error> {
    Err(Error::custom(format!("a scenario has no {what}")))
}

impl Serializer for Spelling {
    type Ok = Node;
    type Error = Error;
    type SerializeSeq = Parts;
    type SerializeTuple = Parts;
    type SerializeStruct = Record;
    type SerializeStructVariant = Record;
    type SerializeTupleStruct = Parts;
    type SerializeTupleVariant = Impossible<Node, Error>;
    type SerializeMap = Impossible<Node, Error>;

    fn serialize_bool(self, value: bool) -> Result<Node, Error> {
        word(value)
    }
    fn serialize_i8(self, value: i8) -> Result<Node, Error> {
        word(value)
    }
    fn serialize_i16(self, value: i16) -> Result<Node, Error> {
        word(value)
    }
    fn serialize_i32(self, value: i32) -> Result<Node, Error> {
        word(value)
    }
    fn serialize_i64(self, value: i64) -> Result<Node, Error> {
        word(value)
    }
    fn serialize_u8(self, value: u8) -> Result<Node, Error> {
        word(value)
    }
    fn serialize_u16(self, value: u16) -> Result<Node, Error> {
        word(value)
    }
    fn serialize_u32(self, value: u32) -> Result<Node, Error> {
        word(value)
    }
    fn serialize_u64(self, value: u64) -> Result<Node, Error> {
        word(value)
    }
    // Rust's debug form is the shortest decimal that reads back to the same bits, always with a dot or an exponent.
    fn serialize_f32(self, value: f32) -> Result<Node, Error> {
        word(format_args!("{value:?}"))
    }
    fn serialize_f64(self, value: f64) -> Result<Node, Error> {
        word(format_args!("{value:?}"))
    }
    fn serialize_char(self, _: char) -> Result<Node, Error> {
        foreign("single characters")
    }
    fn serialize_str(self, value: &str) -> Result<Node, Error> {
        Ok(Node::Text(value.into()))
    }
    fn serialize_bytes(self, _: &[u8]) -> Result<Node, Error> {
        foreign("bytes")
    }
    fn serialize_none(self) -> Result<Node, Error> {
        Ok(Node::Null)
    }
    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<Node, Error> {
        value.serialize(self)
    }
    fn serialize_unit(self) -> Result<Node, Error> {
        foreign("units")
    }
    fn serialize_unit_struct(self, _: &'static str) -> Result<Node, Error> {
        foreign("units")
    }
    fn serialize_unit_variant(
        self,
        kind: &'static str,
        _: u32,
        variant: &'static str,
    ) -> Result<Node, Error> {
        Ok(Node::Record(Record { kind, variant, fields: Vec::new() }))
    }
    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, _: &T) -> Result<Node, Error> {
        foreign("unnamed fields")
    }
    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: &T,
    ) -> Result<Node, Error> {
        foreign("unnamed fields")
    }
    fn serialize_seq(self, _: Option<usize>) -> Result<Parts, Error> {
        Ok(Parts { wrap: Node::List, parts: Vec::new() })
    }
    fn serialize_tuple(self, _: usize) -> Result<Parts, Error> {
        Ok(Parts { wrap: Node::Tuple, parts: Vec::new() })
    }
    // Points: `glam::Vec2` is a tuple struct, which RON writes like a tuple.
    fn serialize_tuple_struct(self, _: &'static str, len: usize) -> Result<Parts, Error> {
        self.serialize_tuple(len)
    }
    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: usize,
    ) -> Result<Self::SerializeTupleVariant, Error> {
        foreign("unnamed fields")
    }
    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, Error> {
        foreign("maps")
    }
    fn serialize_struct(self, kind: &'static str, _: usize) -> Result<Record, Error> {
        Ok(Record { kind, variant: "", fields: Vec::new() })
    }
    fn serialize_struct_variant(
        self,
        kind: &'static str,
        _: u32,
        variant: &'static str,
        _: usize,
    ) -> Result<Record, Error> {
        Ok(Record { kind, variant, fields: Vec::new() })
    }
}

impl SerializeSeq for Parts {
    type Ok = Node;
    type Error = Error;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Error> {
        self.parts.push(Node::from_value(value)?);
        Ok(())
    }
    fn end(self) -> Result<Node, Error> {
        Ok((self.wrap)(self.parts))
    }
}

impl SerializeTuple for Parts {
    type Ok = Node;
    type Error = Error;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Error> {
        SerializeSeq::serialize_element(self, value)
    }
    fn end(self) -> Result<Node, Error> {
        SerializeSeq::end(self)
    }
}

impl SerializeTupleStruct for Parts {
    type Ok = Node;
    type Error = Error;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), Error> {
        SerializeSeq::serialize_element(self, value)
    }
    fn end(self) -> Result<Node, Error> {
        SerializeSeq::end(self)
    }
}

impl SerializeStruct for Record {
    type Ok = Node;
    type Error = Error;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, key: &'static str, value: &T) -> Result<(), Error> {
        self.fields.push((key, Node::from_value(value)?));
        Ok(())
    }
    fn end(self) -> Result<Node, Error> {
        Ok(Node::Record(self))
    }
}

impl SerializeStructVariant for Record {
    type Ok = Node;
    type Error = Error;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, key: &'static str, value: &T) -> Result<(), Error> {
        SerializeStruct::serialize_field(self, key, value)
    }
    fn end(self) -> Result<Node, Error> {
        SerializeStruct::end(self)
    }
}
