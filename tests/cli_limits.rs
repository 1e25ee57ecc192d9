//! Tests of the limits that batch systems and containers set (`ulimit`): a run works with less, or ends with one clear error,
//! and can be resumed.
#![cfg(target_os = "linux")]

mod cli_support;
#[path = "support/requirements.rs"]
mod requirements;
#[path = "support/small_disk.rs"]
mod small_disk;

use std::os::unix::fs::PermissionsExt;
use std::process::Command;

use cli_support::{CommandOutput, Workspace, quick_fast};
use small_disk::can_mount;

const RUN: &str = "--train --preset fast.ron --steps 6400 --seed 5";

fn workspace() -> Workspace {
    let workspace = Workspace::new();
    workspace.write("fast.ron", quick_fast());
    workspace
}

/// Asserts that the command failed without a panic, and that its last line is an error that contains `needle`.
fn assert_failed(done: &CommandOutput, needle: &str) {
    assert_eq!(done.status, Some(1), "{}", done.stderr);
    let last = done.stderr.lines().last().unwrap_or_default();
    assert!(last.starts_with("error: ") && last.contains(needle), "{}", done.stderr);
    assert!(!done.stderr.contains("panicked"), "{}", done.stderr);
}

#[test]
fn with_few_threads_a_run_gives_the_same_result() {
    // The limit of processes does not hold for root, and an ordinary user may have any number of them already.
    let root = Command::new("setpriv").args(["--reuid", "23456", "--clear-groups", "true"]).output();
    if !root.is_ok_and(|output| output.status.success()) {
        requirements::report_skip("`setpriv --reuid` is not permitted; help: run as root");
        return;
    }
    let workspace = workspace();
    workspace.run_ok(&format!("{RUN} --out threads"));
    // The other user may not be allowed to read the build folder.
    std::fs::copy(env!("CARGO_BIN_EXE_wayfield"), workspace.path("program")).unwrap();
    std::fs::create_dir(workspace.path("own")).unwrap();
    for folder in ["", "own"] {
        let all = std::fs::Permissions::from_mode(0o777);
        std::fs::set_permissions(workspace.path(folder), all).unwrap();
    }
    let limited = |limit: u32, arguments: &str| {
        let user = "setpriv --reuid 23456 --regid 23456 --clear-groups";
        workspace.shell(&format!("exec {user} prlimit --nproc={limit} ./program {arguments}"))
    };
    for limit in 2..=4 {
        let done = limited(limit, &format!("{RUN} --out own/{limit}"));
        assert_eq!(done.status, Some(0), "--nproc={limit}: {}", done.stderr);
        assert!(!done.stderr.contains("panicked"), "--nproc={limit}: {}", done.stderr);
        workspace.assert_same_run("threads", &format!("own/{limit}"));
    }
    let done = limited(2, "--eval own/2/policy.safetensors --rounds 1 --episodes 5 --optimum");
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    // Bevy's task pool takes one thread in a build with the app.
    if cfg!(feature = "gui") {
        assert_failed(
            &limited(1, &format!("{RUN} --out own/1")),
            "no thread can be started; help: raise `ulimit -u`",
        );
        assert!(!workspace.path("own/1").exists(), "no folder is left");
    }
}

#[test]
fn a_run_that_reaches_the_limit_of_cpu_time_is_saved_and_resumes() {
    for limit in ["ulimit -S -t 2", "ulimit -t 4"] {
        let workspace = workspace();
        let done = workspace
            .shell(&format!("{limit}; exec $WAYFIELD --train --preset fast.ron --steps 900000000 --out run"));
        // 128 + 24, the number of SIGXCPU.
        assert_eq!(done.status, Some(152), "{limit}: {}", done.stderr);
        assert!(done.stderr.contains("the limit of CPU time"), "{limit}: {}", done.stderr);
        assert_eq!(workspace.json("run/summary.json")["finished"], false, "{limit}");
        let steps = workspace.json("run/summary.json")["env_steps"].as_u64().unwrap() + 16;
        workspace.run_ok(&format!("--resume run --steps {steps}"));
    }
}

#[test]
fn the_limit_of_file_sizes_is_an_error_and_the_run_resumes() {
    let workspace = workspace();
    workspace.run_ok(&format!("{RUN} --out unlimited"));
    // 100 blocks of 512 bytes: the checkpoint is larger.
    let done = workspace.shell(&format!("ulimit -f 100; exec $WAYFIELD {RUN} --out run"));
    assert_failed(&done, "File too large");
    assert!(done.stderr.contains("help: raise the limit on file sizes (`ulimit -f`)"), "{}", done.stderr);
    workspace.run_ok("--resume run");
    workspace.assert_same_run("unlimited", "run");
}

