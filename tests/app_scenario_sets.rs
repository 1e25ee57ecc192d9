//! Sets of scenarios and level generators in the app: training on a set is shown, compared, saved, resumed and replayed like
//! any other training, and each arena shows its scenario.
#![cfg(feature = "gui")]

#[path = "support/headless_app.rs"]
mod headless_app;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use bevy::math::vec2;
use wayfield::app::commands::{Command, Pace, SaveKind, SessionMode};
use wayfield::app::moves::{Movable, MoveRequest};
use wayfield::app::session::journal::verify;
use wayfield::app::session::{StartOptions, TrainingHistory};
use wayfield::scenario::Scenario;

use headless_app::HeadlessApp;

/// Writes a set of two members, a scenario with an obstacle and a generator, with short episodes. Returns its path.
fn write_set(folder: &Path) -> PathBuf {
    let write = |name: &str, text: &str| {
        std::fs::write(folder.join(name), text).expect("a writable folder");
        folder.join(name)
    };
    write(
        "posts.ron",
        "(name: \"Posts\", obstacles: [(shape: Circle(radius_m: 0.2), position_m: (1.0, 1.0), motion: Static)], \
         task: (max_episode_steps: 30))",
    );
    write(
        "field.ron",
        "(name: \"Field\", clutter: [Scatter(count: (2, 6), shapes: [Circle(radius_m: (0.1, 0.2))])], \
         task: (max_episode_steps: 30))",
    );
    let set = "(name: \"Two kinds\", scenarios: [(scenario: \"posts.ron\"), (generator: \"field.ron\", levels: 9)])";
    write("set.ron", set)
}

fn app_in(set: &Path) -> HeadlessApp {
    app_with_preset(set, "fast")
}

fn app_with_preset(set: &Path, preset: &str) -> HeadlessApp {
    let (scenario, preset) = (set.display().to_string(), preset.into());
    let options = StartOptions { scenario, preset, seed: 4, pace: Pace::Full, ..StartOptions::default() };
    let mut app = HeadlessApp::new(options);
    app.command(Command::Pause(true));
    frame(&mut app);
    app
}

fn frame(app: &mut HeadlessApp) {
    app.frame(Duration::from_millis(10));
    assert_eq!(app.error_notices(), Vec::<String>::new());
}

/// Trains until control step `steps`, then waits for the first evaluation.
fn train(app: &mut HeadlessApp, steps: u64) {
    let began = Instant::now();
    app.step_to(steps);
    while app.shown().1.success_rate.is_none() {
        assert!(began.elapsed() < Duration::from_secs(300), "no evaluation");
        frame(app);
    }
}

fn members(app: &HeadlessApp) -> Vec<String> {
    let arenas = &app.shown().0.arenas;
    arenas.iter().map(|arena| arena.set_member.clone().expect("a scenario of the set")).collect()
}

#[test]
fn each_arena_shows_its_scenario_and_both_arenas_of_a_comparison_have_the_same() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut app = app_in(&write_set(folder.path()));
    train(&mut app, 1);
    let mut seen = BTreeSet::new();
    for _ in 0..60 {
        app.command(Command::Step);
        frame(&mut app);
        for (member, arena) in members(&app).iter().zip(&app.shown().0.arenas) {
            let is_level = member.starts_with("field, level ");
            assert!(is_level || member == "posts", "{member}");
            assert_eq!(arena.written.name == "Posts", !is_level, "{member}: {}", arena.written.name);
            seen.insert(member.clone());
        }
    }
    assert!(seen.len() > 4, "episodes have several scenarios: {seen:?}");
    app.command(Command::OpenDriver("field"));
    let mut compared = BTreeSet::new();
    for _ in 0..150 {
        app.command(Command::Step);
        frame(&mut app);
        let [policy, driver] = &app.shown().0.arenas[..] else { panic!("two arenas") };
        assert_eq!((&policy.set_member, &policy.written), (&driver.set_member, &driver.written));
        compared.insert(policy.set_member.clone());
    }
    assert!(compared.len() > 1, "rounds have several scenarios: {compared:?}");
}

