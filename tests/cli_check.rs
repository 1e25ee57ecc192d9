//! Tests of `wayfield --check`: which files are checked, the printed problems, and the exit status.

mod cli_support;

use std::fs;

use cli_support::{CommandOutput, FAST, SCENARIO_1, Workspace, edited, quick_fast};
use serde_json::json;

/// A workspace with valid scenarios and presets, and with files that a check of their folder ignores.
fn workspace() -> Workspace {
    let workspace = Workspace::new();
    for folder in ["files", "files/b", "files/.hidden", "empty"] {
        fs::create_dir(workspace.path(folder)).unwrap();
    }
    workspace.write("files/c.ron", SCENARIO_1);
    workspace.write("files/a.ron", FAST);
    workspace.write("files/b/scenario.ron", SCENARIO_1);
    for ignored in ["files/.hidden/x.ron", "files/.x.ron", "files/notes.txt", "files/ron"] {
        workspace.write(ignored, "this is not RON");
    }
    workspace
}

/// Asserts that the exit status is 2 and the output exactly this.
fn assert_failed(done: &CommandOutput, stdout: &str, stderr: &str) {
    assert_eq!((done.stdout.as_str(), done.stderr.as_str()), (stdout, stderr));
    assert_eq!(done.status, Some(2));
}

#[test]
fn a_folders_files_are_checked_in_alphabetical_order() {
    let workspace = workspace();
    let before = workspace.all_files();
    let done = workspace.run_ok("--check files");
    assert_eq!(
        (done.stdout.as_str(), done.stderr.as_str()),
        ("files/a.ron: ok\nfiles/b/scenario.ron: ok\nfiles/c.ron: ok\n", "")
    );
    assert_eq!(workspace.run_ok("--check files/").stdout, done.stdout, "a trailing slash changes nothing");
    let done = workspace.run_ok("--check files/c.ron files/b files/a.ron");
    assert_eq!(
        done.stdout, "files/c.ron: ok\nfiles/b/scenario.ron: ok\nfiles/a.ron: ok\n",
        "paths are checked in the given order"
    );
    assert_eq!(workspace.all_files(), before, "no file is created or changed");
}

#[test]
fn every_problem_of_every_file_is_printed() {
    let workspace = workspace();
    let beyond_the_enclosure = [
        ("radius_m: 0.15), position_m: (0.6, 0.6)", "radius_m: 0.15), position_m: (1.95, 0.6)"),
        ("radius_m: 0.15), position_m: (-0.6, -0.6)", "radius_m: 0.15), position_m: (-0.6, -1.9)"),
    ];
    workspace.write("files/c.ron", edited(SCENARIO_1, &beyond_the_enclosure));
    workspace.write("files/b/preset.ron", edited(FAST, &[("n_step: 2", "nstep: 2")]));
    workspace.write("files/b/scenario.ron", edited(SCENARIO_1, &[("    obstacles: [", "    obstacels: [")]));
    let done = workspace.run("--check files");
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    assert_eq!(done.stdout, "files/a.ron: ok\n");
    let lines: Vec<&str> = done.stderr.lines().collect();
    let starts = [
        "files/b/preset.ron:19:9: unknown field `nstep` in `learning`: did you mean `n_step`? the fields are ",
        "files/b/scenario.ron:12:5: unknown field `obstacels` in the file: did you mean `obstacles`? the fields are ",
        "files/c.ron:13:9: `obstacles[0]` extends 0.100 m outside the enclosure: move it inside or make it smaller",
        "files/c.ron:15:9: `obstacles[2]` extends 0.050 m outside the enclosure: move it inside or make it smaller",
        "error: 3 of 4 checked files are invalid",
    ];
    assert_eq!(lines.len(), starts.len(), "{}", done.stderr);
    for (line, start) in lines.iter().zip(starts) {
        assert!(line.starts_with(start), "{line}\ndoes not start with\n{start}");
    }
    // The check fails until the last file is fixed.
    workspace.write("files/c.ron", SCENARIO_1);
    workspace.write("files/b/preset.ron", FAST);
    assert_eq!(workspace.run("--check files").status, Some(2));
    workspace.write("files/b/scenario.ron", SCENARIO_1);
    assert_eq!(workspace.run_ok("--check files").stdout.lines().count(), 4);
}

