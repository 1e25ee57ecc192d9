//! Every example runs, and prints what it promises.

use std::path::PathBuf;
use std::process::Command;

/// Runs an example with a path in a fresh folder as its argument; gives what it printed.
fn run(name: &str, argument: &str) -> String {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let test = std::env::current_exe().expect("the test has a path");
    // target/release/deps/examples-<hash> and target/release/examples/<name>
    let target: PathBuf = test.ancestors().nth(2).expect("it is in target/<profile>/deps").into();
    let example = target.join("examples").join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    let output = Command::new(&example)
        .arg(folder.path().join(argument))
        .current_dir(folder.path())
        .output()
        .unwrap_or_else(|error| panic!("{}: {error}", example.display()));
    let (stdout, stderr) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{name} failed:\n{stdout}\n{stderr}");
    stdout.into_owned()
}

#[test]
fn the_learner_alone_finds_the_reward() {
    let printed = run("learner_alone", "");
    assert_eq!(printed.matches("Q(right)").count(), 3, "{printed}");
}

#[test]
fn the_vectorised_environment_steps() {
    let printed = run("vec_env", "");
    assert!(printed.contains("episodes reached the goal"), "{printed}");
}

#[test]
fn a_headless_training_reports_its_success_rate() {
    let printed = run("train_headless", "run");
    assert!(printed.contains("best success rate"), "{printed}");
}

#[test]
fn a_shipped_policy_is_evaluated() {
    let printed = run("evaluate_policy", "");
    assert!(printed.starts_with("success 9") || printed.starts_with("success 100"), "{printed}");
}

#[test]
fn a_custom_reward_is_logged_by_name() {
    let printed = run("custom_reward", "run");
    assert!(printed.contains("reward_smoothness"), "{printed}");
}

#[test]
fn a_custom_sensor_is_recorded_and_its_absence_refused() {
    let printed = run("custom_sensor", "run");
    assert!(printed.contains("takes 30 numbers"), "{printed}");
    assert!(printed.contains("the policy was trained with `odometry:2`"), "{printed}");
}

#[test]
fn a_scenario_is_drawn() {
    let printed = run("draw_scenario", "scenario.svg");
    assert!(printed.contains("A box and a sentry with 2 obstacles"), "{printed}");
}
