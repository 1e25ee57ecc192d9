//! Tiny tasks whose values are known, which a right learner learns in seconds: a bandit, a chain, a
//! stochastic reward, a time limit. Each leaves one part of the algorithm nowhere to hide.

use wayfield_learning::{
    Experience, Exploration, Learner, LearningConfig, Loss, NetworkConfig, Optimizer, ReplayConfig, Sampling,
    Schedule, TargetUpdate, epsilon_greedy,
};
use wayfield_random::{Stream, stream, uniform_01};

const PRIORITIZED: Sampling = Sampling::Prioritized {
    alpha: 0.6,
    beta: Schedule::Constant(1.0),
    importance_weights: true,
    epsilon: 1e-3,
};

/// Always random actions (Q-learning is off-policy), small network, quick target.
fn config(gamma: f32, sampling: Sampling) -> LearningConfig {
    LearningConfig {
        network: NetworkConfig { hidden: vec![32], dueling: true },
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

/// Both samplings, single and double, plain and dueling.
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

/// What a step of a task leads to: reward, next state, terminated, truncated.
type StepResult = (f32, usize, bool, bool);

/// Learns a task of `states` states (observed one-hot, start at 0) for `steps`, and gives Q row by row.
fn learn(
    config: &LearningConfig,
    states: usize,
    actions: usize,
    steps: usize,
    mut task: impl FnMut(usize, usize, &mut Stream) -> StepResult,
) -> Vec<Vec<f32>> {
    let one_hot = |state: usize| (0..states).map(|i| f32::from(u8::from(i == state))).collect::<Vec<_>>();
    let mut learner = Learner::new(config, states, actions, 1, 3).expect("a sound config");
    let mut random = stream(3, "test", 0);
    let (mut state, mut q) = (0, Vec::new());
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
        state = if terminated || truncated { 0 } else { next };
        learner.train().expect("it does not diverge");
    }
    let all: Vec<f32> = (0..states).flat_map(one_hot).collect();
    learner.q_values(&all, states, &mut q);
    q.chunks(actions).map(<[f32]>::to_vec).collect()
}

fn close(found: f32, expected: f32, within: f32, what: &str) {
    assert!((found - expected).abs() < within, "{what}: {found}, not {expected}");
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

#[test]
fn chain_values_are_the_discounted_reward_at_its_end() {
    // States 0 to 4; action 1 goes right, 0 left; right from 4 brings 1 and ends. Q(s, right) = 0.9^(4 - s),
    // and Q(s, left) = 0.9 V(s - 1): five backups deep.
    for config in variants(0.9) {
        let q = learn(&config, 5, 2, 8000, |state, action, _| match (state, action) {
            (4, 1) => (1.0, 4, true, false),
            (_, 1) => (0.0, state + 1, false, false),
            _ => (0.0, state.saturating_sub(1), false, false),
        });
        for (state, q) in q.iter().enumerate() {
            let right = 0.9_f32.powi(4 - state as i32);
            let left = 0.9 * 0.9_f32.powi(5 - state.max(1) as i32);
            close(q[1], right, 0.04, &format!("right from {state} in {config:?}"));
            close(q[0], left, 0.04, &format!("left from {state} in {config:?}"));
        }
    }
}

/// Learns the value of a reward that is 1 in 3 of 10 cases, else 0.
fn coin(sampling: Sampling) -> f32 {
    learn(&config(0.9, sampling), 1, 1, 6000, |_, _, random| {
        (f32::from(u8::from(uniform_01(random) < 0.3)), 0, true, false)
    })[0][0]
}

#[test]
fn a_stochastic_rewards_value_is_its_mean() {
    close(coin(Sampling::Uniform), 0.3, 0.03, "uniform");
    let alpha_1 = |importance_weights| {
        let beta = Schedule::Constant(1.0);
        coin(Sampling::Prioritized { alpha: 1.0, beta, importance_weights, epsilon: 1e-3 })
    };
    close(alpha_1(true), 0.3, 0.03, "prioritized, with importance weights");
    // Without weights, drawing by |error| balances 0.3 (1 - q)^2 against 0.7 q^2: q = 1 / (1 + sqrt(7 / 3)) =
    // 0.396.
    close(
        alpha_1(false),
        0.396,
        0.03,
        "prioritized without importance weights is biased, and by how much is known",
    );
}

#[test]
fn a_time_limit_is_bootstrapped_through() {
    // One state, reward 1 a step, cut after 5 steps, unseen by the robot: an endless task of value 1 / (1 -
    // 0.9).
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
fn a_termination_is_not() {
    // The same five steps, but now they are all there is, and the state tells which it is.
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
