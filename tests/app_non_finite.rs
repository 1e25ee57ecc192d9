//! Non-finite numbers in the app: they are reported, the training stops, and its results can still be saved.
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

/// An app that has trained for some frames with the preset `fast`, in which `replacements` are made.
fn trained(folder: &std::path::Path, replacements: &[(&str, &str)]) -> HeadlessApp {
    let text = replacements.iter().fold(FAST.to_owned(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "`{from}` in fast.ron");
        text.replace(from, to)
    });
    let preset = folder.join("mine.ron");
    std::fs::write(&preset, text).expect("the file can be written");
    let preset = preset.display().to_string();
    let mut app = HeadlessApp::new(StartOptions { preset, pace: Pace::Full, ..StartOptions::default() });
    for _ in 0..40 {
        app.frame(Duration::from_millis(16));
    }
    app
}

#[test]
fn a_non_finite_number_stops_the_training_but_not_the_app() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut app = trained(folder.path(), &[]);
    let world = app.world();
    for mut goal in world.query::<&mut Goal>().iter_mut(world) {
        goal.x_m = f32::NAN;
    }
    // This can take many frames: no step is taken while an evaluation is awaited.
    let mut frames = 0;
    while app.error_notices().is_empty() && frames < 10_000 {
        app.frame(Duration::from_millis(16));
        frames += 1;
    }
    let (steps, episodes) = (app.steps(), app.shown().1.episodes);
    let errors = app.error_notices();
    assert!(
        errors
            .iter()
            .any(|error| error.contains("arena 0, step ") && error.contains("the goal lies at (NaN m")),
        "{errors:?}"
    );

    // The user cannot resume it.
    app.command(Command::Pause(false));
    app.frame(Duration::from_millis(16));
    assert_eq!((app.steps(), app.shown().1.episodes), (steps, episodes));
    // The run cannot be saved, because it could not be resumed; its rows and its policy can.
    app.command(Command::Save(SaveKind::Run, folder.path().join("run")));
    app.command(Command::Save(SaveKind::Csv, folder.path().join("rows.csv")));
    app.command(Command::Save(SaveKind::Policy, folder.path().join("policy.safetensors")));
    app.frame(Duration::from_millis(16));
    assert!(!folder.path().join("run").exists());
    let rows = std::fs::read_to_string(folder.path().join("rows.csv")).expect("the rows");
    assert_eq!(rows.lines().count() as u64, episodes + 1, "the failed step ends no episode");
    wayfield::run::policy_card::read(&folder.path().join("policy.safetensors")).expect("a policy");
    assert!(
        app.error_notices().iter().any(|error| error.contains("cannot continue")),
        "{:?}",
        app.error_notices()
    );

    // A new training run starts as usual.
    let (scenario, preset) = ("scenario-1".to_owned(), "fast".to_owned());
    app.command(Command::StartTraining { scenario, preset, seed: 1 });
    app.command(Command::Pause(false));
    for _ in 0..10 {
        app.frame(Duration::from_millis(16));
    }
    assert!(!app.run().has_failed, "the new run has replaced the failed one: {:?}", app.error_notices());
    assert!(app.steps() > 5, "{} steps, {:?}", app.steps(), app.error_notices());
}

#[test]
fn q_values_beyond_any_return_are_reported_and_training_continues() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut app = trained(folder.path(), &DIVERGENT);
    let warned =
        |app: &HeadlessApp| app.error_notices().iter().any(|error| error.contains("seems to diverge"));
    let mut frames = 0;
    while !warned(&app) && frames < 2000 {
        app.frame(Duration::from_millis(16));
        frames += 1;
    }
    let errors = app.error_notices();
    let warnings =
        errors.iter().filter(|error| error.contains("seems to diverge") && error.contains("learning_rate"));
    assert_eq!(warnings.count(), 1, "{errors:?}");
    let steps = app.steps();
    app.frame(Duration::from_millis(16));
    assert!(app.steps() > steps, "a warning does not stop the training");
    let (scenario, preset) = ("scenario-1".to_owned(), "fast".to_owned());
    app.command(Command::StartTraining { scenario, preset, seed: 1 });
    app.frame(Duration::from_millis(16));
    assert!(!warned(&app), "a new training run removes the warning: {:?}", app.error_notices());
}
