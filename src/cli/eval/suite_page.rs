//! The report of a test in a suite: a page with the results of each family and an image of every failure.
//!
//! The folder also holds the finished tests, so that an interrupted test can continue; the policies and drivers; and the
//! scenarios of the failures.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::suite::{SuiteReport, Tested};
use super::suite_failures::{self, Failure, command, failures};
use crate::policy::Policy;
use crate::report::format::counted;
use crate::report::page::{Item, Page, Section};
use crate::report::table::{Cell, Column, ColumnKind, Table};
use crate::reproduce::report_files;
use crate::reproduce::report_folder::{LOCK, is_vacant};
use crate::run::evaluate::Evaluated;
use crate::run::lock::Lock;
use crate::run::output_file::{remove_temporary_files, replace};
use crate::run::policy_card::WITH_MAP;
use crate::run::suite::{FamilyResult, TestStore};
use crate::run::{RunError, provenance};
use crate::scenario::to_ron;

/// The file with the finished tests.
const TESTS: &str = "tests.ron";
/// The folder of the policies and drivers.
const DRIVERS: &str = "drivers";

/// The folder of a report, locked by this process.
pub struct SuiteFolder {
    path: PathBuf,
    /// The finished tests, each of one driver in one scenario.
    pub store: TestStore,
    _lock: Lock,
}

impl SuiteFolder {
    /// Creates the folder at `path`, or opens one that an earlier test created.
    ///
    /// # Errors
    /// The folder holds something else, another process uses it, or it cannot be written.
    pub fn open(path: &Path) -> Result<Self, RunError> {
        let unwritable = |error: std::io::Error| RunError::not_writable(path, error);
        if !is_vacant(path) && !path.join(TESTS).is_file() {
            let why =
                "holds something other than the report of a suite; help: give a new folder with --report";
            return Err(RunError::invalid_input(path, why));
        }
        fs::create_dir_all(path).map_err(unwritable)?;
        let lock = Lock::acquire(path, &path.join(LOCK))?;
        report_files::prepare(path)?;
        let store = TestStore::open(&path.join(TESTS))?;
        Ok(Self { path: path.into(), store, _lock: lock })
    }

    /// Writes the report, with the images and scenarios of all failures, in place of an earlier one. Returns the path of the page.
    ///
    /// # Errors
    /// An episode cannot be drawn, or a file cannot be written.
    pub fn write(&self, tested: &Tested<'_>, report: &SuiteReport<'_>) -> Result<PathBuf, RunError> {
        let drivers = self.write_drivers(tested)?;
        let failures = failures(tested)?;
        self.write_scenarios(&failures)?;
        let figure = |failure: &Failure| Item::Figure {
            name: failure.file.clone(),
            svg: failure.svg.clone(),
            caption: format!(
                "{}. To repeat it: {}",
                failure.text,
                command(&self.path, failure, tested.test.seed, &drivers[failure.driver])
            ),
            claim_results: Vec::new(),
        };
        let families = report.policies.first().map_or(&[][..], |policy| &policy.families);
        let section = |(family, (name, _)): (usize, &(String, FamilyResult))| {
            let shown: Vec<&Failure> = failures.iter().filter(|failure| failure.family == family).collect();
            let table = Item::Table { table: table(report, family), claim_results: Vec::new() };
            Section {
                id: format!("family-{}", family + 1),
                heading: name.clone(),
                about: match shown.len() {
                    0 => "No episode failed.".into(),
                    1 => "One episode failed.".into(),
                    count => format!("{count} episodes failed."),
                },
                items: std::iter::once(table).chain(shown.into_iter().map(figure)).collect(),
            }
        };
        let page = Page {
            title: report.suite.into(),
            lead: vec![LEAD.into()],
            warning: None,
            claims: Vec::new(),
            sections: families.iter().enumerate().map(section).collect(),
            settings: Vec::new(),
            provenance: vec![
                ("wayfield".into(), provenance::VERSION.into()),
                ("commit".into(), provenance::COMMIT.unwrap_or("unknown").into()),
                ("seed".into(), report.seed.to_string()),
                ("physics".into(), report.physics.into()),
            ],
        };
        report_files::write(&self.path, &page)?;
        Ok(self.path.join("report.html"))
    }

