//! Policies that drive by percepts, as classical drivers do: they choose the same actions as in the simulation, and with a map
//! they get out of dead ends.

mod cli_support;

use std::sync::Arc;

use cli_support::{Workspace, edited, quick_fast};
use wayfield::drivers::{Odometry, Percept, action_motions};
use wayfield::learning::Policy;
use wayfield::run::evaluate::{Evaluator, TraceStep};
use wayfield::run::{RunError, policy_card, shipped};
use wayfield::scenario::{Motion, Scenario};
use wayfield::task::{EpisodeSetup, Goal, Pose};

const ACTIONS: &str = "Relative([(speed: 1, turn: 1), (speed: 1, turn: 0), (speed: 1, turn: -1), (speed: 0, turn: 1), \
                       (speed: 0, turn: -1), (speed: 0.5, turn: 0)])";

/// A policy with observations by sectors and relative actions, which has learned next to nothing.
fn policy_by_sectors() -> Policy {
    let workspace = Workspace::new();
    let fields = format!("observation: Sectors(count: 12, earlier_steps: 2), actions: {ACTIONS}, reward:");
    workspace.write("sectors.ron", edited(&quick_fast(), &[("reward:", &fields)]));
    workspace.run_ok("--train --preset sectors.ron --scenario mixed --steps 320 --seed 4 --out run");
    policy_card::read(&workspace.path("run/policy-last.safetensors")).expect("a policy")
}

/// The steps of three episodes that `policy` drives.
fn steps(policy: &Policy, scenario: &Arc<Scenario>) -> Vec<TraceStep> {
    let mut steps = Vec::new();
    let mut evaluator = Evaluator::new(scenario, 1);
    let episodes = evaluator.run_traced::<RunError>(policy, 5, 3, EpisodeSetup::Random, |step| {
        steps.push(step);
        Ok(())
    });
    assert_eq!(episodes.expect("no error").len(), 3);
    steps
}

fn tuple(pose: &Pose) -> (f32, f32, f32) {
    (pose.x_m, pose.y_m, pose.heading_rad)
}

#[test]
fn a_policy_that_drives_by_percepts_chooses_the_same_actions_as_in_the_simulation() {
    let sectors = policy_by_sectors();
    assert!(policy_card::encoding(&sectors).expect("known").sectors().is_some());
    let expert = &shipped::policies()[0].policy;
    for (policy, name) in [(expert, "scenario-2"), (&sectors, "scenario-2"), (&sectors, "random-field")] {
        let scenario = Arc::new(shipped::scenario(name).expect("shipped"));
        let driving = policy_card::driving(policy.clone(), false).expect("known");
        let mut driver = driving.driver(&scenario);
        let own = action_motions(&driving.actions, &scenario.robot);
        assert_eq!(driver.motions().unwrap_or(&scenario.robot.motions), own);
        let mut last = None;
        for step in steps(policy, &scenario) {
            if step.step == 0 {
                driver = driving.driver(&scenario);
                last = None;
            }
            let goal = Goal { x_m: step.goal_x_m, y_m: step.goal_y_m };
            let odometry = last.map(|last| Odometry::between(last, tuple(&step.pose))).unwrap_or_default();
            let percept = Percept {
                ranges_m: &step.ranges_m,
                goal_distance_m: step.pose.distance_m(&goal),
                goal_bearing_rad: step.pose.bearing_rad(&goal),
                twist: Motion { v_m_s: step.twist.v_m_s, w_rad_s: step.twist.w_rad_s },
                odometry,
                truth: None,
            };
            last = Some(tuple(&step.pose));
            if let Some(action) = step.action {
                assert_eq!(
                    driver.act(&percept),
                    action,
                    "{name}, episode {}, step {}",
                    step.episode,
                    step.step
                );
            }
        }
    }
}

#[test]
fn a_map_does_not_change_how_a_policy_with_relative_actions_drives_where_nothing_is_in_the_way() {
    let sectors = policy_by_sectors();
    let scenario = Arc::new(shipped::scenario("empty").expect("shipped"));
    let with_map = policy_card::driving(sectors.clone(), true).expect("known");
    let mut evaluator = Evaluator::new(&scenario, 8);
    let alone = evaluator.run(&sectors, 3, 8, EpisodeSetup::Random).expect("no error");
    let mapped = evaluator.run(&with_map, 3, 8, EpisodeSetup::Random).expect("no error");
    assert_eq!(alone, mapped);
    assert_eq!(evaluator.run(&sectors, 3, 8, EpisodeSetup::Random), Ok(alone), "the evaluator keeps no map");
}

#[test]
fn a_map_leads_out_of_dead_ends_in_which_a_policy_alone_fails() {
    let workspace = Workspace::new();
    let eval = "--eval scenario-1 scenario-1+map grid-dwa --scenario u-trap --rounds 1 --episodes 50";
    let report = workspace.run_ok(&format!("{eval} --json --csv episodes.csv")).json();
    let results = report["policies"].as_array().expect("a list");
    let of = |key: &str| results.iter().map(|result| result[key].clone()).collect::<Vec<_>>();
    assert_eq!(of("policy"), ["scenario-1", "scenario-1+map", "grid-dwa"]);
    assert_eq!(of("class"), ["A", "B", "B"]);
    assert_eq!(results[0]["weights_crc32c"], results[1]["weights_crc32c"], "the same weights");
    let success = of("success_rate").iter().map(|rate| rate.as_f64().expect("a number")).collect::<Vec<_>>();
    assert!(success[0] < 0.5 && success[1] > 0.9, "{success:?}");
    assert!(workspace.text("episodes.csv").contains("\nscenario-1+map,50,"));
    let table = workspace.run_ok(eval).stdout;
    assert!(table.contains("\nscenario-1+map  B "), "{table}");
}

#[test]
fn the_commands_of_a_report_drive_a_policy_with_its_map() {
    let workspace = Workspace::new();
    workspace.write("short.ron", "(name: \"Short\", families: [(name: \"maze\", scenarios: [\"maze\"], episodes: 2, time_limit_s: 2.0)])");
    workspace.run_ok("--eval scenario-1+map --suite short.ron --report report");
    let page = workspace.text("report/report.html");
    assert!(page.contains("--open report/drivers/1-scenario-1.safetensors+map"), "{page}");
    let again = "--eval report/drivers/1-scenario-1.safetensors+map --suite short.ron --json";
    assert_eq!(workspace.run_ok(again).json()["class"], "B");
    // A test of the policy without a map is a separate entry.
    let alone = workspace.run_ok("--eval scenario-1 --suite short.ron --report report --json").json();
    assert_eq!(alone["class"], "A");
    assert_eq!(workspace.text("report/tests.ron").lines().count(), 2);
}

#[test]
fn only_a_policy_gets_a_map() {
    let workspace = Workspace::new();
    for (name, message) in [
        (
            "dwa+map",
            "dwa+map: +map gives a map to a policy only; help: grid-dwa is a classical driver with a map",
        ),
        ("scenario-1+map+map", "scenario-1+map+map: +map is given twice; help: give it once"),
        ("nothing+map", "nothing: no such file, shipped policy or driver"),
    ] {
        let done = workspace.run(&format!("--eval {name}"));
        assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{name}: {}", done.stderr);
        assert!(done.stderr.contains(message), "{name}: {}", done.stderr);
    }
    let done = workspace.run("--eval scenario-1+map --scenario random-field --set scenario.lidar.beams=36");
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    assert!(done.stderr.contains("scenario-1+map: the policy takes 28 numbers"), "{}", done.stderr);
}
