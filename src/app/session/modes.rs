//! Who drives: the learner in training, or, with the training set aside, a policy, the user, or two side by side.
//!
//! In: the mode asked for. Out: arenas for it. A training set aside waits as it stands and goes on to the bit.

use bevy::prelude::*;

use super::Session;
use super::interventions::{self, Intervention};
use super::trails::Trails;
use crate::agent::{ActionSelection, ActionSource, ActionSources, ActiveLearner, Decisions, TrainingStats};
use crate::app::commands::{Pace, SessionMode};
use crate::learning::QNetwork;
use crate::policy::Policy;
use crate::random::Stream;
use crate::run::evaluate;
use crate::run::{RunError, policy_card};
use crate::sim;
use crate::task::{Actions, Arena, ArenaState, CurrentScenario, Episode, EpisodeEnded, TaskMode};

/// When all have ended a round, so many control steps are waited until the next, for the eye.
const PAUSE_BETWEEN_ROUNDS: u32 = 4;

/// A training while something else is driven.
pub(super) struct SuspendedTraining {
    pace: Pace,
    arenas: Vec<ArenaState>,
    exploration: Vec<Stream>,
    actions: Actions,
    stats: TrainingStats,
    /// What the hand has changed in the world since.
    interventions: Vec<Intervention>,
}

impl SuspendedTraining {
    /// The pace that the training had.
    pub fn pace(&self) -> Pace {
        self.pace
    }

    /// What the hand has done is to be done in the training's world, too. As in the journal: of what is dragged about the
    /// last place counts, if looks around draw nothing (`exact`).
    pub fn record(&mut self, intervention: Intervention, exact: bool) {
        match self.interventions.last_mut() {
            Some(last) if exact && last.affects_same_object(&intervention) => *last = intervention,
            _ => self.interventions.push(intervention),
        }
    }
}

/// Rounds that several drivers drive side by side, each from the same start to the same goal.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rounds {
    round: u64,
    rested: u32,
}

impl Session {
    /// Lets `mode` go on in place of what does.
    ///
    /// # Errors
    /// There is no second policy, or it cannot drive here; everything stays as it was then.
    pub(super) fn set_mode(&mut self, world: &mut World, mode: SessionMode) -> Result<(), RunError> {
        if mode == self.mode {
            return Ok(());
        }
        if mode == SessionMode::Train {
            self.resume_training(world);
            return Ok(());
        }
        let drivers = self.drivers(world, mode)?;
        if self.mode == SessionMode::Train {
            self.suspended = Some(SuspendedTraining {
                pace: self.pacer.pace,
                arenas: sim::snapshot(world),
                exploration: world.resource::<Decisions>().streams.clone(),
                actions: world.resource::<Actions>().clone(),
                stats: *world.resource::<TrainingStats>(),
                interventions: Vec::new(),
            });
        }
        let scenario = world.resource::<CurrentScenario>().0.clone();
        let arenas = drivers.len();
        world.insert_resource(ActionSources { arenas: drivers, num_actions: scenario.robot.motions.len() });
        world.insert_resource(ActionSelection::PerArena);
        world.insert_resource(Decisions::new(self.config.seed, arenas));
        world.insert_resource(if mode == SessionMode::Test {
            TaskMode::Continuing
        } else {
            TaskMode::SingleGoal
        });
        sim::spawn_arenas(world, &scenario, arenas, self.config.seed);
        self.mode = mode;
        self.pacer.pace = to_be_seen(self.pacer.pace, mode);
        self.rounds = Rounds::default();
        self.begin_round(world);
        world.resource_mut::<Trails>().restart(arenas);
        Ok(())
    }

