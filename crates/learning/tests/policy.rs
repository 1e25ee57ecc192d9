//! Policy files: their bytes are reproducible, and reading an untrusted file is safe.

use std::collections::HashMap;

use proptest::prelude::*;
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use wayfield_learning::{
    Activation, Learner, LearningConfig, LoadWeightsError, NetworkConfig, Policy, PolicyError, QNetwork,
};
use wayfield_policy::Scratch;
use wayfield_random::{Stream, normal, stream};

fn learner(hidden: &[usize], dueling: bool) -> Learner {
    let network = NetworkConfig { hidden: hidden.to_vec(), dueling, ..NetworkConfig::default() };
    Learner::new(&LearningConfig { network, ..LearningConfig::default() }, 6, 3, 1, 1)
        .expect("a valid config")
}

fn policy() -> Policy {
    let mut policy = learner(&[5, 4], true).policy();
    for (key, value) in [("scenario", "I"), ("seed", "7"), ("\"quoted\" \u{fc}", "line\nbreak"), ("a", "")] {
        policy.metadata.insert(key.into(), value.into());
    }
    policy
}

/// The tensors and the header of a valid policy file. A test changes them and serializes them again.
struct Parts {
    tensors: Vec<(String, Dtype, Vec<usize>, Vec<u8>)>,
    header: String,
}

impl Parts {
    fn new() -> Self {
        let bytes = policy().to_bytes().expect("finite weights");
        let file = SafeTensors::deserialize(&bytes).expect("safetensors");
        let (_, metadata) = SafeTensors::read_metadata(&bytes).expect("safetensors");
        let header = metadata.metadata().as_ref().expect("metadata")["wayfield"].clone();
        let mut tensors: Vec<_> = file
            .iter()
            .map(|(name, t)| (name.to_string(), t.dtype(), t.shape().to_vec(), t.data().to_vec()))
            .collect();
        tensors.sort_by(|a, b| a.0.cmp(&b.0));
        Self { tensors, header }
    }

    /// The error from reading a file with these parts.
    fn error(&self) -> PolicyError {
        let tensors = self.tensors.iter().map(|(name, dtype, shape, data)| {
            (name, TensorView::new(*dtype, shape.clone(), data).expect("data that fits the shape"))
        });
        let metadata = HashMap::from([("wayfield".to_string(), self.header.clone())]);
        let bytes = safetensors::serialize(tensors, Some(metadata)).expect("safetensors");
        Policy::from_bytes(&bytes).expect_err("a changed file")
    }

    fn tensor(&mut self, name: &str) -> &mut (String, Dtype, Vec<usize>, Vec<u8>) {
        self.tensors.iter_mut().find(|t| t.0 == name).expect("this tensor")
    }
}

#[test]
fn a_policy_is_read_as_it_was_written_and_equal_policies_give_equal_bytes() {
    let (one, bytes) = (policy(), policy().to_bytes().expect("finite weights"));
    assert_eq!(Policy::from_bytes(&bytes).expect("a valid file"), one);
    for _ in 0..20 {
        assert_eq!(policy().to_bytes().expect("finite weights"), bytes, "equal policies give equal bytes");
    }
    for (hidden, dueling) in [(vec![], false), (vec![8], false), (vec![8, 8, 8], true)] {
        let policy = learner(&hidden, dueling).policy();
        let bytes = policy.to_bytes().expect("finite weights");
        assert_eq!(Policy::from_bytes(&bytes), Ok(policy), "hidden layers {hidden:?}");
    }
}

