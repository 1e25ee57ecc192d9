//! Settings: single fields of a preset or a scenario that are set from outside their files.
//!
//! In: pairs of a path and a value in RON, such as `learning.gamma=0.97` or `scenario.lidar.noise_std_m=0.02`. Out: the
//! changed preset and scenario, or errors that name the setting.

mod paths;

use std::fmt;
use std::str::FromStr;

use ron::value::RawValue;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde::ser::{Error as _, SerializeMap, Serializer};
use serde::{Deserialize, Serialize};

use super::RunError;
use super::preset::Preset;
use crate::scenario::{
    Diagnostic, Scenario, ScenarioSet, SetSource, choose, diagnostics, field_names, with_plain_numbers,
    with_setting,
};

/// A setting: a field of the preset, such as `learning.replay.sampling.alpha`, or of the scenario, such as
/// `scenario.obstacles[0].motion.speed_rad_s`, and its new value.
///
/// Its text is `path=value`. The index `[*]` stands for all elements that have the rest of the path. The name of an enum variant
/// is not part of a path: `learning.loss.delta=1.0`. To choose another variant, set it as a whole:
/// `learning.loss=Huber(delta: 1.0)`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The path of the field.
    pub path: String,
    /// The value as RON text. Whole numbers may also be written 6e5 or 600k.
    pub value: String,
}

/// Settings in the order in which they are applied. In a RON file they are a map from paths to values:
/// `{"learning.gamma": 0.97, "reward.kind": Traditional}`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Settings(pub Vec<Setting>);

/// The problem with a setting, and its fix.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{setting}: {problem}")]
pub struct SettingError {
    /// The text of the setting.
    pub setting: String,
    /// The problem and its fix.
    pub problem: String,
}

impl Settings {
    /// Whether there are no settings.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Changes a valid scenario and a valid preset; the results are valid, too.
    ///
    /// # Errors
    /// All problems: there is no such field, it does not take the value, or the result is invalid.
    pub fn apply(&self, scenario: &mut Scenario, preset: &mut Preset) -> Result<(), Vec<SettingError>> {
        self.apply_to(Some(scenario), Some(preset))
    }

    /// Changes the scenarios of `set` as [`apply`](Self::apply) changes a scenario; `preset` stays as it is.
    ///
    /// # Errors
    /// As [`Settings::apply`], with the name of the scenario; also a setting of the scenario where the set has a level generator.
    pub fn apply_to_set(&self, set: &mut ScenarioSet, preset: &Preset) -> Result<(), Vec<SettingError>> {
        for member in &mut set.members {
            match &mut member.source {
                SetSource::Scenario(scenario) => {
                    let applied = self.apply(scenario, &mut preset.clone());
                    applied.map_err(|errors| {
                        let named = |mut error: SettingError| {
                            if error.setting.starts_with("scenario.") {
                                error.problem = format!("in `{}`: {}", member.name, error.problem);
                            }
                            error
                        };
                        errors.into_iter().map(named).collect::<Vec<_>>()
                    })?;
                }
                SetSource::Levels { .. } => {
                    let of_scenario = self.0.iter().filter(|setting| setting.path.starts_with("scenario."));
                    let why = || {
                        format!(
                            "does not change the levels of `{}`; help: change its generator's file",
                            member.name
                        )
                    };
                    let errors: Vec<SettingError> = of_scenario.map(|setting| setting.error(why())).collect();
                    if !errors.is_empty() {
                        return Err(errors);
                    }
                }
            }
        }
        Ok(())
    }

    /// Changes the scenario where there is no preset.
    ///
    /// # Errors
    /// As [`Settings::apply`]; also a setting of the preset.
    pub fn apply_to_scenario(&self, scenario: &mut Scenario) -> Result<(), Vec<SettingError>> {
        self.apply_to(Some(scenario), None)
    }

    /// Changes the preset where the scenario must stay as it is.
    ///
    /// # Errors
    /// As [`Settings::apply`]; also a setting of the scenario.
    pub fn apply_to_preset(&self, preset: &mut Preset) -> Result<(), Vec<SettingError>> {
        self.apply_to(None, Some(preset))
    }

    fn apply_to(
        &self,
        mut scenario: Option<&mut Scenario>,
        mut preset: Option<&mut Preset>,
    ) -> Result<(), Vec<SettingError>> {
        let mut errors = Vec::new();
        for setting in &self.0 {
            let applied = setting.apply(scenario.as_deref_mut(), preset.as_deref_mut());
            errors.extend(applied.err().map(|problem| setting.error(problem)));
        }
        if errors.is_empty() && !self.is_empty() {
            let inside = |found: Diagnostic| Diagnostic { path: format!("scenario.{}", found.path), ..found };
            let of_preset = preset.map(|preset| preset.diagnostics()).unwrap_or_default();
            let of_scenario = scenario.map(|scenario| diagnostics(scenario)).unwrap_or_default();
            let found = of_preset.into_iter().chain(of_scenario.into_iter().map(inside));
            errors.extend(found.map(|found| self.error(&found)));
        }
        if errors.is_empty() { Ok(()) } else { Err(errors) }
    }

