//! What a frame of the window costs the CPU, beside the control steps: the scene taken, the screen laid out, its
//! triangles made. (What the GPU does with them is not in it.) At 30 frames a second a frame has 33 ms.
//!
//! `cargo bench --bench frame`, with the feature `gui`.

#[path = "support/allocator.rs"]
mod allocator;
#[cfg(feature = "gui")]
#[path = "../tests/support/headless_app.rs"]
mod headless_app;

#[cfg(feature = "gui")]
mod frames {
    use std::time::Duration;

    use divan::Bencher;
    use wayfield::app::commands::{Command, Pace};
    use wayfield::app::session::StartOptions;
    use wayfield::app::view_state::Overlays;

    use super::headless_app::HeadlessApp;

    const EVERYTHING: Overlays =
        Overlays { beams: true, path: true, trails: true, potential: true, value: true, q_values: true };

    /// A headless_app that has trained for a while and is paused.
    fn trained(steps: u64, first: StartOptions) -> HeadlessApp {
        let mut headless_app = HeadlessApp::new(StartOptions { pace: Pace::Full, ..first });
        while headless_app.steps() < steps {
            headless_app.frame(Duration::from_millis(16));
        }
        headless_app.command(Command::Pause(true));
        headless_app.frame(Duration::from_millis(16));
        headless_app
    }

    #[divan::bench(sample_count = 60)]
    fn one_arena(bencher: Bencher) {
        let mut headless_app = trained(2_000, StartOptions::default());
        bencher.bench_local(|| headless_app.frame(Duration::from_millis(16)));
    }

    #[divan::bench(sample_count = 60)]
    fn one_arena_with_every_overlay(bencher: Bencher) {
        let mut headless_app = trained(2_000, StartOptions::default());
        headless_app.view_state().overlays = EVERYTHING;
        bencher.bench_local(|| headless_app.frame(Duration::from_millis(16)));
    }

    #[divan::bench(sample_count = 60)]
    fn sixteen_arenas_as_a_grid(bencher: Bencher) {
        let mut headless_app = trained(2_000, StartOptions::default());
        headless_app.view_state().grid = true;
        bencher.bench_local(|| headless_app.frame(Duration::from_millis(16)));
    }

    /// At full speed: 12 ms of it are control steps, or one step more.
    #[divan::bench(sample_count = 60)]
    fn one_arena_while_training_at_full_speed(bencher: Bencher) {
        let mut headless_app = trained(2_000, StartOptions::default());
        headless_app.command(Command::Pause(false));
        bencher.bench_local(|| headless_app.frame(Duration::from_millis(16)));
    }
}

fn main() {
    divan::main();
}
