//! The least times of the test's navigations and of the course, for each world once.
//!
//! In: a scenario and a test's rule. Out: [`Least`]: for each navigation and each drive of the course the planner's
//! plan and a proven lower bound, kept in a folder, since planning among moving obstacles takes its time.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use serde::{Deserialize, Serialize};

use super::experiment::TestRule;
use super::trial;
use crate::planner::Bounds;
use crate::run::RunError;
use crate::run::evaluate::{Navigation, bounds};
use crate::scenario::{Scenario, to_ron};

/// The least times in one world, in the order of the test's navigations.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Least {
    /// Of the navigations.
    pub navigations: Vec<Bounds>,
    /// Of the course's drives.
    pub course: Vec<Bounds>,
}

/// The least times of all worlds.
pub struct Yardstick {
    folder: PathBuf,
    known: RefCell<BTreeMap<String, Rc<Least>>>,
}

impl Yardstick {
    /// Least times are kept in `folder`.
    #[must_use]
    pub fn new(folder: PathBuf) -> Self {
        Self { folder, known: RefCell::default() }
    }

    /// The least times for the tests by `rule` in `scenario`. The starts and targets are learnt by driving with the
    /// policy in the file `policy` (they are the same for every policy).
    ///
    /// # Errors
    /// The policy cannot be read; the folder cannot be written.
    pub fn of(&self, scenario: &Scenario, rule: TestRule, policy: &Path) -> Result<Rc<Least>, RunError> {
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

    fn plan(&self, scenario: &Scenario, rule: TestRule, policy: &Path) -> Result<Least, RunError> {
        let policy = trial::read_policy(policy)?;
        let (navigations, course) = trial::drive(&policy, scenario, rule)?;
        let plan = |driven: &[Navigation]| bounds(scenario, driven, 0);
        Ok(Least { navigations: plan(&navigations), course: plan(&course) })
    }
}
