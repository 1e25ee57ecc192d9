//! The handler of Ctrl-C, and of a closed console, on Windows.

use std::io;
use std::sync::atomic::Ordering;

use super::{FIRST, STOP};
use crate::run::progress::print_stderr;

/// The number of SIGINT on Unix. Here, too, it determines the exit status after a Ctrl-C.
const SIGINT: usize = 2;

/// Does nothing: only on Unix do the limits of a process cause signals.
pub fn survive_limits() {}

/// Does nothing: without a handler, a Ctrl-C ends the process anyway.
pub fn exit_on_signal() {}

/// Installs the handler. A second Ctrl-C ends the process at once.
pub fn stop_on_signal(announcement: &'static str) -> io::Result<()> {
    let handler = move || {
        // Before `STOP`, because the code that sees the stop flag set then reads `FIRST`.
        if FIRST.swap(SIGINT, Ordering::SeqCst) != 0 {
            std::process::exit(128 + SIGINT as i32);
        }
        STOP.store(true, Ordering::SeqCst);
        print_stderr(announcement);
    };
    ctrlc::set_handler(handler).map_err(io::Error::other)
}

/// The name of the only signal.
pub fn name(_: u8) -> &'static str {
    "Ctrl-C"
}

/// The number of the last signal; 0 before the first. Here, every signal is SIGINT, so the last has the number of the first.
pub fn last_signal() -> usize {
    FIRST.load(Ordering::SeqCst)
}
