//! Changes of the scenario during training: its file is edited in another program, broken and fixed; or it is edited in the
//! app. Every adopted scenario is recorded in the journal.
#![cfg(feature = "gui")]

#[path = "support/headless_app.rs"]
mod headless_app;

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::math::vec2;
use wayfield::app::commands::{Command, EditorReply, Pace, SaveKind, SessionMode};
use wayfield::app::moves::{Movable, MoveRequest};
use wayfield::app::session::StartOptions;
use wayfield::app::session::journal::{ReplayResult, verify};
use wayfield::scenario::Scenario;

use headless_app::HeadlessApp;

/// Text of a scenario with a cylinder at (`x_m`, 0.6) and short episodes.
fn scenario_text(x_m: f32) -> String {
    format!(
        "// My own.\n(\n    name: \"Mine\",\n    obstacles: [\n        (shape: Circle(radius_m: 0.2), position_m: ({x_m:?}, 0.6)), \
         // here\n    ],\n    task: (max_episode_steps: 40),\n)\n"
    )
}

fn write(file: &Path, text: &str) {
    // As editors do: to a temporary file, which then replaces the original.
    let temporary = file.with_extension("new");
    std::fs::write(&temporary, text).expect("the file can be written");
    std::fs::rename(temporary, file).expect("the file can be replaced");
}

fn options(file: &Path) -> StartOptions {
    StartOptions {
        scenario: file.display().to_string(),
        seed: 3,
        pace: Pace::Times(50.0),
        ..StartOptions::default()
    }
}

/// The time between two frames, on the clock of the app. The file watch uses the same clock: it checks a file in every tenth
/// frame.
const FRAME: Duration = Duration::from_millis(20);

/// Runs frames until `done`, for at most a minute.
fn wait(app: &mut HeadlessApp, what: &str, done: impl Fn(&HeadlessApp) -> bool) {
    let began = Instant::now();
    while !done(app) {
        assert!(began.elapsed() < Duration::from_secs(60), "{what}: {:?}", app.notices());
        app.frame(FRAME);
    }
}

/// Runs frames until the file watch has checked each file several times.
fn let_files_be_checked(app: &mut HeadlessApp) {
    for _ in 0..45 {
        app.frame(FRAME);
    }
}

fn x_m(app: &HeadlessApp) -> f32 {
    app.shown().0.scenario.obstacles[0].position_m.x
}

fn has_notice(app: &HeadlessApp, words: &str) -> bool {
    app.notices().iter().any(|notice| notice.text.contains(words))
}

#[test]
fn a_changed_file_is_adopted_when_an_episode_ends_even_if_it_was_broken_in_between() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let file = folder.path().join("mine.ron");
    write(&file, &scenario_text(0.6));
    let mut app = HeadlessApp::new(options(&file));
    wait(&mut app, "training runs", |app| app.steps() > 20);
    assert_eq!(x_m(&app), 0.6);
    for (round, x) in [0.7, 0.8, -0.9].into_iter().enumerate() {
        let valid_x_m = x_m(&app);
        write(&file, &scenario_text(x).replace("radius_m", "radius_cm"));
        wait(&mut app, "the error is reported", |app| has_notice(app, "unknown field `radius_cm`"));
        assert!(has_notice(&app, "mine.ron:5:"), "with the line: {:?}", app.error_notices());
        assert!(has_notice(&app, "did you mean `radius_m`?"), "with the fix");
        let steps = app.steps();
        wait(&mut app, "training continues in the last valid scenario", |app| app.steps() > steps + 50);
        assert_eq!(x_m(&app), valid_x_m, "round {round}");
        write(&file, &scenario_text(x));
        wait(&mut app, "the scenario is adopted", |app| x_m(app) == x);
        assert_eq!(app.error_notices(), Vec::<String>::new(), "the error disappears when it is fixed");
        assert!(!app.scenario_modified(), "the scenario equals its file");
    }
    // A scenario that does not fit the network is reported, and the last valid one keeps running.
    write(&file, &scenario_text(0.5).replace("    task:", "    lidar: (beams: 12),\n    task:"));
    wait(&mut app, "the error is reported", |app| has_notice(app, "it has 12 beams"));
    assert_eq!(x_m(&app), -0.9);
    let run = folder.path().join("run");
    app.command(Command::Pause(true));
    app.command(Command::Save(SaveKind::Run, run.clone()));
    app.frame(Duration::from_millis(10));
    let steps = app.steps();
    assert_eq!(
        verify(&run),
        Ok(ReplayResult { steps, interventions: 3, bit_identical: true }),
        "each adopted scenario is in the journal"
    );
}

