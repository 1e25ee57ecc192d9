//! What is written to files: the policy, the whole run, the rows, the curves, the world.
//!
//! In: what is wanted, and where. Out: a file or a folder, whole or not at all.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use bevy::prelude::*;

use super::journal::JOURNAL;
use super::{Session, TrainingHistory};
use crate::app::commands::{SaveKind, SessionMode};
use crate::run::folder::{INITIAL_POLICY_FILE, RunFolder, write_atomic};
use crate::run::metric_rows::EvaluationRow;
use crate::run::{RunError, checkpoint, metrics};
use crate::scenario::to_ron;

impl Session {
    /// The file name that is proposed for `what`.
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
            SaveKind::Scenario => "my-world.ron".into(),
        }
    }

    /// Writes `what` to `path`.
    ///
    /// # Errors
    /// It cannot be written; a run's folder holds something already.
    pub(super) fn save(&mut self, world: &mut World, what: SaveKind, path: &Path) -> Result<(), RunError> {
        let failed = |error: String| RunError::failed(path, error);
        match what {
            SaveKind::Policy => {
                // Of a training that went wrong the best that it had.
                let bytes = match &self.trainer_state.best {
                    Some(best) if self.broken => best.bytes.clone(),
                    _ => metrics::policy_bytes(&metrics::policy(&self.config, world))?,
                };
                write_atomic(path, |file| file.write_all(&bytes)).map_err(|error| failed(error.to_string()))
            }
            SaveKind::Scenario => {
                let (scenario, like) =
                    (Arc::new(self.config.scenario.clone()), self.config.scenario_from.clone());
                self.save_scenario(&scenario, &like, path)
            }
            SaveKind::Csv => {
                let curves = &mut world.resource_mut::<TrainingHistory>().0;
                curves.write_csv(path).map_err(|error| failed(error.to_string()))
            }
            SaveKind::Png => {
                let title = self.config.description();
                world.resource_mut::<TrainingHistory>().0.write_png(&title, path).map_err(failed)
            }
            SaveKind::Run => self.save_run(world, path),
        }
    }

    /// Writes a folder that `--train --resume` goes on from, and `journal.ron` beside its files. The training is taken up
    /// for a moment, if it was set aside.
    fn save_run(&mut self, world: &mut World, path: &Path) -> Result<(), RunError> {
        if cfg!(target_arch = "wasm32") {
            let instead = "a browser saves no folders: save the policy, the episodes and the world";
            return Err(RunError::InvalidInput(instead.into()));
        }
        let occupied = std::fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some());
        if occupied || path.is_file() {
            return Err(RunError::invalid_input(path, "there is something already: choose another name"));
        }
        if self.broken {
            let instead =
                "this training went wrong and cannot go on: save its best policy, its episodes or its curves";
            return Err(RunError::InvalidInput(instead.into()));
        }
        let (mode, pace) = (self.mode, self.pacer.pace);
        self.set_mode(world, SessionMode::Train)?;
        let saved = self.write_run_whole(world, path);
        self.set_mode(world, mode)?;
        self.pacer.pace = pace;
        saved
    }

    /// Writes it beside `path` first: should that fail, nothing is left behind.
    fn write_run_whole(&mut self, world: &mut World, path: &Path) -> Result<(), RunError> {
        let failed = |error: std::io::Error| RunError::failed(path, format!("can't be written: {error}"));
        let beside = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        std::fs::create_dir_all(beside).map_err(failed)?;
        let temporary = tempfile::Builder::new().prefix(".saving-").tempdir_in(beside).map_err(failed)?;
        let written = temporary.path().join("run");
        self.write_run(world, &written)?;
        std::fs::rename(&written, path).map_err(failed)
    }

    fn write_run(&mut self, world: &mut World, path: &Path) -> Result<(), RunError> {
        self.poll_evaluations(world, true)?;
        let folder = RunFolder::create(Some(path.into()), &self.config)?;
        let failed = |name: &str, error: String| RunError::failed(&path.join(name), error);
        let episodes = path.join("episodes.csv");
        let rows = world.resource_mut::<TrainingHistory>().0.write_csv(&episodes);
        rows.map_err(|error| failed("episodes.csv", error.to_string()))?;
        let mut evaluations = folder.csv::<EvaluationRow>("evaluations.csv", 0, &[])?;
        for row in &self.evaluations {
            evaluations.serialize(row).map_err(|error| failed("evaluations.csv", error.to_string()))?;
        }
        evaluations.flush().map_err(|error| failed("evaluations.csv", error.to_string()))?;
        let length = |name: &str| std::fs::metadata(path.join(name)).map(|file| file.len());
        self.trainer_state.episodes_bytes =
            length("episodes.csv").map_err(|error| failed("episodes.csv", error.to_string()))?;
        self.trainer_state.evaluations_bytes =
            length("evaluations.csv").map_err(|error| failed("evaluations.csv", error.to_string()))?;
        self.trainer_state.wall_s = self.wall_s();
        checkpoint::save(&folder, world, &mut self.trainer_state)?;
        let bytes = metrics::policy_bytes(&metrics::policy(&self.config, world))?;
        folder.write("policy-last.safetensors", |file| file.write_all(&bytes))?;
        if let Some(best) = &self.trainer_state.best {
            folder.write("policy.safetensors", |file| file.write_all(&best.bytes))?;
        }
        if let Some(init) = &self.init {
            let bytes = metrics::policy_bytes(init)?;
            folder.write(INITIAL_POLICY_FILE, |file| file.write_all(&bytes))?;
        }
        let journal = to_ron(&self.journal).map_err(|error| failed(JOURNAL, error.to_string()))?;
        folder.write(JOURNAL, |file| file.write_all(journal.as_bytes()))
    }
}
