//! The checks that everything stays inside the enclosure and leaves free space for starts, goals and the benchmark route.
//!
//! In: the valid part of a scenario.

use super::extent::{EnclosureExtent, TOLERANCE_M};
use super::{Diagnostics, ValidPart};
use crate::geometry::{Solid, length, nearest};
use crate::limits::{MAX_EDGE_CHECKS, MAX_GENERATION_WORK};
use crate::motion::pose_at;
use crate::placement::free_points;
use crate::schema::*;
use glam::{Vec2, vec2};

/// Maximum number of moments of an episode at which free space is checked if obstacles move.
const SAMPLED_STEPS: u64 = 4;
/// Maximum number of generated layouts that are checked.
const MAX_SAMPLED_LAYOUTS: usize = 4;
/// Work (number of obstacles to place, multiplied by the number of sides to test) spent on generating layouts. The more work a
/// layout takes, the fewer are checked. The editor runs this check during a drag, so it must be quick.
const GENERATION_WORK_BUDGET: usize = 20_000;
/// One in this many random starts must have a goal that is far enough away.
const FAR_START_DIVISOR: usize = 4;

pub(super) fn check(valid: &ValidPart, diagnostics: &mut Diagnostics) {
    if !valid.has("enclosure") {
        return;
    }
    let scenario = &valid.scenario;
    check_regions(scenario, diagnostics);
    if valid.has_keep_out() {
        check_named_positions(valid, diagnostics);
    }
    if valid.has("task") && valid.has("robot.shape") {
        if let Some(route) = &scenario.benchmark_route {
            check_benchmark_route(valid, route, diagnostics);
        }
        check_free_space(valid, diagnostics);
    }
}

/// Checks that obstacles stay inside the enclosure. The field paths of the diagnostics are those in the whole scenario.
pub(super) fn check_paths(valid: &ValidPart, diagnostics: &mut Diagnostics) {
    if !valid.has("enclosure") {
        return;
    }
    let inside = EnclosureExtent::new(&valid.scenario.enclosure);
    for (k, obstacle) in &valid.obstacles_at_any_speed {
        let over = inside.overhang_m(obstacle);
        if over > TOLERANCE_M {
            let (when, fix) = if obstacle.motion.is_moving() {
                (" while it moves", "shorten its path or make it smaller")
            } else {
                ("", "move it inside or make it smaller")
            };
            diagnostics.push(
                format_args!("obstacles[{k}]"),
                format!("extends {over:.3} m outside the enclosure{when}: {fix}"),
            );
        }
    }
}

/// Checks that the centre line of every inner wall is inside the enclosure; it may end in the enclosure's own walls. Solid
/// cells must be inside.
pub(super) fn check_walls(valid: &ValidPart, diagnostics: &mut Diagnostics) {
    if !valid.has("enclosure") {
        return;
    }
    let scenario = &valid.scenario;
    let inside = EnclosureExtent::new(&scenario.enclosure);
    for (k, wall) in scenario.walls.iter().enumerate() {
        let blocks = wall.blocks().iter().map(|block| inside.overhang_m(&block.obstacle()));
        let over = blocks.fold(0.0, f32::max);
        if over > TOLERANCE_M {
            let message = format!(
                "extend {over:.3} m outside the enclosure: move `centre_m`, write a smaller `cell_m`, or free the cells there"
            );
            diagnostics.push(format_args!("walls[{k}].cells"), message);
        }
        let before = diagnostics.found.len();
        for (j, &corner) in wall.corners_m.iter().enumerate() {
            let over = inside.segment_overhang_m(corner, corner, 0.0);
            if over > TOLERANCE_M {
                let message = format!("is {over:.3} m outside the enclosure: move it inside");
                diagnostics.push(format_args!("walls[{k}].corners_m[{j}]"), message);
            }
        }
        if diagnostics.found.len() > before {
            continue;
        }
        for (j, ends) in wall.corners_m.windows(2).enumerate() {
            let over = inside.segment_overhang_m(ends[0], ends[1], 0.0);
            if over > TOLERANCE_M {
                let message = format!(
                    "starts a segment that extends {over:.3} m outside the enclosure: add a corner that goes around"
                );
                diagnostics.push(format_args!("walls[{k}].corners_m[{j}]"), message);
            }
        }
    }
}

