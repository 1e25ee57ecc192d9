//! The session mode: training, or a demo during which the training is suspended.
//!
//! In: the requested [`SessionMode`]. Out: arenas with their action sources. A suspended training resumes exactly where it
//! stopped.

use std::sync::Arc;

use bevy::prelude::*;

use super::interventions::{self, Intervention};
use super::open::{OpenedFiles, check_can_drive};
use super::pacer::Pacer;
use super::trails::Trails;
use super::training_run::TrainingRun;
use crate::agent::{ActionSelection, ActionSource, ActionSources, ActiveLearner, Decisions, TrainingStats};
use crate::app::commands::{Pace, SessionMode};
use crate::learning::QNetwork;
use crate::random::Stream;
use crate::run::{RunError, evaluate};
use crate::scenario::{Motion, Scenario};
use crate::sim;
use crate::task::{Actions, Arena, ArenaState, CurrentScenario, Episode, EpisodeEnded, TaskMode};

/// Control steps between the end of a round and the next one, so that the user sees how it ended.
const PAUSE_BETWEEN_ROUNDS: u32 = 4;

/// The mode that is active now.
#[derive(Resource, Default)]
pub enum ActiveMode {
    /// The learner drives in all arenas, and learns.
    #[default]
    Train,
    /// Something else drives while the training is suspended.
    Demo(Box<Demo>),
}

/// A demo: a policy or the user drives, and nothing is learnt.
pub struct Demo {
    /// Any mode but [`SessionMode::Train`].
    mode: SessionMode,
    training: SuspendedTraining,
    rounds: Rounds,
}

/// A training that waits for the end of a demo.
struct SuspendedTraining {
    pace: Pace,
    scenario: Arc<Scenario>,
    arenas: Vec<ArenaState>,
    exploration: Vec<Stream>,
    actions: Actions,
    stats: TrainingStats,
    /// Changes made to the scenario during the demo, which the training has yet to adopt.
    interventions: Vec<Intervention>,
}

impl SuspendedTraining {
    /// Captures the training that runs in `world`.
    fn capture(world: &mut World) -> Self {
        Self {
            pace: world.resource::<Pacer>().pace,
            scenario: world.resource::<CurrentScenario>().0.clone(),
            arenas: sim::snapshot(world),
            exploration: world.resource::<Decisions>().streams.clone(),
            actions: world.resource::<Actions>().clone(),
            stats: *world.resource::<TrainingStats>(),
            interventions: Vec::new(),
        }
    }
}

/// Rounds of a demo with several drivers. In each round all of them start from the same pose towards the same goal.
#[derive(Clone, Copy, Debug, Default)]
struct Rounds {
    round: u64,
    /// Control steps since all drivers finished the round.
    waited: u32,
}

impl ActiveMode {
    /// The mode's name.
    #[must_use]
    pub fn mode(&self) -> SessionMode {
        match self {
            Self::Train => SessionMode::Train,
            Self::Demo(demo) => demo.mode,
        }
    }

    /// Whether the training runs.
    #[must_use]
    pub fn is_training(&self) -> bool {
        matches!(self, Self::Train)
    }

    /// Pace of the suspended training, if one is suspended.
    pub(super) fn suspended_pace(&self) -> Option<Pace> {
        match self {
            Self::Train => None,
            Self::Demo(demo) => Some(demo.training.pace),
        }
    }

    /// Remembers a change of the scenario for the suspended training, if one is suspended. As in the journal, only the last
    /// position of a dragged object counts if the LIDAR is `exact`.
    pub(super) fn record_for_training(&mut self, intervention: &Intervention, exact: bool) {
        let Self::Demo(demo) = self else { return };
        match demo.training.interventions.last_mut() {
            Some(last) if exact && last.affects_same_object(intervention) => last.clone_from(intervention),
            _ => demo.training.interventions.push(intervention.clone()),
        }
    }
}

/// Switches to `mode`.
///
/// # Errors
/// There is no second policy, or it cannot drive here. Nothing has changed then.
pub(super) fn set_mode(world: &mut World, mode: SessionMode) -> Result<(), RunError> {
    if mode == world.resource::<ActiveMode>().mode() {
        return Ok(());
    }
    if mode == SessionMode::Train {
        resume_training(world);
        return Ok(());
    }
    let sources = action_sources(world, mode)?;
    let training = match std::mem::take(&mut *world.resource_mut::<ActiveMode>()) {
        ActiveMode::Train => SuspendedTraining::capture(world),
        ActiveMode::Demo(demo) => demo.training,
    };
    spawn_demo_arenas(world, mode, sources);
    *world.resource_mut::<ActiveMode>() =
        ActiveMode::Demo(Box::new(Demo { mode, training, rounds: Rounds::default() }));
    let mut pacer = world.resource_mut::<Pacer>();
    pacer.pace = watchable_pace(pacer.pace, mode);
    begin_round(world, 0);
    let arenas = world.resource::<ActionSources>().arenas.len();
    world.resource_mut::<Trails>().restart(arenas);
    Ok(())
}

