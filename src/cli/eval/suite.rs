//! The test in a suite: `--eval ... --suite NAME`, and `--scenario` with a set of scenarios or with `--report`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use super::EvalArgs;
use super::files::{TestEnd, TestFile, TestFiles};
use super::print_results;
use super::suite_page::SuiteFolder;
use super::test::Named;
use crate::cli::shared::SharedArgs;
use crate::drivers::DriverClass;
use crate::policy::Policy;
use crate::run::RunError;
use crate::run::evaluate::{self, EpisodeRecord};
use crate::run::progress::{CountProgress, print_stderr};
use crate::run::provenance::{COMMIT, VERSION};
use crate::run::suite::{FamilyResult, Suite, SuiteDriver, SuiteEpisodes, SuiteTest};

/// The results of drivers in a suite: the JSON object that `--eval --suite --json` prints for several drivers.
#[derive(Serialize)]
pub struct SuiteReport<'a> {
    pub suite: &'a str,
    pub version: &'static str,
    pub commit: Option<&'static str>,
    pub physics: &'static str,
    pub episodes: u64,
    pub seed: u64,
    pub policies: Vec<DriverReport>,
}

/// The results of one driver in all families of a suite.
#[derive(Serialize)]
pub struct DriverReport {
    pub policy: String,
    pub class: DriverClass,
    /// `None` for a classical driver.
    pub weights_crc32c: Option<String>,
    /// The results by the families' names, in the order of the suite.
    #[serde(serialize_with = "by_name")]
    pub families: Vec<(String, FamilyResult)>,
}

/// The JSON object for a single driver: its results, and the other fields of [`SuiteReport`].
#[derive(Serialize)]
struct SingleReport<'a> {
    #[serde(flatten)]
    driver: &'a DriverReport,
    suite: &'a str,
    version: &'static str,
    commit: Option<&'static str>,
    physics: &'static str,
    episodes: u64,
    seed: u64,
}

fn by_name<S: Serializer>(families: &[(String, FamilyResult)], serializer: S) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(families.len()))?;
    families.iter().try_for_each(|(name, result)| map.serialize_entry(name, result))?;
    map.end()
}

/// The columns that a suite adds to a row of an episode.
#[derive(Serialize)]
struct SuiteColumns<'a> {
    family: &'a str,
    scenario: &'a str,
}

/// A finished test.
pub struct Tested<'a> {
    pub test: &'a SuiteTest<'a>,
    pub drivers: &'a [SuiteDriver<'a>],
    /// The episodes of each driver in each scenario.
    pub episodes: Vec<Vec<SuiteEpisodes>>,
}

/// Tests `drivers` in the suite `wanted`, and prints the results.
///
/// # Errors
/// The suite or an option is invalid, a policy does not fit a scenario, or a file cannot be written.
pub fn run(
    wanted: &str,
    (paths, drivers): (&[PathBuf], &[Named]),
    args: &EvalArgs,
    shared: &SharedArgs,
    (files, stop): (&TestFiles, Option<&'static AtomicBool>),
) -> Result<(), RunError> {
    check_options(args)?;
    let suite = Suite::load(wanted, &shared.settings(), shared.episodes)?;
    suite.check_count(drivers.len())?;
    for (path, driver) in paths.iter().zip(drivers) {
        check_driver(path, driver, &suite, shared)?;
    }
    let under_test: Vec<SuiteDriver<'_>> = drivers.iter().map(under_test).collect();
    let folder = args.report.as_deref().map(SuiteFolder::open).transpose()?;
    let progress = CountProgress::new(suite.scenarios().count() * drivers.len());
    let test = SuiteTest {
        suite: &suite,
        seed: shared.seed(),
        optimum: args.optimum,
        extensions: &shared.extensions,
        threads: 0,
        stop,
        store: folder.as_ref().map(|folder| &folder.store),
        progress: &|done, count| progress.update(done, count),
    };
    let mut tested = None;
    let written = files.write(|csv, _| {
        let episodes = test.run(&under_test)?;
        let tested = tested.insert(Tested { test: &test, drivers: &under_test, episodes });
        csv.map_or(Ok(()), |csv| tested.write_rows(csv))
    });
    progress.finish();
    let reader_closed = match written {
        Ok(()) => false,
        Err(TestEnd::ReaderClosed) => true,
        Err(TestEnd::Error(error)) => return Err(error),
    };
    let Some(tested) = tested else { return Ok(()) };
    let report = SuiteReport::new(drivers, &tested);
    if let Some(folder) = &folder {
        let page = folder.write(&tested, &report)?;
        print_stderr(&format!("report: {}", page.display()));
    }
    if reader_closed {
        return Ok(());
    }
    let text = || super::text::suite_table(&report);
    match report.policies.as_slice() {
        [one] => print_results(&report.single(one), text, shared.json, files.use_stdout()),
        _ => print_results(&report, text, shared.json, files.use_stdout()),
    }
}

fn under_test((name, driver): &Named) -> SuiteDriver<'_> {
    SuiteDriver { name: name.clone(), evaluated: driver.evaluated() }
}

