//! A generator of random obstacles, and the region that it fills.

use bevy::math::Vec2;

use super::super::handle::{Handle, HandleKind};
use super::editable::{Body, DragTarget, Editable, ListItem, numbered, remove_at};
use super::{corners, rectangles};
use crate::scenario::{Region, Scenario};

pub(super) struct GeneratorItem(pub usize);

impl GeneratorItem {
    fn region(&self, scenario: &Scenario) -> Option<Region> {
        scenario.generators.get(self.0)?.within
    }
}

impl Editable for GeneratorItem {
    fn title(&self, scenario: &Scenario) -> String {
        numbered("Generator", self.0, scenario.generators.len())
    }

    fn exists(&self, scenario: &Scenario) -> bool {
        self.0 < scenario.generators.len()
    }

    fn body(&self, scenario: &Scenario) -> Body {
        self.region(scenario).map_or(Body::Nothing, Body::Region)
    }

    fn handles(&self, scenario: &Scenario) -> Vec<Handle> {
        self.region(scenario).map_or_else(Vec::new, rectangles::region_handles)
    }

    fn drag(&self, scenario: &mut Scenario, kind: HandleKind, target: DragTarget) -> Option<()> {
        let region = scenario.generators.get_mut(self.0)?.within.as_mut()?;
        rectangles::drag_region((&mut region.min_m, &mut region.max_m), kind, target)
    }

    fn translate(&self, scenario: &mut Scenario, by_m: Vec2) -> Option<()> {
        let region = scenario.generators.get_mut(self.0)?.within.as_mut()?;
        corners::translate([&mut region.min_m, &mut region.max_m], by_m);
        Some(())
    }

    fn copy(&self, scenario: &Scenario) -> Option<ListItem> {
        scenario.generators.get(self.0).cloned().map(ListItem::Generator)
    }

    /// The lower left corner of the region.
    fn anchor_m(&self, scenario: &Scenario) -> Option<Vec2> {
        self.region(scenario).map(|region| region.min_m)
    }

    fn delete(&self, scenario: &mut Scenario) -> Option<()> {
        remove_at(&mut scenario.generators, self.0)
    }
}
