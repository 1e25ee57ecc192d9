//! Each order, carried out between two control steps.
//!
//! In: an [`Order`]. Out: what it asked for, or a notice that says why not.

use bevy::prelude::*;

use super::trails::Trails;
use super::{Curves, Session, hand};
use crate::agent::{Driver, Drivers, Trainer};
use crate::app::orders::{Moved, Order, Saved};
use crate::app::status::Weight;
use crate::run::{RunError, follow, shipped};
use crate::scenario::Scenario;
use crate::task::CurrentScenario;

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
            Order::Begin { scenario, preset, seed } => {
                let begun = self.begin(world, &scenario, &preset, seed);
                #[cfg(not(target_arch = "wasm32"))]
                if begun.is_err() {
                    self.wait_for(&scenario, super::watch::Then::Open);
                }
                begun
            }
            Order::Transfer { scenario, epsilon } => {
                let name = format!("{} after {} episodes", self.config.scenario.name, self.episodes(world));
                let policy = follow::policy(&self.config, world);
                let found = shipped::scenario(&scenario).map_err(RunError::from);
                found.and_then(|found| {
                    self.begin_from(world, Some((&scenario, found)), (name, policy), epsilon)
                })
            }
            Order::Adopt { epsilon } => match self.opened.clone() {
                Some(opened) => self.begin_from(world, None, opened, epsilon),
                None => Err(RunError::Unusable("there is no policy to start from: open one first".into())),
            },
            Order::Move(moved) => {
                self.move_by_hand(world, &moved);
                Ok(())
            }
            Order::Steer(motion) => {
                if let Some(Driver::Hand(held)) = world.resource_mut::<Drivers>().arenas.first_mut() {
                    *held = motion;
                }
                Ok(())
            }
            Order::OpenExpert => self.open_expert(world),
            Order::Open(path) => {
                self.open_or_tell(world, &path);
                Ok(())
            }
            Order::Save(what, path) => match self.save(world, what, &path) {
                Ok(()) => {
                    if matches!(what, Saved::Policy | Saved::Run) {
                        self.saved_at = Some(world.resource::<Trainer>().0.env_steps());
                    }
                    self.tell(Weight::Told, format!("Saved to {}", path.display()));
                    Ok(())
                }
                Err(error) => Err(error),
            },
            Order::TakeWorld { scenario, from, again } => self.take_edited(world, &scenario, from, again),
            Order::SaveWorld { scenario, like, path: Some(path) } => self.save_world(&scenario, &like, &path),
            Order::EditOpen(Some(path)) => self.open_to_edit(&path),
            Order::Dismiss(index) => {
                if index < self.notices.len() {
                    self.notices.remove(index);
                }
                Ok(())
            }
            // Whoever has dialogs here answers with an order of their own.
            Order::OpenDialog
            | Order::SaveDialog(_)
            | Order::SaveWorld { path: None, .. }
            | Order::EditOpen(None) => Ok(()),
        };
        if let Err(error) = done {
            self.tell(Weight::Failed, error.to_string());
        }
    }

    fn episodes(&self, world: &World) -> u64 {
        world.resource::<Trainer>().0.episodes()
    }

    /// Moves what the user drags, where it can be.
    fn move_by_hand(&mut self, world: &mut World, moved: &Moved) {
        let deed = match hand::resolve(world, moved) {
            Ok(deed) => deed,
            Err(why) => return self.tell(Weight::Told, format!("{NOT_THERE}: {why}")),
        };
        self.untell(NOT_THERE);
        hand::apply(world, &deed);
        if let hand::Deed::Robot { arena, .. } = &deed {
            world.resource_mut::<Trails>().lift(*arena);
        }
        let of_the_world = matches!(deed, hand::Deed::Obstacle { .. });
        let exact = self.config.scenario.lidar.is_exact();
        match &mut self.aside {
            None => self.journal.note(deed, exact),
            Some(aside) if of_the_world => {
                aside.note(deed.clone(), exact);
                self.journal.note(deed, exact);
            }
            // Where a robot or target is while somebody else drives is nothing to the training.
            Some(_) => {}
        }
        if of_the_world {
            self.world_is_another(world);
        }
    }

    /// The world that is driven in is another from now on, for the training, too.
    pub(super) fn world_is_another(&mut self, world: &mut World) {
        let scenario = world.resource::<CurrentScenario>().0.clone();
        self.config.scenario = Scenario::clone(&scenario);
        if self.aside.is_none() {
            self.scenario = scenario;
        }
        self.examiner_is_stale = true;
        // What was saved before is older than this.
        self.saved_world = None;
        // What was best in another world is nothing to go by.
        self.standing.best = None;
        let env_steps = world.resource::<Trainer>().0.env_steps();
        world.resource_mut::<Curves>().0.mark(env_steps, "world changed".into());
    }
}
