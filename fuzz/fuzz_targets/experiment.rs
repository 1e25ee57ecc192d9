#![no_main]
//! Any bytes as an experiment.

#[allow(dead_code, reason = "each target is one of these")]
#[path = "../../tests/support/untrusted_input.rs"]
mod untrusted_input;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    untrusted_input::experiment(bytes);
});
