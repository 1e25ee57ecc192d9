//! Tests of training on sets of scenarios on the command line: every episode draws a scenario, and runs are repeated and
//! resumed bit for bit.

mod cli_support;

use std::fs;

use cli_support::{SCENARIO_1, SCENARIO_2, Workspace, edited, noisy, quick_fast, with_short_episodes};

/// A set of two scenarios and the levels of a generator.
const SET: &str = r#"(
    name: "Three worlds",
    scenarios: [
        (scenario: "one.ron", share: 2),
        (name: "moving", scenario: "two.ron"),
        (generator: "clutter.ron", levels: 20),
    ],
)"#;

const GENERATOR: &str = r#"(
    name: "Clutter",
    clutter: [Scatter(count: (2, 6), shapes: [Circle(radius_m: (0.1, 0.2))])],
    task: (max_episode_steps: 60),
)"#;

fn workspace() -> Workspace {
    let workspace = Workspace::new();
    workspace.write("fast.ron", quick_fast());
    workspace.write("one.ron", with_short_episodes(SCENARIO_1));
    workspace.write("two.ron", noisy(SCENARIO_2));
    workspace.write("clutter.ron", GENERATOR);
    workspace.write("set.ron", SET);
    workspace
}

const TRAIN: &str = "--train --scenario set.ron --preset fast.ron --seed 5";

#[test]
fn a_run_over_a_set_resumes_bit_identically() {
    let workspace = workspace();
    workspace.run_ok(&format!("{TRAIN} --steps 9000 --out straight"));
    workspace.run_ok(&format!("{TRAIN} --steps 1 --out pieces"));
    for steps in [17, 2222, 5200, 9000] {
        workspace.run_ok(&format!("--train --resume pieces --steps {steps}"));
    }
    workspace.assert_same_run("straight", "pieces");
    // config.ron needs none of the files.
    for file in ["set.ron", "one.ron", "two.ron", "clutter.ron"] {
        fs::remove_file(workspace.path(file)).unwrap();
    }
    workspace.run_ok("--train straight/config.ron --out again");
    workspace.assert_same_run("straight", "again");
}

#[test]
fn a_run_over_a_set_that_is_killed_before_its_first_checkpoint_can_be_resumed() {
    let workspace = workspace();
    workspace.run_ok(&format!("{TRAIN} --steps 1600 --out straight"));
    let aborted = workspace.run_until(&format!("{TRAIN} --steps 1600 --out killed"), "events: created");
    assert_ne!(aborted.status, Some(0), "{}", aborted.stderr);
    assert!(!workspace.path("killed/checkpoint/latest.bin").exists());
    assert_eq!(workspace.text("killed/episodes.csv").lines().count(), 1, "the header is there, but no row");
    workspace.run_ok("--train --resume killed");
    workspace.assert_same_run("straight", "killed");
}

#[test]
fn a_run_that_draws_levels_by_progress_resumes_bit_identically() {
    let workspace = workspace();
    workspace.write("progress.ron", "(based_on: \"fast.ron\", levels: ByProgress(uniform: 0.2))");
    let train = "--train --scenario clutter.ron --seed 5 --steps";
    workspace.run_ok(&format!("{train} 9000 --preset progress.ron --out straight"));
    workspace.run_ok(&format!("{train} 1 --preset progress.ron --out pieces"));
    for steps in [17, 2222, 5200, 9000] {
        workspace.run_ok(&format!("--train --resume pieces --steps {steps}"));
    }
    workspace.assert_same_run("straight", "pieces");
    workspace.run_ok(&format!("{train} 9000 --preset fast.ron --out uniform"));
    let episodes = |run: &str| workspace.text(&format!("{run}/episodes.csv")).lines().count();
    assert_ne!(episodes("straight"), episodes("uniform"), "other levels, other episodes");
    // Evaluations do not draw their levels by progress, and the first one tests the same initial policy in both runs.
    let first = |run: &str| workspace.rows(&format!("{run}/evaluations.csv"))[0]["mean_cost_s"].clone();
    assert_eq!(first("straight"), first("uniform"));
}

