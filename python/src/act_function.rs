//! Functions of Python that choose the actions of an evaluation.

use pyo3::prelude::*;
use pyo3::types::PyByteArray;
use wayfield::env::Commands;
use wayfield::policy::Encoding;
use wayfield::run::evaluate::{EvaluationRun, Evaluator};

use crate::commands::{actions, motions};
use crate::errors::env_error;

/// A function of Python that chooses the actions of an evaluation.
pub struct ActFunction {
    /// The function: observations as bytes, and their number, to an array of commands.
    pub act: Py<PyAny>,
    /// The encoding of the observations.
    pub encoding: Encoding,
    /// Whether it returns motions instead of actions.
    pub is_continuous: bool,
}

impl ActFunction {
    /// Sets the commands for the next step of `run`. The robot has `num_actions` motions.
    pub fn command(
        &self,
        evaluator: &mut Evaluator,
        run: &mut EvaluationRun,
        num_actions: usize,
    ) -> PyResult<()> {
        let observations = evaluator.observations(run);
        let bytes: Vec<u8> = observations.iter().flat_map(|number| number.to_ne_bytes()).collect();
        Python::attach(|py| {
            let count = run.parallel_episodes();
            let returned = self.act.bind(py).call1((PyByteArray::new(py, &bytes), count))?;
            let result = if self.is_continuous {
                evaluator.command(run, Commands::Motions(&motions(py, &returned.extract()?)?))
            } else {
                evaluator.command(run, Commands::Actions(&actions(py, &returned.extract()?, num_actions)?))
            };
            result.map_err(env_error)
        })
    }
}