    /// Who drives which arena in `mode`.
    fn drivers(&self, world: &World, mode: SessionMode) -> Result<Vec<ActionSource>, RunError> {
        let present = || ActionSource::Policy(world.resource::<ActiveLearner>().0.network().clone());
        Ok(match mode {
            SessionMode::Train | SessionMode::Test => vec![present()],
            SessionMode::Drive => {
                let ahead = straight_ahead(&self.config.scenario.robot.motions);
                vec![ActionSource::Manual(ahead), present()]
            }
            SessionMode::Compare => {
                let Some((name, policy)) = &self.opened_policy else {
                    return Err(RunError::InvalidInput(
                        "there is no second policy to compare with: open one first".into(),
                    ));
                };
                self.check_can_drive(name, policy)?;
                let network = QNetwork::from_policy(policy)
                    .map_err(|error| RunError::InvalidInput(error.to_string()))?;
                vec![present(), ActionSource::Policy(network)]
            }
        })
    }

    /// Whether `policy`, called `name`, can drive in the present scenario and sees what the preset shows.
    pub(super) fn check_can_drive(&self, name: &str, policy: &Policy) -> Result<(), RunError> {
        let wrong = |why: String| RunError::InvalidInput(format!("{name}: {why}"));
        evaluate::check_compatible(policy, &self.config.scenario, &self.config.observation_layout())
            .map_err(|error| wrong(error.to_string()))?;
        if policy_card::encoding(policy)? != self.config.preset.observation {
            return Err(wrong("its observations are in other units than those of the chosen preset".into()));
        }
        Ok(())
    }

    /// The training goes on where it was set aside.
    fn resume_training(&mut self, world: &mut World) {
        self.mode = SessionMode::Train;
        let arenas = self.config.preset.arenas;
        world.insert_resource(ActionSelection::EpsilonGreedy);
        world.insert_resource(TaskMode::Continuing);
        world.resource_mut::<Messages<EpisodeEnded>>().clear();
        if let Some(aside) = self.suspended.take() {
            self.pacer.pace = aside.pace;
            sim::spawn_arenas(world, &self.scenario, arenas, self.config.seed);
            sim::restore(world, &aside.arenas);
            let mut decisions = Decisions::new(self.config.seed, arenas);
            decisions.streams = aside.exploration;
            world.insert_resource(decisions);
            world.insert_resource(aside.actions);
            world.insert_resource(aside.stats);
            for intervention in &aside.interventions {
                interventions::apply(world, intervention);
            }
            self.scenario = world.resource::<CurrentScenario>().0.clone();
        }
        world.resource_mut::<Trails>().restart(arenas);
    }

    /// After a control step with drivers: when all have ended, they begin the next round.
    pub(super) fn advance_rounds(&mut self, world: &mut World) {
        world.resource_mut::<Messages<EpisodeEnded>>().clear();
        if self.mode == SessionMode::Test {
            return;
        }
        let mut arenas = world.query_filtered::<&Episode, With<Arena>>();
        if arenas.iter(world).all(|episode| episode.inactive) {
            self.rounds.rested += 1;
            if self.rounds.rested >= PAUSE_BETWEEN_ROUNDS {
                self.rounds.round += 1;
                self.begin_round(world);
            }
        }
    }

    /// All arenas at the same start with the same goal, another one every round.
    fn begin_round(&mut self, world: &mut World) {
        self.rounds.rested = 0;
        let (seed, round) = (self.config.seed, self.rounds.round);
        sim::reset_arenas(world, |_| Some(evaluate::episode_streams(seed, round)));
        let mut trails = world.resource_mut::<Trails>();
        for arena in 0..trails.0.len() {
            trails.restart_path(arena);
        }
    }
}

/// A pace at which one can drive, or follow with one's eyes.
fn to_be_seen(pace: Pace, mode: SessionMode) -> Pace {
    let most = if mode == SessionMode::Drive { 1.0 } else { 5.0 };
    match pace {
        Pace::Times(times) => Pace::Times(times.min(most)),
        Pace::Full => Pace::Times(most),
    }
}

/// The motion that turns least.
fn straight_ahead(motions: &[crate::scenario::Motion]) -> usize {
    let turns = |k: &usize| motions[*k].w_rad_s.abs();
    (0..motions.len()).min_by(|a, b| turns(a).total_cmp(&turns(b))).unwrap_or(0)
}
