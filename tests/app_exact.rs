//! The window changes nothing of what is learnt: the studio's plugins, with pauses, changes of pace, panels open and
//! other things driven in between, learn the same bits as a bare loop under MinimalPlugins. And what the hand does can be
//! had again.
#![cfg(feature = "window")]

#[path = "support/studio.rs"]
mod studio;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use wayfield::agent::Trainer;
use wayfield::app::desk::Overlays;
use wayfield::app::orders::{Mode, Moved, Order, Pace, Saved};
use wayfield::app::session::journal::{Replayed, verify};
use wayfield::app::session::{First, Session};
use wayfield::learning::Learner;
use wayfield::run::preset::Budget;
use wayfield::run::train::{CHECKPOINT_EVERY, Job, train};
use wayfield::run::{shipped, simulation};
use wayfield::scenario::pose_at;
use wayfield::sim;
use wayfield::task::{ArenaState, Clock, CurrentScenario, observation};

use studio::Studio;

const STEPS: u64 = 2_000;

/// All that a checkpoint would hold of a world: replay buffer, weights, moments, streams; and every arena.
fn state(world: &mut bevy::prelude::World) -> (Vec<u8>, Vec<ArenaState>) {
    let mut bytes = Vec::new();
    world.resource::<Trainer>().0.save(&mut bytes).expect("a vector can be written to");
    (bytes, sim::snapshot(world))
}

/// The same training in a bare loop.
fn headless(seed: u64, steps: u64) -> (Vec<u8>, Vec<ArenaState>) {
    let scenario = Arc::new(shipped::scenario("scenario-2").expect("it is shipped"));
    let preset = shipped::preset("fast").expect("it is shipped");
    let inputs = observation::width(scenario.lidar.beams);
    let actions = scenario.robot.motions.len();
    let learner = Learner::new(&preset.learning, inputs, actions, preset.arenas, seed).expect("it is sound");
    let mut app = simulation::training(&scenario, &preset, seed, learner);
    for _ in 0..steps {
        simulation::step(app.world_mut()).expect("it goes on");
    }
    state(app.world_mut())
}

/// A policy that can drive in Scenario II.
fn some_policy(folder: &std::path::Path) -> std::path::PathBuf {
    let file = folder.join("other.safetensors");
    let mut studio = Studio::new(first(99));
    studio.order(Order::Pause(true));
    studio.step_to(5);
    studio.order(Order::Save(Saved::Policy, file.clone()));
    studio.frame(Duration::from_millis(10));
    assert!(file.exists(), "{:?}", studio.complaints());
    file
}

fn first(seed: u64) -> First {
    First { scenario: "scenario-2".into(), seed, pace: Pace::Times(40.0), ..First::default() }
}

#[test]
fn two_thousand_steps_in_the_window_learn_what_a_bare_loop_learns() {
    let folder = tempfile::tempdir().expect("a folder");
    let policy = some_policy(folder.path());
    let mut studio = Studio::new(first(5));
    // Frames of changing length, at changing paces, with pauses, single steps, every panel and overlay, and other drivers
    // in between.
    let everything =
        Overlays { beams: true, path: true, trails: true, potential: true, value: true, q_values: true };
    let mut frame = 0_u64;
    while studio.steps() < STEPS - 64 {
        match frame % 40 {
            3 => studio.order(Order::SetPace(Pace::Times(100.0))),
            6 => studio.order(Order::Pause(true)),
            9 => studio.order(Order::Step),
            11 => studio.order(Order::SetMode(Mode::Test)),
            12 => studio.order(Order::Pause(false)),
            15 => studio.order(Order::SetMode(Mode::Drive)),
            16 => studio.order(Order::Steer(0)),
            17 => studio.order(Order::Open(policy.clone())),
            18 => studio.order(Order::Move(Moved::Robot { arena: 0, to_m: (1.2, 0.1) })),
            20 => studio.order(Order::SetMode(Mode::Train)),
            22 => studio.order(Order::SetPace(Pace::Times(7.0))),
            24 => studio.desk().overlays = everything,
            26 => studio.desk().grid = true,
            30 => studio.desk().followed = 7,
            33 => studio.desk().overlays = Overlays::default(),
            _ => {}
        }
        studio.frame(Duration::from_millis(5 + frame % 90));
        frame += 1;
    }
    assert!(frame > 40, "all of it has happened");
    assert!(studio.session().opened.is_some(), "{:?}", studio.complaints());
    studio.order(Order::SetMode(Mode::Train));
    studio.order(Order::Pause(true));
    studio.frame(Duration::from_millis(10));
    studio.step_to(STEPS);
    let (learnt, arenas) = state(studio.world());
    let (bare, bare_arenas) = headless(5, STEPS);
    assert!(arenas == bare_arenas, "the arenas are the same to the bit");
    assert!(learnt == bare, "replay buffer, weights, moments and streams are the same to the bit");
}

