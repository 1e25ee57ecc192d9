//! New numpy arrays.

use numpy::PyArray2;
use numpy::ndarray::ArrayView2;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// A new array of `numbers` in rows of `width`.
pub fn rows<'py>(py: Python<'py>, numbers: &[f32], width: usize) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let count = numbers.len() / width.max(1);
    let view = ArrayView2::from_shape((count, width), numbers);
    view.map(|view| PyArray2::from_array(py, &view))
        .map_err(|error| PyRuntimeError::new_err(error.to_string()))
}
