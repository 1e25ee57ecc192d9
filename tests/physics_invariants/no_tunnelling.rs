//! No tunnelling: a robot is stopped where it touches, and the step is judged a collision, however fast it or the
//! obstacle is.

use std::f32::consts::PI;

use bevy::math::{Vec2, vec2};
use wayfield::random::{stream, uniform, uniform_01, uniform_index};
use wayfield::scenario::{Enclosure, Motion, Obstacle, ObstacleMotion, Scenario, Shape, Wall, diagnostics};
use wayfield::sim;
use wayfield::task::{ArenaState, Clock, Pose, RewardConfig, StepOutcome, TaskMode, Twist};

use crate::common::{Lab, closed_form, still};
use crate::random_scenarios::{
    Point, apart, arc, at_max_speed, between_steps, first_within, free_pose, middle, worlds,
};

/// So deep may a robot be in something, in m.
const MAX_PENETRATION_M: f64 = 0.001;

/// One step of one robot, and what is true of it whatever happens.
struct Step {
    room: Scenario,
    clock: u64,
    from: Pose,
    motion: Motion,
    after: ArenaState,
    outcome: StepOutcome,
    /// How fast the body goes after it, in m/s.
    speed_m_s: f64,
}

impl Step {
    fn due(&self) -> Point {
        let motion = (f64::from(self.motion.v_m_s), f64::from(self.motion.w_rad_s));
        let begin = (middle(&self.from), f64::from(self.from.heading_rad));
        arc(begin, motion, f64::from(self.room.task.control_period_s)).0
    }

    /// When something is nearer to the robot's middle than its radius and `more_m`, if it goes as it was told.
    fn meets(&self, more_m: f64) -> Option<f64> {
        let reach = f64::from(self.room.robot.radius_m) + more_m;
        first_within(&self.room, self.clock, middle(&self.from), self.due(), reach)
    }

    /// Gives whether it met something.
    fn assert_invariants(&self, what: &str) -> bool {
        let told = || format!("{what}: {:?} from {:?} at clock {}", self.motion, self.from, self.clock);
        let (from, due, end) = (middle(&self.from), self.due(), middle(&self.after.pose));
        let rounding = 3e-6 * (1.0 + apart(from, due)) + 2e-7 * (from.0.abs() + from.1.abs());
        let (gone, most) = (apart(from, end), apart(from, due));
        assert!(gone <= most + rounding, "{}: it goes {gone} m, told to go {most} m", told());
        let due_m_s = most / f64::from(self.room.task.control_period_s);
        let due_m_s = if self.after.scan.touching { 0.0 } else { due_m_s };
        let off_m_s = (self.speed_m_s - due_m_s).abs();
        assert!(off_m_s <= 1e-5 * due_m_s + 1e-6, "{}: {} m/s, not {due_m_s}", told(), self.speed_m_s);

        let met = self.meets(-0.0005);
        if let Some(part) = met {
            assert!(
                self.outcome.collided && self.after.scan.touching,
                "{}: meets something at {part} of the step and goes on to {end:?}, due at {due:?}",
                told()
            );
        }
        if self.meets(0.001).is_none() {
            assert!(!self.after.scan.touching, "{}: meets nothing, and is said to", told());
            assert!(
                apart(end, due) <= rounding,
                "{}: meets nothing, and ends at {end:?}, not at {due:?}",
                told()
            );
        }
        // From where it was to where it is, nothing that stands is on the way.
        let mut standing = self.room.clone();
        standing.obstacles.retain(|obstacle| obstacle.motion == ObstacleMotion::Static);
        let inside = f64::from(self.room.robot.radius_m) - MAX_PENETRATION_M;
        let through = first_within(&standing, 0, from, end, inside);
        assert!(through.is_none(), "{}: went through something, to {end:?}", told());
        met.is_some()
    }
}