#[test]
fn a_run_with_mirror_augmentation_and_dropout_of_predictions_resumes_bit_identically() {
    let workspace = workspace();
    let preset = |mirror: bool, dropout: f32| {
        format!(
            "(based_on: \"fast.ron\", observation: Sectors(count: 12, earlier_steps: 1, predicted_paths: true), \
             prediction_dropout: {dropout:?}, learning: (mirror: {mirror}), actions: \
             Relative([(speed: 1, turn: 1), (speed: 1, turn: 0), (speed: 1, turn: -1), (speed: 0, turn: 1), (speed: 0, turn: -1)]))"
        )
    };
    workspace.write("mirrored.ron", preset(true, 0.5));
    workspace.write("plain.ron", preset(false, 0.5));
    workspace.write("predicted.ron", preset(true, 0.0));
    let train = "--train --scenario set.ron --seed 5 --steps";
    workspace.run_ok(&format!("{train} 4000 --preset mirrored.ron --out straight"));
    workspace.run_ok(&format!("{train} 1 --preset mirrored.ron --out pieces"));
    for steps in [1111, 4000] {
        workspace.run_ok(&format!("--train --resume pieces --steps {steps}"));
    }
    workspace.assert_same_run("straight", "pieces");
    workspace.run_ok(&format!("{train} 4000 --preset plain.ron --out plain"));
    workspace.run_ok(&format!("{train} 4000 --preset predicted.ron --out predicted"));
    // The bytes after the header: the card in the header names the preset, so the files always differ.
    let weights = |run: &str| {
        let policy = workspace.read(&format!("{run}/policy-last.safetensors"));
        let header = u64::from_le_bytes(policy[..8].try_into().unwrap());
        policy[8 + header as usize..].to_vec()
    };
    assert!(weights("straight") != weights("plain"), "the mirrored transitions change what is learned");
    assert!(weights("straight") != weights("predicted"), "dropout changes what is learned");
}

#[test]
fn drawing_by_progress_from_too_many_levels_is_an_error() {
    let workspace = workspace();
    let entry = |k: u32| format!("(name: \"n{k}\", generator: \"clutter.ron\", levels: 900000)");
    let entries: Vec<String> = (0..5).map(entry).collect();
    workspace.write("many.ron", format!("(name: \"Many\", scenarios: [{}])", entries.join(", ")));
    workspace.write("progress.ron", "(based_on: \"fast.ron\", levels: ByProgress())");
    let done = workspace.run("--train --scenario many.ron --preset progress.ron --steps 1 --out new");
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    let expected = "the set has 4500000 levels, more than 4000000; help: give its generators fewer `levels`";
    assert!(done.stderr.contains(expected), "{}", done.stderr);
    workspace.run_ok("--train --scenario many.ron --preset fast.ron --steps 1 --out uniform");
}

#[cfg(target_os = "linux")]
#[test]
fn the_number_of_cores_does_not_change_a_run_over_a_set() {
    let workspace = workspace();
    workspace.run_ok(&format!("{TRAIN} --steps 5000 --out all-cores"));
    workspace.run_on_one_core(&format!("{TRAIN} --steps 5000 --out pinned"));
    workspace.assert_same_run("all-cores", "pinned");
}

#[test]
fn every_episode_draws_its_scenario_by_the_shares() {
    let workspace = workspace();
    workspace.run_ok(&format!("{TRAIN} --steps 30000 --out run"));
    let episodes = workspace.rows("run/episodes.csv");
    let share = |name: &str| {
        let count = episodes.iter().filter(|row| row["scenario"] == name).count();
        count as f64 / episodes.len() as f64
    };
    assert!(episodes.len() > 350, "{} episodes", episodes.len());
    // About four standard deviations of a binomial distribution with 400 episodes.
    for (name, expected) in [("one", 0.5), ("moving", 0.25), ("clutter", 0.25)] {
        assert!((share(name) - expected).abs() < 0.1, "{name}: {} of the episodes", share(name));
    }
    let of_arena_3: Vec<&str> =
        episodes.iter().filter(|row| row["arena"] == "3").map(|row| row["scenario"].as_str()).collect();
    assert!(of_arena_3.windows(2).any(|pair| pair[0] != pair[1]), "one arena has several: {of_arena_3:?}");
}