#[test]
fn training_on_a_set_is_saved_resumed_and_replayed() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let set = write_set(folder.path());
    let saved = folder.path().join("run");
    let preset = folder.path().join("progress.ron");
    std::fs::write(&preset, "(based_on: \"fast\", levels: ByProgress(uniform: 0.2))")
        .expect("a writable folder");
    let mut app = app_with_preset(&set, &preset.display().to_string());
    train(&mut app, 150);
    app.command(Command::Move(MoveRequest { arena: 1, object: Movable::Goal, to_m: vec2(0.0, 0.0) }));
    app.step_to(160);
    // In between, a demo replaces the training arenas. Its episodes do not count in the results of the levels.
    app.command(Command::SetMode(SessionMode::Test));
    for _ in 0..70 {
        app.command(Command::Step);
        frame(&mut app);
    }
    app.command(Command::SetMode(SessionMode::Train));
    app.step_to(250);
    app.command(Command::Save(SaveKind::Run, saved.clone()));
    frame(&mut app);
    let replayed = verify(&saved).expect("a run");
    assert!(replayed.bit_identical && replayed.steps == 250, "{replayed:?}");
    for file in ["set.ron", "posts.ron", "field.ron", "progress.ron"] {
        std::fs::remove_file(folder.path().join(file)).expect("the run needs none of the files");
    }
    let mut resumed = HeadlessApp::new(StartOptions { paused: true, ..StartOptions::default() });
    resumed.command(Command::Open(saved));
    frame(&mut resumed);
    resumed.command(Command::Pause(true));
    frame(&mut resumed);
    assert_eq!(members(&resumed), members(&app));
    let goals = |app: &HeadlessApp| app.shown().0.arenas.iter().map(|arena| arena.goal).collect::<Vec<_>>();
    assert_eq!(goals(&resumed), goals(&app));
    let rates = |app: &mut HeadlessApp| {
        let curves = app.world().resource::<TrainingHistory>().0.curves();
        let latest = |(name, series): &(String, wayfield::app::history::DownsampledSeries)| {
            (name.clone(), series.latest().map(|point| point.y))
        };
        curves.evaluated_in.iter().map(latest).collect::<Vec<_>>()
    };
    let before = rates(&mut app);
    assert_eq!(before.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["posts", "field"]);
    assert!(before.iter().all(|(_, rate)| rate.is_some()), "{before:?}");
    assert_eq!(rates(&mut resumed), before);
}

#[test]
fn a_set_is_neither_edited_nor_continued_in_another_scenario() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut app = app_in(&write_set(folder.path()));
    let obstacle = MoveRequest { arena: 0, object: Movable::Obstacle(0), to_m: vec2(-1.0, -1.0) };
    app.command(Command::Move(obstacle));
    frame(&mut app);
    assert!(!app.scenario_modified());
    let scenario = std::sync::Arc::new(Scenario::default());
    let apply =
        |restart| Command::ApplyScenario { scenario: scenario.clone(), from: "mine.ron".into(), restart };
    app.command(apply(false));
    app.frame(Duration::from_millis(10));
    let error = app.error_notices().pop().expect("a refusal");
    assert!(
        error.contains("Two kinds: ") && error.contains("help: start a new training run there"),
        "{error}"
    );
    assert!(app.shown().1.is_set);
    app.command(apply(true));
    app.frame(Duration::from_millis(10));
    assert!(!app.shown().1.is_set);
    assert!(app.shown().0.arenas.iter().all(|arena| arena.set_member.is_none()));
    assert!(app.run().config.scenario_set.is_none());
}

#[test]
fn a_shipped_generator_can_be_chosen_and_training_uses_its_levels() {
    let mut app = HeadlessApp::new(StartOptions { scenario: "clutter".into(), ..StartOptions::default() });
    app.command(Command::Pause(true));
    frame(&mut app);
    let (_, status) = app.shown();
    assert!(status.scenarios.iter().any(|choice| choice.from == "clutter" && !choice.title.is_empty()));
    assert!(status.is_set);
    let seen: BTreeSet<String> = members(&app).into_iter().collect();
    assert!(seen.len() > 4, "sixteen arenas have several levels: {seen:?}");
}

#[test]
fn a_preset_that_names_a_set_is_opened_in_that_set() {
    let folder = tempfile::tempdir().expect("temporary folder");
    write_set(folder.path());
    let preset = folder.path().join("mine.ron");
    std::fs::write(&preset, "(based_on: \"fast\", scenario: \"set.ron\")").expect("a writable folder");
    let mut app = HeadlessApp::new(StartOptions { paused: true, ..StartOptions::default() });
    frame(&mut app);
    app.command(Command::Open(preset));
    frame(&mut app);
    assert_eq!(app.run().config.scenario_title(), "Two kinds");
    assert_eq!(app.run().config.preset_name(), "mine");
}
