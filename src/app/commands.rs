//! Orders: all that the user's hand can ask for, as messages.
//!
//! In: the screen writes them while it is drawn. Out: the session carries them out between control steps, and writes
//! those that touch what is learnt into its journal. Nothing else of the room reaches the world.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

use bevy::math::Vec2;
use serde::{Deserialize, Serialize};

use crate::scenario::Scenario;

/// How quickly simulated time passes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Pace {
    /// So many times real time.
    Times(f32),
    /// As quickly as it goes within a frame's budget.
    Full,
}

impl FromStr for Pace {
    type Err = String;

    /// `full`, or a number of times real time, as in `5` or `5x`.
    fn from_str(text: &str) -> Result<Self, String> {
        if text == "full" {
            return Ok(Self::Full);
        }
        match text.trim_end_matches('x').parse::<f32>() {
            Ok(times) if (0.01..=100.0).contains(&times) => Ok(Self::Times(times)),
            _ => Err("give 0.01 to 100, or full".into()),
        }
    }
}

/// What the robots are driven by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum SessionMode {
    /// All arenas explore, and the learner learns.
    #[default]
    Train,
    /// The present policy drives greedily in one arena; nothing is learnt.
    Test,
    /// The user drives in one arena, and the present policy beside in another, to the same goals.
    Drive,
    /// The present policy and the one that was opened, side by side, to the same goals.
    Compare,
}

/// Something that the user moves, in an arena's own coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MoveRequest {
    /// The target of an arena.
    Goal {
        /// Which arena.
        arena: usize,
        /// Where to, in m.
        to_m: Vec2,
    },
    /// The robot of an arena; its heading stays.
    Robot {
        /// Which arena.
        arena: usize,
        /// Where to, in m.
        to_m: Vec2,
    },
    /// An obstacle, in all arenas: the world itself is another then.
    Obstacle {
        /// In which arena the user sees it.
        arena: usize,
        /// Its number in the scenario.
        index: usize,
        /// Where its middle is to be there now, in m.
        to_m: Vec2,
    },
}

/// What the user asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Time stands still, or goes on.
    Pause(bool),
    /// One control step, and then stand still.
    Step,
    /// Time passes so quickly.
    SetPace(Pace),
    /// Who drives from now on.
    SetMode(SessionMode),
    /// A new training, from nothing: scenario and preset by name or file, and the seed.
    StartTraining {
        /// A shipped scenario's name, or a file.
        scenario: String,
        /// A shipped preset's name, or a file.
        preset: String,
        /// The seed of every random draw.
        seed: u64,
    },
    /// Training goes on in another scenario with the present weights: knowledge transfer.
    Transfer {
        /// A shipped scenario's name, or a file.
        scenario: String,
        /// Epsilon at its start, 0 to 1 (the paper: 0.5).
        epsilon: f32,
    },
    /// A new training of the same preset that starts from the opened policy, in the same scenario.
    TrainFromOpened {
        /// Epsilon at its start, 0 to 1.
        epsilon: f32,
    },
    /// Something was moved by hand.
    Move(MoveRequest),
    /// The motion that the user drives, an index into the robot's motions.
    Steer(usize),
    /// Asks by a dialog for a policy or a run's checkpoint, and opens it.
    OpenDialog,
    /// Opens the shipped policy that can drive here, beside the present one.
    OpenExpert,
    /// Opens a policy file, a run's folder or its checkpoint, a scenario or a preset.
    Open(PathBuf),
    /// Asks by a dialog where to, and saves it there.
    SaveDialog(SaveKind),
    /// Saves it there.
    Save(SaveKind, PathBuf),
    /// Training goes on in this world, which was edited.
    ApplyScenario {
        /// The world.
        scenario: Arc<Scenario>,
        /// By what name or file it is asked for.
        from: String,
        /// A new training begins there, of the same preset and seed; else the policy goes on.
        again: bool,
    },
    /// Saves an edited world as RON.
    SaveScenario {
        /// The world.
        scenario: Arc<Scenario>,
        /// The name or file that it was made from: its comments are kept.
        like: String,
        /// Where to; None: asks by a dialog.
        path: Option<PathBuf>,
    },
    /// Opens a scenario's file to be edited; None: asks by a dialog which.
    OpenInEditor(Option<PathBuf>),
    /// A notice was read: its index among the status's.
    DismissNotice(usize),
}

/// What can be saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaveKind {
    /// The present policy, as safetensors.
    Policy,
    /// The whole run as a folder that `wayfield --train --resume` goes on from.
    Run,
    /// The episodes' rows, as CSV.
    Csv,
    /// The learning curves, as PNG (as SVG where there is no disk).
    Png,
    /// The world as it stands, as RON.
    Scenario,
}
