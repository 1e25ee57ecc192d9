//! Whether everything stays inside the enclosure, and whether there is room for starts, targets and the course.
//!
//! Asked of scenarios whose numbers are sound.

use super::Notes;
use super::extent::{Inside, SLACK_M, moves};
use crate::geometry::{clearance, length};
use crate::motion::pose_at;
use crate::placement::free_points;
use crate::schema::*;

/// At how many moments of an episode room is looked for when obstacles move.
const MOMENTS: u64 = 4;
/// So many sides of obstacles are gone through for one place, over all moments: where there are more, fewer moments do.
const MOST_SIDES: usize = 80_000;
/// So many layouts of generators are looked at.
const LAYOUTS: usize = 4;
/// Where furnishing them takes more than this (obstacles to place times sides to keep clear of), fewer are: a check
/// while the hand still moves must not be felt.
const QUICK_FURNISHING: usize = 20_000;
/// Where furnishing one takes more than this, none is.
const MOST_FURNISHING: usize = 400_000;
/// Of random starts, one in so many must leave a target that is far enough.
const FAR_STARTS: usize = 4;

pub(super) fn check(scenario: &Scenario, notes: &mut Notes) {
    let inside = Inside::of(&scenario.enclosure);
    walls(scenario, &inside, notes);
    for (k, obstacle) in scenario.obstacles.iter().enumerate() {
        let over = inside.beyond(obstacle);
        if over > SLACK_M {
            let (what, mend) = if moves(obstacle) {
                ("reaches on its way", "shorten the way or make it smaller")
            } else {
                ("reaches", "move it inwards or make it smaller")
            };
            notes.add(
                format_args!("obstacles[{k}]"),
                format!("{what} {over:.3} m beyond the enclosure: {mend}"),
            );
        }
    }
    generators(scenario, notes);
    named(scenario, notes);
    course(scenario, notes);
    room(scenario, notes);
}

/// The middle line of an inner wall must be inside; its ends may lie in the enclosure's walls.
fn walls(scenario: &Scenario, inside: &Inside<'_>, notes: &mut Notes) {
    for (k, wall) in scenario.walls.iter().enumerate() {
        let before = notes.0.len();
        for (j, &corner) in wall.corners_m.iter().enumerate() {
            let over = inside.along(corner, corner, 0.0);
            if over > SLACK_M {
                let message = format!("lies {over:.3} m beyond the enclosure: move it inwards");
                notes.add(format_args!("walls[{k}].corners_m[{j}]"), message);
            }
        }
        if notes.0.len() > before {
            continue;
        }
        for (j, ends) in wall.corners_m.windows(2).enumerate() {
            let over = inside.along(ends[0], ends[1], 0.0);
            if over > SLACK_M {
                let message = format!(
                    "begins a piece that reaches {over:.3} m beyond the enclosure: lead it round by another corner"
                );
                notes.add(format_args!("walls[{k}].corners_m[{j}]"), message);
            }
        }
    }
}

fn generators(scenario: &Scenario, notes: &mut Notes) {
    let (low, high) = scenario.enclosure.bounds_m();
    for (k, generator) in scenario.generators.iter().enumerate() {
        let Some(Region { min_m, max_m }) = generator.within else { continue };
        if min_m.0 >= high.0 || max_m.0 <= low.0 || min_m.1 >= high.1 || max_m.1 <= low.1 {
            let message = "lies outside the enclosure: move it inwards, or leave it out";
            notes.add(format_args!("generators[{k}].within"), message);
        }
    }
}

/// The places that a rule names, each with its path below the rule's; none where the rule draws them.
fn places(rule: &PlaceRule) -> Vec<(String, (f32, f32))> {
    match rule {
        PlaceRule::Random { .. } | PlaceRule::Within { .. } => Vec::new(),
        PlaceRule::Fixed { at_m, .. } => vec![("at_m".into(), *at_m)],
        PlaceRule::OneOf { places_m } => {
            places_m.iter().enumerate().map(|(k, &place)| (format!("places_m[{k}]"), place)).collect()
        }
    }
}

/// Places that the rules name must be where the robot doesn't collide with what stands still.
fn named(scenario: &Scenario, notes: &mut Notes) {
    let standing = standing(scenario);
    for (name, rule) in [("starts", &scenario.starts), ("targets", &scenario.targets)] {
        for (path, place) in places(rule) {
            let clear = clearance(&standing, place, 0);
            keeps_clear(format_args!("{name}.{path}"), clear, scenario.task.collision_range_m, notes);
        }
    }
}

