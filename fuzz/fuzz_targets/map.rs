#![no_main]
//! Fuzzes the import of maps.

#[allow(dead_code, reason = "each target uses one reader")]
#[path = "../../tests/support/untrusted_input.rs"]
mod untrusted_input;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    untrusted_input::map(bytes);
});
