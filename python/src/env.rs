//! Environments: steps and resets that return numpy arrays.

use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::{PyIndexError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use wayfield::env::{Autoreset, Step, VecEnv, VecEnvError};
use wayfield::policy::Encoding;
use wayfield::report::raster;
use wayfield::run::scenario_image;
use wayfield::scenario::Scenario;
use wayfield::sim;

use crate::arrays::rows;
use crate::commands;
use crate::env_options::{EnvOptions, is_continuous, scenario_or_set};
use crate::errors::{detached, env_error};
use crate::observation_bounds::ObservationBounds;
use crate::step_details::StepDetails;

/// Observations (envs x width), rewards, terminated, truncated, and the details for `info`.
type Stepped<'py> = (
    Bound<'py, PyArray2<f32>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<bool>>,
    Bound<'py, PyArray1<bool>>,
    StepDetails,
);

/// Observation, reward, terminated, truncated and info.
type SteppedOne<'py> = (Bound<'py, PyArray1<f32>>, f64, bool, bool, Bound<'py, PyDict>);

/// Environments of one scenario or of a set of scenarios, stepped together.
#[pyclass(module = "wayfield._native")]
pub struct NativeEnv {
    /// `None` after a panic.
    env: Option<Box<VecEnv>>,
    /// The scenario, or the first one of the set.
    scenario: Scenario,
    encoding: Encoding,
    bounds: ObservationBounds,
    autoreset: Autoreset,
    is_continuous: bool,
    results: Results,
}

/// The results of a step, one per environment.
#[derive(Default)]
pub(crate) struct Results {
    rewards: Vec<f64>,
    terminated: Vec<bool>,
    truncated: Vec<bool>,
}

impl Results {
    fn fill(&mut self, step: &Step<'_>) {
        self.rewards.clear();
        self.rewards.extend(step.rewards.iter().copied().map(f64::from));
        step.terminated.clone_into(&mut self.terminated);
        step.truncated.clone_into(&mut self.truncated);
    }
}

#[pymethods]
impl NativeEnv {
    /// Environments of the scenario or set `wanted` (a shipped name, a path or RON text). They must be reset before the first
    /// step.
    #[new]
    fn new(py: Python<'_>, wanted: &str, options: EnvOptions) -> PyResult<Self> {
        let (mut scenario, set) = scenario_or_set(wanted)?;
        let is_continuous = is_continuous(&options.actions)?;
        let (config, bounds) = options.config(&mut scenario, set)?;
        let (encoding, autoreset) = (config.encoding, config.autoreset);
        let env = detached(py, || VecEnv::new(&scenario, config).map(Box::new).map_err(env_error))?;
        Ok(Self {
            env: Some(env),
            scenario,
            encoding,
            bounds,
            autoreset,
            is_continuous,
            results: Results::default(),
        })
    }

