//! The replay buffer: stored values, removal of the oldest transitions, sampling probabilities and weights.

use std::collections::VecDeque;

use proptest::prelude::*;
use wayfield_learning::replay::{Batch, ReplayBuffer, StateId, Transition};
use wayfield_learning::{
    Experience, Learner, LearningConfig, NetworkConfig, ReplayConfig, Sampling, Schedule,
};
use wayfield_random::{Stream, stream};

const PENDING: usize = 3;

fn buffer(capacity: usize, sampling: Sampling) -> ReplayBuffer {
    ReplayBuffer::new(&ReplayConfig { capacity, learning_starts: 0, sampling }, 1, PENDING)
}

fn prioritized(alpha: f32, beta: f32) -> Sampling {
    let beta = Schedule::Constant(beta);
    Sampling::Prioritized { alpha, beta, importance_weights: true, epsilon: 0.1 }
}

/// A transition whose reward and discount equal the observations of its two states.
fn tagged_transition(state: (StateId, f32), next: (StateId, f32)) -> Transition {
    Transition {
        state: state.0,
        action: 0,
        reward: state.1,
        discount: next.1,
        next: next.0,
        terminated: false,
        truncated: false,
    }
}

fn sampled(replay: &ReplayBuffer, random: &mut Stream) -> Batch {
    let mut batch = Batch::default();
    replay.sample(64, 0, random, &mut batch);
    batch
}

/// An operation on a buffer.
#[derive(Debug, Clone)]
enum Op {
    /// Store an observation.
    State,
    /// Store a transition between two observations, given by their age: 0 is the latest.
    Transition(usize, usize),
}

fn ops() -> impl Strategy<Value = Vec<Op>> {
    // Mostly recent states, as in episodes; sometimes states that have been overwritten.
    let age = || prop_oneof![3 => 0_usize..4, 1 => 0_usize..40];
    let op = prop_oneof![3 => Just(Op::State), 2 => (age(), age()).prop_map(|(a, b)| Op::Transition(a, b))];
    prop::collection::vec(op, 1..200)
}

