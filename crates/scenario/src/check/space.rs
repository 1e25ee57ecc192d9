//! Whether everything stays inside the enclosure, and whether there is room for starts, goals and the benchmark route.
//!
//! Asked of scenarios whose numbers are sound.

use super::Diagnostics;
use super::extent::{EnclosureExtent, TOLERANCE_M, moves};
use crate::geometry::{clearance, length};
use crate::motion::pose_at;
use crate::placement::free_points;
use crate::schema::*;
use glam::{Vec2, vec2};

/// At how many moments of an episode room is looked for when obstacles move.
const SAMPLED_STEPS: u64 = 4;
/// So many sides of obstacles are gone through for one place, over all moments: where there are more, fewer moments do.
const MAX_EDGE_CHECKS: usize = 80_000;
/// So many layouts of generators are looked at.
const MAX_SAMPLED_LAYOUTS: usize = 4;
/// Where furnishing them takes more than this (obstacles to place times sides to keep clear of), fewer are: a check
/// while the hand still moves must not be felt.
const GENERATION_WORK_BUDGET: usize = 20_000;
/// Where furnishing one takes more than this, none is.
const MAX_GENERATION_WORK: usize = 400_000;
/// Of random starts, one in so many must leave a goal that is far enough.
const FAR_START_DIVISOR: usize = 4;

pub(super) fn check(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let inside = EnclosureExtent::new(&scenario.enclosure);
    walls(scenario, &inside, diagnostics);
    for (k, obstacle) in scenario.obstacles.iter().enumerate() {
        let over = inside.overhang_m(obstacle);
        if over > TOLERANCE_M {
            let (what, mend) = if moves(obstacle) {
                ("reaches on its way", "shorten the way or make it smaller")
            } else {
                ("reaches", "move it inwards or make it smaller")
            };
            diagnostics.push(
                format_args!("obstacles[{k}]"),
                format!("{what} {over:.3} m beyond the enclosure: {mend}"),
            );
        }
    }
    generators(scenario, diagnostics);
    named(scenario, diagnostics);
    benchmark_route(scenario, diagnostics);
    room(scenario, diagnostics);
}

/// The middle line of an inner wall must be inside; its ends may lie in the enclosure's walls.
fn walls(scenario: &Scenario, inside: &EnclosureExtent<'_>, diagnostics: &mut Diagnostics) {
    for (k, wall) in scenario.walls.iter().enumerate() {
        let before = diagnostics.0.len();
        for (j, &corner) in wall.corners_m.iter().enumerate() {
            let over = inside.segment_overhang_m(corner, corner, 0.0);
            if over > TOLERANCE_M {
                let message = format!("lies {over:.3} m beyond the enclosure: move it inwards");
                diagnostics.push(format_args!("walls[{k}].corners_m[{j}]"), message);
            }
        }
        if diagnostics.0.len() > before {
            continue;
        }
        for (j, ends) in wall.corners_m.windows(2).enumerate() {
            let over = inside.segment_overhang_m(ends[0], ends[1], 0.0);
            if over > TOLERANCE_M {
                let message = format!(
                    "begins a piece that reaches {over:.3} m beyond the enclosure: lead it round by another corner"
                );
                diagnostics.push(format_args!("walls[{k}].corners_m[{j}]"), message);
            }
        }
    }
}

fn generators(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let (low, high) = scenario.enclosure.bounds_m();
    for (k, generator) in scenario.generators.iter().enumerate() {
        let Some(Region { min_m, max_m }) = generator.within else { continue };
        if min_m.x >= high.x || max_m.x <= low.x || min_m.y >= high.y || max_m.y <= low.y {
            let message = "lies outside the enclosure: move it inwards, or leave it out";
            diagnostics.push(format_args!("generators[{k}].within"), message);
        }
    }
}

/// The places that a rule names, each with its path below the rule's; none where the rule draws them.
fn places(rule: &PlacementRule) -> Vec<(String, Vec2)> {
    match rule {
        PlacementRule::Random { .. } | PlacementRule::Within { .. } => Vec::new(),
        PlacementRule::Fixed { position_m, .. } => vec![("position_m".into(), *position_m)],
        PlacementRule::OneOf { positions_m } => {
            positions_m.iter().enumerate().map(|(k, &place)| (format!("positions_m[{k}]"), place)).collect()
        }
    }
}

