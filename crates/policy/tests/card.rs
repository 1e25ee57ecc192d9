//! The card of a policy file: it is read as it was written, and a card that contradicts the network or itself is refused.

use serde_json::{Value, json};
use wayfield_policy::card::{Action, Example, Program, RawJson, Training, inputs, q_value_formula};
use wayfield_policy::{Activation, Card, Encoding, NetworkShape, Policy, PolicyError, Scratch};

const BEAMS: usize = 3;
const SENSORS: [(&str, usize); 2] = [("odometry", 2), ("bumper", 1)];

/// The shape of a network for 3 beams, two plugin sensors and two actions.
fn shape() -> NetworkShape {
    NetworkShape {
        inputs: BEAMS + 4 + 3,
        hidden: vec![4],
        actions: 2,
        dueling: true,
        layer_norm: false,
        activation: Activation::Relu,
    }
}

fn policy(encoding: Encoding) -> Policy {
    policy_of(shape(), encoding)
}

/// A policy whose network has `shape`, which may differ from [`shape()`] in activation and layer normalization only.
fn policy_of(shape: NetworkShape, encoding: Encoding) -> Policy {
    let parameters: Vec<f32> =
        (0..shape.parameter_count()).map(|k| (k * 37 % 19) as f32 * 0.1 - 0.9).collect();
    let mut policy = Policy::new(shape, parameters).expect("a valid shape");
    let q_values = |row: &[f32]| policy.q_values(row, &mut Scratch::default()).to_vec();
    let scenario = RawJson::new("{ \"name\": \"Mine\" }".into()).expect("JSON");
    let card = Card {
        observation: None,
        relative_actions: None,
        program: Program { name: "wayfield".into(), version: "1.2.3".into(), commit: None },
        training: Training {
            scenario_from: "mine.ron".into(),
            scenario_set: None,
            preset: "fast".into(),
            seed: u64::MAX,
            init: None,
            env_steps: 7,
            gradient_steps: 3,
            success_rate: Some(0.1),
        },
        inputs: inputs(encoding, &[-0.7, 0.0, 0.7], &SENSORS),
        activation: policy.shape().activation.name().into(),
        q_values: q_value_formula(true).into(),
        actions: [1.5, -0.1].map(|w_rad_s| Action { v_m_s: 0.15, w_rad_s }).into(),
        control_period_s: 0.2,
        example: Example::new(encoding, (BEAMS, 3.5), 3, q_values),
        scenario_crc32c: scenario.crc32c(),
        scenario,
    };
    policy.card = Some(Box::new(card));
    policy
}

#[test]
fn a_card_is_read_as_it_was_written_and_gives_encoding_and_sensors() {
    for encoding in [Encoding::Scaled, Encoding::Raw] {
        let written = policy(encoding);
        let bytes = written.to_bytes().expect("a valid card");
        let read = Policy::from_bytes(&bytes).expect("a valid file");
        assert!(read == written && read.to_bytes().as_ref() == Ok(&bytes), "not a bit has changed");
        let card = read.card.expect("a card");
        assert_eq!((card.encoding(), card.sensors()), (Some(encoding), SENSORS.to_vec()));
        assert_eq!(card.angles_rad(), [-0.7, 0.0, 0.7]);
    }
}

#[test]
fn the_json_of_a_card_lists_every_input_with_unit_divisor_and_angle() {
    let text = policy(Encoding::Scaled).header().expect("a card");
    let header: Value = serde_json::from_str(&text).expect("JSON");
    let inputs = header["card"]["inputs"].as_array().expect("a list");
    assert_eq!(inputs[0], json!({"quantity": "range", "unit": "m", "divisor": 3.5, "angle_rad": -0.7}));
    let bearing = r#"{"quantity":"goal_bearing","unit":"rad","divisor":3.1415927}"#;
    assert!(text.contains(bearing), "the shortest number that is pi in f32: {text}");
    assert_eq!(inputs[4], json!({"quantity": "goal_distance", "unit": "m", "divisor": 4.0}));
    assert_eq!(inputs[5], json!({"quantity": "smallest_range", "unit": "m", "divisor": 3.5}));
    assert_eq!(inputs[6], json!({"quantity": "nearest_beam", "unit": "", "divisor": 3.0}));
    assert_eq!(inputs[9], json!({"quantity": "sensor", "unit": "", "divisor": 1.0, "sensor": "bumper"}));
    assert_eq!(header["version"], 2);
    assert_eq!(header["network"]["hidden"], json!([4]));
}

