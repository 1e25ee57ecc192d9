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

use serde_json::Value;

use cli_support::{Workspace, quick_fast, quick_per, signal, wait_for_output, wait_until};
use wayfield::reproduce::experiment::Experiment;
use wayfield::run::shipped;

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
            stages: [(scenario: "scenario-1", preset: "per.ron", budget: Episodes(24), overrides: {"learning.double": false})],
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
                (statement: "Transfer helps", measure: Return, better: "transferred", than: "plain", after: Episodes(24)),
            ],
        ),
        (name: "dots", title: "Dots", draw: DotPlot(measures: [Success, EpisodesTo(1.0)], after: Episodes(20))),
        (name: "course", title: "Course", draw: BenchmarkRoute(after: Episodes(24))),
    ],
    tables: [
        (
            name: "times",
            aliases: ["clock"],
            title: "Times",
            show: Seeds(measure: BenchmarkRouteTime, after: Episodes(24), paper: [("plain", 13.155)]),
        ),
        (name: "rounds", title: "Rounds", show: Rounds(after: Episodes(24), paper: [("plain", [83.0, 86.0])])),
        (name: "all", title: "All", show: Measures(measures: [Success, MeanTime, TimeRatio], after: Episodes(24))),
        (
            name: "which",
            title: "Which",
            show: Contrast(measures: [Success], better: "transferred", than: "plain", after: [Episodes(8), Episodes(12)], of_last_stage: true),
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

/// Turns a report's folder into one of an earlier version, which did not record what the report shows. Any report may replace it.
fn forget_contents(workspace: &Workspace, folder: &str) {
    workspace.write(&format!("{folder}/spent.json"), r#"{"wall_s": 0.0}"#);
}

/// The time at which each training run finished. A stopped run has a summary, too, but is not finished.
fn finished_at(root: &Path) -> BTreeMap<PathBuf, std::time::SystemTime> {
    let runs = fs::read_dir(root.join("runs")).unwrap();
    let summaries = runs.map(|run| run.unwrap().path().join("summary.json"));
    let is_finished =
        |summary: &PathBuf| fs::read_to_string(summary).is_ok_and(|text| text.contains("\"finished\": true"));
    summaries
        .filter(is_finished)
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

    // A program of the same version from another commit repeats no run either.
    for run in run_names(&workspace, "one") {
        let file = format!("one/runs/{run}/config.ron");
        let text = workspace.text(&file);
        let lines: Vec<&str> =
            text.lines().filter(|line| !line.trim_start().starts_with("commit:")).collect();
        workspace
            .write(&file, lines.join("\n").replacen("seed:", "commit: Some(\"0000000\"),\n    seed:", 1));
    }
    workspace.run_ok("--reproduce --experiment mine/own.ron --out one");
    assert_eq!(finished_at(&workspace.path("one")), before, "no run was repeated");

    // A setting from the command line is recorded in all runs, and gives other runs.
    workspace.run_ok("--reproduce --experiment mine/own.ron --out set --only all --set learning.gamma=0.5");
    let others = run_names(&workspace, "one");
    for run in run_names(&workspace, "set") {
        let config = workspace.text(&format!("set/runs/{run}/config.ron"));
        assert!(config.contains("gamma: 0.5,") && !others.contains(&run), "{run}: {config}");
    }

    // A part of the experiment must not replace all of it.
    let done = workspace.run("--reproduce --experiment mine/own.ron --out one --only clock");
    let message = "error: one: holds a full report with more than --only names: all, course, curves, dots, rounds, which; help: ";
    assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{}", done.stderr);
    assert!(done.stderr.starts_with(message), "{}", done.stderr);
    assert!(report(&workspace, "one") == one, "the report is as it was");

    // A part of the experiment needs no new runs.
    forget_contents(&workspace, "one");
    let done = workspace.run_ok("--reproduce --experiment mine/own.ron --out one --only clock --json");
    let json = done.json();
    assert_eq!((json["runs"].as_u64(), json["claims"].as_array().unwrap().len()), (Some(6), 0));
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

    // A run in which another process is writing is left alone.
    let mut runs = fs::read_dir(workspace.path("stopped/runs")).unwrap().map(|run| run.unwrap().path());
    let begun = runs.find(|run| run.join("checkpoint/latest.bin").exists()).unwrap();
    let lock = fs::File::create(begun.join("checkpoint/lock")).unwrap();
    lock.lock().unwrap();
    let done = workspace.run(&format!("{arguments} stopped"));
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    assert!(done.stderr.contains("another wayfield process is writing in it"), "{}", done.stderr);
    assert!(begun.join("checkpoint/latest.bin").exists(), "its checkpoint is kept");
    drop(lock);

    // The stopped run continues from its checkpoint; a run without a checkpoint is repeated.
    let mut child = workspace.start(&format!("{arguments} stopped"));
    wait_until(&mut child, "a run is finished and the next one has a checkpoint", || {
        let finished = finished_at(&workspace.path("stopped"));
        let mut runs = fs::read_dir(workspace.path("stopped/runs")).unwrap().map(|run| run.unwrap().path());
        let is_next = |run: PathBuf| {
            run.join("checkpoint/latest.bin").exists() && !finished.contains_key(&run.join("summary.json"))
        };
        !finished.is_empty() && runs.any(is_next)
    });
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
    forget_contents(&workspace, "before");
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

/// Aborts the process once after each file that it writes, and once after each that it replaces.
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
            forget_contents(&workspace, "report");
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
    workspace.write("mine/own.ron", OWN.replace("budget: Episodes(24)", "budget: Episodes(5000)"));
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

/// The folders of the runs in a report's folder, by name.
fn run_names(workspace: &Workspace, folder: &str) -> Vec<String> {
    let runs = fs::read_dir(workspace.path(folder).join("runs")).unwrap();
    let mut names: Vec<String> = runs.map(|run| run.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn parts_trained_apart_give_the_report_of_one_machine() {
    let workspace = workspace();
    let command = "--reproduce --experiment mine/own.ron --jobs 1 --out";
    workspace.run_ok(&format!("{command} alone"));

    // Each part in a folder of its own, as on machines that share no files.
    for number in 1..=2 {
        let done = workspace.run_ok(&format!("{command} part-{number} --shard {number}/2"));
        let expected = format!("part {number}/2    part-{number} (3 runs, ");
        assert!(done.stdout.starts_with(&expected) && done.stdout.lines().count() == 1, "{}", done.stdout);
        assert!(!workspace.path(&format!("part-{number}/report.html")).exists(), "a part writes no report");
    }
    workspace.shell("mkdir merged; cp -r part-1/. part-2/. merged");
    assert_eq!(run_names(&workspace, "merged"), run_names(&workspace, "alone"));
    for run in run_names(&workspace, "merged") {
        workspace.assert_same_run(&format!("alone/runs/{run}"), &format!("merged/runs/{run}"));
    }

    // One of the runs comes from another kind of processor.
    let run = &run_names(&workspace, "merged")[0];
    workspace.write(&format!("merged/runs/{run}/processors.json"), "[\"Other <CPU>\"]");
    let before = finished_at(&workspace.path("merged"));
    workspace.run_ok(&format!("{command} merged"));
    assert_eq!(finished_at(&workspace.path("merged")), before, "no run was repeated");
    assert!(report(&workspace, "merged") == report(&workspace, "alone"), "the same figures and tables");
    let page = workspace.text("merged/report.html");
    assert!(
        page.contains("5 runs on ") && page.contains("1 run on Other &lt;CPU&gt;"),
        "both kinds are named"
    );
    assert!(
        page.contains("a run gives the same bits only on the same kind of processor"),
        "the page explains why the kind matters"
    );
    let page = workspace.text("alone/report.html");
    assert!(page.contains("6 runs on ") && !page.contains("only on the same kind"), "one kind of processor");
}

#[test]
fn a_folder_in_use_by_a_part_admits_other_parts_but_neither_that_part_nor_the_report() {
    let workspace = workspace();
    let command = "--reproduce --experiment mine/own.ron --jobs 1 --out shared";
    fs::create_dir(workspace.path("shared")).unwrap();
    let lock = |name: &str| fs::File::create(workspace.path("shared").join(name)).unwrap();
    let (all, first) = (lock("lock"), lock("lock-1-of-2"));
    all.lock_shared().unwrap();
    first.lock().unwrap();
    for refused in ["", " --shard 1/2"] {
        let done = workspace.run(&format!("{command}{refused}"));
        assert_eq!(done.status, Some(2), "{}", done.stderr);
        assert!(done.stderr.contains("shared: another wayfield process is writing in it"), "{}", done.stderr);
    }
    let part = workspace.run_ok(&format!("{command} --shard 2/2 --json")).json();
    assert_eq!((&part["report"], &part["shard"], &part["runs"]), (&Value::Null, &"2/2".into(), &3.into()));
    drop((all, first));
    workspace.run_ok(&format!("{command} --shard 1/2"));
    let done = workspace.run_ok(command);
    assert!(done.stderr.contains("6 of 6 runs"), "{}", done.stderr);
    assert!(done.stdout.contains("shared/report.html (6 runs"), "{}", done.stdout);
    let spent = |name: &str| workspace.json(&format!("shared/{name}.json"))["wall_s"].as_f64().unwrap();
    assert!(spent("spent-1-of-2") > 0.0 && spent("spent-2-of-2") > 0.0, "the time of both parts is known");
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
    rejected(
        "--reproduce --only conditions --seeds 1000",
        &["--seeds", "28000 training runs", "at most 10000"],
    );
    rejected("--reproduce --shard 3/2", &["--shard", "give K/N, such as 2/8"]);
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
        ("after: Episodes(20))", "after: Episodes(25))"),
        &["d.ron:LINE:", "is 25, but arm \"plain\" is trained for 24 episodes"],
    );
    broken("e.ron", ("name: \"dots\"", "name: \"../dots\""), &["e.ron:LINE:", "it becomes a file name"]);
    broken("f.ron", ("preset: \"per.ron\"", "preset: \"pre.ron\""), &["pre.ron", "no such file"]);
    let overrides = "\"learning.double\": false";
    broken(
        "g.ron",
        (overrides, "\"reward.l_r_m\": -1.0"),
        &["g.ron", "arm \"plain\"", "reward.l_r_m=-1.0: "],
    );
    broken(
        "m.ron",
        (overrides, "\"learning.gama\": 0.9"),
        &["m.ron", "learning.gama=0.9: unknown field `gama`", "did you mean `gamma`?"],
    );
    broken(
        "n.ron",
        ("    figures: [", "    conditions: [(name: \"c\", only_arms: [\"plane\"])],\n    figures: ["),
        &["n.ron:LINE:", "names \"plane\"", "did you mean \"plain\"?"],
    );
    broken("h.ron", ("EpisodesTo(1.0)", "EpisodesTo(0.0)"), &["h.ron:LINE:", "give 0.01 to 1000"]);
    broken("i.ron", ("name: \"all\"", "name: \"curves\""), &["i.ron", "two entries called \"curves\""]);
    broken("j.ron", ("budget: Episodes(24)", "budget: EnvSteps(900)"), &["j.ron", "policy: Best"]);
    broken(
        "k.ron",
        ("Episodes(8), Episodes(12)]", "Episodes(8), Episodes(13)]"),
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
            tables: [(name: "t", title: "T", show: Seeds(measure: Success))],
        )"#,
    );
    let done = workspace.run_ok("--reproduce --experiment best.ron --out best");
    assert!(done.stdout.contains("(1 run,"), "{}", done.stdout);
    assert!(workspace.text("best/tables/t.md").contains("fast"));
}

#[test]
fn arms_can_be_compared_before_their_first_step_and_right_after_a_transfer() {
    let workspace = workspace();
    workspace.write("fast.ron", quick_fast());
    let text = r#"(
        title: "Starts",
        seeds: 2,
        test: (rounds: 1, episodes: 4),
        arms: [
            (name: "scratch", stages: [(scenario: "empty", preset: "fast.ron", budget: EnvSteps(1600))]),
            (name: "transferred", stages: [
                (scenario: "empty", preset: "fast.ron", budget: EnvSteps(1600)),
                (scenario: "scenario-1", preset: "fast.ron", budget: EnvSteps(1600), epsilon: 0.5),
            ]),
            (name: "not compared", stages: [(scenario: "hall", preset: "fast.ron", budget: EnvSteps(160))]),
        ],
        tables: [(
            name: "end",
            title: "End",
            show: Contrast(measures: [Success], better: "transferred", than: "scratch"),
        ), (
            name: "start",
            title: "Start",
            show: Contrast(measures: [Success, SuccessRate], better: "transferred", than: "scratch", after: [EnvSteps(0)], of_last_stage: true),
            claims: [(statement: "A jump start", measure: SuccessRate, better: "transferred", than: "scratch", after: EnvSteps(0), of_last_stage: true)],
        )],
    )"#;
    workspace.write("starts.ron", text);
    let done = workspace.run_ok("--reproduce --experiment starts.ron --out starts");
    let message = "an arm that is not compared is not trained";
    assert!(done.stdout.contains("starts/report.html (4 runs"), "{message}: {}", done.stdout);
    let page = workspace.text("starts/README.md");
    let claim = "Success in evaluations during training after 0 env steps of the last stage: transferred ";
    assert!(page.contains(claim), "{page}");
    let data = "unequal data (means over the seeds): scratch 1,600 env steps in ";
    assert!(page.contains(data), "{page}");
    let runs = fs::read_dir(workspace.path("starts/runs")).unwrap().map(|run| run.unwrap().path());
    let initial = runs.filter(|run| run.join("policy-after-0-env-steps.safetensors").exists());
    assert_eq!(initial.count(), 4, "of two seeds, from scratch and after the transfer");

    workspace.write("starts.ron", text.replace("[Success, SuccessRate]", "[Success, Return]"));
    let done = workspace.run("--check starts.ron");
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    let problem = "is 0, where no episode has ended, so that \"Return\" has no value; help: give at least 1";
    assert!(done.stderr.contains(problem), "{}", done.stderr);
}

/// A user's experiment over env steps: arms with different numbers of arenas, chosen seeds, a success rate, and an arm whose
/// runs were trained elsewhere.
const OVER_STEPS: &str = r#"(
    title: "Arenas",
    seeds: [3, 17],
    evaluation: (every_env_steps: 500, episodes: 4),
    test: (rounds: 1, episodes: 4),
    arms: [
        (name: "one", stages: [(scenario: "empty", preset: "per.ron", budget: EnvSteps(2000))]),
        (name: "sixteen", stages: [(scenario: "empty", preset: "fast.ron", budget: EnvSteps(2000))]),
        (name: "elsewhere", runs: ["runs/a", "runs/b"]),
    ],
    figures: [
        (
            name: "curves",
            title: "Curves",
            draw: LearningCurves(series: [Return, SuccessRate], smoothing: 10),
            claims: [
                (statement: "Sixteen is better", measure: Return, better: "sixteen", than: "one", after: EnvSteps(1500)),
                (statement: "It succeeds", measure: Success, better: "sixteen", than: "one", after: EnvSteps(1500)),
                (statement: "It succeeds while it learns", measure: SuccessRate, better: "sixteen", than: "one", after: EnvSteps(1500)),
                (statement: "It begins better", measure: SuccessRate, better: "sixteen", than: "one", after: EnvSteps(0)),
            ],
        ),
        (name: "dots", title: "Dots", draw: DotPlot(measures: [Success, Return])),
    ],
    tables: [
        (name: "ends", title: "Ends", show: Seeds(measure: Success)),
        (name: "beginnings", title: "Beginnings", show: Seeds(measure: SuccessRate, after: EnvSteps(0))),
        (name: "rates", title: "Rates", show: Seeds(measure: SuccessRate, after: EnvSteps(1500))),
        (
            name: "steps",
            title: "Steps",
            show: Contrast(measures: [Return], better: "sixteen", than: "elsewhere", after: [EnvSteps(1000), EnvSteps(2000)]),
            claims: [(statement: "Trained elsewhere is worse", measure: Success, better: "one", than: "elsewhere")],
        ),
    ],
)
"#;

/// A workspace with [`OVER_STEPS`] in the folder `mine`, and the finished runs that it names.
fn over_steps() -> Workspace {
    let workspace = workspace();
    workspace.write("mine/steps.ron", OVER_STEPS);
    workspace.write("mine/fast.ron", quick_fast());
    for (name, seed) in [("a", 3), ("b", 17)] {
        let out = format!("--out mine/runs/{name} --seed {seed}");
        workspace.run_ok(&format!("--train --scenario empty --preset mine/per.ron --steps 2000 {out}"));
    }
    workspace
}

/// The files of a folder and their contents.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let paths =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_file());
    paths.map(|path| (path.clone(), fs::read(&path).unwrap())).collect()
}

#[test]
fn arms_are_compared_over_env_steps_and_with_runs_that_were_trained_elsewhere() {
    let workspace = over_steps();
    let run = files(&workspace.path("mine/runs/a"));
    let done = workspace.run_ok("--reproduce --experiment mine/steps.ron --out report");
    assert!(done.stdout.contains("report/report.html (6 runs"), "{}", done.stdout);
    assert_eq!(files(&workspace.path("mine/runs/a")), run, "the runs from elsewhere are as they were");

    let page = workspace.text("report/README.md");
    for text in [
        "n = 2 says little: a 95 % interval is 12.7 standard errors",
        "Over env steps, because the training runs differ in the number of arenas.",
        "Return after 1,500 env steps (mean of the last 10 episodes): sixteen ",
        "Success in evaluations during training after 1,500 env steps: sixteen ",
        "Success in evaluations during training after 0 env steps: sixteen ",
        "Claims about \"Success\" are about the test after training",
        "(paired by seed)",
        "Equal data (means over the seeds): one 2,000 env steps in ",
        "| Seed 3 | Seed 17 |",
        "Trained elsewhere",
    ] {
        assert!(page.contains(text), "`{text}` is not in the page:\n{page}");
    }
    let saved = |run: &Path| run.join("policy-after-1500-env-steps.safetensors").exists();
    let runs = fs::read_dir(workspace.path("report/runs"))
        .unwrap()
        .filter(|run| saved(&run.as_ref().unwrap().path()));
    assert_eq!(runs.count(), 4, "two arms with two seeds are tested after 1,500 env steps");
    let curves = workspace.text("report/figures/curves.svg");
    assert!(curves.contains("Success in evaluations during training") && curves.contains("env steps"));

    // The same training here and elsewhere gives the same policy.
    let rows = |path: &str| -> Vec<csv::StringRecord> {
        csv::Reader::from_path(workspace.path(path)).unwrap().into_records().map(Result::unwrap).collect()
    };
    let ends = rows("report/tables/ends.csv");
    let values = |row: usize| ends[row].iter().skip(1).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(values(0), values(2), "one, and elsewhere");

    // A claim below the curve has the curve's numbers: those of the evaluations.
    for (table, env_steps) in [("beginnings", "0"), ("rates", "1500")] {
        let evaluations = rows("mine/runs/a/evaluations.csv");
        let evaluation = evaluations.iter().find(|row| &row[0] == env_steps).unwrap();
        let rate: f64 = evaluation[3].parse().unwrap();
        let shown: f64 = rows(&format!("report/tables/{table}.csv"))[2][1].parse().unwrap();
        assert_eq!(shown, 100.0 * rate, "{table}");
    }

    // Other seeds on the command line.
    let done =
        workspace.run_ok("--reproduce --experiment mine/steps.ron --only ends --seeds 4, --out other --json");
    let json = done.json();
    assert_eq!(json["runs"].as_u64(), Some(4), "two arms with one seed, and two runs from elsewhere");
    assert!(workspace.text("other/tables/ends.md").contains("| Seed 3 | Seed 4 | Seed 17 |"));
}

#[test]
fn a_report_says_that_the_training_before_a_transfer_elsewhere_is_not_counted() {
    let workspace = over_steps();
    let transfer = "--init mine/runs/a/policy.safetensors --seed 3 --out mine/runs/c";
    workspace.run_ok(&format!("--train --scenario empty --preset mine/per.ron --steps 2000 {transfer}"));
    workspace.write(
        "mine/transfer.ron",
        r#"(
            title: "Transfer",
            test: (rounds: 1, episodes: 1),
            arms: [(name: "scratch", runs: ["runs/a"]), (name: "transferred", runs: ["runs/c"])],
            tables: [(name: "ends", title: "Ends", show: Seeds(measure: Success))],
        )"#,
    );
    workspace.run_ok("--reproduce --experiment mine/transfer.ron --out report");
    let page = workspace.text("report/README.md");
    let note = "Runs of transferred started from a trained policy, whose training is not counted.";
    assert!(page.contains(note) && !page.contains("Runs of scratch"), "{page}");
    assert!(page.contains("in 1 round of 1 episode that"), "{page}");
    assert!(page.contains("2: 4,000 env steps in "), "the training runs' env steps are counted:\n{page}");
}

