//! The outcome of a control step: reward, termination and truncation.
//!
//! In: poses, scans and goals after the step. Out: one [`StepOutcome`] per arena; the pending reset, or `inactive`, in its
//! [`Episode`]; and an [`EpisodeEnded`] message for every episode that has ended.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::{
    Arena, ArenaLayout, ArenaScenario, DeferResets, Episode, Goal, PathLengths, PendingReset, Pose,
    RewardConfig, RewardTerms, Scan, TaskMode,
};

/// The outcome of one step in one arena.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepOutcome {
    /// The reward, term by term.
    pub reward: RewardTerms,
    /// The sum of the plugins' reward terms ([`ExtraRewards`](super::ExtraRewards)).
    pub extra_reward: f32,
    /// Whether the goal was reached (d_g < l_a) without a collision.
    pub reached: bool,
    /// Whether the robot collided: d_o < l_c, or its body touches something.
    pub collided: bool,
    /// Whether the episode has reached its time limit.
    pub timed_out: bool,
    /// Whether the arena is inactive: nothing happened, and nothing is stored.
    pub inactive: bool,
}

impl StepOutcome {
    /// The reward of the step: the sum of the paper's terms and the plugins' terms.
    #[must_use]
    pub fn total_reward(&self) -> f32 {
        self.reward.total() + self.extra_reward
    }

    /// Whether the return ends with this step, so that nothing is bootstrapped from the next state. True for a collision,
    /// and for a reached goal, since the next state belongs to another goal.
    #[must_use]
    pub fn terminated(&self) -> bool {
        self.collided || self.reached
    }

    /// Whether the time limit cut the return short. The rest is bootstrapped from the last observation.
    #[must_use]
    pub fn truncated(&self) -> bool {
        self.timed_out && !self.terminated()
    }

    /// The end of the episode, if it ends with this step.
    #[must_use]
    pub fn episode_end(&self, mode: TaskMode) -> Option<EpisodeEnd> {
        if self.collided {
            Some(EpisodeEnd::Collided)
        } else if self.reached && mode != TaskMode::Continuing {
            Some(EpisodeEnd::Reached)
        } else if self.timed_out {
            Some(EpisodeEnd::TimedOut)
        } else {
            None
        }
    }

    /// The reset that follows the step: a new episode, or a new goal for a robot that has reached its goal.
    #[must_use]
    pub fn reset(&self, mode: TaskMode) -> PendingReset {
        if self.episode_end(mode).is_some() {
            PendingReset::Episode
        } else if self.reached {
            PendingReset::Goal
        } else {
            PendingReset::None
        }
    }
}

/// The outcomes of the last step, by arena.
#[derive(Resource, Clone, Debug, Default)]
pub struct StepOutcomes(pub Vec<StepOutcome>);

/// The reason why an episode ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EpisodeEnd {
    /// The robot reached its goal (not in [`TaskMode::Continuing`]).
    Reached,
    /// The robot collided with an obstacle, a wall or the enclosure.
    Collided,
    /// The time limit was reached.
    TimedOut,
}

/// The message that is sent when an episode ends.
#[derive(Message, Clone, Debug, PartialEq)]
pub struct EpisodeEnded {
    /// The arena.
    pub arena: usize,
    /// The index of the [`ScenarioPool`](super::ScenarioPool) member that the episode took place in; 0 without a pool.
    pub scenario: usize,
    /// The reason for the end.
    pub end: EpisodeEnd,
    /// The episode's length in control steps.
    pub steps: u32,
    /// The number of goals reached.
    pub goals: u32,
    /// The undiscounted sum of the rewards, term by term.
    pub rewards: RewardTerms,
    /// The undiscounted sums of the plugins' terms, in the order of [`ExtraRewards::names`](super::ExtraRewards::names).
    pub extra_rewards: Vec<f32>,
}

impl EpisodeEnded {
    /// The undiscounted return: the sum of all rewards.
    #[must_use]
    pub fn total_return(&self) -> f64 {
        f64::from(self.rewards.total()) + f64::from(self.extra_rewards.iter().sum::<f32>())
    }
}

