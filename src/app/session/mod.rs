//! The session: what goes on behind the screen. Orders are carried out, time passes, episodes are noted.
//!
//! In: orders, the time between frames. Out: control steps of the same plugins that train without a window, and what is
//! known of the training: its configuration, where it stands, its journal, its curves.
//!
//! | file | duty |
//! |---|---|
//! | `pacer.rs` | how many control steps a frame is given |
//! | `advance.rs` | a frame: orders, then steps, and what is noted after each |
//! | `carry_out.rs` | each order |
//! | `begin.rs` | a training begun: anew, from a policy, from a checkpoint |
//! | `modes.rs` | who drives, with the training set aside meanwhile |
//! | `hand.rs` | a target, a robot, an obstacle put elsewhere |
//! | `journal.rs` | all that the hand did, to be replayed |
//! | `trails.rs` | the ways driven |
//! | `worlds.rs` | another world under the training: edited, or changed in its file |
//! | `watch.rs` | the scenario's file, watched |
//! | `open.rs`, `save.rs` | files read and written |
//!
//! What is learnt depends on the configuration, the journal, and the number of steps; not on when they were taken, nor on
//! what was looked at.

mod advance;
mod begin;
mod carry_out;
pub mod hand;
pub mod journal;
mod modes;
mod open;
pub mod pacer;
mod save;
pub mod trails;
#[cfg(not(target_arch = "wasm32"))]
mod watch;
mod worlds;

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use bevy::platform::cell::SyncCell;
use bevy::platform::time::Instant;
use bevy::prelude::*;

use super::history::History;
use super::orders::{Mode, Order, Pace};
use super::status::{Choice, Notice, Weight};
use crate::agent::Drivers;
use crate::learning::Policy;
use crate::run::checkpoint::Standing;
use crate::run::examiner::Examiner;
use crate::run::folder::RunConfig;
use crate::run::records::EvaluationRow;
use crate::run::simulation;
use crate::scenario::Scenario;
use journal::Journal;
use pacer::Pacer;
use trails::Trails;

/// What to begin with.
#[derive(Clone, Debug, PartialEq)]
pub struct First {
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
    pub not_understood: Vec<String>,
}

impl Default for First {
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
            not_understood: Vec::new(),
        }
    }
}

/// The learning curves.
#[derive(Resource)]
pub struct Curves(pub History);

/// What goes on.
#[derive(Resource)]
pub struct Session {
    /// The training: all that was resolved.
    pub config: RunConfig,
    /// Where it stands, beside its learner.
    pub standing: Standing,
    /// What the hand did to it.
    pub journal: Journal,
    /// The policy that it started from.
    pub init: Option<Policy>,
    /// Who drives.
    pub mode: Mode,
    /// When control steps are taken.
    pub pacer: Pacer,
    /// A second policy, to compare with, and its name.
    pub opened: Option<(String, Policy)>,
    /// What the user should know, and since when.
    notices: Vec<(Notice, Instant)>,
    /// Scenarios and presets of the user's own that were opened.
    pub own_scenarios: Vec<Choice>,
    /// The same for presets.
    pub own_presets: Vec<Choice>,
    /// How quickly it goes.
    pub speed: Speed,
    /// The world of the training, whoever drives meanwhile.
    scenario: Arc<Scenario>,
    /// The world as its file has it, or as it is shipped.
    as_asked: Scenario,
    /// The world that was saved last, and its file.
    pub saved_world: Option<(String, Arc<Scenario>)>,
    /// A world that was opened to be edited: another number with each, its name or file, the world.
    pub draft: Option<(u64, String, Arc<Scenario>)>,
    /// Another world that is to be taken when the next episode ends.
    coming: Option<Scenario>,
    /// Files that are watched.
    #[cfg(not(target_arch = "wasm32"))]
    watches: watch::Watches,
    evaluations: Vec<EvaluationRow>,
    /// (A channel's end may be used by one thread at a time; who has the session alone, has it alone.)
    examiner: SyncCell<Examiner>,
    /// A policy is being examined.
    examining: bool,
    /// The world was changed since the examiner got to know it.
    examiner_is_stale: bool,
    aside: Option<modes::Aside>,
    rounds: modes::Rounds,
    /// The training went wrong: it cannot go on.
    broken: bool,
    /// A file of another's making that was to be written over once.
    overwrites: Option<PathBuf>,
    /// What was asked to be opened once, though a training would be gone with it.
    asked_once: Option<PathBuf>,
    /// Env steps when the policy or the run was saved last.
    saved_at: Option<u64>,
    began: Instant,
    /// Wall time before that, if it was resumed, in s.
    earlier_s: f64,
}

impl Session {
    fn wall_s(&self) -> f64 {
        self.earlier_s + self.began.elapsed().as_secs_f64()
    }

    /// Tells the user something, in place of what was told before in the same words up to the first colon.
    pub fn tell(&mut self, weight: Weight, text: impl Into<String>) {
        let text = text.into();
        self.untell(text.split(':').next().unwrap_or_default());
        if self.notices.len() == MOST_NOTICES {
            self.notices.remove(0);
        }
        self.notices.push((Notice { weight, text }, Instant::now()));
    }

    /// Takes back what was told in these words, up to the first colon.
    fn untell(&mut self, words: &str) {
        self.notices.retain(|(notice, _)| notice.text.split(':').next() != Some(words));
    }

    /// What the user should know. What only confirms goes by itself after a while.
    #[must_use]
    pub fn notices(&self) -> Vec<Notice> {
        self.notices.iter().map(|(notice, _)| notice.clone()).collect()
    }

    fn forget_old_notices(&mut self) {
        self.notices
            .retain(|(notice, since)| notice.weight == Weight::Failed || since.elapsed() < CONFIRMED_FOR);
    }

    /// Whether the world is another than its file has it: something was moved by hand, or it was edited and not saved.
    #[must_use]
    pub fn world_changed(&self) -> bool {
        self.as_asked != self.config.scenario
    }

    /// Whether nothing happens by itself: time stands still, and nobody is being examined.
    #[must_use]
    pub fn rests(&self) -> bool {
        self.pacer.paused && !self.examining
    }

    /// Whether a training of some worth, which stands at `env_steps`, would be gone with this session.
    #[must_use]
    pub fn would_discard(&self, env_steps: u64) -> bool {
        env_steps > WORTH_ENV_STEPS && self.saved_at != Some(env_steps)
    }
}

/// More notices than these are not kept.
const MOST_NOTICES: usize = 4;

/// So long a notice stays that something went as asked.
const CONFIRMED_FOR: Duration = Duration::from_secs(8);

/// A training is of some worth from so many env steps on.
const WORTH_ENV_STEPS: u64 = 20_000;

/// Steps taken over about the last second.
#[derive(Clone, Debug, Default)]
pub struct Speed {
    /// When so many control steps and env steps had been taken in all.
    seen: VecDeque<(f64, u64, u64)>,
    steps: u64,
    env_steps: u64,
}

impl Speed {
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
    pub first: First,
}

impl Plugin for SessionPlugin {
    fn build(&self, app: &mut App) {
        simulation::add_training(app);
        let first = self.first.clone();
        app.add_message::<Order>()
            .init_resource::<Trails>()
            .init_resource::<Drivers>()
            .insert_resource(Curves(History::new()))
            .add_systems(PreStartup, move |world: &mut World| begin::first(world, &first))
            .add_systems(Update, advance::advance.run_if(resource_exists::<Session>));
    }
}
