//! The journal: every intervention in a training run, so that the run can be replayed bit for bit.
//!
//! In: each intervention, and the number of control steps before it. Out: `journal.ron` in the folder of a saved run; and a
//! headless replay of the training ([`Journal::replay`], [`verify`]).

use std::path::Path;
use std::sync::Arc;

use bevy::prelude::Resource;
use serde::{Deserialize, Serialize};

use super::interventions::{self, Intervention};
use crate::agent::ActiveLearner;
use crate::learning::Learner;
use crate::limits::MAX_JOURNAL_BYTES;
use crate::policy::Policy;
use crate::run::folder::{INITIAL_POLICY_FILE, RunConfig, RunFolder};
use crate::run::{RunError, checkpoint, policy_card, training_setup};
use crate::scenario::{Scenario, diagnostics, parse_ron_with_limit, read_text_with_limit};
use crate::simulation::Simulation;
use crate::task::{Fault, TaskFault};

/// Name of the journal in a run folder.
pub const JOURNAL: &str = "journal.ron";

/// Largest coordinate of a moved object, in m. It exceeds the largest scenario.
const MAX_MOVE_M: f32 = 1000.0;

/// An intervention and its time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JournalEntry {
    /// Control steps of the training before the intervention.
    pub after_steps: u64,
    /// The intervention.
    pub intervention: Intervention,
}

/// The configuration of a training run, and every intervention in it.
#[derive(Resource, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Journal {
    /// Configuration at the start of the training.
    pub config: RunConfig,
    /// Control steps so far.
    pub steps: u64,
    /// Interventions, oldest first.
    pub entries: Vec<JournalEntry>,
}

impl Journal {
    /// The journal of a training run that starts now.
    #[must_use]
    pub fn new(config: RunConfig) -> Self {
        Self { config, steps: 0, entries: Vec::new() }
    }

    /// The journal of the run in `folder`, whose learner is `learner`. A headless run has no journal file, because it
    /// has no interventions. The file of a run that was resumed headless has too few `steps`: they come from `learner`.
    ///
    /// # Errors
    /// The file cannot be read, is invalid, or belongs to another run.
    pub fn load(folder: &RunFolder, config: &RunConfig, learner: &Learner) -> Result<Self, RunError> {
        let file = folder.path().join(JOURNAL);
        let text = file.exists().then(|| read_text_with_limit(&file, MAX_JOURNAL_BYTES)).transpose()?;
        Self::parse(text.as_deref(), &file, config, learner)
    }

    /// The journal in `text`, the contents of `file`; without text, a journal without interventions.
    ///
    /// # Errors
    /// The text is invalid, or belongs to another run.
    pub(super) fn parse(
        text: Option<&str>,
        file: &Path,
        config: &RunConfig,
        learner: &Learner,
    ) -> Result<Self, RunError> {
        let mut journal = match text {
            Some(text) => parse_ron_with_limit(text, file, MAX_JOURNAL_BYTES)?,
            None => Self::new(config.clone()),
        };
        let started = &journal.config;
        if (started.seed, started.preset.arenas) != (config.seed, config.preset.arenas) {
            let why = "its seed or number of arenas is not that of config.ron: it belongs to another run";
            return Err(RunError::invalid_input(file, why));
        }
        journal.check().map_err(|why| RunError::invalid_input(file, why))?;
        journal.steps = learner.env_steps() / config.preset.arenas as u64;
        let times: Vec<u64> = journal.entries.iter().map(|entry| entry.after_steps).collect();
        if !times.is_sorted() || times.last().is_some_and(|last| *last > journal.steps) {
            let why = "its entries are out of order or later than the checkpoint: it belongs to another run";
            return Err(RunError::invalid_input(file, why));
        }
        Ok(journal)
    }

