//! No tunnelling: at any speed of the robot or the obstacle, a contact stops the robot and counts as a collision.

use std::f32::consts::PI;

use bevy::math::{Vec2, vec2};
use wayfield::random::{stream, uniform, uniform_01, uniform_index};
use wayfield::scenario::{Enclosure, Motion, Obstacle, ObstacleMotion, Scenario, Shape, Wall, diagnostics};
use wayfield::sim;
use wayfield::task::{ArenaState, Clock, Pose, RewardConfig, StepOutcome, TaskMode, Twist};

use crate::common::{Lab, closed_form, static_obstacle};
use crate::random_scenarios::{
    Point, arc, at_max_speed, between_steps, centre, distance, first_within, free_pose, scenarios,
};

/// The tolerated penetration of a robot, in m.
const MAX_PENETRATION_M: f64 = 0.001;

/// One step of one robot, and the invariants that hold for every step.
struct Step {
    layout: Scenario,
    clock: u64,
    from: Pose,
    motion: Motion,
    after: ArenaState,
    outcome: StepOutcome,
    /// The speed of the body after the step, in m/s.
    speed_m_s: f64,
}

impl Step {
    /// The end of the commanded arc.
    fn commanded_end(&self) -> Point {
        let motion = (f64::from(self.motion.v_m_s), f64::from(self.motion.w_rad_s));
        let start = (centre(&self.from), f64::from(self.from.heading_rad));
        arc(start, motion, f64::from(self.layout.task.control_period_s)).0
    }

    /// The fraction of the step after which the gap to something falls below `gap_m`, on the way to the commanded end.
    fn first_contact(&self, gap_m: f64) -> Option<f64> {
        let reach = f64::from(self.layout.robot.radius_m) + gap_m;
        first_within(&self.layout, self.clock, centre(&self.from), self.commanded_end(), reach)
    }

    /// Asserts the invariants of a step. Returns whether the robot had a contact.
    fn assert_invariants(&self, what: &str) -> bool {
        let context = || format!("{what}: {:?} from {:?} at clock {}", self.motion, self.from, self.clock);
        let (from, commanded, end) = (centre(&self.from), self.commanded_end(), centre(&self.after.pose));
        let rounding = 3e-6 * (1.0 + distance(from, commanded)) + 2e-7 * (from.0.abs() + from.1.abs());
        let (driven, max) = (distance(from, end), distance(from, commanded));
        assert!(driven <= max + rounding, "{}: drives {driven} m, commanded {max} m", context());
        let free_m_s = max / f64::from(self.layout.task.control_period_s);
        let expected_m_s = if self.after.scan.touching { 0.0 } else { free_m_s };
        let off_m_s = (self.speed_m_s - expected_m_s).abs();
        assert!(
            off_m_s <= 1e-5 * expected_m_s + 1e-6,
            "{}: {} m/s, expected {expected_m_s} m/s",
            context(),
            self.speed_m_s
        );

        let contact = self.first_contact(-0.0005);
        if let Some(fraction) = contact {
            assert!(
                self.outcome.collided && self.after.scan.touching,
                "{}: no collision despite a contact at {fraction} of the step; it ends at {end:?}, commanded {commanded:?}",
                context()
            );
        }
        if self.first_contact(0.001).is_none() {
            assert!(!self.after.scan.touching, "{}: reports a contact without an obstacle", context());
            assert!(
                distance(end, commanded) <= rounding,
                "{}: ends at {end:?}, commanded {commanded:?}, without a contact",
                context()
            );
        }
        // No static obstacle is on the line from the start to the end.
        let mut static_only = self.layout.clone();
        static_only.obstacles.retain(|obstacle| obstacle.motion == ObstacleMotion::Static);
        let inside = f64::from(self.layout.robot.radius_m) - MAX_PENETRATION_M;
        let passed = first_within(&static_only, 0, from, end, inside);
        assert!(passed.is_none(), "{}: passes through something to {end:?}", context());
        contact.is_some()
    }
}

/// Arenas of one scenario whose robots are placed before each step.
struct ArenaBatch {
    lab: Lab,
    fresh: Vec<ArenaState>,
}

