//! Questionable settings of presets and runs get a note; shipped files have none.

use super::*;
use crate::learning::{Exploration, Sampling, Schedule, TargetUpdate};
use crate::run::folder::Transfer;
use crate::run::shipped;
use crate::scenario::Shape;
use crate::task::{RewardKind, RewardLengths};

/// A schedule of epsilon that does not depend on env steps.
const PER_EPISODE: Exploration = Exploration::PerEpisode { start: 1.0, decay: 0.99, end: 0.05 };

fn fast() -> Preset {
    shipped::preset("fast").expect("shipped")
}

/// The notes on the preset `fast` with `change`, in Scenario I.
fn noted(change: impl FnOnce(&mut Preset)) -> Vec<String> {
    let mut preset = fast();
    change(&mut preset);
    assert_eq!(preset.diagnostics(), [], "the preset is valid");
    let scenario = shipped::scenario("scenario-1").expect("shipped");
    preset_notes(&preset, Some(&scenario), false).iter().map(ToString::to_string).collect()
}

/// Asserts that the preset `fast` with `change` has one note, which begins with `start` and contains `part`.
#[track_caller]
fn assert_noted(change: impl FnOnce(&mut Preset), start: &str, part: &str) {
    let notes = noted(change);
    let [note] = notes.as_slice() else { panic!("expected one note: {notes:?}") };
    assert!(note.starts_with(start) && note.contains(part) && note.contains("; help: "), "{note}");
}

#[test]
fn the_shipped_presets_have_no_notes_alone_or_in_any_shipped_scenario() {
    for (name, preset) in shipped::presets() {
        assert_eq!(preset_notes(&preset, None, false), [], "{name}");
        for (scenario_name, scenario) in shipped::scenarios() {
            assert_eq!(notes(&scenario), [], "{scenario_name}");
            assert_eq!(preset_notes(&preset, Some(&scenario), false), [], "{name} in {scenario_name}");
        }
    }
}

#[test]
fn a_run_without_a_gradient_step_gets_a_warning() {
    let nothing = "so nothing will be learned: the first gradient step comes after";
    assert_noted(
        |p| p.learning.train_freq = 5_000_000,
        "warning: `learning.train_freq` is 5000000, ",
        nothing,
    );
    assert_noted(
        |p| {
            (p.learning.replay.learning_starts, p.learning.replay.capacity) = (700_000, 1 << 20);
            p.learning.exploration = PER_EPISODE;
        },
        "warning: `learning.replay.learning_starts` is 700000, ",
        "after 700000 env steps, and the budget is 600000; help: give a smaller number, or a larger budget",
    );
    // At most (10 + 16) x 500 = 13,000 env steps: the 10 episodes, and an unfinished one in each of the 16 arenas.
    assert_noted(
        |p| {
            p.budget = Budget::Episodes(10);
            p.learning.replay.learning_starts = 13_001;
            p.learning.learning_rate = Schedule::Constant(1e-3);
            p.learning.replay.sampling = Sampling::Uniform;
        },
        "warning: `learning.replay.learning_starts` is 13001, ",
        "and the run has at most 13000 env steps; help: ",
    );
    // The 60th env step has 60 transitions, too few for a batch; the next update would come at the 120th.
    let batch = noted(|p| {
        (p.arenas, p.budget, p.learning.train_freq) = (1, Budget::EnvSteps(100), 60);
        (p.learning.batch_size, p.learning.replay.learning_starts) = (64, 0);
    });
    let expected = "warning: `learning.batch_size` is 64, so nothing will be learned: the first gradient step comes after 120 ";
    assert!(batch.iter().any(|note| note.starts_with(expected)), "{batch:?}");
    let late = |n| {
        noted(move |p| (p.budget, p.learning.replay.learning_starts) = (Budget::EnvSteps(n), 500))
            .iter()
            .any(|note| note.contains(nothing))
    };
    // A run ends after a whole control step of 16 env steps: a budget of 496 at 496, one of 497 at 512.
    assert!(late(496) && !late(497), "the first gradient step is at the first multiple of 16 from 500 on");
}

