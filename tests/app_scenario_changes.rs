//! Another world under the training: its file is saved in an editor, breaks and is mended; the window's editor hands one
//! over. What is taken stands in the journal.
#![cfg(feature = "gui")]

#[path = "support/headless_app.rs"]
mod headless_app;

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::math::vec2;
use wayfield::app::commands::{Command, MoveRequest, Pace, SaveKind, SessionMode};
use wayfield::app::session::StartOptions;
use wayfield::app::session::journal::{ReplayResult, verify};
use wayfield::scenario::Scenario;

use headless_app::HeadlessApp;

/// A small world with a cylinder at (`x_m`, 0.6) whose episodes are short.
fn world(x_m: f32) -> String {
    format!(
        "// My own.\n(\n    name: \"Mine\",\n    obstacles: [\n        (shape: Circle(radius_m: 0.2), position_m: ({x_m:?}, 0.6)), \
         // here\n    ],\n    task: (max_episode_steps: 40),\n)\n"
    )
}

fn write(file: &Path, text: &str) {
    // As editors do: beside it, then in its place.
    let beside = file.with_extension("new");
    std::fs::write(&beside, text).expect("it is written");
    std::fs::rename(beside, file).expect("it is there");
}

fn first(file: &Path) -> StartOptions {
    StartOptions {
        scenario: file.display().to_string(),
        seed: 3,
        pace: Pace::Times(50.0),
        ..StartOptions::default()
    }
}

/// Frames until `done`, a minute at most.
fn wait(headless_app: &mut HeadlessApp, what: &str, done: impl Fn(&HeadlessApp) -> bool) {
    let began = Instant::now();
    while !done(headless_app) {
        assert!(began.elapsed() < Duration::from_secs(60), "{what}: {:?}", headless_app.session().notices());
        headless_app.frame(Duration::from_millis(20));
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn x_m(headless_app: &HeadlessApp) -> f32 {
    headless_app.shown().0.scenario.obstacles[0].position_m.x
}

fn told(headless_app: &HeadlessApp, words: &str) -> bool {
    headless_app.session().notices().iter().any(|notice| notice.text.contains(words))
}

#[test]
fn a_saved_file_is_taken_at_an_episodes_end_however_often_it_was_broken() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mine.ron");
    write(&file, &world(0.6));
    let mut headless_app = HeadlessApp::new(first(&file));
    wait(&mut headless_app, "it goes on", |headless_app| headless_app.steps() > 20);
    assert_eq!(x_m(&headless_app), 0.6);
    for (round, x) in [0.7, 0.8, -0.9].into_iter().enumerate() {
        let good = x_m(&headless_app);
        write(&file, &world(x).replace("radius_m", "radius_cm"));
        wait(&mut headless_app, "it is told", |headless_app| told(headless_app, "unknown field `radius_cm`"));
        assert!(told(&headless_app, "mine.ron:5:"), "with its line: {:?}", headless_app.error_notices());
        assert!(told(&headless_app, "did you mean `radius_m`?"), "and the mend");
        let steps = headless_app.steps();
        wait(&mut headless_app, "the last good world goes on", |headless_app| {
            headless_app.steps() > steps + 50
        });
        assert_eq!(x_m(&headless_app), good, "round {round}");
        write(&file, &world(x));
        wait(&mut headless_app, "it is taken", |headless_app| x_m(headless_app) == x);
        assert_eq!(
            headless_app.error_notices(),
            Vec::<String>::new(),
            "what was mended is not told any more"
        );
        assert!(!headless_app.session().scenario_modified(), "the world is that of the file");
    }
    // What the network can't take is told, and the last good world goes on.
    write(&file, &world(0.5).replace("    task:", "    lidar: (beams: 12),\n    task:"));
    wait(&mut headless_app, "it is told", |headless_app| told(headless_app, "it has 12 beams"));
    assert_eq!(x_m(&headless_app), -0.9);
    let run = folder.path().join("run");
    headless_app.command(Command::Pause(true));
    headless_app.command(Command::Save(SaveKind::Run, run.clone()));
    headless_app.frame(Duration::from_millis(10));
    let steps = headless_app.steps();
    assert_eq!(
        verify(&run),
        Ok(ReplayResult { steps, interventions: 3, bit_identical: true }),
        "each world stands in the journal"
    );
}

#[test]
fn a_file_that_was_broken_at_first_is_taken_as_soon_as_it_is_mended() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mine.ron");
    write(&file, "(name: \"Mine\", obstacles: [");
    let mut headless_app = HeadlessApp::new(StartOptions { preset: "per_d3qn".into(), ..first(&file) });
    headless_app.frame(Duration::from_millis(10));
    assert!(told(&headless_app, "mine.ron:1:"), "{:?}", headless_app.session().notices());
    assert_eq!(headless_app.shown().0.scenario.name, "Scenario I", "something goes on meanwhile");
    write(&file, "(name: \"Mine\", obstacles: [}");
    wait(&mut headless_app, "broken in another way", |headless_app| {
        told(headless_app, "this closes no open bracket")
    });
    write(&file, &world(0.7));
    wait(&mut headless_app, "it is taken", |headless_app| headless_app.shown().0.scenario.name == "Mine");
    assert_eq!(headless_app.error_notices(), Vec::<String>::new());
    assert_eq!(headless_app.shown().1.preset_from, "per_d3qn", "as it was asked for");
    write(&file, &world(0.9));
    wait(&mut headless_app, "and watched from then on", |headless_app| x_m(headless_app) == 0.9);

    // The same for one that is opened while another training goes on.
    let other = folder.path().join("other.ron");
    write(&other, "(nam: \"Other\")");
    headless_app.command(Command::Open(other.clone()));
    wait(&mut headless_app, "it is told", |headless_app| told(headless_app, "unknown field `nam`"));
    assert_eq!(headless_app.shown().0.scenario.name, "Mine");
    write(&other, "(name: \"Other\")");
    wait(&mut headless_app, "it is opened", |headless_app| headless_app.shown().0.scenario.name == "Other");
    // Nor is a preset, once mended, a bad scenario; and a file that was away for a while is watched on.
    let preset = folder.path().join("preset.ron");
    write(&preset, "(abot: \"Mine\")");
    headless_app.command(Command::Open(preset.clone()));
    wait(&mut headless_app, "it is told", |headless_app| told(headless_app, "unknown field `abot`"));
    write(&preset, &std::fs::read_to_string("assets/presets/dqn.ron").expect("it is shipped"));
    wait(&mut headless_app, "it is opened", |headless_app| {
        headless_app.shown().1.preset_from == preset.display().to_string()
    });
    assert_eq!(headless_app.error_notices(), Vec::<String>::new());
    std::fs::remove_file(&other).expect("it was there");
    let steps = headless_app.steps();
    wait(&mut headless_app, "it goes on without its file", |headless_app| headless_app.steps() > steps + 30);
    write(&other, "(name: \"Back\", task: (max_episode_steps: 40))");
    wait(&mut headless_app, "it is there again", |headless_app| told(headless_app, "its new world is taken"));
}

