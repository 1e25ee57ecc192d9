//! Toy tasks with known values, which a correct learner solves in seconds: a bandit, a chain, a stochastic reward, a time
//! limit, a corridor and its mirror image. Each task depends on one part of the algorithm.

use wayfield_learning::{
    Activation, Experience, Exploration, Learner, LearningConfig, Loss, Mirror, NetworkConfig, Optimizer,
    ReplayConfig, Sampling, Schedule, TargetUpdate, epsilon_greedy,
};
use wayfield_random::{Stream, stream, uniform_01};

const PRIORITIZED: Sampling = Sampling::Prioritized {
    alpha: 0.6,
    beta: Schedule::Constant(1.0),
    importance_weights: true,
    epsilon: 1e-3,
};

/// Random actions (Q-learning is off-policy), a small network and fast target updates.
fn config(gamma: f32, sampling: Sampling) -> LearningConfig {
    LearningConfig {
        network: NetworkConfig { hidden: vec![32], ..NetworkConfig::default() },
        gamma,
        loss: Loss::MeanSquared,
        optimizer: Optimizer::Adam { beta1: 0.9, beta2: 0.999, epsilon: 1e-8 },
        learning_rate: Schedule::Linear { from: 3e-3, to: 1e-5, env_steps: 6000 },
        batch_size: 32,
        replay: ReplayConfig { capacity: 10_000, learning_starts: 200, sampling },
        target_update: TargetUpdate::Soft { tau: 0.02 },
        exploration: Exploration::Linear { start: 1.0, end: 1.0, env_steps: 1 },
        ..LearningConfig::default()
    }
}

/// Both kinds of sampling, each with a plain DQN and a double dueling DQN.
fn variants(gamma: f32) -> Vec<LearningConfig> {
    let mut all = Vec::new();
    for sampling in [Sampling::Uniform, PRIORITIZED] {
        for double in [false, true] {
            let mut config = config(gamma, sampling);
            config.double = double;
            config.network.dueling = double;
            all.push(config);
        }
    }
    all
}

/// Configs with one option of the network, the update or the learning rate changed, and one with several of them.
fn switched(gamma: f32) -> Vec<LearningConfig> {
    let (from, to, env_steps) = (3e-3, 1e-5, 6000);
    let changes: [fn(&mut LearningConfig); 7] = [
        |c| c.network.layer_norm = true,
        |c| c.network.activation = Activation::Elu,
        |c| c.network.activation = Activation::Silu,
        |c| c.network.activation = Activation::Tanh,
        |c| c.max_gradient_norm = Some(0.1),
        |c| c.weight_decay = 1e-3,
        |c| {
            (c.network.layer_norm, c.network.activation) = (true, Activation::Silu);
            (c.max_gradient_norm, c.weight_decay) = (Some(1.0), 1e-4);
        },
    ];
    let schedules = [
        Schedule::Exponential { from, to, env_steps },
        Schedule::Cosine { from, to, env_steps },
        Schedule::Step { from, factor: 0.3, every_env_steps: 2000 },
    ];
    let base = || config(gamma, PRIORITIZED);
    let changed = changes.into_iter().map(|change| {
        let mut config = base();
        change(&mut config);
        config
    });
    changed.chain(schedules.map(|learning_rate| LearningConfig { learning_rate, ..base() })).collect()
}

/// The result of a step: reward, next state, terminated, truncated.
type StepResult = (f32, usize, bool, bool);

/// The Q-values of each state after learning `task` for `steps` env steps. The task has `states` states, observed one-hot,
/// and starts in state 0.
fn learn(
    config: &LearningConfig,
    states: usize,
    actions: usize,
    steps: usize,
    task: impl FnMut(usize, usize, &mut Stream) -> StepResult,
) -> Vec<Vec<f32>> {
    let learner = Learner::new(config, states, actions, 1, 3).expect("a valid config");
    learn_with(learner, (0, steps), task)
}

/// Like [`learn`], with a given learner, for a task that starts in state `start`.
fn learn_with(
    mut learner: Learner,
    (start, steps): (usize, usize),
    mut task: impl FnMut(usize, usize, &mut Stream) -> StepResult,
) -> Vec<Vec<f32>> {
    let (states, actions) = (learner.network().shape().inputs, learner.network().shape().actions);
    let one_hot = |state: usize| (0..states).map(|i| f32::from(u8::from(i == state))).collect::<Vec<_>>();
    let mut random = stream(3, "test", 0);
    let (mut state, mut q) = (start, Vec::new());
    for _ in 0..steps {
        learner.q_values(&one_hot(state), 1, &mut q);
        let (action, _) = epsilon_greedy(&q, learner.epsilon(), &mut random);
        let (reward, next, terminated, truncated) = task(state, action, &mut random);
        learner.store(&Experience {
            env_index: 0,
            observation: &one_hot(state),
            action,
            reward,
            next_observation: &one_hot(next),
            terminated,
            truncated,
        });
        state = if terminated || truncated { start } else { next };
        learner.train().expect("no divergence");
    }
    let all: Vec<f32> = (0..states).flat_map(one_hot).collect();
    learner.q_values(&all, states, &mut q);
    q.chunks(actions).map(<[f32]>::to_vec).collect()
}

