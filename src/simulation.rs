//! Simulations: arenas of one scenario, stepped by their caller.
//!
//! [`SimulationBuilder`] combines the plugins of a simulation with a user's plugins. Training, evaluation,
//! [`VecEnv`](crate::env::VecEnv) and the app all use it. A [`Simulation`] is headless.

use std::fmt;
use std::sync::Arc;

use bevy::prelude::*;

use crate::agent::{ActionSelection, ActiveLearner, AgentPlugin, TrainingFault, TrainingPlugin};
use crate::control_step::{ControlStep, ControlStepPlugin};
use crate::learning::DivergenceError;
use crate::policy::Encoding;
use crate::scenario::Scenario;
use crate::sim::{SimPlugin, spawn_arenas};
use crate::task::{
    ExtraRewards, Fault, ObservationLayout, ObservationSlice, RewardConfig, TaskFault, TaskMode, TaskPlugin,
};

/// A user's plugins. They are added to every simulation that is built with them.
///
/// ```
/// use bevy::prelude::*;
/// use wayfield::simulation::Extensions;
///
/// #[derive(Clone)]
/// struct MySensor;
///
/// impl Plugin for MySensor {
///     fn build(&self, app: &mut App) {
///         // app.add_sensor("my sensor", 1, ...)
///     }
/// }
///
/// let extensions = Extensions::default().plugin(MySensor);
/// # let _ = extensions;
/// ```
#[derive(Clone, Default)]
pub struct Extensions(Vec<AddPlugin>);

/// Adds one plugin to an app.
type AddPlugin = Arc<dyn Fn(&mut App) + Send + Sync>;

impl Extensions {
    /// Adds `plugin`. Its `build` may call the methods of [`SimulationAppExt`](crate::task::SimulationAppExt).
    #[must_use]
    pub fn plugin(mut self, plugin: impl Plugin + Clone) -> Self {
        self.0.push(Arc::new(move |app| {
            app.add_plugins(plugin.clone());
        }));
        self
    }

    /// Adds all plugins to `app`, which must have the [`TaskPlugin`] already.
    fn build(&self, app: &mut App) {
        self.0.iter().for_each(|add| add(app));
    }

    /// The slices that the plugins' sensors add to the observation, and the names of the plugins' reward terms.
    #[must_use]
    pub fn describe(&self) -> (Vec<ObservationSlice>, Vec<String>) {
        if self.0.is_empty() {
            return (Vec::new(), Vec::new());
        }
        let mut app = App::new();
        SimulationBuilder::add_plugins_of(&mut app, &SimulationBuilder::new(&Arc::default()));
        self.build(&mut app);
        let world = app.world();
        (
            world.resource::<ObservationLayout>().slices().to_vec(),
            world.resource::<ExtraRewards>().names().to_vec(),
        )
    }
}

impl PartialEq for Extensions {
    /// Whether both are clones of the same plugins, by identity.
    fn eq(&self, other: &Self) -> bool {
        self.0.len() == other.0.len() && self.0.iter().zip(&other.0).all(|(one, two)| Arc::ptr_eq(one, two))
    }
}

impl fmt::Debug for Extensions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Extensions({})", self.0.len())
    }
}

/// The component that chooses actions.
enum Agent {
    /// The caller writes [`Actions`](crate::task::Actions) before each step.
    Caller,
    /// An [`AgentPlugin`] chooses them.
    Plugin(ActionSelection),
    /// An [`AgentPlugin`] explores, and a [`TrainingPlugin`] trains the learner.
    Training,
}

/// A builder of simulations: a scenario, a number of arenas, a seed, the options of the task, and a user's plugins.
///
/// ```
/// use std::sync::Arc;
/// use wayfield::scenario::Scenario;
/// use wayfield::simulation::SimulationBuilder;
///
/// let mut simulation = SimulationBuilder::new(&Arc::new(Scenario::default())).arenas(4).seed(7).build();
/// simulation.step()?;
/// # Ok::<(), wayfield::simulation::StepError>(())
/// ```
pub struct SimulationBuilder {
    scenario: Arc<Scenario>,
    arenas: usize,
    seed: u64,
    encoding: Encoding,
    reward: RewardConfig,
    mode: TaskMode,
    agent: Agent,
    extensions: Extensions,
}

impl SimulationBuilder {
    /// A builder with one arena of `scenario`, seed 0, the paper's reward and scaled observations. The caller chooses the
    /// actions.
    #[must_use]
    pub fn new(scenario: &Arc<Scenario>) -> Self {
        Self {
            scenario: scenario.clone(),
            arenas: 1,
            seed: 0,
            encoding: Encoding::default(),
            reward: RewardConfig::default(),
            mode: TaskMode::default(),
            agent: Agent::Caller,
            extensions: Extensions::default(),
        }
    }

