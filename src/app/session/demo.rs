//! Demos: a policy, a classical driver or the user drives, and nothing is learned.
//!
//! In: a mode other than training. Out: arenas with their action sources, and a sequence of rounds. In each round all drivers
//! have the same start and goal.

use bevy::prelude::*;

use super::active_mode::ActiveMode;
use super::comparison::origin;
use super::evaluations::Evaluations;
use super::open::{OpenedFiles, check_can_drive, check_driver, matches_training};
use super::session_policy;
use super::trails::Trails;
use super::training_run::TrainingRun;
use crate::agent::{
    ActionSelection, ActionSource, ActionSources, ActiveLearner, Decisions, DriverKind, DriverSource,
};
use crate::app::commands::{Pace, PolicySource, SessionMode};
use crate::app::scene::{DriverLabel, TrailEnd};
use crate::learning::QNetwork;
use crate::policy::Policy;
use crate::report::format::{number, percent};
use crate::run::{RunError, evaluate, policy_card};
use crate::scenario::Motion;
use crate::sim;
use crate::task::{
    ActiveActionSet, Arena, CommandedMotions, CurrentScenario, Episode, EpisodeEnded, PredictionDropout,
    ScenarioPool, TaskMode,
};

/// Control steps between two rounds, so that the user sees how a round ended.
const PAUSE_BETWEEN_ROUNDS: u32 = 4;

/// The first round of every demo: the index of an episode in an evaluation with the seed of the training run.
#[derive(Resource, Clone, Copy, Debug, Default)]
pub(super) struct FirstRound(pub u64);

/// The rounds of a demo.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounds {
    round: u64,
    /// Control steps since all drivers finished the round.
    waited: u32,
}

impl Rounds {
    /// The rounds from `first` on.
    pub(super) fn new(FirstRound(first): FirstRound) -> Self {
        Self { round: first, waited: 0 }
    }

    /// Counts a control step after which every driver has finished. Returns the index of the next round if it begins now.
    fn next(&mut self) -> Option<u64> {
        self.waited += 1;
        // The step in which the last driver finished counts, too.
        if self.waited <= PAUSE_BETWEEN_ROUNDS {
            return None;
        }
        *self = Self { round: self.round + 1, waited: 0 };
        Some(self.round)
    }
}

/// Replaces the arenas with one for each action source, and begins the first round.
pub(super) fn spawn_arenas(world: &mut World, mode: SessionMode, sources: Vec<ActionSource>) {
    let seed = world.resource::<TrainingRun>().config.seed;
    let scenario = world.resource::<CurrentScenario>().0.clone();
    let arenas = sources.len();
    let num_actions = world.resource::<ActiveActionSet>().0.len(scenario.robot.motions.len());
    world.insert_resource(ActionSources { arenas: sources, num_actions });
    world.resource_mut::<CommandedMotions>().0.clear();
    world.insert_resource(ActionSelection::PerArena);
    world.insert_resource(PredictionDropout::default());
    world.insert_resource(Decisions::new(seed, arenas));
    world.insert_resource(if mode == SessionMode::Test {
        TaskMode::Continuing
    } else {
        TaskMode::SingleGoal
    });
    sim::spawn_arenas(world, &scenario, arenas, seed);
    let FirstRound(first) = *world.resource::<FirstRound>();
    begin_round(world, first);
    world.resource_mut::<Trails>().restart(arenas);
}

/// The driver of each arena in `mode`, with its action source.
///
/// # Errors
/// There is no second driver, or it cannot drive here; or the network of the tested policy cannot be created.
pub(super) fn drivers(
    world: &World,
    mode: SessionMode,
) -> Result<Vec<(DriverLabel, ActionSource)>, RunError> {
    Ok(match mode {
        SessionMode::Train | SessionMode::Test => vec![tested(world)?],
        SessionMode::Drive => {
            vec![(DriverLabel::User, ActionSource::Manual(held_motion(world))), tested(world)?]
        }
        SessionMode::Compare => vec![tested(world)?, second(world)?],
    })
}

/// The motion of the robot that the user drives: the last one that was sent, or straight ahead. The screen sends a motion only
/// when it changes, so it must survive a restart of the demo.
fn held_motion(world: &World) -> usize {
    let motions = &world.resource::<TrainingRun>().config.scenario.robot.motions;
    match world.resource::<ActionSources>().arenas.first() {
        Some(ActionSource::Manual(held)) if *held < motions.len() => *held,
        _ => straightest_motion(motions),
    }
}

/// The second driver of a comparison: the classical driver that the user has chosen, or else the opened policy.
fn second(world: &World) -> Result<(DriverLabel, ActionSource), RunError> {
    let opened = world.resource::<OpenedFiles>();
    let config = &world.resource::<TrainingRun>().config;
    if let Some((name, driver)) = &opened.driver {
        check_driver(config, name, driver)?;
        let label = DriverLabel::Policy { name: name.clone(), origin: driver.class().about().into() };
        return Ok((label, ActionSource::Driver(DriverSource::new(driver.clone()))));
    }
    let Some((name, policy)) = &opened.policy else {
        return Err(RunError::InvalidInput(
            "Nothing to compare with\nhelp: open a policy file, or choose a classical driver".into(),
        ));
    };
    check_can_drive(config, name, policy)?;
    let label = DriverLabel::Policy { name: name.clone(), origin: origin(config, policy) };
    let source = if matches_training(config, policy)? {
        ActionSource::Policy(network(policy)?)
    } else {
        let policy = policy_card::driving(policy.clone(), false)?;
        ActionSource::Driver(DriverSource::new(DriverKind::Policy(policy)))
    };
    Ok((label, source))
}

