//! The planner against cases worked by hand, and its promises over random ones.

use glam::{Vec2, vec2};
use proptest::prelude::*;

use super::configuration_space::State;
use super::*;
use wayfield_random::{stream, uniform};
use wayfield_scenario::{Obstacle, ObstacleMotion, Shape};
use wayfield_scenario::{clearance, draw_goal, draw_start};

fn circle(position_m: Vec2, radius_m: f32, motion: ObstacleMotion) -> Obstacle {
    Obstacle { shape: Shape::Circle { radius_m }, position_m, rotation_rad: 0.0, motion }
}

fn slab(position_m: Vec2, width_m: f32, height_m: f32) -> Obstacle {
    let shape = Shape::Rectangle { width_m, height_m };
    Obstacle { shape, position_m, rotation_rad: 0.0, motion: ObstacleMotion::Static }
}

/// The paper's four cylinders, revolving at `speed_rad_s`.
fn cylinders(speed_rad_s: f32) -> Scenario {
    let motion = if speed_rad_s == 0.0 {
        ObstacleMotion::Static
    } else {
        ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s }
    };
    let corners = [vec2(0.6, 0.6), vec2(-0.6, 0.6), vec2(-0.6, -0.6), vec2(0.6, -0.6)];
    let obstacles = corners.map(|corner| circle(corner, 0.15, motion.clone())).into();
    Scenario { obstacles, ..Scenario::default() }
}

/// Cylinders, and boxes that bar half of the enclosure.
fn maze() -> Scenario {
    let tilted = Obstacle { rotation_rad: 0.5, ..slab(vec2(-1.0, 0.9), 0.8, 0.1) };
    let mut scenario = cylinders(0.0);
    scenario.obstacles.extend([slab(vec2(1.1, 0.0), 1.8, 0.1), slab(vec2(0.0, -1.2), 0.2, 1.0), tilted]);
    scenario
}

fn straight(scenario: &Scenario, to: Vec2) -> Option<TimedPath> {
    plan_path(scenario, (0.0, 0.0, 0.0), to, 0, Resolution::default())
}

/// Drives the plan as the world does, in f32: the collision-free step at which it arrives, if it does.
fn replay(
    scenario: &Scenario,
    start: (f32, f32, f32),
    goal: Vec2,
    clock: u64,
    actions: &[u8],
) -> Result<u32, String> {
    let period = scenario.task.control_period_s;
    let (mut x, mut y, mut heading) = start;
    for (steps, &action) in (1..).zip(actions) {
        let motion = scenario.robot.motions[usize::from(action)];
        let half = 0.5 * motion.w_rad_s * period;
        let sinc = if half.abs() < 1e-4 { 1.0 } else { libm::sinf(half) / half };
        let (sin, cos) = libm::sincosf(heading + half);
        x += cos * (motion.v_m_s * sinc) * period;
        y += sin * (motion.v_m_s * sinc) * period;
        heading = libm::remainderf(heading + motion.w_rad_s * period, std::f32::consts::TAU);
        let room = clearance(scenario, vec2(x, y), clock + steps);
        if room < scenario.task.collision_range_m {
            return Err(format!("only {room} m clear after step {steps}"));
        }
        if libm::hypotf(goal.x - x, goal.y - y) < scenario.task.goal_radius_m {
            return Ok(steps as u32);
        }
    }
    Err("never arrives".into())
}

#[test]
fn straight_ahead_it_just_drives() {
    // More than 1.0 m at 0.03 m a step: 34 steps.
    let plan = straight(&Scenario::default(), vec2(1.2, 0.0)).expect("nothing is in the way");
    assert_eq!((plan.steps, plan.time_s, plan.actions.len()), (34, 6.8, 34));
    assert_eq!(lower_bound_steps(&Scenario::default(), (0.0, 0.0, 0.0), vec2(1.2, 0.0), 0), 34);
}

#[test]
fn a_lagging_actuator_is_unsupported() {
    // From rest the robot of the test above is 0.15 m/s x 0.3 s = 0.045 m behind: it needs 35 steps.
    let mut scenario = Scenario::default();
    scenario.robot.actuator_lag_s = 0.3;
    assert_eq!(straight(&scenario, vec2(1.2, 0.0)), None, "a plan of 34 steps would be a lie");
    assert_eq!(lower_bound_steps(&scenario, (0.0, 0.0, 0.0), vec2(1.2, 0.0), 0), 1);
    assert!(!is_supported(&scenario) && is_supported(&Scenario::default()));
}

