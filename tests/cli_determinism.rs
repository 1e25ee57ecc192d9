//! Tests of determinism on the command line: runs with the same seed are byte-identical, and a run that was
//! stopped (by its budget, Ctrl-C or SIGKILL) resumes to the result of an uninterrupted run.

mod cli_support;

use cli_support::{
    SCENARIO_1, SCENARIO_2, Workspace, edited, noisy, quick_fast, quick_per, raw, signal, wait_for_output,
    wait_until, with_short_episodes,
};

/// A workspace with the presets and scenarios of these tests.
fn workspace() -> Workspace {
    let workspace = Workspace::new();
    workspace.write("per.ron", quick_per());
    workspace.write("fast.ron", quick_fast());
    workspace.write("one.ron", with_short_episodes(SCENARIO_1));
    workspace.write("two.ron", with_short_episodes(SCENARIO_2));
    workspace.write("noisy.ron", noisy(SCENARIO_2));
    workspace
}

/// Asserts that runs with the same scenario, preset and seed are identical, and that another seed gives
/// another run.
fn assert_repeats(what: &str) {
    let workspace = workspace();
    workspace.run_ok(&format!("--train {what} --seed 3 --out a"));
    workspace.run_ok(&format!("--train {what} --seed 3 --out b"));
    workspace.run_ok(&format!("--train {what} --seed 4 --out c"));
    workspace.assert_same_run("a", "b");
    let (a, c) = (workspace.run_contents("a"), workspace.run_contents("c"));
    assert_ne!(a.episodes, c.episodes, "another seed gives other episodes");
    assert_ne!(a.evaluations, c.evaluations, "another seed gives other evaluations");
    assert!(a.last != c.last && a.best != c.best, "another seed gives other policies");
    assert!(a.summary["gradient_steps"].as_u64().unwrap() > 1000, "the run is too short to prove anything");
}

#[test]
fn runs_with_prioritized_replay_in_one_arena_are_bit_identical() {
    assert_repeats("--scenario one.ron --preset per.ron --steps 5000");
}

#[test]
fn runs_with_the_default_algorithm_in_16_arenas_are_bit_identical() {
    assert_repeats("--scenario noisy.ron --preset fast.ron --steps 10000");
}

/// Asserts that a run with the `whole` budget equals one with the `half` budget that is resumed to the whole.
fn assert_resumes(what: &str, half: &str, whole: &str) {
    let workspace = workspace();
    workspace.run_ok(&format!("--train {what} --seed 5 {whole} --out straight"));
    workspace.run_ok(&format!("--train {what} --seed 5 {half} --out halves"));
    assert_ne!(workspace.run_contents("straight").episodes, workspace.run_contents("halves").episodes);
    workspace.run_ok(&format!("--train --resume halves {whole}"));
    workspace.assert_same_run("straight", "halves");
}

#[test]
fn a_run_of_150_episodes_resumed_to_300_equals_a_run_of_300() {
    assert_resumes("--scenario one.ron --preset per.ron", "--episodes 150", "--episodes 300");
}

#[test]
fn a_run_with_two_step_returns_in_16_arenas_resumes_bit_identically() {
    // 5200 is between two evaluations, and n-step returns and schedules are in progress.
    assert_resumes("--scenario one.ron --preset fast.ron", "--steps 5200", "--steps 10000");
}

#[test]
fn runs_with_moving_obstacles_and_lidar_noise_resume_bit_identically() {
    assert_resumes("--scenario two.ron --preset per.ron", "--episodes 31", "--episodes 60");
    assert_resumes("--scenario noisy.ron --preset fast.ron", "--episodes 45", "--episodes 90");
}

#[test]
fn a_run_with_actuator_lag_resumes_bit_identically() {
    let workspace = workspace();
    workspace.write(
        "lag.ron",
        edited(&noisy(SCENARIO_2), &[("    lidar: (", "    robot: (actuator_lag_s: 0.3),\n    lidar: (")]),
    );
    workspace.run_ok("--train --scenario lag.ron --preset fast.ron --seed 5 --steps 6000 --out straight");
    workspace.run_ok("--train --scenario lag.ron --preset fast.ron --seed 5 --steps 3100 --out halves");
    workspace.run_ok("--train --resume halves --steps 6000");
    workspace.assert_same_run("straight", "halves");
    workspace.run_ok("--train --scenario noisy.ron --preset fast.ron --seed 5 --steps 6000 --out no-lag");
    assert_ne!(
        workspace.run_contents("straight").episodes,
        workspace.run_contents("no-lag").episodes,
        "the lag changes the run"
    );
}

