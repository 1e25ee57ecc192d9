//! Numbers that go wrong in the window: told, the training stands still, and what can be kept can still be saved.
#![cfg(feature = "window")]

#[path = "support/studio.rs"]
mod studio;

use std::time::Duration;

use studio::Studio;
use wayfield::app::orders::{Order, Pace, Saved};
use wayfield::app::session::First;

const FAST: &str = include_str!("../assets/presets/fast.ron");

/// A studio that trains for some frames by the preset `fast`, in which other things stand in place of some.
fn trained(folder: &std::path::Path, others: &[(&str, &str)]) -> Studio {
    let text = others.iter().fold(FAST.to_owned(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "`{from}` in fast.ron");
        text.replace(from, to)
    });
    let preset = folder.join("mine.ron");
    std::fs::write(&preset, text).expect("a file can be written");
    let preset = preset.display().to_string();
    let mut studio = Studio::new(First { preset, pace: Pace::Full, ..First::default() });
    for _ in 0..40 {
        studio.frame(Duration::from_millis(16));
    }
    studio
}

#[test]
fn a_reward_that_is_no_number_ends_the_training_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut studio = trained(folder.path(), &[("mu: 100.0", "mu: 1e38")]);
    let told = studio.complaints();
    assert!(told.iter().any(|told| told.contains("step 1: the reward is NaN")), "{told:?}");
    assert_eq!(studio.steps(), 1, "the step in which it arose was the last");

    // Not even by hand.
    studio.order(Order::Pause(false));
    studio.frame(Duration::from_millis(16));
    assert_eq!(studio.steps(), 1);
    // A run that cannot go on is not saved as one; its rows are.
    studio.order(Order::Save(Saved::Run, folder.path().join("run")));
    studio.order(Order::Save(Saved::Csv, folder.path().join("rows.csv")));
    studio.frame(Duration::from_millis(16));
    assert!(!folder.path().join("run").exists() && folder.path().join("rows.csv").exists());
    assert!(
        studio.complaints().iter().any(|told| told.contains("cannot go on")),
        "{:?}",
        studio.complaints()
    );

    // Another training begins as ever.
    let (scenario, preset) = ("scenario-1".to_owned(), "fast".to_owned());
    studio.order(Order::Begin { scenario, preset, seed: 1 });
    studio.order(Order::Pause(false));
    for _ in 0..10 {
        studio.frame(Duration::from_millis(16));
    }
    assert!(studio.steps() > 5, "{} steps, {:?}", studio.steps(), studio.complaints());
}

#[test]
fn q_values_beyond_any_return_are_told_and_the_training_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut studio = trained(
        folder.path(),
        &[
            ("hidden: [64, 64]", "hidden: [256, 256]"),
            ("gamma: 0.95", "gamma: 0.99"),
            ("double: true", "double: false"),
            ("Huber(delta: 1.0)", "MeanSquared"),
            ("Linear(from: 0.001, to: 0.00001, env_steps: 300000)", "Constant(0.01)"),
            ("gradient_steps: 4", "gradient_steps: 16"),
            ("Soft(tau: 0.01)", "Soft(tau: 1.0)"),
        ],
    );
    while studio.shown().1.gradient_steps < 1000 {
        studio.frame(Duration::from_millis(16));
    }
    let told = studio.complaints();
    let warnings =
        told.iter().filter(|told| told.contains("seems to diverge") && told.contains("learning_rate"));
    assert_eq!(warnings.count(), 1, "{told:?}");
    let steps = studio.steps();
    studio.frame(Duration::from_millis(16));
    assert!(studio.steps() > steps, "a warning stops nothing");
}
