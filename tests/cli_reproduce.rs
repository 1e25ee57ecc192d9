//! Tests of `wayfield --reproduce`: it trains, tests and writes a report, does not repeat finished runs, and gives the same
//! results for any number of parallel runs and after interruptions.

mod cli_support;
#[cfg(target_os = "linux")]
#[path = "support/requirements.rs"]
mod requirements;
#[cfg(target_os = "linux")]
#[path = "support/small_disk.rs"]
mod small_disk;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use cli_support::{Workspace, quick_fast, quick_per, signal, wait_for_output, wait_until};

/// A small experiment with two arms, one of them with two stages, a preset in the same folder, and a figure and a table
/// of each kind.
const OWN: &str = r#"(
    title: "A user's experiment",
    about: "Does < it > work?",
    seeds: 2,
    test: (rounds: 2, episodes: 3, seed: 7),
    arms: [
        (
            name: "plain",
            stages: [(scenario: "scenario-1", preset: "per.ron", budget: Episodes(24), overrides: (double: false))],
        ),
        (
            name: "transferred",
            stages: [
                (scenario: "empty", preset: "per.ron", budget: Episodes(12)),
                (scenario: "scenario-1", preset: "per.ron", budget: Episodes(12), epsilon: 0.5),
            ],
        ),
    ],
    figures: [
        (
            name: "curves",
            title: "Curves",
            draw: LearningCurves(series: [Return, Goals], smoothing: 5),
            claims: [
                (statement: "Transfer helps", measure: Return, better: "transferred", than: "plain", after: 24),
            ],
        ),
        (name: "dots", title: "Dots", draw: DotPlot(measures: [Success, EpisodesTo(1.0)], after: 20)),
        (name: "course", title: "Course", draw: BenchmarkRoute(after: 24)),
    ],
    tables: [
        (
            name: "times",
            aliases: ["clock"],
            title: "Times",
            show: Seeds(measure: BenchmarkRouteTime, after: 24, paper: [("plain", 13.155)]),
        ),
        (name: "rounds", title: "Rounds", show: Rounds(after: 24, paper: [("plain", [83.0, 86.0])])),
        (name: "all", title: "All", show: Measures(measures: [Success, MeanTime, TimeRatio], after: 24)),
        (
            name: "which",
            title: "Which",
            show: Contrast(measures: [Success], better: "transferred", than: "plain", after: [8, 12], of_last_stage: true),
        ),
    ],
)
"#;

fn workspace() -> Workspace {
    let workspace = Workspace::new();
    fs::create_dir(workspace.path("mine")).unwrap();
    workspace.write("mine/own.ron", OWN);
    workspace.write("mine/per.ron", quick_per());
    workspace
}

/// All files of the report in `folder`, with their contents.
fn whole_report(workspace: &Workspace, folder: &str) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut files = report(workspace, folder);
    for page in ["README.md", "report.html"] {
        files.insert(page.into(), workspace.read(&format!("{folder}/{page}")));
    }
    files
}

/// The figure and table files of the report in `folder`, with their contents.
fn report(workspace: &Workspace, folder: &str) -> BTreeMap<PathBuf, Vec<u8>> {
    let root = workspace.path(folder);
    let mut files = BTreeMap::new();
    for sub in ["figures", "tables"] {
        for entry in fs::read_dir(root.join(sub)).unwrap() {
            let path = entry.unwrap().path();
            files.insert(path.strip_prefix(&root).unwrap().to_owned(), fs::read(&path).unwrap());
        }
    }
    files
}

/// The time at which each training run finished.
fn finished_at(root: &Path) -> BTreeMap<PathBuf, std::time::SystemTime> {
    let runs = fs::read_dir(root.join("runs")).unwrap();
    let summaries = runs.map(|run| run.unwrap().path().join("summary.json"));
    summaries
        .filter_map(|summary| Some((summary.clone(), fs::metadata(&summary).ok()?.modified().ok()?)))
        .collect()
}