#[test]
fn learning_rates_that_change_nothing_or_diverge_get_a_warning() {
    let rate = |rate| move |p: &mut Preset| p.learning.learning_rate = Schedule::Constant(rate);
    assert_noted(rate(0.0), "warning: `learning.learning_rate` is 0 throughout", "nothing will be learned");
    assert_noted(
        rate(1e-12),
        "warning: `learning.learning_rate` is at most 1e-12",
        "nothing will be learned",
    );
    assert_noted(rate(3.0), "warning: `learning.learning_rate` is up to 3, ", "diverges");
    for usual in [1e-5, 2.5e-4, 0.01, 0.05] {
        assert_eq!(noted(rate(usual)), [""; 0], "{usual}");
    }
    let warm_up = Schedule::Linear { from: 0.0, to: 1e-3, env_steps: 10_000 };
    assert_eq!(noted(|p| p.learning.learning_rate = warm_up), [""; 0], "a warm-up may start at 0");
}

#[test]
fn rewards_that_teach_nothing_or_the_wrong_thing_are_noted() {
    assert_noted(
        |p| p.reward.collided = 50.0,
        "warning: `reward.collided` is 50: ",
        "collisions are rewarded",
    );
    assert_noted(|p| p.reward.reached = -1.0, "warning: `reward.reached` is -1: ", "is punished");
    let nothing = |p: &mut Preset| {
        (p.reward.kind, p.reward.reached, p.reward.collided) = (RewardKind::Traditional, 0.0, 0.0);
    };
    assert_noted(nothing, "warning: `reward` gives nothing for a goal, ", "so nothing will be learned");
    assert_noted(
        |p| (p.reward.mu, p.reward.reached) = (0.0, 0.0),
        "warning: `reward` gives nothing for a goal, ",
        "the robot only learns to avoid collisions",
    );
    let to_collide = noted(|p| {
        nothing(p);
        p.reward.collided = 50.0;
    });
    assert!(to_collide.iter().any(|note| note.contains("so the robot learns to collide")), "{to_collide:?}");
    let mut preset = fast();
    nothing(&mut preset);
    assert_eq!(preset_notes(&preset, None, true), [], "a plugin may give the reward");
    assert_noted(
        |p| p.reward.l_r_m = 0.1,
        "note: `reward.l_r_m` is 0.1, ",
        "but below 0.13 m the robot collides at every heading",
    );
    assert_eq!(noted(|p| (p.reward.l_r_m, p.reward.sigma) = (0.1, 0.0)), [""; 0]);
    // With lengths relative to the robot, 0.3 m is beyond the collision range of any robot.
    let mut large = Scenario::default();
    (large.robot.radius_m, large.task.collision_range_m) = (0.4, 0.5);
    let with_lengths = |lengths| {
        let mut preset = fast();
        preset.reward.lengths = lengths;
        preset_notes(&preset, Some(&large), false)
    };
    let notes = with_lengths(RewardLengths::Metres);
    assert!(notes.len() == 1 && notes[0].to_string().contains("such as 1.00"), "{notes:?}");
    assert_eq!(with_lengths(RewardLengths::Robot), []);
    // A body of 1 m x 0.8 m reaches 0.4 m to the sides, beyond the collision range of 0.13 m.
    let mut shaped = Scenario::default();
    shaped.robot.shape = Some(Shape::Rectangle { width_m: 1.0, height_m: 0.8 });
    let notes = preset_notes(&fast(), Some(&shaped), false);
    assert!(notes.len() == 1 && notes[0].to_string().contains("below 0.40 m the robot"), "{notes:?}");
}

