//! What a user gets for a trained policy: that it was learnt, how it is tested, and that it can be passed on.

mod cli_support;

use std::sync::OnceLock;

use cli_support::{FAST, SCENARIO_1, Workspace, edited, quick_fast, raw};
use serde_json::Value;
use wayfield::policy::Policy;

/// A desk on which the default preset has trained for 30,000 env steps with seed 1, once for all tests:
/// `taught/policy.safetensors`.
fn taught() -> &'static Workspace {
    static DESK: OnceLock<Workspace> = OnceLock::new();
    DESK.get_or_init(|| {
        let workspace = Workspace::new();
        workspace.run_ok("--train --steps 30000 --seed 1 --out taught");
        workspace
    })
}

const EVAL: &str = "--eval taught/policy.safetensors --rounds 4 --episodes 50";

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("`{key}` is no number in {value}"))
}

fn numbers(value: &Value, key: &str) -> Vec<f64> {
    let list = value[key].as_array().unwrap_or_else(|| panic!("`{key}` is no list in {value}"));
    list.iter().map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn the_default_preset_learns_to_navigate_in_30_000_steps() {
    // 300 episodes that neither training nor its evaluations have seen.
    let report = taught().run_ok("--eval taught/policy.safetensors --rounds 3 --seed 77 --json").json();
    assert!(number(&report, "success_rate") >= 0.9, "{report}");
    let summary = taught().json("taught/summary.json");
    assert!(number(&summary, "best_success_rate") >= 0.95, "{summary}");
    assert!(number(&summary["first_96"], "env_steps") <= 30_000.0, "{summary}");
}

#[test]
fn a_policy_that_has_learnt_nothing_does_not_pass_for_one_that_has() {
    let workspace = Workspace::new();
    workspace.run_ok("--train --steps 1 --seed 1 --out untaught");
    let report = workspace.run_ok("--eval untaught/policy.safetensors --rounds 3 --seed 77 --json").json();
    assert!(number(&report, "success_rate") < 0.5, "{report}");
    assert_eq!(workspace.json("untaught/summary.json")["first_96"], Value::Null);
}

#[test]
fn an_evaluation_adds_up() {
    let done = taught().run_ok(&format!("{EVAL} --seed 9 --json"));
    let report = done.json();
    assert_eq!(done.stdout.lines().count(), 1, "one line: {}", done.stdout);
    assert_eq!(done.stderr, "", "nothing to say beside the result");
    let rates = ["success_rate", "collision_rate", "timeout_rate"].map(|key| number(&report, key));
    assert!((rates.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{report}");
    let rounds = numbers(&report, "rounds");
    assert_eq!(rounds.len(), 4);
    assert!((rounds.iter().sum::<f64>() / 4.0 - rates[0]).abs() < 1e-9, "{report}");
    for rate in rounds {
        let hits = rate * 50.0;
        assert!((hits - hits.round()).abs() < 1e-9, "{rate} is no share of 50");
    }
    assert_eq!((&report["episodes"], &report["seed"]), (&Value::from(200), &Value::from(9)));
    // Targets are at least 0.5 m away, of which 0.2 m are spared, at 0.15 m/s: 2 s is the least there can be.
    let time = number(&report, "mean_time_s");
    assert!((2.0..100.0).contains(&time), "{time}");
    for key in ["course_time_s", "course_times_s"] {
        assert!(report.get(key).is_none(), "no `{key}` without --course");
    }
}

#[test]
fn the_course_is_timed() {
    let report = taught().run_ok(&format!("{EVAL} --course --json")).json();
    let times = numbers(&report, "course_times_s");
    assert_eq!(times.len(), 25, "5 rounds of 5, all of them reached: {report}");
    let mean = times.iter().sum::<f64>() / 25.0;
    assert!((mean - number(&report, "course_time_s")).abs() < 1e-9, "{report}");
    // 10.8 s is the least possible (field notes); nothing can be quicker, and a taught robot is not much slower.
    assert!(times.iter().all(|time| (10.8 - 1e-9..20.0).contains(time)), "{times:?}");
}

#[test]
fn the_text_says_the_same_as_the_json() {
    let (text, report) = (
        taught().run_ok(&format!("{EVAL} --course --seed 9")),
        taught().run_ok(&format!("{EVAL} --course --seed 9 --json")).json(),
    );
    assert_eq!(text.stderr, "");
    for needle in [
        "taught/policy.safetensors in Scenario I, 200 episodes, seed 9".to_owned(),
        format!("{:.1} %  (rounds: ", 100.0 * number(&report, "success_rate")),
        format!("collision       {:.1} %", 100.0 * number(&report, "collision_rate")),
        format!("timeout         {:.1} %", 100.0 * number(&report, "timeout_rate")),
        format!("mean time       {:.3} s", number(&report, "mean_time_s")),
        format!("benchmark route {:.3} s", number(&report, "course_time_s")),
    ] {
        assert!(text.stdout.contains(&needle), "`{needle}` is not in\n{}", text.stdout);
    }
}

#[test]
fn an_evaluation_depends_on_its_seed_alone() {
    let evaluate = |more: &str| taught().run_ok(&format!("{EVAL} --json {more}")).stdout;
    let first = evaluate("--seed 5");
    assert_eq!(first, evaluate("--seed 5"));
    assert_ne!(first, evaluate("--seed 6"));
    assert_eq!(evaluate(""), evaluate("--seed 0"), "0 is the default");

    // The number of episodes driven side by side changes none of them: two rounds are the first two of four.
    let two: Value = serde_json::from_str(&evaluate("--seed 5")).unwrap();
    let short = taught().run_ok("--eval taught/policy.safetensors --rounds 2 --episodes 50 --seed 5 --json");
    assert_eq!(numbers(&short.json(), "rounds"), numbers(&two, "rounds")[..2]);
}

#[test]
fn another_scenario_is_another_world() {
    let report = |scenario: &str| taught().run_ok(&format!("{EVAL} --json --scenario {scenario}")).json();
    let (one, two, empty) = (report("scenario-1"), report("scenario-2"), report("empty"));
    assert_eq!(
        (&one["scenario"], &two["scenario"]),
        (&Value::from("Scenario I"), &Value::from("Scenario II"))
    );
    let success = |report| number(report, "success_rate");
    assert!(success(&two) < success(&one), "moving obstacles are harder: {two}");
    assert!(success(&empty) > 0.5, "a robot that can go round obstacles can do without: {empty}");
}

#[test]
fn in_a_world_whose_drive_lags_no_least_time_is_claimed() {
    let workspace = taught();
    workspace.write(
        "lag.ron",
        edited(SCENARIO_1, &[("    obstacles: [", "    robot: (actuator_lag_s: 0.3),\n    obstacles: [")]),
    );
    let what = "--eval taught/policy.safetensors --rounds 1 --episodes 20 --optimum --json";
    let (lagging, prompt) = (workspace.run_ok(&format!("{what} --scenario lag.ron")), workspace.run_ok(what));
    assert_eq!(prompt.stderr, "");
    assert!(number(&prompt.json(), "time_ratio") >= 1.0, "{}", prompt.stdout);
    let report = lagging.json();
    assert_eq!(report["optimum_episodes"], 0, "{report}");
    assert_eq!(
        (&report["optimum_mean_time_s"], &report["time_ratio"]),
        (&Value::Null, &Value::Null),
        "{report}"
    );
    for needle in ["note: ", "actuator lag", "Scenario I", "actuator_lag_s is 0.3"] {
        assert!(lagging.stderr.contains(needle), "`{needle}` is not in {}", lagging.stderr);
    }
    assert_eq!(lagging.stderr.lines().count(), 1, "{}", lagging.stderr);
}

#[test]
fn a_raw_policy_is_shown_raw_observations_and_nothing_else() {
    let workspace = Workspace::new();
    workspace.write("raw.ron", raw(FAST));
    workspace.run_ok("--train --preset raw.ron --steps 40000 --seed 1 --out run");
    // During training: where scaled numbers are shown to it, it does not get there.
    let evaluations = workspace.rows("run/evaluations.csv");
    let last: f64 = evaluations.last().unwrap()["success_rate"].parse().unwrap();
    assert!(last >= 0.9, "{last}");
    let success = |name: &str| {
        number(
            &workspace.run_ok(&format!("--eval {name} --rounds 2 --seed 77 --json")).json(),
            "success_rate",
        )
    };
    let own = success("run/policy.safetensors");
    assert!(own >= 0.9, "{own}");

    let mut policy = Policy::from_bytes(&workspace.read("run/policy.safetensors")).unwrap();
    assert_eq!(policy.metadata["encoding"], "raw");
    let told = policy.metadata["observation"].clone();
    assert!(told.starts_with("24 LIDAR ranges in m (") && !told.contains('/'), "{told}");
    let scaled = Policy::from_bytes(&taught().read("taught/policy.safetensors")).unwrap();
    assert_eq!(scaled.metadata["encoding"], "scaled");
    let told = &scaled.metadata["observation"];
    assert!(told.starts_with("24 LIDAR ranges / 3.5 m (") && told.contains("/ pi rad"), "{told}");

    // The same weights under another card, or none, as before there were two encodings: scaled.
    policy.metadata.insert("encoding".into(), "scaled".into());
    workspace.write("misled.safetensors", policy.to_bytes().unwrap());
    policy.metadata.remove("encoding");
    workspace.write("old.safetensors", policy.to_bytes().unwrap());
    let (misled, old) = (success("misled.safetensors"), success("old.safetensors"));
    assert!(misled < 0.5 && misled == old, "{misled}, {old}: the card decides, and scaled is the default");
}

/// The bytes behind a safetensors file's header: the weights.
fn weights(policy: &[u8]) -> &[u8] {
    let header = u64::from_le_bytes(policy[..8].try_into().unwrap());
    &policy[8 + header as usize..]
}

#[test]
fn transfer_starts_with_the_policys_weights_and_the_epsilon_asked_for() {
    let workspace = taught();
    // Evaluated every 160 env steps; training begins after 1000, so 320 show where it starts from.
    let often =
        edited(FAST, &[("every_env_steps: 5000, episodes: 200", "every_env_steps: 160, episodes: 100")]);
    workspace.write("often.ron", often);
    let what = "--train --preset often.ron --seed 2";
    workspace.run_ok(&format!("{what} --steps 320 --out scratch"));
    workspace.run_ok(&format!(
        "{what} --steps 320 --init taught/policy.safetensors --epsilon 0.5 --out transferred"
    ));

    let (taught, passed_on) =
        (workspace.read("taught/policy.safetensors"), workspace.read("transferred/policy-last.safetensors"));
    assert!(weights(&taught) == weights(&passed_on), "before any training the weights are the policy's own");
    assert!(weights(&taught) != weights(&workspace.read("scratch/policy-last.safetensors")));
    let first_success = |run: &str| -> f64 {
        workspace.rows(&format!("{run}/evaluations.csv"))[0]["success_rate"].parse().unwrap()
    };
    assert!(first_success("transferred") >= 0.9, "{}", first_success("transferred"));
    assert!(first_success("scratch") < 0.5, "{}", first_success("scratch"));

    // config.ron says so, and a resumed run remembers.
    let config = workspace.text("transferred/config.ron");
    assert!(config.contains("policy: \"taught/policy.safetensors\""), "{config}");
    assert!(config.contains("epsilon: 0.5"), "{config}");
    assert!(!workspace.text("scratch/config.ron").contains("epsilon: 0.5"));
    workspace.run_ok("--train --resume transferred --steps 4000");
    workspace.run_ok("--train --resume scratch --steps 4000");
    // The preset's line from its start to 0.02 over 15,000 env steps, from another start.
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
fn a_transferred_run_resumes_to_the_bit() {
    let workspace = taught();
    let what = "--train --scenario scenario-2 --seed 2 --init taught/policy.safetensors --epsilon 0.5";
    workspace.run_ok(&format!("{what} --steps 4000 --out onward"));
    workspace.run_ok(&format!("{what} --steps 2000 --out onward-halves"));
    workspace.run_ok("--train --resume onward-halves --steps 4000");
    workspace.assert_same_run("onward", "onward-halves");
}

#[cfg(target_os = "linux")]
#[test]
fn results_that_nobody_can_take_are_no_panic() {
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
    assert_eq!(closed.status.code(), Some(0), "whoever closes stdout has seen enough");
    let full = eval(std::fs::File::options().write(true).open("/dev/full").unwrap().into());
    let told = String::from_utf8_lossy(&full.stderr).into_owned();
    assert_eq!(full.status.code(), Some(1), "{told}");
    assert!(told.contains("stdout") && !told.contains("panicked"), "{told}");
}

#[test]
fn the_printed_next_step_tests_in_the_world_of_the_run() {
    let workspace = Workspace::new();
    workspace.write("fast.ron", quick_fast());
    let done = workspace.run_ok("--train --scenario scenario-2 --preset fast.ron --steps 64 --out run");
    assert!(done.stdout.contains("--eval run/policy.safetensors --scenario scenario-2"), "{}", done.stdout);
    assert!(done.stderr.contains("warning: nothing will be learned"), "{}", done.stderr);
    let elsewhere = workspace.run("--eval run/policy.safetensors --rounds 1 --episodes 2");
    assert!(elsewhere.stderr.contains("trained in Scenario II"), "{}", elsewhere.stderr);
}
