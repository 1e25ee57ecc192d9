//! Moving obstacles: circles on paths that are clear of everything static. Only pedestrians avoid each other or the robot.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, vec2};
use wayfield_random::{Stream, random_u64, uniform, uniform_01};

use super::draft::Draft;
use super::pedestrians::Behaviour;
use super::schema::Traffic;
use super::{lanes, number, one_of, pedestrians, whole};
use crate::geometry::length;
use crate::schema::{Obstacle, ObstacleMotion, Shape};

/// Attempts to find a free path before an obstacle is omitted.
const TRIES: usize = 50;
/// Largest deviation of an obstacle from its evenly spaced position on the circle, as a fraction of the spacing.
const JITTER: f32 = 0.3;

/// Adds one of `layouts`; nothing if there is none.
pub(super) fn add(draft: &mut Draft, layouts: &[Traffic], stream: &mut Stream) {
    let Some(layout) = one_of(layouts, stream) else { return };
    match *layout {
        Traffic::Lanes { pairs, count, radius_m, speed_m_s } => {
            for _ in 0..whole(stream, pairs) {
                let walker = Walkers { radius_m, speed_m_s }.draw(stream);
                lanes::add(draft, walker, whole(stream, count), stream);
            }
        }
        Traffic::CircleCrossing { count, radius_m, speed_m_s, circle_m } => {
            add_circle(draft, whole(stream, count), Walkers { radius_m, speed_m_s }, circle_m, stream);
        }
        Traffic::RandomCrossing { count, radius_m, speed_m_s } => {
            for _ in 0..whole(stream, count) {
                let walker = Walkers { radius_m, speed_m_s }.draw(stream);
                add_crossing(draft, walker, stream);
            }
        }
        Traffic::RandomWalks { count, radius_m, speed_m_s, reach_m } => {
            for _ in 0..whole(stream, count) {
                let walker = Walkers { radius_m, speed_m_s }.draw(stream);
                let reach_m = number(stream, reach_m);
                add_walk(draft, walker, reach_m, stream);
            }
        }
        Traffic::Orbits { circles, count, radius_m, speed_m_s, orbit_m } => {
            for _ in 0..whole(stream, circles) {
                let walker = Walkers { radius_m, speed_m_s }.draw(stream);
                let orbit_m = number(stream, orbit_m);
                add_orbits(draft, whole(stream, count), walker, orbit_m, stream);
            }
        }
        Traffic::PedestrianCircle { count, radius_m, speed_m_s, circle_m, noise_m, loops, sees_robot } => {
            let who =
                (whole(stream, count), Walkers { radius_m, speed_m_s }, Behaviour { loops, sees_robot });
            pedestrians::add_circle(draft, who, (circle_m, noise_m), stream);
        }
        Traffic::PedestrianCrowd { count, radius_m, speed_m_s, goals, sees_robot } => {
            let behaviour = Behaviour { loops: true, sees_robot };
            let who = (whole(stream, count), Walkers { radius_m, speed_m_s }, behaviour);
            pedestrians::add_crowd(draft, who, goals, stream);
        }
    }
}

/// The ranges of the sizes and speeds of moving obstacles.
#[derive(Clone, Copy)]
pub(super) struct Walkers {
    radius_m: (f32, f32),
    speed_m_s: (f32, f32),
}

impl Walkers {
    pub(super) fn draw(self, stream: &mut Stream) -> Walker {
        Walker { radius_m: number(stream, self.radius_m), speed_m_s: number(stream, self.speed_m_s) }
    }
}

/// The size and the speed of a moving obstacle.
#[derive(Clone, Copy)]
pub(super) struct Walker {
    pub(super) radius_m: f32,
    pub(super) speed_m_s: f32,
}

impl Walker {
    /// The moving obstacle at a position.
    pub(super) fn at(self, position_m: Vec2, motion: ObstacleMotion) -> Obstacle {
        let shape = Shape::Circle { radius_m: self.radius_m };
        Obstacle { shape, position_m, rotation_rad: 0.0, motion }
    }

