//! The source of the current scenario: its file, and the last known content of the files that the user works with.
//!
//! In: every scenario that is loaded, saved or opened in the editor. Out: whether the current scenario differs from its file,
//! and whether a file may be overwritten.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy::prelude::*;

use crate::app::app_status::ScenarioFile;
use crate::run::folder::RunConfig;
use crate::run::{RunError, shipped};
use crate::scenario::{Scenario, path_exists, read_text};

/// The source of the current scenario, and the last known content of files.
#[derive(Resource)]
pub struct ScenarioSource {
    /// The scenario as it is in its file, or as it is shipped.
    pub(super) loaded: Scenario,
    /// A scenario to switch to when the next episode ends.
    pub(super) pending: Option<Scenario>,
    /// The scenario that was saved last; `None` if the current scenario has changed since.
    saved: Option<ScenarioFile>,
    /// The contents of files as the user last saw them: loaded, opened in the editor or saved.
    known: BTreeMap<String, Arc<Scenario>>,
    /// A file that another program has changed, and that the user has once asked to overwrite, with its text at that moment.
    /// The text is `None` if the file could not be read.
    overwrite_requested: Option<(PathBuf, Option<String>)>,
}

impl ScenarioSource {
    /// The source of the scenario in `config`.
    pub(super) fn new(config: &RunConfig) -> Self {
        let in_file = load_source(&config.scenario_from);
        let mut known = BTreeMap::new();
        // The user has not seen the file if it differs.
        if in_file.as_ref() == Some(&config.scenario) {
            known.insert(config.scenario_from.clone(), Arc::new(config.scenario.clone()));
        }
        let loaded = in_file.unwrap_or_else(|| config.scenario.clone());
        Self { loaded, pending: None, saved: None, known, overwrite_requested: None }
    }

    /// Takes over the known contents of files from `old`, when a new training run replaces the current one.
    pub(super) fn keep_known_files(&mut self, old: Self) {
        self.saved = old.saved;
        for (file, content) in old.known {
            self.known.entry(file).or_insert(content);
        }
    }

    /// Whether the current scenario differs from its file: an object was moved, or an edit was not saved.
    #[must_use]
    pub fn is_modified(&self, config: &RunConfig) -> bool {
        self.loaded != config.scenario
    }

    /// The scenario that was saved last, and its file.
    #[must_use]
    pub fn saved(&self) -> Option<&ScenarioFile> {
        self.saved.as_ref()
    }

    /// The content of `file` as the user last saw it; `None` if the app never read it.
    pub(super) fn known(&self, file: &str) -> Option<&Arc<Scenario>> {
        self.known.get(file)
    }

    /// Records that the current scenario is the content of its file, `from`.
    pub(super) fn record_loaded(&mut self, from: String, scenario: Scenario) {
        self.known.insert(from, Arc::new(scenario.clone()));
        self.loaded = scenario;
    }

    /// Records the content of a file that was opened in the editor.
    pub(crate) fn record_opened(&mut self, from: String, scenario: Arc<Scenario>) {
        self.known.insert(from, scenario);
    }

    /// Records the content of a file to which a scenario was saved.
    pub(super) fn record_saved(&mut self, file: String, scenario: Arc<Scenario>) {
        self.known.insert(file.clone(), scenario.clone());
        self.saved = Some((file, scenario));
    }

    /// Discards the saved scenario, because the current scenario is newer.
    pub(super) fn forget_saved(&mut self) {
        self.saved = None;
    }

    /// Checks that writing `scenario` to `path` overwrites no changes made by another program. The file may be written if its
    /// content is as the user last saw it, if the app never read it (the file dialog has asked for confirmation), or if the user
    /// asks twice and it has not changed in between.
    ///
    /// # Errors
    /// Another program has changed the file, and the user has not yet asked to overwrite this change.
    pub(super) fn check_overwrite(
        &mut self,
        config: &RunConfig,
        scenario: &Scenario,
        path: &Path,
    ) -> Result<(), RunError> {
        let file = path.display().to_string();
        // The file of a resumed run may have changed since the run was saved.
        let running = (file == config.scenario_from).then_some(&config.scenario);
        let known = self.known.get(&file).map(|content| &**content).or(running);
        let text = read_text(path).ok();
        let present = text.as_deref().and_then(|text| Scenario::parse_draft(text, path).ok());
        let is_unchanged = known.is_none() || [Some(scenario), known].contains(&present.as_ref());
        let request = (path.to_path_buf(), text);
        let is_repeated = self.overwrite_requested.take().as_ref() == Some(&request);
        if !path_exists(path) || is_unchanged || is_repeated {
            return Ok(());
        }
        self.overwrite_requested = Some(request);
        let why = "another program has changed this file, and its changes would be lost\n\
                   help: save again to overwrite it, or choose another name";
        Err(RunError::failed(path, why))
    }
}

/// The scenario that `from`, a file or a shipped name, contains now.
pub(super) fn load_source(from: &str) -> Option<Scenario> {
    shipped::scenario(from).ok()
}
