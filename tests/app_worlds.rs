//! Another world under the training: its file is saved in an editor, breaks and is mended; the window's editor hands one
//! over. What is taken stands in the journal.
#![cfg(feature = "window")]

#[path = "support/studio.rs"]
mod studio;

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use wayfield::app::orders::{Mode, Moved, Order, Pace, Saved};
use wayfield::app::session::First;
use wayfield::app::session::journal::{Replayed, verify};
use wayfield::scenario::Scenario;

use studio::Studio;

/// A small world with a cylinder at (`x_m`, 0.6) whose episodes are short.
fn world(x_m: f32) -> String {
    format!(
        "// My own.\n(\n    name: \"Mine\",\n    obstacles: [\n        (shape: Circle(radius_m: 0.2), position_m: ({x_m:?}, 0.6)), \
         // here\n    ],\n    task: (time_limit_steps: 40),\n)\n"
    )
}

fn write(file: &Path, text: &str) {
    // As editors do: beside it, then in its place.
    let beside = file.with_extension("new");
    std::fs::write(&beside, text).expect("it is written");
    std::fs::rename(beside, file).expect("it is there");
}

fn first(file: &Path) -> First {
    First { scenario: file.display().to_string(), seed: 3, pace: Pace::Times(50.0), ..First::default() }
}

/// Frames until `done`, a minute at most.
fn wait(studio: &mut Studio, what: &str, done: impl Fn(&Studio) -> bool) {
    let began = Instant::now();
    while !done(studio) {
        assert!(began.elapsed() < Duration::from_secs(60), "{what}: {:?}", studio.session().notices());
        studio.frame(Duration::from_millis(20));
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn x_m(studio: &Studio) -> f32 {
    studio.shown().0.scenario.obstacles[0].position_m.0
}

fn told(studio: &Studio, words: &str) -> bool {
    studio.session().notices().iter().any(|notice| notice.text.contains(words))
}

#[test]
fn a_saved_file_is_taken_at_an_episodes_end_however_often_it_was_broken() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mine.ron");
    write(&file, &world(0.6));
    let mut studio = Studio::new(first(&file));
    wait(&mut studio, "it goes on", |studio| studio.steps() > 20);
    assert_eq!(x_m(&studio), 0.6);
    for (round, x) in [0.7, 0.8, -0.9].into_iter().enumerate() {
        let good = x_m(&studio);
        write(&file, &world(x).replace("radius_m", "radius_cm"));
        wait(&mut studio, "it is told", |studio| told(studio, "unknown field `radius_cm`"));
        assert!(told(&studio, "mine.ron:5:"), "with its line: {:?}", studio.complaints());
        assert!(told(&studio, "did you mean `radius_m`?"), "and the mend");
        let steps = studio.steps();
        wait(&mut studio, "the last good world goes on", |studio| studio.steps() > steps + 50);
        assert_eq!(x_m(&studio), good, "round {round}");
        write(&file, &world(x));
        wait(&mut studio, "it is taken", |studio| x_m(studio) == x);
        assert_eq!(studio.complaints(), Vec::<String>::new(), "what was mended is not told any more");
        assert!(!studio.session().world_changed(), "the world is that of the file");
    }
    // What the network can't take is told, and the last good world goes on.
    write(&file, &world(0.5).replace("    task:", "    lidar: (beams: 12),\n    task:"));
    wait(&mut studio, "it is told", |studio| told(studio, "it has 12 beams"));
    assert_eq!(x_m(&studio), -0.9);
    let run = folder.path().join("run");
    studio.order(Order::Pause(true));
    studio.order(Order::Save(Saved::Run, run.clone()));
    studio.frame(Duration::from_millis(10));
    let steps = studio.steps();
    assert_eq!(
        verify(&run),
        Ok(Replayed { steps, deeds: 3, same: true }),
        "each world stands in the journal"
    );
}

#[test]
fn a_file_that_was_broken_at_first_is_taken_as_soon_as_it_is_mended() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mine.ron");
    write(&file, "(name: \"Mine\", obstacles: [");
    let mut studio = Studio::new(First { preset: "per_d3qn".into(), ..first(&file) });
    studio.frame(Duration::from_millis(10));
    assert!(told(&studio, "mine.ron:1:"), "{:?}", studio.session().notices());
    assert_eq!(studio.shown().0.scenario.name, "Scenario I", "something goes on meanwhile");
    write(&file, "(name: \"Mine\", obstacles: [}");
    wait(&mut studio, "broken in another way", |studio| told(studio, "this closes no open bracket"));
    write(&file, &world(0.7));
    wait(&mut studio, "it is taken", |studio| studio.shown().0.scenario.name == "Mine");
    assert_eq!(studio.complaints(), Vec::<String>::new());
    assert_eq!(studio.shown().1.preset_from, "per_d3qn", "as it was asked for");
    write(&file, &world(0.9));
    wait(&mut studio, "and watched from then on", |studio| x_m(studio) == 0.9);

    // The same for one that is opened while another training goes on.
    let other = folder.path().join("other.ron");
    write(&other, "(nam: \"Other\")");
    studio.order(Order::Open(other.clone()));
    wait(&mut studio, "it is told", |studio| told(studio, "unknown field `nam`"));
    assert_eq!(studio.shown().0.scenario.name, "Mine");
    write(&other, "(name: \"Other\")");
    wait(&mut studio, "it is opened", |studio| studio.shown().0.scenario.name == "Other");
    // Nor is a preset, once mended, a bad scenario; and a file that was away for a while is watched on.
    let preset = folder.path().join("preset.ron");
    write(&preset, "(abot: \"Mine\")");
    studio.order(Order::Open(preset.clone()));
    wait(&mut studio, "it is told", |studio| told(studio, "unknown field `abot`"));
    write(&preset, &std::fs::read_to_string("assets/presets/dqn.ron").expect("it is shipped"));
    wait(&mut studio, "it is opened", |studio| studio.shown().1.preset_from == preset.display().to_string());
    assert_eq!(studio.complaints(), Vec::<String>::new());
    std::fs::remove_file(&other).expect("it was there");
    let steps = studio.steps();
    wait(&mut studio, "it goes on without its file", |studio| studio.steps() > steps + 30);
    write(&other, "(name: \"Back\", task: (time_limit_steps: 40))");
    wait(&mut studio, "it is there again", |studio| told(studio, "its new world is taken"));
}

