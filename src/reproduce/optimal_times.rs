//! The least times of the test's episodes and of the benchmark route, for each world once.
//!
//! In: a scenario and a test's rule. Out: [`OptimalTimes`]: for each navigation and each drive of the benchmark route the planner's
//! plan and a proven lower bound, kept in a folder, since planning among moving obstacles takes its time.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use serde::{Deserialize, Serialize};

use super::experiment::TestRule;
use super::policy_test;
use crate::planner::StepBounds;
use crate::run::RunError;
use crate::run::evaluate::{EpisodeResult, bounds};
use crate::scenario::{Scenario, to_ron};

/// The least times in one world, in the order of the test's episodes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OptimalTimes {
    /// Of the episodes.
    pub episodes: Vec<StepBounds>,
    /// Of the benchmark route's drives.
    pub benchmark_route: Vec<StepBounds>,
}

/// The least times of all worlds.
pub struct OptimalTimesCache {
    folder: PathBuf,
    known: RefCell<BTreeMap<String, Rc<OptimalTimes>>>,
}

impl OptimalTimesCache {
    /// Least times are kept in `folder`.
    #[must_use]
    pub fn new(folder: PathBuf) -> Self {
        Self { folder, known: RefCell::default() }
    }

    /// The least times for the tests by `rule` in `scenario`. The starts and goals are learnt by driving with the
    /// policy in the file `policy` (they are the same for every policy).
    ///
    /// # Errors
    /// The policy cannot be read; the folder cannot be written.
    pub fn for_test(
        &self,
        scenario: &Scenario,
        rule: TestRule,
        policy: &Path,
    ) -> Result<Rc<OptimalTimes>, RunError> {
        let text = to_ron(&(scenario, rule)).map_err(|error| RunError::Failed(error.to_string()))?;
        let name = format!("{:08x}.json", crc32c::crc32c(text.as_bytes()));
        if let Some(known) = self.known.borrow().get(&name) {
            return Ok(known.clone());
        }
        let path = self.folder.join(&name);
        let kept = std::fs::read_to_string(&path).ok().and_then(|text| serde_json::from_str(&text).ok());
        let least = match kept {
            Some(least) => least,
            None => {
                let least = self.plan(scenario, rule, policy)?;
                let failed = |error: std::io::Error| RunError::failed(&path, error);
                std::fs::create_dir_all(&self.folder).map_err(failed)?;
                let text =
                    serde_json::to_string(&least).map_err(|error| RunError::Failed(error.to_string()))?;
                std::fs::write(&path, text).map_err(failed)?;
                least
            }
        };
        let least = Rc::new(least);
        self.known.borrow_mut().insert(name, least.clone());
        Ok(least)
    }

    fn plan(&self, scenario: &Scenario, rule: TestRule, policy: &Path) -> Result<OptimalTimes, RunError> {
        let policy = policy_test::read_policy(policy)?;
        let (episodes, benchmark_route) = policy_test::run_episodes(&policy, scenario, rule)?;
        let plan = |driven: &[EpisodeResult]| bounds(scenario, driven, 0);
        Ok(OptimalTimes { episodes: plan(&episodes), benchmark_route: plan(&benchmark_route) })
    }
}
