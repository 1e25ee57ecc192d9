//! Rewards of steps, ends of episodes, and what continues across a reached goal.

mod common;

use common::{Lab, bits};
use wayfield::scenario::Scenario;
use wayfield::task::{EpisodeEnd, EpisodeEnded, Goal, Pose, RewardConfig, RewardKind, RewardTerms, TaskMode};

/// An arena with the robot at the origin, heading along x, and the goal `ahead_m` in front of it.
fn facing(scenario: &Scenario, ahead_m: f32, reward: RewardConfig, mode: TaskMode) -> Lab {
    let mut lab = Lab::with(scenario, 1, 4, reward, mode);
    let potential = lab.simulation.world().resource::<RewardConfig>().potential(ahead_m, 1.0);
    lab.edit(0, |state| {
        state.pose = Pose::default();
        state.goal = Goal { x_m: ahead_m, y_m: 0.0 };
        state.episode.potential = potential;
    });
    lab
}

#[test]
fn a_reached_goal_gives_250_and_is_redrawn_and_the_episode_continues() {
    let scenario = Scenario::default();
    let reward = RewardConfig::default();
    let mut lab = facing(&scenario, 0.25, reward.clone(), TaskMode::Continuing);
    lab.step(&[2]);
    assert!(!lab.outcomes()[0].reached, "0.22 m is farther than l_a = 0.2 m");
    let before = lab.state(0);
    lab.step(&[2]);
    let (outcome, after) = (lab.outcomes()[0], lab.state(0));
    assert!(outcome.reached && outcome.terminated() && !outcome.truncated(), "0.19 m is nearer than l_a");
    assert_eq!(
        outcome.reward,
        RewardTerms { reached: 250.0, ..RewardTerms::default() },
        "r+ and nothing else"
    );
    assert!(lab.take_ended_episodes().is_empty(), "the episode continues");
    assert_eq!((after.episode.steps, after.episode.goals), (2, 1));
    assert!(
        (after.pose.x_m - 0.06).abs() < 1e-6 && after.pose.y_m == 0.0,
        "the robot has driven, not jumped"
    );
    assert_eq!(after.clock.0, before.clock.0 + 1);
    assert_ne!(after.goal, before.goal, "only the goal is redrawn");

    // The reward of the next step is the decrease of the new goal's potential, computed here in f64.
    let distance =
        |pose: &Pose| f64::from(after.goal.x_m - pose.x_m).hypot(f64::from(after.goal.y_m - pose.y_m));
    let u_before = 50.0 * distance(&after.pose).powi(2);
    let attraction = f64::from(after.episode.potential.attraction);
    assert!((attraction - u_before).abs() < 1e-3, "the potential is that of the new goal");
    lab.step(&[2]);
    let u_after = 50.0 * distance(&lab.state(0).pose).powi(2);
    let terms = lab.outcomes()[0].reward;
    assert!(
        (f64::from(terms.total()) - (u_before - u_after)).abs() < 1e-3 && terms.reached == 0.0,
        "the reward is {terms:?}, but the new goal's potential decreased by {}",
        u_before - u_after
    );
}

#[test]
fn a_collision_costs_200_and_ends_the_episode() {
    let scenario = Scenario::default();
    let mut lab = facing(&scenario, 0.21, RewardConfig::default(), TaskMode::Continuing);
    lab.step(&[2]);
    lab.edit(0, |state| {
        state.pose = Pose { x_m: 1.82, y_m: 0.0, heading_rad: 0.0 };
        state.goal = Goal { x_m: -1.0, y_m: 1.0 };
    });
    let mut sum = lab.outcomes()[0].reward;
    lab.step(&[2]);
    assert!(!lab.outcomes()[0].collided, "0.15 m to the wall is more than l_c = 0.13 m");
    sum += lab.outcomes()[0].reward;
    lab.step(&[2]);
    let outcome = lab.outcomes()[0];
    sum += outcome.reward;
    assert!(outcome.collided && outcome.terminated() && !outcome.truncated(), "0.12 m is less than l_c");
    assert_eq!(
        outcome.reward,
        RewardTerms { collided: -200.0, ..RewardTerms::default() },
        "r- and nothing else"
    );
    let ended = EpisodeEnded {
        arena: 0,
        scenario: 0,
        end: EpisodeEnd::Collided,
        steps: 3,
        goals: 1,
        rewards: sum,
        extra_rewards: Vec::new(),
    };
    assert_eq!(
        lab.take_ended_episodes(),
        vec![ended],
        "the ended episode has its steps, goals and the sum of its rewards"
    );
    let next = lab.state(0);
    assert_eq!((next.episode.steps, next.episode.goals), (0, 0), "a new episode has begun");
    assert_eq!(next.episode.rewards, RewardTerms::default());
    assert!(next.scan.nearest_m > 0.13 && !next.scan.touching, "the new start is clear of everything");
}

