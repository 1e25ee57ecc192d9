//! The page around the app in a browser: what a command line, a disk and dialogs are elsewhere.
//!
//! In: the page's address, files that the user hands to it. Out: files to be saved, what is to be remembered, how the
//! training stands in words (for who cannot see the canvas, and for tests), and a panic's message. The other side is
//! `web/page.js`: an object `wayfieldPage` with a function for each thing said here.

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::{Mutex, PoisonError};

use bevy::prelude::*;
use bevy::time::Real;
use serde::Serialize;
use wasm_bindgen::prelude::*;

use super::OnDesk;
use super::orders::{Mode, Order, Pace};
use super::session::{First, Session};
use super::window::{self, Opening};
use crate::agent::Trainer;
use crate::run::folder::RunConfig;
use crate::run::{self, shipped};
use crate::scenario::{shelf, to_ron};

#[wasm_bindgen]
extern "C" {
    /// The value of `key` in the page's address.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn asked(key: &str) -> Option<String>;
    /// The app runs: the page needs to show nothing of its own.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn started();
    /// It cannot go on, and why.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn failed(text: &str);
    /// Asks the user for a file.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn choose();
    /// Saves a file where the browser keeps such.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn save(name: &str, bytes: &[u8]);
    /// How the training stands, as JSON.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn report(json: &str);
    /// The page's address becomes one that begins the same training; `world` is the scenario's text, if it is not one that
    /// is shipped.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn address(scenario: &str, preset: &str, seed: &str, world: Option<String>);
    /// The page's address becomes one that asks for nothing.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn no_address();
    /// The text of a scenario that the address itself holds.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn enclosed() -> Option<String>;
    /// Keeps a text from one visit to the next.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn remember(text: &str);
    /// What was kept.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn remembered() -> Option<String>;
}

/// Files that the page took from the user and nobody has opened yet.
static INBOX: Mutex<Vec<shelf::Book>> = Mutex::new(Vec::new());

/// The page hands in a file of the user's.
#[wasm_bindgen]
pub fn hand_in(name: String, bytes: Vec<u8>) {
    INBOX.lock().unwrap_or_else(PoisonError::into_inner).push((name, bytes));
}

/// Begins what the page's address asks for, and returns; the browser calls from then on.
pub fn run() {
    std::panic::set_hook(Box::new(|panic| failed(&panic.to_string())));
    let usual = First::default();
    let mut not_understood = Vec::new();
    let seed = take("seed", "give a whole number from 0 on", &mut not_understood);
    let pace = take("pace", "give 0.01 to 100 times real time, or full", &mut not_understood);
    let mut scenario = asked("scenario").unwrap_or(usual.scenario);
    if let Some(text) = enclosed() {
        scenario = if shipped::is_scenario(&scenario) { "world.ron".into() } else { scenario };
        shelf::hand_in(scenario.clone(), text.into_bytes());
    }
    let first = First {
        scenario,
        preset: asked("preset").unwrap_or(usual.preset),
        seed: seed.unwrap_or(usual.seed),
        pace: pace.unwrap_or(usual.pace),
        paused: asked("paused").is_some(),
        open: None,
        edit: asked("edit").is_some(),
        not_understood,
    };
    if let Err(error) = window::run(Opening { first, ..Opening::default() }) {
        failed(&error.to_string());
    }
}

/// What the page's address says of `key`; what cannot be read is told, with the mend.
fn take<T: FromStr>(key: &str, mend: &str, not_understood: &mut Vec<String>) -> Option<T> {
    let text = asked(key)?;
    let value = text.parse().ok();
    if value.is_none() {
        not_understood.push(format!("{key}={text} in the page's address: {mend}"));
    }
    value
}

/// Needed in place of the system's dialogs' state: there is none.
#[derive(Resource, Default)]
pub struct Dialogs;

/// Opens what was handed in, saves what was handed out, and answers the orders that ask for a dialog.
pub(super) fn answer(
    mut messages: ResMut<Messages<Order>>,
    mut seen: Local<bevy::ecs::message::MessageCursor<Order>>,
    session: Option<Res<Session>>,
    desk: Res<OnDesk>,
) {
    let mut answers = Vec::new();
    for order in seen.read(&messages) {
        match order {
            Order::OpenDialog | Order::EditOpen(None) => choose(),
            Order::SaveWorld { scenario, like, path: None } => {
                let path = world_file(&scenario.name);
                answers.push(Order::SaveWorld {
                    scenario: scenario.clone(),
                    like: like.clone(),
                    path: Some(path),
                });
            }
            Order::SaveDialog(what) => {
                answers.extend(
                    session.iter().map(|session| Order::Save(*what, session.proposed_name(*what).into())),
                );
            }
            _ => {}
        }
    }
    for (name, bytes) in std::mem::take(&mut *INBOX.lock().unwrap_or_else(PoisonError::into_inner)) {
        shelf::hand_in(name.clone(), bytes);
        let edits = desk.0.editor.is_some() && name.ends_with(".ron");
        answers.push(if edits { Order::EditOpen(Some(name.into())) } else { Order::Open(name.into()) });
    }
    messages.write_batch(answers);
    for (name, bytes) in shelf::take_out() {
        save(&name, &bytes);
    }
}

