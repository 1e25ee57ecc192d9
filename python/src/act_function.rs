//! Python functions that choose the actions of an evaluation.

use pyo3::prelude::*;
use wayfield::env::Commands;
use wayfield::policy::Encoding;
use wayfield::run::evaluate::{EvaluationRun, Evaluator};

use crate::arrays::rows;
use crate::commands::{actions, motions};
use crate::errors::env_error;

/// A Python function that chooses the actions of an evaluation.
pub struct ActFunction {
    /// The function: takes observations (rows x width), and returns an array of commands.
    pub act: Py<PyAny>,
    /// The encoding of the observations.
    pub encoding: Encoding,
    /// Whether the function returns motions instead of actions.
    pub is_continuous: bool,
}

impl ActFunction {
    /// Calls the function, and sets the commands that it returns for the next step of `run`. The robot has `num_actions` motions.
    ///
    /// # Errors
    /// The function raised an exception or returned invalid commands, or Ctrl-C was pressed.
    pub fn command(
        &self,
        evaluator: &mut Evaluator,
        run: &mut EvaluationRun,
        num_actions: usize,
    ) -> PyResult<()> {
        Python::attach(|py| {
            // A function that is not written in Python does not check this itself.
            py.check_signals()?;
            let observations = evaluator.observations(run);
            let count = run.parallel_episodes();
            let observations = rows(py, observations, observations.len() / count.max(1))?;
            let returned = self.act.bind(py).call1((observations,))?;
            let result = if self.is_continuous {
                evaluator.command(run, Commands::Motions(&motions(&returned, &[count])?))
            } else {
                evaluator.command(run, Commands::Actions(&actions(&returned, &[count], num_actions)?))
            };
            result.map_err(env_error)
        })
    }
}
