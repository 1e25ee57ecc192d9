//! Tests of policy cards: the card states what the policy's numbers mean. A scenario in which they mean something else is
//! refused, or causes a warning, with both values.

mod cli_support;
#[path = "support/requirements.rs"]
mod requirements;

use std::process::Command;
use std::sync::OnceLock;

use cli_support::messages::{Messages, rejection};
use cli_support::{FAST, SCENARIO_1, Workspace, edited, quick_fast};
use requirements::Requirement;
use serde_json::json;
use wayfield::learning::NetworkConfig;
use wayfield::policy::Policy;
use wayfield::policy::card::RawJson;
use wayfield::run::folder::RunConfig;
use wayfield::run::policy_card;
use wayfield::scenario::{PlacementRule, Scenario};
use wayfield::task::ObservationSlice;

const PYTHON: Requirement = Requirement { commands: &["python3"], packages: "python3" };

/// A workspace with a quick preset and a policy that has been trained with it in Scenario I.
fn workspace() -> Workspace {
    static POLICY: OnceLock<Vec<u8>> = OnceLock::new();
    let workspace = Workspace::new();
    workspace.write("quick.ron", quick_fast());
    let policy = POLICY.get_or_init(|| {
        let workspace = Workspace::new();
        workspace.write("quick.ron", quick_fast());
        workspace.run_ok("--train --preset quick.ron --steps 64 --out run");
        workspace.read("run/policy.safetensors")
    });
    workspace.write("policy.safetensors", policy);
    workspace
}

/// Scenario I with `fields`.
fn with(fields: &str) -> String {
    edited(SCENARIO_1, &[("    obstacles: [", &format!("    {fields},\n    obstacles: ["))])
}

/// Scenario I with motions at 0.15 m/s and these turning rates, in rad/s.
fn turning(rates_rad_s: [f32; 5]) -> String {
    let motions = rates_rad_s.map(|w| format!("(v_m_s: 0.15, w_rad_s: {w:?})"));
    with(&format!("robot: (motions: [{}])", motions.join(", ")))
}

const TEST: &str = "--eval policy.safetensors --rounds 1 --episodes 2 --scenario";
const TRANSFER: &str = "--train --preset quick.ron --init policy.safetensors --steps 16";

/// The policy of [`workspace`].
fn policy() -> Policy {
    Policy::from_bytes(&workspace().read("policy.safetensors")).expect("a valid policy")
}

#[test]
fn reversed_or_reordered_actions_are_refused_with_both_meanings() {
    let workspace = workspace();
    let mut messages = Messages::new("policy_cards");
    for (name, comment, scenario) in [
        ("mirrored.ron", "the turns are mirrored", turning([-1.5, -0.75, 0.0, 0.75, 1.5])),
        ("reordered.ron", "two left turns are exchanged", turning([0.75, 1.5, 0.0, -0.75, -1.5])),
        (
            "backwards.ron",
            "the last motion drives backwards",
            turning([1.5, 0.75, 0.0, -0.75, -1.5]).replace("0.15, w_rad_s: -1.5", "-0.15, w_rad_s: -1.5"),
        ),
    ] {
        workspace.write(name, scenario);
        messages.case(comment);
        messages.line(&workspace, &format!("{TEST} {name}"));
        messages.line(&workspace, &format!("{TRANSFER} --scenario {name} --out new"));
    }
    messages.check();
}