/// The policy that is tested: the best one so far if the user has chosen it, or else the current one.
fn tested(world: &World) -> Result<(DriverLabel, ActionSource), RunError> {
    let run = world.resource::<TrainingRun>();
    let learner = &world.resource::<ActiveLearner>().0;
    let steps = |env_steps: u64| format!("after {} env steps", number(env_steps as f64, 0));
    let (name, origin, network) = match world.resource::<Evaluations>().best(&run.trainer_state) {
        Some(row) if run.tested == PolicySource::Best => {
            let (_, policy) = session_policy::policy(world, PolicySource::Best)?;
            let origin = format!("{} {}", percent(row.success_rate), steps(row.env_steps));
            ("Best so far", origin, network(&policy)?)
        }
        _ => ("Current policy", steps(learner.env_steps()), learner.network().clone()),
    };
    Ok((DriverLabel::Policy { name: name.into(), origin }, ActionSource::Policy(network)))
}

fn network(policy: &Policy) -> Result<QNetwork, RunError> {
    QNetwork::from_policy(policy).map_err(|error| RunError::InvalidInput(error.to_string()))
}

/// Begins the next round of a demo `PAUSE_BETWEEN_ROUNDS` control steps after every driver has finished the current one.
pub(super) fn advance_rounds(world: &mut World) {
    world.resource_mut::<Messages<EpisodeEnded>>().clear();
    let mut arenas = world.query_filtered::<&Episode, With<Arena>>();
    let all_finished = arenas.iter(world).all(|episode| episode.inactive);
    let ActiveMode::Demo(demo) = world.resource_mut::<ActiveMode>().into_inner() else { return };
    if demo.mode == SessionMode::Test || !all_finished {
        return;
    }
    if let Some(round) = demo.rounds.next() {
        begin_round(world, round);
    }
}

/// Puts every arena at the start of `round`, which has the same start and goal in all arenas. With a set of scenarios, the
/// scenario is also that of the evaluation episode with this index.
fn begin_round(world: &mut World, round: u64) {
    let seed = world.resource::<TrainingRun>().config.seed;
    let has_rounds = world.resource::<ActiveMode>().mode() != SessionMode::Test;
    if let Some(pool) = world.get_resource::<ScenarioPool>().filter(|_| has_rounds) {
        let scenario = pool.evaluation(seed, round as usize + 1).pop().unwrap_or_default();
        sim::assign_scenarios(world, |_| scenario);
    }
    sim::reset_arenas(world, |_| Some(evaluate::episode_streams(seed, round)));
    let mut trails = world.resource_mut::<Trails>();
    for arena in 0..trails.0.len() {
        trails.restart_path(arena);
    }
}

/// Moves the goal of every arena to `to_m`, in m. Time limits start again, and a robot that has finished the round drives on
/// unless it collided.
pub(super) fn set_goal(world: &mut World, to_m: Vec2) {
    let arenas = world.resource::<Trails>().0.len();
    let collided: Vec<bool> = {
        let trails = world.resource::<Trails>().0.iter();
        trails.map(|arena| arena.finished.back().is_some_and(|t| t.end == TrailEnd::Collided)).collect()
    };
    let mut episodes = world.query::<(&Arena, &mut Episode)>();
    for (arena, mut episode) in episodes.iter_mut(world) {
        // Not 0, at which a driver would forget its map.
        episode.steps = episode.steps.min(1);
        episode.inactive &= collided.get(arena.0).copied().unwrap_or(false);
    }
    for arena in 0..arenas {
        sim::move_goal(world, arena, to_m);
    }
    if let ActiveMode::Demo(demo) = world.resource_mut::<ActiveMode>().into_inner() {
        demo.rounds.waited = 0;
    }
}

/// `pace`, limited to a speed at which a user can drive or watch.
pub(super) fn watchable_pace(pace: Pace, mode: SessionMode) -> Pace {
    let max = if mode == SessionMode::Drive { 1.0 } else { 5.0 };
    match pace {
        Pace::Times(times) => Pace::Times(times.min(max)),
        Pace::Full => Pace::Times(max),
    }
}

/// Index of the motion with the smallest absolute turning rate; if there are several, of the fastest.
fn straightest_motion(motions: &[Motion]) -> usize {
    let turning_rate = |k: &usize| motions[*k].w_rad_s.abs();
    let speed = |k: &usize| motions[*k].v_m_s;
    (0..motions.len())
        .min_by(|a, b| turning_rate(a).total_cmp(&turning_rate(b)).then(speed(b).total_cmp(&speed(a))))
        .unwrap_or(0)
}
