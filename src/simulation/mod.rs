//! Simulations: arenas of a scenario or of a set of scenarios, stepped by their caller.
//!
//! [`SimulationBuilder`] combines the plugins of a simulation with a user's plugins ([`Extensions`]). Training,
//! evaluation, [`VecEnv`](crate::env::VecEnv) and the app all use it. A [`Simulation`] is headless.

mod builder;
mod extensions;

use std::panic::{self, AssertUnwindSafe};

use bevy::app::{TaskPoolOptions, TaskPoolThreadAssignmentPolicy};
use bevy::prelude::*;

pub use builder::SimulationBuilder;
pub use extensions::Extensions;

use crate::agent::{ActionSelection, ActiveLearner, TrainingFault};
use crate::control_step::ControlStep;
use crate::learning::DivergenceError;
use crate::task::{Fault, TaskFault};

/// Gives Bevy's task pools a single thread in total, which is enough for headless simulations. Call it before the first
/// simulation is built, in a process that opens no window. Returns whether the thread could be started. (Builds without
/// the app start no thread.)
#[must_use]
pub fn use_one_task_thread() -> bool {
    let threads = |count| TaskPoolThreadAssignmentPolicy {
        min_threads: count,
        max_threads: count,
        percent: 1.0,
        on_thread_spawn: None,
        on_thread_destroy: None,
    };
    let options = TaskPoolOptions {
        io: threads(0),
        async_compute: threads(0),
        // Bevy's transform systems never finish on a pool without threads.
        compute: threads(1),
        ..TaskPoolOptions::default()
    };
    // A pool panics if it cannot start its threads.
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let made = panic::catch_unwind(AssertUnwindSafe(|| options.create_default_pools()));
    panic::set_hook(hook);
    made.is_ok()
}

/// A headless simulation.
pub struct Simulation {
    world: World,
}

impl Simulation {
    /// The ECS world with all arenas.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The ECS world with all arenas, to modify between steps.
    pub fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// Runs one control step in all arenas.
    ///
    /// # Errors
    /// See [`step`].
    pub fn step(&mut self) -> Result<(), StepError> {
        step(&mut self.world)
    }
}

/// The reason why a control step failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// No free space for a start or goal, no level with the drawn seed, or a non-finite number.
    #[error(transparent)]
    Task(#[from] Fault),
    /// A non-finite loss or weight.
    #[error(transparent)]
    Learning(#[from] DivergenceError),
}

/// Runs one control step in all arenas of `world`.
///
/// # Errors
/// - No free space was found for a start or goal, or a generator has no level with the drawn seed.
/// - A number of the task is NaN or infinite. The message names the number, the arena and the step.
/// - Learning diverged: the loss or a weight is not finite.
pub fn step(world: &mut World) -> Result<(), StepError> {
    world.run_schedule(ControlStep);
    if let Some(fault) = &world.resource::<TaskFault>().0 {
        return Err(fault.clone().into());
    }
    // A suspended training run keeps its fault. Only an active one can fail this step.
    let is_training = world.get_resource::<ActionSelection>() == Some(&ActionSelection::EpsilonGreedy)
        && world.contains_resource::<ActiveLearner>();
    let fault = world.get_resource::<TrainingFault>().filter(|_| is_training);
    match fault.and_then(|fault| fault.0.as_ref()) {
        Some(diverged) => Err(diverged.clone().into()),
        None => Ok(()),
    }
}
