//! Tests of `--set`, of presets that are based on others, and of a run's `config.ron` as an argument: each trains exactly as
//! edited files do.

mod cli_support;

use cli_support::messages::rejection;
use cli_support::{SCENARIO_1, Workspace, edited, quick_fast, with_short_episodes};

/// A workspace with a scenario and a preset, and with copies of both in which some fields are changed.
fn workspace() -> Workspace {
    let workspace = Workspace::new();
    let scenario = with_short_episodes(SCENARIO_1);
    workspace.write("one.ron", &scenario);
    workspace.write("fast.ron", quick_fast());
    let noise = ("    obstacles: [", "    lidar: (noise_std_m: 0.02),\n\n    obstacles: [");
    workspace.write("edited-one.ron", edited(&scenario, &[noise]));
    workspace.write(
        "edited-fast.ron",
        edited(&quick_fast(), &[("gamma: 0.95", "gamma: 0.9"), ("alpha: 0.6", "alpha: 0.3")]),
    );
    workspace
}

const SET: &str =
    "--set learning.gamma=0.9 --set learning.replay.sampling.alpha=0.3 --set scenario.lidar.noise_std_m=0.02";

#[test]
fn settings_train_what_edited_files_train_and_the_configuration_records_the_result() {
    let workspace = workspace();
    let done = workspace
        .run_ok(&format!("--train --scenario one.ron --preset fast.ron {SET} --steps 3200 --out set"));
    assert!(
        done.stderr.contains("set learning.gamma=0.9, learning.replay.sampling.alpha=0.3, scenario"),
        "{}",
        done.stderr
    );
    workspace.run_ok("--train --scenario edited-one.ron --preset edited-fast.ron --steps 3200 --out edited");
    workspace.write(
        "based.ron",
        "(based_on: \"fast.ron\", learning: (gamma: 0.9, replay: (sampling: Prioritized(alpha: 0.3, \
         beta: Linear(from: 0.4, to: 1.0, env_steps: 600000), importance_weights: true, epsilon: 0.001))))",
    );
    workspace.run_ok("--train --scenario edited-one.ron --preset based.ron --steps 3200 --out based");
    let config = |run: &str, names: [&str; 2]| {
        let [scenario, preset] = names.map(|name| format!("_from: \"{name}.ron\""));
        edited(
            &workspace.text(&format!("{run}/config.ron")),
            &[(&scenario, "_from: 1"), (&preset, "_from: 2")],
        )
    };
    let edited = config("edited", ["edited-one", "edited-fast"]);
    assert_eq!(config("set", ["one", "fast"]), edited, "config.ron holds the result of the settings");
    assert_eq!(config("based", ["edited-one", "based"]), edited, "config.ron holds the complete preset");
    let [set, edited, based] = ["set", "edited", "based"].map(|run| workspace.run_contents(run));
    assert!(set.episodes.len() > 5, "the run is too short to prove anything");
    for other in [&set, &based] {
        assert_eq!(other.episodes, edited.episodes);
        assert_eq!(other.curves, edited.curves);
    }
}

#[test]
fn the_configuration_of_a_run_repeats_it_exactly() {
    let workspace = workspace();
    let arguments = "--scenario one.ron --preset fast.ron --seed 7 --steps 3200";
    workspace.run_ok(&format!("--train {arguments} {SET} --out first"));
    for file in ["one.ron", "fast.ron"] {
        std::fs::remove_file(workspace.path(file)).expect("the file exists");
    }
    workspace.run_ok("--train first/config.ron --out again");
    workspace.assert_same_run("first", "again");
    workspace.run_ok("--train first --seed 8 --out other");
    assert!(workspace.run_contents("other").last != workspace.run_contents("first").last, "another seed");

    workspace.run_ok("--train --scenario first/config.ron --preset first/config.ron --seed 7 --out parts");
    assert_eq!(workspace.run_contents("parts").episodes, workspace.run_contents("first").episodes);
    let check = workspace.run_ok("--check first/config.ron");
    assert_eq!(check.stdout, "first/config.ron: ok (run configuration)\n");
}

#[test]
fn a_run_that_started_from_a_policy_is_repeated_from_its_own_copy() {
    let workspace = workspace();
    workspace.run_ok("--train --scenario one.ron --preset fast.ron --steps 1600 --out source");
    let init = "--init source/policy.safetensors --epsilon 0.5";
    workspace.run_ok(&format!(
        "--train --scenario edited-one.ron --preset fast.ron {init} --steps 1600 --out first"
    ));
    std::fs::remove_dir_all(workspace.path("source")).expect("the folder exists");
    workspace.run_ok("--train first/config.ron --out again");
    workspace.assert_same_run("first", "again");
}

#[test]
fn a_file_of_another_kind_is_named_with_the_flag_that_takes_it() {
    let workspace = workspace();
    workspace.write("exp.ron", "(title: \"x\", arms: [(name: \"a\", stages: [(budget: Episodes(1))])])");
    for (arguments, expected) in [
        (
            "--train one.ron",
            "one.ron: is a scenario, not a run configuration; help: --train --scenario one.ron",
        ),
        (
            "--train fast.ron",
            "fast.ron: is a preset, not a run configuration; help: --train --preset fast.ron",
        ),
        (
            "--train --scenario fast.ron",
            "fast.ron: is a preset, not a scenario; help: --train --preset fast.ron",
        ),
        (
            "--train --preset one.ron",
            "one.ron: is a scenario, not a preset; help: --train --scenario one.ron",
        ),
        (
            "--train --preset exp.ron",
            "exp.ron: is an experiment, not a preset; help: --reproduce --experiment exp.ron",
        ),
    ] {
        assert_eq!(rejection(&workspace, arguments).trim_end(), format!("error: {expected}"), "{arguments}");
    }
}

#[test]
fn a_policy_is_tested_in_a_scenario_with_settings() {
    let workspace = workspace();
    workspace.run_ok("--train --scenario one.ron --preset fast.ron --steps 800 --out run");
    let eval = |arguments: &str| {
        let arguments = format!("--eval run/policy.safetensors --rounds 1 --episodes 5 --json {arguments}");
        workspace.run_ok(&arguments).json()
    };
    let set = eval("--set scenario.lidar.noise_std_m=0.02");
    assert_eq!(set, eval("--scenario edited-one.ron"));
    assert_eq!(eval("--set scenario.name=\"Noisy\"")["scenario"].as_str(), Some("Noisy"));
}