fn close(found: f32, expected: f32, within: f32, what: &str) {
    assert!((found - expected).abs() < within, "{what}: {found} instead of {expected}");
}

#[test]
fn bandit_values_are_the_rewards() {
    for config in variants(0.9) {
        let q = learn(&config, 1, 3, 4000, |_, action, _| ([0.0, 1.0, -0.5][action], 0, true, false));
        for (found, expected) in q[0].iter().zip([0.0, 1.0, -0.5]) {
            close(*found, expected, 0.02, &format!("{:?} in {config:?}", q[0]));
        }
    }
}

/// A step in a chain of the states 0 to 4. Action 0 moves left, action 1 moves right, action 2 stays in place. Moving right
/// from 4 gives reward 1 and terminates.
fn chain(state: usize, action: usize, _: &mut Stream) -> StepResult {
    match (state, action) {
        (4, 1) => (1.0, 4, true, false),
        (_, 1) => (0.0, state + 1, false, false),
        (_, 0) => (0.0, state.saturating_sub(1), false, false),
        _ => (0.0, state, false, false),
    }
}

/// The values of moving left and right in the chain with a discount of 0.9: Q(s, left) = 0.9 V(s - 1),
/// Q(s, right) = V(s) = 0.9^(4 - s). Moving left in state 0 stays there.
fn chain_values(state: usize) -> (f32, f32) {
    (0.9 * 0.9_f32.powi(5 - state.max(1) as i32), 0.9_f32.powi(4 - state as i32))
}

#[test]
fn chain_values_are_the_discounted_final_reward() {
    for config in variants(0.9).into_iter().chain(switched(0.9)) {
        let q = learn(&config, 5, 2, 8000, chain);
        for (state, q) in q.iter().enumerate() {
            let (left, right) = chain_values(state);
            close(q[1], right, 0.04, &format!("right from {state} in {config:?}"));
            close(q[0], left, 0.04, &format!("left from {state} in {config:?}"));
        }
    }
}

#[test]
fn advantage_learning_doubles_the_gap_to_the_best_action_and_keeps_its_value() {
    // Three actions: staying in place loses 0.1 V(s), and moving left loses more, except in state 0.
    let config = LearningConfig { advantage_learning: 0.5, ..config(0.9, PRIORITIZED) };
    let q = learn(&config, 5, 3, 12_000, chain);
    for (state, q) in q.iter().enumerate() {
        let (left, right) = chain_values(state);
        close(q[1], right, 0.04, &format!("right from {state}"));
        close(q[2], right - 2.0 * (right - 0.9 * right), 0.04, &format!("staying in {state}"));
        close(q[0], right - 2.0 * (right - left), 0.04, &format!("left from {state}"));
    }
}

#[test]
fn quantiles_of_a_chain_have_the_known_values() {
    let loss = Loss::Huber { delta: 1.0 };
    let config = LearningConfig { quantiles: 8, loss, ..config(0.9, PRIORITIZED) };
    let q = learn(&config, 5, 2, 8000, chain);
    for (state, q) in q.iter().enumerate() {
        let (left, right) = chain_values(state);
        close(q[1], right, 0.05, &format!("right from {state}"));
        close(q[0], left, 0.05, &format!("left from {state}"));
    }
}

#[test]
fn quantiles_show_the_distribution_of_a_stochastic_reward() {
    // 2 with probability 0.3, otherwise 0: the quantiles below 0.7 are 0, the others are 2. With a small delta, the loss is
    // close to that of quantile regression; with a large one, the quantiles move towards the mean.
    let loss = Loss::Huber { delta: 0.02 };
    let config = LearningConfig { quantiles: 10, loss, ..config(0.9, Sampling::Uniform) };
    let mut learner = Learner::new(&config, 1, 1, 1, 3).expect("a valid config");
    let mut random = stream(3, "test", 0);
    for _ in 0..8000 {
        let reward = if uniform_01(&mut random) < 0.3 { 2.0 } else { 0.0 };
        learner.store(&Experience {
            env_index: 0,
            observation: &[1.0],
            action: 0,
            reward,
            next_observation: &[1.0],
            terminated: true,
            truncated: false,
        });
        learner.train().expect("no divergence");
    }
    let mut quantiles = Vec::new();
    learner.network().quantile_values(&[1.0], 1, &mut quantiles);
    for (i, quantile) in quantiles.iter().enumerate() {
        close(*quantile, if i < 7 { 0.0 } else { 2.0 }, 0.1, &format!("quantile {i} of {quantiles:?}"));
    }
}