#[test]
fn a_broken_start_file_is_adopted_once_it_is_fixed() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let file = folder.path().join("mine.ron");
    write(&file, "(name: \"Mine\", obstacles: [");
    let mut app = HeadlessApp::new(StartOptions { preset: "per_d3qn".into(), ..options(&file) });
    app.frame(Duration::from_millis(10));
    assert!(has_notice(&app, "mine.ron:1:"), "{:?}", app.notices());
    assert_eq!(app.shown().0.scenario.name, "Scenario I", "the default runs meanwhile");
    write(&file, "(name: \"Mine\", obstacles: [}");
    wait(&mut app, "the new error is reported", |app| has_notice(app, "this closes no open bracket"));
    write(&file, &scenario_text(0.7));
    wait(&mut app, "the scenario is adopted", |app| app.shown().0.scenario.name == "Mine");
    assert_eq!(app.error_notices(), Vec::<String>::new());
    assert_eq!(app.shown().1.preset_from, "per_d3qn", "the requested preset");
    write(&file, &scenario_text(0.9));
    wait(&mut app, "the file is watched from then on", |app| x_m(app) == 0.9);

    // The same holds for a file that is opened later.
    let other = folder.path().join("other.ron");
    write(&other, "(nam: \"Other\")");
    app.command(Command::Open(other.clone()));
    wait(&mut app, "the error is reported", |app| has_notice(app, "unknown field `nam`"));
    assert_eq!(app.shown().0.scenario.name, "Mine");
    write(&other, "(name: \"Other\")");
    wait(&mut app, "the file is opened", |app| app.shown().0.scenario.name == "Other");
    // It also holds for a preset. And a file that was deleted for a while is still watched.
    let preset = folder.path().join("preset.ron");
    write(&preset, "(abot: \"Mine\")");
    app.command(Command::Open(preset.clone()));
    wait(&mut app, "the error is reported", |app| has_notice(app, "unknown field `abot`"));
    write(&preset, &std::fs::read_to_string("assets/presets/dqn.ron").expect("shipped"));
    wait(&mut app, "the file is opened", |app| app.shown().1.preset_from == preset.display().to_string());
    assert_eq!(app.error_notices(), Vec::<String>::new());
    std::fs::remove_file(&other).expect("the file existed");
    let steps = app.steps();
    let_files_be_checked(&mut app);
    assert!(app.steps() > steps + 30, "training continues without the file");
    write(&other, "(name: \"Back\", task: (max_episode_steps: 40))");
    wait(&mut app, "the file exists again", |app| {
        has_notice(app, "the changed scenario runs when the next episode ends")
    });
}

/// A paused app that has tried to start training in the scenario at `file` with `preset` and seed 9.
fn app_after_start(file: &Path, preset: &str) -> HeadlessApp {
    let mut app = HeadlessApp::new(StartOptions { paused: true, ..StartOptions::default() });
    app.frame(FRAME);
    let (scenario, preset) = (file.display().to_string(), preset.to_owned());
    app.command(Command::StartTraining { scenario, preset, seed: 9 });
    app.frame(FRAME);
    app
}

