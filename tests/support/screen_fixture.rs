//! A made-up training run to draw, without a session, a `World` or a learner behind it.
//!
//! In: nothing. Out: a plausible [`ScreenFixture`], always the same.
#![allow(dead_code, reason = "no test needs all of it")]

use std::sync::Arc;

use bevy::math::{Vec2, vec2};
use wayfield::app::app_status::{AppStatus, BestSoFar, Choice, ExpertChoice, Notice, Severity};
use wayfield::app::commands::{Command, Pace, PolicySource, SessionMode};
use wayfield::app::history::History;
use wayfield::app::scene::{ArenaScene, DriverLabel, ScalarField, Scene, Score, Trail, TrailEnd};
use wayfield::app::screen::{self, ScreenInput, theme};
use wayfield::app::view_state::ViewState;
use wayfield::run::metric_rows::{EpisodeRow, EvaluationRow};
use wayfield::scenario::{
    BenchmarkRoute, Enclosure, Generator, Lidar, Obstacle, ObstacleMotion, PlacementRule, RandomShape,
    Region, Scenario, SetFit, Shape, Wall,
};
use wayfield::task::{Goal, Pose};

const RING_M: [Vec2; 4] = [vec2(0.6, 0.6), vec2(-0.6, 0.6), vec2(-0.6, -0.6), vec2(0.6, -0.6)];
const RADIUS_M: f32 = 0.15;

/// Input and output of the screen.
pub struct ScreenFixture {
    /// The scene.
    pub scene: Scene,
    /// The state of the session.
    pub status: AppStatus,
    /// The learning curves.
    pub history: History,
    /// What the user has chosen to see.
    pub view_state: ViewState,
    /// Commands sent by the screen.
    pub commands: Vec<Command>,
    has_theme: bool,
}

impl Default for ScreenFixture {
    fn default() -> Self {
        let shape = Shape::Circle { radius_m: RADIUS_M };
        let obstacle = |position_m| Obstacle {
            shape: shape.clone(),
            position_m,
            rotation_rad: 0.0,
            motion: ObstacleMotion::Static,
        };
        let obstacles = RING_M.map(obstacle).into();
        let benchmark_route = Some(BenchmarkRoute::default());
        let scenario =
            Scenario { name: "Scenario I".into(), obstacles, benchmark_route, ..Scenario::default() };
        let scenario = Arc::new(scenario);
        let scene = Scene {
            arenas: (0..8).map(|n| arena(n, &scenario)).collect(),
            scenario,
            potential: None,
            value: None,
        };
        Self {
            scene,
            status: status(),
            history: history(),
            view_state: ViewState::default(),
            commands: Vec::new(),
            has_theme: false,
        }
    }
}

impl ScreenFixture {
    /// A training run before its first step.
    pub fn untrained() -> Self {
        let mut screen_fixture = Self { history: History::new(), ..Self::default() };
        let s = &mut screen_fixture.status;
        (s.paused, s.episodes, s.env_steps, s.gradient_steps, s.epsilon) = (true, 0, 0, 0, 1.0);
        (s.success_rate, s.best, s.simulated_s) = (None, None, 0.0);
        for arena in &mut screen_fixture.scene.arenas {
            arena.score = Score::default();
            (arena.path_m, arena.trails, arena.q_values) = (Vec::new(), Vec::new(), Vec::new());
        }
        screen_fixture
    }

    /// The training run in another scenario, each arena with its own generated obstacles. All beams have the same
    /// range, whatever is in their way.
    pub fn with_scenario(mut self, scenario: Scenario) -> Self {
        for (layout_seed, arena) in (0..).zip(&mut self.scene.arenas) {
            let layout = scenario.with_generated_obstacles(layout_seed);
            let at = |o: &Obstacle| (o.position_m.x, o.position_m.y, o.rotation_rad);
            arena.obstacles = layout.obstacles.iter().map(at).collect();
            arena.ranges_m = vec![0.4 * scenario.lidar.max_range_m; scenario.lidar.beams];
            arena.scenario = Arc::new(layout);
            arena.written = Arc::new(scenario.clone());
        }
        self.scene.scenario = Arc::new(scenario);
        self
    }