#[test]
fn a_run_with_values_drawn_from_ranges_resumes_bit_identically() {
    let workspace = workspace();
    let ranges = "    robot: (actuator_lag_s: (0.0, 0.3), max_acceleration_m_s2: 0.5, slip: (forward: (0.0, 0.1), turning: 0.0, std: 0.02), \
                  odometry_drift: (distance_error: (-0.05, 0.05), rotation_error: (-0.05, 0.05), heading_drift_rad_m: 0.1)),\n    lidar: (latency_steps: (0, 3), ";
    let text =
        edited(&noisy(SCENARIO_2), &[("    lidar: (", ranges), ("dropout: 0.05", "dropout: (0.0, 0.1)")]);
    assert!(text.contains("speed_rad_s: 0.15"), "{text}");
    workspace.write("ranges.ron", text.replace("speed_rad_s: 0.15", "speed_rad_s: (0.0, 0.2)"));
    workspace.run_ok("--train --scenario ranges.ron --preset fast.ron --seed 5 --steps 6000 --out straight");
    workspace.run_ok("--train --scenario ranges.ron --preset fast.ron --seed 5 --steps 3100 --out halves");
    workspace.run_ok("--train --resume halves --steps 6000");
    workspace.assert_same_run("straight", "halves");
}

#[test]
fn a_run_with_raw_observations_resumes_bit_identically() {
    let workspace = workspace();
    workspace.write("raw.ron", raw(&quick_fast()));
    let what = "--train --scenario one.ron --preset raw.ron --seed 5";
    workspace.run_ok(&format!("{what} --steps 6000 --out straight"));
    workspace.run_ok(&format!("{what} --steps 3100 --out halves"));
    workspace.run_ok("--train --resume halves --steps 6000");
    workspace.assert_same_run("straight", "halves");
}

#[test]
fn a_run_resumed_many_times_equals_an_uninterrupted_run() {
    let workspace = workspace();
    workspace.run_ok("--train --scenario noisy.ron --preset fast.ron --steps 3000 --out straight");
    workspace.run_ok("--train --scenario noisy.ron --preset fast.ron --steps 1 --out pieces");
    for steps in [17, 999, 1017, 1500, 2222, 3000] {
        workspace.run_ok(&format!("--train --resume pieces --steps {steps}"));
    }
    workspace.assert_same_run("straight", "pieces");
}

/// More bytes than the header of `episodes.csv` has, but fewer than the header and the first rows.
#[cfg(unix)]
const BEYOND_HEADER: u64 = 300;

/// Whether `episodes.csv` of a run in progress has more than `more_than` bytes.
#[cfg(unix)]
fn has_rows(workspace: &Workspace, run: &str, more_than: u64) -> bool {
    std::fs::metadata(workspace.path(&format!("{run}/episodes.csv"))).is_ok_and(|file| file.len() > more_than)
}

#[cfg(unix)]
#[test]
fn a_run_stopped_by_a_signal_resumes_to_the_uninterrupted_result() {
    let workspace = workspace();
    let what = "--train --scenario two.ron --preset per.ron --seed 6 --episodes 400";
    workspace.run_ok(&format!("{what} --out uninterrupted"));

    for (name, status) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        let mut child = workspace.start(&format!("{what} --out {name}"));
        wait_until(&mut child, "rows in episodes.csv", || has_rows(&workspace, name, BEYOND_HEADER));
        signal(&child, name);
        let stopped = wait_for_output(child);
        assert_eq!(stopped.status, Some(status), "{}", stopped.stderr);
        assert!(stopped.stderr.contains(&format!("SIG{name}: saving a checkpoint")), "{}", stopped.stderr);
        assert!(stopped.stderr.ends_with(&format!("--resume {name}` continues\n")), "{}", stopped.stderr);
        assert!(stopped.stdout.contains("none yet: it follows at the end of training"), "{}", stopped.stdout);
        assert!(workspace.json(&format!("{name}/summary.json"))["final_test"].is_null());
        assert!(stopped.stdout.contains("last policy"), "a stopped run has a summary: {}", stopped.stdout);
        let summary = workspace.json(&format!("{name}/summary.json"));
        assert_eq!(summary["finished"], false, "the run was stopped in the middle");

        // Without a new budget, the run resumes to its original one.
        let done = workspace.run_ok(&format!("--resume {name} --json"));
        assert_eq!(done.json()["finished"], true);
        workspace.assert_same_run("uninterrupted", name);
    }
}

