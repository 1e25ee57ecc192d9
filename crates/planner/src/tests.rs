//! Tests of the planner: cases computed by hand, and properties of plans and bounds in random cases.

use glam::{Vec2, vec2};
use proptest::prelude::*;

use super::configuration_space::State;
use super::*;
use wayfield_random::{stream, uniform};
use wayfield_scenario::{Obstacle, ObstacleMotion, Ranged, Robot, Shape, Slip};
use wayfield_scenario::{clearance, draw_goal, draw_start};

fn circle(position_m: Vec2, radius_m: f32, motion: ObstacleMotion) -> Obstacle {
    Obstacle { shape: Shape::Circle { radius_m }, position_m, rotation_rad: 0.0, motion }
}

fn static_box(position_m: Vec2, width_m: f32, height_m: f32) -> Obstacle {
    let shape = Shape::Rectangle { width_m, height_m };
    Obstacle { shape, position_m, rotation_rad: 0.0, motion: ObstacleMotion::Static }
}

/// The paper's four cylinders, orbiting the centre at `speed_rad_s`.
fn cylinders(speed_rad_s: f32) -> Scenario {
    let motion = if speed_rad_s == 0.0 {
        ObstacleMotion::Static
    } else {
        ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s: speed_rad_s.into() }
    };
    let corners = [vec2(0.6, 0.6), vec2(-0.6, 0.6), vec2(-0.6, -0.6), vec2(0.6, -0.6)];
    let obstacles = corners.map(|corner| circle(corner, 0.15, motion.clone())).into();
    Scenario { obstacles, ..Scenario::default() }
}

/// The cylinders, and boxes that block half of the enclosure.
fn maze() -> Scenario {
    let tilted = Obstacle { rotation_rad: 0.5, ..static_box(vec2(-1.0, 0.9), 0.8, 0.1) };
    let mut scenario = cylinders(0.0);
    scenario.obstacles.extend([
        static_box(vec2(1.1, 0.0), 1.8, 0.1),
        static_box(vec2(0.0, -1.2), 0.2, 1.0),
        tilted,
    ]);
    scenario
}

fn plan_from_origin(scenario: &Scenario, to: Vec2) -> Option<TimedPath> {
    plan_path(scenario, (0.0, 0.0, 0.0), to, 0, Resolution::default())
}

/// Drives the plan in f32, as in the simulation. Returns the step at which it reaches the goal without a collision.
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
        let free_m = clearance(scenario, vec2(x, y), clock + steps);
        if free_m < scenario.task.collision_range_m {
            return Err(format!("only {free_m} m clear after step {steps}"));
        }
        if libm::hypotf(goal.x - x, goal.y - y) < scenario.task.goal_radius_m {
            return Ok(steps as u32);
        }
    }
    Err("the plan does not reach the goal".into())
}

#[test]
fn a_goal_straight_ahead_takes_its_distance_divided_by_the_step_length() {
    // 1.0 m at 0.03 m per step: 34 steps.
    let plan = plan_from_origin(&Scenario::default(), vec2(1.2, 0.0)).expect("the arena is empty");
    assert_eq!((plan.steps, plan.time_s, plan.actions.len()), (34, 6.8, 34));
    assert_eq!(lower_bound_steps(&Scenario::default(), (0.0, 0.0, 0.0), vec2(1.2, 0.0), 0), 34);
}

#[test]
fn a_lagging_actuator_is_unsupported() {
    // From rest, the robot of the previous test loses 0.15 m/s x 0.3 s = 0.045 m: it needs 35 steps.
    let mut scenario = Scenario::default();
    scenario.robot.actuator_lag_s = 0.3.into();
    assert_eq!(plan_from_origin(&scenario, vec2(1.2, 0.0)), None, "a plan of 34 steps would be wrong");
    assert_eq!(lower_bound_steps(&scenario, (0.0, 0.0, 0.0), vec2(1.2, 0.0), 0), 1);
    assert!(!is_supported(&scenario) && is_supported(&Scenario::default()));
}

