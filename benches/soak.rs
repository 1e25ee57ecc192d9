//! Soak test: hours of training in one process. Checks that memory and speed stay constant and that the counters agree.
//!
//! `cargo bench --bench soak -- headless [ENV_STEPS]` trains without a window, by default for 20 million env steps.
//! `cargo bench --bench soak -- window [MINUTES]` trains in the window at full pace, by default for an hour. It needs a display,
//! such as Xvfb. Both print a row for each tenth of the time and a result, and exit with status 1 if a check fails. Other load
//! affects the speeds: leave the machine idle, or give this process its own core.

#[path = "support/allocator.rs"]
mod allocator;
#[path = "support/process.rs"]
mod process;

use std::error::Error;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use process::{cpu_s, status_kb};
use wayfield::learning::LearningConfig;
use wayfield::run::folder::RunConfig;
use wayfield::run::preset::Budget;
use wayfield::run::train::{CHECKPOINT_INTERVAL, Job, train};

/// Fraction by which the last tenth may be slower than the first.
const SLOWER: f64 = 0.05;
/// Fraction by which memory may grow after the second tenth. (Buffers fill during the first.)
const GROWTH: f64 = 0.05;

/// A measurement of the process.
#[derive(Clone, Copy, Debug)]
struct Sample {
    wall_s: f64,
    cpu_s: f64,
    env_steps: u64,
    frames: u64,
    resident_kb: u64,
}

