//! A small separate file system, on which a test can fill the disk or forbid writing.

#![allow(dead_code, reason = "each test file uses part of this module")]

use std::process::Command;

use crate::cli_support::{CommandOutput, Workspace};
use crate::requirements::report_skip;

/// Whether this test may mount a file system, as root or in a user namespace. If not, the test is skipped.
pub fn can_mount() -> bool {
    let tried = Command::new("unshare").args(["--mount", "--map-root-user", "true"]).output();
    let works = tried.is_ok_and(|output| output.status.success());
    if !works {
        report_skip("`unshare --mount` is not permitted; help: run as root, or allow user namespaces");
    }
    works
}

/// Runs `script` with a small temporary file system mounted at `small` in the workspace.
pub fn with_small_disk(workspace: &Workspace, options: &str, script: &str) -> CommandOutput {
    std::fs::create_dir_all(workspace.path("small")).unwrap();
    let script = format!("mount -t tmpfs -o {options} tmpfs small && {script}");
    let mut command = Command::new("unshare");
    command.args(["--mount", "--map-root-user", "sh", "-euc", &script]);
    workspace.finish(command)
}

/// A script that fills the disk at `small`, except for `free_kib` KiB.
pub fn fill_disk(free_kib: u32) -> String {
    format!(
        "{{ dd if=/dev/zero of=small/fill bs=1k 2>/dev/null || true; }}; truncate -s -{free_kib}k small/fill"
    )
}