/// Moves an obstacle a little from where it is now.
fn nudge(studio: &mut Studio, index: usize) {
    let world = studio.world();
    let scenario = world.resource::<CurrentScenario>().0.clone();
    let clock = world.query::<&Clock>().iter(world).next().expect("an arena").0;
    let (x, y, _) = pose_at(&scenario.obstacles[index], clock, scenario.task.control_period_s);
    studio.order(Order::Move(Moved::Obstacle { arena: 0, index, to_m: (x + 0.04, y - 0.03) }));
}

#[test]
fn what_the_hand_does_can_be_had_again() {
    let mut studio = Studio::new(first(6));
    studio.order(Order::Pause(true));
    studio.step_to(150);
    // Dragged over several places between two steps: the last one counts.
    for x_m in [1.3, 1.4, 1.5] {
        studio.order(Order::Move(Moved::Target { arena: 0, to_m: (x_m, 0.0) }));
    }
    studio.step_to(180);
    studio.order(Order::Move(Moved::Robot { arena: 3, to_m: (-1.4, 0.2) }));
    nudge(&mut studio, 1);
    studio.step_to(240);
    // The world is changed while somebody else drives; the training finds it changed.
    studio.order(Order::SetMode(Mode::Test));
    studio.order(Order::Pause(false));
    for _ in 0..10 {
        studio.frame(Duration::from_millis(40));
    }
    nudge(&mut studio, 2);
    studio.order(Order::Pause(true));
    studio.order(Order::SetMode(Mode::Train));
    studio.step_to(400);

    let journal = studio.session().journal.clone();
    assert_eq!((journal.steps, journal.entries.len()), (400, 4));
    let (learnt, arenas) = state(studio.world());
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
    let mut studio = Studio::new(first(7));
    studio.order(Order::Pause(true));
    studio.step_to(3);
    let before = state(studio.world());
    for nowhere in [
        Moved::Target { arena: 0, to_m: (9.0, 0.0) },
        Moved::Target { arena: 99, to_m: (0.0, 0.0) },
        Moved::Robot { arena: 0, to_m: (1.95, 1.95) },
        Moved::Robot { arena: 0, to_m: (f32::NAN, 0.0) },
        Moved::Obstacle { arena: 0, index: 0, to_m: (5.0, 5.0) },
        Moved::Obstacle { arena: 0, index: 99, to_m: (0.0, 0.0) },
        Moved::Obstacle { arena: 99, index: 0, to_m: (0.6, 0.6) },
    ] {
        studio.order(Order::Move(nowhere));
        studio.frame(Duration::from_millis(10));
    }
    assert_eq!(studio.session().journal.entries, []);
    assert!(state(studio.world()) == before, "nothing has changed");
}

#[test]
fn an_obstacle_goes_where_it_is_dragged_in_the_arena_where_it_is_seen() {
    // Two drivers, of whom one has ended: his arena's clock stands, and the obstacles revolve in the other.
    let mut studio = Studio::new(first(12));
    studio.order(Order::SetMode(Mode::Drive));
    for motion in [0, 4].into_iter().cycle().take(4_000) {
        studio.order(Order::Steer(motion));
        studio.frame(Duration::from_millis(200));
        let (scene, _) = studio.shown();
        if scene.arenas[0].parked != scene.arenas[1].parked {
            break;
        }
    }
    let (scene, _) = studio.shown();
    let running = scene.arenas.iter().position(|arena| !arena.parked).expect("one still drives");
    assert!(scene.arenas.iter().any(|arena| arena.parked), "one has ended");
    studio.order(Order::Pause(true));
    for _ in 0..3 {
        studio.order(Order::Step);
        studio.frame(Duration::from_millis(10));
    }
    let (x, y, _) = studio.shown().0.arenas[running].obstacles[3];
    let to_m = (x + 0.03, y + 0.02);
    studio.order(Order::Move(Moved::Obstacle { arena: running, index: 3, to_m }));
    studio.frame(Duration::from_millis(10));
    let (now_x, now_y, _) = studio.shown().0.arenas[running].obstacles[3];
    assert!(
        (now_x - to_m.0).abs() < 1e-4 && (now_y - to_m.1).abs() < 1e-4,
        "{now_x} {now_y} is not {to_m:?}"
    );
}

#[test]
fn a_saved_run_goes_on_as_if_it_had_not_been_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    let mut studio = Studio::new(first(8));
    studio.order(Order::Pause(true));
    studio.step_to(500);
    studio.order(Order::Save(Saved::Run, run.clone()));
    studio.frame(Duration::from_millis(10));
    assert_eq!(studio.complaints(), Vec::<String>::new());
    studio.step_to(700);
    let whole = state(studio.world());

    let mut other = Studio::new(first(1));
    other.order(Order::Pause(true));
    other.order(Order::Open(run));
    other.frame(Duration::from_millis(10));
    assert_eq!(other.complaints(), Vec::<String>::new());
    other.step_to(700);
    assert!(state(other.world()) == whole, "500 steps, saved, opened, 200 more: the same as 700");
    let session: &Session = other.session();
    assert_eq!(session.config.seed, 8);
}