#[test]
fn straight_drives_take_the_way_over_the_stride() {
    let scenario = Scenario::default();
    for k in 1..=16_u8 {
        // From 0.315 m: (d - 0.2) m over 0.03 m is never near a whole number.
        let (d, heading) = (0.115 + 0.2 * f32::from(k), 0.4 * f32::from(k));
        let start = (-0.5 * d * heading.cos(), -0.5 * d * heading.sin(), heading);
        let goal = vec2(-start.0, -start.1);
        let steps = ((f64::from(d) - 0.2) / 0.03).ceil() as u32;
        let bounds = step_bounds(&scenario, start, goal, 0, Resolution::default());
        assert_eq!(bounds, StepBounds { lower_steps: steps, plan_steps: Some(steps) }, "{d} m");
    }
}

#[test]
fn a_goal_behind_costs_the_turn() {
    // The turning circle's middle is 1 m ahead of the target and 0.1 m aside, so the tangent is 1 m long; the
    // turn is pi + 2 atan(0.1) = 3.3409 rad on a radius of 0.1 m. (0.33409 + 1 - 0.2) m / 0.03 m = 37.8.
    let start = (0.0, 0.0, 0.0);
    assert_eq!(lower_bound_steps(&Scenario::default(), start, vec2(-1.0, 0.0), 0), 38);
    assert_eq!(straight(&Scenario::default(), vec2(-1.0, 0.0)).map(|plan| plan.steps), Some(38));
}

#[test]
fn on_the_goal_it_still_takes_one_step() {
    assert_eq!(straight(&Scenario::default(), vec2(0.05, 0.0)).map(|plan| plan.steps), Some(1));
    assert_eq!(lower_bound_steps(&Scenario::default(), (0.0, 0.0, 0.0), vec2(0.05, 0.0), 0), 1);
}

#[test]
fn the_benchmark_route_takes_54_steps_and_53_are_proven_too_few() {
    let (scenario, start, goal) = (cylinders(0.0), (0.0, 0.0, 0.0), vec2(1.2, 1.2));
    assert_eq!(lower_bound_steps(&scenario, start, goal, 0), 54);
    for cell_m in [0.04, 0.02, 0.01, 0.005] {
        let resolution =
            Resolution { cell_m, heading_rad: 4.0 * cell_m, refinements: 0, ..Default::default() };
        let plan = plan_path(&scenario, start, goal, 0, resolution).expect("there is a way");
        assert_eq!(plan.steps, 54, "with cells of {cell_m} m");
        assert_eq!(replay(&scenario, start, goal, 0, &plan.actions), Ok(54));
    }
}

#[test]
fn the_way_round_a_slab_is_the_one_worked_by_hand() {
    // From (-1, 0) to (1, 0) past a slab 0.1 m thick that ends at y = 0.6 and meets the lower wall: by its upper
    // corners, 0.13 m off. By symmetry: to the corner (0.05, 0.6) at (0.95, 0.6), length 1.12361, the tangent
    // sqrt(1.12361^2 - 0.13^2) = 1.11606, the arc's angle atan(0.6 / 0.95) + asin(0.13 / 1.12361) = 0.67932
    // from the top. In all 2 (1.11606 + 0.13 * 0.67932) + 0.1 - 0.2 = 2.30874 m, 76.96 steps: 77 at least, and
    // the start's heading is along the tangent.
    let scenario = Scenario { obstacles: vec![slab(vec2(0.0, -0.7), 0.1, 2.6)], ..Scenario::default() };
    let (start, goal) = ((-1.0, 0.0, 0.67932), vec2(1.0, 0.0));
    let plan = plan_path(&scenario, start, goal, 0, Resolution::default()).expect("there is a way");
    assert!((76..=77).contains(&lower_bound_steps(&scenario, start, goal, 0)));
    assert!((77..=78).contains(&plan.steps), "{} steps", plan.steps);
}

#[test]
fn no_way_is_none() {
    let walled = Scenario { obstacles: vec![slab(vec2(0.8, 0.0), 0.1, 4.0)], ..Scenario::default() };
    assert_eq!(straight(&walled, vec2(1.5, 0.0)), None);
    assert_eq!(lower_bound_steps(&walled, (0.0, 0.0, 0.0), vec2(1.5, 0.0), 0), u32::MAX);
    let mut hasty = Scenario::default();
    hasty.task.max_episode_steps = 33;
    assert_eq!(straight(&hasty, vec2(1.2, 0.0)), None, "34 steps are beyond the time limit");
    hasty.task.max_episode_steps = 34;
    assert!(straight(&hasty, vec2(1.2, 0.0)).is_some());
}