#[test]
fn a_mended_file_takes_no_training_away() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mine.ron");
    write(&file, "(nam: \"Mine\")");
    let mut headless_app = HeadlessApp::new(StartOptions { pace: Pace::Full, ..StartOptions::default() });
    headless_app.frame(Duration::from_millis(10));
    headless_app.command(Command::Open(file.clone()));
    wait(&mut headless_app, "it is of some worth", |headless_app| headless_app.shown().1.env_steps > 21_000);
    for k in 0..2 {
        write(&file, &format!("(name: \"Mine {k}\")"));
        wait(&mut headless_app, "it is told", |headless_app| {
            k > 0 || told(headless_app, "it can be used now")
        });
    }
    let steps = headless_app.steps();
    wait(&mut headless_app, "the training goes on", |headless_app| headless_app.steps() > steps + 3_000);
    assert_eq!(headless_app.shown().0.scenario.name, "Scenario I");
}

#[test]
fn an_edited_world_is_gone_on_in_or_begun_again_as_the_user_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = folder.path().join("run");
    let mut headless_app = HeadlessApp::new(StartOptions { seed: 4, ..StartOptions::default() });
    headless_app.command(Command::Pause(true));
    headless_app.step_to(60);
    let mut edited = Scenario::clone(&headless_app.shown().0.scenario);
    edited.obstacles[0].position_m = vec2(0.9, 0.9);
    let take = |scenario: &Scenario, again| Command::ApplyScenario {
        scenario: Arc::new(scenario.clone()),
        from: "scenario-1".into(),
        again,
    };
    let learnt = headless_app.shown().1.env_steps;
    headless_app.command(Command::SetMode(SessionMode::Test));
    headless_app.frame(Duration::from_millis(10));
    headless_app.command(take(&edited, false));
    headless_app.frame(Duration::from_millis(10));
    assert_eq!(headless_app.error_notices(), Vec::<String>::new());
    assert_eq!(headless_app.shown().0.scenario.obstacles[0].position_m, vec2(0.9, 0.9));
    assert_eq!(
        (headless_app.shown().1.mode, headless_app.shown().1.env_steps),
        (SessionMode::Test, learnt),
        "the policy goes on"
    );
    assert!(headless_app.shown().1.scenario_modified && !headless_app.shown().1.is_paper_scenario_1);
    headless_app.command(Command::SetMode(SessionMode::Train));
    headless_app.command(Command::Pause(true));
    headless_app.step_to(120);
    headless_app.command(Command::Save(SaveKind::Run, run.clone()));
    headless_app.frame(Duration::from_millis(10));
    assert_eq!(headless_app.error_notices(), Vec::<String>::new());
    assert_eq!(verify(&run), Ok(ReplayResult { steps: 120, interventions: 1, bit_identical: true }));

    // What can't be is refused, and nothing happens.
    let mut wrong = edited.clone();
    wrong.obstacles[0].position_m = vec2(1.95, 0.9);
    headless_app.command(take(&wrong, false));
    headless_app.frame(Duration::from_millis(10));
    assert!(told(&headless_app, "beyond the enclosure"), "{:?}", headless_app.error_notices());
    headless_app.command(take(
        &Scenario {
            lidar: wayfield::scenario::Lidar { beams: 12, ..edited.lidar.clone() },
            ..edited.clone()
        },
        false,
    ));
    headless_app.frame(Duration::from_millis(10));
    assert!(told(&headless_app, "12 beams"), "{:?}", headless_app.error_notices());
    assert_eq!(headless_app.steps(), 120);

    // In a world whose LIDAR is noisy each look around draws: every place of a drag is noted, though the training began
    // in a world without noise.
    let mut noisy = edited.clone();
    noisy.lidar.noise_std_m = 0.02;
    headless_app.command(take(&noisy, false));
    for x_m in [0.05, 0.1] {
        headless_app.command(Command::Move(MoveRequest::Robot { arena: 1, to_m: vec2(x_m, 0.0) }));
    }
    headless_app.frame(Duration::from_millis(10));
    headless_app.step_to(140);
    let noisy_run = folder.path().join("noisy");
    headless_app.command(Command::Save(SaveKind::Run, noisy_run.clone()));
    headless_app.frame(Duration::from_millis(10));
    assert_eq!(verify(&noisy_run), Ok(ReplayResult { steps: 140, interventions: 4, bit_identical: true }));

    headless_app.command(take(&edited, true));
    headless_app.frame(Duration::from_millis(10));
    assert_eq!(headless_app.shown().0.scenario.obstacles[0].position_m, vec2(0.9, 0.9));
    assert!(headless_app.steps() < 60, "a new training");
    assert!(headless_app.shown().1.scenario_modified && !headless_app.shown().1.is_paper_scenario_1);
}

