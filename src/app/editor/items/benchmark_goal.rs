//! The goal of the benchmark route.

use bevy::math::Vec2;

use super::super::handle::{Handle, HandleKind};
use super::super::points::place_text;
use super::corners;
use super::editable::{Body, DragTarget, Editable};
use crate::scenario::{BenchmarkRoute, Scenario};

pub(super) struct BenchmarkGoalItem;

impl Editable for BenchmarkGoalItem {
    fn title(&self, _scenario: &Scenario) -> String {
        "Benchmark goal".into()
    }

    fn exists(&self, scenario: &Scenario) -> bool {
        scenario.benchmark_route.is_some()
    }

    fn body(&self, scenario: &Scenario) -> Body {
        let positions_m = scenario.benchmark_route.iter().map(|route| route.goal_m).collect();
        Body::Marks { positions_m, radius_m: scenario.task.goal_radius_m }
    }

    fn handles(&self, scenario: &Scenario) -> Vec<Handle> {
        let Some(BenchmarkRoute { goal_m: at, .. }) = scenario.benchmark_route else { return Vec::new() };
        vec![Handle::new(HandleKind::Middle, at, place_text(at), "Move the goal of the benchmark route")]
    }

    fn drag(&self, scenario: &mut Scenario, kind: HandleKind, target: DragTarget) -> Option<()> {
        let route = scenario.benchmark_route.as_mut().filter(|_| kind == HandleKind::Middle)?;
        route.goal_m = target.snapped_m;
        Some(())
    }

    fn translate(&self, scenario: &mut Scenario, by_m: Vec2) -> Option<()> {
        corners::translate([&mut scenario.benchmark_route.as_mut()?.goal_m], by_m);
        Some(())
    }

    fn can_delete(&self, scenario: &Scenario) -> bool {
        self.exists(scenario)
    }

    /// Deletes the route with both ends.
    fn delete(&self, scenario: &mut Scenario) -> Option<()> {
        scenario.benchmark_route.take().map(drop)
    }
}
