//! The ONNX file of a policy: measurements, or an observation by sectors, in; Q-values, action and velocities out.
//!
//! The index of a smallest or largest element is found by `Equal -> Where -> ReduceMin`, which gives the first of equal
//! elements in every runtime. ArgMin and ArgMax do not: some runtimes take the last one. Equal elements are common, because all
//! beams that hit nothing have exactly the maximum range.

use wayfield_policy::card::Quantity;
use wayfield_policy::{Activation, Card, NetworkShape, Policy};
use wayfield_protobuf::Message;

use crate::graph::{Attribute, Element, Graph};
use crate::{ExportError, described};

/// The version of the ONNX operator set. It is old enough for the runtimes on robots and in browsers, and the first one with
/// LayerNormalization.
pub const OPSET: u64 = 17;
/// The version of the ONNX file format that belongs to [`OPSET`].
pub const IR_VERSION: u64 = 8;

/// Field numbers of `ModelProto`, `OperatorSetIdProto` and `StringStringEntryProto`.
mod field {
    pub const IR_VERSION: u32 = 1;
    pub const PRODUCER_NAME: u32 = 2;
    pub const PRODUCER_VERSION: u32 = 3;
    pub const DOC: u32 = 6;
    pub const GRAPH: u32 = 7;
    pub const OPSET_IMPORT: u32 = 8;
    pub const METADATA: u32 = 14;
    pub const OPSET_VERSION: u32 = 2;
    pub const KEY: u32 = 1;
    pub const VALUE: u32 = 2;
}

/// The key of the policy's header, with its card, in the file's metadata; the same as in a policy file.
const METADATA_KEY: &str = "wayfield";

type Attributes<'a> = [(&'a str, Attribute<'a>)];

/// The attributes of a reduction of each row to one element: the result is a matrix with one column, or a vector.
const TO_COLUMN: &Attributes = &[("axes", Attribute::Ints(&[1])), ("keepdims", Attribute::Int(1))];
const TO_VECTOR: &Attributes = &[("axes", Attribute::Ints(&[1])), ("keepdims", Attribute::Int(0))];

/// The bytes of an ONNX file that acts as `policy` does. `docs/onnx.md` describes its inputs and outputs. Equal policies give
/// equal bytes.
///
/// # Errors
/// The policy has non-finite weights, has no readable card, or contradicts its card.
pub fn to_onnx(policy: &Policy) -> Result<Vec<u8>, ExportError> {
    policy.check_finite()?;
    let header = policy.header()?;
    let (card, scenario) = described(policy)?;
    let mut graph = Graph::new("policy");
    let observation = if card.observation.is_some() {
        graph.input("observation", card.inputs.len(), "the inputs on the card");
        "observation"
    } else {
        add_measurements(&mut graph, card);
        add_observation(&mut graph, card, scenario.lidar.max_range_m)
    };
    add_network(&mut graph, policy, observation);
    add_decision(&mut graph, card);

    let [mut opset, mut metadata, mut model] = <[Message; 3]>::default();
    opset.uint(field::OPSET_VERSION, OPSET);
    metadata.text(field::KEY, METADATA_KEY).text(field::VALUE, &header);
    model.uint(field::IR_VERSION, IR_VERSION).text(field::PRODUCER_NAME, &card.program.name);
    model.text(field::PRODUCER_VERSION, &card.program.version);
    model.text(field::DOC, "A LIDAR navigation policy. The metadata has its card, as JSON.");
    model.message(field::GRAPH, &graph.into_message()).message(field::OPSET_IMPORT, &opset);
    model.message(field::METADATA, &metadata);
    Ok(model.into_bytes())
}