    /// A test of the current policy in one arena.
    pub fn with_single_policy(mut self) -> Self {
        self.scene.arenas.truncate(1);
        self.scene.arenas[0].driver =
            DriverLabel::Policy { name: "Current policy".into(), origin: "after 312,480 env steps".into() };
        self.status.mode = SessionMode::Test;
        self
    }

    /// With two notices: a confirmation, and an error of several lines.
    pub fn with_notices(mut self) -> Self {
        let failed = "scenarios/mine.ron:7:5: unknown field `radius`, expected `radius_m`\n\
                      scenarios/mine.ron:12:9: the robot's start (0.6, 0.6) is inside obstacle 1; \
                      move it at least 0.25 m away";
        for (severity, text) in
            [(Severity::Info, "Saved as /home/me/runs/fast.safetensors"), (Severity::Error, failed)]
        {
            self.status.notices.push(Notice { severity, text: text.into() });
        }
        self
    }

    /// Draws one frame of the window, as the app does.
    pub fn draw(&mut self, ui: &mut egui::Ui) {
        if !self.has_theme {
            theme::install(ui.ctx());
            self.has_theme = true;
            // The font is available from the next frame on.
            ui.ctx().request_repaint();
            return;
        }
        let view = ScreenInput { scene: &self.scene, status: &self.status, history: &self.history };
        let whole =
            egui::UiBuilder::new().layer_id(egui::LayerId::background()).max_rect(ui.ctx().content_rect());
        let mut ui = egui::Ui::new(ui.ctx().clone(), egui::Id::new("window"), whole);
        screen::screen_ui(&mut ui, &view, &mut self.view_state, &mut self.commands);
    }
}

/// A scenario with most features of the file format: an L-shaped enclosure, inner walls, every shape, most motions, a
/// generator, a narrow field of view.
pub fn mixed_scenario() -> Scenario {
    let obstacle =
        |shape, position_m, rotation_rad, motion| Obstacle { shape, position_m, rotation_rad, motion };
    let still = ObstacleMotion::Static;
    let disc = |radius_m| Shape::Circle { radius_m };
    let corners_m = vec![vec2(0.25, 0.0), vec2(-0.15, 0.2), vec2(-0.2, -0.25)];
    Scenario {
        name: "All sorts".into(),
        enclosure: Enclosure::Polygon {
            corners_m: vec![
                vec2(-2.0, -1.5),
                vec2(4.0, -1.5),
                vec2(4.0, 0.5),
                vec2(1.5, 0.5),
                vec2(1.5, 2.5),
                vec2(-2.0, 2.5),
            ],
        },
        walls: vec![
            Wall {
                corners_m: vec![vec2(-0.4, -1.5), vec2(-0.4, -0.6), vec2(0.5, -0.6)],
                thickness_m: 0.1,
                ..Wall::default()
            },
            Wall { corners_m: vec![vec2(-2.0, 1.3), vec2(-1.2, 1.0)], thickness_m: 0.2, ..Wall::default() },
        ],
        obstacles: vec![
            obstacle(disc(0.15), vec2(-1.4, 0.2), 0.0, still.clone()),
            obstacle(Shape::Rectangle { width_m: 0.6, height_m: 0.3 }, vec2(0.9, 1.9), 0.5, still.clone()),
            obstacle(Shape::Polygon { corners_m }, vec2(-0.6, 1.9), 0.4, still.clone()),
            obstacle(Shape::Capsule { length_m: 0.5, radius_m: 0.12 }, vec2(3.4, -0.1), 1.1, still),
            obstacle(
                disc(0.12),
                vec2(1.0, -1.2),
                0.0,
                ObstacleMotion::Patrol {
                    waypoints_m: vec![vec2(2.6, -1.2), vec2(2.6, -0.5)],
                    speed_m_s: 0.3.into(),
                },
            ),
            obstacle(
                disc(0.1),
                vec2(-1.7, -1.2),
                0.0,
                ObstacleMotion::BackAndForth { waypoints_m: vec![vec2(-1.7, -0.3)], speed_m_s: 0.2.into() },
            ),
            obstacle(
                Shape::Rectangle { width_m: 0.3, height_m: 0.12 },
                vec2(0.8, 0.9),
                0.0,
                ObstacleMotion::Orbit { centre_m: vec2(0.3, 0.9), speed_rad_s: 0.3.into() },
            ),
            obstacle(
                disc(0.12),
                vec2(3.2, -1.0),
                0.0,
                ObstacleMotion::RandomWalk { radius_m: 0.3, speed_m_s: 0.3.into(), seed: 1 },
            ),
        ],
        generators: vec![Generator {
            count: 3,
            shape: RandomShape::Circle { radius_m: (0.05, 0.1) },
            gap_m: 0.3,
            within: Some(Region { min_m: vec2(1.2, -0.4), max_m: vec2(2.8, 0.4) }),
        }],
        lidar: Lidar { beams: 12, field_of_view_rad: 2.0, ..Lidar::default() },
        starts: PlacementRule::Within { min_m: vec2(-1.9, -0.2), max_m: vec2(-0.9, 0.6), clearance_m: 0.2 },
        goals: PlacementRule::OneOf { positions_m: vec![vec2(0.0, 0.2), vec2(3.7, -1.2), vec2(1.2, 1.2)] },
        benchmark_route: Some(BenchmarkRoute {
            start_m: vec2(-1.5, 1.9),
            heading_rad: -0.8,
            goal_m: vec2(3.0, 0.2),
        }),
        ..Scenario::default()
    }
}

