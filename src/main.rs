//! The binary: one command line, one exit status; in a browser, the page's door.

/// Rapier and dfdx allocate in every step: what that costs is told in docs/performance.md.
#[cfg(not(target_arch = "wasm32"))]
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    wayfield::cli::main(std::time::Instant::now())
}

#[cfg(target_arch = "wasm32")]
fn main() {
    wayfield::app::browser::run();
}
