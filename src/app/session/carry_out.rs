//! Each order, carried out between two control steps.
//!
//! In: an [`Order`]. Out: what it asked for, or a notice that says why not.

use std::path::Path;

use bevy::prelude::*;

use super::trails::Trails;
use super::{Curves, Session, hand};
use crate::agent::{Driver, Drivers};
use crate::app::orders::{Mode, Moved, Order};
use crate::app::status::{Choice, Weight};
use crate::learning::Policy;
use crate::run::preset::Preset;
use crate::run::{RunError, follow};
use crate::scenario::{Scenario, read_text};
use crate::task::CurrentScenario;

/// No policy file is longer, in bytes: the most parameters that a network may have, and room for its card.
const LONGEST_POLICY: u64 = 80 << 20;

/// How a notice begins that says why something cannot be moved to where it is dragged.
const NOT_THERE: &str = "Not there";

impl Session {
    /// Carries out `order`; what goes wrong becomes a notice.
    pub(super) fn carry_out(&mut self, world: &mut World, order: Order) {
        let done = match order {
            Order::Pause(paused) => {
                self.pacer.paused = paused;
                Ok(())
            }
            Order::Step => {
                self.pacer.step_once();
                Ok(())
            }
            Order::SetPace(pace) => {
                self.pacer.pace = pace;
                Ok(())
            }
            Order::SetMode(mode) => self.set_mode(world, mode),
            Order::Begin { scenario, preset, seed } => self.begin(world, &scenario, &preset, seed),
            Order::Transfer { scenario, epsilon } => {
                let name = format!("{} after {} episodes", self.config.scenario.name, self.episodes(world));
                let policy = follow::policy(&self.config, world);
                self.begin_from(world, &scenario, (name, policy), epsilon)
            }
            Order::Adopt { epsilon } => match self.opened.clone() {
                Some(opened) => {
                    let scenario = self.config.scenario_from.clone();
                    self.begin_from(world, &scenario, opened, epsilon)
                }
                None => Err(RunError::Unusable("there is no policy to start from: open one first".into())),
            },
            Order::Move(moved) => {
                self.move_by_hand(world, &moved);
                Ok(())
            }
            Order::Steer(motion) => {
                if let Some(Driver::Hand(held)) = world.resource_mut::<Drivers>().0.first_mut() {
                    *held = motion;
                }
                Ok(())
            }
            Order::Open(path) => {
                self.open_or_tell(world, &path);
                Ok(())
            }
            Order::Save(what, path) => match self.save(world, what, &path) {
                Ok(()) => {
                    self.tell(Weight::Told, format!("Saved to {}", path.display()));
                    Ok(())
                }
                Err(error) => Err(error),
            },
            Order::Dismiss => {
                self.notices.pop();
                Ok(())
            }
            // Whoever has dialogs here answers with an order of their own.
            Order::OpenDialog | Order::SaveDialog(_) => Ok(()),
        };
        if let Err(error) = done {
            self.tell(Weight::Failed, error.to_string());
        }
    }

    fn episodes(&self, world: &World) -> u64 {
        world.resource::<crate::agent::Trainer>().0.episodes()
    }

    /// Moves what the user drags, where it can be.
    fn move_by_hand(&mut self, world: &mut World, moved: &Moved) {
        let deed = match hand::resolve(world, moved) {
            Ok(deed) => deed,
            Err(why) => {
                self.notices.retain(|notice| !notice.text.starts_with(NOT_THERE));
                return self.tell(Weight::Failed, format!("{NOT_THERE}: {why}"));
            }
        };
        self.notices.retain(|notice| !notice.text.starts_with(NOT_THERE));
        hand::apply(world, &deed);
        if let hand::Deed::Robot { arena, .. } = deed {
            world.resource_mut::<Trails>().lift(arena);
        }
        let of_the_world = matches!(deed, hand::Deed::Obstacle { .. });
        match &mut self.aside {
            None => self.journal.note(deed),
            Some(aside) if of_the_world => {
                aside.deeds.push(deed);
                self.journal.note(deed);
            }
            // Where a robot or target is while somebody else drives is nothing to the training.
            Some(_) => {}
        }
        if of_the_world {
            let scenario = world.resource::<CurrentScenario>().0.clone();
            self.config.scenario = Scenario::clone(&scenario);
            if self.aside.is_none() {
                self.scenario = scenario.clone();
            }
            self.examiner_is_stale = true;
            let env_steps = world.resource::<crate::agent::Trainer>().0.env_steps();
            world.resource_mut::<Curves>().0.mark(env_steps, "world changed".into());
        }
    }

    /// Opens the file at `path`, or says why it cannot be.
    pub(super) fn open_or_tell(&mut self, world: &mut World, path: &Path) {
        match self.open(world, path) {
            Ok(told) => self.tell(Weight::Told, told),
            Err(error) => self.tell(Weight::Failed, error.to_string()),
        }
    }

    /// Opens what is at `path`: a run's folder or its checkpoint, a policy, a scenario, a preset. Gives what to say.
    fn open(&mut self, world: &mut World, path: &Path) -> Result<String, RunError> {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        if path.is_dir() {
            self.resume(world, path)?;
            return Ok(format!("The run {name} goes on"));
        }
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("bin") => {
                let folder = path.parent().and_then(Path::parent).unwrap_or(path);
                self.resume(world, folder)?;
                Ok("The run goes on from its checkpoint".into())
            }
            Some("safetensors") => {
                let policy = read_policy(path)?;
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
                    let scenario = self.config.scenario_from.clone();
                    self.begin(world, &scenario, &from, seed)?;
                    let title = self.config.preset_name();
                    add(
                        &mut self.own_presets,
                        Choice { from, title: title.clone(), about: preset.about },
                    );
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

/// The policy in the file at `path`.
fn read_policy(path: &Path) -> Result<Policy, RunError> {
    let unusable = |why: String| RunError::Unusable(format!("{}: {why}", path.display()));
    let length = std::fs::metadata(path).map_err(|error| unusable(error.to_string()))?.len();
    if length > LONGEST_POLICY {
        return Err(unusable(format!("is {length} bytes long; no policy is longer than {LONGEST_POLICY}")));
    }
    let bytes = std::fs::read(path).map_err(|error| unusable(error.to_string()))?;
    Policy::from_bytes(&bytes).map_err(|error| unusable(error.to_string()))
}