fn add_measurements(graph: &mut Graph, card: &Card) {
    let (beams, readings) = (card.count(Quantity::Range), card.count(Quantity::Sensor));
    graph.input("ranges", beams, "LIDAR ranges in m, in the order of the beams on the card");
    graph.input(
        "goal",
        2,
        "bearing of the goal relative to the heading, in rad, left positive, in (-pi, pi]; distance in m",
    );
    if readings > 0 {
        graph.input("sensor_readings", readings, "readings of the plugin sensors on the card");
    }
}

/// Adds the encoding of the paper's observation, and returns its name. The order is that of the card's inputs.
fn add_observation(graph: &mut Graph, card: &Card, max_range_m: f32) -> &'static str {
    let beams = card.count(Quantity::Range);
    graph.constant("max_range", &[1], &[max_range_m]);
    graph.node("Min", &["ranges", "max_range"], "clipped_ranges", &[]);
    graph.node("ReduceMin", &["clipped_ranges"], "smallest_range", TO_COLUMN);
    add_first_index(graph, ["clipped_ranges", "smallest_range", "nearest_beam"], beams, TO_COLUMN);
    let mut parts = vec!["clipped_ranges", "goal", "smallest_range", "nearest_beam"];
    if card.count(Quantity::Sensor) > 0 {
        parts.push("sensor_readings");
    }
    graph.node("Concat", &parts, "measurements", &[("axis", Attribute::Int(1))]);
    let divisors: Vec<f32> = card.inputs.iter().map(|input| input.divisor).collect();
    if divisors.iter().all(|&divisor| divisor == 1.0) {
        return "measurements";
    }
    graph.constant("divisors", &[divisors.len()], &divisors);
    graph.node("Div", &["measurements", "divisors"], "observation", &[]);
    "observation"
}

/// Adds the network, whose output is `q_values`. Weights have the names of the tensors in a policy file.
fn add_network(graph: &mut Graph, policy: &Policy, observation: &str) {
    let shape = policy.shape();
    for view in shape.parameters() {
        graph.constant(&view.name, &view.shape, &policy.parameters()[view.range.clone()]);
    }
    let mut units = observation.to_owned();
    for layer in (0..shape.hidden.len()).map(|k| format!("hidden.{k}")) {
        let linear = format!("{layer}.linear");
        add_dense(graph, &layer, &units, &linear);
        let normalized = if shape.layer_norm { add_layer_norm(graph, &layer, &linear) } else { linear };
        add_activation(graph, shape.activation, &normalized, &layer);
        units = layer;
    }
    add_head(graph, shape, &units);
}

/// Adds the layer normalization of `units`, and returns its name. ONNX's default axis is the last one; its default epsilon is
/// 1e-5, that of a policy.
fn add_layer_norm(graph: &mut Graph, layer: &str, units: &str) -> String {
    let (norm, scale, shift) =
        (format!("{layer}.norm"), format!("{layer}.norm.weight"), format!("{layer}.norm.bias"));
    graph.node("LayerNormalization", &[units, &scale, &shift], &norm, &[]);
    norm
}

fn add_activation(graph: &mut Graph, activation: Activation, units: &str, output: &str) {
    match activation {
        Activation::Relu => graph.node("Relu", &[units], output, &[]),
        // ONNX's default alpha is 1, that of a policy.
        Activation::Elu => graph.node("Elu", &[units], output, &[]),
        Activation::Silu => {
            let sigmoid = format!("{output}.sigmoid");
            graph.node("Sigmoid", &[units], &sigmoid, &[]);
            graph.node("Mul", &[units, &sigmoid], output, &[]);
        }
        Activation::Tanh => graph.node("Tanh", &[units], output, &[]),
    }
}

fn add_head(graph: &mut Graph, shape: &NetworkShape, units: &str) {
    if !shape.dueling {
        add_dense(graph, "output", units, "q_values");
        return;
    }
    // Q = V + A - mean(A): the dueling head of Wang et al. 2016.
    add_dense(graph, "value", units, "value");
    add_dense(graph, "advantage", units, "advantage");
    graph.node("ReduceMean", &["advantage"], "mean_advantage", TO_COLUMN);
    graph.node("Sub", &["value", "mean_advantage"], "offset", &[]);
    graph.node("Add", &["advantage", "offset"], "q_values", &[]);
}