#[test]
fn a_saved_run_is_replayed_from_its_journal_also_when_it_was_opened_in_between() {
    let folder = tempfile::tempdir().expect("a folder");
    let (first_run, second_run) = (folder.path().join("first"), folder.path().join("second"));
    let mut studio = Studio::new(first(9));
    studio.order(Order::Pause(true));
    studio.step_to(120);
    studio.order(Order::Move(Moved::Target { arena: 2, to_m: (1.5, 0.1) }));
    studio.step_to(200);
    studio.order(Order::Save(Saved::Run, first_run.clone()));
    studio.frame(Duration::from_millis(10));
    assert_eq!(studio.complaints(), Vec::<String>::new());
    assert_eq!(verify(&first_run), Ok(Replayed { steps: 200, deeds: 1, same: true }));

    let mut other = Studio::new(first(1));
    other.order(Order::Pause(true));
    other.order(Order::Open(first_run.clone()));
    other.frame(Duration::from_millis(10));
    nudge(&mut other, 0);
    other.step_to(260);
    other.order(Order::Save(Saved::Run, second_run.clone()));
    other.frame(Duration::from_millis(10));
    assert_eq!(other.complaints(), Vec::<String>::new());
    assert_eq!(verify(&second_run), Ok(Replayed { steps: 260, deeds: 2, same: true }));

    // It goes on without a window: the journal ends earlier than the run, which is replayed all the same.
    let job = Job::Resume { folder: second_run.clone(), budget: Some(Budget::EnvSteps(300 * 16)) };
    let stop = AtomicBool::new(false);
    train(job, CHECKPOINT_EVERY, &stop, std::time::Instant::now(), Some(Box::new(|_| {})))
        .expect("it goes on");
    assert_eq!(verify(&second_run), Ok(Replayed { steps: 300, deeds: 2, same: true }));

    // A journal that says something else is found out.
    let journal = second_run.join("journal.ron");
    let text = std::fs::read_to_string(&journal).expect("it is there");
    std::fs::write(&journal, text.replace("after_steps: 120", "after_steps: 121")).expect("it is written");
    assert_eq!(verify(&second_run).map(|replayed| replayed.same), Ok(false));
}

#[test]
fn transfer_keeps_the_weights_and_can_be_replayed() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    let mut studio = Studio::new(First { scenario: "scenario-1".into(), ..first(10) });
    studio.order(Order::Pause(true));
    studio.step_to(150);
    let weights =
        |studio: &mut Studio| studio.world().resource::<Trainer>().0.network().parameters().to_vec();
    let before = weights(&mut studio);
    studio.order(Order::Transfer { scenario: "scenario-2".into(), epsilon: 0.5 });
    studio.frame(Duration::from_millis(10));
    assert_eq!(studio.complaints(), Vec::<String>::new());
    assert!(weights(&mut studio) == before, "it goes on with what it has learnt");
    let epsilon = studio.world().resource::<Trainer>().0.epsilon();
    assert!((epsilon - 0.5).abs() < 1e-6, "and explores from 0.5: {epsilon}");
    assert_eq!((studio.session().config.scenario.name.as_str(), studio.steps()), ("Scenario II", 0));
    studio.step_to(90);
    studio.order(Order::Save(Saved::Run, run.clone()));
    studio.frame(Duration::from_millis(10));
    assert_eq!(studio.complaints(), Vec::<String>::new());
    assert_eq!(verify(&run), Ok(Replayed { steps: 90, deeds: 0, same: true }));
}

#[test]
fn what_cannot_be_opened_is_told_and_everything_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut studio = Studio::new(first(11));
    studio.order(Order::Pause(true));
    studio.step_to(20);
    let before = state(studio.world());
    for (name, content, told) in [
        ("world.ron", "(name: \"A\", radius_cm: 1)", "world.ron:1:13"),
        ("policy.safetensors", "nonsense", "not a safetensors file"),
        ("notes.txt", "", "neither a policy"),
    ] {
        let file = folder.path().join(name);
        std::fs::write(&file, content).expect("it is written");
        studio.order(Order::Open(file));
        studio.frame(Duration::from_millis(10));
        let complaints = studio.complaints();
        assert!(complaints.iter().any(|complaint| complaint.contains(told)), "{complaints:?}");
    }
    studio.order(Order::Open(folder.path().to_path_buf()));
    studio.order(Order::Open(folder.path().join("missing.ron")));
    studio.order(Order::SetMode(Mode::Compare));
    studio.order(Order::Save(Saved::Policy, folder.path().join("nowhere/policy.safetensors")));
    studio.frame(Duration::from_millis(10));
    assert_eq!(studio.complaints().len(), 4, "no more than four at a time: {:?}", studio.complaints());
    assert!(state(studio.world()) == before, "the training is as it was");
    studio.step_to(30);
}
