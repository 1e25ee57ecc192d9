//! Whether a scenario can be meant: every number in its range, everything inside the walls, room for the
//! task, a way from every start to every goal.
//!
//! In: a [`Scenario`] that was read or built. Out: [`Diagnostic`]s, each with the field's path and the mend;
//! none when all is well. The limits also keep a hostile file from taking memory or time: a scenario without
//! findings is safe to run.
//!
//! | file | duty |
//! |---|---|
//! | `numbers.rs` | each number against its range, and against those it must fit |
//! | `obstacles.rs` | the same for walls, obstacles and generators |
//! | `polygons.rs` | the corners of polygons: that they make an outline |
//! | `speeds.rs` | how far robot and obstacles come in one control step |
//! | `space.rs` | everything inside the enclosure; room for starts, goals and the benchmark route |
//! | `extent.rs` | how far an obstacle reaches beyond the enclosure, on its whole way |
//! | `reachability.rs`, `grid.rs` | whether the robot can get from every start to every goal |

mod extent;
mod grid;
mod numbers;
mod obstacles;
mod polygons;
mod reachability;
mod space;
mod speeds;

use std::fmt;
use std::ops::RangeInclusive;

use super::file_error::Diagnostic;
use super::schema::Scenario;
use glam::Vec2;

const METRES: &str = " (metres)";
const METRES_PER_SECOND: &str = " (metres a second)";
const SECONDS: &str = " (seconds)";
const RADIANS: &str = " (radians: a full turn is 6.2832)";
const RADIANS_PER_SECOND: &str = " (radians a second)";
/// A full turn either way, with a little room for rounding.
const MAX_ANGLE_RAD: f32 = 6.3;

/// All that is wrong with `scenario`. Whether there is room for the task is asked only when the numbers are
/// sound, and whether there is a way only when there is room.
#[must_use]
pub fn diagnostics(scenario: &Scenario) -> Vec<Diagnostic> {
    let mut diagnostics = Diagnostics(Vec::new());
    for check in [numbers::check, space::check, reachability::check] {
        if diagnostics.0.is_empty() {
            check(scenario, &mut diagnostics);
        }
    }
    diagnostics.0
}

/// What is wrong with the numbers of `scenario`: without such findings it can be drawn and edited, though perhaps not
/// driven in.
#[must_use]
pub fn value_diagnostics(scenario: &Scenario) -> Vec<Diagnostic> {
    let mut diagnostics = Diagnostics(Vec::new());
    numbers::check(scenario, &mut diagnostics);
    diagnostics.0
}

/// The findings so far.
struct Diagnostics(Vec<Diagnostic>);

impl Diagnostics {
    fn push(&mut self, path: fmt::Arguments<'_>, message: impl Into<String>) {
        self.0.push(Diagnostic { path: path.to_string(), message: message.into() });
    }

    /// Reports `value` unless it lies in `range`; NaN lies in none.
    fn check_range<T>(&mut self, path: fmt::Arguments<'_>, value: T, range: RangeInclusive<T>, unit: &str)
    where
        T: PartialOrd + fmt::Display,
    {
        if !range.contains(&value) {
            let (low, high) = (range.start(), range.end());
            self.push(path, format!("is {value}: write a number from {low} to {high}{unit}"));
        }
    }

    /// Reports coordinates that lie beyond the largest enclosure there is.
    fn check_point(&mut self, path: fmt::Arguments<'_>, Vec2 { x, y }: Vec2) {
        self.check_range(format_args!("{path}[0]"), x, -500.0..=500.0, METRES);
        self.check_range(format_args!("{path}[1]"), y, -500.0..=500.0, METRES);
    }

    /// Reports a list of `count` entries unless it has as many as `range` says.
    fn check_count(&mut self, path: fmt::Arguments<'_>, count: usize, range: RangeInclusive<usize>) {
        if !range.contains(&count) {
            let (low, high) = (range.start(), range.end());
            self.push(path, format!("has {count} entries: write {low} to {high} of them"));
        }
    }

    /// Reports a list of points unless it has as many as `range` says, and each that lies beyond the largest
    /// enclosure.
    fn check_points(&mut self, path: fmt::Arguments<'_>, points: &[Vec2], range: RangeInclusive<usize>) {
        let most = *range.end();
        self.check_count(path, points.len(), range);
        for (k, &point) in points.iter().enumerate().take(most) {
            self.check_point(format_args!("{path}[{k}]"), point);
        }
    }

    /// Reports `value` unless it is greater than `bound`, which is called `what`, or was noted before.
    fn check_above(&mut self, path: fmt::Arguments<'_>, value: f32, bound: f32, what: &str) {
        if value <= bound && !self.0.iter().any(|finding| finding.path == path.to_string()) {
            self.push(path, format!("is {value}: write more than {what}, {bound} m"));
        }
    }
}

/// `most`, rounded down to three places (or three digits, where it is small), so that what is written is
/// allowed.
fn rounded_down(most: f32) -> String {
    let most = f64::from(most);
    let places = if most > 0.0 { (-libm::log10(most).floor()).clamp(0.0, 9.0) as usize + 2 } else { 3 };
    let places = places.max(3);
    let scale = libm::pow(10.0, places as f64);
    // A quotient that should be a round number may have lost its last bit.
    format!("{:.places$}", (most * scale * (1.0 + 1e-7)).floor() / scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_rounded_down_but_not_to_nothing() {
        for (most, text) in [
            (2.5, "2.500"),
            (7.142_857, "7.142"),
            (0.049_99, "0.0499"),
            (0.000_123_9, "0.000123"),
            (0.0, "0.000"),
        ] {
            assert_eq!(rounded_down(most), text);
        }
    }
}