/// `Reward`: computes reward, collision, goal and time limit.
pub(super) fn compute_outcomes(
    reward: Res<RewardConfig>,
    mut outcomes: ResMut<StepOutcomes>,
    mut arenas: Query<(&Arena, &ArenaLayout, &Pose, &Scan, &Goal, &mut PathLengths, &mut Episode)>,
) {
    for (arena, layout, pose, scan, goal, mut paths, mut episode) in &mut arenas {
        let rules = &layout.scenario.task;
        let outcome = &mut outcomes.0[arena.0];
        if episode.inactive {
            *outcome = StepOutcome { inactive: true, ..StepOutcome::default() };
            continue;
        }
        let d_g = pose.distance_m(goal);
        let attracting_m = paths.distance_m(&reward, layout, pose, goal);
        let scale = reward.scale(layout.robot_unit_m);
        let potential = reward.potential(scale * attracting_m, scale * scan.nearest_m);
        let collided = scan.nearest_m < rules.collision_range_m || scan.touching;
        let reached = !collided && d_g < rules.goal_radius_m;
        episode.steps += 1;
        *outcome = StepOutcome {
            reward: reward.reward(reached, collided, episode.potential, potential),
            extra_reward: 0.0,
            reached,
            collided,
            timed_out: episode.steps >= rules.max_episode_steps,
            inactive: false,
        };
        episode.potential = potential;
        episode.goals += u32::from(reached);
        episode.rewards += outcome.reward;
    }
}

/// `Reset`: publishes ended episodes, and sets the pending resets. An arena that is not to be reset becomes inactive instead.
pub(super) fn close_episodes(
    (mode, defer_resets): (Res<TaskMode>, Res<DeferResets>),
    outcomes: Res<StepOutcomes>,
    mut ended: MessageWriter<EpisodeEnded>,
    mut arenas: Query<(&Arena, Option<&ArenaScenario>, &mut Episode)>,
) {
    for (arena, scenario, mut episode) in &mut arenas {
        let outcome = &outcomes.0[arena.0];
        if let Some(end) = outcome.episode_end(*mode) {
            ended.write(EpisodeEnded {
                arena: arena.0,
                scenario: scenario.map_or(0, |scenario| scenario.choice.member as usize),
                end,
                steps: episode.steps,
                goals: episode.goals,
                rewards: episode.rewards,
                extra_rewards: episode.extra_rewards.clone(),
            });
        }
        match outcome.reset(*mode) {
            PendingReset::None => {}
            _ if defer_resets.0 || *mode == TaskMode::SingleGoal => episode.inactive = true,
            reset => episode.pending_reset = reset,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_limit_truncates_the_return_but_does_not_terminate_it() {
        let outcome = StepOutcome { timed_out: true, ..StepOutcome::default() };
        assert!(outcome.truncated() && !outcome.terminated());
        assert_eq!(outcome.episode_end(TaskMode::Continuing), Some(EpisodeEnd::TimedOut));
    }

    #[test]
    fn a_reached_goal_ends_the_return_but_not_the_episode() {
        let outcome = StepOutcome { reached: true, ..StepOutcome::default() };
        assert!(outcome.terminated() && !outcome.truncated());
        assert_eq!(outcome.episode_end(TaskMode::Continuing), None);
        assert_eq!(outcome.episode_end(TaskMode::SingleGoal), Some(EpisodeEnd::Reached));
    }

    #[test]
    fn a_collision_in_the_last_allowed_step_is_a_collision() {
        let outcome = StepOutcome { collided: true, timed_out: true, ..StepOutcome::default() };
        assert!(outcome.terminated() && !outcome.truncated());
        assert_eq!(outcome.episode_end(TaskMode::Continuing), Some(EpisodeEnd::Collided));
    }

    #[test]
    fn a_goal_reached_in_the_last_allowed_step_ends_the_episode_too() {
        let outcome = StepOutcome { reached: true, timed_out: true, ..StepOutcome::default() };
        assert!(outcome.terminated() && !outcome.truncated());
        assert_eq!(outcome.episode_end(TaskMode::Continuing), Some(EpisodeEnd::TimedOut));
    }
}