#[test]
fn a_broken_scenario_starts_with_the_requested_preset_and_seed_once_it_is_fixed() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let file = folder.path().join("mine.ron");
    write(&file, "(nam: \"Mine\")");
    let mut app = app_after_start(&file, "dqn");
    assert!(has_notice(&app, "unknown field `nam`"), "{:?}", app.notices());
    write(&file, "(name: \"Mine\")");
    wait(&mut app, "training starts", |app| app.shown().0.scenario.name == "Mine");
    let config = &app.run().config;
    assert_eq!((config.preset_from.as_str(), config.seed), ("dqn", 9), "as requested");
    assert_eq!(app.error_notices(), Vec::<String>::new());
}

#[test]
fn a_fixed_scenario_waits_until_its_preset_is_fixed_too() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let (file, preset) = (folder.path().join("mine.ron"), folder.path().join("preset.ron"));
    write(&file, "(nam: \"Mine\")");
    write(&preset, "(arena: 1)");
    let preset_from = preset.display().to_string();
    let mut app = app_after_start(&file, &preset_from);
    write(&file, "(name: \"Mine 1\")");
    wait(&mut app, "the preset is reported", |app| has_notice(app, "unknown field `arena`"));
    write(&preset, "(arenas: 1)");
    write(&file, "(name: \"Mine 22\")");
    wait(&mut app, "training starts", |app| app.shown().0.scenario.name == "Mine 22");
    let config = &app.run().config;
    assert_eq!((config.preset_from.as_str(), config.seed), (preset_from.as_str(), 9), "as requested");
    assert_eq!(app.error_notices(), Vec::<String>::new());
}

#[test]
fn after_a_failed_start_in_a_map_a_broken_scenario_still_starts_once_it_is_fixed() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let (file, map) = (folder.path().join("mine.ron"), folder.path().join("map.yaml"));
    write(&file, "(nam: \"Mine\")");
    let text = "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    write(&map, text);
    let is_edge = |cell: usize| matches!(cell, 0 | 29);
    let cell = |k: usize| if is_edge(k % 30) || is_edge(k / 30) { "0 " } else { "254 " };
    let cells: String = (0..900).map(cell).collect();
    write(&folder.path().join("map.pgm"), &format!("P2\n30 30\n255\n{cells}"));
    let mut app = app_after_start(&file, "dqn");
    let (scenario, preset) = (map.display().to_string(), folder.path().join("none.ron"));
    app.command(Command::StartTraining { scenario, preset: preset.display().to_string(), seed: 9 });
    app.frame(FRAME);
    assert!(has_notice(&app, "none.ron: no such file"), "{:?}", app.notices());
    write(&file, "(name: \"Mine\")");
    wait(&mut app, "training starts", |app| app.shown().0.scenario.name == "Mine");
}

#[test]
fn questionable_settings_are_reported_until_another_training_run_starts() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let hangar = folder.path().join("hangar.ron");
    write(&hangar, "(name: \"Hangar\", enclosure: Rectangle(width_m: 30.0, height_m: 30.0))");
    let mut app = HeadlessApp::new(options(&hangar));
    app.frame(FRAME);
    let text = "hangar.ron: `task.max_episode_steps` is 500: ";
    assert!(has_notice(&app, text) && has_notice(&app, "% of the goals"), "{:?}", app.notices());
    let scenario = Arc::new(Scenario::clone(&app.shown().0.scenario));
    app.command(Command::ApplyScenario { scenario, from: "empty".into(), restart: false });
    app.frame(FRAME);
    assert!(!has_notice(&app, text), "the scenario is from another file now: {:?}", app.notices());
    let text = "empty: `task.max_episode_steps` is 500: ";
    assert!(has_notice(&app, text), "the notice names that file: {:?}", app.notices());
    let scenario = "scenario-1".to_owned();
    app.command(Command::StartTraining { scenario, preset: "fast".into(), seed: 0 });
    app.frame(FRAME);
    assert!(!has_notice(&app, text), "another training run removes it: {:?}", app.notices());
}

