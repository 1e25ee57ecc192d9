//! Tests of `--eval` in suites, sets and folders of scenarios: results by family, the same on any number of cores, and clear
//! errors.

mod cli_support;

use std::collections::BTreeMap;

use bevy::prelude::{App, Plugin};
use cli_support::{SCENARIO_1, SCENARIO_2, Workspace, noisy, with_short_episodes};
use serde_json::Value;
use wayfield::drivers::{DriverConfig, FieldParameters};
use wayfield::run::evaluate::Evaluated;
use wayfield::run::settings::Settings;
use wayfield::run::suite::{Suite, SuiteDriver, SuiteTest, TestStore};
use wayfield::simulation::Extensions;

const GENERATOR: &str = r#"(
    name: "Clutter",
    clutter: [Scatter(count: (2, 6), shapes: [Circle(radius_m: (0.1, 0.2))])],
    task: (max_episode_steps: 60),
)"#;

/// Two BARN worlds without obstacles in the way. The path length that the second states is less than the distance to the goal.
const BARN: &str = r#"{"radius_m": 0.075, "start_m": [-2.25, 3.0], "heading_rad": 1.57, "goal_m": [-2.25, 13.0],
    "goal_radius_m": 1.0, "time_limit_s": 100, "worlds": [
    {"world": 0, "circles_m": [[-0.075, 0.075], [-4.5, 8.0]], "metric_path_length_m": 12.5},
    {"world": 1, "circles_m": [[-0.075, 0.075], [-4.5, 8.0]], "metric_path_length_m": 3.0}]}"#;

const SUITE: &str = r#"(
    name: "Four families",
    families: [
        (name: "still", scenarios: ["one.ron", "maze"], episodes: 4, time_limit_s: 12.0),
        (name: "moving", scenarios: ["two.ron"], episodes: 6),
        (name: "levels", generator: "clutter.ron", levels: 12),
        (name: "BARN", scenarios: ["barn"], episodes: 1, score: Barn),
    ],
)"#;

fn workspace() -> Workspace {
    let workspace = Workspace::new();
    workspace.write("one.ron", with_short_episodes(SCENARIO_1));
    workspace.write("two.ron", noisy(SCENARIO_2));
    workspace.write("clutter.ron", GENERATOR);
    workspace.write("barn.json", BARN);
    workspace.run_ok("--import barn.json --out barn");
    workspace.write("suite.ron", SUITE);
    workspace
}

/// The rows of `episodes.csv`.
fn rows(workspace: &Workspace) -> Vec<BTreeMap<String, String>> {
    csv::Reader::from_path(workspace.path("episodes.csv"))
        .unwrap()
        .deserialize()
        .map(Result::unwrap)
        .collect()
}

fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("`{column}` is not a number in {row:?}"))
}

