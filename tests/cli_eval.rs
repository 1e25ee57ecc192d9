//! Tests of trained policies: the default preset learns, evaluations are correct, and policies can be transferred.

mod cli_support;

use std::collections::BTreeMap;
use std::sync::OnceLock;

use cli_support::{FAST, SCENARIO_1, Workspace, edited, quick_fast, raw};
use serde_json::Value;
use wayfield::policy::Policy;

/// A workspace, shared by the tests that need it, with a run of the default preset in `trained`: 30,000 env steps, seed 1.
fn trained() -> &'static Workspace {
    static WORKSPACE: OnceLock<Workspace> = OnceLock::new();
    WORKSPACE.get_or_init(|| {
        let workspace = Workspace::new();
        workspace.run_ok("--train --steps 30000 --seed 1 --out trained");
        workspace
    })
}

const EVAL: &str = "--eval trained/policy.safetensors --rounds 4 --episodes 50";

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("`{key}` is not a number in {value}"))
}

fn numbers(value: &Value, key: &str) -> Vec<f64> {
    let list = value[key].as_array().unwrap_or_else(|| panic!("`{key}` is not a list in {value}"));
    list.iter().map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn the_default_preset_learns_to_navigate_in_30_000_steps() {
    // These 300 episodes occur neither in training nor in its evaluations.
    let report = trained().run_ok("--eval trained/policy.safetensors --rounds 3 --seed 77 --json").json();
    assert!(number(&report, "success_rate") >= 0.9, "{report}");
    let summary = trained().json("trained/summary.json");
    assert!(number(&summary, "best_success_rate") >= 0.95, "{summary}");
    assert!(number(&summary["first_96"], "env_steps") <= 30_000.0, "{summary}");
}

#[test]
fn an_untrained_policy_has_a_low_success_rate() {
    let workspace = Workspace::new();
    workspace.run_ok("--train --steps 1 --seed 1 --out untrained");
    let report = workspace.run_ok("--eval untrained/policy.safetensors --rounds 3 --seed 77 --json").json();
    assert!(number(&report, "success_rate") < 0.5, "{report}");
    assert_eq!(workspace.json("untrained/summary.json")["first_96"], Value::Null);
}

#[test]
fn the_result_to_report_is_a_test_in_new_episodes() {
    let summary = trained().json("trained/summary.json");
    let test = &summary["final_test"];
    let (seed, episodes) = (&test["seed"], &test["episodes"]);
    assert_eq!(*episodes, 500);
    let command =
        format!("--eval trained/policy.safetensors --rounds 1 --episodes {episodes} --seed {seed} --json");
    let again = trained().run_ok(&command).json();
    for key in ["success_rate", "success_interval", "collision_rate", "timeout_interval", "mean_time_s"] {
        assert_eq!(test[key], again[key], "{key}: {summary}");
    }
    // The evaluations during training have other episodes, so the best policy has another mean time in them.
    assert_ne!(test["mean_time_s"], summary["best_mean_time_s"], "{summary}");
    assert_eq!(summary["evaluations"], trained().rows("trained/evaluations.csv").len());
}

#[test]
fn training_prints_which_result_to_report() {
    let workspace = Workspace::new();
    workspace.write("fast.ron", quick_fast());
    let text = workspace.run_ok("--train --preset fast.ron --steps 64 --out run").stdout;
    let test = &workspace.json("run/summary.json")["final_test"];
    let line = text.lines().find(|line| line.starts_with("final test")).expect("a line");
    assert!(
        line.ends_with(&format!("20 new episodes (seed {}); report this number", test["seed"])),
        "{text}"
    );
    let at = workspace.json("run/summary.json")["best_env_steps"].clone();
    let rows = workspace.rows("run/evaluations.csv");
    assert!(rows.iter().any(|row| row["env_steps"].parse().ok() == at.as_u64()), "{at} in {rows:?}");
    let first = if at == 0 { ", before any training" } else { "" };
    assert!(
        text.contains(&format!("in the best of 2 evaluations (optimistic), at env step {at}{first}\n")),
        "{text}"
    );

    workspace.write("none.ron", quick_fast().replace("final_episodes: 20", "final_episodes: 0"));
    let done = workspace.run_ok("--train --preset none.ron --steps 64 --out none");
    assert!(done.stdout.contains("final test      none: the preset asks for none\n"), "{}", done.stdout);
    assert_eq!(workspace.json("none/summary.json")["final_test"], Value::Null);
}

#[test]
fn the_first_evaluation_is_that_of_the_initial_policy() {
    let workspace = trained();
    workspace.write("quick.ron", quick_fast().replace("episodes: 20, final", "episodes: 100, final"));
    for (run, init) in [("from-scratch", ""), ("from-trained", "--init trained/policy.safetensors")] {
        let preset = if init.is_empty() { "quick.ron" } else { "fast" };
        workspace.run_ok(&format!("--train --preset {preset} --seed 4 --steps 3200 {init} --out {run}"));
        let rows = workspace.rows(&format!("{run}/evaluations.csv"));
        assert_eq!((rows[0]["env_steps"].as_str(), rows[0]["gradient_steps"].as_str()), ("0", "0"), "{run}");
        let rate: f64 = rows[0]["success_rate"].parse().unwrap();
        assert_eq!(rate >= 0.9, !init.is_empty(), "{run}: the jump start is {rate}");
    }
    let rows = workspace.rows("from-trained/evaluations.csv");
    let row = rows.iter().find(|row| row["success_rate"].parse::<f64>().unwrap() >= 0.96);
    let expected = row.map(|row| row["env_steps"].parse::<u64>().unwrap());
    let first = &workspace.json("from-trained/summary.json")["first_96"];
    assert_eq!(first["env_steps"].as_u64(), expected, "{first}: {rows:?}");
}

#[test]
fn the_rates_of_an_evaluation_are_consistent() {
    let done = trained().run_ok(&format!("{EVAL} --seed 9 --json"));
    let report = done.json();
    assert_eq!(done.stdout.lines().count(), 1, "one line: {}", done.stdout);
    assert_eq!(done.stderr, "", "no notes or warnings");
    let rates = ["success_rate", "collision_rate", "timeout_rate"].map(|key| number(&report, key));
    assert!((rates.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{report}");
    let rounds = numbers(&report, "rounds");
    assert_eq!(rounds.len(), 4);
    assert!((rounds.iter().sum::<f64>() / 4.0 - rates[0]).abs() < 1e-9, "{report}");
    for rate in rounds {
        let successes = rate * 50.0;
        assert!((successes - successes.round()).abs() < 1e-9, "{rate} is not a multiple of 1/50");
    }
    assert_eq!((&report["episodes"], &report["seed"]), (&Value::from(200), &Value::from(9)));
    // Goals are at least 0.5 m away and have a radius of 0.2 m; at 0.15 m/s that takes at least 2 s.
    let time = number(&report, "mean_time_s");
    assert!((2.0..100.0).contains(&time), "{time}");
    for key in ["course_time_s", "course_times_s"] {
        assert!(report.get(key).is_none(), "no `{key}` without --course");
    }
}

#[test]
fn course_times_every_episode_on_the_benchmark_route() {
    let report = trained().run_ok(&format!("{EVAL} --course --json")).json();
    let times = numbers(&report, "course_times_s");
    assert_eq!(times.len(), 25, "all 5 rounds of 5 episodes reach the goal: {report}");
    let mean = times.iter().sum::<f64>() / 25.0;
    assert!((mean - number(&report, "course_time_s")).abs() < 1e-9, "{report}");
    // The optimal time is 10.8 s (docs/optimum.md). No time is below it, and a trained robot's is close to it.
    assert!(times.iter().all(|time| (10.8 - 1e-9..20.0).contains(time)), "{times:?}");
}

#[test]
fn the_papers_results_are_named_in_its_scenario_only() {
    let route = |scenario: &str| {
        let arguments = format!(
            "--eval trained/policy.safetensors --rounds 1 --episodes 2 --course --scenario {scenario}"
        );
        let done = trained().run_ok(&arguments);
        done.stdout.lines().find(|line| line.starts_with("benchmark route ")).expect("a line").to_owned()
    };
    assert!(route("scenario-1").ends_with("(the paper's PER-D3QN: 13.155 s)"), "{}", route("scenario-1"));
    assert!(route("empty").ends_with("] of 25 episodes"), "{}", route("empty"));

    let workspace = Workspace::new();
    workspace.write("fast.ron", quick_fast());
    for (scenario, names_paper) in [("scenario-1", true), ("empty", false)] {
        workspace
            .run_ok(&format!("--train --scenario {scenario} --preset fast.ron --steps 64 --out {scenario}"));
        let curve = workspace.text(&format!("{scenario}/learning-curve.svg"));
        assert_eq!(curve.contains("paper 96%"), names_paper, "{scenario}");
    }
}

#[test]
fn a_scenario_without_a_benchmark_route_needs_one_only_for_course() {
    let workspace = Workspace::new();
    // The pillar is where the paper's route starts.
    let office = "(name: \"Office\", obstacles: [(shape: Circle(radius_m: 0.3), position_m: (0.0, 0.0))])";
    workspace.write("office.ron", office);
    workspace.write("policy.safetensors", trained().read("trained/policy.safetensors"));
    assert_eq!(workspace.run_ok("--check office.ron").stderr, "");
    let eval = "--eval policy.safetensors --scenario office.ron --rounds 1 --episodes 2";
    workspace.run_ok(eval);
    let done = workspace.run(&format!("{eval} --course"));
    assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{}", done.stderr);
    let message = "error: Office has no benchmark route; help: write one into the scenario, such as \
                   `benchmark_route: (start_m: (0.0, 0.0), goal_m: (1.2, 1.2))`, or leave out --course";
    assert_eq!(done.stderr.trim_end(), message);
}

#[test]
fn text_and_json_agree() {
    let (text, report) = (
        trained().run_ok(&format!("{EVAL} --course --seed 9")),
        trained().run_ok(&format!("{EVAL} --course --seed 9 --json")).json(),
    );
    assert_eq!(text.stderr, "");
    let rate = |key: &str| {
        let interval = numbers(&report, &format!("{key}_interval"));
        let percent = |rate: f64| format!("{:.1}", 100.0 * rate);
        let rate = percent(number(&report, &format!("{key}_rate")));
        format!("{rate} % [{}, {}]", percent(interval[0]), percent(interval[1]))
    };
    for needle in [
        "trained/policy.safetensors in Scenario I, 200 episodes, seed 9".to_owned(),
        format!("success         {}  (rounds: ", rate("success")),
        format!("collision       {}", rate("collision")),
        format!("timeout         {}", rate("timeout")),
        format!("SPL             {:.3}", number(&report, "spl")),
        format!("mean time       {:.3} s", number(&report, "mean_time_s")),
        format!("benchmark route {:.3} s", number(&report, "course_time_s")),
    ] {
        assert!(text.stdout.contains(&needle), "`{needle}` is not in\n{}", text.stdout);
    }
}

#[test]
fn an_evaluation_depends_only_on_its_seed() {
    let evaluate = |more: &str| trained().run_ok(&format!("{EVAL} --json {more}")).stdout;
    let first = evaluate("--seed 5");
    assert_eq!(first, evaluate("--seed 5"));
    assert_ne!(first, evaluate("--seed 6"));
    assert_eq!(evaluate(""), evaluate("--seed 0"), "0 is the default");

    // The number of parallel episodes changes nothing: two rounds equal the first two of four.
    let four: Value = serde_json::from_str(&first).unwrap();
    let two = trained().run_ok("--eval trained/policy.safetensors --rounds 2 --episodes 50 --seed 5 --json");
    assert_eq!(numbers(&two.json(), "rounds"), numbers(&four, "rounds")[..2]);
}

#[test]
fn the_scenario_changes_the_result() {
    let report = |scenario: &str| trained().run_ok(&format!("{EVAL} --json --scenario {scenario}")).json();
    let (one, two, empty) = (report("scenario-1"), report("scenario-2"), report("empty"));
    assert_eq!(
        (&one["scenario"], &two["scenario"]),
        (&Value::from("Scenario I"), &Value::from("Scenario II"))
    );
    let success = |report| number(report, "success_rate");
    assert!(success(&two) < success(&one), "moving obstacles are harder: {two}");
    assert!(success(&empty) > 0.5, "a robot that can avoid obstacles also succeeds without them: {empty}");
}

#[test]
fn with_actuator_lag_no_optimal_time_is_reported() {
    let workspace = trained();
    workspace.write(
        "lag.ron",
        edited(SCENARIO_1, &[("    obstacles: [", "    robot: (actuator_lag_s: 0.3),\n    obstacles: [")]),
    );
    let what = "--eval trained/policy.safetensors --rounds 1 --episodes 20 --optimum --json";
    let (with_lag, without_lag) =
        (workspace.run_ok(&format!("{what} --scenario lag.ron")), workspace.run_ok(what));
    assert_eq!(without_lag.stderr, "");
    assert!(number(&without_lag.json(), "time_ratio") >= 1.0, "{}", without_lag.stdout);
    let report = with_lag.json();
    assert_eq!(report["optimum_episodes"], 0, "{report}");
    assert_eq!(
        (&report["optimum_mean_time_s"], &report["time_ratio"]),
        (&Value::Null, &Value::Null),
        "{report}"
    );
    let note = with_lag.stderr.lines().last().unwrap();
    for needle in ["note: ", "actuator lag", "Scenario I", "actuator_lag_s is 0.3"] {
        assert!(note.contains(needle), "`{needle}` is not in {}", with_lag.stderr);
    }
    assert_eq!(with_lag.stderr.matches("no optimal times").count(), 1, "{}", with_lag.stderr);
    let text = workspace.run_ok(&format!("{} --scenario lag.ron", what.replace(" --json", ""))).stdout;
    assert!(
        text.contains("success") && !text.contains("optimal time"),
        "no line for the optimal time: {text}"
    );
}

#[test]
fn a_policy_trained_on_raw_observations_is_evaluated_on_raw_observations() {
    let workspace = Workspace::new();
    workspace.write("raw.ron", raw(FAST));
    workspace.run_ok("--train --preset raw.ron --steps 40000 --seed 1 --out run");
    // Evaluations during training also use raw observations: with scaled ones the rate would stay low.
    let evaluations = workspace.rows("run/evaluations.csv");
    let last: f64 = evaluations.last().unwrap()["success_rate"].parse().unwrap();
    assert!(last >= 0.9, "{last}");
    let success = |name: &str| {
        number(
            &workspace.run_ok(&format!("--eval {name} --rounds 2 --seed 77 --json")).json(),
            "success_rate",
        )
    };
    let rate = success("run/policy.safetensors");
    assert!(rate >= 0.9, "{rate}");

    let mut policy = Policy::from_bytes(&workspace.read("run/policy.safetensors")).unwrap();
    let divisors = |policy: &Policy| -> Vec<f32> {
        policy.card.as_ref().unwrap().inputs[23..].iter().map(|input| input.divisor).collect()
    };
    assert_eq!(divisors(&policy), [1.0; 5]);
    let scaled = Policy::from_bytes(&trained().read("trained/policy.safetensors")).unwrap();
    assert_eq!(divisors(&scaled), [3.5, std::f32::consts::PI, 4.0, 3.5, 24.0]);

    // The same weights in files without a card: the metadata name another encoding, or none, which means scaled.
    policy.card = None;
    policy.metadata.insert("encoding".into(), "scaled".into());
    workspace.write("relabelled.safetensors", policy.to_bytes().unwrap());
    policy.metadata.remove("encoding");
    workspace.write("old.safetensors", policy.to_bytes().unwrap());
    let (relabelled, old) = (success("relabelled.safetensors"), success("old.safetensors"));
    assert!(
        relabelled < 0.5 && relabelled == old,
        "{relabelled}, {old}: the file sets the encoding, and scaled is the default"
    );
}

/// The weights in a safetensors file: the bytes after the header.
fn weights(policy: &[u8]) -> &[u8] {
    let header = u64::from_le_bytes(policy[..8].try_into().unwrap());
    &policy[8 + header as usize..]
}

#[test]
fn transfer_starts_with_the_weights_of_the_policy_and_the_given_epsilon() {
    let workspace = trained();
    // Evaluated every 160 env steps. Learning starts later, so 320 env steps show the initial policy.
    let often =
        edited(FAST, &[("every_env_steps: 5000, episodes: 200", "every_env_steps: 160, episodes: 100")]);
    workspace.write("often.ron", often);
    let what = "--train --preset often.ron --seed 2";
    workspace.run_ok(&format!("{what} --steps 320 --out scratch"));
    workspace.run_ok(&format!(
        "{what} --steps 320 --init trained/policy.safetensors --epsilon 0.5 --out transferred"
    ));

    let (trained, transferred) =
        (workspace.read("trained/policy.safetensors"), workspace.read("transferred/policy-last.safetensors"));
    assert!(
        weights(&trained) == weights(&transferred),
        "before learning starts, the weights are the policy's"
    );
    assert!(weights(&trained) != weights(&workspace.read("scratch/policy-last.safetensors")));
    let first_success = |run: &str| -> f64 {
        workspace.rows(&format!("{run}/evaluations.csv"))[0]["success_rate"].parse().unwrap()
    };
    assert!(first_success("transferred") >= 0.9, "{}", first_success("transferred"));
    assert!(first_success("scratch") < 0.5, "{}", first_success("scratch"));

    // config.ron records the transfer, and a resumed run keeps it.
    let config = workspace.text("transferred/config.ron");
    assert!(config.contains("policy: \"trained/policy.safetensors\""), "{config}");
    assert!(config.contains("epsilon: 0.5"), "{config}");
    assert!(!workspace.text("scratch/config.ron").contains("epsilon: 0.5"));
    workspace.run_ok("--train --resume transferred --steps 4000");
    workspace.run_ok("--train --resume scratch --steps 4000");
    // Epsilon falls linearly to 0.02 over 15,000 env steps, from different initial values.
    for (run, start) in [("transferred", 0.5), ("scratch", 1.0)] {
        let rows = workspace.rows(&format!("{run}/episodes.csv"));
        assert!(!rows.is_empty());
        for row in rows {
            let (epsilon, env_steps): (f64, f64) =
                (row["epsilon"].parse().unwrap(), row["env_steps"].parse().unwrap());
            let expected = start + (0.02 - start) * env_steps / 15_000.0;
            assert!((epsilon - expected).abs() < 1e-4, "{run}: {epsilon} at {env_steps}, not {expected}");
        }
    }
}

#[test]
fn a_run_with_transfer_resumes_bit_identically() {
    let workspace = trained();
    let what = "--train --scenario scenario-2 --seed 2 --init trained/policy.safetensors --epsilon 0.5";
    workspace.run_ok(&format!("{what} --steps 4000 --out straight"));
    workspace.run_ok(&format!("{what} --steps 2000 --out halves"));
    workspace.run_ok("--train --resume halves --steps 4000");
    workspace.assert_same_run("straight", "halves");
}

#[cfg(target_os = "linux")]
#[test]
fn a_closed_or_full_stdout_causes_no_panic() {
    let workspace = Workspace::new();
    workspace.write("fast.ron", quick_fast());
    workspace.run_ok("--train --preset fast.ron --steps 64 --out run");
    let eval = |stdout: std::process::Stdio| {
        std::process::Command::new(env!("CARGO_BIN_EXE_wayfield"))
            .args(["--eval", "run/policy.safetensors", "--rounds", "1", "--episodes", "2"])
            .current_dir(workspace.path(""))
            .stdout(stdout)
            .output()
            .unwrap()
    };
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let closed = eval(writer.into());
    assert_eq!(closed.status.code(), Some(0), "a closed stdout is not an error");
    let full = eval(std::fs::File::options().write(true).open("/dev/full").unwrap().into());
    let stderr = String::from_utf8_lossy(&full.stderr).into_owned();
    assert_eq!(full.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("stdout") && !stderr.contains("panicked"), "{stderr}");
}

#[test]
fn the_printed_eval_command_tests_the_policy_in_the_scenario_of_the_run() {
    let workspace = Workspace::new();
    workspace.write("fast.ron", quick_fast());
    let done = workspace.run_ok("--train --scenario scenario-2 --preset fast.ron --steps 64 --out run");
    assert!(done.stdout.contains("--eval run/policy.safetensors\n"), "{}", done.stdout);
    assert!(done.stderr.contains("so nothing will be learned"), "{}", done.stderr);
    let own = workspace.run_ok("--eval run/policy.safetensors --rounds 1 --episodes 2");
    assert!(own.stdout.starts_with("run/policy.safetensors in Scenario II, 2 episodes"), "{}", own.stdout);
    let elsewhere =
        workspace.run("--eval run/policy.safetensors --rounds 1 --episodes 2 --scenario scenario-1");
    assert!(elsewhere.stderr.contains("trained in Scenario II"), "{}", elsewhere.stderr);
}

#[test]
fn classical_drivers_are_tested_in_the_same_episodes_as_a_policy() {
    let workspace = Workspace::new();
    let command = "--eval field dwa dwa-cv grid-dwa astar-dwa astar orca scenario-1 --rounds 1 --episodes 10";
    let report = workspace.run_ok(&format!("{command} --scenario empty --csv episodes.csv --json")).json();
    let results = report["policies"].as_array().expect("a list");
    let classes: Vec<_> = results.iter().map(|result| result["class"].as_str().unwrap()).collect();
    assert_eq!(classes, ["A", "A", "A", "B", "C", "C", "C", "A"], "{report}");
    for result in results {
        assert_eq!(
            result["success_rate"], 1.0,
            "every driver reaches every goal in the empty scenario: {result}"
        );
        assert_eq!(result["physics"], "kinematic, rapier contact");
    }
    let mut reader = csv::Reader::from_path(workspace.path("episodes.csv")).expect("written");
    let rows: Vec<BTreeMap<String, String>> = reader.deserialize().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 8 * 10, "one row per driver and episode");
    for (index, row) in rows.iter().enumerate() {
        let same = &rows[index % 10];
        for column in ["start_x_m", "start_heading_rad", "goal_x_m", "clock_steps"] {
            assert_eq!(row[column], same[column], "episode {} of {}", row["episode"], row["policy"]);
        }
    }
    let table = workspace.run_ok(&format!("{command} --scenario empty")).stdout;
    assert!(table.contains("\ngrid-dwa    B      100.0 %"), "{table}");
    let alone = workspace.run_ok("--eval orca --rounds 1 --episodes 3").stdout;
    assert!(alone.starts_with("orca in Scenario I, 3 episodes"), "{alone}");
    assert!(alone.contains("\nclass           C (kinematic, rapier contact)\n"), "{alone}");
}

#[test]
fn a_trace_does_not_change_the_results_of_a_driver() {
    let workspace = Workspace::new();
    for (driver, q_values) in [("dwa-cv", None), ("grid-dwa", None), ("scenario-2+map", Some(5))] {
        let command = format!("--eval {driver} --scenario scenario-2 --rounds 1 --episodes 4 --json");
        let together = workspace.run_ok(&command).json();
        let alone = workspace.run_ok(&format!("{command} --trace steps.jsonl")).json();
        assert_eq!(together, alone, "{driver}: parallel episodes and single ones are equal");
        let line: Value =
            serde_json::from_str(workspace.text("steps.jsonl").lines().next().unwrap()).unwrap();
        assert_eq!(
            (line["q_values"].as_array().map(Vec::len), line["policy"].as_str()),
            (q_values, Some(driver))
        );
        assert!(line["action"].is_u64() && line["ranges_m"].is_array(), "{line}");
    }
}

#[test]
fn a_driver_file_sets_parameters_and_a_file_takes_precedence_over_a_name() {
    let workspace = Workspace::new();
    workspace.write("weak.ron", "Field(repulsion: 0.0)");
    let run = "--scenario scenario-1 --rounds 1 --episodes 20 --json";
    let weak = workspace.run_ok(&format!("--eval weak.ron {run}")).json();
    let field = workspace.run_ok(&format!("--eval field {run}")).json();
    assert!(number(&weak, "collision_rate") > number(&field, "collision_rate"), "{weak} {field}");
    for (file, text, message) in [
        ("a.ron", "Field(repulsion: -1.0)", "a.ron:1:18: `repulsion` is -1; help: give 0 to 1000"),
        ("b.ron", "Dwa(horizon: 1.0)", "b.ron:1:"),
        ("c.ron", "Bug2()", "c.ron:1:"),
    ] {
        workspace.write(file, text);
        let done = workspace.run(&format!("--eval {file}"));
        assert!(done.stderr.contains(message), "{file}: {}", done.stderr);
        assert_eq!(done.status, Some(2), "{file}");
    }
    workspace.write("dwa", "not a policy");
    let done = workspace.run("--eval dwa");
    assert!(done.stderr.contains("dwa: "), "the file is read, not the driver: {}", done.stderr);
    assert_eq!(done.status, Some(2));
}
