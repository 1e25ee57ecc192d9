//! The goal of the benchmark route.

use bevy::math::Vec2;

use super::super::handle::{Handle, HandleKind};
use super::super::points::place_text;
use super::corners;
use super::editable::{Body, DragTarget, Editable};
use crate::scenario::Scenario;

pub(super) struct BenchmarkGoalItem;

impl Editable for BenchmarkGoalItem {
    fn title(&self, _scenario: &Scenario) -> String {
        "Benchmark goal".into()
    }

    fn body(&self, scenario: &Scenario) -> Body {
        let positions_m = vec![scenario.benchmark_route.goal_m];
        Body::Marks { positions_m, radius_m: scenario.task.goal_radius_m }
    }

    fn handles(&self, scenario: &Scenario) -> Vec<Handle> {
        let at = scenario.benchmark_route.goal_m;
        vec![Handle::new(HandleKind::Middle, at, place_text(at), "Move the goal of the benchmark route")]
    }

    fn drag(&self, scenario: &mut Scenario, kind: HandleKind, target: DragTarget) -> Option<()> {
        (kind == HandleKind::Middle).then(|| scenario.benchmark_route.goal_m = target.snapped_m)
    }

    fn translate(&self, scenario: &mut Scenario, by_m: Vec2) -> Option<()> {
        corners::translate([&mut scenario.benchmark_route.goal_m], by_m);
        Some(())
    }
}
