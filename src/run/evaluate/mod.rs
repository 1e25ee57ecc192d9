//! Evaluation of a policy or a classical driver: success rates and times over rounds of episodes and on the benchmark route, and
//! the comparison with optimal times.
//!
//! In: a policy or driver, a scenario, a seed. Out: the episodes and an [`Evaluation`]. Episode j depends only on the
//! policy or driver, the scenario, the seed and j.
//!
//! **Success**: the robot gets closer to the goal than l_a (0.2 m) before a LIDAR range is below l_c (0.13 m)
//! or its body touches anything, within the scenario's time limit (500 steps, 100 s). An episode has one
//! start and one goal, drawn from random streams that training never uses. The obstacles' clock at the
//! start is drawn too.

mod commanded;
#[cfg(not(target_arch = "wasm32"))]
mod episode_image;
mod evaluator;
mod optimum;
mod path;
mod per_episode;
mod record;
mod trace;

use serde::{Deserialize, Serialize};

use crate::drivers::{DriverClass, DriverConfig, DrivingPolicy};
use crate::policy::Policy;
use crate::report::rate::rate_interval;
use crate::scenario::TaskRules;
use crate::task::{Clock, EpisodeEnd, Goal, Pose, ScenarioPool};

pub use evaluator::{EvaluationRun, Evaluator, check_compatible, episode_streams};
pub use optimum::{OptimumComparison, compare_with_optimum};
pub use path::PathMeasures;
pub use per_episode::{bounds, shortest_paths_m};
pub use record::EpisodeRecord;
pub use trace::TraceStep;

/// The simulation's physics, as reports name it: results from other physics do not belong in the same column.
pub const PHYSICS: &str = "kinematic, rapier contact";

/// What is evaluated: a policy, a policy with a map, or a classical driver.
#[derive(Clone, Copy, Debug)]
pub enum Evaluated<'a> {
    /// The greedy actions of a policy.
    Policy(&'a Policy),
    /// A policy that builds a map, and uses it to drive around anything that blocks the straight line to the goal.
    PolicyWithMap(&'a DrivingPolicy),
    /// A classical driver.
    Driver(&'a DriverConfig),
}

impl Evaluated<'_> {
    /// What it may perceive: class A for a policy, B for a policy with a map.
    #[must_use]
    pub fn class(&self) -> DriverClass {
        match self {
            Self::Policy(_) => DriverClass::A,
            Self::PolicyWithMap(policy) => policy.class(),
            Self::Driver(driver) => driver.class(),
        }
    }
}

impl<'a> From<&'a Policy> for Evaluated<'a> {
    fn from(policy: &'a Policy) -> Self {
        Self::Policy(policy)
    }
}

impl<'a> From<&'a DrivingPolicy> for Evaluated<'a> {
    fn from(policy: &'a DrivingPolicy) -> Self {
        Self::PolicyWithMap(policy)
    }
}

impl<'a> From<&'a DriverConfig> for Evaluated<'a> {
    fn from(driver: &'a DriverConfig) -> Self {
        Self::Driver(driver)
    }
}

/// The result of one episode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EpisodeResult {
    /// The reason why the episode ended.
    pub end: EpisodeEnd,
    /// The length of the episode in control steps.
    pub steps: u32,
    /// The robot's initial pose.
    pub start: Pose,
    /// The goal.
    pub goal: Goal,
    /// The obstacles' clock at the start.
    pub clock: Clock,
    /// The seed of the generated obstacles and of the drawn numbers, if the scenario has generators or ranges.
    pub layout_seed: u64,
    /// The measures of the robot's path; `None` unless the evaluator [measures them](Evaluator::measuring_paths).
    pub path: Option<PathMeasures>,
}

impl EpisodeResult {
    /// Whether the robot reached the goal.
    #[must_use]
    pub fn succeeded(&self) -> bool {
        self.end == EpisodeEnd::Reached
    }

    /// Success weighted by path length, 0 to 1, where the shortest path to the goal has the length `shortest_path_m`, in m:
    /// 0 after a failure, otherwise the shortest length divided by the larger of the actual length and the shortest. `None` if
    /// the path was not measured.
    ///
    /// Source: Anderson et al., *On evaluation of embodied navigation agents*, arXiv 1807.06757 (2018).
    #[must_use]
    pub fn spl(&self, shortest_path_m: f64) -> Option<f64> {
        let longer_m = self.path?.length_m.max(shortest_path_m);
        Some(if !self.succeeded() {
            0.0
        } else if longer_m > 0.0 {
            shortest_path_m / longer_m
        } else {
            1.0
        })
    }
}

