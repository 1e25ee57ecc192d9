//! Parsers for option values.

use std::time::Duration;

use crate::limits::MAX_STEPS;

/// Parses a number of episodes or env steps.
pub fn budget(text: &str) -> Result<u64, String> {
    let value = text.parse().ok().filter(|n| (1..=MAX_STEPS).contains(n));
    value.ok_or_else(|| format!("give a whole number from 1 to {MAX_STEPS}"))
}

/// Parses a time in s.
pub fn seconds(text: &str) -> Result<Duration, String> {
    let value = text.parse().ok().filter(|s| (0.01..=1e6).contains(s));
    value.map(Duration::from_secs_f64).ok_or_else(|| "give 0.01 to 1000000 seconds".into())
}

/// Parses a seed.
pub fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("give a whole number from 0 to {}", u64::MAX))
}
