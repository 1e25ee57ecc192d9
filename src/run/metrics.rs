//! The metrics of a training run, headless or in the app: rows of episodes and evaluations, and the best policy.
//!
//! In: the world after a control step; results of evaluations. Out: rows, and an updated [`TrainerState`].
//! This module neither writes files nor affects learning.

use bevy::prelude::*;

use super::background_evaluator::{Candidate, EpisodeSet, EvalResult};
use super::checkpoint::{BestPolicy, TrainerState};
use super::folder::RunConfig;
use super::metric_rows::{EpisodeRow, EvaluationRow, Milestone};
use super::{RunError, policy_card};
use crate::agent::{ActiveLearner, TrainingStats};
use crate::limits::MAX_RECENT_RETURNS;
use crate::policy::Policy;
use crate::random::{self, Stream};
use crate::task::{EpisodeEnded, ScenarioPool};

/// Takes the rows of all episodes that ended since the last call, with the wall time `wall_s`, and removes their
/// [`EpisodeEnded`] messages from `world`.
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
    let pool = world.get_resource::<ScenarioPool>();
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
        scenario: pool.map(|pool| pool.name(ended.scenario).into()),
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
        if trainer_state.recent_returns.len() > MAX_RECENT_RETURNS {
            trainer_state.recent_returns.pop_front();
        }
    }
    rows
}

/// The current policy, with its card.
#[must_use]
pub fn policy(config: &RunConfig, world: &World) -> Policy {
    let learner = &world.resource::<ActiveLearner>().0;
    let mut policy = learner.policy();
    policy_card::attach(&mut policy, config, (learner.env_steps(), learner.gradient_steps()), None);
    policy
}

/// The current policy as a candidate for evaluation.
#[must_use]
pub fn candidate(config: &RunConfig, world: &World) -> Candidate {
    let learner = &world.resource::<ActiveLearner>().0;
    Candidate {
        policy: policy(config, world),
        env_steps: learner.env_steps(),
        episodes: learner.episodes(),
        gradient_steps: learner.gradient_steps(),
        test: None,
    }
}

/// The metrics of an evaluation.
pub struct EvaluationMetrics {
    /// The row of the evaluation.
    pub row: EvaluationRow,
    /// Milestones (success rates, 0 to 1) reached for the first time.
    pub milestones_reached: Vec<f64>,
    /// Whether the policy is the best so far, and is now in [`TrainerState::best`].
    pub is_best: bool,
}

/// Records the result of an evaluation in `trainer_state`, with the wall time `wall_s`.
///
/// # Errors
/// The evaluation failed, or its policy cannot be saved.
pub fn record_evaluation(
    trainer_state: &mut TrainerState,
    eval_result: EvalResult,
    wall_s: f64,
) -> Result<EvaluationMetrics, RunError> {
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
        scenario_success_rates: result.scenarios.into_iter().map(|of| (of.name, of.success_rate)).collect(),
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
        if let Some(card) = &mut policy.card {
            card.training.success_rate = Some(row.success_rate);
        }
        trainer_state.best = Some(BestPolicy {
            success_rate: row.success_rate,
            mean_time_s: row.mean_time_s,
            mean_cost_s: row.mean_cost_s,
            min_cost_s,
            bytes: policy_bytes(&policy)?,
        });
    }
    Ok(EvaluationMetrics { row, milestones_reached: reached, is_best })
}

/// The contents of a policy's file.
///
/// # Errors
/// A weight is not finite.
pub fn policy_bytes(policy: &Policy) -> Result<Vec<u8>, RunError> {
    policy.to_bytes().map_err(|error| RunError::Failed(format!("the policy cannot be saved: {error}")))
}

/// The episodes of the evaluations during the training run of `config`.
#[must_use]
pub fn evaluation_episodes(config: &RunConfig) -> EpisodeSet {
    EpisodeSet { count: config.preset.evaluation.episodes, seed: evaluation_seed(config.seed) }
}

/// The seed of the evaluations during training. It is hashed, so that `--eval` with the same seed uses other
/// episodes.
#[must_use]
pub fn evaluation_seed(seed: u64) -> u64 {
    let mut stream: Stream = random::stream(seed, "evaluation during training", 0);
    random::random_u64(&mut stream)
}
