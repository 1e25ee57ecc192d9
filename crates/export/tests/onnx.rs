//! An exported policy decides as wayfield does: ONNX Runtime computes the same Q-values and actions.

mod python;

use std::fs;
use std::path::Path;

use wayfield_export::{ExportError, MODEL_CARD_MARK, model_card, to_onnx};
use wayfield_policy::card::{Action, Card, Example, Program, RawJson, Training, inputs, q_value_formula};
use wayfield_policy::{Activation, Encoding, NetworkShape, Policy, Scratch};
use wayfield_random::uniform;

use python::Measurements;

const SENSORS: [(&str, usize); 2] = [("odometry", 2), ("bumper", 1)];

fn shipped(name: &str) -> Policy {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/policies").join(name);
    Policy::from_bytes(&fs::read(path).expect("a shipped policy")).expect("a valid policy")
}

/// A policy with random weights for 9 beams that reach 2.5 m.
fn random(shape: NetworkShape, encoding: Encoding, sensors: &[(&str, usize)]) -> Policy {
    let mut random = wayfield_random::stream(7, "test: weights", 0);
    let mut weights = Vec::new();
    for view in shape.parameters() {
        // He initialization: the outputs of a layer vary about as much as its inputs.
        let bound = view.shape.get(1).map_or(2.0, |&inputs| (6.0 / inputs as f32).sqrt());
        weights.extend(view.range.map(|_| uniform(&mut random, -bound, bound)));
    }
    let mut policy = Policy::new(shape.clone(), weights).expect("a valid shape");
    let angles: Vec<f32> = (0..9).map(|beam| (beam as f32 - 4.0) * 0.5).collect();
    let q_values = |row: &[f32]| policy.q_values(row, &mut Scratch::default()).to_vec();
    let scenario =
        RawJson::new(r#"{"name": "A <b>\"room\"</b> | 迷路", "lidar": {"max_range_m": 2.5}}"#.into());
    let scenario = scenario.expect("JSON");
    policy.card = Some(Box::new(Card {
        observation: None,
        relative_actions: None,
        program: Program { name: "wayfield".into(), version: "1.2.3".into(), commit: None },
        training: Training {
            scenario_from: "room.ron".into(),
            scenario_set: None,
            preset: "my_preset".into(),
            seed: 3,
            init: None,
            env_steps: 7,
            gradient_steps: 3,
            success_rate: None,
        },
        inputs: inputs(encoding, &angles, sensors),
        activation: shape.activation.name().into(),
        q_values: q_value_formula(shape.dueling).into(),
        actions: (0..shape.actions).map(|k| Action { v_m_s: 0.1, w_rad_s: k as f32 - 1.0 }).collect(),
        control_period_s: 0.2,
        example: Example::new(encoding, (9, 2.5), sensors.iter().map(|(_, width)| width).sum(), q_values),
        scenario_crc32c: scenario.crc32c(),
        scenario,
    }));
    policy
}

/// Compares ONNX Runtime's decisions with those of `policy`.
fn assert_parity(name: &str, policy: &Policy, max_range_m: f32) {
    let Some(python) = python::python() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("policy.onnx"), to_onnx(policy).expect("an ONNX file")).expect("written");
    println!("{name}: {}", Measurements::random(policy, max_range_m).assert_parity(&python, folder.path()));
}

#[test]
fn onnx_runtime_decides_as_the_general_policy_does_for_a_robot_with_any_limits() {
    let policy = shipped("general.safetensors");
    let page = model_card(&policy, "policy.onnx", &[]).expect("a page");
    assert!(page.starts_with("---\n") && page.contains("# LIDAR navigation in General\n"), "{page}");
    assert!(
        page.contains("| `highest_motion` | n x 2, f32 |") && page.contains("| 7 | 0.5 | -1 |"),
        "{page}"
    );
    let Some(python) = python::python() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("policy.onnx"), to_onnx(&policy).expect("an ONNX file")).expect("written");
    println!("{}", Measurements::random_observations(&policy).assert_parity(&python, folder.path()));
    // The example on the page runs as it is.
    let (_, example) = page.split_once("```python\n").expect("an example");
    let (example, _) = example.split_once("```").expect("its end");
    fs::write(folder.path().join("example.py"), example).expect("written");
    let printed = python::run(&python, folder.path(), Path::new("example.py"));
    assert!(printed.starts_with("[["), "{printed}");
}

#[test]
fn onnx_runtime_decides_as_the_shipped_policies_do() {
    for name in ["scenario-1.safetensors", "scenario-2.safetensors"] {
        assert_parity(name, &shipped(name), 3.5);
    }
}

