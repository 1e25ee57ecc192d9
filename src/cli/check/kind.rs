//! The kind of a file, by its content, and the check of each kind.

use std::path::Path;

use crate::reproduce::Experiment;
use crate::run::folder::RunConfig;
use crate::run::notes::preset_notes;
use crate::run::policy_card;
use crate::run::preset::Preset;
use crate::scenario::{
    FileError, LocatedDiagnostic, Note, NoteLevel, Scenario, locate, notes, read_text, resemblance,
};

/// The kind of a file that can be checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A scenario.
    Scenario,
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
            Self::Preset => "preset",
            Self::Experiment => "experiment",
            Self::RunConfig => "run configuration",
            Self::Policy => "policy",
        }
    }

    /// The kind of a RON file: the one whose name begins the text, or else the one with most of the text's fields. A text
    /// that could be of any kind is a scenario.
    pub fn of_text(text: &str) -> Self {
        let resemblances = [
            (resemblance::<RunConfig>(text, "RunConfig"), Self::RunConfig),
            (resemblance::<Experiment>(text, "Experiment"), Self::Experiment),
            (resemblance::<Preset>(text, "Preset"), Self::Preset),
            (resemblance::<Scenario>(text, "Scenario"), Self::Scenario),
        ];
        // The last of several kinds with equally many fields.
        resemblances.into_iter().max_by_key(|(fields, _)| *fields).map_or(Self::Scenario, |(_, kind)| kind)
    }
}

/// The notes on a valid file, with their locations.
pub type LocatedNotes = Vec<(NoteLevel, LocatedDiagnostic)>;

/// The kind of the file at `path`, if it can be read, and its notes, or its problems.
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
        FileKind::Preset => Preset::parse(&text, path).map(|preset| preset_notes(&preset, None, false)),
        FileKind::Experiment => {
            Experiment::parse(&text, path).and_then(|experiment| experiment.training_notes(path, &text))
        }
        FileKind::RunConfig => RunConfig::parse(&text, path).map(|_| Vec::new()),
        FileKind::Scenario | FileKind::Policy => {
            Scenario::parse(&text, path).map(|scenario| notes(&scenario))
        }
    };
    (Some(kind), found.map(|notes| located(&text, &notes)))
}

fn located(text: &str, notes: &[Note]) -> LocatedNotes {
    let located = locate(text, notes.iter().map(|note| &note.diagnostic));
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
            ("Preset()", FileKind::Preset),
            ("", FileKind::Scenario),
        ] {
            assert_eq!(FileKind::of_text(text), kind, "{text}");
        }
    }
}
