//! The checks of a scenario: ranges of numbers, geometry inside the enclosure, free space, reachability.
//!
//! In: a [`Scenario`], read from a file or built in code. Out: a [`Diagnostic`] with field path and fix for each
//! problem and, if all values are valid, a [`Note`] for each questionable setting. The limits also keep a hostile file
//! from taking too much memory or time: a scenario without diagnostics is safe to run.
//!
//! | file | purpose |
//! |---|---|
//! | `numbers.rs` | ranges of numbers, comparisons between numbers; names and descriptions |
//! | `obstacles.rs`, `key_frames.rs` | the same for walls, obstacles, generators and key frames; notes on motions that stop |
//! | `polygons.rs` | polygons: simple and, for obstacles, convex |
//! | `speeds.rs` | distances travelled by the robot and obstacles in one control step; obstacles faster than the robot |
//! | `motions.rs` | the robot can move, and the time limit is long enough for the nearest goals |
//! | `space.rs` | geometry inside the enclosure; free space for starts, goals and the benchmark route |
//! | `extent.rs` | how far an obstacle reaches outside the enclosure along its whole path |
//! | `reachability.rs`, `grid.rs` | a path for the robot from every start to every goal |
//! | `valid_part.rs` | the valid part of a scenario, for the checks from `motions.rs` to `reachability.rs` |
//! | `time_limit.rs`, `turning.rs` | notes: goals out of reach within the time limit, a robot that can't turn around |
//! | `overlaps.rs`, `swept_path.rs`, `convex.rs` | notes: obstacles that overlap walls or obstacles, or pass through them |

mod convex;
mod extent;
mod grid;
mod key_frames;
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
mod valid_part;

pub(crate) use convex::RoundedArea;
pub use convex::convex_distance;
pub(crate) use grid::{CellGrid, ConnectedRegions};
pub(crate) use numbers::{check_name, check_texts};
pub(crate) use obstacles::check_random_shape;
pub(crate) use reachability::{RegionSite, blocked, sites};
pub(crate) use speeds::{checked_period_s, fastest_m_s};

use std::fmt;
use std::ops::RangeInclusive;

use self::valid_part::ValidPart;
use super::file_error::{Diagnostic, overlap};
use super::limits::COORDINATE_M;
use super::note::{Note, NoteLevel};
use super::ranged::{RangeNumber, Ranged};
use super::schema::{Robot, Scenario, TaskRules};
use glam::Vec2;

// Units, for messages.
pub(crate) const METRES: &str = " (metres)";
pub(crate) const METRES_PER_SECOND: &str = " (metres per second)";
const SECONDS: &str = " (seconds)";
pub(crate) const RADIANS: &str = " (radians: a full turn is 6.2832)";
const RADIANS_PER_SECOND: &str = " (radians per second)";

// Lengths that other lengths must exceed: the description for messages, and the path.
const ROBOT_RADIUS: (&str, &str) = ("the robot's radius", "robot.radius_m");
const GOAL_RADIUS: (&str, &str) = ("the goal radius", "task.goal_radius_m");
const COLLISION_RANGE: (&str, &str) = ("the collision range", "task.collision_range_m");
const TWICE_COLLISION_RANGE: (&str, &str) = ("twice the collision range", "task.collision_range_m");
const ROBOT_REACH: (&str, &str) = ("the reach of the robot's shape", "robot.shape");
const TWICE_ROBOT_REACH: (&str, &str) = ("twice the reach of the robot's shape", "robot.shape");

/// All problems of `scenario`: first invalid values, then parts that do not fit together. A problem of the second kind that
/// depends on an invalid value is not found.
#[must_use]
pub fn diagnostics(scenario: &Scenario) -> Vec<Diagnostic> {
    diagnostics_of_known(scenario, &[])
}