#[test]
fn every_setting_that_differs_from_the_card_is_listed_with_both_values() {
    let workspace = workspace();
    let cases = [
        ("task: (control_period_s: 1.0)", "control period: 0.2 s on its card, 1 s here"),
        ("task: (goal_radius_m: 0.3)", "goal radius: 0.2 m on its card, 0.3 m here"),
        ("task: (collision_range_m: 0.12)", "collision range: 0.13 m on its card, 0.12 m here"),
        ("robot: (radius_m: 0.05)", "robot radius: 0.1 m on its card, 0.05 m here"),
        (
            "robot: (shape: Rectangle(width_m: 0.2, height_m: 0.1))",
            "robot shape: a disc on its card, Rectangle(width_m:0.2,height_m:0.1) here",
        ),
        ("robot: (actuator_lag_s: 0.3)", "actuator lag: 0 s on its card, 0.3 s here"),
        ("robot: (actuator_lag_s: (0.0, 0.3))", "actuator lag: 0 s on its card, (0, 0.3) s here"),
        ("robot: (max_acceleration_m_s2: 0.5)", "acceleration limit: none on its card, 0.5 m/s^2 here"),
        (
            "robot: (max_angular_acceleration_rad_s2: 5.0)",
            "angular acceleration limit: none on its card, 5 rad/s^2 here",
        ),
        (
            "robot: (odometry_drift: (distance_error: 0.02, rotation_error: 0, heading_drift_rad_m: 0))",
            "odometry: exact on its card, errors 0.02 m/m, 0 rad/rad, 0 rad/m here",
        ),
        (
            "robot: (slip: (forward: (0.0, 0.1), turning: 0, std: 0))",
            "wheel slip: none on its card, forward (0, 0.1), turning 0, standard deviation 0 here",
        ),
        ("lidar: (max_range_m: 0.5)", "LIDAR range: 3.5 m on its card, 0.5 m here"),
        ("lidar: (noise_std_m: 0.02)", "LIDAR noise: 0 m on its card, 0.02 m here"),
        ("lidar: (dropout: 0.013)", "LIDAR dropout: 0 % on its card, 1.3 % here"),
        ("lidar: (latency_steps: 2)", "LIDAR latency: 0 steps on its card, 2 steps here"),
        (
            "lidar: (field_of_view_rad: 4.712)",
            "LIDAR field of view: 6.2831855 rad on its card, 4.712 rad here",
        ),
    ];
    for (number, (fields, expected)) in cases.into_iter().enumerate() {
        workspace.write("differs.ron", with(fields));
        let done = workspace.run_ok(&format!("{TEST} differs.ron"));
        let lines: Vec<&str> = done.stderr.lines().collect();
        let part = fields.split(':').next().unwrap_or_default();
        let head =
            "warning: policy.safetensors: \"Scenario I\" differs from what this policy was trained with:";
        assert_eq!(lines[..2], [head, &format!("  {expected}")], "{fields}");
        assert_eq!(
            lines[2..],
            [format!(
                "note: policy.safetensors: this policy was trained in another version of Scenario I, which differs in `{part}`"
            )],
            "{fields}"
        );
        let done = workspace.run_ok(&format!("{TRANSFER} --scenario differs.ron --out transfer-{number}"));
        assert!(done.stderr.contains(&format!("{head}\n  {expected}\n")), "--init: {}", done.stderr);
    }
    workspace.write("slower.ron", turning([1.0, 0.5, 0.0, -0.5, -1.0]));
    let done = workspace.run_ok(&format!("{TEST} slower.ron"));
    let expected = "  action 0: 0.15 m/s 1.5 rad/s on its card, 0.15 m/s 1 rad/s here\n";
    assert!(done.stderr.contains(expected), "{}", done.stderr);
    assert_eq!(done.stderr.matches("  action ").count(), 4, "straight ahead is the same: {}", done.stderr);
}

#[test]
fn other_obstacles_under_the_same_name_give_a_note_and_no_warning() {
    let workspace = workspace();
    assert_eq!(workspace.run_ok(&format!("{TEST} scenario-1")).stderr, "", "its own scenario");
    workspace.write("moved.ron", edited(SCENARIO_1, &[("position_m: (0.6, 0.6)", "position_m: (0.7, 0.6)")]));
    let done = workspace.run_ok(&format!("{TEST} moved.ron"));
    assert_eq!(
        done.stderr,
        "note: policy.safetensors: this policy was trained in another version of Scenario I, which differs in `obstacles`\n"
    );
    let done = workspace.run_ok(&format!("{TEST} scenario-2"));
    assert_eq!(
        done.stderr,
        "note: policy.safetensors: this policy was trained in Scenario I and is tested in Scenario II\n"
    );
}

#[test]
fn without_a_scenario_a_policy_is_tested_in_its_own() {
    let workspace = workspace();
    workspace.write("narrow.ron", with("lidar: (field_of_view_rad: 4.712, beams: 12)"));
    workspace.run_ok("--train --preset quick.ron --steps 64 --scenario narrow.ron --out narrow");
    let own = workspace.run_ok("--eval narrow/policy.safetensors --rounds 1 --episodes 20 --course --json");
    let named = workspace.run_ok(
        "--eval narrow/policy.safetensors --rounds 1 --episodes 20 --course --json --scenario narrow.ron",
    );
    assert_eq!((own.stdout, own.stderr.as_str()), (named.stdout, ""));
    let error = rejection(&workspace, "--eval narrow/policy.safetensors --scenario scenario-1");
    assert!(error.contains("takes 16 numbers") && error.contains("gives 28 numbers"), "{error}");
}

