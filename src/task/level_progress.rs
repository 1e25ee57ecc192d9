//! Level sampling by learning progress: levels that are solved only sometimes are drawn more often in training.
//!
//! In: the ends of episodes. Out: [`LevelProgress`], the results in each level of a [`ScenarioPool`], by which the pool draws.
//! Evaluations draw without it.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Arena, ArenaScenario, Episode, EpisodeEnd, ScenarioPool, StepOutcomes, TaskMode};
use crate::learning::sum_tree::SumTree;
use crate::random::{self, Stream};

/// The maximum number of results of a level. They are halved when there are more.
const MAX_RESULTS: f32 = 64.0;

/// The sampling of levels in training, from a generator or from each generator of a set. Evaluations and the shares of a set's
/// entries do not depend on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum LevelSampling {
    /// Every level has the same probability.
    #[default]
    Uniform,
    /// The probability of a level is proportional to p (1 - p), where p = (goals + 1) / (goals + failures + 2) is its estimated
    /// success rate; failures are collisions and time-outs. Levels that are always or never solved are rarely drawn; one
    /// without an episode has p = 1/2. (Sampling for learnability, Rutherford et al. 2024.)
    ByProgress {
        /// The fraction of draws that are uniform, 0 to 1.
        #[serde(default = "default_uniform")]
        uniform: f32,
    },
}

fn default_uniform() -> f32 {
    0.3
}

/// The results in a level: the goals reached, and the collisions and time-outs. When there are more than 64, both are halved, so
/// that newer results count more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LevelResults {
    goals: f32,
    failures: f32,
}

impl LevelResults {
    /// p (1 - p), where p is the estimated success rate: the posterior mean after these results, with a uniform prior.
    fn weight(self) -> f64 {
        let [goals, failures] = [self.goals, self.failures].map(|count| f64::from(count) + 1.0);
        goals * failures / (goals + failures).powi(2)
    }

    fn add(&mut self, goals: u32, failed: bool) {
        self.goals += goals as f32;
        self.failures += f32::from(u8::from(failed));
        while self.goals + self.failures > MAX_RESULTS {
            self.goals /= 2.0;
            self.failures /= 2.0;
        }
    }

    fn is_valid(self) -> bool {
        self.goals >= 0.0 && self.failures >= 0.0 && self.goals + self.failures <= MAX_RESULTS
    }
}

/// The results in the levels of a pool's member, and the levels' weights.
#[derive(Clone, Debug)]
struct Member {
    results: Vec<LevelResults>,
    weights: SumTree,
}

impl Member {
    fn new(results: Vec<LevelResults>) -> Self {
        let mut weights = SumTree::new(results.len());
        weights.set_all(results.iter().map(|results| results.weight()));
        Self { results, weights }
    }
}

/// The results of training in each level, by which the [`ScenarioPool`] draws levels. Without this resource, it draws them
/// uniformly.
#[derive(Resource, Clone, Debug)]
pub struct LevelProgress {
    uniform: f32,
    /// One per member of the pool; a member that is a scenario has no levels.
    members: Vec<Member>,
}

impl LevelProgress {
    /// Empty results for the levels of `pool`; `None` if `sampling` does not need results.
    #[must_use]
    pub(crate) fn new(sampling: LevelSampling, pool: &ScenarioPool) -> Option<Self> {
        let LevelSampling::ByProgress { uniform } = sampling else { return None };
        let empty = |levels| Member::new(vec![LevelResults::default(); levels]);
        Some(Self { uniform, members: pool.training_level_counts().map(empty).collect() })
    }

    /// The results by member and level.
    #[must_use]
    pub(crate) fn results(&self) -> Vec<Vec<LevelResults>> {
        self.members.iter().map(|member| member.results.clone()).collect()
    }

    /// Replaces the results with those that [`results`](Self::results) returned earlier. They must [`fit`](Self::fit).
    pub(crate) fn restore(&mut self, results: &[Vec<LevelResults>]) {
        self.members = results.iter().cloned().map(Member::new).collect();
    }

    /// Whether a training run with these levels can produce `results`.
    #[must_use]
    pub(crate) fn fit(&self, results: &[Vec<LevelResults>]) -> bool {
        let lengths = self.members.iter().map(|member| member.results.len());
        lengths.eq(results.iter().map(Vec::len)) && results.iter().flatten().all(|results| results.is_valid())
    }

