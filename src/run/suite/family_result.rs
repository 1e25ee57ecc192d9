//! The results of a driver in a family.

use serde::Serialize;

use super::{Family, SuiteEpisodes};
use crate::import::stated_path_length_m;
use crate::report::rate::rate_interval;
use crate::run::evaluate::{EpisodeResult, OptimumComparison, period_s, round_to_millionth, times_s};
use crate::scenario::{Scenario, SuiteScore};
use crate::task::EpisodeEnd;

/// The results of a driver in a family.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FamilyResult {
    /// Number of scenarios.
    pub scenarios: usize,
    /// Number of episodes in all of them.
    pub episodes: usize,
    /// Fraction of episodes that succeeded, 0 to 1.
    pub success_rate: f64,
    /// The 95 % confidence interval of the success rate (Wilson's), within 0 to 1.
    pub success_interval: [f64; 2],
    /// The success rate of each round: in the first episodes of all scenarios, in the second ones, and so on.
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
    /// Mean success weighted by path length, 0 to 1.
    pub spl: f64,
    /// Mean success rate in the tenth of the scenarios (at least one) where it is lowest, 0 to 1.
    pub worst_tenth: f64,
    /// The mean score of the BARN Challenge, 0 to 0.5, if the family has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub barn_score: Option<f64>,
    /// Time of the successful episodes divided by the time of the planner's paths, over the episodes for which the planner found
    /// one; `None` if it found none or was not asked.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_ratio: Option<f64>,
    /// Number of episodes in that comparison; 0 if the planner was not asked.
    pub optimum_episodes: usize,
}

impl FamilyResult {
    /// The results in `family`, from the episodes in each of its scenarios.
    #[must_use]
    pub fn new(family: &Family, results: &[SuiteEpisodes]) -> Self {
        let all = || results.iter().flat_map(|result| &result.episodes);
        let episodes = all().count();
        let count = |end: EpisodeEnd| all().filter(|episode| episode.end == end).count();
        let rate = |end| fraction(count(end), episodes);
        let interval = |end| rate_interval(count(end), episodes);
        let times: Vec<f64> = results
            .iter()
            .flat_map(|result| times_s(&result.episodes, result.scenario.task.control_period_s))
            .collect();
        let (time_ratio, optimum_episodes) = time_ratio(results);
        Self {
            scenarios: results.len(),
            episodes,
            success_rate: rate(EpisodeEnd::Reached),
            success_interval: interval(EpisodeEnd::Reached),
            rounds: rounds(results),
            collision_rate: rate(EpisodeEnd::Collided),
            collision_interval: interval(EpisodeEnd::Collided),
            timeout_rate: rate(EpisodeEnd::TimedOut),
            timeout_interval: interval(EpisodeEnd::TimedOut),
            mean_time_s: (!times.is_empty()).then(|| mean(&times)),
            spl: mean_over(results, |_, episode, shortest_m| episode.spl(shortest_m).unwrap_or(0.0)),
            worst_tenth: worst_tenth(results),
            barn_score: family.score.map(|SuiteScore::Barn| mean_over(results, barn_score)),
            time_ratio,
            optimum_episodes,
        }
    }
}

fn fraction(count: usize, of: usize) -> f64 {
    count as f64 / of.max(1) as f64
}

fn mean(values: &[f64]) -> f64 {
    round_to_millionth(values.iter().sum::<f64>() / values.len().max(1) as f64)
}

/// The mean of `value` over all episodes. `value` gets the scenario, the episode and the length of the shortest path in m.
fn mean_over(results: &[SuiteEpisodes], value: impl Fn(&Scenario, &EpisodeResult, f64) -> f64) -> f64 {
    let values = results.iter().flat_map(|result| {
        let episodes = result.episodes.iter().zip(&result.references.shortest_paths_m);
        episodes.map(|(episode, shortest_m)| value(&result.scenario, episode, *shortest_m))
    });
    mean(&values.collect::<Vec<f64>>())
}

fn success_rate(episodes: &[EpisodeResult]) -> f64 {
    fraction(episodes.iter().filter(|episode| episode.succeeded()).count(), episodes.len())
}

