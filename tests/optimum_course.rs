//! The least times of the shipped worlds: the paper's course from every heading, with the cylinders elsewhere, at
//! every phase of their revolution; and how near the planner's two bounds are to each other.
//!
//! docs/optimum.md quotes these numbers. To see them:
//! `cargo test --release --no-default-features --test optimum_course -- --nocapture`

mod common;

use std::f32::consts::PI;
use std::time::Instant;

use common::Lab;
use wayfield::planner::{Bounds, Plan, Resolution, least_time};
use wayfield::random::stream;
use wayfield::run::evaluate::{Navigation, bounds};
use wayfield::run::shipped;
use wayfield::scenario::{Scenario, draw_start, draw_target};
use wayfield::task::{ArenaState, Clock, EpisodeEnd, Pose, RewardConfig, Target, TaskMode};

fn scenario(name: &str) -> Scenario {
    shipped::scenario(name).expect("it is shipped")
}

/// The course, with another heading at the start and another clock.
fn course(scenario: &Scenario, heading_rad: f32, clock: u64) -> Navigation {
    let ((x_m, y_m), target) = (scenario.course.start_m, scenario.course.target_m);
    Navigation {
        end: EpisodeEnd::TimedOut,
        steps: 0,
        start: Pose { x_m, y_m, heading_rad },
        target: Target { x_m: target.0, y_m: target.1 },
        clock: Clock(clock),
        layout: 0,
    }
}

/// As many navigations as an evaluation has, by its rules.
fn random_navigations(scenario: &Scenario, count: u64) -> Vec<Navigation> {
    let drawn = |index| {
        let mut draws = stream(1, "optimum", index);
        let clock = 37 * index;
        let (x_m, y_m, heading_rad) = draw_start(scenario, clock, &mut draws).expect("room");
        let target = draw_target(scenario, clock, (x_m, y_m), &mut draws).expect("room");
        let target = Target { x_m: target.0, y_m: target.1 };
        let start = Pose { x_m, y_m, heading_rad };
        Navigation { end: EpisodeEnd::TimedOut, steps: 0, start, target, clock: Clock(clock), layout: 0 }
    };
    (0..count).map(drawn).collect()
}

/// Seconds, as the paper would give them.
fn seconds(steps: u32) -> f64 {
    f64::from(steps) / 5.0
}

/// Least, mean and greatest number of steps.
fn spread(steps: &[u32]) -> (u32, f64, u32) {
    let (least, greatest) = (steps.iter().min().expect("some"), steps.iter().max().expect("some"));
    (*least, f64::from(steps.iter().sum::<u32>()) / steps.len() as f64, *greatest)
}

fn plans(found: &[Bounds]) -> Vec<u32> {
    found.iter().map(|b| b.plan_steps.expect("there is a way")).collect()
}

fn print(what: &str, found: &[Bounds]) {
    let lower: Vec<u32> = found.iter().map(|b| b.lower_steps).collect();
    let proven = found.iter().filter(|b| b.plan_steps == Some(b.lower_steps)).count();
    let ((least, mean, most), (least_lower, mean_lower, most_lower)) =
        (spread(&plans(found)), spread(&lower));
    println!(
        "{what}: {} drives, planned {least} / {mean:.2} / {most} steps (least / mean / greatest), {:.1} / {:.3} / \
         {:.1} s, bound {least_lower} / {mean_lower:.2} / {most_lower}; mean gap {:.2} %, {proven} proven optimal",
        found.len(),
        seconds(least),
        mean / 5.0,
        seconds(most),
        100.0 * (mean / mean_lower - 1.0),
    );
}

/// The bounds of all these, printed; there is a way for each, and none below its bound.
fn measured(what: &str, scenario: &Scenario, navigations: &[Navigation]) -> Vec<Bounds> {
    let found = bounds(scenario, navigations, 0);
    print(what, &found);
    for bounds in &found {
        assert!(bounds.plan_steps.is_some_and(|steps| bounds.lower_steps <= steps), "{what}: {bounds:?}");
    }
    found
}

/// The 24 headings, 15 degrees apart.
fn headings(scenario: &Scenario) -> Vec<Navigation> {
    (0..24).map(|k| course(scenario, k as f32 * PI / 12.0, 0)).collect()
}

#[test]
fn in_scenario_i_the_course_takes_10_8_s_and_from_no_heading_less() {
    let scenario = scenario("scenario-1");
    let found = measured("course, 24 headings", &scenario, &headings(&scenario));
    assert_eq!(found[0], Bounds { lower_steps: 54, plan_steps: Some(54) }, "heading 0 is proven");
    let (least, _, greatest) = spread(&plans(&found));
    assert_eq!((least, greatest), (54, 63));
    assert!(found.iter().all(|b| b.lower_steps >= 53));
}

#[test]
fn for_the_judge_by_24_beams_53_steps_may_do_and_52_do_not() {
    let mut lenient = scenario("scenario-1");
    lenient.task.collision_range_m -= 0.0021;
    let found = measured("course, collision range 2.1 mm less", &lenient, &headings(&lenient));
    assert_eq!(found.iter().map(|b| b.lower_steps).min(), Some(53));
}

