//! An obstacle: its body and its motion together.

use bevy::math::{Vec2, vec2};

use super::super::free_space;
use super::super::handle::{Handle, HandleKind};
use super::super::new_motion::unused_seed;
use super::super::snap::Snap;
use super::editable::{Body, DragTarget, Editable, ListItem, numbered, remove_at};
use super::{obstacle_body, obstacle_path};
use crate::scenario::{ObstacleMotion, Scenario, shape_distance};

pub(super) struct ObstacleItem(pub usize);

impl Editable for ObstacleItem {
    fn title(&self, scenario: &Scenario) -> String {
        numbered("Obstacle", self.0, scenario.obstacles.len())
    }

    fn exists(&self, scenario: &Scenario) -> bool {
        self.0 < scenario.obstacles.len()
    }

    fn body(&self, scenario: &Scenario) -> Body {
        scenario.obstacles.get(self.0).cloned().map_or(Body::Nothing, Body::Obstacle)
    }

    fn solid_distance_m(&self, scenario: &Scenario, point_m: Vec2) -> Option<f32> {
        let obstacle = scenario.obstacles.get(self.0)?;
        let Vec2 { x, y } = obstacle.position_m;
        Some(shape_distance(&obstacle.shape, (x, y, obstacle.rotation_rad), point_m))
    }

    fn handles(&self, scenario: &Scenario) -> Vec<Handle> {
        let Some(obstacle) = scenario.obstacles.get(self.0) else { return Vec::new() };
        let mut handles = obstacle_path::handles(obstacle);
        handles.extend(obstacle_body::handles(obstacle));
        handles
    }

    fn drag(&self, scenario: &mut Scenario, kind: HandleKind, target: DragTarget) -> Option<()> {
        let obstacle = scenario.obstacles.get_mut(self.0)?;
        obstacle_body::drag(obstacle, kind, target).or_else(|| obstacle_path::drag(obstacle, kind, target))
    }

    fn insert(&self, scenario: &mut Scenario, kind: HandleKind, position_m: Vec2) -> Option<HandleKind> {
        let obstacle = scenario.obstacles.get_mut(self.0)?;
        obstacle_body::insert(obstacle, kind, position_m)
            .or_else(|| obstacle_path::insert(obstacle, kind, position_m))
    }

    fn remove(&self, scenario: &mut Scenario, kind: HandleKind) -> Option<()> {
        let obstacle = scenario.obstacles.get_mut(self.0)?;
        obstacle_body::remove(obstacle, kind).or_else(|| obstacle_path::remove(obstacle, kind))
    }

    fn rotation(&self, scenario: &Scenario) -> Option<(Vec2, f32)> {
        let obstacle = scenario.obstacles.get(self.0)?;
        obstacle.shape.has_orientation().then_some((obstacle.position_m, obstacle.rotation_rad))
    }

    fn rotate(&self, scenario: &mut Scenario, angle_rad: f32) -> Option<()> {
        scenario.obstacles.get_mut(self.0)?.rotation_rad = angle_rad;
        Some(())
    }

    fn translate(&self, scenario: &mut Scenario, by_m: Vec2) -> Option<()> {
        obstacle_path::translate(scenario.obstacles.get_mut(self.0)?, by_m);
        Some(())
    }

    fn copy(&self, scenario: &Scenario) -> Option<ListItem> {
        scenario.obstacles.get(self.0).cloned().map(ListItem::Obstacle)
    }

    /// Gives a random walk another seed.
    fn vary(&self, scenario: &mut Scenario) {
        let Some(obstacle) = scenario.obstacles.get(self.0) else { return };
        let ObstacleMotion::RandomWalk { seed, .. } = obstacle.motion else { return };
        let unused = unused_seed(scenario, seed);
        if let ObstacleMotion::RandomWalk { seed, .. } = &mut scenario.obstacles[self.0].motion {
            *seed = unused;
        }
    }

    fn anchor_m(&self, scenario: &Scenario) -> Option<Vec2> {
        scenario.obstacles.get(self.0).map(|obstacle| obstacle.position_m)
    }

    fn copy_anchor_m(&self, scenario: &Scenario, others: &Scenario, snap: Snap) -> Option<Vec2> {
        let obstacle = scenario.obstacles.get(self.0)?;
        let radius_m = obstacle.shape.bounding_radius_m();
        let wanted = obstacle.position_m + vec2(2.0 * radius_m + 0.1, 0.0);
        Some(free_space::nearest(others, wanted, radius_m, snap))
    }

    fn delete(&self, scenario: &mut Scenario) -> Option<()> {
        remove_at(&mut scenario.obstacles, self.0)
    }
}