#[test]
fn a_mended_file_takes_no_training_away() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mine.ron");
    write(&file, "(nam: \"Mine\")");
    let mut studio = Studio::new(First { pace: Pace::Full, ..First::default() });
    studio.frame(Duration::from_millis(10));
    studio.order(Order::Open(file.clone()));
    wait(&mut studio, "it is of some worth", |studio| studio.shown().1.env_steps > 21_000);
    for k in 0..2 {
        write(&file, &format!("(name: \"Mine {k}\")"));
        wait(&mut studio, "it is told", |studio| k > 0 || told(studio, "it can be used now"));
    }
    let steps = studio.steps();
    wait(&mut studio, "the training goes on", |studio| studio.steps() > steps + 3_000);
    assert_eq!(studio.shown().0.scenario.name, "Scenario I");
}

#[test]
fn an_edited_world_is_gone_on_in_or_begun_again_as_the_user_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    let mut studio = Studio::new(First { seed: 4, ..First::default() });
    studio.order(Order::Pause(true));
    studio.step_to(60);
    let mut edited = Scenario::clone(&studio.shown().0.scenario);
    edited.obstacles[0].position_m = (0.9, 0.9);
    let take = |scenario: &Scenario, again| Order::TakeWorld {
        scenario: Arc::new(scenario.clone()),
        from: "scenario-1".into(),
        again,
    };
    let learnt = studio.shown().1.env_steps;
    studio.order(Order::SetMode(Mode::Test));
    studio.frame(Duration::from_millis(10));
    studio.order(take(&edited, false));
    studio.frame(Duration::from_millis(10));
    assert_eq!(studio.complaints(), Vec::<String>::new());
    assert_eq!(studio.shown().0.scenario.obstacles[0].position_m, (0.9, 0.9));
    assert_eq!(
        (studio.shown().1.mode, studio.shown().1.env_steps),
        (Mode::Test, learnt),
        "the policy goes on"
    );
    assert!(studio.shown().1.world_changed && !studio.shown().1.papers_world);
    studio.order(Order::SetMode(Mode::Train));
    studio.order(Order::Pause(true));
    studio.step_to(120);
    studio.order(Order::Save(Saved::Run, run.clone()));
    studio.frame(Duration::from_millis(10));
    assert_eq!(studio.complaints(), Vec::<String>::new());
    assert_eq!(verify(&run), Ok(Replayed { steps: 120, deeds: 1, same: true }));

    // What can't be is refused, and nothing happens.
    let mut wrong = edited.clone();
    wrong.obstacles[0].position_m = (1.95, 0.9);
    studio.order(take(&wrong, false));
    studio.frame(Duration::from_millis(10));
    assert!(told(&studio, "beyond the enclosure"), "{:?}", studio.complaints());
    studio.order(take(
        &Scenario {
            lidar: wayfield::scenario::Lidar { beams: 12, ..edited.lidar.clone() },
            ..edited.clone()
        },
        false,
    ));
    studio.frame(Duration::from_millis(10));
    assert!(told(&studio, "12 beams"), "{:?}", studio.complaints());
    assert_eq!(studio.steps(), 120);

    // In a world whose LIDAR is noisy each look around draws: every place of a drag is noted, though the training began
    // in a world without noise.
    let mut noisy = edited.clone();
    noisy.lidar.noise_std_m = 0.02;
    studio.order(take(&noisy, false));
    for x_m in [0.05, 0.1] {
        studio.order(Order::Move(Moved::Robot { arena: 1, to_m: (x_m, 0.0) }));
    }
    studio.frame(Duration::from_millis(10));
    studio.step_to(140);
    let noisy_run = folder.path().join("noisy");
    studio.order(Order::Save(Saved::Run, noisy_run.clone()));
    studio.frame(Duration::from_millis(10));
    assert_eq!(verify(&noisy_run), Ok(Replayed { steps: 140, deeds: 4, same: true }));

    studio.order(take(&edited, true));
    studio.frame(Duration::from_millis(10));
    assert_eq!(studio.shown().0.scenario.obstacles[0].position_m, (0.9, 0.9));
    assert!(studio.steps() < 60, "a new training");
    assert!(studio.shown().1.world_changed && !studio.shown().1.papers_world);
}

