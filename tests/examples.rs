//! Every example runs and prints the expected results.

use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs an example in a temporary folder, with the path of `argument` in it. Returns the example's stdout.
fn run(name: &str, argument: &str) -> String {
    run_in(tempfile::tempdir().expect("a temporary folder").path(), name, argument)
}

/// Like [`run`], in `folder`.
fn run_in(folder: &Path, name: &str, argument: &str) -> String {
    let test = std::env::current_exe().expect("the path of the test binary");
    // The test is target/release/deps/examples-<hash>, the example target/release/examples/<name>.
    let target: PathBuf = test.ancestors().nth(2).expect("the test is in target/<profile>/deps").into();
    let example = target.join("examples").join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    let output = Command::new(&example)
        .arg(folder.join(argument))
        .current_dir(folder)
        .output()
        .unwrap_or_else(|error| panic!("{}: {error}", example.display()));
    let (stdout, stderr) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{name} failed:\n{stdout}\n{stderr}");
    stdout.into_owned()
}

#[test]
fn learner_alone_learns_to_move_to_the_reward() {
    let printed = run("learner_alone", "");
    assert_eq!(printed.matches("Q(right)").count(), 3, "{printed}");
}

#[test]
fn vec_env_reports_reached_goals() {
    let printed = run("vec_env", "");
    // "1234 of 5678 episodes reached the goal; ..."
    let (reached, rest) = printed.split_once(' ').expect("a number of episodes");
    assert!(rest.contains("episodes reached the goal"), "{printed}");
    assert!(reached.parse::<usize>().is_ok_and(|reached| reached > 0), "{printed}");
}

#[test]
fn train_headless_reports_its_success_rate() {
    let printed = run("train_headless", "run");
    assert!(printed.contains("best success rate"), "{printed}");
}

#[test]
fn evaluate_policy_reports_more_than_90_percent_success() {
    let printed = run("evaluate_policy", "");
    // "success 98.0 % [...], ..."
    let percent = printed.strip_prefix("success ").and_then(|rest| rest.split(' ').next());
    let percent: Option<f64> = percent.and_then(|text| text.parse().ok());
    assert!(percent.is_some_and(|percent| percent > 90.0), "{printed}");
}

#[test]
fn custom_reward_logs_its_term_by_name() {
    let printed = run("custom_reward", "run");
    assert!(printed.contains("reward_smoothness"), "{printed}");
}

#[test]
fn custom_sensor_trains_a_policy_that_fails_without_the_sensor() {
    let printed = run("custom_sensor", "run");
    assert!(printed.contains("the policy has 30 inputs"), "{printed}");
    assert!(printed.contains("the policy was trained with `odometry:2`"), "{printed}");
}

#[test]
fn draw_scenario_writes_the_drawing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let printed = run_in(folder.path(), "draw_scenario", "scenario.svg");
    assert!(printed.contains("A box and a patrol with 2 obstacles"), "{printed}");
    let svg = std::fs::read_to_string(folder.path().join("scenario.svg")).expect("the drawing is there");
    assert!(svg.starts_with("<svg"), "{svg}");
}