/// Adds a fully connected layer, whose weight is a matrix of outputs x inputs.
fn add_dense(graph: &mut Graph, layer: &str, units: &str, output: &str) {
    let (weight, bias) = (format!("{layer}.weight"), format!("{layer}.bias"));
    graph.node("Gemm", &[units, &weight, &bias], output, &[("transB", Attribute::Int(1))]);
}

/// Adds the greedy action and its velocities.
///
/// Relative motions become velocities by the robot's limits, which are inputs: fraction * highest, or -fraction * lowest if the
/// fraction is negative, as [`RelativeMotion::of`](wayfield_policy::RelativeMotion::of) computes them.
fn add_decision(graph: &mut Graph, card: &Card) {
    let actions = card.actions.len();
    graph.output("q_values", Element::F32, Some(actions), "the Q-value of each action");
    graph.node("ReduceMax", &["q_values"], "largest_q_value", TO_COLUMN);
    add_first_index(graph, ["q_values", "largest_q_value", "best_action"], actions, TO_VECTOR);
    graph.node("Cast", &["best_action"], "action", &[("to", Attribute::Int(Element::I64 as i64))]);
    graph.output("action", Element::I64, None, "the greedy action: the first with the largest Q-value");
    match &card.relative_actions {
        None => {
            let motions = card.actions.iter().map(|action| [action.v_m_s, action.w_rad_s]);
            add_choice(graph, "motions", motions, "velocity");
        }
        Some(motions) => {
            let fractions = motions.iter().map(|motion| [motion.speed, motion.turn]);
            for (limit, sign) in [("highest", 1.0), ("lowest", -1.0)] {
                let input = format!("{limit}_motion");
                graph.input(
                    &input,
                    2,
                    &format!("the robot's {limit} speed in m/s and turning rate in rad/s"),
                );
                let of_this_sign = fractions.clone().map(|motion| motion.map(|f| (sign * f).max(0.0)));
                add_choice(graph, &format!("{limit}.fractions"), of_this_sign, &format!("{limit}.fraction"));
                graph.node("Mul", &[&format!("{limit}.fraction"), &input], &format!("{limit}.part"), &[]);
            }
            graph.node("Add", &["highest.part", "lowest.part"], "velocity", &[]);
        }
    }
    let doc =
        "the action's linear speed along the heading in m/s, and its angular speed in rad/s, left positive";
    graph.output("velocity", Element::F32, Some(2), doc);
}

/// Adds `output`: the element of the constant `name`, a list of `pairs`, that belongs to the action.
fn add_choice(graph: &mut Graph, name: &str, pairs: impl Iterator<Item = [f32; 2]>, output: &str) {
    let values: Vec<f32> = pairs.flatten().collect();
    graph.constant(name, &[values.len() / 2, 2], &values);
    graph.node("Gather", &[name, "action"], output, &[("axis", Attribute::Int(0))]);
}

/// Adds `output`: in each row of `values`, which has `count` elements, the index of the first one that equals the row's
/// `extreme`.
fn add_first_index(graph: &mut Graph, [values, extreme, output]: [&str; 3], count: usize, axis: &Attributes) {
    let [indices, end, is_equal, candidates] =
        ["indices", "end", "is_equal", "candidates"].map(|part| format!("{output}.{part}"));
    graph.constant(&indices, &[count], &(0..count).map(|k| k as f32).collect::<Vec<f32>>());
    graph.constant(&end, &[1], &[count as f32]);
    graph.node("Equal", &[values, extreme], &is_equal, &[]);
    graph.node("Where", &[&is_equal, &indices, &end], &candidates, &[]);
    graph.node("ReduceMin", &[&candidates], output, axis);
}
