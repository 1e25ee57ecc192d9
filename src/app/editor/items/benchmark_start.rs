//! The start of the benchmark route.

use bevy::math::Vec2;

use super::super::handle::{Handle, HandleKind};
use super::super::points::place_text;
use super::editable::{Body, DragTarget, Editable};
use super::{corners, placement_rule};
use crate::scenario::Scenario;

pub(super) struct BenchmarkStartItem;

impl Editable for BenchmarkStartItem {
    fn title(&self, _scenario: &Scenario) -> String {
        "Benchmark start".into()
    }

    fn body(&self, scenario: &Scenario) -> Body {
        let radius_m = scenario.task.collision_range_m.max(scenario.robot.radius_m);
        Body::Marks { positions_m: vec![scenario.benchmark_route.start_m], radius_m }
    }

    fn handles(&self, scenario: &Scenario) -> Vec<Handle> {
        let route = &scenario.benchmark_route;
        let text = place_text(route.start_m);
        vec![
            placement_rule::heading_handle(route.start_m, route.heading_rad),
            Handle::new(HandleKind::Middle, route.start_m, text, "Move the start of the benchmark route"),
        ]
    }

    fn drag(&self, scenario: &mut Scenario, kind: HandleKind, target: DragTarget) -> Option<()> {
        (kind == HandleKind::Middle).then(|| scenario.benchmark_route.start_m = target.snapped_m)
    }

    fn rotation(&self, scenario: &Scenario) -> Option<(Vec2, f32)> {
        Some((scenario.benchmark_route.start_m, scenario.benchmark_route.heading_rad))
    }

    fn rotate(&self, scenario: &mut Scenario, angle_rad: f32) -> Option<()> {
        scenario.benchmark_route.heading_rad = angle_rad;
        Some(())
    }

    fn translate(&self, scenario: &mut Scenario, by_m: Vec2) -> Option<()> {
        corners::translate([&mut scenario.benchmark_route.start_m], by_m);
        Some(())
    }
}
