//! Files opened in the window: a run or its checkpoint, a policy, a scenario, a preset.
//!
//! In: a path. Out: a training that goes on or begins, or a second policy to compare with; or why it cannot be used.

use std::path::Path;

use bevy::prelude::*;

use super::Session;
use crate::agent::ActiveLearner;
use crate::app::app_snapshot::{Choice, Severity};
use crate::app::commands::SessionMode;
use crate::policy::Policy;
use crate::run::folder::RunConfig;
use crate::run::preset::Preset;
use crate::run::{RunError, policy_card, shipped};
use crate::scenario::{Scenario, read_text};

impl Session {
    /// Opens the file at `path`, or says why it cannot be.
    pub(super) fn open_or_notify(&mut self, world: &mut World, path: &Path) {
        match self.open(world, path) {
            Ok(told) => self.notify(Severity::Info, told),
            Err(error) => {
                self.notify(Severity::Error, error.to_string());
                #[cfg(not(target_arch = "wasm32"))]
                if path.extension().is_some_and(|ending| ending == "ron") {
                    self.retry_when_fixed(&path.display().to_string(), super::file_watch::RetryAction::Open);
                }
            }
        }
    }

    /// Whether what is at `path` is to be opened although a training of some worth would be gone: when it is asked for twice.
    ///
    /// # Errors
    /// It was asked for once: what would happen, in words.
    fn confirm_by_repeating(&mut self, world: &World, path: &Path) -> Result<(), RunError> {
        let learner = &world.resource::<ActiveLearner>().0;
        if self.would_lose_training(learner.env_steps()) && self.open_requested_once.as_deref() != Some(path)
        {
            self.open_requested_once = Some(path.into());
            return Err(RunError::InvalidInput(format!(
                "The training of {} episodes would be gone: save the {} first, or open {} once more",
                learner.episodes(),
                if cfg!(target_arch = "wasm32") { "policy" } else { "run" },
                path.display()
            )));
        }
        self.open_requested_once = None;
        Ok(())
    }

    /// Opens what is at `path`: a run's folder or its checkpoint, a policy, a scenario, a preset. Gives what to say.
    fn open(&mut self, world: &mut World, path: &Path) -> Result<String, RunError> {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        if path.is_dir() {
            self.confirm_by_repeating(world, path)?;
            self.resume(world, path)?;
            return Ok(format!("The run {name} goes on"));
        }
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("bin") => {
                self.confirm_by_repeating(world, path)?;
                let folder = path.parent().and_then(Path::parent).unwrap_or(path);
                self.resume(world, folder)?;
                Ok("The run goes on from its checkpoint".into())
            }
            Some("safetensors") => {
                let policy = policy_card::read(path)?;
                self.check_can_drive(&path.display().to_string(), &policy)?;
                self.compare_with(world, (name.clone(), policy))?;
                Ok(format!("{name} drives beside the present policy"))
            }
            Some("ron") => self.open_ron(world, path),
            _ => Err(RunError::InvalidInput(format!(
                "{}: neither a policy (.safetensors), nor a scenario or preset (.ron), nor a run's folder",
                path.display()
            ))),
        }
    }

    /// Lets the shipped policy drive that can drive here, beside the present one.
    ///
    /// # Errors
    /// None can.
    pub(super) fn open_expert(&mut self, world: &mut World) -> Result<(), RunError> {
        let Some((name, policy)) = self.expert() else {
            let why = "no policy that comes with the program can drive here: its LIDAR, its robot or the preset's \
                       observations are others";
            return Err(RunError::InvalidInput(why.into()));
        };
        self.notify(Severity::Info, format!("{name} drives beside the present policy"));
        self.compare_with(world, (name, policy.clone()))
    }

    /// The shipped policy for the present world, or else the first that can drive here, and what to call it.
    pub(crate) fn expert(&self) -> Option<(String, &'static Policy)> {
        let all = shipped::policies();
        let of_this_world = all.iter().filter(|(name, _)| *name == self.config.scenario_from);
        let (name, policy) =
            of_this_world.chain(all).find(|(name, policy)| self.check_can_drive(name, policy).is_ok())?;
        let world = policy.metadata.get("scenario").map_or(*name, String::as_str);
        Some((format!("Expert of {world}"), policy))
    }

    /// Lets `opened_policy` drive beside the present policy.
    fn compare_with(&mut self, world: &mut World, opened_policy: (String, Policy)) -> Result<(), RunError> {
        self.opened_policy = Some(opened_policy);
        if self.mode == SessionMode::Compare {
            self.set_mode(world, SessionMode::Test)?;
        }
        self.set_mode(world, SessionMode::Compare)
    }

    /// The present scenario and preset can be chosen from now on, also where they are the user's own.
    pub(super) fn list_user_files(&mut self) {
        let RunConfig { scenario_from, preset_from, scenario, preset, .. } = &self.config;
        if !shipped::is_scenario(scenario_from) {
            let (title, about) = (scenario.name.clone(), scenario.about.clone());
            add(&mut self.user_scenarios, Choice { from: scenario_from.clone(), title, about });
        }
        if !shipped::is_preset(preset_from) {
            let (title, about) = (self.config.preset_name(), preset.about.clone());
            add(&mut self.user_presets, Choice { from: preset_from.clone(), title, about });
        }
    }

    /// Opens a scenario or a preset: a training of it begins.
    fn open_ron(&mut self, world: &mut World, path: &Path) -> Result<String, RunError> {
        let from = path.display().to_string();
        let text = read_text(path)?;
        let seed = self.config.seed;
        match Scenario::parse(&text, path) {
            Ok(scenario) => {
                self.confirm_by_repeating(world, path)?;
                let preset = self.config.preset_from.clone();
                self.start_training(world, &from, &preset, seed)?;
                Ok(format!("Training begins in {}", scenario.name))
            }
            // What is a good preset is no bad scenario; anything else is told as the scenario that it was meant to be.
            Err(error) => match Preset::parse(&text, path) {
                Ok(_) => {
                    self.confirm_by_repeating(world, path)?;
                    let scenario = self.config.scenario_from.clone();
                    self.start_training(world, &scenario, &from, seed)?;
                    Ok(format!("Training begins with {}", self.config.preset_name()))
                }
                Err(_) => Err(error.into()),
            },
        }
    }
}

fn add(choices: &mut Vec<Choice>, choice: Choice) {
    choices.retain(|other| other.from != choice.from);
    choices.push(choice);
}
