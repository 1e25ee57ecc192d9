//! The web page around the app in a browser, in place of a command line, a disk and dialogs.
//!
//! In: the address of the page, and files that the user gives to it. Out: files to download, a share link, the status of the
//! training run (for screen readers and tests), and the message of a panic.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::{Mutex, PoisonError};

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy::time::Real;
use serde::Serialize;
use wasm_bindgen::prelude::*;

use super::CurrentViewState;
use super::commands::{Command, Pace, SessionMode};
use super::controls;
use super::page;
use super::session::autosave::AUTOSAVE_INTERVAL;
use super::session::{
    ActiveMode, AutosaveOptions, Journal, Notices, Pacer, ScenarioSource, StartOptions, Throughput,
    TrainingRun,
};
use super::window::{self, WindowOptions};
use crate::agent::ActiveLearner;
use crate::import::{is_image, is_map_or_world};
use crate::run::folder::RunConfig;
use crate::run::{self, shipped};
use crate::scenario::{to_ron, virtual_files};

/// Files from the user that have not been opened yet.
static INBOX: Mutex<Vec<virtual_files::VirtualFile>> = Mutex::new(Vec::new());

/// Takes a file that the user has given to the page.
#[wasm_bindgen]
pub fn receive_file(name: String, bytes: Vec<u8>) {
    INBOX.lock().unwrap_or_else(PoisonError::into_inner).push((name, bytes));
}

/// Starts the app with the options in the address, and returns. The browser then calls the app for each frame.
pub fn run() {
    std::panic::set_hook(Box::new(|panic| page::failed(&panic.to_string())));
    let default = StartOptions::default();
    let mut invalid_options = Vec::new();
    let seed = parse_query("seed", "use a whole number, 0 or more", &mut invalid_options);
    let pace = parse_query("pace", "use 0.01 to 100 (times real time), or full", &mut invalid_options);
    let mut scenario = page::query_parameter("scenario").unwrap_or(default.scenario);
    if let Some(text) = page::embedded_scenario() {
        // The text is a scenario, even if the link's run started in a shipped one or in an imported map.
        if shipped::is_scenario(&scenario) {
            scenario = "scenario.ron".into();
        } else if is_map_or_world(Path::new(&scenario)) {
            scenario += ".ron";
        }
        virtual_files::add_upload(scenario.clone(), text.into_bytes());
    }
    let start = StartOptions {
        scenario,
        preset: page::query_parameter("preset").unwrap_or(default.preset),
        seed: seed.unwrap_or(default.seed),
        pace: pace.unwrap_or(default.pace),
        paused: page::query_parameter("paused").is_some(),
        edit: page::query_parameter("edit").is_some(),
        invalid_options,
        autosave: Some(AutosaveOptions { folder: PathBuf::new(), every: AUTOSAVE_INTERVAL }),
        ..default
    };
    if let Err(error) = window::run(WindowOptions { start, ..WindowOptions::default() }) {
        page::failed(&error.to_string());
    }
}

/// The query parameter `key`, parsed. An invalid value is added to `invalid_options`, with `help`.
fn parse_query<T: FromStr>(key: &str, help: &str, invalid_options: &mut Vec<String>) -> Option<T> {
    let text = page::query_parameter(key)?;
    let value = text.parse().ok();
    if value.is_none() {
        invalid_options.push(format!("Invalid address: {key}={text}\nhelp: {help}"));
    }
    value
}

/// Placeholder: the browser's file picker needs no state.
#[derive(Resource, Default)]
pub struct FileDialogs;

/// Opens files from the user, downloads saved files, and answers commands that need a dialog.
pub(super) fn run_file_dialogs(
    mut messages: ResMut<Messages<Command>>,
    mut seen: Local<bevy::ecs::message::MessageCursor<Command>>,
    run: Res<TrainingRun>,
    view_state: Res<CurrentViewState>,
) {
    let mut answers = Vec::new();
    for command in seen.read(&messages) {
        match command {
            Command::OpenDialog | Command::OpenInEditor(None) => page::open_file_picker(),
            Command::SaveScenario { scenario, based_on, path: None } => {
                let path = scenario_file_name(&scenario.name);
                answers.push(Command::SaveScenario {
                    scenario: scenario.clone(),
                    based_on: based_on.clone(),
                    path: Some(path),
                });
            }
            Command::SaveDialog(what) => {
                answers.push(Command::Save(*what, run.suggested_file_name(*what).into()));
            }
            _ => {}
        }
    }
    let files = std::mem::take(&mut *INBOX.lock().unwrap_or_else(PoisonError::into_inner));
    let has_map = files.iter().any(|(name, _)| is_map_or_world(Path::new(name)));
    for (name, bytes) in files {
        virtual_files::add_upload(name.clone(), bytes);
        // The image of a map is read with the map.
        if has_map && is_image(Path::new(&name)) {
            continue;
        }
        let in_editor = view_state.0.editor.is_some() && name.ends_with(".ron");
        answers.push(if in_editor {
            Command::OpenInEditor(Some(name.into()))
        } else {
            Command::Open(name.into())
        });
    }
    messages.write_batch(answers);
    for (name, bytes) in virtual_files::take_downloads() {
        page::save(&name, &bytes);
    }
}