impl Sample {
    fn now(began: Instant, env_steps: u64, frames: u64) -> Self {
        let wall_s = began.elapsed().as_secs_f64();
        Self { wall_s, cpu_s: cpu_s(), env_steps, frames, resident_kb: status_kb("VmRSS:") }
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let count = arguments.get(1).map(|text| text.replace('_', "").parse::<u64>());
    let done = match (arguments.first().map(String::as_str), count) {
        (Some("headless"), None) => headless(20_000_000),
        (Some("headless"), Some(Ok(env_steps @ 1..))) => headless(env_steps),
        (Some("window"), None) => window::soak(60),
        (Some("window"), Some(Ok(minutes @ 1..))) => window::soak(minutes),
        (Some(mode @ ("headless" | "window")), _) => {
            Err(format!("give a whole number of at least 1 after `{mode}`, or none").into())
        }
        _ => {
            println!(
                "skipped, because it takes long; help: run it with `headless [ENV_STEPS]` or `window [MINUTES]`"
            );
            return ExitCode::SUCCESS;
        }
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Trains like `wayfield --train` with the default preset, but longer.
fn headless(env_steps: u64) -> Result<bool, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let mut config = RunConfig::resolve("scenario-1", "fast", 0)?;
    config.preset.budget = Budget::EnvSteps(env_steps);
    let arenas = config.preset.arenas as u64;
    let learning = config.preset.learning.clone();
    let out = folder.path().join("run");
    let began = Instant::now();
    let samples = Arc::new(Mutex::new(vec![Sample::now(began, 0, 0)]));
    let listener = {
        let samples = Arc::clone(&samples);
        Box::new(move |progress: &wayfield::run::progress::Progress| {
            let mut samples = samples.lock().expect("not poisoned");
            let last = samples.last().map_or(0, |sample| sample.env_steps);
            if progress.env_steps >= last + (env_steps / 1000).max(1) {
                samples.push(Sample::now(began, progress.env_steps, 0));
            }
        })
    };
    let job = Job::New { config: Box::new(config), policy: None, out: Some(out.clone()) };
    let (_, summary) = train(job, CHECKPOINT_INTERVAL, &AtomicBool::new(false), began, Some(listener))?;
    let samples = samples.lock().expect("not poisoned");
    let mut passed = report(&samples);
    let rows =
        |name: &str| std::fs::read_to_string(out.join(name)).map(|text| text.lines().count() as u64 - 1);
    passed &= agrees("env steps", summary.env_steps, env_steps.next_multiple_of(arenas));
    passed &= agrees("episodes and their rows", summary.episodes, rows("episodes.csv")?);
    passed &= agrees(
        "gradient steps",
        summary.gradient_steps,
        expected_gradient_steps(&learning, summary.env_steps),
    );
    Ok(passed)
}

#[cfg(feature = "gui")]
mod window {
    use std::time::Duration;

    use bevy::prelude::*;
    use wayfield::agent::ActiveLearner;
    use wayfield::app::Snapshot;
    use wayfield::app::app_status::Severity;
    use wayfield::app::commands::{Command, Pace, SaveKind};
    use wayfield::app::session::{Journal, StartOptions};
    use wayfield::app::view_state::Overlays;
    use wayfield::app::window::{WindowOptions, app};

    use super::*;

    /// Maximum time to wait for the run to be saved.
    const SAVE_TIMEOUT: Duration = Duration::from_secs(60);

    #[derive(Resource)]
    struct Soak {
        began: Instant,
        duration: Duration,
        frames: u64,
        samples: Vec<Sample>,
        run: std::path::PathBuf,
        /// Time at which saving was requested.
        save_requested: Option<Instant>,
        error_notices: Vec<String>,
    }

    /// The results, set when the app exits.
    #[derive(Resource, Clone, Default)]
    struct End(Arc<Mutex<Option<Results>>>);

    struct Results {
        samples: Vec<Sample>,
        /// Control steps, env steps, episodes, gradient steps.
        counts: [u64; 4],
        error_notices: Vec<String>,
    }

    /// Trains in the window for `minutes`, with all overlays but the potential.
    pub fn soak(minutes: u64) -> Result<bool, Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let start = StartOptions { pace: Pace::Full, ..StartOptions::default() };
        let preset = wayfield::run::shipped::preset(&start.preset)?;
        let overlays = Overlays { beams: true, path: true, trails: true, value: true, ..Default::default() };
        let options = WindowOptions {
            start,
            overlays: Some(overlays),
            size: Some((1000.0, 640.0)),
            ..WindowOptions::default()
        };
        let end = End::default();
        let run = folder.path().join("run");
        let began = Instant::now();
        app(options)
            .insert_resource(end.clone())
            .insert_resource(Soak {
                began,
                duration: Duration::from_secs(60 * minutes),
                frames: 0,
                samples: Vec::new(),
                run: run.clone(),
                save_requested: None,
                error_notices: Vec::new(),
            })
            .add_systems(Last, watch)
            .run();
        let results = end.0.lock().expect("not poisoned").take();
        let results = results.ok_or("the window was closed too early")?;
        let mut passed = report(&results.samples);
        let [steps, env_steps, episodes, gradient_steps] = results.counts;
        passed &= agrees("env steps, from the control steps", env_steps, steps * preset.arenas as u64);
        passed &=
            agrees("gradient steps", gradient_steps, expected_gradient_steps(&preset.learning, env_steps));
        for error in &results.error_notices {
            println!("error notice: {error}");
        }
        let rows = std::fs::read_to_string(run.join("episodes.csv"))?.lines().count() as u64 - 1;
        passed &= agrees("episodes and their rows", episodes, rows);
        Ok(passed && results.error_notices.is_empty())
    }

    /// Takes about 60 samples over the duration. At the end, saves the run, and closes the window once the run is saved or
    /// [`SAVE_TIMEOUT`] has passed.
    fn watch(
        mut soak: ResMut<Soak>,
        shown: Res<Snapshot>,
        journal: Option<Res<Journal>>,
        learner: Option<Res<ActiveLearner>>,
        end: Res<End>,
        mut commands: MessageWriter<Command>,
        mut exit: MessageWriter<AppExit>,
    ) {
        let (Some(journal), Some(learner), Some((_, status))) = (journal, learner, &shown.now) else {
            return;
        };
        let soak = &mut *soak;
        soak.frames += 1;
        let last = soak.samples.last().map_or(-1.0, |sample| sample.wall_s);
        let interval_s = soak.duration.as_secs_f64() / 60.0;
        if soak.samples.is_empty() || soak.began.elapsed().as_secs_f64() >= last + interval_s {
            let sample = Sample::now(soak.began, status.env_steps, soak.frames);
            println!("{sample:?}");
            soak.samples.push(sample);
        }
        // Only the latest notices are kept, so they are collected in every frame.
        for notice in status.notices.iter().filter(|notice| notice.severity == Severity::Error) {
            if !soak.error_notices.contains(&notice.text) {
                soak.error_notices.push(notice.text.clone());
            }
        }
        if soak.began.elapsed() < soak.duration {
            return;
        }
        let Some(since) = soak.save_requested else {
            soak.save_requested = Some(Instant::now());
            commands.write(Command::Pause(true));
            commands.write(Command::Save(SaveKind::Run, soak.run.clone()));
            return;
        };
        if soak.run.join("checkpoint").exists() || since.elapsed() > SAVE_TIMEOUT {
            let learner = &learner.0;
            *end.0.lock().expect("not poisoned") = Some(Results {
                samples: soak.samples.clone(),
                counts: [journal.steps, learner.env_steps(), learner.episodes(), learner.gradient_steps()],
                error_notices: std::mem::take(&mut soak.error_notices),
            });
            exit.write(AppExit::Success);
        }
    }
}

#[cfg(not(feature = "gui"))]
mod window {
    pub fn soak(_: u64) -> Result<bool, Box<dyn super::Error>> {
        Err("this build has no app; help: run without --no-default-features".into())
    }
}

/// Prints a row for each tenth. Returns whether, within the tolerances, the last is as fast as the first (by wall time or by CPU
/// time) and uses no more memory than the second.
fn report(samples: &[Sample]) -> bool {
    println!(
        "| part | env steps | env steps/s | env steps per CPU s | frames/s | resident MB |\n|---|---|---|---|---|---|"
    );
    let whole = samples.last().map_or(0.0, |last| last.wall_s);
    let at = |part: u32| {
        let until = whole * f64::from(part) / 10.0;
        samples.iter().rev().find(|sample| sample.wall_s <= until + 1e-9).unwrap_or(&samples[0])
    };
    let mut parts = Vec::new();
    for part in 1..=10 {
        let (from, to) = (at(part - 1), at(part));
        let wall_s = (to.wall_s - from.wall_s).max(1e-9);
        let steps = (to.env_steps - from.env_steps) as f64;
        let speed = steps / wall_s;
        let per_cpu = steps / (to.cpu_s - from.cpu_s).max(1e-9);
        let frames = (to.frames - from.frames) as f64 / wall_s;
        let mb = to.resident_kb as f64 / 1024.0;
        println!("| {part} | {} | {speed:.0} | {per_cpu:.0} | {frames:.1} | {mb:.1} |", to.env_steps);
        parts.push((speed, per_cpu, mb));
    }
    let ratio = |pick: fn(&(f64, f64, f64)) -> f64, from: usize| pick(&parts[9]) / pick(&parts[from]);
    let (speed, per_cpu, growth) = (ratio(|p| p.0, 0), ratio(|p| p.1, 0), ratio(|p| p.2, 1));
    println!(
        "\nlast tenth relative to the first: {speed:.3} env steps/s, {per_cpu:.3} env steps per CPU s; \
         memory relative to the second: {growth:.3}; peak {:.1} MB",
        status_kb("VmHWM:") as f64 / 1024.0
    );
    let passed = speed.max(per_cpu) >= 1.0 - SLOWER && growth <= 1.0 + GROWTH;
    println!("{}", if passed { "flat" } else { "NOT FLAT" });
    passed
}

fn agrees(what: &str, found: u64, expected: u64) -> bool {
    let passed = found == expected;
    println!("{what}: {found}{}", if passed { String::new() } else { format!(", BUT EXPECTED {expected}") });
    passed
}

/// Expected number of gradient steps after `env_steps`: an update at each multiple of `train_freq` from `learning_starts` on.
fn expected_gradient_steps(learning: &LearningConfig, env_steps: u64) -> u64 {
    let interval = learning.train_freq;
    let first = learning.replay.learning_starts.max(1).div_ceil(interval);
    (env_steps / interval + 1).saturating_sub(first) * u64::from(learning.gradient_steps)
}
