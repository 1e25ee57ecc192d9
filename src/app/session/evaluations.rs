//! Evaluation during training: submits policies to the background evaluator and records the results.
//!
//! In: the policy in training, whenever the preset asks for an evaluation. Out: rows of `evaluations.csv`, the curves, and
//! the best policy. A result for a scenario that has changed since is discarded.

use std::sync::Arc;

use bevy::platform::cell::SyncCell;
use bevy::prelude::*;

use super::TrainingHistory;
use super::notices::{NoticeTopic, notify};
use super::training_run::TrainingRun;
use crate::agent::ActiveLearner;
use crate::app::app_status::Severity;
use crate::run::background_evaluator::{BackgroundEvaluator, Candidate, EvalResult};
use crate::run::checkpoint::TrainerState;
use crate::run::folder::RunConfig;
use crate::run::metric_rows::EvaluationRow;
use crate::run::{RunError, metrics};
use crate::scenario::Scenario;
use crate::task::CurrentScenario;

/// The state of the background evaluator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EvaluatorState {
    /// Idle.
    Idle,
    /// Evaluating a policy.
    Running,
    /// Idle, but built for the scenario before the last change. The evaluator is replaced before the next evaluation.
    Outdated,
    /// Evaluating a policy in the scenario before the last change. The result will be discarded.
    RunningOutdated,
}

/// The background evaluator and the results so far.
#[derive(Resource)]
pub struct Evaluations {
    /// In a `SyncCell` because only one thread at a time may use the evaluator's channel.
    evaluator: SyncCell<BackgroundEvaluator>,
    state: EvaluatorState,
    /// Results so far, oldest first.
    pub(super) rows: Vec<EvaluationRow>,
}

impl Evaluations {
    /// An idle evaluator for the policies of a training run in `scenario`.
    pub(super) fn new(config: &RunConfig, scenario: &Arc<Scenario>) -> Self {
        Self {
            evaluator: SyncCell::new(evaluator(config, scenario)),
            state: EvaluatorState::Idle,
            rows: Vec::new(),
        }
    }

    /// Whether a policy is being evaluated.
    #[must_use]
    pub fn is_running(&self) -> bool {
        matches!(self.state, EvaluatorState::Running | EvaluatorState::RunningOutdated)
    }

    /// Whether a policy is being evaluated on the thread that polls for the result.
    pub(super) fn runs_on_caller_thread(&mut self) -> bool {
        self.is_running() && self.evaluator.get().runs_on_caller_thread()
    }

    /// The evaluation of the best policy in `trainer_state`.
    #[must_use]
    pub fn best(&self, trainer_state: &TrainerState) -> Option<&EvaluationRow> {
        let best = trainer_state.best.as_ref()?;
        self.rows.iter().rev().find(|row| row.mean_cost_s == best.mean_cost_s)
    }

    /// Marks the evaluator as outdated: the scenario of the training has changed.
    pub(super) fn mark_outdated(&mut self) {
        self.state =
            if self.is_running() { EvaluatorState::RunningOutdated } else { EvaluatorState::Outdated };
    }

    /// Records that no evaluation is running.
    fn finish(&mut self) {
        self.state = match self.state {
            EvaluatorState::Idle | EvaluatorState::Running => EvaluatorState::Idle,
            EvaluatorState::Outdated | EvaluatorState::RunningOutdated => EvaluatorState::Outdated,
        };
    }

    fn submit(
        &mut self,
        config: &RunConfig,
        scenario: &Arc<Scenario>,
        candidate: Candidate,
    ) -> Result<(), RunError> {
        if self.state == EvaluatorState::Outdated {
            self.evaluator = SyncCell::new(evaluator(config, scenario));
        }
        self.evaluator.get().submit(candidate)?;
        self.state = EvaluatorState::Running;
        Ok(())
    }

    /// The next result for the current scenario, if there is one. With `wait`, blocks until a running evaluation is done.
    fn poll(&mut self, wait: bool) -> Result<Option<EvalResult>, RunError> {
        while let Some(result) = self.evaluator.get().poll(wait)? {
            self.finish();
            if self.state == EvaluatorState::Idle {
                return Ok(Some(result));
            }
        }
        Ok(None)
    }
}

fn evaluator(config: &RunConfig, scenario: &Arc<Scenario>) -> BackgroundEvaluator {
    BackgroundEvaluator::new(scenario, metrics::evaluation_episodes(config), &config.simulation_plugins())
}

/// Whether the preset asks for an evaluation now.
pub(super) fn is_due(world: &World) -> bool {
    let next_evaluation = world.resource::<TrainingRun>().trainer_state.next_evaluation;
    world.resource::<ActiveLearner>().0.env_steps() >= next_evaluation
}

/// Submits the policy in training to the evaluator, and schedules the next evaluation.
///
/// # Errors
/// The evaluator's thread has ended.
pub(super) fn submit(world: &mut World) -> Result<(), RunError> {
    let scenario = world.resource::<CurrentScenario>().0.clone();
    let candidate = metrics::candidate(&world.resource::<TrainingRun>().config, world);
    world.resource_scope(|world, mut run: Mut<TrainingRun>| {
        run.trainer_state.next_evaluation += run.config.preset.evaluation.every_env_steps;
        run.trainer_state.evaluated_at = Some(candidate.env_steps);
        world.resource_mut::<Evaluations>().submit(&run.config, &scenario, candidate)
    })
}

/// Records every finished evaluation. With `wait`, waits for a running one first.
///
/// # Errors
/// An evaluation failed, or the evaluator's thread has ended.
pub(super) fn record_finished(world: &mut World, wait: bool) -> Result<(), RunError> {
    while let Some(result) = world.resource_mut::<Evaluations>().poll(wait)? {
        let run = world.resource_mut::<TrainingRun>().into_inner();
        let wall_s = run.wall_s();
        let recorded = metrics::record_evaluation(&mut run.trainer_state, result, wall_s)?;
        world.resource_mut::<TrainingHistory>().0.push_evaluation(&recorded.row);
        world.resource_mut::<Evaluations>().rows.push(recorded.row);
    }
    Ok(())
}

/// Records every finished evaluation. On an error, reports it and replaces the evaluator; a running evaluation is lost.
pub(super) fn record_finished_or_restart(world: &mut World) {
    let Err(error) = record_finished(world, false) else { return };
    notify(world, NoticeTopic::Evaluation, Severity::Error, error.to_string());
    let scenario = world.resource::<CurrentScenario>().0.clone();
    world.resource_scope(|world, run: Mut<TrainingRun>| {
        let mut evaluations = world.resource_mut::<Evaluations>();
        evaluations.evaluator = SyncCell::new(evaluator(&run.config, &scenario));
        evaluations.state = EvaluatorState::Idle;
    });
}
