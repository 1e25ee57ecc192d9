//! Programs started with the default handling of signals.

use std::ffi::OsStr;
use std::process::Command;

/// The command for `program`. On Linux, it doesn't ignore SIGINT, SIGHUP or SIGTERM, even if the tests run in the background
/// of a shell or under `nohup`.
pub fn with_default_signals(program: impl AsRef<OsStr>) -> Command {
    if !cfg!(target_os = "linux") {
        return Command::new(program);
    }
    let mut command = Command::new("env");
    command.arg("--default-signal=INT,HUP,TERM").arg(program);
    command
}
