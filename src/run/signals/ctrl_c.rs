//! The handler of Ctrl-C, and of a closed console, on Windows.

use std::io;
use std::sync::atomic::Ordering;

use super::{FIRST, STOP};
use crate::run::progress::print_stderr;

/// The number of SIGINT on Unix. Here, too, it determines the exit status after a Ctrl-C.
const SIGINT: usize = 2;

/// Does nothing. On Unix, a process gets signals when it exceeds its limits, such as that of file sizes; here it does not.
pub fn survive_limits() {}

/// Does nothing, because a Ctrl-C ends the process unless there is a handler.
pub fn exit_on_signal() {}

/// Installs the handler. A second Ctrl-C ends the process at once.
pub fn stop_on_signal(announcement: &'static str) -> io::Result<()> {
    let handler = move || {
        // `FIRST` is set before `STOP`, because whoever sees `STOP` set reads `FIRST`.
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
