//! The test of drivers in a suite, on all cores.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use serde::{Deserialize, Serialize};

use super::store::{self, StoredTest, TestStore};
use super::{Family, Suite, SuiteScenario};
use crate::planner::StepBounds;
use crate::run::evaluate::{self, EpisodeResult, Evaluated, Evaluator};
use crate::run::{RunError, on_all_cores};
use crate::scenario::Scenario;
use crate::simulation::Extensions;
use crate::task::EpisodeSetup;

/// A driver or policy under test.
#[derive(Clone, Debug)]
pub struct SuiteDriver<'a> {
    /// Its file or shipped name.
    pub name: String,
    /// The driver or policy.
    pub evaluated: Evaluated<'a>,
}

/// A test of drivers, which all get the same starts and goals. Episode j of a scenario depends only on the driver, the scenario,
/// the seed and j.
pub struct SuiteTest<'a> {
    /// The suite.
    pub suite: &'a Suite,
    /// The seed of the episodes' starts and goals.
    pub seed: u64,
    /// Whether the planner finds bounds on the optimal time of each episode.
    pub optimum: bool,
    /// The plugins that policies were trained with.
    pub extensions: &'a Extensions,
    /// The number of threads (0: one per core). It changes no result.
    pub threads: usize,
    /// Set from outside to stop the test.
    pub stop: Option<&'a AtomicBool>,
    /// Where finished tests are stored and looked up. Not used if there are plugins, because the key of a test does not
    /// identify them.
    pub store: Option<&'a TestStore>,
    /// Called with the number of finished pairs of a driver and a scenario, and the number of all pairs.
    pub progress: &'a (dyn Fn(usize, usize) + Sync),
}

/// The episodes of a driver in a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct SuiteEpisodes {
    /// The scenario.
    pub scenario: Arc<Scenario>,
    /// The episodes.
    pub episodes: Vec<EpisodeResult>,
    /// What the planner knows about them, which is the same for all drivers.
    pub references: Arc<PlannerReferences>,
}

/// What the planner knows about the episodes in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannerReferences {
    /// The length of the shortest path of each episode, in m.
    pub shortest_paths_m: Vec<f64>,
    /// The bounds on the optimal time of each episode, if wanted.
    pub bounds: Option<Vec<StepBounds>>,
}

/// The simulation that a thread used last, with its scenario, kept for the next driver.
struct Kept {
    index: usize,
    scenario: Arc<Scenario>,
    /// Made when it is needed.
    evaluator: Option<Evaluator>,
}

/// The choice of starts and goals in `scenario`, which belongs to `family`.
#[must_use]
pub fn episode_setup(family: &Family, scenario: &Scenario) -> EpisodeSetup {
    let route = scenario.benchmark_route.filter(|_| family.benchmark_route);
    route.map_or(EpisodeSetup::Random, EpisodeSetup::Route)
}

