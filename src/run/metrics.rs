//! What is noted of a training while it goes on, with a window or without: the rows of ended episodes, the policies to
//! be examined, what came of that, and the best of them.
//!
//! In: the world after a control step, examinations. Out: rows, and a [`TrainerState`] brought up to date. Nothing here
//! writes a file or touches what is learnt.

use bevy::prelude::*;

use super::background_evaluator::{Candidate, EvalResult};
use super::checkpoint::{BestPolicy, TrainerState};
use super::folder::RunConfig;
use super::metric_rows::{EpisodeRow, EvaluationRow, Milestone};
use super::{RunError, policy_card};
use crate::agent::{ActiveLearner, TrainingStats};
use crate::policy::Policy;
use crate::random::{self, Stream};
use crate::task::EpisodeEnded;

/// So many of the last returns are kept to be averaged.
const RECENT: usize = 100;

/// A row for every episode that ended since the last call; `wall_s` is what to write as the time. The messages of their
/// ends are taken out of the world.
pub fn take_episode_rows(
    world: &mut World,
    trainer_state: &mut TrainerState,
    wall_s: f64,
) -> Vec<EpisodeRow> {
    if world.resource::<Messages<EpisodeEnded>>().is_empty() {
        return Vec::new();
    }
    let ended: Vec<EpisodeEnded> = world.resource_mut::<Messages<EpisodeEnded>>().drain().collect();
    if let Some(means) = world.resource_mut::<TrainingStats>().take_means() {
        trainer_state.means = Some(means);
    }
    let learner = &world.resource::<ActiveLearner>().0;
    let means = trainer_state.means;
    let before = learner.episodes() - ended.len() as u64;
    let row = |(number, ended): (u64, &EpisodeEnded)| EpisodeRow {
        episode: number,
        arena: ended.arena,
        env_steps: learner.env_steps(),
        gradient_steps: learner.gradient_steps(),
        steps: ended.steps,
        total_return: ended.total_return(),
        reward_goal: ended.rewards.reached,
        reward_collision: ended.rewards.collided,
        reward_attraction: ended.rewards.attraction,
        reward_repulsion: ended.rewards.repulsion,
        extra_rewards: ended.extra_rewards.clone(),
        goals: ended.goals,
        collision: EpisodeRow::collision_flag(ended.end),
        epsilon: learner.epsilon(),
        loss: means.map(|m| m.0),
        td_error: means.map(|m| m.1),
        mean_q: means.map(|m| m.2),
        wall_s,
    };
    let rows: Vec<EpisodeRow> = (before + 1..).zip(&ended).map(row).collect();
    for row in &rows {
        trainer_state.recent_returns.push_back(row.total_return);
        if trainer_state.recent_returns.len() > RECENT {
            trainer_state.recent_returns.pop_front();
        }
    }
    rows
}

/// The policy in training as it stands, with its card.
#[must_use]
pub fn policy(config: &RunConfig, world: &World) -> Policy {
    let learner = &world.resource::<ActiveLearner>().0;
    let mut policy = learner.policy();
    policy.metadata = policy_card::metadata(config, (learner.env_steps(), learner.gradient_steps()), None);
    policy
}

/// The same, to be examined.
#[must_use]
pub fn candidate(config: &RunConfig, world: &World) -> Candidate {
    let learner = &world.resource::<ActiveLearner>().0;
    Candidate {
        policy: policy(config, world),
        env_steps: learner.env_steps(),
        episodes: learner.episodes(),
        gradient_steps: learner.gradient_steps(),
    }
}

/// What an examination brought.
pub struct EpisodeMetrics {
    /// Its row.
    pub row: EvaluationRow,
    /// The success rates (0 to 1) that were reached for the first time.
    pub first: Vec<f64>,
    /// The policy is the best so far: it stands in [`TrainerState::best`] now.
    pub is_best: bool,
}

/// Takes an examination into `trainer_state`; `wall_s` is what to write as the time.
///
/// # Errors
/// The examination failed, or its policy cannot be kept.
pub fn record_evaluation(
    config: &RunConfig,
    trainer_state: &mut TrainerState,
    eval_result: EvalResult,
    wall_s: f64,
) -> Result<EpisodeMetrics, RunError> {
    let EvalResult { candidate, result, .. } = eval_result;
    let result = result?;
    let row = EvaluationRow {
        env_steps: candidate.env_steps,
        episodes: candidate.episodes,
        gradient_steps: candidate.gradient_steps,
        success_rate: result.success_rate,
        collision_rate: result.collision_rate,
        timeout_rate: result.timeout_rate,
        mean_time_s: result.mean_time_s,
        mean_cost_s: result.mean_cost_s,
        wall_s,
    };
    let milestone = Milestone { env_steps: row.env_steps, episodes: row.episodes, wall_s };
    trainer_state.last_success_rate = Some(row.success_rate);
    let mut reached = Vec::new();
    for (first, rate) in [(&mut trainer_state.first_96, 0.96), (&mut trainer_state.first_99, 0.99)] {
        if first.is_none() && row.success_rate >= rate {
            *first = Some(milestone);
            reached.push(rate);
        }
    }
    let min_cost_s =
        trainer_state.best.as_ref().map_or(row.mean_cost_s, |best| best.min_cost_s.min(row.mean_cost_s));
    let is_best = row.mean_cost_s <= min_cost_s * BestPolicy::COST_TOLERANCE;
    if is_best {
        let mut policy = candidate.policy;
        policy.metadata =
            policy_card::metadata(config, (row.env_steps, row.gradient_steps), Some(row.success_rate));
        trainer_state.best = Some(BestPolicy {
            success_rate: row.success_rate,
            mean_time_s: row.mean_time_s,
            mean_cost_s: row.mean_cost_s,
            min_cost_s,
            bytes: policy_bytes(&policy)?,
        });
    }
    Ok(EpisodeMetrics { row, first: reached, is_best })
}

/// A policy as the bytes of its file.
///
/// # Errors
/// A weight is not finite.
pub fn policy_bytes(policy: &Policy) -> Result<Vec<u8>, RunError> {
    policy.to_bytes().map_err(|error| RunError::Failed(format!("the policy cannot be saved: {error}")))
}

/// The seed of the evaluations during training, far from any that a user would give to `--eval`.
#[must_use]
pub fn evaluation_seed(seed: u64) -> u64 {
    let mut stream: Stream = random::stream(seed, "evaluation during training", 0);
    random::random_u64(&mut stream)
}
