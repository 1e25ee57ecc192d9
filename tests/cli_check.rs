//! Tests of `wayfield --check`: which files are checked, the printed problems, and the exit status.

mod cli_support;

use std::fs;

use cli_support::messages::Messages;
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
        ("files/a.ron: ok (preset)\nfiles/b/scenario.ron: ok (scenario)\nfiles/c.ron: ok (scenario)\n", "")
    );
    assert_eq!(workspace.run_ok("--check files/").stdout, done.stdout, "a trailing slash changes nothing");
    let done = workspace.run_ok("--check files/c.ron files/b files/a.ron");
    assert_eq!(
        done.stdout,
        "files/c.ron: ok (scenario)\nfiles/b/scenario.ron: ok (scenario)\nfiles/a.ron: ok (preset)\n",
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
    assert_eq!(done.stdout, "files/a.ron: ok (preset)\n");
    let lines: Vec<&str> = done.stderr.lines().collect();
    let starts = [
        "files/b/preset.ron:19:9: unknown field `nstep` in `learning`: did you mean `n_step`? the fields are ",
        "files/b/preset.ron: 1 problem in this preset",
        "files/b/scenario.ron:12:5: unknown field `obstacels` in the file: did you mean `obstacles`? the fields are ",
        "files/b/scenario.ron: 1 problem in this scenario",
        "files/c.ron:13:9: `obstacles[0]` extends 0.100 m outside the enclosure: move it inside or make it smaller",
        "files/c.ron:15:9: `obstacles[2]` extends 0.050 m outside the enclosure: move it inside or make it smaller",
        "files/c.ron: 2 problems in this scenario",
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
        "files/b/scenario.ron: ok (scenario)\n",
        "files/d.ron: no such file (files there: files/a.ron, files/c.ron)\n\
         error: 1 of 2 checked files are invalid\n",
    );
    assert_failed(
        &workspace.run("--check files/notes.txt"),
        "",
        "files/notes.txt:1:1: expected `Scenario(...)` or `(...)`, found `this`\n\
         files/notes.txt: 1 problem in this scenario\n\
         error: 1 of 1 checked files are invalid\n",
    );
}

