//! Named streams of random numbers: every draw of wayfield comes from one of these.
//!
//! In: a run's seed, the name of what the numbers are for, and an index (an arena, a navigation). Out: a
//! [`Stream`], the same on every machine, that can be saved in a checkpoint and taken up again to the bit.
//! Streams of different names or indices share nothing, so drawing more from one never shifts another.

use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// One seeded stream of random numbers (PCG XSL 128/64), with a state that serde can save.
pub type Stream = Pcg64Mcg;

/// The stream called `name`, number `index`, of the run with `seed`.
#[must_use]
pub fn stream(seed: u64, name: &str, index: u64) -> Stream {
    let mut hash = mix(seed);
    for &byte in name.as_bytes() {
        hash = mix(hash ^ u64::from(byte));
    }
    hash = mix(hash ^ 0xFF00);
    let low = mix(hash ^ index);
    let high = mix(low ^ 0xA5A5_5A5A);
    let mut bytes = [0_u8; 16];
    bytes[..8].copy_from_slice(&low.to_le_bytes());
    bytes[8..].copy_from_slice(&high.to_le_bytes());
    Stream::from_seed(bytes)
}

/// Whether `stream`, read from a file, can be one of [`stream`]'s: its state is odd, as that of every such generator is.
/// (From an even one it would soon give the same number for ever.)
#[must_use]
pub fn is_valid(stream: &Stream) -> bool {
    // Its state is all that is written of it, least significant bits first.
    postcard::to_allocvec(stream).is_ok_and(|state| state.first().is_some_and(|low| low & 1 == 1))
}

/// A draw from [0, 1), in steps of 2^-24.
pub fn uniform_01(stream: &mut Stream) -> f32 {
    (stream.next_u32() >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// A draw from [low, high), evenly.
pub fn uniform(stream: &mut Stream, low: f32, high: f32) -> f32 {
    low + (high - low) * uniform_01(stream)
}

/// A draw from 0, 1, ..., `count` - 1, evenly. `count` must not be 0.
pub fn uniform_index(stream: &mut Stream, count: usize) -> usize {
    stream.random_range(0..count as u64) as usize
}

/// A draw from all numbers of 64 bits.
pub fn random_u64(stream: &mut Stream) -> u64 {
    stream.next_u64()
}

/// A draw from the normal distribution with mean 0 and standard deviation 1 (Box and Muller's method, by
/// `libm`, so that the bits do not depend on the platform's own logarithm).
pub fn normal(stream: &mut Stream) -> f32 {
    let radius = libm::sqrtf(-2.0 * libm::logf(1.0 - uniform_01(stream)));
    radius * libm::cosf(core::f32::consts::TAU * uniform_01(stream))
}

/// SplitMix64's finalizer: every bit of `x` reaches every bit of the result.
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
    fn a_stream_is_told_by_seed_name_and_index() {
        let first = |seed, name, index| stream(seed, name, index).next_u64();
        assert_eq!(first(7, "starts", 3), first(7, "starts", 3), "same key, same numbers");
        for other in [first(8, "starts", 3), first(7, "start", 3), first(7, "starts", 4)] {
            assert_ne!(first(7, "starts", 3), other, "another key, other numbers");
        }
    }

    #[test]
    fn a_saved_stream_goes_on_where_it_was() {
        let mut one = stream(1, "noise", 0);
        one.next_u64();
        let saved = postcard::to_allocvec(&one).expect("a stream serializes");
        let mut two: Stream = postcard::from_bytes(&saved).expect("and comes back");
        assert_eq!(one.next_u64(), two.next_u64());
    }

    #[test]
    fn a_stream_with_an_even_state_is_none_of_ours() {
        for index in 0..100 {
            let mut sound = stream(1, "noise", index);
            assert!(is_valid(&sound), "at its start");
            sound.next_u64();
            assert!(is_valid(&sound), "and later");
        }
        for even in [0_u128, 2, 1 << 127, u128::MAX - 1] {
            let bytes = postcard::to_allocvec(&even).expect("a number serializes");
            let stream: Stream = postcard::from_bytes(&bytes).expect("and is read as a state");
            assert!(!is_valid(&stream), "{even}");
        }
    }

    #[test]
    fn draws_have_the_moments_they_promise() {
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
        assert!((squares / n - 1.0).abs() < 0.02, "and variance 1");
        assert!((units / n - 0.5).abs() < 0.005, "uniform draws have mean 1/2");
        assert!((0..1000).all(|_| uniform_index(&mut s, 5) < 5));
    }
}
