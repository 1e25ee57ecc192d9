//! The configuration of a run: `config.ron`.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::RunFolder;
use crate::limits::{MAX_CONFIG_BYTES, MAX_LEVELS_BY_PROGRESS};
use crate::run::RunError;
use crate::run::preset::{Budget, Preset};
use crate::run::provenance::{COMMIT, VERSION};
use crate::run::settings::{SettingError, Settings};
use crate::run::{scenario_set, shipped};
use crate::scenario::{
    Diagnostic, FileError, Scenario, ScenarioSet, SetMember, SetSource, diagnostics_of_known, is_unprintable,
    parse_checked, read_ron_with_limit, read_text_with_limit, resemblance,
};
use crate::simulation::Extensions;
use crate::task::{LevelSampling, ObservationLayout, ObservationSlice, ScenarioPool};

/// The resolved configuration of a run: everything needed to repeat the run bit for bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunConfig {
    /// The version of wayfield that started the run.
    pub version: String,
    /// The Git commit of that program; `None` if it is unknown.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// The seed from which all random streams are derived.
    pub seed: u64,
    /// The scenario's file or the name of a shipped scenario, as given by the user.
    pub scenario_from: String,
    /// The preset's file or the name of a shipped preset, as given by the user.
    pub preset_from: String,
    /// The policy that training starts from; `None` for random weights.
    #[serde(default)]
    pub transfer: Option<Transfer>,
    /// The numbers of finished episodes or env steps after which the current policy is saved, in addition to the
    /// best and the last policy ([`RunFolder::policy_after_file`](super::RunFolder::policy_after_file)).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub save_policy_after: Vec<Budget>,
    /// The observation slices of plugin sensors.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<ObservationSlice>,
    /// The names of plugin reward terms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reward_terms: Vec<String>,
    /// The plugins. They are not part of the file.
    #[serde(skip)]
    pub extensions: Extensions,
    /// The set from which each episode draws its scenario; `None` if all episodes have the same one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario_set: Option<ScenarioSet>,
    /// The scenario, or the first scenario of the set, including overrides from the command line.
    pub scenario: Scenario,
    /// The preset, including overrides from the command line.
    pub preset: Preset,
}

impl RunConfig {
    /// The configuration of a run that starts from random weights. `scenario_from` and `preset_from` are files or
    /// shipped names.
    ///
    /// # Errors
    /// A file cannot be read or is invalid, or no policy can drive in all scenarios of a set. The message gives a fix and,
    /// where there is one, the line and column.
    pub fn resolve(scenario_from: &str, preset_from: &str, seed: u64) -> Result<Self, FileError> {
        let (scenario, scenario_set) = shipped::scenario_or_set(scenario_from)?;
        let preset = shipped::preset(preset_from)?;
        if let Some(set) = &scenario_set {
            scenario_set::check_fit(set, scenario_from, preset.fit())?;
        }
        let config = Self::new((scenario_from.into(), scenario), (preset_from.into(), preset), seed);
        Ok(Self { scenario_set, ..config })
    }

    /// Like [`resolve`](Self::resolve). Without `scenario_from`, it takes the scenario that the preset names, or Scenario I if
    /// the preset names none.
    ///
    /// # Errors
    /// As for [`resolve`](Self::resolve).
    pub fn resolve_default(
        scenario_from: Option<&str>,
        preset_from: &str,
        seed: u64,
    ) -> Result<Self, FileError> {
        if let Some(scenario) = scenario_from {
            return Self::resolve(scenario, preset_from, seed);
        }
        match shipped::preset(preset_from)?.scenario {
            Some(scenario) => Self::resolve(&scenario, preset_from, seed)
                .map_err(|error| FileError::for_file(Path::new(preset_from), of_preset(&error))),
            None => Self::resolve(DEFAULT_SCENARIO, preset_from, seed),
        }
    }

    /// The configuration of a run that starts from random weights. The scenario and the preset each come with their file
    /// or shipped name.
    #[must_use]
    pub fn new(scenario: (String, Scenario), preset: (String, Preset), seed: u64) -> Self {
        let ((scenario_from, scenario), (preset_from, preset)) = (scenario, preset);
        Self {
            version: VERSION.into(),
            commit: COMMIT.map(String::from),
            seed,
            scenario_from,
            preset_from,
            transfer: None,
            save_policy_after: Vec::new(),
            sensors: Vec::new(),
            reward_terms: Vec::new(),
            extensions: Extensions::default(),
            scenario_set: None,
            scenario,
            // The scenario that the preset names was only a default.
            preset: Preset { scenario: None, ..preset },
        }
    }

    /// This configuration with changes to its scenario, or to all scenarios of its set, and to its preset.
    ///
    /// # Errors
    /// As for [`Settings::apply`].
    pub fn with_settings(mut self, settings: &Settings) -> Result<Self, Vec<SettingError>> {
        if let Some(set) = &mut self.scenario_set {
            settings.apply_to_set(set, &self.preset)?;
        }
        settings.apply(&mut self.scenario, &mut self.preset)?;
        Ok(self)
    }