#[test]
fn a_policy_without_a_card_is_used_with_a_warning() {
    let workspace = workspace();
    let mut old = policy();
    old.card = None;
    old.metadata.insert("scenario".into(), "Scenario II".into());
    workspace.write("old.safetensors", old.to_bytes().expect("finite weights"));
    let done = workspace.run_ok("--eval old.safetensors --rounds 1 --episodes 2");
    assert!(done.stdout.starts_with("old.safetensors in Scenario I, 2 episodes"), "{}", done.stdout);
    assert!(done.stderr.starts_with("warning: old.safetensors: this policy has no card"), "{}", done.stderr);
    assert!(
        done.stderr.contains("note: old.safetensors: this policy was trained in Scenario II"),
        "{}",
        done.stderr
    );
    let error = rejection(&workspace, "--card old.safetensors");
    assert!(error.contains("has no card") && error.contains("help: train the policy again"), "{error}");
}

#[test]
fn the_printed_card_is_complete() {
    let workspace = workspace();
    workspace.write("mine.ron", with("lidar: (field_of_view_rad: 3.0, beams: 7, noise_std_m: 0.01)"));
    workspace.run_ok("--train --preset quick.ron --steps 64 --scenario mine.ron --seed 5 --out mine");
    let printed = workspace.run_ok("--card mine/policy.safetensors");
    assert_eq!((printed.stdout.lines().count(), printed.stderr.as_str()), (1, ""));
    let header = printed.json();
    assert_eq!(header["network"], json!({"inputs": 11, "hidden": [16], "actions": 5, "dueling": true}));
    let card = &header["card"];
    let inputs = card["inputs"].as_array().expect("a list");
    let angles: Vec<f64> = inputs.iter().filter_map(|input| input["angle_rad"].as_f64()).collect();
    assert_eq!(angles, [-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5], "from the right edge to the left one");
    assert_eq!((inputs.len(), &inputs[8]["quantity"]), (11, &json!("goal_distance")));
    assert_eq!(card["actions"][4], json!({"v_m_s": 0.15, "w_rad_s": -1.5}));
    assert_eq!((&card["control_period_s"], &card["activation"]), (&json!(0.2), &json!("relu")));
    assert_eq!(card["q_values"], "value + advantage - mean(advantage)");
    let training = &card["training"];
    assert_eq!(
        (&training["seed"], &training["preset"], &training["scenario_from"], &training["env_steps"]),
        (&json!(5), &json!("quick"), &json!("mine.ron"), &json!(64))
    );
    assert_eq!(card["program"]["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(card["program"]["commit"], json!(option_env!("WAYFIELD_COMMIT")));
    let scenario: Scenario = serde_json::from_value(card["scenario"].clone()).expect("a scenario");
    assert_eq!(scenario, Scenario::load(workspace.path("mine.ron")).expect("the scenario of the run"));
    let example = &card["example"];
    let policy = Policy::from_bytes(&workspace.read("mine/policy.safetensors")).expect("a valid policy");
    let row: Vec<f32> = serde_json::from_value(example["observation"].clone()).expect("numbers");
    assert_eq!(policy.act(&row, &mut wayfield::policy::Scratch::default()), example["action"]);
}

type ScenarioChange = fn(&mut Scenario);

/// `policy` with another scenario on its card.
fn with_scenario(mut policy: Policy, change: impl FnOnce(&mut Scenario)) -> Policy {
    let card = policy.card.as_mut().expect("a card");
    let mut scenario: Scenario = serde_json::from_str(card.scenario.text()).expect("a scenario");
    change(&mut scenario);
    card.scenario = RawJson::new(serde_json::to_string(&scenario).expect("JSON")).expect("JSON");
    card.scenario_crc32c = card.scenario.crc32c();
    policy
}

#[test]
fn a_card_that_contradicts_its_scenario_is_refused() {
    let workspace = workspace();
    let changes: [(&str, ScenarioChange); 6] = [
        ("other than those of its scenario", |scenario| scenario.robot.motions.reverse()),
        ("other than those of its scenario", |scenario| scenario.task.control_period_s = 0.1),
        ("other than those of its scenario", |scenario| scenario.lidar.field_of_view_rad = 3.0),
        ("other than those of its scenario", |scenario| scenario.lidar.beams = 4),
        ("has an invalid scenario", |scenario| scenario.robot.radius_m = -1.0),
        ("has an invalid scenario", |scenario| scenario.lidar.max_range_m = 1e30),
    ];
    for (expected, change) in changes {
        let policy = with_scenario(policy(), change);
        workspace.write("changed.safetensors", policy.to_bytes().expect("a consistent file"));
        for arguments in [
            "--eval changed.safetensors",
            "--card changed.safetensors",
            "--train --preset quick.ron --init changed.safetensors --out new",
        ] {
            let error = rejection(&workspace, arguments);
            assert!(error.contains(expected) && error.contains("help: "), "{arguments}: {error}");
        }
    }
    let mut policy = policy();
    let card = policy.card.as_mut().expect("a card");
    card.scenario = RawJson::new("{\"name\": \"x\", \"colour\": 1}".into()).expect("JSON");
    card.scenario_crc32c = card.scenario.crc32c();
    workspace.write("changed.safetensors", policy.to_bytes().expect("a consistent file"));
    let error = rejection(&workspace, "--eval changed.safetensors");
    assert!(error.contains("unreadable scenario: unknown field `colour`"), "{error}");
}

#[test]
fn a_policy_trained_with_its_goal_in_an_obstacle_can_be_tested_only_in_another_scenario() {
    let workspace = workspace();
    // In the app an obstacle can be dragged onto a fixed goal.
    let policy = with_scenario(policy(), |scenario| {
        scenario.goals =
            PlacementRule::Fixed { position_m: scenario.obstacles[0].position_m, heading_rad: None };
    });
    workspace.write("dragged.safetensors", policy.to_bytes().expect("a consistent file"));
    let error = rejection(&workspace, "--eval dragged.safetensors");
    assert!(
        error.contains("the scenario on the policy's card is invalid") && error.contains("--scenario"),
        "{error}"
    );
    workspace.run_ok("--eval dragged.safetensors --rounds 1 --episodes 2 --scenario scenario-1");
}

#[test]
fn text_on_a_card_reaches_no_terminal_as_an_escape_sequence() {
    let workspace = workspace();
    let (escape, mark) = ("\u{1b}]0;taken\u{7}\u{1b}[31m\u{9b}2K", "\u{202e}live");
    let mut policy = policy();
    let training = &mut policy.card.as_mut().expect("a card").training;
    (training.preset, training.scenario_from, training.init) =
        (escape.into(), mark.into(), Some(escape.into()));
    workspace.write("hostile.safetensors", policy.to_bytes().expect("a consistent file"));
    // A plugin sensor with such a name.
    let mut config = RunConfig::resolve("scenario-1", "fast", 0).expect("shipped");
    config.sensors = vec![ObservationSlice { name: escape.into(), width: 1 }];
    let network = NetworkConfig { hidden: vec![], dueling: false, ..NetworkConfig::default() };
    let shape = network.shape(29, 5).expect("a valid shape");
    let mut policy = Policy::new(shape, vec![0.5; 30 * 5]).expect("a valid shape");
    policy_card::attach(&mut policy, &config, (1, 1), None);
    workspace.write("sensor.safetensors", policy.to_bytes().expect("a consistent file"));
    for arguments in [
        "--card hostile.safetensors",
        "--card sensor.safetensors",
        "--eval hostile.safetensors --rounds 1 --episodes 1",
        "--eval hostile.safetensors --rounds 1 --episodes 1 --scenario scenario-1",
        "--eval sensor.safetensors",
    ] {
        let done = workspace.run(arguments);
        for c in ['\u{1b}', '\u{7}', '\u{9b}', '\u{202e}'] {
            assert!(!done.stdout.contains(c) && !done.stderr.contains(c), "{arguments}: {c:?}: {done:?}");
        }
    }
    let printed = workspace.run_ok("--card hostile.safetensors").json();
    assert_eq!(printed["card"]["training"]["preset"], escape, "JSON keeps it, escaped");
    let error = rejection(&workspace, "--eval sensor.safetensors");
    assert!(
        error.contains("trained with `\\u{1b}]0;taken\\u{7}\\u{1b}[31m\\u{9b}2K:1`, but this simulation has no sensor plugin"),
        "{error}"
    );
}

/// The Python program in docs/policy-file.md.
fn program() -> String {
    let page = include_str!("../docs/policy-file.md");
    let blocks = page.split("```python\n").skip(1);
    blocks.map(|block| block.split_once("```").expect("the end of the block").0).collect()
}

#[test]
fn the_python_program_in_the_documentation_takes_as_long_as_wayfield_on_the_benchmark_route() {
    if !PYTHON.is_met() {
        return;
    }
    let workspace = Workspace::new();
    workspace.write("drive.py", program());
    let shipped = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/policies/scenario-1.safetensors");
    workspace.write("shipped.safetensors", std::fs::read(shipped).expect("the shipped policy"));
    workspace.run_ok("--train --steps 30000 --seed 1 --out plain");
    workspace.write("narrow.ron", with("lidar: (field_of_view_rad: 4.712)"));
    workspace.run_ok("--train --scenario narrow.ron --steps 60000 --seed 1 --out narrow");
    let angular = [
        (
            "(shape: Circle(radius_m: 0.15), position_m: (0.6, 0.6)",
            "(shape: Rectangle(width_m: 0.3, height_m: 0.2), rotation_rad: 0.5, position_m: (0.6, 0.6)",
        ),
        (
            "(shape: Circle(radius_m: 0.15), position_m: (-0.6, 0.6)",
            "(shape: Polygon(corners_m: [(-0.15, -0.1), (0.15, -0.1), (0.0, 0.2)]), position_m: (-0.6, 0.6)",
        ),
        (
            "    obstacles: [",
            "    enclosure: Polygon(corners_m: [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-1.0, 2.0), (-2.0, 1.5)]),\n    obstacles: [",
        ),
    ];
    workspace.write("angular.ron", edited(SCENARIO_1, &angular));
    workspace.run_ok("--train --scenario angular.ron --steps 60000 --seed 1 --out angular");
    let network = "dueling: true, layer_norm: true, activation: Silu";
    workspace.write("silu.ron", edited(FAST, &[("dueling: true", network)]));
    workspace.run_ok("--train --preset silu.ron --steps 60000 --seed 1 --out silu");
    for policy in [
        "shipped.safetensors",
        "plain/policy.safetensors",
        "narrow/policy.safetensors",
        "angular/policy.safetensors",
        "silu/policy.safetensors",
    ] {
        let report =
            workspace.run_ok(&format!("--eval {policy} --rounds 1 --episodes 1 --course --json")).json();
        let time_s = report["course_time_s"].as_f64().unwrap_or_else(|| panic!("{policy} arrives: {report}"));
        let run = Command::new("python3")
            .args(["drive.py", policy])
            .current_dir(workspace.path(""))
            .output()
            .expect("python3 starts");
        let printed = String::from_utf8_lossy(&run.stdout);
        assert_eq!(printed, format!("{time_s:.3} s\n"), "{policy}: {}", String::from_utf8_lossy(&run.stderr));
    }
}

#[test]
fn the_python_program_says_what_it_cannot_simulate() {
    if !PYTHON.is_met() {
        return;
    }
    let workspace = Workspace::new();
    workspace.write("drive.py", program());
    for (scenario, what) in
        [("scenario-2", "moving obstacles"), ("doorway", "walls"), ("random-field", "generators")]
    {
        workspace.run_ok(&format!("--train --scenario {scenario} --steps 16 --out {scenario}"));
        let run = Command::new("python3")
            .args(["drive.py", &format!("{scenario}/policy.safetensors")])
            .current_dir(workspace.path(""))
            .output()
            .expect("python3 starts");
        let printed = String::from_utf8_lossy(&run.stderr);
        assert_eq!(printed, format!("this program cannot simulate {what}\n"), "{scenario}");
    }
}

#[test]
fn the_python_program_refuses_a_card_whose_example_it_computes_differently() {
    if !PYTHON.is_met() {
        return;
    }
    let workspace = workspace();
    workspace.write("drive.py", program());
    let mut bytes = workspace.read("policy.safetensors");
    let end = bytes.len();
    bytes[end - 64..].fill(0);
    workspace.write("damaged.safetensors", &bytes);
    let run = Command::new("python3")
        .args(["drive.py", "damaged.safetensors"])
        .current_dir(workspace.path(""))
        .output()
        .expect("python3 starts");
    assert!(String::from_utf8_lossy(&run.stderr).contains("AssertionError: the Q-values"), "{run:?}");
    let error = rejection(&workspace, "--eval damaged.safetensors");
    assert!(error.contains("an example whose Q-values or action do not match the network"), "{error}");
}