fn rounds(results: &[SuiteEpisodes]) -> Vec<f64> {
    let longest = results.iter().map(|result| result.episodes.len()).max().unwrap_or(0);
    let round = |k: usize| {
        let episodes: Vec<EpisodeResult> =
            results.iter().filter_map(|result| result.episodes.get(k).copied()).collect();
        success_rate(&episodes)
    };
    (0..longest).map(round).collect()
}

fn worst_tenth(results: &[SuiteEpisodes]) -> f64 {
    let mut rates: Vec<f64> = results.iter().map(|result| success_rate(&result.episodes)).collect();
    rates.sort_by(f64::total_cmp);
    rates.truncate(rates.len().div_ceil(10));
    mean(&rates)
}

/// The score of an episode as in the BARN Challenge's `run.py`: 0 after a failure, otherwise T / clip(time, 2 T, 8 T), where T
/// is the time for the shortest path at the robot's top speed.
fn barn_score(scenario: &Scenario, episode: &EpisodeResult, shortest_m: f64) -> f64 {
    let top_speed_m_s = scenario.robot.motions.iter().map(|motion| motion.v_m_s.abs()).fold(0.0, f32::max);
    let length_m = stated_path_length_m(&scenario.about).unwrap_or(shortest_m);
    let optimal_s = length_m / f64::from(top_speed_m_s);
    // A path without length, or a robot that can only turn, scores 0.
    if !episode.succeeded() || !optimal_s.is_finite() || optimal_s <= 0.0 {
        return 0.0;
    }
    let time_s = f64::from(episode.steps) * period_s(scenario.task.control_period_s);
    optimal_s / time_s.clamp(2.0 * optimal_s, 8.0 * optimal_s)
}

/// The time of the successful episodes divided by the time of the planner's paths, and the number of compared episodes.
fn time_ratio(results: &[SuiteEpisodes]) -> (Option<f64>, usize) {
    let (mut actual_s, mut planned_s, mut episodes) = (0.0, 0.0, 0);
    for result in results {
        let bounds = result.references.bounds.as_deref().unwrap_or_default();
        if let Some(found) = OptimumComparison::from_episodes(&result.episodes, bounds, &result.scenario.task)
        {
            let of_planned_s = found.optimum_mean_time_s * found.episodes as f64;
            actual_s += of_planned_s * found.time_ratio;
            planned_s += of_planned_s;
            episodes += found.episodes;
        }
    }
    ((episodes > 0).then(|| actual_s / planned_s), episodes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Motion;
    use crate::task::{Clock, Goal, Pose};

    #[test]
    fn the_barn_score_is_at_most_half_and_zero_without_a_path_or_a_speed() {
        let score = |top_speed_m_s: f32, shortest_m: f64, end: EpisodeEnd| {
            let mut scenario = Scenario::default();
            scenario.robot.motions = vec![Motion { v_m_s: top_speed_m_s, w_rad_s: 1.0 }];
            let episode = EpisodeResult {
                end,
                steps: 100, // 20 s
                start: Pose { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 },
                goal: Goal { x_m: 0.0, y_m: 0.0 },
                clock: Clock(0),
                layout_seed: 0,
                path: None,
            };
            barn_score(&scenario, &episode, shortest_m)
        };
        // The optimal time is 5 s, so 20 s are within 2 to 8 times that.
        assert!((score(2.0, 10.0, EpisodeEnd::Reached) - 0.25).abs() < 1e-6);
        assert_eq!(score(2.0, 10.0, EpisodeEnd::Collided), 0.0);
        assert_eq!(score(0.25, 10.0, EpisodeEnd::Reached), 0.5, "faster than twice the optimal time");
        assert_eq!(score(0.0, 10.0, EpisodeEnd::Reached), 0.0, "it can only turn");
        assert_eq!(score(0.0, 0.0, EpisodeEnd::Reached), 0.0);
        assert_eq!(score(2.0, 0.0, EpisodeEnd::Reached), 0.0);
    }
}