#[test]
fn moving_obstacles_are_met_where_the_clock_puts_them() {
    // A cylinder comes down the line x = 0.6 at 0.15 m/s, 0.03 m a step, as fast as the robot: from 0.6 m above,
    // it is in the robot's way just when the robot comes by. Started later, it has passed.
    let motion = ObstacleMotion::Patrol { waypoints_m: vec![vec2(0.6, -1.8)], speed_m_s: 0.15 };
    let scenario = Scenario { obstacles: vec![circle(vec2(0.6, 0.6), 0.15, motion)], ..Scenario::default() };
    let go = |clock| {
        let start = (0.0, 0.0, 0.0);
        let plan = plan_path(&scenario, start, vec2(1.2, 0.0), clock, Resolution::default()).expect("a way");
        assert_eq!(replay(&scenario, start, vec2(1.2, 0.0), clock, &plan.actions), Ok(plan.steps));
        assert!(lower_bound_steps(&scenario, start, vec2(1.2, 0.0), clock) <= plan.steps);
        plan.steps
    };
    assert!(replay(&scenario, (0.0, 0.0, 0.0), vec2(1.2, 0.0), 0, &[2; 34]).is_err(), "it is in the way");
    assert!((35..45).contains(&go(0)), "{}", go(0));
    assert_eq!(go(30), 34);
}

#[test]
fn driving_backward_standing_still_and_turning_on_the_spot_are_motions_too() {
    let mut scenario = Scenario::default();
    let motion = |v_m_s, w_rad_s| wayfield_scenario::Motion { v_m_s, w_rad_s };
    scenario.robot.motions = vec![motion(0.0, 0.0), motion(0.15, 0.0), motion(0.0, 1.5), motion(-0.15, 0.0)];
    let plan = straight(&scenario, vec2(-1.2, 0.0)).expect("backward");
    assert_eq!(plan.steps, 34);
    let plan = straight(&scenario, vec2(0.0, 1.2)).expect("turn, then drive");
    // Five turns make 1.5 rad, 0.07 rad short of a right angle: 34 or 35 steps from there.
    assert!((39..=40).contains(&plan.steps), "{}", plan.steps);
    assert!(lower_bound_steps(&scenario, (0.0, 0.0, 0.0), vec2(0.0, 1.2), 0) <= plan.steps);
    scenario.robot.motions.truncate(1);
    assert_eq!(straight(&scenario, vec2(1.2, 0.0)), None, "it can only stand");
}

#[test]
fn random_episodes_are_within_a_percent_of_the_proven_bound() {
    let scenario = cylinders(0.0);
    let mut draws = stream(1, "optimum", 0);
    let (mut steps, mut least) = (0, 0);
    for _ in 0..100 {
        let start = draw_start(&scenario, 0, &mut draws).expect("room");
        let goal = draw_goal(&scenario, 0, vec2(start.0, start.1), &mut draws).expect("room");
        let plan = plan_path(&scenario, start, goal, 0, Resolution::default()).expect("a way");
        steps += plan.steps;
        least += lower_bound_steps(&scenario, start, goal, 0);
    }
    assert!(least <= steps && f64::from(steps) < 1.01 * f64::from(least), "{steps} to {least}");
}

