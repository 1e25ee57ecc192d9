//! The journal: all that the hand did to a training, so that it can be had again to the bit.
//!
//! In: what was done, and after how many control steps of the training. Out: `journal.ron` in a saved run's folder; and
//! the same training again, without a window ([`Journal::replay`], [`verify`]).

use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::interventions::{self, Intervention};
use crate::agent::ActiveLearner;
use crate::learning::{Learner, Policy};
use crate::run::folder::{INITIAL_POLICY_FILE, RunConfig, RunFolder};
use crate::run::{RunError, checkpoint, policy_card, training_setup};
use crate::scenario::{Scenario, diagnostics, read_ron_with_limit};
use crate::simulation::Simulation;
use crate::task::{Fault, TaskFault};

/// Its name in a saved run's folder.
pub const JOURNAL: &str = "journal.ron";

/// It holds every world that was taken, so it may grow; what is larger is none.
const MAX_JOURNAL_BYTES: u64 = 256 << 20;

/// Nothing is moved farther than this along an axis, in m: the widest world ends sooner.
const MAX_MOVE_M: f32 = 1000.0;

/// What the hand did, and when.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JournalEntry {
    /// After so many control steps of the training.
    pub after_steps: u64,
    /// What it did.
    pub intervention: Intervention,
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
    pub entries: Vec<JournalEntry>,
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
    pub fn load(folder: &RunFolder, config: &RunConfig, learner: &Learner) -> Result<Self, RunError> {
        let file = folder.path().join(JOURNAL);
        let mut journal = Self::new(config.clone());
        if file.exists() {
            journal = read_ron_with_limit(&file, MAX_JOURNAL_BYTES)?;
        }
        journal.check().map_err(|why| RunError::invalid_input(&file, why))?;
        journal.steps = learner.env_steps() / config.preset.arenas as u64;
        let times: Vec<u64> = journal.entries.iter().map(|entry| entry.after_steps).collect();
        if !times.is_sorted() || times.last().is_some_and(|last| *last > journal.steps) {
            let why = "its entries are not in order, or go beyond where the run stands: it is of another run";
            return Err(RunError::invalid_input(&file, why));
        }
        Ok(journal)
    }

    /// Whether what it holds can be done: it may come from a stranger.
    fn check(&self) -> Result<(), String> {
        let RunConfig { scenario, preset, .. } = &self.begun;
        let shape = |scenario: &Scenario| (scenario.lidar.beams, scenario.robot.motions.len());
        let sound = |world: &Scenario| {
            let finding = diagnostics(world).into_iter().next().map(|finding| finding.to_string());
            finding.map_or(Ok(()), Err).and_then(|()| preset.check_memory(world))
        };
        if let Some(finding) = preset.diagnostics().first() {
            return Err(format!("it began with a preset that cannot be: {finding}"));
        }
        sound(scenario).map_err(|why| format!("it began in a world that cannot be: {why}"))?;
        for JournalEntry { after_steps, intervention } in &self.entries {
            let place_m = match intervention {
                Intervention::Goal { to_m, .. } | Intervention::Robot { to_m, .. } => *to_m,
                Intervention::Obstacle { position_m, .. } => *position_m,
                Intervention::World(world) if shape(world) == shape(scenario) => {
                    sound(world).map_err(|why| format!("the world after {after_steps} steps: {why}"))?;
                    continue;
                }
                Intervention::World(_) => {
                    return Err(format!(
                        "the world after {after_steps} steps has other beams or motions than the first"
                    ));
                }
            };
            if !(place_m.x.abs() <= MAX_MOVE_M && place_m.y.abs() <= MAX_MOVE_M) {
                return Err(format!("what was moved after {after_steps} steps went to {place_m:?}"));
            }
        }
        Ok(())
    }

    /// Notes what is done now. Of what is dragged about between two steps only the last place counts, unless each look
    /// around draws from the sensor's stream (the LIDAR is not `exact`).
    pub fn record(&mut self, intervention: Intervention, exact: bool) {
        if let Some(last) = self.entries.last_mut()
            && exact
            && last.after_steps == self.steps
            && last.intervention.affects_same_object(&intervention)
        {
            last.intervention = intervention;
            return;
        }
        self.entries.push(JournalEntry { after_steps: self.steps, intervention });
    }

    /// The same training again, from its beginning to where the journal ends; `policy` is the one that it started from,
    /// if there was one.
    ///
    /// # Errors
    /// The configuration or the policy cannot be used, or the training fails.
    pub fn replay(&self, policy: Option<&Policy>) -> Result<Simulation, RunError> {
        let learner = training_setup::create_learner(&self.begun, policy)?;
        let scenario = Arc::new(self.begun.scenario.clone());
        let mut simulation = training_setup::training(
            &scenario,
            &self.begun.preset,
            self.begun.seed,
            learner,
            &self.begun.extensions,
        );
        let mut entries = self.entries.iter().peekable();
        for step in 0..=self.steps {
            while let Some(entry) = entries.next_if(|entry| entry.after_steps == step) {
                interventions::apply(simulation.world_mut(), &entry.intervention);
            }
            if step < self.steps {
                // A world without room for a goal is told of in the window, and mended there by hand: time goes on.
                let stepped = simulation.step();
                let fault = simulation.world_mut().resource_mut::<TaskFault>().0.take();
                if !matches!(fault, Some(Fault::NoFreeSpace { .. })) {
                    stepped?;
                }
            }
        }
        Ok(simulation)
    }
}

/// What came of a replay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReplayResult {
    /// Control steps.
    pub steps: u64,
    /// Changes by hand among them.
    pub interventions: usize,
    /// Replay buffer, weights, moments and streams came out as they stand in the folder's checkpoint, to the bit.
    pub bit_identical: bool,
}

/// Replays the run saved in the folder at `path`, and compares what comes out with its checkpoint.
///
/// # Errors
/// The folder holds no such run, or one that cannot be used.
pub fn verify(path: &Path) -> Result<ReplayResult, RunError> {
    let (folder, config) = RunFolder::open(path)?;
    let learner = checkpoint::load(&folder, &config)?.learner;
    let journal = Journal::load(&folder, &config, &learner)?;
    let again = journal.replay(initial_policy(&folder, &journal.begun)?.as_ref())?;
    let bytes = |learner: &Learner| {
        let mut bytes = Vec::new();
        learner.save(&mut bytes).map_err(|error| RunError::Failed(error.to_string()))?;
        Ok::<_, RunError>(bytes)
    };
    let same = bytes(&learner)? == bytes(&again.world().resource::<ActiveLearner>().0)?;
    Ok(ReplayResult { steps: journal.steps, interventions: journal.entries.len(), bit_identical: same })
}

/// The policy that the run in `folder` started from, if there was one.
///
/// # Errors
/// It cannot be read.
pub fn initial_policy(folder: &RunFolder, begun: &RunConfig) -> Result<Option<Policy>, RunError> {
    if begun.transfer.is_none() {
        return Ok(None);
    }
    policy_card::read(&folder.path().join(INITIAL_POLICY_FILE)).map(Some)
}
