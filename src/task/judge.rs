//! What a step was worth, and whether it ended something.
//!
//! In: poses, scans and targets after the step. Out: one [`Outcome`] per arena; what is due before the next step
//! (in [`Episode`]); and an [`EpisodeEnded`] message for every episode that is over.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::{
    Arena, CurrentScenario, Episode, Pose, Restart, RewardConfig, RewardTerms, Scan, Target, TaskMode,
};

/// What came of one step of one arena.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// The reward, term by term.
    pub reward: RewardTerms,
    /// The target was reached (d_g < l_a) and nothing was hit.
    pub reached: bool,
    /// The robot hit something: d_o < l_c, or its body touches another.
    pub collided: bool,
    /// The episode has lasted as long as it may.
    pub timed_out: bool,
    /// The arena was parked: nothing happened, nothing is to be remembered.
    pub parked: bool,
}

impl Outcome {
    /// The return ends with this step: nothing is bootstrapped from what follows. True for a collision, and for a
    /// reached target, whose successor state belongs to another target.
    #[must_use]
    pub fn terminated(&self) -> bool {
        self.collided || self.reached
    }

    /// The time limit cut the return short: the value of the last observation stands for the rest.
    #[must_use]
    pub fn truncated(&self) -> bool {
        self.timed_out && !self.terminated()
    }

    /// Why the episode ends with this step, if it does.
    #[must_use]
    pub fn episode_end(&self, mode: TaskMode) -> Option<EpisodeEnd> {
        if self.collided {
            Some(EpisodeEnd::Collided)
        } else if self.reached && mode == TaskMode::SingleNavigation {
            Some(EpisodeEnd::Reached)
        } else if self.timed_out {
            Some(EpisodeEnd::TimedOut)
        } else {
            None
        }
    }
}

/// The outcomes of the last step, by arena.
#[derive(Resource, Clone, Debug, Default)]
pub struct Outcomes(pub Vec<Outcome>);

/// Why an episode ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EpisodeEnd {
    /// The target was reached (only where that ends an episode).
    Reached,
    /// The robot hit an obstacle or the enclosure.
    Collided,
    /// The time limit.
    TimedOut,
}

/// An episode is over.
#[derive(Message, Clone, Debug, PartialEq)]
pub struct EpisodeEnded {
    /// In which arena.
    pub arena: usize,
    /// How it ended.
    pub end: EpisodeEnd,
    /// Its length in control steps.
    pub steps: u32,
    /// Targets reached in it.
    pub targets: u32,
    /// The undiscounted sum of its rewards, term by term.
    pub rewards: RewardTerms,
}

/// `Judge`: reward, collision, target, time limit.
pub(super) fn judge(
    scenario: Res<CurrentScenario>,
    reward: Res<RewardConfig>,
    mut outcomes: ResMut<Outcomes>,
    mut arenas: Query<(&Arena, &Pose, &Scan, &Target, &mut Episode)>,
) {
    let rules = &scenario.0.task;
    for (arena, pose, scan, target, mut episode) in &mut arenas {
        let outcome = &mut outcomes.0[arena.0];
        if episode.parked {
            *outcome = Outcome { parked: true, ..Outcome::default() };
            continue;
        }
        let d_g = pose.distance_m(target);
        let potential = reward.potential(d_g, scan.nearest_m);
        let collided = scan.nearest_m < rules.collision_range_m || scan.touching;
        let reached = !collided && d_g < rules.goal_radius_m;
        episode.steps += 1;
        *outcome = Outcome {
            reward: reward.reward(reached, collided, episode.potential, potential),
            reached,
            collided,
            timed_out: episode.steps >= rules.time_limit_steps,
            parked: false,
        };
        episode.potential = potential;
        episode.targets += u32::from(reached);
        episode.rewards += outcome.reward;
    }
}

/// `Restart`: publishes the episodes that are over and marks what each arena is owed.
pub(super) fn close_episodes(
    mode: Res<TaskMode>,
    outcomes: Res<Outcomes>,
    mut ended: MessageWriter<EpisodeEnded>,
    mut arenas: Query<(&Arena, &mut Episode)>,
) {
    for (arena, mut episode) in &mut arenas {
        let outcome = &outcomes.0[arena.0];
        if let Some(end) = outcome.episode_end(*mode) {
            ended.write(EpisodeEnded {
                arena: arena.0,
                end,
                steps: episode.steps,
                targets: episode.targets,
                rewards: episode.rewards,
            });
            match *mode {
                TaskMode::Continuing => episode.restart = Restart::Episode,
                TaskMode::SingleNavigation => episode.parked = true,
            }
        } else if outcome.reached {
            episode.restart = Restart::Target;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_limit_truncates_but_does_not_terminate() {
        let outcome = Outcome { timed_out: true, ..Outcome::default() };
        assert!(outcome.truncated() && !outcome.terminated());
        assert_eq!(outcome.episode_end(TaskMode::Continuing), Some(EpisodeEnd::TimedOut));
    }

    #[test]
    fn a_reached_target_ends_the_return_but_not_the_episode() {
        let outcome = Outcome { reached: true, ..Outcome::default() };
        assert!(outcome.terminated() && !outcome.truncated());
        assert_eq!(outcome.episode_end(TaskMode::Continuing), None);
        assert_eq!(outcome.episode_end(TaskMode::SingleNavigation), Some(EpisodeEnd::Reached));
    }

    #[test]
    fn a_collision_in_the_last_allowed_step_is_a_collision() {
        let outcome = Outcome { collided: true, timed_out: true, ..Outcome::default() };
        assert!(outcome.terminated() && !outcome.truncated());
        assert_eq!(outcome.episode_end(TaskMode::Continuing), Some(EpisodeEnd::Collided));
    }

    #[test]
    fn a_target_reached_in_the_last_allowed_step_ends_the_episode_too() {
        let outcome = Outcome { reached: true, timed_out: true, ..Outcome::default() };
        assert!(outcome.terminated() && !outcome.truncated());
        assert_eq!(outcome.episode_end(TaskMode::Continuing), Some(EpisodeEnd::TimedOut));
    }
}
