//! The window changes nothing of what is learnt: the headless_app's plugins, with pauses, changes of pace, panels open and
//! other things driven in between, learn the same bits as a bare loop under MinimalPlugins. And what the hand does can be
//! had again.
#![cfg(feature = "gui")]

#[path = "support/headless_app.rs"]
mod headless_app;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use bevy::math::vec2;
use wayfield::agent::ActiveLearner;
use wayfield::app::commands::{Command, MoveRequest, Pace, SaveKind, SessionMode};
use wayfield::app::session::journal::{ReplayResult, verify};
use wayfield::app::session::{Session, StartOptions};
use wayfield::app::view_state::Overlays;
use wayfield::learning::Learner;
use wayfield::run::preset::Budget;
use wayfield::run::train::{CHECKPOINT_INTERVAL, Job, train};
use wayfield::run::{shipped, training_setup};
use wayfield::scenario::pose_at;
use wayfield::sim;
use wayfield::simulation::Extensions;
use wayfield::task::{ArenaState, Clock, CurrentScenario, observation};

use headless_app::HeadlessApp;

const STEPS: u64 = 2_000;

/// All that a checkpoint would hold of a world: replay buffer, weights, moments, streams; and every arena.
fn state(world: &mut bevy::prelude::World) -> (Vec<u8>, Vec<ArenaState>) {
    let mut bytes = Vec::new();
    world.resource::<ActiveLearner>().0.save(&mut bytes).expect("a vector can be written to");
    (bytes, sim::snapshot(world))
}

/// The same training in a bare loop.
fn headless(seed: u64, steps: u64) -> (Vec<u8>, Vec<ArenaState>) {
    let scenario = Arc::new(shipped::scenario("scenario-2").expect("it is shipped"));
    let preset = shipped::preset("fast").expect("it is shipped");
    let inputs = observation::width(scenario.lidar.beams);
    let actions = scenario.robot.motions.len();
    let learner = Learner::new(&preset.learning, inputs, actions, preset.arenas, seed).expect("it is sound");
    let mut simulation = training_setup::training(&scenario, &preset, seed, learner, &Extensions::default());
    for _ in 0..steps {
        simulation.step().expect("it goes on");
    }
    state(simulation.world_mut())
}

/// A policy that can drive in Scenario II.
fn some_policy(folder: &std::path::Path) -> std::path::PathBuf {
    let file = folder.join("other.safetensors");
    let mut headless_app = HeadlessApp::new(first(99));
    headless_app.command(Command::Pause(true));
    headless_app.step_to(5);
    headless_app.command(Command::Save(SaveKind::Policy, file.clone()));
    headless_app.frame(Duration::from_millis(10));
    assert!(file.exists(), "{:?}", headless_app.error_notices());
    file
}

fn first(seed: u64) -> StartOptions {
    StartOptions { scenario: "scenario-2".into(), seed, pace: Pace::Times(40.0), ..StartOptions::default() }
}

#[test]
fn two_thousand_steps_in_the_window_learn_what_a_bare_loop_learns() {
    let folder = tempfile::tempdir().expect("a folder");
    let policy = some_policy(folder.path());
    let mut headless_app = HeadlessApp::new(first(5));
    // Frames of changing length, at changing paces, with pauses, single steps, every panel and overlay, and other drivers
    // in between.
    let everything =
        Overlays { beams: true, path: true, trails: true, potential: true, value: true, q_values: true };
    let mut frame = 0_u64;
    while headless_app.steps() < STEPS - 64 {
        match frame % 40 {
            3 => headless_app.command(Command::SetPace(Pace::Times(100.0))),
            6 => headless_app.command(Command::Pause(true)),
            9 => headless_app.command(Command::Step),
            11 => headless_app.command(Command::SetMode(SessionMode::Test)),
            12 => headless_app.command(Command::Pause(false)),
            15 => headless_app.command(Command::SetMode(SessionMode::Drive)),
            16 => headless_app.command(Command::Steer(0)),
            17 => headless_app.command(Command::Open(policy.clone())),
            18 => headless_app.command(Command::Move(MoveRequest::Robot { arena: 0, to_m: vec2(1.2, 0.1) })),
            20 => headless_app.command(Command::SetMode(SessionMode::Train)),
            22 => headless_app.command(Command::SetPace(Pace::Times(7.0))),
            24 => headless_app.view_state().overlays = everything,
            26 => headless_app.view_state().grid = true,
            30 => headless_app.view_state().followed = 7,
            33 => headless_app.view_state().overlays = Overlays::default(),
            _ => {}
        }
        headless_app.frame(Duration::from_millis(5 + frame % 90));
        frame += 1;
    }
    assert!(frame > 40, "all of it has happened");
    assert!(headless_app.session().opened_policy.is_some(), "{:?}", headless_app.error_notices());
    headless_app.command(Command::SetMode(SessionMode::Train));
    headless_app.command(Command::Pause(true));
    headless_app.frame(Duration::from_millis(10));
    headless_app.step_to(STEPS);
    let (learnt, arenas) = state(headless_app.world());
    let (bare, bare_arenas) = headless(5, STEPS);
    assert!(arenas == bare_arenas, "the arenas are the same to the bit");
    assert!(learnt == bare, "replay buffer, weights, moments and streams are the same to the bit");
}

