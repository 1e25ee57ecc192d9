//! The journal: all that the hand did to a training, so that it can be had again to the bit.
//!
//! In: what was done, and after how many control steps of the training. Out: `journal.ron` in a saved run's folder; and
//! the same training again, without a window ([`Journal::replay`], [`verify`]).

use std::path::Path;
use std::sync::Arc;

use bevy::prelude::App;
use serde::{Deserialize, Serialize};

use super::hand::{self, Deed};
use crate::agent::Trainer;
use crate::learning::{Learner, Policy};
use crate::run::folder::{INIT, RunConfig, RunFolder};
use crate::run::{RunError, checkpoint, policy_card, simulation, start};
use crate::scenario::{Scenario, findings, read_long_ron};
use crate::task::{Fault, TaskFault};

/// Its name in a saved run's folder.
pub const JOURNAL: &str = "journal.ron";

/// It holds every world that was taken, so it may grow; what is larger is none.
const MOST_BYTES: u64 = 256 << 20;

/// Nothing is moved farther than this along an axis, in m: the widest world ends sooner.
const FARTHEST_M: f32 = 1000.0;

/// What the hand did, and when.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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

    /// The journal of the run in `folder`, which stands where `learner` does. One that was trained without a window has
    /// none, for no hand was in it; and one that went on without a window has a journal that ends before it does.
    ///
    /// # Errors
    /// There is one that cannot be read, or that is of another run.
    pub fn of(folder: &RunFolder, config: &RunConfig, learner: &Learner) -> Result<Self, RunError> {
        let file = folder.path().join(JOURNAL);
        let mut journal = Self::new(config.clone());
        if file.exists() {
            journal = read_long_ron(&file, MOST_BYTES)?;
        }
        journal.check().map_err(|why| RunError::unusable(&file, why))?;
        journal.steps = learner.env_steps() / config.preset.arenas as u64;
        let times: Vec<u64> = journal.entries.iter().map(|entry| entry.after_steps).collect();
        if !times.is_sorted() || times.last().is_some_and(|last| *last > journal.steps) {
            let why = "its entries are not in order, or go beyond where the run stands: it is of another run";
            return Err(RunError::unusable(&file, why));
        }
        Ok(journal)
    }

    /// Whether what it holds can be done: it may come from a stranger.
    fn check(&self) -> Result<(), String> {
        let RunConfig { scenario, preset, .. } = &self.begun;
        let shape = |scenario: &Scenario| (scenario.lidar.beams, scenario.robot.motions.len());
        let sound = |world: &Scenario| {
            let finding = findings(world).into_iter().next().map(|finding| finding.to_string());
            finding.map_or(Ok(()), Err).and_then(|()| preset.fits(world))
        };
        if let Some(finding) = preset.findings().first() {
            return Err(format!("it began with a preset that cannot be: {finding}"));
        }
        sound(scenario).map_err(|why| format!("it began in a world that cannot be: {why}"))?;
        for Entry { after_steps, deed } in &self.entries {
            let place_m = match deed {
                Deed::Target { to_m, .. } | Deed::Robot { to_m, .. } => *to_m,
                Deed::Obstacle { position_m, .. } => *position_m,
                Deed::World(world) if shape(world) == shape(scenario) => {
                    sound(world).map_err(|why| format!("the world after {after_steps} steps: {why}"))?;
                    continue;
                }
                Deed::World(_) => {
                    return Err(format!(
                        "the world after {after_steps} steps has other beams or motions than the first"
                    ));
                }
            };
            if !(place_m.0.abs() <= FARTHEST_M && place_m.1.abs() <= FARTHEST_M) {
                return Err(format!("what was moved after {after_steps} steps went to {place_m:?}"));
            }
        }
        Ok(())
    }

    /// Notes what is done now. Of what is dragged about between two steps only the last place counts, unless each look
    /// around draws from the sensor's stream (the LIDAR is not `exact`).
    pub fn note(&mut self, deed: Deed, exact: bool) {
        if let Some(last) = self.entries.last_mut()
            && exact
            && last.after_steps == self.steps
            && last.deed.is_of_what(&deed)
        {
            last.deed = deed;
            return;
        }
        self.entries.push(Entry { after_steps: self.steps, deed });
    }

    /// The same training again, from its beginning to where the journal ends; `policy` is the one that it started from,
    /// if there was one.
    ///
    /// # Errors
    /// The configuration or the policy cannot be used, or the training fails.
    pub fn replay(&self, policy: Option<&Policy>) -> Result<App, RunError> {
        let learner = start::learner(&self.begun, policy)?;
        let scenario = Arc::new(self.begun.scenario.clone());
        let mut app = simulation::training(&scenario, &self.begun.preset, self.begun.seed, learner);
        let mut entries = self.entries.iter().peekable();
        for step in 0..=self.steps {
            while let Some(entry) = entries.next_if(|entry| entry.after_steps == step) {
                hand::apply(app.world_mut(), &entry.deed);
            }
            if step < self.steps {
                // A world without room for a target is told of in the window, and mended there by hand: time goes on.
                let stepped = simulation::step(app.world_mut());
                let fault = app.world_mut().resource_mut::<TaskFault>().0.take();
                if !matches!(fault, Some(Fault::NoRoom { .. })) {
                    stepped?;
                }
            }
        }
        Ok(app)
    }
}

/// What came of a replay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Replayed {
    /// Control steps.
    pub steps: u64,
    /// Changes by hand among them.
    pub deeds: usize,
    /// Replay buffer, weights, moments and streams came out as they stand in the folder's checkpoint, to the bit.
    pub same: bool,
}

/// Replays the run saved in the folder at `path`, and compares what comes out with its checkpoint.
///
/// # Errors
/// The folder holds no such run, or one that cannot be used.
pub fn verify(path: &Path) -> Result<Replayed, RunError> {
    let (folder, config) = RunFolder::open(path)?;
    let learner = checkpoint::load(&folder, &config)?.learner;
    let journal = Journal::of(&folder, &config, &learner)?;
    let again = journal.replay(init(&folder, &journal.begun)?.as_ref())?;
    let bytes = |learner: &Learner| {
        let mut bytes = Vec::new();
        learner.save(&mut bytes).map_err(|error| RunError::Failed(error.to_string()))?;
        Ok::<_, RunError>(bytes)
    };
    let same = bytes(&learner)? == bytes(&again.world().resource::<Trainer>().0)?;
    Ok(Replayed { steps: journal.steps, deeds: journal.entries.len(), same })
}

/// The policy that the run in `folder` started from, if there was one.
///
/// # Errors
/// It cannot be read.
pub fn init(folder: &RunFolder, begun: &RunConfig) -> Result<Option<Policy>, RunError> {
    if begun.transfer.is_none() {
        return Ok(None);
    }
    policy_card::read(&folder.path().join(INIT)).map(Some)
}