#[test]
fn json_lists_the_files_and_the_problems() {
    let workspace = workspace();
    let paths = ["files/a.ron", "files/b/scenario.ron", "files/c.ron"];
    assert_eq!(
        workspace.run_ok("--check files --json").json(),
        json!({ "files": paths, "kinds": ["preset", "scenario", "scenario"], "problems": [], "notes": [] })
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
            "kinds": ["preset", "scenario", "scenario", null],
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
fn questionable_settings_are_printed_with_their_position_and_the_file_is_valid() {
    let workspace = Workspace::new();
    workspace.write("hangar.ron", "(name: \"Hangar\", enclosure: Rectangle(width_m: 30.0, height_m: 30.0))");
    workspace.write("rare.ron", edited(FAST, &[("train_freq: 16", "train_freq: 5000000")]));
    let zero = ("Linear(from: 0.0015, to: 0.00001, env_steps: 600000)", "Constant(0.0)");
    workspace.write("zero.ron", edited(FAST, &[zero]));
    let done = workspace.run_ok("--check hangar.ron rare.ron zero.ron");
    assert_eq!(done.stdout, "hangar.ron: ok (scenario)\nrare.ron: ok (preset)\nzero.ron: ok (preset)\n");
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
fn impossible_scenarios_are_refused_and_questionable_settings_are_reported_before_a_run_starts() {
    let workspace = Workspace::new();
    workspace.write("top.ron", "(name: \"Top\", robot: (motions: [(v_m_s: 0.0, w_rad_s: 1.0)]))");
    workspace.write("hasty.ron", "(name: \"Hasty\", task: (max_episode_steps: 3))");
    let done = workspace.run("--check top.ron hasty.ron");
    assert_failed(
        &done,
        "",
        "top.ron:1:32: `robot.motions` never move the robot: write a v_m_s other than 0 for at least one of them\n\
         top.ron: 1 problem in this scenario\n\
         hasty.ron:1:43: `task.max_episode_steps` is 3: in this time the robot covers at most 0.090 m, but goals are at \
         least 0.5 m away: write at least 10, or make the robot faster\n\
         hasty.ron: 1 problem in this scenario\n\
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
    assert!(done.stdout.lines().count() >= 24 && done.stdout.lines().all(|line| line.contains(": ok (")));
    assert_eq!(done.stderr, "", "nothing shipped is questionable");
}

#[test]
fn the_content_decides_what_kind_a_file_is() {
    let workspace = workspace();
    workspace.run_ok("--train --steps 16 --out run");
    workspace.write("run/experiment.ron", include_str!("../assets/experiments/fig8.ron"));
    let done = workspace.run_ok("--check run run/policy.safetensors");
    assert_eq!(
        done.stdout,
        "run/config.ron: ok (run configuration)\nrun/experiment.ron: ok (experiment)\nrun/policy.safetensors: ok (policy)\n"
    );
    // The fields decide the kind of an invalid file, too: an experiment with budgets is not taken for a preset.
    let experiment = edited(include_str!("../assets/experiments/fig8.ron"), &[("    arms: [", "    arm: [")]);
    for (name, text, problem) in [
        ("experiment.ron", experiment, "experiment"),
        ("preset.ron", edited(FAST, &[("arenas: 16", "arenas: 0")]), "preset"),
        (
            "scenario.ron",
            "(name: \"arenas\", // budget: learning is fun\n obstacles: [(shap: 1)])".into(),
            "scenario",
        ),
        (
            "run/config.ron",
            edited(&workspace.text("run/config.ron"), &[("seed: 0", "seed: -1")]),
            "run configuration",
        ),
        ("run/policy.safetensors", "not a policy".into(), "policy"),
    ] {
        workspace.write(name, text);
        let done = workspace.run(&format!("--check {name}"));
        assert_eq!(done.status, Some(2), "{}", done.stderr);
        assert!(done.stderr.contains(&format!(" in this {problem}\n")), "{}", done.stderr);
    }
}

/// What `--reproduce` would refuse is a problem. A training run's questionable settings are printed at its stage or condition.
#[test]
fn the_training_runs_of_an_experiment_are_checked() {
    let workspace = Workspace::new();
    let experiment = |rest: &str| {
        format!(
            "(title: \"x\",\narms: [(name: \"a\",\nstages: [(scenario: \"empty\", preset: \"fast\")], policy: Best)],\n{rest}\n\
             tables: [(name: \"t\", title: \"t\", show: Seeds(measure: Success))])"
        )
    };
    let setting = "conditions: [(name: \"plain\"),\n(name: \"still\", overrides: {\"learning.learning_rate\": Constant(0.9)})],";
    workspace.write("questionable.ron", experiment(setting));
    let done = workspace.run_ok("--check questionable.ron");
    assert_eq!(done.stdout, "questionable.ron: ok (experiment)\n");
    assert!(done.stderr.starts_with("questionable.ron:5:1: "), "at the condition: {}", done.stderr);
    assert!(done.stderr.contains("(arm \"a\"): fast: `learning.learning_rate` "), "{}", done.stderr);

    let invalid = "conditions: [(name: \"b\", scenario: \"mazze\"),\n(name: \"c\", overrides: {\"learning.gama\": 1})],";
    workspace.write("invalid.ron", experiment(invalid));
    let done = workspace.run("--check invalid.ron");
    assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{}", done.stderr);
    for text in [
        "invalid.ron:4:14: `conditions[0]` cannot be trained: ",
        "invalid.ron:5:1: `conditions[1]` cannot be trained: ",
        "learning.gama=1: unknown field `gama`",
        "invalid.ron: 2 problems in this experiment",
    ] {
        assert!(done.stderr.contains(text), "no `{text}` in {}", done.stderr);
    }
    workspace.write(
        "short.ron",
        experiment("").replace("policy: Best", "").replace("Success)", "Success, after: Episodes(5))"),
    );
    let done = workspace.run("--check short.ron");
    assert!(
        done.stderr.contains("short.ron: a figure or table needs arm \"a\" after 5 episodes"),
        "{}",
        done.stderr
    );
}

#[test]
fn a_value_that_was_not_read_is_not_reported_twice() {
    let workspace = workspace();
    workspace.write(
        "e5.ron",
        edited(FAST, &[("EnvSteps(600000)", "EnvSteps(6e5)"), ("gamma: 0.95", "gamma: 95")]),
    );
    let done = workspace.run("--check e5.ron");
    let lines: Vec<&str> = done.stderr.lines().collect();
    assert_eq!(
        lines[..3],
        [
            "e5.ron:5:22: `budget` must be a whole number: write 600000",
            "e5.ron:18:16: `learning.gamma` is 95; help: give 0 to 1",
            "e5.ron: 2 problems in this preset",
        ]
    );
}

#[test]
fn all_problems_of_a_file_are_listed_at_once() {
    let workspace = workspace();
    workspace.write(
        "many.ron",
        "(\n    arenas: \"16\",\n    budget: 600000,\n    evaluation: (episodes: 0),\n    colour: 3,\n    learning: (\n        \
         loss: \"huber\",\n        gamma: 0,99,\n    ),\n)",
    );
    let done = workspace.run("--check many.ron");
    let lines: Vec<&str> = done.stderr.lines().collect();
    let starts = [
        "many.ron:2:13: `arenas` must be a whole number, without quotes",
        "many.ron:3:13: `budget` must be one of the choices `Episodes`, `EnvSteps`: write `Episodes(600000)`",
        "many.ron:4:28: `evaluation.episodes` is 0; help: give 1 to ",
        "many.ron:5:5: unknown field `colour` in the file: the fields are `about`, `based_on`, `arenas`, ",
        "many.ron:7:15: `learning.loss` must be one of the choices `",
        "many.ron:8:16: a decimal comma: write 0.99",
    ];
    for (line, start) in lines.iter().zip(starts) {
        assert!(line.starts_with(start), "{line}\ndoes not start with\n{start}\nin\n{}", done.stderr);
    }
    assert_eq!(
        lines[starts.len()..],
        ["many.ron: 6 problems in this preset", "error: 1 of 1 checked files are invalid"]
    );
}

/// A scenario, a preset and an experiment with an unknown field, values of the wrong type, numbers out of range, and parts
/// that do not fit together.
#[test]
fn faults_of_every_kind_are_listed_at_once() {
    let workspace = workspace();
    let mut messages = Messages::new("checks");
    workspace.write(
        "scenario.ron",
        r#"(
    name: "All",
    colour: 3,
    walls: [(corners_m: [(0.0, 1.0), (3.0, 1.0)])],
    obstacles: [
        (shape: Circle(radius_m: "big"), position_m: (0.6, 0.6)),
        (shape: Circle(radius_m: 99), position_m: (0.6, -0.6)),
        (shape: Circle(radius_m: 0.15), position_m: (1.95, 0.6)),
        (shape: Circle(radius_m: 0.15), position_m: (-1.95, 0.6), motion: Orbit(centre_m: (-1.0, 0.6), speed_rad_s: 50.0)),
        (shape: Circle(radius_m: 0.2)),
    ],
    task: (max_episode_steps: 3),
    starts: Fixed(position_m: (1.9, 0.7)),
    goals: Random(clearance_m: 1.95),
)
"#,
    );
    let preset = r#"(
    based_on: "base.ron",
    arenas: "16",
    budget: EnvSteps(6e5),
    evaluation: (episodes: 0),
    colour: 3,
    reward: (mu: -1, l_r_m: 0),
    learning: (
        gamma: 1.5,
        lr: 3e-4,
        gradient_clip: 10,
        buffer_size: 100000,
        network: (hidden: [64, 0, 0]),
        optimizer: Adam(beta1: 2.0, beta2: 2.0),
    ),
)
"#;
    workspace.write("preset.ron", preset);
    workspace.write("base.ron", "(arenas: 8,\n    learning: (tau: 0.01, batch_size: none),\n)\n");
    workspace.write(
        "experiment.ron",
        r#"(
    title: "",
    seeds: 0,
    colour: 3,
    arms: [
        (name: "a", stages: [(scenario: "empty", preset: "fast", budget: EnvSteps(0))]),
        (name: "b", stages: [(scenario: "mazze", preset: "fsat")]),
        (name: "c", stages: [(scenario: "empty", preset: "fast", overrides: {"learning.gama": 1})]),
    ],
    tables: [
        (
            name: "t",
            title: "T",
            show: Seeds(measure: Success, after: EnvSteps("5")),
            claims: [(statement: "x", measure: SuccessRates, better: "d", than: "a")],
        ),
    ],
)
"#,
    );
    for file in ["scenario.ron", "preset.ron", "experiment.ron"] {
        messages.checked(&workspace, file);
    }
    messages.check();
}

#[test]
fn problems_in_a_base_preset_are_reported_at_their_position_in_its_file() {
    let workspace = Workspace::new();
    workspace.write(
        "base.ron",
        "(\n    learning: (\n        train_freq: 5000000,\n        gamma: 0.9,\n    ),\n)\n",
    );
    workspace.write("mine.ron", "(\n    based_on: \"base.ron\",\n    budget: EnvSteps(600000),\n)\n");
    let done = workspace.run_ok("--check mine.ron");
    let start = "base.ron:3:21: warning: `learning.train_freq` is 5000000, ";
    assert!(done.stderr.lines().any(|line| line.starts_with(start)), "{}", done.stderr);
    let notes = workspace.run_ok("--check mine.ron --json").json()["notes"].clone();
    let notes = notes.as_array().expect("a list");
    assert!(notes.iter().any(|note| note["path"] == "base.ron" && note["line"] == 3), "{notes:?}");
    workspace.write("base.ron", "(\n    learning: (\n        gamma: 1.5,\n    ),\n)\n");
    let done = workspace.run("--check mine.ron");
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    assert!(done.stderr.starts_with("base.ron:3:16: `learning.gamma` is 1.5; "), "{}", done.stderr);
}

#[test]
fn field_names_of_other_libraries_are_answered_with_the_matching_field() {
    let workspace = Workspace::new();
    for (field, meant) in [
        ("learning: (gradient_clip: 10)", "did you mean `max_gradient_norm`?"),
        ("learning: (lr: 3e-4)", "did you mean `learning_rate`?"),
        ("learning: (hidden: [64])", "did you mean `network.hidden`?"),
        ("learning: (buffer_size: 1000)", "did you mean `replay.capacity`?"),
        ("learning: (tau: 0.005)", "did you mean `target_update: Soft(tau: ...)`?"),
        ("lr: 3e-4", "did you mean `learning.learning_rate`?"),
    ] {
        workspace.write("mine.ron", format!("(arenas: 4, {field})"));
        let done = workspace.run("--check mine.ron");
        assert!(done.stderr.contains(meant), "{field}: {}", done.stderr);
    }
    let done = workspace.run("--train --set learning.gradient_clip=10 --out new");
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    assert!(done.stderr.contains("did you mean `max_gradient_norm`?"), "{}", done.stderr);
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
