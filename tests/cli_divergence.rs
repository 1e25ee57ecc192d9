//! Divergence: a non-finite value stops the run with its step, cause and a fix, and keeps the last
//! checkpoint; before that, a warning is printed while learning diverges.

mod cli_support;
#[path = "support/divergent.rs"]
mod divergent;

use cli_support::{FAST, Workspace, edited, quick_fast};
use divergent::DIVERGENT;

#[test]
fn learning_that_diverges_stops_and_keeps_the_last_checkpoint() {
    let workspace = Workspace::new();
    // Valid by every check, but the squared errors overflow.
    let overflow = edited(
        &quick_fast(),
        &[("reward_scale: 0.01", "reward_scale: 1e20"), ("Huber(delta: 1.0)", "MeanSquared")],
    );
    workspace.write("overflow.ron", overflow);
    let done = workspace.run("--train --preset overflow.ron --steps 20000 --out run");
    assert_eq!((done.status, done.stdout.as_str()), (Some(1), ""), "{}", done.stderr);
    let message = done.stderr.lines().last().unwrap();
    for needle in [
        "error: learning diverged at gradient step 1 (env step 512): the loss is not finite, with TD errors of up to",
        "try a lower learning_rate or reward_scale, loss: Huber(delta: 1.0)",
        "checkpoint is in run/checkpoint",
    ] {
        assert!(message.contains(needle), "`{needle}` is not in: {}", done.stderr);
    }
    assert!(!done.stderr.contains("panicked"), "{}", done.stderr);
    assert!(!workspace.path("run/policy.safetensors").exists(), "no policy with NaN weights is saved");
    assert!(workspace.rows("run/episodes.csv").len() > 1, "the episodes are recorded");

    // A resumed run diverges at the same step; one that stops earlier doesn't, so the checkpoint is valid.
    assert_eq!(workspace.run("--train --resume run").status, Some(1));
    let before = workspace.run_ok("--train --resume run --steps 320 --json").json();
    assert_eq!(before["env_steps"], 320);
    workspace.run_ok("--eval run/policy.safetensors --rounds 1 --episodes 10");
}

#[test]
fn values_whose_sums_would_overflow_are_rejected() {
    let workspace = Workspace::new();
    for (from, to, message) in [
        (
            "mu: 100.0",
            "mu: 1e38",
            "steep.ron:11:13: `reward.mu` is 1e38; give a number between -1e9 and 1e9",
        ),
        ("reached: 250.0", "reached: -2e9", "`reward.reached` is -2e9; give a number between -1e9 and 1e9"),
        (
            "reward_scale: 0.01",
            "reward_scale: 1e21",
            "`learning.reward_scale` 1000000000000000000000 is out of range",
        ),
    ] {
        workspace.write("steep.ron", edited(&quick_fast(), &[(from, to)]));
        let done = workspace.run("--train --preset steep.ron --steps 2000 --out run");
        assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{}", done.stderr);
        assert!(done.stderr.contains(message), "`{message}` is not in: {}", done.stderr);
        assert!(!workspace.path("run").exists());
    }
}

#[test]
fn without_any_reward_there_is_no_divergence_warning() {
    let workspace = Workspace::new();
    // The traditional reward is zero until a goal or a collision, and here these give zero as well.
    let no_reward = edited(
        &quick_fast(),
        &[
            ("kind: Optimized", "kind: Traditional"),
            ("reached: 250.0", "reached: 0.0"),
            ("collided: -200.0", "collided: 0.0"),
        ],
    );
    workspace.write("no-reward.ron", no_reward);
    let done = workspace.run_ok("--train --preset no-reward.ron --steps 4000 --out run");
    assert!(!done.stderr.contains("warning"), "{}", done.stderr);
}

#[test]
fn q_values_beyond_the_return_bound_are_warned_about_once() {
    let workspace = Workspace::new();
    let fewer_evaluations = ("every_env_steps: 5000, episodes: 200", "every_env_steps: 4000, episodes: 20");
    let divergent = edited(&edited(FAST, &DIVERGENT), &[fewer_evaluations]);
    workspace.write("divergent.ron", divergent);
    let done = workspace.run_ok("--train --preset divergent.ron --steps 4000 --out run");
    let warnings: Vec<&str> = done.stderr.lines().filter(|line| line.contains("seems to diverge")).collect();
    let [warning] = warnings.as_slice() else { panic!("one warning, not {warnings:?}: {}", done.stderr) };
    for needle in [
        "warning: run: learning seems to diverge at gradient step",
        "no return can exceed",
        "try a lower learning_rate",
    ] {
        assert!(warning.contains(needle), "`{needle}` is not in: {warning}");
    }
    // A stable run with the same maximum reward has no warning.
    workspace.write("stable.ron", quick_fast());
    let done = workspace.run_ok("--train --preset stable.ron --steps 4000 --out stable");
    assert!(!done.stderr.contains("warning"), "{}", done.stderr);
}
