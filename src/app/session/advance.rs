//! A frame of the session: orders are carried out, then control steps are taken, and what each brought is noted.
//!
//! In: orders, the time since the last frame. Out: the world some steps on. An order never comes in the middle of a step.

use bevy::platform::cell::SyncCell;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy::time::Real;

use super::start_training::evaluator;
use super::trails::{Trails, poses};
use super::{Session, TrainingHistory};
use crate::agent::{ActiveLearner, TrainingWarning};
use crate::app::app_snapshot::Severity;
use crate::app::commands::{Command, SessionMode};
use crate::run::background_evaluator::RUNS_ON_CALLER_THREAD;
use crate::run::{RunError, metrics};
use crate::simulation;
use crate::task::{CurrentScenario, EpisodeEnded, Fault, StepOutcomes, TaskFault};

/// The words by which a warning of the training begins; with another training it is gone.
pub(super) const WARNING_PREFIX: &str = "This training";

/// One frame.
pub(super) fn advance(world: &mut World) {
    let commands: Vec<Command> = world.resource_mut::<Messages<Command>>().drain().collect();
    let time = world.resource::<Time<Real>>();
    let (real_s, now_s) = (time.delta_secs_f64(), time.elapsed_secs_f64());
    world.resource_scope(|world, mut session: Mut<Session>| {
        let session = &mut *session;
        for command in commands {
            session.execute(world, command);
        }
        #[cfg(not(target_arch = "wasm32"))]
        session.poll_watched_files(world);
        let period_s = f64::from(world.resource::<CurrentScenario>().0.task.control_period_s);
        session.pacer.begin_frame(real_s, period_s);
        let began = Instant::now();
        while session.may_step(world) && session.pacer.should_step(began.elapsed()) {
            if let Err(error) = session.step(world) {
                session.pacer.paused = true;
                session.notify(Severity::Error, error.to_string());
                break;
            }
        }
        // Where the examiner works on this very thread, what is left of the frame's time is his.
        while RUNS_ON_CALLER_THREAD && session.evaluating && session.pacer.has_budget(began.elapsed()) {
            if let Err(error) = session.poll_evaluations(world, false) {
                session.restart_evaluator(&error);
            }
        }
        session.expire_notices();
        session.throughput.frame(now_s);
    });
}

impl Session {
    /// Whether a control step may be taken now: not while the examination of an earlier policy is waited for, nor after
    /// the learner has broken down.
    fn may_step(&mut self, world: &mut World) -> bool {
        if let Err(error) = self.poll_evaluations(world, false) {
            self.restart_evaluator(&error);
        }
        self.mode != SessionMode::Train || !(self.broken || self.evaluating && self.evaluation_is_due(world))
    }

    /// The examiner is no more: another one takes his place, and this examination is let go.
    fn restart_evaluator(&mut self, error: &RunError) {
        self.notify(Severity::Error, error.to_string());
        self.evaluator = SyncCell::new(evaluator(&self.config, &self.scenario));
        self.evaluating = false;
    }

    fn evaluation_is_due(&self, world: &World) -> bool {
        world.resource::<ActiveLearner>().0.env_steps() >= self.trainer_state.next_evaluation
    }

    /// One control step.
    fn step(&mut self, world: &mut World) -> Result<(), RunError> {
        if self.mode == SessionMode::Train && self.evaluation_is_due(world) {
            self.trainer_state.next_evaluation += self.config.preset.evaluation.every_env_steps;
            self.submit(world)?;
        }
        let before = poses(world);
        world.resource_mut::<Trails>().record_before_step(&before);
        let stepped = simulation::step(world);
        let after = poses(world);
        world.resource_scope(|world, mut trails: Mut<Trails>| {
            trails.record_after_step(&after, world.resource::<StepOutcomes>());
        });
        self.throughput.stepped(after.len());
        if let Some(warning) = world.resource_mut::<TrainingWarning>().take_new() {
            self.notify(Severity::Error, format!("{WARNING_PREFIX}: {warning}"));
        }
        let ended = !world.resource::<Messages<EpisodeEnded>>().is_empty();
        if self.mode == SessionMode::Train {
            self.journal.steps += 1;
            let wall_s = self.wall_s();
            for row in metrics::take_episode_rows(world, &mut self.trainer_state, wall_s) {
                world.resource_mut::<TrainingHistory>().0.push_episode(&row);
            }
        } else {
            self.advance_rounds(world);
        }
        if ended {
            self.apply_pending_scenario(world);
        }
        if stepped.is_err() {
            // A world without room may be mended by hand; numbers that are none cannot.
            let no_room =
                matches!(world.resource_mut::<TaskFault>().0.take(), Some(Fault::NoFreeSpace { .. }));
            self.broken |= !no_room && self.mode == SessionMode::Train;
        }
        stepped.map_err(RunError::from)
    }

    /// Hands the present policy to the examiner.
    fn submit(&mut self, world: &World) -> Result<(), RunError> {
        if std::mem::take(&mut self.evaluator_is_stale) {
            self.evaluator = SyncCell::new(evaluator(&self.config, &self.scenario));
        }
        let candidate = metrics::candidate(&self.config, world);
        self.trainer_state.evaluated_at = Some(candidate.env_steps);
        self.evaluating = true;
        self.evaluator.get().submit(candidate)
    }

    /// Notes the examination that is done, if one is; with `wait`, when it is.
    pub(super) fn poll_evaluations(&mut self, world: &mut World, wait: bool) -> Result<(), RunError> {
        while let Some(eval_result) = self.evaluator.get().poll(wait)? {
            self.evaluating = false;
            if self.evaluator_is_stale {
                // Of another world.
                continue;
            }
            let wall_s = self.wall_s();
            let noted =
                metrics::record_evaluation(&self.config, &mut self.trainer_state, eval_result, wall_s)?;
            world.resource_mut::<TrainingHistory>().0.push_evaluation(&noted.row);
            self.evaluations.push(noted.row);
        }
        Ok(())
    }
}
