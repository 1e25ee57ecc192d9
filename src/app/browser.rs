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

use super::CurrentViewState;
use super::commands::{Command, Pace, SessionMode};
use super::session::{Session, StartOptions};
use super::window::{self, WindowOptions};
use crate::agent::ActiveLearner;
use crate::run::folder::RunConfig;
use crate::run::{self, shipped};
use crate::scenario::{to_ron, virtual_files};

#[wasm_bindgen]
extern "C" {
    /// The value of `key` in the page's address.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn query_parameter(key: &str) -> Option<String>;
    /// The app runs: the page needs to show nothing of its own.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn started();
    /// It cannot go on, and why.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn failed(text: &str);
    /// Asks the user for a file.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn open_file_picker();
    /// Saves a file where the browser keeps such.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn save(name: &str, bytes: &[u8]);
    /// How the training stands, as JSON.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn report(json: &str);
    /// The page's address becomes one that begins the same training; `world` is the scenario's text, if it is not one that
    /// is shipped.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn set_share_link(scenario: &str, preset: &str, seed: &str, world: Option<String>);
    /// The page's address becomes one that asks for nothing.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn clear_share_link();
    /// The text of a scenario that the address itself holds.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    fn embedded_scenario() -> Option<String>;
    /// Keeps a text from one visit to the next.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn save_preferences(text: &str);
    /// What was kept.
    #[wasm_bindgen(js_namespace = wayfieldPage)]
    pub(super) fn load_preferences() -> Option<String>;
}

/// Files that the page took from the user and nobody has opened yet.
static INBOX: Mutex<Vec<virtual_files::VirtualFile>> = Mutex::new(Vec::new());

/// The page hands in a file of the user's.
#[wasm_bindgen]
pub fn receive_file(name: String, bytes: Vec<u8>) {
    INBOX.lock().unwrap_or_else(PoisonError::into_inner).push((name, bytes));
}

/// Begins what the page's address asks for, and returns; the browser calls from then on.
pub fn run() {
    std::panic::set_hook(Box::new(|panic| failed(&panic.to_string())));
    let usual = StartOptions::default();
    let mut invalid_options = Vec::new();
    let seed = parse_query("seed", "give a whole number from 0 on", &mut invalid_options);
    let pace = parse_query("pace", "give 0.01 to 100 times real time, or full", &mut invalid_options);
    let mut scenario = query_parameter("scenario").unwrap_or(usual.scenario);
    if let Some(text) = embedded_scenario() {
        scenario = if shipped::is_scenario(&scenario) { "world.ron".into() } else { scenario };
        virtual_files::add_upload(scenario.clone(), text.into_bytes());
    }
    let first = StartOptions {
        scenario,
        preset: query_parameter("preset").unwrap_or(usual.preset),
        seed: seed.unwrap_or(usual.seed),
        pace: pace.unwrap_or(usual.pace),
        paused: query_parameter("paused").is_some(),
        open: None,
        edit: query_parameter("edit").is_some(),
        invalid_options,
    };
    if let Err(error) = window::run(WindowOptions { first, ..WindowOptions::default() }) {
        failed(&error.to_string());
    }
}

/// What the page's address says of `key`; what cannot be read is told, with the mend.
fn parse_query<T: FromStr>(key: &str, mend: &str, invalid_options: &mut Vec<String>) -> Option<T> {
    let text = query_parameter(key)?;
    let value = text.parse().ok();
    if value.is_none() {
        invalid_options.push(format!("{key}={text} in the page's address: {mend}"));
    }
    value
}

/// Needed in place of the system's dialogs' state: there is none.
#[derive(Resource, Default)]
pub struct FileDialogs;

/// Opens what was handed in, saves what was handed out, and answers the orders that ask for a dialog.
pub(super) fn run_file_dialogs(
    mut messages: ResMut<Messages<Command>>,
    mut seen: Local<bevy::ecs::message::MessageCursor<Command>>,
    session: Option<Res<Session>>,
    view_state: Res<CurrentViewState>,
) {
    let mut answers = Vec::new();
    for command in seen.read(&messages) {
        match command {
            Command::OpenDialog | Command::OpenInEditor(None) => open_file_picker(),
            Command::SaveScenario { scenario, like, path: None } => {
                let path = scenario_file_name(&scenario.name);
                answers.push(Command::SaveScenario {
                    scenario: scenario.clone(),
                    like: like.clone(),
                    path: Some(path),
                });
            }
            Command::SaveDialog(what) => {
                answers.extend(
                    session
                        .iter()
                        .map(|session| Command::Save(*what, session.suggested_file_name(*what).into())),
                );
            }
            _ => {}
        }
    }
    for (name, bytes) in std::mem::take(&mut *INBOX.lock().unwrap_or_else(PoisonError::into_inner)) {
        virtual_files::add_upload(name.clone(), bytes);
        let edits = view_state.0.editor.is_some() && name.ends_with(".ron");
        answers.push(if edits {
            Command::OpenInEditor(Some(name.into()))
        } else {
            Command::Open(name.into())
        });
    }
    messages.write_batch(answers);
    for (name, bytes) in virtual_files::take_downloads() {
        save(&name, &bytes);
    }
}

/// A file's name for a world that is called `name`.
fn scenario_file_name(name: &str) -> PathBuf {
    let plain = |c: char| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    let stem: String = name.chars().map(plain).collect();
    format!("{}.ron", stem.trim_matches('-')).into()
}

/// The page's address becomes a link to what goes on: whoever follows it begins the same training. A world of the user's
/// own goes with it. There is no link to a preset of the user's own, nor to what began from a policy.
fn update_share_link(begun: &RunConfig) {
    let RunConfig { scenario_from, preset_from, seed, scenario, transfer, .. } = begun;
    let as_shipped = shipped::is_scenario(scenario_from)
        && shipped::scenario(scenario_from).is_ok_and(|shipped| shipped == *scenario);
    let world = if as_shipped { None } else { to_ron(scenario).ok() };
    if shipped::is_preset(preset_from) && transfer.is_none() && (as_shipped || world.is_some()) {
        set_share_link(scenario_from, preset_from, &seed.to_string(), world);
    } else {
        clear_share_link();
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
    mode: SessionMode,
    pace: Option<Pace>,
    paused: bool,
    /// The world is another than its file has it.
    scenario_modified: bool,
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
pub(super) fn report_to_page(
    session: Option<Res<Session>>,
    trainer: Option<Res<ActiveLearner>>,
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
        update_share_link(&session.journal.begun);
        *linked = Some(session.journal.begun.clone());
    }
    told.scenario.clone_from(&config.scenario_from);
    told.preset.clone_from(&config.preset_from);
    told.seed = config.seed;
    told.mode = session.mode;
    told.pace = Some(session.pacer.pace);
    told.paused = session.pacer.paused;
    told.scenario_modified = session.scenario_modified();
    told.episodes = trainer.0.episodes();
    told.env_steps = trainer.0.env_steps();
    told.gradient_steps = trainer.0.gradient_steps();
    told.success_rate = session.trainer_state.last_success_rate;
    told.best_success_rate = session.trainer_state.best.as_ref().map(|best| best.success_rate);
    told.frames_per_s = session.throughput.per_s().2;
    told.notice = session.notices().pop().map(|notice| notice.text);
    if let Ok(json) = serde_json::to_string(&*told) {
        report(&json);
    }
}
