//! The vectorized environment follows Gymnasium's conventions, and plugins extend observation and reward.

use std::sync::Arc;

use bevy::prelude::*;
use wayfield::env::{Autoreset, VecEnv, VecEnvConfig, VecEnvError};
use wayfield::random::{stream, uniform_index};
use wayfield::run::shipped;
use wayfield::scenario::{Motion, Obstacle, ObstacleMotion, PlacementRule, Scenario, Shape, vec2};
use wayfield::simulation::{Extensions, SimulationBuilder};
use wayfield::task::{
    Arena, EpisodeEnd, ExtraRewards, ObservationLayout, RewardTerm, SensorReadings, SensorSlice,
    SimulationAppExt, StepOutcomes, TaskMode, Twist,
};

fn env(num_envs: usize, mode: TaskMode) -> VecEnv {
    let mut scenario = shipped::scenario("scenario-1").expect("shipped");
    scenario.task.max_episode_steps = 40;
    VecEnv::new(&scenario, VecEnvConfig { num_envs, mode, ..VecEnvConfig::default() }).expect("free space")
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// The observations and rewards of environment 0 over 200 random steps after `reset(seed)`.
fn rollout(env: &mut VecEnv, seed: u64) -> Vec<Vec<u32>> {
    let mut streams: Vec<_> = (0..env.num_envs() as u64).map(|k| stream(1, "actions", k)).collect();
    let (width, num_actions) = (env.observation_width(), env.num_actions());
    let mut numbers = vec![bits(&env.reset(seed).expect("free space")[..width])];
    for _ in 0..200 {
        let actions: Vec<usize> =
            streams.iter_mut().map(|stream| uniform_index(stream, num_actions)).collect();
        let step = env.step(&actions).expect("a valid step");
        numbers.push(bits(&step.observations[..width]));
        numbers.push(bits(&step.rewards[..1]));
    }
    numbers
}

#[test]
fn the_same_seed_gives_the_same_bits_after_any_history_and_for_any_number_of_environments() {
    let mut one = env(1, TaskMode::Episodic);
    let first = rollout(&mut one, 7);
    assert_eq!(rollout(&mut one, 7), first, "a second reset");
    assert_eq!(rollout(&mut env(9, TaskMode::Episodic), 7), first, "nine environments");
    assert_ne!(rollout(&mut one, 8), first, "a different seed");
}

#[test]
fn an_ended_episode_is_followed_by_a_new_one_and_its_final_observation_is_returned() {
    let mut env = env(4, TaskMode::Episodic);
    let width = env.observation_width();
    env.reset(3).expect("free space");
    let mut ended = 0;
    for _ in 0..400 {
        let step = env.step(&[2; 4]).expect("a valid step");
        for k in 0..4 {
            let row = k * width..(k + 1) * width;
            let (next, last) = (&step.observations[row.clone()], &step.final_observations[row]);
            assert!(!(step.terminated[k] && step.truncated[k]), "a step never terminates and truncates");
            if step.terminated[k] || step.truncated[k] {
                ended += 1;
                assert_ne!(next, last, "a new episode has another start");
                assert!(step.ended.iter().any(|episode| episode.arena == k));
            } else {
                assert_eq!(next, last, "without a reset, both observations are the same");
            }
        }
    }
    assert!(ended > 10, "only {ended} episodes ended");
}

#[test]
fn the_mode_decides_whether_an_episode_ends_at_the_goal() {
    // The goal is straight ahead of the start.
    let scenario = Scenario::parse(
        "(
            name: \"Straight ahead\",
            starts: Fixed(position_m: (-0.3, 0.0), heading_rad: 0.0),
            goals: Fixed(position_m: (0.5, 0.0)),
        )",
        "test",
    )
    .unwrap_or_else(|error| panic!("{error}"));
    for (mode, ends) in [(TaskMode::Episodic, 1), (TaskMode::Continuing, 0)] {
        let config = VecEnvConfig { mode, ..VecEnvConfig::default() };
        let mut env = VecEnv::new(&scenario, config).expect("free space");
        let mut reached = 0;
        let mut episodes = 0;
        for _ in 0..2_000 {
            let step = env.step(&[2]).expect("a valid step");
            if step.outcomes[0].reached {
                reached += 1;
                episodes += step.ended.iter().filter(|episode| episode.end == EpisodeEnd::Reached).count();
                assert!(step.terminated[0], "a reached goal terminates the return");
            }
        }
        assert!(reached > 5, "{mode:?}: the goal was reached only {reached} times");
        assert_eq!(episodes, reached * ends, "{mode:?}");
    }
}

