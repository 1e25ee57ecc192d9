//! The session: what goes on behind the screen. Orders are carried out, time passes, episodes are noted.
//!
//! In: orders, the time between frames. Out: control steps of the same plugins that train without a window, and what is
//! known of the training: its configuration, where it stands, its journal, its curves.
//!
//! | file | duty |
//! |---|---|
//! | `pacer.rs` | how many control steps a frame is given |
//! | `advance.rs` | a frame: orders, then steps, and what is noted after each |
//! | `execute.rs` | each order |
//! | `start_training.rs` | a training begun: anew, from a policy, from a checkpoint |
//! | `modes.rs` | who drives, with the training set aside meanwhile |
//! | `interventions.rs` | a goal, a robot, an obstacle put elsewhere |
//! | `journal.rs` | all that the hand did, to be replayed |
//! | `trails.rs` | the ways driven |
//! | `scenario_changes.rs` | another world under the training: edited, or changed in its file |
//! | `file_watch.rs` | the scenario's file, watched |
//! | `open.rs`, `save.rs` | files read and written |
//!
//! What is learnt depends on the configuration, the journal, and the number of steps; not on when they were taken, nor on
//! what was looked at.

mod advance;
mod execute;
#[cfg(not(target_arch = "wasm32"))]
mod file_watch;
pub mod interventions;
pub mod journal;
mod modes;
mod open;
pub mod pacer;
mod save;
mod scenario_changes;
mod start_training;
pub mod trails;

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use bevy::platform::cell::SyncCell;
use bevy::platform::time::Instant;
use bevy::prelude::*;

use super::app_snapshot::{Choice, Notice, Severity};
use super::commands::{Command, Pace, SessionMode};
use super::history::History;
use crate::agent::ActionSources;
use crate::policy::Policy;
use crate::run::background_evaluator::BackgroundEvaluator;
use crate::run::checkpoint::TrainerState;
use crate::run::folder::RunConfig;
use crate::run::metric_rows::EvaluationRow;
use crate::scenario::Scenario;
use crate::simulation::SimulationBuilder;
use journal::Journal;
use pacer::Pacer;
use trails::Trails;

/// What to begin with.
#[derive(Clone, Debug, PartialEq)]
pub struct StartOptions {
    /// A shipped scenario's name, or a file.
    pub scenario: String,
    /// A shipped preset's name, or a file.
    pub preset: String,
    /// The seed of every random draw.
    pub seed: u64,
    /// How quickly time passes.
    pub pace: Pace,
    /// Whether it stands still at first.
    pub paused: bool,
    /// A policy or a run to open at once.
    pub open: Option<PathBuf>,
    /// The world is to be edited, though it may not fit together yet.
    pub edit: bool,
    /// What of all that was asked for could not be understood, in words: to be told.
    pub invalid_options: Vec<String>,
}

impl Default for StartOptions {
    /// Scenario I and the default preset, five times as quick as life: the robot can drive within the first minute.
    fn default() -> Self {
        Self {
            scenario: "scenario-1".into(),
            preset: "fast".into(),
            seed: 0,
            pace: Pace::Times(5.0),
            paused: false,
            open: None,
            edit: false,
            invalid_options: Vec::new(),
        }
    }
}

/// The learning curves.
#[derive(Resource)]
pub struct TrainingHistory(pub History);

/// What goes on.
#[derive(Resource)]
pub struct Session {
    /// The training: all that was resolved.
    pub config: RunConfig,
    /// Where it stands, beside its learner.
    pub trainer_state: TrainerState,
    /// What the hand did to it.
    pub journal: Journal,
    /// The policy that it started from.
    pub init: Option<Policy>,
    /// Who drives.
    pub mode: SessionMode,
    /// When control steps are taken.
    pub pacer: Pacer,
    /// A second policy, to compare with, and its name.
    pub opened_policy: Option<(String, Policy)>,
    /// What the user should know, and since when.
    notices: Vec<(Notice, Instant)>,
    /// Scenarios and presets of the user's own that were opened.
    pub user_scenarios: Vec<Choice>,
    /// The same for presets.
    pub user_presets: Vec<Choice>,
    /// How quickly it goes.
    pub throughput: Throughput,
    /// The world of the training, whoever drives meanwhile.
    scenario: Arc<Scenario>,
    /// The world as its file has it, or as it is shipped.
    loaded_scenario: Scenario,
    /// The world that was saved last, and its file.
    pub saved_scenario: Option<(String, Arc<Scenario>)>,
    /// A world that was opened to be edited: another number with each, its name or file, the world.
    pub draft: Option<(u64, String, Arc<Scenario>)>,
    /// Another world that is to be taken when the next episode ends.
    pending_scenario: Option<Scenario>,
    /// Files that are watched.
    #[cfg(not(target_arch = "wasm32"))]
    file_watches: file_watch::FileWatches,
    evaluations: Vec<EvaluationRow>,
    /// (A channel's end may be used by one thread at a time; who has the session alone, has it alone.)
    evaluator: SyncCell<BackgroundEvaluator>,
    /// A policy is being examined.
    evaluating: bool,
    /// The world was changed since the examiner got to know it.
    evaluator_is_stale: bool,
    suspended: Option<modes::SuspendedTraining>,
    rounds: modes::Rounds,
    /// The training went wrong: it cannot go on.
    broken: bool,
    /// A file of another's making that was to be written over once.
    overwrite_requested: Option<PathBuf>,
    /// What was asked to be opened once, though a training would be gone with it.
    open_requested_once: Option<PathBuf>,
    /// Env steps when the policy or the run was saved last.
    saved_at: Option<u64>,
    began: Instant,
    /// Wall time before that, if it was resumed, in s.
    previous_wall_s: f64,
}

