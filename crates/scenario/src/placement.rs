//! The placement of starts and goals by the rules of the scenario.
//!
//! In: a [`Scenario`], the step, a [`Stream`]. Out: a start or a goal. Random ones keep their clearance from walls and from
//! the obstacles at that step. Runs at every reset, without allocation.

use std::f32::consts::{PI, TAU};

use super::geometry::length;
use super::schema::{PlacementRule, Region, Scenario};
use super::spatial_index::IndexedScenario;
use glam::{Vec2, vec2};
use wayfield_random::{Stream, uniform, uniform_01, uniform_index};

/// Random attempts before the grid is searched.
const TRIES: u32 = 1_000;
/// Grid points along each side of the enclosure, or of the rule's region.
const GRID: usize = 64;
/// Attempts to find a start with a goal that is far enough away.
const START_TRIES: u32 = 200;

/// The error when no point satisfies a rule at a step. A scenario without diagnostics has free space at step 0 and at the
/// other steps that the checks test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no free space for a {what} at step {step}: use fewer or smaller obstacles, or a smaller clearance_m{}",
    if *what == "goal" { " or min_goal_distance_m" } else { "" }
)]
pub struct NoFreeSpace {
    /// "start" or "goal".
    pub what: &'static str,
    /// The control step.
    pub step: u64,
}

/// Draws a start as [`draw_start`] does and a goal as [`draw_goal`] does, far enough apart.
///
/// # Errors
/// [`NoFreeSpace`] if the obstacles leave no space at `step`, or if no start is found that has a goal far enough away.
pub fn draw_start_and_goal<'a>(
    scenario: impl Into<IndexedScenario<'a>>,
    step: u64,
    stream: &mut Stream,
) -> Result<((f32, f32, f32), Vec2), NoFreeSpace> {
    let scenario = scenario.into();
    let mut drawn = Err(NoFreeSpace { what: "goal", step });
    for _ in 0..START_TRIES {
        let start = draw_start(scenario, step, stream)?;
        drawn = draw_goal(scenario, step, vec2(start.0, start.1), stream).map(|goal| (start, goal));
        if drawn.is_ok() {
            break;
        }
    }
    drawn
}

/// Draws a start (x in m, y in m, heading in rad) by the rule `starts`. The heading is uniform over (-pi, pi] unless the rule
/// fixes it.
///
/// # Errors
/// [`NoFreeSpace`] if the obstacles leave no space at `step`.
pub fn draw_start<'a>(
    scenario: impl Into<IndexedScenario<'a>>,
    step: u64,
    stream: &mut Stream,
) -> Result<(f32, f32, f32), NoFreeSpace> {
    let space = scenario.into();
    let rule = &space.scenario.starts;
    let Vec2 { x, y } =
        draw(space, rule, step, stream, |_| true).ok_or(NoFreeSpace { what: "start", step })?;
    let heading = match rule {
        PlacementRule::Fixed { heading_rad: Some(heading), .. } => *heading,
        _ => PI - TAU * uniform_01(stream),
    };
    Ok((x, y, heading))
}

/// Draws a goal by the rule `goals`, in m, at least `task.min_goal_distance_m` from `robot_m`.
///
/// # Errors
/// [`NoFreeSpace`] if the obstacles leave no space at `step`, or if the rule has no position far enough away.
pub fn draw_goal<'a>(
    scenario: impl Into<IndexedScenario<'a>>,
    step: u64,
    robot_m: Vec2,
    stream: &mut Stream,
) -> Result<Vec2, NoFreeSpace> {
    let space = scenario.into();
    let scenario = space.scenario;
    let far = |Vec2 { x, y }: Vec2| length(x - robot_m.x, y - robot_m.y) >= scenario.task.min_goal_distance_m;
    draw(space, &scenario.goals, step, stream, far).ok_or(NoFreeSpace { what: "goal", step })
}