#[test]
fn fixing_a_file_discards_no_training_worth_keeping() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let file = folder.path().join("mine.ron");
    write(&file, "(nam: \"Mine\")");
    let mut app = HeadlessApp::new(StartOptions { pace: Pace::Full, ..StartOptions::default() });
    app.frame(Duration::from_millis(10));
    app.command(Command::Open(file.clone()));
    wait(&mut app, "the training is worth keeping", |app| app.shown().1.env_steps > 21_000);
    write(&file, "(name: \"Mine 0\")");
    wait(&mut app, "the fix is reported", |app| has_notice(app, "the file is valid now"));
    write(&file, "(name: \"Mine 1\")");
    let_files_be_checked(&mut app);
    let steps = app.steps();
    wait(&mut app, "training continues", |app| app.steps() > steps + 3_000);
    assert_eq!(app.shown().0.scenario.name, "Scenario I");
}

#[test]
fn an_edited_scenario_continues_or_restarts_the_training() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let run = folder.path().join("run");
    let mut app = HeadlessApp::new(StartOptions { seed: 4, ..StartOptions::default() });
    app.command(Command::Pause(true));
    app.step_to(60);
    let mut edited = Scenario::clone(&app.shown().0.scenario);
    edited.obstacles[0].position_m = vec2(0.9, 0.9);
    let apply = |scenario: &Scenario, restart| Command::ApplyScenario {
        scenario: Arc::new(scenario.clone()),
        from: "scenario-1".into(),
        restart,
    };
    let env_steps = app.shown().1.env_steps;
    app.command(Command::SetMode(SessionMode::Test));
    app.frame(Duration::from_millis(10));
    app.command(apply(&edited, false));
    app.frame(Duration::from_millis(10));
    assert_eq!(app.error_notices(), Vec::<String>::new());
    assert_eq!(app.shown().0.scenario.obstacles[0].position_m, vec2(0.9, 0.9));
    assert_eq!(
        (app.shown().1.mode, app.shown().1.env_steps),
        (SessionMode::Test, env_steps),
        "training is kept"
    );
    assert!(app.shown().1.scenario_modified && !app.shown().1.is_paper_scenario_1);
    app.command(Command::SetMode(SessionMode::Train));
    app.command(Command::Pause(true));
    app.step_to(120);
    app.command(Command::Save(SaveKind::Run, run.clone()));
    app.frame(Duration::from_millis(10));
    assert_eq!(app.error_notices(), Vec::<String>::new());
    assert_eq!(verify(&run), Ok(ReplayResult { steps: 120, interventions: 1, bit_identical: true }));

    // Invalid and unsuitable scenarios are rejected, and nothing changes.
    let mut invalid = edited.clone();
    invalid.obstacles[0].position_m = vec2(1.95, 0.9);
    app.command(apply(&invalid, false));
    app.frame(Duration::from_millis(10));
    assert!(has_notice(&app, "outside the enclosure"), "{:?}", app.error_notices());
    let editor = app.view_state().editor.as_ref().expect("the edited scenario is not lost");
    assert_eq!(**editor.scenario(), invalid);
    app.command(apply(
        &Scenario {
            lidar: wayfield::scenario::Lidar { beams: 12, ..edited.lidar.clone() },
            ..edited.clone()
        },
        false,
    ));
    app.frame(Duration::from_millis(10));
    assert!(has_notice(&app, "12 beams"), "{:?}", app.error_notices());
    assert_eq!(app.steps(), 120);

    // With a noisy LIDAR every scan draws random numbers, so every position of a drag is recorded, although the training
    // started without noise.
    let mut noisy = edited.clone();
    noisy.lidar.noise_std_m = 0.02.into();
    app.command(apply(&noisy, false));
    for x_m in [0.05, 0.1] {
        app.command(Command::Move(MoveRequest { arena: 1, object: Movable::Robot, to_m: vec2(x_m, 0.0) }));
    }
    app.frame(Duration::from_millis(10));
    app.step_to(140);
    let noisy_run = folder.path().join("noisy");
    app.command(Command::Save(SaveKind::Run, noisy_run.clone()));
    app.frame(Duration::from_millis(10));
    assert_eq!(verify(&noisy_run), Ok(ReplayResult { steps: 140, interventions: 4, bit_identical: true }));

    app.command(apply(&edited, true));
    app.frame(Duration::from_millis(10));
    assert_eq!(app.shown().0.scenario.obstacles[0].position_m, vec2(0.9, 0.9));
    assert!(app.steps() < 60, "the training has restarted");
    assert!(app.shown().1.scenario_modified && !app.shown().1.is_paper_scenario_1);
}