#[test]
fn an_episode_that_ended_in_a_failed_step_is_not_reported_after_the_reset() {
    // The episode ends after two steps, when the obstacle covers all starts.
    let obstacle = Obstacle {
        shape: Shape::Circle { radius_m: 0.3 },
        position_m: vec2(-1.0, 1.5),
        rotation_rad: 0.0,
        motion: ObstacleMotion::Patrol { waypoints_m: vec![vec2(-1.0, 0.0)], speed_m_s: 3.75.into() },
    };
    let (min_m, max_m) = (vec2(-1.05, -0.05), vec2(-0.95, 0.05));
    let mut scenario = Scenario {
        obstacles: vec![obstacle],
        starts: PlacementRule::Within { min_m, max_m, clearance_m: 0.2 },
        ..Scenario::default()
    };
    scenario.task.max_episode_steps = 2;
    let mut env = VecEnv::new(&scenario, VecEnvConfig::default()).expect("free space");
    env.step(&[2]).expect("a valid step");
    let error = env.step(&[2]).expect_err("no start is free").to_string();
    assert!(error.contains("no free space for a start"), "{error}");
    env.reset(7).expect("free space");
    assert!(env.step(&[2]).expect("a valid step").ended.is_empty(), "no episode has ended since the reset");
}

/// One environment of Scenario I with a time limit of 40 steps.
fn one_env(mode: TaskMode, autoreset: Autoreset) -> VecEnv {
    let mut scenario = shipped::scenario("scenario-1").expect("shipped");
    scenario.task.max_episode_steps = 40;
    VecEnv::new(&scenario, VecEnvConfig { mode, autoreset, ..VecEnvConfig::default() }).expect("free space")
}

#[test]
fn the_episodes_are_the_same_in_all_autoreset_modes() {
    for mode in [TaskMode::Episodic, TaskMode::Continuing] {
        let modes = [Autoreset::SameStep, Autoreset::NextStep, Autoreset::Disabled];
        let mut envs = modes.map(|autoreset| one_env(mode, autoreset));
        envs.iter_mut().for_each(|env| assert!(env.reset(3).is_ok()));
        let mut random = stream(1, "actions", 0);
        let mut ends = 0;
        for _ in 0..600 {
            let action = [uniform_index(&mut random, 5)];
            let [same, next, off] = envs.each_mut().map(|env| {
                let step = env.step(&action).expect("a valid step");
                let ended = step.terminated[0] || step.truncated[0];
                (ended, bits(step.rewards), bits(step.final_observations), bits(step.observations))
            });
            assert_eq!(same.1, next.1, "{mode:?}: rewards");
            assert!((same.0, &same.1, &same.2) == (off.0, &off.1, &off.2), "{mode:?}: with autoreset off");
            assert_eq!(same.2, next.3, "{mode:?}: the last observation of an episode is returned first");
            if same.0 {
                ends += 1;
                let step = envs[1].step(&action).expect("a valid step");
                assert_eq!(
                    (step.rewards, step.terminated, step.truncated),
                    (&[0.0][..], &[false][..], &[false][..])
                );
                assert_eq!(bits(step.observations), same.3, "{mode:?}: then the first of the next one");
                assert_eq!(envs[2].step(&action).expect_err("ended"), VecEnvError::Ended { env: 0 });
                assert_eq!(bits(envs[2].reset_selected(&[true], None).expect("free space")), same.3);
            }
        }
        assert!(ends > 15, "{mode:?}: only {ends} ends");
    }
}