/// A file's name for a world that is called `name`.
fn world_file(name: &str) -> PathBuf {
    let plain = |c: char| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    let stem: String = name.chars().map(plain).collect();
    format!("{}.ron", stem.trim_matches('-')).into()
}

/// The page's address becomes a link to what goes on: whoever follows it begins the same training. A world of the user's
/// own goes with it. There is no link to a preset of the user's own, nor to what began from a policy.
fn tell_address(begun: &RunConfig) {
    let RunConfig { scenario_from, preset_from, seed, scenario, transfer, .. } = begun;
    let as_shipped = shipped::is_scenario(scenario_from)
        && shipped::scenario(scenario_from).is_ok_and(|shipped| shipped == *scenario);
    let world = if as_shipped { None } else { to_ron(scenario).ok() };
    if shipped::is_preset(preset_from) && transfer.is_none() && (as_shipped || world.is_some()) {
        address(scenario_from, preset_from, &seed.to_string(), world);
    } else {
        no_address();
    }
}

/// Checksums of what a training begins with and of its first control steps, weights and world, as 16 hexadecimal digits;
/// or why there are none. For the tests: natively they must be the same ([`crate::run::fingerprint`]).
#[wasm_bindgen]
pub fn fingerprint(scenario: &str, preset: &str, seed: u32, control_steps: u32) -> String {
    match run::fingerprint::fingerprint(scenario, preset, seed.into(), control_steps) {
        Ok(print) => print.to_string(),
        Err(error) => error.to_string(),
    }
}

/// What the page is told once a second.
#[derive(Clone, Default, Serialize)]
pub(super) struct Report {
    scenario: String,
    preset: String,
    seed: u64,
    mode: Mode,
    pace: Option<Pace>,
    paused: bool,
    /// The world is another than its file has it.
    world_changed: bool,
    episodes: u64,
    env_steps: u64,
    gradient_steps: u64,
    /// Of the last evaluation, 0 to 1.
    success_rate: Option<f64>,
    best_success_rate: Option<f64>,
    frames: u64,
    frames_per_s: f64,
    /// Time that steps took in all, and the most in one frame, in ms.
    stepping_ms: f64,
    longest_slice_ms: f64,
    /// The last notice.
    notice: Option<String>,
}

/// Tells the page how the training stands.
pub(super) fn tell(
    session: Option<Res<Session>>,
    trainer: Option<Res<Trainer>>,
    time: Res<Time<Real>>,
    mut told: Local<Report>,
    mut told_s: Local<f64>,
    mut linked: Local<Option<RunConfig>>,
) {
    let (Some(session), Some(trainer)) = (session, trainer) else { return };
    if told.frames == 0 {
        started();
    }
    let spent_ms = session.pacer.spent().as_secs_f64() * 1e3;
    told.frames += 1;
    told.stepping_ms += spent_ms;
    told.longest_slice_ms = told.longest_slice_ms.max(spent_ms);
    let now_s = time.elapsed_secs_f64();
    if now_s - *told_s < 1.0 && told.frames > 1 {
        return;
    }
    *told_s = now_s;
    let config = &session.config;
    if linked.as_ref() != Some(&session.journal.begun) {
        tell_address(&session.journal.begun);
        *linked = Some(session.journal.begun.clone());
    }
    told.scenario.clone_from(&config.scenario_from);
    told.preset.clone_from(&config.preset_from);
    told.seed = config.seed;
    told.mode = session.mode;
    told.pace = Some(session.pacer.pace);
    told.paused = session.pacer.paused;
    told.world_changed = session.world_changed();
    told.episodes = trainer.0.episodes();
    told.env_steps = trainer.0.env_steps();
    told.gradient_steps = trainer.0.gradient_steps();
    told.success_rate = session.standing.last_success_rate;
    told.best_success_rate = session.standing.best.as_ref().map(|best| best.success_rate);
    told.frames_per_s = session.speed.per_s().2;
    told.notice = session.notices().pop().map(|notice| notice.text);
    if let Ok(json) = serde_json::to_string(&*told) {
        report(&json);
    }
}