    /// Draws a level of `member`, which must have levels.
    pub(super) fn draw(&self, member: usize, stream: &mut Stream) -> u64 {
        let Member { results, weights } = &self.members[member];
        if random::uniform_01(stream) < self.uniform {
            return random::uniform_index(stream, results.len()) as u64;
        }
        weights.find(weights.total() * random::uniform_f64(stream)) as u64
    }

    /// Adds the result of an episode in a level.
    fn add(&mut self, member: usize, level: u64, goals: u32, failed: bool) {
        let Some(Member { results, weights }) = self.members.get_mut(member) else { return };
        let Some(results) = results.get_mut(level as usize) else { return };
        results.add(goals, failed);
        weights.set(level as usize, results.weight());
    }
}

/// `Reset`: adds the results of the episodes that ended in this step.
pub(super) fn record(
    progress: Option<ResMut<LevelProgress>>,
    mode: Res<TaskMode>,
    outcomes: Res<StepOutcomes>,
    arenas: Query<(&Arena, &ArenaScenario, &Episode)>,
) {
    let Some(mut progress) = progress else { return };
    let ended = |(arena, scenario, episode): (&Arena, &ArenaScenario, &Episode)| {
        let end = outcomes.0[arena.0].episode_end(*mode)?;
        Some((arena.0, scenario.choice, episode.goals, end))
    };
    let mut ended: Vec<_> = arenas.iter().filter_map(ended).collect();
    // Halving makes the order matter.
    ended.sort_by_key(|&(arena, ..)| arena);
    for (_, choice, goals, end) in ended {
        progress.add(choice.member as usize, choice.level, goals, end != EpisodeEnd::Reached);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::folder::RunConfig;
    use crate::run::{shipped, training_setup};
    use crate::scenario::{LevelGenerator, Scenario, ScenarioSet, SetMember, SetSource};
    use crate::task::{EpisodeEnded, ScenarioChoice};

    /// A scenario and a generator with this number of levels, all with short episodes.
    fn set(levels: u32) -> ScenarioSet {
        let generator = "(name: \"Posts\", clutter: [Scatter(count: (2, 6), shapes: [Circle(radius_m: (0.1, 0.2))])], \
                         task: (max_episode_steps: 30))";
        let generator = Box::new(LevelGenerator::parse(generator, "posts.ron").expect("a valid generator"));
        let mut scenario = Scenario::default();
        scenario.task.max_episode_steps = 30;
        let member = |source| SetMember { name: "member".into(), share: 1.0, source };
        let sources = [SetSource::Scenario(Box::new(scenario)), SetSource::Levels { generator, levels }];
        ScenarioSet { name: "set".into(), members: sources.map(member).into() }
    }

    fn progress(uniform: f32, levels: u32) -> LevelProgress {
        let pool = ScenarioPool::new(&set(levels));
        LevelProgress::new(LevelSampling::ByProgress { uniform }, &pool).expect("by progress")
    }

    #[test]
    fn every_training_episode_counts_in_the_level_in_which_it_took_place() {
        let mut preset = shipped::preset("fast").expect("a shipped preset");
        preset.levels = LevelSampling::ByProgress { uniform: 0.3 };
        let scenario_set = Some(set(3));
        let config = RunConfig::new(("set".into(), Scenario::default()), ("fast".into(), preset), 7);
        let config = RunConfig { scenario_set, ..config };
        let learner = training_setup::create_learner(&config, None).expect("a learner");
        let (scenario, plugins) = (config.scenario.clone().into(), config.simulation_plugins());
        let mut simulation = training_setup::training(&scenario, &config.preset, 7, learner, &plugins);
        let mut expected = simulation.world().resource::<LevelProgress>().clone();
        let mut choices = vec![ScenarioChoice::default(); config.preset.arenas];
        let mut episodes = 0;
        for _ in 0..400 {
            let world = simulation.world_mut();
            let mut arenas = world.query::<(&Arena, &ArenaScenario)>();
            arenas.iter(world).for_each(|(arena, scenario)| choices[arena.0] = scenario.choice);
            simulation.step().expect("no fault");
            for ended in simulation.world_mut().resource_mut::<Messages<EpisodeEnded>>().drain() {
                let ScenarioChoice { member, level } = choices[ended.arena];
                expected.add(member as usize, level, ended.goals, ended.end != EpisodeEnd::Reached);
                episodes += member;
            }
        }
        assert!(episodes > 20, "{episodes} episodes in levels");
        assert_eq!(simulation.world().resource::<LevelProgress>().results(), expected.results());
    }

    /// The number of times that each level of member 1 is drawn.
    fn counts(progress: &LevelProgress, levels: usize, draws: usize) -> Vec<usize> {
        let (mut counts, mut stream) = (vec![0; levels], random::stream(3, "test", 0));
        (0..draws).for_each(|_| counts[progress.draw(1, &mut stream) as usize] += 1);
        counts
    }

    #[test]
    fn the_weight_of_a_level_is_p_times_1_minus_p_of_its_estimated_success() {
        let mut progress = progress(0.0, 4);
        progress.add(1, 1, 2, true);
        progress.add(1, 2, 0, true);
        progress.add(1, 2, 0, true);
        progress.add(1, 3, 8, false);
        let weights = &progress.members[1].weights;
        // p = 1/2 without an episode; (2 + 1) / (2 + 1 + 2); (0 + 1) / (0 + 2 + 2); (8 + 1) / (8 + 0 + 2).
        for (level, expected) in [0.25, 0.6 * 0.4, 0.25 * 0.75, 0.9 * 0.1].into_iter().enumerate() {
            assert!((weights.get(level) - expected).abs() < 1e-12, "level {level}: {}", weights.get(level));
        }
    }

    #[test]
    fn the_given_fraction_of_draws_is_uniform_and_the_rest_in_proportion_to_the_weights() {
        // The weights are 0.25 for a level without an episode, and 0.09 for one with p = (17 + 1) / (17 + 1 + 2).
        let mut progress = progress(0.4, 2);
        progress.add(1, 1, 17, true);
        let (draws, found) = (20_000, counts(&progress, 2, 20_000));
        let probability = 0.6 * 0.09 / 0.34 + 0.4 / 2.0;
        let expected = (draws as f64 * probability) as usize;
        // Four standard deviations of a binomial distribution are below 280.
        assert!(found[1].abs_diff(expected) < 280, "{found:?}, not {expected}");
        let uniform = counts(&self::progress(1.0, 2), 2, 20_000);
        assert!(uniform[1].abs_diff(10_000) < 290, "{uniform:?}");
    }

    #[test]
    fn a_level_that_is_always_or_never_solved_is_drawn_less_and_less() {
        let mut progress = progress(0.0, 3);
        let mut before = [1.0, 1.0];
        for _ in 0..20 {
            progress.add(1, 0, 3, false);
            progress.add(1, 1, 0, true);
            progress.add(1, 2, 1, true);
            let now = [0, 1].map(|level| progress.members[1].weights.get(level));
            assert!(now[1] < before[1] && now[0] < before[0], "{now:?} after {before:?}");
            before = now;
        }
        let found = counts(&progress, 3, 1_000);
        assert!(found[2] > 700, "{found:?}");
    }

    #[test]
    fn newer_results_count_more() {
        let mut results = LevelResults::default();
        (0..64).for_each(|_| results.add(0, true));
        (0..64).for_each(|_| results.add(1, false));
        assert!(results.goals > 2.0 * results.failures && results.is_valid(), "{results:?}");
    }

    #[test]
    fn results_that_no_training_run_can_produce_are_recognized() {
        let progress = progress(0.3, 3);
        let valid = progress.results();
        assert!(progress.fit(&valid) && valid.iter().map(Vec::len).eq([0, 3]));
        let changes: [fn(&mut Vec<Vec<LevelResults>>); 5] = [
            |results| results[1][2].goals = -1.0,
            |results| results[1][0].failures = f32::NAN,
            |results| results[1][0].goals = 65.0,
            |results| results[1].truncate(2),
            |results| results.truncate(1),
        ];
        for (number, change) in changes.into_iter().enumerate() {
            let mut results = valid.clone();
            change(&mut results);
            assert!(!progress.fit(&results), "change {number}");
        }
    }
}
