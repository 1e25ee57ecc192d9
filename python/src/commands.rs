//! Commands to robots, from numpy's arrays.

use pyo3::buffer::PyBuffer;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use wayfield::scenario::Motion;

/// The actions in `buffer`, one per environment. Those that are too large pass.
pub fn actions(py: Python<'_>, buffer: &PyBuffer<i64>, num_actions: usize) -> PyResult<Vec<usize>> {
    let index = |(env, action): (usize, i64)| {
        usize::try_from(action).map_err(|_| {
            let last = num_actions - 1;
            PyValueError::new_err(format!(
                "action {action} of environment {env} is out of range: the robot has actions 0 to {last}"
            ))
        })
    };
    buffer.to_vec(py)?.into_iter().enumerate().map(index).collect()
}

/// The motions in `buffer` (environments x 2: m/s, rad/s).
pub fn motions(py: Python<'_>, buffer: &PyBuffer<f32>) -> PyResult<Vec<Motion>> {
    let numbers = buffer.to_vec(py)?;
    let pairs = numbers.as_chunks().0.iter();
    Ok(pairs.map(|&[v_m_s, w_rad_s]| Motion { v_m_s, w_rad_s }).collect())
}
