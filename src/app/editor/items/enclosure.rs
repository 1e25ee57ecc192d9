//! The boundary of the scenario.

use bevy::math::{Vec2, vec2};

use super::super::handle::{Handle, HandleKind};
use super::super::limits::{ENCLOSURE_CORNERS, MIN_ENCLOSURE_M};
use super::editable::{Body, DragTarget, Editable};
use super::{corners, rectangles};
use crate::scenario::{Enclosure, Scenario};

pub(super) struct EnclosureItem;

impl Editable for EnclosureItem {
    fn title(&self, _scenario: &Scenario) -> String {
        "Enclosure".into()
    }

    fn body(&self, scenario: &Scenario) -> Body {
        Body::Outline(scenario.enclosure.corners_m())
    }

    fn handles(&self, scenario: &Scenario) -> Vec<Handle> {
        match &scenario.enclosure {
            Enclosure::Rectangle { width_m, height_m } => {
                rectangles::side_handles(Vec2::ZERO, vec2(*width_m, *height_m), "Resize; the centre stays")
            }
            Enclosure::Polygon { corners_m } => corners::handles(corners_m, true, *ENCLOSURE_CORNERS.end()),
        }
    }

    fn drag(&self, scenario: &mut Scenario, kind: HandleKind, target: DragTarget) -> Option<()> {
        match (&mut scenario.enclosure, kind) {
            (Enclosure::Rectangle { width_m, height_m }, HandleKind::Side(x, y)) => {
                resize(width_m, x, target.position_m.x, target);
                resize(height_m, y, target.position_m.y, target);
            }
            (Enclosure::Polygon { corners_m }, HandleKind::Corner(k)) => {
                *corners_m.get_mut(k)? = target.snapped_m;
            }
            _ => return None,
        }
        Some(())
    }

    fn insert(&self, scenario: &mut Scenario, kind: HandleKind, position_m: Vec2) -> Option<HandleKind> {
        match (&mut scenario.enclosure, kind) {
            (Enclosure::Polygon { corners_m }, HandleKind::InsertCorner(k)) => {
                corners::insert(corners_m, k, position_m)
            }
            _ => None,
        }
    }

    fn remove(&self, scenario: &mut Scenario, kind: HandleKind) -> Option<()> {
        match (&mut scenario.enclosure, kind) {
            (Enclosure::Polygon { corners_m }, HandleKind::Corner(k)) => {
                corners::remove(corners_m, k, *ENCLOSURE_CORNERS.start())
            }
            _ => None,
        }
    }

    fn translate(&self, _scenario: &mut Scenario, _by_m: Vec2) -> Option<()> {
        None
    }
}

/// Resizes one axis so that its side (-1 or 1) is at `coordinate_m`; side 0 changes nothing. The centre stays at 0, so
/// the opposite side moves by the same distance.
fn resize(size_m: &mut f32, side: i8, coordinate_m: f32, target: DragTarget) {
    if side != 0 {
        *size_m = target.snap.size(2.0 * coordinate_m * f32::from(side)).max(MIN_ENCLOSURE_M);
    }
}