#[test]
fn an_edited_world_is_saved_with_the_comments_of_its_file_and_opened_to_be_edited_though_it_does_not_fit_yet()
{
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mine.ron");
    write(&file, &world(0.6));
    let mut headless_app = HeadlessApp::new(StartOptions { paused: true, ..first(&file) });
    headless_app.frame(Duration::from_millis(10));
    let mut edited = Scenario::clone(&headless_app.shown().0.scenario);
    edited.obstacles[0].position_m = vec2(3.0, 0.6);
    let scenario = Arc::new(edited.clone());
    let like = file.display().to_string();
    headless_app.command(Command::SaveScenario {
        scenario: scenario.clone(),
        like,
        path: Some(file.clone()),
    });
    headless_app.frame(Duration::from_millis(10));
    let saved = std::fs::read_to_string(&file).expect("it is there");
    assert_eq!(saved, world(3.0), "one number is another");
    assert_eq!(headless_app.shown().1.saved_scenario, Some((file.display().to_string(), scenario.clone())));
    // Whether the training goes on in it, the user says; that it doesn't fit yet, the editor.
    let began = Instant::now();
    wait(&mut headless_app, "the file was looked at", |_| began.elapsed() > Duration::from_millis(900));
    assert_eq!((x_m(&headless_app), headless_app.error_notices()), (0.6, Vec::new()));
    // What somebody else has written meanwhile is not written over but when it is asked for twice.
    write(&file, &world(1.1));
    let like = file.display().to_string();
    for k in 0..2 {
        let (scenario, like) = (scenario.clone(), like.clone());
        headless_app.command(Command::SaveScenario { scenario, like, path: Some(file.clone()) });
        headless_app.frame(Duration::from_millis(10));
        let there = std::fs::read_to_string(&file).expect("it is there");
        assert_eq!(there, world(if k == 0 { 1.1 } else { 3.0 }), "asked for {} times", k + 1);
        assert_eq!(told(&headless_app, "changed since by somebody else"), k == 0);
    }
    headless_app.command(Command::OpenInEditor(Some(file.clone())));
    headless_app.frame(Duration::from_millis(10));
    let (number, from, draft) = headless_app.shown().1.draft.clone().expect("it was opened");
    assert_eq!((number, from, Scenario::clone(&draft)), (1, file.display().to_string(), edited));
    headless_app.command(Command::OpenInEditor(Some("doorway".into())));
    headless_app.frame(Duration::from_millis(10));
    assert_eq!(
        headless_app.shown().1.draft.as_ref().map(|draft| (draft.0, draft.1.as_str())),
        Some((2, "doorway"))
    );
    assert_eq!(headless_app.error_notices(), Vec::<String>::new());
}