#[test]
fn straight_paths_of_any_length_and_direction_are_optimal() {
    let scenario = Scenario::default();
    for k in 1..=16_u8 {
        // With these distances d, from 0.315 m on, (d - 0.2) m / 0.03 m is never close to a whole number.
        let (d, heading) = (0.115 + 0.2 * f32::from(k), 0.4 * f32::from(k));
        let start = (-0.5 * d * heading.cos(), -0.5 * d * heading.sin(), heading);
        let goal = vec2(-start.0, -start.1);
        let steps = ((f64::from(d) - 0.2) / 0.03).ceil() as u32;
        let bounds = step_bounds(&scenario, start, goal, 0, Resolution::default());
        assert_eq!(bounds, StepBounds { lower_steps: steps, plan_steps: Some(steps) }, "{d} m");
    }
}

#[test]
fn a_goal_behind_the_robot_adds_a_turn() {
    // The centre of the turning circle is 1 m from the goal along x and 0.1 m along y, so the tangent is 1 m long. The
    // turn is pi + 2 atan(0.1) = 3.3409 rad on a radius of 0.1 m. (0.33409 + 1 - 0.2) m / 0.03 m = 37.8.
    let start = (0.0, 0.0, 0.0);
    assert_eq!(lower_bound_steps(&Scenario::default(), start, vec2(-1.0, 0.0), 0), 38);
    assert_eq!(plan_from_origin(&Scenario::default(), vec2(-1.0, 0.0)).map(|plan| plan.steps), Some(38));
}

#[test]
fn a_start_on_the_goal_takes_one_step() {
    assert_eq!(plan_from_origin(&Scenario::default(), vec2(0.05, 0.0)).map(|plan| plan.steps), Some(1));
    assert_eq!(lower_bound_steps(&Scenario::default(), (0.0, 0.0, 0.0), vec2(0.05, 0.0), 0), 1);
}

#[test]
fn the_benchmark_route_takes_54_steps_which_is_proven_optimal() {
    let (scenario, start, goal) = (cylinders(0.0), (0.0, 0.0, 0.0), vec2(1.2, 1.2));
    assert_eq!(lower_bound_steps(&scenario, start, goal, 0), 54);
    for cell_m in [0.04, 0.02, 0.01, 0.005] {
        let resolution =
            Resolution { cell_m, heading_rad: 4.0 * cell_m, refinements: 0, ..Default::default() };
        let plan = plan_path(&scenario, start, goal, 0, resolution).expect("a path");
        assert_eq!(plan.steps, 54, "with cells of {cell_m} m");
        assert_eq!(replay(&scenario, start, goal, 0, &plan.actions), Ok(54));
    }
}

#[test]
fn the_path_around_a_box_has_the_length_computed_by_hand() {
    // From (-1, 0) to (1, 0), past the upper corners of a box that is 0.1 m wide, reaches from the lower wall to y = 0.6,
    // and must be passed at 0.13 m. Both halves are equal. The corner is (0.95, 0.6) from the end, a distance of
    // 1.12361 m; the tangent is sqrt(1.12361^2 - 0.13^2) = 1.11606 m; the arc's angle is atan(0.6 / 0.95) +
    // asin(0.13 / 1.12361) = 0.67932 rad. The total is 2 (1.11606 + 0.13 * 0.67932) + 0.1 - 0.2 = 2.30874 m, or 76.96
    // steps: at least 77. The start's heading is along the tangent.
    let scenario = Scenario { obstacles: vec![static_box(vec2(0.0, -0.7), 0.1, 2.6)], ..Scenario::default() };
    let (start, goal) = ((-1.0, 0.0, 0.67932), vec2(1.0, 0.0));
    let plan = plan_path(&scenario, start, goal, 0, Resolution::default()).expect("a path");
    assert!((76..=77).contains(&lower_bound_steps(&scenario, start, goal, 0)));
    assert!((77..=78).contains(&plan.steps), "{} steps", plan.steps);
}

