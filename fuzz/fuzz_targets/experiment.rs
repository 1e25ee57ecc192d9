#![no_main]
//! Any bytes as an experiment.

#[allow(dead_code, reason = "each target is one of these")]
#[path = "../../tests/support/strangers.rs"]
mod strangers;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    strangers::experiment(bytes);
});
