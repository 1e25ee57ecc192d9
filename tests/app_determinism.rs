//! The app does not affect what is learned: with pauses, changes of pace, open panels and demos in between, its training is
//! bit-identical to that of a bare loop under `MinimalPlugins`. And training with interventions can be replayed from its
//! journal.
#![cfg(feature = "gui")]

#[path = "support/headless_app.rs"]
mod headless_app;

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use bevy::math::vec2;
use wayfield::agent::ActiveLearner;
use wayfield::app::commands::{Command, FigureFormat, Pace, PolicySource, SaveKind, SessionMode};
use wayfield::app::moves::{Movable, MoveRequest};
use wayfield::app::session::journal::{ReplayResult, verify};
use wayfield::app::session::{StartOptions, TrainingHistory};
use wayfield::app::view_state::Overlays;
use wayfield::learning::Learner;
use wayfield::run::folder::RunConfig;
use wayfield::run::preset::Budget;
use wayfield::run::settings::{Setting, Settings};
use wayfield::run::train::{CHECKPOINT_INTERVAL, Job, train};
use wayfield::run::{shipped, training_setup};
use wayfield::scenario::{Generator, ObstacleMotion, RandomShape, Scenario, pose_at};
use wayfield::sim;
use wayfield::simulation::Extensions;
use wayfield::task::{ArenaState, Clock, CurrentScenario};

use headless_app::HeadlessApp;

const STEPS: u64 = 2_000;

/// The state of training: the learner as a checkpoint stores it (replay buffer, weights, moments, random streams), and
/// every arena.
fn state(world: &mut bevy::prelude::World) -> (Vec<u8>, Vec<ArenaState>) {
    let mut bytes = Vec::new();
    world.resource::<ActiveLearner>().0.save(&mut bytes).expect("written to memory");
    (bytes, sim::snapshot(world))
}

/// Settings under which training also depends on the earlier scans that a robot remembers, and on which of its predictions are
/// dropped.
fn settings() -> Settings {
    let setting = |(path, value): (&str, &str)| Setting { path: path.into(), value: value.into() };
    let observation = "Sectors(count: 12, earlier_steps: 3, predicted_paths: true)";
    Settings([("observation", observation), ("prediction_dropout", "0.5")].map(setting).to_vec())
}

/// The state after the same training in a bare loop.
fn train_headless(seed: u64, steps: u64) -> (Vec<u8>, Vec<ArenaState>) {
    let scenario = Arc::new(shipped::scenario("scenario-2").expect("shipped"));
    let mut preset = shipped::preset("fast").expect("shipped");
    settings().apply_to_preset(&mut preset).expect("valid");
    let inputs = preset.observation.width(scenario.lidar.beams);
    let actions = scenario.robot.motions.len();
    let learner =
        Learner::new(&preset.learning, inputs, actions, preset.arenas, seed).expect("the preset is valid");
    let mut simulation = training_setup::training(&scenario, &preset, seed, learner, &Extensions::default());
    for _ in 0..steps {
        simulation.step().expect("training continues");
    }
    state(simulation.world_mut())
}

/// Saves a policy that can drive in Scenario II. Returns its path.
fn save_policy(folder: &std::path::Path) -> std::path::PathBuf {
    let file = folder.join("other.safetensors");
    let mut app = HeadlessApp::new(options(99));
    app.command(Command::Pause(true));
    app.step_to(5);
    app.command(Command::Save(SaveKind::Policy, file.clone()));
    app.frame(Duration::from_millis(10));
    assert!(file.exists(), "{:?}", app.error_notices());
    file
}

fn options(seed: u64) -> StartOptions {
    let scenario = "scenario-2".into();
    StartOptions { scenario, settings: settings(), seed, pace: Pace::Times(40.0), ..StartOptions::default() }
}

