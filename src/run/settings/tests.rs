use super::*;
use crate::learning::{Loss, Sampling, Schedule};
use crate::run::preset::Budget;
use crate::run::shipped;
use crate::scenario::{ObstacleMotion, to_ron};
use crate::task::{GoalDistance, RewardKind};

fn settings(texts: &[&str]) -> Settings {
    Settings(
        texts.iter().map(|text| text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))).collect(),
    )
}

/// Applies the settings `texts` to the shipped Scenario II and the preset `fast`.
fn set(texts: &[&str]) -> Result<(Scenario, Preset), Vec<SettingError>> {
    let mut scenario = shipped::scenario("scenario-2").expect("shipped");
    let mut preset = shipped::preset("fast").expect("shipped");
    settings(texts).apply(&mut scenario, &mut preset)?;
    Ok((scenario, preset))
}

fn message(texts: &[&str]) -> String {
    let errors = set(texts).err().unwrap_or_else(|| panic!("{texts:?} must be rejected"));
    errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

#[test]
fn any_field_can_be_set_and_the_others_stay() {
    let (scenario, preset) = set(&[
        "learning.gamma=0.97",
        "learning.replay.sampling.alpha=0.3",
        "reward.kind=Traditional",
        "reward.distance=Geodesic",
        "arenas = 4",
        "evaluation.every_env_steps=1k",
        "budget=EnvSteps(6e5)",
        "learning.loss=Huber(delta: 2)",
        "learning.network.hidden=[32, 32]",
        "learning.network.hidden[1]=16",
        "learning.learning_rate=Constant(3e-4) // a comment",
        "scenario.lidar.noise_std_m=0.02",
        "scenario.obstacles[*].motion.speed_rad_s=0.3",
        "scenario.name=\"Two \\\" ( 6e5\"",
    ])
    .expect("valid settings");
    let (mut expected_scenario, mut expected) =
        (shipped::scenario("scenario-2").expect("shipped"), shipped::preset("fast").expect("shipped"));
    expected.learning.gamma = 0.97;
    let Sampling::Prioritized { alpha, .. } = &mut expected.learning.replay.sampling else {
        panic!("not prioritized")
    };
    *alpha = 0.3;
    expected.reward.kind = RewardKind::Traditional;
    expected.reward.distance = GoalDistance::Geodesic;
    expected.arenas = 4;
    expected.evaluation.every_env_steps = 1000;
    expected.budget = Budget::EnvSteps(600_000);
    expected.learning.loss = Loss::Huber { delta: 2.0 };
    expected.learning.network.hidden = vec![32, 16];
    expected.learning.learning_rate = Schedule::Constant(3e-4);
    assert_eq!(preset, expected);
    expected_scenario.lidar.noise_std_m = 0.02.into();
    for obstacle in &mut expected_scenario.obstacles {
        if let ObstacleMotion::Orbit { speed_rad_s, .. } = &mut obstacle.motion {
            *speed_rad_s = 0.3.into();
        }
    }
    expected_scenario.name = "Two \" ( 6e5".into();
    assert_eq!(scenario, expected_scenario);
}

#[test]
fn the_error_names_the_setting_the_problem_and_the_fix() {
    let top = "`about`, `based_on`, `arenas`, `budget`, `evaluation`, `observation`, \
               `prediction_dropout`, `actions`, `reward`, `learning`, `levels`, \
               `scenario`";
    for (text, expected) in [
        (
            "lerning.gamma=1",
            format!("unknown field `lerning` in a preset: did you mean `learning`? the fields are {top}"),
        ),
        ("scenario.lidr.beams=1", "unknown field `lidr` in `scenario`: did you mean `lidar`?".into()),
        (
            "scenario=\"maze\"",
            "give a field of the scenario, such as scenario.lidar.noise_std_m; help: ".into(),
        ),
        (
            "learning.gama=0.97",
            "unknown field `gama` in `learning`: did you mean `gamma`? the fields are `network`, `double`"
                .into(),
        ),
        ("gamma=0.97", "`gamma` is not the whole path: did you mean `learning.gamma`?".into()),
        (
            "robot.radius_m=0.2",
            "`robot.radius_m` is not the whole path: did you mean `scenario.robot.radius_m`?".into(),
        ),
        (
            "obstacles[0].motion=Static",
            "`obstacles[0].motion` is not the whole path: did you mean `scenario.obstacles[0].motion`?"
                .into(),
        ),
        (
            "sampling.alpha=0.3",
            "`sampling.alpha` is not the whole path: did you mean `learning.replay.sampling.alpha`?".into(),
        ),
        ("learning.gamma=high", "`learning.gamma` must be a number".into()),
        ("learning.gamma=0,97", "a decimal comma: write 0.97".into()),
        ("learning.gamma=0.97, double: false", "`double` appears twice in `learning`: remove one".into()),
        (
            "learning.gamma=(0.97",
            "`(0.97` has brackets that do not match; help: add the missing bracket, or remove the extra one"
                .into(),
        ),
        (
            "learning.gamma=0.97)",
            "`0.97)` has brackets that do not match; help: add the missing bracket, or remove the extra one"
                .into(),
        ),
        ("learning.gamma=1.5", "`learning.gamma` is 1.5".into()),
        ("learning.optimizer=Adam", "`learning.optimizer` must be written with parentheses: Adam()".into()),
        ("arenas=4.5", "`arenas` must be a whole number, without a fraction".into()),
        ("arenas=0", "`arenas` is 0".into()),
        (
            "budget=500",
            "`budget` must be one of the choices `Episodes`, `EnvSteps`: write `Episodes(500)`".into(),
        ),
        (
            "reward.kind=Baseline",
            "unknown choice `Baseline` for `reward.kind`: the choices are `Traditional`, `Optimized`".into(),
        ),
        (
            "learning.learning_rate.gamma=1",
            "unknown field `gamma` in `learning.learning_rate`: the fields are `from`, `to`, `env_steps`"
                .into(),
        ),
        (
            "learning.loss.delta.x=1",
            "`learning.loss.delta` is `1.0`, which has no `x`; help: set `learning.loss.delta` as a whole"
                .into(),
        ),
        (
            "scenario.obstacles[99].position_m=(0, 0)",
            "`obstacles` is `[ ( shape: Circle( radius_m: 0.15".into(),
        ),
        ("scenario.lidar.beams=0", "`scenario.lidar.beams` is 0".into()),
        ("learning.replay.capacity=8", "`learning.replay.capacity` is 8".into()),
    ] {
        let message = message(&[text]);
        assert!(message.starts_with(&format!("{text}: {expected}")), "{message}\nexpected {expected}");
        assert!(!message.contains('\n'), "one problem each: {message}");
    }
    for text in ["learning.gamma", "=1", "learning.gamma="] {
        let error = text.parse::<Setting>().expect_err(text);
        assert_eq!(error, "give PATH=VALUE, such as learning.gamma=0.97 or scenario.lidar.noise_std_m=0.02");
    }
}

#[test]
fn all_errors_are_reported_at_once_and_each_names_the_last_setting_that_contains_its_field() {
    let found = message(&["arenas=0.5", "learning.gama=1"]);
    assert_eq!(found.lines().count(), 2, "{found}");
    let found = message(&["arenas=2", "arenas=0"]);
    assert!(found.starts_with("arenas=0: "), "{found}");
    let speed = "scenario.obstacles[*].motion.speed_rad_s=99";
    let found = message(&["scenario.lidar.noise_std_m=1", speed]);
    assert!(found.lines().all(|line| line.starts_with(&format!("{speed}: "))), "{found}");
}

#[test]
fn a_file_holds_settings_as_a_map() {
    let text = "{\"learning.gamma\": 0.97, \"budget\": Episodes(3) /* few */, \"about\": \"x\"}";
    let read: Settings =
        crate::scenario::parse_ron(text, "settings.ron").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(read, settings(&["learning.gamma=0.97", "budget=Episodes(3)", "about=\"x\""]));
    let written = to_ron(&read).expect("RON");
    let again: Settings =
        crate::scenario::parse_ron(&written, "settings.ron").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(again, read, "{written}");
}

#[test]
fn settings_with_shorthand_numbers_or_comments_are_written_as_ron() {
    let written = to_ron(&settings(&["budget=EnvSteps(600k)", "arenas=6e1 // many", "seed=1"])).expect("RON");
    let read: Settings =
        crate::scenario::parse_ron(&written, "settings.ron").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(read.0[0].value, "EnvSteps(600000)", "{written}");
    assert!(read.0[1].value.starts_with("60"), "{written}");
    assert_eq!(read.0[2].value, "1", "{written}");
}
