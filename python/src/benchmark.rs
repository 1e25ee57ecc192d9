//! Steps without Python, with which `benches/throughput.py` compares those from Python.

use pyo3::prelude::*;
use wayfield::random::{stream, uniform_index};

use crate::env::NativeEnv;

/// The number of different rows of actions.
const ROWS: usize = 1000;

/// Takes `steps` control steps with random actions in the environments `env`, which must not need a reset by the caller.
#[pyfunction]
pub fn benchmark(py: Python<'_>, mut env: PyRefMut<'_, NativeEnv>, steps: usize) -> PyResult<()> {
    env.run(py, |env, _| {
        let mut random = stream(1, "actions", 0);
        let (envs, num_actions) = (env.num_envs(), env.num_actions());
        let actions: Vec<usize> = (0..ROWS * envs).map(|_| uniform_index(&mut random, num_actions)).collect();
        actions.chunks_exact(envs).cycle().take(steps).try_for_each(|row| env.step(row).map(|_| ()))
    })
}