#[test]
fn evaluations_and_the_final_test_give_the_success_in_each_scenario() {
    let workspace = workspace();
    workspace.run_ok(&format!("{TRAIN} --steps 6000 --out run"));
    let evaluations = workspace.rows("run/evaluations.csv");
    assert!(!evaluations.is_empty());
    for row in &evaluations {
        let rate = |column: &str| row[column].parse::<f64>().unwrap();
        let [one, moving, clutter] =
            ["one", "moving", "clutter"].map(|name| rate(&format!("success_rate_{name}")));
        // 20 episodes: 10, 5 and 5.
        let mean = 0.5 * one + 0.25 * moving + 0.25 * clutter;
        assert!((mean - rate("success_rate")).abs() < 1e-9, "{row:?}");
    }
    let summary = workspace.json("run/summary.json");
    assert_eq!(summary["scenario"], "Three worlds");
    let tested: Vec<(&str, u64)> = summary["final_test"]["scenarios"]
        .as_array()
        .unwrap()
        .iter()
        .map(|of| (of["name"].as_str().unwrap(), of["episodes"].as_u64().unwrap()))
        .collect();
    assert_eq!(tested, [("one", 10), ("moving", 5), ("clutter", 5)]);
    let curves = cli_support::event_files::curves(&workspace.path("run"));
    for tag in ["evaluation/success_rate/moving", "episode/return/clutter"] {
        assert!(curves.keys().any(|key| key.contains(tag)), "{tag}");
    }
    let card = workspace.run_ok("--card run/policy.safetensors").json();
    let set = &card["card"]["training"]["scenario_set"];
    assert_eq!(set["name"], "Three worlds");
    assert_eq!(set["crc32c"], summary["scenario_crc32c"], "the card and the summary name the same set");
}

#[test]
fn a_setting_changes_every_scenario_of_a_set_but_no_levels() {
    let workspace = workspace();
    let two = "(name: \"Two\", scenarios: [(scenario: \"one.ron\"), (scenario: \"two.ron\")])";
    workspace.write("two-set.ron", two);
    let set = "--set scenario.lidar.dropout=0.125 --preset fast.ron --steps 1";
    workspace.run_ok(&format!("--train --scenario two-set.ron {set} --out run"));
    let config = workspace.text("run/config.ron");
    assert_eq!(config.matches("dropout: 0.125").count(), 3, "both, and the first as `scenario`: {config}");
    let done = workspace.run(&format!("--train --scenario set.ron {set} --out refused"));
    assert_eq!(done.status, Some(2));
    assert!(done.stderr.contains("does not change the levels of `clutter`; help: "), "{}", done.stderr);
    assert!(!workspace.path("refused").exists());
}

#[test]
fn a_preset_names_its_scenarios_and_a_flag_names_others() {
    let workspace = workspace();
    fs::create_dir(workspace.path("mine")).unwrap();
    workspace.write("mine/preset.ron", "(based_on: \"../fast.ron\", scenario: \"../set.ron\")");
    workspace.write("other.ron", "(based_on: \"mine/preset.ron\")");
    workspace.run_ok("--check mine/preset.ron other.ron");
    let train = "--train --seed 5 --steps 1 --preset";
    workspace.run_ok(&format!("{train} mine/preset.ron --out own"));
    workspace.run_ok(&format!("{train} other.ron --out inherited"));
    workspace.run_ok(&format!("{train} other.ron --scenario two.ron --out given"));
    let scenario = |run: &str| workspace.json(&format!("{run}/summary.json"))["scenario"].clone();
    assert_eq!([scenario("own"), scenario("inherited")], ["Three worlds", "Three worlds"]);
    assert_eq!(scenario("given"), "Scenario II");
    let config = workspace.text("own/config.ron");
    assert!(config.contains("scenario_from: \"mine/../set.ron\""), "{config}");

    workspace.write("bad.ron", "(\n    based_on: \"fast\",\n    scenario: \"no-such.ron\",\n)");
    let done = workspace.run("--check bad.ron");
    let text = format!("{}{}", done.stdout, done.stderr);
    assert!(
        done.status == Some(2) && text.contains("bad.ron:3:15: `scenario` cannot be used: no-such.ron: "),
        "{text}"
    );
    let done = workspace.run("--train --preset bad.ron --out refused");
    let problem = "bad.ron: its `scenario` cannot be used: no-such.ron: no such file";
    assert!(done.status == Some(2) && done.stderr.contains(problem), "{}", done.stderr);
    workspace.run_ok(&format!("{train} bad.ron --scenario two.ron --out overridden"));
}

/// Asserts that `--train` and `--check` reject `set` with each of `parts` in the message, and write nothing.
fn assert_rejected(workspace: &Workspace, set: &str, parts: &[&str]) {
    workspace.write("bad.ron", set);
    for command in ["--train --scenario bad.ron --out run", "--check bad.ron"] {
        let done = workspace.run(command);
        let text = format!("{}{}", done.stdout, done.stderr);
        assert_eq!(done.status, Some(2), "{command}: {text}");
        for part in parts {
            assert!(text.contains(part), "{command}: no `{part}` in {text}");
        }
    }
    assert!(!workspace.path("run").exists());
}

