//! Random obstacle layouts.
//!
//! In: a [`Scenario`] with generators or ranges, and a layout seed. Out: the scenario of one episode in one arena, with generated
//! obstacles and drawn numbers (`ranged.rs`), and without generators. The same seed gives the same layout on every platform.

use std::f32::consts::PI;

use super::geometry::length;
use super::schema::{Generator, Obstacle, ObstacleMotion, RandomShape, Scenario, Shape};
use super::spatial_index::IndexedScenario;
use glam::{Vec2, vec2};
use wayfield_random::{Stream, stream, uniform};

/// Attempts to place an obstacle before it is omitted.
const TRIES: u32 = 200;

impl Scenario {
    /// Largest number of obstacles in a layout.
    #[must_use]
    pub fn max_obstacles(&self) -> usize {
        self.obstacles.len() + self.generators.iter().map(|generator| generator.count as usize).sum::<usize>()
    }

    /// The scenario of an episode with this layout seed: with a number drawn from each range, with the generated obstacles
    /// after its own, and without generators. A generated obstacle keeps its gap from walls, from static obstacles, from moving
    /// obstacles at step 0, from the ends of the benchmark route and from positions that the start and goal rules name. It is
    /// omitted if no place is found for it.
    #[must_use]
    pub fn with_generated_obstacles(&self, layout_seed: u64) -> Self {
        let mut layout = Self { generators: Vec::new(), ..self.with_drawn_numbers(layout_seed) };
        let kept_free = self.named_places();
        for (index, generator) in self.generators.iter().enumerate() {
            let mut stream = stream(layout_seed, "layout", index as u64);
            for _ in 0..generator.count {
                layout.obstacles.extend(generated_obstacle(&layout, generator, &kept_free, &mut stream));
            }
        }
        layout
    }

    /// The ends of the benchmark route and the positions that the start and goal rules name, in m.
    fn named_places(&self) -> Vec<Vec2> {
        let mut places: Vec<Vec2> =
            self.benchmark_route.iter().flat_map(|route| [route.start_m, route.goal_m]).collect();
        for rule in [&self.starts, &self.goals] {
            places.extend(rule.positions_m());
        }
        places
    }
}

/// Another obstacle for `layout`, or `None` if no place is found for it.
fn generated_obstacle(
    layout: &Scenario,
    generator: &Generator,
    kept_free: &[Vec2],
    stream: &mut Stream,
) -> Option<Obstacle> {
    let mut size = |(low, high): (f32, f32)| uniform(stream, low, high);
    let (shape, turns) = match generator.shape {
        RandomShape::Circle { radius_m } => (Shape::Circle { radius_m: size(radius_m) }, false),
        RandomShape::Rectangle { width_m, height_m } => {
            (Shape::Rectangle { width_m: size(width_m), height_m: size(height_m) }, true)
        }
    };
    let rotation_rad = if turns { uniform(stream, -PI, PI) } else { 0.0 };
    let away = shape.bounding_radius_m() + generator.gap_m;
    let (low, high) = match generator.within {
        Some(region) => (region.min_m, region.max_m),
        None => layout.enclosure.bounds_m(),
    };
    let space = IndexedScenario::from(layout);
    let position_m = (0..TRIES)
        .map(|_| vec2(uniform(stream, low.x, high.x), uniform(stream, low.y, high.y)))
        .find(|&at| {
            space.is_clear(at, 0, away) && kept_free.iter().all(|p| length(p.x - at.x, p.y - at.y) >= away)
        })?;
    Some(Obstacle { shape, position_m, rotation_rad, motion: ObstacleMotion::Static })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BenchmarkRoute, Region, clearance};

    fn field() -> Scenario {
        let circles = Generator {
            count: 5,
            shape: RandomShape::Circle { radius_m: (0.1, 0.2) },
            gap_m: 0.3,
            within: None,
        };
        let boxes = Generator {
            count: 2,
            shape: RandomShape::Rectangle { width_m: (0.2, 0.4), height_m: (0.1, 0.1) },
            gap_m: 0.35,
            within: Some(Region { min_m: vec2(-2.0, 0.0), max_m: vec2(2.0, 2.0) }),
        };
        Scenario {
            generators: vec![circles, boxes],
            benchmark_route: Some(BenchmarkRoute::default()),
            ..Scenario::default()
        }
    }

    #[test]
    fn a_layout_keeps_gaps_sizes_and_regions_and_depends_on_its_seed() {
        let scenario = field();
        assert_eq!(scenario.max_obstacles(), 7);
        assert_eq!(scenario.with_generated_obstacles(3), scenario.with_generated_obstacles(3));
        assert_ne!(scenario.with_generated_obstacles(3), scenario.with_generated_obstacles(4));
        let mut in_all = 0;
        for layout_seed in 0..200 {
            let layout = scenario.with_generated_obstacles(layout_seed);
            assert!(layout.generators.is_empty());
            in_all += layout.obstacles.len();
            for (index, obstacle) in layout.obstacles.iter().enumerate() {
                let Vec2 { x, y } = obstacle.position_m;
                let (radius, gap) = match obstacle.shape {
                    Shape::Circle { radius_m } => {
                        assert!((0.1..=0.2).contains(&radius_m));
                        (radius_m, 0.3)
                    }
                    Shape::Rectangle { width_m, height_m } => {
                        assert!((0.2..=0.4).contains(&width_m) && height_m == 0.1 && y >= 0.0);
                        (width_m.hypot(height_m) / 2.0, 0.35)
                    }
                    _ => panic!("a generator makes only circles and rectangles"),
                };
                let mut others = layout.clone();
                others.obstacles.truncate(index);
                assert!(
                    clearance(&others, vec2(x, y), 0) >= radius + gap - 1e-5,
                    "layout {layout_seed}: {obstacle:?}"
                );
                for end in [(0.0, 0.0), (1.2, 1.2)] {
                    assert!(
                        (x - end.0).hypot(y - end.1) >= radius + gap - 1e-5,
                        "the benchmark route stays free"
                    );
                }
            }
        }
        assert!(in_all > 1_300, "there is space for nearly all of 1,400: {in_all}");
    }

    #[test]
    fn obstacles_without_space_are_omitted() {
        let mut scenario = field();
        scenario.generators[0].gap_m = 1.0;
        scenario.generators[0].count = 200;
        let count = scenario.with_generated_obstacles(0).obstacles.len();
        assert!((1..20).contains(&count), "{count}");
    }
}
