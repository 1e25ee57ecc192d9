//! Suites: tests of drivers and policies in many scenarios and levels, with results by family.
//!
//! In: the name of a suite, and drivers. Out: the episodes of each driver in each scenario, and the [`FamilyResult`]s.
//!
//! | file | contents |
//! |---|---|
//! | `load.rs` | a suite by name: its file, a folder, a set, a level generator, a scenario |
//! | `test.rs` | the episodes, on all cores |
//! | `store.rs` | the finished tests in a folder, so that an interrupted suite can be resumed |
//! | `family_result.rs` | the results of a family |

mod family_result;
pub mod load;
mod store;
mod test;

use std::sync::Arc;

use super::RunError;
use super::settings::Settings;
use crate::limits::MAX_EVAL_EPISODES;
use crate::scenario::{
    Diagnostic, LevelGenerator, Lidar, Robot, Scenario, SuiteScore, TaskRules, diagnostics,
};

pub use family_result::FamilyResult;
pub use store::TestStore;
pub use test::{PlannerReferences, SuiteDriver, SuiteEpisodes, SuiteTest, episode_setup};

/// Families of scenarios.
#[derive(Clone, Debug, PartialEq)]
pub struct Suite {
    /// Name of the suite.
    pub name: String,
    /// The families, at least one.
    pub families: Vec<Family>,
}

/// Scenarios whose results are reported together.
#[derive(Clone, Debug, PartialEq)]
pub struct Family {
    /// Name of the family.
    pub name: String,
    /// The scenarios, at least one.
    pub scenarios: Vec<SuiteScenario>,
    /// Number of episodes in each scenario.
    pub episodes: usize,
    /// Whether the episodes drive the benchmark route of the scenario.
    pub benchmark_route: bool,
    /// The family's score, if it has one.
    pub score: Option<SuiteScore>,
}

/// A scenario of a suite. If it is a level, it is made when it is needed.
#[derive(Clone, Debug, PartialEq)]
pub struct SuiteScenario {
    /// The file or shipped name, as given after `--scenario`.
    pub name: String,
    source: ScenarioOrLevel,
    rules: FamilyRules,
}

#[derive(Clone, Debug, PartialEq)]
enum ScenarioOrLevel {
    Scenario(Arc<Scenario>),
    Level(Arc<LevelGenerator>, u64),
}

/// What a family changes in its scenarios.
#[derive(Clone, Debug, Default, PartialEq)]
struct FamilyRules {
    time_limit_s: Option<f32>,
    collision_range_m: Option<f32>,
    settings: Settings,
}

impl Suite {
    /// All scenarios, with their families, in the order of the results.
    pub fn scenarios(&self) -> impl Iterator<Item = (&Family, &SuiteScenario)> {
        self.families
            .iter()
            .flat_map(|family| family.scenarios.iter().map(move |scenario| (family, scenario)))
    }

    /// The number of episodes that each driver drives.
    #[must_use]
    pub fn episodes(&self) -> u64 {
        let of = |family: &Family| family.episodes as u64 * family.scenarios.len() as u64;
        self.families.iter().map(of).sum()
    }

    /// Checks the total number of episodes of `drivers` drivers.
    ///
    /// # Errors
    /// There are too many.
    pub fn check_count(&self, drivers: usize) -> Result<(), RunError> {
        let count = self.episodes().saturating_mul(drivers as u64);
        if count <= MAX_EVAL_EPISODES {
            return Ok(());
        }
        Err(RunError::InvalidInput(format!(
            "{count} episodes, {} per driver, are too many; help: give at most {MAX_EVAL_EPISODES} in total, with fewer episodes \
             in each scenario",
            self.episodes()
        )))
    }

    /// The results of a driver by the families' names, from its episodes in each scenario.
    #[must_use]
    pub fn results(&self, episodes: &[SuiteEpisodes]) -> Vec<(String, FamilyResult)> {
        let mut rest = episodes;
        let families = self.families.iter().map(|family| {
            let (own, others) = rest.split_at(family.scenarios.len().min(rest.len()));
            rest = others;
            (family.name.clone(), FamilyResult::new(family, own))
        });
        families.collect()
    }
}

