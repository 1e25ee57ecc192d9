//! Steps without Python, with which `benches/throughput.py` compares those from Python.

use pyo3::prelude::*;
use wayfield::env::{VecEnv, VecEnvConfig};
use wayfield::random::{stream, uniform_index};

use crate::env_options::scenario;
use crate::errors::{detached, env_error};

/// Takes `steps` control steps with random actions in `num_envs` environments of Scenario I.
#[pyfunction]
pub fn benchmark(py: Python<'_>, num_envs: usize, steps: u32) -> PyResult<()> {
    let scenario = scenario("scenario-1")?;
    detached(py, || {
        let config = VecEnvConfig { num_envs, ..VecEnvConfig::default() };
        let mut env = VecEnv::new(&scenario, config).map_err(env_error)?;
        let (mut random, num_actions) = (stream(1, "actions", 0), env.num_actions());
        for _ in 0..steps {
            let actions: Vec<usize> =
                (0..num_envs).map(|_| uniform_index(&mut random, num_actions)).collect();
            env.step(&actions).map_err(env_error)?;
        }
        Ok(())
    })
}
