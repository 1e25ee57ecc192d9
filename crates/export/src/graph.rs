//! Builds an ONNX `GraphProto`. Each method adds one field of a protobuf message of
//! [onnx.proto](https://github.com/onnx/onnx/blob/main/onnx/onnx.proto).

use wayfield_protobuf::Message;

/// Field numbers, by message.
mod field {
    pub mod graph {
        pub const NODE: u32 = 1;
        pub const NAME: u32 = 2;
        pub const INITIALIZER: u32 = 5;
        pub const INPUT: u32 = 11;
        pub const OUTPUT: u32 = 12;
    }
    pub mod node {
        pub const INPUT: u32 = 1;
        pub const OUTPUT: u32 = 2;
        pub const NAME: u32 = 3;
        pub const OP_TYPE: u32 = 4;
        pub const ATTRIBUTE: u32 = 5;
    }
    pub mod attribute {
        pub const NAME: u32 = 1;
        pub const INT: u32 = 3;
        pub const INTS: u32 = 8;
        pub const TYPE: u32 = 20;
    }
    pub mod tensor {
        pub const DIMS: u32 = 1;
        pub const DATA_TYPE: u32 = 2;
        pub const NAME: u32 = 8;
        pub const RAW_DATA: u32 = 9;
    }
    pub mod value_info {
        pub const NAME: u32 = 1;
        pub const TYPE: u32 = 2;
        pub const DOC: u32 = 3;
    }
    pub mod tensor_type {
        /// The field of `TypeProto` that holds this message.
        pub const IN_TYPE: u32 = 1;
        pub const ELEMENT: u32 = 1;
        pub const SHAPE: u32 = 2;
        /// `TensorShapeProto.dim`.
        pub const DIM: u32 = 1;
        pub const DIM_VALUE: u32 = 1;
        pub const DIM_PARAM: u32 = 2;
    }
}

/// The type of a tensor's elements: `TensorProto.DataType`.
#[derive(Clone, Copy)]
pub enum Element {
    F32 = 1,
    I64 = 7,
}

/// `AttributeProto.AttributeType`.
const ATTRIBUTE_INT: u64 = 2;
const ATTRIBUTE_INTS: u64 = 7;

/// The value of a node's attribute.
#[derive(Clone, Copy)]
pub enum Attribute<'a> {
    Int(i64),
    Ints(&'a [i64]),
}

/// A graph under construction. Nodes must be added in topological order.
pub struct Graph(Message);

impl Graph {
    pub fn new(name: &str) -> Self {
        let mut graph = Message::default();
        graph.text(field::graph::NAME, name);
        Self(graph)
    }

    /// Adds an input: a row of `width` elements per observation.
    pub fn input(&mut self, name: &str, width: usize, doc: &str) {
        self.0.message(field::graph::INPUT, &value_info(name, Element::F32, Some(width), doc));
    }

    /// Adds an output: one element per observation, or a row of `width` elements.
    pub fn output(&mut self, name: &str, element: Element, width: Option<usize>, doc: &str) {
        self.0.message(field::graph::OUTPUT, &value_info(name, element, width, doc));
    }

    /// Adds a constant of shape `dims`, with its values row by row.
    pub fn constant(&mut self, name: &str, dims: &[usize], values: &[f32]) {
        let mut tensor = Message::default();
        for &dim in dims {
            tensor.uint(field::tensor::DIMS, dim as u64);
        }
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        tensor.uint(field::tensor::DATA_TYPE, Element::F32 as u64).text(field::tensor::NAME, name);
        tensor.bytes(field::tensor::RAW_DATA, &bytes);
        self.0.message(field::graph::INITIALIZER, &tensor);
    }

    /// Adds a node with one output, which gives the node its name.
    pub fn node(&mut self, operator: &str, inputs: &[&str], output: &str, attributes: &[(&str, Attribute)]) {
        let mut node = Message::default();
        for input in inputs {
            node.text(field::node::INPUT, input);
        }
        node.text(field::node::OUTPUT, output).text(field::node::NAME, output);
        node.text(field::node::OP_TYPE, operator);
        for (name, value) in attributes {
            node.message(field::node::ATTRIBUTE, &attribute(name, *value));
        }
        self.0.message(field::graph::NODE, &node);
    }

    pub fn into_message(self) -> Message {
        self.0
    }
}

fn attribute(name: &str, value: Attribute) -> Message {
    let mut message = Message::default();
    message.text(field::attribute::NAME, name);
    let kind = match value {
        Attribute::Int(value) => {
            message.int(field::attribute::INT, value);
            ATTRIBUTE_INT
        }
        Attribute::Ints(values) => {
            for &value in values {
                message.int(field::attribute::INTS, value);
            }
            ATTRIBUTE_INTS
        }
    };
    message.uint(field::attribute::TYPE, kind);
    message
}

/// The description of a tensor whose first dimension is the number of observations, `n`.
fn value_info(name: &str, element: Element, width: Option<usize>, doc: &str) -> Message {
    use field::tensor_type as tensor;
    let [mut rows, mut columns, mut shape, mut tensor_type, mut of_type, mut info] =
        <[Message; 6]>::default();
    shape.message(tensor::DIM, rows.text(tensor::DIM_PARAM, "n"));
    if let Some(width) = width {
        shape.message(tensor::DIM, columns.uint(tensor::DIM_VALUE, width as u64));
    }
    tensor_type.uint(tensor::ELEMENT, element as u64).message(tensor::SHAPE, &shape);
    of_type.message(tensor::IN_TYPE, &tensor_type);
    info.text(field::value_info::NAME, name).message(field::value_info::TYPE, &of_type);
    info.text(field::value_info::DOC, doc);
    info
}
