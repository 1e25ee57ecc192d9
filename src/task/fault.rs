//! What goes wrong in a step: no room for a start or goal, or a number that is none.
//!
//! In: what `Sense` and `Reward` have left. Out: [`TaskFault`], which the caller of the step must look at. A step with a
//! number that is none is neither remembered nor learnt from, and no episode ends with it.

use bevy::prelude::*;

use super::{
    Arena, Clock, Episode, ExtraRewards, Goal, ObservationLayout, Observations, Pose, Scan, StepOutcome,
    StepOutcomes, Twist,
};
use crate::scenario::NoFreeSpace;

/// Set where a step went wrong: the caller of the step must look, and stop.
#[derive(Resource, Clone, Debug, Default)]
pub struct TaskFault(pub Option<Fault>);

/// Why a step went wrong.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// No start or goal could be found. A world can be mended, and the training go on.
    #[error("arena {arena}, step {step}: {why}")]
    NoFreeSpace {
        /// In which arena.
        arena: usize,
        /// Its clock, in control steps.
        step: u64,
        /// What was looked for.
        why: NoFreeSpace,
    },
    /// A number is NaN or infinite: what comes after it means nothing.
    #[error("arena {arena}, step {step}: {what}")]
    NonFinite {
        /// In which arena.
        arena: usize,
        /// Its clock, in control steps.
        step: u64,
        /// Which number, where it came from, and what to try.
        what: String,
    },
}

/// Whether the numbers of this step can be learnt from, and counted.
pub fn step_is_finite(fault: Res<TaskFault>) -> bool {
    !matches!(fault.0, Some(Fault::NonFinite { .. }))
}

/// `Reward`, last: all numbers of the step are finite, or the first that is not is told with its cause.
pub(super) fn detect_faults(
    observations: Res<Observations>,
    outcomes: Res<StepOutcomes>,
    layout: Res<ObservationLayout>,
    extra: Res<ExtraRewards>,
    mut fault: ResMut<TaskFault>,
    arenas: Query<(&Arena, &Clock, &Pose, &Twist, &Scan, &Goal, &Episode)>,
) {
    let rewards = outcomes.0.iter().map(super::outcome::StepOutcome::total_reward);
    if all_finite(&observations.next) && rewards.fold(0.0, |sum, r| sum + 0.0 * r) == 0.0 {
        return;
    }
    let mut seen: Vec<_> = arenas.iter().filter(|(.., episode)| !episode.inactive).collect();
    seen.sort_by_key(|(arena, ..)| arena.0);
    for (arena, clock, pose, twist, scan, goal, episode) in seen {
        let outcome = &outcomes.0[arena.0];
        let row = observations.next_row(arena.0);
        if let Some(what) = cause(pose, twist, scan, goal, row, &layout)
            .or_else(|| cause_of_reward(outcome, episode, extra.names()))
        {
            fault.0 = Some(Fault::NonFinite { arena: arena.0, step: clock.0, what });
            return;
        }
    }
}

/// What among that which an observation is made of is not finite, the earliest first.
fn cause(
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
            "the robot's pose is ({x_m} m, {y_m} m, {heading_rad} rad): its motions are {} m/s and {} rad/s; try slower \
             ones, or a shorter control_period_s",
            twist.v_m_s, twist.w_rad_s
        ));
    }
    if !all_finite(&[goal.x_m, goal.y_m]) {
        return Some(format!("the goal lies at ({} m, {} m)", goal.x_m, goal.y_m));
    }
    if let Some(beam) = scan.ranges_m.iter().position(|range| !range.is_finite()) {
        let range = scan.ranges_m[beam];
        return Some(format!("the LIDAR's beam {beam} reports {range} m; look at the scenario's lidar"));
    }
    let column = row.iter().position(|number| !number.is_finite())?;
    let beams = scan.ranges_m.len();
    let meaning = layout.describe_column(column, beams);
    Some(format!("the observation's number {column} ({meaning}) is {}", row[column]))
}

