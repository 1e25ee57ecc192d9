//! Checkpoints with invalid values and a valid checksum.

use super::*;
use crate::config::{NetworkConfig, Optimizer, ReplayConfig, Sampling, Schedule};
use crate::learner::Experience;
use crate::n_step::{PendingStep, StepEnd};
use crate::state_ring::StateId;
use wayfield_random::Stream;

/// A learner whose ring buffers have wrapped around, and its config.
fn learner() -> (LearningConfig, Learner) {
    let beta = Schedule::Constant(0.4);
    let sampling = Sampling::Prioritized { alpha: 0.6, beta, importance_weights: true, epsilon: 0.01 };
    let config = LearningConfig {
        network: NetworkConfig { hidden: vec![3], ..NetworkConfig::default() },
        n_step: 3,
        batch_size: 2,
        optimizer: Optimizer::Adam { beta1: 0.9, beta2: 0.999, epsilon: 1e-8 },
        replay: ReplayConfig { capacity: 8, learning_starts: 0, sampling },
        ..LearningConfig::default()
    };
    let mut learner = Learner::new(&config, 2, 2, 1, 1).expect("a valid config");
    for step in 0..30 {
        learner.store(&Experience {
            env_index: 0,
            observation: &[step as f32, 0.0],
            action: step % 2,
            reward: 1.0,
            next_observation: &[step as f32 + 1.0, 0.0],
            terminated: step % 9 == 8,
            truncated: false,
        });
        learner.train().expect("no divergence");
    }
    (config, learner)
}

fn restored(config: &LearningConfig, learner: &Learner) -> Result<Learner, CheckpointError> {
    let mut bytes = Vec::new();
    learner.save(&mut bytes).expect("memory can be written");
    Learner::restore(config, 2, 2, 1, &bytes[..])
}

/// The expected error, and the change to a learner that causes it when the learner is saved and restored.
type Change = (&'static str, fn(&mut Learner));

#[test]
fn invalid_values_are_rejected_even_if_the_checksum_matches() {
    let (config, valid) = learner();
    let mut again = restored(&config, &valid).expect("a valid checkpoint");
    assert_eq!(again.counters, valid.counters);
    again.train().expect("no divergence");
    let changes: &[Change] = &[
        ("a weight is not finite", |l| l.online.update(|weights| weights[3] = f32::NAN)),
        ("a weight is not finite", |l| l.target.update(|weights| weights[0] = f32::INFINITY)),
        ("its number of optimizer moments does not match the config", |l| l.optimizer.second.truncate(2)),
        ("an optimizer moment is invalid", |l| l.optimizer.first[1] = f32::NAN),
        ("an optimizer moment is invalid", |l| l.optimizer.second[1] = -1.0),
        ("a counter is too large", |l| l.optimizer.steps = u64::MAX),
        ("a counter is too large", |l| l.counters.env_steps = u64::MAX),
        ("a counter is too large", |l| l.counters.episodes = u64::MAX),
        ("its number of pending updates is invalid", |l| l.counters.pending_updates = u32::MAX),
        ("its epsilon is not between 0 and 1", |l| l.counters.epsilon_start = Some(f32::NAN)),
        ("the state of its random stream is invalid", |l| {
            let zero = postcard::to_allocvec(&0_u128).expect("a number");
            l.counters.sampling = postcard::from_bytes::<Stream>(&zero).expect("a state");
        }),
        ("its largest priority is invalid", |l| {
            if let Some(priorities) = &mut l.replay.priorities {
                priorities.largest = 1e300;
            }
        }),
        ("a trajectory is invalid", |l| l.trajectories[0].last = Some(StateId(1 << 40))),
        ("a trajectory is invalid", |l| {
            let step = PendingStep { state: StateId(1 << 40), action: 0, reward: 0.0 };
            l.trajectories[0].n_step.push(step, StateId(0), StepEnd::Ongoing, (9, 0.9), |_| ());
        }),
        ("an observation is not finite", |l| l.replay.states.values[3] = f32::NAN),
        ("a transition refers to a missing state or action", |l| l.replay.transitions[2].next = u32::MAX),
        ("a transition refers to a missing state or action", |l| l.replay.transitions[2].action = 2),
        ("a transition's reward or discount is invalid", |l| l.replay.transitions[1].reward = f32::NAN),
        ("a transition's reward or discount is invalid", |l| l.replay.transitions[1].discount = 1.5),
        ("a priority is invalid", |l| set_priority(l, |head, _| head, f64::INFINITY)),
        ("a priority is invalid", |l| set_priority(l, |_, tail| tail - 1, 0.0)),
        ("a removed transition has a priority", |l| {
            l.replay.head += 1;
        }),
    ];
    for (expected, change) in changes {
        let mut changed = valid.clone();
        change(&mut changed);
        match restored(&config, &changed) {
            Err(CheckpointError::Corrupt(why)) => assert_eq!(why, *expected),
            other => panic!("{expected}: {:?}", other.map(|_| ())),
        }
    }
}

#[test]
fn an_invalid_random_stream_of_the_mirror_is_rejected() {
    let (config, _) = learner();
    let config = LearningConfig { mirror: true, ..config };
    let mut learner = Learner::new(&config, 2, 2, 1, 1).expect("a valid config");
    restored(&config, &learner).expect("a valid checkpoint");
    let zero = postcard::to_allocvec(&0_u128).expect("a number");
    learner.mirror_stream = Some(postcard::from_bytes(&zero).expect("a state"));
    let error = restored(&config, &learner).expect_err("an invalid stream").to_string();
    assert!(error.contains("the state of its mirror's random stream is invalid"), "{error}");
}

/// Sets the priority of the transition with the sequence number `which(head, tail)`.
fn set_priority(learner: &mut Learner, which: fn(u64, u64) -> u64, priority: f64) {
    let slot = learner.replay.slot(which(learner.replay.head, learner.replay.tail));
    if let Some(priorities) = &mut learner.replay.priorities {
        priorities.tree.set(slot, priority);
    }
}