/// The name of an episode's end in files and tables: `success`, `collision` or `timeout`.
#[must_use]
pub fn outcome_name(end: EpisodeEnd) -> &'static str {
    match end {
        EpisodeEnd::Reached => "success",
        EpisodeEnd::Collided => "collision",
        EpisodeEnd::TimedOut => "timeout",
    }
}

/// The rates and mean times of a set of episodes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// Fraction of episodes that succeeded, 0 to 1.
    pub success_rate: f64,
    /// The 95 % confidence interval of the success rate ([`rate_interval`]), within 0 to 1.
    pub success_interval: [f64; 2],
    /// The success rate of each round (tables 2 and 5 of the paper).
    pub rounds: Vec<f64>,
    /// Fraction of episodes that ended in a collision, 0 to 1.
    pub collision_rate: f64,
    /// Its 95 % confidence interval, within 0 to 1.
    pub collision_interval: [f64; 2],
    /// Fraction of episodes that ended at the time limit, 0 to 1.
    pub timeout_rate: f64,
    /// Its 95 % confidence interval, within 0 to 1.
    pub timeout_interval: [f64; 2],
    /// Mean simulated time of the successful episodes, in s; `None` if none succeeded.
    pub mean_time_s: Option<f64>,
    /// Mean cost, in s: the simulated time of an episode, or the whole time limit if it failed. The best
    /// policy of a run is the one with the lowest cost.
    pub mean_cost_s: f64,
    /// Number of episodes.
    pub episodes: usize,
    /// The seed of the episodes' starts and goals.
    pub seed: u64,
    /// The results in each scenario of a set; empty if all episodes had the same scenario.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub scenarios: Vec<ScenarioResult>,
}

/// The result of an evaluation in one scenario of a set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScenarioResult {
    /// The scenario's name in the set.
    pub name: String,
    /// Fraction of the episodes in this scenario that succeeded, 0 to 1.
    pub success_rate: f64,
    /// The 95 % confidence interval of the success rate, within 0 to 1.
    pub success_interval: [f64; 2],
    /// Fraction of these episodes that ended in a collision, 0 to 1.
    pub collision_rate: f64,
    /// Fraction of these episodes that ended at the time limit, 0 to 1.
    pub timeout_rate: f64,
    /// Mean simulated time of the successful episodes, in s; `None` if none succeeded.
    pub mean_time_s: Option<f64>,
    /// Number of episodes in this scenario.
    pub episodes: usize,
}

impl Evaluation {
    /// The evaluation of `episodes`, with `round` episodes per round. Without episodes, the rates and the mean cost are NaN.
    ///
    /// # Panics
    /// `round` is 0.
    #[must_use]
    pub fn from_episodes(episodes: &[EpisodeResult], round: usize, rules: &TaskRules, seed: u64) -> Self {
        let count = |of: &[EpisodeResult], end| of.iter().filter(|episode| episode.end == end).count();
        let rate = |of: &[EpisodeResult], end| count(of, end) as f64 / of.len() as f64;
        let interval = |end| rate_interval(count(episodes, end), episodes.len());
        Self {
            success_rate: rate(episodes, EpisodeEnd::Reached),
            success_interval: interval(EpisodeEnd::Reached),
            rounds: episodes.chunks(round).map(|chunk| rate(chunk, EpisodeEnd::Reached)).collect(),
            collision_rate: rate(episodes, EpisodeEnd::Collided),
            collision_interval: interval(EpisodeEnd::Collided),
            timeout_rate: rate(episodes, EpisodeEnd::TimedOut),
            timeout_interval: interval(EpisodeEnd::TimedOut),
            mean_time_s: mean_time_s(times_s(episodes, rules.control_period_s)),
            mean_cost_s: mean_cost_s(episodes, rules),
            episodes: episodes.len(),
            seed,
            scenarios: Vec::new(),
        }
    }