fn spawn_demo_arenas(world: &mut World, mode: SessionMode, sources: Vec<ActionSource>) {
    let seed = world.resource::<TrainingRun>().config.seed;
    let scenario = world.resource::<CurrentScenario>().0.clone();
    let arenas = sources.len();
    world.insert_resource(ActionSources { arenas: sources, num_actions: scenario.robot.motions.len() });
    world.insert_resource(ActionSelection::PerArena);
    world.insert_resource(Decisions::new(seed, arenas));
    world.insert_resource(if mode == SessionMode::Test {
        TaskMode::Continuing
    } else {
        TaskMode::SingleGoal
    });
    sim::spawn_arenas(world, &scenario, arenas, seed);
}

/// The action source of each arena in `mode`.
fn action_sources(world: &World, mode: SessionMode) -> Result<Vec<ActionSource>, RunError> {
    let config = &world.resource::<TrainingRun>().config;
    let present = || ActionSource::Policy(world.resource::<ActiveLearner>().0.network().clone());
    Ok(match mode {
        SessionMode::Train | SessionMode::Test => vec![present()],
        SessionMode::Drive => {
            let ahead = straightest_motion(&config.scenario.robot.motions);
            vec![ActionSource::Manual(ahead), present()]
        }
        SessionMode::Compare => {
            let Some((name, policy)) = &world.resource::<OpenedFiles>().policy else {
                return Err(RunError::InvalidInput(
                    "No policy to compare with\nhelp: open a policy file first".into(),
                ));
            };
            check_can_drive(config, name, policy)?;
            let network =
                QNetwork::from_policy(policy).map_err(|error| RunError::InvalidInput(error.to_string()))?;
            vec![present(), ActionSource::Policy(network)]
        }
    })
}

/// Resumes the suspended training.
fn resume_training(world: &mut World) {
    let (arenas, seed) = {
        let config = &world.resource::<TrainingRun>().config;
        (config.preset.arenas, config.seed)
    };
    world.insert_resource(ActionSelection::EpsilonGreedy);
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
        for intervention in &training.interventions {
            interventions::apply(world, intervention);
        }
    }
    world.resource_mut::<Trails>().restart(arenas);
}

/// Runs `work` while the training is active, then returns to the mode and pace of before.
///
/// # Errors
/// Those of `work`; or the mode of before cannot be entered again.
pub(super) fn while_training(
    world: &mut World,
    work: impl FnOnce(&mut World) -> Result<(), RunError>,
) -> Result<(), RunError> {
    let (mode, pace) = (world.resource::<ActiveMode>().mode(), world.resource::<Pacer>().pace);
    set_mode(world, SessionMode::Train)?;
    let done = work(world);
    set_mode(world, mode)?;
    world.resource_mut::<Pacer>().pace = pace;
    done
}

/// Begins the next round of a demo some control steps after every driver has finished the last one.
pub(super) fn advance_rounds(world: &mut World) {
    world.resource_mut::<Messages<EpisodeEnded>>().clear();
    let mut arenas = world.query_filtered::<&Episode, With<Arena>>();
    let all_finished = arenas.iter(world).all(|episode| episode.inactive);
    let ActiveMode::Demo(demo) = world.resource_mut::<ActiveMode>().into_inner() else { return };
    if demo.mode == SessionMode::Test || !all_finished {
        return;
    }
    demo.rounds.waited += 1;
    if demo.rounds.waited < PAUSE_BETWEEN_ROUNDS {
        return;
    }
    demo.rounds = Rounds { round: demo.rounds.round + 1, waited: 0 };
    let round = demo.rounds.round;
    begin_round(world, round);
}

/// Puts every arena at the start of `round`, which has the same start and goal in all arenas.
fn begin_round(world: &mut World, round: u64) {
    let seed = world.resource::<TrainingRun>().config.seed;
    sim::reset_arenas(world, |_| Some(evaluate::episode_streams(seed, round)));
    let mut trails = world.resource_mut::<Trails>();
    for arena in 0..trails.0.len() {
        trails.restart_path(arena);
    }
}

/// `pace`, limited so that one can drive, or watch.
fn watchable_pace(pace: Pace, mode: SessionMode) -> Pace {
    let max = if mode == SessionMode::Drive { 1.0 } else { 5.0 };
    match pace {
        Pace::Times(times) => Pace::Times(times.min(max)),
        Pace::Full => Pace::Times(max),
    }
}

/// Index of the motion with the least turn rate.
fn straightest_motion(motions: &[Motion]) -> usize {
    let turn_rate = |k: &usize| motions[*k].w_rad_s.abs();
    (0..motions.len()).min_by(|a, b| turn_rate(a).total_cmp(&turn_rate(b))).unwrap_or(0)
}
