//! The session's work in each frame: it executes commands, then takes as many control steps as the pacer allows.
//!
//! In: commands, and the time since the last frame. Out: the `World` after these steps. A command is never executed in the
//! middle of a control step.

use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy::time::Real;

use super::active_mode::ActiveMode;
use super::autosave;
use super::evaluations::{self, Evaluations};
use super::journal::Journal;
use super::notices::{NoticeTopic, notify};
use super::pacer::Pacer;
use super::throughput::Throughput;
use super::trails::{Trails, poses};
use super::training_run::TrainingRun;
use super::{TrainingHistory, demo, execute, scenario_changes};
use crate::agent::TrainingWarning;
use crate::app::app_status::Severity;
use crate::app::commands::Command;
use crate::run::{RunError, metrics};
use crate::simulation;
use crate::task::{CurrentScenario, EpisodeEnded, Fault, StepOutcomes, TaskFault};

/// Executes the commands that arrived since the last frame.
pub(super) fn execute_commands(world: &mut World) {
    let commands: Vec<Command> = world.resource_mut::<Messages<Command>>().drain().collect();
    for command in commands {
        execute::execute(world, command);
    }
}

/// Takes the control steps of this frame.
pub(super) fn take_steps(world: &mut World) {
    let real_s = world.resource::<Time<Real>>().delta_secs_f64();
    let period_s = f64::from(world.resource::<CurrentScenario>().0.task.control_period_s);
    world.resource_mut::<Pacer>().begin_frame(real_s, period_s);
    let began = Instant::now();
    while may_step(world) && world.resource_mut::<Pacer>().should_step(began.elapsed()) {
        if let Err(error) = step(world) {
            world.resource_mut::<Pacer>().set_paused(true);
            notify(world, NoticeTopic::TrainingFailure, Severity::Error, error.to_string());
            break;
        }
    }
    // An evaluator that works on this thread (in a browser) gets the rest of the frame's budget.
    while world.resource_mut::<Evaluations>().runs_on_caller_thread()
        && world.resource_mut::<Pacer>().has_budget(began.elapsed())
    {
        evaluations::record_finished_or_restart(world);
    }
}

/// Whether a control step may be taken now. In training, none is taken after a failure, nor while an evaluation still runs
/// and the next one or an autosave is due.
fn may_step(world: &mut World) -> bool {
    evaluations::record_finished_or_restart(world);
    if !world.resource::<ActiveMode>().is_training() {
        return true;
    }
    let waits = world.resource::<Evaluations>().is_running() && evaluations::is_due(world)
        || autosave::holds_steps(world);
    !(world.resource::<TrainingRun>().has_failed || waits)
}

/// Takes one control step.
///
/// # Errors
/// There is no free space for a start or a goal, a generator has no level with the drawn seed, a value is not finite, or the
/// evaluator's thread has ended.
fn step(world: &mut World) -> Result<(), RunError> {
    let is_training = world.resource::<ActiveMode>().is_training();
    if is_training && evaluations::is_due(world) {
        evaluations::submit(world)?;
    }
    let before = poses(world);
    world.resource_mut::<Trails>().record_before_step(&before);
    let stepped = simulation::step(world);
    let after = poses(world);
    world.resource_scope(|world, mut trails: Mut<Trails>| {
        trails.record_after_step(&after, world.resource::<StepOutcomes>());
    });
    world.resource_mut::<Throughput>().count_step(after.len());
    if let Some(warning) = world.resource_mut::<TrainingWarning>().take_new() {
        notify(world, NoticeTopic::TrainingWarning, Severity::Error, format!("Training: {warning}"));
    }
    let episode_ended = !world.resource::<Messages<EpisodeEnded>>().is_empty();
    if is_training {
        world.resource_mut::<Journal>().steps += 1;
        record_episodes(world);
    } else {
        demo::advance_rounds(world);
    }
    if episode_ended {
        scenario_changes::apply_pending_scenario(world);
    }
    if stepped.is_err() {
        // The user can make room in a scenario without free space; the other faults cannot be repaired.
        let fault = world.resource_mut::<TaskFault>().0.take();
        let is_repairable = matches!(fault, Some(Fault::NoFreeSpace { .. }));
        world.resource_mut::<TrainingRun>().has_failed |= !is_repairable && is_training;
    }
    stepped.map_err(RunError::from)
}

/// Adds the episodes that ended in the last step to the training history.
fn record_episodes(world: &mut World) {
    world.resource_scope(|world, mut run: Mut<TrainingRun>| {
        let wall_s = run.wall_s();
        for row in metrics::take_episode_rows(world, &mut run.trainer_state, wall_s) {
            world.resource_mut::<TrainingHistory>().0.push_episode(&row);
        }
    });
}