#[test]
fn an_experiment_gives_a_report_and_finished_runs_are_not_repeated() {
    let workspace = workspace();
    let done = workspace.run_ok("--reproduce --experiment mine/own.ron --out one --jobs 1");
    assert!(done.stdout.contains("Transfer helps"), "{}", done.stdout);
    assert!(done.stdout.contains("one/report.html (6 runs"), "{}", done.stdout);
    assert!(done.stderr.contains("100%  6 of 6 runs"), "{}", done.stderr);

    let one = report(&workspace, "one");
    let names: Vec<String> = one.keys().map(|path| path.display().to_string()).collect();
    let expected = [
        "figures/course.png",
        "figures/course.svg",
        "figures/curves.png",
        "figures/curves.svg",
        "figures/dots.png",
        "figures/dots.svg",
        "tables/all.csv",
        "tables/all.md",
        "tables/rounds.csv",
        "tables/rounds.md",
        "tables/times.csv",
        "tables/times.md",
        "tables/which.csv",
        "tables/which.md",
    ];
    assert_eq!(names, expected);
    let html = workspace.text("one/report.html");
    for text in [
        "A user&#39;s experiment",
        "Does &lt; it &gt; work?",
        "Transfer helps",
        "Seed 2",
        "per.ron",
        "13.155",
    ] {
        assert!(
            html.contains(text) || html.contains(&text.replace("&#39;", "'")),
            "{text} is not in the page"
        );
    }
    let markdown = workspace.text("one/README.md");
    assert!(markdown.contains("figures/curves.svg") && markdown.contains("Transfer helps"), "{markdown}");

    let rounds: Vec<_> =
        csv::Reader::from_path(workspace.path("one/tables/rounds.csv")).unwrap().into_records().collect();
    assert_eq!(rounds.len(), 5, "two arms with two seeds, and the paper's rounds of one arm");
    assert_eq!(
        rounds[0].as_ref().unwrap().iter().next_back(),
        Some("84.500"),
        "the paper's mean of 83 and 86"
    );

    let times = csv::Reader::from_path(workspace.path("one/tables/times.csv")).unwrap().records().count();
    assert_eq!(times, 2, "a row for each arm");

    // With another number of jobs and in another folder, the report is the same to the byte.
    workspace.run_ok("--reproduce --experiment mine/own.ron --out two --jobs 3");
    let two = report(&workspace, "two");
    for (path, bytes) in &one {
        assert!(two[path] == *bytes, "{} depends on the number of jobs", path.display());
    }

    // In the same folder, no run is repeated, and the report is the same.
    let before = finished_at(&workspace.path("one"));
    workspace.run_ok("--reproduce --experiment mine/own.ron --out one");
    assert_eq!(finished_at(&workspace.path("one")), before, "no run was repeated");
    assert!(report(&workspace, "one") == one);

    // A part of the experiment with fewer seeds needs no new runs.
    let json =
        workspace.run_ok("--reproduce --experiment mine/own.ron --out one --only clock --seeds 1 --json");
    let json: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!((json["runs"].as_u64(), json["claims"].as_array().unwrap().len()), (Some(3), 0));
    assert_eq!(finished_at(&workspace.path("one")), before, "no run was repeated");
}