/// The course's ends must be where the robot doesn't collide, and apart.
fn course(scenario: &Scenario, notes: &mut Notes) {
    let (course, task) = (&scenario.course, &scenario.task);
    for (name, point) in [("start_m", course.start_m), ("target_m", course.target_m)] {
        let clear = clearance(scenario, point, 0);
        keeps_clear(format_args!("course.{name}"), clear, task.collision_range_m, notes);
    }
    let apart = length(course.start_m.0 - course.target_m.0, course.start_m.1 - course.target_m.1);
    notes.above(format_args!("course.target_m"), apart, task.goal_radius_m, "the goal radius from the start");
}

fn keeps_clear(path: std::fmt::Arguments<'_>, clear: f32, least: f32, notes: &mut Notes) {
    if clear < least {
        let lies = if clear < 0.0 { "inside an obstacle or wall" } else { "from an obstacle or wall" };
        let message =
            format!("lies {:.3} m {lies}: put it at least {least} m clear of everything", clear.abs());
        notes.add(path, message);
    }
}

/// Starts and targets must find room, and targets far enough from wherever the robot is.
fn room(scenario: &Scenario, notes: &mut Notes) {
    let moments = if scenario.obstacles.iter().any(moves) {
        (MOST_SIDES / sides(scenario).max(1)).clamp(1, MOMENTS as usize) as u64
    } else {
        1
    };
    let (mut starts, mut targets, mut spread) = (None, None, false);
    for step in (0..moments).map(|k| k * u64::from(scenario.task.time_limit_steps) / MOMENTS) {
        let found = Room::of(&frozen(scenario, step));
        starts = starts.or((!found.starts).then_some(step));
        targets = targets.or((!found.targets).then_some(step));
        spread |= found.targets && !found.wide;
    }
    none("starts", starts, &scenario.starts, notes);
    none("targets", targets, &scenario.targets, notes);
    if spread {
        let message = format!(
            "is {}: the free space for targets is less than twice as long, so some places of the robot leave no \
             target; write less, or make room",
            scenario.task.min_target_distance_m
        );
        notes.add(format_args!("task.min_target_distance_m"), message);
    }
    if starts.is_none() && targets.is_none() {
        far_enough(scenario, notes);
        if !spread {
            layouts(scenario, notes);
        }
    }
}

/// What the rules find in a world at one moment. Of a rule that names places nothing is asked here.
struct Room {
    starts: bool,
    targets: bool,
    /// Whether random targets lie so far apart that one is far enough from anywhere.
    wide: bool,
}

impl Room {
    /// In a world in which everything stands.
    fn of(frozen: &Scenario) -> Self {
        let far = 2.0 * frozen.task.min_target_distance_m;
        let any =
            |rule: &PlaceRule| !places(rule).is_empty() || free_points(frozen, rule, 0).next().is_some();
        let starts = any(&frozen.starts);
        let PlaceRule::Random { .. } = frozen.targets else {
            return Self { starts, targets: any(&frozen.targets), wide: true };
        };
        let (mut low, mut high) = ((f32::MAX, f32::MAX), (f32::MIN, f32::MIN));
        for (x, y) in free_points(frozen, &frozen.targets, 0) {
            low = (low.0.min(x), low.1.min(y));
            high = (high.0.max(x), high.1.max(y));
            if high.0 - low.0 >= far || high.1 - low.1 >= far {
                return Self { starts, targets: true, wide: true };
            }
        }
        Self { starts, targets: low.0 <= high.0, wide: false }
    }
}

/// What generators make must leave room, too: a few layouts are looked at.
fn layouts(scenario: &Scenario, notes: &mut Notes) {
    let made = scenario.most_obstacles() - scenario.obstacles.len();
    if made == 0 {
        return;
    }
    let work = made * (made + sides(scenario));
    if work > MOST_FURNISHING {
        return;
    }
    let mut placed = 0;
    for layout in 0..(QUICK_FURNISHING / work).clamp(1, LAYOUTS) as u64 {
        let furnished = scenario.furnished(layout);
        placed += furnished.obstacles.len() - scenario.obstacles.len();
        let found = Room::of(&frozen(&furnished, 0));
        let what = match found {
            Room { starts: false, .. } => "for a start",
            Room { targets: false, .. } => "for a target",
            Room { wide: false, .. } => "for a target that is task.min_target_distance_m away",
            _ => continue,
        };
        let message = format!(
            "can leave no room {what}: write fewer or smaller ones, keep them within a part of the enclosure, or write \
             a smaller clearance_m"
        );
        notes.add(format_args!("generators"), message);
        return;
    }
    if placed == 0 && !notes.0.iter().any(|finding| finding.path.starts_with("generators")) {
        let message = "find no room for anything: write a smaller gap_m, smaller sizes, or a larger `within`";
        notes.add(format_args!("generators"), message);
    }
}