#[test]
fn a_commanded_motion_drives_like_the_action_with_that_motion() {
    let mut envs = [(); 2].map(|()| one_env(TaskMode::Continuing, Autoreset::SameStep));
    let motions = shipped::scenario("scenario-1").expect("shipped").robot.motions;
    envs.iter_mut().for_each(|env| assert!(env.reset(5).is_ok()));
    let mut random = stream(1, "actions", 0);
    for _ in 0..200 {
        let action = uniform_index(&mut random, motions.len());
        let one = bits(envs[0].step(&[action]).expect("a valid step").observations);
        let two = bits(envs[1].step_motions(&[motions[action]]).expect("a valid step").observations);
        assert_eq!(one, two);
    }
    let (low, high) = envs[0].motion_limits();
    assert_eq!((low.v_m_s, high.v_m_s, low.w_rad_s, high.w_rad_s), (0.0, 0.15, -1.5, 1.5));
    let reckless = Motion { v_m_s: 9.0, w_rad_s: -9.0 };
    let limited = Motion { v_m_s: 0.15, w_rad_s: -1.5 };
    let [one, two] = [reckless, limited].map(|motion| {
        envs[0].reset(6).expect("free space");
        bits(envs[0].step_motions(&[motion]).expect("a valid step").observations)
    });
    assert_eq!(one, two, "a motion is limited to the robot's range");
    let broken = Motion { v_m_s: f32::NAN, w_rad_s: 0.0 };
    assert_eq!(envs[0].step_motions(&[broken]).expect_err("not a number"), VecEnvError::Motion { env: 0 });
}

#[test]
fn a_commanded_motion_of_a_car_keeps_its_minimum_turning_radius() {
    let mut car = shipped::scenario("empty").expect("shipped");
    let motion = |v_m_s, w_rad_s| Motion { v_m_s, w_rad_s };
    car.robot.min_turning_radius_m = Some(0.5);
    car.robot.motions = vec![motion(0.2, 0.4), motion(0.2, -0.4), motion(0.2, 0.0)];
    let mut env = VecEnv::new(&car, VecEnvConfig::default()).expect("a valid scenario");
    let mut after = |command: Motion| {
        env.reset(6).expect("free space");
        bits(env.step_motions(&[command]).expect("a valid step").observations)
    };
    assert_eq!(after(motion(0.1, 0.4)), after(motion(0.1, 0.2)), "0.1 m/s on a circle of radius 0.5 m");
    assert_eq!(after(motion(0.0, 0.4)), after(motion(0.0, 0.0)), "it can't turn on the spot");
    assert_ne!(after(motion(0.2, 0.4)), after(motion(0.2, 0.2)));
}

#[test]
fn an_invalid_action_is_an_error_that_names_it() {
    let mut env = env(2, TaskMode::Episodic);
    let error = env.step(&[0]).expect_err("one action for two environments");
    assert_eq!(error, VecEnvError::ActionCount { given: 1, num_envs: 2 });
    let error = env.step(&[0, 5]).expect_err("action 5 of five actions");
    assert_eq!(error.to_string(), "action 5 of environment 1 is out of range: the robot has actions 0 to 4");
}

/// Sensors of the robot's speed and the arena's number; reward terms of 1 in every arena and of -2 in odd arenas.
#[derive(Clone)]
struct Extras;

impl Plugin for Extras {
    fn build(&self, app: &mut App) {
        app.add_sensor("speed", 1, |slice: SensorSlice| {
            move |mut arenas: Query<(&Twist, &mut SensorReadings)>| {
                for (twist, mut readings) in &mut arenas {
                    readings.slice_mut(&slice)[0] = twist.v_m_s;
                }
            }
        })
        .add_sensor("arena", 1, |slice: SensorSlice| {
            move |mut arenas: Query<(&Arena, &mut SensorReadings)>| {
                for (arena, mut readings) in &mut arenas {
                    readings.slice_mut(&slice)[0] = arena.0 as f32;
                }
            }
        })
        .add_reward_term("alive", |term: RewardTerm| {
            move |mut rewards: ResMut<ExtraRewards>, arenas: Query<&Arena>| {
                arenas.iter().for_each(|arena| rewards.set(arena.0, term, 1.0));
            }
        })
        .add_reward_term("odd", |term: RewardTerm| {
            move |mut rewards: ResMut<ExtraRewards>, arenas: Query<&Arena>| {
                for arena in arenas.iter().filter(|arena| arena.0 % 2 == 1) {
                    rewards.set(arena.0, term, -2.0);
                }
            }
        });
    }
}