#[test]
fn the_results_of_a_family_are_those_of_its_episodes() {
    let workspace = workspace();
    let report = workspace.run_ok("--eval dwa --suite suite.ron --csv episodes.csv --json").json();
    assert_eq!(
        (&report["policy"], &report["class"], &report["suite"]),
        (&"dwa".into(), &"A".into(), &"Four families".into())
    );
    let rows = rows(&workspace);
    assert_eq!(rows.len(), 2 * 4 + 6 + 12 + 2);
    assert_eq!(report["episodes"], rows.len());
    for (family, scenarios) in [("still", 2), ("moving", 1), ("levels", 12), ("BARN", 2)] {
        let result = &report["families"][family];
        let episodes: Vec<_> = rows.iter().filter(|row| row["family"] == family).collect();
        let share = |outcome: &str| {
            episodes.iter().filter(|row| row["outcome"] == outcome).count() as f64 / episodes.len() as f64
        };
        assert_eq!(result["scenarios"], scenarios, "{result}");
        assert_eq!(result["episodes"], episodes.len());
        for (rate, outcome) in [("success", "success"), ("collision", "collision"), ("timeout", "timeout")] {
            assert_eq!(result[format!("{rate}_rate")], share(outcome), "{family}: {rate}");
        }
        let mut by_scenario = BTreeMap::<&str, Vec<bool>>::new();
        for row in &episodes {
            by_scenario.entry(&row["scenario"]).or_default().push(row["outcome"] == "success");
        }
        assert_eq!(by_scenario.len(), scenarios);
        let mut rates: Vec<f64> = by_scenario
            .values()
            .map(|successes| {
                successes.iter().filter(|success| **success).count() as f64 / successes.len() as f64
            })
            .collect();
        rates.sort_by(f64::total_cmp);
        let worst = &rates[..scenarios.div_ceil(10)];
        let mean = worst.iter().sum::<f64>() / worst.len() as f64;
        assert!((result["worst_tenth"].as_f64().unwrap() - mean).abs() < 1e-6, "{family}: {result}");
        let spl = episodes.iter().map(|row| number(row, "spl")).sum::<f64>() / episodes.len() as f64;
        assert!((result["spl"].as_f64().unwrap() - spl).abs() < 2e-6, "{family}: {result}");
        assert_eq!(result["barn_score"] == Value::Null, family != "BARN");
    }
    let still_s = rows.iter().filter(|row| row["family"] == "still").map(|row| number(row, "time_s"));
    assert!(still_s.fold(0.0, f64::max) <= 12.0, "the family's time limit holds");
    assert!(rows.iter().any(|row| row["scenario"] == "clutter.ron:1000011"), "the last level");
}