/// Draws a point by `rule` for which `fits` holds: by rejection sampling and, if that fails, the first fitting point of a grid.
/// Positions that the rule names are used even if an obstacle is there at this step.
fn draw(
    space: IndexedScenario,
    rule: &PlacementRule,
    step: u64,
    stream: &mut Stream,
    fits: impl Fn(Vec2) -> bool,
) -> Option<Vec2> {
    match rule {
        PlacementRule::Fixed { position_m, .. } => Some(*position_m).filter(|&place| fits(place)),
        PlacementRule::OneOf { positions_m } => {
            let fitting = || positions_m.iter().copied().filter(|&place| fits(place));
            let count = fitting().count();
            if count == 0 { None } else { fitting().nth(uniform_index(stream, count)) }
        }
        PlacementRule::Random { clearance_m } | PlacementRule::Within { clearance_m, .. } => {
            let (low, high) = bounds_m(space.scenario, rule);
            if !(low.x <= high.x && low.y <= high.y) {
                return None;
            }
            (0..TRIES)
                .map(|_| vec2(uniform(stream, low.x, high.x), uniform(stream, low.y, high.y)))
                .find(|&point| fits(point) && space.is_clear(point, step, *clearance_m))
                .or_else(|| free_points(space, rule, step).find(|&point| fits(point)))
        }
    }
}

/// The box that contains the points of a rule, in m; low exceeds high if it is empty.
fn bounds_m(scenario: &Scenario, rule: &PlacementRule) -> (Vec2, Vec2) {
    match *rule {
        PlacementRule::Within { min_m, max_m, .. } => (min_m, max_m),
        PlacementRule::Random { clearance_m: c } => {
            let (low, high) = scenario.enclosure.bounds_m();
            (vec2(low.x + c, low.y + c), vec2(high.x - c, high.y - c))
        }
        PlacementRule::Fixed { .. } | PlacementRule::OneOf { .. } => scenario.enclosure.bounds_m(),
    }
}

