//! The reward of a step, term by term: eqs. (3) to (7) of the paper.
//!
//! In: the potentials before and after a step, whether the goal was reached, whether the robot collided. Out:
//! [`RewardTerms`], whose sum is the reward.

use bevy::prelude::Resource;
use serde::{Deserialize, Serialize};

use crate::limits::MAX_REWARD_PARAMETER;

/// The reward of a step in which the robot neither reaches the goal nor collides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RewardKind {
    /// Eq. (3): 0.
    Traditional,
    /// Eq. (7): the decrease of the potential, U_{t-1} - U_t.
    Optimized,
}

/// How the distance to the goal is measured for the attraction. It is d_g in eq. (5). The policy always observes the
/// straight-line distance, which also decides whether a goal is reached. Evaluations do not use the reward.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum GoalDistance {
    /// The straight-line distance, as in the paper.
    #[default]
    Straight,
    /// The length of the shortest path around walls and static obstacles, for a disc as large as the robot. Then the
    /// attraction leads out of dead ends instead of into them. Moving obstacles are left out.
    Geodesic,
}

/// The growth of the attraction with the distance to the goal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Attraction {
    /// Eq. (5): mu d_g^2 / 2.
    #[default]
    Quadratic,
    /// mu d_g: a step towards the goal is worth as much far from it as near it.
    Linear,
}

/// The unit of the lengths in the potential.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum RewardLengths {
    /// Metres, as in the paper.
    #[default]
    Metres,
    /// Lengths are scaled to the paper's robot: with a robot that is twice as large, 2 m count as 1 m. A reward
    /// then means the same for robots of all sizes.
    Robot,
}

/// The distance from surfaces at which the paper's robot collides, in m.
const PAPER_ROBOT_UNIT_M: f32 = 0.13;

/// The parameters of the reward (Table 1).
#[derive(Resource, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RewardConfig {
    /// Eq. (3) or eq. (7).
    pub kind: RewardKind,
    /// r+, the reward for reaching the goal.
    pub reached: f32,
    /// r-, the reward for a collision.
    pub collided: f32,
    /// mu, the gain of the attraction in eq. (5), per m^2; of a linear attraction, per m.
    pub mu: f32,
    /// sigma, the gain of the repulsion in eq. (6).
    pub sigma: f32,
    /// l_r of eq. (6), in m: the distance beyond which obstacles do not repel. The paper does not give its value.
    pub l_r_m: f32,
    /// How the attraction grows with the distance: `Quadratic`, as in eq. (5), or `Linear`.
    pub attraction: Attraction,
    /// The unit of the lengths: `Metres`, as in the paper, or `Robot`, for training with robots of different sizes.
    pub lengths: RewardLengths,
    /// The distance to the goal in eq. (5): `Straight`, as in the paper, or `Geodesic`, around walls and static obstacles.
    pub distance: GoalDistance,
}

impl Default for RewardConfig {
    fn default() -> Self {
        Self {
            kind: RewardKind::Optimized,
            reached: 250.0,
            collided: -200.0,
            mu: 100.0,
            sigma: 100.0,
            l_r_m: 0.3,
            attraction: Attraction::Quadratic,
            lengths: RewardLengths::Metres,
            distance: GoalDistance::Straight,
        }
    }
}

/// The potential of eq. (4), as its two terms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Potential {
    /// U_a of eq. (5).
    pub attraction: f32,
    /// U_r of eq. (6).
    pub repulsion: f32,
}

impl Potential {
    /// U of eq. (4).
    #[must_use]
    pub fn total(&self) -> f32 {
        self.attraction + self.repulsion
    }
}

/// The terms of a reward, or of a sum of rewards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RewardTerms {
    /// r+ for reached goals.
    pub reached: f32,
    /// r- for collisions.
    pub collided: f32,
    /// The decrease of the attraction, U_a at t-1 minus U_a at t: positive when the robot approaches the goal.
    pub attraction: f32,
    /// The decrease of the repulsion, U_r at t-1 minus U_r at t: positive when the robot moves away from an obstacle.
    pub repulsion: f32,
}