impl SuiteScenario {
    /// The scenario, with the changes of the suite.
    ///
    /// # Errors
    /// The generator has no such level, or the scenario does not allow the changes.
    pub fn scenario(&self) -> Result<Arc<Scenario>, RunError> {
        let invalid = |why: String| RunError::InvalidInput(format!("{}: {why}", self.name));
        let mut scenario = match &self.source {
            ScenarioOrLevel::Scenario(scenario) => scenario.clone(),
            ScenarioOrLevel::Level(generator, seed) => {
                Arc::new(generator.level(*seed).map_err(|error| invalid(error.to_string()))?)
            }
        };
        if self.rules != FamilyRules::default() {
            let scenario = Arc::make_mut(&mut scenario);
            let problems = self.rules.apply(scenario).map_err(|error| invalid(error.to_string()))?;
            if let Some(problem) = problems.first() {
                return Err(invalid(format!("{problem}; help: change the family's rules")));
            }
        }
        Ok(scenario)
    }

    /// Robot, LIDAR and rules, without the changes of the suite. They decide whether a policy can drive in the scenario.
    #[must_use]
    pub fn task(&self) -> (&Robot, &Lidar, &TaskRules) {
        match &self.source {
            ScenarioOrLevel::Scenario(scenario) => (&scenario.robot, &scenario.lidar, &scenario.task),
            ScenarioOrLevel::Level(generator, _) => (&generator.robot, &generator.lidar, &generator.task),
        }
    }
}

impl FamilyRules {
    /// Changes `scenario`. Returns the problems of the result.
    fn apply(&self, scenario: &mut Scenario) -> Result<Vec<Diagnostic>, RunError> {
        // The limits on both numbers keep the steps within u32.
        let steps = |limit_s: f32, period_s: f32| (limit_s / period_s).round().max(1.0) as u32;
        let task = &mut scenario.task;
        if let Some(limit_s) = self.time_limit_s {
            task.max_episode_steps = steps(limit_s, task.control_period_s);
        }
        let steps_before = task.max_episode_steps;
        if let Some(range_m) = self.collision_range_m {
            task.collision_range_m = range_m;
        }
        if self.time_limit_s.is_some() || self.collision_range_m.is_some() {
            let problems = diagnostics(scenario);
            if !problems.is_empty() {
                return Ok(problems);
            }
        }
        self.settings.apply_to_scenario(scenario)?;
        // The time limit in seconds also holds with another control period, unless a setting replaces it.
        match self.time_limit_s {
            Some(limit_s) if scenario.task.max_episode_steps == steps_before => {
                scenario.task.max_episode_steps = steps(limit_s, scenario.task.control_period_s);
                Ok(diagnostics(scenario))
            }
            _ => Ok(Vec::new()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::settings::Setting;

    #[test]
    fn a_time_limit_holds_with_another_control_period_unless_a_setting_replaces_it() {
        let steps = |settings: &[(&str, &str)]| {
            let setting =
                |(path, value): &(&str, &str)| Setting { path: (*path).into(), value: (*value).into() };
            let settings = Settings(settings.iter().map(setting).collect());
            let rules = FamilyRules { time_limit_s: Some(20.0), settings, ..FamilyRules::default() };
            let mut scenario = Scenario::default();
            let problems = rules.apply(&mut scenario).expect("valid settings");
            assert!(problems.is_empty(), "{problems:?}");
            scenario.task.max_episode_steps
        };
        assert_eq!(steps(&[]), 100, "0.2 s each");
        assert_eq!(steps(&[("scenario.task.control_period_s", "0.1")]), 200);
        assert_eq!(steps(&[("scenario.task.max_episode_steps", "70")]), 70);
    }
}