#[test]
fn scenarios_that_need_different_policies_are_rejected_with_all_differing_fields() {
    let workspace = workspace();
    let other = edited(
        SCENARIO_1,
        &[(
            "\n    name:",
            "\n    lidar: (beams: 36),\n    robot: (motions: [(v_m_s: 0.1, w_rad_s: 1.0), (v_m_s: 0.1, w_rad_s: -1.0)]),\n    name:",
        )],
    );
    workspace.write("other.ron", other);
    let set = "(\n    name: \"Bad\",\n    scenarios: [\n        (scenario: \"one.ron\"),\n        (scenario: \"other.ron\"),\n    ],\n)";
    let expected = [
        "bad.ron:5:20: `scenarios[1].scenario` (`other`) needs a different policy from `one`",
        "lidar.beams (36, not 24)",
        "robot.motions (2 motions, not 5)",
        "give all scenarios of a set the same LIDAR beams",
    ];
    workspace.write("bad.ron", set);
    let trained = workspace.run("--train --scenario bad.ron --out run");
    // The set is valid for a policy with sector observations.
    let checked = workspace.run("--check bad.ron");
    assert_eq!((trained.status, checked.status), (Some(2), Some(0)));
    let text = trained.stderr;
    expected.iter().for_each(|part| assert!(text.contains(part), "no `{part}` in {text}"));
    assert!(!workspace.path("run").exists());
}

#[test]
fn an_invalid_entry_of_a_set_is_reported_with_line_and_fix() {
    let workspace = workspace();
    let set =
        |entries: &str| format!("(\n    name: \"Bad\",\n    scenarios: [\n        {entries}\n    ],\n)");
    for (entries, parts) in [
        (
            "(scenario: \"missing.ron\"),",
            &["bad.ron:4:20: `scenarios[0].scenario` can't be used: ", "missing.ron"][..],
        ),
        ("(generator: \"one.ron\"),", &["bad.ron:4:21: `scenarios[0].generator` can't be used: "]),
        (
            "(scenario: \"one.ron\", generator: \"clutter.ron\"),",
            &["bad.ron:4:9:", "write either `scenario: \"FILE\"`"],
        ),
        (
            "(scenario: \"one.ron\"), (scenario: \"one.ron\"),",
            &["the second one called `one`: give this entry another"],
        ),
        (
            "(scenario: \"one.ron\", share: 0),",
            &["bad.ron:4:38: `scenarios[0].share` is 0: write a number from 0.001"],
        ),
        ("", &["`scenarios` has 0 entries: write 1 to 64"]),
    ] {
        assert_rejected(&workspace, &set(entries), parts);
    }
}

#[test]
fn a_mode_for_one_scenario_rejects_a_set_and_names_its_scenarios() {
    let workspace = workspace();
    workspace.run_ok("--check set.ron");
    let done = workspace.run("--draw set.svg --plain --scenario set.ron");
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    let expected = "set.ron: is a set of scenarios (one, moving, clutter), but one scenario is needed here; help: give one of them";
    assert!(done.stderr.contains(expected), "{}", done.stderr);
}

#[test]
fn a_configuration_whose_scenario_does_not_fit_its_set_is_rejected() {
    let workspace = workspace();
    workspace.run_ok(&format!("{TRAIN} --steps 1 --out run"));
    let config = workspace.text("run/config.ron");
    let (before, after) = config.rsplit_once("beams: 24").expect("the LIDAR of the scenario");
    workspace.write("run/config.ron", format!("{before}beams: 25{after}"));
    let done = workspace.run("--resume run");
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    assert!(done.stderr.contains("lidar.beams (25, not 24)"), "{}", done.stderr);
}

#[test]
fn the_scenarios_of_a_configuration_are_not_compared_if_a_value_cannot_be_read() {
    let workspace = workspace();
    let set = r#"(name: "Two", scenarios: [(scenario: "empty"), (name: "other", scenario: "empty")])"#;
    workspace.write("two.ron", set);
    workspace.run_ok("--train --scenario two.ron --preset fast.ron --steps 1 --out run");
    let config = workspace.text("run/config.ron");
    workspace.write("run/config.ron", config.replacen("beams: 24", "beams: \"many\"", 1));
    let done = workspace.run("--check run/config.ron");
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    assert!(done.stderr.contains(" in this run configuration\n"), "{}", done.stderr);
    assert!(!done.stderr.contains("needs a different policy"), "{}", done.stderr);
}
