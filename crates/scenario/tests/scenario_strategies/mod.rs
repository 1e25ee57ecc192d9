//! Strategies for random scenarios, arbitrary or valid. They have no pedestrians, no values that each episode draws from a range,
//! no slip and no odometry drift.

use std::f32::consts::TAU;

use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use wayfield_random::stream;
use wayfield_scenario::{
    BenchmarkRoute, Enclosure, Generator, Lidar, Motion, Obstacle, ObstacleMotion, PlacementRule,
    RandomShape, Region, Robot, Scenario, Shape, TaskRules, Vec2, Wall, WallCells, diagnostics,
    draw_start_and_goal, pose_at, vec2,
};

/// The numbers that a strategy draws: those that a valid scenario may have, or others too.
#[derive(Clone, Copy)]
pub enum ValueRange {
    Plausible,
    /// Also zeros, tiny and huge ones, infinities and NaN.
    Any,
    /// Also zeros, tiny and huge ones, but neither infinities nor NaN.
    Finite,
}

impl ValueRange {
    fn within(self, low: f32, high: f32) -> BoxedStrategy<f32> {
        let extreme =
            prop_oneof![Just(0.0), Just(-0.0), Just(f32::MAX), Just(f32::MIN), Just(1e-45), any::<f32>()];
        match self {
            Self::Plausible => (low..high).boxed(),
            Self::Any => prop_oneof![
                6 => low..high,
                1 => prop_oneof![Just(f32::NAN), Just(f32::INFINITY), Just(f32::NEG_INFINITY), extreme],
            ]
            .boxed(),
            Self::Finite => prop_oneof![
                6 => low..high,
                1 => extreme.prop_map(|x| if x.is_finite() { x } else { 7.0 }),
            ]
            .boxed(),
        }
    }

    fn point(self, reach: f32) -> BoxedStrategy<Vec2> {
        (self.within(-reach, reach), self.within(-reach, reach)).prop_map(Vec2::from).boxed()
    }

    fn enclosure(self) -> BoxedStrategy<Enclosure> {
        let side = || self.within(3.0, 7.0);
        let rectangle =
            (side(), side()).prop_map(|(width_m, height_m)| Enclosure::Rectangle { width_m, height_m });
        // An L with wide arms, whose corners are in either order. Its numbers are always plausible.
        let plausible = |low, high| Self::Plausible.within(low, high);
        let l = (
            plausible(3.0, 7.0),
            plausible(3.0, 7.0),
            plausible(0.3, 0.6),
            plausible(0.3, 0.6),
            any::<bool>(),
        )
            .prop_map(|(width, height, x, y, reversed)| {
                let (w, h) = (width / 2.0, height / 2.0);
                let (x, y) = (w * (2.0 * x - 1.0), h * (2.0 * y - 1.0));
                let mut corners_m =
                    vec![vec2(-w, -h), vec2(w, -h), vec2(w, y), vec2(x, y), vec2(x, h), vec2(-w, h)];
                if reversed {
                    corners_m.reverse();
                }
                Enclosure::Polygon { corners_m }
            });
        let any = vec(self.point(4.0), 0..9).prop_map(|corners_m| Enclosure::Polygon { corners_m });
        match self {
            Self::Plausible => prop_oneof![rectangle, l].boxed(),
            _ => prop_oneof![rectangle, l, any].boxed(),
        }
    }

    fn wall(self) -> BoxedStrategy<Wall> {
        let corners = vec(self.point(1.6), if matches!(self, Self::Plausible) { 2..4 } else { 0..6 });
        let segments = (corners, self.within(0.02, 0.2)).prop_map(|(corners_m, thickness_m)| Wall {
            corners_m,
            thickness_m,
            ..Wall::default()
        });
        let rows = if matches!(self, Self::Plausible) {
            vec("[#. ]{3}", 2..4).boxed()
        } else {
            vec("[#. x]{0,4}", 0..4).boxed()
        };
        let cells = (rows, self.within(0.02, 0.2), self.point(1.4)).prop_map(|(rows, cell_m, centre_m)| {
            Wall { cells: Some(WallCells::new(rows, cell_m, centre_m)), ..Wall::default() }
        });
        prop_oneof![3 => segments, 1 => cells].boxed()
    }