#[test]
fn the_time_limit_truncates_an_episode_without_terminating_it() {
    let mut scenario = Scenario::default();
    scenario.task.max_episode_steps = 20;
    let mut lab = facing(&scenario, 1.9, RewardConfig::default(), TaskMode::Continuing);
    let mut sum = RewardTerms::default();
    for step in 1..=20 {
        assert!(lab.take_ended_episodes().is_empty(), "step {step}");
        lab.step(&[0]);
        let outcome = lab.outcomes()[0];
        assert_eq!(outcome.truncated(), step == 20, "step {step} of 20");
        assert!(!outcome.terminated(), "a time limit is not a termination");
        sum += outcome.reward;
    }
    let ended = EpisodeEnded {
        arena: 0,
        scenario: 0,
        end: EpisodeEnd::TimedOut,
        steps: 20,
        goals: 0,
        rewards: sum,
        extra_rewards: Vec::new(),
    };
    assert_eq!(lab.take_ended_episodes(), vec![ended]);
    assert_eq!(lab.state(0).episode.steps, 0, "a new episode has begun");
}

/// Asserts over 400 steps of 16 arenas that the reward of every step agrees with eqs. (3) to (7), computed in f64, and that
/// the rewards of every episode are the sums over its steps.
fn assert_rewards_add_up(scenario: &Scenario, reward: &RewardConfig) {
    let mut scenario = scenario.clone();
    scenario.task.max_episode_steps = 90;
    let arenas = 16;
    let mut lab = Lab::with(&scenario, arenas, 9, reward.clone(), TaskMode::Continuing);
    let mut action_streams = common::action_streams(arenas);
    let mut sums = vec![(RewardTerms::default(), 0, 0); arenas];
    let mut ended = Vec::new();
    let potential = |pose: &Pose, goal: &Goal, nearest_m: f32| {
        let d_g = f64::from(pose.x_m - goal.x_m).hypot(f64::from(pose.y_m - goal.y_m));
        let near = (1.0 - f64::from(nearest_m) / f64::from(reward.l_r_m)).max(0.0);
        (0.5 * f64::from(reward.mu) * d_g * d_g, 0.5 * f64::from(reward.sigma) * near * near)
    };
    let mut repelled = 0;
    for step in 0..400 {
        let before = lab.states();
        let actions = common::steer_to_goal(&lab, &mut action_streams);
        lab.step(&actions);
        let after = lab.states();
        for arena in 0..arenas {
            let outcome = lab.outcomes()[arena];
            let (sum, steps, goals) = &mut sums[arena];
            *sum += outcome.reward;
            *steps += 1;
            *goals += u32::from(outcome.reached);
            if outcome.collided {
                assert_eq!(outcome.reward.total(), -200.0);
            } else if outcome.reached {
                assert_eq!(outcome.reward.total(), 250.0);
            } else if reward.kind == RewardKind::Traditional {
                assert_eq!(
                    outcome.reward,
                    RewardTerms::default(),
                    "eq. (3) gives 0 without goal or collision"
                );
            } else if !outcome.timed_out {
                let from = potential(&before[arena].pose, &before[arena].goal, before[arena].scan.nearest_m);
                let to = potential(&after[arena].pose, &after[arena].goal, after[arena].scan.nearest_m);
                let terms = outcome.reward;
                assert!(
                    (f64::from(terms.attraction) - (from.0 - to.0)).abs() < 1e-3
                        && (f64::from(terms.repulsion) - (from.1 - to.1)).abs() < 1e-3,
                    "step {step}, arena {arena}: {terms:?} is not eq. (7) from {from:?} to {to:?}"
                );
                repelled += usize::from(terms.repulsion != 0.0);
                // The largest possible decrease is about mu d_g |step| = 100 x 4.7 x 0.031.
                assert!(
                    terms.attraction.abs() < 15.0,
                    "a new goal or a reset makes the reward jump: {terms:?}"
                );
            }
        }
        for episode in lab.take_ended_episodes() {
            let (rewards, steps, goals) = std::mem::take(&mut sums[episode.arena]);
            assert_eq!(
                (episode.rewards, episode.steps, episode.goals),
                (rewards, steps, goals),
                "an episode's rewards, steps and goals are those of its steps, bit for bit"
            );
            assert_eq!(lab.outcomes()[episode.arena].collided, episode.end == EpisodeEnd::Collided);
            ended.push(episode);
        }
    }
    assert!(ended.iter().any(|episode| episode.end == EpisodeEnd::Collided));
    assert!(ended.iter().any(|episode| episode.end == EpisodeEnd::TimedOut));
    assert!(ended.iter().any(|episode| episode.goals > 1));
    assert!(
        reward.kind == RewardKind::Traditional || repelled > 100,
        "only {repelled} steps are near obstacles"
    );
}