#[test]
fn the_notes_of_a_table_are_only_about_arms_that_are_compared() {
    let workspace = over_steps();
    workspace.write(
        "mine/best.ron",
        r#"(
            title: "Best",
            seeds: [4],
            test: (rounds: 1, episodes: 1),
            arms: [
                (name: "last", runs: ["runs/a", "runs/b"]),
                (name: "best", runs: ["runs/a", "runs/b"], policy: Best),
                (name: "not compared", stages: [(scenario: "empty", preset: "per.ron")], policy: Best),
            ],
            tables: [(name: "t", title: "T", show: Contrast(measures: [Success], better: "best", than: "last"))],
        )"#,
    );
    workspace.run_ok("--reproduce --experiment mine/best.ron --out report");
    let page = workspace.text("report/README.md");
    assert!(page.contains("seeds 3, 17; ") && page.contains("n = 2)"), "{page}");
    assert!(page.contains("best: the best policy of its training"), "{page}");
    assert!(!page.contains("not compared: the best policy"), "{page}");
}

#[test]
fn runs_from_elsewhere_that_do_not_fit_are_rejected_with_a_fix() {
    let workspace = over_steps();
    let train = |name: &str, arguments: &str| {
        workspace.run_ok(&format!("--train --preset mine/per.ron --out mine/runs/{name} {arguments}"));
    };
    train("world", "--scenario u-trap --steps 2000 --seed 5");
    train("longer", "--scenario empty --steps 2500 --seed 5");
    train("twin", "--scenario empty --steps 2000 --seed 3");
    let rejected = |(from, to): (&str, &str), needles: &[&str]| {
        assert!(OVER_STEPS.contains(from), "{from}");
        workspace.write("mine/broken.ron", OVER_STEPS.replacen(from, to, 1));
        let done = workspace.run("--reproduce --experiment mine/broken.ron --out no");
        assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{to}: {}", done.stderr);
        for needle in needles {
            assert!(done.stderr.contains(needle), "{to}: no `{needle}` in {}", done.stderr);
        }
        assert!(!workspace.path("no").exists(), "{to}: no folder is created");
    };
    rejected(
        ("runs/b", "runs/none"),
        &["runs/none: holds no run", "help: give the folder of a finished run"],
    );
    rejected(
        ("runs/b", "runs/world"),
        &[
            "mine/runs/world: is a run in \"U-trap\", but mine/runs/a is one in \"Empty\"",
            "an arm of its own",
        ],
    );
    rejected(("runs/b", "runs/longer"), &["mine/runs/longer: has different settings from mine/runs/a"]);
    rejected(("runs/b", "runs/twin"), &["mine/runs/twin: has the same seed as mine/runs/a: 3"]);
    rejected(
        ("[\"runs/a\", \"runs/b\"]", "[\"runs/world\"]"),
        &["arm \"one\" is compared with \"elsewhere\"", "in different scenarios: \"Empty\" and \"U-trap\""],
    );
    rejected(
        ("show: Seeds(measure: Success)", "show: Seeds(measure: Success, after: EnvSteps(1500))"),
        &["mine/runs/a: has no policy after 1,500 env steps", "leave `after` out", "policy: Best"],
    );
    rejected(
        ("after: EnvSteps(1500)", "after: EnvSteps(2500)"),
        &["mine/broken.ron:", "is 2500, but arm \"one\" is trained for 2000 env steps"],
    );
    rejected(
        ("after: EnvSteps(1500)", "after: Episodes(15)"),
        &[
            "mine/broken.ron:",
            "is a number of episodes, but arm \"one\" is trained for a number of env steps",
        ],
    );
    rejected(
        ("after: EnvSteps(1500)", "after: 15"),
        &["mine/broken.ron:", "must be one of the choices", "`Episodes`", "`EnvSteps`"],
    );
    rejected(
        ("figures: [", "conditions: [(name: \"x\")],\n    figures: ["),
        &["mine/broken.ron:", "are finished, so conditions and overrides cannot change \"elsewhere\""],
    );
    rejected(("[3, 17]", "[3, 17, 3]"), &["mine/broken.ron:", "has 3 twice"]);
    rejected(("[3, 17]", "\"3\""), &["mine/broken.ron:", "a number of seeds, such as 5, or a list"]);
    let done = workspace.run("--reproduce --experiment mine/steps.ron --quick --out no");
    assert_eq!(done.status, Some(2));
    assert!(done.stderr.contains("arm \"elsewhere\" has finished runs"), "{}", done.stderr);
    let finished = r#"(
        title: "Finished",
        arms: [(name: "elsewhere", runs: ["runs/a"])],
        tables: [(name: "seeds", title: "Seeds", show: Seeds(measure: Success))],
    )"#;
    workspace.write("mine/finished.ron", finished);
    let done = workspace.run("--reproduce --experiment mine/finished.ron --seeds 2 --out no");
    assert_eq!(done.status, Some(2));
    let needle = "mine/finished.ron: --seeds chooses the seeds of training runs, but all arms have finished runs; help: ";
    assert!(done.stderr.contains(needle), "{}", done.stderr);

    workspace.write(
        "mine/late.ron",
        r#"(
            title: "Late",
            arms: [(name: "elsewhere", runs: ["runs/a"])],
            tables: [(name: "ends", title: "Ends", show: Seeds(measure: Success, after: EnvSteps(2500)))],
        )"#,
    );
    let done = workspace.run("--reproduce --experiment mine/late.ron --out no");
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    let message =
        "arm \"elsewhere\" after 2,500 env steps, but one of its runs is shorter; help: leave `after` out";
    assert!(done.stderr.contains(message), "{}", done.stderr);

    // A run that was killed after it had been resumed with a larger budget, and one that was stopped.
    let summary = workspace.text("mine/runs/b/summary.json");
    let env_steps = workspace.json("mine/runs/b/summary.json")["env_steps"].as_u64().unwrap();
    let shorter = summary.replace(&format!("\"env_steps\": {env_steps}"), "\"env_steps\": 16");
    for unfinished in [shorter, summary.replace("\"finished\": true", "\"finished\": false")] {
        assert_ne!(unfinished, summary);
        workspace.write("mine/runs/b/summary.json", unfinished);
        let done = workspace.run("--reproduce --experiment mine/steps.ron --out no");
        assert_eq!(done.status, Some(2));
        assert!(
            done.stderr.contains("mine/runs/b: this run is not finished; help: finish it with --resume"),
            "{}",
            done.stderr
        );
    }
}

