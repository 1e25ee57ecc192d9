//! The journal: all that the hand did to a training, so that it can be had again to the bit.
//!
//! In: what was moved, and after how many control steps of the training. Out: the same training, without a window
//! ([`Journal::replay`]).

use std::sync::Arc;

use bevy::prelude::App;
use serde::{Deserialize, Serialize};

use super::hand::{self, Deed};
use crate::learning::Policy;
use crate::run::folder::RunConfig;
use crate::run::{RunError, simulation, train};

/// What the hand did, and when.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// After so many control steps of the training.
    pub after_steps: u64,
    /// What it did.
    pub deed: Deed,
}

/// A training from its beginning, with all that the hand did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Journal {
    /// What was begun.
    pub begun: RunConfig,
    /// Control steps taken since.
    pub steps: u64,
    /// What the hand did, in order.
    pub entries: Vec<Entry>,
}

impl Journal {
    /// A training that begins now.
    #[must_use]
    pub fn new(begun: RunConfig) -> Self {
        Self { begun, steps: 0, entries: Vec::new() }
    }

    /// Notes what is done now.
    pub fn note(&mut self, deed: Deed) {
        self.entries.push(Entry { after_steps: self.steps, deed });
    }

    /// The same training again, from its beginning to where the journal ends; `policy` is the one that it started from,
    /// if there was one.
    ///
    /// # Errors
    /// The configuration or the policy cannot be used, or the training fails.
    pub fn replay(&self, policy: Option<&Policy>) -> Result<App, RunError> {
        let learner = train::learner(&self.begun, policy)?;
        let scenario = Arc::new(self.begun.scenario.clone());
        let mut app = simulation::training(&scenario, &self.begun.preset, self.begun.seed, learner);
        let mut entries = self.entries.iter().peekable();
        for step in 0..=self.steps {
            while let Some(entry) = entries.next_if(|entry| entry.after_steps == step) {
                hand::apply(app.world_mut(), &entry.deed);
            }
            if step < self.steps {
                simulation::step(app.world_mut())?;
            }
        }
        Ok(app)
    }
}
