//! TD targets, the return bound, divergence.

use super::update::{all_finite, td_targets, widen_gaps};
use super::*;
use crate::Schedule;
use crate::replay::Batch;

/// Two transitions with the returns 1 and 2 and the discounts 0.9 and 0 (terminated).
fn batch() -> Batch {
    Batch { returns: vec![1.0, 2.0], discounts: vec![0.9, 0.0], ..Batch::default() }
}

#[test]
fn a_dqn_target_uses_the_largest_value_of_the_target_network() {
    let (target_q, mut y) = ([3.0, 5.0, 4.0, 70.0, 80.0, 90.0], Vec::new());
    td_targets(&batch(), &target_q, &target_q, &mut y);
    assert_eq!(y, [1.0 + 0.9 * 5.0, 2.0], "r + 0.9 x max, and r alone if terminated");
}

#[test]
fn a_double_dqn_target_uses_the_target_networks_value_of_the_online_networks_choice() {
    let (target_q, online_q, mut y) =
        ([3.0, 5.0, 4.0, 70.0, 80.0, 90.0], [9.0, 1.0, 2.0, 0.0, 0.0, 1.0], Vec::new());
    td_targets(&batch(), &online_q, &target_q, &mut y);
    assert_eq!(
        y,
        [1.0 + 0.9 * 3.0, 2.0],
        "the online network prefers action 0, whose value in the target network is 3"
    );
}

#[test]
fn with_quantiles_each_transition_has_a_target_for_each_quantile_of_the_best_action() {
    // Two quantiles of three actions for each of two transitions.
    let target_z = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let (choosing_q, mut y) = ([0.0, 9.0, 1.0, 0.0, 0.0, 1.0], Vec::new());
    td_targets(&batch(), &choosing_q, &target_z, &mut y);
    assert_eq!(y, [1.0 + 0.9 * 2.0, 1.0 + 0.9 * 5.0, 2.0, 2.0]);
    widen_gaps(&[0, 1], &[3.0, 5.0, 4.0, 3.0, 5.0, 4.0], 0.5, &mut y);
    assert_eq!(y, [1.0 + 0.9 * 2.0 - 1.0, 1.0 + 0.9 * 5.0 - 1.0, 2.0, 2.0], "lowered by half the gap of 2");
}

#[test]
fn advantage_learning_lowers_the_targets_of_all_but_the_best_actions() {
    let mut targets = [1.0, 1.0, 1.0];
    widen_gaps(&[0, 1, 2], &[3.0, 5.0, 4.0, 3.0, 5.0, 4.0, 3.0, 5.0, 4.0], 0.5, &mut targets);
    assert_eq!(targets, [1.0 - 0.5 * 2.0, 1.0, 1.0 - 0.5 * 1.0]);
}

#[test]
fn q_values_above_the_largest_possible_return_are_reported_after_50_gradient_steps() {
    // Rewards of up to 2, scaled to 1, give returns of up to 1 / (1 - 0.9) = 10. Advantage learning of weight 0.5 allows Q-values
    // up to 1.5 / 0.5 = 3 times as large.
    for (advantage_learning, q) in [(0.0, 10.5), (0.5, 31.5)] {
        let mut config =
            LearningConfig { gamma: 0.9, batch_size: 1, advantage_learning, ..LearningConfig::default() };
        (config.replay.learning_starts, config.train_freq, config.gradient_steps) = (1, 1, 1);
        (config.reward_scale, config.learning_rate) = (0.5, Schedule::Constant(1e-6));
        let mut learner = Learner::new(&config, 1, 2, 1, 0).expect("a valid config");
        // All Q-values are `q`.
        learner.online.update(|weights| weights.fill(0.0));
        let bias = learner.online.shape().parameters().into_iter().find(|view| view.name == "value.bias");
        let bias = bias.expect("the paper's network is dueling").range.start;
        learner.online.update(|weights| weights[bias] = q);
        let step = |reward| Experience {
            env_index: 0,
            observation: &[0.0],
            action: 0,
            reward,
            next_observation: &[0.0],
            terminated: true,
            truncated: false,
        };
        let mut after = |reward, times: u64| {
            let mut last = None;
            for _ in 0..times {
                learner.store(&step(reward));
                last = learner.train().expect("no divergence").expect("a pending update").overestimate;
            }
            last
        };
        assert_eq!(
            after(0.0, 60),
            None,
            "before the first reward other than 0, nothing is known about returns"
        );
        assert_eq!(after(-2.0, 49), None, "49 gradient steps are not enough");
        let found = after(-2.0, 1).expect("the Q-values exceed the bound for the 50th time");
        assert_eq!((found.gradient_step, found.env_step, found.largest_reward), (110, 110, 1.0));
        assert!((found.q - q).abs() < 1e-3, "{found}");
        assert!((found.largest_return - 10.0).abs() < 1e-5, "{found}");
        // A reward of 2.2, scaled to 1.1, raises the bound by a tenth.
        assert_eq!(after(2.2, 1), None);
    }
}

#[test]
fn a_gradient_with_an_infinite_square_is_a_divergence() {
    let mut config = LearningConfig { batch_size: 1, ..LearningConfig::default() };
    (config.replay.learning_starts, config.train_freq, config.gradient_steps) = (1, 1, 1);
    let mut learner = Learner::new(&config, 1, 2, 1, 0).expect("a valid config");
    // The TD error is about 4e18, whose square is finite in f32. The input of 100 makes the gradient a hundred times larger.
    let (observation, next_observation) = (&[100.0], &[0.0]);
    let reward = 4e18;
    learner.store(&Experience {
        env_index: 0,
        observation,
        action: 0,
        reward,
        next_observation,
        terminated: true,
        truncated: false,
    });
    let diverged = learner.train().expect_err("an infinite square").to_string();
    assert!(diverged.contains("the square of a gradient is not finite"), "{diverged}");
}

#[test]
fn non_finite_values_are_detected() {
    assert!(all_finite(&[0.0, -1.0, f32::MAX, f32::MIN_POSITIVE / 2.0]));
    for bad in [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert!(!all_finite(&[1.0, bad, 1.0]), "{bad}");
    }
}

#[test]
fn a_replay_buffer_with_too_many_observation_values_is_rejected() {
    let mut config = LearningConfig::default();
    config.replay.capacity = 1 << 24;
    let error = Learner::new(&config, 1000, 5, 1, 0).expect_err("2^24 observations of 1000 numbers");
    assert_eq!(error.field, "replay.capacity", "{error}");
}

#[test]
fn a_learner_can_be_shared_between_threads() {
    fn shareable<T: Send + Sync + 'static>() {}
    shareable::<Learner>();
    shareable::<Policy>();
}