#[test]
fn a_restarted_run_records_the_version_that_restarted_it() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let run = folder.path().join("run");
    let mut app = HeadlessApp::new(StartOptions::default());
    app.command(Command::Pause(true));
    app.step_to(60);
    app.command(Command::Save(SaveKind::Run, run.clone()));
    app.frame(FRAME);
    let config = run.join("config.ron");
    let text = std::fs::read_to_string(&config).expect("the run was saved");
    let field = |version: &str| format!("version: \"{version}\"");
    let older = text.replacen(&field(env!("CARGO_PKG_VERSION")), &field("0.0.1"), 1);
    std::fs::write(&config, older).expect("the file can be written");
    app.command(Command::Open(run));
    app.frame(FRAME);
    assert_eq!(app.run().config.version, "0.0.1", "the run was opened: {:?}", app.error_notices());
    let scenario = app.shown().0.scenario.clone();
    app.command(Command::ApplyScenario { scenario, from: "scenario-1".into(), restart: true });
    app.frame(FRAME);
    assert_eq!(app.run().config.version, env!("CARGO_PKG_VERSION"));
}

#[test]
fn training_continues_in_an_edited_scenario_in_which_the_compared_policy_cannot_drive() {
    let mut app = HeadlessApp::new(StartOptions { paused: true, ..StartOptions::default() });
    app.frame(Duration::from_millis(10));
    app.command(Command::OpenExpert);
    app.frame(Duration::from_millis(10));
    assert_eq!(app.shown().1.mode, SessionMode::Compare);
    let mut edited = Scenario::clone(&app.shown().0.scenario);
    edited.robot.motions.reverse();
    app.command(Command::ApplyScenario {
        scenario: Arc::new(edited.clone()),
        from: "empty".into(),
        restart: false,
    });
    app.frame(Duration::from_millis(10));
    assert!(has_notice(&app, "the policy's card says"), "{:?}", app.notices());
    let status = &app.shown().1;
    assert_eq!((status.mode, status.scenario_from.as_str()), (SessionMode::Train, "empty"));
    assert_eq!(app.shown().0.scenario.robot.motions, edited.robot.motions);
    assert_eq!(app.journal().entries.len(), 1);
}