#[test]
fn too_few_open_files_are_an_error_and_the_run_resumes() {
    let workspace = workspace();
    workspace.run_ok(&format!("{RUN} --out unlimited"));
    let mut failed = 0;
    for limit in 4..=16 {
        let run = format!("run-{limit}");
        let done = workspace.shell(&format!("ulimit -n {limit}; exec $WAYFIELD {RUN} --out {run}"));
        assert!(!done.stderr.contains("panicked"), "{limit}: {}", done.stderr);
        match done.status {
            Some(0) => {}
            Some(1 | 2) => {
                failed += 1;
                assert!(done.stderr.contains("Too many open files"), "{limit}: {}", done.stderr);
                let again = if workspace.path(&format!("{run}/config.ron")).exists() {
                    format!("--resume {run}")
                } else {
                    format!("{RUN} --out {run}")
                };
                workspace.run_ok(&again);
            }
            status => panic!("{limit}: {status:?} {}", done.stderr),
        }
        workspace.assert_same_run("unlimited", &run);
    }
    assert!(failed > 0, "the limits are low enough to matter");
}

#[test]
fn too_little_memory_is_an_error_before_the_run_folder_is_made() {
    for flag in ["-v", "-d"] {
        let workspace = workspace();
        // The preset's replay buffer alone takes more than 50 MB.
        let done = workspace.shell(&format!(
            "unset RUST_BACKTRACE; ulimit {flag} 150000; exec $WAYFIELD --train --steps 16 --out run"
        ));
        assert_failed(&done, &format!("(`ulimit {flag}`)"));
        assert!(!workspace.path("run").exists(), "no folder is left");
    }
}

#[test]
fn the_memory_that_the_error_asks_for_suffices() {
    // With enough for an evaluation, the error is about the training.
    for (flag, kilobytes) in [("-v", 600_000), ("-d", 150_000)] {
        let workspace = workspace();
        let train = |kilobytes: u64| {
            let limit = format!("unset RUST_BACKTRACE; ulimit {flag} {kilobytes}");
            workspace.shell(&format!("{limit}; exec $WAYFIELD --train --steps 12000 --out run"))
        };
        let done = train(kilobytes);
        assert_failed(&done, "`learning.replay.capacity`");
        let needed = done.stderr.split("about ").nth(1).and_then(|text| text.split(' ').next());
        let megabytes: u64 = needed.expect("a number of MB").parse().unwrap();
        let done = train(megabytes * 1_000_000 / 1024 + 1);
        assert_eq!(done.status, Some(0), "{flag} {megabytes} MB: {}", done.stderr);
    }
}

#[test]
fn every_memory_limit_at_which_the_program_starts_gives_one_line_of_error() {
    let workspace = workspace();
    let mut has_started = false;
    for kilobytes in (20_000..=220_000).step_by(5_000) {
        let limit = format!("unset RUST_BACKTRACE; ulimit -v {kilobytes}");
        let done = workspace.shell(&format!("{limit}; exec $WAYFIELD --train --steps 16 --out run"));
        // With too little, the system cannot load the program, or the standard library cannot start it. Once it starts, its
        // errors and its help have enough memory.
        has_started |= done.status == Some(1);
        if !has_started {
            continue;
        }
        assert_failed(&done, "(`ulimit -v`");
        assert_eq!(done.stderr.lines().count(), 1, "{kilobytes} kB: {}", done.stderr);
        let help = workspace.shell(&format!("{limit}; exec $WAYFIELD --help"));
        assert_eq!(help.status, Some(0), "{kilobytes} kB: {help:?}");
    }
    assert!(has_started, "the largest of these limits is enough to start");
}

#[test]
fn on_one_cpu_and_without_dev_shm_a_run_gives_the_same_result() {
    let workspace = workspace();
    workspace.run_ok(&format!("{RUN} --out run"));
    let done = workspace.shell(&format!("exec taskset -c 0 $WAYFIELD {RUN} --out one-cpu"));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    workspace.assert_same_run("run", "one-cpu");
    if !can_mount() {
        return;
    }
    let script =
        format!("mount -t tmpfs -o size=0,mode=000,ro tmpfs /dev/shm; exec $WAYFIELD {RUN} --out no-shm");
    let done = workspace.shell(&format!("exec unshare --mount --map-root-user sh -ec '{script}'"));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    workspace.assert_same_run("run", "no-shm");
}

#[test]
fn a_bare_environment_is_enough() {
    let workspace = workspace();
    // No HOME, no TMPDIR that exists, no stdin, a small stack.
    let done =
        workspace.shell(&format!("ulimit -s 256; exec env -i TMPDIR=/nowhere $WAYFIELD {RUN} --out run <&-"));
    assert_eq!(done.status, Some(0), "{}", done.stderr);
}
