//! New items, added by one click.

use bevy::math::Vec2;

use super::document::Editor;
use super::free_space;
use super::items::ListItem;
use super::limits::new_clearance_m;
use super::selection::Selection;
use crate::scenario::{BenchmarkRoute, Generator, Obstacle, ObstacleMotion, RandomShape, Shape};

impl Editor {
    /// Adds an obstacle of this shape at a free position near `near_m`, and selects it.
    pub fn add_obstacle(&mut self, shape: Shape, near_m: Vec2) {
        let radius_m = shape.bounding_radius_m();
        let position_m = free_space::nearest(self.scenario(), near_m, radius_m, self.snap);
        let motion = ObstacleMotion::Static;
        self.append(ListItem::Obstacle(Obstacle { shape, position_m, rotation_rad: 0.0, motion }));
    }

    /// Adds a generator of random obstacles, and selects it.
    pub fn add_generator(&mut self) {
        let shape = RandomShape::Circle { radius_m: (0.1, 0.2) };
        self.append(ListItem::Generator(Generator { count: 4, shape, gap_m: 0.4, within: None }));
    }

    /// Adds a benchmark route between two free positions, unless there is one, and selects its goal.
    pub fn add_benchmark_route(&mut self) {
        let snap = self.snap;
        self.step(|scenario, selection| {
            let clearance_m = new_clearance_m(scenario);
            let (low, high) = scenario.enclosure.bounds_m();
            let free = |along: f32| free_space::nearest(scenario, low.lerp(high, along), clearance_m, snap);
            let route = BenchmarkRoute { start_m: free(0.2), heading_rad: 0.0, goal_m: free(0.8) };
            scenario.benchmark_route.get_or_insert(route);
            *selection = Selection::BenchmarkGoal;
        });
    }

    /// Appends an item to its list, and selects it.
    pub(super) fn append(&mut self, item: ListItem) {
        self.step(|scenario, selection| *selection = item.add_to(scenario));
    }
}