    /// The evaluation of `episodes`, with `round` episodes per round. Their scenarios are those of
    /// [`ScenarioPool::in_fixed_shares`].
    #[must_use]
    pub fn over_pool(episodes: &[EpisodeResult], round: usize, pool: &ScenarioPool, seed: u64) -> Self {
        let member_of = pool.in_fixed_shares(episodes.len());
        let mut groups = vec![Vec::new(); pool.members()];
        for (episode, &member) in episodes.iter().zip(&member_of) {
            groups[member].push(*episode);
        }
        let of_member = |(member, group): (usize, &Vec<EpisodeResult>)| {
            let of = Self::from_episodes(group, group.len(), &pool.rules(member), seed);
            (pool.name(member).to_string(), of)
        };
        let groups = groups.iter().enumerate().filter(|(_, group)| !group.is_empty());
        let members: Vec<(String, Self)> = groups.map(of_member).collect();
        // Control periods and time limits may differ between the scenarios.
        let cost_s: f64 = members.iter().map(|(_, of)| of.mean_cost_s * of.episodes as f64).sum();
        let mean_cost_s = round_to_millionth(cost_s / episodes.len() as f64);
        let periods_s: Vec<f32> =
            (0..pool.members()).map(|member| pool.rules(member).control_period_s).collect();
        let times = episodes
            .iter()
            .zip(&member_of)
            .flat_map(|(episode, &member)| times_s(std::slice::from_ref(episode), periods_s[member]));
        let mean_time_s = mean_time_s(times);
        let all = Self::from_episodes(episodes, round, &pool.rules(0), seed);
        let scenarios = members.into_iter().map(|(name, of)| ScenarioResult {
            name,
            success_rate: of.success_rate,
            success_interval: of.success_interval,
            collision_rate: of.collision_rate,
            timeout_rate: of.timeout_rate,
            mean_time_s: of.mean_time_s,
            episodes: of.episodes,
        });
        Self { scenarios: scenarios.collect(), mean_time_s, mean_cost_s, ..all }
    }
}

/// The simulated time of each successful episode, in s.
pub fn times_s(episodes: &[EpisodeResult], control_period_s: f32) -> impl Iterator<Item = f64> {
    episodes
        .iter()
        .filter(|episode| episode.succeeded())
        .map(move |episode| round_to_millionth(f64::from(episode.steps) * period_s(control_period_s)))
}

fn mean_time_s(times_s: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = times_s.fold((0_u32, 0.0), |(n, sum), t| (n + 1, sum + t));
    (count > 0).then(|| round_to_millionth(sum / f64::from(count)))
}

fn mean_cost_s(episodes: &[EpisodeResult], rules: &TaskRules) -> f64 {
    let steps = |episode: &EpisodeResult| {
        if episode.succeeded() { episode.steps } else { rules.max_episode_steps }
    };
    let sum: u64 = episodes.iter().map(|episode| u64::from(steps(episode))).sum();
    round_to_millionth(sum as f64 / episodes.len() as f64 * period_s(rules.control_period_s))
}

/// The control period in s, without the rounding error of `f32`: 0.2, not 0.200000003.
#[must_use]
pub fn period_s(control_period_s: f32) -> f64 {
    round_to_millionth(f64::from(control_period_s))
}

/// `value`, rounded to a millionth, which removes the rounding errors of sums.
#[must_use]
pub fn round_to_millionth(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Scenario, ScenarioSet, SetMember, SetSource};

    #[test]
    fn each_episode_over_a_set_is_timed_with_the_control_period_of_its_scenario() {
        let member = |(name, control_period_s): (&str, f32)| {
            let task = TaskRules { control_period_s, ..TaskRules::default() };
            let scenario = Scenario { task, ..Scenario::default() };
            SetMember { name: name.into(), share: 1.0, source: SetSource::Scenario(Box::new(scenario)) }
        };
        let members = [("slow", 0.5), ("fast", 0.2)].map(member).into();
        let pool = ScenarioPool::new(&ScenarioSet { name: "set".into(), members });
        let episode = EpisodeResult {
            end: EpisodeEnd::Reached,
            steps: 10,
            start: Pose::default(),
            goal: Goal::default(),
            clock: Clock::default(),
            layout_seed: 0,
            path: None,
        };
        let evaluation = Evaluation::over_pool(&[episode; 2], 2, &pool, 0);
        assert_eq!((evaluation.mean_time_s, evaluation.mean_cost_s), (Some(3.5), 3.5));
        let times: Vec<Option<f64>> = evaluation.scenarios.iter().map(|of| of.mean_time_s).collect();
        assert_eq!(times, [Some(5.0), Some(2.0)]);
    }
}
