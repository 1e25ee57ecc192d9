//! Policies: Q-values of batches of observations, the card, and ONNX export.

use std::path::{Path, PathBuf};

use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use wayfield::cli;
use wayfield::export::EvalResults;
use wayfield::policy::{Encoding, Policy, Scratch, observation};
use wayfield::run::export::{ModelCardFile, export_policy};
use wayfield::run::{policy_card, shipped};

use crate::arrays::rows;
use crate::errors::{detached, file_error, run_error};

/// A trained Q-network with its card.
#[pyclass(module = "wayfield._native", frozen)]
pub struct NativePolicy {
    pub policy: Policy,
    encoding: Encoding,
    /// Whether the policy is tested with a map that is built as it drives.
    #[pyo3(get)]
    pub with_map: bool,
}

impl TryFrom<Policy> for NativePolicy {
    type Error = PyErr;

    fn try_from(policy: Policy) -> PyResult<Self> {
        let encoding = policy_card::encoding(&policy).map_err(run_error)?;
        Ok(Self { policy, encoding, with_map: false })
    }
}

impl NativePolicy {
    /// The policy, tested with a map if `with_map`.
    pub fn given_map(self, with_map: bool) -> Self {
        Self { with_map, ..self }
    }
}

#[pymethods]
impl NativePolicy {
    /// The policy in the file `wanted`, or the shipped policy of that name.
    #[new]
    fn new(wanted: &str) -> PyResult<Self> {
        let policy = cli::load_policy(Path::new(wanted)).map_err(|error| file_error(wanted, error))?;
        Self::try_from(policy)
    }

    /// The policy in the bytes of a file, tested with a map if `with_map`.
    #[staticmethod]
    #[pyo3(signature = (contents, with_map=false))]
    fn from_bytes(contents: &[u8], with_map: bool) -> PyResult<Self> {
        let policy = Policy::from_bytes(contents);
        let policy = Self::try_from(policy.map_err(|error| PyValueError::new_err(error.to_string()))?)?;
        Ok(policy.given_map(with_map))
    }

    /// The Q-values (rows x actions) of `observations` (rows x inputs).
    fn q_values<'py>(
        &self,
        py: Python<'py>,
        observations: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let observations: Vec<f32> = observations.as_array().iter().copied().collect();
        let values = detached(py, || {
            let mut scratch = Scratch::default();
            let rows = observations.chunks_exact(self.inputs());
            Ok(rows.flat_map(|row| self.policy.q_values(row, &mut scratch).to_vec()).collect::<Vec<f32>>())
        })?;
        rows(py, &values, self.actions())
    }

    /// The observation (width) that encodes a scan (beams, in m) and a goal.
    fn encode<'py>(
        &self,
        py: Python<'py>,
        ranges_m: Vec<f32>,
        bearing_rad: f32,
        distance_m: f32,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        if self.encoding.sectors().is_some() {
            return Err(PyValueError::new_err(
                "this policy observes by sectors, with what the robot has seen before, so that one scan is not enough; help: drive \
                 with policy.driver(scenario), which remembers it",
            ));
        }
        policy_card::check_without_sensors(&self.policy).map_err(run_error)?;
        let (width, inputs) = (observation::width(ranges_m.len()), self.inputs());
        if width != inputs {
            return Err(PyValueError::new_err(format!(
                "the scan has {} ranges; help: give {} of them, counterclockwise, from the first beam on the policy's card",
                ranges_m.len(),
                inputs.saturating_sub(observation::width(0))
            )));
        }
        let mut row = vec![0.0; width];
        observation::encode(self.encoding, &ranges_m, bearing_rad, distance_m, &mut row);
        Ok(PyArray1::from_slice(py, &row))
    }

    /// The policy's header as JSON: network, card, and metadata of older files.
    fn header(&self) -> PyResult<String> {
        self.policy.header().map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// The bytes of the policy's file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.policy.to_bytes().map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Writes the ONNX file `path`, and in its folder a model card with the test `results` (each as JSON). Returns the path of
    /// the model card if it was written.
    fn export_onnx(&self, path: PathBuf, results: Vec<String>) -> PyResult<Option<PathBuf>> {
        let parse = |json: &String| {
            EvalResults::parse(json.as_bytes(), &self.policy)
                .map_err(|error| PyValueError::new_err(error.to_string()))
        };
        let results = results.iter().map(parse).collect::<PyResult<Vec<_>>>()?;
        let card = export_policy(&self.policy, Path::new("the policy"), &path, &results);
        match card.map_err(run_error)? {
            ModelCardFile::Written(page) => Ok(Some(page)),
            ModelCardFile::Kept(_) | ModelCardFile::None => Ok(None),
        }
    }

    /// The length of an observation.
    #[getter]
    fn inputs(&self) -> usize {
        self.policy.shape().inputs
    }

    /// The number of actions.
    #[getter]
    fn actions(&self) -> usize {
        self.policy.shape().actions
    }

    /// The names of the shipped policies.
    #[staticmethod]
    fn shipped() -> Vec<&'static str> {
        shipped::policies().iter().map(|shipped| shipped.scenario_from).collect()
    }
}
