//! The current autosave, in words: for a process that ends because of a panic, a signal, or a lost display or GPU.
//!
//! It is global, because a panic hook and the thread that watches the display have no access to the world.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use bevy::platform::time::Instant;

use crate::scenario::quoted;

/// The folder of the last autosave of the current training run, and when it was up to date.
static LATEST: Mutex<Option<(PathBuf, Instant)>> = Mutex::new(None);

/// Records that the autosave at `path` is up to date now; `None` if the current training run has no autosave. The first
/// autosave of a training run is announced on stderr, because a process that is killed cannot report the path later.
pub(super) fn set(path: Option<&Path>) {
    let mut latest = LATEST.lock().unwrap_or_else(PoisonError::into_inner);
    #[cfg(not(target_arch = "wasm32"))]
    if let Some(path) = path.filter(|path| latest.as_ref().is_none_or(|(earlier, _)| earlier != path)) {
        crate::run::progress::print_stderr(&format!("autosave: {}", path.display()));
    }
    *latest = path.map(|path| (path.into(), Instant::now()));
}

/// The path and the age of the current autosave, and how to continue from it; `None` if there is none.
#[must_use]
pub fn describe() -> Option<String> {
    let latest = LATEST.lock().unwrap_or_else(PoisonError::into_inner);
    let (path, since) = latest.as_ref()?;
    let age = match since.elapsed().as_secs() {
        0..=1 => String::new(),
        seconds => format!(", as it was {seconds} s ago"),
    };
    Some(format!(
        "the training run is in {}{age}; help: start wayfield again, or continue it with `wayfield --resume {}`",
        path.display(),
        quoted(path)
    ))
}
