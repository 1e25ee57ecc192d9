//! Tests of diverging training runs. Q-values beyond the return bound give a warning. A non-finite value stops the
//! run: the error names the step, the cause and a fix, and the last checkpoint is kept.

mod cli_support;
#[path = "support/divergent.rs"]
mod divergent;

use cli_support::{FAST, Workspace, edited, quick_fast};
use divergent::DIVERGENT;

#[test]
fn a_diverged_run_stops_and_keeps_the_last_checkpoint() {
    let workspace = Workspace::new();
    // The preset is valid, but the squared errors overflow.
    let overflow = edited(
        &quick_fast(),
        &[("reward_scale: 0.01", "reward_scale: 1e20"), ("Huber(delta: 1.0)", "MeanSquared")],
    );
    workspace.write("overflow.ron", overflow);
    let done = workspace.run("--train --preset overflow.ron --steps 20000 --out run");
    assert_eq!((done.status, done.stdout.as_str()), (Some(1), ""), "{}", done.stderr);
    let message = done.stderr.lines().last().unwrap();
    for expected in [
        "error: learning diverged at gradient step 1 (env step 512): the loss is not finite, with TD errors of up to",
        "try a lower learning_rate or reward_scale, loss: Huber(delta: 1.0)",
        "checkpoint is in run/checkpoint",
    ] {
        assert!(message.contains(expected), "`{expected}` is not in: {}", done.stderr);
    }
    assert!(!done.stderr.contains("panicked"), "{}", done.stderr);
    // The only policy is that of the evaluation at env step 0. One with NaN weights could not be read.
    workspace.run_ok("--eval run/policy.safetensors --rounds 1 --episodes 2");
    assert!(workspace.rows("run/episodes.csv").len() > 1, "the episodes are recorded");

    // The checkpoint is valid: resumed from it, a run diverges again, but not if it stops before that step.
    assert_eq!(workspace.run("--train --resume run").status, Some(1));
    let stopped_earlier = workspace.run_ok("--train --resume run --steps 320 --json").json();
    assert_eq!(stopped_earlier["env_steps"], 320);
    workspace.run_ok("--eval run/policy.safetensors --rounds 1 --episodes 10");
}

#[test]
fn values_that_would_overflow_in_sums_are_rejected() {
    let workspace = Workspace::new();
    for (from, to, message) in [
        (
            "mu: 100.0",
            "mu: 1e38",
            "too_large.ron:11:13: `reward.mu` is 1e38; help: give a number from 0 to 1e9",
        ),
        ("reached: 250.0", "reached: -2e9", "`reward.reached` is -2e9; help: give a number from -1e9 to 1e9"),
        (
            "reward_scale: 0.01",
            "reward_scale: 1e21",
            "`learning.reward_scale` is 1000000000000000000000; help: give a number above 0, at most 100000000000000000000",
        ),
    ] {
        workspace.write("too_large.ron", edited(&quick_fast(), &[(from, to)]));
        let done = workspace.run("--train --preset too_large.ron --steps 2000 --out run");
        assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{}", done.stderr);
        assert!(done.stderr.contains(message), "`{message}` is not in: {}", done.stderr);
        assert!(!workspace.path("run").exists());
    }
}

#[test]
fn a_run_without_rewards_has_no_divergence_warning() {
    let workspace = Workspace::new();
    // The traditional reward is zero except at a goal or a collision; this preset sets these two to zero as well.
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
    assert!(!done.stderr.contains("diverge"), "{}", done.stderr);
    let warning =
        "warning: no-reward.ron: `reward` gives nothing for a goal, so nothing will be learned; help: ";
    assert!(done.stderr.contains(warning), "{}", done.stderr);
}

#[test]
fn q_values_beyond_the_return_bound_give_one_warning() {
    let workspace = Workspace::new();
    let fewer_evaluations = ("every_env_steps: 5000, episodes: 200", "every_env_steps: 4000, episodes: 20");
    let divergent = edited(&edited(FAST, &DIVERGENT), &[fewer_evaluations]);
    workspace.write("divergent.ron", divergent);
    let done = workspace.run_ok("--train --preset divergent.ron --steps 4000 --out run");
    let warnings: Vec<&str> = done.stderr.lines().filter(|line| line.contains("seems to diverge")).collect();
    let [warning] = warnings.as_slice() else {
        panic!("expected one warning, found {warnings:?}: {}", done.stderr)
    };
    for expected in [
        "warning: run: learning seems to diverge at gradient step",
        "no return can exceed",
        "try a lower learning_rate",
    ] {
        assert!(warning.contains(expected), "`{expected}` is not in: {warning}");
    }
    // A stable run with the same maximum reward gives no warning.
    workspace.write("stable.ron", quick_fast());
    let done = workspace.run_ok("--train --preset stable.ron --steps 4000 --out stable");
    assert!(!done.stderr.contains("warning"), "{}", done.stderr);
}
