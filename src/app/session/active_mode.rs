//! The active mode: training, or a demo during which the training is suspended.
//!
//! In: the requested [`SessionMode`]. Out: the arenas for this mode (`demo.rs`). Suspended training resumes
//! exactly where it stopped.

use std::sync::Arc;

use bevy::prelude::*;

use super::comparison;
use super::demo::{self, FirstRound, Rounds};
use super::interventions::{self, Intervention};
use super::notices::{NoticeTopic, notify};
use super::pacer::Pacer;
use super::trails::Trails;
use super::training_run::TrainingRun;
use crate::agent::{ActionSelection, Decisions, TrainingStats};
use crate::app::app_status::Severity;
use crate::app::commands::{Pace, PolicySource, SessionMode};
use crate::app::scene::DriverLabel;
use crate::random::Stream;
use crate::run::RunError;
use crate::run::checkpoint::TrainerState;
use crate::scenario::Scenario;
use crate::sim;
use crate::task::{
    Actions, ArenaState, CommandedMotions, CurrentScenario, EpisodeEnded, LevelProgress, PredictionDropout,
    TaskMode,
};

/// The mode that is active now.
#[derive(Resource, Default)]
pub enum ActiveMode {
    /// The learner drives in all arenas, and learns.
    #[default]
    Train,
    /// A demo is shown; the training is suspended.
    Demo(Box<Demo>),
}

/// A demo: a policy, a classical driver or the user drives, and nothing is learned.
pub struct Demo {
    /// The mode: any except [`SessionMode::Train`].
    pub(super) mode: SessionMode,
    /// The driver of each arena.
    drivers: Vec<DriverLabel>,
    training: SuspendedTraining,
    pub(super) rounds: Rounds,
}

/// A training run that waits for the end of a demo.
struct SuspendedTraining {
    pace: Pace,
    scenario: Arc<Scenario>,
    arenas: Vec<ArenaState>,
    exploration: Vec<Stream>,
    actions: Actions,
    stats: TrainingStats,
    /// The results in each level of the set, if levels are drawn by their results. Episodes of a demo do not count.
    level_progress: Option<LevelProgress>,
    /// Changes of the scenario during the demo. The training adopts them when it resumes.
    interventions: Vec<Intervention>,
}

impl SuspendedTraining {
    /// Captures the training that runs in `world`. Removes its [`LevelProgress`], so that the demo draws levels without it.
    fn capture(world: &mut World) -> Self {
        Self {
            pace: world.resource::<Pacer>().pace,
            scenario: world.resource::<CurrentScenario>().0.clone(),
            arenas: sim::snapshot(world),
            exploration: world.resource::<Decisions>().streams.clone(),
            actions: world.resource::<Actions>().clone(),
            stats: *world.resource::<TrainingStats>(),
            level_progress: world.remove_resource(),
            interventions: Vec::new(),
        }
    }
}

impl ActiveMode {
    /// The session mode.
    #[must_use]
    pub fn mode(&self) -> SessionMode {
        match self {
            Self::Train => SessionMode::Train,
            Self::Demo(demo) => demo.mode,
        }
    }

    /// The driver of `arena`.
    #[must_use]
    pub fn driver(&self, arena: usize) -> DriverLabel {
        let Self::Demo(demo) = self else { return DriverLabel::Learner };
        demo.drivers.get(arena).cloned().unwrap_or(DriverLabel::Learner)
    }

    /// Whether the training runs.
    #[must_use]
    pub fn is_training(&self) -> bool {
        matches!(self, Self::Train)
    }

    /// Pace of the suspended training run, if one is suspended.
    pub(super) fn suspended_pace(&self) -> Option<Pace> {
        match self {
            Self::Train => None,
            Self::Demo(demo) => Some(demo.training.pace),
        }
    }

    /// Copies the state of the training to `state`, even while the training is suspended.
    pub(super) fn update_trainer_state(&self, world: &mut World, state: &mut TrainerState) {
        match self {
            Self::Train => state.update(world),
            Self::Demo(demo) => {
                let training = &demo.training;
                let progress = training.level_progress.as_ref();
                state.level_results = progress.map(LevelProgress::results).unwrap_or_default();
                state.update_with(training.arenas.clone(), training.exploration.clone(), training.stats);
            }
        }
    }

    /// Whether the scenario was changed during this demo. The suspended training run has not adopted the change yet.
    pub(super) fn has_pending_changes(&self) -> bool {
        matches!(self, Self::Demo(demo) if !demo.training.interventions.is_empty())
    }

