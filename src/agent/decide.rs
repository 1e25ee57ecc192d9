//! Action selection (`Decide`): one forward pass turns the batch of observations into a batch of actions.
//!
//! In: [`Observations`], epsilon, and the learner's network, a fixed policy or a source per arena. Out: [`Actions`]; for
//! display, the Q-values and which actions were random ([`Decisions`]).

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

use super::ActiveLearner;
use super::drive::DriverSource;
use crate::drivers::{motion_limits, relative_motion};
use crate::learning::{QNetwork, epsilon_greedy, greedy};
use crate::policy::{ActionSet, Decider};
use crate::random::{self, Stream};
use crate::scenario::Motion;
use crate::task::{
    Actions, ActiveActionSet, Arena, ArenaLayout, Episode, ObservationLayout, Observations, ScanMemory, Twist,
};

/// The method that selects actions.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActionSelection {
    /// Epsilon-greedy with the network in training ([`ActiveLearner`]).
    EpsilonGreedy,
    /// Greedy with a fixed policy ([`GreedyPolicy`]).
    Greedy,
    /// By a separate source per arena ([`ActionSources`]). Nothing is stored or learned.
    PerArena,
}

/// The network of [`ActionSelection::Greedy`].
#[derive(Resource)]
pub struct GreedyPolicy(pub QNetwork);

/// The sources of actions for [`ActionSelection::PerArena`].
#[derive(Resource, Default)]
pub struct ActionSources {
    /// The source of each arena, by arena number.
    pub arenas: Vec<ActionSource>,
    /// The number of possible actions.
    pub num_actions: usize,
}

/// The source of the actions of one arena.
pub enum ActionSource {
    /// The greedy action of a network.
    Policy(QNetwork),
    /// The user, with the action that is selected at the moment.
    Manual(usize),
    /// A classical driver, or a policy used as a driver, with or without a map.
    Driver(DriverSource),
}

/// The last decisions, and the random streams of exploration.
#[derive(Resource)]
pub struct Decisions {
    /// The Q-values of the last decision: arenas x actions; NaN in arenas that a driver or the user controls.
    pub q_values: Vec<f32>,
    /// Whether the last action of each arena was random.
    pub explored: Vec<bool>,
    /// The exploration stream of each arena.
    pub streams: Vec<Stream>,
    /// The memory of each arena's decisions. Only policies with relative actions use it, outside training.
    deciders: Vec<Decider>,
}

impl Decisions {
    /// Makes the initial state: no decisions yet, and the streams of `seed`.
    #[must_use]
    pub(crate) fn new(seed: u64, arenas: usize) -> Self {
        Self {
            q_values: Vec::new(),
            explored: vec![false; arenas],
            streams: (0..arenas as u64).map(|k| random::stream(seed, "exploration", k)).collect(),
            deciders: Vec::new(),
        }
    }
}

/// What decisions depend on besides the source of the actions.
#[derive(SystemParam)]
pub(super) struct Robots<'w, 's> {
    observations: Res<'w, Observations>,
    action_set: Res<'w, ActiveActionSet>,
    layout: Res<'w, ObservationLayout>,
    arenas: Query<
        'w,
        's,
        (&'static Arena, &'static Episode, &'static Twist, &'static ArenaLayout, &'static ScanMemory),
    >,
}

impl Robots<'_, '_> {
    /// Chooses among [relative actions](ActionSet::Relative) as [`Decider::choose`] does, in the arenas for which `is_policy` is
    /// true. In the others, the deciders only sense. Does nothing if actions are the robot's motions.
    fn choose(&self, decisions: &mut Decisions, is_policy: impl Fn(usize) -> bool, actions: &mut Actions) {
        let ActionSet::Relative(motions) = &self.action_set.0 else { return };
        let Decisions { q_values, deciders, .. } = decisions;
        deciders.resize(actions.0.len(), Decider::default());
        let width = motions.len();
        for (arena, episode, twist, layout, memory) in &self.arenas {
            let row = q_values.get(arena.0 * width..(arena.0 + 1) * width);
            let (Some(row), Some(decider)) = (row, deciders.get_mut(arena.0)) else { continue };
            let robot = &layout.scenario.robot;
            let limits = motion_limits(robot);
            if episode.steps == 0 {
                *decider = Decider::default();
            }
            decider.sense((twist.v_m_s, twist.w_rad_s), &limits);
            if !is_policy(arena.0) {
                continue;
            }
            let moves = self.layout.encoding.shows_motion(self.observations.row(arena.0));
            let motion = |action: usize| {
                let Motion { v_m_s, w_rad_s } = relative_motion(motions[action], robot, &limits);
                (v_m_s, w_rad_s)
            };
            let steps_to_collision = |first, then| {
                let observer = memory.observer();
                observer.map_or(f32::INFINITY, |observer| observer.steps_to_collision(first, then))
            };
            actions.0[arena.0] = decider.choose(row, motion, moves, steps_to_collision);
        }
    }
}

/// `Decide`: selects the actions of all arenas.
pub(super) fn decide(
    action_selection: Res<ActionSelection>,
    learner: Option<Res<ActiveLearner>>,
    policy: Option<Res<GreedyPolicy>>,
    sources: Option<Res<ActionSources>>,
    robots: Robots,
    mut decisions: ResMut<Decisions>,
    mut actions: ResMut<Actions>,
) {
    let (observations, decisions) = (&robots.observations, &mut *decisions);
    let arenas = actions.0.len();
    match (*action_selection, learner, policy, sources) {
        (ActionSelection::EpsilonGreedy, Some(learner), ..) => {
            let learner = &learner.0;
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
            robots.choose(decisions, |_| true, &mut actions);
            decisions.explored.fill(false);
        }
        (ActionSelection::PerArena, _, _, Some(sources)) => {
            let mut row = Vec::new();
            decisions.q_values.clear();
            decisions.explored.fill(false);
            for (arena, source) in sources.arenas.iter().enumerate().take(arenas) {
                match source {
                    ActionSource::Policy(network) => {
                        network.q_values(observations.row(arena), 1, &mut row);
                        actions.0[arena] = greedy(&row);
                    }
                    // The user has no Q-values, and a driver keeps its own; a row of NaN keeps the rows of the other arenas in
                    // place.
                    ActionSource::Manual(action) => {
                        fill_with_nan(&mut row, sources.num_actions);
                        actions.0[arena] = (*action).min(sources.num_actions.saturating_sub(1));
                    }
                    // `drive` chooses its action.
                    ActionSource::Driver(_) => fill_with_nan(&mut row, sources.num_actions),
                }
                decisions.q_values.extend_from_slice(&row);
            }
            let is_policy = |arena: usize| matches!(sources.arenas.get(arena), Some(ActionSource::Policy(_)));
            robots.choose(decisions, is_policy, &mut actions);
        }
        // Without the resource that the method needs, the last actions are repeated.
        _ => {}
    }
}

fn fill_with_nan(row: &mut Vec<f32>, num_actions: usize) {
    row.clear();
    row.resize(num_actions, f32::NAN);
}
