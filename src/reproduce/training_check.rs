//! The check of an experiment's training runs by `--check`: whether all of them can be planned, and which of their
//! settings are questionable.

use std::cell::RefCell;
use std::path::Path;

use super::check;
use super::experiment::Experiment;
use super::plan::RunPlan;
use super::run_config::run_config;
use super::seeds::Seeds;
use super::selected::{ExperimentSource, SelectedExperiment};
use crate::run::RunError;
use crate::run::folder::RunConfig;
use crate::run::notes::{RunNote, run_notes};
use crate::scenario::{Diagnostic, FileError, Note, NoteLevel, overlap, parse_checked, printable_path};

impl Experiment {
    /// Checks the experiment with this `text`, from the file at `path`, and its training runs. Returns notes on their
    /// questionable settings, each at the path of the stage, or of the condition if that changes the stage.
    ///
    /// # Errors
    /// As for [`Experiment::parse`]; also if a training run is invalid after its overrides, a scenario, preset or run cannot
    /// be read, or a figure or table needs more training than there is. All invalid training runs are listed.
    pub fn check(text: &str, path: &Path) -> Result<Vec<Note>, FileError> {
        let notes = RefCell::new(Vec::new());
        let check = |experiment: &Self, unknown: &[String]| {
            let mut found = check::diagnostics(experiment, unknown);
            if check::is_small(experiment) {
                let (of_training_runs, invalid) = experiment.check_training_runs(path, unknown, &found);
                notes.replace(of_training_runs);
                found.extend(invalid);
            }
            found
        };
        parse_checked(text, path, check, |experiment| check(experiment, &[]))?;
        Ok(notes.into_inner())
    }

    /// Notes on the questionable settings of the training runs, and the runs' problems. The values at the paths `unknown` could
    /// not be read, and `found` are the problems of the file itself.
    fn check_training_runs(
        &self,
        path: &Path,
        unknown: &[String],
        found: &[Diagnostic],
    ) -> (Vec<Note>, Vec<Diagnostic>) {
        let from = path.display().to_string();
        let faulty: Vec<&str> =
            unknown.iter().map(String::as_str).chain(found.iter().map(|found| found.path.as_str())).collect();
        let is_faulty = |path: &str| faulty.iter().any(|other| overlap(other, path));
        // One seed is enough, because seeds change no setting.
        let first =
            Some(&self.seeds).filter(|_| !is_faulty("seeds")).and_then(|seeds| seeds.list().first().copied());
        let seeds = Seeds::List(vec![first.unwrap_or(1)]);
        let mut experiment = Self { seeds, ..self.clone() };
        experiment.evaluation = experiment.evaluation.filter(|_| !is_faulty("evaluation"));
        let mut findings = Findings { from: &from, unknown, notes: Vec::new(), invalid: Vec::new() };
        for (i, arm) in experiment.arms.iter_mut().enumerate() {
            for (k, stage) in arm.stages.iter_mut().enumerate() {
                stage.budget = stage.budget.filter(|_| !is_faulty(&format!("arms[{i}].stages[{k}].budget")));
            }
        }
        for condition in 0..experiment.conditions.len().max(1) {
            findings.check(&experiment, condition);
        }
        let planned = ["arms", "conditions", "overrides", "figures", "tables", "seeds"];
        if findings.invalid.is_empty() && !planned.iter().any(|part| is_faulty(part)) {
            let selected = SelectedExperiment {
                figures: (0..experiment.figures.len()).collect(),
                tables: (0..experiment.tables.len()).collect(),
                source: ExperimentSource { from: from.clone(), experiment },
            };
            if let Err(error) = RunPlan::new(&[selected]) {
                let message = without_path(&error, path);
                findings.invalid.push(Diagnostic { path: String::new(), message });
            }
        }
        (findings.notes, findings.invalid)
    }
}

/// The notes and problems found in the training runs so far.
struct Findings<'a> {
    from: &'a str,
    /// The paths of values that could not be read.
    unknown: &'a [String],
    notes: Vec<Note>,
    invalid: Vec<Diagnostic>,
}

impl Findings<'_> {
    /// Checks the training runs under a condition, except those with settings that could not be read.
    fn check(&mut self, experiment: &Experiment, condition: usize) {
        let is_known = |path: &str| !self.unknown.iter().any(|other| overlap(other, path));
        if !is_known("overrides") || !is_known(&format!("conditions[{condition}]")) {
            return;
        }
        let mut stages = Vec::new();
        for (i, arm) in experiment.arms.iter().enumerate() {
            for (k, stage) in arm.stages.iter().enumerate() {
                let at = format!("arms[{i}].stages[{k}]");
                if ["scenario", "preset", "overrides"].iter().all(|part| is_known(&format!("{at}.{part}"))) {
                    stages.push((at, arm, stage));
                }
            }
        }
        for (at, arm, stage) in stages {
            let at = match experiment.conditions.get(condition) {
                Some(found) if found.changes(arm, stage) => format!("conditions[{condition}]"),
                _ => at,
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

    /// Adds the notes of a training run, except those that an earlier run has too. For a condition, whose settings are unusual
    /// on purpose, it adds only the warnings.
    fn add_notes(&mut self, at: &str, arm: &str, config: &RunConfig) {
        let is_wanted =
            |found: &RunNote| found.note.level == NoteLevel::Warning || !at.starts_with("conditions");
        for found in run_notes(config).into_iter().filter(is_wanted) {
            let message = format!("(arm \"{arm}\"): {found}");
            let is_same = |other: &Note| other.diagnostic.message.ends_with(&format!("): {found}"));
            if !self.notes.iter().any(is_same) {
                self.notes.push(Note::new(found.note.level, at, message));
            }
        }
    }
}

/// The message of an error, without the path of the experiment at its start.
fn without_path(error: &RunError, path: &Path) -> String {
    let message = error.to_string();
    let prefix = format!("{}: ", printable_path(path));
    message.strip_prefix(&prefix).unwrap_or(&message).to_owned()
}
