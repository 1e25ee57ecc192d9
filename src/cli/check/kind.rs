//! The kind of a file, by its content, and the check of each kind.

use std::path::Path;

use crate::drivers::DriverConfig;
use crate::reproduce::Experiment;
use crate::run::RunError;
use crate::run::folder::RunConfig;
use crate::run::notes::preset_notes;
use crate::run::policy_card;
use crate::run::preset::Preset;
use crate::run::{scenario_set, shipped, suite};
use crate::scenario::{
    Diagnostic, FileError, LevelGenerator, LocatedDiagnostic, Note, NoteLevel, Scenario, ScenarioSetFile,
    SuiteFile, locate, notes, quoted, read_text, resemblance,
};

/// Number of levels that are generated to check a level generator.
const CHECKED_LEVELS: u64 = 8;

/// The kind of a file that can be checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A scenario.
    Scenario,
    /// A set of scenarios.
    ScenarioSet,
    /// A level generator.
    LevelGenerator,
    /// A suite.
    Suite,
    /// The parameters of a classical driver.
    Driver,
    /// A training preset.
    Preset,
    /// An experiment.
    Experiment,
    /// The configuration of a run.
    RunConfig,
    /// A trained policy.
    Policy,
}

impl FileKind {
    /// The kind's name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scenario => "scenario",
            Self::ScenarioSet => "set of scenarios",
            Self::LevelGenerator => "level generator",
            Self::Suite => "suite",
            Self::Driver => "driver",
            Self::Preset => "preset",
            Self::Experiment => "experiment",
            Self::RunConfig => "run configuration",
            Self::Policy => "policy",
        }
    }

    /// The kind of a RON file: the one whose name the text begins with, or else the one that has the most of the text's fields.
    /// A text that could be of any kind is a scenario.
    pub fn of_text(text: &str) -> Self {
        // `max_by_key` chooses the last of several kinds that match equally well.
        let kinds = [
            Self::ScenarioSet,
            Self::RunConfig,
            Self::Experiment,
            Self::Driver,
            Self::Suite,
            Self::Preset,
            Self::LevelGenerator,
            Self::Scenario,
        ];
        kinds.into_iter().max_by_key(|kind| kind.resemblance(text)).unwrap_or(Self::Scenario)
    }

    /// How well `text` matches this kind: how many of its fields the kind has, or `usize::MAX` if it begins with the kind's name.
    fn resemblance(self, text: &str) -> usize {
        match self {
            Self::Scenario => resemblance::<Scenario>(text, "Scenario"),
            Self::ScenarioSet => resemblance::<ScenarioSetFile>(text, "ScenarioSet"),
            Self::LevelGenerator => resemblance::<LevelGenerator>(text, "LevelGenerator"),
            Self::Suite => resemblance::<SuiteFile>(text, "Suite"),
            Self::Driver if DriverConfig::looks_like(text) => usize::MAX,
            Self::Driver => 0,
            Self::Preset => resemblance::<Preset>(text, "Preset"),
            Self::Experiment => resemblance::<Experiment>(text, "Experiment"),
            Self::RunConfig => resemblance::<RunConfig>(text, "RunConfig"),
            Self::Policy => 0,
        }
    }

    /// How a file of this kind is given on the command line.
    fn usage(self, file: &str) -> String {
        match self {
            Self::Scenario | Self::LevelGenerator | Self::ScenarioSet => {
                format!("--train --scenario {file}")
            }
            Self::Suite => format!("--eval POLICY --suite {file}"),
            Self::Preset => format!("--train --preset {file}"),
            Self::Experiment => format!("--reproduce --experiment {file}"),
            Self::RunConfig => format!("--train {file}"),
            Self::Policy | Self::Driver => format!("--eval {file}"),
        }
    }
}

/// Checks that the RON file `path` is not clearly of another kind than `wanted`. A file that cannot be read, or whose kind is in
/// doubt, passes: its problems are reported when it is read. The configuration of a run passes as its scenario or preset, and a
/// level generator or a set of scenarios as a scenario.
///
/// # Errors
/// The file is of another kind. The message names the kind, and how such a file is given.
pub fn expect_kind(path: &Path, wanted: FileKind) -> Result<(), RunError> {
    // Standard input can be read only once.
    if !path.is_file() {
        return Ok(());
    }
    let Ok(text) = read_text(path) else { return Ok(()) };
    let kind = FileKind::of_text(&text);
    // A run has a scenario and a preset, and some modes take a set or a generator in place of a scenario.
    let is_wanted = match kind {
        FileKind::RunConfig => true,
        FileKind::LevelGenerator | FileKind::ScenarioSet => wanted == FileKind::Scenario,
        _ => kind.resemblance(&text) <= wanted.resemblance(&text),
    };
    if is_wanted {
        return Ok(());
    }
    let article = if kind == FileKind::Experiment { "an" } else { "a" };
    let (name, usage) = (kind.name(), kind.usage(&quoted(path)));
    Err(RunError::invalid_input(path, format!("is {article} {name}, not a {}; help: {usage}", wanted.name())))
}

