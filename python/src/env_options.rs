//! The options of an environment, as the Python layer passes them.

use std::path::Path;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use wayfield::env::{Autoreset, VecEnvConfig};
use wayfield::limits::MAX_ARENAS;
use wayfield::policy::Encoding;
use wayfield::run::preset::Preset;
use wayfield::run::settings::{Setting, Settings};
use wayfield::run::{scenario_set, shipped};
use wayfield::scenario::{Scenario, ScenarioSet};
use wayfield::simulation::Extensions;
use wayfield::task::{ObservationLayout, ScenarioPool, TaskMode};

use crate::errors::{file_error, run_error, setting_errors};
use crate::observation_bounds::ObservationBounds;

/// The name that messages use for a file that was given as text.
pub const TEXT: &str = "<text>";

/// Whether `source` is the text of a RON file, and not a path or a name. A heuristic: it has parentheses, and no file of that
/// name exists.
pub fn is_text(source: &str) -> bool {
    source.contains('(') && source.contains(')') && !Path::new(source).exists()
}

/// The scenario `source`: a shipped name, a file's path, or RON text.
pub fn scenario(source: &str) -> PyResult<Scenario> {
    if is_text(source) {
        return Scenario::parse(source, TEXT).map_err(|error| run_error(error.into()));
    }
    shipped::scenario(source).map_err(|error| file_error(source, error))
}

/// The scenario `source`, as for [`scenario`]; or, if `source` is a set, its first scenario and the set.
pub fn scenario_or_set(source: &str) -> PyResult<(Scenario, Option<ScenarioSet>)> {
    if !is_text(source) {
        return shipped::scenario_or_set(source).map_err(|error| file_error(source, error));
    }
    if !scenario_set::looks_like(source) {
        return Ok((scenario(source)?, None));
    }
    let set = scenario_set::parse(source, Path::new(TEXT)).map_err(|error| run_error(error.into()))?;
    let first = set.members.first().map(|member| member.source.first()).transpose();
    let first = first.map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok((first.unwrap_or_default(), Some(set)))
}

/// The preset `source`: a shipped name, a file's path, or RON text.
pub fn preset(source: &str) -> PyResult<Preset> {
    if is_text(source) {
        return Preset::parse(source, TEXT).map_err(|error| run_error(error.into()));
    }
    shipped::preset(source).map_err(|error| file_error(source, error))
}

/// Converts pairs to settings. A pair is the path of a field, such as `reward.mu`, and its value as RON.
pub fn settings(pairs: Vec<(String, String)>) -> Settings {
    Settings(pairs.into_iter().map(|(path, value)| Setting { path, value }).collect())
}

/// The options of environments, not yet checked.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct EnvOptions {
    /// The number of environments.
    pub num_envs: usize,
    /// `navigation` or `continuing`.
    pub task: String,
    /// `scaled` or `raw`; `None` for the preset's.
    pub observation: Option<String>,
    /// `discrete` or `continuous`.
    pub actions: String,
    /// The preset whose reward and observation are used.
    pub preset: String,
    /// Settings of the preset and the scenario: pairs of a field's path and its value as RON.
    pub settings: Vec<(String, String)>,
    /// `same_step`, `next_step` or `disabled`.
    pub autoreset: String,
}

impl EnvOptions {
    /// Applies the settings to `scenario` and `set`. Returns the configuration of the environments (of `set` if given,
    /// otherwise of `scenario`) and the bounds of their observations.
    pub fn config(
        self,
        scenario: &mut Scenario,
        mut set: Option<ScenarioSet>,
    ) -> PyResult<(VecEnvConfig, ObservationBounds)> {
        let num_envs = self.num_envs;
        if !(1..=MAX_ARENAS).contains(&num_envs) {
            return Err(PyValueError::new_err(format!(
                "num_envs is {num_envs}; help: give a number from 1 to {MAX_ARENAS}"
            )));
        }
        let mut preset = preset(&self.preset)?;
        let encoding = self.observation.as_deref().map(encoding).transpose()?;
        let settings = settings(self.settings);
        if let Some(set) = &mut set {
            settings.apply_to_set(set, &preset).map_err(setting_errors)?;
        }
        settings.apply(scenario, &mut preset).map_err(setting_errors)?;
        preset.arenas = num_envs;
        let encoding = encoding.unwrap_or(preset.observation);
        let mut layout = ObservationLayout::default();
        layout.encoding = encoding;
        let check_memory = |scenario: &Scenario| {
            let checked = preset.check_env_memory(scenario, &layout);
            checked.map_err(|error| PyValueError::new_err(format!("num_envs={num_envs}: {error}")))
        };
        check_memory(scenario)?;
        for member in set.iter().flat_map(|set| &set.members) {
            let first = member.source.first().map_err(|error| PyValueError::new_err(error.to_string()))?;
            check_memory(&first)?;
        }
        let bounds = ObservationBounds::of(encoding, scenario, set.as_ref());
        let config = VecEnvConfig {
            num_envs,
            encoding,
            reward: preset.reward,
            mode: choice(
                "task",
                &self.task,
                &[("navigation", TaskMode::Episodic), ("continuing", TaskMode::Continuing)],
            )?,
            autoreset: autoreset_mode(&self.autoreset)?,
            extensions: set.map_or_else(Extensions::default, |set| {
                Extensions::default().plugin(ScenarioPool::new(&set))
            }),
        };
        Ok((config, bounds))
    }
}

/// The encoding called `name`.
pub fn encoding(name: &str) -> PyResult<Encoding> {
    choice("observation", name, &[("scaled", Encoding::Scaled), ("raw", Encoding::Raw)])
}

/// Whether the action space called `name` is continuous: motions instead of indices of motions.
pub fn is_continuous(name: &str) -> PyResult<bool> {
    choice("actions", name, &[("discrete", false), ("continuous", true)])
}

/// The autoreset mode called `name`.
pub fn autoreset_mode(name: &str) -> PyResult<Autoreset> {
    let modes = [
        ("next_step", Autoreset::NextStep),
        ("same_step", Autoreset::SameStep),
        ("disabled", Autoreset::Disabled),
    ];
    choice("autoreset_mode", name, &modes)
}

/// The value of `option` called `name`.
pub fn choice<T: Copy>(option: &str, name: &str, choices: &[(&str, T)]) -> PyResult<T> {
    if let Some((_, value)) = choices.iter().find(|(choice, _)| *choice == name) {
        return Ok(*value);
    }
    let names: Vec<String> = choices.iter().map(|(choice, _)| format!("\"{choice}\"")).collect();
    Err(PyValueError::new_err(format!("{option} is {name:?}; help: give {}", names.join(" or "))))
}
