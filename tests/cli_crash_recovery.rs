//! Nothing is lost: whatever ends a run, its folder is whole, and the run goes on as if undisturbed.
#![cfg(target_os = "linux")]

mod cli_support;

use std::process::Command;
use std::time::Duration;

use cli_support::{
    CommandOutput, SCENARIO_1, Workspace, quick_fast, signal, wait_for_output, wait_until,
    with_short_episodes,
};

/// A run of half a second or so, with checkpoints all the time.
const RUN: &str = "--train --scenario one.ron --preset fast.ron --seed 9 --steps 6400";
const OFTEN: &str = "--checkpoint-every 0.01";

/// A desk with a run that nobody disturbed.
fn workspace() -> Workspace {
    let workspace = Workspace::new();
    workspace.write("fast.ron", quick_fast());
    workspace.write("one.ron", with_short_episodes(SCENARIO_1));
    workspace.run_ok(&format!("{RUN} --out undisturbed"));
    workspace
}

/// The names in a folder of the desk, in order.
fn names(workspace: &Workspace, folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(workspace.path(folder)).unwrap();
    let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn killed_at_any_moment_a_run_ends_as_if_undisturbed() {
    let workspace = workspace();
    let began = std::time::Instant::now();
    workspace.run_ok(&format!("{RUN} {OFTEN} --out timed"));
    let whole = began.elapsed();
    workspace.assert_same_run("undisturbed", "timed");
    let (mut before_it_began, mut killed) = (0, 0);
    for moment in 0..50_u32 {
        // Spread over the whole run, at moments that no round number of anything can favour.
        let part = (f64::from(moment) * 0.618_033_988_749_894_9).fract();
        let run = format!("killed-{moment}");
        let mut child = workspace.start(&format!("{RUN} {OFTEN} --out {run}"));
        std::thread::sleep(Duration::from_secs_f64(whole.as_secs_f64() * part));
        if child.try_wait().unwrap().is_none() {
            signal(&child, "KILL");
            killed += usize::from(wait_for_output(child).status.is_none());
        }
        if !workspace.path(&format!("{run}/config.ron")).exists() {
            // There is nothing yet to go on with; the same command begins.
            before_it_began += 1;
            workspace.run_ok(&format!("{RUN} {OFTEN} --out {run}"));
        } else if !workspace.path(&format!("{run}/summary.json")).exists() {
            let gone_on = workspace.run(&format!("--train --resume {run} {OFTEN}"));
            // Killed between its last checkpoint and its summary, it only lacks the latter.
            if gone_on.status == Some(2) && gone_on.stderr.contains("has had 6400 env steps already") {
                workspace.run_ok(&format!("--train --resume {run} --steps 6401"));
                continue;
            }
            assert_eq!(gone_on.status, Some(0), "{run}: {}", gone_on.stderr);
            assert!(
                !gone_on.stderr.contains("warning"),
                "{run}: no checkpoint was spoilt: {}",
                gone_on.stderr
            );
        }
        workspace.assert_same_run("undisturbed", &run);
        let left: Vec<_> = names(&workspace, &run)
            .into_iter()
            .chain(names(&workspace, &format!("{run}/checkpoint")))
            .collect();
        assert!(
            !left.iter().any(|name| name.starts_with('.')),
            "{run}: something temporary is left: {left:?}"
        );
    }
    assert!(killed >= 30, "of 50 only {killed} were killed; {before_it_began} before they began");
}

#[test]
fn a_spoilt_checkpoint_is_passed_over_for_the_one_before() {
    let workspace = workspace();
    workspace.run_ok(&format!("{RUN} --out run"));
    let steps =
        |name: &str, steps: u32| workspace.run_ok(&format!("--train --resume {name} --steps {steps}"));
    steps("run", 8000);
    steps("run", 9600);
    steps("undisturbed", 8000);
    steps("undisturbed", 9600);
    workspace.assert_same_run("undisturbed", "run");
    assert_eq!(names(&workspace, "run/checkpoint"), ["latest.bin", "lock", "older.bin", "previous.bin"]);
    for (spoilt, is) in [("latest", 8000), ("previous", 6400)] {
        let file = format!("run/checkpoint/{spoilt}.bin");
        let mut bytes = workspace.read(&file);
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        workspace.write(&file, bytes);
        let copy = format!("from-{is}");
        assert!(
            Command::new("cp")
                .arg("-r")
                .args([workspace.path("run"), workspace.path(&copy)])
                .status()
                .unwrap()
                .success()
        );
        let done = steps(&copy, 9600);
        let warning = format!("warning: {copy}/checkpoint/latest.bin: the checkpoint is damaged");
        assert!(done.stderr.contains(&warning), "{}", done.stderr);
        assert!(
            done.stderr.contains(&format!("going on from the checkpoint before it, {is} env steps")),
            "{}",
            done.stderr
        );
        workspace.assert_same_run("undisturbed", &copy);
        assert!(
            names(&workspace, &format!("{copy}/checkpoint")).contains(&"latest.bin.damaged".to_owned()),
            "it is kept"
        );
        // And what came after is sound.
        workspace.run_ok(&format!("--train --resume {copy} --steps 9900"));
    }
}

#[test]
fn two_cannot_be_at_work_in_one_folder() {
    let workspace = workspace();
    let mut child = workspace.start("--train --scenario one.ron --preset fast.ron --steps 3000000 --out run");
    wait_until(&mut child, "a checkpoint", || workspace.path("run/checkpoint/latest.bin").exists());
    for second in ["--train --resume run", "--train --scenario one.ron --preset fast.ron --out run"] {
        let refused = workspace.run(second);
        assert_eq!((refused.status, refused.stdout.as_str()), (Some(2), ""), "{second}: {}", refused.stderr);
        assert!(refused.stderr.starts_with("error: run: "), "{}", refused.stderr);
        let why = if second.contains("resume") {
            "another wayfield is at work in it"
        } else {
            "holds a run already"
        };
        assert!(refused.stderr.contains(why), "{}", refused.stderr);
    }
    signal(&child, "TERM");
    assert_eq!(wait_for_output(child).status, Some(0));
    workspace.run_ok("--train --resume run --steps 3000001 --checkpoint-every 1000000 --json").json();
}

/// Runs `script` with a file system of its own, mounted at `small` on the desk, which is gone afterwards. (As root, or as a user
/// who may have namespaces.)
fn with_small_disk(workspace: &Workspace, options: &str, script: &str) -> CommandOutput {
    std::fs::create_dir_all(workspace.path("small")).unwrap();
    let script = format!("mount -t tmpfs -o {options} tmpfs small && {script}");
    let output = Command::new("unshare")
        .args(["--mount", "--map-root-user", "sh", "-euc", &script])
        .env("WAYFIELD", env!("CARGO_BIN_EXE_wayfield"))
        .current_dir(workspace.path(""))
        .output()
        .expect("unshare, of util-linux, starts");
    let text = |bytes| String::from_utf8(bytes).unwrap();
    CommandOutput { status: output.status.code(), stdout: text(output.stdout), stderr: text(output.stderr) }
}

#[test]
fn a_disk_that_is_full_spoils_nothing() {
    let workspace = workspace();
    // What is written until then is whole; with room again, the run goes on.
    let done = with_small_disk(
        &workspace,
        "size=1m",
        &format!(
            "s=0; $WAYFIELD {RUN} {OFTEN} --out small/run 2>said || s=$?; echo $s; \
             mount -o remount,size=64m small; $WAYFIELD --train --resume small/run >/dev/null 2>resumed; cp -r small/run run"
        ),
    );
    assert_eq!(
        (done.status, done.stdout.as_str()),
        (Some(0), "1\n"),
        "{}{}",
        done.stderr,
        workspace.text("said")
    );
    let said = workspace.text("said");
    let message = said.lines().last().unwrap();
    for needle in [
        "error: small/run/",
        "can't be written",
        "No space left on device",
        "the last checkpoint is kept in small/run/checkpoint",
    ] {
        assert!(message.contains(needle), "`{needle}` is not in: {said}");
    }
    assert!(!said.contains("panicked"), "{said}");
    assert!(!workspace.text("resumed").contains("warning"), "{}", workspace.text("resumed"));
    workspace.assert_same_run("undisturbed", "run");
}

#[test]
fn where_nothing_can_be_written_it_is_said_before_anything_begins() {
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

#[cfg(unix)]
#[test]
fn a_folder_from_elsewhere_cannot_lead_a_run_to_other_files() {
    let workspace = workspace();
    workspace.run_ok("--train --scenario one.ron --preset fast.ron --episodes 20 --out run");
    workspace.write("precious.txt", "not a run's");
    for name in ["episodes.csv", "checkpoint/lock", "policy.safetensors"] {
        let file = workspace.path(&format!("run/{name}"));
        let kept = std::fs::read(&file).expect("a run has it");
        std::fs::remove_file(&file).expect("it can be removed");
        std::os::unix::fs::symlink(workspace.path("precious.txt"), &file).expect("a link can be made");
        let done = workspace.run("--train --resume run --episodes 40");
        assert_eq!(done.status, Some(2), "{}", done.stderr);
        assert!(done.stderr.contains(name) && done.stderr.contains("is a link"), "{}", done.stderr);
        std::fs::remove_file(&file).expect("the link");
        std::fs::write(&file, kept).expect("it can be put back");
    }
    assert_eq!(std::fs::read_to_string(workspace.path("precious.txt")).expect("it is there"), "not a run's");
    workspace.run_ok("--train --resume run --episodes 40");
}