fn check_regions(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let (low, high) = scenario.enclosure.bounds_m();
    for (k, generator) in scenario.generators.iter().enumerate() {
        let Some(Region { min_m, max_m }) = generator.within else { continue };
        if min_m.x >= high.x || max_m.x <= low.x || min_m.y >= high.y || max_m.y <= low.y {
            let message = "is outside the enclosure: move it inside, or remove it";
            diagnostics.push(format_args!("generators[{k}].within"), message);
        }
    }
}

/// The positions that a rule names, each with its field path below the rule. Empty if the rule draws positions.
fn named_positions(rule: &PlacementRule) -> impl Iterator<Item = (String, Vec2)> {
    let is_list = matches!(rule, PlacementRule::OneOf { .. });
    let path = move |k| if is_list { format!("positions_m[{k}]") } else { "position_m".into() };
    rule.positions_m().iter().enumerate().map(move |(k, &position)| (path(k), position))
}

/// Checks that the robot does not collide with a wall or static obstacle at the positions that the rules name.
fn check_named_positions(valid: &ValidPart, diagnostics: &mut Diagnostics) {
    let scenario = &valid.scenario;
    let still = without_moving_obstacles(scenario);
    let is_still = |&k: &usize| !scenario.obstacles[k].motion.is_moving();
    let indices: Vec<usize> = (0..scenario.obstacles.len()).filter(is_still).collect();
    for (name, rule) in [("starts", &scenario.starts), ("goals", &scenario.goals)] {
        for (path, position) in named_positions(rule) {
            let near = match nearest(&still, position, 0) {
                (Solid::Obstacle(k), clear) => (Solid::Obstacle(indices[k]), clear),
                near => near,
            };
            check_clearance(format_args!("{name}.{path}"), near, valid, diagnostics);
        }
    }
}

/// Checks that the robot does not collide at either end of the benchmark route, and that the ends are not too close together.
fn check_benchmark_route(valid: &ValidPart, route: &BenchmarkRoute, diagnostics: &mut Diagnostics) {
    let scenario = &valid.scenario;
    for (name, point) in [("start_m", route.start_m), ("goal_m", route.goal_m)] {
        let near = nearest(scenario, point, 0);
        check_clearance(format_args!("benchmark_route.{name}"), near, valid, diagnostics);
    }
    let apart = length(route.start_m.x - route.goal_m.x, route.start_m.y - route.goal_m.y);
    diagnostics.check_above(
        format_args!("benchmark_route.goal_m"),
        apart,
        scenario.task.goal_radius_m,
        ("the goal radius from the start", "task.goal_radius_m"),
    );
}

/// Reports a position at which the robot may collide with the solid `near`. The message names the solid as in the whole scenario.
fn check_clearance(
    path: std::fmt::Arguments<'_>,
    (near, clear): (Solid, f32),
    valid: &ValidPart,
    diagnostics: &mut Diagnostics,
) {
    let least = valid.scenario.keep_out_m();
    if clear < least {
        let place = match (near, clear < 0.0) {
            (Solid::Enclosure, true) => "outside the enclosure".into(),
            (Solid::Enclosure, false) => "from the wall of the enclosure".into(),
            (Solid::Wall(k), inside) => {
                format!("{} `{}`", inside_or_from(inside), valid.path_in_whole("walls", k))
            }
            (Solid::Obstacle(k), inside) => {
                format!("{} `{}`", inside_or_from(inside), valid.path_in_whole("obstacles", k))
            }
        };
        let message =
            format!("is {:.3} m {place}: keep it at least {least} m away from everything", clear.abs());
        diagnostics.push(path, message);
    }
}