impl RewardTerms {
    /// The reward: the sum of its terms.
    #[must_use]
    pub fn total(&self) -> f32 {
        self.reached + self.collided + self.attraction + self.repulsion
    }
}

impl core::ops::AddAssign for RewardTerms {
    fn add_assign(&mut self, other: Self) {
        self.reached += other.reached;
        self.collided += other.collided;
        self.attraction += other.attraction;
        self.repulsion += other.repulsion;
    }
}

impl RewardConfig {
    /// The potential of eqs. (4) to (6): U = mu d_g^2 / 2 + sigma (1 - d_o/l_r)^2 / 2, where the second term is 0 for
    /// d_o > l_r. A linear attraction is mu d_g.
    ///
    /// `d_g` is the distance to the goal, measured as [`RewardConfig::distance`] says, and `d_o` the smallest LIDAR
    /// range. Both are in m, times [`scale`](Self::scale).
    #[must_use]
    pub fn potential(&self, d_g: f32, d_o: f32) -> Potential {
        let attraction = match self.attraction {
            Attraction::Quadratic => 0.5 * self.mu * d_g * d_g,
            Attraction::Linear => self.mu * d_g,
        };
        let repulsion = if d_o <= self.l_r_m {
            let closeness = 1.0 - d_o / self.l_r_m;
            0.5 * self.sigma * closeness * closeness
        } else {
            0.0
        };
        Potential { attraction, repulsion }
    }

    /// The factor for the lengths in the potential, given the robot's
    /// [`robot_unit_m`](crate::scenario::Scenario::robot_unit_m): 1 if lengths are in metres.
    #[must_use]
    pub fn scale(&self, robot_unit_m: f32) -> f32 {
        match self.lengths {
            RewardLengths::Metres => 1.0,
            RewardLengths::Robot => PAPER_ROBOT_UNIT_M / robot_unit_m,
        }
    }

    /// The reward of eq. (3) or eq. (7). `before` and `after` are the potentials U_{t-1} and U_t. A step that both collides
    /// and reaches the goal counts as a collision.
    #[must_use]
    pub fn reward(&self, reached: bool, collided: bool, before: Potential, after: Potential) -> RewardTerms {
        let mut terms = RewardTerms::default();
        if collided {
            terms.collided = self.collided;
        } else if reached {
            terms.reached = self.reached;
        } else if self.kind == RewardKind::Optimized {
            terms.attraction = before.attraction - after.attraction;
            terms.repulsion = before.repulsion - after.repulsion;
        }
        terms
    }

    /// Checks that the rewards and gains are from -1e9 to 1e9, the gains are not negative, and l_r is positive.
    ///
    /// # Errors
    /// The first of the [`problems`](Self::problems).
    pub fn check(&self) -> Result<(), (&'static str, String)> {
        self.problems().into_iter().next().map_or(Ok(()), Err)
    }