#[test]
fn paths_without_scenarios_or_presets_are_reported() {
    let workspace = workspace();
    assert_failed(
        &workspace.run("--check empty"),
        "",
        "empty: this folder has no .ron file; help: give a scenario or preset file, or a folder of them\n\
         error: 1 of 1 checked files are invalid\n",
    );
    assert_failed(
        &workspace.run("--check files/b files/d.ron"),
        "files/b/scenario.ron: ok\n",
        "files/d.ron: no such file (files there: files/.x.ron, files/a.ron, files/c.ron)\n\
         error: 1 of 2 checked files are invalid\n",
    );
    assert_failed(
        &workspace.run("--check files/notes.txt"),
        "",
        "files/notes.txt:1:1: expected `Scenario(...)` or `(...)`, found `this`\n\
         error: 1 of 1 checked files are invalid\n",
    );
}

#[test]
fn json_lists_the_files_and_the_problems() {
    let workspace = workspace();
    let paths = ["files/a.ron", "files/b/scenario.ron", "files/c.ron"];
    assert_eq!(
        workspace.run_ok("--check files --json").json(),
        json!({ "files": paths, "problems": [], "notes": [] })
    );
    let beyond_the_enclosure =
        [("radius_m: 0.15), position_m: (0.6, 0.6)", "radius_m: 0.15), position_m: (1.95, 0.6)")];
    workspace.write("files/c.ron", edited(SCENARIO_1, &beyond_the_enclosure));
    let done = workspace.run("--check files empty --json");
    assert_eq!(done.status, Some(2));
    assert_eq!(done.stderr, "error: 2 of 4 checked files are invalid\n");
    assert_eq!(
        done.json(),
        json!({
            "files": ["files/a.ron", "files/b/scenario.ron", "files/c.ron", "empty"],
            "problems": [
                {
                    "path": "files/c.ron",
                    "line": 13,
                    "column": 9,
                    "message":
                        "`obstacles[0]` extends 0.100 m outside the enclosure: move it inside or make it smaller",
                },
                {
                    "path": "empty",
                    "line": null,
                    "column": null,
                    "message":
                        "this folder has no .ron file; help: give a scenario or preset file, or a folder of them",
                },
            ],
            "notes": [],
        })
    );
}

#[test]
fn what_is_doubtful_is_printed_with_its_place_and_the_file_is_valid() {
    let workspace = Workspace::new();
    workspace.write("hangar.ron", "(name: \"Hangar\", enclosure: Rectangle(width_m: 30.0, height_m: 30.0))");
    workspace.write("rare.ron", edited(FAST, &[("train_freq: 16", "train_freq: 5000000")]));
    let zero = ("Linear(from: 0.0015, to: 0.00001, env_steps: 600000)", "Constant(0.0)");
    workspace.write("zero.ron", edited(FAST, &[zero]));
    let done = workspace.run_ok("--check hangar.ron rare.ron zero.ron");
    assert_eq!(done.stdout, "hangar.ron: ok\nrare.ron: ok\nzero.ron: ok\n");
    let lines: Vec<&str> = done.stderr.lines().collect();
    let expected = [
        (
            "hangar.ron:1:1: warning: `task.max_episode_steps` is 500: ",
            " % of the goals are farther from the start, ",
        ),
        (
            "rare.ron:35:21: warning: `learning.train_freq` is 5000000, so nothing will be learned: ",
            "; help: ",
        ),
        (
            "zero.ron:23:24: warning: `learning.learning_rate` is 0 throughout, so nothing will be learned",
            "; help: ",
        ),
    ];
    assert_eq!(lines.len(), expected.len(), "{}", done.stderr);
    for (line, (start, part)) in lines.iter().zip(expected) {
        assert!(line.starts_with(start) && line.contains(part), "{line}\nis not\n{start}...{part}");
    }
    let report = workspace.run_ok("--check rare.ron --json").json();
    assert_eq!(report["problems"], json!([]));
    let note = &report["notes"][0];
    assert_eq!(
        (&note["level"], &note["path"], &note["line"]),
        (&json!("warning"), &json!("rare.ron"), &json!(35))
    );
}

