//! Exits that the user did not start in the window: after a signal, a lost display, a lost GPU, or a panic.
//!
//! In: the cause of the exit. Out: the training run is saved if the Bevy world still exists, and its path is printed on
//! stderr.

use std::sync::Once;

use bevy::prelude::*;
use bevy::render::error_handler::{RenderError, RenderErrorHandler, RenderErrorPolicy};

use super::editor_backup;
use super::session::autosave::{latest, save_now};
use crate::run::RunError;
use crate::run::progress::print_stderr;
use crate::run::signals;

/// What the first signal prints.
const ANNOUNCEMENT: &str = "saving the training run, then closing (a second Ctrl-C quits without saving)";

/// The plugin that saves the training run when a signal arrives or the GPU is lost.
pub(super) struct ShutdownPlugin;

impl Plugin for ShutdownPlugin {
    fn build(&self, app: &mut App) {
        signals::stop_on_signal(ANNOUNCEMENT);
        report_autosave_after_panic();
        app.insert_resource(RenderErrorHandler(save_after_render_error))
            .add_systems(PreUpdate, save_after_signal);
    }
}

/// Saves the training run and closes the app after a signal.
fn save_after_signal(world: &mut World) {
    let Some(signal) = signals::received() else { return };
    save_or_warn(world);
    world.write_message(AppExit::from_code(signal.exit_status()));
}

/// Saves the training run and closes the app after a renderer error, such as a lost GPU.
pub fn save_after_render_error(error: &RenderError, world: &mut World, _: &mut World) -> RenderErrorPolicy {
    // Bevy calls this in every frame until the app has ended.
    if world.resource::<Messages<AppExit>>().is_empty() {
        print_stderr(&format!("error: the graphics device failed ({:?}: {})", error.ty, error.description));
        save_or_warn(world);
        world.write_message(AppExit::error());
    }
    RenderErrorPolicy::StopRendering
}

fn save_or_warn(world: &mut World) {
    if let Err(error) = save_now(world) {
        print_stderr(&format!("warning: autosave failed: {error}"));
    }
    match editor_backup::save_now(world) {
        Ok(Some(path)) => print_stderr(&format!(
            "the unsaved scenario is in {}; help: start wayfield again, which offers to restore it",
            path.display()
        )),
        Ok(None) => {}
        Err(error) => print_stderr(&format!("warning: backing up the unsaved scenario failed: {error}")),
    }
}

/// Installs a panic hook that also prints where the autosave is.
fn report_autosave_after_panic() {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let report = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            report(panic);
            if let Some(text) = latest::describe() {
                print_stderr(&text);
            }
        }));
    });
}

/// The result of the app that ended with `exit`.
///
/// # Errors
/// A signal or a failure ended it. The message has the path of the autosave.
pub(super) fn result(exit: &AppExit) -> Result<(), RunError> {
    let with_autosave = |text: &str| match latest::describe() {
        Some(autosave) => format!("{text}: {autosave}"),
        None => text.to_owned(),
    };
    match (exit, signals::received()) {
        (AppExit::Success, _) => Ok(()),
        (AppExit::Error(_), Some(_)) => Err(RunError::Stopped(with_autosave("stopped"))),
        (AppExit::Error(_), None) => {
            Err(RunError::Failed(with_autosave("the window closed unexpectedly (see above)")))
        }
    }
}

/// Watches the connection to the display in a thread. When the display is lost, prints where the autosave is, because the
/// X library then ends the process at once.
#[cfg(all(unix, not(target_os = "macos")))]
pub(super) fn watch_display(connection: impl x11rb::connection::Connection + Send + 'static) {
    use std::time::Duration;

    /// Time for the X library to end the process. If the main thread does not use the display meanwhile, this thread ends
    /// the process.
    const TIME_TO_EXIT: Duration = Duration::from_secs(2);

    let watch = move || {
        while connection.wait_for_event().is_ok() {}
        let text = latest::describe().map_or(String::new(), |autosave| format!(": {autosave}"));
        print_stderr(&format!("error: the display was lost{text}"));
        std::thread::sleep(TIME_TO_EXIT);
        std::process::exit(1);
    };
    // Without the thread, the next start still offers the autosave.
    let _ = std::thread::Builder::new().name("display".into()).spawn(watch);
}
