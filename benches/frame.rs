//! CPU time of a frame of the app apart from its control steps: extracting the scene, laying out the screen, tessellating it.
//! GPU time is not included. At 30 frames per second, a frame has 33 ms.
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
    use wayfield::app::session::{AutosaveOptions, StartOptions};
    use wayfield::app::view_state::Overlays;

    use super::headless_app::HeadlessApp;

    const ALL_OVERLAYS: Overlays =
        Overlays { beams: true, path: true, trails: true, potential: true, value: true, q_values: true };

    /// An app that has trained for `steps` control steps and is paused.
    fn trained(steps: u64, start: StartOptions) -> HeadlessApp {
        let mut app = HeadlessApp::new(StartOptions { pace: Pace::Full, ..start });
        while app.steps() < steps {
            app.frame(Duration::from_millis(16));
        }
        app.command(Command::Pause(true));
        app.frame(Duration::from_millis(16));
        app
    }

    #[divan::bench(sample_count = 60)]
    fn one_arena(bencher: Bencher) {
        let mut app = trained(2_000, StartOptions::default());
        bencher.bench_local(|| app.frame(Duration::from_millis(16)));
    }

    #[divan::bench(sample_count = 60)]
    fn one_arena_with_every_overlay(bencher: Bencher) {
        let mut app = trained(2_000, StartOptions::default());
        app.view_state().overlays = ALL_OVERLAYS;
        bencher.bench_local(|| app.frame(Duration::from_millis(16)));
    }

    #[divan::bench(sample_count = 60)]
    fn sixteen_arenas_as_a_grid(bencher: Bencher) {
        let mut app = trained(2_000, StartOptions::default());
        app.view_state().grid = true;
        bencher.bench_local(|| app.frame(Duration::from_millis(16)));
    }

    /// Copies a training run for an autosave, after 400,000 env steps, which fill the replay buffer.
    #[divan::bench(sample_count = 20, sample_size = 1)]
    fn one_arena_with_an_autosave(bencher: Bencher) {
        let folder = tempfile::tempdir().expect("temporary folder");
        let autosave = AutosaveOptions { folder: folder.path().into(), every: Duration::from_secs(1) };
        let start = StartOptions { autosave: Some(autosave), ..StartOptions::default() };
        let app = std::cell::RefCell::new(trained(25_000, start));
        let step = || {
            // Time to write the previous autosave.
            std::thread::sleep(Duration::from_secs(2));
            let mut app = app.borrow_mut();
            app.command(Command::Step);
            app.frame(Duration::from_millis(16));
        };
        bencher.with_inputs(step).bench_local_values(|()| app.borrow_mut().frame(Duration::from_millis(16)));
    }

    /// Includes control steps: 12 ms of them, plus the rest of the step in progress.
    #[divan::bench(sample_count = 60)]
    fn one_arena_while_training_at_full_speed(bencher: Bencher) {
        let mut app = trained(2_000, StartOptions::default());
        app.command(Command::Pause(false));
        bencher.bench_local(|| app.frame(Duration::from_millis(16)));
    }
}

fn main() {
    divan::main();
}
