//! The signals that ask the program to stop: Ctrl-C (SIGINT), SIGTERM, SIGHUP, and those by which batch systems announce the
//! end of a job's time.
//!
//! In: signals. Out: a stop flag, which long-running work polls, and the first signal, which determines the exit status.
//! Further signals change nothing, with one exception: a second Ctrl-C in the terminal ends the process at once (on Unix, only
//! if it comes at least half a second after the first signal). On Linux, a signal that was already ignored when the process
//! started (`nohup`, a background job of `sh`) stays ignored.

#[cfg(not(unix))]
#[path = "signals/ctrl_c.rs"]
mod platform;
#[cfg(unix)]
#[path = "signals/unix.rs"]
mod platform;

use std::sync::Once;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use super::progress::print_stderr;

pub use platform::{exit_on_signal, survive_limits};

/// Whether to stop. Also set by the code that polls it, to stop parallel work.
static STOP: AtomicBool = AtomicBool::new(false);
/// The number of the first signal; 0 before the first.
static FIRST: AtomicUsize = AtomicUsize::new(0);

/// A signal that asked the program to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StopSignal(u8);

impl StopSignal {
    /// The exit status of a process that stopped because of this signal: 128 plus its number, as in a shell.
    #[must_use]
    pub fn exit_status(self) -> u8 {
        128 + self.0
    }

    /// The signal's name, such as `SIGTERM`.
    #[must_use]
    pub fn name(self) -> &'static str {
        platform::name(self.0)
    }
}

/// Installs the handlers of the signals, once. Returns the stop flag, which the first signal sets. That signal also prints
/// `announcement` on stderr.
pub fn stop_on_signal(announcement: &'static str) -> &'static AtomicBool {
    static HANDLERS: Once = Once::new();
    HANDLERS.call_once(|| {
        if let Err(error) = platform::stop_on_signal(announcement) {
            print_stderr(&format!(
                "warning: signals such as Ctrl-C will end this process without saving: {error}"
            ));
        }
    });
    &STOP
}

/// The first signal that asked the program to stop since [`stop_on_signal`] was called; the last one, if the first is not
/// recorded yet.
#[must_use]
pub fn received() -> Option<StopSignal> {
    let number = match FIRST.load(Ordering::SeqCst) {
        0 => platform::last_signal(),
        first => first,
    };
    u8::try_from(number).ok().filter(|number| *number != 0).map(StopSignal)
}
