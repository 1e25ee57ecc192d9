//! The test of drivers in a suite, on all cores.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

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
    /// What drives.
    pub evaluated: Evaluated<'a>,
}

/// A test of drivers, which all drive the same episodes. Each scenario has its own: episode j of a scenario depends only on the
/// driver, the scenario, the seed and j.
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
    /// Is told the number of tested pairs of a driver and a scenario, and the number of all.
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
    pub references: Arc<References>,
}

/// What the planner knows about the episodes in a scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct References {
    /// The length of the shortest path of each episode, in m.
    pub shortest_paths_m: Vec<f64>,
    /// The bounds on its optimal time, if wanted.
    pub bounds: Option<Vec<StepBounds>>,
}

/// The simulation of the scenario that a thread has worked in last.
struct Kept {
    index: usize,
    scenario: Arc<Scenario>,
    evaluator: Evaluator,
}

impl SuiteTest<'_> {
    /// Tests `drivers`. Returns the episodes of each driver in each scenario ([`Suite::scenarios`]).
    ///
    /// # Errors
    /// A driver is a policy that does not fit a scenario, a level cannot be made, a scenario has no free space for a start, or
    /// the test was stopped.
    pub fn run(&self, drivers: &[SuiteDriver<'_>]) -> Result<Vec<Vec<SuiteEpisodes>>, RunError> {
        let scenarios: Vec<(&Family, &SuiteScenario)> = self.suite.scenarios().collect();
        let references: Vec<OnceLock<Arc<References>>> = scenarios.iter().map(|_| OnceLock::new()).collect();
        let (done, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
        let count = scenarios.len() * drivers.len();
        let results = on_all_cores::map(
            count,
            self.threads,
            || None,
            |kept: &mut Option<Kept>, job| {
                // By scenarios first, so that a thread can keep its simulation.
                let (index, driver) = (job / drivers.len(), job % drivers.len());
                if failed.load(Ordering::Relaxed) {
                    return Ok(None);
                }
                let (family, scenario) = scenarios[index];
                let result = self
                    .kept(kept, index, family, scenario)
                    .and_then(|kept| self.episodes(kept, family, &drivers[driver], &references[index]));
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

    /// The simulation of scenario `index`.
    fn kept<'k>(
        &self,
        kept: &'k mut Option<Kept>,
        index: usize,
        family: &Family,
        scenario: &SuiteScenario,
    ) -> Result<&'k mut Kept, RunError> {
        if kept.as_ref().is_none_or(|kept| kept.index != index) {
            // The old one goes first.
            *kept = None;
            let scenario = scenario.scenario()?;
            let evaluator =
                Evaluator::with_extensions(&scenario, family.episodes, self.extensions).measuring_paths();
            *kept = Some(Kept { index, scenario, evaluator });
        }
        kept.as_mut().ok_or_else(|| RunError::Failed("the simulation is missing".into()))
    }

    /// The episodes of `driver` in the scenario of `kept`.
    fn episodes(
        &self,
        kept: &mut Kept,
        family: &Family,
        driver: &SuiteDriver<'_>,
        references: &OnceLock<Arc<References>>,
    ) -> Result<SuiteEpisodes, RunError> {
        let route = kept.scenario.benchmark_route.filter(|_| family.benchmark_route);
        let setup = route.map_or(EpisodeSetup::Random, EpisodeSetup::Route);
        let mut run = kept.evaluator.start(driver.evaluated, self.seed, family.episodes, setup)?;
        while !kept.evaluator.step(&mut run)? {
            self.check_signals()?;
        }
        let references = references.get_or_init(|| Arc::new(self.plan(&kept.scenario, &run.episodes)));
        Ok(SuiteEpisodes {
            scenario: kept.scenario.clone(),
            episodes: run.episodes,
            references: references.clone(),
        })
    }

    fn plan(&self, scenario: &Scenario, episodes: &[EpisodeResult]) -> References {
        References {
            shortest_paths_m: evaluate::shortest_paths_m(scenario, episodes, 1),
            bounds: self.optimum.then(|| evaluate::bounds(scenario, episodes, 1)),
        }
    }

    fn check_signals(&self) -> Result<(), RunError> {
        match self.stop {
            Some(stop) if stop.load(Ordering::Relaxed) => {
                Err(RunError::Stopped("stopped before the end of the test".into()))
            }
            _ => Ok(()),
        }
    }
}