#[test]
fn two_thousand_training_steps_in_the_app_are_bit_identical_to_a_bare_loop() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let policy = save_policy(folder.path());
    let mut app = HeadlessApp::new(options(5));
    // Frames of varying length, with changes of pace, pauses, single steps, overlays and demos in between.
    let all_overlays =
        Overlays { beams: true, path: true, trails: true, potential: true, value: true, q_values: true };
    let mut frame = 0_u64;
    while app.steps() < STEPS - 64 {
        match frame % 40 {
            3 => app.command(Command::SetPace(Pace::Times(100.0))),
            6 => app.command(Command::Pause(true)),
            9 => app.command(Command::Step),
            11 => app.command(Command::SetMode(SessionMode::Test)),
            12 => app.command(Command::Pause(false)),
            15 => app.command(Command::SetMode(SessionMode::Drive)),
            16 => app.command(Command::Steer(0)),
            17 => app.command(Command::Open(policy.clone())),
            18 => app.command(Command::Move(MoveRequest {
                arena: 0,
                object: Movable::Robot,
                to_m: vec2(1.2, 0.1),
            })),
            20 => app.command(Command::SetMode(SessionMode::Train)),
            22 => app.command(Command::SetPace(Pace::Times(7.0))),
            24 => app.view_state().overlays = all_overlays,
            26 => app.view_state().grid = true,
            30 => app.view_state().followed = 7,
            33 => app.view_state().overlays = Overlays::default(),
            _ => {}
        }
        app.frame(Duration::from_millis(5 + frame % 90));
        frame += 1;
    }
    assert!(frame > 40, "every event has happened");
    assert!(app.opened_files().policy.is_some(), "{:?}", app.error_notices());
    app.command(Command::SetMode(SessionMode::Train));
    app.command(Command::Pause(true));
    app.frame(Duration::from_millis(10));
    app.step_to(STEPS);
    let (learned, arenas) = state(app.world());
    let (bare, bare_arenas) = train_headless(5, STEPS);
    assert!(arenas == bare_arenas, "the arenas are bit-identical");
    assert!(learned == bare, "the learners are bit-identical");
}

/// Moves an obstacle a little from its current position.
fn nudge(app: &mut HeadlessApp, index: usize) {
    let world = app.world();
    let scenario = world.resource::<CurrentScenario>().0.clone();
    let clock = world.query::<&Clock>().iter(world).next().expect("there is an arena").0;
    let (x, y, _) = pose_at(&scenario.obstacles[index], clock, scenario.task.control_period_s);
    app.command(Command::Move(MoveRequest {
        arena: 0,
        object: Movable::Obstacle(index),
        to_m: vec2(x + 0.04, y - 0.03),
    }));
}

#[test]
fn training_with_interventions_can_be_replayed() {
    let mut app = HeadlessApp::new(options(6));
    app.command(Command::Pause(true));
    app.step_to(150);
    // Dragged over several positions between two steps: only the last one counts.
    for x_m in [1.3, 1.4, 1.5] {
        app.command(Command::Move(MoveRequest { arena: 0, object: Movable::Goal, to_m: vec2(x_m, 0.0) }));
    }
    app.step_to(180);
    app.command(Command::Move(MoveRequest { arena: 3, object: Movable::Robot, to_m: vec2(-1.4, 0.2) }));
    nudge(&mut app, 1);
    app.step_to(240);
    // Moving an obstacle during a demo also moves it in training.
    app.command(Command::SetMode(SessionMode::Test));
    app.command(Command::Pause(false));
    for _ in 0..10 {
        app.frame(Duration::from_millis(40));
    }
    nudge(&mut app, 2);
    app.command(Command::Pause(true));
    app.command(Command::SetMode(SessionMode::Train));
    app.step_to(400);

    let journal = app.journal().clone();
    assert_eq!((journal.steps, journal.entries.len()), (400, 4));
    let (learned, arenas) = state(app.world());
    let mut replayed = journal.replay(None).expect("the journal is valid");
    let (replayed_learner, replayed_arenas) = state(replayed.world_mut());
    assert!(arenas == replayed_arenas && learned == replayed_learner, "bit-identical");

    let mut untouched = journal.clone();
    untouched.entries.clear();
    let mut other = untouched.replay(None).expect("the journal is valid");
    assert!(state(other.world_mut()).0 != learned, "without the interventions the training differs");
}