#[test]
fn onnx_runtime_decides_as_every_kind_of_network_does() {
    let shape = |inputs: usize, hidden: &[usize], actions, dueling| NetworkShape {
        inputs: 9 + 4 + inputs,
        hidden: hidden.to_vec(),
        actions,
        dueling,
        layer_norm: false,
        activation: Activation::Relu,
    };
    let switched =
        |layer_norm, activation| NetworkShape { layer_norm, activation, ..shape(0, &[32, 16], 5, true) };
    for (name, shape, encoding, sensors) in [
        ("raw, dueling", shape(0, &[32, 16], 5, true), Encoding::Raw, &[][..]),
        ("scaled, plain", shape(0, &[32], 3, false), Encoding::Scaled, &[]),
        ("scaled, dueling, sensors", shape(3, &[16, 16, 8], 4, true), Encoding::Scaled, &SENSORS),
        ("layer norm", switched(true, Activation::Relu), Encoding::Scaled, &[]),
        ("layer norm, SiLU", switched(true, Activation::Silu), Encoding::Raw, &[]),
        ("ELU", switched(false, Activation::Elu), Encoding::Scaled, &[]),
        ("tanh", switched(false, Activation::Tanh), Encoding::Raw, &[]),
        ("raw, without hidden layers, one action", shape(3, &[], 1, false), Encoding::Raw, &SENSORS),
    ] {
        assert_parity(name, &random(shape, encoding, sensors), 2.5);
    }
}

#[test]
fn equal_policies_give_equal_files() {
    let name = "scenario-1.safetensors";
    assert_eq!(to_onnx(&shipped(name)), to_onnx(&shipped(name)));
    assert_ne!(to_onnx(&shipped(name)), to_onnx(&shipped("scenario-2.safetensors")));
}

#[test]
fn a_policy_without_a_card_is_not_exported() {
    let mut policy = shipped("scenario-1.safetensors");
    policy.card = None;
    assert_eq!(to_onnx(&policy), Err(ExportError::NoCard));
    assert_eq!(model_card(&policy, "policy.onnx", &[]), Err(ExportError::NoCard));
}

#[test]
fn the_model_card_gives_the_values_of_the_policy_card_and_no_others() {
    let policy = shipped("scenario-1.safetensors");
    let card = policy.card.as_ref().expect("a card");
    let rate = card.training.success_rate.expect("a measured rate");
    let page = model_card(&policy, "policy.onnx", &[]).expect("a page");
    assert!(
        page.starts_with("---\nlibrary_name: \"wayfield\"\n") && page.contains(MODEL_CARD_MARK),
        "{page}"
    );
    assert!(page.contains(&format!("\"value\":{rate:?},\"verified\":false")), "{page}");
    assert!(
        page.contains(&format!("goal in {:.1} % of the episodes in Scenario I.", 100.0 * rate)),
        "{page}"
    );
    assert!(page.contains(&format!("| env steps | {} |", card.training.env_steps)), "{page}");
    assert!(page.contains("| 4 | 0.15 | -1.5 |"), "{page}");

    let shape = NetworkShape {
        inputs: 16,
        hidden: vec![4],
        actions: 3,
        dueling: true,
        layer_norm: false,
        activation: Activation::Relu,
    };
    let page = model_card(&random(shape, Encoding::Raw, &SENSORS), "my.onnx", &[]).expect("a page");
    assert!(!page.contains("model-index") && page.contains("was not measured"), "{page}");
    assert!(page.contains("# LIDAR navigation in A \\<b\\>\"room\"\\</b\\> \\| 迷路\n"), "{page}");
}

#[test]
fn hugging_face_reads_the_front_matter_of_a_model_card() {
    let Some(python) = python::python() else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let page = model_card(&shipped("scenario-1.safetensors"), "policy.onnx", &[]).expect("a page");
    fs::write(folder.path().join("README.md"), page).expect("written");
    let script = folder.path().join("read.py");
    let program = "from huggingface_hub import ModelCard\n\
                   data = ModelCard.load('README.md').data\n\
                   result = data.eval_results[0]\n\
                   print(data.library_name, data.pipeline_tag, result.dataset_name, result.metric_type, result.metric_value)\n";
    fs::write(&script, program).expect("written");
    let printed = python::run(&python, folder.path(), &script);
    assert_eq!(printed, "wayfield reinforcement-learning Scenario I success_rate 1.0\n");
}
