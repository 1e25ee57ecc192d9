//! The activation functions of the hidden layers, and their names in a policy file.

use serde::{Deserialize, Serialize};

/// The activation function of the hidden layers. It is applied to each unit separately.
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
            // Not `x.max(0.0)`, which hides a NaN.
            Self::Relu => replace(values, |x| if x <= 0.0 { 0.0 } else { x }),
            // exp(x) - 1 = 2 t / (1 - t) with t = tanh(x / 2); the relative error is below 1e-6.
            Self::Elu => replace(values, |x| {
                let t = tanh(0.5 * x);
                if x > 0.0 { x } else { 2.0 * t / (1.0 - t) }
            }),
            Self::Silu => replace(values, |x| x * sigmoid(x)),
            Self::Tanh => replace(values, tanh),
        }
    }
}

fn replace(values: &mut [f32], function: impl Fn(f32) -> f32) {
    values.iter_mut().for_each(|value| *value = function(*value));
}

/// 1 / (1 + exp(-x)), with an absolute error below 3e-7.
#[must_use]
pub fn sigmoid(x: f32) -> f32 {
    0.5 + 0.5 * tanh(0.5 * x)
}

/// The hyperbolic tangent, with a relative error below 5e-7: a rational approximation with the coefficients of Eigen's
/// `ptanh`. It takes only sums, products and a quotient, so the compiler vectorizes it (libm's is ten times slower), and it
/// gives the same bits on every platform.
#[must_use]
pub fn tanh(x: f32) -> f32 {
    // From here on, the result is 1, with an error below 4e-8.
    const LARGE: f32 = 9.0;
    const NUMERATOR: [f32; 7] = [
        -2.760_768_4e-16,
        2.000_188e-13,
        -8.604_672e-11,
        5.122_297_1e-8,
        1.485_722_36e-5,
        6.372_619_3e-4,
        4.893_524_6e-3,
    ];
    const DENOMINATOR: [f32; 4] = [1.198_258_4e-6, 1.185_347_1e-4, 2.268_434_7e-3, 4.893_525e-3];
    let bounded = x.clamp(-LARGE, LARGE);
    let square = bounded * bounded;
    let polynomial = |coefficients: &[f32]| coefficients.iter().fold(0.0, |sum, c| sum * square + c);
    let ratio = bounded * polynomial(&NUMERATOR) / polynomial(&DENOMINATOR);
    if x.abs() >= LARGE { 1.0_f32.copysign(x) } else { ratio }
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
            let mut nan = [f32::NAN];
            activation.apply(&mut nan);
            assert!(nan[0].is_nan(), "{activation:?} of NaN is {}", nan[0]);
        }
    }

    #[test]
    fn tanh_and_the_functions_computed_from_it_are_as_accurate_as_documented() {
        for i in -200_000..=200_000 {
            let x = i as f32 * 1e-4;
            let (exact, f64_x) = (f64::from(x).tanh(), f64::from(x));
            let error = (f64::from(tanh(x)) - exact).abs();
            assert!(error <= 5e-7 * exact.abs(), "tanh({x}) is {}, not {exact}", tanh(x));
            let exact = 1.0 / (1.0 + (-f64_x).exp());
            assert!((f64::from(sigmoid(x)) - exact).abs() < 3e-7, "sigmoid({x}) is {}", sigmoid(x));
            let mut elu = [x];
            Activation::Elu.apply(&mut elu);
            let exact = if x > 0.0 { f64_x } else { f64_x.exp_m1() };
            assert!((f64::from(elu[0]) - exact).abs() <= 1e-6 * exact.abs(), "ELU({x}) is {}", elu[0]);
        }
        assert_eq!([0.0, 9.0, f32::INFINITY, f32::MIN].map(tanh), [0.0, 1.0, 1.0, -1.0]);
        let mut low = [f32::MIN, -100.0];
        Activation::Silu.apply(&mut low);
        assert_eq!(low, [0.0, 0.0]);
        assert!(tanh(f32::NAN).is_nan() && sigmoid(f32::NAN).is_nan());
    }
}
