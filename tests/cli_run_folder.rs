//! Tests of run folders: their contents and names, and that no run overwrites another.

mod cli_support;

use std::collections::BTreeMap;

use cli_support::event_files::curves;
use cli_support::{
    PER_D3QN, SCENARIO_1, Workspace, edited, quick_fast, signal, wait_for_output, wait_until,
    with_short_episodes,
};
use serde_json::Value;
use wayfield::run::folder::RunConfig;
use wayfield::scenario::read_ron;

fn workspace() -> Workspace {
    let workspace = Workspace::new();
    workspace.write("quick.ron", quick_fast());
    workspace.write("short.ron", with_short_episodes(SCENARIO_1));
    workspace
}

const TRAIN: &str = "--train --scenario short.ron --preset quick.ron --steps 3200";

#[test]
fn a_run_folder_has_all_files() {
    let workspace = workspace();
    let done = workspace.run_ok(&format!("{TRAIN} --seed 8 --out run"));
    let mut names: Vec<String> = std::fs::read_dir(workspace.path("run"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let (events, others): (Vec<String>, Vec<String>) =
        names.into_iter().partition(|name| name.starts_with("events.out.tfevents."));
    assert_eq!(
        others,
        [
            "checkpoint",
            "config.ron",
            "episodes.csv",
            "evaluations.csv",
            "learning-curve.svg",
            "policy-last.safetensors",
            "policy.safetensors",
            "processors.json",
            "summary.json",
        ],
        "no file is missing, and no temporary file is left"
    );
    assert_eq!(events.len(), 1, "one TensorBoard file: {events:?}");
    assert!(workspace.read(&format!("run/{}", events[0])).len() > 100);
    let mut checkpoints: Vec<_> = std::fs::read_dir(workspace.path("run/checkpoint"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    checkpoints.sort();
    assert_eq!(checkpoints, ["latest.bin", "lock", "previous.bin"], "checkpoints of the end and the start");
    assert!(workspace.text("run/learning-curve.svg").trim_start().starts_with("<svg"));

    // The summary is on stdout, progress on stderr.
    for needle in
        ["best policy", "3200 env steps", "run folder      run", "wayfield --eval run/policy.safetensors"]
    {
        assert!(done.stdout.contains(needle), "`{needle}` is not in\n{}", done.stdout);
    }
    assert!(done.stderr.starts_with("run: Scenario I, preset quick, seed 8, 16 arenas\n"), "{}", done.stderr);
    assert!(done.stderr.ends_with("done: run\n"), "{}", done.stderr);
    assert!(!done.stderr.contains(['\u{1b}', '\r']), "plain lines, because stderr is not a terminal");
}

/// Rows appear before the next checkpoint, and before a buffer (of at least forty rows) is full.
#[test]
fn rows_are_in_the_files_while_the_run_goes_on() {
    let workspace = workspace();
    // Slow, with an evaluation every other second or so.
    let slow = edited(
        PER_D3QN,
        &[
            ("every_env_steps: 20000, episodes: 200", "every_env_steps: 200, episodes: 1"),
            ("hidden: [64, 64]", "hidden: [256, 256]"),
        ],
    );
    workspace.write("slow.ron", slow);
    let mut child = workspace
        .start("--train --scenario short.ron --preset slow.ron --checkpoint-every 1000000 --out run --steps 50000000");
    for name in ["run/episodes.csv", "run/evaluations.csv"] {
        let rows = || {
            let text = std::fs::read_to_string(workspace.path(name)).unwrap_or_default();
            text.matches('\n').count().saturating_sub(1)
        };
        wait_until(&mut child, "a row", || rows() > 0);
        assert!(rows() < 30, "{name}: {} rows at once", rows());
    }
    wait_until(&mut child, "a point of both kinds", || {
        let curves = curves(&workspace.path("run"));
        ["episode/return", "evaluation/success_rate"].iter().all(|tag| curves.contains_key(*tag))
    });
    signal(&child, "KILL");
    wait_for_output(child);
}

#[test]
fn the_summary_agrees_with_the_csv_files() {
    let workspace = workspace();
    let printed = workspace.run_ok(&format!("{TRAIN} --seed 8 --out run --json")).json();
    let summary = workspace.json("run/summary.json");
    assert_eq!(printed, summary, "--json prints summary.json");

    let (episodes, evaluations) = (workspace.rows("run/episodes.csv"), workspace.rows("run/evaluations.csv"));
    assert_eq!(summary["episodes"], episodes.len());
    assert_eq!(summary["env_steps"], 3200);
    assert!(summary["gradient_steps"].as_u64().unwrap() > 0);
    assert!(summary["wall_s"].as_f64().unwrap() > 0.0);
    let rates: Vec<f64> = evaluations.iter().map(|row| row["success_rate"].parse().unwrap()).collect();
    assert_eq!(summary["last_success_rate"].as_f64(), rates.last().copied());
    let cost = |row: &BTreeMap<String, String>| row["mean_cost_s"].parse::<f64>().unwrap();
    let min_cost = evaluations.iter().map(cost).reduce(f64::min).unwrap();
    let best = evaluations.iter().rfind(|row| cost(row) <= 1.01 * min_cost).unwrap();
    let rate: f64 = best["success_rate"].parse().unwrap();
    assert_eq!(
        summary["best_success_rate"], rate,
        "the best policy is the latest one close to the minimum cost"
    );
    for first in ["first_96", "first_99"] {
        let milestone = summary.get(first).expect(first);
        let keys = ["env_steps", "episodes", "wall_s"];
        assert!(
            *milestone == Value::Null || keys.iter().all(|key| milestone[key].is_number()),
            "{milestone}"
        );
    }
    // Episodes are numbered, their rewards add up to the return, and env steps never decrease.
    let of = |row: &BTreeMap<String, String>, key: &str| -> f64 { row[key].parse().unwrap() };
    for (number, row) in (1..).zip(&episodes) {
        assert_eq!(of(row, "episode"), f64::from(number));
        let parts = ["reward_goal", "reward_collision", "reward_attraction", "reward_repulsion"];
        let sum: f64 = parts.iter().map(|part| of(row, part)).sum();
        assert!((sum - of(row, "return")).abs() < 1e-3 * (1.0 + sum.abs()), "{row:?}");
        assert_eq!(of(row, "reward_goal"), 250.0 * of(row, "goals"));
        assert_eq!(of(row, "reward_collision"), -200.0 * of(row, "collision"));
        assert!((1.0..=120.0).contains(&of(row, "steps")), "{row:?}");
        assert!(
            of(row, "collision") == 1.0 || of(row, "steps") == 120.0,
            "a collision or the time limit: {row:?}"
        );
    }
    let env_steps: Vec<f64> = episodes.iter().map(|row| of(row, "env_steps")).collect();
    assert!(env_steps.is_sorted());
}

#[test]
fn the_curves_of_a_run_can_be_drawn_even_while_it_goes_on() {
    let workspace = workspace();
    workspace.run_ok(&format!("{TRAIN} --seed 8 --out run"));
    workspace.run_ok("--draw curves.svg --run run");
    assert_eq!(workspace.read("curves.svg"), workspace.read("run/learning-curve.svg"));
    workspace.run_ok("--draw curves.pdf --run run");
    assert!(workspace.read("curves.pdf").starts_with(b"%PDF-"));
    // A run in progress has written a part of its next row.
    workspace.write("run/episodes.csv", workspace.text("run/episodes.csv") + "9999,12");
    workspace.run_ok("--draw again.svg --run run");
    assert_eq!(workspace.read("again.svg"), workspace.read("curves.svg"));
    for (arguments, expected) in [
        (
            "--run absent",
            "error: absent: is not a run folder (it has no config.ron); help: give the folder of a run",
        ),
        ("--run run --scenario hall", "cannot be used with"),
        ("--run run --plain", "cannot be used with"),
        ("--run run --seed 3", "cannot be used with"),
        ("--run run --resolution 0.05", "cannot be used with"),
    ] {
        let done = workspace.run(&format!("--draw new.svg {arguments}"));
        assert_eq!(done.status, Some(2), "{arguments}: {}", done.stderr);
        assert!(done.stderr.contains(expected), "{arguments}: {}", done.stderr);
    }
    assert!(!workspace.path("new.svg").exists());
}

#[test]
fn every_record_names_the_program_and_the_scenario() {
    let workspace = workspace();
    workspace.run_ok(&format!("{TRAIN} --seed 8 --out run"));
    let card = workspace.run_ok("--card run/policy.safetensors").json()["card"].clone();
    assert!(card["program"]["version"].is_string() && card["scenario_crc32c"].is_string(), "{card}");
    let config: RunConfig = read_ron(workspace.path("run/config.ron")).unwrap();
    assert_eq!(config.commit.as_deref(), card["program"]["commit"].as_str());
    let tested = workspace.run_ok("--eval run/policy.safetensors --rounds 1 --episodes 2 --json").json();
    for record in [workspace.json("run/summary.json"), tested] {
        assert_eq!(record["version"], card["program"]["version"], "{record}");
        assert_eq!(record["commit"], card["program"]["commit"], "{record}");
        assert_eq!(record["scenario_crc32c"], card["scenario_crc32c"], "{record}");
    }
}

#[test]
fn config_ron_is_enough_to_repeat_a_run() {
    let workspace = workspace();
    workspace.run_ok(&format!("{TRAIN} --seed 8 --arenas 4 --out run"));
    let config: RunConfig = read_ron(workspace.path("run/config.ron")).unwrap();
    assert_eq!((config.seed, config.preset.arenas), (8, 4));
    assert_eq!(config.version, env!("CARGO_PKG_VERSION"));

    // Scenario and preset, saved as separate files, give the same run.
    workspace.write("scenario.ron", wayfield::scenario::to_ron(&config.scenario).unwrap());
    workspace.write("preset.ron", wayfield::scenario::to_ron(&config.preset).unwrap());
    workspace.run_ok("--train --scenario scenario.ron --preset preset.ron --seed 8 --out again");
    let (first, again) = (workspace.run_contents("run"), workspace.run_contents("again"));
    assert_eq!((first.episodes, first.evaluations), (again.episodes, again.evaluations));
}

#[test]
fn a_config_ron_without_lag_and_encoding_loads_with_the_defaults() {
    let workspace = workspace();
    workspace.run_ok("--train --scenario short.ron --preset quick.ron --steps 16 --out run");
    let text = workspace.text("run/config.ron");
    let config: RunConfig = read_ron(workspace.path("run/config.ron")).unwrap();
    let old: Vec<&str> =
        text.lines().filter(|l| !l.contains("actuator_lag_s:") && !l.contains("observation:")).collect();
    assert_eq!(old.len(), text.lines().count() - 2, "{text}");
    workspace.write("old.ron", old.join("\n"));
    assert_eq!(
        read_ron::<RunConfig>(workspace.path("old.ron")).unwrap(),
        config,
        "no lag, scaled observations"
    );
}

#[test]
fn default_folders_are_named_after_the_run_and_never_reused() {
    let workspace = workspace();
    let train = "--train --scenario short.ron --preset quick.ron --steps 1600 --seed 3";
    assert!(workspace.run_ok(train).stdout.contains("run folder      runs/short-quick-3\n"));
    let first = workspace.run_contents("runs/short-quick-3");
    assert!(workspace.run_ok(train).stdout.contains("run folder      runs/short-quick-3-2\n"));
    assert!(workspace.run_ok(train).stdout.contains("run folder      runs/short-quick-3-3\n"));
    assert_eq!(workspace.run_contents("runs/short-quick-3"), first, "the first run is unchanged");
    let done = workspace.run_ok("--train --scenario empty --steps 1");
    assert!(done.stdout.contains("run folder      runs/empty-fast-0\n"), "{}", done.stdout);
}

#[test]
fn a_folder_that_holds_a_run_is_not_overwritten() {
    let workspace = workspace();
    workspace.run_ok(&format!("{TRAIN} --out run"));
    let before = workspace.all_files();
    let done = workspace.run(&format!("{TRAIN} --seed 99 --out run"));
    assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""));
    assert_eq!(
        done.stderr,
        "error: run: already holds a run; help: continue it with --resume, or give --out another folder\n"
    );
    assert!(workspace.all_files() == before);
}

#[test]
fn a_folder_with_checkpoints_only_is_not_used_for_another_run() {
    let workspace = workspace();
    workspace.run_ok(&format!("{TRAIN} --out run"));
    std::fs::create_dir(workspace.path("old")).expect("a folder");
    std::fs::rename(workspace.path("run/checkpoint"), workspace.path("old/checkpoint")).expect("a folder");
    let before = workspace.all_files();
    let done = workspace.run(&format!("{TRAIN} --out old"));
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    assert_eq!(done.stderr, "error: old: is not empty; help: give --out a new or an empty folder\n");
    assert!(workspace.all_files() == before);
}

#[test]
fn a_run_whose_rows_are_missing_is_not_resumed() {
    let workspace = workspace();
    workspace.run_ok(&format!("{TRAIN} --out run"));
    let rows = workspace.path("run/episodes.csv");
    std::fs::remove_file(&rows).expect("the run has this file");
    let done = workspace.run("--train --resume run --steps 4800");
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    assert!(done.stderr.contains("error: run/episodes.csv: "), "{}", done.stderr);
    assert!(!rows.exists(), "an empty file is no replacement for the rows");
}

#[test]
fn missing_parent_folders_of_out_are_created() {
    let workspace = workspace();
    workspace.run_ok(&format!("{TRAIN} --out a/b/c"));
    assert!(workspace.path("a/b/c/summary.json").exists());
}

#[test]
fn a_folder_does_not_hide_a_shipped_scenario_or_preset() {
    let workspace = workspace();
    std::fs::create_dir(workspace.path("empty")).expect("a folder");
    std::fs::create_dir(workspace.path("fast")).expect("a folder");
    let done =
        workspace.run_ok("--train --scenario empty --preset fast --steps 160 --out empty/run --json").json();
    assert_eq!(done["scenario_from"], "empty");
}
