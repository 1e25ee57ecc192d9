//! The state of a run in a checkpoint, and the check of its values.

use std::collections::VecDeque;
use std::sync::Arc;

use bevy::prelude::World;
use serde::{Deserialize, Serialize};

use crate::agent::{Decisions, TrainingStats};
use crate::learning::Policy;
use crate::limits::{MAX_RECENT_RETURNS, MAX_TIME_S};
use crate::policy::observation::ObserverMemory;
use crate::random::{self, Stream};
use crate::run::folder::RunConfig;
use crate::run::metric_rows::Milestone;
use crate::sim;
use crate::task::{ArenaScenario, ArenaState, LevelProgress, LevelResults, Pedestrians, Pose, ScenarioPool};

/// The state of a run, apart from its learner.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrainerState {
    /// The arenas.
    pub arenas: Vec<ArenaState>,
    /// The random streams of exploration, one per arena.
    pub exploration: Vec<Stream>,
    /// Sums over the gradient steps since the last row of `episodes.csv`.
    pub stats: TrainingStats,
    /// Mean loss, TD error and Q-value in the last row.
    pub means: Option<(f64, f64, f64)>,
    /// Returns of the last episodes, at most [`MAX_RECENT_RETURNS`].
    pub recent_returns: VecDeque<f64>,
    /// Length of `episodes.csv` in bytes.
    pub episodes_bytes: u64,
    /// Length of `evaluations.csv` in bytes.
    pub evaluations_bytes: u64,
    /// Env steps at which the next evaluation is due; the first is due before the first step.
    pub next_evaluation: u64,
    /// Env steps at the last evaluation; `None` before the first.
    pub evaluated_at: Option<u64>,
    /// Success rate of the last evaluation, 0 to 1.
    pub last_success_rate: Option<f64>,
    /// The best policy so far.
    pub best: Option<BestPolicy>,
    /// The first evaluation with a success rate of at least 96 %.
    pub first_96: Option<Milestone>,
    /// The first evaluation with a success rate of at least 99 %.
    pub first_99: Option<Milestone>,
    /// Wall time up to this checkpoint, in s, over all processes of the run.
    pub wall_s: f64,
    /// The plugin data of every arena; empty without plugins.
    pub arena_extensions: Vec<ArenaExtension>,
    /// Which scenario of the run's set each arena is in; empty without a set.
    pub arena_scenarios: Vec<ArenaScenario>,
    /// The estimated pose of each arena's robot; empty if these are the true poses.
    pub estimated_poses: Vec<Pose>,
    /// The pedestrians of each arena; empty if there are none.
    pub pedestrians: Vec<Pedestrians>,
    /// What each arena's robot remembers for its observation by sectors; empty with any other observation.
    pub observer_memories: Vec<ObserverMemory>,
    /// The results in each level, by member of the run's set; empty unless levels are drawn by their results.
    pub level_results: Vec<Vec<LevelResults>>,
}

/// The plugin data of an arena: sensor readings, and the sums of reward terms in the current episode.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ArenaExtension {
    /// The readings of plugin sensors.
    pub readings: Vec<f32>,
    /// The sums of plugin reward terms.
    pub extra_rewards: Vec<f32>,
}

impl ArenaExtension {
    fn from_state(state: &ArenaState) -> Self {
        Self { readings: state.readings.clone(), extra_rewards: state.episode.extra_rewards.clone() }
    }

    fn is_empty(&self) -> bool {
        self.readings.is_empty() && self.extra_rewards.is_empty()
    }
}

/// The best policy so far: the latest one whose mean cost is within [`BestPolicy::COST_TOLERANCE`] of the
/// minimum.
///
/// The cost of an episode is its simulated time; a failure costs the whole time limit. Over a few
/// hundred episodes, a difference within the tolerance is noise; of two such policies, the one trained longer is kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BestPolicy {
    /// Fraction of episodes that succeeded, 0 to 1.
    pub success_rate: f64,
    /// Mean simulated time of the successful episodes, in s.
    pub mean_time_s: Option<f64>,
    /// Mean cost of all episodes, in s.
    pub mean_cost_s: f64,
    /// Minimum mean cost of all policies so far, in s.
    pub min_cost_s: f64,
    /// The contents of the policy file.
    pub bytes: Vec<u8>,
}

impl BestPolicy {
    /// Policies count as equally good up to this multiple of the minimum mean cost.
    pub const COST_TOLERANCE: f64 = 1.01;

    /// Env steps of training up to this policy, from its policy card; `None` without a card.
    #[must_use]
    pub fn env_steps(&self) -> Option<u64> {
        Some(Policy::from_bytes(&self.bytes).ok()?.card?.training.env_steps)
    }
}

impl TrainerState {
    /// Copies the state of the arenas, of the agent and of the levels from `world`.
    pub fn update(&mut self, world: &mut World) {
        let arenas = sim::snapshot(world);
        let exploration = world.resource::<Decisions>().streams.clone();
        let progress = world.get_resource::<LevelProgress>();
        self.level_results = progress.map(LevelProgress::results).unwrap_or_default();
        self.update_with(arenas, exploration, *world.resource::<TrainingStats>());
    }

    /// Replaces the state of the arenas and of the agent.
    pub fn update_with(&mut self, arenas: Vec<ArenaState>, exploration: Vec<Stream>, stats: TrainingStats) {
        (self.arenas, self.exploration, self.stats) = (arenas, exploration, stats);
        self.collect_extensions();
    }

