//! Policies that drive robots outside wayfield, step by step. In: what the robot senses. Out: the motion to command.

use std::f64::consts::TAU;

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use wayfield::drivers::{Driver, DrivingPolicy, Odometry, Percept};
use wayfield::run::evaluate::{check_compatible, period_s};
use wayfield::run::policy_card;
use wayfield::scenario::{Motion, Scenario};
use wayfield::task::{ObservationLayout, wrap_angle};

use crate::env_options::{scenario as find_scenario, settings as settings_of};
use crate::errors::{detached, run_error, setting_errors};
use crate::policy::NativePolicy;

/// The largest magnitude of a number in a robot's input, in m, rad, m/s or rad/s.
const MAX_MAGNITUDE: f64 = 1e7;

/// A pose: x in m, y in m, heading in rad. In double precision, so that the frame's origin may be far away.
type Pose = (f64, f64, f64);

/// A policy that drives one robot of a scenario.
#[pyclass(module = "wayfield._native")]
pub struct NativeDriver {
    policy: DrivingPolicy,
    scenario: Scenario,
    /// A message about the settings of the scenario that differ from the policy's card.
    #[pyo3(get)]
    warning: Option<String>,
    /// The driver of the current episode.
    driver: Box<dyn Driver>,
    /// The pose at the last decision; `None` at the start of an episode.
    last_pose: Option<Pose>,
}

#[pymethods]
impl NativeDriver {
    /// A driver with `policy` for the scenario `wanted` (a shipped name, a path or RON text), changed by `settings`.
    #[new]
    fn new(
        policy: PyRef<'_, NativePolicy>,
        wanted: &str,
        settings: Vec<(String, String)>,
        with_map: bool,
    ) -> PyResult<Self> {
        let mut scenario = find_scenario(wanted)?;
        settings_of(settings).apply_to_scenario(&mut scenario).map_err(setting_errors)?;
        policy_card::check_without_sensors(&policy.policy)
            .and_then(|()| check_compatible(&policy.policy, &scenario, &ObservationLayout::default()))
            .map_err(run_error)?;
        let warning = policy_card::warning(&policy.policy, &scenario).map_err(run_error)?;
        let policy = policy_card::driving(policy.policy.clone(), with_map).map_err(run_error)?;
        let driver = policy.driver(&scenario);
        Ok(Self { policy, scenario, warning, driver, last_pose: None })
    }

    /// Starts an episode: forgets all scans and the map.
    fn reset(&mut self) {
        self.driver = self.policy.driver(&self.scenario);
        self.last_pose = None;
    }

    /// Returns the speed in m/s, the turning rate in rad/s and the index of the action to command, for a scan (beams, in m), the
    /// goal's bearing in rad and distance in m, the robot's pose, and its actual speed in m/s and turning rate in rad/s.
    fn act(
        &mut self,
        py: Python<'_>,
        ranges_m: PyReadonlyArray1<'_, f32>,
        goal: (f64, f64),
        pose: Pose,
        twist: (f64, f64),
    ) -> PyResult<(f32, f32, usize)> {
        check_magnitudes("goal", &[("bearing_rad", goal.0), ("distance_m", goal.1)])?;
        check_magnitudes("pose", &[("x_m", pose.0), ("y_m", pose.1), ("heading_rad", pose.2)])?;
        check_magnitudes("twist", &[("v_m_s", twist.0), ("w_rad_s", twist.1)])?;
        if goal.1 < 0.0 {
            let distance_m = goal.1;
            return Err(PyValueError::new_err(format!(
                "goal: distance_m is {distance_m:?}; help: give a distance of at least 0 m, and the direction as bearing_rad"
            )));
        }
        let ranges_m = self.scan(ranges_m.as_array().iter().copied().collect())?;
        let percept = Percept {
            ranges_m: &ranges_m,
            goal_distance_m: goal.1 as f32,
            goal_bearing_rad: wrapped(goal.0),
            twist: Motion { v_m_s: twist.0 as f32, w_rad_s: twist.1 as f32 },
            odometry: self.last_pose.map_or_else(Odometry::default, |last| motion_between(last, pose)),
            truth: None,
        };
        let driver = &mut self.driver;
        let action = detached(py, || Ok(driver.act(&percept)))?;
        self.last_pose = Some(pose);
        let motion = self.driver.motions().unwrap_or(&self.scenario.robot.motions)[action];
        Ok((motion.v_m_s, motion.w_rad_s, action))
    }

    /// The observation of the last decision: the inputs of the network, zeros at the start of an episode.
    #[getter]
    fn observation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        PyArray1::from_slice(py, self.driver.observation().unwrap_or_default())
    }

    /// The directions of the LIDAR's beams relative to the heading, in rad.
    #[getter]
    fn beam_angles_rad<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f32>> {
        let lidar = &self.scenario.lidar;
        PyArray1::from_iter(py, (0..lidar.beams).map(|beam| lidar.beam_angle_rad(beam) as f32))
    }

    /// The LIDAR's maximum range, in m.
    #[getter]
    fn max_range_m(&self) -> f32 {
        self.scenario.lidar.max_range_m
    }

    /// The control period in s.
    #[getter]
    fn control_period_s(&self) -> f64 {
        period_s(self.scenario.task.control_period_s)
    }
}

impl NativeDriver {
    /// Checks `ranges_m`, and limits them to the LIDAR's maximum range.
    fn scan(&self, mut ranges_m: Vec<f32>) -> PyResult<Vec<f32>> {
        let Scenario { name, lidar, .. } = &self.scenario;
        let (given, beams, max_range_m) = (ranges_m.len(), lidar.beams, lidar.max_range_m);
        if given != beams {
            return Err(PyValueError::new_err(format!(
                "the scan has {given} ranges, but the LIDAR of \"{name}\" has {beams} beams; help: give {beams} ranges, at the \
                 driver's beam_angles_rad, or make the driver with set={{\"scenario.lidar.beams\": {given}}} if the policy \
                 takes that many"
            )));
        }
        if let Some(index) = ranges_m.iter().position(|range| !(range.is_finite() && *range >= 0.0)) {
            return Err(PyValueError::new_err(format!(
                "range {index} of the scan is {:?}; help: give numbers of at least 0 m, and for a beam that hits nothing the \
                 maximum range, {max_range_m} m",
                ranges_m[index]
            )));
        }
        ranges_m.iter_mut().for_each(|range| *range = range.min(max_range_m));
        Ok(ranges_m)
    }
}

/// Checks that the parts of `what` are finite and at most [`MAX_MAGNITUDE`].
fn check_magnitudes(what: &str, parts: &[(&str, f64)]) -> PyResult<()> {
    match parts.iter().find(|(_, value)| !value.is_finite() || value.abs() > MAX_MAGNITUDE) {
        Some((name, value)) => Err(PyValueError::new_err(format!(
            "{what}: {name} is {value:?}; help: give a finite number, between -{MAX_MAGNITUDE} and {MAX_MAGNITUDE}"
        ))),
        None => Ok(()),
    }
}

/// The robot's motion from the pose `from` to the pose `to`, in the robot's frame at `from`.
fn motion_between(from: Pose, to: Pose) -> Odometry {
    // The positions are subtracted in double precision, before the conversion to single precision.
    let to = ((to.0 - from.0) as f32, (to.1 - from.1) as f32, wrapped(to.2));
    Odometry::between((0.0, 0.0, wrapped(from.2)), to)
}

/// `angle_rad` in (-pi, pi], in single precision. Full turns are removed in double precision.
fn wrapped(angle_rad: f64) -> f32 {
    wrap_angle((angle_rad % TAU) as f32)
}
