//! Named streams of random numbers. All randomness of wayfield comes from them.
//!
//! [`stream`] derives a [`Stream`] from a run's seed, a purpose (a name) and an index (of an arena or an episode). The
//! numbers are the same on every machine, and a checkpoint can save a stream and resume it exactly. Streams with
//! different names or indices are independent: drawing more numbers from one never changes another.
//!
//! ```
//! use wayfield_random::{normal, stream, uniform, uniform_index};
//!
//! let mut noise = stream(42, "noise", 0);
//! let error_m = 0.01 * normal(&mut noise);
//! let angle_rad = uniform(&mut noise, -1.0, 1.0);
//! let action = uniform_index(&mut noise, 5);
//! assert!(error_m.abs() < 0.1 && (-1.0..1.0).contains(&angle_rad) && action < 5);
//!
//! // The same seed, name and index give the same numbers.
//! assert_eq!(normal(&mut stream(42, "noise", 0)), normal(&mut stream(42, "noise", 0)));
//! assert_ne!(normal(&mut stream(42, "noise", 0)), normal(&mut stream(42, "noise", 1)));
//! ```

use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// A seeded stream of random numbers (PCG XSL 128/64 (MCG)), whose state serde can save.
pub type Stream = Pcg64Mcg;

/// The stream with this `name` and `index` in the run with this `seed`.
#[must_use]
pub fn stream(seed: u64, name: &str, index: u64) -> Stream {
    let mut hash = mix(seed);
    for &byte in name.as_bytes() {
        hash = mix(hash ^ u64::from(byte));
    }
    // Separates the name from the index: no byte has this value.
    hash = mix(hash ^ 0xFF00);
    let low = mix(hash ^ index);
    let high = mix(low ^ 0xA5A5_5A5A);
    let mut bytes = [0_u8; 16];
    bytes[..8].copy_from_slice(&low.to_le_bytes());
    bytes[8..].copy_from_slice(&high.to_le_bytes());
    Stream::from_seed(bytes)
}

/// Whether `stream`, read from a file, has a state that [`stream`] can produce: an odd one. From an even state, the
/// generator has a shorter period, down to a single number.
#[must_use]
pub fn is_valid(stream: &Stream) -> bool {
    // The serialized form is the state alone, least significant bits first.
    postcard::to_allocvec(stream).is_ok_and(|state| state.first().is_some_and(|low| low & 1 == 1))
}

/// A uniform draw from [0, 1), in steps of 2^-24.
pub fn uniform_01(stream: &mut Stream) -> f32 {
    (stream.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// A uniform draw from [0, 1) in steps of 2^-53, which are fine enough to reach each of 10^6 indices of a sum tree.
pub fn uniform_f64(stream: &mut Stream) -> f64 {
    (random_u64(stream) >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
}

/// A uniform draw from [low, high). Rounding can also give `high`.
pub fn uniform(stream: &mut Stream, low: f32, high: f32) -> f32 {
    low + (high - low) * uniform_01(stream)
}

/// A uniform draw from 0, 1, ..., `count` - 1.
///
/// # Panics
/// If `count` is 0.
pub fn uniform_index(stream: &mut Stream, count: usize) -> usize {
    stream.random_range(0..count as u64) as usize
}

/// A uniform draw from all 64-bit numbers.
pub fn random_u64(stream: &mut Stream) -> u64 {
    stream.next_u64()
}

/// A seed that is a function of the state of the stream `from`, the `name` and the `index`. Nothing is drawn from that stream.
#[must_use]
pub fn derived_seed(from: &Stream, name: &str, index: u64) -> u64 {
    let state = random_u64(&mut from.clone());
    random_u64(&mut stream(state, name, index))
}

/// A draw from the normal distribution with mean 0 and standard deviation 1, by the Box-Muller transform. It uses `libm`,
/// so that the bits do not depend on the platform's logarithm and cosine.
pub fn normal(stream: &mut Stream) -> f32 {
    let radius = libm::sqrtf(-2.0 * libm::logf(1.0 - uniform_01(stream)));
    radius * libm::cosf(core::f32::consts::TAU * uniform_01(stream))
}

/// The finalizer of SplitMix64: every bit of `x` affects every bit of the result.
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seed_name_and_index_identify_a_stream() {
        let first = |seed, name, index| stream(seed, name, index).next_u64();
        assert_eq!(first(7, "starts", 3), first(7, "starts", 3), "equal keys give equal numbers");
        for other in [first(8, "starts", 3), first(7, "start", 3), first(7, "starts", 4)] {
            assert_ne!(first(7, "starts", 3), other, "a different key gives different numbers");
        }
    }

    #[test]
    fn a_saved_stream_continues_where_it_stopped() {
        let mut one = stream(1, "noise", 0);
        one.next_u64();
        let saved = postcard::to_allocvec(&one).expect("a stream serializes");
        let mut two: Stream = postcard::from_bytes(&saved).expect("a stream deserializes");
        assert_eq!(one.next_u64(), two.next_u64());
    }

    #[test]
    fn a_stream_with_an_even_state_is_invalid() {
        for index in 0..100 {
            let mut valid = stream(1, "noise", index);
            assert!(is_valid(&valid), "initially");
            valid.next_u64();
            assert!(is_valid(&valid), "after a draw");
        }
        for even in [0_u128, 2, 1 << 127, u128::MAX - 1] {
            let bytes = postcard::to_allocvec(&even).expect("a number serializes");
            let stream: Stream = postcard::from_bytes(&bytes).expect("any number is read as a state");
            assert!(!is_valid(&stream), "{even}");
        }
    }

    #[test]
    fn draws_have_the_documented_mean_and_variance() {
        let mut s = stream(3, "moments", 0);
        let n = 200_000;
        let (mut sum, mut squares, mut units) = (0.0_f64, 0.0_f64, 0.0_f64);
        for _ in 0..n {
            let x = f64::from(normal(&mut s));
            sum += x;
            squares += x * x;
            let u = uniform_01(&mut s);
            assert!((0.0..1.0).contains(&u));
            units += f64::from(u);
        }
        let n = f64::from(n);
        assert!((sum / n).abs() < 0.01, "normal draws have mean 0");
        assert!((squares / n - 1.0).abs() < 0.02, "normal draws have variance 1");
        assert!((units / n - 0.5).abs() < 0.005, "uniform draws have mean 1/2");
        assert!((0..1000).all(|_| uniform_index(&mut s, 5) < 5));
    }
}
