//! What is noted of a training while it goes on, with a window or without: the rows of ended episodes, the policies to
//! be examined, what came of that, and the best of them.
//!
//! In: the world after a control step, examinations. Out: rows, and a [`Standing`] brought up to date. Nothing here
//! writes a file or touches what is learnt.

use bevy::prelude::*;

use super::checkpoint::{Best, Standing};
use super::examiner::{Candidate, Examination};
use super::folder::RunConfig;
use super::records::{EpisodeRow, EvaluationRow, Milestone};
use super::{RunError, policy_card};
use crate::agent::{Trainer, TrainingStats};
use crate::learning::Policy;
use crate::random::{self, Stream};
use crate::task::EpisodeEnded;

/// So many of the last returns are kept to be averaged.
const RECENT: usize = 100;

/// A row for every episode that ended since the last call; `wall_s` is what to write as the time. The messages of their
/// ends are taken out of the world.
pub fn ended_episodes(world: &mut World, standing: &mut Standing, wall_s: f64) -> Vec<EpisodeRow> {
    if world.resource::<Messages<EpisodeEnded>>().is_empty() {
        return Vec::new();
    }
    let ended: Vec<EpisodeEnded> = world.resource_mut::<Messages<EpisodeEnded>>().drain().collect();
    if let Some(means) = world.resource_mut::<TrainingStats>().take_means() {
        standing.means = Some(means);
    }
    let learner = &world.resource::<Trainer>().0;
    let means = standing.means;
    let before = learner.episodes() - ended.len() as u64;
    let row = |(number, ended): (u64, &EpisodeEnded)| EpisodeRow {
        episode: number,
        arena: ended.arena,
        env_steps: learner.env_steps(),
        gradient_steps: learner.gradient_steps(),
        steps: ended.steps,
        total_return: f64::from(ended.rewards.total()),
        reward_reached: ended.rewards.reached,
        reward_collided: ended.rewards.collided,
        reward_attraction: ended.rewards.attraction,
        reward_repulsion: ended.rewards.repulsion,
        targets: ended.targets,
        collision: EpisodeRow::collision_of(ended.end),
        epsilon: learner.epsilon(),
        loss: means.map(|m| m.0),
        td_error: means.map(|m| m.1),
        mean_q: means.map(|m| m.2),
        wall_s,
    };
    let rows: Vec<EpisodeRow> = (before + 1..).zip(&ended).map(row).collect();
    for row in &rows {
        standing.recent_returns.push_back(row.total_return);
        if standing.recent_returns.len() > RECENT {
            standing.recent_returns.pop_front();
        }
    }
    rows
}

/// The policy in training as it stands, with its card.
#[must_use]
pub fn policy(config: &RunConfig, world: &World) -> Policy {
    let learner = &world.resource::<Trainer>().0;
    let mut policy = learner.policy();
    policy.metadata = policy_card::metadata(config, (learner.env_steps(), learner.gradient_steps()), None);
    policy
}

/// The same, to be examined.
#[must_use]
pub fn candidate(config: &RunConfig, world: &World) -> Candidate {
    let learner = &world.resource::<Trainer>().0;
    Candidate {
        policy: policy(config, world),
        env_steps: learner.env_steps(),
        episodes: learner.episodes(),
        gradient_steps: learner.gradient_steps(),
    }
}

/// What an examination brought.
pub struct Noted {
    /// Its row.
    pub row: EvaluationRow,
    /// The success rates (0 to 1) that were reached for the first time.
    pub first: Vec<f64>,
    /// The policy is the best so far: it stands in [`Standing::best`] now.
    pub is_best: bool,
}

/// Takes an examination into `standing`; `wall_s` is what to write as the time.
///
/// # Errors
/// The examination failed, or its policy cannot be kept.
pub fn examined(
    config: &RunConfig,
    standing: &mut Standing,
    examination: Examination,
    wall_s: f64,
) -> Result<Noted, RunError> {
    let Examination { candidate, result, .. } = examination;
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
    standing.last_success_rate = Some(row.success_rate);
    let mut reached = Vec::new();
    for (first, rate) in [(&mut standing.first_96, 0.96), (&mut standing.first_99, 0.99)] {
        if first.is_none() && row.success_rate >= rate {
            *first = Some(milestone);
            reached.push(rate);
        }
    }
    let least_cost_s =
        standing.best.as_ref().map_or(row.mean_cost_s, |best| best.least_cost_s.min(row.mean_cost_s));
    let is_best = row.mean_cost_s <= least_cost_s * Best::AS_GOOD;
    if is_best {
        let mut policy = candidate.policy;
        policy.metadata =
            policy_card::metadata(config, (row.env_steps, row.gradient_steps), Some(row.success_rate));
        standing.best = Some(Best {
            success_rate: row.success_rate,
            mean_time_s: row.mean_time_s,
            mean_cost_s: row.mean_cost_s,
            least_cost_s,
            bytes: bytes(&policy)?,
        });
    }
    Ok(Noted { row, first: reached, is_best })
}

/// A policy as the bytes of its file.
///
/// # Errors
/// A weight is not finite.
pub fn bytes(policy: &Policy) -> Result<Vec<u8>, RunError> {
    policy.to_bytes().map_err(|error| RunError::Failed(format!("the policy cannot be saved: {error}")))
}

/// The seed of the evaluations during training, far from any that a user would give to `--eval`.
#[must_use]
pub fn evaluation_seed(seed: u64) -> u64 {
    let mut stream: Stream = random::stream(seed, "evaluation during training", 0);
    random::word(&mut stream)
}
