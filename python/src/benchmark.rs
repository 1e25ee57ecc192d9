//! A benchmark of steps without Python; `benches/throughput.py` compares steps from Python with it.

use pyo3::prelude::*;
use wayfield::random::{stream, uniform_index};

use crate::env::NativeEnv;

/// The number of different rows of actions.
const ROWS: usize = 1000;

/// Takes `steps` control steps with random actions in the environments of `env`, and resets those that wait for a reset.
#[pyfunction]
pub fn benchmark(py: Python<'_>, mut env: PyRefMut<'_, NativeEnv>, steps: usize) -> PyResult<()> {
    let waits_for_resets = env.waits_for_resets();
    env.run(py, |env, _| {
        let mut random = stream(1, "actions", 0);
        let (envs, num_actions) = (env.num_envs(), env.num_actions());
        let actions: Vec<usize> =
            (0..steps.min(ROWS) * envs).map(|_| uniform_index(&mut random, num_actions)).collect();
        let mut ended = Vec::with_capacity(envs);
        for row in actions.chunks_exact(envs).cycle().take(steps) {
            let step = env.step(row)?;
            if waits_for_resets {
                ended.clear();
                ended.extend(step.terminated.iter().zip(step.truncated).map(|(a, b)| a | b));
                if ended.contains(&true) {
                    env.reset_selected(&ended, None)?;
                }
            }
        }
        Ok(())
    })
}