/// Places that the rules name must be where the robot doesn't collide with what stands still.
fn named(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let standing = standing(scenario);
    for (name, rule) in [("starts", &scenario.starts), ("goals", &scenario.goals)] {
        for (path, place) in places(rule) {
            let clear = clearance(&standing, place, 0);
            keeps_clear(format_args!("{name}.{path}"), clear, scenario.task.collision_range_m, diagnostics);
        }
    }
}

/// The benchmark route's ends must be where the robot doesn't collide, and apart.
fn benchmark_route(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let (benchmark_route, task) = (&scenario.benchmark_route, &scenario.task);
    for (name, point) in [("start_m", benchmark_route.start_m), ("goal_m", benchmark_route.goal_m)] {
        let clear = clearance(scenario, point, 0);
        keeps_clear(format_args!("benchmark_route.{name}"), clear, task.collision_range_m, diagnostics);
    }
    let apart = length(
        benchmark_route.start_m.x - benchmark_route.goal_m.x,
        benchmark_route.start_m.y - benchmark_route.goal_m.y,
    );
    diagnostics.check_above(
        format_args!("benchmark_route.goal_m"),
        apart,
        task.goal_radius_m,
        "the goal radius from the start",
    );
}

fn keeps_clear(path: std::fmt::Arguments<'_>, clear: f32, least: f32, diagnostics: &mut Diagnostics) {
    if clear < least {
        let lies = if clear < 0.0 { "inside an obstacle or wall" } else { "from an obstacle or wall" };
        let message =
            format!("lies {:.3} m {lies}: put it at least {least} m clear of everything", clear.abs());
        diagnostics.push(path, message);
    }
}

/// Starts and goals must find room, and goals far enough from wherever the robot is.
fn room(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let moments = if scenario.obstacles.iter().any(moves) {
        (MAX_EDGE_CHECKS / sides(scenario).max(1)).clamp(1, SAMPLED_STEPS as usize) as u64
    } else {
        1
    };
    let (mut starts, mut goals, mut spread) = (None, None, false);
    for step in (0..moments).map(|k| k * u64::from(scenario.task.max_episode_steps) / SAMPLED_STEPS) {
        let found = FreeSpace::new(&frozen(scenario, step));
        starts = starts.or((!found.starts).then_some(step));
        goals = goals.or((!found.goals).then_some(step));
        spread |= found.goals && !found.wide;
    }
    none("starts", starts, &scenario.starts, diagnostics);
    none("goals", goals, &scenario.goals, diagnostics);
    if spread {
        let message = format!(
            "is {}: the free space for goals is less than twice as long, so some places of the robot leave no \
             goal; write less, or make room",
            scenario.task.min_goal_distance_m
        );
        diagnostics.push(format_args!("task.min_goal_distance_m"), message);
    }
    if starts.is_none() && goals.is_none() {
        far_enough(scenario, diagnostics);
        if !spread {
            layouts(scenario, diagnostics);
        }
    }
}

/// What the rules find in a world at one moment. Of a rule that names places nothing is asked here.
struct FreeSpace {
    starts: bool,
    goals: bool,
    /// Whether random goals lie so far apart that one is far enough from anywhere.
    wide: bool,
}

impl FreeSpace {
    /// In a world in which everything stands.
    fn new(frozen: &Scenario) -> Self {
        let far = 2.0 * frozen.task.min_goal_distance_m;
        let any =
            |rule: &PlacementRule| !places(rule).is_empty() || free_points(frozen, rule, 0).next().is_some();
        let starts = any(&frozen.starts);
        let PlacementRule::Random { .. } = frozen.goals else {
            return Self { starts, goals: any(&frozen.goals), wide: true };
        };
        let (mut low, mut high) = (Vec2::MAX, Vec2::MIN);
        for Vec2 { x, y } in free_points(frozen, &frozen.goals, 0) {
            low = vec2(low.x.min(x), low.y.min(y));
            high = vec2(high.x.max(x), high.y.max(y));
            if high.x - low.x >= far || high.y - low.y >= far {
                return Self { starts, goals: true, wide: true };
            }
        }
        Self { starts, goals: low.x <= high.x, wide: false }
    }
}