#[test]
fn hopeless_scenarios_are_refused_and_doubtful_runs_are_told_of_before_they_start() {
    let workspace = Workspace::new();
    workspace.write("top.ron", "(name: \"Top\", robot: (motions: [(v_m_s: 0.0, w_rad_s: 1.0)]))");
    workspace.write("hasty.ron", "(name: \"Hasty\", task: (max_episode_steps: 3))");
    let done = workspace.run("--check top.ron hasty.ron");
    assert_failed(
        &done,
        "",
        "top.ron:1:32: `robot.motions` never move the robot: write a v_m_s other than 0 for at least one of them\n\
         hasty.ron:1:43: `task.max_episode_steps` is 3: in this time the robot covers at most 0.090 m, but goals are at \
         least 0.5 m away: write at least 10, or make the robot faster\n\
         error: 2 of 2 checked files are invalid\n",
    );
    let lorry =
        "(name: \"Lorry\", robot: (motions: [(v_m_s: 0.5, w_rad_s: 0.2), (v_m_s: 0.5, w_rad_s: -0.2)]))";
    workspace.write("lorry.ron", lorry);
    workspace.write("quick.ron", quick_fast());
    let trained = workspace.run_ok("--train --scenario lorry.ron --preset quick.ron --steps 1600 --out run");
    let at = |text: &str| {
        trained.stderr.find(text).unwrap_or_else(|| panic!("`{text}` is not in {}", trained.stderr))
    };
    let first = at("run: Lorry, ");
    let warning =
        at("\nwarning: lorry.ron: `robot.motions` turn the robot with a radius of at least 2.50 m, ");
    let note =
        at("\nnote: quick.ron: `learning.learning_rate` ends at env step 600000, but the budget is 1600, ");
    assert!(first < warning && warning < note && note < at("done: run"), "{}", trained.stderr);
    // A larger budget gets its own notes.
    let resumed = workspace.run_ok("--train --resume run --steps 3200");
    assert!(
        resumed.stderr.contains("`learning.learning_rate` ends at env step 600000, but the budget is 3200"),
        "{}",
        resumed.stderr
    );
}

#[test]
fn all_shipped_scenarios_presets_and_experiments_are_valid() {
    let done = Workspace::new()
        .run_ok(&format!("--check {root}/scenarios {root}/assets", root = env!("CARGO_MANIFEST_DIR")));
    assert!(done.stdout.lines().count() >= 24 && done.stdout.lines().all(|line| line.ends_with(": ok")));
    assert_eq!(done.stderr, "", "nothing shipped is doubtful");
}

#[test]
fn check_rejects_the_options_of_other_modes() {
    let workspace = workspace();
    for (arguments, expected) in [
        ("--check", "a value is required"),
        ("--check files --train", "--train"),
        ("--check files --steps 100", "--steps"),
        ("--check files --eval x", "--eval"),
        ("--check files --rounds 3", "--rounds"),
        ("--check files --seed 3", "--seed"),
        ("--reproduce --check files", "--check"),
    ] {
        let done = workspace.run(arguments);
        assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{arguments}: {}", done.stderr);
        assert!(done.stderr.contains(expected), "{arguments}: {}", done.stderr);
    }
    assert!(workspace.run_ok("--help").stdout.contains("--check <PATH>..."));
}
