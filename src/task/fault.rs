//! Faults of a step: no free space for a start or goal, no level with the drawn seed, or a non-finite number.
//!
//! In: the results of `Sense` and `Reward`. Out: [`TaskFault`], which the caller of the step must check. A step with a
//! non-finite number is not stored in the replay buffer, and ends no episode.

use bevy::prelude::*;

use super::{
    Arena, Clock, Episode, ExtraRewards, Goal, ObservationLayout, Observations, Pose, Scan, StepOutcome,
    StepOutcomes, Twist,
};
use crate::scenario::{LevelError, NoFreeSpace};

/// The fault of a step, if there was one. The caller of the step must check it and stop.
#[derive(Resource, Clone, Debug, Default)]
pub struct TaskFault(pub Option<Fault>);

/// The reason why a step failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// No free space for a start or goal was found. The run can continue after the scenario is changed.
    #[error("arena {arena}, step {step}: {why}")]
    NoFreeSpace {
        /// The arena's index.
        arena: usize,
        /// The arena's clock, in control steps.
        step: u64,
        /// The start or goal that could not be placed.
        why: NoFreeSpace,
    },
    /// A generator of the run's set has no level with the drawn seed.
    #[error("arena {arena}, step {step}: {why}")]
    NoLevel {
        /// The arena's index.
        arena: usize,
        /// The arena's clock, in control steps.
        step: u64,
        /// The generator and the seed.
        why: LevelError,
    },
    /// A number is NaN or infinite. All later numbers are meaningless.
    #[error("arena {arena}, step {step}: {what}")]
    NonFinite {
        /// The arena's index.
        arena: usize,
        /// The arena's clock, in control steps.
        step: u64,
        /// The number, its origin, and a possible fix.
        what: String,
    },
}

/// Whether all numbers of this step are finite, so that it can be stored and counted.
pub(crate) fn step_is_finite(fault: Res<TaskFault>) -> bool {
    !matches!(fault.0, Some(Fault::NonFinite { .. }))
}

/// `Reward`, last: reports the first non-finite number of the step, with its cause.
pub(super) fn detect_faults(
    observations: Res<Observations>,
    outcomes: Res<StepOutcomes>,
    layout: Res<ObservationLayout>,
    extra: Res<ExtraRewards>,
    mut fault: ResMut<TaskFault>,
    arenas: Query<(&Arena, &Clock, &Pose, &Twist, &Scan, &Goal, &Episode)>,
) {
    let rewards_are_finite = || outcomes.0.iter().all(|outcome| outcome.total_reward().is_finite());
    if all_finite(&observations.next) && rewards_are_finite() {
        return;
    }
    let mut active: Vec<_> = arenas.iter().filter(|(.., episode)| !episode.inactive).collect();
    active.sort_by_key(|(arena, ..)| arena.0);
    for (arena, clock, pose, twist, scan, goal, episode) in active {
        let outcome = &outcomes.0[arena.0];
        let row = observations.next_row(arena.0);
        if let Some(what) = cause_in_observation(pose, twist, scan, goal, row, &layout)
            .or_else(|| cause_in_reward(outcome, episode, extra.names()))
        {
            fault.0 = Some(Fault::NonFinite { arena: arena.0, step: clock.0, what });
            return;
        }
    }
}

/// The description of the first non-finite input of an observation, in the order of computation.
fn cause_in_observation(
    pose: &Pose,
    twist: &Twist,
    scan: &Scan,
    goal: &Goal,
    row: &[f32],
    layout: &ObservationLayout,
) -> Option<String> {
    let Pose { x_m, y_m, heading_rad } = *pose;
    if !all_finite(&[x_m, y_m, heading_rad]) {
        return Some(format!(
            "the robot's pose is ({x_m} m, {y_m} m, {heading_rad} rad) at {} m/s and {} rad/s; try slower motions or a \
             shorter control_period_s",
            twist.v_m_s, twist.w_rad_s
        ));
    }
    if !all_finite(&[goal.x_m, goal.y_m]) {
        return Some(format!("the goal lies at ({} m, {} m)", goal.x_m, goal.y_m));
    }
    if let Some(beam) = scan.ranges_m.iter().position(|range| !range.is_finite()) {
        let range = scan.ranges_m[beam];
        return Some(format!("LIDAR beam {beam} reports {range} m; check the scenario's lidar"));
    }
    let column = row.iter().position(|number| !number.is_finite())?;
    let beams = scan.ranges_m.len();
    let meaning = layout.describe_column(column, beams);
    Some(format!("entry {column} of the observation ({meaning}) is {}", row[column]))
}