impl ArenaBatch {
    fn new(scenario: &Scenario, arenas: usize) -> Self {
        let mut lab = Lab::with(scenario, arenas, 7, RewardConfig::default(), TaskMode::SingleGoal);
        let fresh = lab.states();
        Self { lab, fresh }
    }

    fn layout(&self, arena: usize) -> Scenario {
        self.lab.scenario.with_generated_obstacles(self.fresh[arena].layout_seed)
    }

    /// Runs one step from these poses and clocks, with these actions; one element per arena.
    fn step(&mut self, starts: &[(Pose, u64, usize)]) -> Vec<Step> {
        let mut states = self.fresh.clone();
        for (state, &(pose, clock, _)) in states.iter_mut().zip(starts) {
            (state.pose, state.clock, state.twist) = (pose, Clock(clock), Twist::default());
        }
        sim::restore(self.lab.simulation.world_mut(), &states);
        let actions: Vec<usize> = starts.iter().map(|&(.., action)| action).collect();
        self.lab.step(&actions);
        let states = self.lab.states();
        let mut steps = Vec::new();
        for (arena, (&(from, clock, action), after)) in starts.iter().zip(states).enumerate() {
            let velocity = self.lab.with_physics(arena, |bodies, set, _| set.bodies[bodies.robot].linvel());
            steps.push(Step {
                layout: self.layout(arena),
                clock,
                from,
                motion: self.lab.scenario.robot.motions[action],
                after,
                outcome: self.lab.outcomes()[arena],
                speed_m_s: f64::from(velocity.length()),
            });
        }
        steps
    }
}

#[test]
fn in_random_scenarios_at_full_speed_no_robot_passes_through_anything() {
    const ARENAS: usize = 32;
    let mut stream = stream(3, "at full speed", 0);
    let (mut steps, mut contacts) = (0, 0);
    for (number, scenario) in scenarios(1, 60).filter_map(at_max_speed).enumerate() {
        let scenario = Scenario {
            robot: wayfield::scenario::Robot { actuator_lag_s: 0.0.into(), ..scenario.robot.clone() },
            ..scenario
        };
        let mut batch = ArenaBatch::new(&scenario, ARENAS);
        for _ in 0..8 {
            let starts: Option<Vec<_>> = (0..ARENAS)
                .map(|arena| {
                    let clock = uniform_index(&mut stream, 100_000) as u64;
                    let clear = f64::from(scenario.robot.radius_m) + 0.002;
                    let pose = free_pose(&batch.layout(arena), clock, clear, &mut stream)?;
                    Some((pose, clock, uniform_index(&mut stream, scenario.robot.motions.len())))
                })
                .collect();
            for step in batch.step(&starts.expect("free space")) {
                contacts +=
                    usize::from(step.assert_invariants(&format!("scenario {number}, {}", scenario.name)));
                steps += 1;
            }
        }
    }
    assert!(steps > 10_000 && contacts > 1_000, "{steps} steps, {contacts} contacts");
}

/// The smallest robot with the longest step that the checks allow: 5 m/s for 10 s.
fn longest_step() -> Scenario {
    let mut scenario = Scenario {
        enclosure: Enclosure::Rectangle { width_m: 300.0, height_m: 300.0 },
        ..Scenario::default()
    };
    scenario.robot.radius_m = 0.01;
    scenario.robot.motions = [5.0, -5.0, 0.0].map(|v_m_s| Motion { v_m_s, w_rad_s: 0.0 }).into();
    scenario.task.control_period_s = 10.0;
    scenario.task.collision_range_m = 0.011;
    scenario.task.goal_radius_m = 25.0;
    scenario.task.min_goal_distance_m = 26.0;
    scenario
}

