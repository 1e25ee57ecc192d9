//! The optimal times of shipped scenarios: on the paper's benchmark route from 24 headings, with a cylinder moved, and at every
//! phase of the cylinders' orbit; and the gap between the planner's two bounds.
//!
//! docs/optimum.md quotes these numbers. To print them:
//! `cargo test --release --no-default-features --test planner_bounds -- --nocapture`

mod common;

use std::f32::consts::PI;
use std::time::Instant;

use bevy::math::{Vec2, vec2};
use common::Lab;
use wayfield::planner::{Resolution, StepBounds, TimedPath, plan_path};
use wayfield::random::stream;
use wayfield::run::evaluate::{EpisodeResult, bounds};
use wayfield::run::shipped;
use wayfield::scenario::{Scenario, draw_goal, draw_start};
use wayfield::task::{ArenaState, Clock, EpisodeEnd, Goal, Pose, RewardConfig, TaskMode};

fn scenario(name: &str) -> Scenario {
    shipped::scenario(name).expect("shipped")
}

/// An episode on the benchmark route, with the given initial heading and clock.
fn benchmark_route(scenario: &Scenario, heading_rad: f32, clock: u64) -> EpisodeResult {
    let route = scenario.benchmark_route.expect("a benchmark route");
    let (Vec2 { x: x_m, y: y_m }, goal) = (route.start_m, route.goal_m);
    EpisodeResult {
        end: EpisodeEnd::TimedOut,
        steps: 0,
        start: Pose { x_m, y_m, heading_rad },
        goal: Goal { x_m: goal.x, y_m: goal.y },
        clock: Clock(clock),
        layout_seed: 0,
        path: None,
    }
}

/// Random episodes, with the start and goal rules of evaluations.
fn random_episodes(scenario: &Scenario, count: u64) -> Vec<EpisodeResult> {
    let episode = |index| {
        let mut draws = stream(1, "optimum", index);
        let clock = 37 * index;
        let (x_m, y_m, heading_rad) = draw_start(scenario, clock, &mut draws).expect("free space");
        let goal = draw_goal(scenario, clock, vec2(x_m, y_m), &mut draws).expect("free space");
        let goal = Goal { x_m: goal.x, y_m: goal.y };
        let start = Pose { x_m, y_m, heading_rad };
        EpisodeResult {
            end: EpisodeEnd::TimedOut,
            steps: 0,
            start,
            goal,
            clock: Clock(clock),
            layout_seed: 0,
            path: None,
        }
    };
    (0..count).map(episode).collect()
}

/// The duration of `steps` control steps in s.
fn seconds(steps: u32) -> f64 {
    f64::from(steps) / 5.0
}

/// Minimum, mean and maximum number of steps.
fn min_mean_max(steps: &[u32]) -> (u32, f64, u32) {
    let (min, max) = (steps.iter().min().expect("steps"), steps.iter().max().expect("steps"));
    (*min, f64::from(steps.iter().sum::<u32>()) / steps.len() as f64, *max)
}

fn plans(found: &[StepBounds]) -> Vec<u32> {
    found.iter().map(|b| b.plan_steps.expect("a path")).collect()
}

fn print(what: &str, found: &[StepBounds]) {
    let lower: Vec<u32> = found.iter().map(|b| b.lower_steps).collect();
    let proven = found.iter().filter(|b| b.plan_steps == Some(b.lower_steps)).count();
    let ((min, mean, max), (min_lower, mean_lower, max_lower)) =
        (min_mean_max(&plans(found)), min_mean_max(&lower));
    println!(
        "{what}: {} episodes, planned {min} / {mean:.2} / {max} steps (min / mean / max), {:.1} / {:.3} / {:.1} s, lower \
         bound {min_lower} / {mean_lower:.2} / {max_lower}; mean gap {:.2} %, {proven} proven optimal",
        found.len(),
        seconds(min),
        mean / 5.0,
        seconds(max),
        100.0 * (mean / mean_lower - 1.0),
    );
}

/// The bounds of `episodes`. They are printed and checked: each episode has a path, none shorter than its
/// lower bound.
fn checked_bounds(what: &str, scenario: &Scenario, episodes: &[EpisodeResult]) -> Vec<StepBounds> {
    let found = bounds(scenario, episodes, 0);
    print(what, &found);
    for bounds in &found {
        assert!(bounds.plan_steps.is_some_and(|steps| bounds.lower_steps <= steps), "{what}: {bounds:?}");
    }
    found
}

/// Episodes on the benchmark route with 24 initial headings, 15 degrees apart.
fn headings(scenario: &Scenario) -> Vec<EpisodeResult> {
    (0..24).map(|k| benchmark_route(scenario, k as f32 * PI / 12.0, 0)).collect()
}

#[test]
fn in_scenario_i_the_benchmark_route_takes_10_8_s_and_no_heading_takes_less_than_10_6_s() {
    let scenario = scenario("scenario-1");
    let found = checked_bounds("benchmark route, 24 headings", &scenario, &headings(&scenario));
    assert_eq!(
        found[0],
        StepBounds { lower_steps: 54, plan_steps: Some(54) },
        "the time from heading 0 is proven optimal"
    );
    let (min, _, max) = min_mean_max(&plans(&found));
    assert_eq!((min, max), (54, 63));
    assert!(found.iter().all(|b| b.lower_steps >= 53));
}

