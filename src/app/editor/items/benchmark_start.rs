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

    fn exists(&self, scenario: &Scenario) -> bool {
        scenario.benchmark_route.is_some()
    }

    fn body(&self, scenario: &Scenario) -> Body {
        let radius_m = scenario.keep_out_m().max(scenario.robot.reach_m());
        Body::Marks {
            positions_m: scenario.benchmark_route.iter().map(|route| route.start_m).collect(),
            radius_m,
        }
    }

    fn handles(&self, scenario: &Scenario) -> Vec<Handle> {
        let Some(route) = scenario.benchmark_route else { return Vec::new() };
        let text = place_text(route.start_m);
        vec![
            placement_rule::heading_handle(route.start_m, route.heading_rad),
            Handle::new(HandleKind::Middle, route.start_m, text, "Move the start of the benchmark route"),
        ]
    }

    fn drag(&self, scenario: &mut Scenario, kind: HandleKind, target: DragTarget) -> Option<()> {
        let route = scenario.benchmark_route.as_mut().filter(|_| kind == HandleKind::Middle)?;
        route.start_m = target.snapped_m;
        Some(())
    }

    fn rotation(&self, scenario: &Scenario) -> Option<(Vec2, f32)> {
        scenario.benchmark_route.map(|route| (route.start_m, route.heading_rad))
    }

    fn rotate(&self, scenario: &mut Scenario, angle_rad: f32) -> Option<()> {
        scenario.benchmark_route.as_mut()?.heading_rad = angle_rad;
        Some(())
    }

    fn translate(&self, scenario: &mut Scenario, by_m: Vec2) -> Option<()> {
        corners::translate([&mut scenario.benchmark_route.as_mut()?.start_m], by_m);
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
