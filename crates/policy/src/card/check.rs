//! The checks of a policy card: its values, and whether it agrees with itself and with the network.

use super::{Card, Input, Quantity, inputs, q_value_formula};
use crate::greedy;
use crate::network::{NetworkShape, Scratch, Weights, forward};
use crate::observation::{self, Encoding};

/// The largest relative difference between two Q-values that can come from the order of additions alone.
const Q_TOLERANCE: f32 = 1e-3;

/// A contradiction or an invalid value in a card. The message is the rest of a sentence that begins with "the policy's card".
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct CardError(pub String);

impl Card {
    /// The encoding of the observations; `None` if this version knows none with these inputs.
    #[must_use]
    pub fn encoding(&self) -> Option<Encoding> {
        let (angles, sensors) = (self.angles_rad(), self.sensors());
        let is_match = |e: &Encoding| e.check().is_ok() && inputs(*e, &angles, &sensors) == self.inputs;
        match self.observation {
            Some(encoding) => Some(encoding).filter(is_match),
            None => [Encoding::Scaled, Encoding::Raw].into_iter().find(is_match),
        }
    }

    /// The directions of the inputs that have one, in rad: LIDAR beams, or for an observation by sectors each input's sector.
    #[must_use]
    pub fn angles_rad(&self) -> Vec<f32> {
        self.inputs.iter().filter_map(|input| input.angle_rad).collect()
    }

    /// The number of inputs that have this `quantity`.
    #[must_use]
    pub fn count(&self, quantity: Quantity) -> usize {
        self.inputs.iter().filter(|input| input.quantity == quantity).count()
    }

    /// The plugin sensors: names and widths.
    #[must_use]
    pub fn sensors(&self) -> Vec<(&str, usize)> {
        let names = self.inputs.iter().filter_map(|input| input.sensor.as_deref());
        let mut sensors: Vec<(&str, usize)> = Vec::new();
        for name in names {
            match sensors.last_mut() {
                Some((last, width)) if *last == name => *width += 1,
                _ => sensors.push((name, 1)),
            }
        }
        sensors
    }

    /// Checks that the card describes the network of `shape` with these `parameters`, and does not contradict itself.
    pub(crate) fn check(&self, shape: &NetworkShape, parameters: &[f32]) -> Result<(), CardError> {
        ensure(self.inputs.len() == shape.inputs, || {
            format!("lists {} inputs, but the network has {}", self.inputs.len(), shape.inputs)
        })?;
        ensure(self.actions.len() == shape.actions, || {
            format!("lists {} actions, but the network has {}", self.actions.len(), shape.actions)
        })?;
        let (activation, formula) = (shape.activation.name(), q_value_formula(shape.dueling));
        ensure((self.activation.as_str(), self.q_values.as_str()) == (activation, formula), || {
            format!("must say that the activation is \"{activation}\" and the Q-values are \"{formula}\"")
        })?;
        self.check_numbers()?;
        ensure(self.scenario_crc32c == self.scenario.crc32c(), || {
            format!("has a scenario whose checksum is {}, not the recorded one", self.scenario.crc32c())
        })?;
        self.check_example(shape, parameters)
    }

    fn check_numbers(&self) -> Result<(), CardError> {
        let period_s = self.control_period_s;
        ensure(period_s.is_finite() && period_s > 0.0, || {
            format!("has a control period of {period_s} s; it must be above 0")
        })?;
        ensure(
            self.relative_actions.as_ref().is_none_or(|motions| motions.len() == self.actions.len()),
            || "lists different numbers of actions and relative actions".into(),
        )?;
        self.action_set()
            .check()
            .map_err(|problem| CardError(format!("has relative actions; their list {problem}")))?;
        let is_finite = |k: usize| self.actions[k].v_m_s.is_finite() && self.actions[k].w_rad_s.is_finite();
        let non_finite = (0..self.actions.len()).find(|&k| !is_finite(k));
        ensure(non_finite.is_none(), || {
            format!("has a number that is not finite in action {}", non_finite.unwrap_or(0))
        })?;
        let is_finite =
            |input: &Input| input.divisor.is_finite() && input.angle_rad.is_none_or(f32::is_finite);
        let non_finite = self.inputs.iter().position(|input| !is_finite(input));
        ensure(non_finite.is_none(), || {
            format!("has a number that is not finite in input {}", non_finite.unwrap_or(0))
        })?;
        let rate = self.training.success_rate;
        ensure(rate.is_none_or(|rate| (0.0..=1.0).contains(&rate)), || {
            "has a success rate outside 0 to 1".into()
        })
    }

    fn check_example(&self, shape: &NetworkShape, parameters: &[f32]) -> Result<(), CardError> {
        let example = &self.example;
        let encoding = self.encoding().ok_or_else(|| {
            CardError(
                "lists inputs that this version of wayfield cannot compute; help: use a newer wayfield"
                    .into(),
            )
        })?;
        if encoding.sectors().is_some() {
            // The observation depends on the robot, which only the scenario describes; this crate does not read scenarios.
            ensure(example.observation.len() == shape.inputs, || {
                "has an example whose observation has the wrong length".into()
            })?;
            return self.check_q_values(&example.observation, shape, parameters);
        }
        let beams = self.count(Quantity::Range);
        ensure(example.ranges_m.len() == beams, || {
            format!("has an example with {} ranges, but {beams} beams", example.ranges_m.len())
        })?;
        let readings = self.inputs.len() - observation::width(beams);
        ensure(example.sensor_readings.len() == readings, || {
            format!(
                "has an example with {} sensor readings, but {readings} sensor inputs",
                example.sensor_readings.len()
            )
        })?;
        let mut expected = vec![0.0; observation::width(beams)];
        let (bearing, distance) = (example.goal_bearing_rad, example.goal_distance_m);
        observation::encode(encoding, &example.ranges_m, bearing, distance, &mut expected);
        expected.extend(&example.sensor_readings);
        ensure(example.observation == expected, || {
            "has an example whose observation is not that of its ranges and goal".into()
        })?;
        self.check_q_values(&expected, shape, parameters)
    }

    /// Checks that the Q-values of the example are those of the network for `observation`.
    fn check_q_values(
        &self,
        observation: &[f32],
        shape: &NetworkShape,
        parameters: &[f32],
    ) -> Result<(), CardError> {
        let example = &self.example;
        let mut scratch = Scratch::default();
        let computed = forward(shape, &Weights::new(shape, parameters), observation, &mut scratch);
        let is_near = |(a, b): (&f32, &f32)| (a - b).abs() <= Q_TOLERANCE * (1.0 + b.abs());
        let same =
            example.q_values.len() == shape.actions && example.q_values.iter().zip(computed).all(is_near);
        ensure(same && example.action == greedy(&example.q_values), || {
            format!(
                "has an example whose Q-values or action do not match the network, which gives {computed:?}"
            )
        })
    }
}

/// Returns an error with `problem` unless the condition `holds`.
fn ensure(holds: bool, problem: impl FnOnce() -> String) -> Result<(), CardError> {
    let error = || CardError(format!("{}; help: use the file as wayfield wrote it", problem()));
    if holds { Ok(()) } else { Err(error()) }
}