/// Moves an obstacle a little from where it is now.
fn nudge(headless_app: &mut HeadlessApp, index: usize) {
    let world = headless_app.world();
    let scenario = world.resource::<CurrentScenario>().0.clone();
    let clock = world.query::<&Clock>().iter(world).next().expect("an arena").0;
    let (x, y, _) = pose_at(&scenario.obstacles[index], clock, scenario.task.control_period_s);
    headless_app.command(Command::Move(MoveRequest::Obstacle {
        arena: 0,
        index,
        to_m: vec2(x + 0.04, y - 0.03),
    }));
}

#[test]
fn what_the_hand_does_can_be_had_again() {
    let mut headless_app = HeadlessApp::new(first(6));
    headless_app.command(Command::Pause(true));
    headless_app.step_to(150);
    // Dragged over several places between two steps: the last one counts.
    for x_m in [1.3, 1.4, 1.5] {
        headless_app.command(Command::Move(MoveRequest::Goal { arena: 0, to_m: vec2(x_m, 0.0) }));
    }
    headless_app.step_to(180);
    headless_app.command(Command::Move(MoveRequest::Robot { arena: 3, to_m: vec2(-1.4, 0.2) }));
    nudge(&mut headless_app, 1);
    headless_app.step_to(240);
    // The world is changed while somebody else drives; the training finds it changed.
    headless_app.command(Command::SetMode(SessionMode::Test));
    headless_app.command(Command::Pause(false));
    for _ in 0..10 {
        headless_app.frame(Duration::from_millis(40));
    }
    nudge(&mut headless_app, 2);
    headless_app.command(Command::Pause(true));
    headless_app.command(Command::SetMode(SessionMode::Train));
    headless_app.step_to(400);

    let journal = headless_app.session().journal.clone();
    assert_eq!((journal.steps, journal.entries.len()), (400, 4));
    let (learnt, arenas) = state(headless_app.world());
    let mut again = journal.replay(None).expect("it can be had again");
    let (learnt_again, arenas_again) = state(again.world_mut());
    assert!(arenas == arenas_again && learnt == learnt_again, "the same to the bit");

    let mut untouched = journal.clone();
    untouched.entries.clear();
    let mut other = untouched.replay(None).expect("it can be had again");
    assert!(state(other.world_mut()).0 != learnt, "without the hand it is another training");
}

#[test]
fn the_hand_cannot_put_things_where_they_cannot_be() {
    let mut headless_app = HeadlessApp::new(first(7));
    headless_app.command(Command::Pause(true));
    headless_app.step_to(3);
    let before = state(headless_app.world());
    for nowhere in [
        MoveRequest::Goal { arena: 0, to_m: vec2(9.0, 0.0) },
        MoveRequest::Goal { arena: 99, to_m: vec2(0.0, 0.0) },
        MoveRequest::Robot { arena: 0, to_m: vec2(1.95, 1.95) },
        MoveRequest::Robot { arena: 0, to_m: vec2(f32::NAN, 0.0) },
        MoveRequest::Obstacle { arena: 0, index: 0, to_m: vec2(5.0, 5.0) },
        MoveRequest::Obstacle { arena: 0, index: 99, to_m: vec2(0.0, 0.0) },
        MoveRequest::Obstacle { arena: 99, index: 0, to_m: vec2(0.6, 0.6) },
    ] {
        headless_app.command(Command::Move(nowhere));
        headless_app.frame(Duration::from_millis(10));
    }
    assert_eq!(headless_app.session().journal.entries, []);
    assert!(state(headless_app.world()) == before, "nothing has changed");
}

