//! Evaluations in which the caller chooses the actions, for example with a policy of another library.

use super::evaluator::set_observation;
use super::{EvaluationRun, Evaluator};
use crate::agent::{ActionSelection, GreedyPolicy};
use crate::env::{CommandRules, Commands, VecEnvError};
use crate::policy::Encoding;
use crate::task::{ActiveActionSet, EpisodeSetup, Observations};

impl Evaluator {
    /// Starts an evaluation of `count` episodes whose actions the caller chooses. The starts and goals are those of
    /// [`Evaluator::run`] with the same seed. Per control step, call [`observations`](Self::observations),
    /// [`command`](Self::command) and [`step`](Self::step).
    pub fn start_commanded(
        &mut self,
        encoding: Encoding,
        seed: u64,
        count: usize,
        setup: EpisodeSetup,
    ) -> EvaluationRun {
        let (beams, arenas) = (self.scenario().lidar.beams, self.arenas());
        let world = self.world_mut();
        set_observation(world, encoding, beams, arenas);
        world.insert_resource(ActiveActionSet::default());
        world.remove_resource::<GreedyPolicy>();
        world.insert_resource(ActionSelection::Greedy);
        world.insert_resource(setup);
        EvaluationRun::new(seed, count)
    }

    /// The observations in the current parallel episodes of `run`, one row each, in the order of the episodes. If none
    /// are in progress, the next ones begin. The rows of episodes that have ended have no meaning.
    pub fn observations<'a>(&'a mut self, run: &mut EvaluationRun) -> &'a [f32] {
        self.begin_if_needed(run);
        let world = self.world_mut();
        let width = world.resource::<Observations>().width;
        &world.resource::<Observations>().current[..run.parallel_episodes() * width]
    }

    /// Sets the commands for the next control step: one per row of the observations.
    ///
    /// # Errors
    /// The number of commands is wrong, an action is out of range, or a motion is not finite.
    pub fn command(&mut self, run: &EvaluationRun, commands: Commands<'_>) -> Result<(), VecEnvError> {
        CommandRules::of(self.scenario()).apply(commands, run.parallel_episodes(), self.world_mut())
    }
}
