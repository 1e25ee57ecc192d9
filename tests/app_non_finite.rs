//! Numbers that go wrong in the window: told, the training stands still, and what can be kept can still be saved.
#![cfg(feature = "gui")]

#[path = "support/divergent.rs"]
mod divergent;
#[path = "support/headless_app.rs"]
mod headless_app;

use std::time::Duration;

use divergent::DIVERGENT;
use headless_app::HeadlessApp;
use wayfield::app::commands::{Command, Pace, SaveKind};
use wayfield::app::session::StartOptions;
use wayfield::task::Goal;

const FAST: &str = include_str!("../assets/presets/fast.ron");

/// A headless_app that trains for some frames by the preset `fast`, in which other things stand in place of some.
fn trained(folder: &std::path::Path, others: &[(&str, &str)]) -> HeadlessApp {
    let text = others.iter().fold(FAST.to_owned(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "`{from}` in fast.ron");
        text.replace(from, to)
    });
    let preset = folder.join("mine.ron");
    std::fs::write(&preset, text).expect("a file can be written");
    let preset = preset.display().to_string();
    let mut headless_app =
        HeadlessApp::new(StartOptions { preset, pace: Pace::Full, ..StartOptions::default() });
    for _ in 0..40 {
        headless_app.frame(Duration::from_millis(16));
    }
    headless_app
}

#[test]
fn a_number_that_is_none_ends_the_training_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut headless_app = trained(folder.path(), &[]);
    let world = headless_app.world();
    for mut goal in world.query::<&mut Goal>().iter_mut(world) {
        goal.x_m = f32::NAN;
    }
    // (No step is taken while an examination is waited for.)
    let mut frames = 0;
    while headless_app.error_notices().is_empty() && frames < 10_000 {
        headless_app.frame(Duration::from_millis(16));
        frames += 1;
    }
    let (steps, episodes) = (headless_app.steps(), headless_app.shown().1.episodes);
    let told = headless_app.error_notices();
    assert!(
        told.iter().any(|told| told.contains("arena 0, step ") && told.contains("the goal lies at (NaN m")),
        "{told:?}"
    );

    // It does not go on, not even by hand.
    headless_app.command(Command::Pause(false));
    headless_app.frame(Duration::from_millis(16));
    assert_eq!((headless_app.steps(), headless_app.shown().1.episodes), (steps, episodes));
    // A run that cannot go on is not saved as one; its rows and its policy are.
    headless_app.command(Command::Save(SaveKind::Run, folder.path().join("run")));
    headless_app.command(Command::Save(SaveKind::Csv, folder.path().join("rows.csv")));
    headless_app.command(Command::Save(SaveKind::Policy, folder.path().join("policy.safetensors")));
    headless_app.frame(Duration::from_millis(16));
    assert!(!folder.path().join("run").exists());
    let rows = std::fs::read_to_string(folder.path().join("rows.csv")).expect("the rows");
    assert_eq!(rows.lines().count() as u64, episodes + 1, "no episode ends with such a step");
    wayfield::run::policy_card::read(&folder.path().join("policy.safetensors")).expect("a policy");
    assert!(
        headless_app.error_notices().iter().any(|told| told.contains("cannot continue")),
        "{:?}",
        headless_app.error_notices()
    );

    // Another training begins as ever.
    let (scenario, preset) = ("scenario-1".to_owned(), "fast".to_owned());
    headless_app.command(Command::StartTraining { scenario, preset, seed: 1 });
    headless_app.command(Command::Pause(false));
    for _ in 0..10 {
        headless_app.frame(Duration::from_millis(16));
    }
    assert!(headless_app.steps() > 5, "{} steps, {:?}", headless_app.steps(), headless_app.error_notices());
}

#[test]
fn q_values_beyond_any_return_are_told_and_the_training_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut headless_app = trained(folder.path(), &DIVERGENT);
    let warned = |headless_app: &HeadlessApp| {
        headless_app.error_notices().iter().any(|told| told.contains("seems to diverge"))
    };
    let mut frames = 0;
    while !warned(&headless_app) && frames < 2000 {
        headless_app.frame(Duration::from_millis(16));
        frames += 1;
    }
    let told = headless_app.error_notices();
    let warnings =
        told.iter().filter(|told| told.contains("seems to diverge") && told.contains("learning_rate"));
    assert_eq!(warnings.count(), 1, "{told:?}");
    let steps = headless_app.steps();
    headless_app.frame(Duration::from_millis(16));
    assert!(headless_app.steps() > steps, "a warning stops nothing");
    let (scenario, preset) = ("scenario-1".to_owned(), "fast".to_owned());
    headless_app.command(Command::StartTraining { scenario, preset, seed: 1 });
    headless_app.frame(Duration::from_millis(16));
    assert!(!warned(&headless_app), "another training has no part in it: {:?}", headless_app.error_notices());
}