#[test]
fn obstacles_dragged_over_several_positions_between_two_steps_can_be_replayed() {
    let mut app = HeadlessApp::new(options(13));
    app.command(Command::Pause(true));
    app.step_to(40);
    // Each move shifts an orbit by an offset, and rounding errors add up.
    for index in 0..4 {
        for _ in 0..3 {
            nudge(&mut app, index);
            app.frame(Duration::from_millis(10));
        }
    }
    let shifts = app.journal().entries.len();
    assert!(shifts > 4, "every position is recorded: {shifts}");
    app.step_to(60);
    // With generated obstacles, each move begins new episodes.
    let mut edited = Scenario::clone(&app.shown().0.scenario);
    edited.obstacles.iter_mut().for_each(|obstacle| obstacle.motion = ObstacleMotion::Static);
    let shape = RandomShape::Circle { radius_m: (0.05, 0.1) };
    edited.generators = vec![Generator { count: 2, shape, gap_m: 0.3, within: None }];
    app.command(Command::ApplyScenario {
        scenario: Arc::new(edited),
        from: "scenario-2".into(),
        restart: false,
    });
    app.frame(Duration::from_millis(10));
    for _ in 0..3 {
        nudge(&mut app, 0);
        app.frame(Duration::from_millis(10));
    }
    assert_eq!(app.error_notices(), Vec::<String>::new());
    app.step_to(80);

    let journal = app.journal().clone();
    assert_eq!(journal.entries.len(), shifts + 4, "another scenario, and three moves");
    let (learned, arenas) = state(app.world());
    let mut replayed = journal.replay(None).expect("the journal is valid");
    let (replayed_learner, replayed_arenas) = state(replayed.world_mut());
    assert!(arenas == replayed_arenas && learned == replayed_learner, "bit-identical");
}

#[test]
fn objects_cannot_be_moved_to_invalid_positions() {
    let mut app = HeadlessApp::new(options(7));
    app.command(Command::Pause(true));
    app.step_to(3);
    let before = state(app.world());
    for request in [
        MoveRequest { arena: 0, object: Movable::Goal, to_m: vec2(9.0, 0.0) },
        MoveRequest { arena: 99, object: Movable::Goal, to_m: vec2(0.0, 0.0) },
        MoveRequest { arena: 0, object: Movable::Robot, to_m: vec2(1.95, 1.95) },
        MoveRequest { arena: 0, object: Movable::Robot, to_m: vec2(f32::NAN, 0.0) },
        MoveRequest { arena: 0, object: Movable::Obstacle(0), to_m: vec2(5.0, 5.0) },
        MoveRequest { arena: 0, object: Movable::Obstacle(99), to_m: vec2(0.0, 0.0) },
        MoveRequest { arena: 99, object: Movable::Obstacle(0), to_m: vec2(0.6, 0.6) },
    ] {
        app.command(Command::Move(request));
        app.frame(Duration::from_millis(10));
    }
    assert_eq!(app.journal().entries, []);
    assert!(state(app.world()) == before, "nothing has changed");
}

#[test]
fn an_obstacle_dragged_in_one_arena_of_a_demo_goes_where_the_user_drops_it() {
    // One of two arenas has finished: its clock has stopped, while obstacles revolve in the other.
    let mut app = HeadlessApp::new(options(12));
    app.command(Command::SetMode(SessionMode::Drive));
    for motion in [0, 4].into_iter().cycle().take(4_000) {
        app.command(Command::Steer(motion));
        app.frame(Duration::from_millis(200));
        let (scene, _) = app.shown();
        if scene.arenas[0].inactive != scene.arenas[1].inactive {
            break;
        }
    }
    let (scene, _) = app.shown();
    let running = scene.arenas.iter().position(|arena| !arena.inactive).expect("one arena still runs");
    let finished = scene.arenas.iter().position(|arena| arena.inactive).expect("one arena has finished");
    let still = scene.arenas[finished].obstacles.clone();
    app.frame(Duration::from_millis(70));
    assert_eq!(
        app.shown().0.arenas[finished].obstacles,
        still,
        "nothing in it moves between two steps either"
    );
    app.command(Command::Pause(true));
    for _ in 0..3 {
        app.command(Command::Step);
        app.frame(Duration::from_millis(10));
    }
    let (x, y, _) = app.shown().0.arenas[running].obstacles[3];
    let to_m = vec2(x + 0.03, y + 0.02);
    app.command(Command::Move(MoveRequest { arena: running, object: Movable::Obstacle(3), to_m }));
    app.frame(Duration::from_millis(10));
    let (now_x, now_y, _) = app.shown().0.arenas[running].obstacles[3];
    assert!(
        (now_x - to_m.x).abs() < 1e-4 && (now_y - to_m.y).abs() < 1e-4,
        "{now_x} {now_y} is not {to_m:?}"
    );
}