#[test]
fn schedules_that_end_long_before_or_after_the_budget_are_noted() {
    let fields = |notes: &[String]| -> Vec<String> {
        notes.iter().map(|note| note.split('`').nth(1).unwrap_or_default().to_owned()).collect()
    };
    let short = noted(|p| p.budget = Budget::EnvSteps(6_000));
    assert_eq!(
        fields(&short),
        ["learning.learning_rate", "learning.replay.sampling.beta", "learning.exploration"],
        "{short:?}"
    );
    assert!(
        short[0].starts_with(
            "note: `learning.learning_rate` ends at env step 600000, but the budget is 6000, after which it has only gone \
             from 0.0015 to 0.001485"
        ),
        "{short:?}"
    );
    let uneven = noted(|p| p.budget = Budget::EnvSteps(5_990));
    assert!(
        uneven[0].contains("the budget is 5990, after which"),
        "not rounded up to a whole control step: {uneven:?}"
    );
    assert_eq!(
        noted(|p| p.budget = Budget::EnvSteps(300_000)),
        [""; 0],
        "a schedule of twice the budget is not long"
    );
    let long = noted(|p| p.budget = Budget::EnvSteps(5_000_000));
    assert_eq!(fields(&long), ["learning.learning_rate"]);
    assert!(
        long[0].contains("most of it with a learning rate of 0.00001; help: end it at 5000000"),
        "{long:?}"
    );
    assert_eq!(noted(|p| p.budget = Budget::EnvSteps(2_000_000)), [""; 0]);
    // With a budget in episodes, each has 1 to 500 env steps, and each of the 16 arenas may have an unfinished one.
    let short = noted(|p| p.budget = Budget::Episodes(10));
    let rate = short.iter().find(|note| note.contains("`learning.learning_rate`")).expect("a note");
    assert!(rate.contains("600000, but the run has at most 13000 env steps, after which it"), "{rate}");
    let long = noted(|p| p.budget = Budget::Episodes(5_000_000));
    assert!(long[0].contains("600000, but the run has at least 5000000 env steps, most of it"), "{long:?}");
}

#[test]
fn schedules_of_every_kind_are_compared_with_the_budget() {
    let rate = |learning_rate, budget| {
        noted(move |p| {
            (p.learning.learning_rate, p.budget) = (learning_rate, Budget::EnvSteps(budget));
            p.learning.replay.sampling = Sampling::Uniform;
            p.learning.exploration = PER_EPISODE;
        })
    };
    let (from, to, env_steps) = (1e-3, 1e-5, 600_000);
    for schedule in [Schedule::Exponential { from, to, env_steps }, Schedule::Cosine { from, to, env_steps }]
    {
        let short = rate(schedule, 60_000);
        assert!(short.len() == 1 && short[0].contains("the budget is 60000, after which"), "{short:?}");
        let long = rate(schedule, 6_000_000);
        assert!(long.len() == 1 && long[0].contains("most of it with a learning rate of"), "{long:?}");
        assert_eq!(rate(schedule, 600_000), [""; 0]);
    }
    let step = |factor, every_env_steps| Schedule::Step { from, factor, every_env_steps };
    let late = rate(step(0.5, 600_001), 600_000);
    assert!(
        late.len() == 1 && late[0].contains("first step at env step 600001, but the budget is 600000"),
        "{late:?}"
    );
    // Halfway through the budget, after 17 steps: 1e-3 x 0.5^17 = 7.6e-9, below 1e-8.
    let low = rate(step(0.5, 10_000), 350_000);
    assert!(low.len() == 1 && low[0].contains("has fallen from 0.001 to 7.6"), "{low:?}");
    assert_eq!(rate(step(0.5, 100_000), 600_000), [""; 0]);
    let high = rate(Schedule::Step { from: 0.5, factor: 0.1, every_env_steps: 100_000 }, 600_000);
    assert!(high.len() == 1 && high[0].contains("is up to 0.5, at which learning diverges"), "{high:?}");
}

#[test]
fn questionable_exploration_is_noted() {
    let exploration = |exploration| move |p: &mut Preset| p.learning.exploration = exploration;
    let per_episode = |start, decay, end| exploration(Exploration::PerEpisode { start, decay, end });
    let field = "note: `learning.exploration` ";
    let none = Exploration::Linear { start: 0.0, end: 0.0, env_steps: 1 };
    assert_noted(exploration(none), field, "no random actions");
    let early = Exploration::Linear { start: 1.0, end: 0.05, env_steps: 500 };
    assert_noted(exploration(early), field, "ends at env step 500, but learning starts at 500, ");
    assert_noted(per_episode(1.0, 0.99, 1.0), field, "random actions only");
    assert_noted(per_episode(1.0, 1.0, 0.05), field, "never decays");
    // 0.999^100 = 0.905.
    let slow = |p: &mut Preset| {
        per_episode(1.0, 0.999, 0.05)(p);
        p.budget = Budget::Episodes(100);
        p.learning.learning_rate = Schedule::Constant(1e-3);
        p.learning.replay.sampling = Sampling::Uniform;
    };
    assert_noted(slow, field, "still has an epsilon of 0.90");
    assert_eq!(noted(per_episode(1.0, 0.99, 0.05)), [""; 0]);
}

