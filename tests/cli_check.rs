//! `wayfield --check`: which files are looked at, what is said of them, and the exit status.

mod cli_support;

use std::fs;

use cli_support::{Desk, Done, FAST, SCENARIO_1, edited};
use serde_json::json;

/// Worlds and presets in a folder and its folders, all good; and what is not looked at.
fn desk() -> Desk {
    let desk = Desk::new();
    for folder in ["files", "files/b", "files/.hidden", "empty"] {
        fs::create_dir(desk.path(folder)).unwrap();
    }
    desk.write("files/c.ron", SCENARIO_1);
    desk.write("files/a.ron", FAST);
    desk.write("files/b/world.ron", SCENARIO_1);
    for other in ["files/.hidden/x.ron", "files/.x.ron", "files/notes.txt", "files/ron"] {
        desk.write(other, "this is no RON");
    }
    desk
}

/// Asserts that a check failed, and that it said just this.
fn assert_failed(done: &Done, stdout: &str, stderr: &str) {
    assert_eq!((done.stdout.as_str(), done.stderr.as_str()), (stdout, stderr));
    assert_eq!(done.status, Some(2));
}

#[test]
fn every_file_of_a_folder_is_looked_at_in_the_order_of_names() {
    let desk = desk();
    let before = desk.everything();
    let done = desk.succeed("--check files");
    assert_eq!(
        (done.stdout.as_str(), done.stderr.as_str()),
        ("files/a.ron: ok\nfiles/b/world.ron: ok\nfiles/c.ron: ok\n", "")
    );
    assert_eq!(desk.succeed("--check files/").stdout, done.stdout, "with a slash it is the same folder");
    let done = desk.succeed("--check files/c.ron files/b files/a.ron");
    assert_eq!(
        done.stdout, "files/c.ron: ok\nfiles/b/world.ron: ok\nfiles/a.ron: ok\n",
        "in the order given"
    );
    assert_eq!(desk.everything(), before, "nothing is left behind");
}

#[test]
fn all_that_is_wrong_is_told_of_every_file() {
    let desk = desk();
    let outside = [
        ("radius_m: 0.15), position_m: (0.6, 0.6)", "radius_m: 0.15), position_m: (1.95, 0.6)"),
        ("radius_m: 0.15), position_m: (-0.6, -0.6)", "radius_m: 0.15), position_m: (-0.6, -1.9)"),
    ];
    desk.write("files/c.ron", edited(SCENARIO_1, &outside));
    desk.write("files/b/preset.ron", edited(FAST, &[("n_step: 2", "nstep: 2")]));
    desk.write("files/b/world.ron", edited(SCENARIO_1, &[("    obstacles: [", "    obstacels: [")]));
    let done = desk.run("--check files");
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    assert_eq!(done.stdout, "files/a.ron: ok\n");
    let lines: Vec<&str> = done.stderr.lines().collect();
    let starts = [
        "files/b/preset.ron:19:9: unknown field `nstep` in `learning`: did you mean `n_step`? the fields are ",
        "files/b/world.ron:12:5: unknown field `obstacels` in the file: did you mean `obstacles`? the fields are ",
        "files/c.ron:13:9: `obstacles[0]` reaches 0.100 m beyond the enclosure: move it inwards or make it smaller",
        "files/c.ron:15:9: `obstacles[2]` reaches 0.050 m beyond the enclosure: move it inwards or make it smaller",
        "error: of 4 checked, 3 can't be used",
    ];
    assert_eq!(lines.len(), starts.len(), "{}", done.stderr);
    for (line, start) in lines.iter().zip(starts) {
        assert!(line.starts_with(start), "{line}\nis not\n{start}");
    }
    // Mended one after the other, as one does.
    desk.write("files/c.ron", SCENARIO_1);
    desk.write("files/b/preset.ron", FAST);
    assert_eq!(desk.run("--check files").status, Some(2));
    desk.write("files/b/world.ron", SCENARIO_1);
    assert_eq!(desk.succeed("--check files").stdout.lines().count(), 4);
}

#[test]
fn a_path_that_leads_to_no_file_is_told_of() {
    let desk = desk();
    assert_failed(
        &desk.run("--check empty"),
        "",
        "empty: there is no .ron file in this folder: name a scenario, a preset, or a folder that has some\n\
         error: of 1 checked, 1 can't be used\n",
    );
    assert_failed(
        &desk.run("--check files/b files/d.ron"),
        "files/b/world.ron: ok\n",
        "files/d.ron: no such file (files there: files/.x.ron, files/a.ron, files/c.ron)\n\
         error: of 2 checked, 1 can't be used\n",
    );
    assert_failed(
        &desk.run("--check files/notes.txt"),
        "",
        "files/notes.txt:1:1: this must be `Scenario(...)` or only `(...)`, not `this`\n\
         error: of 1 checked, 1 can't be used\n",
    );
}

#[test]
fn json_has_the_files_and_the_problems() {
    let desk = desk();
    let all = ["files/a.ron", "files/b/world.ron", "files/c.ron"];
    assert_eq!(desk.succeed("--check files --json").json(), json!({ "files": all, "problems": [] }));
    let outside = [("radius_m: 0.15), position_m: (0.6, 0.6)", "radius_m: 0.15), position_m: (1.95, 0.6)")];
    desk.write("files/c.ron", edited(SCENARIO_1, &outside));
    let done = desk.run("--check files empty --json");
    assert_eq!(done.status, Some(2));
    assert_eq!(done.stderr, "error: of 4 checked, 2 can't be used\n");
    assert_eq!(
        done.json(),
        json!({
            "files": ["files/a.ron", "files/b/world.ron", "files/c.ron", "empty"],
            "problems": [
                {
                    "path": "files/c.ron",
                    "line": 13,
                    "column": 9,
                    "message":
                        "`obstacles[0]` reaches 0.100 m beyond the enclosure: move it inwards or make it smaller",
                },
                {
                    "path": "empty",
                    "line": null,
                    "column": null,
                    "message":
                        "there is no .ron file in this folder: name a scenario, a preset, or a folder that has some",
                },
            ],
        })
    );
}

#[test]
fn what_is_shipped_passes() {
    let done = Desk::new()
        .succeed(&format!("--check {root}/scenarios {root}/assets", root = env!("CARGO_MANIFEST_DIR")));
    assert!(done.stdout.lines().count() >= 24 && done.stdout.lines().all(|line| line.ends_with(": ok")));
}

#[test]
fn a_check_does_nothing_else() {
    let desk = desk();
    for (arguments, needle) in [
        ("--check", "a value is required"),
        ("--check files --train", "--train"),
        ("--check files --steps 100", "--steps"),
        ("--check files --eval x", "--eval"),
        ("--check files --rounds 3", "--rounds"),
        ("--check files --seed 3", "--seed"),
        ("--reproduce --check files", "--check"),
    ] {
        let done = desk.run(arguments);
        assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{arguments}: {}", done.stderr);
        assert!(done.stderr.contains(needle), "{arguments}: {}", done.stderr);
    }
    assert!(desk.succeed("--help").stdout.contains("--check <PATH>..."));
}