    /// The error for an invalid result. It names the last setting that contains the field, or all settings if none does.
    fn error(&self, found: &Diagnostic) -> SettingError {
        match self.0.iter().rev().find(|setting| setting.contains(&found.path)) {
            Some(setting) => setting.error(found.to_string()),
            None => SettingError { setting: self.to_string(), problem: found.to_string() },
        }
    }
}

impl Setting {
    fn apply(&self, scenario: Option<&mut Scenario>, preset: Option<&mut Preset>) -> Result<(), String> {
        let (first, rest) = self.path.split_once('.').unwrap_or((&self.path, ""));
        if first == "scenario" {
            let Some(scenario) = scenario else {
                return Err("the scenario cannot be set here; help: change its file".into());
            };
            if rest.is_empty() {
                return Err("give a field of the scenario, such as scenario.lidar.noise_std_m; help: choose another scenario with --scenario".into());
            }
            check_name(rest, "`scenario`", field_names::<Scenario>())?;
            *scenario = with_setting(scenario, rest, &self.value)?;
            return Ok(());
        }
        let fields = field_names::<Preset>();
        if !fields.contains(&first.split('[').next().unwrap_or_default())
            && let Some(longer) = paths::paths_ending_with(&self.path, preset.as_deref(), scenario.as_deref())
        {
            return Err(format!("`{}` is not the whole path: did you mean {longer}?", self.path));
        }
        check_name(&self.path, "a preset", fields)?;
        let Some(preset) = preset else {
            return Err(
                "there is no preset here, only a scenario; help: the path of a scenario field starts with `scenario.`".into(),
            );
        };
        *preset = with_setting(preset, &self.path, &self.value)?;
        Ok(())
    }

    fn error(&self, problem: String) -> SettingError {
        SettingError { setting: self.to_string(), problem }
    }

    /// Whether the field at `path`, the path of a diagnostic, is the setting's field or inside it. `path` has an index where the
    /// setting's path may have a star.
    fn contains(&self, path: &str) -> bool {
        let parts = |path: &'_ str| path.split(['.', '[']).map(str::to_owned).collect::<Vec<_>>();
        let (own, path) = (parts(&self.path), parts(path));
        own.len() <= path.len() && own.iter().zip(&path).all(|(own, part)| own == part || own == "*]")
    }
}

/// Checks the first name of `path` against the `known` fields of `owner`.
fn check_name(path: &str, owner: &str, known: &[&str]) -> Result<(), String> {
    let name = path.split(['.', '[']).next().unwrap_or_default();
    if known.contains(&name) {
        return Ok(());
    }
    Err(format!("unknown field `{name}` in {owner}: {}", choose(name, known, "the fields are")))
}

impl FromStr for Setting {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (path, value) = text.split_once('=').unwrap_or_default();
        let (path, value) = (path.trim(), value.trim());
        if path.is_empty() || value.is_empty() {
            return Err(
                "give PATH=VALUE, such as learning.gamma=0.97 or scenario.lidar.noise_std_m=0.02".into()
            );
        }
        Ok(Self { path: path.into(), value: value.into() })
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.path, self.value)
    }
}

impl fmt::Display for Settings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let texts: Vec<_> = self.0.iter().map(ToString::to_string).collect();
        f.write_str(&texts.join(", "))
    }
}

impl Serialize for Settings {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for Setting { path, value } in &self.0 {
            let mut value = with_plain_numbers(value);
            if RawValue::from_ron(&value).is_err() {
                // A line break ends a comment at the end of the value.
                value.push('\n');
            }
            map.serialize_entry(path, RawValue::from_ron(&value).map_err(S::Error::custom)?)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Settings {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Pairs;

        impl<'de> Visitor<'de> for Pairs {
            type Value = Settings;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a map of settings: {\"learning.gamma\": 0.97}")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Settings, A::Error> {
                let mut settings = Vec::new();
                while let Some((path, value)) = map.next_entry::<String, Box<RawValue>>()? {
                    settings.push(Setting { path, value: value.trim().get_ron().into() });
                }
                Ok(Settings(settings))
            }
        }

        deserializer.deserialize_map(Pairs)
    }
}

/// The error for settings from the command line, one line per problem.
impl From<Vec<SettingError>> for RunError {
    fn from(errors: Vec<SettingError>) -> Self {
        let lines: Vec<_> = errors.iter().map(|error| format!("--set {error}")).collect();
        Self::InvalidInput(lines.join("\n"))
    }
}

#[cfg(test)]
mod tests;
