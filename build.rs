//! Sets `WAYFIELD_COMMIT` to the Git commit that is built, with `-dirty` if a file of the program has been changed since.
//! Policies, runs and reports record it. Outside a clone of wayfield it stays unset.

use std::path::Path;
use std::process::Command;

/// The files that the program is built from.
const SOURCES: [&str; 6] = ["Cargo.lock", "Cargo.toml", "assets", "crates", "scenarios", "src"];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // Sources that were copied into another project's clone have no commit of their own.
    let is_own_clone = git(&["rev-parse", "--show-prefix"]).is_some_and(|prefix| prefix.is_empty());
    if !is_own_clone {
        return;
    }
    let Some(log) = git(&["rev-parse", "--git-path", "logs/HEAD"]) else { return };
    // Commits and checkouts append to this log. A path that does not exist would make every build run this script again.
    for path in SOURCES.into_iter().chain([log.as_str()]).filter(|path| Path::new(path).exists()) {
        println!("cargo::rerun-if-changed={path}");
    }
    let Some(commit) = git(&["rev-parse", "--short=12", "HEAD"]) else { return };
    let changed = git(&[&["status", "--porcelain", "--untracked-files=no", "--"], &SOURCES[..]].concat());
    let suffix = if changed.is_some_and(|files| files.is_empty()) { "" } else { "-dirty" };
    println!("cargo::rustc-env=WAYFIELD_COMMIT={commit}{suffix}");
}

/// The output of `git` with these arguments; `None` if it fails.
fn git(arguments: &[&str]) -> Option<String> {
    let output =
        Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