    /// Stores a change of the scenario for the suspended training run, if a demo is shown. With
    /// `only_last_counts`, it replaces the last one if that moved the same object, as in the journal.
    pub(super) fn record_for_training(&mut self, intervention: &Intervention, only_last_counts: bool) {
        let Self::Demo(demo) = self else { return };
        match demo.training.interventions.last_mut() {
            Some(last) if only_last_counts && last.affects_same_object(intervention) => {
                last.clone_from(intervention);
            }
            _ => demo.training.interventions.push(intervention.clone()),
        }
    }
}

/// Switches to `mode`.
///
/// # Errors
/// There is no second driver, or a driver cannot drive in the current scenario. The mode is then unchanged.
pub(super) fn set_mode(world: &mut World, mode: SessionMode) -> Result<(), RunError> {
    if mode == world.resource::<ActiveMode>().mode() {
        return Ok(());
    }
    if mode == SessionMode::Train {
        comparison::warn_in_comparison(world, mode);
        resume_training(world);
        return Ok(());
    }
    enter_demo(world, mode)
}

/// Sets the policy that Test, Drive and Compare use.
///
/// # Errors
/// A demo is shown, and it cannot be restarted with this policy. The tested policy then stays the same, and the demo continues.
pub(super) fn set_tested(world: &mut World, source: PolicySource) -> Result<(), RunError> {
    let before = std::mem::replace(&mut world.resource_mut::<TrainingRun>().tested, source);
    restart_demo(world).inspect_err(|_| world.resource_mut::<TrainingRun>().tested = before)
}

/// Restarts the demo that is shown, if any, from its first round, because its drivers have changed.
///
/// # Errors
/// A driver is missing, or cannot drive in the current scenario.
pub(super) fn restart_demo(world: &mut World) -> Result<(), RunError> {
    match world.resource::<ActiveMode>().mode() {
        SessionMode::Train => Ok(()),
        mode => enter_demo(world, mode),
    }
}

/// Starts a demo in `mode`.
fn enter_demo(world: &mut World, mode: SessionMode) -> Result<(), RunError> {
    let (drivers, sources) = demo::drivers(world, mode)?.into_iter().unzip();
    comparison::warn_in_comparison(world, mode);
    let training = match std::mem::take(&mut *world.resource_mut::<ActiveMode>()) {
        ActiveMode::Train => SuspendedTraining::capture(world),
        ActiveMode::Demo(demo) => demo.training,
    };
    let rounds = Rounds::new(*world.resource::<FirstRound>());
    *world.resource_mut::<ActiveMode>() =
        ActiveMode::Demo(Box::new(Demo { mode, drivers, training, rounds }));
    let mut pacer = world.resource_mut::<Pacer>();
    pacer.pace = demo::watchable_pace(pacer.pace, mode);
    demo::spawn_arenas(world, mode, sources);
    Ok(())
}

/// Resumes the suspended training run.
fn resume_training(world: &mut World) {
    let (arenas, seed, dropout) = {
        let config = &world.resource::<TrainingRun>().config;
        (config.preset.arenas, config.seed, PredictionDropout(config.preset.prediction_dropout))
    };
    world.insert_resource(ActionSelection::EpsilonGreedy);
    world.insert_resource(dropout);
    world.resource_mut::<CommandedMotions>().0.clear();
    world.insert_resource(TaskMode::Continuing);
    world.resource_mut::<Messages<EpisodeEnded>>().clear();
    if let ActiveMode::Demo(demo) = std::mem::take(&mut *world.resource_mut::<ActiveMode>()) {
        let training = demo.training;
        world.resource_mut::<Pacer>().pace = training.pace;
        sim::spawn_arenas(world, &training.scenario, arenas, seed);
        sim::restore(world, &training.arenas);
        let mut decisions = Decisions::new(seed, arenas);
        decisions.streams = training.exploration;
        world.insert_resource(decisions);
        world.insert_resource(training.actions);
        world.insert_resource(training.stats);
        if let Some(progress) = training.level_progress {
            world.insert_resource(progress);
        }
        for intervention in &training.interventions {
            interventions::apply(world, intervention);
        }
    }
    world.resource_mut::<Trails>().restart(arenas);
}

/// Runs `work` while the training is active, then restores the previous mode and pace. If the previous mode cannot be restored,
/// for example because `work` has changed the scenario, the training stays active, with a notice.
///
/// # Errors
/// `work` fails.
pub(super) fn while_training<T>(
    world: &mut World,
    work: impl FnOnce(&mut World) -> Result<T, RunError>,
) -> Result<T, RunError> {
    let (mode, pace) = (world.resource::<ActiveMode>().mode(), world.resource::<Pacer>().pace);
    set_mode(world, SessionMode::Train)?;
    let done = work(world);
    match set_mode(world, mode) {
        Ok(()) => world.resource_mut::<Pacer>().pace = pace,
        Err(error) => notify(world, NoticeTopic::Comparison, Severity::Error, error.to_string()),
    }
    done
}