/// The file name for a scenario called `name`.
fn scenario_file_name(name: &str) -> PathBuf {
    let plain = |c: char| if c.is_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    let stem: String = name.chars().map(plain).collect();
    let stem = stem.trim_matches('-');
    format!("{}.ron", if stem.is_empty() { "scenario" } else { stem }).into()
}

/// Makes the address a link that starts the same training run. It embeds the user's own scenario. There is no link for the user's
/// own preset or set, nor for a run that started from a policy.
fn update_share_link(config: &RunConfig) {
    let RunConfig { scenario_from, preset_from, seed, scenario, transfer, .. } = config;
    let is_set = config.scenario_set.is_some();
    let as_shipped = match is_set {
        true => shipped::is_level_generator(scenario_from) || shipped::is_set(scenario_from),
        false => {
            shipped::is_scenario(scenario_from)
                && shipped::scenario(scenario_from).is_ok_and(|shipped| shipped == *scenario)
        }
    };
    let embedded = if as_shipped || is_set { None } else { to_ron(scenario).ok() };
    if shipped::is_preset(preset_from) && transfer.is_none() && (as_shipped || embedded.is_some()) {
        page::set_share_link(scenario_from, preset_from, &seed.to_string(), embedded);
    } else {
        page::clear_share_link();
    }
}

/// Returns checksums of the initial state and the first control steps of a training run, as hexadecimal digits; or an error
/// message. The tests compare them with those of a native build ([`crate::run::fingerprint`]).
#[wasm_bindgen]
pub fn fingerprint(scenario: &str, preset: &str, seed: u32, control_steps: u32) -> String {
    match run::fingerprint::fingerprint(scenario, preset, seed.into(), control_steps) {
        Ok(print) => print.to_string(),
        Err(error) => error.to_string(),
    }
}

/// Returns left, top, width and height, in CSS pixels, of the control or arena object with this accessible name in the last
/// frame; undefined if it is disabled or absent. The tests click there.
#[wasm_bindgen]
pub fn control(name: &str) -> Option<Vec<f64>> {
    controls::find(name).map(Vec::from)
}

/// The status that is reported to the page once per second.
#[derive(Clone, Default, Serialize)]
pub(super) struct PageStatus {
    scenario: String,
    preset: String,
    seed: u64,
    mode: SessionMode,
    pace: Option<Pace>,
    paused: bool,
    /// Whether the scenario differs from its file.
    scenario_modified: bool,
    episodes: u64,
    env_steps: u64,
    gradient_steps: u64,
    /// Success rate of the last evaluation, 0 to 1.
    success_rate: Option<f64>,
    best_success_rate: Option<f64>,
    frames: u64,
    frames_per_s: f64,
    /// Total time spent on control steps, in ms.
    stepping_ms: f64,
    /// Longest time spent on control steps in one frame, in ms.
    longest_slice_ms: f64,
    /// Text of the latest notice.
    notice: Option<String>,
}

/// The resources of the session that are reported.
#[derive(SystemParam)]
pub(super) struct SessionView<'w> {
    run: Res<'w, TrainingRun>,
    mode: Res<'w, ActiveMode>,
    pacer: Res<'w, Pacer>,
    source: Res<'w, ScenarioSource>,
    throughput: Res<'w, Throughput>,
    notices: Res<'w, Notices>,
    journal: Res<'w, Journal>,
    learner: Res<'w, ActiveLearner>,
}

/// Reports the status of the training run to the page, and keeps the address up to date.
pub(super) fn report_to_page(
    session: SessionView,
    time: Res<Time<Real>>,
    mut status: Local<PageStatus>,
    mut reported_s: Local<f64>,
    mut linked: Local<Option<RunConfig>>,
) {
    if status.frames == 0 {
        page::started();
    }
    let spent_ms = session.pacer.spent().as_secs_f64() * 1e3;
    status.frames += 1;
    status.stepping_ms += spent_ms;
    status.longest_slice_ms = status.longest_slice_ms.max(spent_ms);
    let now_s = time.elapsed_secs_f64();
    if now_s - *reported_s < 1.0 && status.frames > 1 {
        return;
    }
    *reported_s = now_s;
    if linked.as_ref() != Some(&session.journal.config) {
        update_share_link(&session.journal.config);
        *linked = Some(session.journal.config.clone());
    }
    update(&mut status, &session);
    if let Ok(json) = serde_json::to_string(&*status) {
        page::report(&json);
    }
}

fn update(status: &mut PageStatus, session: &SessionView) {
    let (config, trainer_state) = (&session.run.config, &session.run.trainer_state);
    let learner = &session.learner.0;
    status.scenario.clone_from(&config.scenario_from);
    status.preset.clone_from(&config.preset_from);
    status.seed = config.seed;
    status.mode = session.mode.mode();
    status.pace = Some(session.pacer.pace);
    status.paused = session.pacer.is_paused();
    status.scenario_modified = session.source.is_modified(config);
    status.episodes = learner.episodes();
    status.env_steps = learner.env_steps();
    status.gradient_steps = learner.gradient_steps();
    status.success_rate = trainer_state.last_success_rate;
    status.best_success_rate = trainer_state.best.as_ref().map(|best| best.success_rate);
    status.frames_per_s = session.throughput.rates().frames_per_s;
    status.notice = session.notices.list().pop().map(|notice| notice.text);
}
