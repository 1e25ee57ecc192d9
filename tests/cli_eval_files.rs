//! What `--eval` writes: a comparison of several policies on the same episodes, a CSV row per episode, a trace of every
//! control step.

mod cli_support;

use std::collections::BTreeMap;

use cli_support::{Workspace, messages::rejection, signal, wait_for_output, wait_until};
use serde_json::Value;

/// Two shipped policies in Scenario II, where the first one collides now and then.
const EVAL: &str = "--eval scenario-1 scenario-2 --scenario scenario-2 --rounds 2 --episodes 60 --seed 3";

type Row = BTreeMap<String, String>;

fn rows(text: &str) -> Vec<Row> {
    csv::Reader::from_reader(text.as_bytes()).deserialize().map(Result::unwrap).collect()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("`{column}` is not a number in {row:?}"))
}

fn of_policy<'a>(rows: &'a [Row], policy: &'a str) -> Vec<&'a Row> {
    rows.iter().filter(|row| row["policy"] == policy).collect()
}

fn lines(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn floats(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn several_policies_drive_the_same_episodes_and_are_compared_in_a_table() {
    let workspace = Workspace::new();
    let both = workspace.run_ok(&format!("{EVAL} --course --json")).json();
    let policies = both["policies"].as_array().unwrap();
    assert_eq!((&both["episodes"], &both["seed"], policies.len()), (&Value::from(120), &Value::from(3), 2));
    for report in policies {
        let policy = report["policy"].as_str().unwrap();
        let alone = EVAL.replace("scenario-1 scenario-2 --scenario", &format!("{policy} --scenario"));
        assert_eq!(
            workspace.run_ok(&format!("{alone} --course --json")).json(),
            *report,
            "as if tested alone"
        );
        for rate in ["success", "collision", "timeout", "course_success"] {
            let interval = floats(&report[format!("{rate}_interval")]);
            let rate = report[format!("{rate}_rate")].as_f64().unwrap();
            assert!(0.0 <= interval[0] && interval[0] <= rate, "{report}");
            assert!(rate <= interval[1] && interval[1] <= 1.0 && interval[0] < interval[1], "{report}");
        }
    }
    let text = workspace.run_ok(&format!("{EVAL} --course")).stdout;
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].starts_with("2 policies in Scenario II, the same 120 episodes, seed 3 ("), "{text}");
    for (line, report) in lines[3..].iter().zip(policies) {
        let percent = |value: &Value| format!("{:.1}", 100.0 * value.as_f64().unwrap());
        let interval = &report["success_interval"];
        let success = format!(
            "{} % [{}, {}]",
            percent(&report["success_rate"]),
            percent(&interval[0]),
            percent(&interval[1])
        );
        let start = lines[2].find("success").unwrap();
        assert!(line[start..].starts_with(&success), "`{success}` is not under its title in\n{text}");
    }
    let error = rejection(&workspace, "--eval scenario-1 scenario-2");
    assert!(error.contains("\"Scenario I\"") && error.contains("help: give --scenario"), "{error}");
}