/// What the reward is made of, if it is not finite.
fn cause_of_reward(outcome: &StepOutcome, episode: &Episode, extra_names: &[String]) -> Option<String> {
    if let Some(index) = episode.extra_rewards.iter().position(|reward| !reward.is_finite()) {
        let name = extra_names.get(index).map_or("?", String::as_str);
        return Some(format!("the reward term `{name}` is not finite: check the plugin that adds it"));
    }
    let (terms, potential) = (&outcome.reward, &episode.potential);
    let total = terms.total();
    (!total.is_finite()).then(|| {
        format!(
            "the reward is {total}: {:e} for reaching, {:e} for colliding, {:e} by attraction and {:e} by repulsion, whose \
             potentials are now {:e} and {:e}; give less for reward.mu or reward.sigma",
            terms.reached,
            terms.collided,
            terms.attraction,
            terms.repulsion,
            potential.attraction,
            potential.repulsion
        )
    })
}

/// Whether no value is NaN or infinite.
fn all_finite(values: &[f32]) -> bool {
    values.iter().all(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::RewardConfig;

    const POSE: Pose = Pose { x_m: 1.0, y_m: 0.0, heading_rad: 0.0 };
    const TARGET: Goal = Goal { x_m: 1.0, y_m: -2.0 };

    fn said(pose: Pose, ranges_m: Vec<f32>, goal: Goal, row: &[f32]) -> Option<String> {
        let scan = Scan { ranges_m, ..Scan::default() };
        cause(&pose, &Twist { v_m_s: 0.15, w_rad_s: 0.0 }, &scan, &goal, row, &ObservationLayout::default())
    }

    #[test]
    fn the_earliest_number_that_is_none_is_the_cause() {
        let nan = f32::NAN;
        assert_eq!(said(POSE, vec![3.5; 2], TARGET, &[1.0; 6]), None, "all is well");
        let lost = Pose { y_m: nan, ..POSE };
        let what = said(lost, vec![nan; 2], TARGET, &[nan; 6]).expect("it is seen");
        assert!(
            what.starts_with("the robot's pose is (1 m, NaN m, 0 rad): its motions are 0.15 m/s"),
            "{what}"
        );
        let what = said(POSE, vec![3.5, f32::INFINITY], TARGET, &[nan; 6]).expect("it is seen");
        assert!(what.starts_with("the LIDAR's beam 1 reports inf m"), "{what}");
        let what = said(POSE, vec![3.5; 2], Goal { x_m: nan, ..TARGET }, &[nan; 6]).expect("it is seen");
        assert_eq!(what, "the goal lies at (NaN m, -2 m)");
        let what = said(POSE, vec![3.5; 2], TARGET, &[1.0, 1.0, 1.0, nan, 1.0, 0.5]).expect("it is seen");
        assert_eq!(what, "the observation's number 3 (d_g, the goal's distance) is NaN");
    }

    #[test]
    fn a_reward_that_is_no_number_is_told_with_its_terms() {
        // 0.5 * 1e38 * 3^2 is more than an f32 can be. (No preset may ask for it.)
        let config = RewardConfig { mu: 1e38, ..RewardConfig::default() };
        let potential = config.potential(3.0, 1.0);
        let outcome = StepOutcome {
            reward: config.reward(false, false, potential, potential),
            ..StepOutcome::default()
        };
        let episode = Episode { potential, ..Episode::default() };
        let what = cause_of_reward(&outcome, &episode, &[]).expect("it is seen");
        let expected = "the reward is NaN: 0e0 for reaching, 0e0 for colliding, NaN by attraction and 0e0 by repulsion, \
                        whose potentials are now inf and 0e0";
        assert!(what.starts_with(expected), "{what}");
        assert_eq!(cause_of_reward(&StepOutcome::default(), &episode, &[]), None);
        assert_eq!(config.check().expect_err("so it is refused").0, "mu");
    }
}
