//! The builder of simulations.

use std::sync::Arc;

use bevy::prelude::*;

use super::{Extensions, Simulation};
use crate::agent::{ActionSelection, AgentPlugin, TrainingPlugin};
use crate::control_step::ControlStepPlugin;
use crate::policy::Encoding;
use crate::scenario::Scenario;
use crate::sim::{SimPlugin, spawn_arenas};
use crate::task::{RewardConfig, TaskMode, TaskPlugin};

/// What chooses the actions.
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

    /// Sets the encoding of the observation.
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

    /// Sets the user's plugins.
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

    /// Adds an agent that explores and learns. Insert the learner as
    /// [`ActiveLearner`](crate::agent::ActiveLearner) before the first step.
    #[must_use]
    pub fn training(self) -> Self {
        Self { agent: Agent::Training, ..self }
    }

    /// Adds the plugins to `app`, whose runner decides when
    /// [`ControlStep`](crate::control_step::ControlStep) runs. Spawns no arena.
    pub fn add_to(&self, app: &mut App) {
        app.add_plugins((
            ControlStepPlugin,
            TaskPlugin { observation: self.encoding, reward: self.reward.clone(), mode: self.mode },
            SimPlugin,
        ));
        let (seed, arenas) = (self.seed, self.arenas);
        match self.agent {
            Agent::Caller => {}
            Agent::Plugin(action_selection) => {
                app.add_plugins(AgentPlugin { action_selection, seed, arenas });
            }
            Agent::Training => {
                let action_selection = ActionSelection::EpsilonGreedy;
                app.add_plugins((AgentPlugin { action_selection, seed, arenas }, TrainingPlugin));
            }
        }
        self.extensions.build(app);
    }

    /// Builds a headless simulation without arenas; call [`spawn_arenas`] next.
    #[must_use]
    pub(crate) fn build_empty(&self) -> Simulation {
        let mut app = App::new();
        app.add_plugins(MinimalPlugins);
        self.add_to(&mut app);
        // As an app's runner does, up to and including the first frame.
        app.finish();
        app.cleanup();
        app.update();
        // Keeps the world only, because an app cannot move between threads.
        Simulation { world: std::mem::take(app.world_mut()) }
    }

    /// Builds a headless simulation, with every arena at its first observation.
    #[must_use]
    pub fn build(&self) -> Simulation {
        let mut simulation = self.build_empty();
        spawn_arenas(&mut simulation.world, &self.scenario, self.arenas, self.seed);
        simulation
    }
}