#[test]
fn an_edited_scenario_is_saved_with_its_comments_and_can_be_opened_while_invalid() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let file = folder.path().join("mine.ron");
    write(&file, &scenario_text(0.6));
    let mut app = HeadlessApp::new(StartOptions { paused: true, ..options(&file) });
    app.frame(Duration::from_millis(10));
    let mut edited = Scenario::clone(&app.shown().0.scenario);
    edited.obstacles[0].position_m = vec2(3.0, 0.6);
    let scenario = Arc::new(edited.clone());
    let based_on = file.display().to_string();
    app.command(Command::SaveScenario { scenario: scenario.clone(), based_on, path: Some(file.clone()) });
    app.frame(Duration::from_millis(10));
    let saved = std::fs::read_to_string(&file).expect("the file exists");
    assert_eq!(saved, scenario_text(3.0), "only one number has changed");
    let saved = (file.display().to_string(), scenario.clone());
    assert_eq!(app.shown().1.saved_scenario, Some(saved.clone()));
    assert_eq!(app.editor_replies(), [EditorReply::Saved { file: saved.0, scenario: saved.1 }]);
    // The errors of the saved scenario are shown in the editor only.
    let_files_be_checked(&mut app);
    assert_eq!(app.error_notices(), Vec::<String>::new());
    // Each change made by another program is overwritten only when the user asks twice.
    let based_on = file.display().to_string();
    for (k, changed_x_m) in [Some(1.1), Some(1.2), None].into_iter().enumerate() {
        if let Some(x_m) = changed_x_m {
            write(&file, &scenario_text(x_m));
        }
        let (scenario, based_on) = (scenario.clone(), based_on.clone());
        app.command(Command::SaveScenario { scenario, based_on, path: Some(file.clone()) });
        app.frame(Duration::from_millis(10));
        let there = std::fs::read_to_string(&file).expect("the file exists");
        assert_eq!(there, scenario_text(changed_x_m.unwrap_or(3.0)), "request {}", k + 1);
        assert_eq!(has_notice(&app, "another program has changed this file"), changed_x_m.is_some());
    }
    app.command(Command::OpenInEditor(Some(file.clone())));
    app.frame(Duration::from_millis(10));
    let opened = EditorReply::Opened { from: file.display().to_string(), scenario: Arc::new(edited) };
    assert_eq!(app.editor_replies().last(), Some(&opened));
    app.command(Command::OpenInEditor(Some("doorway".into())));
    app.frame(Duration::from_millis(10));
    let replies = app.editor_replies();
    assert!(matches!(&replies[..], [EditorReply::Opened { from, .. }] if from == "doorway"), "{replies:?}");
    assert_eq!(app.error_notices(), Vec::<String>::new());
}

#[test]
fn a_change_of_the_file_that_the_editor_overwrites_is_not_adopted() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let file = folder.path().join("mine.ron");
    write(&file, &scenario_text(0.6));
    let mut app = HeadlessApp::new(StartOptions { paused: true, ..options(&file) });
    let_files_be_checked(&mut app);
    write(&file, &scenario_text(1.1));
    let_files_be_checked(&mut app);
    let text = "the changed scenario runs when the next episode ends";
    assert!(has_notice(&app, text), "{:?}", app.notices());
    let scenario = Arc::new(Scenario::parse(&scenario_text(0.9), "mine.ron").expect("a scenario"));
    // The first request is refused, because another program has changed the file.
    for _ in 0..2 {
        let (scenario, based_on) = (scenario.clone(), file.display().to_string());
        app.command(Command::SaveScenario { scenario, based_on, path: Some(file.clone()) });
        app.frame(FRAME);
    }
    assert_eq!(std::fs::read_to_string(&file).expect("the file exists"), scenario_text(0.9));
    assert!(!has_notice(&app, text), "{:?}", app.notices());
    app.step_to(60);
    assert_eq!((x_m(&app), app.error_notices()), (0.6, Vec::new()), "an episode has at most 40 steps");
}

#[test]
fn a_saved_scenario_that_cannot_be_applied_still_counts_as_saved_when_the_editor_opens_again() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let file = folder.path().join("mine.ron");
    let from = file.display().to_string();
    let mut app = HeadlessApp::new(StartOptions { paused: true, ..StartOptions::default() });
    app.frame(FRAME);
    // At 3.0 m, the cylinder is outside the enclosure.
    let scenario = |x_m| {
        let mut scenario = Scenario::parse(&scenario_text(0.6), "mine.ron").expect("a scenario");
        scenario.obstacles[0].position_m.x = x_m;
        Arc::new(scenario)
    };
    let saved = scenario(3.0);
    app.command(Command::SaveScenario {
        scenario: saved.clone(),
        based_on: from.clone(),
        path: Some(file.clone()),
    });
    app.frame(FRAME);
    for (scenario, is_unsaved) in [(saved, false), (scenario(3.1), true)] {
        app.command(Command::ApplyScenario { scenario, from: from.clone(), restart: false });
        app.frame(FRAME);
        assert!(has_notice(&app, "outside the enclosure"), "{:?}", app.error_notices());
        let editor = app.view_state().editor.as_ref().expect("the editor is open");
        assert_eq!((editor.from(), editor.has_unsaved_changes()), (from.as_str(), is_unsaved));
    }
}