#[test]
fn a_saved_run_continues_as_if_it_had_not_been_saved() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let run = folder.path().join("run");
    let mut app = HeadlessApp::new(options(8));
    app.command(Command::Pause(true));
    app.step_to(500);
    app.command(Command::Save(SaveKind::Run, run.clone()));
    app.frame(Duration::from_millis(10));
    assert_eq!(app.error_notices(), Vec::<String>::new());
    app.step_to(700);
    let uninterrupted = state(app.world());

    let mut other = HeadlessApp::new(options(1));
    other.command(Command::Pause(true));
    other.command(Command::Open(run));
    other.frame(Duration::from_millis(10));
    assert_eq!(other.error_notices(), Vec::<String>::new());
    other.step_to(700);
    assert!(state(other.world()) == uninterrupted, "500 steps, saved, opened, 200 more: the same as 700");
    assert_eq!(other.run().config.seed, 8);
}

#[test]
fn the_evaluation_after_the_last_step_of_a_finished_run_is_left_out_when_the_run_is_continued() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let (finished, continued) = (folder.path().join("finished"), folder.path().join("continued"));
    let mut config = RunConfig::resolve("scenario-1", "fast", 3).expect("shipped");
    config.preset.budget = Budget::EnvSteps(160);
    config.preset.evaluation.episodes = 1;
    config.preset.evaluation.final_episodes = 0;
    let job = Job::New { config: Box::new(config), policy: None, out: Some(finished.clone()) };
    let stop = AtomicBool::new(false);
    train(job, CHECKPOINT_INTERVAL, &stop, std::time::Instant::now(), Some(Box::new(|_| {})))
        .expect("training ends");
    let evaluations = |run: &Path| {
        let rows = std::fs::read_to_string(run.join("evaluations.csv")).expect("the file exists");
        rows.lines().skip(1).count()
    };
    assert_eq!(evaluations(&finished), 2, "before the first step and after the last");

    let mut app = HeadlessApp::new(options(1));
    app.command(Command::Pause(true));
    app.command(Command::Open(finished));
    app.command(Command::Save(SaveKind::Run, continued.clone()));
    app.frame(Duration::from_millis(10));
    assert_eq!(app.error_notices(), Vec::<String>::new());
    assert_eq!(evaluations(&continued), 1, "as after --resume");
}

#[test]
fn a_saved_run_can_be_replayed_even_if_it_was_reopened_in_between() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let (first_run, second_run) = (folder.path().join("first"), folder.path().join("second"));
    let mut app = HeadlessApp::new(options(9));
    app.command(Command::Pause(true));
    app.step_to(120);
    app.command(Command::Move(MoveRequest { arena: 2, object: Movable::Goal, to_m: vec2(1.5, 0.1) }));
    app.step_to(200);
    app.command(Command::Save(SaveKind::Run, first_run.clone()));
    app.frame(Duration::from_millis(10));
    assert_eq!(app.error_notices(), Vec::<String>::new());
    assert_eq!(verify(&first_run), Ok(ReplayResult { steps: 200, interventions: 1, bit_identical: true }));

    let mut other = HeadlessApp::new(options(1));
    other.command(Command::Pause(true));
    other.command(Command::Open(first_run.clone()));
    other.frame(Duration::from_millis(10));
    nudge(&mut other, 0);
    other.step_to(260);
    other.command(Command::Save(SaveKind::Run, second_run.clone()));
    other.frame(Duration::from_millis(10));
    assert_eq!(other.error_notices(), Vec::<String>::new());
    assert_eq!(verify(&second_run), Ok(ReplayResult { steps: 260, interventions: 2, bit_identical: true }));

    // The curves of the reopened run have the mark of the scenario change, on the screen and in a figure.
    let mut third = HeadlessApp::new(options(1));
    third.command(Command::Pause(true));
    third.command(Command::Open(second_run.clone()));
    let figure = folder.path().join("curves.svg");
    third.command(Command::Save(SaveKind::Figure(FigureFormat::Svg), figure.clone()));
    third.frame(Duration::from_millis(10));
    assert_eq!(third.error_notices(), Vec::<String>::new());
    let marks = |app: &mut HeadlessApp| app.world().resource::<TrainingHistory>().0.annotations().to_vec();
    assert_eq!(marks(&mut third), marks(&mut other));
    assert_eq!(marks(&mut third).iter().map(|mark| mark.env_steps).collect::<Vec<_>>(), [200 * 16]);
    let text = std::fs::read_to_string(&figure).expect("the figure was saved");
    assert!(text.contains("scenario changed") && !text.contains("paper"), "{text}");

    // Continued without a window: the journal ends before the run does, and the whole run is replayed.
    let job = Job::Resume {
        folder: second_run.clone(),
        budget: Some(Budget::EnvSteps(300 * 16)),
        extensions: Extensions::default(),
    };
    let stop = AtomicBool::new(false);
    train(job, CHECKPOINT_INTERVAL, &stop, std::time::Instant::now(), Some(Box::new(|_| {})))
        .expect("training continues");
    assert_eq!(verify(&second_run), Ok(ReplayResult { steps: 300, interventions: 2, bit_identical: true }));

    // A modified journal is detected.
    let journal = second_run.join("journal.ron");
    let text = std::fs::read_to_string(&journal).expect("the file exists");
    std::fs::write(&journal, text.replace("after_steps: 120", "after_steps: 121"))
        .expect("the file can be written");
    assert_eq!(verify(&second_run).map(|replayed| replayed.bit_identical), Ok(false));

    // The journal of a run with another seed is refused.
    let other_seed = text.replacen("seed: 9,", "seed: 8,", 1);
    assert_ne!(other_seed, text);
    std::fs::write(&journal, other_seed).expect("the file can be written");
    let why = verify(&second_run).expect_err("another run");
    assert!(why.to_string().contains("journal.ron: its seed or number of arenas"), "{why:?}");
}