#[cfg(unix)]
#[test]
fn a_killed_run_resumes_from_its_last_checkpoint_to_the_uninterrupted_result() {
    let workspace = workspace();
    let what = "--train --scenario one.ron --preset per.ron --seed 7";
    workspace.run_ok(&format!("{what} --episodes 400 --out uninterrupted"));

    // The run is killed after its first checkpoint, and again after one in the middle. Both times there are rows on
    // disk that the checkpoint does not include.
    let mut child = workspace.start(&format!("{what} --episodes 100 --out killed"));
    wait_until(&mut child, "rows in episodes.csv", || has_rows(&workspace, "killed", BEYOND_HEADER));
    signal(&child, "KILL");
    assert_eq!(wait_for_output(child).status, None);
    workspace.run_ok("--train --resume killed");
    let rows = std::fs::metadata(workspace.path("killed/episodes.csv")).unwrap().len();

    let mut child = workspace.start("--train --resume killed --episodes 400");
    wait_until(&mut child, "more rows in episodes.csv", || has_rows(&workspace, "killed", rows));
    signal(&child, "KILL");
    assert_eq!(wait_for_output(child).status, None);
    workspace.run_ok("--train --resume killed");
    workspace.assert_same_run("uninterrupted", "killed");
}

#[test]
fn a_finished_run_resumes_only_with_a_larger_budget() {
    let workspace = workspace();
    workspace.run_ok("--train --scenario one.ron --preset fast.ron --steps 1600 --out run");
    let before = workspace.all_files();
    for more in ["", " --steps 1600", " --steps 800"] {
        let done = workspace.run(&format!("--train --resume run{more}"));
        assert_eq!(done.status, Some(2), "{more}: {}", done.stderr);
        assert!(done.stderr.starts_with("error: run: this run already has "), "{}", done.stderr);
        assert!(done.stderr.contains("--episodes or --steps"), "{}", done.stderr);
        assert_eq!(done.stdout, "");
        assert!(workspace.all_files() == before, "a rejected resume changes nothing");
    }
    let done = workspace.run_ok("--train --resume run --steps 3200 --json");
    assert_eq!(done.json()["env_steps"], 3200);
    assert!(workspace.text("run/config.ron").contains("EnvSteps(3200)"), "config.ron has the new budget");
}

#[cfg(unix)]
#[test]
fn an_unfinished_run_does_not_resume_with_a_budget_that_it_has_passed() {
    let workspace = workspace();
    let mut child =
        workspace.start("--train --scenario one.ron --preset fast.ron --steps 90000000 --out run");
    wait_until(&mut child, "rows in episodes.csv", || has_rows(&workspace, "run", BEYOND_HEADER));
    signal(&child, "TERM");
    assert_eq!(wait_for_output(child).status, Some(143));
    let before = workspace.all_files();
    let summary = workspace.json("run/summary.json");
    let env_steps = summary["env_steps"].as_u64().unwrap();
    let done = workspace.run("--resume run --steps 16");
    assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{}", done.stderr);
    let message = format!(
        "error: run: this run already has {env_steps} env steps, more than --steps 16; help: give --steps"
    );
    assert!(done.stderr.starts_with(&message), "{}", done.stderr);
    assert!(workspace.all_files() == before, "a rejected resume changes nothing");
    // A control step of the 16 arenas is 16 env steps, so a run with this budget ends at the same number.
    let done = workspace.run_ok(&format!("--resume run --steps {} --json", env_steps - 15));
    assert_eq!(done.json()["env_steps"], env_steps);
    assert_eq!(done.json()["finished"], true);
}

#[cfg(target_os = "linux")]
#[test]
fn the_number_of_cores_does_not_change_a_run() {
    let workspace = workspace();
    let what = "--train --scenario noisy.ron --preset fast.ron --steps 8000 --seed 3";
    workspace.run_ok(&format!("{what} --out all-cores"));
    workspace.run_on_one_core(&format!("{what} --out pinned"));
    workspace.assert_same_run("all-cores", "pinned");
}
