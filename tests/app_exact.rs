//! The window changes nothing of what is learnt: the studio's plugins, with pauses, changes of pace, panels open and
//! other things driven in between, learn the same bits as a bare loop under MinimalPlugins. And what the hand does can be
//! had again.
#![cfg(feature = "window")]

#[path = "support/studio.rs"]
mod studio;

use std::sync::Arc;
use std::time::Duration;

use wayfield::agent::Trainer;
use wayfield::app::desk::Overlays;
use wayfield::app::orders::{Mode, Moved, Order, Pace};
use wayfield::app::session::{First, Session};
use wayfield::learning::Learner;
use wayfield::run::{shipped, simulation};
use wayfield::scenario::pose_at;
use wayfield::task::{ArenaState, Clock, CurrentScenario, observation};
use wayfield::world;

use studio::Studio;

const STEPS: u64 = 2_000;

/// All that a checkpoint would hold of a world: replay buffer, weights, moments, streams; and every arena.
fn state(world: &mut bevy::prelude::World) -> (Vec<u8>, Vec<ArenaState>) {
    let mut bytes = Vec::new();
    world.resource::<Trainer>().0.save(&mut bytes).expect("a vector can be written to");
    (bytes, world::snapshot(world))
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

fn first(seed: u64) -> First {
    First { scenario: "scenario-2".into(), seed, pace: Pace::Times(40.0), ..First::default() }
}

#[test]
fn two_thousand_steps_in_the_window_learn_what_a_bare_loop_learns() {
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
    studio.order(Order::Move(Moved::Obstacle { index, to_m: (x + 0.04, y - 0.03) }));
}

#[test]
fn what_the_hand_does_can_be_had_again() {
    let mut studio = Studio::new(first(6));
    studio.order(Order::Pause(true));
    studio.step_to(150);
    studio.order(Order::Move(Moved::Target { arena: 0, to_m: (1.5, 0.0) }));
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
        Moved::Obstacle { index: 0, to_m: (5.0, 5.0) },
        Moved::Obstacle { index: 99, to_m: (0.0, 0.0) },
    ] {
        studio.order(Order::Move(nowhere));
        studio.frame(Duration::from_millis(10));
    }
    assert_eq!(studio.session().journal.entries, []);
    assert!(state(studio.world()) == before, "nothing has changed");
}

#[test]
fn a_saved_run_goes_on_as_if_it_had_not_been_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    let mut studio = Studio::new(first(8));
    studio.order(Order::Pause(true));
    studio.step_to(500);
    studio.order(Order::Save(wayfield::app::orders::Saved::Run, run.clone()));
    studio.frame(Duration::from_millis(10));
    assert_eq!(studio.complaints(), Vec::<String>::new());
    studio.step_to(700);
    let whole = state(studio.world());

    let mut other = Studio::new(first(1));
    other.order(Order::Pause(true));
    other.order(Order::Open(run));
    other.frame(Duration::from_millis(10));
    assert_eq!(other.complaints(), Vec::<String>::new());
    other.step_to(200);
    assert!(state(other.world()) == whole, "500 steps, saved, opened, 200 more: the same as 700");
    let session: &Session = other.session();
    assert_eq!(session.config.seed, 8);
}
