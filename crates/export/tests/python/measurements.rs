//! Random measurements, and the Q-values that wayfield computes for them.

use std::f32::consts::PI;
use std::fs;
use std::path::Path;

use wayfield_policy::{Policy, Scratch, observation};
use wayfield_random::{uniform, uniform_01};

/// The number of random observations per policy.
const OBSERVATIONS: usize = 100_000;

/// Random measurements. About half of the beams hit nothing, so that many ranges are equal.
#[derive(Default)]
pub struct Measurements {
    ranges: Vec<f32>,
    goal: Vec<f32>,
    sensor_readings: Vec<f32>,
    /// Observations by sectors (docs/algorithm.md), for policies that take these instead of ranges.
    observation: Vec<f32>,
    /// For each of these observations, the robot's highest speed in m/s and turning rate in rad/s (left positive).
    highest_motion: Vec<f32>,
    /// The lowest speed and turning rate, at most 0: backwards, and to the right.
    lowest_motion: Vec<f32>,
    /// The Q-values that the policy computes for the measurements or observations.
    q_values: Vec<f32>,
}

impl Measurements {
    /// Measurements for `policy`, whose LIDAR reaches `max_range_m`.
    pub fn random(policy: &Policy, max_range_m: f32) -> Self {
        let card = policy.card.as_ref().expect("a card");
        let (beams, encoding) = (card.angles_rad().len(), card.encoding().expect("known"));
        let readings: usize = card.sensors().iter().map(|(_, width)| width).sum();
        let mut random = wayfield_random::stream(1, "test: measurements", 0);
        let (mut all, mut scratch) = (Self::default(), Scratch::default());
        for _ in 0..OBSERVATIONS {
            let nearest_m = uniform(&mut random, 0.1, max_range_m);
            let mut range = |_| match uniform_01(&mut random) {
                draw if draw < 0.5 => nearest_m + 2.0 * draw * (max_range_m - nearest_m),
                _ => max_range_m,
            };
            let ranges: Vec<f32> = (0..beams).map(&mut range).collect();
            let goal = [uniform(&mut random, -PI, PI), uniform(&mut random, 0.0, 6.0)];
            let sensed: Vec<f32> = (0..readings).map(|_| uniform(&mut random, -1.0, 1.0)).collect();
            let mut row = vec![0.0; observation::width(beams)];
            observation::encode(encoding, &ranges, goal[0], goal[1], &mut row);
            row.extend(&sensed);
            all.q_values.extend(policy.q_values(&row, &mut scratch));
            all.ranges.extend(ranges);
            all.goal.extend(goal);
            all.sensor_readings.extend(sensed);
        }
        all
    }

    /// Random observations for `policy`, which observes by sectors and whose actions are relative.
    pub fn random_observations(policy: &Policy) -> Self {
        let mut random = wayfield_random::stream(1, "test: observations", 0);
        let (mut all, mut scratch) = (Self::default(), Scratch::default());
        for _ in 0..OBSERVATIONS {
            let row: Vec<f32> = (0..policy.shape().inputs).map(|_| uniform(&mut random, -1.0, 1.0)).collect();
            all.q_values.extend(policy.q_values(&row, &mut scratch));
            all.observation.extend(row);
            all.highest_motion.extend([uniform(&mut random, 0.1, 2.0), uniform(&mut random, 0.5, 4.0)]);
            all.lowest_motion.extend([uniform(&mut random, -1.0, 0.0), uniform(&mut random, -4.0, -0.5)]);
        }
        all
    }

    /// Asserts that ONNX Runtime with `policy.onnx` in `folder` gives wayfield's results. Returns the summary of `parity.py`.
    pub fn assert_parity(&self, python: &Path, folder: &Path) -> String {
        for (name, values) in [
            ("ranges", &self.ranges),
            ("goal", &self.goal),
            ("sensor_readings", &self.sensor_readings),
            ("observation", &self.observation),
            ("highest_motion", &self.highest_motion),
            ("lowest_motion", &self.lowest_motion),
            ("q_values", &self.q_values),
        ] {
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            fs::write(folder.join(format!("{name}.f32")), bytes).expect("written");
        }
        fs::write(folder.join("parity.py"), include_str!("../parity.py")).expect("written");
        let printed = super::run(python, folder, Path::new("parity.py"));
        assert!(printed.contains(&format!("\"observations\": {OBSERVATIONS}")), "{printed}");
        printed
    }
}
