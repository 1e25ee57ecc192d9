//! The replay buffer gives back what went in, drops the oldest first, and draws as promised.

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

/// A transition that tells in its reward and discount which observations it belongs to.
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

/// What can happen to a buffer.
#[derive(Debug, Clone)]
enum Op {
    /// A new observation.
    State,
    /// A transition between two observations, so many before the latest.
    Transition(usize, usize),
}

fn ops() -> impl Strategy<Value = Vec<Op>> {
    // Mostly recent states, as in chains; sometimes ones so old that they are gone.
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
        // The model: all states ever, and the transitions kept, by a search where the buffer keeps an index.
        let mut states: Vec<(StateId, f32)> = Vec::new();
        let mut kept: VecDeque<(usize, usize)> = VecDeque::new();
        let room = capacity + capacity / 8 + PENDING + 2;
        for op in ops {
            match op {
                Op::State => {
                    if let Some(gone) = states.len().checked_sub(room) {
                        while kept.iter().any(|&(state, next)| state == gone || next == gone) {
                            kept.pop_front();
                        }
                    }
                    let value = states.len() as f32;
                    states.push((replay.push_state(&[value]), value));
                }
                Op::Transition(a, b) => {
                    let before = |age: usize| states.len().checked_sub(1 + age);
                    let (Some(a), Some(b)) = (before(a), before(b)) else { continue };
                    replay.push(&tagged_transition(states[a], states[b]));
                    if a.min(b) + room >= states.len() {
                        if kept.len() == capacity {
                            kept.pop_front();
                        }
                        kept.push_back((a, b));
                    }
                }
            }
            prop_assert_eq!(replay.len(), kept.len(), "as many as the model keeps");
            if replay.is_empty() {
                continue;
            }
            let batch = sampled(&replay, &mut random);
            prop_assert_eq!(&batch.states, &batch.rewards, "the state is the one that was stored");
            prop_assert_eq!(&batch.next_states, &batch.discounts, "and so is the next");
            for (state, next) in batch.states.iter().zip(&batch.next_states) {
                let found = kept.contains(&(*state as usize, *next as usize));
                prop_assert!(found, "{state} -> {next} was dropped");
            }
        }
    }

    #[test]
    fn arenas_may_stand_still_and_episodes_be_of_any_length(
        steps in prop::collection::vec((0_usize..3, 0_u8..10), 1..300),
        n_step in 1_usize..5,
        always_truncated in any::<bool>(),
    ) {
        let config = LearningConfig {
            network: NetworkConfig { hidden: vec![], dueling: false },
            n_step,
            gamma: 1.0,
            batch_size: 8,
            replay: ReplayConfig { capacity: 8, learning_starts: 1_000_000, sampling: Sampling::Uniform },
            ..LearningConfig::default()
        };
        let mut learner = Learner::new(&config, 1, 2, 3, 0).expect("a sound config");
        let mut random = stream(1, "test", 0);
        // Each arena counts up by its own power of ten, reward 1 a step: so next = state + return x that
        // power.
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
                let (state, next, steps) = (batch.states[i], batch.next_states[i], batch.rewards[i]);
                prop_assert!((1.0..=n_step as f32).contains(&steps), "a return over 1 to n steps");
                let scale = scale.into_iter().find(|s| next - state == s * steps);
                let joined = batch.discounts[i] == 0.0 || scale.is_some();
                prop_assert!(joined, "{state} -> {next} in {steps} steps");
            }
        }
    }
}

#[test]
fn a_full_buffer_of_long_episodes_keeps_its_whole_capacity() {
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
    assert_eq!(replay.len(), 80, "11 states for 10 transitions fit the 1/8 more states");
}

/// Four transitions, told apart by their states 0, 1, 2, 3.
fn four(sampling: Sampling) -> ReplayBuffer {
    let mut replay = buffer(6, sampling);
    for i in 0..4 {
        let state = (replay.push_state(&[i as f32]), i as f32);
        replay.push(&tagged_transition(state, state));
    }
    replay
}

#[test]
fn priorities_are_powers_of_td_errors_and_newcomers_get_the_largest() {
    let mut replay = four(prioritized(0.5, 1.0));
    assert!((0..4).all(|slot| replay.priority(slot) == 1.0), "the first enter with priority 1");
    // epsilon 0.1: 0.1^0.5, 0.36^0.5, 4^0.5, 1^0.5.
    replay.update_priorities(&[0, 1, 2, 3], &[0.0, -0.26, 3.9, 0.9]);
    for (slot, expected) in [0.316_227_77, 0.6, 2.0, 1.0].into_iter().enumerate() {
        assert!((replay.priority(slot) - expected).abs() < 1e-6, "slot {slot}: {}", replay.priority(slot));
    }
    replay.update_priorities(&[2], &[0.0]);
    let state = (replay.push_state(&[4.0]), 4.0);
    replay.push(&tagged_transition(state, state));
    assert!((replay.priority(4) - 2.0).abs() < 1e-6, "the largest so far, not the largest now");
}

#[test]
fn importance_weights_are_n_p_to_the_minus_beta_over_the_largest() {
    let mut replay = four(prioritized(1.0, 0.5));
    let priorities = [0.5_f32, 1.0, 2.0, 4.5];
    replay.update_priorities(&[0, 1, 2, 3], &priorities.map(|p| p - 0.1));
    let batch = sampled(&replay, &mut stream(1, "test", 0));
    let raw = |p: f32| (4.0 * p / 8.0).powf(-0.5);
    for (&slot, &weight) in batch.slots.iter().zip(&batch.weights) {
        let expected = raw(priorities[slot]) / raw(0.5);
        assert!((weight - expected).abs() < 1e-5, "slot {slot}: weight {weight}, not {expected}");
    }
    assert!(batch.slots.contains(&0), "64 draws reach a transition of 1/16 (and stratified ones 4 times)");
    assert_eq!(batch.slots.iter().filter(|&&slot| slot == 0).count(), 4, "stratified: 0.5 / 8 of 64 draws");
}

#[test]
fn uniform_weights_are_one_and_draws_even() {
    let replay = four(Sampling::Uniform);
    let mut random = stream(1, "test", 0);
    let mut counts = [0.0_f64; 4];
    for _ in 0..1000 {
        let batch = sampled(&replay, &mut random);
        assert!(batch.weights.iter().all(|&w| w == 1.0));
        batch.slots.iter().for_each(|&slot| counts[slot] += 1.0);
    }
    // Pearson's chi-square with 3 degrees of freedom exceeds 16.3 in one of a thousand fair samplers.
    let chi_square: f64 = counts.iter().map(|n| (n - 16_000.0).powi(2) / 16_000.0).sum();
    assert!(chi_square < 16.3, "chi-square {chi_square}: {counts:?}");
}
