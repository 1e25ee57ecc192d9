//! The handler of Ctrl-C and SIGTERM.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::run::progress::print_stderr;

/// The stop flag, set by the first Ctrl-C or SIGTERM. A second signal ends the process at once.
pub fn stop_on_signal() -> &'static AtomicBool {
    static STOP: AtomicBool = AtomicBool::new(false);
    let handler = || {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        print_stderr("stopping: saving a checkpoint (press Ctrl-C again to quit without saving)");
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        print_stderr(&format!("warning: Ctrl-C will not save a checkpoint: {error}"));
    }
    &STOP
}
