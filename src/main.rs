//! The binary: one command line, one exit status.

use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    wayfield::cli::main(Instant::now())
}