    fn shape(self) -> BoxedStrategy<Shape> {
        let size = || self.within(0.05, 0.4);
        // Corners on a circle, in order around it, are convex.
        let plausible = |low, high| Self::Plausible.within(low, high);
        let polygon = (vec(plausible(0.5, 1.0), 3..8), plausible(0.05, 0.4), any::<bool>()).prop_map(
            |(parts, radius, reversed)| {
                let whole: f32 = parts.iter().sum();
                let mut sum = 0.0;
                let mut corners_m: Vec<Vec2> = Vec::new();
                for part in parts {
                    sum += part;
                    let (sin, cos) = (sum / whole * TAU).sin_cos();
                    corners_m.push(vec2(radius * cos + 0.05, radius * sin));
                }
                if reversed {
                    corners_m.reverse();
                }
                Shape::Polygon { corners_m }
            },
        );
        let any = vec(self.point(1.0), 0..6).prop_map(|corners_m| Shape::Polygon { corners_m });
        let others = prop_oneof![
            size().prop_map(|radius_m| Shape::Circle { radius_m }),
            (size(), size()).prop_map(|(width_m, height_m)| Shape::Rectangle { width_m, height_m }),
            (size(), size()).prop_map(|(length_m, radius_m)| Shape::Capsule { length_m, radius_m }),
        ];
        match self {
            Self::Plausible => prop_oneof![3 => others, 1 => polygon].boxed(),
            _ => prop_oneof![3 => others, 1 => polygon, 1 => any].boxed(),
        }
    }

    fn motion(self) -> BoxedStrategy<ObstacleMotion> {
        let speed = || self.within(0.0, 1.0);
        let waypoints = || vec(self.point(1.4), if matches!(self, Self::Plausible) { 1..4 } else { 0..4 });
        prop_oneof![
            2 => Just(ObstacleMotion::Static),
            1 => (self.point(1.0), self.within(-0.8, 0.8))
                .prop_map(|(centre_m, speed_rad_s)| ObstacleMotion::Orbit { centre_m, speed_rad_s: speed_rad_s.into() }),
            1 => (waypoints(), speed())
                .prop_map(|(waypoints_m, speed_m_s)| ObstacleMotion::Patrol { waypoints_m, speed_m_s: speed_m_s.into() }),
            1 => (waypoints(), speed())
                .prop_map(|(waypoints_m, speed_m_s)| ObstacleMotion::BackAndForth { waypoints_m, speed_m_s: speed_m_s.into() }),
            1 => (waypoints(), self.within(0.2, 1.0), any::<bool>(), self.point(1.4)).prop_map(
                |(path_m, speed_m_s, is_loop, start_m)| {
                    ObstacleMotion::key_frames_along(start_m, &path_m, speed_m_s, is_loop)
                }
            ),
            1 => (self.within(0.05, 1.0), speed(), any::<u32>())
                .prop_map(|(radius_m, speed_m_s, seed)| ObstacleMotion::RandomWalk { radius_m, speed_m_s: speed_m_s.into(), seed }),
        ]
        .boxed()
    }

    fn obstacle(self) -> BoxedStrategy<Obstacle> {
        (self.shape(), self.point(1.6), self.within(-TAU, TAU), self.motion())
            .prop_map(|(shape, position_m, rotation_rad, motion)| Obstacle {
                shape,
                position_m,
                rotation_rad,
                motion,
            })
            .boxed()
    }