#[test]
fn optimized_rewards_are_eq_7_step_by_step_and_add_up() {
    assert_rewards_add_up(&common::four_cylinders(), &RewardConfig::default());
    assert_rewards_add_up(
        &common::moving_obstacles(),
        &RewardConfig { mu: 70.0, sigma: 140.0, l_r_m: 0.5, ..RewardConfig::default() },
    );
}

#[test]
fn traditional_rewards_are_eq_3_step_by_step_and_add_up() {
    let reward = RewardConfig { kind: RewardKind::Traditional, ..RewardConfig::default() };
    assert_rewards_add_up(&common::moving_obstacles(), &reward);
}

#[test]
fn a_collision_is_a_nearest_range_below_l_c() {
    let scenario = common::moving_obstacles();
    let mut lab = Lab::new(&scenario, 16, 12);
    let mut action_streams = common::action_streams(16);
    let mut collisions = 0;
    for _ in 0..300 {
        let before = lab.states();
        let actions = common::random_actions(&mut action_streams);
        lab.step(&actions);
        for (arena, after) in lab.states().iter().enumerate() {
            let outcome = lab.outcomes()[arena];
            collisions += usize::from(outcome.collided);
            if !outcome.collided && outcome.episode_end(TaskMode::Continuing).is_none() {
                assert!(after.scan.nearest_m >= 0.13, "an episode that continues has d_o >= l_c");
            }
            if outcome.collided {
                // A step moves robot and obstacle by less than 0.06 m. A corner may lie between two beams.
                assert!(
                    before[arena].scan.nearest_m < 0.13 + 0.2,
                    "an obstacle was near before the collision"
                );
            }
        }
    }
    assert!(collisions > 10, "{collisions}");
}

#[test]
fn after_a_single_goal_episode_the_arena_is_inactive_and_its_state_does_not_change() {
    let mut scenario = common::moving_obstacles();
    scenario.task.max_episode_steps = 60;
    (scenario.lidar.noise_std_m, scenario.lidar.dropout) = (0.02.into(), 0.02.into());
    let arenas = 24;
    let mut lab = Lab::with(&scenario, arenas, 17, RewardConfig::default(), TaskMode::SingleGoal);
    let mut action_streams = common::action_streams(arenas);
    let mut inactive = vec![None; arenas];
    let mut ends = Vec::new();
    for step in 1..=80 {
        let actions = common::steer_to_goal(&lab, &mut action_streams);
        lab.step(&actions);
        let now: Vec<_> = (0..arenas)
            .map(|arena| {
                let bodies = lab.with_physics(arena, |bodies, set, _| {
                    let all = bodies.obstacles.iter().flatten().chain([&bodies.robot]);
                    all.map(|&body| *set.bodies[body].position()).collect::<Vec<_>>()
                });
                (lab.state(arena), bits(&lab.row(arena)), bodies)
            })
            .collect();
        for episode in lab.take_ended_episodes() {
            assert!(inactive[episode.arena].is_none(), "an episode ends once");
            assert!(!lab.outcomes()[episode.arena].inactive, "the step that ends the episode still counts");
            assert!(now[episode.arena].0.episode.inactive);
            inactive[episode.arena] = Some((step, now[episode.arena].clone()));
            ends.push(episode.end);
        }
        for (arena, then) in inactive.iter().enumerate() {
            match then {
                Some((since, then)) if *since < step => {
                    assert!(
                        lab.outcomes()[arena].inactive,
                        "arena {arena} stays inactive after step {since}"
                    );
                    assert_eq!(lab.outcomes()[arena].reward.total(), 0.0);
                    assert_eq!(
                        now[arena].0, then.0,
                        "step {step}: state of arena {arena}, inactive since step {since}"
                    );
                    assert_eq!(now[arena].1, then.1, "step {step}: observation of arena {arena}");
                    assert_eq!(now[arena].2, then.2, "step {step}: bodies of arena {arena}");
                }
                Some(_) => {}
                None => assert_eq!(now[arena].0.clock.0, step, "active arenas continue"),
            }
        }
    }
    assert_eq!(ends.len(), arenas, "every episode has ended");
    for end in [EpisodeEnd::Reached, EpisodeEnd::Collided, EpisodeEnd::TimedOut] {
        assert!(ends.contains(&end), "some episode ends with {end:?}");
    }
}