#[test]
fn applying_an_edited_scenario_does_not_hide_a_change_of_its_file_by_another_program() {
    for restart in [false, true] {
        let folder = tempfile::tempdir().expect("temporary folder");
        let file = folder.path().join("mine.ron");
        write(&file, &scenario_text(0.6));
        let mut app = HeadlessApp::new(StartOptions { paused: true, ..StartOptions::default() });
        app.frame(FRAME);
        app.command(Command::OpenInEditor(Some(file.clone())));
        app.frame(FRAME);
        write(&file, &scenario_text(1.1));
        let scenario = Arc::new(Scenario::parse(&scenario_text(0.9), "mine.ron").expect("a scenario"));
        let from = file.display().to_string();
        app.command(Command::ApplyScenario { scenario: scenario.clone(), from: from.clone(), restart });
        app.frame(FRAME);
        assert_eq!((x_m(&app), app.error_notices()), (0.9, Vec::new()), "restart: {restart}");
        assert!(app.scenario_modified(), "the scenario differs from its file");
        app.command(Command::SaveScenario { scenario, based_on: from, path: Some(file.clone()) });
        app.frame(FRAME);
        assert!(has_notice(&app, "another program has changed this file"), "restart: {restart}");
        assert_eq!(std::fs::read_to_string(&file).expect("the file exists"), scenario_text(1.1));
    }
}

#[test]
fn a_file_opened_in_the_editor_can_be_saved_again_after_a_copy_was_saved() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let (file, copy) = (folder.path().join("mine.ron"), folder.path().join("copy.ron"));
    write(&file, &scenario_text(0.6));
    let mut app = HeadlessApp::new(StartOptions { paused: true, ..StartOptions::default() });
    app.frame(Duration::from_millis(10));
    app.command(Command::OpenInEditor(Some(file.clone())));
    app.frame(Duration::from_millis(10));
    for (path, x_m) in [(&file, 0.7), (&copy, 0.8), (&file, 0.9)] {
        let scenario = Scenario::parse(&scenario_text(x_m), "mine.ron").expect("a scenario");
        let (scenario, based_on) = (Arc::new(scenario), file.display().to_string());
        app.command(Command::SaveScenario { scenario, based_on, path: Some(path.clone()) });
        app.frame(Duration::from_millis(10));
        assert_eq!(app.error_notices(), Vec::<String>::new(), "no other program has changed the file");
        assert_eq!(std::fs::read_to_string(path).expect("the file exists"), scenario_text(x_m));
    }
}

#[cfg(unix)]
#[test]
fn saving_through_a_link_keeps_the_link_and_the_permissions_of_the_file_behind_it() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().expect("temporary folder");
    let (file, behind) = (folder.path().join("mine.ron"), folder.path().join("repository.ron"));
    write(&behind, &scenario_text(0.6));
    std::fs::set_permissions(&behind, PermissionsExt::from_mode(0o640)).expect("permissions can be set");
    symlink("repository.ron", &file).expect("a link can be made");
    let mut app = HeadlessApp::new(StartOptions { paused: true, ..options(&file) });
    app.frame(Duration::from_millis(10));
    let mut edited = Scenario::clone(&app.shown().0.scenario);
    edited.obstacles[0].position_m = vec2(0.9, 0.6);
    let based_on = file.display().to_string();
    app.command(Command::SaveScenario { scenario: Arc::new(edited), based_on, path: Some(file.clone()) });
    app.frame(Duration::from_millis(10));
    assert_eq!(app.error_notices(), Vec::<String>::new());
    assert!(file.symlink_metadata().expect("the link").is_symlink());
    assert_eq!(std::fs::read_to_string(&behind).expect("the file exists"), scenario_text(0.9));
    assert_eq!(behind.metadata().expect("the file exists").permissions().mode() & 0o777, 0o640);
}