#[test]
fn a_quick_report_never_replaces_a_full_one() {
    let workspace = workspace();
    let command = "--reproduce --experiment mine/own.ron --only times --out report";
    workspace.run_ok(&format!("{command} --seeds 1"));
    let full = whole_report(&workspace, "report");
    let done = workspace.run(&format!("{command} --quick"));
    assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{}", done.stderr);
    assert!(
        done.stderr
            .starts_with("error: report: holds a full reproduction, which --quick would overwrite; help: "),
        "{}",
        done.stderr
    );
    assert!(whole_report(&workspace, "report") == full, "the full report is as it was");

    // A full report may replace a quick one, and is then kept.
    workspace.run_ok(&format!("{command} --quick").replace("--out report", "--out sketch"));
    workspace.run_ok(&format!("{command} --seeds 1").replace("--out report", "--out sketch"));
    let done = workspace.run(&format!("{command} --quick").replace("--out report", "--out sketch"));
    assert_eq!(done.status, Some(2), "{}", done.stderr);
}

#[test]
fn a_full_report_is_never_replaced_by_one_of_other_experiments_or_fewer_seeds() {
    let workspace = workspace();
    workspace.write("mine/other.ron", OWN);
    fs::create_dir(workspace.path("twin")).unwrap();
    workspace.write("twin/own.ron", OWN.replace("per.ron", "../mine/per.ron"));
    let command = "--reproduce --experiment mine/own.ron --only times";
    workspace.run_ok(command);
    let folder = "runs/reproduce-own";
    let full = whole_report(&workspace, folder);
    for (refused, message) in [
        (
            format!("{command} --seeds 1"),
            "holds a full report with 2 seeds of own, which one with 1 would replace",
        ),
        (
            format!("--reproduce --experiment mine/other.ron --out {folder}"),
            "own.ron, which this one would replace",
        ),
        ("--reproduce --experiment twin/own.ron".to_owned(), "own.ron, which this one would replace"),
        (format!("--reproduce --out {folder}"), "own.ron, which this one would replace"),
    ] {
        let done = workspace.run(&refused);
        assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{refused}: {}", done.stderr);
        assert!(done.stderr.contains(message), "{refused}: {}", done.stderr);
        assert!(done.stderr.contains("help: choose another folder with --out"), "{refused}: {}", done.stderr);
        assert!(whole_report(&workspace, folder) == full, "{refused}: the report is as it was");
    }
    // More seeds may replace it, and so may the same experiment after its folder was moved.
    workspace.run_ok(&format!("{command} --seeds 3"));
    fs::rename(workspace.path("mine"), workspace.path("moved")).unwrap();
    workspace.run_ok("--reproduce --experiment moved/own.ron --only times --seeds 3");
}

/// All shipped experiments, in the quick version.
#[test]
fn the_quick_report_has_all_shipped_figures_and_tables() {
    let workspace = Workspace::new();
    workspace.run_ok("--reproduce --quick");
    let html = workspace.text("runs/reproduce-quick/report.html");
    assert!(html.contains("quick report"), "the report warns that it is quick");
    for (from, text) in shipped::experiments() {
        let experiment = Experiment::parse(text, from).unwrap();
        for name in experiment.figures.iter().map(|figure| &figure.name) {
            let png = workspace.read(&format!("runs/reproduce-quick/figures/{name}.png"));
            assert!(png.starts_with(b"\x89PNG") && png.len() > 10_000, "{name}.png is a PNG");
            assert!(workspace.text(&format!("runs/reproduce-quick/figures/{name}.svg")).contains("</svg>"));
        }
        for name in experiment.tables.iter().map(|table| &table.name) {
            let path = workspace.path(&format!("runs/reproduce-quick/tables/{name}.csv"));
            assert!(csv::Reader::from_path(path).unwrap().records().count() >= 2, "{name}.csv has rows");
        }
    }
}
