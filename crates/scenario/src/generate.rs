//! Generated obstacles: a world as it is laid out for one episode.
//!
//! In: a [`Scenario`] with generators, the number of a layout. Out: the same world with their obstacles among the others
//! and without generators: what stands in one arena for one episode. The same number is the same layout, everywhere.

use std::f32::consts::PI;

use super::geometry::{is_clear, length};
use super::schema::{Generator, Obstacle, ObstacleMotion, PlacementRule, RandomShape, Scenario, Shape};
use glam::{Vec2, vec2};
use wayfield_random::{Stream, stream, uniform};

/// So many places are tried for an obstacle before it is left out.
const TRIES: u32 = 200;

impl Scenario {
    /// The most obstacles that a layout of it has.
    #[must_use]
    pub fn max_obstacles(&self) -> usize {
        self.obstacles.len() + self.generators.iter().map(|generator| generator.count as usize).sum::<usize>()
    }

    /// The world with layout number `layout_seed`: what its generators make comes after its own obstacles, and no generators
    /// are left. A generated obstacle keeps its gap from what stands still, from moving obstacles where they are at step
    /// 0, from the benchmark route's ends and from the places that the rules name; where no room is found for it, it is left out.
    #[must_use]
    pub fn with_generated_obstacles(&self, layout_seed: u64) -> Self {
        let mut room = Self { generators: Vec::new(), ..self.clone() };
        let kept_free = self.named_places();
        for (index, generator) in self.generators.iter().enumerate() {
            let mut stream = stream(layout_seed, "layout", index as u64);
            for _ in 0..generator.count {
                room.obstacles.extend(one(&room, generator, &kept_free, &mut stream));
            }
        }
        room
    }

    /// The benchmark route's ends and the places that the rules of starts and goals name, in m.
    fn named_places(&self) -> Vec<Vec2> {
        let mut places = vec![self.benchmark_route.start_m, self.benchmark_route.goal_m];
        for rule in [&self.starts, &self.goals] {
            match rule {
                PlacementRule::Fixed { position_m, .. } => places.push(*position_m),
                PlacementRule::OneOf { positions_m } => places.extend(positions_m),
                PlacementRule::Random { .. } | PlacementRule::Within { .. } => {}
            }
        }
        places
    }
}

/// One more obstacle for `room`, if a place is found for it.
fn one(room: &Scenario, generator: &Generator, kept_free: &[Vec2], stream: &mut Stream) -> Option<Obstacle> {
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
        None => room.enclosure.bounds_m(),
    };
    let position_m = (0..TRIES)
        .map(|_| vec2(uniform(stream, low.x, high.x), uniform(stream, low.y, high.y)))
        .find(|&at| {
            is_clear(room, at, 0, away) && kept_free.iter().all(|p| length(p.x - at.x, p.y - at.y) >= away)
        })?;
    Some(Obstacle { shape, position_m, rotation_rad, motion: ObstacleMotion::Static })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Region, clearance};

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
        Scenario { generators: vec![circles, boxes], ..Scenario::default() }
    }

    #[test]
    fn a_layout_keeps_its_gaps_sizes_and_regions_and_is_told_by_its_number() {
        let scenario = field();
        assert_eq!(scenario.max_obstacles(), 7);
        assert_eq!(scenario.with_generated_obstacles(3), scenario.with_generated_obstacles(3));
        assert_ne!(scenario.with_generated_obstacles(3), scenario.with_generated_obstacles(4));
        let mut in_all = 0;
        for layout_seed in 0..200 {
            let room = scenario.with_generated_obstacles(layout_seed);
            assert!(room.generators.is_empty());
            in_all += room.obstacles.len();
            for (index, obstacle) in room.obstacles.iter().enumerate() {
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
                    _ => panic!("a generator makes circles and boxes"),
                };
                let mut others = room.clone();
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
        assert!(in_all > 1_300, "there is room for nearly all of 1,400: {in_all}");
    }

    #[test]
    fn what_finds_no_room_is_left_out() {
        let mut scenario = field();
        scenario.generators[0].gap_m = 1.0;
        scenario.generators[0].count = 200;
        let count = scenario.with_generated_obstacles(0).obstacles.len();
        assert!((1..20).contains(&count), "{count}");
    }
}
