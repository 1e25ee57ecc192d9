//! Environments: steps and resets that write into numpy's arrays.

use std::f32::consts::PI;

use pyo3::buffer::PyBuffer;
use pyo3::exceptions::{PyIndexError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use wayfield::env::{Step, VecEnv, VecEnvError};
use wayfield::policy::{Encoding, observation};
use wayfield::report::raster;
use wayfield::run::scenario_image;
use wayfield::scenario::Scenario;
use wayfield::sim;
use wayfield::task::StepOutcome;

use crate::commands;
use crate::env_options::{EnvOptions, scenario};
use crate::errors::{detached, env_error};

/// The names of the reward's terms, as in `episodes.csv`.
const REWARD_TERMS: [&str; 4] = ["reward_goal", "reward_collision", "reward_attraction", "reward_repulsion"];

/// The flags of an environment after a step.
const FLAGS: [&str; 5] = ["terminated", "truncated", "is_success", "collision", "stepped"];

/// The arrays that a step fills: observations (f32, envs x width), the rewards and their terms (f64, (1 + terms) x envs), and
/// the flags (u8, flags x envs).
type Outputs = (PyBuffer<f32>, PyBuffer<f64>, PyBuffer<u8>);

/// Environments of one scenario, stepped together.
#[pyclass(module = "wayfield._native")]
pub struct NativeEnv {
    /// `None` after a panic.
    env: Option<Box<VecEnv>>,
    scenario: Scenario,
    encoding: Encoding,
    results: Results,
}

/// The results of a step.
#[derive(Default)]
pub(crate) struct Results {
    numbers: Vec<f64>,
    flags: Vec<u8>,
    any_ended: bool,
}

impl Results {
    fn fill(&mut self, step: &Step<'_>) {
        let envs = step.outcomes.len();
        self.numbers.resize((1 + REWARD_TERMS.len()) * envs, 0.0);
        self.flags.resize(FLAGS.len() * envs, 0);
        self.any_ended = false;
        for (env, outcome) in step.outcomes.iter().enumerate() {
            let StepOutcome { reward, reached, collided, inactive, .. } = *outcome;
            let (terminated, truncated) = (step.terminated[env], step.truncated[env]);
            let numbers =
                [step.rewards[env], reward.reached, reward.collided, reward.attraction, reward.repulsion];
            for (row, number) in numbers.into_iter().enumerate() {
                self.numbers[row * envs + env] = f64::from(number);
            }
            for (row, flag) in [terminated, truncated, reached, collided, !inactive].into_iter().enumerate() {
                self.flags[row * envs + env] = u8::from(flag);
            }
            self.any_ended |= terminated || truncated;
        }
    }
}

#[pymethods]
impl NativeEnv {
    /// Environments of the scenario with the shipped name, path or text `wanted`. They must be reset before the first step.
    #[new]
    fn new(py: Python<'_>, wanted: &str, options: EnvOptions) -> PyResult<Self> {
        let mut scenario = scenario(wanted)?;
        let config = options.config(&mut scenario)?;
        let encoding = config.encoding;
        let env = detached(py, || VecEnv::new(&scenario, config).map(Box::new).map_err(env_error))?;
        Ok(Self { env: Some(env), scenario, encoding, results: Results::default() })
    }

    /// Starts new episodes in all environments, or in those of `mask`, and writes all observations (f32, envs x width).
    #[pyo3(signature = (observations, seed=None, mask=None))]
    fn reset(
        &mut self,
        py: Python<'_>,
        observations: PyBuffer<f32>,
        seed: Option<u64>,
        mask: Option<Vec<bool>>,
    ) -> PyResult<()> {
        self.run(py, |env, _| {
            let mask = mask.unwrap_or_else(|| vec![true; env.num_envs()]);
            env.reset_selected(&mask, seed).map(|_| ())
        })?;
        observations.copy_from_slice(py, self.env()?.observations())
    }

    /// Takes a step with `actions` (i64, one per environment). Returns whether an episode has ended.
    fn step(&mut self, py: Python<'_>, actions: PyBuffer<i64>, outputs: Outputs) -> PyResult<bool> {
        let actions = commands::actions(py, &actions, self.env()?.num_actions())?;
        self.run(py, |env, results| env.step(&actions).map(|step| results.fill(&step)))?;
        self.write(py, &outputs)
    }

    /// Takes a step with commanded motions (f32, envs x 2: m/s, rad/s). Returns whether an episode has ended.
    fn step_motions(&mut self, py: Python<'_>, motions: PyBuffer<f32>, outputs: Outputs) -> PyResult<bool> {
        let motions = commands::motions(py, &motions)?;
        self.run(py, |env, results| env.step_motions(&motions).map(|step| results.fill(&step)))?;
        self.write(py, &outputs)
    }

    /// Writes the observations after the last step and before any reset (f32, envs x width).
    fn final_observations(&self, py: Python<'_>, observations: PyBuffer<f32>) -> PyResult<()> {
        observations.copy_from_slice(py, self.env()?.final_observations())
    }

    /// A picture of one environment: height and width in pixels, and the RGB bytes.
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

    /// The state of one environment, in m and rad.
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
        observation::width(self.scenario.lidar.beams)
    }

    /// The least and the greatest value of every number of an observation.
    #[getter]
    fn observation_bounds(&self) -> (Vec<f32>, Vec<f32>) {
        let lidar = &self.scenario.lidar;
        let corners = self.scenario.enclosure.corners_m();
        let distances = corners.iter().flat_map(|a| corners.iter().map(|b| a.distance(*b)));
        // The tolerance is for rounding.
        let farthest_m = 1.001 * distances.fold(0.0, f32::max);
        let encode = |ranges_m: &[f32], bearing_rad, distance_m| {
            let mut row = vec![0.0; self.observation_width()];
            observation::encode(self.encoding, ranges_m, bearing_rad, distance_m, &mut row);
            row
        };
        let mut ranges_m = vec![lidar.max_range_m; lidar.beams];
        let mut high = encode(&ranges_m, PI, farthest_m);
        // The index of the nearest beam is largest if the last beam is the nearest.
        if let (Some(range), Some(index)) = (ranges_m.last_mut(), high.last_mut()) {
            *range = 0.0;
            *index = encode(&ranges_m, PI, farthest_m).pop().unwrap_or_default();
        }
        (encode(&vec![0.0; lidar.beams], -PI, 0.0), high)
    }

    /// The least and the greatest commanded motion, as speeds in m/s and turning rates in rad/s.
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

    /// The control period in s.
    #[getter]
    fn control_period_s(&self) -> f64 {
        wayfield::run::evaluate::period_s(self.scenario.task.control_period_s)
    }

    /// The names of the reward's terms: the rows of a step's numbers after the first.
    #[classattr]
    fn reward_terms() -> [&'static str; 4] {
        REWARD_TERMS
    }

    /// The names of a step's flags, row by row.
    #[classattr]
    fn flags() -> [&'static str; 5] {
        FLAGS
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

    fn write(&self, py: Python<'_>, (observations, numbers, flags): &Outputs) -> PyResult<bool> {
        observations.copy_from_slice(py, self.env()?.observations())?;
        numbers.copy_from_slice(py, &self.results.numbers)?;
        flags.copy_from_slice(py, &self.results.flags)?;
        Ok(self.results.any_ended)
    }
}

fn broken() -> PyErr {
    PyRuntimeError::new_err("an internal error has ended these environments; help: make new ones")
}

fn no_such_env(index: usize) -> PyErr {
    PyIndexError::new_err(format!("there is no environment {index}"))
}
