//! `Decide`: the batch of observations becomes a batch of actions by one forward pass.
//!
//! In: [`Observations`], the learner's network or a fixed policy, epsilon. Out: [`Actions`], and for whoever watches
//! the Q-values and which actions were explored ([`Decisions`]).

use bevy::prelude::*;

use super::Trainer;
use crate::learning::Policy;
use crate::learning::exploration::{epsilon_greedy, greedy};
use crate::random::{self, Stream};
use crate::task::{Actions, Observations};

/// How actions are chosen.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acting {
    /// Epsilon-greedily with the network in training ([`Trainer`]).
    Exploring,
    /// Greedily with a fixed policy ([`GreedyPolicy`]).
    Greedy,
    /// Each arena by a driver of its own ([`Drivers`]); nothing is remembered or learnt.
    Driven,
}

/// The policy that [`Acting::Greedy`] follows.
#[derive(Resource)]
pub struct GreedyPolicy(pub Policy);

/// Who drives, where [`Acting::Driven`] is followed.
#[derive(Resource, Default)]
pub struct Drivers {
    /// The driver of each arena, by number.
    pub arenas: Vec<Driver>,
    /// From how many motions they choose.
    pub motions: usize,
}

/// Who drives an arena.
pub enum Driver {
    /// A policy, greedily.
    Policy(Policy),
    /// A hand, which holds this motion.
    Hand(usize),
}

/// What was decided, and the streams by which arenas explore.
#[derive(Resource)]
pub struct Decisions {
    /// Q-values of the last decision: arenas x actions.
    pub q_values: Vec<f32>,
    /// Whether an arena's last action was a random one.
    pub explored: Vec<bool>,
    /// The exploration stream of each arena.
    pub streams: Vec<Stream>,
}

impl Decisions {
    /// Nothing decided yet, streams at their start.
    #[must_use]
    pub fn new(seed: u64, arenas: usize) -> Self {
        Self {
            q_values: Vec::new(),
            explored: vec![false; arenas],
            streams: (0..arenas as u64).map(|k| random::stream(seed, "exploration", k)).collect(),
        }
    }
}

/// `Decide`: epsilon-greedy or greedy, for all arenas at once.
pub(super) fn decide(
    acting: Res<Acting>,
    trainer: Option<Res<Trainer>>,
    policy: Option<Res<GreedyPolicy>>,
    drivers: Option<Res<Drivers>>,
    observations: Res<Observations>,
    mut decisions: ResMut<Decisions>,
    mut actions: ResMut<Actions>,
) {
    let decisions = &mut *decisions;
    let arenas = actions.0.len();
    match (*acting, trainer, policy, drivers) {
        (Acting::Exploring, Some(trainer), ..) => {
            let learner = &trainer.0;
            learner.q_values(&observations.current, arenas, &mut decisions.q_values);
            let (epsilon, width) = (learner.epsilon(), decisions.q_values.len() / arenas);
            for (arena, row) in decisions.q_values.chunks_exact(width).enumerate() {
                (actions.0[arena], decisions.explored[arena]) =
                    epsilon_greedy(row, epsilon, &mut decisions.streams[arena]);
            }
        }
        (Acting::Greedy, _, Some(policy), _) => {
            policy.0.network.q_values(&observations.current, arenas, &mut decisions.q_values);
            let width = decisions.q_values.len() / arenas;
            for (action, row) in actions.0.iter_mut().zip(decisions.q_values.chunks_exact(width)) {
                *action = greedy(row);
            }
            decisions.explored.fill(false);
        }
        (Acting::Driven, _, _, Some(drivers)) => {
            let mut row = Vec::new();
            decisions.q_values.clear();
            decisions.explored.fill(false);
            for (arena, driver) in drivers.arenas.iter().enumerate().take(arenas) {
                match driver {
                    Driver::Policy(policy) => {
                        policy.network.q_values(observations.row(arena), 1, &mut row);
                        actions.0[arena] = greedy(&row);
                    }
                    Driver::Hand(motion) => {
                        // A hand values nothing in numbers; its row keeps the others in their places.
                        row.clear();
                        row.resize(drivers.motions, f32::NAN);
                        actions.0[arena] = (*motion).min(drivers.motions.saturating_sub(1));
                    }
                }
                decisions.q_values.extend_from_slice(&row);
            }
        }
        // Without a network to ask, the robots stand by their last action.
        _ => {}
    }
}