#[test]
fn an_obstacle_goes_where_it_is_dragged_in_the_arena_where_it_is_seen() {
    // Two drivers, of whom one has ended: his arena's clock stands, and the obstacles revolve in the other.
    let mut headless_app = HeadlessApp::new(first(12));
    headless_app.command(Command::SetMode(SessionMode::Drive));
    for motion in [0, 4].into_iter().cycle().take(4_000) {
        headless_app.command(Command::Steer(motion));
        headless_app.frame(Duration::from_millis(200));
        let (scene, _) = headless_app.shown();
        if scene.arenas[0].inactive != scene.arenas[1].inactive {
            break;
        }
    }
    let (scene, _) = headless_app.shown();
    let running = scene.arenas.iter().position(|arena| !arena.inactive).expect("one still drives");
    assert!(scene.arenas.iter().any(|arena| arena.inactive), "one has ended");
    headless_app.command(Command::Pause(true));
    for _ in 0..3 {
        headless_app.command(Command::Step);
        headless_app.frame(Duration::from_millis(10));
    }
    let (x, y, _) = headless_app.shown().0.arenas[running].obstacles[3];
    let to_m = vec2(x + 0.03, y + 0.02);
    headless_app.command(Command::Move(MoveRequest::Obstacle { arena: running, index: 3, to_m }));
    headless_app.frame(Duration::from_millis(10));
    let (now_x, now_y, _) = headless_app.shown().0.arenas[running].obstacles[3];
    assert!(
        (now_x - to_m.x).abs() < 1e-4 && (now_y - to_m.y).abs() < 1e-4,
        "{now_x} {now_y} is not {to_m:?}"
    );
}

#[test]
fn a_saved_run_goes_on_as_if_it_had_not_been_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    let mut headless_app = HeadlessApp::new(first(8));
    headless_app.command(Command::Pause(true));
    headless_app.step_to(500);
    headless_app.command(Command::Save(SaveKind::Run, run.clone()));
    headless_app.frame(Duration::from_millis(10));
    assert_eq!(headless_app.error_notices(), Vec::<String>::new());
    headless_app.step_to(700);
    let whole = state(headless_app.world());

    let mut other = HeadlessApp::new(first(1));
    other.command(Command::Pause(true));
    other.command(Command::Open(run));
    other.frame(Duration::from_millis(10));
    assert_eq!(other.error_notices(), Vec::<String>::new());
    other.step_to(700);
    assert!(state(other.world()) == whole, "500 steps, saved, opened, 200 more: the same as 700");
    let session: &Session = other.session();
    assert_eq!(session.config.seed, 8);
}

