//! Files opened in the window: a run or its checkpoint, a policy, a scenario, a preset.
//!
//! In: a path. Out: a training that goes on or begins, or a second policy to compare with; or why it cannot be used.

use std::path::Path;

use bevy::prelude::*;

use super::Session;
use crate::agent::Trainer;
use crate::app::orders::Mode;
use crate::app::status::{Choice, Weight};
use crate::run::preset::Preset;
use crate::run::{RunError, policy_card};
use crate::scenario::{Scenario, read_text};

impl Session {
    /// Opens the file at `path`, or says why it cannot be.
    pub(super) fn open_or_tell(&mut self, world: &mut World, path: &Path) {
        match self.open(world, path) {
            Ok(told) => self.tell(Weight::Told, told),
            Err(error) => self.tell(Weight::Failed, error.to_string()),
        }
    }

    /// Whether what is at `path` is to be opened although a training of some worth would be gone: when it is asked for twice.
    ///
    /// # Errors
    /// It was asked for once: what would happen, in words.
    fn asked_twice(&mut self, world: &World, path: &Path) -> Result<(), RunError> {
        let learner = &world.resource::<Trainer>().0;
        if self.would_discard(learner.env_steps()) && self.asked_once.as_deref() != Some(path) {
            self.asked_once = Some(path.into());
            return Err(RunError::Unusable(format!(
                "The training of {} episodes would be gone: save the run first, or open {} once more",
                learner.episodes(),
                path.display()
            )));
        }
        self.asked_once = None;
        Ok(())
    }

    /// Opens what is at `path`: a run's folder or its checkpoint, a policy, a scenario, a preset. Gives what to say.
    fn open(&mut self, world: &mut World, path: &Path) -> Result<String, RunError> {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        if path.is_dir() {
            self.asked_twice(world, path)?;
            self.resume(world, path)?;
            return Ok(format!("The run {name} goes on"));
        }
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("bin") => {
                self.asked_twice(world, path)?;
                let folder = path.parent().and_then(Path::parent).unwrap_or(path);
                self.resume(world, folder)?;
                Ok("The run goes on from its checkpoint".into())
            }
            Some("safetensors") => {
                let policy = policy_card::read(path)?;
                self.may_drive(&path.display().to_string(), &policy)?;
                self.opened = Some((name.clone(), policy));
                if self.mode == Mode::Compare {
                    self.set_mode(world, Mode::Test)?;
                }
                self.set_mode(world, Mode::Compare)?;
                Ok(format!("{name} drives on the right, the present policy on the left"))
            }
            Some("ron") => self.open_ron(world, path),
            _ => Err(RunError::Unusable(format!(
                "{}: neither a policy (.safetensors), nor a scenario or preset (.ron), nor a run's folder",
                path.display()
            ))),
        }
    }

    /// Opens a scenario or a preset: a training of it begins.
    fn open_ron(&mut self, world: &mut World, path: &Path) -> Result<String, RunError> {
        let from = path.display().to_string();
        let text = read_text(path)?;
        let seed = self.config.seed;
        match Scenario::parse(&text, path) {
            Ok(scenario) => {
                self.asked_twice(world, path)?;
                let preset = self.config.preset_from.clone();
                self.begin(world, &from, &preset, seed)?;
                add(
                    &mut self.own_scenarios,
                    Choice { from, title: scenario.name.clone(), about: scenario.about },
                );
                Ok(format!("Training begins in {}", scenario.name))
            }
            // What is a good preset is no bad scenario; anything else is told as the scenario that it was meant to be.
            Err(error) => match Preset::parse(&text, path) {
                Ok(preset) => {
                    self.asked_twice(world, path)?;
                    let scenario = self.config.scenario_from.clone();
                    self.begin(world, &scenario, &from, seed)?;
                    let title = self.config.preset_name();
                    add(&mut self.own_presets, Choice { from, title: title.clone(), about: preset.about });
                    Ok(format!("Training begins with {title}"))
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