    /// Copies from the arenas what their serialized form leaves out: plugin data, scenarios, estimated poses, pedestrians and
    /// observer memories.
    fn collect_extensions(&mut self) {
        self.arena_extensions = self.arenas.iter().map(ArenaExtension::from_state).collect();
        if self.arena_extensions.iter().all(ArenaExtension::is_empty) {
            self.arena_extensions.clear();
        }
        self.estimated_poses = self.arenas.iter().map(|arena| arena.estimated_pose).collect();
        if self.arenas.iter().all(|arena| arena.estimated_pose == arena.pose) {
            self.estimated_poses.clear();
        }
        self.pedestrians = self.arenas.iter().map(|arena| arena.pedestrians.clone()).collect();
        if self.pedestrians.iter().all(|pedestrians| *pedestrians == Pedestrians::default()) {
            self.pedestrians.clear();
        }
        self.observer_memories = self.arenas.iter().map(|arena| arena.observer_memory.clone()).collect();
        if self.observer_memories.iter().all(ObserverMemory::is_empty) {
            self.observer_memories.clear();
        }
        self.arena_scenarios = self.arenas.iter().filter_map(|arena| arena.scenario.clone()).collect();
    }

    /// The reverse of `collect_extensions`: copies the data back into the arenas.
    ///
    /// # Errors
    /// Some of the data are for a different number of arenas.
    pub(super) fn distribute_extensions(&mut self) -> Result<(), String> {
        for (what, count) in [
            ("plugin data", self.arena_extensions.len()),
            ("scenarios", self.arena_scenarios.len()),
            ("estimated poses", self.estimated_poses.len()),
            ("pedestrians", self.pedestrians.len()),
            ("earlier scans", self.observer_memories.len()),
        ] {
            if count != 0 && count != self.arenas.len() {
                return Err(format!("is damaged: it has {what} for a different number of arenas"));
            }
        }
        for (arena, extension) in self.arenas.iter_mut().zip(&self.arena_extensions) {
            arena.readings.clone_from(&extension.readings);
            arena.episode.extra_rewards.clone_from(&extension.extra_rewards);
        }
        for (arena, scenario) in self.arenas.iter_mut().zip(&self.arena_scenarios) {
            arena.scenario = Some(scenario.clone());
        }
        for (k, arena) in self.arenas.iter_mut().enumerate() {
            arena.estimated_pose = self.estimated_poses.get(k).copied().unwrap_or(arena.pose);
        }
        for (arena, pedestrians) in self.arenas.iter_mut().zip(&self.pedestrians) {
            arena.pedestrians.clone_from(pedestrians);
        }
        for (arena, memory) in self.arenas.iter_mut().zip(&self.observer_memories) {
            arena.observer_memory.clone_from(memory);
        }
        self.collect_extensions();
        Ok(())
    }

    /// Checks that a run of `config` can continue from this state.
    pub(super) fn check(&self, config: &RunConfig) -> Result<(), String> {
        let arenas = config.preset.arenas;
        if self.arenas.len() != arenas || self.exploration.len() != arenas {
            return Err("has a different number of arenas than config.ron".into());
        }
        let own = Arc::new(config.scenario.clone());
        let pool = config.scenario_set.as_ref().map(ScenarioPool::new);
        for (number, arena) in self.arenas.iter().enumerate() {
            let scenario = match (&pool, &arena.scenario) {
                (None, None) => Some(own.clone()),
                (Some(pool), Some(drawn)) => drawn.scenario_in(pool),
                _ => None,
            };
            let scenario = scenario
                .ok_or_else(|| format!("is damaged: arena {number} has an invalid value for the scenario"))?;
            arena
                .check(&scenario, &config.observation_layout())
                .map_err(|what| format!("is damaged: arena {number} has an invalid value for {what}"))?;
        }
        let progress = pool.as_ref().and_then(|pool| LevelProgress::new(config.preset.levels, pool));
        if !progress.map_or(self.level_results.is_empty(), |progress| progress.fit(&self.level_results)) {
            return Err("is damaged: invalid value for the results in the levels".into());
        }
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let TrainingStats { loss, td_error, q_value, .. } = self.stats;
        let is_fraction = |rate: f64| (0.0..=1.0).contains(&rate);
        let milestones = [self.first_96, self.first_99];
        for (what, is_valid) in [
            ("a random stream of exploration", self.exploration.iter().all(random::is_valid)),
            ("the sums over gradient steps", finite(&[loss, td_error, q_value])),
            ("the means of the last row", self.means.is_none_or(|(a, b, c)| finite(&[a, b, c]))),
            (
                "the recent returns",
                self.recent_returns.len() <= MAX_RECENT_RETURNS
                    && self.recent_returns.iter().all(|value| value.is_finite()),
            ),
            ("the next evaluation", self.next_evaluation <= 1 << 62),
            ("the last success rate", self.last_success_rate.is_none_or(is_fraction)),
            ("the best policy", self.best.as_ref().is_none_or(BestPolicy::is_valid)),
            ("the milestones", milestones.iter().flatten().all(|milestone| milestone.wall_s.is_finite())),
            ("the wall time", (0.0..=MAX_TIME_S).contains(&self.wall_s)),
        ] {
            if !is_valid {
                return Err(format!("is damaged: invalid value for {what}"));
            }
        }
        Ok(())
    }
}

impl BestPolicy {
    /// Whether the policy is readable and the numbers are possible results of an evaluation.
    fn is_valid(&self) -> bool {
        let times = [self.mean_cost_s, self.min_cost_s].into_iter().chain(self.mean_time_s);
        (0.0..=1.0).contains(&self.success_rate)
            && times.into_iter().all(|time| (0.0..=MAX_TIME_S).contains(&time))
            && Policy::from_bytes(&self.bytes).is_ok()
    }
}