proptest! {
    #[test]
    fn no_sample_reads_an_overwritten_state(
        ops in ops(),
        capacity in 1_usize..20,
        by_priority in any::<bool>(),
    ) {
        let sampling = if by_priority { prioritized(1.0, 1.0) } else { Sampling::Uniform };
        let mut replay = buffer(capacity, sampling);
        let mut random = stream(1, "test", 0);
        // The reference: all states, and the stored transitions, found by search instead of by an index.
        let mut states: Vec<(StateId, f32)> = Vec::new();
        let mut stored: VecDeque<(usize, usize)> = VecDeque::new();
        let state_capacity = capacity + capacity / 8 + PENDING + 2;
        let recent_states = (capacity / 2).max(2 * PENDING);
        for op in ops {
            match op {
                Op::State => {
                    if let Some(overwritten) = states.len().checked_sub(state_capacity) {
                        while stored.iter().any(|&(state, next)| state == overwritten || next == overwritten) {
                            stored.pop_front();
                        }
                    }
                    let value = states.len() as f32;
                    states.push((replay.push_state(&[value]), value));
                }
                Op::Transition(a, b) => {
                    let index = |age: usize| states.len().checked_sub(1 + age);
                    let (Some(a), Some(b)) = (index(a), index(b)) else { continue };
                    replay.push(&tagged_transition(states[a], states[b]));
                    let is_newest = |k: usize, count: usize| k + count >= states.len();
                    if is_newest(a, recent_states.min(state_capacity)) && is_newest(b, state_capacity) {
                        if stored.len() == capacity {
                            stored.pop_front();
                        }
                        stored.push_back((a, b));
                    }
                }
            }
            prop_assert_eq!(replay.len(), stored.len(), "as many as in the reference");
            if replay.is_empty() {
                continue;
            }
            let batch = sampled(&replay, &mut random);
            prop_assert_eq!(&batch.states, &batch.returns, "the states are as stored");
            prop_assert_eq!(&batch.next_states, &batch.discounts, "the next states are as stored");
            for (state, next) in batch.states.iter().zip(&batch.next_states) {
                let found = stored.contains(&(*state as usize, *next as usize));
                prop_assert!(found, "{state} -> {next} was removed");
            }
        }
    }

    #[test]
    fn a_return_of_k_rewards_links_states_k_steps_apart_even_if_environments_pause(
        steps in prop::collection::vec((0_usize..3, 0_u8..10), 1..300),
        n_step in 1_usize..5,
        always_truncated in any::<bool>(),
    ) {
        let config = LearningConfig {
            network: NetworkConfig { hidden: vec![], dueling: false, ..NetworkConfig::default() },
            n_step,
            gamma: 1.0,
            batch_size: 8,
            replay: ReplayConfig { capacity: 8, learning_starts: 1_000_000, sampling: Sampling::Uniform },
            ..LearningConfig::default()
        };
        let mut learner = Learner::new(&config, 1, 2, 3, 0).expect("a valid config");
        let mut random = stream(1, "test", 0);
        // Each environment counts up by its own scale with reward 1 per step, so next = state + return x scale.
        let mut at = [0.0_f32; 3];
        let scale = [1.0, 1000.0, 1_000_000.0];
        for (env_index, end) in steps {
            let (observation, next) = (at[env_index], at[env_index] + scale[env_index]);
            let (terminated, truncated) = (end == 0 && !always_truncated, end == 1 || always_truncated);
            learner.store(&Experience {
                env_index,
                observation: &[observation],
                action: 0,
                reward: 1.0,
                next_observation: &[next],
                terminated,
                truncated,
            });
            at[env_index] = if terminated || truncated { 0.0 } else { next };
            if learner.replay().is_empty() {
                continue;
            }
            let batch = sampled(learner.replay(), &mut random);
            for i in 0..64 {
                let (state, next, steps) = (batch.states[i], batch.next_states[i], batch.returns[i]);
                prop_assert!((1.0..=n_step as f32).contains(&steps), "the return has 1 to n rewards");
                let scale = scale.into_iter().find(|s| next - state == s * steps);
                let consistent = batch.discounts[i] == 0.0 || scale.is_some();
                prop_assert!(consistent, "{state} -> {next} in {steps} steps");
            }
        }
    }
}

/// A learner without hidden layers, for observations of one value and two actions.
fn small_learner(n_step: usize, capacity: usize, num_envs: usize) -> Learner {
    let config = LearningConfig {
        network: NetworkConfig { hidden: vec![], dueling: false, ..NetworkConfig::default() },
        n_step,
        batch_size: 4,
        replay: ReplayConfig { capacity, learning_starts: 0, sampling: Sampling::Uniform },
        train_freq: 1,
        gradient_steps: 1,
        ..LearningConfig::default()
    };
    Learner::new(&config, 1, 2, num_envs, 0).expect("a valid config")
}

/// Stores one env step of an episode that goes on.
fn store_step(learner: &mut Learner, env_index: usize) {
    learner.store(&Experience {
        env_index,
        observation: &[0.0],
        action: 0,
        reward: 1.0,
        next_observation: &[0.0],
        terminated: false,
        truncated: false,
    });
}

#[test]
fn an_environment_that_has_paused_removes_no_experience_of_the_others() {
    for pause in 0..200 {
        let mut learner = small_learner(1, 64, 2);
        let others = |steps| std::iter::repeat_n(1, steps);
        for (step, env_index) in
            [0].into_iter().chain(others(pause)).chain([0]).chain(others(200)).enumerate()
        {
            store_step(&mut learner, env_index);
            let stored = learner.replay().len();
            assert!(stored >= (step + 1).min(32), "{stored} at step {step} with a pause of {pause}");
        }
    }
}