/// The points that satisfy `rule` at `step`: the clear points of a grid of 64 x 64 over the enclosure or the rule's region,
/// or those named positions at which the robot would not collide.
pub(super) fn free_points<'a>(
    scenario: impl Into<IndexedScenario<'a>>,
    rule: &PlacementRule,
    step: u64,
) -> impl Iterator<Item = Vec2> {
    let space = scenario.into();
    let scenario = space.scenario;
    let named = rule.positions_m();
    let clearance_m = rule.clearance_m().unwrap_or(scenario.keep_out_m());
    let (low, high) = match rule.region() {
        Some(Region { min_m, max_m }) => (min_m, max_m),
        None => scenario.enclosure.bounds_m(),
    };
    let at = move |k: usize, low: f32, high: f32| {
        (low + high) / 2.0 + ((k as f32 + 0.5) / GRID as f32 - 0.5) * (high - low)
    };
    let of_grid = if named.is_empty() { GRID * GRID } else { 0 };
    let grid = (0..of_grid).map(move |k| vec2(at(k % GRID, low.x, high.x), at(k / GRID, low.y, high.y)));
    let named = named.iter().copied();
    grid.chain(named).filter(move |&point| space.is_clear(point, step, clearance_m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Enclosure, Obstacle, ObstacleMotion, Shape, clearance};
    use wayfield_random::stream;

    fn with_central_square(side_m: f32) -> Scenario {
        let obstacle = Obstacle {
            shape: Shape::Rectangle { width_m: side_m, height_m: side_m },
            position_m: vec2(0.0, 0.0),
            rotation_rad: 0.0,
            motion: ObstacleMotion::Static,
        };
        Scenario { obstacles: vec![obstacle], ..Scenario::default() }
    }

    #[test]
    fn a_full_enclosure_gives_an_error_and_no_endless_search() {
        let no_room = with_central_square(3.9);
        let mut s = stream(1, "starts", 0);
        let error = draw_start(&no_room, 7, &mut s).expect_err("there is no room");
        assert_eq!(
            error.to_string(),
            "no free space for a start at step 7: use fewer or smaller obstacles, or a smaller clearance_m"
        );
        let narrow = Scenario { starts: PlacementRule::Random { clearance_m: 2.5 }, ..Scenario::default() };
        assert!(draw_start(&narrow, 0, &mut s).is_err(), "a clearance beyond the walls");
    }

    #[test]
    fn scarce_free_space_is_found() {
        // Two slabs leave a corridor in which only a strip of 20 um along a grid row is clear: random attempts miss it, the
        // grid finds it.
        let slab = |height_m, y| Obstacle {
            shape: Shape::Rectangle { width_m: 4.0, height_m },
            position_m: vec2(0.0, y),
            rotation_rad: 0.0,
            motion: ObstacleMotion::Static,
        };
        let scenario = Scenario {
            obstacles: vec![slab(1.6875, -1.15625), slab(1.625, 1.1875)],
            goals: PlacementRule::Random { clearance_m: 0.34374 },
            ..Scenario::default()
        };
        let mut s = stream(1, "goals", 0);
        for _ in 0..100 {
            let goal = draw_goal(&scenario, 0, vec2(-1.65, 0.0), &mut s).expect("there is room");
            assert!(clearance(&scenario, goal, 0) >= 0.34374);
        }
    }

    #[test]
    fn named_positions_are_used_if_they_are_far_enough() {
        let mut scenario = Scenario {
            starts: PlacementRule::Fixed { position_m: vec2(-1.5, 0.5), heading_rad: Some(0.25) },
            goals: PlacementRule::OneOf {
                positions_m: vec![vec2(1.0, 1.0), vec2(-1.4, 0.5), vec2(1.0, -1.0)],
            },
            ..Scenario::default()
        };
        let mut s = stream(3, "places", 0);
        let mut counts = [0; 2];
        for _ in 0..1_000 {
            let (start, goal) = draw_start_and_goal(&scenario, 0, &mut s).expect("two are far enough");
            assert_eq!(start, (-1.5, 0.5, 0.25));
            counts[usize::from(goal.y < 0.0)] += 1;
            assert_eq!(goal.x, 1.0, "0.1 m away is too near");
        }
        assert!(counts.iter().all(|&n| (420..580).contains(&n)), "they are equally likely: {counts:?}");
        for _ in 0..100 {
            let next = draw_goal(&scenario, 0, vec2(1.0, 1.0), &mut s).expect("there are two others");
            assert_ne!(next, vec2(1.0, 1.0));
        }
        scenario.goals = PlacementRule::Fixed { position_m: vec2(-1.4, 0.5), heading_rad: None };
        let error = draw_start_and_goal(&scenario, 0, &mut s).expect_err("too near the only start");
        assert_eq!(error.what, "goal");
    }

    #[test]
    fn positions_stay_inside_a_region_and_inside_an_l_shaped_enclosure() {
        let corners_m = vec![
            vec2(0.0, 0.0),
            vec2(4.0, 0.0),
            vec2(4.0, 2.0),
            vec2(2.0, 2.0),
            vec2(2.0, 4.0),
            vec2(0.0, 4.0),
        ];
        let scenario = Scenario {
            enclosure: Enclosure::Polygon { corners_m },
            starts: PlacementRule::Within { min_m: vec2(0.5, 2.0), max_m: vec2(3.5, 3.5), clearance_m: 0.35 },
            ..Scenario::default()
        };
        let mut s = stream(4, "places", 0);
        let mut upper = 0;
        for _ in 0..500 {
            let (start, goal) = draw_start_and_goal(&scenario, 0, &mut s).expect("there is room");
            assert!((0.5..=1.65).contains(&start.0) && (2.0..3.5).contains(&start.1), "{start:?}");
            assert!(clearance(&scenario, goal, 0) >= 0.35, "{goal:?}");
            upper += u32::from(goal.y > 2.0);
        }
        assert!((100..250).contains(&upper), "about a third of the L is its upper arm: {upper}");
    }

    #[test]
    fn headings_are_uniform() {
        let scenario = Scenario::default();
        let mut s = stream(5, "starts", 0);
        let mut quarters = [0; 4];
        for _ in 0..4_000 {
            let (_, _, heading) = draw_start(&scenario, 0, &mut s).expect("there is room");
            assert!(heading > -PI && heading <= PI);
            quarters[(((heading + PI) / (TAU / 4.0)) as usize).min(3)] += 1;
        }
        assert!(quarters.iter().all(|&n| (850..1150).contains(&n)), "{quarters:?}");
    }
}
