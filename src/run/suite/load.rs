//! Suites by name.

use std::path::Path;
use std::sync::Arc;

use super::{Family, FamilyRules, ScenarioOrLevel, Suite, SuiteScenario};
use crate::run::RunError;
use crate::run::scenario_set::named_file;
use crate::run::settings::Settings;
use crate::run::shipped::{self, Source};
use crate::scenario::{
    DEFAULT_SUITE_EPISODES, DEFAULT_SUITE_LEVELS, Diagnostic, FIRST_EVALUATION_LEVEL, FileError,
    LevelGenerator, Scenario, SetSource, SuiteFamily, SuiteFile, read_text, resemblance,
};

impl Suite {
    /// The suite `wanted`: the file or the shipped name of a suite; a folder of scenarios, a level generator or a scenario, each
    /// as a single family; or a set of scenarios, each of them a family. A generator's levels are ones that training never uses.
    /// `settings` change fields of the scenarios; `episodes` is the number of episodes in each, in place of the suite's.
    ///
    /// # Errors
    /// There is no such file or name; a file is invalid, or a scenario does not allow the rules of its family or the settings.
    pub fn load(wanted: &str, settings: &Settings, episodes: Option<u64>) -> Result<Self, RunError> {
        let mut suite = Self::find(wanted)?;
        for family in &mut suite.families {
            if let Some(episodes) = episodes {
                family.episodes = usize::try_from(episodes).unwrap_or(usize::MAX);
            }
            family.scenarios.iter_mut().for_each(|scenario| scenario.rules.settings = settings.clone());
            family.check()?;
        }
        Ok(suite)
    }

    fn find(wanted: &str) -> Result<Self, RunError> {
        if let Some((text, path)) = shipped::suite_text(wanted) {
            return Ok(parse(text, Path::new(path))?);
        }
        let path = Path::new(wanted);
        // A folder that happens to be called `hall` does not hide the shipped scenario.
        let is_shipped =
            shipped::is_scenario(wanted) || shipped::is_level_generator(wanted) || shipped::is_set(wanted);
        if path.is_dir() && !is_shipped {
            let scenarios = in_folder(path)?;
            let name = path.canonicalize().unwrap_or_else(|_| path.into());
            let name =
                name.file_name().map_or_else(|| wanted.into(), |name| name.to_string_lossy().into_owned());
            return Ok(Self::of_one(Family::new(name, scenarios, DEFAULT_SUITE_EPISODES)));
        }
        if path.is_file()
            && let text = read_text(path)?
            && looks_like(&text)
        {
            return Ok(parse(&text, path)?);
        }
        Ok(Self::of_source(Source::load(wanted)?, wanted))
    }

    fn of_source(source: Source, wanted: &str) -> Self {
        match source {
            Source::Scenario(scenario) => {
                let name = scenario.name.clone();
                let scenarios = vec![SuiteScenario::new(wanted, scenario)];
                Self::of_one(Family::new(name, scenarios, DEFAULT_SUITE_EPISODES))
            }
            Source::Levels(generator) => {
                let name = generator.name.clone();
                let scenarios = levels(wanted, generator, FIRST_EVALUATION_LEVEL, DEFAULT_SUITE_LEVELS);
                Self::of_one(Family::new(name, scenarios, 1))
            }
            Source::Set(_, set) => {
                let family = |member: crate::scenario::SetMember| match member.source {
                    SetSource::Scenario(scenario) => {
                        let scenarios = vec![SuiteScenario::new(&member.name, *scenario)];
                        Family::new(member.name, scenarios, DEFAULT_SUITE_EPISODES)
                    }
                    SetSource::Levels { generator, .. } => {
                        let first = FIRST_EVALUATION_LEVEL;
                        let scenarios = levels(&member.name, *generator, first, DEFAULT_SUITE_LEVELS);
                        Family::new(member.name, scenarios, 1)
                    }
                };
                Self { name: set.name, families: set.members.into_iter().map(family).collect() }
            }
        }
    }

    fn of_one(family: Family) -> Self {
        Self { name: family.name.clone(), families: vec![family] }
    }
}

/// Whether the text of a file is meant as a suite, by its fields.
#[must_use]
pub fn looks_like(text: &str) -> bool {
    resemblance::<SuiteFile>(text, "Suite") > resemblance::<Scenario>(text, "Scenario")
}