    fn generator(self) -> BoxedStrategy<Generator> {
        let sizes = || (self.within(0.05, 0.2), self.within(0.2, 0.3));
        let shape = prop_oneof![
            sizes().prop_map(|radius_m| RandomShape::Circle { radius_m }),
            (sizes(), sizes()).prop_map(|(width_m, height_m)| RandomShape::Rectangle { width_m, height_m }),
        ];
        let region =
            (self.within(-3.0, 0.0), self.within(0.0, 3.0), self.within(-3.0, 0.0), self.within(0.0, 3.0))
                .prop_map(|(x, to_x, y, to_y)| Region { min_m: vec2(x, y), max_m: vec2(to_x, to_y) });
        let count = if matches!(self, Self::Plausible) { (1_u32..5).boxed() } else { any::<u32>().boxed() };
        (count, shape, self.within(0.3, 0.5), option::of(region))
            .prop_map(|(count, shape, gap_m, within)| Generator { count, shape, gap_m, within })
            .boxed()
    }

    fn rule(self, is_start: bool) -> BoxedStrategy<PlacementRule> {
        let heading = if is_start { option::of(self.within(-TAU, TAU)).boxed() } else { Just(None).boxed() };
        prop_oneof![
            3 => self.within(0.2, 0.4).prop_map(|clearance_m| PlacementRule::Random { clearance_m }),
            1 => (self.within(-3.0, -0.5), self.within(0.0, 3.0), self.within(-3.0, -0.5), self.within(0.0, 3.0),
                self.within(0.2, 0.4))
                .prop_map(|(x, to_x, y, to_y, clearance_m)| {
                    PlacementRule::Within { min_m: vec2(x, y), max_m: vec2(to_x, to_y), clearance_m }
                }),
            1 => (self.point(2.0), heading).prop_map(|(position_m, heading_rad)| PlacementRule::Fixed { position_m, heading_rad }),
            1 => vec(self.point(2.0), if matches!(self, Self::Plausible) { 1..5 } else { 0..5 })
                .prop_map(|positions_m| PlacementRule::OneOf { positions_m }),
        ]
        .boxed()
    }

    /// A scenario whose parts are all random.
    pub fn scenario(self) -> BoxedStrategy<Scenario> {
        // Physics tests, which use plausible scenarios, expect the robot to be a disc.
        let is_plausible = matches!(self, Self::Plausible);
        let shape = if is_plausible { Just(None).boxed() } else { option::of(self.shape()).boxed() };
        let robot = (
            self.within(0.05, 0.12),
            shape,
            vec((self.within(-1.0, 1.0), self.within(-3.0, 3.0)), 1..6),
            self.within(0.0, 1.0),
        )
            .prop_map(|(radius_m, shape, motions, actuator_lag_s)| Robot {
                radius_m,
                shape,
                min_turning_radius_m: None,
                motions: motions.into_iter().map(|(v_m_s, w_rad_s)| Motion { v_m_s, w_rad_s }).collect(),
                actuator_lag_s: actuator_lag_s.into(),
                ..Robot::default()
            });
        let lidar = (
            1_usize..64,
            self.within(0.1, TAU),
            self.within(1.0, 5.0),
            self.within(0.0, 0.1),
            self.within(0.0, 0.2),
            0_u32..9,
        )
            .prop_map(
                |(beams, field_of_view_rad, max_range_m, noise_std_m, dropout, latency_steps)| Lidar {
                    beams,
                    field_of_view_rad,
                    max_range_m,
                    noise_std_m: noise_std_m.into(),
                    dropout: dropout.into(),
                    latency_steps: latency_steps.into(),
                },
            );
        let task = (
            self.within(0.15, 0.3),
            self.within(0.13, 0.18),
            1_u32..2_000,
            self.within(0.05, 0.3),
            self.within(0.31, 0.6),
        )
            .prop_map(
                |(
                    goal_radius_m,
                    collision_range_m,
                    max_episode_steps,
                    control_period_s,
                    min_goal_distance_m,
                )| {
                    TaskRules {
                        goal_radius_m,
                        collision_range_m,
                        max_episode_steps,
                        control_period_s,
                        min_goal_distance_m,
                    }
                },
            );
        let benchmark_route = (self.point(2.0), self.within(-TAU, TAU), self.point(2.0))
            .prop_map(|(start_m, heading_rad, goal_m)| BenchmarkRoute { start_m, heading_rad, goal_m });
        let benchmark_route = option::of(benchmark_route);
        let texts =
            ("[ -~é]{1,40}", "[ -~é\n\t]{0,60}").prop_filter("a name", |(name, _)| !name.trim().is_empty());
        let things = (vec(self.wall(), 0..4), vec(self.obstacle(), 0..6), vec(self.generator(), 0..3));
        (
            texts,
            self.enclosure(),
            things,
            (robot, lidar, task),
            self.rule(true),
            self.rule(false),
            benchmark_route,
        )
            .prop_map(
                |(
                    (name, about),
                    enclosure,
                    (walls, obstacles, generators),
                    (robot, lidar, task),
                    starts,
                    goals,
                    benchmark_route,
                )| {
                    Scenario {
                        name,
                        about,
                        enclosure,
                        walls,
                        obstacles,
                        generators,
                        robot,
                        lidar,
                        task,
                        starts,
                        goals,
                        benchmark_route,
                    }
                },
            )
            .boxed()
    }
}