/// A scalar field with a basin and ridges, for the overlays.
pub fn field(version: u64, depth: f32) -> Arc<ScalarField> {
    let size = [40, 40];
    let at = |k: usize| (k as f32 + 0.5) / 10.0 - 2.0;
    let value = |Vec2 { x, y }: Vec2| {
        let near = RING_M.iter().map(|&Vec2 { x: a, y: b }| (x - a).hypot(y - b)).fold(f32::MAX, f32::min);
        if near < RADIUS_M + 0.1 { f32::NAN } else { depth * (x - 1.2).hypot(y - 1.2) - depth * 0.2 / near }
    };
    let values = (0..1600).map(|k| value(vec2(at(k % 40), at(k / 40)))).collect();
    Arc::new(ScalarField { size, min_m: [-2.0, -2.0], max_m: [2.0, 2.0], values, version })
}

fn arena(n: usize, layout: &Arc<Scenario>) -> ArenaScene {
    let turn = n as f32 * 0.8;
    let pose = Pose { x_m: -0.1 + 0.9 * turn.sin(), y_m: -1.1 * turn.cos() + 0.1, heading_rad: 0.9 + turn };
    let path_m = (0..40).map(|k| behind(pose, 0.03 * (39 - k) as f32)).collect();
    let trail = |(k, end)| Trail {
        points_m: (0..60)
            .map(|i| behind(Pose { heading_rad: pose.heading_rad + 1.1 * k as f32, ..pose }, 0.03 * i as f32))
            .collect(),
        end,
    };
    let ends = [TrailEnd::Reached, TrailEnd::Collided, TrailEnd::Reached, TrailEnd::TimedOut];
    ArenaScene {
        scenario: layout.clone(),
        written: layout.clone(),
        set_member: None,
        pose,
        goal: Goal { x_m: 1.2 * (turn + 0.8).cos(), y_m: 1.2 * (turn + 0.8).sin() },
        obstacles: RING_M.iter().map(|&Vec2 { x, y }| (x, y, 0.0)).collect(),
        ranges_m: (0..24).map(|k| range_m(pose, k as f32 / 24.0 * std::f32::consts::TAU)).collect(),
        scan_pose: pose,
        driver: DriverLabel::Learner,
        motions: layout.robot.motions.clone(),
        action: n % 5,
        explored: n == 3,
        q_values: vec![31.0, 44.5, 52.0, 38.0, 12.5],
        plan: None,
        path_m,
        trails: ends.into_iter().enumerate().map(trail).collect(),
        score: Score { reached: 96, collided: 41, timed_out: 3, reached_time_s: 842.0 },
        inactive: false,
    }
}

/// The point at `distance_m` behind `pose`, on a gentle curve.
fn behind(pose: Pose, distance_m: f32) -> [f32; 2] {
    let heading = pose.heading_rad - 0.5 * distance_m;
    [
        (pose.x_m - distance_m * heading.cos()).clamp(-1.9, 1.9),
        (pose.y_m - distance_m * heading.sin()).clamp(-1.9, 1.9),
    ]
}