/// The suite in `text`, the contents of the file at `path`, with the scenarios that it names.
///
/// # Errors
/// The text is not a suite, or a scenario cannot be read, is invalid, or does not allow the rules of its family.
pub fn parse(text: &str, path: &Path) -> Result<Suite, FileError> {
    let file = SuiteFile::parse(text, path)?;
    let mut problems = Vec::new();
    let mut families = Vec::new();
    for (k, family) in file.families.into_iter().enumerate() {
        let mut scenarios = Vec::new();
        for (i, name) in family.scenarios.iter().enumerate() {
            match named_scenarios(path, name) {
                Ok(found) => scenarios.extend(found),
                Err(why) => problems.push(problem(format!("families[{k}].scenarios[{i}]"), &why)),
            }
        }
        if let Some(name) = &family.generator {
            match named_levels(path, name, &family) {
                Ok(found) => scenarios.extend(found),
                Err(why) => problems.push(problem(format!("families[{k}].generator"), &why)),
            }
        }
        let SuiteFamily { time_limit_s, collision_range_m, .. } = family;
        for scenario in &mut scenarios {
            scenario.rules = FamilyRules { time_limit_s, collision_range_m, ..FamilyRules::default() };
        }
        let episodes = family.episodes();
        let SuiteFamily { name, benchmark_route, score, .. } = family;
        let family = Family { benchmark_route, score, ..Family::new(name, scenarios, episodes) };
        if problems.is_empty()
            && let Err(error) = family.check()
        {
            problems.push(problem(format!("families[{k}]"), &error.to_string()));
        }
        families.push(family);
    }
    let suite = Suite { name: file.name, families };
    if problems.is_empty() { Ok(suite) } else { Err(FileError::from_diagnostics(path, text, &problems)) }
}

fn problem(path: String, why: &str) -> Diagnostic {
    Diagnostic { path, message: format!("can't be used: {why}") }
}

/// The scenario, or those in the folder, that the suite at `suite` calls `name`.
fn named_scenarios(suite: &Path, name: &str) -> Result<Vec<SuiteScenario>, String> {
    let folder = suite.parent().map(|parent| parent.join(name)).filter(|folder| folder.is_dir());
    if let Some(folder) = folder.filter(|_| !shipped::is_scenario(name)) {
        return in_folder(&folder).map_err(|error| error.to_string());
    }
    let wanted = named_file(suite, name)?;
    match Source::load(&wanted).map_err(|error| error.to_string())? {
        Source::Scenario(scenario) => Ok(vec![SuiteScenario::new(&wanted, scenario)]),
        Source::Levels(_) => Err(format!(
            "it is a level generator; help: write `generator: \"{name}\"` in a family of its own, or `{name}:SEED` for one level"
        )),
        Source::Set(..) => Err("it is a set of scenarios; help: name its scenarios".into()),
    }
}

/// The levels of the generator that the suite at `suite` calls `name`.
fn named_levels(suite: &Path, name: &str, family: &SuiteFamily) -> Result<Vec<SuiteScenario>, String> {
    let wanted = named_file(suite, name)?;
    match Source::load(&wanted).map_err(|error| error.to_string())? {
        Source::Levels(generator) => Ok(levels(&wanted, generator, family.first_level(), family.levels())),
        _ => {
            Err("it is not a level generator; help: write `scenarios: [...]` instead of `generator:`".into())
        }
    }
}

/// The scenarios in a folder, in the order of their file names.
fn in_folder(folder: &Path) -> Result<Vec<SuiteScenario>, RunError> {
    let unreadable =
        |error: std::io::Error| RunError::invalid_input(folder, format!("can't be read: {error}"));
    let entries = std::fs::read_dir(folder).map_err(unreadable)?;
    let mut files =
        entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
    files.retain(|file| file.extension() == Some("ron".as_ref()) && file.is_file());
    files.sort();
    if files.is_empty() {
        return Err(RunError::invalid_input(
            folder,
            "this folder has no .ron file; help: give a folder of scenarios",
        ));
    }
    let load = |file: &std::path::PathBuf| {
        Ok(SuiteScenario::new(&file.display().to_string(), Scenario::load(file)?))
    };
    files.iter().map(load).collect()
}

/// `count` levels of `generator`, which is called `name`, from the seed `first` on.
fn levels(name: &str, generator: LevelGenerator, first: u64, count: u32) -> Vec<SuiteScenario> {
    let generator = Arc::new(generator);
    let level = |k: u32| {
        let seed = first + u64::from(k);
        let source = ScenarioOrLevel::Level(generator.clone(), seed);
        SuiteScenario { name: format!("{name}:{seed}"), source, rules: FamilyRules::default() }
    };
    (0..count).map(level).collect()
}

impl SuiteScenario {
    fn new(name: &str, scenario: Scenario) -> Self {
        let source = ScenarioOrLevel::Scenario(Arc::new(scenario));
        Self { name: name.into(), source, rules: FamilyRules::default() }
    }
}

impl Family {
    fn new(name: String, scenarios: Vec<SuiteScenario>, episodes: u32) -> Self {
        Self { name, scenarios, episodes: episodes as usize, benchmark_route: false, score: None }
    }

    /// Checks that the scenarios, or the first level, allow the rules of the family, and have a benchmark route if one is needed.
    fn check(&self) -> Result<(), RunError> {
        for (k, wanted) in self.scenarios.iter().enumerate() {
            if k > 0 && matches!(wanted.source, ScenarioOrLevel::Level(..)) {
                continue;
            }
            let scenario = wanted.scenario()?;
            if self.benchmark_route && scenario.benchmark_route.is_none() {
                let name = &wanted.name;
                return Err(RunError::InvalidInput(format!(
                    "{name} has no benchmark route; help: write one into the scenario, or leave out `benchmark_route`"
                )));
            }
        }
        Ok(())
    }
}