    /// Sets the number of arenas, at least 1.
    #[must_use]
    pub fn arenas(self, arenas: usize) -> Self {
        Self { arenas: arenas.max(1), ..self }
    }

    /// Sets the seed. The random streams of arena k depend on the seed and k alone.
    #[must_use]
    pub fn seed(self, seed: u64) -> Self {
        Self { seed, ..self }
    }

    /// Sets the encoding of the paper's observation.
    #[must_use]
    pub fn encoding(self, encoding: Encoding) -> Self {
        Self { encoding, ..self }
    }

    /// Sets the parameters of the reward.
    #[must_use]
    pub fn reward(self, reward: RewardConfig) -> Self {
        Self { reward, ..self }
    }

    /// Sets what happens when the goal is reached, and after an episode.
    #[must_use]
    pub fn mode(self, mode: TaskMode) -> Self {
        Self { mode, ..self }
    }

    /// Adds a user's plugins.
    #[must_use]
    pub fn extensions(self, extensions: &Extensions) -> Self {
        Self { extensions: extensions.clone(), ..self }
    }

    /// Adds an agent. It selects actions with the [`GreedyPolicy`](crate::agent::GreedyPolicy) or the
    /// [`ActionSources`](crate::agent::ActionSources) in the world.
    #[must_use]
    pub fn agent(self, action_selection: ActionSelection) -> Self {
        Self { agent: Agent::Plugin(action_selection), ..self }
    }

    /// Adds an agent that explores and learns. Insert the learner as [`ActiveLearner`] before the first step.
    #[must_use]
    pub fn training(self) -> Self {
        Self { agent: Agent::Training, ..self }
    }

    /// Adds the plugins to `app`, whose runner decides when [`ControlStep`] runs. Spawns no arena.
    pub fn add_to(&self, app: &mut App) {
        Self::add_plugins_of(app, self);
        self.extensions.build(app);
    }

    fn add_plugins_of(app: &mut App, builder: &Self) {
        app.add_plugins((
            ControlStepPlugin,
            TaskPlugin { observation: builder.encoding, reward: builder.reward.clone(), mode: builder.mode },
            SimPlugin,
        ));
        let (seed, arenas) = (builder.seed, builder.arenas);
        match builder.agent {
            Agent::Caller => {}
            Agent::Plugin(action_selection) => {
                app.add_plugins(AgentPlugin { action_selection, seed, arenas });
            }
            Agent::Training => {
                let action_selection = ActionSelection::EpsilonGreedy;
                app.add_plugins((AgentPlugin { action_selection, seed, arenas }, TrainingPlugin));
            }
        }
    }

    /// A headless simulation without arenas; call [`spawn_arenas`] next.
    #[must_use]
    pub(crate) fn build_empty(&self) -> Simulation {
        let mut app = App::new();
        app.add_plugins(MinimalPlugins);
        self.add_to(&mut app);
        // An app's runner does this before its first frame.
        app.finish();
        app.cleanup();
        app.update();
        // Keeps the world only, because an app cannot move between threads.
        Simulation { world: std::mem::take(app.world_mut()) }
    }

    /// A headless simulation, with every arena at its first observation.
    #[must_use]
    pub fn build(&self) -> Simulation {
        let mut simulation = self.build_empty();
        spawn_arenas(&mut simulation.world, &self.scenario, self.arenas, self.seed);
        simulation
    }
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
    /// No free space for a start or goal, or a non-finite number.
    #[error(transparent)]
    Task(#[from] Fault),
    /// A non-finite loss or weight.
    #[error(transparent)]
    Learning(#[from] DivergenceError),
}

/// Runs one control step in all arenas of `world`.
///
/// # Errors
/// - No free space was found for a start or goal.
/// - A number is NaN or infinite. The message names the number, the arena and the step.
pub fn step(world: &mut World) -> Result<(), StepError> {
    world.run_schedule(ControlStep);
    if let Some(fault) = &world.resource::<TaskFault>().0 {
        return Err(fault.clone().into());
    }
    // A suspended training keeps its fault. Only an active one can fail this step.
    let is_training = world.get_resource::<ActionSelection>() == Some(&ActionSelection::EpsilonGreedy)
        && world.contains_resource::<ActiveLearner>();
    let fault = world.get_resource::<TrainingFault>().filter(|_| is_training);
    match fault.and_then(|fault| fault.0.as_ref()) {
        Some(diverged) => Err(diverged.clone().into()),
        None => Ok(()),
    }
}