#[test]
fn sensors_and_reward_terms_of_plugins_extend_observation_and_reward() {
    let scenario = shipped::scenario("empty").expect("shipped");
    let config = VecEnvConfig { num_envs: 3, ..VecEnvConfig::default() };
    let extras = VecEnvConfig { extensions: Extensions::default().plugin(Extras), ..config.clone() };
    let mut plain = VecEnv::new(&scenario, config).expect("free space");
    let mut extended = VecEnv::new(&scenario, extras).expect("free space");
    assert_eq!(extended.observation_width(), plain.observation_width() + 2);
    let width = extended.observation_width();
    for _ in 0..20 {
        let plain = plain.step(&[2; 3]).expect("a valid step");
        let extended = extended.step(&[2; 3]).expect("a valid step");
        for k in 0..3 {
            let row = &extended.final_observations[k * width..(k + 1) * width];
            assert_eq!(row[width - 2..], [0.15, k as f32], "the robot drives at 0.15 m/s");
            let extra = if k % 2 == 1 { -1.0 } else { 1.0 };
            assert_eq!(extended.rewards[k], plain.rewards[k] + extra);
        }
    }
}

#[test]
fn plugins_extend_a_simulation_from_the_builder_too() {
    let scenario = Arc::new(shipped::scenario("scenario-2").expect("shipped"));
    let extensions = Extensions::default().plugin(Extras);
    let (sensors, terms) = extensions.describe();
    assert_eq!(sensors.iter().map(|slice| slice.name.as_str()).collect::<Vec<_>>(), ["speed", "arena"]);
    assert_eq!(terms, ["alive", "odd"]);
    let mut simulation = SimulationBuilder::new(&scenario).arenas(2).extensions(&extensions).build();
    simulation.step().expect("a valid step");
    let layout = simulation.world().resource::<ObservationLayout>();
    assert_eq!(layout.width(24), 30);
    let outcomes = &simulation.world().resource::<StepOutcomes>().0;
    assert_eq!(outcomes.iter().map(|outcome| outcome.extra_reward).collect::<Vec<_>>(), [1.0, -1.0]);
}

#[test]
fn a_run_with_plugins_resumes_bit_for_bit_and_only_with_the_same_plugins() {
    use std::sync::atomic::AtomicBool;
    use std::time::Instant;
    use wayfield::run::folder::RunConfig;
    use wayfield::run::preset::Budget;
    use wayfield::run::train::{CHECKPOINT_INTERVAL, Job, train};

    let folder = tempfile::tempdir().expect("a temporary folder");
    let extensions = Extensions::default().plugin(Extras);
    let never = AtomicBool::new(false);
    let run = |job| train(job, CHECKPOINT_INTERVAL, &never, Instant::now(), Some(Box::new(|_| ())));
    let new = |name: &str, env_steps| {
        let mut config =
            RunConfig::resolve("scenario-1", "fast", 3).expect("shipped").with_extensions(&extensions);
        config.preset.budget = Budget::EnvSteps(env_steps);
        Job::New { config: Box::new(config), policy: None, out: Some(folder.path().join(name)) }
    };
    run(new("whole", 6_400)).expect("a complete run");
    run(new("parts", 3_200)).expect("the first part");
    let resume = |extensions: &Extensions| Job::Resume {
        folder: folder.path().join("parts"),
        budget: Some(Budget::EnvSteps(6_400)),
        extensions: extensions.clone(),
    };
    let error = run(resume(&Extensions::default())).expect_err("the plugins are missing").to_string();
    assert!(error.contains("other sensor or reward plugins"), "{error}");
    run(resume(&extensions)).expect("the second part");
    let policy = |name: &str| {
        std::fs::read(folder.path().join(name).join("policy-last.safetensors")).expect("a file of the run")
    };
    assert!(policy("whole") == policy("parts"), "both runs have the same weights bit for bit");
    let rows = |name: &str| {
        let text = std::fs::read_to_string(folder.path().join(name).join("episodes.csv"))
            .expect("a file of the run");
        // Without the wall time.
        let wall =
            text.lines().next().and_then(|header| header.split(',').position(|column| column == "wall_s"));
        let keep = |line: &str| -> Vec<String> {
            line.split(',')
                .enumerate()
                .filter(|(k, _)| Some(*k) != wall)
                .map(|(_, cell)| cell.into())
                .collect()
        };
        text.lines().map(keep).collect::<Vec<_>>()
    };
    assert!(rows("whole")[0].ends_with(&["reward_alive".to_string(), "reward_odd".to_string()]));
    assert_eq!(rows("whole"), rows("parts"));
}