/// The notes on a valid file, with their locations.
pub type LocatedNotes = Vec<(NoteLevel, LocatedDiagnostic)>;

/// Checks the file at `path`. Returns its kind, if it can be read, and its notes or its problems.
pub fn check(path: &Path) -> (Option<FileKind>, Result<LocatedNotes, FileError>) {
    if path.extension().is_some_and(|extension| extension == "safetensors") {
        return (
            Some(FileKind::Policy),
            policy_card::read_unnamed(path).map(|_| Vec::new()).map_err(|why| FileError::for_file(path, why)),
        );
    }
    let text = match read_text(path) {
        Ok(text) => text,
        Err(error) => return (None, Err(error)),
    };
    let kind = FileKind::of_text(&text);
    let found = match kind {
        FileKind::Preset => check_preset(&text, path).map(|preset| preset_notes(&preset, None, false)),
        FileKind::Experiment => Experiment::check(&text, path),
        FileKind::LevelGenerator => check_levels(&text, path).map(|()| Vec::new()),
        FileKind::RunConfig => RunConfig::parse(&text, path).map(|_| Vec::new()),
        // Whether one policy fits all scenarios depends on the preset.
        FileKind::ScenarioSet => scenario_set::parse(&text, path).map(|_| Vec::new()),
        FileKind::Suite => suite::load::parse(&text, path).map(|_| Vec::new()),
        FileKind::Driver => DriverConfig::parse(&text, path).map(|_| Vec::new()),
        FileKind::Scenario | FileKind::Policy => {
            Scenario::parse(&text, path).map(|scenario| notes(&scenario))
        }
    };
    (Some(kind), found.map(|notes| located(kind, &text, path, &notes)))
}

/// Checks a preset, and the scenario that it names.
fn check_preset(text: &str, path: &Path) -> Result<Preset, FileError> {
    let preset = Preset::parse(text, path)?;
    let check_named = |name: &str| {
        let (_, set) = shipped::scenario_or_set(name)?;
        set.map_or(Ok(()), |set| scenario_set::check_fit(&set, name, preset.fit()))
    };
    let Some(Err(error)) = preset.scenario.as_deref().map(check_named) else { return Ok(preset) };
    let diagnostic = Diagnostic { path: "scenario".into(), message: format!("cannot be used: {error}") };
    Err(FileError::from_located(path, Preset::locate(text, path, [diagnostic].iter())))
}

/// Checks a level generator, and that its first levels can be made.
fn check_levels(text: &str, path: &Path) -> Result<(), FileError> {
    let generator = LevelGenerator::parse(text, path)?;
    let failure = (0..CHECKED_LEVELS).find_map(|seed| generator.level(seed).err());
    failure.map_or(Ok(()), |error| Err(FileError::for_file(path, error.to_string())))
}

fn located(kind: FileKind, text: &str, path: &Path, notes: &[Note]) -> LocatedNotes {
    let diagnostics = notes.iter().map(|note| &note.diagnostic);
    let located = match kind {
        FileKind::Preset => Preset::locate(text, path, diagnostics),
        _ => locate(text, diagnostics),
    };
    notes.iter().map(|note| note.level).zip(located).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fields_decide_the_kind() {
        for (text, kind) in [
            ("(\n    about: \"x\",\n    arenas: 16,\n)", FileKind::Preset),
            ("(budget : EnvSteps(1), lerning: ())", FileKind::Preset),
            ("(name: \"arenas\", // learning is fun\n obstacles: [(shap: 1)])", FileKind::Scenario),
            ("(title: \"x\", arms: [(name: \"a\", stages: [(budget: Episodes(1))])])", FileKind::Experiment),
            ("(version: \"1\", seed: 1, scenario: (name: \"a\"), preset: ())", FileKind::RunConfig),
            ("(name: \"a\", scenarios: [(scenario: \"b\")])", FileKind::ScenarioSet),
            ("(name: \"a\", traffic: [Lanes()])", FileKind::LevelGenerator),
            ("(name: \"a\", wall_layouts: [Rooms()], robot: ())", FileKind::LevelGenerator),
            ("(name: \"a\", families: [(scenarios: [\"b\"])])", FileKind::Suite),
            ("// Mine.\nDwaCv(dwa: (speed: 2))", FileKind::Driver),
            ("Preset()", FileKind::Preset),
            ("", FileKind::Scenario),
        ] {
            assert_eq!(FileKind::of_text(text), kind, "{text}");
        }
    }
}
