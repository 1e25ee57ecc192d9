//! Commands: everything that the user can ask for, as messages.
//!
//! In: the screen writes commands while it is drawn. Out: the session executes them between control steps, and records those
//! that affect the training in its journal. The screen changes the session in no other way. Replies go to the editor.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::app_status::Notice;
use super::moves::MoveRequest;
use crate::scenario::Scenario;

/// Speed of the simulated time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Pace {
    /// A multiple of real time, 0.01 to 100.
    Times(f32),
    /// As fast as possible within each frame's budget.
    Full,
}

impl FromStr for Pace {
    type Err = String;

    /// Parses `full`, or a multiple of real time such as `5` or `5x`.
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "full" {
            return Ok(Self::Full);
        }
        match text.strip_suffix('x').unwrap_or(text).parse::<f32>() {
            Ok(times) if (0.01..=100.0).contains(&times) => Ok(Self::Times(times)),
            _ => Err("give 0.01 to 100, or full".into()),
        }
    }
}

/// What drives the robots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum SessionMode {
    /// The learner drives in all arenas, explores and learns.
    #[default]
    Train,
    /// The current or the best policy drives greedily in one arena; nothing is learned.
    Test,
    /// The user drives in one arena, and the current or the best policy in another, to the same goals.
    Drive,
    /// The current or the best policy drives side by side with the opened policy or a classical driver, to the same goals.
    Compare,
}

/// A policy of the session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PolicySource {
    /// The policy in training.
    #[default]
    Current,
    /// The best policy of the training run so far, by evaluation.
    Best,
    /// The policy that the user has opened.
    Opened,
}

/// A command of the user.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Pauses time, or lets it run.
    Pause(bool),
    /// Takes one control step, then pauses.
    Step,
    /// Sets the pace.
    SetPace(Pace),
    /// Sets the mode.
    SetMode(SessionMode),
    /// Sets the policy that Test, Drive and Compare use: the current or the best one.
    SetTested(PolicySource),
    /// Starts a training run from random weights.
    StartTraining {
        /// A shipped scenario's name, or a file.
        scenario: String,
        /// A shipped preset's name, or a file.
        preset: String,
        /// Seed of every random draw.
        seed: u64,
    },
    /// Starts a training run from the weights of a policy: knowledge transfer.
    Transfer {
        /// The policy.
        policy: PolicySource,
        /// A shipped scenario's name, or a file. If it is the current scenario, the user's changes are kept.
        scenario: String,
        /// A shipped preset's name, or a file. If it is the current preset, it is kept as it is.
        preset: String,
        /// Seed of every random draw.
        seed: u64,
        /// Initial epsilon of the new run, 0 to 1 (the paper: 0.5).
        epsilon: f32,
    },
    /// Moves an object.
    Move(MoveRequest),
    /// While testing, driving or comparing: gives all robots the goal at the requested position, and restarts their time
    /// limits.
    SetGoal(MoveRequest),
    /// Sets the motion of the robot that the user drives, as an index into its motions.
    Steer(usize),
    /// Opens a dialog for the file to open with [`Command::Open`].
    OpenDialog,
    /// Opens a shipped policy that can drive here, to compare with.
    OpenExpert,
    /// Lets the classical driver of this name drive next to the current or the best policy.
    OpenDriver(&'static str),
    /// Lets the current or the best policy drive with a map, next to the same policy without one.
    OpenWithMap,
    /// Lets a shipped policy with a map drive next to the current or the best policy.
    OpenExpertWithMap,
    /// Opens the best policy of the training run so far, to compare with.
    OpenBest,
    /// Opens a policy, a run folder, a checkpoint, a scenario, a set of scenarios, a preset, a classical driver, a map or a
    /// Gazebo world.
    Open(PathBuf),
    /// Opens a dialog for the file to save to.
    SaveDialog(SaveKind),
    /// Saves to a file or folder.
    Save(SaveKind, PathBuf),
    /// Saves the run under `runs/` (in a browser, the policy), then executes the command, which would discard the training.
    SaveFirst(Box<Command>),
    /// Continues the last session from its autosave.
    ContinueLastSession,
    /// Withdraws the offer to continue the last session.
    DismissLastSession,
    /// Opens the editor with the unsaved changes of an earlier session.
    RestoreEdits,
    /// Withdraws the offer to restore unsaved changes.
    DismissEdits,
    /// Closes the app; asks first if an unsaved training run would be lost.
    Close,
    /// Closes the app: an answer to the question of [`Command::Close`].
    Quit {
        /// Whether to save the run first.
        save: bool,
    },
    /// Keeps the app open: the other answer to that question.
    KeepOpen,
    /// Applies an edited scenario to the training. If that fails, the editor opens with the scenario again.
    ApplyScenario {
        /// The scenario.
        scenario: Arc<Scenario>,
        /// The scenario's file or shipped name.
        from: String,
        /// Whether to restart the training from random weights, with the same preset and seed; otherwise it continues.
        restart: bool,
    },
    /// Saves an edited scenario as RON. [`EditorReply::Saved`] is the answer.
    SaveScenario {
        /// The scenario.
        scenario: Arc<Scenario>,
        /// File or shipped name of the scenario it is based on, whose comments are kept.
        based_on: String,
        /// The file; `None` opens a dialog.
        path: Option<PathBuf>,
    },
    /// Opens a scenario in the editor; `None` opens a dialog. [`EditorReply::Opened`] is the answer.
    OpenInEditor(Option<PathBuf>),
    /// Dismisses a notice.
    DismissNotice(Notice),
}

/// The file format of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FigureFormat {
    /// Pixels. Not in a browser.
    Png,
    /// Vectors.
    Svg,
}

/// The part of a training run to save.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaveKind {
    /// The current policy, as safetensors.
    Policy,
    /// The best policy so far, as safetensors.
    BestPolicy,
    /// The whole run, as a folder that `wayfield --resume` can continue.
    Run,
    /// The episodes, as CSV.
    Csv,
    /// The learning curves, as a figure.
    Figure(FigureFormat),
    /// The current scenario, as RON.
    Scenario,
}

/// An answer of the session to the editor.
#[derive(Clone, Debug, PartialEq)]
pub enum EditorReply {
    /// A scenario was saved.
    Saved {
        /// Path of the saved file.
        file: String,
        /// The saved scenario.
        scenario: Arc<Scenario>,
    },
    /// A scenario was opened to be edited.
    Opened {
        /// The scenario's file or shipped name.
        from: String,
        /// The scenario, which may be invalid.
        scenario: Arc<Scenario>,
    },
}