/// The learned value of a reward that is 1 with probability 0.3, otherwise 0.
fn coin(sampling: Sampling) -> f32 {
    learn(&config(0.9, sampling), 1, 1, 6000, |_, _, random| {
        (f32::from(u8::from(uniform_01(random) < 0.3)), 0, true, false)
    })[0][0]
}

#[test]
fn the_value_of_a_stochastic_reward_is_its_mean() {
    close(coin(Sampling::Uniform), 0.3, 0.03, "uniform");
    let alpha_1 = |importance_weights| {
        let beta = Schedule::Constant(1.0);
        coin(Sampling::Prioritized { alpha: 1.0, beta, importance_weights, epsilon: 1e-3 })
    };
    close(alpha_1(true), 0.3, 0.03, "prioritized, with importance weights");
    // Without weights, sampling by |error| balances 0.3 (1 - q)^2 and 0.7 q^2, which gives q = 1 / (1 + sqrt(7 / 3)) = 0.396.
    close(alpha_1(false), 0.396, 0.03, "prioritized, without importance weights: the known bias");
}

#[test]
fn a_time_limit_bootstraps() {
    // One state, reward 1 per step, truncated every 5 steps. The value is that of an endless task, 1 / (1 - 0.9).
    for n_step in [1, 3] {
        let mut config = config(0.9, PRIORITIZED);
        config.n_step = n_step;
        let mut steps = 0;
        let q = learn(&config, 1, 2, 6000, |_, _, _| {
            steps += 1;
            (1.0, 0, false, steps % 5 == 0)
        });
        close(q[0][0], 10.0, 0.3, &format!("with {n_step}-step returns"));
    }
}

#[test]
fn a_termination_does_not_bootstrap() {
    // The same rewards, but the episode terminates after 5 steps, and the state is the index of the step.
    for n_step in [1, 3] {
        let mut config = config(0.9, PRIORITIZED);
        config.n_step = n_step;
        let q = learn(&config, 5, 2, 6000, |state, _, _| (1.0, (state + 1) % 5, state == 4, false));
        for (state, q) in q.iter().enumerate() {
            let left = 5 - state as i32;
            let finite = (1.0 - 0.9_f32.powi(left)) / (1.0 - 0.9);
            close(q[0], finite, 0.1, &format!("{left} steps before the end, {n_step}-step returns"));
        }
    }
}

/// The learned Q-values in a corridor whose goal lies in its middle, between state 2 and state 3. Action 0 moves left, action 1
/// right. Every episode starts at the right end, in state 5, and ends at the goal with the reward 1. State 5 - s is the mirror
/// image of state s.
fn corridor_from_the_right(mirror: bool) -> Vec<Vec<f32>> {
    let config = LearningConfig { mirror, ..config(0.9, PRIORITIZED) };
    let mut learner = Learner::new(&config, 6, 2, 1, 3).expect("a valid config");
    let inputs = (0..6).rev().map(|state| (state, 1.0)).collect();
    learner.set_mirror(Mirror::new(inputs, vec![1, 0]).expect("an involution")).expect("the same sizes");
    learn_with(learner, (5, 8000), |state, action, _| match (state, action) {
        (3, 0) => (1.0, 3, true, false),
        (_, 0) => (0.0, state - 1, false, false),
        _ => (0.0, (state + 1).min(5), false, false),
    })
}

#[test]
fn with_mirror_augmentation_the_mirrored_side_is_learned_without_being_visited() {
    let (plain, mirrored) = (corridor_from_the_right(false), corridor_from_the_right(true));
    let error_on_the_left = |q: &[Vec<f32>]| {
        let error = |state: usize| (q[state][1] - 0.9_f32.powi(2 - state as i32)).abs();
        (0..3).map(error).fold(0.0, f32::max)
    };
    assert!(error_on_the_left(&plain) > 0.2, "without it, the left side is unknown: {plain:?}");
    for (state, q) in mirrored.iter().enumerate() {
        let steps = if state < 3 { 2 - state } else { state - 3 } as i32;
        let (towards, away) = if state < 3 { (1, 0) } else { (0, 1) };
        close(q[towards], 0.9_f32.powi(steps), 0.04, &format!("to the goal from {state}"));
        let back = 0.9 * 0.9_f32.powi((steps + 1).min(2));
        close(q[away], back, 0.04, &format!("away from the goal from {state}"));
    }
}