fn inside_or_from(is_inside: bool) -> &'static str {
    if is_inside { "inside" } else { "from" }
}

/// Checks that there is free space for starts and goals, and that enough starts have a goal that is far enough away.
fn check_free_space(valid: &ValidPart, diagnostics: &mut Diagnostics) {
    let scenario = &valid.scenario;
    let moments = if scenario.obstacles.iter().any(|obstacle| obstacle.motion.is_moving()) {
        (MAX_EDGE_CHECKS / sides(scenario).max(1)).clamp(1, SAMPLED_STEPS as usize) as u64
    } else {
        1
    };
    let (mut starts, mut goals, mut too_near) = (None, None, false);
    for step in (0..moments).map(|k| k * u64::from(scenario.task.max_episode_steps) / moments) {
        let found = FreeSpace::new(&frozen(scenario, step));
        starts = starts.or((!found.starts).then_some(step));
        goals = goals.or((!found.goals).then_some(step));
        too_near |= !found.far_goals;
    }
    let (has_starts, has_goals) = (valid.has("starts"), valid.has("goals"));
    report_no_free_space("starts", starts.filter(|_| has_starts), &scenario.starts, diagnostics);
    report_no_free_space("goals", goals.filter(|_| has_goals), &scenario.goals, diagnostics);
    if has_starts && has_goals && starts.is_none() && goals.is_none() {
        let before = diagnostics.found.len();
        check_goal_distance(scenario, too_near, diagnostics);
        if diagnostics.found.len() == before {
            check_layouts(scenario, diagnostics);
        }
    }
}

/// The free space of a scenario at one moment, for starts and for goals. Rules with named positions are not checked here.
struct FreeSpace {
    /// Whether there is a free start.
    starts: bool,
    /// Whether there is a free goal.
    goals: bool,
    /// Whether enough of the possible starts have a goal that is far enough away.
    far_goals: bool,
}

impl FreeSpace {
    /// The free space of a scenario in which nothing moves.
    fn new(frozen: &Scenario) -> Self {
        let any = |rule: &PlacementRule| {
            !rule.positions_m().is_empty() || free_points(frozen, rule, 0).next().is_some()
        };
        Self {
            starts: any(&frozen.starts),
            goals: any(&frozen.goals),
            far_goals: !frozen.starts.positions_m().is_empty() || has_far_goals(frozen),
        }
    }
}

/// Checks that a few generated layouts leave free space, too.
fn check_layouts(scenario: &Scenario, diagnostics: &mut Diagnostics) {
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
        let what = match FreeSpace::new(&frozen(&generated, 0)) {
            FreeSpace { starts: false, .. } => "for a start",
            FreeSpace { goals: false, .. } => "for a goal",
            FreeSpace { far_goals: false, .. } => "for a goal that is task.min_goal_distance_m away",
            _ => continue,
        };
        let message = format!(
            "may leave no free space {what}: generate fewer or smaller obstacles, restrict them with `within`, or write a \
             smaller clearance_m"
        );
        diagnostics.push(format_args!("generators"), message);
        return;
    }
    if placed == 0 && !diagnostics.found.iter().any(|found| found.path.starts_with("generators")) {
        let message =
            "have no space for any obstacle: write a smaller gap_m, smaller sizes, or a larger `within`";
        diagnostics.push(format_args!("generators"), message);
    }
}

fn report_no_free_space(name: &str, step: Option<u64>, rule: &PlacementRule, diagnostics: &mut Diagnostics) {
    if let (Some(step), Some(clearance_m)) = (step, rule.clearance_m()) {
        let (of, fix) = match rule.region() {
            Some(_) => ("its rectangle", "move or enlarge it, use"),
            None => ("the enclosure", "use"),
        };
        let message = format!(
            "has no free space at step {step}: no point of {of} has a clearance of {clearance_m} m; {fix} fewer or smaller \
             obstacles, or a smaller clearance_m"
        );
        diagnostics.push(format_args!("{name}"), message);
    }
}