/// Like [`diagnostics`], for a scenario whose values at the paths `unknown` could not be read and are arbitrary. Nothing is
/// reported about those.
#[must_use]
pub fn diagnostics_of_known(scenario: &Scenario, unknown: &[String]) -> Vec<Diagnostic> {
    let mut all = value_diagnostics_of_known(scenario, unknown);
    let invalid = all.iter().map(|found| &found.path).chain(unknown).cloned().collect();
    let valid = ValidPart::new(scenario, invalid);
    let found_by = |check: fn(&ValidPart, &mut Diagnostics)| {
        let mut diagnostics = Diagnostics::default();
        check(&valid, &mut diagnostics);
        diagnostics.found
    };
    let in_whole = |found: Diagnostic| valid.in_whole(found);
    all.extend(found_by(motions::check));
    all.extend(found_by(space::check_walls).into_iter().map(in_whole));
    all.extend(found_by(space::check_paths));
    all.extend(found_by(space::check).into_iter().map(in_whole));
    all.extend(found_by(reachability::check));
    all
}

/// The questionable settings of `scenario`, the more important first. Empty if a value is invalid or the robot can't move.
#[must_use]
pub fn notes(scenario: &Scenario) -> Vec<Note> {
    let mut notes = Vec::new();
    if value_diagnostics(scenario).is_empty() && motions::max_speed_m_s(&scenario.robot) > 0.0 {
        time_limit::check(scenario, &mut notes);
        turning::check(scenario, &mut notes);
        speeds::note_fast_obstacles(scenario, &mut notes);
        key_frames::note_stops(scenario, &mut notes);
        overlaps::check(scenario, &mut notes);
    }
    notes
}

/// The invalid values of `scenario`. A scenario without them can be drawn and edited, but perhaps not run.
#[must_use]
pub fn value_diagnostics(scenario: &Scenario) -> Vec<Diagnostic> {
    value_diagnostics_of_known(scenario, &[])
}

/// Like [`value_diagnostics`], for a scenario whose values at the paths `unknown` could not be read and are arbitrary.
/// Nothing is reported about those.
#[must_use]
pub fn value_diagnostics_of_known(scenario: &Scenario, unknown: &[String]) -> Vec<Diagnostic> {
    let mut diagnostics = Diagnostics { incomparable: unknown.to_vec(), ..Diagnostics::default() };
    numbers::check(scenario, &mut diagnostics);
    let is_unknown = |path: &str| unknown.iter().any(|other| overlap(other, path));
    // A problem of a rectangle's upper corner may come from its comparison with an unknown lower one.
    diagnostics.found.retain(|Diagnostic { path, .. }| {
        !is_unknown(path) && !is_unknown(&path.replace(".max_m[", ".min_m["))
    });
    diagnostics.found
}

/// Whether `scenario` passes all checks except two: that walls and obstacles stay inside the enclosure, and reachability.
pub(crate) fn has_valid_space(scenario: &Scenario) -> bool {
    let mut diagnostics = Diagnostics::default();
    check_robot_and_task(scenario, &mut diagnostics);
    if diagnostics.is_empty() {
        space::check(&ValidPart::new(scenario, Vec::new()), &mut diagnostics);
    }
    diagnostics.is_empty()
}

/// Checks the single values of a scenario and the motions of its robot, but not how its parts fit together.
pub(crate) fn check_robot_and_task(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    numbers::check(scenario, diagnostics);
    let invalid = diagnostics.found.iter().map(|found| found.path.clone()).collect();
    motions::check(&ValidPart::new(scenario, invalid), diagnostics);
}

/// The diagnostics collected so far.
#[derive(Default)]
pub(crate) struct Diagnostics {
    found: Vec<Diagnostic>,
    /// The paths of values that others are not compared with, because they could not be read or are out of range.
    incomparable: Vec<String>,
}

impl Diagnostics {
    /// Whether no problem was found.
    pub(crate) fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// All diagnostics, in the order of the checks.
    pub(crate) fn into_vec(self) -> Vec<Diagnostic> {
        self.found
    }

