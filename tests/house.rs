//! The rules of the house, held against the source itself: who imports whom.

use std::fs;
use std::path::{Path, PathBuf};

/// Each room with all that it may import, from the ground up.
const ROOMS: &[(&str, &[&str])] = &[
    ("random", &[]),
    ("scenario", &["random"]),
    ("learning", &["random"]),
    ("control_step", &[]),
    ("task", &["random", "scenario", "control_step"]),
    ("world", &["random", "scenario", "control_step", "task"]),
    ("agent", &["random", "learning", "control_step", "task", "world"]),
    ("report", &[]),
    ("run", &["random", "scenario", "learning", "control_step", "task", "world", "agent", "report"]),
    ("reproduce", &["scenario", "learning", "task", "report", "run"]),
    ("app", &["random", "scenario", "learning", "task", "world", "agent", "report", "run"]),
    ("cli", &["random", "scenario", "learning", "task", "run", "reproduce", "app"]),
];

fn sources(path: &Path, found: &mut Vec<PathBuf>) {
    if path.is_dir() {
        for entry in fs::read_dir(path).expect("a folder of the project") {
            sources(&entry.expect("an entry of it").path(), found);
        }
    } else if path.extension().is_some_and(|ending| ending == "rs") {
        found.push(path.into());
    }
}

/// The rooms that a file's code (not its comments) names as `crate::room`.
fn imports(text: &str) -> Vec<(usize, String)> {
    let mut named = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let code = line.split("//").next().unwrap_or_default();
        for rest in code.split("crate::").skip(1) {
            let room = rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default();
            if ROOMS.iter().any(|(name, _)| *name == room) {
                named.push((number, room.to_string()));
            }
        }
    }
    named
}

#[test]
fn a_room_imports_only_from_rooms_below_it() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut wrong = Vec::new();
    let mut looked_at = 0;
    for (room, may) in ROOMS {
        let mut files = Vec::new();
        for place in [src.join(room), src.join(format!("{room}.rs"))] {
            if place.exists() {
                sources(&place, &mut files);
            }
        }
        for file in files {
            looked_at += 1;
            let text = fs::read_to_string(&file).expect("a source file");
            for (line, named) in imports(&text) {
                if named != *room && !may.contains(&named.as_str()) {
                    wrong.push(format!("{}:{line}: {room} must not import {named}", file.display()));
                }
            }
        }
    }
    assert!(looked_at > 40, "the rooms were found ({looked_at} files)");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn an_import_is_seen_however_it_is_written() {
    let text = "use crate::{x};\nlet a = crate::world::populate; // crate::cli\nuse crate::task::{A, B};";
    assert_eq!(imports(text), [(2, "world".to_string()), (3, "task".to_string())]);
}

#[test]
fn every_module_says_what_it_is() {
    let mut files = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut files);
    for file in files {
        let text = fs::read_to_string(&file).expect("a source file");
        assert!(text.starts_with("//! "), "{} opens with a few lines on what it is", file.display());
    }
}
