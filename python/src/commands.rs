//! Commands to robots, from numpy arrays or values that can be converted to one.

use numpy::{
    AllowTypeChange, Element, PyArrayDyn, PyArrayLikeDyn, PyReadonlyArrayDyn, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use wayfield::scenario::Motion;

/// The actions in `given`, which must have the shape `shape`. Indices that are too large are not rejected here.
pub fn actions(given: &Bound<'_, PyAny>, shape: &[usize], num_actions: usize) -> PyResult<Vec<usize>> {
    // NumPy's conversion to integers would drop fractions without an error.
    if given.cast::<PyArrayDyn<i64>>().is_err() {
        let converted: Vec<f64> = numbers(given, shape)?;
        if let Some((env, action)) = converted.iter().enumerate().find(|(_, action)| action.fract() != 0.0) {
            return Err(PyValueError::new_err(format!(
                "action {action} of environment {env} is not a whole number; help: give the index of an action"
            )));
        }
    }
    let index = |(env, action): (usize, i64)| {
        usize::try_from(action).map_err(|_| {
            let last = num_actions - 1;
            PyValueError::new_err(format!(
                "action {action} of environment {env} is out of range: the robot has actions 0 to {last}"
            ))
        })
    };
    numbers(given, shape)?.into_iter().enumerate().map(index).collect()
}

/// The motions in `given` (m/s, rad/s), which must have the shape `shape` with a further axis of length 2.
pub fn motions(given: &Bound<'_, PyAny>, shape: &[usize]) -> PyResult<Vec<Motion>> {
    let numbers = numbers(given, &[shape, &[2]].concat())?;
    let pairs = numbers.as_chunks().0.iter();
    Ok(pairs.map(|&[v_m_s, w_rad_s]| Motion { v_m_s, w_rad_s }).collect())
}

/// The mask in `given`: one bool for each of `count` environments.
pub fn mask(given: &Bound<'_, PyAny>, count: usize) -> PyResult<Vec<bool>> {
    let array: Option<PyArrayLikeDyn<'_, bool>> = given.extract().ok();
    array.filter(|array| array.shape() == [count]).map(|array| values(&array)).ok_or_else(|| {
        PyValueError::new_err(format!(
            "reset_mask is {given}; help: give a bool array of the shape ({count},)"
        ))
    })
}

/// The numbers in `given`, which must have the shape `shape`, row by row.
fn numbers<'py, T>(given: &Bound<'py, PyAny>, shape: &[usize]) -> PyResult<Vec<T>>
where
    T: Element + Copy + 'py,
    PyArrayLikeDyn<'py, T, AllowTypeChange>: for<'a> FromPyObject<'a, 'py, Error = PyErr>,
{
    let array: PyArrayLikeDyn<'py, T, AllowTypeChange> = given.extract()?;
    if array.shape() != shape {
        return Err(PyValueError::new_err(format!(
            "the actions have the shape {}; help: give an array of the shape {}",
            tuple(array.shape()),
            tuple(shape)
        )));
    }
    Ok(values(&array))
}

/// The values of `array`, row by row.
fn values<T: Element + Copy>(array: &PyReadonlyArrayDyn<'_, T>) -> Vec<T> {
    match array.as_slice() {
        // The slice of a column-major array has its values column by column.
        Ok(values) if array.is_c_contiguous() => values.to_vec(),
        _ => array.as_array().iter().copied().collect(),
    }
}

/// A shape as Python writes it.
fn tuple(shape: &[usize]) -> String {
    match shape {
        [length] => format!("({length},)"),
        _ => format!("({})", shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")),
    }
}
