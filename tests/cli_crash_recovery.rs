//! Tests of crash recovery: after any kind of crash, the run folder is consistent, and the resumed run equals an
//! uninterrupted one.
#![cfg(target_os = "linux")]

mod cli_support;
#[path = "support/requirements.rs"]
mod requirements;
#[path = "support/small_disk.rs"]
mod small_disk;

use std::collections::BTreeSet;
use std::process::Command;
use std::sync::Mutex;
use std::time::Duration;

use cli_support::event_files::{assert_curves_never_go_back, curves, event_files};
use cli_support::messages::rejection;
use cli_support::{
    SCENARIO_1, Workspace, quick_fast, signal, wait_for_output, wait_until, with_short_episodes,
};
use small_disk::{can_mount, with_small_disk};
use wayfield::run::write_points::WRITE_POINTS;

/// The arguments of a run of about half a second.
const RUN: &str = "--train --scenario one.ron --preset fast.ron --seed 9 --steps 6400";
/// The arguments that make a run write checkpoints all the time.
const OFTEN: &str = "--checkpoint-every 0.01";
/// The number of runs that are killed, each at a different moment.
const MOMENTS: u32 = 12;

/// A workspace with the uninterrupted run.
fn workspace() -> Workspace {
    let workspace = Workspace::new();
    workspace.write("fast.ron", quick_fast());
    workspace.write("one.ron", with_short_episodes(SCENARIO_1));
    workspace.run_ok(&format!("{RUN} --out uninterrupted"));
    workspace
}

