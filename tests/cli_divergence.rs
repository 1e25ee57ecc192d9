//! Numbers that go wrong, in the real program: caught where they arise, told with step, cause and mend, the checkpoint kept;
//! and a warning while learning diverges, before it comes to that.

mod cli_support;
#[path = "support/divergent.rs"]
mod divergent;

use cli_support::{FAST, Workspace, edited, quick_fast};
use divergent::DIVERGENT;

#[test]
fn learning_that_diverges_stops_and_keeps_the_last_checkpoint() {
    let workspace = Workspace::new();
    // Allowed by every check, and hopeless: the squares of such errors are no numbers any more.
    let hopeless = edited(
        &quick_fast(),
        &[("reward_scale: 0.01", "reward_scale: 1e20"), ("Huber(delta: 1.0)", "MeanSquared")],
    );
    workspace.write("hopeless.ron", hopeless);
    let done = workspace.run("--train --preset hopeless.ron --steps 20000 --out run");
    assert_eq!((done.status, done.stdout.as_str()), (Some(1), ""), "{}", done.stderr);
    let message = done.stderr.lines().last().unwrap();
    for needle in [
        "error: learning diverged at gradient step 1 (env step 512): the loss is not finite, with TD errors of up to",
        "try a lower learning_rate or reward_scale, loss: Huber(delta: 1.0)",
        "checkpoint is kept in run/checkpoint",
    ] {
        assert!(message.contains(needle), "`{needle}` is not in: {}", done.stderr);
    }
    assert!(!done.stderr.contains("panicked"), "{}", done.stderr);
    assert!(
        !workspace.path("run/policy.safetensors").exists(),
        "no policy of NaNs is left for anyone to use"
    );
    assert!(workspace.rows("run/episodes.csv").len() > 1, "what was driven is on record");

    // Going on diverges in the same place; stopping before does not, so the checkpoint is sound.
    assert_eq!(workspace.run("--train --resume run").status, Some(1));
    let before = workspace.run_ok("--train --resume run --steps 320 --json").json();
    assert_eq!(before["env_steps"], 320);
    workspace.run_ok("--eval run/policy.safetensors --rounds 1 --episodes 10");
}

#[test]
fn numbers_so_large_that_sums_of_them_are_none_are_refused_at_once() {
    let workspace = Workspace::new();
    for (from, to, told) in [
        (
            "mu: 100.0",
            "mu: 1e38",
            "steep.ron:11:13: `reward.mu` is 1e38; give a number of at most 1e9 in size",
        ),
        ("reached: 250.0", "reached: -2e9", "`reward.reached` is -2e9; give a number of at most 1e9 in size"),
        (
            "reward_scale: 0.01",
            "reward_scale: 1e21",
            "`learning.reward_scale` 1000000000000000000000 is out of range",
        ),
    ] {
        workspace.write("steep.ron", edited(&quick_fast(), &[(from, to)]));
        let done = workspace.run("--train --preset steep.ron --steps 2000 --out run");
        assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{}", done.stderr);
        assert!(done.stderr.contains(told), "`{told}` is not in: {}", done.stderr);
        assert!(!workspace.path("run").exists());
    }
}

#[test]
fn where_nothing_is_rewarded_yet_no_q_value_is_too_large() {
    let workspace = Workspace::new();
    // The traditional reward is nothing at all up to the first target or collision, and here there is none.
    let none = edited(
        &quick_fast(),
        &[
            ("kind: Optimized", "kind: Traditional"),
            ("reached: 250.0", "reached: 0.0"),
            ("collided: -200.0", "collided: 0.0"),
        ],
    );
    workspace.write("none.ron", none);
    let done = workspace.run_ok("--train --preset none.ron --steps 4000 --out run");
    assert!(!done.stderr.contains("warning"), "{}", done.stderr);
}

#[test]
fn q_values_beyond_any_return_are_warned_of_once_and_the_run_goes_on() {
    let workspace = Workspace::new();
    let seldom = ("every_env_steps: 5000, episodes: 200", "every_env_steps: 4000, episodes: 20");
    let divergent = edited(&edited(FAST, &DIVERGENT), &[seldom]);
    workspace.write("wild.ron", divergent);
    let done = workspace.run_ok("--train --preset wild.ron --steps 4000 --out run");
    let warnings: Vec<&str> = done.stderr.lines().filter(|line| line.contains("seems to diverge")).collect();
    let [warning] = warnings.as_slice() else { panic!("one warning, not {warnings:?}: {}", done.stderr) };
    for needle in [
        "warning: run: learning seems to diverge at gradient step",
        "no return can exceed",
        "try a lower learning_rate",
    ] {
        assert!(warning.contains(needle), "`{needle}` is not in: {warning}");
    }
    // A training as it should be has none, with the same largest reward.
    workspace.write("sound.ron", quick_fast());
    let done = workspace.run_ok("--train --preset sound.ron --steps 4000 --out sound");
    assert!(!done.stderr.contains("warning"), "{}", done.stderr);
}