/// The shortest path around the box of the previous test is 2.30874 m long at any heading of the robot. A wall of the same size,
/// given by corners or by cells, yields the same length.
#[test]
fn the_shortest_path_goes_round_obstacles_and_walls_to_the_edge_of_the_goal() {
    let (start, goal) = ((-1.0, 0.0, 2.0), vec2(1.0, 0.0));
    let boxed = Scenario { obstacles: vec![static_box(vec2(0.0, -0.7), 0.1, 2.6)], ..Scenario::default() };
    let corners_m = vec![vec2(0.0, -1.95), vec2(0.0, 0.55)];
    let walled = Scenario {
        walls: vec![wayfield_scenario::Wall {
            corners_m,
            thickness_m: 0.1,
            ..wayfield_scenario::Wall::default()
        }],
        ..Scenario::default()
    };
    // 27 cells of 0.1 m from y = -2.1 to y = 0.6, of which the lowest one is outside the enclosure and so free.
    let rows = (0..27).map(|row| if row < 26 { "#" } else { "." }.to_owned()).collect();
    let cells = wayfield_scenario::WallCells::new(rows, 0.1, vec2(0.0, -0.75));
    let cells = Scenario {
        walls: vec![wayfield_scenario::Wall { cells: Some(cells), ..Default::default() }],
        ..Scenario::default()
    };
    for scenario in [&boxed, &walled, &cells] {
        let length = shortest_path_m(scenario, start, goal).expect("a path");
        assert!((2.30874 * 0.995..=2.30875).contains(&length), "{length}");
    }
    let straight = shortest_path_m(&Scenario::default(), start, goal).expect("a path");
    assert!((straight - 1.8).abs() < 1e-4, "{straight}");
    assert_eq!(shortest_path_m(&Scenario::default(), start, vec2(-0.9, 0.0)), Some(0.0), "already there");

    let lagging =
        Scenario { robot: Robot { actuator_lag_s: 0.3.into(), ..Robot::default() }, ..boxed.clone() };
    assert_eq!(shortest_path_m(&lagging, start, goal), shortest_path_m(&boxed, start, goal));
    let blocked = Scenario { obstacles: vec![static_box(vec2(0.0, 0.0), 0.1, 4.0)], ..Scenario::default() };
    assert_eq!(shortest_path_m(&blocked, start, goal), None);
    let corners_m = vec![vec2(-2.0, -2.0), vec2(2.0, -2.0), vec2(0.0, 2.0)];
    let triangle = Scenario { enclosure: Enclosure::Polygon { corners_m }, ..Scenario::default() };
    assert_eq!(shortest_path_m(&triangle, start, goal), None, "polygons are not supported");
}

#[test]
fn a_robot_that_does_not_drive_as_commanded_is_unsupported() {
    let unsupported = |robot: Robot| unsupported_reason(&Scenario { robot, ..Scenario::default() });
    for (robot, expected) in [
        (Robot::default(), None),
        (
            Robot { actuator_lag_s: Ranged::Range(0.0, 0.3), ..Robot::default() },
            Some("actuator lag: robot.actuator_lag_s is (0, 0.3)"),
        ),
        (
            Robot { max_angular_acceleration_rad_s2: Some(2.5), ..Robot::default() },
            Some("limited accelerations: robot.max_angular_acceleration_rad_s2 is 2.5"),
        ),
        (Robot { slip: Some(Slip::default()), ..Robot::default() }, Some("slip: robot.slip is given")),
    ] {
        assert_eq!(unsupported(robot).as_deref(), expected);
    }
}

#[test]
fn a_blocked_goal_has_no_plan() {
    let blocked = Scenario { obstacles: vec![static_box(vec2(0.8, 0.0), 0.1, 4.0)], ..Scenario::default() };
    assert_eq!(plan_from_origin(&blocked, vec2(1.5, 0.0)), None);
    assert_eq!(lower_bound_steps(&blocked, (0.0, 0.0, 0.0), vec2(1.5, 0.0), 0), u32::MAX);
    let mut limited = Scenario::default();
    limited.task.max_episode_steps = 33;
    assert_eq!(plan_from_origin(&limited, vec2(1.2, 0.0)), None, "34 steps exceed the time limit");
    limited.task.max_episode_steps = 34;
    assert!(plan_from_origin(&limited, vec2(1.2, 0.0)).is_some());
}

