//! What is written to files: the policy, the whole run, the rows, the curves, the world.
//!
//! In: what is wanted, and where. Out: a file or a folder, whole or not at all.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use bevy::prelude::*;

use super::journal::JOURNAL;
use super::{Curves, Session};
use crate::app::orders::{Mode, Saved};
use crate::run::folder::{INIT, RunFolder, write_whole};
use crate::run::records::EvaluationRow;
use crate::run::{RunError, checkpoint, follow};
use crate::scenario::to_ron;

impl Session {
    /// The file name that is proposed for `what`.
    #[must_use]
    pub fn proposed_name(&self, what: Saved) -> String {
        let config = &self.config;
        let name = format!("{}-{}-{}", config.scenario_name(), config.preset_name(), config.seed);
        match what {
            Saved::Policy => format!("{name}.safetensors"),
            Saved::Run => name,
            Saved::Csv => format!("{name}-episodes.csv"),
            Saved::Png if cfg!(target_arch = "wasm32") => format!("{name}-curves.svg"),
            Saved::Png => format!("{name}-curves.png"),
            Saved::Scenario => "my-world.ron".into(),
        }
    }

    /// Writes `what` to `path`.
    ///
    /// # Errors
    /// It cannot be written; a run's folder holds something already.
    pub(super) fn save(&mut self, world: &mut World, what: Saved, path: &Path) -> Result<(), RunError> {
        let failed = |error: String| RunError::failed(path, error);
        match what {
            Saved::Policy => {
                // Of a training that went wrong the best that it had.
                let bytes = match &self.standing.best {
                    Some(best) if self.broken => best.bytes.clone(),
                    _ => follow::bytes(&follow::policy(&self.config, world))?,
                };
                write_whole(path, |file| file.write_all(&bytes)).map_err(|error| failed(error.to_string()))
            }
            Saved::Scenario => {
                let (scenario, like) =
                    (Arc::new(self.config.scenario.clone()), self.config.scenario_from.clone());
                self.save_world(&scenario, &like, path)
            }
            Saved::Csv => {
                let curves = &mut world.resource_mut::<Curves>().0;
                curves.write_csv(path).map_err(|error| failed(error.to_string()))
            }
            Saved::Png => {
                let title = self.config.description();
                world.resource_mut::<Curves>().0.write_png(&title, path).map_err(failed)
            }
            Saved::Run => self.save_run(world, path),
        }
    }

    /// Writes a folder that `--train --resume` goes on from, and `journal.ron` beside its files. The training is taken up
    /// for a moment, if it was set aside.
    fn save_run(&mut self, world: &mut World, path: &Path) -> Result<(), RunError> {
        if cfg!(target_arch = "wasm32") {
            let instead = "a browser saves no folders: save the policy, the episodes and the world";
            return Err(RunError::Unusable(instead.into()));
        }
        let occupied = std::fs::read_dir(path).is_ok_and(|mut entries| entries.next().is_some());
        if occupied || path.is_file() {
            return Err(RunError::unusable(path, "there is something already: choose another name"));
        }
        if self.broken {
            let instead =
                "this training went wrong and cannot go on: save its best policy, its episodes or its curves";
            return Err(RunError::Unusable(instead.into()));
        }
        let (mode, pace) = (self.mode, self.pacer.pace);
        self.set_mode(world, Mode::Train)?;
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
        self.take_examinations(world, true)?;
        let folder = RunFolder::create(Some(path.into()), &self.config)?;
        let failed = |name: &str, error: String| RunError::failed(&path.join(name), error);
        let episodes = path.join("episodes.csv");
        let rows = world.resource_mut::<Curves>().0.write_csv(&episodes);
        rows.map_err(|error| failed("episodes.csv", error.to_string()))?;
        let mut evaluations = folder.csv::<EvaluationRow>("evaluations.csv", 0)?;
        for row in &self.evaluations {
            evaluations.serialize(row).map_err(|error| failed("evaluations.csv", error.to_string()))?;
        }
        evaluations.flush().map_err(|error| failed("evaluations.csv", error.to_string()))?;
        let length = |name: &str| std::fs::metadata(path.join(name)).map(|file| file.len());
        self.standing.episodes_bytes =
            length("episodes.csv").map_err(|error| failed("episodes.csv", error.to_string()))?;
        self.standing.evaluations_bytes =
            length("evaluations.csv").map_err(|error| failed("evaluations.csv", error.to_string()))?;
        self.standing.wall_s = self.wall_s();
        checkpoint::save(&folder, world, &mut self.standing)?;
        let bytes = follow::bytes(&follow::policy(&self.config, world))?;
        folder.write("policy-last.safetensors", |file| file.write_all(&bytes))?;
        if let Some(best) = &self.standing.best {
            folder.write("policy.safetensors", |file| file.write_all(&best.bytes))?;
        }
        if let Some(init) = &self.init {
            let bytes = follow::bytes(init)?;
            folder.write(INIT, |file| file.write_all(&bytes))?;
        }
        let journal = to_ron(&self.journal).map_err(|error| failed(JOURNAL, error.to_string()))?;
        folder.write(JOURNAL, |file| file.write_all(journal.as_bytes()))
    }
}