#[test]
fn a_csv_file_has_a_row_per_episode_that_agrees_with_the_summary() {
    let workspace = Workspace::new();
    let report = workspace.run_ok(&format!("{EVAL} --csv episodes.csv --json")).json();
    let text = workspace.text("episodes.csv");
    let header = "policy,episode,outcome,hit,hit_index,hit_shape,steps,time_s,path_length_m,shortest_path_m,spl,\
                  min_clearance_m,optimal_time_s,lower_bound_time_s,start_x_m,start_y_m,start_heading_rad,goal_x_m,goal_y_m,\
                  clock_steps,layout_seed";
    assert_eq!(text.lines().next(), Some(header), "the columns that docs/command-line.md describes");
    let all = rows(&text);
    assert_eq!(all.len(), 240);
    for report in report["policies"].as_array().unwrap() {
        let rows = of_policy(&all, report["policy"].as_str().unwrap());
        let fraction = |outcome| rows.iter().filter(|row| row["outcome"] == outcome).count() as f64 / 120.0;
        for outcome in ["success", "collision", "timeout"] {
            let rate = report[format!("{outcome}_rate")].as_f64().unwrap();
            assert!((rate - fraction(outcome)).abs() < 1e-9, "{outcome}: {report}");
        }
        let spl = rows.iter().map(|row| number(row, "spl")).sum::<f64>() / 120.0;
        assert!((report["spl"].as_f64().unwrap() - spl).abs() < 1e-6, "{report}");
        for (index, row) in rows.iter().enumerate() {
            assert_eq!(number(row, "episode"), index as f64 + 1.0);
            assert!((number(row, "time_s") - 0.2 * number(row, "steps")).abs() < 1e-9, "{row:?}");
            assert!(number(row, "path_length_m") <= 0.03 * number(row, "steps") + 1e-5, "{row:?}");
            assert!(row["optimal_time_s"].is_empty() && row["layout_seed"].is_empty(), "{row:?}");
            let (length, shortest) = (number(row, "path_length_m"), number(row, "shortest_path_m"));
            let (spl, clearance) = (number(row, "spl"), number(row, "min_clearance_m"));
            let collided = row["outcome"] == "collision";
            assert_eq!(collided, !row["hit"].is_empty(), "{row:?}");
            // A range below 0.13 m is a collision; the robot's radius is 0.1 m.
            assert!(!collided || clearance < 0.031, "{row:?}");
            if row["outcome"] == "success" {
                assert!((spl - shortest / length.max(shortest)).abs() < 1e-5, "{row:?}");
                assert!(length > 0.98 * shortest, "{row:?}");
            } else {
                assert_eq!(spl, 0.0, "{row:?}");
            }
            if row["hit"] == "moving obstacle" {
                assert!(row["hit_shape"] == "circle" && number(row, "hit_index") < 4.0, "{row:?}");
            }
        }
    }
    let hits: Vec<&str> = all.iter().map(|row| row["hit"].as_str()).collect();
    assert!(hits.contains(&"moving obstacle"), "{hits:?}");
    let setups = |policy| -> Vec<Vec<String>> {
        let columns = ["start_x_m", "start_heading_rad", "goal_y_m", "clock_steps", "shortest_path_m"];
        let of = |row: &&Row| columns.iter().map(|column| row[*column].clone()).collect();
        of_policy(&all, policy).iter().map(of).collect()
    };
    assert_eq!(setups("scenario-1"), setups("scenario-2"), "both drive the same episodes");

    workspace.run_ok(&format!("{EVAL} --csv again.csv"));
    assert_eq!(workspace.text("again.csv"), text, "the same bytes");
}

#[test]
fn with_optimum_the_rows_have_the_planners_times() {
    let workspace = Workspace::new();
    let command = "--eval scenario-1 --rounds 1 --episodes 20 --optimum";
    let report = workspace.run_ok(&format!("{command} --csv episodes.csv --json")).json();
    assert_eq!(workspace.run_ok(&format!("{command} --json")).json(), report, "the file changes no result");
    let rows = rows(&workspace.text("episodes.csv"));
    assert_eq!(rows.len(), 20);
    for row in rows {
        let (optimal, bound) = (number(&row, "optimal_time_s"), number(&row, "lower_bound_time_s"));
        assert!(bound <= optimal + 1e-9, "{row:?}");
        assert!(row["outcome"] != "success" || number(&row, "time_s") >= bound - 1e-9, "{row:?}");
    }
}

