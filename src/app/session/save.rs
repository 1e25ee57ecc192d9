//! Files written by the app: the policy, the run, the episodes, the curves, the scenario.
//!
//! In: the part to save, and a path. Out: a file or a folder. After a failure, nothing is left behind.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy::prelude::*;

use super::TrainingHistory;
#[cfg(not(target_arch = "wasm32"))]
use super::active_mode::while_training;
use super::editor_files;
#[cfg(not(target_arch = "wasm32"))]
use super::evaluations;
use super::evaluations::Evaluations;
#[cfg(not(target_arch = "wasm32"))]
use super::run_snapshot::RunSnapshot;
use super::session_policy;
use super::training_run::TrainingRun;
use crate::app::commands::{FigureFormat, PolicySource, SaveKind};
use crate::app::history::write_figure;
use crate::report::run_figure::RunFigure;
use crate::run::metric_rows::EvaluationRow;
use crate::run::output_file::write_atomic;
use crate::run::{RunError, metrics};

impl TrainingRun {
    /// The suggested name of the file or folder for `what`.
    #[must_use]
    pub fn suggested_file_name(&self, what: SaveKind) -> String {
        let config = &self.config;
        let name = config.run_name();
        match what {
            SaveKind::Policy => format!("{name}.safetensors"),
            SaveKind::BestPolicy => format!("{name}-best.safetensors"),
            SaveKind::Run => name,
            SaveKind::Csv => format!("{name}-episodes.csv"),
            SaveKind::Figure(FigureFormat::Png) => format!("{name}-curves.png"),
            SaveKind::Figure(FigureFormat::Svg) => format!("{name}-curves.svg"),
            SaveKind::Scenario => "my-scenario.ron".into(),
        }
    }
}

/// Saves `what` to `path`.
///
/// # Errors
/// The file cannot be written, no best policy exists yet, or the scenario is a set. A run is not saved over existing files, nor
/// after it has failed.
pub(super) fn save(world: &mut World, what: SaveKind, path: &Path) -> Result<(), RunError> {
    let failed = |error: String| RunError::failed(path, error);
    match what {
        SaveKind::Policy | SaveKind::BestPolicy => {
            let bytes = policy_bytes(world, what)?;
            write_atomic(path, |file| file.write_all(&bytes)).map_err(|error| failed(error.to_string()))
        }
        SaveKind::Scenario => {
            let config = &world.resource::<TrainingRun>().config;
            if let Some(set) = &config.scenario_set {
                let why = "the app cannot save a set of scenarios\nhelp: copy its file";
                return Err(RunError::InvalidInput(format!("{}: {why}", set.name)));
            }
            let (scenario, based_on) = (Arc::new(config.scenario.clone()), config.scenario_from.clone());
            editor_files::save_scenario(world, &scenario, &based_on, path)
        }
        SaveKind::Csv => {
            let history = &mut world.resource_mut::<TrainingHistory>().0;
            history.write_csv(path).map_err(|error| failed(error.to_string()))
        }
        SaveKind::Figure(_) => write_figure(&figure(world), path),
        SaveKind::Run => save_run(world, path),
    }
}

/// The figure of the learning curves, with the marks and reference lines of the screen.
fn figure(world: &mut World) -> RunFigure {
    let run = world.resource::<TrainingRun>();
    let best = world.resource::<Evaluations>().best(&run.trainer_state).map(EvaluationRow::point);
    let is_paper_scenario_1 = run.config.is_paper_scenario_1();
    let title = run.config.description();
    world.resource_mut::<TrainingHistory>().0.figure(title, best, is_paper_scenario_1)
}

/// The current policy or the best one as a file. After training has failed, the best one if there is one.
fn policy_bytes(world: &World, what: SaveKind) -> Result<Vec<u8>, RunError> {
    let run = world.resource::<TrainingRun>();
    let is_best = what == SaveKind::BestPolicy || (run.has_failed && run.trainer_state.best.is_some());
    let source = if is_best { PolicySource::Best } else { PolicySource::Current };
    let (_, policy) = session_policy::policy(world, source)?;
    metrics::policy_bytes(&policy)
}

/// Saves a folder that `--train --resume` can continue, with `journal.ron` in it. A suspended training run is resumed while
/// it is saved.
#[cfg(not(target_arch = "wasm32"))]
fn save_run(world: &mut World, path: &Path) -> Result<(), RunError> {
    let is_occupied = std::fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some());
    if is_occupied || path.is_file() {
        return Err(RunError::invalid_input(path, "already exists\nhelp: choose another name"));
    }
    if world.resource::<TrainingRun>().has_failed {
        let why = "This training run has failed and cannot continue\n\
                   help: save its best policy, its episodes or its curves instead";
        return Err(RunError::InvalidInput(why.into()));
    }
    write_run_atomically(&complete_snapshot(world)?, path)
}

#[cfg(target_arch = "wasm32")]
fn save_run(_: &mut World, _: &Path) -> Result<(), RunError> {
    let why = "A browser cannot save folders\nhelp: save the policy, the episodes and the scenario instead";
    Err(RunError::InvalidInput(why.into()))
}

/// Waits for the running evaluation, if any, then copies the run, with that evaluation's result and any scenario changes made in
/// a demo.
///
/// # Errors
/// An evaluation failed, or the rows of the episodes could not be stored.
#[cfg(not(target_arch = "wasm32"))]
pub(super) fn complete_snapshot(world: &mut World) -> Result<RunSnapshot, RunError> {
    while_training(world, |world| {
        evaluations::record_finished(world, true)?;
        RunSnapshot::capture(world, 0)
    })
}

/// Writes the run to a temporary folder next to `path` first, so that a failure leaves nothing behind.
#[cfg(not(target_arch = "wasm32"))]
fn write_run_atomically(snapshot: &RunSnapshot, path: &Path) -> Result<(), RunError> {
    let failed = |error: std::io::Error| RunError::failed(path, format!("cannot be written: {error}"));
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(parent).map_err(failed)?;
    let temporary = tempfile::Builder::new().prefix(".saving-").tempdir_in(parent).map_err(failed)?;
    let written = temporary.path().join("run");
    snapshot.write(&written, None)?;
    std::fs::rename(&written, path).map_err(failed)
}

/// A path for the download `name`.
#[cfg(target_arch = "wasm32")]
pub(crate) fn unused_path(name: &str) -> PathBuf {
    name.into()
}

/// An unused path for `name` under `runs/`.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn unused_path(name: &str) -> PathBuf {
    let runs = std::path::absolute("runs").unwrap_or_else(|_| "runs".into());
    // If the folder cannot be created, saving reports the error.
    let _ = std::fs::create_dir_all(&runs);
    // The name of a run's folder may end in a number with a decimal point.
    let extension = name.rsplit_once('.').filter(|(_, end)| end.chars().all(char::is_alphabetic));
    let (stem, extension) = extension.map_or((name, String::new()), |(stem, end)| (stem, format!(".{end}")));
    let numbered = (2..).map(|number| runs.join(format!("{stem}-{number}{extension}")));
    std::iter::once(runs.join(name)).chain(numbered).find(|path| !path.exists()).unwrap_or_default()
}
