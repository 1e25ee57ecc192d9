//! In the app, a policy whose card (the part of its file that describes the robot and LIDAR it was trained with) differs from
//! the current scenario is refused, or gives a notice with both values: in a comparison, and as the start of a training run.
#![cfg(feature = "gui")]

#[path = "support/headless_app.rs"]
mod headless_app;

use std::path::{Path, PathBuf};
use std::time::Duration;

use headless_app::HeadlessApp;
use wayfield::app::app_status::Severity;
use wayfield::app::commands::{Command, Pace, PolicySource, SessionMode};
use wayfield::app::session::StartOptions;

/// The shipped policy of Scenario I.
fn policy() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/policies/scenario-1.safetensors")
}

/// An app that trains in a scenario with `fields`.
fn app(folder: &Path, fields: &str) -> HeadlessApp {
    let file = folder.join("mine.ron");
    std::fs::write(&file, format!("(name: \"Mine\", {fields})")).expect("the file can be written");
    let scenario = file.display().to_string();
    let mut app =
        HeadlessApp::new(StartOptions { scenario, pace: Pace::Times(1.0), ..StartOptions::default() });
    frames(&mut app);
    app
}

fn frames(app: &mut HeadlessApp) {
    for _ in 0..5 {
        app.frame(Duration::from_millis(16));
    }
}

fn execute(app: &mut HeadlessApp, command: Command) {
    app.command(command);
    frames(app);
}

/// Starts a training run from the opened policy in the current scenario.
fn train_from_opened(app: &mut HeadlessApp) {
    let config = &app.run().config;
    let (scenario, preset) = (config.scenario_from.clone(), config.preset_from.clone());
    execute(app, Command::Transfer { policy: PolicySource::Opened, scenario, preset, seed: 1, epsilon: 0.5 });
}

/// The texts of the warnings and errors.
fn warnings_and_errors(app: &HeadlessApp) -> Vec<String> {
    let serious = app.notices().into_iter().filter(|notice| notice.severity != Severity::Info);
    serious.map(|notice| notice.text).collect()
}

/// The warnings and errors that contain `words`.
fn notices(app: &HeadlessApp, words: &str) -> Vec<String> {
    warnings_and_errors(app).into_iter().filter(|text| text.contains(words)).collect()
}

const RANGE: &str = "\n  LIDAR range: 3.5 m on its card, 0.9 m here";

#[test]
fn a_comparison_with_a_policy_of_another_lidar_lists_both_values() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut app = app(folder.path(), "lidar: (max_range_m: 0.9)");
    execute(&mut app, Command::Open(policy()));
    let warnings = notices(&app, RANGE);
    let expected = "scenario-1.safetensors: \"Mine\" differs from what this policy was trained with:";
    assert!(warnings.len() == 1 && warnings[0].starts_with(expected), "{warnings:?}");
    execute(&mut app, Command::SetMode(SessionMode::Train));
    assert_eq!(notices(&app, RANGE), [""; 0], "the warning ends with the comparison");
    execute(&mut app, Command::SetMode(SessionMode::Compare));
    assert_eq!(notices(&app, RANGE).len(), 1, "and comes back with it");

    // The same policy as the start of a training run.
    train_from_opened(&mut app);
    assert!(app.run().initial_policy.is_some(), "{:?}", warnings_and_errors(&app));
    assert_eq!(notices(&app, RANGE).len(), 1, "{:?}", warnings_and_errors(&app));
}

#[test]
fn a_policy_of_another_field_of_view_comes_with_a_warning() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut app = app(folder.path(), "lidar: (field_of_view_rad: 4.712)");
    execute(&mut app, Command::Open(policy()));
    let warnings = notices(&app, "LIDAR field of view: 6.2831855 rad on its card, 4.712 rad here");
    assert!(warnings.len() == 1 && warnings[0].starts_with("scenario-1.safetensors: "), "{warnings:?}");
}

#[test]
fn a_policy_whose_actions_are_mirrored_here_does_not_drive() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let motions = [-1.5, -0.75, 0.0, 0.75, 1.5].map(|w| format!("(v_m_s: 0.15, w_rad_s: {w:?})")).join(", ");
    let mut app = app(folder.path(), &format!("robot: (motions: [{motions}])"));
    execute(&mut app, Command::Open(policy()));
    let errors = notices(&app, "action 0 is 0.15 m/s 1.5 rad/s, but in \"Mine\" it is 0.15 m/s -1.5 rad/s");
    assert_eq!(errors.len(), 1, "{:?}", warnings_and_errors(&app));
    assert!(app.opened_files().policy.is_none(), "nothing was opened");
}

#[test]
fn a_policy_of_the_same_robot_and_lidar_gives_no_warning() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut app = app(folder.path(), "walls: [(corners_m: [(1.0, 1.0), (1.0, 1.5)])]");
    execute(&mut app, Command::Open(policy()));
    assert_eq!(notices(&app, "scenario-1.safetensors"), [""; 0]);
    train_from_opened(&mut app);
    assert!(app.run().initial_policy.is_some(), "{:?}", warnings_and_errors(&app));
    assert_eq!(notices(&app, "scenario-1.safetensors"), [""; 0]);
}
