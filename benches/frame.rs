//! What a frame of the window costs the CPU, beside the control steps: the scene taken, the screen laid out, its
//! triangles made. (What the GPU does with them is not in it.) At 30 frames a second a frame has 33 ms.
//!
//! `cargo bench --bench frame`, with the feature `window`.

#[path = "support/allocator.rs"]
mod allocator;
#[cfg(feature = "window")]
#[path = "../tests/support/studio.rs"]
mod studio;

#[cfg(feature = "window")]
mod frames {
    use std::time::Duration;

    use divan::Bencher;
    use wayfield::app::desk::Overlays;
    use wayfield::app::orders::{Order, Pace};
    use wayfield::app::session::First;

    use super::studio::Studio;

    const EVERYTHING: Overlays =
        Overlays { beams: true, path: true, trails: true, potential: true, value: true, q_values: true };

    /// A studio that has trained for a while and is paused.
    fn trained(steps: u64, first: First) -> Studio {
        let mut studio = Studio::new(First { pace: Pace::Full, ..first });
        while studio.steps() < steps {
            studio.frame(Duration::from_millis(16));
        }
        studio.order(Order::Pause(true));
        studio.frame(Duration::from_millis(16));
        studio
    }

    #[divan::bench(sample_count = 60)]
    fn one_arena(bencher: Bencher) {
        let mut studio = trained(2_000, First::default());
        bencher.bench_local(|| studio.frame(Duration::from_millis(16)));
    }

    #[divan::bench(sample_count = 60)]
    fn one_arena_with_every_overlay(bencher: Bencher) {
        let mut studio = trained(2_000, First::default());
        studio.desk().overlays = EVERYTHING;
        bencher.bench_local(|| studio.frame(Duration::from_millis(16)));
    }

    #[divan::bench(sample_count = 60)]
    fn sixteen_arenas_as_a_grid(bencher: Bencher) {
        let mut studio = trained(2_000, First::default());
        studio.desk().grid = true;
        bencher.bench_local(|| studio.frame(Duration::from_millis(16)));
    }

    /// At full speed: 12 ms of it are control steps, or one step more.
    #[divan::bench(sample_count = 60)]
    fn one_arena_while_training_at_full_speed(bencher: Bencher) {
        let mut studio = trained(2_000, First::default());
        studio.order(Order::Pause(false));
        bencher.bench_local(|| studio.frame(Duration::from_millis(16)));
    }
}

fn main() {
    divan::main();
}