    /// All invalid fields: the name, and the problem with its fix.
    #[must_use]
    pub fn problems(&self) -> Vec<(&'static str, String)> {
        let mut problems = Vec::new();
        let rewards = [("reached", self.reached), ("collided", self.collided)];
        let gains = [("mu", self.mu), ("sigma", self.sigma)];
        for (field, value) in rewards.into_iter().chain(gains) {
            if !value.is_finite() || value.abs() > MAX_REWARD_PARAMETER {
                let is_gain = gains.iter().any(|gain| gain.0 == field);
                let lowest = if is_gain { "0".into() } else { format!("-{MAX_REWARD_PARAMETER:e}") };
                let range = format!("{lowest} to {MAX_REWARD_PARAMETER:e}");
                problems.push((field, format!("is {value:e}; help: give a number from {range}")));
            } else if value < 0.0 && gains.iter().any(|gain| gain.0 == field) {
                problems.push((field, format!("is {value}; help: give 0 or more (the paper uses 100)")));
            }
        }
        if !self.l_r_m.is_finite() || self.l_r_m <= 0.0 {
            let message = format!("is {}; help: give a distance above 0 m, such as 0.3", self.l_r_m);
            problems.push(("l_r_m", message));
        }
        problems
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table_1() -> RewardConfig {
        RewardConfig { l_r_m: 0.4, ..RewardConfig::default() }
    }

    #[test]
    fn eq_5_attraction_is_half_mu_d_squared() {
        // 100 * 1.2^2 / 2 = 72
        assert!((table_1().potential(1.2, 3.0).attraction - 72.0).abs() < 1e-4);
    }

    #[test]
    fn a_linear_attraction_is_mu_d_and_robot_lengths_are_scaled_to_the_paper_s_robot() {
        let r = RewardConfig {
            attraction: Attraction::Linear,
            lengths: RewardLengths::Robot,
            ..RewardConfig::default()
        };
        assert!((r.potential(1.2, 3.0).attraction - 120.0).abs() < 1e-4);
        assert!((r.scale(0.26) - 0.5).abs() < 1e-6, "a robot twice as large as the paper's");
        assert_eq!(RewardConfig::default().scale(0.26), 1.0);
    }

    #[test]
    fn eq_6_repulsion_is_quadratic_within_l_r_and_zero_beyond() {
        // 100 * (1 - 0.1/0.4)^2 / 2 = 28.125
        assert!((table_1().potential(0.0, 0.1).repulsion - 28.125).abs() < 1e-4);
        assert_eq!(table_1().potential(0.0, 0.4).repulsion, 0.0, "zero at l_r");
        assert_eq!(table_1().potential(0.0, 0.41).repulsion, 0.0);
    }

    #[test]
    fn eq_7_gives_the_decrease_of_the_potential_or_a_terminal_reward() {
        let r = table_1();
        // From 1.00 to 0.97 m from the goal: 50 * (1 - 0.9409) = 2.955.
        // From 0.3 to 0.2 m from an obstacle: 50 * (1/4)^2 - 50 * (1/2)^2 = -9.375.
        let before = r.potential(1.0, 0.3);
        let after = r.potential(0.97, 0.2);
        let terms = r.reward(false, false, before, after);
        assert!((terms.attraction - 2.955).abs() < 1e-3);
        assert!((terms.repulsion + 9.375).abs() < 1e-3);
        assert!((terms.total() - (before.total() - after.total())).abs() < 1e-4);
        assert_eq!(r.reward(true, false, before, after).total(), 250.0);
        assert_eq!(r.reward(false, true, before, after).total(), -200.0);
        assert_eq!(r.reward(true, true, before, after).total(), -200.0, "a collision counts before the goal");
    }

    #[test]
    fn eq_3_gives_zero_until_the_goal_or_a_collision() {
        let r = RewardConfig { kind: RewardKind::Traditional, ..table_1() };
        let (before, after) = (r.potential(1.0, 0.3), r.potential(0.97, 0.2));
        assert_eq!(r.reward(false, false, before, after).total(), 0.0);
        assert_eq!(r.reward(true, false, before, after).total(), 250.0);
        assert_eq!(r.reward(false, true, before, after).total(), -200.0);
    }

    #[test]
    fn the_check_names_the_invalid_parameter() {
        let invalid = RewardConfig { l_r_m: 0.0, ..RewardConfig::default() };
        assert_eq!(invalid.check().unwrap_err().0, "l_r_m");
        let invalid = RewardConfig { mu: -1.0, ..RewardConfig::default() };
        assert_eq!(invalid.check().unwrap_err().0, "mu");
        assert_eq!(RewardConfig::default().check(), Ok(()));
    }
}
