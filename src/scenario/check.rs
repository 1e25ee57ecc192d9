//! Whether a scenario can be meant: every number in its range, everything inside the walls, room for the
//! task.
//!
//! In: a [`Scenario`] that was read or built. Out: [`Finding`]s, each with the field's path and the mend;
//! none when all is well. The limits also keep a hostile file from taking memory or time: a scenario without
//! findings is safe to run.

mod numbers;
mod space;

use std::fmt;
use std::ops::RangeInclusive;

use super::file_error::Finding;
use super::schema::Scenario;

/// All that is wrong with `scenario`. Whether there is room for the task is asked only when the numbers are
/// sound.
#[must_use]
pub fn findings(scenario: &Scenario) -> Vec<Finding> {
    let mut notes = Notes(Vec::new());
    numbers::check(scenario, &mut notes);
    if notes.0.is_empty() {
        space::check(scenario, &mut notes);
    }
    notes.0
}

/// The findings so far.
struct Notes(Vec<Finding>);

impl Notes {
    fn add(&mut self, path: fmt::Arguments<'_>, message: impl Into<String>) {
        self.0.push(Finding { path: path.to_string(), message: message.into() });
    }

    /// Notes `value` unless it lies in `range`; NaN lies in none.
    fn number<T>(&mut self, path: fmt::Arguments<'_>, value: T, range: RangeInclusive<T>, unit: &str)
    where
        T: PartialOrd + fmt::Display,
    {
        if !range.contains(&value) {
            let (low, high) = (range.start(), range.end());
            self.add(path, format!("is {value}: write a number from {low} to {high}{unit}"));
        }
    }

    /// Notes a list of `count` entries unless it has as many as `range` says.
    fn count(&mut self, path: fmt::Arguments<'_>, count: usize, range: RangeInclusive<usize>) {
        if !range.contains(&count) {
            let (low, high) = (range.start(), range.end());
            self.add(path, format!("has {count} entries: write {low} to {high} of them"));
        }
    }

    /// Notes `value` unless it is greater than `bound`, which is called `what`, or was noted before.
    fn above(&mut self, path: fmt::Arguments<'_>, value: f32, bound: f32, what: &str) {
        if value <= bound && !self.0.iter().any(|finding| finding.path == path.to_string()) {
            self.add(path, format!("is {value}: write more than {what}, {bound} m"));
        }
    }
}