/// Range in m of the beam at `angle` (rad) from the heading, in the square enclosure with four cylinders.
fn range_m(pose: Pose, angle: f32) -> f32 {
    let (dy, dx) = (pose.heading_rad + angle).sin_cos();
    let wall = |at: f32, d: f32| if d == 0.0 { f32::MAX } else { (2.0 * d.signum() - at) / d };
    let hit = |&Vec2 { x, y }: &Vec2| {
        let (x, y) = (x - pose.x_m, y - pose.y_m);
        let (along, aside) = (x * dx + y * dy, x * dy - y * dx);
        let under = RADIUS_M * RADIUS_M - aside * aside;
        if along > 0.0 && under > 0.0 { along - under.sqrt() } else { f32::MAX }
    };
    RING_M.iter().map(hit).fold(wall(pose.x_m, dx).min(wall(pose.y_m, dy)).min(3.5), f32::min)
}

fn status() -> AppStatus {
    let choice = |from: &str, title: &str, about: &str| Choice {
        from: from.into(),
        title: title.into(),
        about: about.into(),
    };
    AppStatus {
        paused: false,
        pace: Pace::Times(20.0),
        mode: SessionMode::Train,
        scenario_from: "scenario-1".into(),
        is_set: false,
        needs: SetFit { lidar: true, motions: true },
        preset_from: "fast".into(),
        scenario_modified: false,
        is_paper_scenario_1: true,
        scenarios: vec![
            choice("empty", "Empty", "Four walls and nothing in between."),
            choice("scenario-1", "Scenario I", "Four cylinders stand still."),
            choice("scenario-2", "Scenario II", "The four cylinders of Scenario I revolve about the centre."),
        ],
        presets: vec![
            choice(
                "fast",
                "Fast",
                "The skill in seconds: PER-D3QN in 16 arenas at once, with Adam and 2-step returns.",
            ),
            choice("dqn", "DQN", "Table 1 of the paper; single, without dueling, uniform replay."),
        ],
        seed: 7,
        transfer_from: None,
        episodes: 1_284,
        env_steps: 312_480,
        gradient_steps: 39_060,
        budget_env_steps: Some(400_000),
        epsilon: 0.12,
        success_rate: Some(0.946_5),
        best: Some(BestSoFar { success_rate: 0.946_5, env_steps: 311_040 }),
        env_steps_per_s: 1_600.0,
        real_time_factor: 20.0,
        simulated_s: 7_812.0,
        frames_per_s: 60.0,
        opened_policy: None,
        opened_driver: None,
        notices: Vec::new(),
        restart_loses_training: false,
        last_session: None,
        unsaved_edits: None,
        quit_question: false,
        expert: Some(ExpertChoice { name: "Scenario I expert".into(), is_new_here: false }),
        tested: PolicySource::Current,
        has_disk: true,
        saved_scenario: None,
    }
}

fn history() -> History {
    let mut history = History::new();
    for n in 1..=1284_u64 {
        let learned = 1.0 - (-(n as f64) / 300.0).exp();
        // Scattered, but deterministic.
        let chance = (n * 7_919 % 101) as f64 / 101.0;
        let goals = (6.0 * learned * chance) as u32;
        history.push_episode(&EpisodeRow {
            episode: n,
            arena: (n % 8) as usize,
            env_steps: n * 243,
            gradient_steps: n * 30,
            steps: 243,
            total_return: -180.0 + 900.0 * learned * chance,
            scenario: None,
            reward_goal: 250.0 * goals as f32,
            reward_collision: -200.0,
            extra_rewards: Vec::new(),
            reward_attraction: 80.0 * learned as f32,
            reward_repulsion: -30.0,
            goals,
            collision: 1,
            epsilon: (1.0 - n as f32 / 1400.0).max(0.05),
            loss: Some(0.4 / (1.0 + n as f64 / 200.0) + 0.02 * chance),
            td_error: Some(0.3 / (1.0 + n as f64 / 300.0)),
            mean_q: Some(60.0 * learned),
            wall_s: 0.0,
        });
        if n % 80 == 0 {
            history.push_evaluation(&EvaluationRow {
                env_steps: n * 243,
                episodes: n,
                success_rate: (learned * 0.96).min(0.96),
                ..EvaluationRow::default()
            });
        }
    }
    history
}