#[test]
fn a_saved_run_is_replayed_from_its_journal_also_when_it_was_opened_in_between() {
    let folder = tempfile::tempdir().expect("a folder");
    let (first_run, second_run) = (folder.path().join("first"), folder.path().join("second"));
    let mut headless_app = HeadlessApp::new(first(9));
    headless_app.command(Command::Pause(true));
    headless_app.step_to(120);
    headless_app.command(Command::Move(MoveRequest::Goal { arena: 2, to_m: vec2(1.5, 0.1) }));
    headless_app.step_to(200);
    headless_app.command(Command::Save(SaveKind::Run, first_run.clone()));
    headless_app.frame(Duration::from_millis(10));
    assert_eq!(headless_app.error_notices(), Vec::<String>::new());
    assert_eq!(verify(&first_run), Ok(ReplayResult { steps: 200, interventions: 1, bit_identical: true }));

    let mut other = HeadlessApp::new(first(1));
    other.command(Command::Pause(true));
    other.command(Command::Open(first_run.clone()));
    other.frame(Duration::from_millis(10));
    nudge(&mut other, 0);
    other.step_to(260);
    other.command(Command::Save(SaveKind::Run, second_run.clone()));
    other.frame(Duration::from_millis(10));
    assert_eq!(other.error_notices(), Vec::<String>::new());
    assert_eq!(verify(&second_run), Ok(ReplayResult { steps: 260, interventions: 2, bit_identical: true }));

    // It goes on without a window: the journal ends earlier than the run, which is replayed all the same.
    let job = Job::Resume {
        folder: second_run.clone(),
        budget: Some(Budget::EnvSteps(300 * 16)),
        extensions: Extensions::default(),
    };
    let stop = AtomicBool::new(false);
    train(job, CHECKPOINT_INTERVAL, &stop, std::time::Instant::now(), Some(Box::new(|_| {})))
        .expect("it goes on");
    assert_eq!(verify(&second_run), Ok(ReplayResult { steps: 300, interventions: 2, bit_identical: true }));

    // A journal that says something else is found out.
    let journal = second_run.join("journal.ron");
    let text = std::fs::read_to_string(&journal).expect("it is there");
    std::fs::write(&journal, text.replace("after_steps: 120", "after_steps: 121")).expect("it is written");
    assert_eq!(verify(&second_run).map(|replayed| replayed.bit_identical), Ok(false));
}

#[test]
fn transfer_keeps_the_weights_and_can_be_replayed() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    let mut headless_app = HeadlessApp::new(StartOptions { scenario: "scenario-1".into(), ..first(10) });
    headless_app.command(Command::Pause(true));
    headless_app.step_to(150);
    let weights = |headless_app: &mut HeadlessApp| {
        headless_app.world().resource::<ActiveLearner>().0.network().parameters().to_vec()
    };
    let before = weights(&mut headless_app);
    headless_app.command(Command::Transfer { scenario: "scenario-2".into(), epsilon: 0.5 });
    headless_app.frame(Duration::from_millis(10));
    assert_eq!(headless_app.error_notices(), Vec::<String>::new());
    assert!(weights(&mut headless_app) == before, "it goes on with what it has learnt");
    let epsilon = headless_app.world().resource::<ActiveLearner>().0.epsilon();
    assert!((epsilon - 0.5).abs() < 1e-6, "and explores from 0.5: {epsilon}");
    assert_eq!(
        (headless_app.session().config.scenario.name.as_str(), headless_app.steps()),
        ("Scenario II", 0)
    );
    headless_app.step_to(90);
    headless_app.command(Command::Save(SaveKind::Run, run.clone()));
    headless_app.frame(Duration::from_millis(10));
    assert_eq!(headless_app.error_notices(), Vec::<String>::new());
    assert_eq!(verify(&run), Ok(ReplayResult { steps: 90, interventions: 0, bit_identical: true }));
}

#[test]
fn what_cannot_be_opened_is_told_and_everything_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut headless_app = HeadlessApp::new(first(11));
    headless_app.command(Command::Pause(true));
    headless_app.step_to(20);
    let before = state(headless_app.world());
    for (name, content, told) in [
        ("world.ron", "(name: \"A\", radius_cm: 1)", "world.ron:1:13"),
        ("policy.safetensors", "nonsense", "not a safetensors file"),
        ("notes.txt", "", "neither a policy"),
    ] {
        let file = folder.path().join(name);
        std::fs::write(&file, content).expect("it is written");
        headless_app.command(Command::Open(file));
        headless_app.frame(Duration::from_millis(10));
        let error_notices = headless_app.error_notices();
        assert!(error_notices.iter().any(|complaint| complaint.contains(told)), "{error_notices:?}");
    }
    headless_app.command(Command::Open(folder.path().to_path_buf()));
    headless_app.command(Command::Open(folder.path().join("missing.ron")));
    headless_app.command(Command::SetMode(SessionMode::Compare));
    headless_app.command(Command::Save(SaveKind::Policy, folder.path().join("nowhere/policy.safetensors")));
    headless_app.frame(Duration::from_millis(10));
    assert_eq!(
        headless_app.error_notices().len(),
        4,
        "no more than four at a time: {:?}",
        headless_app.error_notices()
    );
    assert!(state(headless_app.world()) == before, "the training is as it was");
    headless_app.step_to(30);
}