impl Session {
    fn wall_s(&self) -> f64 {
        self.previous_wall_s + self.began.elapsed().as_secs_f64()
    }

    /// Tells the user something, in place of what was told before in the same words up to the first colon.
    pub fn notify(&mut self, severity: Severity, text: impl Into<String>) {
        let text = text.into();
        self.retract_notice(text.split(':').next().unwrap_or_default());
        if self.notices.len() == MAX_NOTICES {
            self.notices.remove(0);
        }
        self.notices.push((Notice { severity, text }, Instant::now()));
    }

    /// Takes back what was told in these words, up to the first colon.
    fn retract_notice(&mut self, words: &str) {
        self.notices.retain(|(notice, _)| notice.text.split(':').next() != Some(words));
    }

    /// What the user should know. What only confirms goes by itself after a while.
    #[must_use]
    pub fn notices(&self) -> Vec<Notice> {
        self.notices.iter().map(|(notice, _)| notice.clone()).collect()
    }

    fn expire_notices(&mut self) {
        self.notices.retain(|(notice, since)| {
            notice.severity == Severity::Error || since.elapsed() < INFO_NOTICE_DURATION
        });
    }

    /// Whether the world is another than its file has it: something was moved by hand, or it was edited and not saved.
    #[must_use]
    pub fn scenario_modified(&self) -> bool {
        self.loaded_scenario != self.config.scenario
    }

    /// Whether nothing happens by itself: time stands still, and nobody is being examined.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.pacer.paused && !self.evaluating
    }

    /// Whether a training of some worth, which stands at `env_steps`, would be gone with this session.
    #[must_use]
    pub fn would_lose_training(&self, env_steps: u64) -> bool {
        env_steps > MIN_ENV_STEPS_WORTH_KEEPING && self.saved_at != Some(env_steps)
    }
}

/// More notices than these are not kept.
const MAX_NOTICES: usize = 4;

/// So long a notice stays that something went as asked.
const INFO_NOTICE_DURATION: Duration = Duration::from_secs(8);

/// A training is of some worth from so many env steps on.
const MIN_ENV_STEPS_WORTH_KEEPING: u64 = 20_000;

/// Steps taken over about the last second.
#[derive(Clone, Debug, Default)]
pub struct Throughput {
    /// When so many control steps and env steps had been taken in all.
    seen: VecDeque<(f64, u64, u64)>,
    steps: u64,
    env_steps: u64,
}

impl Throughput {
    const WINDOW_S: f64 = 1.0;

    fn stepped(&mut self, arenas: usize) {
        self.steps += 1;
        self.env_steps += arenas as u64;
    }

    fn frame(&mut self, now_s: f64) {
        self.seen.push_back((now_s, self.steps, self.env_steps));
        while self.seen.len() > 2 && self.seen.get(1).is_some_and(|seen| now_s - seen.0 >= Self::WINDOW_S) {
            self.seen.pop_front();
        }
    }

    /// Control steps, env steps (of all arenas) and frames a second.
    #[must_use]
    pub fn per_s(&self) -> (f64, f64, f64) {
        match (self.seen.front(), self.seen.back()) {
            (Some(first), Some(last)) if last.0 > first.0 => {
                let seconds = last.0 - first.0;
                let rate = |count: u64| count as f64 / seconds;
                (rate(last.1 - first.1), rate(last.2 - first.2), rate(self.seen.len() as u64 - 1))
            }
            _ => (0.0, 0.0, 0.0),
        }
    }
}

/// Responsible for the training and its time. Adds the plugins of the training itself.
pub struct SessionPlugin {
    /// What to begin with.
    pub first: StartOptions,
}

impl Plugin for SessionPlugin {
    fn build(&self, app: &mut App) {
        SimulationBuilder::new(&Arc::default()).training().add_to(app);
        let first = self.first.clone();
        app.add_message::<Command>()
            .init_resource::<Trails>()
            .init_resource::<ActionSources>()
            .insert_resource(TrainingHistory(History::new()))
            .add_systems(PreStartup, move |world: &mut World| start_training::first_session(world, &first))
            .add_systems(Update, advance::advance.run_if(resource_exists::<Session>));
    }
}