impl Tested<'_> {
    /// Writes a row per episode.
    fn write_rows(&self, csv: &mut TestFile) -> Result<(), TestEnd> {
        let mut is_first = true;
        for (driver, results) in self.drivers.iter().zip(&self.episodes) {
            for ((family, scenario), in_scenario) in self.test.suite.scenarios().zip(results) {
                let columns = || SuiteColumns { family: &family.name, scenario: &scenario.name };
                csv.rows(records(&driver.name, in_scenario).map(|record| (columns(), record)), is_first)?;
                is_first = false;
            }
        }
        Ok(())
    }
}

impl<'a> SuiteReport<'a> {
    fn new(drivers: &[Named], tested: &Tested<'a>) -> Self {
        let SuiteTest { suite, seed, .. } = *tested.test;
        Self {
            suite: &suite.name,
            version: VERSION,
            commit: COMMIT,
            physics: evaluate::PHYSICS,
            episodes: suite.episodes(),
            seed,
            policies: drivers
                .iter()
                .zip(&tested.episodes)
                .map(|(driver, results)| DriverReport::new(driver, suite, results))
                .collect(),
        }
    }
}

impl SuiteReport<'_> {
    fn single<'b>(&'b self, driver: &'b DriverReport) -> SingleReport<'b> {
        let Self { suite, version, commit, physics, episodes, seed, .. } = *self;
        SingleReport { driver, suite, version, commit, physics, episodes, seed }
    }
}

impl DriverReport {
    fn new((name, driver): &Named, suite: &Suite, results: &[SuiteEpisodes]) -> Self {
        Self {
            policy: name.clone(),
            class: driver.evaluated().class(),
            families: suite.results(results),
            weights_crc32c: driver.policy().map(Policy::weights_crc32c),
        }
    }
}

/// The records of the episodes of the driver `name` in a scenario.
fn records<'a>(name: &'a str, in_scenario: &'a SuiteEpisodes) -> impl Iterator<Item = EpisodeRecord> + 'a {
    let episodes = in_scenario.episodes.iter().zip(&in_scenario.references.shortest_paths_m).enumerate();
    episodes.map(move |(k, (episode, shortest_m))| {
        let bounds = in_scenario.references.bounds.as_ref().and_then(|bounds| bounds.get(k).copied());
        EpisodeRecord::new(name, k + 1, episode, &in_scenario.scenario, *shortest_m, bounds)
    })
}

fn check_options(args: &EvalArgs) -> Result<(), RunError> {
    let refused =
        [("--trace", args.trace.is_some()), ("--course", args.course), ("--rounds", args.rounds.is_some())];
    match refused.into_iter().find(|(_, is_given)| *is_given) {
        Some((flag, _)) => Err(RunError::InvalidInput(format!(
            "{flag} is for a test in one scenario, not for a suite, a set of scenarios or a report; help: leave it out, or \
             give one scenario with --scenario and no --report"
        ))),
        None => Ok(()),
    }
}

/// Checks that a policy can drive in every scenario of the suite. Of a family's scenarios with the same task (robot, LIDAR and
/// rules), only the first is checked.
fn check_driver(
    path: &Path,
    (_, driver): &Named,
    suite: &Suite,
    shared: &SharedArgs,
) -> Result<(), RunError> {
    if driver.policy().is_none() {
        return Ok(());
    }
    let mut checked: BTreeMap<&str, Vec<_>> = BTreeMap::new();
    for (family, scenario) in suite.scenarios() {
        let tasks = checked.entry(&family.name).or_default();
        if !tasks.contains(&scenario.task()) {
            tasks.push(scenario.task());
            driver.check(path, &*scenario.scenario()?, &shared.extensions)?;
        }
    }
    Ok(())
}
