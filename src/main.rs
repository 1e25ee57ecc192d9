//! The program's entry point: the command line, or the app in a browser.

/// A fast allocator, because rapier and dfdx allocate in every step (docs/performance.md).
#[cfg(not(target_arch = "wasm32"))]
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    wayfield::cli::main(std::time::Instant::now(), wayfield::simulation::Extensions::default())
}

#[cfg(target_arch = "wasm32")]
fn main() {
    wayfield::app::browser::run();
}
