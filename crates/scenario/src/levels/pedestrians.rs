//! Pedestrians of levels: across a circle, or between random points. Their straight paths are clear of everything static.

use std::f32::consts::PI;

use glam::{Vec2, vec2};
use wayfield_random::{Stream, uniform};

use super::draft::Draft;
use super::traffic::{Walker, Walkers};
use super::{number, whole};
use crate::geometry::length;
use crate::schema::{Obstacle, ObstacleMotion, PlacementRule};

/// Attempts to find a free start or path before a pedestrian is omitted.
const TRIES: usize = 100;
/// Smallest gap in m between a pedestrian's start and the robot's start and goal, the others' starts and, on a circle, their
/// goals.
const SPACING_M: f32 = 0.2;

/// How the pedestrians of a level behave.
#[derive(Clone, Copy)]
pub(super) struct Behaviour {
    pub(super) loops: bool,
    pub(super) sees_robot: bool,
}

/// A start or goal, in m, and the radius in m of its pedestrian or robot.
type End = (Vec2, f32);

/// Adds pedestrians who start near a circle and walk to the opposite points, as in CrowdNav.
pub(super) fn add_circle(
    draft: &mut Draft,
    (count, walkers, behaviour): (u32, Walkers, Behaviour),
    (circle_m, noise_m): ((f32, f32), f32),
    stream: &mut Stream,
) {
    let circle_m = number(stream, circle_m);
    let middle = (draft.field.min_m + draft.field.max_m) / 2.0;
    let mut taken = ends_of_robot(draft);
    for _ in 0..count {
        let walker = walkers.draw(stream);
        let mut starts = (0..TRIES).map(|_| {
            let (sin, cos) = libm::sincosf(uniform(stream, -PI, PI));
            let noise = vec2(uniform(stream, -noise_m, noise_m), uniform(stream, -noise_m, noise_m));
            middle + circle_m * vec2(cos, sin) + noise
        });
        let free = starts.find(|&start| {
            is_spaced(start, walker.radius_m, &taken)
                && draft.is_free(start, 2.0 * middle - start, walker.radius_m)
        });
        if let Some(start) = free {
            let goal = 2.0 * middle - start;
            taken.extend([(start, walker.radius_m), (goal, walker.radius_m)]);
            draft.add_moving(pedestrian(walker, start, vec![goal], behaviour));
        }
    }
}

/// Adds pedestrians who walk between random points. Each goal is at least half the shorter side of the field from the point
/// before it.
pub(super) fn add_crowd(
    draft: &mut Draft,
    (count, walkers, behaviour): (u32, Walkers, Behaviour),
    goals: (u32, u32),
    stream: &mut Stream,
) {
    let mut taken = ends_of_robot(draft);
    for _ in 0..count {
        let walker = walkers.draw(stream);
        let mut starts = (0..TRIES).map(|_| draft.random_point(stream));
        let free = starts
            .find(|&at| is_spaced(at, walker.radius_m, &taken) && draft.is_free(at, at, walker.radius_m));
        let Some(start) = free else { continue };
        let goals_m = random_goals(draft, start, walker.radius_m, whole(stream, goals), stream);
        if !goals_m.is_empty() {
            taken.push((start, walker.radius_m));
            draft.add_moving(pedestrian(walker, start, goals_m, behaviour));
        }
    }
}

/// Up to `count` goals. The straight lines from `start` through the goals, and from each goal back to `start`, are free.
fn random_goals(draft: &Draft, start: Vec2, radius_m: f32, count: u32, stream: &mut Stream) -> Vec<Vec2> {
    let far = (draft.field.max_m - draft.field.min_m).min_element() / 2.0;
    let mut goals_m = Vec::new();
    for _ in 0..count {
        let from = goals_m.last().copied().unwrap_or(start);
        let fits = |to: &Vec2| {
            length(to.x - from.x, to.y - from.y) >= far
                && draft.is_free(from, *to, radius_m)
                && draft.is_free(*to, start, radius_m)
        };
        let Some(goal) = (0..TRIES).map(|_| draft.random_point(stream)).find(fits) else { break };
        goals_m.push(goal);
    }
    goals_m
}

/// The fixed start and goal of the robot, if it has them.
fn ends_of_robot(draft: &Draft) -> Vec<End> {
    let rules = [&draft.scenario.starts, &draft.scenario.goals];
    let ends = rules.into_iter().flat_map(PlacementRule::positions_m);
    ends.map(|&end| (end, draft.scenario.robot.reach_m())).collect()
}

fn is_spaced(start: Vec2, radius_m: f32, taken: &[End]) -> bool {
    let gap_m = |&(end, other_m): &End| length(end.x - start.x, end.y - start.y) - radius_m - other_m;
    taken.iter().all(|end| gap_m(end) >= SPACING_M)
}

fn pedestrian(walker: Walker, start: Vec2, goals_m: Vec<Vec2>, behaviour: Behaviour) -> Obstacle {
    let Behaviour { loops, sees_robot } = behaviour;
    let speed_m_s = walker.speed_m_s.into();
    walker.at(start, ObstacleMotion::Pedestrian { goals_m, speed_m_s, loops, sees_robot })
}
