//! The check of an experiment's trainings, as `--check` makes it: whether all of them can be planned, and what is doubtful in
//! their settings.

use std::path::Path;

use super::experiment::Experiment;
use super::plan::RunPlan;
use super::run_config::run_config;
use super::seeds::Seeds;
use super::selected::{ExperimentSource, SelectedExperiment};
use crate::run::RunError;
use crate::run::folder::RunConfig;
use crate::run::notes::{RunNote, run_notes};
use crate::scenario::{Diagnostic, FileError, Note, NoteLevel, printable_path};

impl Experiment {
    /// The doubtful settings of the trainings of this experiment, whose file is `path` with this `text`. Each is at the stage,
    /// or at the condition that makes the setting doubtful.
    ///
    /// # Errors
    /// Trainings are invalid after their overrides, a scenario, preset or run cannot be read, or a figure or table needs more
    /// training than there is. All invalid trainings are listed.
    pub fn training_notes(&self, path: &Path, text: &str) -> Result<Vec<Note>, FileError> {
        let from = path.display().to_string();
        // Seeds change no setting.
        let seeds = self.seeds.list().first().map_or_else(Seeds::default, |&seed| Seeds::List(vec![seed]));
        let experiment = Self { seeds, ..self.clone() };
        let mut found = Found { from: &from, notes: Vec::new(), invalid: Vec::new() };
        for condition in 0..experiment.conditions.len().max(1) {
            found.check_trainings(&experiment, condition);
        }
        if found.invalid.is_empty() {
            let selected = SelectedExperiment {
                figures: (0..experiment.figures.len()).collect(),
                tables: (0..experiment.tables.len()).collect(),
                source: ExperimentSource { from: from.clone(), experiment },
            };
            if let Err(error) = RunPlan::new(&[selected]) {
                return Err(FileError::for_file(path, without_path(&error, path)));
            }
            return Ok(found.notes);
        }
        Err(FileError::from_diagnostics(path, text, &found.invalid))
    }
}

/// What was found in the trainings so far.
struct Found<'a> {
    from: &'a str,
    notes: Vec<Note>,
    invalid: Vec<Diagnostic>,
}

impl Found<'_> {
    /// Checks the trainings under a condition.
    fn check_trainings(&mut self, experiment: &Experiment, condition: usize) {
        for (i, arm) in experiment.arms.iter().enumerate() {
            for (k, stage) in arm.stages.iter().enumerate() {
                let at = match experiment.conditions.get(condition) {
                    Some(found) if found.changes(arm, stage) => format!("conditions[{condition}]"),
                    _ => format!("arms[{i}].stages[{k}]"),
                };
                match run_config(self.from, experiment, condition, (arm, stage), 1) {
                    Ok(config) => self.add_notes(&at, &arm.name, &config),
                    Err(error) => {
                        let message =
                            format!("cannot be trained: {}", without_path(&error, Path::new(self.from)));
                        let problem = Diagnostic { path: at, message };
                        if !self.invalid.contains(&problem) {
                            self.invalid.push(problem);
                        }
                    }
                }
            }
        }
    }

    /// Adds the notes of a training, except those that another training has, too. Of a condition, whose settings are unusual on
    /// purpose, only the warnings.
    fn add_notes(&mut self, at: &str, arm: &str, config: &RunConfig) {
        let is_wanted =
            |found: &RunNote| found.note.level == NoteLevel::Warning || !at.starts_with("conditions");
        for found in run_notes(config).into_iter().filter(is_wanted) {
            let message = format!("(arm \"{arm}\"): {found}");
            let is_known = |known: &Note| known.diagnostic.message.ends_with(&format!("): {found}"));
            if !self.notes.iter().any(is_known) {
                self.notes.push(Note::new(found.note.level, at, message));
            }
        }
    }
}

/// An error without the path of the experiment at its start.
fn without_path(error: &RunError, path: &Path) -> String {
    let message = error.to_string();
    let prefix = format!("{}: ", printable_path(path));
    message.strip_prefix(&prefix).unwrap_or(&message).to_owned()
}