/// The description of a non-finite reward and its terms.
fn cause_in_reward(outcome: &StepOutcome, episode: &Episode, extra_names: &[String]) -> Option<String> {
    if let Some(index) = episode.extra_rewards.iter().position(|reward| !reward.is_finite()) {
        let name = extra_names.get(index).map_or("?", String::as_str);
        return Some(format!("the reward term `{name}` is not finite: check the plugin that adds it"));
    }
    let (terms, potential) = (&outcome.reward, &episode.potential);
    let total = terms.total();
    if total.is_finite() {
        // Finite terms, but too large a sum.
        let total = outcome.total_reward();
        return (!total.is_finite()).then(|| {
            format!(
                "the reward with the terms of plugins is {total}: check the plugins that add {}",
                extra_names.join(", ")
            )
        });
    }
    Some(format!(
        "the reward is {total}: reached {:e}, collided {:e}, attraction {:e}, repulsion {:e}; potentials: attraction {:e}, \
         repulsion {:e}; try a smaller reward.mu or reward.sigma",
        terms.reached,
        terms.collided,
        terms.attraction,
        terms.repulsion,
        potential.attraction,
        potential.repulsion
    ))
}

/// Whether all values are finite.
fn all_finite(values: &[f32]) -> bool {
    values.iter().all(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::RewardConfig;

    const POSE: Pose = Pose { x_m: 1.0, y_m: 0.0, heading_rad: 0.0 };
    const GOAL: Goal = Goal { x_m: 1.0, y_m: -2.0 };

    fn cause(pose: Pose, ranges_m: Vec<f32>, goal: Goal, row: &[f32]) -> Option<String> {
        let scan = Scan { ranges_m, ..Scan::default() };
        let twist = Twist { v_m_s: 0.15, w_rad_s: 0.0 };
        cause_in_observation(&pose, &twist, &scan, &goal, row, &ObservationLayout::default())
    }

    #[test]
    fn the_first_non_finite_number_is_reported_as_the_cause() {
        let nan = f32::NAN;
        assert_eq!(cause(POSE, vec![3.5; 2], GOAL, &[1.0; 6]), None, "all numbers are finite");
        let bad_pose = Pose { y_m: nan, ..POSE };
        let what = cause(bad_pose, vec![nan; 2], GOAL, &[nan; 6]).expect("a fault");
        assert!(what.starts_with("the robot's pose is (1 m, NaN m, 0 rad) at 0.15 m/s"), "{what}");
        let what = cause(POSE, vec![3.5, f32::INFINITY], GOAL, &[nan; 6]).expect("a fault");
        assert!(what.starts_with("LIDAR beam 1 reports inf m"), "{what}");
        let what = cause(POSE, vec![3.5; 2], Goal { x_m: nan, ..GOAL }, &[nan; 6]).expect("a fault");
        assert_eq!(what, "the goal lies at (NaN m, -2 m)");
        let what = cause(POSE, vec![3.5; 2], GOAL, &[1.0, 1.0, 1.0, nan, 1.0, 0.5]).expect("a fault");
        assert_eq!(what, "entry 3 of the observation (d_g, the goal's distance) is NaN");
    }

    #[test]
    fn a_non_finite_reward_is_reported_with_its_terms() {
        // 0.5 * 1e38 * 3^2 exceeds the range of f32. The check of presets rejects such a mu.
        let config = RewardConfig { mu: 1e38, ..RewardConfig::default() };
        let potential = config.potential(3.0, 1.0);
        let outcome = StepOutcome {
            reward: config.reward(false, false, potential, potential),
            ..StepOutcome::default()
        };
        let episode = Episode { potential, ..Episode::default() };
        let what = cause_in_reward(&outcome, &episode, &[]).expect("a fault");
        let expected = "the reward is NaN: reached 0e0, collided 0e0, attraction NaN, repulsion 0e0; potentials: \
                        attraction inf, repulsion 0e0";
        assert!(what.starts_with(expected), "{what}");
        assert_eq!(cause_in_reward(&StepOutcome::default(), &episode, &[]), None);
        assert_eq!(config.check().expect_err("mu is too large").0, "mu");
    }
}
