//! Each order, carried out between two control steps.
//!
//! In: an [`Command`]. Out: what it asked for, or a notice that says why not.

use bevy::prelude::*;

use super::trails::Trails;
use super::{Session, TrainingHistory, interventions};
use crate::agent::{ActionSource, ActionSources, ActiveLearner};
use crate::app::app_snapshot::Severity;
use crate::app::commands::{Command, MoveRequest, SaveKind};
use crate::run::{RunError, metrics, shipped};
use crate::scenario::Scenario;
use crate::task::CurrentScenario;

/// How a notice begins that says why something cannot be moved to where it is dragged.
const NOT_THERE: &str = "Not there";

impl Session {
    /// Carries out `command`; what goes wrong becomes a notice.
    pub(super) fn execute(&mut self, world: &mut World, command: Command) {
        let done = match command {
            Command::Pause(paused) => {
                self.pacer.paused = paused;
                Ok(())
            }
            Command::Step => {
                self.pacer.step_once();
                Ok(())
            }
            Command::SetPace(pace) => {
                self.pacer.pace = pace;
                Ok(())
            }
            Command::SetMode(mode) => self.set_mode(world, mode),
            Command::StartTraining { scenario, preset, seed } => {
                let begun = self.start_training(world, &scenario, &preset, seed);
                #[cfg(not(target_arch = "wasm32"))]
                if begun.is_err() {
                    self.retry_when_fixed(&scenario, super::file_watch::RetryAction::Open);
                }
                begun
            }
            Command::Transfer { scenario, epsilon } => {
                let name = format!("{} after {} episodes", self.config.scenario.name, self.episodes(world));
                let policy = metrics::policy(&self.config, world);
                let found = shipped::scenario(&scenario).map_err(RunError::from);
                found.and_then(|found| {
                    self.start_from_policy(world, Some((&scenario, found)), (name, policy), epsilon)
                })
            }
            Command::TrainFromOpened { epsilon } => match self.opened_policy.clone() {
                Some(opened_policy) => self.start_from_policy(world, None, opened_policy, epsilon),
                None => {
                    Err(RunError::InvalidInput("there is no policy to start from: open one first".into()))
                }
            },
            Command::Move(moved) => {
                self.move_by_hand(world, &moved);
                Ok(())
            }
            Command::Steer(motion) => {
                if let Some(ActionSource::Manual(held)) =
                    world.resource_mut::<ActionSources>().arenas.first_mut()
                {
                    *held = motion;
                }
                Ok(())
            }
            Command::OpenExpert => self.open_expert(world),
            Command::Open(path) => {
                self.open_or_notify(world, &path);
                Ok(())
            }
            Command::Save(what, path) => match self.save(world, what, &path) {
                Ok(()) => {
                    if matches!(what, SaveKind::Policy | SaveKind::Run) {
                        self.saved_at = Some(world.resource::<ActiveLearner>().0.env_steps());
                    }
                    self.notify(Severity::Info, format!("Saved to {}", path.display()));
                    Ok(())
                }
                Err(error) => Err(error),
            },
            Command::ApplyScenario { scenario, from, again } => {
                self.apply_edited(world, &scenario, from, again)
            }
            Command::SaveScenario { scenario, like, path: Some(path) } => {
                self.save_scenario(&scenario, &like, &path)
            }
            Command::OpenInEditor(Some(path)) => self.open_in_editor(&path),
            Command::DismissNotice(index) => {
                if index < self.notices.len() {
                    self.notices.remove(index);
                }
                Ok(())
            }
            // Whoever has dialogs here answers with an order of their own.
            Command::OpenDialog
            | Command::SaveDialog(_)
            | Command::SaveScenario { path: None, .. }
            | Command::OpenInEditor(None) => Ok(()),
        };
        if let Err(error) = done {
            self.notify(Severity::Error, error.to_string());
        }
    }

    fn episodes(&self, world: &World) -> u64 {
        world.resource::<ActiveLearner>().0.episodes()
    }

    /// Moves what the user drags, where it can be.
    fn move_by_hand(&mut self, world: &mut World, moved: &MoveRequest) {
        let intervention = match interventions::resolve(world, moved) {
            Ok(intervention) => intervention,
            Err(why) => return self.notify(Severity::Info, format!("{NOT_THERE}: {why}")),
        };
        self.retract_notice(NOT_THERE);
        interventions::apply(world, &intervention);
        if let interventions::Intervention::Robot { arena, .. } = &intervention {
            world.resource_mut::<Trails>().restart_path(*arena);
        }
        let of_the_world = matches!(intervention, interventions::Intervention::Obstacle { .. });
        let exact = self.config.scenario.lidar.is_exact();
        match &mut self.suspended {
            None => self.journal.record(intervention, exact),
            Some(aside) if of_the_world => {
                aside.record(intervention.clone(), exact);
                self.journal.record(intervention, exact);
            }
            // Where a robot or goal is while somebody else drives is nothing to the training.
            Some(_) => {}
        }
        if of_the_world {
            self.on_scenario_changed(world);
        }
    }

    /// The world that is driven in is another from now on, for the training, too.
    pub(super) fn on_scenario_changed(&mut self, world: &mut World) {
        let scenario = world.resource::<CurrentScenario>().0.clone();
        self.config.scenario = Scenario::clone(&scenario);
        if self.suspended.is_none() {
            self.scenario = scenario;
        }
        self.evaluator_is_stale = true;
        // What was saved before is older than this.
        self.saved_scenario = None;
        // What was best in another world is nothing to go by.
        self.trainer_state.best = None;
        let env_steps = world.resource::<ActiveLearner>().0.env_steps();
        world.resource_mut::<TrainingHistory>().0.annotate(env_steps, "world changed".into());
    }
}
