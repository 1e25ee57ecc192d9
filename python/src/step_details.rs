//! What a step did, beyond the numbers that it returns: the contents of `info`.

use numpy::{Element, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use wayfield::task::StepOutcome;

/// The name of a value, and the function that reads it from an outcome.
type Named<T> = (&'static str, fn(&StepOutcome) -> T);

/// The reward's terms, with the names of the columns in `episodes.csv`.
const TERMS: [Named<f64>; 4] = [
    ("reward_goal", |outcome| outcome.reward.reached.into()),
    ("reward_collision", |outcome| outcome.reward.collided.into()),
    ("reward_attraction", |outcome| outcome.reward.attraction.into()),
    ("reward_repulsion", |outcome| outcome.reward.repulsion.into()),
];

/// What happened to the robot, by name.
const EVENTS: [Named<bool>; 2] =
    [("is_success", |outcome| outcome.reached), ("collision", |outcome| outcome.collided)];

/// The details of a step of all environments. The arrays are made only when they are asked for, because most loops read none.
#[pyclass(module = "wayfield._native", frozen)]
pub struct StepDetails {
    outcomes: Vec<StepOutcome>,
    /// The observations before any reset, if an episode ended in this step and the next one began.
    final_observations: Option<Vec<f32>>,
}

#[pymethods]
impl StepDetails {
    /// The contents of `info`: arrays by name, with Gymnasium's masks.
    fn info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let values = self.values(py);
        let Some(observations) = &self.final_observations else {
            return masked(&values, &self.column(py, |outcome| !outcome.inactive));
        };
        let done = self.column(py, has_ended);
        let info = masked(&values, &self.column(py, |outcome| !has_ended(outcome)))?;
        info.set_item("final_info", masked(&values, &done)?)?;
        info.set_item("final_obs", self.final_rows(py, observations))?;
        info.set_item("_final_obs", &done)?;
        info.set_item("_final_info", &done)?;
        Ok(info)
    }
}

impl StepDetails {
    /// The details of the step with `outcomes`. `final_observations` are the observations before any reset; `None` if this step
    /// cannot have included a reset.
    pub fn new(outcomes: &[StepOutcome], final_observations: Option<&[f32]>) -> Self {
        let kept = final_observations.filter(|_| outcomes.iter().any(has_ended));
        Self { outcomes: outcomes.to_vec(), final_observations: kept.map(<[f32]>::to_vec) }
    }

    /// The `info` of the only environment: plain values by name.
    pub fn single_info<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let info = PyDict::new(py);
        if let Some(outcome) = self.outcomes.first() {
            TERMS.iter().try_for_each(|(name, term)| info.set_item(name, term(outcome)))?;
            EVENTS.iter().try_for_each(|(name, event)| info.set_item(name, event(outcome)))?;
        }
        Ok(info)
    }

    fn values<'py>(&self, py: Python<'py>) -> Vec<(&'static str, Bound<'py, PyAny>)> {
        let terms = TERMS.iter().map(|(name, term)| (*name, self.column(py, term)));
        terms.chain(EVENTS.iter().map(|(name, event)| (*name, self.column(py, event)))).collect()
    }

    fn column<'py, T: Element>(
        &self,
        py: Python<'py>,
        value: impl Fn(&StepOutcome) -> T,
    ) -> Bound<'py, PyAny> {
        PyArray1::from_iter(py, self.outcomes.iter().map(value)).into_any()
    }

    /// An array of objects: the final observation of each ended environment, None for the others.
    fn final_rows<'py>(&self, py: Python<'py>, observations: &[f32]) -> Bound<'py, PyAny> {
        let rows = observations.chunks_exact((observations.len() / self.outcomes.len()).max(1));
        let row = |(outcome, row)| match has_ended(outcome) {
            true => PyArray1::from_slice(py, row).into_any().unbind(),
            false => py.None(),
        };
        PyArray1::from_iter(py, self.outcomes.iter().zip(rows).map(row)).into_any()
    }
}

fn has_ended(outcome: &StepOutcome) -> bool {
    outcome.terminated() || outcome.truncated()
}

/// A dict of `values`, each with the `mask` of the environments in which it is valid.
fn masked<'py>(
    values: &[(&'static str, Bound<'py, PyAny>)],
    mask: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(mask.py());
    values.iter().try_for_each(|(name, value)| dict.set_item(name, value))?;
    values.iter().try_for_each(|(name, _)| dict.set_item(format!("_{name}"), mask))?;
    Ok(dict)
}