#[test]
fn a_search_that_knows_only_the_straight_line_finds_nothing_below_the_bounds() {
    let mut draws = stream(2, "optimum", 0);
    for scenario in [Scenario::default(), cylinders(0.0), maze()] {
        for _ in 0..12 {
            let start = draw_start(&scenario, 0, &mut draws).expect("room");
            let goal = draw_goal(&scenario, 0, vec2(start.0, start.1), &mut draws).expect("room");
            let bound = LowerBound::new(&scenario, start, goal);
            let mut blind = LowerBound::new(&scenario, start, goal);
            blind.turning_radius = None;
            (blind.geodesic.occluders, blind.geodesic.corners) = (Vec::new(), Vec::new());
            let mut world = ConfigurationSpace::new(&scenario, 0, 0.0);
            let goal_region = GoalRegion::new(&scenario, goal, 0.0);
            let limits = SearchLimits { step_limit: 500, states: MAX_STATES };
            let mut cells = StateGrid::new(0.03, 0.16, false);
            let plan = search(&mut world, &blind, &goal_region, start, &mut cells, &limits).expect("a way");
            let mut state = State::new(start);
            for (steps, &action) in (1..).zip(&plan[..plan.len() - 1]) {
                state =
                    state.after(&world.motion_primitives[usize::from(action)], libm::sincos(state.heading));
                let (to_go, left) = (bound.steps(&state), plan.len() - steps);
                assert!(to_go <= left as f64, "{left} steps were enough, not {to_go}");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_plan_replayed_arrives_with_its_last_step_and_touches_nothing(
        seed: u64,
        clock in 0_u64..1_000,
        world in 0_usize..4,
    ) {
        let scenario = &[Scenario::default(), cylinders(0.0), cylinders(0.15), maze()][world];
        let mut draws = stream(seed, "optimum", 0);
        let start = draw_start(scenario, clock, &mut draws).expect("room");
        let goal = draw_goal(scenario, clock, vec2(start.0, start.1), &mut draws).expect("room");
        let coarse = Resolution { refinements: 0, ..Resolution::default() };
        let first = plan_path(scenario, start, goal, clock, coarse).expect("a way");
        let plan = plan_path(scenario, start, goal, clock, Resolution::default()).expect("a way");
        prop_assert_eq!(plan.steps as usize, plan.actions.len());
        prop_assert_eq!(replay(scenario, start, goal, clock, &plan.actions), Ok(plan.steps));
        prop_assert!(plan.steps <= first.steps, "a finer search is never worse");
        let lower_steps = lower_bound_steps(scenario, start, goal, clock);
        prop_assert!(lower_steps <= plan.steps);
        let both = step_bounds(scenario, start, goal, clock, Resolution::default());
        prop_assert_eq!(both, StepBounds { lower_steps, plan_steps: Some(plan.steps) });
        prop_assert_eq!(plan.poses.len(), plan.actions.len() + 1);
        prop_assert_eq!((plan.poses[0].0, plan.poses[0].1), (start.0, start.1));
        for (step, &(x, y, heading)) in (0..).zip(&plan.poses).skip(1) {
            prop_assert!(clearance(scenario, vec2(x, y), clock + step) >= scenario.task.collision_range_m);
            prop_assert!(heading.abs() <= std::f32::consts::PI);
            let arrived = libm::hypotf(goal.x - x, goal.y - y) < scenario.task.goal_radius_m;
            prop_assert_eq!(arrived, step == u64::from(plan.steps));
        }
    }

    /// Wherever the robot gets by any drive at all, no bound on the way says it couldn't.
    #[test]
    fn no_drive_beats_the_bounds(seed: u64, world in 0_usize..3, turns in 1_usize..8, held in 1_u32..20) {
        let scenario = &[Scenario::default(), cylinders(0.0), maze()][world];
        let mut draws = stream(seed, "drive", 0);
        let start = draw_start(scenario, 0, &mut draws).expect("room");
        let free = ConfigurationSpace::new(scenario, 0, 0.0);
        let mut way = vec![State::new(start)];
        for _ in 0..turns {
            let step = &free.motion_primitives[wayfield_random::uniform_index(&mut draws, free.motion_primitives.len())];
            for _ in 0..held {
                let last = way[way.len() - 1];
                let next = last.after(step, libm::sincos(last.heading));
                if !free.is_clear(next.x, next.y, 0) {
                    break;
                }
                way.push(next);
            }
        }
        let end = way[way.len() - 1];
        let radius = 0.199 * uniform(&mut draws, 0.0, 1.0);
        let angle = uniform(&mut draws, 0.0, std::f32::consts::TAU);
        let goal = vec2(end.x as f32 + radius * angle.cos(), end.y as f32 + radius * angle.sin());
        let bound = LowerBound::new(scenario, start, goal);
        for (before, state) in way.iter().enumerate() {
            let to_go = bound.steps(state);
            let taken = (way.len() - 1 - before) as f64;
            prop_assert!(to_go <= taken + 1e-9, "{taken} steps from ({}, {}), not {to_go}", state.x, state.y);
        }
        if way.len() > 1 {
            prop_assert!(lower_bound_steps(scenario, start, goal, 0) < way.len() as u32);
        }
    }
}
