//! The activation functions of the hidden layers, and their names in a policy file.

use serde::{Deserialize, Serialize};

/// The activation function of the hidden layers. It applies to each unit alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Activation {
    /// max(0, x) (the paper, fig. 5).
    #[default]
    Relu,
    /// x if x > 0, otherwise exp(x) - 1 (Clevert et al. 2016, with alpha = 1).
    Elu,
    /// x / (1 + exp(-x)), also called swish (Elfwing et al. 2018).
    Silu,
    /// The hyperbolic tangent of x.
    Tanh,
}

impl Activation {
    /// All activation functions.
    pub const ALL: [Self; 4] = [Self::Relu, Self::Elu, Self::Silu, Self::Tanh];

    /// The name in a policy file, which is that of the function in `torch.nn.functional`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Relu => "relu",
            Self::Elu => "elu",
            Self::Silu => "silu",
            Self::Tanh => "tanh",
        }
    }

    /// Replaces each of `values` by its function value.
    pub fn apply(self, values: &mut [f32]) {
        match self {
            Self::Relu => replace(values, |x| x.max(0.0)),
            Self::Elu => replace(values, |x| if x > 0.0 { x } else { libm::expm1f(x) }),
            Self::Silu => replace(values, |x| x / (1.0 + libm::expf(-x))),
            Self::Tanh => replace(values, libm::tanhf),
        }
    }
}

fn replace(values: &mut [f32], function: impl Fn(f32) -> f32) {
    values.iter_mut().for_each(|value| *value = function(*value));
}

/// An activation function as its name, for serde's `with`.
pub(crate) mod by_name {
    use serde::de::{Deserialize, Deserializer, Error};
    use serde::ser::Serializer;

    use super::Activation;

    pub(crate) fn serialize<S: Serializer>(activation: &Activation, out: S) -> Result<S::Ok, S::Error> {
        out.serialize_str(activation.name())
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(text: D) -> Result<Activation, D::Error> {
        let name = String::deserialize(text)?;
        let known = Activation::ALL.into_iter().find(|activation| activation.name() == name);
        known.ok_or_else(|| D::Error::unknown_variant(&name, &["relu", "elu", "silu", "tanh"]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn activations_match_calculations_by_hand() {
        // exp(-1) = 0.3678794: ELU(-1) = -0.6321206; SiLU(-1) = -1 / (1 + e) = -0.2689414; tanh(1) = 0.7615942.
        for (activation, expected) in [
            (Activation::Relu, [0.0, 0.0, 1.0]),
            (Activation::Elu, [-0.632_120_6, 0.0, 1.0]),
            (Activation::Silu, [-0.268_941_4, 0.0, 0.731_058_6]),
            (Activation::Tanh, [-0.761_594_2, 0.0, 0.761_594_2]),
        ] {
            let mut values = [-1.0, 0.0, 1.0];
            activation.apply(&mut values);
            for (found, expected) in values.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-6, "{activation:?}: {values:?}");
            }
            let mut extremes = [f32::MIN, f32::MAX];
            activation.apply(&mut extremes);
            assert!(extremes.iter().all(|value| value.is_finite()), "{activation:?}: {extremes:?}");
        }
    }
}
