//! The binary: one command line, one exit status; in a browser, the page's door.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    wayfield::cli::main(std::time::Instant::now())
}

#[cfg(target_arch = "wasm32")]
fn main() {
    wayfield::app::browser::run();
}