/// What generators make must leave room, too: a few layouts are looked at.
fn layouts(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let made = scenario.max_obstacles() - scenario.obstacles.len();
    if made == 0 {
        return;
    }
    let work = made * (made + sides(scenario));
    if work > MAX_GENERATION_WORK {
        return;
    }
    let mut placed = 0;
    for layout_seed in 0..(GENERATION_WORK_BUDGET / work).clamp(1, MAX_SAMPLED_LAYOUTS) as u64 {
        let generated = scenario.with_generated_obstacles(layout_seed);
        placed += generated.obstacles.len() - scenario.obstacles.len();
        let found = FreeSpace::new(&frozen(&generated, 0));
        let what = match found {
            FreeSpace { starts: false, .. } => "for a start",
            FreeSpace { goals: false, .. } => "for a goal",
            FreeSpace { wide: false, .. } => "for a goal that is task.min_goal_distance_m away",
            _ => continue,
        };
        let message = format!(
            "can leave no room {what}: write fewer or smaller ones, keep them within a part of the enclosure, or write \
             a smaller clearance_m"
        );
        diagnostics.push(format_args!("generators"), message);
        return;
    }
    if placed == 0 && !diagnostics.0.iter().any(|finding| finding.path.starts_with("generators")) {
        let message = "find no room for anything: write a smaller gap_m, smaller sizes, or a larger `within`";
        diagnostics.push(format_args!("generators"), message);
    }
}

fn none(name: &str, step: Option<u64>, rule: &PlacementRule, diagnostics: &mut Diagnostics) {
    let (of, clearance_m) = match rule {
        PlacementRule::Random { clearance_m } => ("the enclosure", clearance_m),
        PlacementRule::Within { clearance_m, .. } => ("its rectangle", clearance_m),
        PlacementRule::Fixed { .. } | PlacementRule::OneOf { .. } => return,
    };
    if let Some(step) = step {
        let message = format!(
            "finds no free space at step {step}: no point of {of} is {clearance_m} m clear; use fewer or smaller \
             obstacles, or a smaller clearance_m"
        );
        diagnostics.push(format_args!("{name}"), message);
    }
}

/// Starts must leave a goal that is far enough. (Of random goals, [`room`] has seen to that.)
fn far_enough(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    if matches!(scenario.goals, PlacementRule::Random { .. }) {
        return;
    }
    let least = scenario.task.min_goal_distance_m;
    let frozen = frozen(scenario, 0);
    let points = |rule: &PlacementRule| -> Vec<Vec2> {
        let named: Vec<_> = places(rule).into_iter().map(|(_, place)| place).collect();
        if named.is_empty() { free_points(&frozen, rule, 0).collect() } else { named }
    };
    let goals = points(&scenario.goals);
    let leaves = |start: Vec2| goals.iter().any(|goal| length(goal.x - start.x, goal.y - start.y) >= least);
    if let (PlacementRule::Fixed { position_m: start, .. }, PlacementRule::Fixed { position_m: goal, .. }) =
        (&scenario.starts, &scenario.goals)
    {
        let apart = length(goal.x - start.x, goal.y - start.y);
        if apart < least {
            let message = format!(
                "lies {apart:.3} m from the start: put it {least} m away at least, or write less for \
                 task.min_goal_distance_m"
            );
            diagnostics.push(format_args!("goals.position_m"), message);
        }
        return;
    }
    let named = places(&scenario.starts);
    for (path, start) in &named {
        if !leaves(*start) {
            let message = format!(
                "leaves no goal that is {least} m away: move it, or write less for task.min_goal_distance_m"
            );
            diagnostics.push(format_args!("starts.{path}"), message);
        }
    }
    if named.is_empty() {
        let starts = points(&scenario.starts);
        let far = starts.iter().filter(|&&start| leaves(start)).count();
        if far * FAR_START_DIVISOR < starts.len() {
            let message = format!(
                "lie too near the starts: fewer than one start in {FAR_START_DIVISOR} leaves a goal that is {least} m away; \
                 move them, or write less for task.min_goal_distance_m"
            );
            diagnostics.push(format_args!("goals"), message);
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
        obstacle.position_m = vec2(x, y);
        obstacle.rotation_rad = rotation;
        obstacle.motion = ObstacleMotion::Static;
    }
    still
}