#[test]
fn a_header_names_activation_and_layer_norm_only_if_they_are_not_the_defaults() {
    let plain = policy(Encoding::Scaled).header().expect("a card");
    assert!(!plain.contains("layer_norm") && plain.contains("\"dueling\":true},"), "{plain}");
    for activation in Activation::ALL {
        let shape = NetworkShape { layer_norm: true, activation, ..shape() };
        let written = policy_of(shape, Encoding::Scaled);
        let bytes = written.to_bytes().expect("a valid card");
        assert!(
            Policy::from_bytes(&bytes).as_ref() == Ok(&written),
            "{activation:?} is read as it was written"
        );
        let header: Value = serde_json::from_str(&written.header().expect("a card")).expect("JSON");
        assert_eq!(header["network"]["layer_norm"], true);
        assert_eq!(header["card"]["activation"], activation.name());
        let in_network = header["network"].get("activation").and_then(Value::as_str);
        assert_eq!(in_network.unwrap_or("relu"), activation.name());
    }
}

/// The error from reading a policy file whose header `change` has edited.
fn error(change: impl FnOnce(&str) -> String) -> String {
    let bytes = policy(Encoding::Scaled).to_bytes().expect("a valid card");
    let length = u64::from_le_bytes(bytes[..8].try_into().expect("eight bytes")) as usize;
    let mut file: Value = serde_json::from_slice(&bytes[8..8 + length]).expect("JSON");
    let header = file["__metadata__"]["wayfield"].as_str().expect("a text").to_owned();
    let changed = change(&header);
    assert_ne!(changed, header, "the change changes something");
    file["__metadata__"]["wayfield"] = changed.into();
    let mut json = file.to_string();
    json.push_str(&" ".repeat(json.len().next_multiple_of(8) - json.len()));
    let file = [&(json.len() as u64).to_le_bytes()[..], json.as_bytes(), &bytes[8 + length..]].concat();
    Policy::from_bytes(&file).expect_err("refused").to_string()
}

#[test]
fn a_card_that_contradicts_the_network_or_itself_is_refused() {
    for (from, to, expected) in [
        ("\"activation\":\"relu\"", "\"activation\":\"tanh\"", "the activation is \"relu\""),
        ("\"dueling\":true", "\"dueling\":true,\"activation\":\"tanh\"", "the activation is \"tanh\""),
        ("\"dueling\":true", "\"dueling\":true,\"activation\":\"gelu\"", "unknown variant `gelu`"),
        (
            "\"dueling\":true",
            "\"dueling\":true,\"layer_norm\":true",
            "lacks the tensor `hidden.0.norm.weight`",
        ),
        ("value + advantage - mean(advantage)", "output", "the Q-values are"),
        (",{\"v_m_s\":0.15,\"w_rad_s\":-0.1}", "", "lists 1 actions, but the network has 2"),
        ("\"v_m_s\":0.15", "\"v_m_s\":1e39", "not finite in action 0"),
        ("\"v_m_s\":0.15", "\"v_m_s\":NaN", "expected value"),
        ("\"v_m_s\":0.15", "\"v_m_s\":null", "invalid type: null"),
        ("\"control_period_s\":0.2", "\"control_period_s\":0.0", "a control period of 0 s"),
        ("\"angle_rad\":0.7", "\"angle_rad\":-1e39", "not finite in input 2"),
        ("\"divisor\":4.0", "\"divisor\":5.0", "cannot compute; help: use a newer wayfield"),
        ("\"quantity\":\"goal_bearing\"", "\"quantity\":\"goal_distance\"", "cannot compute"),
        ("\"goal_distance_m\":1.5", "\"goal_distance_m\":1.25", "not that of its ranges and goal"),
        ("\"success_rate\":0.1", "\"success_rate\":1.1", "a success rate outside 0 to 1"),
    ] {
        let message = error(|header| header.replacen(from, to, 1));
        assert!(message.contains(expected), "{from} -> {to}: {message}");
    }
    let message = error(|header| header.replacen("\"Mine\"", "\"Yours\"", 1));
    assert!(message.contains("has a scenario whose checksum is"), "{message}");
}

#[test]
fn an_example_with_other_q_values_than_the_network_is_refused() {
    let mut policy = policy(Encoding::Raw);
    let card = policy.card.as_mut().expect("a card");
    card.example.q_values[1] += 0.1;
    let error = policy.to_bytes().expect_err("refused when it is written, too");
    assert!(
        matches!(error, PolicyError::Card(_)) && error.to_string().contains("do not match the network"),
        "{error}"
    );
}

#[test]
fn format_version_2_needs_a_card_and_version_1_has_none() {
    let message = error(|header| header.replacen("\"card\":", "\"business card\":", 1));
    assert!(message.contains("missing field `card`"), "{message}");
    let message = error(|header| header.replacen("\"version\":2", "\"version\":3", 1));
    assert!(message.contains("version 3, but this wayfield reads versions 1 and 2"), "{message}");
    let mut without = policy(Encoding::Scaled);
    without.card = None;
    let bytes = without.to_bytes().expect("finite weights");
    assert_eq!(Policy::from_bytes(&bytes), Ok(without), "a policy without a card is written in version 1");
}

#[test]
fn a_header_above_the_limit_is_refused() {
    let message = error(|header| header.replacen("{", &format!("{{{}", " ".repeat(1 << 24)), 1));
    assert!(message.contains("more than 16777216"), "{message}");
}