#[test]
fn with_the_cylinder_ten_centimetres_aside_the_course_takes_51_to_54_steps() {
    let mut facing_along_x = Vec::new();
    let mut all = Vec::new();
    for (dx, dy) in (0..25).map(|k| (k / 5 - 2, k % 5 - 2)) {
        let mut scenario = scenario("scenario-1");
        scenario.obstacles[0].position_m = (0.6 + 0.05 * dx as f32, 0.6 + 0.05 * dy as f32);
        let found = bounds(&scenario, &headings(&scenario), 0);
        facing_along_x.push(found[0]);
        all.extend(found);
    }
    print("course, cylinder moved by up to 0.1 m each way, heading 0", &facing_along_x);
    print("course, cylinder moved, 24 headings", &all);
    let (least, _, greatest) = spread(&plans(&facing_along_x));
    assert_eq!((least, greatest), (51, 54));
    let (least, _, greatest) = spread(&plans(&all));
    assert_eq!((least, greatest), (51, 63));
}

#[test]
fn in_scenario_ii_the_course_takes_10_2_to_11_2_s_by_the_phase() {
    // Four cylinders a quarter turn apart: a quarter revolution, 52.4 steps, has all the phases there are.
    let scenario = scenario("scenario-2");
    let phases: Vec<_> = (0..53).map(|clock| course(&scenario, 0.0, clock)).collect();
    let steps = plans(&measured("course, 53 phases", &scenario, &phases));
    let (least, mean, greatest) = spread(&steps);
    assert_eq!((least, greatest), (51, 56));
    assert!((51.8..52.2).contains(&mean), "{mean}");
}

#[test]
fn the_two_bounds_are_near_each_other() {
    for (name, most) in [("empty", 1.003), ("scenario-1", 1.003), ("scenario-2", 1.025)] {
        let scenario = scenario(name);
        let navigations = random_navigations(&scenario, 500);
        let began = Instant::now();
        let found = measured(&format!("500 random navigations, {name}"), &scenario, &navigations);
        println!("  on all cores in {:.2} s", began.elapsed().as_secs_f64());
        let planned: u32 = plans(&found).iter().sum();
        let proven: u32 = found.iter().map(|b| b.lower_steps).sum();
        assert!(f64::from(planned) < most * f64::from(proven), "{name}: {planned} to {proven}");
    }
}

#[test]
fn bounds_are_the_same_on_any_number_of_threads_and_in_order() {
    let scenario = scenario("scenario-2");
    let navigations = random_navigations(&scenario, 20);
    let on_one = bounds(&scenario, &navigations, 1);
    assert_eq!(on_one, bounds(&scenario, &navigations, 3));
    assert_eq!(on_one, bounds(&scenario, &navigations, 64));
    for (n, bounds) in navigations.iter().zip(&on_one) {
        let start = (n.start.x_m, n.start.y_m, n.start.heading_rad);
        let plan =
            least_time(&scenario, start, (n.target.x_m, n.target.y_m), n.clock.0, Resolution::default());
        assert_eq!(bounds.plan_steps, plan.map(|plan| plan.steps));
    }
    assert_eq!(bounds(&scenario, &[], 0), []);
}

#[test]
fn plans_arrive_on_time_in_the_world_of_the_physics_engine() {
    for name in ["scenario-1", "scenario-2"] {
        let (arenas, scenario) = (16, scenario(name));
        let mut lab = Lab::with(&scenario, arenas, 3, RewardConfig::default(), TaskMode::SingleNavigation);
        let plan = |state: &ArenaState| {
            let ArenaState { pose, target, clock, .. } = state;
            let start = (pose.x_m, pose.y_m, pose.heading_rad);
            let plan = least_time(&scenario, start, (target.x_m, target.y_m), clock.0, Resolution::default());
            plan.expect("there is a way")
        };
        let plans: Vec<_> = lab.states().iter().map(plan).collect();
        let mut ended = vec![None; arenas];
        for step in 0..plans.iter().map(|plan| plan.actions.len()).max().expect("some") {
            let action = |plan: &Plan| plan.actions.get(step).map_or(0, |&action| usize::from(action));
            lab.step(&plans.iter().map(action).collect::<Vec<_>>());
            for over in lab.ended() {
                ended[over.arena] = Some((over.end, over.steps));
            }
            for (state, plan) in lab.states().iter().zip(&plans) {
                let Some(&(x_m, y_m, _)) = plan.poses.get(step + 1) else { continue };
                let off = libm::hypotf(state.pose.x_m - x_m, state.pose.y_m - y_m);
                assert!(off < 2e-5, "{name}: {off} m off the plan after step {}", step + 1);
            }
        }
        for (end, plan) in ended.iter().zip(&plans) {
            assert_eq!(*end, Some((EpisodeEnd::Reached, plan.steps)), "{name}");
        }
    }
}
