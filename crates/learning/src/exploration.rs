//! Epsilon-greedy exploration. Epsilon is a pure function of env steps and episodes.
//!
//! In: the exploration schedule, env steps, episodes, a row of Q-values. Out: epsilon, an action.

use wayfield_policy::greedy;

use super::config::{Exploration, Schedule};
use wayfield_random::{Stream, uniform_01, uniform_index};

impl Exploration {
    /// Epsilon, the probability of a random action (0 to 1), after `env_steps` env steps and `episodes` episodes.
    ///
    /// [`Exploration::PerEpisode`] is equation (10) of the paper: max(end, start x decay^episodes). After a knowledge
    /// transfer, `start` replaces the start of the schedule (section 3.2: 0.5). Epsilon is not accumulated, so a
    /// resumed run continues exactly.
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

/// Chooses a random action with probability `epsilon`, otherwise the greedy one. Returns it, and whether it was random.
///
/// `q_row` has one Q-value per action. Both random draws (whether to explore, and the random action) are always made, so
/// that the position of the stream does not depend on the outcome.
///
/// # Panics
/// If `q_row` is empty.
pub fn epsilon_greedy(q_row: &[f32], epsilon: f32, stream: &mut Stream) -> (usize, bool) {
    let explored = uniform_01(stream) < epsilon;
    let random = uniform_index(stream, q_row.len());
    (if explored { random } else { greedy(q_row) }, explored)
}

#[cfg(test)]
mod tests {
    use wayfield_random::{random_u64, stream};

    use super::*;

    const TABLE_1: Exploration = Exploration::PerEpisode { start: 1.0, decay: 0.99, end: 0.05 };

    #[test]
    fn epsilon_per_episode_follows_equation_10() {
        // 0.99^100 = exp(100 ln 0.99) = exp(-1.0050336) = 0.3660323; 0.99^298 = 0.0500, 0.99^299 < 0.05.
        for (episodes, epsilon) in [(0, 1.0), (1, 0.99), (100, 0.366_032_3), (299, 0.05), (100_000, 0.05)] {
            let found = TABLE_1.epsilon(0, episodes, None);
            assert!((found - epsilon).abs() < 1e-6, "after {episodes} episodes: {found}");
        }
        assert_eq!(
            TABLE_1.epsilon(1_000_000, 3, None),
            TABLE_1.epsilon(0, 3, None),
            "epsilon does not depend on env steps"
        );
        let transfer = TABLE_1.epsilon(0, 10, Some(0.5));
        assert!((transfer - 0.452_191_04).abs() < 1e-6, "after a transfer: {transfer}, not 0.5 x 0.99^10");
    }

    #[test]
    fn linear_epsilon_depends_on_env_steps() {
        let linear = Exploration::Linear { start: 1.0, end: 0.1, env_steps: 90 };
        assert!((linear.epsilon(30, 7, None) - 0.7).abs() < 1e-6);
        assert!((linear.epsilon(30, 7, Some(0.4)) - 0.3).abs() < 1e-6, "from 0.4 down to 0.1");
        assert!((linear.epsilon(91, 0, Some(0.4)) - 0.1).abs() < 1e-6);
    }

    #[test]
    fn epsilon_is_the_fraction_of_random_actions_which_are_uniform() {
        let mut random = stream(1, "test", 0);
        let (mut explored, mut counts) = (0, [0; 4]);
        for _ in 0..100_000 {
            let (action, is_random) = epsilon_greedy(&[0.0, 0.0, 1.0, 0.0], 0.4, &mut random);
            explored += u32::from(is_random);
            counts[action] += 1;
        }
        assert!((39_000..41_000).contains(&explored), "{explored} of 100,000 with epsilon 0.4");
        for action in [0, 1, 3] {
            assert!((9_500..10_500).contains(&counts[action]), "a quarter of 40,000 each: {counts:?}");
        }
    }

    #[test]
    fn exploring_and_not_exploring_consume_the_same_random_numbers() {
        let (mut never, mut always) = (stream(1, "test", 0), stream(1, "test", 0));
        for _ in 0..100 {
            assert!(!epsilon_greedy(&[0.0; 5], 0.0, &mut never).1, "epsilon 0 never explores");
            assert!(epsilon_greedy(&[0.0; 5], 1.0, &mut always).1, "epsilon 1 always explores");
        }
        assert_eq!(random_u64(&mut never), random_u64(&mut always));
    }
}