    /// Starts new episodes in all environments, or in those of `mask`. Returns all observations (envs x width).
    #[pyo3(signature = (seed=None, mask=None))]
    fn reset<'py>(
        &mut self,
        py: Python<'py>,
        seed: Option<u64>,
        mask: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let mask = mask.map(|mask| commands::mask(mask, self.env()?.num_envs())).transpose()?;
        self.run(py, |env, _| {
            let mask = mask.unwrap_or_else(|| vec![true; env.num_envs()]);
            env.reset_selected(&mask, seed).map(|_| ())
        })?;
        self.observations(py)
    }

    /// Takes a step with `actions`: integers, one per environment, or motions (envs x 2: m/s, rad/s).
    fn step<'py>(&mut self, py: Python<'py>, actions: &Bound<'py, PyAny>) -> PyResult<Stepped<'py>> {
        let details = self.take_step(py, actions, &[self.env()?.num_envs()])?;
        let Results { rewards, terminated, truncated } = &self.results;
        Ok((
            self.observations(py)?,
            PyArray1::from_slice(py, rewards),
            PyArray1::from_slice(py, terminated),
            PyArray1::from_slice(py, truncated),
            details,
        ))
    }

    /// Takes a step of the only environment, with an integer or a motion (m/s, rad/s).
    fn step_one<'py>(&mut self, py: Python<'py>, action: &Bound<'py, PyAny>) -> PyResult<SteppedOne<'py>> {
        let info = self.take_step(py, action, &[])?.single_info(py)?;
        let Results { rewards, terminated, truncated } = &self.results;
        let observation = PyArray1::from_slice(py, self.env()?.observations());
        Ok((observation, rewards[0], terminated[0], truncated[0], info))
    }

    /// An image of one environment, with `scale` pixels per SVG pixel: height and width in pixels, and the RGB bytes.
    fn render<'py>(
        &mut self,
        py: Python<'py>,
        index: usize,
        scale: f32,
    ) -> PyResult<(usize, usize, Bound<'py, PyBytes>)> {
        let svg =
            self.run(py, |env, _| Ok(scenario_image::frame_svg(env.simulation_mut().world_mut(), index)))?;
        let failed = |error| PyRuntimeError::new_err(format!("the environment can't be drawn: {error}"));
        let svg = svg.ok_or_else(|| no_such_env(index))?.map_err(failed)?;
        let image = detached(py, || raster::rgb(&svg, scale).map_err(failed))?;
        Ok((image.height, image.width, PyBytes::new(py, &image.bytes)))
    }

    /// The state of one environment, in m, rad, m/s and rad/s.
    fn state<'py>(&mut self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyDict>> {
        let states = self.run(py, |env, _| Ok(sim::snapshot(env.simulation_mut().world_mut())))?;
        let state = states.into_iter().nth(index).ok_or_else(|| no_such_env(index))?;
        let values = PyDict::new(py);
        values.set_item("pose", (state.pose.x_m, state.pose.y_m, state.pose.heading_rad))?;
        values.set_item("velocity", (state.twist.v_m_s, state.twist.w_rad_s))?;
        values.set_item("goal", (state.goal.x_m, state.goal.y_m))?;
        values.set_item("ranges", state.scan.ranges_m)?;
        values.set_item("clock", state.clock.0)?;
        values.set_item("episode_steps", state.episode.steps)?;
        Ok(values)
    }

    /// The number of discrete actions.
    #[getter]
    fn num_actions(&self) -> usize {
        self.scenario.robot.motions.len()
    }

    /// The length of an observation.
    #[getter]
    fn observation_width(&self) -> usize {
        self.encoding.width(self.scenario.lidar.beams)
    }

    /// The smallest and the largest value of every entry of an observation; infinite where there is no bound.
    #[getter]
    fn observation_bounds(&self) -> (&[f32], &[f32]) {
        (&self.bounds.low, &self.bounds.high)
    }

    /// The smallest and the largest motion that can be commanded, as speeds in m/s and turning rates in rad/s.
    #[getter]
    fn motion_limits(&self) -> PyResult<((f32, f32), (f32, f32))> {
        let (low, high) = self.env()?.motion_limits();
        Ok(((low.v_m_s, low.w_rad_s), (high.v_m_s, high.w_rad_s)))
    }

    /// The motions of the discrete actions, as speeds in m/s and turning rates in rad/s.
    #[getter]
    fn motions(&self) -> Vec<(f32, f32)> {
        self.scenario.robot.motions.iter().map(|motion| (motion.v_m_s, motion.w_rad_s)).collect()
    }

    /// The scenario's name.
    #[getter]
    fn scenario_name(&self) -> &str {
        &self.scenario.name
    }

    /// The control period in s; that of the first scenario of a set.
    #[getter]
    fn control_period_s(&self) -> f64 {
        wayfield::run::evaluate::period_s(self.scenario.task.control_period_s)
    }

    /// Whether actions are motions.
    #[getter]
    fn is_continuous(&self) -> bool {
        self.is_continuous
    }
}

impl NativeEnv {
    fn env(&self) -> PyResult<&VecEnv> {
        self.env.as_deref().ok_or_else(broken)
    }

    /// Runs `work` without the GIL. After a panic, the environments are gone.
    pub(crate) fn run<T: Send>(
        &mut self,
        py: Python<'_>,
        work: impl FnOnce(&mut VecEnv, &mut Results) -> Result<T, VecEnvError> + Send,
    ) -> PyResult<T> {
        let mut env = self.env.take().ok_or_else(broken)?;
        let results = &mut self.results;
        let (env, result) = detached(py, move || {
            let result = work(&mut env, results);
            Ok((env, result))
        })?;
        self.env = Some(env);
        result.map_err(env_error)
    }

    /// Whether ended environments wait for the caller's reset.
    pub(crate) fn waits_for_resets(&self) -> bool {
        self.autoreset == Autoreset::Disabled
    }

    /// Takes a step. Actions must have the shape `shape`; motions have a further axis of length 2.
    fn take_step<'py>(
        &mut self,
        py: Python<'py>,
        actions: &Bound<'py, PyAny>,
        shape: &[usize],
    ) -> PyResult<StepDetails> {
        let resets_in_step = self.autoreset == Autoreset::SameStep;
        let details = move |step: Step<'_>, results: &mut Results| {
            results.fill(&step);
            StepDetails::new(step.outcomes, resets_in_step.then_some(step.final_observations))
        };
        if self.is_continuous {
            let motions = commands::motions(actions, shape)?;
            self.run(py, |env, results| env.step_motions(&motions).map(|step| details(step, results)))
        } else {
            let actions = commands::actions(actions, shape, self.num_actions())?;
            self.run(py, |env, results| env.step(&actions).map(|step| details(step, results)))
        }
    }

    fn observations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let env = self.env()?;
        rows(py, env.observations(), env.observation_width())
    }
}

fn broken() -> PyErr {
    PyRuntimeError::new_err("an internal error has ended these environments; help: make new ones")
}

fn no_such_env(index: usize) -> PyErr {
    PyIndexError::new_err(format!("there is no environment {index}"))
}
