//! Tests of signals: which ones stop a run, what is saved, and the exit status.
#![cfg(target_os = "linux")]

mod cli_support;
#[path = "support/requirements.rs"]
mod requirements;

use std::io::Write;
use std::process::{Child, Command};
use std::thread::sleep;
use std::time::Duration;

use cli_support::{Workspace, edited, quick_fast, signal, wait_for_output, wait_until};
use requirements::Requirement;

/// A run that goes on until a signal stops it.
const ENDLESS: &str = "--train --preset fast.ron --steps 900000000 --checkpoint-every 0.05 --out run";

fn workspace() -> Workspace {
    let workspace = Workspace::new();
    workspace.write("fast.ron", quick_fast());
    workspace
}

fn size(workspace: &Workspace, file: &str) -> u64 {
    std::fs::metadata(workspace.path(file)).map_or(0, |file| file.len())
}

/// Waits until the run has written more rows than it has now.
fn wait_for_progress(workspace: &Workspace, child: &mut Child) {
    let before = size(workspace, "run/episodes.csv");
    wait_until(child, "more rows in episodes.csv", || size(workspace, "run/episodes.csv") > before);
}

/// Whether the process has a handler for SIGTERM.
fn handles_sigterm(process: u32) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap_or_default();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    caught.is_some_and(|mask| u64::from_str_radix(mask.trim(), 16).unwrap() >> 14 & 1 == 1)
}

/// Asserts that the run in `run` was saved unfinished, and that it resumes.
fn assert_saved(workspace: &Workspace) {
    let summary = workspace.json("run/summary.json");
    assert_eq!(summary["finished"], false);
    let steps = summary["env_steps"].as_u64().unwrap() + 16;
    workspace.run_ok(&format!("--resume run --steps {steps}"));
}

#[test]
fn a_signal_that_was_ignored_at_the_start_stays_ignored() {
    let workspace = workspace();
    let mut child = workspace.start_shell(&format!("trap '' HUP INT; exec $WAYFIELD {ENDLESS}"));
    for name in ["HUP", "INT"] {
        wait_for_progress(&workspace, &mut child);
        signal(&child, name);
    }
    wait_for_progress(&workspace, &mut child);
    signal(&child, "TERM");
    let done = wait_for_output(child);
    assert_eq!(done.status, Some(143), "the first signal that is not ignored counts: {}", done.stderr);
    assert_saved(&workspace);
}

#[test]
fn repeated_and_different_signals_save_as_one_does() {
    for (first, second, statuses) in [
        ("TERM", "TERM", [143, 143]),
        ("HUP", "TERM", [129, 129]),
        ("TERM", "INT", [143, 130]),
        ("INT", "INT", [130, 130]),
    ] {
        for pause in ["0", "0.1", "0.7"] {
            let workspace = workspace();
            let mut child = workspace.start(ENDLESS);
            wait_for_progress(&workspace, &mut child);
            let id = child.id();
            // The second signal may find the process gone.
            let both = format!("kill -{first} {id}; sleep {pause}; kill -{second} {id} || true");
            assert!(Command::new("sh").args(["-c", &both]).status().unwrap().success());
            let done = wait_for_output(child);
            // Of signals that arrive together, the one with the smaller number comes first, which may be the second one sent.
            let expected = if pause == "0" { &statuses[..] } else { &statuses[..1] };
            let case = format!("{first}, {second}, pause {pause}");
            assert!(
                done.status.is_some_and(|status| expected.contains(&status)),
                "{case}: {:?} {}",
                done.status,
                done.stderr
            );
            assert_saved(&workspace);
        }
    }
}

#[test]
fn signals_of_batch_systems_save_the_run() {
    for (name, status) in [("USR1", 138), ("USR2", 140), ("XCPU", 152)] {
        let workspace = workspace();
        let mut child = workspace.start(ENDLESS);
        wait_for_progress(&workspace, &mut child);
        signal(&child, name);
        let done = wait_for_output(child);
        assert_eq!(done.status, Some(status), "{name}: {}", done.stderr);
        assert!(done.stderr.contains(&format!("SIG{name}")), "{name}: {}", done.stderr);
        assert_saved(&workspace);
    }
}

#[test]
fn a_second_ctrl_c_in_the_terminal_ends_the_run_at_once() {
    let script = Requirement { commands: &["script"], packages: "bsdutils" };
    if !script.is_met() {
        return;
    }
    let workspace = workspace();
    // The evaluation after the last checkpoint takes much longer than the test.
    let rare_and_long = "every_env_steps: 100000000, episodes: 100000,";
    let slow = edited(&quick_fast(), &[("every_env_steps: 1500, episodes: 20,", rare_and_long)]);
    workspace.write("fast.ron", slow);
    let command = format!("script -qefc \"$WAYFIELD {ENDLESS}\" /dev/null");
    let mut child = workspace.start_shell(&command);
    let mut keyboard = child.stdin.take().unwrap();
    wait_for_progress(&workspace, &mut child);
    for _ in 0..2 {
        keyboard.write_all(b"\x03").unwrap();
        keyboard.flush().unwrap();
        // A second Ctrl-C within half a second would count as the first one.
        sleep(Duration::from_millis(1500));
    }
    let done = wait_for_output(child);
    assert_eq!(done.status, Some(130), "{}{}", done.stdout, done.stderr);
    assert!(done.stdout.contains("SIGINT: saving a checkpoint"), "{}", done.stdout);
    assert!(!workspace.path("run/summary.json").exists(), "the process did not wait for the evaluation");
    assert!(workspace.path("run/checkpoint/latest.bin").exists(), "earlier checkpoints are kept");
}

#[test]
fn an_evaluation_ends_with_the_status_of_its_signal() {
    let workspace = workspace();
    workspace.run_ok("--train --preset fast.ron --steps 1600 --out run");
    for (name, status) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        let mut child = workspace.start("--eval run/policy.safetensors --rounds 1000 --episodes 1000");
        let id = child.id();
        wait_until(&mut child, "the handlers are installed", || handles_sigterm(id));
        signal(&child, name);
        let done = wait_for_output(child);
        assert_eq!((done.status, done.stdout.as_str()), (Some(status), ""), "{name}: {}", done.stderr);
    }
}

#[test]
fn the_first_process_of_a_container_stops_too() {
    let inside = "unshare --map-root-user --pid --fork --kill-child";
    let tried = Command::new("sh").args(["-c", &format!("{inside} true")]).output();
    if !tried.is_ok_and(|output| output.status.success()) {
        requirements::report_skip(
            "`unshare --pid` is not permitted; help: run as root, or allow user namespaces",
        );
        return;
    }
    let workspace = workspace();
    workspace.run_ok("--train --preset fast.ron --steps 1600 --out run");
    let eval = "--eval run/policy.safetensors --rounds 1000 --episodes 1000";
    let mut child = workspace.start_shell(&format!("exec {inside} $WAYFIELD {eval}"));
    let children = format!("/proc/{0}/task/{0}/children", child.id());
    let first = || std::fs::read_to_string(&children).ok()?.trim().parse::<u32>().ok();
    // The kernel drops signals that the first process has no handler for.
    wait_until(&mut child, "its handlers are installed", || first().is_some_and(handles_sigterm));
    let sent = Command::new("kill").args(["-TERM", &first().unwrap().to_string()]).status();
    assert!(sent.unwrap().success());
    let done = wait_for_output(child);
    assert_eq!(done.status, Some(143), "{}", done.stderr);
}