/// A valid scenario: parts that the checks report are removed, moved or reset.
pub fn valid_scenario() -> impl Strategy<Value = Scenario> {
    ValueRange::Plausible.scenario().prop_map(|mut scenario| {
        for attempt in 0..100 {
            let Some(finding) = diagnostics(&scenario).into_iter().next() else { return scenario };
            let index = finding.path.split(['[', ']']).nth(1).and_then(|digits| digits.parse::<usize>().ok());
            let what = finding.path.split(['.', '[']).next().unwrap_or_default();
            match (what, index) {
                ("walls", Some(k)) => drop(scenario.walls.remove(k)),
                ("obstacles", Some(k)) => drop(scenario.obstacles.remove(k)),
                ("generators", Some(k)) => drop(scenario.generators.remove(k)),
                ("generators", None) => scenario.generators.clear(),
                ("robot", _) => scenario.robot = Robot::default(),
                _ if attempt % 8 == 7 => match scenario.walls.pop() {
                    Some(_) => (),
                    None => drop(scenario.obstacles.pop()),
                },
                _ => put_elsewhere(what, &mut scenario, attempt),
            }
        }
        panic!("there is still something wrong: {:?}", diagnostics(&scenario));
    })
}

/// Draws new positions for the part called `what`; a rule without listed positions becomes random. If the part is the task,
/// resets it and the robot.
fn put_elsewhere(what: &str, scenario: &mut Scenario, attempt: u64) {
    let random = PlacementRule::Random { clearance_m: 0.2 };
    let free =
        Scenario { starts: random.clone(), goals: random.clone(), ..without_moving_obstacles(scenario) };
    let Ok(((x, y, _), goal)) = draw_start_and_goal(&free, 0, &mut stream(attempt, "elsewhere", 0)) else {
        return;
    };
    let start = vec2(x, y);
    let elsewhere = |rule: &PlacementRule, position_m| match rule {
        PlacementRule::Fixed { heading_rad, .. } => {
            PlacementRule::Fixed { position_m, heading_rad: *heading_rad }
        }
        PlacementRule::OneOf { .. } => PlacementRule::OneOf { positions_m: vec![position_m] },
        _ => random.clone(),
    };
    match what {
        "starts" => scenario.starts = elsewhere(&scenario.starts, start),
        "goals" => scenario.goals = elsewhere(&scenario.goals, goal),
        "task" => (scenario.task, scenario.robot) = (TaskRules::default(), Robot::default()),
        _ => {
            let route = scenario.benchmark_route.get_or_insert_default();
            (route.start_m, route.goal_m) = (start, goal);
        }
    }
}

/// The scenario without its moving obstacles.
pub fn without_moving_obstacles(scenario: &Scenario) -> Scenario {
    let mut still = scenario.clone();
    still
        .obstacles
        .retain(|o| pose_at(o, 1, 0.1) == pose_at(o, 0, 0.1) && pose_at(o, 77, 0.1) == pose_at(o, 0, 0.1));
    still
}