#[test]
fn with_the_24_beam_collision_check_53_steps_may_suffice_but_52_do_not() {
    let mut lenient = scenario("scenario-1");
    // Between two beams, the robot gets up to 2.1 mm nearer to the cylinder without a collision (docs/optimum.md).
    lenient.task.collision_range_m -= 0.0021;
    let found =
        checked_bounds("benchmark route, collision range reduced by 2.1 mm", &lenient, &headings(&lenient));
    assert_eq!(found.iter().map(|b| b.lower_steps).min(), Some(53));
}

#[test]
fn with_the_cylinder_moved_by_up_to_10_cm_the_benchmark_route_takes_51_to_54_steps() {
    let mut facing_along_x = Vec::new();
    let mut all = Vec::new();
    for (dx, dy) in (0..25).map(|k| (k / 5 - 2, k % 5 - 2)) {
        let mut scenario = scenario("scenario-1");
        scenario.obstacles[0].position_m = vec2(0.6 + 0.05 * dx as f32, 0.6 + 0.05 * dy as f32);
        let found = bounds(&scenario, &headings(&scenario), 0);
        facing_along_x.push(found[0]);
        all.extend(found);
    }
    print("benchmark route, cylinder moved by up to 0.1 m, heading 0", &facing_along_x);
    print("benchmark route, cylinder moved, 24 headings", &all);
    let (min, _, max) = min_mean_max(&plans(&facing_along_x));
    assert_eq!((min, max), (51, 54));
    let (min, _, max) = min_mean_max(&plans(&all));
    assert_eq!((min, max), (51, 63));
}

#[test]
fn in_scenario_ii_the_benchmark_route_takes_10_2_to_11_2_s_depending_on_phase() {
    // Four cylinders, 90 degrees apart: a quarter of an orbit, 52.4 steps, covers all phases.
    let scenario = scenario("scenario-2");
    let phases: Vec<_> = (0..53).map(|clock| benchmark_route(&scenario, 0.0, clock)).collect();
    let steps = plans(&checked_bounds("benchmark route, 53 phases", &scenario, &phases));
    let (min, mean, max) = min_mean_max(&steps);
    assert_eq!((min, max), (51, 56));
    assert!((51.8..52.2).contains(&mean), "{mean}");
}

#[test]
fn the_upper_and_lower_bounds_are_close_to_each_other() {
    for (name, max_ratio) in [("empty", 1.003), ("scenario-1", 1.003), ("scenario-2", 1.025)] {
        let scenario = scenario(name);
        let episodes = random_episodes(&scenario, 500);
        let began = Instant::now();
        let found = checked_bounds(&format!("500 random episodes, {name}"), &scenario, &episodes);
        println!("  on all cores in {:.2} s", began.elapsed().as_secs_f64());
        let planned: u32 = plans(&found).iter().sum();
        let proven: u32 = found.iter().map(|b| b.lower_steps).sum();
        assert!(
            f64::from(planned) < max_ratio * f64::from(proven),
            "{name}: {planned} planned steps, lower bound {proven}"
        );
    }
}

#[test]
fn the_number_of_threads_does_not_change_the_bounds_or_their_order() {
    let scenario = scenario("scenario-2");
    let episodes = random_episodes(&scenario, 20);
    let single_threaded = bounds(&scenario, &episodes, 1);
    assert_eq!(single_threaded, bounds(&scenario, &episodes, 3));
    assert_eq!(single_threaded, bounds(&scenario, &episodes, 64));
    for (EpisodeResult { start, goal, clock, .. }, bounds) in episodes.iter().zip(&single_threaded) {
        let start = (start.x_m, start.y_m, start.heading_rad);
        let plan = plan_path(&scenario, start, vec2(goal.x_m, goal.y_m), clock.0, Resolution::default());
        assert_eq!(bounds.plan_steps, plan.map(|plan| plan.steps));
    }
    assert_eq!(bounds(&scenario, &[], 0), []);
}

#[test]
fn plans_arrive_on_time_in_the_physics_simulation() {
    for name in ["scenario-1", "scenario-2"] {
        let (arenas, scenario) = (16, scenario(name));
        let mut lab = Lab::with(&scenario, arenas, 3, RewardConfig::default(), TaskMode::SingleGoal);
        let plan = |state: &ArenaState| {
            let ArenaState { pose, goal, clock, .. } = state;
            let start = (pose.x_m, pose.y_m, pose.heading_rad);
            let plan = plan_path(&scenario, start, vec2(goal.x_m, goal.y_m), clock.0, Resolution::default());
            plan.expect("a path")
        };
        let plans: Vec<_> = lab.states().iter().map(plan).collect();
        let mut ended = vec![None; arenas];
        for step in 0..plans.iter().map(|plan| plan.actions.len()).max().expect("a plan") {
            let action = |plan: &TimedPath| plan.actions.get(step).map_or(0, |&action| usize::from(action));
            lab.step(&plans.iter().map(action).collect::<Vec<_>>());
            for episode in lab.take_ended_episodes() {
                ended[episode.arena] = Some((episode.end, episode.steps));
            }
            for (state, plan) in lab.states().iter().zip(&plans) {
                let Some(&(x_m, y_m, _)) = plan.poses.get(step + 1) else { continue };
                let error_m = libm::hypotf(state.pose.x_m - x_m, state.pose.y_m - y_m);
                assert!(error_m < 2e-5, "{name}: {error_m} m from the plan after step {}", step + 1);
            }
        }
        for (end, plan) in ended.iter().zip(&plans) {
            assert_eq!(*end, Some((EpisodeEnd::Reached, plan.steps)), "{name}");
        }
    }
}