    /// Writes the policies and drivers, so that the commands of the failures need no other files. Returns their paths, as given
    /// on the command line.
    fn write_drivers(&self, tested: &Tested<'_>) -> Result<Vec<PathBuf>, RunError> {
        let folder = create_folder(&self.path.join(DRIVERS), is_driver)?;
        let mut paths = Vec::new();
        for (k, driver) in tested.drivers.iter().enumerate() {
            let name = driver.name.strip_suffix(WITH_MAP).unwrap_or(&driver.name);
            let stem = Path::new(name).file_stem().unwrap_or_default().to_string_lossy();
            let failed =
                |error: &dyn std::fmt::Display| RunError::Failed(format!("{}: {error}", driver.name));
            let of_policy = |policy: &Policy| policy.to_bytes().map_err(|error| failed(&error));
            let (extension, bytes, suffix) = match driver.evaluated {
                Evaluated::Policy(policy) => ("safetensors", of_policy(policy)?, ""),
                Evaluated::PolicyWithMap(with_map) => ("safetensors", of_policy(&with_map.policy)?, WITH_MAP),
                Evaluated::Driver(driver) => {
                    ("ron", to_ron(driver).map_err(|error| failed(&error))?.into_bytes(), "")
                }
            };
            let path = folder.join(format!("{}-{stem}.{extension}", k + 1));
            replace(&path, |file| file.write_all(&bytes))
                .map_err(|error| RunError::not_written(&path, error))?;
            let mut given = path.into_os_string();
            given.push(suffix);
            paths.push(given.into());
        }
        Ok(paths)
    }

    fn write_scenarios(&self, failures: &[Failure]) -> Result<(), RunError> {
        let folder = create_folder(&self.path.join(suite_failures::FOLDER), suite_failures::is_file_name)?;
        for failure in failures {
            let path = folder.join(format!("{}.ron", failure.file));
            replace(&path, |file| file.write_all(failure.scenario.as_bytes()))
                .map_err(|error| RunError::not_written(&path, error))?;
        }
        Ok(())
    }
}

/// The paragraph at the top of the page.
const LEAD: &str = "Every policy and driver drove the same episodes. In the images, the line is the robot's path, and the rays \
are its last scan. The command below an image repeats the episode in the app, with the same driver, start, goal, moving \
obstacles and sensor noise.";

/// Whether `name` is that of a driver's file in a report: its number, a hyphen, its name, and `.safetensors` or `.ron`.
fn is_driver(name: &str) -> bool {
    let is_numbered = name.split_once('-').is_some_and(|(number, _)| number.parse::<usize>().is_ok());
    is_numbered && Path::new(name).extension().is_some_and(|end| end == "safetensors" || end == "ron")
}

/// Creates `folder` if it is missing. Removes temporary files from it, and the files of an earlier report: those whose names
/// `is_ours` accepts.
fn create_folder(folder: &Path, is_ours: fn(&str) -> bool) -> Result<PathBuf, RunError> {
    fs::create_dir_all(folder).map_err(|error| RunError::not_written(folder, error))?;
    remove_temporary_files(folder);
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_name().to_str().is_some_and(is_ours) {
            // A file that cannot be deleted does no harm: the page does not name it.
            let _ = fs::remove_file(entry.path());
        }
    }
    Ok(folder.into())
}

/// The table of a family.
fn table(report: &SuiteReport<'_>, family: usize) -> Table {
    let text =
        |heading: &str| Column { heading: heading.into(), unit: String::new(), kind: ColumnKind::Text };
    let number = |heading: &str, unit: &str| Column {
        heading: heading.into(),
        unit: unit.into(),
        kind: ColumnKind::Number,
    };
    let exact =
        |value: Option<f64>, digits| value.map_or(Cell::Empty, |value| Cell::Number { value, digits });
    let percent = |rate: f64| exact(Some(100.0 * rate), 1);
    let results = || report.policies.iter().map(|policy| (policy, &policy.families[family].1));
    let rows = results().map(|(policy, result)| {
        let [low, high] = result.success_interval;
        vec![
            Cell::Text(policy.policy.clone()),
            Cell::Text(format!("{:?}", policy.class)),
            percent(result.success_rate),
            Cell::Text(format!("{:.1} to {:.1}", 100.0 * low, 100.0 * high)),
            percent(result.collision_rate),
            percent(result.timeout_rate),
            percent(result.worst_tenth),
            exact(result.mean_time_s, 2),
            exact(Some(result.spl), 3),
            exact(result.time_ratio, 3),
            exact(result.barn_score, 3),
        ]
    });
    let counts = results().next().map_or((0, 0), |(_, result)| (result.scenarios, result.episodes));
    Table {
        name: format!("family-{}", family + 1),
        title: format!("{}, {}", counted(counts.0 as f64, "scenario"), counted(counts.1 as f64, "episode")),
        columns: vec![
            text("Policy"),
            text("Class"),
            number("Success", "%"),
            text("95 % interval"),
            number("Collision", "%"),
            number("Timeout", "%"),
            number("Worst tenth", "%"),
            number("Mean time", "s"),
            number("SPL", ""),
            number("Time ratio", ""),
            number("BARN score", ""),
        ],
        rows: rows.collect(),
        notes: Vec::new(),
    }
}