    /// This configuration with another budget and number of arenas, where they are given.
    ///
    /// # Errors
    /// The preset would then be invalid. The message names it.
    pub fn with_length(mut self, budget: Option<Budget>, arenas: Option<usize>) -> Result<Self, RunError> {
        self.preset.budget = budget.unwrap_or(self.preset.budget);
        self.preset.arenas = arenas.unwrap_or(self.preset.arenas);
        match self.preset.diagnostics().first() {
            None => Ok(self),
            Some(found) => Err(RunError::InvalidInput(format!("{}: {found}", self.preset_from))),
        }
    }

    /// The configuration in the file at `path`, the `config.ron` of a run folder.
    ///
    /// # Errors
    /// The file cannot be read, is not a configuration or has invalid values.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        let config: Self = read_ron_with_limit(path, MAX_CONFIG_BYTES)?;
        let diagnostics = config.diagnostics();
        if diagnostics.is_empty() {
            return Ok(config);
        }
        Err(FileError::from_diagnostics(path, &read_text_with_limit(path, MAX_CONFIG_BYTES)?, &diagnostics))
    }

    /// Whether the text of a file is meant as a configuration, judging by its fields.
    #[must_use]
    pub fn looks_like(text: &str) -> bool {
        let others = [resemblance::<Scenario>(text, "Scenario"), resemblance::<Preset>(text, "Preset")];
        others.iter().all(|other| resemblance::<Self>(text, "RunConfig") > *other)
    }

    /// The configuration in the text of a `config.ron`; error messages name it by `path`.
    ///
    /// # Errors
    /// The text is not a configuration or has invalid values.
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        parse_checked(text, path, Self::diagnostics_of_known, Self::diagnostics)
    }

    /// All invalid values of the preset, the set of scenarios and the scenario.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        self.diagnostics_of_known(&[])
    }

    /// The [`diagnostics`](Self::diagnostics), if the values at the paths `unknown` could not be read.
    fn diagnostics_of_known(&self, unknown: &[String]) -> Vec<Diagnostic> {
        let all_known = unknown.is_empty();
        let in_scenario = |path: &String| match path.strip_prefix("scenario") {
            Some(rest) => Some(rest.trim_start_matches('.').to_owned()),
            None => path.is_empty().then(String::new),
        };
        let unknown: Vec<String> = unknown.iter().filter_map(in_scenario).collect();
        let inside = |part: &'static str| {
            move |found: Diagnostic| Diagnostic { path: format!("{part}.{}", found.path), ..found }
        };
        let preset = self.preset.diagnostics().into_iter().map(inside("preset"));
        let of_set = |set: &ScenarioSet| {
            let Scenario { name, robot, lidar, task, .. } = &self.scenario;
            let fit = self.preset.fit();
            let member = set.misfit(fit).map(|(k, why)| (format!("scenario_set.members[{k}].source"), why));
            let first = || Some(("scenario".into(), set.misfit_of(name, (robot, lidar, task), fit)?));
            // Values that could not be read must not be compared.
            let misfit = member.or_else(first).filter(|_| all_known);
            let misfit = misfit.map(|(path, message)| Diagnostic { path, message });
            let inside = set.diagnostics().into_iter().map(inside("scenario_set"));
            inside.chain(misfit).collect()
        };
        let set: Vec<Diagnostic> = self.scenario_set.as_ref().map(of_set).unwrap_or_default();
        let scenario = diagnostics_of_known(&self.scenario, &unknown).into_iter().map(inside("scenario"));
        preset.chain(set).chain(scenario).collect()
    }

    /// This configuration with the user's plugins; their sensors and reward terms are recorded.
    #[must_use]
    pub fn with_extensions(self, extensions: &Extensions) -> Self {
        let (sensors, reward_terms) = extensions.describe();
        Self { sensors, reward_terms, extensions: extensions.clone(), ..self }
    }

    /// This recorded configuration with the user's plugins, for a run that is resumed or repeated. An error names
    /// it by `path`.
    ///
    /// # Errors
    /// The sensors or reward terms of the plugins differ from the recorded ones.
    pub fn resume_with_extensions(self, extensions: &Extensions, path: &Path) -> Result<Self, RunError> {
        let recorded = (self.sensors.clone(), self.reward_terms.clone());
        let config = self.with_extensions(extensions);
        if recorded == (config.sensors.clone(), config.reward_terms.clone()) {
            return Ok(config);
        }
        Err(RunError::invalid_input(
            path,
            "this run was started with other sensor or reward plugins; help: use the plugins listed in config.ron",
        ))
    }

    /// Whether the LIDARs of all its scenarios measure exactly, so that no scan draws from a random stream.
    #[must_use]
    pub fn has_exact_lidars(&self) -> bool {
        let mut members = self.scenario_set.iter().flat_map(|set| &set.members);
        self.scenario.lidar.is_exact() && members.all(|member| member.source.task().1.is_exact())
    }

    /// The layout of the run's observations.
    #[must_use]
    pub fn observation_layout(&self) -> ObservationLayout {
        ObservationLayout::new(self.preset.observation, self.sensors.clone())
    }

    /// A one-line description: scenario, preset, seed, number of arenas, and initial policy.
    #[must_use]
    pub fn description(&self) -> String {
        let name = self.preset_name();
        let from = self.transfer.as_ref().map_or(String::new(), |t| format!(", from {}", t.policy));
        let arenas = self.preset.arenas;
        format!(
            "{}, preset {name}, seed {}, {arenas} arena{}{from}",
            self.scenario_title(),
            self.seed,
            if arenas == 1 { "" } else { "s" }
        )
    }

    /// The name of the scenario, or of the set of scenarios.
    #[must_use]
    pub fn scenario_title(&self) -> &str {
        self.scenario_set.as_ref().map_or(&self.scenario.name, |set| &set.name)
    }

    /// Whether the run is in the paper's Scenario I, so that the paper's numbers apply.
    #[must_use]
    pub fn is_paper_scenario_1(&self) -> bool {
        self.scenario_set.is_none() && shipped::is_paper_scenario_1(&self.scenario)
    }

    /// The names of the set's members; empty without a set.
    pub fn member_names(&self) -> impl Iterator<Item = &str> {
        self.scenario_set.iter().flat_map(|set| &set.members).map(|member| member.name.as_str())
    }

    /// The plugins of the run's simulations: the user's, and one for the set of scenarios.
    #[must_use]
    pub fn simulation_plugins(&self) -> Extensions {
        match &self.scenario_set {
            Some(set) => self.extensions.clone().plugin(ScenarioPool::new(set)),
            None => self.extensions.clone(),
        }
    }

    /// Checks that training needs no more memory than allowed, in any of its scenarios.
    ///
    /// # Errors
    /// It needs too much memory. The message names the fields to reduce.
    pub fn check_memory(&self) -> Result<(), String> {
        self.check_levels()?;
        let layout = self.observation_layout();
        for member in self.scenario_set.iter().flat_map(|set| &set.members) {
            let scenario = member.source.first().map_err(|error| error.to_string())?;
            self.preset.check_memory(&scenario, &layout)?;
        }
        self.preset.check_memory(&self.scenario, &layout)
    }

    /// Checks that the set has few enough levels to keep the results of each, if the preset draws levels by their results.
    fn check_levels(&self) -> Result<(), String> {
        let levels = |member: &SetMember| match member.source {
            SetSource::Scenario(_) => 0,
            SetSource::Levels { levels, .. } => levels as usize,
        };
        let levels: usize = self.scenario_set.iter().flat_map(|set| &set.members).map(levels).sum();
        if self.preset.levels == LevelSampling::Uniform || levels <= MAX_LEVELS_BY_PROGRESS {
            return Ok(());
        }
        Err(format!(
            "`levels: ByProgress` keeps the results of every level, but the set has {levels} levels, more than \
             {MAX_LEVELS_BY_PROGRESS}; help: give its generators fewer `levels`, or use `levels: Uniform`"
        ))
    }

    /// A name for the run's folder: `<scenario>-<preset>-<seed>`.
    #[must_use]
    pub fn run_name(&self) -> String {
        format!("{}-{}-{}", self.scenario_name(), self.preset_name(), self.seed)
    }

    /// The scenario's file name without folder and extension.
    #[must_use]
    pub fn scenario_name(&self) -> String {
        file_stem(&self.scenario_from)
    }

    /// The preset's file name without folder and extension.
    #[must_use]
    pub fn preset_name(&self) -> String {
        file_stem(&self.preset_from)
    }
}

/// The scenario of a training run for which neither the user nor the preset names one.
pub const DEFAULT_SCENARIO: &str = "scenario-1";

/// The message for an unusable scenario that a preset names.
fn of_preset(error: &FileError) -> String {
    format!("its `scenario` cannot be used: {error}")
}

/// The name of the file `path` without folder and extension, as part of another file's name: without characters that can't
/// be printed. For standard input it is `stdin`, and for the `config.ron` of a run the name of the run's folder.
fn file_stem(path: &str) -> String {
    let path = Path::new(if path == "-" { "stdin" } else { path });
    let folder = path.parent().and_then(Path::file_name).filter(|_| path.ends_with(RunFolder::CONFIG_FILE));
    let stem = folder.or(path.file_stem()).unwrap_or_default();
    stem.to_string_lossy().replace(is_unprintable, "_")
}

/// The paper's epsilon at the start of a transfer (section 3.2).
pub const PAPER_TRANSFER_EPSILON: f32 = 0.5;

/// The initial policy of a run with knowledge transfer (section 3.2 of the paper).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Transfer {
    /// The policy's file, as given by the user.
    pub policy: String,
    /// The initial epsilon; `None` keeps the preset's.
    pub epsilon: Option<f32>,
}
