//! An inner wall.

use bevy::math::Vec2;

use super::super::handle::{Handle, HandleKind};
use super::super::limits::WALL_CORNERS;
use super::super::points::point_to_mm;
use super::corners;
use super::editable::{Body, DragTarget, Editable, ListItem, numbered, remove_at};
use crate::scenario::{Scenario, WallCells, inner_wall_distance};

pub(super) struct WallItem(pub usize);

impl Editable for WallItem {
    fn title(&self, scenario: &Scenario) -> String {
        numbered("Wall", self.0, scenario.walls.len())
    }

    fn exists(&self, scenario: &Scenario) -> bool {
        self.0 < scenario.walls.len()
    }

    fn body(&self, scenario: &Scenario) -> Body {
        scenario.walls.get(self.0).cloned().map_or(Body::Nothing, Body::Wall)
    }

    fn solid_distance_m(&self, scenario: &Scenario, point_m: Vec2) -> Option<f32> {
        scenario.walls.get(self.0).map(|wall| inner_wall_distance(wall, point_m))
    }

    fn handles(&self, scenario: &Scenario) -> Vec<Handle> {
        let wall = scenario.walls.get(self.0);
        wall.map_or_else(Vec::new, |wall| corners::handles(&wall.corners_m, false, *WALL_CORNERS.end()))
    }

    /// A wall has no visible middle handle. When it is dragged by its body, its anchor acts as the handle.
    fn handle_position_m(&self, scenario: &Scenario, kind: HandleKind) -> Option<Vec2> {
        if kind == HandleKind::Middle {
            return self.anchor_m(scenario);
        }
        let handle = self.handles(scenario).into_iter().find(|handle| handle.kind == kind);
        handle.map(|handle| handle.position_m)
    }

    fn drag(&self, scenario: &mut Scenario, kind: HandleKind, target: DragTarget) -> Option<()> {
        match kind {
            HandleKind::Corner(k) => {
                *scenario.walls.get_mut(self.0)?.corners_m.get_mut(k)? = target.snapped_m;
            }
            HandleKind::Middle => {
                let by_m = target.snapped_m - self.anchor_m(scenario)?;
                self.translate(scenario, by_m)?;
            }
            _ => return None,
        }
        Some(())
    }

    fn insert(&self, scenario: &mut Scenario, kind: HandleKind, position_m: Vec2) -> Option<HandleKind> {
        let HandleKind::InsertCorner(k) = kind else { return None };
        corners::insert(&mut scenario.walls.get_mut(self.0)?.corners_m, k, position_m)
    }

    fn remove(&self, scenario: &mut Scenario, kind: HandleKind) -> Option<()> {
        let HandleKind::Corner(k) = kind else { return None };
        corners::remove(&mut scenario.walls.get_mut(self.0)?.corners_m, k, *WALL_CORNERS.start())
    }

    fn translate(&self, scenario: &mut Scenario, by_m: Vec2) -> Option<()> {
        let wall = scenario.walls.get_mut(self.0)?;
        corners::translate(&mut wall.corners_m, by_m);
        if let Some(cells) = wall.cells.take() {
            let centre_m = point_to_mm(cells.centre_m() + by_m);
            wall.cells = Some(cells.with_centre(centre_m));
        }
        Some(())
    }

    fn copy(&self, scenario: &Scenario) -> Option<ListItem> {
        scenario.walls.get(self.0).cloned().map(ListItem::Wall)
    }

    /// The first corner or, for a wall of cells, their centre.
    fn anchor_m(&self, scenario: &Scenario) -> Option<Vec2> {
        let wall = scenario.walls.get(self.0)?;
        wall.corners_m.first().copied().or_else(|| wall.cells.as_ref().map(WallCells::centre_m))
    }

    fn delete(&self, scenario: &mut Scenario) -> Option<()> {
        remove_at(&mut scenario.walls, self.0)
    }
}