#[test]
fn questionable_values_of_the_learner_and_the_evaluation_are_noted() {
    assert_noted(|p| p.learning.gamma = 0.0, "note: `learning.gamma` is 0: ", "only the next reward counts");
    assert_noted(|p| p.learning.gamma = 1.0, "note: `learning.gamma` is 1: ", "no bound");
    // At the rate of 0.0015: 0.0015 x 0.7 = 0.00105, ln 2 / 0.00105 = 660.1.
    assert_noted(
        |p| p.learning.weight_decay = 0.7,
        "note: `learning.weight_decay` is 0.7: ",
        "lose half of their value in 661 gradient steps",
    );
    assert_eq!(noted(|p| p.learning.weight_decay = 0.1), [""; 0]);
    // Of the 600,000 env steps, the 512th is the first with an update, then every 16th: 37,469 updates of 2 gradient steps.
    assert_noted(
        |p| p.learning.target_update = TargetUpdate::Hard { every: 74_939 },
        "note: `learning.target_update.every` is 74939, ",
        "the budget has at most 74938 gradient steps",
    );
    assert_eq!(noted(|p| p.learning.target_update = TargetUpdate::Hard { every: 74_938 }), [""; 0]);
    assert_noted(
        |p| (p.learning.replay.learning_starts, p.learning.exploration) = (400_001, PER_EPISODE),
        "note: `learning.replay.learning_starts` is 400001, ",
        "the replay buffer holds 400000 transitions",
    );
    assert_noted(
        |p| p.evaluation.every_env_steps = 600_001,
        "note: `evaluation.every_env_steps` is 600001, ",
        "so only the first and the last policy are evaluated",
    );
}

#[test]
fn a_run_names_the_file_of_each_note() {
    let mut config = RunConfig::resolve("scenario-1", "fast", 0).expect("shipped");
    assert_eq!(run_notes(&config), []);
    config.preset.reward.collided = 1.0;
    config.scenario.robot.motions.truncate(3);
    config.scenario.robot.motions.iter_mut().for_each(|motion| motion.w_rad_s = 0.0);
    let lines: Vec<String> = run_notes(&config).iter().map(ToString::to_string).collect();
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert!(lines[0].starts_with("scenario-1: `robot.motions` never turn the robot"), "{lines:?}");
    assert!(lines[1].starts_with("fast: `reward.collided` is 1: collisions are rewarded"), "{lines:?}");
}

#[test]
fn the_notes_of_a_run_in_a_set_use_its_longest_time_limit() {
    let mut config = RunConfig::resolve("general", "general", 0).expect("shipped");
    assert_eq!(config.scenario.task.max_episode_steps, 500, "others in the set have 1000");
    config.preset.budget = Budget::Episodes(2_000);
    let most = (2_000 + config.preset.arenas as u64) * 1_000;
    for (every, is_noted) in [(most, false), (most + 1, true)] {
        config.preset.evaluation.every_env_steps = every;
        let notes = run_notes(&config);
        let found = notes.iter().any(|found| found.to_string().contains("`evaluation.every_env_steps`"));
        assert_eq!(found, is_noted, "{notes:?}");
    }
}

#[test]
fn the_notes_of_a_run_with_transfer_use_its_own_epsilon() {
    let mut config = RunConfig::resolve("scenario-1", "fast", 0).expect("shipped");
    config.preset.budget = Budget::EnvSteps(3_000);
    let exploration = |config: &RunConfig| {
        let lines: Vec<String> = run_notes(config).iter().map(ToString::to_string).collect();
        lines.into_iter().find(|line| line.contains("`learning.exploration`")).expect("a note")
    };
    assert!(exploration(&config).contains("has only gone from 1 to "), "{}", exploration(&config));
    config.transfer = Some(Transfer { policy: "p.safetensors".into(), epsilon: None });
    assert!(exploration(&config).contains("has only gone from 1 to "), "without --epsilon, the preset's");
    config.transfer = Some(Transfer { policy: "p.safetensors".into(), epsilon: Some(0.5) });
    assert!(exploration(&config).contains("has only gone from 0.5 to "), "{}", exploration(&config));
}