    /// Checks that the journal can be replayed. It may come from an untrusted source.
    ///
    /// # Errors
    /// A value in the journal is invalid.
    fn check(&self) -> Result<(), String> {
        let RunConfig { scenario, preset, .. } = &self.config;
        let layout = self.config.observation_layout();
        let check_scenario = |scenario: &Scenario| {
            let found = diagnostics(scenario).into_iter().next().map(|found| found.to_string());
            found.map_or(Ok(()), Err).and_then(|()| preset.check_memory(scenario, &layout))
        };
        if let Some(found) = preset.diagnostics().first() {
            return Err(format!("the preset of the run is invalid: {found}"));
        }
        check_scenario(scenario).map_err(|why| format!("the scenario of the run is invalid: {why}"))?;
        if self.config.scenario_set.is_some() {
            let found = self.config.diagnostics().into_iter().next();
            found.map_or(Ok(()), |found| {
                Err(format!("the set of scenarios of the run is invalid: {found}"))
            })?;
            if self.scenario_changes().next().is_some() {
                return Err("training on a set of scenarios cannot have changes of the scenario".into());
            }
        }
        for JournalEntry { after_steps, intervention } in &self.entries {
            match intervention {
                Intervention::Move { to_m, .. } => {
                    if !(to_m.x.abs() <= MAX_MOVE_M && to_m.y.abs() <= MAX_MOVE_M) {
                        return Err(format!(
                            "after {after_steps} steps an object was moved to ({}, {}), which lies outside every scenario",
                            to_m.x, to_m.y
                        ));
                    }
                }
                Intervention::Scenario(next) => {
                    if let Some(why) = preset.network_misfit(scenario, next) {
                        return Err(format!("the scenario after {after_steps} steps does not fit: {why}"));
                    }
                    check_scenario(next)
                        .map_err(|why| format!("the scenario after {after_steps} steps is invalid: {why}"))?;
                }
            }
        }
        Ok(())
    }

    /// Records an intervention made now. With `only_last_counts`, it replaces the last one if that moved the same object since
    /// the last control step.
    pub fn record(&mut self, intervention: Intervention, only_last_counts: bool) {
        if let Some(last) = self.entries.last_mut()
            && only_last_counts
            && last.after_steps == self.steps
            && last.intervention.affects_same_object(&intervention)
        {
            last.intervention = intervention;
            return;
        }
        self.entries.push(JournalEntry { after_steps: self.steps, intervention });
    }

    /// Env steps of the training at each change of its scenario, in order.
    pub(super) fn scenario_changes(&self) -> impl Iterator<Item = u64> {
        let arenas = self.config.preset.arenas as u64;
        let changes = self.entries.iter().filter(|entry| entry.intervention.changes_scenario());
        changes.map(move |entry| entry.after_steps * arenas)
    }

    /// Replays the training from its start to the end of the journal. `policy` is the policy that the training started from,
    /// if any.
    ///
    /// # Errors
    /// The configuration or the policy is invalid, or the training fails.
    pub fn replay(&self, policy: Option<&Policy>) -> Result<Simulation, RunError> {
        let learner = training_setup::create_learner(&self.config, policy)?;
        let scenario = Arc::new(self.config.scenario.clone());
        let mut simulation = training_setup::training(
            &scenario,
            &self.config.preset,
            self.config.seed,
            learner,
            &self.config.simulation_plugins(),
        );
        let mut entries = self.entries.iter().peekable();
        for step in 0..=self.steps {
            while let Some(entry) = entries.next_if(|entry| entry.after_steps == step) {
                interventions::apply(simulation.world_mut(), &entry.intervention);
            }
            if step < self.steps {
                // In the app the user made room where there was no free space, and the training continued.
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

/// The result of a replay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReplayResult {
    /// Control steps replayed.
    pub steps: u64,
    /// Interventions replayed.
    pub interventions: usize,
    /// Whether the learner (replay buffer, weights, optimizer moments, random streams) equals the checkpoint's, bit for bit.
    pub bit_identical: bool,
}

/// Replays the run saved in the folder at `path`, and compares the learner with that of its checkpoint.
///
/// # Errors
/// The folder has no run, or an invalid one, or the replay fails.
pub fn verify(path: &Path) -> Result<ReplayResult, RunError> {
    let (folder, config) = RunFolder::open(path)?;
    let learner = checkpoint::load(&folder, &config)?.learner;
    let journal = Journal::load(&folder, &config, &learner)?;
    let replayed = journal.replay(initial_policy(&folder, &journal.config)?.as_ref())?;
    let bytes = |learner: &Learner| {
        let mut bytes = Vec::new();
        learner.save(&mut bytes).map_err(|error| RunError::Failed(error.to_string()))?;
        Ok::<_, RunError>(bytes)
    };
    let same = bytes(&learner)? == bytes(&replayed.world().resource::<ActiveLearner>().0)?;
    Ok(ReplayResult { steps: journal.steps, interventions: journal.entries.len(), bit_identical: same })
}

/// The policy that the run in `folder` started from, if any.
///
/// # Errors
/// The policy's file cannot be read.
pub fn initial_policy(folder: &RunFolder, config: &RunConfig) -> Result<Option<Policy>, RunError> {
    if config.transfer.is_none() {
        return Ok(None);
    }
    policy_card::read(&folder.path().join(INITIAL_POLICY_FILE)).map(Some)
}
