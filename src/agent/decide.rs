//! `Decide`: the batch of observations becomes a batch of actions by one forward pass.
//!
//! In: [`Observations`], the learner's network or a fixed policy, epsilon. Out: [`Actions`], and for whoever watches
//! the Q-values and which actions were explored ([`Decisions`]).

use bevy::prelude::*;

use super::ActiveLearner;
use crate::learning::{QNetwork, epsilon_greedy, greedy};
use crate::random::{self, Stream};
use crate::task::{Actions, Observations};

/// How actions are chosen.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActionSelection {
    /// Epsilon-greedily with the network in training ([`ActiveLearner`]).
    EpsilonGreedy,
    /// Greedily with a fixed policy ([`GreedyPolicy`]).
    Greedy,
    /// Each arena by a driver of its own ([`ActionSources`]); nothing is remembered or learnt.
    PerArena,
}

/// The policy that [`ActionSelection::Greedy`] follows.
#[derive(Resource)]
pub struct GreedyPolicy(pub QNetwork);

/// Who drives, where [`ActionSelection::PerArena`] is followed.
#[derive(Resource, Default)]
pub struct ActionSources {
    /// The driver of each arena, by number.
    pub arenas: Vec<ActionSource>,
    /// From how many motions they choose.
    pub num_actions: usize,
}

/// Who drives an arena.
pub enum ActionSource {
    /// A policy, greedily.
    Policy(QNetwork),
    /// A hand, which holds this motion.
    Manual(usize),
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
    action_selection: Res<ActionSelection>,
    trainer: Option<Res<ActiveLearner>>,
    policy: Option<Res<GreedyPolicy>>,
    drivers: Option<Res<ActionSources>>,
    observations: Res<Observations>,
    mut decisions: ResMut<Decisions>,
    mut actions: ResMut<Actions>,
) {
    let decisions = &mut *decisions;
    let arenas = actions.0.len();
    match (*action_selection, trainer, policy, drivers) {
        (ActionSelection::EpsilonGreedy, Some(trainer), ..) => {
            let learner = &trainer.0;
            learner.q_values(&observations.current, arenas, &mut decisions.q_values);
            let (epsilon, width) = (learner.epsilon(), decisions.q_values.len() / arenas);
            for (arena, row) in decisions.q_values.chunks_exact(width).enumerate() {
                (actions.0[arena], decisions.explored[arena]) =
                    epsilon_greedy(row, epsilon, &mut decisions.streams[arena]);
            }
        }
        (ActionSelection::Greedy, _, Some(policy), _) => {
            policy.0.q_values(&observations.current, arenas, &mut decisions.q_values);
            let width = decisions.q_values.len() / arenas;
            for (action, row) in actions.0.iter_mut().zip(decisions.q_values.chunks_exact(width)) {
                *action = greedy(row);
            }
            decisions.explored.fill(false);
        }
        (ActionSelection::PerArena, _, _, Some(drivers)) => {
            let mut row = Vec::new();
            decisions.q_values.clear();
            decisions.explored.fill(false);
            for (arena, driver) in drivers.arenas.iter().enumerate().take(arenas) {
                match driver {
                    ActionSource::Policy(network) => {
                        network.q_values(observations.row(arena), 1, &mut row);
                        actions.0[arena] = greedy(&row);
                    }
                    ActionSource::Manual(motion) => {
                        // A hand values nothing in numbers; its row keeps the others in their places.
                        row.clear();
                        row.resize(drivers.num_actions, f32::NAN);
                        actions.0[arena] = (*motion).min(drivers.num_actions.saturating_sub(1));
                    }
                }
                decisions.q_values.extend_from_slice(&row);
            }
        }
        // Without a network to ask, the robots stand by their last action.
        _ => {}
    }
}