#[test]
fn stopped_work_continues_where_it_stopped() {
    let workspace = workspace();
    // The runs are long enough to be stopped before they end.
    let longer = OWN.replace("Episodes(24)", "Episodes(300)").replace("Episodes(12)", "Episodes(150)");
    workspace.write("mine/own.ron", longer);
    let arguments = "--reproduce --experiment mine/own.ron --jobs 1 --out";
    workspace.run_ok(&format!("{arguments} straight"));

    let mut child = workspace.start(&format!("{arguments} stopped"));
    wait_until(&mut child, "a run has a checkpoint", || {
        fs::read_dir(workspace.path("stopped/runs"))
            .is_ok_and(|mut runs| runs.any(|run| run.unwrap().path().join("checkpoint/latest.bin").exists()))
    });
    signal(&child, "TERM");
    let done = wait_for_output(child);
    assert_eq!(done.status, Some(143), "{}", done.stderr);
    assert!(
        done.stderr.contains("of 6 runs; help: the same command continues from there"),
        "{}",
        done.stderr
    );
    assert!(!workspace.path("stopped/report.html").exists(), "there is no report of unfinished work");

    // A run continues from its checkpoint; a run without a checkpoint is repeated.
    let arguments_killed = format!("{arguments} stopped");
    let mut child = workspace.start(&arguments_killed);
    wait_until(&mut child, "a run is finished", || !finished_at(&workspace.path("stopped")).is_empty());
    signal(&child, "KILL");
    wait_for_output(child);
    for run in fs::read_dir(workspace.path("stopped/runs")).unwrap() {
        let checkpoint = run.unwrap().path().join("checkpoint");
        for kept in ["latest.bin", "previous.bin", "older.bin"] {
            let _ = fs::remove_file(checkpoint.join(kept));
        }
    }
    workspace.run_ok(&format!("{arguments} stopped"));
    assert!(
        report(&workspace, "stopped") == report(&workspace, "straight"),
        "the report is the same as without interruptions"
    );
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_the_last_report_as_it_was() {
    if !small_disk::can_mount() {
        return;
    }
    let workspace = workspace();
    let command = "--reproduce --experiment mine/own.ron --jobs 1 --seeds 1";
    workspace.run_ok(&format!("{command} --out before"));
    let reproduce = format!("$WAYFIELD {command} --only dots,times --out small/report 2>&1");
    let done = small_disk::with_small_disk(
        &workspace,
        "size=64m",
        &format!(
            "cp -r before small/report; {}; s=0; {reproduce} || s=$?; echo $s; cp -r small/report after; \
             rm small/fill; {reproduce}; cp -r small/report again",
            small_disk::fill_disk(12),
        ),
    );
    assert_eq!(done.status, Some(0), "{}{}", done.stdout, done.stderr);
    assert!(
        done.stdout.contains("can't be written: No space left on device (os error 28)\n1\n"),
        "{}",
        done.stdout
    );
    assert!(
        whole_report(&workspace, "after") == whole_report(&workspace, "before"),
        "the report has changed"
    );
    let names: Vec<String> =
        report(&workspace, "again").keys().map(|path| path.display().to_string()).collect();
    assert_eq!(names, ["figures/dots.png", "figures/dots.svg", "tables/times.csv", "tables/times.md"]);
}

/// The test aborts the process as often as it replaces a file.
#[test]
fn a_report_that_is_killed_while_it_is_written_consists_of_whole_files() {
    let workspace = workspace();
    let command = "--reproduce --experiment mine/own.ron --jobs 1 --seeds 1 --out report";
    workspace.run_ok(command);
    let first = report(&workspace, "report");
    let other = format!("{command} --only dots,times");
    workspace.run_ok(&other.replace("--out report", "--out other"));
    let second = report(&workspace, "other");
    let mut aborted = 0;
    for point in ["file: contents written", "file: replaced"] {
        for pass in 1.. {
            let done = workspace.run_until(&other, &format!("{point}:{pass}"));
            if done.status == Some(0) {
                break;
            }
            assert_eq!(done.status, None, "{}", done.stderr);
            aborted += 1;
            for (path, bytes) in report(&workspace, "report") {
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                let is_whole = [&first, &second].iter().any(|report| report.get(&path) == Some(&bytes));
                assert!(is_whole || name.starts_with('.'), "{point}:{pass}: {} is not whole", path.display());
            }
            assert!(workspace.text("report/report.html").trim_end().ends_with("</html>"), "{point}:{pass}");
            workspace.run_ok(command);
            assert!(
                report(&workspace, "report") == first,
                "{point}:{pass}: the report is not complete again"
            );
        }
    }
    assert!(aborted > 12, "only {aborted} aborts");
}

#[test]
fn of_two_processes_started_at_once_one_is_refused() {
    let workspace = workspace();
    workspace.write("mine/own.ron", OWN.replace("Episodes(24)", "Episodes(5000)"));
    let command = "--reproduce --experiment mine/own.ron --jobs 1 --out report";
    let mut both = [workspace.start(command), workspace.start(command)];
    let began = std::time::Instant::now();
    let refused = loop {
        assert!(began.elapsed().as_secs() < 60, "no process is refused");
        if let Some(index) = both.iter_mut().position(|child| child.try_wait().unwrap().is_some()) {
            break index;
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    };
    let [first, second] = both;
    let (refused, mut other) = if refused == 0 { (first, second) } else { (second, first) };
    let refused = wait_for_output(refused);
    assert_eq!((refused.status, refused.stdout.as_str()), (Some(2), ""), "{}", refused.stderr);
    assert!(
        refused.stderr.starts_with("error: report: another wayfield process is writing in it; help: "),
        "{}",
        refused.stderr
    );
    wait_until(&mut other, "the other process works", || workspace.path("report/runs").exists());
    signal(&other, "TERM");
    let other = wait_for_output(other);
    assert!(other.stderr.contains("the same command continues from there"), "{}", other.stderr);
    assert!(workspace.json("report/spent.json")["wall_s"].as_f64().unwrap() > 0.0);
}

#[test]
fn a_report_that_cannot_be_replaced_is_reported_before_the_runs() {
    let workspace = workspace();
    let command = "--reproduce --experiment mine/own.ron --jobs 1 --seeds 1 --only times --out report";
    workspace.run_ok(command);
    let more = command.replace("--seeds 1", "--seeds 2");
    let runs = || fs::read_dir(workspace.path("report/runs")).unwrap().count();
    let before = runs();
    let rejected = |expected: &str| {
        let done = workspace.run(&more);
        assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{}", done.stderr);
        assert!(done.stderr.starts_with(&format!("error: report/{expected}")), "{}", done.stderr);
        assert_eq!(runs(), before, "a run was started");
    };
    for name in ["report.html", "README.md", "tables/times.csv"] {
        let set_readonly = |readonly: bool| {
            let mut permissions =
                fs::metadata(workspace.path(&format!("report/{name}"))).unwrap().permissions();
            permissions.set_readonly(readonly);
            fs::set_permissions(workspace.path(&format!("report/{name}")), permissions).unwrap();
        };
        set_readonly(true);
        rejected(&format!("{name}: can't be written: the file is read-only; help: "));
        set_readonly(false);
    }
    fs::remove_file(workspace.path("report/report.html")).unwrap();
    fs::create_dir(workspace.path("report/report.html")).unwrap();
    rejected("report.html: can't be written: this is a folder");
    fs::remove_dir(workspace.path("report/report.html")).unwrap();
    fs::remove_dir_all(workspace.path("report/figures")).unwrap();
    workspace.write("report/figures", "");
    rejected("figures: is not a folder");
    fs::remove_file(workspace.path("report/figures")).unwrap();
    workspace.run_ok(&more);
}

#[test]
fn invalid_options_and_files_are_rejected_with_a_fix() {
    let workspace = workspace();
    let rejected = |arguments: &str, needles: &[&str]| {
        let done = workspace.run(arguments);
        assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{arguments}: {}", done.stderr);
        for needle in needles {
            assert!(done.stderr.contains(needle), "{arguments}: no `{needle}` in {}", done.stderr);
        }
        assert!(!done.stderr.contains("panicked"), "{}", done.stderr);
    };
    rejected("--reproduce --only fig99", &["there is no `fig99`", "fig9", "table2", "ablation"]);
    rejected("--reproduce --only tabel2", &["did you mean `table2`?"]);
    rejected("--reproduce --experiment none.ron", &["none.ron", "no such file"]);
    rejected("--reproduce --seeds 0", &["--seeds", "a whole number from 1 to 1000"]);
    rejected("--reproduce --train", &["--train"]);
    rejected("--reproduce --seed 3", &["--seed"]);
    rejected("--train --only fig9", &["--only"]);
    rejected("--eval mine/own.ron --quick", &["--quick"]);
    // A folder with other files is not used.
    rejected("--reproduce --experiment mine/own.ron --out mine", &["mine", "holds no reproduction", "--out"]);
    assert_eq!(fs::read_dir(workspace.path("mine")).unwrap().count(), 2);

    // The message names the changed line, or the line where the changed value is used.
    let broken = |name: &str, (from, to): (&str, &str), needles: &[&str]| {
        let at = OWN.find(from).unwrap_or_else(|| panic!("{from} is in the file"));
        let line = 1 + OWN[..at].matches('\n').count();
        workspace.write(name, OWN.replacen(from, to, 1).replace("per.ron", "mine/per.ron"));
        let needles: Vec<String> =
            needles.iter().map(|needle| needle.replace("LINE", &line.to_string())).collect();
        let needles: Vec<&str> = needles.iter().map(String::as_str).collect();
        rejected(&format!("--reproduce --experiment {name} --out no"), &needles);
        assert!(!workspace.path("no").exists(), "{name}: no folder is created");
    };
    broken("a.ron", ("seeds: 2", "seeds: 0"), &["a.ron:LINE:", "seeds", "give 1 to 1000"]);
    broken("b.ron", ("smoothing: 5", "smoothnig: 5"), &["b.ron:LINE:", "did you mean `smoothing`?"]);
    broken(
        "c.ron",
        ("better: \"transferred\"", "better: \"transfered\""),
        &["c.ron:LINE:", "names \"transfered\"", "did you mean \"transferred\"?"],
    );
    broken(
        "d.ron",
        ("after: 20)", "after: 25)"),
        &["d.ron:LINE:", "is 25, but arm \"plain\" is trained for 24 episodes"],
    );
    broken("e.ron", ("name: \"dots\"", "name: \"../dots\""), &["e.ron:LINE:", "it becomes a file name"]);
    broken("f.ron", ("preset: \"per.ron\"", "preset: \"pre.ron\""), &["pre.ron", "no such file"]);
    broken("g.ron", ("double: false", "l_r_m: -1.0"), &["g.ron", "reward.l_r_m"]);
    broken("h.ron", ("EpisodesTo(1.0)", "EpisodesTo(0.0)"), &["h.ron:LINE:", "give 0.01 to 1000"]);
    broken("i.ron", ("name: \"all\"", "name: \"curves\""), &["i.ron", "two entries called \"curves\""]);
    broken("j.ron", ("budget: Episodes(24)", "budget: EnvSteps(900)"), &["j.ron", "policy: Best"]);
    broken(
        "k.ron",
        ("after: [8, 12]", "after: [8, 13]"),
        &["k.ron:LINE:", "is 13, but arm \"transferred\" is trained for 12 episodes"],
    );
    workspace.write("office.ron", "(name: \"Office\")");
    broken(
        "l.ron",
        (
            "(scenario: \"scenario-1\", preset: \"per.ron\", budget: Episodes(24)",
            "(scenario: \"office.ron\", preset: \"per.ron\", budget: Episodes(24)",
        ),
        &["l.ron: ", "Office, the scenario of arm \"plain\", has none", "help: write a `benchmark_route`"],
    );
    workspace.write("settings.ron", OWN.replace("per.ron", "mine/per.ron"));
    rejected("--reproduce --experiment settings.ron --out no", &["settings.ron", "rename the file"]);
}

#[test]
fn an_arm_can_be_tested_with_its_best_policy() {
    let workspace = workspace();
    workspace.write("fast.ron", quick_fast());
    workspace.write(
        "best.ron",
        r#"(
            title: "Best",
            seeds: 1,
            test: (rounds: 1, episodes: 4),
            arms: [(name: "fast", stages: [(scenario: "empty", preset: "fast.ron", budget: EnvSteps(3000))], policy: Best)],
            tables: [(name: "t", title: "T", show: Seeds(measure: Success, after: 1))],
        )"#,
    );
    let done = workspace.run_ok("--reproduce --experiment best.ron --out best");
    assert!(done.stdout.contains("(1 runs"), "{}", done.stdout);
    assert!(workspace.text("best/tables/t.md").contains("fast"));
}

/// All shipped experiments, in the quick version.
#[test]
fn the_quick_report_has_all_shipped_figures_and_tables() {
    let workspace = Workspace::new();
    workspace.run_ok("--reproduce --quick");
    let html = workspace.text("runs/reproduce-quick/report.html");
    assert!(html.contains("quick report"), "the report warns that it is quick");
    for name in ["fig8", "fig9", "fig10", "ablation", "course"] {
        let png = workspace.read(&format!("runs/reproduce-quick/figures/{name}.png"));
        assert!(png.starts_with(b"\x89PNG") && png.len() > 10_000, "{name}.png is a PNG");
        assert!(workspace.text(&format!("runs/reproduce-quick/figures/{name}.svg")).contains("</svg>"));
    }
    for name in ["table2", "table3-4", "table5", "table6-7", "conditions", "transfer-in-ii", "best-success"] {
        let path = workspace.path(&format!("runs/reproduce-quick/tables/{name}.csv"));
        assert!(csv::Reader::from_path(path).unwrap().records().count() >= 2, "{name}.csv has rows");
    }
}