#[test]
fn the_clock_determines_where_moving_obstacles_are() {
    // A cylinder moves down the line x = 0.6 at 0.15 m/s, as fast as the robot. Starting at y = 0.6, it is in the way when
    // the robot reaches that line. With a later clock it has already passed.
    let motion = ObstacleMotion::Patrol { waypoints_m: vec![vec2(0.6, -1.8)], speed_m_s: 0.15.into() };
    let scenario = Scenario { obstacles: vec![circle(vec2(0.6, 0.6), 0.15, motion)], ..Scenario::default() };
    let planned_steps = |clock| {
        let start = (0.0, 0.0, 0.0);
        let plan = plan_path(&scenario, start, vec2(1.2, 0.0), clock, Resolution::default()).expect("a path");
        assert_eq!(replay(&scenario, start, vec2(1.2, 0.0), clock, &plan.actions), Ok(plan.steps));
        assert!(lower_bound_steps(&scenario, start, vec2(1.2, 0.0), clock) <= plan.steps);
        plan.steps
    };
    assert!(
        replay(&scenario, (0.0, 0.0, 0.0), vec2(1.2, 0.0), 0, &[2; 34]).is_err(),
        "the straight path collides"
    );
    assert!((35..45).contains(&planned_steps(0)), "{}", planned_steps(0));
    assert_eq!(planned_steps(30), 34);
}

#[test]
fn motions_may_drive_backward_stand_still_or_turn_on_the_spot() {
    let mut scenario = Scenario::default();
    let motion = |v_m_s, w_rad_s| wayfield_scenario::Motion { v_m_s, w_rad_s };
    scenario.robot.motions = vec![motion(0.0, 0.0), motion(0.15, 0.0), motion(0.0, 1.5), motion(-0.15, 0.0)];
    let plan = plan_from_origin(&scenario, vec2(-1.2, 0.0)).expect("backward");
    assert_eq!(plan.steps, 34);
    let plan = plan_from_origin(&scenario, vec2(0.0, 1.2)).expect("turn, then drive");
    // Five turns of 0.3 rad are 0.07 rad short of a right angle; 34 or 35 steps remain.
    assert!((39..=40).contains(&plan.steps), "{}", plan.steps);
    assert!(lower_bound_steps(&scenario, (0.0, 0.0, 0.0), vec2(0.0, 1.2), 0) <= plan.steps);
    scenario.robot.motions.truncate(1);
    assert_eq!(plan_from_origin(&scenario, vec2(1.2, 0.0)), None, "the only motion is to stand still");
}

#[test]
fn random_plans_are_on_average_within_one_percent_of_the_proven_bound() {
    let scenario = cylinders(0.0);
    let mut draws = stream(1, "optimum", 0);
    let (mut steps, mut lower_steps) = (0, 0);
    for _ in 0..100 {
        let start = draw_start(&scenario, 0, &mut draws).expect("free space");
        let goal = draw_goal(&scenario, 0, vec2(start.0, start.1), &mut draws).expect("free space");
        let plan = plan_path(&scenario, start, goal, 0, Resolution::default()).expect("a path");
        steps += plan.steps;
        lower_steps += lower_bound_steps(&scenario, start, goal, 0);
    }
    assert!(lower_steps <= steps, "{lower_steps} > {steps}");
    assert!(f64::from(steps) < 1.01 * f64::from(lower_steps), "{steps} > 1.01 * {lower_steps}");
}