#[test]
fn the_longest_step_ends_at_the_thinnest_obstacle() {
    let wall = |corners_m| Wall { corners_m, thickness_m: 0.01, ..Wall::default() };
    let thin = |shape: Shape, turn| static_obstacle(shape, vec2(0.0, 0.0), turn);
    let l_shape = vec![
        vec2(-60.0, -60.0),
        vec2(60.0, -60.0),
        vec2(60.0, 0.0),
        vec2(0.0, 0.0),
        vec2(0.0, 60.0),
        vec2(-60.0, 60.0),
    ];
    let plate = Shape::Polygon { corners_m: vec![vec2(-0.5, 0.0), vec2(0.5, -0.0005), vec2(0.5, 0.0005)] };
    let scenarios = [
        Scenario { walls: vec![wall(vec![vec2(-40.0, 0.0), vec2(40.0, 0.0)])], ..longest_step() },
        Scenario {
            walls: vec![wall(vec![vec2(-40.0, -40.0), vec2(0.0, 0.0), vec2(40.0, -40.0)])],
            ..longest_step()
        },
        Scenario {
            obstacles: vec![thin(Shape::Rectangle { width_m: 60.0, height_m: 0.001 }, 0.3)],
            ..longest_step()
        },
        Scenario { obstacles: vec![thin(Shape::Circle { radius_m: 0.001 }, 0.0)], ..longest_step() },
        Scenario {
            obstacles: vec![thin(Shape::Capsule { length_m: 3.0, radius_m: 0.001 }, 1.0)],
            ..longest_step()
        },
        Scenario { obstacles: vec![thin(plate, -0.4)], ..longest_step() },
        Scenario { enclosure: Enclosure::Polygon { corners_m: l_shape }, ..longest_step() },
    ];
    for (number, scenario) in scenarios.iter().enumerate() {
        let found =
            diagnostics(&Scenario { benchmark_route: Some(long_benchmark_route()), ..scenario.clone() });
        assert!(found.is_empty(), "scenario {number} is invalid: {found:?}");
        let mut batch = ArenaBatch::new(scenario, 16);
        let (mut contacts, mut stream) = (0, stream(9, "longest step", number as u64));
        for round in 0..40 {
            let starts: Vec<_> = (0..16)
                .map(|k| {
                    let pose = free_pose(scenario, 0, 0.05, &mut stream).expect("free space");
                    // Drives at the thin obstacle at the origin, past it or elsewhere; forwards if k < 8, else backwards.
                    let to_origin = (-pose.y_m).atan2(-pose.x_m);
                    let offset = [0.0, 1e-4, -3e-4, 2e-3, -0.02, 0.3, 1.0, -2.0][k % 8];
                    // From 0.1 m to 48 m away.
                    let away = 0.1 + 48.9 * (round as f32 / 40.0);
                    let (sin, cos) = to_origin.sin_cos();
                    let candidate = Pose { x_m: -away * cos, y_m: -away * sin, ..pose };
                    let clear = closed_form::clearance(scenario, 0, centre(&candidate));
                    let start = if clear > 0.012 { candidate } else { pose };
                    let heading_rad =
                        wayfield::task::wrap_angle(to_origin + offset + if k < 8 { 0.0 } else { PI });
                    (Pose { heading_rad, ..start }, 0, usize::from(k >= 8))
                })
                .collect();
            for step in batch.step(&starts) {
                contacts += usize::from(step.assert_invariants(&format!("thin obstacle {number}")));
            }
        }
        assert!(contacts > 20, "scenario {number}: only {contacts} contacts");
    }
}

/// A long benchmark route that is clear of the thin obstacles.
fn long_benchmark_route() -> wayfield::scenario::BenchmarkRoute {
    wayfield::scenario::BenchmarkRoute {
        start_m: vec2(-45.0, -50.0),
        heading_rad: 0.0,
        goal_m: vec2(30.0, -55.0),
    }
}

