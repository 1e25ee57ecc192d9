//! Autosaves from earlier visits in a browser, and what the page reports about autosaves.
//!
//! In: calls from the page. Out: the session to offer, its files, and failures. The page chooses the newest session that no
//! other tab is writing, and deletes old ones.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use wasm_bindgen::prelude::*;

use crate::app::app_status::LastSession;
use crate::app::page;
use crate::run::RunError;

/// An autosave from an earlier visit.
#[derive(Clone, Debug)]
pub(super) struct FoundSession(LastSession);

impl FoundSession {
    /// The session as plain data to show.
    pub(super) fn describe(&self) -> LastSession {
        self.0.clone()
    }
}

/// The autosave that the page offers, if there is one. If the user has already asked to continue it, requests its files
/// instead.
pub(super) fn find(_: &Path) -> Vec<FoundSession> {
    let note = page::last_session().and_then(|note| serde_json::from_str(&note).ok());
    if note.is_some() && page::continues_last_session() {
        page::load_session();
        return Vec::new();
    }
    note.map(FoundSession).into_iter().collect()
}

/// What the page has reported.
struct PageReports {
    /// Whether the training should be saved soon: the user may be about to leave.
    save_soon: bool,
    /// Number of the last autosave that was passed to the page.
    last: u32,
    /// The result of storing it.
    stored: Option<Result<(), RunError>>,
    /// Files received so far of the session that the user continues.
    files: BTreeMap<String, Vec<u8>>,
    /// All of these files once they have been received, or the reason why they could not be read.
    session: Option<Result<BTreeMap<String, Vec<u8>>, RunError>>,
}

static REPORTS: Mutex<PageReports> = Mutex::new(PageReports {
    save_soon: false,
    last: 0,
    stored: None,
    files: BTreeMap::new(),
    session: None,
});

fn reports() -> MutexGuard<'static, PageReports> {
    REPORTS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether the page has asked for an autosave since the last call.
pub(super) fn take_save_soon() -> bool {
    std::mem::take(&mut reports().save_soon)
}

/// The number of the next autosave. A late report about an earlier one is ignored from now on.
pub(super) fn next_number() -> u32 {
    let mut reports = reports();
    reports.stored = None;
    reports.last += 1;
    reports.last
}

/// The result of storing the last autosave, once.
pub(super) fn take_stored() -> Option<Result<(), RunError>> {
    reports().stored.take()
}

/// The files of the session that the user continues, once they have all been received.
pub(super) fn take_session() -> Option<Result<BTreeMap<String, Vec<u8>>, RunError>> {
    reports().session.take()
}

/// Asks for an autosave within a few seconds.
#[wasm_bindgen]
pub fn save_soon() {
    reports().save_soon = true;
}

/// Reports that autosave `number` was stored, or `error`, the reason why it was not.
#[wasm_bindgen]
pub fn autosave_stored(number: u32, error: Option<String>) {
    let mut reports = reports();
    if number == reports.last {
        reports.stored = Some(error.map_or(Ok(()), |error| Err(RunError::Failed(error))));
    }
}

/// Receives a file of the session that the user continues.
#[wasm_bindgen]
pub fn receive_session_file(name: String, bytes: Vec<u8>) {
    reports().files.insert(name, bytes);
}

/// Reports that all files of the session have been passed, or why they could not be read.
#[wasm_bindgen]
pub fn session_received(error: Option<String>) {
    let mut reports = reports();
    let files = std::mem::take(&mut reports.files);
    reports.session = Some(error.map_or(Ok(files), |error| Err(RunError::Failed(error))));
}
