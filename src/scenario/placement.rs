//! Random starts and targets that keep clear of the walls and of the obstacles where they are at that step.
//!
//! In: a [`Scenario`], the step, a [`Stream`]. Out: a start or a target. Called at every reset: nothing
//! allocates.

use std::f32::consts::{PI, TAU};

use super::geometry::{is_clear, length};
use super::schema::{Enclosure, PlaceRule, Scenario};
use crate::random::{Stream, between, unit};

/// Random tries before the grid is walked.
const TRIES: u32 = 1_000;
/// Grid points along each side of the enclosure.
const GRID: u32 = 64;

/// At this moment no point satisfies the rule. (A scenario without findings has room at step 0 and at the
/// other moments that the checks look at.)
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no free space for a {what} at step {step}: fewer or smaller obstacles, or a smaller clearance_m, make room"
)]
pub struct NoFreePlace {
    /// "start" or "target".
    pub what: &'static str,
    /// The step at which there was no room.
    pub step: u64,
}

/// A start (x in m, y in m, heading in rad), the place by the rule `starts`, the heading even over (-pi, pi].
///
/// # Errors
/// [`NoFreePlace`] when the obstacles, where they are at `step`, leave no room.
pub fn draw_start(
    scenario: &Scenario,
    step: u64,
    stream: &mut Stream,
) -> Result<(f32, f32, f32), NoFreePlace> {
    let (x, y) = draw(scenario, &scenario.starts, step, stream, |_| true)
        .ok_or(NoFreePlace { what: "start", step })?;
    Ok((x, y, PI - TAU * unit(stream)))
}

/// A target (x, y in m) by the rule `targets`, at least `task.min_target_distance_m` from `robot_m`.
///
/// # Errors
/// [`NoFreePlace`] when the obstacles, where they are at `step`, leave no room.
pub fn draw_target(
    scenario: &Scenario,
    step: u64,
    robot_m: (f32, f32),
    stream: &mut Stream,
) -> Result<(f32, f32), NoFreePlace> {
    let far =
        |(x, y): (f32, f32)| length(x - robot_m.0, y - robot_m.1) >= scenario.task.min_target_distance_m;
    draw(scenario, &scenario.targets, step, stream, far).ok_or(NoFreePlace { what: "target", step })
}

/// A point by `rule` that `fits`: by rejection, and where room is scarce the first that fits on the grid.
fn draw(
    scenario: &Scenario,
    rule: &PlaceRule,
    step: u64,
    stream: &mut Stream,
    fits: impl Fn((f32, f32)) -> bool,
) -> Option<(f32, f32)> {
    let PlaceRule::Random { clearance_m } = *rule;
    let Enclosure::Rectangle { width_m, height_m } = scenario.enclosure;
    let (reach_x, reach_y) = (width_m / 2.0 - clearance_m, height_m / 2.0 - clearance_m);
    if !(reach_x >= 0.0 && reach_y >= 0.0) {
        return None;
    }
    (0..TRIES)
        .map(|_| (between(stream, -reach_x, reach_x), between(stream, -reach_y, reach_y)))
        .find(|&point| fits(point) && is_clear(scenario, point, step, clearance_m))
        .or_else(|| free_points(scenario, rule, step).find(|&point| fits(point)))
}

/// The points of a fixed grid of 64 x 64 over the enclosure that satisfy `rule` at `step`.
pub(super) fn free_points(
    scenario: &Scenario,
    rule: &PlaceRule,
    step: u64,
) -> impl Iterator<Item = (f32, f32)> {
    let PlaceRule::Random { clearance_m } = *rule;
    let Enclosure::Rectangle { width_m, height_m } = scenario.enclosure;
    let at = |k: u32, extent: f32| ((k as f32 + 0.5) / GRID as f32 - 0.5) * extent;
    (0..GRID * GRID)
        .map(move |k| (at(k % GRID, width_m), at(k / GRID, height_m)))
        .filter(move |&point| is_clear(scenario, point, step, clearance_m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::stream;
    use crate::scenario::{Obstacle, ObstacleMotion, Shape, clearance};

    fn boxed_in(side_m: f32) -> Scenario {
        let obstacle = Obstacle {
            shape: Shape::Rectangle { width_m: side_m, height_m: side_m },
            position_m: (0.0, 0.0),
            rotation_rad: 0.0,
            motion: ObstacleMotion::Still,
        };
        Scenario { obstacles: vec![obstacle], ..Scenario::default() }
    }

    #[test]
    fn no_room_is_an_error_not_an_endless_search() {
        let no_room = boxed_in(3.9);
        let mut s = stream(1, "starts", 0);
        let error = draw_start(&no_room, 7, &mut s).expect_err("there is no room");
        assert_eq!(
            error.to_string(),
            "no free space for a start at step 7: fewer or smaller obstacles, or a smaller clearance_m, make room"
        );
        let narrow = Scenario { starts: PlaceRule::Random { clearance_m: 2.5 }, ..Scenario::default() };
        assert!(draw_start(&narrow, 0, &mut s).is_err(), "a clearance beyond the walls");
    }

    #[test]
    fn scarce_room_is_found_all_the_same() {
        // Two slabs leave a corridor in which only a strip of 20 um, along a row of the grid, is clear
        // enough: the grid finds its points when chance does not.
        let mut scenario = boxed_in(1.0);
        let slab = |height_m, y| Obstacle {
            shape: Shape::Rectangle { width_m: 4.0, height_m },
            position_m: (0.0, y),
            rotation_rad: 0.0,
            motion: ObstacleMotion::Still,
        };
        scenario.obstacles = vec![slab(1.6875, -1.15625), slab(1.625, 1.1875)];
        scenario.targets = PlaceRule::Random { clearance_m: 0.34374 };
        let mut s = stream(1, "targets", 0);
        for _ in 0..100 {
            let target = draw_target(&scenario, 0, (-1.65, 0.0), &mut s).expect("there is room");
            assert!(clearance(&scenario, target, 0) >= 0.34374);
        }
    }

    #[test]
    fn headings_cover_the_circle_evenly() {
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
