//! Files written by the app: the policy, the run, the episodes, the curves, the scenario.
//!
//! In: the part to save, and a path. Out: a file or a folder. After a failure, nothing is left behind.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use bevy::prelude::*;

use super::TrainingHistory;
use super::active_mode::while_training;
use super::editor_files;
use super::evaluations::{self, Evaluations};
use super::journal::{JOURNAL, Journal};
use super::training_run::TrainingRun;
use crate::app::commands::SaveKind;
use crate::run::folder::{RunFolder, write_atomic};
use crate::run::metric_rows::EvaluationRow;
use crate::run::{RunError, checkpoint, metrics, shipped};
use crate::scenario::to_ron;

impl TrainingRun {
    /// The suggested name of the file.
    #[must_use]
    pub fn suggested_file_name(&self, what: SaveKind) -> String {
        let config = &self.config;
        let name = format!("{}-{}-{}", config.scenario_name(), config.preset_name(), config.seed);
        match what {
            SaveKind::Policy => format!("{name}.safetensors"),
            SaveKind::Run => name,
            SaveKind::Csv => format!("{name}-episodes.csv"),
            SaveKind::Png if cfg!(target_arch = "wasm32") => format!("{name}-curves.svg"),
            SaveKind::Png => format!("{name}-curves.png"),
            SaveKind::Scenario => "my-scenario.ron".into(),
        }
    }
}

/// Saves `what` to `path`.
///
/// # Errors
/// The file cannot be written. A run is not saved over existing files, nor after it has failed.
pub(super) fn save(world: &mut World, what: SaveKind, path: &Path) -> Result<(), RunError> {
    let failed = |error: String| RunError::failed(path, error);
    match what {
        SaveKind::Policy => {
            let bytes = policy_bytes(world)?;
            write_atomic(path, |file| file.write_all(&bytes)).map_err(|error| failed(error.to_string()))
        }
        SaveKind::Scenario => {
            let config = &world.resource::<TrainingRun>().config;
            let (scenario, based_on) = (Arc::new(config.scenario.clone()), config.scenario_from.clone());
            editor_files::save_scenario(world, &scenario, &based_on, path)
        }
        SaveKind::Csv => {
            let curves = &mut world.resource_mut::<TrainingHistory>().0;
            curves.write_csv(path).map_err(|error| failed(error.to_string()))
        }
        SaveKind::Png => {
            let config = &world.resource::<TrainingRun>().config;
            let (title, in_paper_scenario) =
                (config.description(), shipped::is_paper_scenario_1(&config.scenario));
            let curves = &mut world.resource_mut::<TrainingHistory>().0;
            curves.write_figure(&title, in_paper_scenario, path)
        }
        SaveKind::Run => save_run(world, path),
    }
}

/// The current policy as a file; after a failure of the training, its best policy.
fn policy_bytes(world: &World) -> Result<Vec<u8>, RunError> {
    let run = world.resource::<TrainingRun>();
    match &run.trainer_state.best {
        Some(best) if run.has_failed => Ok(best.bytes.clone()),
        _ => metrics::policy_bytes(&metrics::policy(&run.config, world)),
    }
}

/// Saves a folder that `--train --resume` can continue, with `journal.ron` in it. A suspended training is resumed while
/// it is saved.
fn save_run(world: &mut World, path: &Path) -> Result<(), RunError> {
    if cfg!(target_arch = "wasm32") {
        let why =
            "A browser cannot save folders\nhelp: save the policy, the episodes and the scenario instead";
        return Err(RunError::InvalidInput(why.into()));
    }
    let is_occupied = std::fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some());
    if is_occupied || path.is_file() {
        return Err(RunError::invalid_input(path, "this already exists\nhelp: choose another name"));
    }
    if world.resource::<TrainingRun>().has_failed {
        let why = "This training has failed and cannot continue\n\
                   help: save its best policy, its episodes or its curves instead";
        return Err(RunError::InvalidInput(why.into()));
    }
    while_training(world, |world| write_run_atomically(world, path))
}

/// Writes the run to a temporary folder next to `path` first, so that a failure leaves nothing behind.
fn write_run_atomically(world: &mut World, path: &Path) -> Result<(), RunError> {
    let failed = |error: std::io::Error| RunError::failed(path, format!("cannot be written: {error}"));
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    std::fs::create_dir_all(parent).map_err(failed)?;
    let temporary = tempfile::Builder::new().prefix(".saving-").tempdir_in(parent).map_err(failed)?;
    let written = temporary.path().join("run");
    write_run(world, &written)?;
    std::fs::rename(&written, path).map_err(failed)
}

fn write_run(world: &mut World, path: &Path) -> Result<(), RunError> {
    evaluations::record_finished(world, true)?;
    world.resource_scope(|world, mut run: Mut<TrainingRun>| {
        let initial_policy = run.initial_policy.as_ref().map(metrics::policy_bytes).transpose()?;
        let folder = RunFolder::create(Some(path.into()), &run.config, initial_policy.as_deref())?;
        write_rows(world, &mut run, &folder)?;
        run.trainer_state.wall_s = run.wall_s();
        checkpoint::save(&folder, world, &mut run.trainer_state)?;
        write_policies(world, &run, &folder)?;
        let failed = |error: String| RunError::failed(&path.join(JOURNAL), error);
        let journal = to_ron(world.resource::<Journal>()).map_err(|error| failed(error.to_string()))?;
        folder.write(JOURNAL, |file| file.write_all(journal.as_bytes()))
    })
}

/// Writes the rows of episodes and evaluations, and records the lengths of both files.
fn write_rows(world: &mut World, run: &mut TrainingRun, folder: &RunFolder) -> Result<(), RunError> {
    let file = |name: &str| folder.path().join(name);
    let failed = |name: &str, error: String| RunError::failed(&file(name), error);
    let rows = world.resource_mut::<TrainingHistory>().0.write_csv(&file("episodes.csv"));
    rows.map_err(|error| failed("episodes.csv", error.to_string()))?;
    let mut evaluations = folder.csv::<EvaluationRow>("evaluations.csv", 0, &[])?;
    for row in &world.resource::<Evaluations>().rows {
        evaluations.serialize(row).map_err(|error| failed("evaluations.csv", error.to_string()))?;
    }
    evaluations.flush().map_err(|error| failed("evaluations.csv", error.to_string()))?;
    let length = |name: &str| {
        let file = std::fs::metadata(file(name)).map_err(|error| failed(name, error.to_string()))?;
        Ok::<_, RunError>(file.len())
    };
    run.trainer_state.episodes_bytes = length("episodes.csv")?;
    run.trainer_state.evaluations_bytes = length("evaluations.csv")?;
    Ok(())
}

/// Writes the last policy and the best one.
fn write_policies(world: &World, run: &TrainingRun, folder: &RunFolder) -> Result<(), RunError> {
    let bytes = metrics::policy_bytes(&metrics::policy(&run.config, world))?;
    folder.write("policy-last.safetensors", |file| file.write_all(&bytes))?;
    if let Some(best) = &run.trainer_state.best {
        folder.write("policy.safetensors", |file| file.write_all(&best.bytes))?;
    }
    Ok(())
}
