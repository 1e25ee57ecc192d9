//! The training session of the app. It executes commands, advances simulated time and records the training.
//!
//! In: commands, and the time between frames. Out: control steps of the same plugins that a headless run uses, and the
//! resources below.
//!
//! | file | resource | purpose |
//! |---|---|---|
//! | `training_run.rs` | [`TrainingRun`] | configuration, progress, wall time |
//! | `active_mode.rs` | [`ActiveMode`] | training, or a demo with the training suspended |
//! | `pacer.rs` | [`Pacer`] | number of control steps per frame |
//! | `throughput.rs` | [`Throughput`] | steps and frames per second |
//! | `evaluations.rs` | [`Evaluations`] | evaluation during training |
//! | `journal.rs` | [`Journal`] | every intervention, for a replay |
//! | `scenario_source.rs` | [`ScenarioSource`] | the scenario's file |
//! | `file_watch.rs` | `FileWatches` | files that the user edits in another program |
//! | `open.rs` | [`OpenedFiles`] | files opened by the user |
//! | `comparison.rs` | | the second driver, to compare with |
//! | `notices.rs`, `run_notices.rs` | [`Notices`] | messages to the user; the message about questionable settings |
//! | `trails.rs` | [`Trails`] | the robots' paths |
//! | `advance.rs` | | a frame: commands, then control steps |
//! | `execute.rs` | | the execution of each command |
//! | `interventions.rs`, `scenario_changes.rs` | | changes made during a training run |
//! | `start_training.rs`, `saved_run.rs`, `first_training.rs` | | the start of a training run |
//! | `demo.rs` | | a policy or the user drives |
//! | `save.rs`, `run_snapshot.rs`, `editor_files.rs` | | the saving of files |
//! | `autosave/` | [`Autosave`] | a copy of the training run for the next session |
//! | `quit.rs` | [`QuitQuestion`] | quitting, and the question before it |
//! | `session_policy.rs` | | the policies that can be tested, saved or transferred |
//!
//! What is learned depends on the configuration, the journal and the number of steps, but not on when the steps were taken
//! or on what was displayed.

pub mod active_mode;
mod advance;
pub mod autosave;
pub(crate) mod comparison;
mod demo;
mod editor_files;
pub mod evaluations;
mod execute;
#[cfg(not(target_arch = "wasm32"))]
mod file_watch;
mod first_training;
pub mod interventions;
pub mod journal;
pub mod notices;
pub mod open;
pub mod pacer;
#[cfg(not(target_arch = "wasm32"))]
mod quit;
mod run_notices;
mod run_snapshot;
mod save;
mod saved_run;
mod scenario_changes;
pub mod scenario_source;
mod session_policy;
mod start_training;
pub mod throughput;
pub mod trails;
pub mod training_run;

use std::path::PathBuf;
use std::sync::Arc;

use bevy::prelude::*;

use super::commands::{Command, EditorReply, Pace};
use super::history::History;
use crate::agent::ActionSources;
use crate::run::settings::Settings;
use crate::simulation::{Extensions, SimulationBuilder};

pub use active_mode::ActiveMode;
pub use autosave::{Autosave, AutosaveOptions};
pub use evaluations::Evaluations;
pub use journal::Journal;
pub use notices::Notices;
pub use open::OpenedFiles;
pub use pacer::Pacer;
#[cfg(not(target_arch = "wasm32"))]
pub(crate) use save::unused_path;
pub use scenario_source::ScenarioSource;
pub use throughput::Throughput;
pub use trails::Trails;
pub use training_run::TrainingRun;

/// Options of the first training run.
#[derive(Clone, Debug, PartialEq)]
pub struct StartOptions {
    /// The scenario: a file or a shipped name.
    pub scenario: String,
    /// The preset: a file or a shipped name.
    pub preset: String,
    /// Settings of the preset. They must not change the scenario, which the app keeps equal to its file.
    pub settings: Settings,
    /// Seed of every random draw.
    pub seed: u64,
    /// Pace of simulated time.
    pub pace: Pace,
    /// Whether time is paused at first.
    pub paused: bool,
    /// A file or a run folder to open at the start.
    pub open: Option<PathBuf>,
    /// Index of the first episode of a demo, among the episodes of an evaluation with this seed.
    pub episode: u64,
    /// Whether to open the scenario in the editor. The scenario may then be invalid.
    pub edit: bool,
    /// Messages about invalid options, which are replaced by their defaults.
    pub invalid_options: Vec<String>,
    /// Where and how often to save the training run; `None` disables autosaves.
    pub autosave: Option<AutosaveOptions>,
    /// The user's plugins.
    pub extensions: Extensions,
}

impl Default for StartOptions {
    /// Scenario I and the default preset at five times real time. The robot learns to drive within the first minute.
    fn default() -> Self {
        Self {
            scenario: "scenario-1".into(),
            preset: "fast".into(),
            settings: Settings::default(),
            seed: 0,
            pace: Pace::Times(5.0),
            paused: false,
            open: None,
            episode: 0,
            edit: false,
            invalid_options: Vec::new(),
            autosave: None,
            extensions: Extensions::default(),
        }
    }
}

/// Whether the question before quitting is open. (In a browser it never is, because a page cannot keep its tab open.)
#[derive(Resource, Default)]
pub struct QuitQuestion(pub bool);

/// The learning curves.
#[derive(Resource)]
pub struct TrainingHistory(pub History);

/// The plugin of the session. It adds the plugins for training.
pub struct SessionPlugin {
    /// Options of the first training run.
    pub start: StartOptions,
}

impl Plugin for SessionPlugin {
    fn build(&self, app: &mut App) {
        let builder = SimulationBuilder::new(&Arc::default()).training();
        builder.extensions(&self.start.extensions).add_to(app);
        let start = self.start.clone();
        app.add_message::<Command>()
            .add_message::<EditorReply>()
            .init_resource::<Trails>()
            .init_resource::<ActionSources>()
            .init_resource::<Notices>()
            .init_resource::<OpenedFiles>()
            .init_resource::<Autosave>()
            .init_resource::<QuitQuestion>()
            .init_resource::<Throughput>()
            .insert_resource(TrainingHistory(History::new()))
            .add_systems(PreStartup, move |world: &mut World| first_training::start_first(world, &start))
            .add_systems(
                Update,
                (
                    advance::execute_commands,
                    #[cfg(not(target_arch = "wasm32"))]
                    file_watch::poll,
                    autosave::run,
                    advance::take_steps,
                    notices::expire,
                    throughput::record_frame,
                )
                    .chain()
                    .run_if(resource_exists::<TrainingRun>),
            );
    }
}
