//! The finished tests of a suite, in a file, so that an interrupted suite continues where it stopped.
//!
//! Each line is one test, as RON. A line that is incomplete because the process was killed is dropped, and its test is
//! repeated. The key of a test contains everything that its result depends on except plugins, so any later suite with the same
//! folder can use the result. Tests with plugins are not stored.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::test::PlannerReferences;
use crate::policy::Policy;
use crate::policy::card::RawJson;
use crate::run::RunError;
use crate::run::evaluate::{EpisodeResult, Evaluated};
use crate::run::output_file::replace;
use crate::run::provenance::{COMMIT, VERSION, scenario_json};
use crate::scenario::Scenario;

/// The finished tests of a folder.
#[derive(Debug)]
pub struct TestStore {
    path: PathBuf,
    finished: BTreeMap<String, StoredTest>,
    file: Mutex<File>,
}

/// The result of a test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StoredTest {
    /// The episodes.
    pub episodes: Vec<EpisodeResult>,
    /// What the planner knows about them.
    pub references: PlannerReferences,
}

impl TestStore {
    /// The tests in the file at `path`, which is created if it does not exist.
    ///
    /// # Errors
    /// The file cannot be read or written.
    pub fn open(path: &Path) -> Result<Self, RunError> {
        let unwritable = |error: std::io::Error| RunError::not_written(path, error);
        let unreadable =
            |error: std::io::Error| RunError::failed(path, format_args!("can't be read: {error}"));
        let bytes = if path.exists() { fs::read(path).map_err(unreadable)? } else { Vec::new() };
        let text = String::from_utf8_lossy(&bytes);
        let complete: Vec<(&str, (String, StoredTest))> =
            text.lines().filter_map(|line| Some((line, ron::from_str(line).ok()?))).collect();
        replace(path, |file| complete.iter().try_for_each(|(line, _)| writeln!(file, "{line}")))
            .map_err(unwritable)?;
        let file = File::options().append(true).open(path).map_err(unwritable)?;
        let finished = complete.into_iter().map(|(_, test)| test).collect();
        Ok(Self { path: path.into(), finished, file: Mutex::new(file) })
    }

    /// The result of the test `key`, if the file contained it when it was opened.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&StoredTest> {
        self.finished.get(key)
    }

    /// Adds the result of the test `key`.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&self, key: &str, test: &StoredTest) -> Result<(), RunError> {
        let unwritable = |error: &dyn std::fmt::Display| RunError::not_written(&self.path, error);
        let line = ron::to_string(&(key, test)).map_err(|error| unwritable(&error))? + "\n";
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.write_all(line.as_bytes()).and_then(|()| file.flush()).map_err(|error| unwritable(&error))
    }
}

/// The part of a test's [key] that identifies the driver. For a policy, it is the checksum of the whole file, because the card in
/// the file also says how the policy observes and acts.
///
/// # Errors
/// None is known: every driver that can be evaluated can be written.
pub fn driver_key(evaluated: Evaluated<'_>) -> Result<String, RunError> {
    let crc_of = |policy: &Policy| match policy.to_bytes() {
        Ok(bytes) => Ok(format!("{:08x}", crc32c::crc32c(&bytes))),
        Err(error) => Err(RunError::Failed(error.to_string())),
    };
    Ok(match evaluated {
        Evaluated::Policy(policy) => format!("policy {}", crc_of(policy)?),
        Evaluated::PolicyWithMap(policy) => format!("policy {} with map", crc_of(&policy.policy)?),
        Evaluated::Driver(driver) => {
            let json = serde_json::to_string(driver).and_then(RawJson::new);
            let json = json.map_err(|error| RunError::Failed(error.to_string()))?;
            format!("{} {}", driver.name(), json.crc32c())
        }
    })
}

/// The key of a test without plugins, from all that its result depends on: the program, the driver ([`driver_key`]), the scenario
/// and the test's `options`. The program is identified by its version and commit, so builds of one commit with different
/// uncommitted changes share keys.
///
/// # Errors
/// None is known: the scenario can always be written as JSON.
pub fn key(driver: &str, scenario: &Scenario, options: &str) -> Result<String, RunError> {
    let failed = |error: serde_json::Error| RunError::Failed(error.to_string());
    let (name, crc) = (&scenario.name, scenario_json(scenario).map_err(failed)?.crc32c());
    Ok(format!("{VERSION} {}; {driver}; {name} {crc}; {options}", COMMIT.unwrap_or("")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::evaluate::PathMeasures;
    use crate::scenario::Solid;
    use crate::task::{Clock, EpisodeEnd, Goal, Pose};

    #[test]
    fn finished_tests_are_read_back_bit_for_bit_and_an_incomplete_line_is_dropped() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("tests.ron");
        let episode = EpisodeResult {
            end: EpisodeEnd::Collided,
            steps: 17,
            start: Pose { x_m: 0.1, y_m: -1.0 / 3.0, heading_rad: 2.5 },
            goal: Goal { x_m: 1.0, y_m: 2.0 },
            clock: Clock(99_999),
            layout_seed: u64::MAX,
            path: Some(PathMeasures {
                length_m: 0.1 + 0.2,
                min_clearance_m: 1e-7,
                hit: Some(Solid::Wall(3)),
            }),
        };
        let references = PlannerReferences { shortest_paths_m: vec![2.0_f64.sqrt()], bounds: None };
        let test = StoredTest { episodes: vec![episode], references };
        let store = TestStore::open(&path).expect("a new file");
        store.add("a", &test).expect("written");
        store.add("b", &test).expect("written");
        let text = fs::read_to_string(&path).expect("text");
        fs::write(&path, &text[..text.len() - 9]).expect("written");
        let store = TestStore::open(&path).expect("the file");
        assert_eq!((store.get("a"), store.get("b")), (Some(&test), None));
        store.add("b", &test).expect("written");
        assert_eq!(TestStore::open(&path).expect("the file").get("b"), Some(&test));
    }
}
