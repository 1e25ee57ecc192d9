//! The native rate of steps, with which `benches/throughput.py` compares the rate from Python.

use std::time::{Duration, Instant};

use pyo3::prelude::*;
use wayfield::env::{VecEnv, VecEnvConfig};
use wayfield::random::{stream, uniform_index};

use crate::env_options::scenario;
use crate::errors::{detached, env_error};

/// The control steps between two looks at the clock.
const STEPS: u32 = 100;

/// Env steps per second of `num_envs` environments in Scenario I with random actions, measured for `seconds` without Python.
#[pyfunction]
pub fn benchmark(py: Python<'_>, num_envs: usize, seconds: f64) -> PyResult<f64> {
    let scenario = scenario("scenario-1")?;
    detached(py, || {
        let config = VecEnvConfig { num_envs, ..VecEnvConfig::default() };
        let mut env = VecEnv::new(&scenario, config).map_err(env_error)?;
        let (mut random, num_actions) = (stream(1, "actions", 0), env.num_actions());
        let mut steps = |count: u32| {
            for _ in 0..count {
                let actions: Vec<usize> =
                    (0..num_envs).map(|_| uniform_index(&mut random, num_actions)).collect();
                env.step(&actions).map_err(env_error)?;
            }
            PyResult::Ok(())
        };
        steps(2 * STEPS)?;
        let (began, mut taken) = (Instant::now(), 0);
        while began.elapsed() < Duration::from_secs_f64(seconds.clamp(0.0, 3600.0)) {
            steps(STEPS)?;
            taken += STEPS;
        }
        Ok(f64::from(taken) * num_envs as f64 / began.elapsed().as_secs_f64())
    })
}