    fn between(self, from: Vec2, to: Vec2) -> Obstacle {
        let waypoints_m = vec![to];
        self.at(from, ObstacleMotion::BackAndForth { waypoints_m, speed_m_s: self.speed_m_s.into() })
    }
}

/// Adds obstacles that start all around a circle and move to the opposite points and back.
fn add_circle(draft: &mut Draft, count: u32, walkers: Walkers, circle_m: (f32, f32), stream: &mut Stream) {
    let (circle_m, first) = (number(stream, circle_m), uniform(stream, -PI, PI));
    let middle = (draft.field.min_m + draft.field.max_m) / 2.0;
    let size = draft.field.max_m - draft.field.min_m;
    for k in 0..count {
        let walker = walkers.draw(stream);
        let angle = angle_on_circle(k, count, first, stream);
        let (sin, cos) = libm::sincosf(angle);
        let offset = circle_m.min(size.min_element() / 2.0 - walker.radius_m).max(0.0) * vec2(cos, sin);
        if draft.is_free(middle + offset, middle - offset, walker.radius_m) {
            draft.add_moving(walker.between(middle + offset, middle - offset));
        }
    }
}

/// A random point without anything static within `reach_m`; `None` if none is found.
fn free_point(draft: &Draft, reach_m: f32, stream: &mut Stream) -> Option<Vec2> {
    (0..TRIES).map(|_| draft.random_point(stream)).find(|&at| draft.is_free(at, at, reach_m))
}

/// The angle, in rad, of obstacle `k` of `count` on a circle, where obstacle 0 is at about the angle `first`.
fn angle_on_circle(k: u32, count: u32, first: f32, stream: &mut Stream) -> f32 {
    first + TAU * (k as f32 + uniform(stream, -JITTER, JITTER)) / count as f32
}

/// Adds obstacles that drive one after the other on a circle with the radius `orbit_m` around a random point.
fn add_orbits(draft: &mut Draft, count: u32, walker: Walker, orbit_m: f32, stream: &mut Stream) {
    let Some(centre_m) = free_point(draft, orbit_m + walker.radius_m, stream) else { return };
    let direction = if uniform_01(stream) < 0.5 { 1.0 } else { -1.0 };
    let speed_rad_s = direction * walker.speed_m_s / orbit_m;
    let first = uniform(stream, -PI, PI);
    // Neighbours must not overlap, even with the largest deviations: half the angle between them is at least `half_angle`.
    let half_angle = libm::asinf((walker.radius_m / orbit_m).min(1.0));
    let count = count.min((((0.5 - JITTER) * TAU / half_angle) as u32).max(1));
    for k in 0..count {
        let (sin, cos) = libm::sincosf(angle_on_circle(k, count, first, stream));
        let motion = ObstacleMotion::Orbit { centre_m, speed_rad_s: speed_rad_s.into() };
        draft.add_moving(walker.at(centre_m + orbit_m * vec2(cos, sin), motion));
    }
}

/// Adds an obstacle that moves back and forth between two random points, at least half the shorter side of the field apart.
fn add_crossing(draft: &mut Draft, walker: Walker, stream: &mut Stream) {
    let far = (draft.field.max_m - draft.field.min_m).min_element() / 2.0;
    let mut ends = (0..TRIES).map(|_| (draft.random_point(stream), draft.random_point(stream)));
    let free = ends.find(|&(from, to)| {
        length(to.x - from.x, to.y - from.y) >= far && draft.is_free(from, to, walker.radius_m)
    });
    if let Some((from, to)) = free {
        draft.add_moving(walker.between(from, to));
    }
}

/// Adds an obstacle that walks at random within `reach_m` of a random point.
fn add_walk(draft: &mut Draft, walker: Walker, reach_m: f32, stream: &mut Stream) {
    if let Some(at) = free_point(draft, walker.radius_m + reach_m, stream) {
        let seed = random_u64(stream) as u32;
        let motion =
            ObstacleMotion::RandomWalk { radius_m: reach_m, speed_m_s: walker.speed_m_s.into(), seed };
        draft.add_moving(walker.at(at, motion));
    }
}
