//! Places: the ends of the course, and where the rules put starts and targets.
//!
//! In: a rule or the course, a handle. Out: the same with a place moved or taken out.

use super::corners;
use super::frames;
use super::handles::{Handle, HandleKind};
use super::points::{Frame, Point, degrees_text, place_text};
use super::selection::{Selection, region};
use super::snap::Snap;
use crate::scenario::{Course, PlaceRule};

/// How far from a start the handle is that turns it, in m.
const TURN_M: f32 = 0.3;

/// The handles of a rule of starts or targets.
pub(super) fn of_rule(rule: &PlaceRule) -> Vec<Handle> {
    let mut all = region(rule).map_or_else(Vec::new, frames::of_region);
    if let PlaceRule::Fixed { at_m, heading_rad: Some(heading) } = *rule {
        all.push(turn(at_m, heading));
    }
    all.extend(super::selection::places(rule).iter().enumerate().map(|(k, &at)| {
        let about = match rule {
            PlaceRule::OneOf { .. } => "One of the places; double click takes it out",
            _ => "The place",
        };
        Handle::new(HandleKind::Place(k), at, place_text(at), about)
    }));
    all
}

/// Those of an end of the course.
pub(super) fn of_course(course: &Course, end: Selection) -> Vec<Handle> {
    let place = |at, about| Handle::new(HandleKind::Middle, at, place_text(at), about);
    if end == Selection::CourseTarget {
        return vec![place(course.target_m, "Where the course ends")];
    }
    vec![turn(course.start_m, course.heading_rad), place(course.start_m, "Where the course starts")]
}

fn turn(at: Point, heading_rad: f32) -> Handle {
    let tip = Frame::new(at, heading_rad).out((TURN_M, 0.0));
    Handle::new(HandleKind::Turn, tip, degrees_text(heading_rad), "Where it looks")
}

/// Drags a handle of a rule.
pub(super) fn drag_rule(
    rule: &mut PlaceRule,
    kind: HandleKind,
    to: Point,
    snap: Snap,
    centre: Point,
) -> Option<()> {
    match (kind, rule) {
        (HandleKind::Place(_), PlaceRule::Fixed { at_m, .. }) => *at_m = snap.point(to, centre),
        (HandleKind::Place(k), PlaceRule::OneOf { places_m }) => {
            *places_m.get_mut(k)? = snap.point(to, centre);
        }
        (_, PlaceRule::Within { min_m, max_m, .. }) => {
            return frames::drag_region((min_m, max_m), kind, to, snap, centre);
        }
        _ => return None,
    }
    Some(())
}

/// Drags an end of the course by its middle.
pub(super) fn drag_course(
    course: &mut Course,
    end: Selection,
    kind: HandleKind,
    snapped: Point,
) -> Option<()> {
    if kind != HandleKind::Middle {
        return None;
    }
    match end {
        Selection::CourseStart => course.start_m = snapped,
        _ => course.target_m = snapped,
    }
    Some(())
}

/// Takes a place out; one stays.
pub(super) fn remove(rule: &mut PlaceRule, k: usize) -> Option<()> {
    match rule {
        PlaceRule::OneOf { places_m } => corners::remove(places_m, k, 1),
        _ => None,
    }
}

/// All points of a rule.
pub(super) fn points(rule: &mut PlaceRule) -> Vec<&mut Point> {
    match rule {
        PlaceRule::Random { .. } => Vec::new(),
        PlaceRule::Within { min_m, max_m, .. } => vec![min_m, max_m],
        PlaceRule::Fixed { at_m, .. } => vec![at_m],
        PlaceRule::OneOf { places_m } => places_m.iter_mut().collect(),
    }
}
