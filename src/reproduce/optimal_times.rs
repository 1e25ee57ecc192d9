//! The optimal times of test episodes, computed once per scenario and test.
//!
//! In: a scenario and a [`TestRule`]. Out: [`OptimalTimes`]: the planner's time and a proven lower bound for each
//! episode. They are stored in a folder, because planning among moving obstacles takes a long time.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use serde::{Deserialize, Serialize};

use super::experiment::TestRule;
use super::policy_test;
use super::report_progress::ReportProgress;
use crate::planner::StepBounds;
use crate::run::RunError;
use crate::run::evaluate::bounds;
use crate::run::output_file::replace;
use crate::scenario::{Scenario, to_ron};

/// The number of episodes whose optimal times are computed between two updates of the progress.
const EPISODES_PER_UPDATE: usize = 16;

/// The optimal times in one scenario, in the order of the test's episodes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OptimalTimes {
    /// The optimal times of the random episodes.
    pub episodes: Vec<StepBounds>,
    /// The optimal times of the episodes on the benchmark route.
    pub benchmark_route: Vec<StepBounds>,
}

/// The optimal times of all scenarios, in memory and in a folder.
pub struct OptimalTimesCache {
    folder: PathBuf,
    known: RefCell<BTreeMap<String, Rc<OptimalTimes>>>,
    progress: ReportProgress,
}

impl OptimalTimesCache {
    /// A cache with files in `folder`, which shows in `progress` what it computes.
    pub fn new(folder: PathBuf, progress: ReportProgress) -> Self {
        Self { folder, known: RefCell::default(), progress }
    }

    /// The progress of the report.
    pub fn progress(&self) -> &ReportProgress {
        &self.progress
    }

    /// Reads or computes the optimal times of the test by `rule` in `scenario`. If they are not known, the policy in the file
    /// `policy` is run to find the starts and goals, which are the same for every policy.
    ///
    /// # Errors
    /// The policy cannot be read or does not fit the scenario, no free start was found, or the folder cannot be written.
    pub fn for_test(
        &self,
        scenario: &Scenario,
        rule: TestRule,
        policy: &Path,
    ) -> Result<Rc<OptimalTimes>, RunError> {
        // Another version of wayfield may plan differently.
        let key = (scenario, rule, env!("CARGO_PKG_VERSION"));
        let text = to_ron(&key).map_err(|error| RunError::Failed(error.to_string()))?;
        let name = format!("{:08x}.json", crc32c::crc32c(text.as_bytes()));
        if let Some(known) = self.known.borrow().get(&name) {
            return Ok(known.clone());
        }
        let path = self.folder.join(&name);
        let stored = std::fs::read_to_string(&path).ok().and_then(|text| serde_json::from_str(&text).ok());
        let times = match stored {
            Some(times) => times,
            None => {
                let times = compute(scenario, rule, policy, &self.progress)?;
                self.store(&path, &times)?;
                times
            }
        };
        let times = Rc::new(times);
        self.known.borrow_mut().insert(name, times.clone());
        Ok(times)
    }

    fn store(&self, path: &Path, times: &OptimalTimes) -> Result<(), RunError> {
        let text = serde_json::to_string(times).map_err(|error| RunError::Failed(error.to_string()))?;
        std::fs::create_dir_all(&self.folder)
            .and_then(|()| replace(path, |file| file.write_all(text.as_bytes())))
            .map_err(|error| RunError::not_written(path, error))
    }
}

fn compute(
    scenario: &Scenario,
    rule: TestRule,
    policy: &Path,
    progress: &ReportProgress,
) -> Result<OptimalTimes, RunError> {
    let policy = policy_test::read_policy(policy)?;
    let (episodes, benchmark_route) = policy_test::run_episodes(&policy, scenario, rule)?;
    let (all_cores, all) = (0, episodes.len());
    let mut known = Vec::with_capacity(all);
    for chunk in episodes.chunks(EPISODES_PER_UPDATE) {
        progress.show(&format!("optimal times in {}: {} of {all} episodes", scenario.name, known.len()));
        known.extend(bounds(scenario, chunk, all_cores));
    }
    let benchmark_route = bounds(scenario, &benchmark_route, all_cores);
    Ok(OptimalTimes { episodes: known, benchmark_route })
}
