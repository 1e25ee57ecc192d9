//! Numbers that go wrong in the window: told, the training stands still, and what can be kept can still be saved.
#![cfg(feature = "window")]

#[path = "support/studio.rs"]
mod studio;
#[path = "support/wild.rs"]
mod wild;

use std::time::Duration;

use studio::Studio;
use wayfield::app::orders::{Order, Pace, Saved};
use wayfield::app::session::First;
use wayfield::task::Target;
use wild::WILD;

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
fn a_number_that_is_none_ends_the_training_and_nothing_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut studio = trained(folder.path(), &[]);
    let world = studio.world();
    for mut target in world.query::<&mut Target>().iter_mut(world) {
        target.x_m = f32::NAN;
    }
    // (No step is taken while an examination is waited for.)
    let mut frames = 0;
    while studio.complaints().is_empty() && frames < 10_000 {
        studio.frame(Duration::from_millis(16));
        frames += 1;
    }
    let (steps, episodes) = (studio.steps(), studio.shown().1.episodes);
    let told = studio.complaints();
    assert!(
        told.iter().any(|told| told.contains("arena 0, step ") && told.contains("the target lies at (NaN m")),
        "{told:?}"
    );

    // It does not go on, not even by hand.
    studio.order(Order::Pause(false));
    studio.frame(Duration::from_millis(16));
    assert_eq!((studio.steps(), studio.shown().1.episodes), (steps, episodes));
    // A run that cannot go on is not saved as one; its rows and its policy are.
    studio.order(Order::Save(Saved::Run, folder.path().join("run")));
    studio.order(Order::Save(Saved::Csv, folder.path().join("rows.csv")));
    studio.order(Order::Save(Saved::Policy, folder.path().join("policy.safetensors")));
    studio.frame(Duration::from_millis(16));
    assert!(!folder.path().join("run").exists());
    let rows = std::fs::read_to_string(folder.path().join("rows.csv")).expect("the rows");
    assert_eq!(rows.lines().count() as u64, episodes + 1, "no episode ends with such a step");
    wayfield::run::policy_card::read(&folder.path().join("policy.safetensors")).expect("a policy");
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
    let mut studio = trained(folder.path(), &WILD);
    let warned = |studio: &Studio| studio.complaints().iter().any(|told| told.contains("seems to diverge"));
    let mut frames = 0;
    while !warned(&studio) && frames < 2000 {
        studio.frame(Duration::from_millis(16));
        frames += 1;
    }
    let told = studio.complaints();
    let warnings =
        told.iter().filter(|told| told.contains("seems to diverge") && told.contains("learning_rate"));
    assert_eq!(warnings.count(), 1, "{told:?}");
    let steps = studio.steps();
    studio.frame(Duration::from_millis(16));
    assert!(studio.steps() > steps, "a warning stops nothing");
    let (scenario, preset) = ("scenario-1".to_owned(), "fast".to_owned());
    studio.order(Order::Begin { scenario, preset, seed: 1 });
    studio.frame(Duration::from_millis(16));
    assert!(!warned(&studio), "another training has no part in it: {:?}", studio.complaints());
}