/// Many robots, each in the same world, that are put where one likes for each step.
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

    fn room(&self, arena: usize) -> Scenario {
        self.lab.scenario.with_generated_obstacles(self.fresh[arena].layout_seed)
    }

    /// One step from these poses and clocks, with these motions; one for each arena.
    fn step(&mut self, begin: &[(Pose, u64, usize)]) -> Vec<Step> {
        let mut states = self.fresh.clone();
        for (state, &(pose, clock, _)) in states.iter_mut().zip(begin) {
            (state.pose, state.clock, state.twist) = (pose, Clock(clock), Twist::default());
        }
        sim::restore(self.lab.simulation.world_mut(), &states);
        let actions: Vec<usize> = begin.iter().map(|&(.., action)| action).collect();
        self.lab.step(&actions);
        let states = self.lab.states();
        let mut steps = Vec::new();
        for (arena, (&(from, clock, action), after)) in begin.iter().zip(states).enumerate() {
            let velocity = self.lab.with_physics(arena, |bodies, set, _| set.bodies[bodies.robot].linvel());
            steps.push(Step {
                room: self.room(arena),
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
fn in_random_worlds_at_full_speed_nothing_is_driven_through() {
    const ARENAS: usize = 32;
    let mut stream = stream(3, "at full speed", 0);
    let (mut asked, mut met) = (0, 0);
    for (number, scenario) in worlds(1, 60).filter_map(at_max_speed).enumerate() {
        let scenario = Scenario {
            robot: wayfield::scenario::Robot { actuator_lag_s: 0.0, ..scenario.robot.clone() },
            ..scenario
        };
        let mut hall = ArenaBatch::new(&scenario, ARENAS);
        for _ in 0..8 {
            let begin: Option<Vec<_>> = (0..ARENAS)
                .map(|arena| {
                    let clock = uniform_index(&mut stream, 100_000) as u64;
                    let clear = f64::from(scenario.robot.radius_m) + 0.002;
                    let pose = free_pose(&hall.room(arena), clock, clear, &mut stream)?;
                    Some((pose, clock, uniform_index(&mut stream, scenario.robot.motions.len())))
                })
                .collect();
            for step in hall.step(&begin.expect("there is room")) {
                met += usize::from(step.assert_invariants(&format!("world {number}, {}", scenario.name)));
                asked += 1;
            }
        }
    }
    assert!(asked > 10_000 && met > 1_000, "{asked} steps, {met} collisions");
}

/// The longest step that the checks allow: 5 m/s for 10 s, the smallest robot in the largest hurry.
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
fn the_longest_step_ends_at_the_thinnest_thing() {
    let wall = |corners_m| Wall { corners_m, thickness_m: 0.01 };
    let thin = |shape: Shape, turn| still(shape, vec2(0.0, 0.0), turn);
    let l = vec![
        vec2(-60.0, -60.0),
        vec2(60.0, -60.0),
        vec2(60.0, 0.0),
        vec2(0.0, 0.0),
        vec2(0.0, 60.0),
        vec2(-60.0, 60.0),
    ];
    let plate = Shape::Polygon { corners_m: vec![vec2(-0.5, 0.0), vec2(0.5, -0.0005), vec2(0.5, 0.0005)] };
    let worlds = [
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
        Scenario { enclosure: Enclosure::Polygon { corners_m: l }, ..longest_step() },
    ];
    for (number, scenario) in worlds.iter().enumerate() {
        let found = diagnostics(&Scenario { benchmark_route: far_benchmark_route(), ..scenario.clone() });
        assert!(found.is_empty(), "world {number} is allowed: {found:?}");
        let mut hall = ArenaBatch::new(scenario, 16);
        let (mut met, mut stream) = (0, stream(9, "longest step", number as u64));
        for round in 0..40 {
            let begin: Vec<_> = (0..16)
                .map(|k| {
                    let pose = free_pose(scenario, 0, 0.05, &mut stream).expect("room");
                    // Straight at the middle of the world, where the thin thing is (head-on, or at a corner), past it by
                    // less than the robot is wide, by a hair's angle, or anywhere.
                    let to_middle = (-pose.y_m).atan2(-pose.x_m);
                    let aside = [0.0, 1e-4, -3e-4, 2e-3, -0.02, 0.3, 1.0, -2.0][k % 8];
                    // From 0.1 to 49 m away.
                    let far = 0.1 + 48.9 * (round as f32 / 40.0);
                    let (sin, cos) = to_middle.sin_cos();
                    let near = Pose { x_m: -far * cos, y_m: -far * sin, ..pose };
                    let clear = closed_form::clearance(scenario, 0, middle(&near));
                    let place = if clear > 0.012 { near } else { pose };
                    let heading_rad =
                        wayfield::task::wrap_angle(to_middle + aside + if k < 8 { 0.0 } else { PI });
                    (Pose { heading_rad, ..place }, 0, usize::from(k >= 8))
                })
                .collect();
            for step in hall.step(&begin) {
                met += usize::from(step.assert_invariants(&format!("thin world {number}")));
            }
        }
        assert!(met > 20, "world {number} was met {met} times");
    }
}

/// Ends of a benchmark route that are far apart, and clear of what the thin worlds have.
fn far_benchmark_route() -> wayfield::scenario::BenchmarkRoute {
    wayfield::scenario::BenchmarkRoute {
        start_m: vec2(-45.0, -50.0),
        heading_rad: 0.0,
        goal_m: vec2(30.0, -55.0),
    }
}

#[test]
fn what_drives_over_a_standing_robot_collides_with_it() {
    // 0.5 m in a step, all that an obstacle may go; and half a turn, all that it may turn.
    let to_and_fro = || ObstacleMotion::Patrol { waypoints_m: vec![vec2(1.0, 0.013)], speed_m_s: 2.5 };
    let orbit = |centre_m, speed_rad_s| ObstacleMotion::Orbit { centre_m, speed_rad_s };
    let put = |shape, motion| Obstacle { motion, ..still(shape, vec2(-1.0, 0.0), 0.5) };
    let needle = || Shape::Capsule { length_m: 0.8, radius_m: 0.001 };
    let fast = [
        put(Shape::Circle { radius_m: 0.001 }, to_and_fro()),
        put(Shape::Circle { radius_m: 0.05 }, to_and_fro()),
        put(Shape::Rectangle { width_m: 0.001, height_m: 0.4 }, to_and_fro()),
        put(
            Shape::Polygon { corners_m: vec![vec2(0.0, 0.0), vec2(0.2, 0.0), vec2(0.0, 0.03)] },
            to_and_fro(),
        ),
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
            let mut hall = ArenaBatch::new(&scenario, 32);
            let mut stream = stream(5, "driven over", number as u64);
            let mut met = 0;
            for _ in 0..30 {
                let begin: Vec<_> = (0..32)
                    .map(|k| {
                        let clock = uniform_index(&mut stream, 10_000) as u64;
                        // Somewhere on the obstacle's way in this step, or a little aside.
                        let pose = loop {
                            let moment = between_steps(&scenario, clock, f64::from(uniform_01(&mut stream)));
                            let reach = obstacle.shape.bounding_radius_m() + radius_m;
                            let mut aside = || uniform(&mut stream, -reach, reach);
                            let Vec2 { x, y } = moment.obstacles[0].position_m;
                            let pose = Pose { x_m: x + aside(), y_m: y + aside(), heading_rad: 1.0 };
                            let clear = closed_form::clearance(&scenario, clock, middle(&pose));
                            if clear > f64::from(radius_m) + 0.002 {
                                break pose;
                            }
                        };
                        (pose, clock, k % 2)
                    })
                    .collect();
                for step in hall.step(&begin) {
                    met += usize::from(step.assert_invariants(&format!("driven over by {number}")));
                }
            }
            assert!(met > 20, "obstacle {number} met a robot of {radius_m} m {met} times");
        }
    }
}

#[test]
fn nobody_is_thrown_out_of_what_it_was_put_into() {
    // A hand may put the robot into an obstacle or a wall: it goes no faster for that.
    let mut scenario = crate::common::moving_obstacles();
    (scenario.benchmark_route.start_m, scenario.benchmark_route.goal_m) = (vec2(1.7, 0.0), vec2(-1.7, 0.0));
    let scenario = at_max_speed(scenario).expect("allowed");
    let mut hall = ArenaBatch::new(&scenario, 16);
    let mut stream = stream(8, "thrown", 0);
    let mut deep = 0;
    for _ in 0..200 {
        let begin: Vec<_> = (0..16)
            .map(|_| {
                let clock = uniform_index(&mut stream, 10_000) as u64;
                let pose = free_pose(&scenario, clock, -0.3, &mut stream).expect("anywhere");
                (pose, clock, uniform_index(&mut stream, scenario.robot.motions.len()))
            })
            .collect();
        for step in hall.step(&begin) {
            let (gone, most) =
                (apart(middle(&step.from), middle(&step.after.pose)), apart(middle(&step.from), step.due()));
            assert!(gone <= most + 5e-6, "{:?} from {:?}: {gone} m", step.motion, step.from);
            if closed_form::clearance(&scenario, step.clock, middle(&step.from)) < 0.0999 {
                assert!(
                    step.outcome.collided && step.after.scan.touching && step.speed_m_s == 0.0,
                    "it begins in something, and stays at rest: {:?}",
                    step.from
                );
                deep += 1;
            }
        }
    }
    assert!(deep > 300, "{deep}");
}