/// With many environments and a small buffer, the state of an environment that has paused may be the oldest in the buffer. When it
/// is overwritten, the transition from it is removed, with all older ones.
#[test]
fn no_gradient_step_is_taken_after_a_paused_environment_has_emptied_the_buffer() {
    let mut was_emptied = false;
    for pause in 8..60 {
        let mut learner = small_learner(2, 8, 4);
        let others = std::iter::repeat_n(1, pause);
        for env_index in [0].into_iter().chain(others).chain([0, 2]) {
            store_step(&mut learner, env_index);
        }
        assert!(learner.pending_updates() > 0, "after a pause of {pause} steps");
        let is_empty = learner.replay().is_empty();
        was_emptied |= is_empty;
        assert_eq!(learner.train().expect("no divergence").is_none(), is_empty);
    }
    assert!(was_emptied, "the buffer is emptied after a pause of some length");
}

#[test]
fn a_buffer_of_long_episodes_fills_its_whole_capacity() {
    let mut replay = buffer(80, Sampling::Uniform);
    for episode in 0..40 {
        let mut state = (replay.push_state(&[-1.0]), -1.0);
        for step in 0..10 {
            let value = (episode * 10 + step) as f32;
            let next = (replay.push_state(&[value]), value);
            replay.push(&tagged_transition(state, next));
            state = next;
        }
    }
    assert_eq!(replay.len(), 80, "11 states per 10 transitions fit into the state ring, which is 1/8 larger");
}

/// A buffer of four transitions with the states 0, 1, 2, 3.
fn four(sampling: Sampling) -> ReplayBuffer {
    let mut replay = buffer(6, sampling);
    for i in 0..4 {
        let state = (replay.push_state(&[i as f32]), i as f32);
        replay.push(&tagged_transition(state, state));
    }
    replay
}

#[test]
fn priorities_are_powers_of_td_errors_and_new_transitions_get_the_largest() {
    let mut replay = four(prioritized(0.5, 1.0));
    assert!((0..4).all(|slot| replay.priority(slot) == 1.0), "the first transitions get priority 1");
    // epsilon 0.1: 0.1^0.5, 0.36^0.5, 4^0.5, 1^0.5.
    replay.update_priorities(&[0, 1, 2, 3], &[0.0, -0.26, 3.9, 0.9]);
    for (slot, expected) in [0.316_227_77, 0.6, 2.0, 1.0].into_iter().enumerate() {
        assert!((replay.priority(slot) - expected).abs() < 1e-6, "slot {slot}: {}", replay.priority(slot));
    }
    replay.update_priorities(&[2], &[0.0]);
    let state = (replay.push_state(&[4.0]), 4.0);
    replay.push(&tagged_transition(state, state));
    assert!((replay.priority(4) - 2.0).abs() < 1e-6, "the largest so far, not the current largest");
}

#[test]
fn importance_weights_are_relative_to_the_largest_of_the_batch() {
    let mut replay = four(prioritized(1.0, 0.5));
    let priorities = [0.5_f32, 1.0, 2.0, 4.5];
    replay.update_priorities(&[0, 1, 2, 3], &priorities.map(|p| p - 0.1));
    let batch = sampled(&replay, &mut stream(1, "test", 0));
    let raw = |p: f32| (4.0 * p / 8.0).powf(-0.5);
    for (&slot, &weight) in batch.slots.iter().zip(&batch.weights) {
        let expected = raw(priorities[slot]) / raw(0.5);
        assert!((weight - expected).abs() < 1e-5, "slot {slot}: weight {weight} instead of {expected}");
    }
    let count = batch.slots.iter().filter(|&&slot| slot == 0).count();
    assert_eq!(count, 4, "stratified sampling draws slot 0 in exactly 0.5 / 8 of 64 draws");
}

#[test]
fn uniform_sampling_has_equal_probabilities_and_weights_of_one() {
    let replay = four(Sampling::Uniform);
    let mut random = stream(1, "test", 0);
    let mut counts = [0.0_f64; 4];
    for _ in 0..1000 {
        let batch = sampled(&replay, &mut random);
        assert!(batch.weights.iter().all(|&w| w == 1.0));
        batch.slots.iter().for_each(|&slot| counts[slot] += 1.0);
    }
    // A fair sampler exceeds this chi-square (3 degrees of freedom) once in a thousand times.
    let chi_square: f64 = counts.iter().map(|n| (n - 16_000.0).powi(2) / 16_000.0).sum();
    assert!(chi_square < 16.3, "chi-square {chi_square}: {counts:?}");
}