    /// Reports a problem of the field at `path`.
    pub(crate) fn push(&mut self, path: fmt::Arguments<'_>, message: impl Into<String>) {
        self.found.push(Diagnostic { path: path.to_string(), message: message.into() });
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
            self.incomparable.push(path.to_string());
        }
    }

    /// Reports each of the numbers `low` and `high` that lies outside `range`, and a `low` above `high`.
    pub(crate) fn check_pair<T>(
        &mut self,
        path: fmt::Arguments<'_>,
        (low, high): (T, T),
        range: RangeInclusive<T>,
        unit: &str,
    ) where
        T: PartialOrd + Copy + fmt::Display,
    {
        self.check_range(format_args!("{path}[0]"), low, range.clone(), unit);
        self.check_range(format_args!("{path}[1]"), high, range, unit);
        if low > high {
            self.push(path, format!("is ({low}, {high}): write the smaller number first"));
        }
    }

    /// Checks a number with [`Diagnostics::check_range`], or both numbers of a range with [`Diagnostics::check_pair`].
    fn check_ranged<T: RangeNumber>(
        &mut self,
        path: fmt::Arguments<'_>,
        value: Ranged<T>,
        range: RangeInclusive<T>,
        unit: &str,
    ) {
        match value {
            Ranged::Number(value) => self.check_range(path, value, range, unit),
            Ranged::Range(low, high) => self.check_pair(path, (low, high), range, unit),
        }
    }

    /// Reports coordinates outside the range of the largest enclosure.
    pub(crate) fn check_point(&mut self, path: fmt::Arguments<'_>, Vec2 { x, y }: Vec2) {
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

    /// Reports a distance from surfaces that leaves no space for the robot of `scenario`.
    fn check_clearance(&mut self, path: fmt::Arguments<'_>, clearance_m: f32, scenario: &Scenario) {
        self.check_above(path, clearance_m, scenario.task.collision_range_m, COLLISION_RANGE);
        if scenario.robot.shape.is_some() {
            self.check_above(path, clearance_m, scenario.robot.reach_m(), ROBOT_REACH);
        }
    }

    /// Reports a gap that the robot does not fit through.
    pub(crate) fn check_gap(
        &mut self,
        path: fmt::Arguments<'_>,
        gap_m: f32,
        robot: &Robot,
        task: &TaskRules,
    ) {
        self.check_above(path, gap_m, 2.0 * task.collision_range_m, TWICE_COLLISION_RANGE);
        if robot.shape.is_some() {
            self.check_above(path, gap_m, 2.0 * robot.reach_m(), TWICE_ROBOT_REACH);
        }
    }

    /// Reports `value` if it is not greater than `bound`. `what` describes the bound, and `bound_path` is its path. Nothing
    /// is reported if the field at `path` has been reported before, or if the bound is out of range or unknown.
    pub(crate) fn check_above(
        &mut self,
        path: fmt::Arguments<'_>,
        value: f32,
        bound: f32,
        (what, bound_path): (&str, &str),
    ) {
        let at = path.to_string();
        let is_reported = self.found.iter().any(|found| found.path == at);
        let is_comparable = !self.incomparable.iter().any(|path| overlap(path, bound_path));
        if value <= bound && !is_reported && is_comparable {
            self.push(path, format!("is {value}: write more than {what}, {bound} m"));
        }
    }
}

/// `most` rounded down to three decimals, or to three significant digits if it is small, so that the printed number is
/// allowed.
pub(crate) fn rounded_down(most: f32) -> String {
    let most = f64::from(most);
    let places = if most > 0.0 { (-libm::log10(most).floor()).clamp(0.0, 9.0) as usize + 2 } else { 3 };
    let places = places.max(3);
    let scale = libm::pow(10.0, places as f64);
    // The factor restores round numbers that lost their last bit in a division.
    format!("{:.places$}", (most * scale * (1.0 + 1e-7)).floor() / scale)
}

/// `least` rounded up to `places` decimals, so that the printed number is allowed.
pub(crate) fn rounded_up(least: f64, places: usize) -> String {
    let scale = libm::pow(10.0, places as f64);
    // The factor restores round numbers, as in [`rounded_down`].
    format!("{:.places$}", (least * scale * (1.0 - 1e-7)).ceil() / scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_is_rounded_down_but_keeps_three_significant_digits() {
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

    #[test]
    fn a_minimum_is_rounded_up_unless_it_is_round() {
        for (least, text) in [(0.4, "0.400"), (0.4004, "0.401"), (0.399_999_999, "0.400")] {
            assert_eq!(rounded_up(least, 3), text);
        }
    }
}