fn none(name: &str, step: Option<u64>, rule: &PlaceRule, notes: &mut Notes) {
    let (of, clearance_m) = match rule {
        PlaceRule::Random { clearance_m } => ("the enclosure", clearance_m),
        PlaceRule::Within { clearance_m, .. } => ("its rectangle", clearance_m),
        PlaceRule::Fixed { .. } | PlaceRule::OneOf { .. } => return,
    };
    if let Some(step) = step {
        let message = format!(
            "finds no free space at step {step}: no point of {of} is {clearance_m} m clear; use fewer or smaller \
             obstacles, or a smaller clearance_m"
        );
        notes.add(format_args!("{name}"), message);
    }
}

/// Starts must leave a target that is far enough. (Of random targets, [`room`] has seen to that.)
fn far_enough(scenario: &Scenario, notes: &mut Notes) {
    if matches!(scenario.targets, PlaceRule::Random { .. }) {
        return;
    }
    let least = scenario.task.min_target_distance_m;
    let frozen = frozen(scenario, 0);
    let points = |rule: &PlaceRule| -> Vec<(f32, f32)> {
        let named: Vec<_> = places(rule).into_iter().map(|(_, place)| place).collect();
        if named.is_empty() { free_points(&frozen, rule, 0).collect() } else { named }
    };
    let targets = points(&scenario.targets);
    let leaves = |start: (f32, f32)| {
        targets.iter().any(|target| length(target.0 - start.0, target.1 - start.1) >= least)
    };
    if let (PlaceRule::Fixed { at_m: start, .. }, PlaceRule::Fixed { at_m: target, .. }) =
        (&scenario.starts, &scenario.targets)
    {
        let apart = length(target.0 - start.0, target.1 - start.1);
        if apart < least {
            let message = format!(
                "lies {apart:.3} m from the start: put it {least} m away at least, or write less for \
                 task.min_target_distance_m"
            );
            notes.add(format_args!("targets.at_m"), message);
        }
        return;
    }
    let named = places(&scenario.starts);
    for (path, start) in &named {
        if !leaves(*start) {
            let message = format!(
                "leaves no target that is {least} m away: move it, or write less for task.min_target_distance_m"
            );
            notes.add(format_args!("starts.{path}"), message);
        }
    }
    if named.is_empty() {
        let starts = points(&scenario.starts);
        let far = starts.iter().filter(|&&start| leaves(start)).count();
        if far * FAR_STARTS < starts.len() {
            let message = format!(
                "lie too near the starts: fewer than one start in {FAR_STARTS} leaves a target that is {least} m away; \
                 move them, or write less for task.min_target_distance_m"
            );
            notes.add(format_args!("targets"), message);
        }
    }
}

/// How many sides all obstacles and inner walls have.
fn sides(scenario: &Scenario) -> usize {
    let of_obstacle = |obstacle: &Obstacle| match &obstacle.shape {
        Shape::Circle { .. } => 1,
        Shape::Rectangle { .. } | Shape::Capsule { .. } => 2,
        Shape::Polygon { corners_m } => corners_m.len(),
    };
    scenario.obstacles.iter().map(of_obstacle).sum::<usize>()
        + scenario.walls.iter().map(|wall| wall.corners_m.len()).sum::<usize>()
}

/// The scenario without what moves.
fn standing(scenario: &Scenario) -> Scenario {
    let mut still = scenario.clone();
    still.obstacles.retain(|obstacle| !moves(obstacle));
    still
}

/// The scenario with every obstacle standing where it is at `step`.
fn frozen(scenario: &Scenario, step: u64) -> Scenario {
    let mut still = scenario.clone();
    for obstacle in &mut still.obstacles {
        let (x, y, rotation) = pose_at(obstacle, step, scenario.task.control_period_s);
        obstacle.position_m = (x, y);
        obstacle.rotation_rad = rotation;
        obstacle.motion = ObstacleMotion::Still;
    }
    still
}
