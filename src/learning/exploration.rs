//! Exploration: epsilon-greedy, with epsilon a pure function of how far the run has come.
//!
//! In: the exploration's schedule, env steps, episodes, a row of Q-values. Out: epsilon, an action.

use super::config::{Exploration, Schedule};
use crate::random::{Stream, below, unit};

impl Exploration {
    /// Epsilon, the chance of a random action (0 to 1), after `env_steps` and `episodes`.
    ///
    /// Per episode it is eq. (10): max(end, start decay^episodes). `start` replaces the schedule's own start, as
    /// knowledge transfer asks (section 3.2: 0.5). Nothing is accumulated, so a resumed run agrees to the bit.
    #[must_use]
    pub fn epsilon(&self, env_steps: u64, episodes: u64, start: Option<f32>) -> f32 {
        match *self {
            Self::PerEpisode { start: from, decay, end } => {
                let from = f64::from(start.unwrap_or(from));
                let epsilon = from * libm::pow(f64::from(decay), episodes as f64);
                (epsilon as f32).max(end)
            }
            Self::Linear { start: from, end, env_steps: length } => {
                Schedule::Linear { from: start.unwrap_or(from), to: end, env_steps: length }.at(env_steps)
            }
        }
    }
}

/// The index of the largest of `q_row`; of equals, the lowest. An empty row gives 0.
#[must_use]
pub fn greedy(q_row: &[f32]) -> usize {
    let mut best = 0;
    for (action, &q) in q_row.iter().enumerate() {
        if q > q_row[best] {
            best = action;
        }
    }
    best
}

/// A random action with chance `epsilon`, else the greedy one; and whether it was the random one.
///
/// Both draws (whether, which) are made either way, so that the stream's place does not depend on the outcome.
/// `q_row` holds one Q-value per action and must not be empty.
pub fn epsilon_greedy(q_row: &[f32], epsilon: f32, stream: &mut Stream) -> (usize, bool) {
    let explored = unit(stream) < epsilon;
    let random = below(stream, q_row.len());
    (if explored { random } else { greedy(q_row) }, explored)
}