#[test]
fn a_trace_has_every_step_of_every_episode() {
    let workspace = Workspace::new();
    let command = "--eval scenario-1 --scenario scenario-2 --rounds 1 --episodes 40 --seed 3";
    let plain = workspace.run_ok(&format!("{command} --json --csv episodes.csv")).json();
    let traced = workspace.run_ok(&format!("{command} --json --csv again.csv --trace steps.jsonl")).json();
    assert_eq!(plain, traced, "tracing changes no result");
    assert_eq!(workspace.text("episodes.csv"), workspace.text("again.csv"));

    let mut steps = lines(&workspace.text("steps.jsonl")).into_iter();
    let rows = rows(&workspace.text("episodes.csv"));
    assert_eq!(rows.len(), 40);
    for row in rows {
        let mut length = 0.0;
        let mut clearance = f64::INFINITY;
        let mut before: Option<(f64, f64)> = None;
        for step in 0..=number(&row, "steps") as u64 {
            let line = steps.next().unwrap_or_else(|| panic!("a line is missing: {row:?}, step {step}"));
            let value = |key: &str| line[key].as_f64().unwrap_or_else(|| panic!("`{key}` in {line}"));
            assert_eq!((value("episode"), value("step")), (number(&row, "episode"), step as f64));
            let at = (value("x_m"), value("y_m"));
            length += before.map_or(0.0, |(x, y)| (at.0 - x).hypot(at.1 - y));
            clearance = clearance.min(value("clearance_m"));
            before = Some(at);
            assert_eq!(floats(&line["ranges_m"]).len(), 24);
            if step == 0 {
                assert_eq!(at, (number(&row, "start_x_m"), number(&row, "start_y_m")));
                assert_eq!((value("v_m_s"), value("w_rad_s")), (0.0, 0.0), "the robot starts at rest");
            }
            if step < number(&row, "steps") as u64 {
                let q_values = floats(&line["q_values"]);
                let best = q_values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                assert_eq!(q_values.len(), 5);
                assert_eq!(q_values[value("action") as usize], best, "the policy acts greedily: {line}");
                assert!(value("reward").is_finite() && line["outcome"].is_null());
            } else {
                assert_eq!(line["outcome"], row["outcome"]);
                assert!(line["action"].is_null() && line["q_values"].is_null() && line["reward"].is_null());
            }
        }
        assert!((length - number(&row, "path_length_m")).abs() < 1e-4, "{length}: {row:?}");
        assert!((clearance - number(&row, "min_clearance_m")).abs() < 1e-6, "{clearance}: {row:?}");
    }
    assert_eq!(steps.next(), None);
    workspace.run_ok(&format!("{command} --trace again.jsonl"));
    assert!(workspace.read("again.jsonl") == workspace.read("steps.jsonl"), "the same bytes");
}

#[test]
fn scenarios_with_generators_walls_and_polygons_have_rows_too() {
    let workspace = Workspace::new();
    workspace.write(
        "triangle.ron",
        "(name: \"Triangle\", enclosure: Polygon(corners_m: [(-3.0, -2.0), (3.0, -2.0), (0.0, 3.0)]), \
         walls: [(corners_m: [(-0.5, 0.0), (0.5, 0.0)])])",
    );
    for (scenario, has_layouts) in [("random-field", true), ("maze", false), ("triangle.ron", false)] {
        workspace.run_ok(&format!(
            "--eval scenario-2 --scenario {scenario} --rounds 1 --episodes 40 --csv {scenario}.csv"
        ));
        let rows = rows(&workspace.text(&format!("{scenario}.csv")));
        assert_eq!(rows.len(), 40, "{scenario}");
        for row in rows {
            assert_eq!(row["layout_seed"].is_empty(), !has_layouts, "{row:?}");
            let straight = (number(&row, "goal_x_m") - number(&row, "start_x_m"))
                .hypot(number(&row, "goal_y_m") - number(&row, "start_y_m"))
                - 0.2;
            assert!(number(&row, "shortest_path_m") >= straight - 1e-4, "{row:?}");
            assert!((0.0..=1.0).contains(&number(&row, "spl")), "{row:?}");
            let has_index = !["", "enclosure"].contains(&row["hit"].as_str());
            assert_eq!(has_index, !row["hit_index"].is_empty(), "{row:?}");
            assert_eq!(row["hit"].ends_with("obstacle"), !row["hit_shape"].is_empty(), "{row:?}");
        }
    }
}