impl SuiteTest<'_> {
    /// Tests `drivers`. Returns the episodes of each driver in each scenario ([`Suite::scenarios`]).
    ///
    /// # Errors
    /// A driver is a policy that does not fit a scenario, a level cannot be made, a scenario has no free space for a start, a
    /// finished test cannot be stored, or the test was stopped.
    pub fn run(&self, drivers: &[SuiteDriver<'_>]) -> Result<Vec<Vec<SuiteEpisodes>>, RunError> {
        let scenarios: Vec<(&Family, &SuiteScenario)> = self.suite.scenarios().collect();
        let references: Vec<OnceLock<Arc<PlannerReferences>>> =
            scenarios.iter().map(|_| OnceLock::new()).collect();
        let keys = || drivers.iter().map(|driver| store::driver_key(driver.evaluated)).collect();
        let store = self.used_store();
        let keys: Option<Vec<String>> = store.map(|_| keys()).transpose()?;
        let (done, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
        let count = scenarios.len() * drivers.len();
        let results = on_all_cores::map(
            count,
            self.threads,
            || None,
            |kept: &mut Option<Kept>, job| {
                // Scenario by scenario, so that a thread can keep its simulation.
                let (index, driver) = (job / drivers.len(), job % drivers.len());
                if failed.load(Ordering::Relaxed) {
                    return Ok(None);
                }
                let (family, scenario) = scenarios[index];
                let stored = store.zip(keys.as_ref().map(|keys| keys[driver].as_str()));
                let result = kept_of(kept, index, scenario)
                    .and_then(|kept| self.tested(kept, family, &drivers[driver], stored, &references[index]));
                failed.fetch_or(result.is_err(), Ordering::Relaxed);
                (self.progress)(done.fetch_add(1, Ordering::Relaxed) + 1, count);
                result.map(Some)
            },
        );
        let mut found: Vec<Vec<SuiteEpisodes>> = drivers.iter().map(|_| Vec::new()).collect();
        for (job, result) in results.into_iter().enumerate() {
            found[job % drivers.len()].extend(result?);
        }
        Ok(found)
    }

    /// The episodes of `driver` in the scenario of `kept`: those of an earlier, equal test, or new ones. `stored` has the
    /// finished tests, and the driver's part of their keys.
    fn tested(
        &self,
        kept: &mut Kept,
        family: &Family,
        driver: &SuiteDriver<'_>,
        stored: Option<(&TestStore, &str)>,
        references: &OnceLock<Arc<PlannerReferences>>,
    ) -> Result<SuiteEpisodes, RunError> {
        let Some((store, driver_key)) = stored else {
            return self.episodes(kept, family, driver, references);
        };
        let Family { episodes, benchmark_route, .. } = family;
        let options = format!(
            "seed {}, {episodes} episodes, route {benchmark_route}, optimum {}",
            self.seed, self.optimum
        );
        let key = store::key(driver_key, &kept.scenario, &options)?;
        if let Some(StoredTest { episodes, references }) = store.get(&key).cloned() {
            let scenario = kept.scenario.clone();
            return Ok(SuiteEpisodes { scenario, episodes, references: Arc::new(references) });
        }
        let found = self.episodes(kept, family, driver, references)?;
        let test = StoredTest { episodes: found.episodes.clone(), references: (*found.references).clone() };
        store.add(&key, &test)?;
        Ok(found)
    }

    /// New episodes of `driver` in the scenario of `kept`.
    fn episodes(
        &self,
        kept: &mut Kept,
        family: &Family,
        driver: &SuiteDriver<'_>,
        references: &OnceLock<Arc<PlannerReferences>>,
    ) -> Result<SuiteEpisodes, RunError> {
        let Kept { scenario, evaluator, .. } = kept;
        let evaluator = evaluator.get_or_insert_with(|| {
            Evaluator::with_extensions(scenario, family.episodes, self.extensions).measuring_paths()
        });
        let setup = episode_setup(family, scenario);
        let mut run = evaluator.start(driver.evaluated, self.seed, family.episodes, setup)?;
        while !evaluator.step(&mut run)? {
            self.check_not_stopped()?;
        }
        let references = references.get_or_init(|| Arc::new(self.plan(scenario, &run.episodes)));
        Ok(SuiteEpisodes {
            scenario: scenario.clone(),
            episodes: run.episodes,
            references: references.clone(),
        })
    }

    /// The store, unless there are plugins.
    fn used_store(&self) -> Option<&TestStore> {
        self.store.filter(|_| self.extensions.is_empty())
    }

    fn plan(&self, scenario: &Scenario, episodes: &[EpisodeResult]) -> PlannerReferences {
        PlannerReferences {
            shortest_paths_m: evaluate::shortest_paths_m(scenario, episodes, 1),
            bounds: self.optimum.then(|| evaluate::bounds(scenario, episodes, 1)),
        }
    }

    /// Checks that the test has not been stopped.
    ///
    /// # Errors
    /// It has been stopped.
    pub fn check_not_stopped(&self) -> Result<(), RunError> {
        match self.stop {
            Some(stop) if stop.load(Ordering::Relaxed) => {
                let rest = if self.used_store().is_some() {
                    "run the same command again to continue"
                } else {
                    "no file was written"
                };
                Err(RunError::Stopped(format!("stopped before the end of the test; {rest}")))
            }
            _ => Ok(()),
        }
    }
}

/// The simulation of scenario `index`: the kept one if it has this index, otherwise a new one, which is then kept.
fn kept_of<'k>(
    kept: &'k mut Option<Kept>,
    index: usize,
    scenario: &SuiteScenario,
) -> Result<&'k mut Kept, RunError> {
    let scenario = match kept.take() {
        Some(old) if old.index == index => return Ok(kept.insert(old)),
        _ => scenario.scenario()?,
    };
    Ok(kept.insert(Kept { index, scenario, evaluator: None }))
}
