//! The checks of a scenario: ranges of numbers, geometry inside the enclosure, free space, reachability.
//!
//! In: a [`Scenario`], read from a file or built in code. Out: a [`Diagnostic`] with field path and fix for each problem, and
//! a [`Note`] for each doubtful setting of a scenario that can be run.
//! The limits also keep a hostile file from taking memory or time: a scenario without diagnostics is safe to run.
//!
//! | file | duty |
//! |---|---|
//! | `numbers.rs` | ranges of numbers, comparisons between numbers |
//! | `obstacles.rs` | the same for walls, obstacles and generators |
//! | `polygons.rs` | corners of polygons: simple and, for obstacles, convex |
//! | `speeds.rs` | distances travelled by robot and obstacles in one control step; obstacles faster than the robot |
//! | `motions.rs` | the robot moves, and the time limit allows for the nearest goals |
//! | `space.rs` | geometry inside the enclosure; free space for starts, goals and the benchmark route |
//! | `extent.rs` | how far an obstacle reaches outside the enclosure along its whole path |
//! | `reachability.rs`, `grid.rs` | a path for the robot from every start to every goal |
//! | `time_limit.rs`, `turning.rs` | notes: goals out of reach within the time limit, no space to turn round |
//! | `overlaps.rs`, `swept_path.rs`, `convex.rs` | notes: obstacles that overlap or cross walls and each other |

mod convex;
mod extent;
mod grid;
mod motions;
mod numbers;
mod obstacles;
mod overlaps;
mod polygons;
mod reachability;
mod space;
mod speeds;
mod swept_path;
mod time_limit;
mod turning;

pub(crate) use convex::RoundedArea;
pub(crate) use grid::{CellGrid, ConnectedRegions};
pub(crate) use obstacles::check_random_shape;
pub(crate) use reachability::{RegionSite, blocked, sites};

use std::fmt;
use std::ops::RangeInclusive;

use super::file_error::Diagnostic;
use super::limits::COORDINATE_M;
use super::note::{Note, NoteLevel};
use super::schema::Scenario;
use glam::Vec2;

pub(crate) const METRES: &str = " (metres)";
pub(crate) const METRES_PER_SECOND: &str = " (metres per second)";
const SECONDS: &str = " (seconds)";
const RADIANS: &str = " (radians: a full turn is 6.2832)";
const RADIANS_PER_SECOND: &str = " (radians per second)";

/// All problems of `scenario`. Free space is checked only if all numbers are valid, reachability only if there is free
/// space.
#[must_use]
pub fn diagnostics(scenario: &Scenario) -> Vec<Diagnostic> {
    let mut diagnostics = Diagnostics(Vec::new());
    for check in [numbers::check, motions::check, space::check, reachability::check] {
        if diagnostics.0.is_empty() {
            check(scenario, &mut diagnostics);
        }
    }
    diagnostics.0
}

/// The doubtful settings of `scenario`, the more important ones first. None for a scenario with invalid numbers.
#[must_use]
pub fn notes(scenario: &Scenario) -> Vec<Note> {
    let mut notes = Vec::new();
    if value_diagnostics(scenario).is_empty() && motions::max_speed_m_s(&scenario.robot) > 0.0 {
        for check in [time_limit::check, turning::check, speeds::note_fast_obstacles, overlaps::check] {
            check(scenario, &mut notes);
        }
    }
    notes
}

/// The invalid numbers of `scenario`. A scenario without them can be drawn and edited, but perhaps not run.
#[must_use]
pub fn value_diagnostics(scenario: &Scenario) -> Vec<Diagnostic> {
    let mut diagnostics = Diagnostics(Vec::new());
    numbers::check(scenario, &mut diagnostics);
    diagnostics.0
}

/// Whether `scenario` passes all checks but that of reachability.
pub(crate) fn has_valid_space(scenario: &Scenario) -> bool {
    let mut diagnostics = Diagnostics::default();
    check_robot_and_task(scenario, &mut diagnostics);
    if diagnostics.is_empty() {
        space::check(scenario, &mut diagnostics);
    }
    diagnostics.is_empty()
}

/// Checks the single values of a scenario, of which some parts are not final, and the motions of its robot.
pub(crate) fn check_robot_and_task(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    numbers::check(scenario, diagnostics);
    if diagnostics.is_empty() {
        motions::check(scenario, diagnostics);
    }
}

/// The diagnostics collected so far.
#[derive(Default)]
pub(crate) struct Diagnostics(Vec<Diagnostic>);

impl Diagnostics {
    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// All of them, in the order of the checks.
    pub(crate) fn into_vec(self) -> Vec<Diagnostic> {
        self.0
    }

    /// Reports a problem of the field at `path`.
    pub(crate) fn push(&mut self, path: fmt::Arguments<'_>, message: impl Into<String>) {
        self.0.push(Diagnostic { path: path.to_string(), message: message.into() });
    }

    /// Reports `value` if it lies outside `range`; NaN always does.
    pub(crate) fn check_range<T>(
        &mut self,
        path: fmt::Arguments<'_>,
        value: T,
        range: RangeInclusive<T>,
        unit: &str,
    ) where
        T: PartialOrd + fmt::Display,
    {
        if !range.contains(&value) {
            let (low, high) = (range.start(), range.end());
            self.push(path, format!("is {value}: write a number from {low} to {high}{unit}"));
        }
    }

    /// Reports coordinates outside the range of the largest enclosure.
    fn check_point(&mut self, path: fmt::Arguments<'_>, Vec2 { x, y }: Vec2) {
        self.check_range(format_args!("{path}[0]"), x, COORDINATE_M, METRES);
        self.check_range(format_args!("{path}[1]"), y, COORDINATE_M, METRES);
    }

    /// Reports a list whose length `count` lies outside `range`.
    pub(crate) fn check_count(
        &mut self,
        path: fmt::Arguments<'_>,
        count: usize,
        range: RangeInclusive<usize>,
    ) {
        if !range.contains(&count) {
            let (low, high) = (range.start(), range.end());
            self.push(path, format!("has {count} entries: write {low} to {high}"));
        }
    }

    /// Reports a list of points whose length lies outside `range`, and each point with a coordinate out of range.
    fn check_points(&mut self, path: fmt::Arguments<'_>, points: &[Vec2], range: RangeInclusive<usize>) {
        let most = *range.end();
        self.check_count(path, points.len(), range);
        for (k, &point) in points.iter().enumerate().take(most) {
            self.check_point(format_args!("{path}[{k}]"), point);
        }
    }

    /// Reports `value` if it is not greater than `bound`, which the message calls `what`. A field that was reported before
    /// is not reported again.
    pub(crate) fn check_above(&mut self, path: fmt::Arguments<'_>, value: f32, bound: f32, what: &str) {
        if value <= bound && !self.0.iter().any(|found| found.path == path.to_string()) {
            self.push(path, format!("is {value}: write more than {what}, {bound} m"));
        }
    }
}

/// `most` rounded down to three decimals, or to three digits if it is small, so that the printed number is allowed.
fn rounded_down(most: f32) -> String {
    let most = f64::from(most);
    let places = if most > 0.0 { (-libm::log10(most).floor()).clamp(0.0, 9.0) as usize + 2 } else { 3 };
    let places = places.max(3);
    let scale = libm::pow(10.0, places as f64);
    // The factor restores round numbers that lost their last bit in a division.
    format!("{:.places$}", (most * scale * (1.0 + 1e-7)).floor() / scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_is_rounded_down_but_keeps_three_digits() {
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