#[test]
fn an_edited_world_is_saved_with_the_comments_of_its_file_and_opened_to_be_edited_though_it_does_not_fit_yet()
{
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mine.ron");
    write(&file, &world(0.6));
    let mut studio = Studio::new(First { paused: true, ..first(&file) });
    studio.frame(Duration::from_millis(10));
    let mut edited = Scenario::clone(&studio.shown().0.scenario);
    edited.obstacles[0].position_m = (3.0, 0.6);
    let scenario = Arc::new(edited.clone());
    let like = file.display().to_string();
    studio.order(Order::SaveWorld { scenario: scenario.clone(), like, path: Some(file.clone()) });
    studio.frame(Duration::from_millis(10));
    let saved = std::fs::read_to_string(&file).expect("it is there");
    assert_eq!(saved, world(3.0), "one number is another");
    assert_eq!(studio.shown().1.saved_world, Some((file.display().to_string(), scenario.clone())));
    // Whether the training goes on in it, the user says; that it doesn't fit yet, the editor.
    let began = Instant::now();
    wait(&mut studio, "the file was looked at", |_| began.elapsed() > Duration::from_millis(900));
    assert_eq!((x_m(&studio), studio.complaints()), (0.6, Vec::new()));
    // What somebody else has written meanwhile is not written over but when it is asked for twice.
    write(&file, &world(1.1));
    let like = file.display().to_string();
    for k in 0..2 {
        let (scenario, like) = (scenario.clone(), like.clone());
        studio.order(Order::SaveWorld { scenario, like, path: Some(file.clone()) });
        studio.frame(Duration::from_millis(10));
        let there = std::fs::read_to_string(&file).expect("it is there");
        assert_eq!(there, world(if k == 0 { 1.1 } else { 3.0 }), "asked for {} times", k + 1);
        assert_eq!(told(&studio, "changed since by somebody else"), k == 0);
    }
    studio.order(Order::EditOpen(Some(file.clone())));
    studio.frame(Duration::from_millis(10));
    let (number, from, draft) = studio.shown().1.draft.clone().expect("it was opened");
    assert_eq!((number, from, Scenario::clone(&draft)), (1, file.display().to_string(), edited));
    studio.order(Order::EditOpen(Some("doorway".into())));
    studio.frame(Duration::from_millis(10));
    assert_eq!(
        studio.shown().1.draft.as_ref().map(|draft| (draft.0, draft.1.as_str())),
        Some((2, "doorway"))
    );
    assert_eq!(studio.complaints(), Vec::<String>::new());
}