#[test]
fn an_obstacle_that_moves_over_a_robot_collides_with_it() {
    // The longest travel per step that the checks allow for an obstacle, 0.5 m, and the largest rotation, half a turn.
    let patrol = || ObstacleMotion::Patrol { waypoints_m: vec![vec2(1.0, 0.013)], speed_m_s: 2.5.into() };
    let orbit =
        |centre_m, speed_rad_s: f32| ObstacleMotion::Orbit { centre_m, speed_rad_s: speed_rad_s.into() };
    let put = |shape, motion| Obstacle { motion, ..static_obstacle(shape, vec2(-1.0, 0.0), 0.5) };
    let needle = || Shape::Capsule { length_m: 0.8, radius_m: 0.001 };
    let fast = [
        put(Shape::Circle { radius_m: 0.001 }, patrol()),
        put(Shape::Circle { radius_m: 0.05 }, patrol()),
        put(Shape::Rectangle { width_m: 0.001, height_m: 0.4 }, patrol()),
        put(Shape::Polygon { corners_m: vec![vec2(0.0, 0.0), vec2(0.2, 0.0), vec2(0.0, 0.03)] }, patrol()),
        put(needle(), orbit(vec2(-1.0, 0.0), 5.0 * PI)),
        put(needle(), orbit(vec2(-0.9, 0.1), -5.0 * PI)),
        put(Shape::Circle { radius_m: 0.001 }, orbit(vec2(-0.2, 0.0), 3.125)),
        put(Shape::Rectangle { width_m: 0.6, height_m: 0.002 }, orbit(vec2(-0.8, 0.0), 12.5)),
    ];
    for (number, obstacle) in fast.into_iter().enumerate() {
        for radius_m in [0.01, 0.1] {
            let mut scenario = Scenario { obstacles: vec![obstacle.clone()], ..Scenario::default() };
            scenario.robot.radius_m = radius_m;
            scenario.robot.motions =
                vec![Motion { v_m_s: 0.0, w_rad_s: 0.0 }, Motion { v_m_s: 1.0, w_rad_s: 3.0 }];
            scenario.task.collision_range_m = radius_m + 0.0001;
            assert!(diagnostics(&scenario).is_empty(), "{:?}", diagnostics(&scenario));
            let mut batch = ArenaBatch::new(&scenario, 32);
            let mut stream = stream(5, "driven over", number as u64);
            let mut contacts = 0;
            for _ in 0..30 {
                let starts: Vec<_> = (0..32)
                    .map(|k| {
                        let clock = uniform_index(&mut stream, 10_000) as u64;
                        // A position on the obstacle's trajectory in this step, or close to it.
                        let pose = loop {
                            let moment = between_steps(&scenario, clock, f64::from(uniform_01(&mut stream)));
                            let reach = obstacle.shape.bounding_radius_m() + radius_m;
                            let mut offset = || uniform(&mut stream, -reach, reach);
                            let Vec2 { x, y } = moment.obstacles[0].position_m;
                            let pose = Pose { x_m: x + offset(), y_m: y + offset(), heading_rad: 1.0 };
                            let clear = closed_form::clearance(&scenario, clock, centre(&pose));
                            if clear > f64::from(radius_m) + 0.002 {
                                break pose;
                            }
                        };
                        (pose, clock, k % 2)
                    })
                    .collect();
                for step in batch.step(&starts) {
                    contacts += usize::from(step.assert_invariants(&format!("obstacle {number}")));
                }
            }
            assert!(contacts > 20, "obstacle {number}, robot radius {radius_m} m: only {contacts} contacts");
        }
    }
}

#[test]
fn a_robot_placed_inside_an_obstacle_is_not_ejected() {
    // An edit may put the robot inside an obstacle or a wall.
    let mut scenario = crate::common::moving_obstacles();
    let route = scenario.benchmark_route.get_or_insert_default();
    (route.start_m, route.goal_m) = (vec2(1.7, 0.0), vec2(-1.7, 0.0));
    let scenario = at_max_speed(scenario).expect("a valid scenario");
    let mut batch = ArenaBatch::new(&scenario, 16);
    let mut stream = stream(8, "thrown", 0);
    let mut inside = 0;
    for _ in 0..200 {
        let starts: Vec<_> = (0..16)
            .map(|_| {
                let clock = uniform_index(&mut stream, 10_000) as u64;
                let pose = free_pose(&scenario, clock, -0.3, &mut stream).expect("a pose");
                (pose, clock, uniform_index(&mut stream, scenario.robot.motions.len()))
            })
            .collect();
        for step in batch.step(&starts) {
            let from = centre(&step.from);
            let driven = distance(from, centre(&step.after.pose));
            let max = distance(from, step.commanded_end());
            assert!(driven <= max + 5e-6, "{:?} from {:?}: {driven} m", step.motion, step.from);
            if closed_form::clearance(&scenario, step.clock, from) < 0.0999 {
                assert!(
                    step.outcome.collided && step.after.scan.touching && step.speed_m_s == 0.0,
                    "a robot inside an obstacle collides and stays at rest: {:?}",
                    step.from
                );
                inside += 1;
            }
        }
    }
    assert!(inside > 300, "only {inside} robots started inside an obstacle");
}