/// The sorted names in a folder of the workspace.
fn names(workspace: &Workspace, folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(workspace.path(folder)).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Asserts that no temporary file is left in the run folder `run`.
fn assert_no_temporary_files(workspace: &Workspace, run: &str) {
    let mut left = names(workspace, run);
    left.extend(names(workspace, &format!("{run}/checkpoint")));
    assert!(!left.iter().any(|name| name.starts_with('.')), "{run}: temporary files are left: {left:?}");
}

fn copy_folder(workspace: &Workspace, from: &str, to: &str) {
    let copied = Command::new("cp").arg("-r").args([workspace.path(from), workspace.path(to)]).status();
    assert!(copied.unwrap().success());
}

/// The arguments of a run that the test of the write points aborts. It starts from a policy, which is one more file to write.
const ABORTED: &str = "--train --scenario one.ron --preset fast.ron --init init.safetensors --seed 9";
/// The env steps after which an aborted run, once resumed, is compared with the uninterrupted one. This is more than
/// the `--steps` of the aborted process, so that there is something to resume even if it is aborted near its end.
const ENV_STEPS: u32 = 3200;

/// A training process to abort.
#[derive(Clone, Copy, Debug)]
enum Process {
    /// The first process of a run.
    First,
    /// A process that resumes a run with all three checkpoints.
    Resuming,
}

/// Aborts `process` at each pass of the write point with the index `point`, resumes the run, and compares the result with
/// the uninterrupted run. Returns the number of passes.
fn abort_at_each_pass(workspace: &Workspace, point: usize, process: Process) -> u32 {
    for pass in 1..100 {
        let at = format!("{}:{pass}", WRITE_POINTS[point]);
        let run = format!("{process:?}-{point}-{pass}");
        let command = match process {
            Process::First => format!("{ABORTED} --steps 1600 --out {run}"),
            Process::Resuming => {
                copy_folder(workspace, "three-checkpoints", &run);
                format!("--train --resume {run} --steps 2560")
            }
        };
        let aborted = workspace.run_until(&command, &at);
        if aborted.status == Some(0) {
            return pass - 1;
        }
        assert_eq!(aborted.status, None, "{at}: wayfield {command}\n{}", aborted.stderr);
        let again = if workspace.path(&format!("{run}/config.ron")).exists() {
            format!("--train --resume {run} --steps {ENV_STEPS}")
        } else {
            format!("{ABORTED} --steps {ENV_STEPS} --out {run}")
        };
        let resumed = workspace.run_ok(&again);
        assert!(!resumed.stderr.contains("warning"), "{at}: wayfield {command}\n{}", resumed.stderr);
        workspace.assert_same_run("uninterrupted", &run);
        assert_no_temporary_files(workspace, &run);
        std::fs::remove_dir_all(workspace.path(&run)).unwrap();
    }
    panic!("{}: more than 99 passes", WRITE_POINTS[point]);
}

#[test]
fn a_run_aborted_at_any_write_point_resumes_to_the_uninterrupted_result() {
    let workspace = workspace();
    std::fs::rename(
        workspace.path("uninterrupted/policy-last.safetensors"),
        workspace.path("init.safetensors"),
    )
    .unwrap();
    std::fs::remove_dir_all(workspace.path("uninterrupted")).unwrap();
    workspace.run_ok(&format!("{ABORTED} --steps {ENV_STEPS} --out uninterrupted"));
    workspace.run_ok(&format!("{ABORTED} --steps 1600 --out three-checkpoints"));
    workspace.run_ok("--train --resume three-checkpoints --steps 1920");
    assert_eq!(
        names(&workspace, "three-checkpoints/checkpoint"),
        ["latest.bin", "lock", "older.bin", "previous.bin"]
    );
    let jobs = Mutex::new(
        (0..WRITE_POINTS.len()).flat_map(|point| [(point, Process::First), (point, Process::Resuming)]),
    );
    let passed = Mutex::new(BTreeSet::new());
    let work = || {
        loop {
            let Some((point, process)) = jobs.lock().unwrap().next() else { return };
            if abort_at_each_pass(&workspace, point, process) > 0 {
                passed.lock().unwrap().insert(WRITE_POINTS[point]);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(2, usize::from) {
            scope.spawn(work);
        }
    });
    assert_eq!(passed.into_inner().unwrap(), BTreeSet::from(WRITE_POINTS), "every write point is reached");
}

#[test]
fn a_run_killed_at_any_moment_resumes_to_the_uninterrupted_result() {
    let workspace = workspace();
    let began = std::time::Instant::now();
    workspace.run_ok(&format!("{RUN} {OFTEN} --out timed"));
    let duration = began.elapsed();
    workspace.assert_same_run("uninterrupted", "timed");
    let (mut killed_before_start, mut killed) = (0, 0);
    for moment in 0..MOMENTS {
        // The golden ratio spreads the moments over the whole run, so that they do not align with any period.
        let fraction = (f64::from(moment) * 0.618_033_988_749_894_9).fract();
        let run = format!("killed-{moment}");
        let mut child = workspace.start(&format!("{RUN} {OFTEN} --out {run}"));
        std::thread::sleep(Duration::from_secs_f64(duration.as_secs_f64() * fraction));
        if child.try_wait().unwrap().is_none() {
            signal(&child, "KILL");
            killed += u32::from(wait_for_output(child).status.is_none());
        }
        if !workspace.path(&format!("{run}/config.ron")).exists() {
            // There is nothing to resume; the same command starts again.
            killed_before_start += 1;
            workspace.run_ok(&format!("{RUN} {OFTEN} --out {run}"));
        } else if !workspace.path(&format!("{run}/summary.json")).exists() {
            let resumed = workspace.run(&format!("--train --resume {run} {OFTEN}"));
            assert_eq!(resumed.status, Some(0), "{run}: {}", resumed.stderr);
            assert!(
                !resumed.stderr.contains("warning"),
                "{run}: no checkpoint is damaged: {}",
                resumed.stderr
            );
        }
        workspace.assert_same_run("uninterrupted", &run);
        assert_no_temporary_files(&workspace, &run);
    }
    assert!(
        killed >= MOMENTS / 2,
        "only {killed} of {MOMENTS} runs were killed, {killed_before_start} of them before they started"
    );
}

#[test]
fn a_damaged_checkpoint_is_replaced_by_the_previous_one() {
    let workspace = workspace();
    workspace.run_ok(&format!("{RUN} --out run"));
    let resume =
        |name: &str, steps: u32| workspace.run_ok(&format!("--train --resume {name} --steps {steps}"));
    resume("run", 8000);
    resume("run", 9600);
    resume("uninterrupted", 8000);
    resume("uninterrupted", 9600);
    workspace.assert_same_run("uninterrupted", "run");
    assert_eq!(names(&workspace, "run/checkpoint"), ["latest.bin", "lock", "older.bin", "previous.bin"]);
    for (damaged, env_steps) in [("latest", 8000), ("previous", 6400)] {
        let file = format!("run/checkpoint/{damaged}.bin");
        let mut bytes = workspace.read(&file);
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        workspace.write(&file, bytes);
        let copy = format!("from-{env_steps}");
        copy_folder(&workspace, "run", &copy);
        let done = resume(&copy, 9600);
        let warnings: Vec<&str> = done.stderr.lines().filter(|line| line.contains("damaged")).collect();
        let unreadable: &[&str] = if damaged == "latest" { &["latest"] } else { &["latest", "previous"] };
        assert_eq!(warnings.len(), unreadable.len(), "{}", done.stderr);
        for (warning, name) in warnings.iter().zip(unreadable) {
            let start = format!("warning: {copy}/checkpoint/{name}.bin: the checkpoint is damaged");
            assert!(warning.starts_with(&start), "{warning}");
            let end = format!("; resuming from an older checkpoint, at {env_steps} env steps");
            assert!(warning.ends_with(&end), "{warning}");
        }
        workspace.assert_same_run("uninterrupted", &copy);
        assert!(
            names(&workspace, &format!("{copy}/checkpoint")).contains(&"latest.bin.damaged".to_owned()),
            "the damaged file is kept"
        );
        // The checkpoints written after that are valid.
        let resumed = resume(&copy, 9900);
        assert!(!resumed.stderr.contains("damaged"), "{}", resumed.stderr);
    }
}

#[test]
fn a_checkpoint_of_a_newer_version_is_left_alone() {
    let workspace = workspace();
    workspace.run_ok(&format!("{RUN} --out run"));
    workspace.run_ok("--train --resume run --steps 8000");
    // The version follows the 8 magic bytes.
    let mut newer = workspace.read("run/checkpoint/latest.bin");
    newer[8] = 99;
    workspace.write("run/checkpoint/latest.bin", newer);
    // This also checks that no file is created, renamed or changed.
    let error = rejection(&workspace, "--train --resume run --steps 9600");
    assert!(error.contains("was written by a newer wayfield: it has checkpoint version 99"), "{error}");
}

/// TensorBoard reads event files in the order of their names, and shows the points of each curve in the order it reads them.
#[test]
fn tensorboards_curves_never_go_back_after_kills_and_resumes() {
    let workspace = workspace();
    let run = workspace.path("run");
    let mut command = format!("{RUN} --checkpoint-every 0.2 --out run").replace("6400", "50000000");
    for kill in 1..=3_u32 {
        let checkpoint =
            || std::fs::metadata(run.join("checkpoint/older.bin")).and_then(|file| file.modified()).ok();
        let before = checkpoint();
        let mut child = workspace.start(&command);
        wait_until(&mut child, "a checkpoint of this process", || checkpoint() != before);
        wait_until(&mut child, "points after a checkpoint", || {
            let newest = event_files(&run).pop().and_then(|newest| newest.metadata().ok());
            newest.is_some_and(|file| file.len() > 20_000)
        });
        signal(&child, "KILL");
        wait_for_output(child);
        // As if the clock had been decades ahead, and was set back afterwards.
        let newest = event_files(&run).pop().unwrap();
        let renamed = run.join(format!("events.out.tfevents.{}.wayfield", 4_000_000_000 + 1000 * kill));
        std::fs::rename(newest, renamed).unwrap();
        command = "--train --resume run --checkpoint-every 0.2".into();
    }
    let mut child = workspace.start("--train --resume run");
    wait_until(&mut child, "a fourth event file", || event_files(&run).len() == 4);
    signal(&child, "TERM");
    wait_for_output(child);
    assert_curves_never_go_back(&run);

    // Every point is there once, and no point is missing.
    let rows = workspace.rows("run/episodes.csv");
    let expected: Vec<u64> = rows.iter().map(|row| row["env_steps"].parse().unwrap()).collect();
    let steps = |tag: &str| -> Vec<u64> { curves(&run)[tag].iter().map(|point| point.0).collect() };
    assert_eq!(steps("episode/return"), expected);
    let rows = workspace.rows("run/evaluations.csv");
    let expected: Vec<u64> = rows.iter().map(|row| row["env_steps"].parse().unwrap()).collect();
    assert_eq!(steps("evaluation/success_rate"), expected);
}

#[test]
fn two_processes_cannot_write_in_one_run_folder() {
    let workspace = workspace();
    let mut child = workspace.start("--train --scenario one.ron --preset fast.ron --steps 3000000 --out run");
    wait_until(&mut child, "a checkpoint", || workspace.path("run/checkpoint/latest.bin").exists());
    for second_command in ["--train --resume run", "--train --scenario one.ron --preset fast.ron --out run"] {
        let rejected = workspace.run(second_command);
        assert_eq!(
            (rejected.status, rejected.stdout.as_str()),
            (Some(2), ""),
            "{second_command}: {}",
            rejected.stderr
        );
        assert!(rejected.stderr.starts_with("error: run: "), "{}", rejected.stderr);
        let why = if second_command.contains("resume") {
            "another wayfield process is writing in it"
        } else {
            "already holds a run"
        };
        assert!(rejected.stderr.contains(why), "{}", rejected.stderr);
    }
    signal(&child, "TERM");
    assert_eq!(wait_for_output(child).status, Some(143));
    workspace.run_ok("--train --resume run --steps 3000001 --checkpoint-every 1000000 --json").json();
}

#[test]
fn a_full_disk_damages_nothing() {
    if !can_mount() {
        return;
    }
    let workspace = workspace();
    // The files written before the disk was full are complete. Once there is space, the run resumes.
    let done = with_small_disk(
        &workspace,
        "size=1m",
        &format!(
            "s=0; $WAYFIELD {RUN} {OFTEN} --out small/run 2>log || s=$?; echo $s; \
             mount -o remount,size=64m small; $WAYFIELD --train --resume small/run >/dev/null 2>resumed; cp -r small/run run"
        ),
    );
    assert_eq!(
        (done.status, done.stdout.as_str()),
        (Some(0), "1\n"),
        "{}{}",
        done.stderr,
        workspace.text("log")
    );
    let log = workspace.text("log");
    let message = log.lines().last().unwrap();
    for needle in [
        "error: small/run/",
        "can't be written",
        "No space left on device",
        "the last checkpoint is in small/run/checkpoint",
    ] {
        assert!(message.contains(needle), "`{needle}` is not in: {log}");
    }
    assert!(!log.contains("panicked"), "{log}");
    assert!(!workspace.text("resumed").contains("warning"), "{}", workspace.text("resumed"));
    workspace.assert_same_run("uninterrupted", "run");
}

#[test]
fn a_read_only_folder_is_rejected_before_the_run_starts() {
    if !can_mount() {
        return;
    }
    let workspace = workspace();
    let done = with_small_disk(
        &workspace,
        "size=1m",
        &format!("mount -o remount,ro small; s=0; $WAYFIELD {RUN} --out small/run || s=$?; echo $s"),
    );
    assert_eq!(done.stdout, "2\n", "{}", done.stderr);
    for needle in ["error: small/run: can't be written (Read-only file system", "give --out another folder"] {
        assert!(done.stderr.contains(needle), "{}", done.stderr);
    }
}

#[test]
fn links_in_a_run_folder_are_not_followed() {
    let workspace = workspace();
    workspace.run_ok("--train --scenario one.ron --preset fast.ron --episodes 20 --out run");
    workspace.write("precious.txt", "not part of a run");
    for name in ["episodes.csv", "checkpoint/lock", "policy.safetensors"] {
        let file = workspace.path(&format!("run/{name}"));
        let kept = std::fs::read(&file).expect("the run has this file");
        std::fs::remove_file(&file).expect("the file can be removed");
        std::os::unix::fs::symlink(workspace.path("precious.txt"), &file).expect("a link can be made");
        let done = workspace.run("--train --resume run --episodes 40");
        assert_eq!(done.status, Some(2), "{}", done.stderr);
        assert!(done.stderr.contains(name) && done.stderr.contains("is a link"), "{}", done.stderr);
        std::fs::remove_file(&file).expect("the link can be removed");
        std::fs::write(&file, kept).expect("the file can be restored");
    }
    assert_eq!(
        std::fs::read_to_string(workspace.path("precious.txt")).expect("the file still exists"),
        "not part of a run"
    );
    workspace.run_ok("--train --resume run --episodes 40");
}