fn transfer(policy: PolicySource, seed: u64) -> Command {
    Command::Transfer { policy, scenario: "scenario-2".into(), preset: "fast".into(), seed, epsilon: 0.5 }
}

#[test]
fn transfer_keeps_the_weights_and_can_be_replayed() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let run = folder.path().join("run");
    let mut app = HeadlessApp::new(StartOptions { scenario: "scenario-1".into(), ..options(10) });
    app.command(Command::Pause(true));
    app.step_to(150);
    let weights =
        |app: &mut HeadlessApp| app.world().resource::<ActiveLearner>().0.network().parameters().to_vec();
    let before = weights(&mut app);
    let earlier = app.world().resource::<TrainingHistory>().0.to_earlier();
    assert!(!earlier.return_mean.points().is_empty());
    app.command(transfer(PolicySource::Current, 42));
    app.command(Command::Pause(true));
    app.frame(Duration::from_millis(10));
    assert_eq!(app.error_notices(), Vec::<String>::new());
    assert!(weights(&mut app) == before, "the weights are kept");
    let epsilon = app.world().resource::<ActiveLearner>().0.epsilon();
    assert!((epsilon - 0.5).abs() < 1e-6, "exploration starts at 0.5: {epsilon}");
    assert_eq!((app.run().config.scenario.name.as_str(), app.steps()), ("Scenario II", 0));
    assert_eq!(app.run().config.seed, 42, "the chosen seed");
    assert_eq!(app.shown().1.transfer_from.as_deref(), Some("Scenario I, 2,400 steps, seed 10"));
    assert_eq!(app.world().resource::<TrainingHistory>().0.earlier(), Some(&earlier), "the curves stay");
    app.step_to(90);
    app.command(Command::Save(SaveKind::Run, run.clone()));
    app.frame(Duration::from_millis(10));
    assert_eq!(app.error_notices(), Vec::<String>::new());
    assert_eq!(verify(&run), Ok(ReplayResult { steps: 90, interventions: 0, bit_identical: true }));
}

#[test]
fn a_file_that_cannot_be_opened_is_reported_and_training_continues() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut app = HeadlessApp::new(options(11));
    app.command(Command::Pause(true));
    app.step_to(20);
    let before = state(app.world());
    for (name, content, expected) in [
        ("world.ron", "(name: \"A\", radius_cm: 1)", "world.ron:1:13"),
        ("policy.safetensors", "nonsense", "not a safetensors file"),
        ("notes.txt", "", "notes.txt: cannot be opened"),
        ("what.bin", "", "what.bin: not part of a run"),
    ] {
        let file = folder.path().join(name);
        std::fs::write(&file, content).expect("the file can be written");
        app.command(Command::Open(file));
        app.frame(Duration::from_millis(10));
        let error_notices = app.error_notices();
        assert!(error_notices.iter().any(|error| error.contains(expected)), "{error_notices:?}");
    }
    app.command(Command::Open(folder.path().to_path_buf()));
    app.command(Command::Open(folder.path().join("missing.ron")));
    app.command(Command::SetMode(SessionMode::Compare));
    app.command(Command::Save(SaveKind::Policy, folder.path().join("nowhere/policy.safetensors")));
    app.frame(Duration::from_millis(10));
    assert_eq!(app.error_notices().len(), 4, "at most four notices: {:?}", app.error_notices());
    assert!(state(app.world()) == before, "the training is unchanged");
    app.step_to(30);
}