#[test]
fn the_bound_never_exceeds_the_plan_of_a_search_without_it() {
    let mut draws = stream(2, "optimum", 0);
    for scenario in [Scenario::default(), cylinders(0.0), maze()] {
        for _ in 0..12 {
            let start = draw_start(&scenario, 0, &mut draws).expect("free space");
            let goal = draw_goal(&scenario, 0, vec2(start.0, start.1), &mut draws).expect("free space");
            let bound = LowerBound::new(&scenario, start, goal);
            let mut straight_line = LowerBound::new(&scenario, start, goal);
            straight_line.turning_radius = None;
            let graph = &mut straight_line.visibility_graph;
            (graph.occluders, graph.corners) = (Vec::new(), Vec::new());
            let mut space = ConfigurationSpace::new(&scenario, 0, scenario.keep_out_m().into());
            let goal_region = GoalRegion::new(&scenario, goal, 0.0);
            let limits = SearchLimits { step_limit: 500, max_states: MAX_STATES };
            let mut cells = StateGrid::new(0.03, 0.16, false);
            let plan =
                search(&mut space, &straight_line, &goal_region, start, &mut cells, &limits).expect("a path");
            let mut state = State::new(start);
            for (steps, &action) in (1..).zip(&plan[..plan.len() - 1]) {
                state =
                    state.after(&space.motion_primitives[usize::from(action)], libm::sincos(state.heading));
                let (to_go, left) = (bound.steps(&state), plan.len() - steps);
                assert!(to_go <= left as f64, "the bound is {to_go} steps, but {left} were enough");
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_replayed_plan_arrives_with_its_last_step_without_a_collision(
        seed: u64,
        clock in 0_u64..1_000,
        map in 0_usize..4,
    ) {
        let scenario = &[Scenario::default(), cylinders(0.0), cylinders(0.15), maze()][map];
        let mut draws = stream(seed, "optimum", 0);
        let start = draw_start(scenario, clock, &mut draws).expect("free space");
        let goal = draw_goal(scenario, clock, vec2(start.0, start.1), &mut draws).expect("free space");
        let coarse = Resolution { refinements: 0, ..Resolution::default() };
        let first = plan_path(scenario, start, goal, clock, coarse).expect("a path");
        let plan = plan_path(scenario, start, goal, clock, Resolution::default()).expect("a path");
        prop_assert_eq!(plan.steps as usize, plan.actions.len());
        prop_assert_eq!(replay(scenario, start, goal, clock, &plan.actions), Ok(plan.steps));
        prop_assert!(plan.steps <= first.steps, "a refined search is never worse");
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

    /// The bound from each state of a random trajectory is at most the number of steps to the trajectory's end.
    #[test]
    fn no_random_trajectory_is_shorter_than_the_bounds(seed: u64, map in 0_usize..3, motions in 1_usize..8, held in 1_u32..20) {
        let scenario = &[Scenario::default(), cylinders(0.0), maze()][map];
        let mut draws = stream(seed, "drive", 0);
        let start = draw_start(scenario, 0, &mut draws).expect("free space");
        let free = ConfigurationSpace::new(scenario, 0, scenario.keep_out_m().into());
        let mut path = vec![State::new(start)];
        for _ in 0..motions {
            let step = &free.motion_primitives[wayfield_random::uniform_index(&mut draws, free.motion_primitives.len())];
            for _ in 0..held {
                let last = path[path.len() - 1];
                let next = last.after(step, libm::sincos(last.heading));
                if !free.is_clear(next.x, next.y, 0) {
                    break;
                }
                path.push(next);
            }
        }
        let end = path[path.len() - 1];
        let radius = 0.199 * uniform(&mut draws, 0.0, 1.0);
        let angle = uniform(&mut draws, 0.0, std::f32::consts::TAU);
        let goal = vec2(end.x as f32 + radius * angle.cos(), end.y as f32 + radius * angle.sin());
        let bound = LowerBound::new(scenario, start, goal);
        for (before, state) in path.iter().enumerate() {
            let to_go = bound.steps(state);
            let taken = (path.len() - 1 - before) as f64;
            prop_assert!(to_go <= taken + 1e-9, "the bound from ({}, {}) is {to_go} steps, but {taken} were enough", state.x, state.y);
        }
        if path.len() > 1 {
            prop_assert!(lower_bound_steps(scenario, start, goal, 0) < path.len() as u32);
        }
    }
}