#[test]
fn barns_score_compares_the_time_with_that_of_the_stated_path_at_top_speed() {
    let workspace = workspace();
    let report = workspace.run_ok("--eval astar --suite barn --episodes 1 --csv episodes.csv --json").json();
    assert_eq!(report["families"]["barn"]["success_rate"], 1.0, "nothing is in the way: {report}");
    workspace.write(
        "barn.ron",
        "(name: \"B\", families: [(name: \"b\", scenarios: [\"barn\"], episodes: 1, score: Barn)])",
    );
    let report = workspace.run_ok("--eval astar --suite barn.ron --json").json();
    let rows = rows(&workspace);
    // At 2 m/s: 6.25 s and 1.5 s.
    let scores = rows
        .iter()
        .zip([6.25, 1.5])
        .map(|(row, optimal_s)| optimal_s / number(row, "time_s").clamp(2.0 * optimal_s, 8.0 * optimal_s));
    let mean = scores.sum::<f64>() / 2.0;
    assert!(
        (report["families"]["b"]["barn_score"].as_f64().unwrap() - mean).abs() < 1e-6,
        "{report}, not {mean}"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn the_number_of_cores_does_not_change_the_results_of_a_suite() {
    let workspace = workspace();
    let eval = "--eval dwa scenario-2 --suite set.ron --json --csv";
    let set = r#"(name: "Set", scenarios: [(scenario: "one.ron"), (scenario: "two.ron"), (generator: "clutter.ron")])"#;
    workspace.write("set.ron", set);
    let all = workspace.run_ok(&format!("{eval} all.csv --episodes 3"));
    workspace.run_on_one_core(&format!("{eval} one.csv --episodes 3"));
    assert_eq!(workspace.text("all.csv"), workspace.text("one.csv"));
    let policies = all.json();
    let names: Vec<&str> =
        policies["policies"].as_array().unwrap().iter().map(|of| of["policy"].as_str().unwrap()).collect();
    assert_eq!(names, ["dwa", "scenario-2"]);
}

#[test]
fn a_set_is_a_suite_and_its_episodes_are_those_of_each_scenario() {
    let workspace = workspace();
    workspace.write(
        "set.ron",
        r#"(name: "Set", scenarios: [(scenario: "one.ron"), (name: "moving", scenario: "two.ron")])"#,
    );
    let of_set = workspace.run_ok("--eval field --scenario set.ron --episodes 20 --seed 3 --json").json();
    let again = workspace.run_ok("--eval field --suite set.ron --episodes 20 --seed 3 --json").json();
    assert_eq!(of_set, again);
    for (family, file) in [("one", "one.ron"), ("moving", "two.ron")] {
        let alone = workspace
            .run_ok(&format!("--eval field --scenario {file} --rounds 1 --episodes 20 --seed 3 --json"))
            .json();
        for key in ["success_rate", "success_interval", "collision_rate", "timeout_rate", "mean_time_s"] {
            assert_eq!(of_set["families"][family][key], alone[key], "{family}: {key}");
        }
    }
    let table = workspace.run_ok("--eval field dwa --scenario set.ron --episodes 2").stdout;
    for row in ["\none     field   A ", "\none     dwa     A ", "\nmoving  field   A "] {
        assert!(table.contains(row), "{table}");
    }
    workspace.run_ok("--draw sheet.svg --scenario set.ron");
    let sheet = workspace.text("sheet.svg");
    assert!(["Set", "one", "moving"].iter().all(|name| sheet.contains(&format!("\n{name}\n"))), "{sheet}");
}

#[test]
fn the_optimum_and_the_benchmark_route_can_be_part_of_a_suite() {
    let workspace = workspace();
    workspace.write(
        "route.ron",
        r#"(name: "R", families: [(name: "route", scenarios: ["scenario-1"], episodes: 2, benchmark_route: true)])"#,
    );
    let report = workspace
        .run_ok("--eval scenario-1 --suite route.ron --optimum --csv episodes.csv --report report --json")
        .json();
    let route = &report["families"]["route"];
    assert_eq!(route["optimum_episodes"], 2, "{report}");
    assert!((1.0..1.3).contains(&route["time_ratio"].as_f64().unwrap()), "{report}");
    for row in rows(&workspace) {
        assert_eq!(
            (number(&row, "goal_x_m"), number(&row, "start_x_m")),
            (1.2, 0.0),
            "the paper's route: {row:?}"
        );
    }
}

#[test]
fn check_knows_suites_and_drivers() {
    let workspace = workspace();
    workspace.write("dwa.ron", "// Faster.\nDwa(speed: 2.0)");
    let checked = workspace.run_ok("--check suite.ron dwa.ron").stdout;
    assert_eq!(checked, "suite.ron: ok (suite)\ndwa.ron: ok (driver)\n");
    workspace.write("bad.ron", "Dwa(speed: -2.0)");
    let done = workspace.run("--check bad.ron");
    assert_eq!(done.status, Some(2));
    assert!(done.stderr.starts_with("bad.ron:1:"), "{}", done.stderr);
    assert!(done.stderr.contains("in this driver"), "{}", done.stderr);
}

#[test]
fn an_invalid_suite_is_rejected_with_line_and_fix() {
    let workspace = workspace();
    workspace.write("bare.ron", "(name: \"Bare\")");
    let suite = |family: &str| format!("(\n    name: \"Bad\",\n    families: [\n        {family}\n    ],\n)");
    for (family, part) in [
        (
            "(name: \"a\", scenarios: [\"maze\", \"missing.ron\"])",
            "bad.ron:4:41: `families[0].scenarios[1]` can't be used: missing.ron: ",
        ),
        (
            "(name: \"a\", scenarios: [\"clutter\"])",
            "it is a level generator; help: write `generator: \"clutter\"`",
        ),
        (
            "(name: \"a\", generator: \"maze\")",
            "bad.ron:4:32: `families[0].generator` can't be used: it is not a level generator",
        ),
        (
            "(name: \"a\")",
            "bad.ron:4:9: `families[0]` must have scenarios: write either `scenarios: [\"FILE\", ...]`",
        ),
        (
            "(name: \"a\", scenarios: [\"maze\"], levels: 3)",
            "`families[0].levels` belongs to a generator: remove it",
        ),
        (
            "(name: \"a\", generator: \"clutter\", first_level: 18446744073709551615)",
            "`families[0].first_level` is too large for this number of levels: give a smaller seed",
        ),
        (
            "(name: \"a\", scenarios: [\"maze\"], episodes: 0)",
            "`families[0].episodes` is 0: write a number from 1 to",
        ),
        (
            "(name: \"a\", scenarios: [\"maze\"], time_limit_s: 0)",
            "`families[0].time_limit_s` is 0: write a number from 0.1",
        ),
        (
            "(name: \"a\", scenarios: [\"maze\"], collision_range_m: 0.05)",
            "bad.ron:4:9: `families[0]` can't be used: maze: ",
        ),
        (
            "(name: \"a\", scenarios: [\"barn.json\"])",
            "bad.ron:4:33: `families[0].scenarios[0]` can't be used: ",
        ),
        (
            "(name: \"a\", scenarios: [\"bare.ron\"], benchmark_route: true)",
            "bare.ron has no benchmark route; help: ",
        ),
    ] {
        workspace.write("bad.ron", suite(family));
        for command in ["--check bad.ron", "--eval dwa --suite bad.ron --csv episodes.csv"] {
            let done = workspace.run(command);
            assert_eq!(done.status, Some(2), "{command}: {}", done.stderr);
            assert!(done.stderr.contains(part), "{command}: no `{part}` in {}", done.stderr);
        }
    }
    assert!(!workspace.path("episodes.csv").exists());
}

#[test]
fn options_that_do_not_suit_a_suite_are_refused_with_a_fix() {
    let workspace = workspace();
    std::fs::create_dir(workspace.path("nothing")).unwrap();
    for (arguments, part) in [
        ("--eval dwa --suite suite.ron --trace t.jsonl", "--trace is for a test in one scenario"),
        ("--eval dwa --suite suite.ron --rounds 2", "--rounds is for a test in one scenario"),
        ("--eval dwa --suite suite.ron --scenario maze", "cannot be used with"),
        (
            "--eval dwa --scenario suite.ron",
            "suite.ron: is a suite, not a scenario; help: --eval POLICY --suite suite.ron",
        ),
        (
            "--eval dwa --scenario suite.ron --report report",
            "suite.ron: is a suite, not a scenario; help: --eval POLICY --suite suite.ron",
        ),
        (
            "--eval dwa --report report",
            "--report needs scenarios to test in; help: give --suite NAME, or --scenario",
        ),
        ("--eval dwa --scenario maze --report report --course", "--course is for a test in one scenario"),
        ("--eval dwa --suite nothing", "nothing: this folder has no .ron file; help: "),
        ("--eval dwa --suite mzae", "did you mean `maze`?"),
        ("--eval scenario-1 --suite suite.ron", "but scenario"),
        ("--eval dwa --suite suite.ron --episodes 1000000", "help: give at most 1000000 in total"),
        (
            "--eval dwa --suite suite.ron --set scenario.lidar.beams=0",
            "one.ron: --set scenario.lidar.beams=0: `scenario.lidar.beams` is 0",
        ),
    ] {
        let done = workspace.run(arguments);
        assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{arguments}: {}", done.stderr);
        assert!(done.stderr.contains(part), "{arguments}: no `{part}` in {}", done.stderr);
    }
}

#[test]
fn a_folder_does_not_hide_the_shipped_scenario_of_its_name() {
    let workspace = workspace();
    let eval = "--eval field --episodes 1 --json --suite";
    let shipped = workspace.run_ok(&format!("{eval} empty")).json();
    std::fs::create_dir(workspace.path("empty")).unwrap();
    assert_eq!(workspace.run_ok(&format!("{eval} empty")).json(), shipped);
    let done = workspace.run(&format!("{eval} empty/"));
    assert!(done.stderr.contains("this folder has no .ron file"), "{}", done.stderr);
}

/// A suite of scenarios without moving obstacles, in which the driver `field` often fails.
const HARD: &str = r#"(
    name: "Hard",
    families: [
        (name: "u-trap", scenarios: ["u-trap"], episodes: 4, time_limit_s: 20),
        (name: "levels", generator: "clutter.ron", levels: 5),
        (name: "field", scenarios: ["random-field"], episodes: 4, time_limit_s: 20),
    ],
)"#;

#[test]
fn a_report_shows_every_failure_and_its_scenario_has_the_same_start_and_goal() {
    let workspace = workspace();
    workspace.write("hard.ron", HARD);
    workspace.run_ok("--eval field dwa --suite hard.ron --report report --csv episodes.csv --json");
    let page = workspace.text("report/report.html");
    let failed: Vec<_> = rows(&workspace).into_iter().filter(|row| row["outcome"] != "success").collect();
    assert!(failed.len() > 2, "some fail");
    let files = std::fs::read_dir(workspace.path("report/failures")).unwrap().count();
    assert_eq!(files, failed.len());
    for row in &failed {
        let (policy, scenario, episode) = (&row["policy"], &row["scenario"], &row["episode"]);
        let caption = format!("{policy} in {scenario}, episode {episode}: {} after ", row["outcome"]);
        assert_eq!(page.matches(&caption).count(), 1, "{caption}");
        let number = (1..=failed.len()).find(|number| {
            workspace.text(&format!("report/failures/failure-{number:04}.ron")).contains(&caption)
        });
        let file = format!("report/failures/failure-{:04}.ron", number.expect("its scenario"));
        assert!(
            page.contains(&format!(
                "wayfield --scenario {file} --seed 0 --episode {episode} --open report/drivers/"
            )),
            "{file}"
        );
        workspace
            .run_ok(&format!("--eval {policy} --scenario {file} --rounds 1 --episodes 1 --csv again.csv"));
        let again: Vec<BTreeMap<String, String>> = csv::Reader::from_path(workspace.path("again.csv"))
            .unwrap()
            .deserialize()
            .map(Result::unwrap)
            .collect();
        for column in ["start_x_m", "start_y_m", "start_heading_rad", "goal_x_m", "goal_y_m"] {
            assert_eq!(again[0][column], row[column], "{file}: {column}");
        }
        // Nothing moves in these scenarios, and nothing is noisy.
        assert_eq!((&again[0]["outcome"], &again[0]["steps"]), (&row["outcome"], &row["steps"]), "{file}");
    }
}

#[cfg(unix)]
#[test]
fn a_report_is_written_even_if_the_reader_of_the_episodes_closes_its_pipe() {
    let workspace = Workspace::new();
    workspace.write("one.ron", with_short_episodes(SCENARIO_1));
    let eval = "--eval dwa --scenario one.ron --episodes 2 --report report --csv -";
    let done = workspace.shell(&format!("$WAYFIELD {eval} | true"));
    assert!(done.stderr.contains("report: ") && !done.stderr.contains("error"), "{}", done.stderr);
    assert!(workspace.path("report/report.html").exists());
}

#[test]
fn a_new_report_deletes_the_files_of_the_earlier_one_and_no_others() {
    let workspace = workspace();
    workspace.write("hard.ron", HARD);
    let names = |folder: &str| {
        let entries = std::fs::read_dir(workspace.path(folder)).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    };
    workspace.run_ok("--eval field dwa --suite hard.ron --report report");
    assert_eq!(names("report/drivers"), ["1-field.ron", "2-dwa.ron"]);
    let earlier = names("report/failures").len();
    workspace.write("report/drivers/mine.ron", "mine");
    workspace.write("report/drivers/2-notes.txt", "mine");
    workspace.write("report/failures/notes.txt", "mine");
    let earlier_images = names("report/figures").len();
    let own = ["figures/My sketch.svg", "figures/plot.csv", "tables/notes.md"];
    own.iter().for_each(|name| workspace.write(&format!("report/{name}"), "mine"));
    workspace.run_ok("--eval dwa --suite hard.ron --report report");
    for name in own {
        assert_eq!(workspace.text(&format!("report/{name}")), "mine", "{name}");
    }
    assert!(names("report/figures").len() - 2 < earlier_images, "outdated images are deleted");
    assert_eq!(names("report/drivers"), ["1-dwa.ron", "2-notes.txt", "mine.ron"]);
    let failures = workspace.text("report/report.html").matches("To repeat it: ").count();
    assert!(failures < earlier, "the driver `field` fails, too");
    let kept = names("report/failures");
    assert_eq!(kept.len(), failures + 1, "{kept:?}");
    assert!(kept.contains(&"notes.txt".to_string()), "{kept:?}");
}

#[test]
fn a_scenario_a_set_or_a_generator_gives_the_same_results_as_a_suite_of_it() {
    let workspace = workspace();
    let set = "(name: \"Both\", scenarios: [(scenario: \"one.ron\"), (scenario: \"two.ron\", share: 2)])";
    workspace.write("both.ron", set);
    for (given, families) in [("both.ron", 2), ("clutter.ron", 1), ("one.ron", 1)] {
        let eval = format!("--eval field --episodes 2 --json --report {given}-report");
        let report = workspace.run_ok(&format!("{eval} --scenario {given}")).json();
        assert_eq!(report["families"].as_object().map(serde_json::Map::len), Some(families), "{report}");
        let page = workspace.text(&format!("{given}-report/report.html"));
        let failures =
            std::fs::read_dir(workspace.path(&format!("{given}-report/failures"))).map_or(0, Iterator::count);
        assert_eq!(page.matches("To repeat it: ").count(), failures, "{given}");
        let suite = format!("--eval field --episodes 2 --json --suite {given}");
        assert_eq!(workspace.run_ok(&suite).json(), report, "{given}");
    }
}

#[test]
fn an_interrupted_test_resumes_with_the_same_results() {
    let workspace = workspace();
    let eval = "--eval field dwa --suite suite.ron --json";
    let whole = workspace.run_ok(eval).stdout;
    assert_eq!(workspace.run_ok(&format!("{eval} --report report")).stdout, whole);
    let tests = workspace.text("report/tests.ron");
    assert_eq!(tests.lines().count(), 2 * 17, "a line for each driver and scenario");
    // As if killed while the twelfth line was written.
    let kept: Vec<&str> = tests.lines().take(12).collect();
    workspace.write("report/tests.ron", &kept.join("\n")[..kept.join("\n").len() - 20]);
    assert_eq!(workspace.run_ok(&format!("{eval} --report report")).stdout, whole);
    assert_eq!(workspace.text("report/tests.ron").lines().count(), 2 * 17);
    // Finished tests are reused only with the same seed.
    workspace.run_ok(&format!("{eval} --report report --seed 1"));
    assert_eq!(workspace.text("report/tests.ron").lines().count(), 4 * 17);
    // As if killed before the first test.
    std::fs::create_dir(workspace.path("begun")).unwrap();
    workspace.write("begun/lock", "");
    assert_eq!(workspace.run_ok(&format!("{eval} --report begun")).stdout, whole);
    std::fs::create_dir(workspace.path("used")).unwrap();
    workspace.write("used/notes.txt", "mine");
    let done = workspace.run(&format!("{eval} --report used"));
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    assert!(
        done.stderr.contains("used: holds something other than the report of a suite; help: "),
        "{}",
        done.stderr
    );
}

#[test]
fn tests_with_plugins_are_not_stored() {
    #[derive(Clone)]
    struct MyPlugin;
    impl Plugin for MyPlugin {
        fn build(&self, _: &mut App) {}
    }
    let workspace = Workspace::new();
    let suite = Suite::load("empty", &Settings::default(), Some(1)).unwrap();
    let driver = DriverConfig::Field(FieldParameters::default());
    let drivers = [SuiteDriver { name: "field".into(), evaluated: Evaluated::Driver(&driver) }];
    let plugin = Extensions::default().plugin(MyPlugin);
    for (name, extensions, stored) in [("none.ron", Extensions::default(), 1), ("plugin.ron", plugin, 0)] {
        let store = TestStore::open(&workspace.path(name)).unwrap();
        let test = SuiteTest {
            suite: &suite,
            seed: 0,
            optimum: false,
            extensions: &extensions,
            threads: 1,
            stop: None,
            store: Some(&store),
            progress: &|_, _| {},
        };
        assert_eq!(test.run(&drivers).unwrap().len(), 1);
        assert_eq!(workspace.text(name).lines().count(), stored, "{name}");
    }
}