#[test]
fn every_kind_of_invalid_file_has_its_own_error() {
    let error = Policy::from_bytes(b"not a policy at all").expect_err("not safetensors");
    assert!(matches!(error, PolicyError::NotSafetensors(_)), "{error}");

    let foreign = safetensors::serialize(Vec::<(String, TensorView<'_>)>::new(), None).expect("safetensors");
    let error = Policy::from_bytes(&foreign).expect_err("a file of another program");
    assert!(matches!(error, PolicyError::NotWayfield(_)), "{error}");

    let mut parts = Parts::new();
    parts.header = parts.header.replace("\"version\":1", "\"version\":99");
    assert_eq!(parts.error(), PolicyError::Version { found: 99 });

    let mut parts = Parts::new();
    parts.header = "{".into();
    assert!(matches!(parts.error(), PolicyError::NotWayfield(_)));

    let mut parts = Parts::new();
    parts.tensors.retain(|t| t.0 != "value.bias");
    let error = parts.error();
    assert_eq!(error, PolicyError::MissingTensor { name: "value.bias".into(), expected: vec![1] });
    assert!(error.to_string().contains("value.bias"), "{error}");

    let mut parts = Parts::new();
    parts.tensor("hidden.0.weight").2 = vec![6, 5];
    let error = parts.error().to_string();
    for part in ["hidden.0.weight", "[6, 5]", "[5, 6]"] {
        assert!(error.contains(part), "`{part}` is not in: {error}");
    }

    let mut parts = Parts::new();
    parts.tensor("hidden.1.bias").1 = Dtype::I32;
    assert!(parts.error().to_string().contains("I32"), "{}", parts.error());

    for value in [f32::NAN, f32::NEG_INFINITY] {
        let mut parts = Parts::new();
        parts.tensor("advantage.weight").3[8..12].copy_from_slice(&value.to_le_bytes());
        let error = parts.error();
        assert!(
            matches!(&error, PolicyError::NonFinite { name, index: 2, .. } if name == "advantage.weight"),
            "{error}"
        );
    }
}

#[test]
fn a_small_file_that_claims_a_huge_network_is_rejected_without_allocating_it() {
    for hidden in ["[4096,4096,4096,4096,4096]", "[18446744073709551615]", "[1000000000,1000000000]", "[0]"] {
        let mut parts = Parts::new();
        parts.header = parts.header.replace("[5,4]", hidden);
        assert!(matches!(parts.error(), PolicyError::InvalidShape(_)), "{hidden}: {}", parts.error());
    }
    let mut parts = Parts::new();
    parts.header = parts.header.replace("[5,4]", "[4096,2048]");
    assert!(
        matches!(parts.error(), PolicyError::TensorMismatch { .. }),
        "within the limits, but not the shape of the tensors"
    );
}

#[test]
fn a_transfer_requires_the_same_network_shape() {
    let mut learner = learner(&[5], true);
    let error = learner.load_weights(&policy(), None).expect_err("another network").to_string();
    assert!(
        error.contains("6-5-4-dueling 3") && error.contains("6-5-dueling 3"),
        "both shapes are in: {error}"
    );
    let network = NetworkConfig { hidden: vec![5], layer_norm: true, ..NetworkConfig::default() };
    let normalized = Learner::new(&LearningConfig { network, ..LearningConfig::default() }, 6, 3, 1, 1);
    let normalized = normalized.expect("a valid config").policy();
    let error = learner.load_weights(&normalized, None).expect_err("another network").to_string();
    assert!(
        error.contains("use a config with the network 6-5-dueling 3 with layer norm and relu"),
        "{error}"
    );
    let same = learner.policy();
    assert_eq!(learner.load_weights(&same, Some(1.5)), Err(LoadWeightsError::InvalidEpsilon(1.5)));
}

#[test]
fn the_policy_crate_and_the_learner_compute_the_same_q_values() {
    let mut noise = stream(4, "policy core", 0);
    for activation in Activation::ALL {
        for layer_norm in [false, true] {
            for (hidden, dueling) in
                [(vec![], false), (vec![], true), (vec![64, 64], true), (vec![7, 3, 5], false)]
            {
                compare(&NetworkConfig { hidden, dueling, layer_norm, activation }, &mut noise);
            }
        }
    }
}

/// Compares the forward passes of the policy crate and of the learner with random weights and observations.
fn compare(config: &NetworkConfig, noise: &mut Stream) {
    let shape = config.shape(28, 5).expect("a valid shape");
    let mut network = QNetwork::new(shape.clone(), noise).expect("a valid shape");
    // Makes the scales and shifts of layer normalization differ from those of a new network.
    network.update(|parameters| parameters.iter_mut().for_each(|p| *p += 0.1 * normal(noise)));
    let policy = network.to_policy();
    let rows = 300;
    let observations: Vec<f32> = (0..rows * shape.inputs).map(|_| normal(noise)).collect();
    let (mut expected, mut scratch) = (Vec::new(), Scratch::default());
    network.q_values(&observations, rows, &mut expected);
    for (observation, expected) in observations.chunks(shape.inputs).zip(expected.chunks(shape.actions)) {
        let q = policy.q_values(observation, &mut scratch);
        for (q, expected) in q.iter().zip(expected) {
            let error = (q - expected).abs();
            assert!(error < 2e-5 * (1.0 + expected.abs()), "{shape}: {q} instead of {expected}");
        }
    }
    let bytes = policy.to_bytes().expect("finite weights");
    assert_eq!(Policy::from_bytes(&bytes), Ok(policy), "{shape} is read as it was written");
}

proptest! {
    #[test]
    fn a_changed_byte_causes_no_panic_and_a_truncated_file_is_an_error(
        at in any::<prop::sample::Index>(),
        byte in any::<u8>(),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut bytes = policy().to_bytes().expect("finite weights");
        let at = at.index(bytes.len());
        bytes[at] = byte;
        let _ = Policy::from_bytes(&bytes);
        prop_assert!(Policy::from_bytes(&bytes[..cut.index(bytes.len())]).is_err(), "a truncated file is an error");
    }
}