#[test]
fn a_dash_writes_a_file_to_standard_output_and_the_summary_to_standard_error() {
    let workspace = Workspace::new();
    let command = "--eval scenario-1 --rounds 1 --episodes 3";
    let done = workspace.run_ok(&format!("{command} --csv -"));
    assert_eq!(rows(&done.stdout).len(), 3, "{}", done.stdout);
    assert!(done.stderr.contains("success  "), "{}", done.stderr);
    let done = workspace.run_ok(&format!("{command} --trace -"));
    assert!(lines(&done.stdout).len() > 30, "{}", done.stdout);
    std::fs::create_dir(workspace.path("folder")).unwrap();
    for (arguments, reason) in [
        (format!("{command} --json --csv -"), "both go to standard output"),
        (format!("{command} --csv - --trace -"), "name the same file"),
        (format!("{command} --csv same --trace same"), "name the same file"),
        (format!("{command} --csv same --trace ./same"), "name the same file"),
        (format!("{command} --csv same --trace folder/../same"), "name the same file"),
        (format!("{command} --csv absent/episodes.csv"), "the folder absent does not exist"),
        ("--eval scenario-3".into(), "no such file, shipped policy or driver"),
    ] {
        let error = rejection(&workspace, &arguments);
        assert!(error.contains(reason) && error.contains("help: "), "{error}");
    }
    #[cfg(unix)]
    {
        let done = workspace.run_ok(&format!("{command} --csv /dev/fd/1"));
        assert_eq!(rows(&done.stdout).len(), 3, "{}", done.stdout);
        assert!(done.stderr.contains("success  "), "{}", done.stderr);
        let error = rejection(&workspace, &format!("{command} --json --csv /dev/fd/1"));
        assert!(error.contains("both go to standard output"), "{error}");
        // The 1,000 rows are longer than the buffer of a pipe.
        let rows = "--eval scenario-1 --rounds 10 --episodes 100 --csv -";
        for command in [rows, &format!("{command} --trace -")] {
            let head = workspace.shell(&format!("$WAYFIELD {command} | head -n 1"));
            assert_eq!((head.status, head.stdout.lines().count()), (Some(0), 1), "{}", head.stderr);
            assert!(!head.stderr.contains("error"), "{}", head.stderr);
        }
        // The trace of 100 episodes, too.
        let both = "--eval scenario-1 --rounds 1 --episodes 100 --csv left.csv --trace -";
        let head = workspace.shell(&format!("$WAYFIELD {both} | head -n 1"));
        assert!(head.stderr.contains("note: left.csv: not written"), "{}", head.stderr);
        assert!(!workspace.path("left.csv").exists());
    }
}

#[cfg(unix)]
#[test]
fn a_stopped_evaluation_leaves_the_old_files_and_no_others() {
    let workspace = Workspace::new();
    for name in ["episodes.csv", "steps.jsonl"] {
        workspace.write(name, "old\n");
    }
    let before = workspace.all_files();
    for file in ["--csv episodes.csv", "--trace steps.jsonl"] {
        let mut child = workspace.start(&format!("--eval scenario-1 --rounds 1000 --episodes 1000 {file}"));
        wait_until(&mut child, "the new file is begun", || workspace.all_files().len() > before.len());
        signal(&child, "TERM");
        let done = wait_for_output(child);
        assert_eq!((done.status, done.stdout.as_str()), (Some(143), ""), "{}", done.stderr);
        assert!(done.stderr.contains("no file was written"), "{}", done.stderr);
        assert!(workspace.all_files() == before, "{file}");
    }
}
