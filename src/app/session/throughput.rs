//! Throughput: steps and frames per second, averaged over about the last second.

use std::collections::VecDeque;

use bevy::prelude::*;
use bevy::time::Real;

/// Rates are averaged over this time, in s.
const WINDOW_S: f64 = 1.0;

/// Rates of the recent past.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rates {
    /// Control steps per second.
    pub control_steps_per_s: f64,
    /// Env steps per second, all arenas together.
    pub env_steps_per_s: f64,
    /// Frames per second.
    pub frames_per_s: f64,
}

/// Counts of steps, and the times of recent frames.
#[derive(Resource, Clone, Debug, Default)]
pub struct Throughput {
    /// Time in s and the counts of control steps and env steps, at the end of each recent frame.
    frames: VecDeque<(f64, u64, u64)>,
    control_steps: u64,
    env_steps: u64,
}

impl Throughput {
    /// Counts a control step of `arenas` arenas.
    pub(super) fn count_step(&mut self, arenas: usize) {
        self.control_steps += 1;
        self.env_steps += arenas as u64;
    }

    fn record_frame(&mut self, now_s: f64) {
        self.frames.push_back((now_s, self.control_steps, self.env_steps));
        while self.frames.len() > 2 && self.frames.get(1).is_some_and(|frame| now_s - frame.0 >= WINDOW_S) {
            self.frames.pop_front();
        }
    }

    /// Rates over the window; zero before the second frame.
    #[must_use]
    pub fn rates(&self) -> Rates {
        match (self.frames.front(), self.frames.back()) {
            (Some(first), Some(last)) if last.0 > first.0 => {
                let seconds = last.0 - first.0;
                let rate = |count: u64| count as f64 / seconds;
                Rates {
                    control_steps_per_s: rate(last.1 - first.1),
                    env_steps_per_s: rate(last.2 - first.2),
                    frames_per_s: rate(self.frames.len() as u64 - 1),
                }
            }
            _ => Rates::default(),
        }
    }
}

/// Records the end of a frame.
pub(super) fn record_frame(mut throughput: ResMut<Throughput>, time: Res<Time<Real>>) {
    throughput.record_frame(time.elapsed_secs_f64());
}