/// Checks that a goal is far enough from the starts. `too_near`: at some moment, too few random starts have such a goal.
fn check_goal_distance(scenario: &Scenario, too_near: bool, diagnostics: &mut Diagnostics) {
    let least = scenario.task.min_goal_distance_m;
    let frozen = frozen(scenario, 0);
    if let (PlacementRule::Fixed { position_m: start, .. }, PlacementRule::Fixed { position_m: goal, .. }) =
        (&scenario.starts, &scenario.goals)
    {
        let apart = length(goal.x - start.x, goal.y - start.y);
        if apart < least {
            let message = format!(
                "is {apart:.3} m from the start: move it at least {least} m away, or write a smaller \
                 task.min_goal_distance_m"
            );
            diagnostics.push(format_args!("goals.position_m"), message);
        }
        return;
    }
    if !scenario.starts.positions_m().is_empty() {
        let goals: Vec<Vec2> = possible_positions(&frozen, &scenario.goals).collect();
        for (path, _) in named_positions(&scenario.starts).filter(|named| !is_any_far(&goals, named.1, least))
        {
            let message = format!(
                "has no goal at least {least} m away: move it, or write a smaller task.min_goal_distance_m"
            );
            diagnostics.push(format_args!("starts.{path}"), message);
        }
    }
    if too_near {
        let few = format!("fewer than one start in {FAR_START_DIVISOR} has a goal");
        if matches!(scenario.goals, PlacementRule::Random { .. }) {
            let message =
                format!("is {least}, but {few} that far away: write a smaller distance, or free more space");
            diagnostics.push(format_args!("task.min_goal_distance_m"), message);
        } else {
            let message = format!(
                "are too close to the starts: {few} at least {least} m away; move them, or write a smaller \
                 task.min_goal_distance_m"
            );
            diagnostics.push(format_args!("goals"), message);
        }
    }
}

/// Whether enough of the possible starts have a goal that is far enough away.
fn has_far_goals(frozen: &Scenario) -> bool {
    let least_m = frozen.task.min_goal_distance_m;
    let (mut goals, mut low, mut high) = (Vec::new(), Vec2::MAX, Vec2::MIN);
    for goal in possible_positions(frozen, &frozen.goals) {
        (low, high) = (low.min(goal), high.max(goal));
        if (high - low).max_element() >= 2.0 * least_m {
            // Two goals are this far apart, so from any start at least one of them is far enough away.
            return true;
        }
        goals.push(goal);
    }
    let starts: Vec<Vec2> = possible_positions(frozen, &frozen.starts).collect();
    let far = starts.iter().filter(|start| is_any_far(&goals, **start, least_m));
    far.count() * FAR_START_DIVISOR >= starts.len()
}

fn is_any_far(goals: &[Vec2], start: Vec2, least_m: f32) -> bool {
    goals.iter().any(|goal| length(goal.x - start.x, goal.y - start.y) >= least_m)
}

/// The positions that `rule` names; if it names none, the points of a grid that it allows at step 0.
pub(super) fn possible_positions(scenario: &Scenario, rule: &PlacementRule) -> impl Iterator<Item = Vec2> {
    let named = rule.positions_m();
    let of_grid = named.is_empty().then(|| free_points(scenario, rule, 0));
    named.iter().copied().chain(of_grid.into_iter().flatten())
}

/// Number of sides that a test of a point against all obstacles and inner walls takes, approximately.
pub(super) fn sides(scenario: &Scenario) -> usize {
    scenario.obstacles.iter().map(|obstacle| obstacle.shape.side_count()).sum::<usize>()
        + scenario.walls.iter().map(|wall| wall.corners_m.len() + 2 * wall.blocks().len()).sum::<usize>()
}

/// The scenario without its moving obstacles.
pub(super) fn without_moving_obstacles(scenario: &Scenario) -> Scenario {
    let mut still = scenario.clone();
    still.obstacles.retain(|obstacle| !obstacle.motion.is_moving());
    still
}

/// The scenario with every obstacle stopped where it is at `step`.
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
