//! Soak: hours of work in one process. Does memory stay flat, does it stay as quick as it was, do its counters agree?
//!
//! `cargo bench --bench soak -- headless [ENV_STEPS]` trains without a window, 20 million env steps unless told otherwise.
//! `cargo bench --bench soak -- window [MINUTES]` trains in the window at full pace, for an hour unless told otherwise; it
//! wants a display, such as Xvfb's. Both print a table of ten parts and a verdict, and end with status 1 if it is a bad
//! one. What else the machine does shows in the speeds: leave it alone meanwhile, or give this process a core of its own.

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

/// The last tenth may be slower than the first by this share.
const SLOWER: f64 = 0.05;
/// From its second tenth on (buffers fill in the first), memory may grow by this share.
const GROWTH: f64 = 0.05;

/// How the process stood at one moment.
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
        _ => {
            println!(
                "give `headless [ENV_STEPS]` or `window [MINUTES]`: this takes long, and is not run by default"
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

/// The default run, but longer, as `wayfield --train` does it.
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
        Box::new(move |status: &wayfield::run::progress::Progress| {
            let mut samples = samples.lock().expect("nobody panics while holding it");
            let last = samples.last().map_or(0, |sample| sample.env_steps);
            if status.env_steps >= last + (env_steps / 1000).max(1) {
                samples.push(Sample::now(began, status.env_steps, 0));
            }
        })
    };
    let job = Job::New { config: Box::new(config), policy: None, out: Some(out.clone()) };
    let (_, summary) = train(job, CHECKPOINT_INTERVAL, &AtomicBool::new(false), began, Some(listener))?;
    let samples = samples.lock().expect("nobody panics while holding it");
    let mut good = report(&samples);
    let rows =
        |name: &str| std::fs::read_to_string(out.join(name)).map(|text| text.lines().count() as u64 - 1);
    good &= agrees("env steps", summary.env_steps, env_steps.next_multiple_of(arenas));
    good &= agrees("episodes, and their rows", summary.episodes, rows("episodes.csv")?);
    good &= agrees("gradient steps", summary.gradient_steps, due(&learning, summary.env_steps));
    Ok(good)
}

#[cfg(feature = "gui")]
mod window {
    use std::time::Duration;

    use bevy::prelude::*;
    use wayfield::agent::ActiveLearner;
    use wayfield::app::Snapshot;
    use wayfield::app::app_snapshot::Severity;
    use wayfield::app::commands::{Command, Pace, SaveKind};
    use wayfield::app::session::{Journal, StartOptions};
    use wayfield::app::view_state::Overlays;
    use wayfield::app::window::{WindowOptions, app};

    use super::*;

    /// So long the run may take to be saved.
    const PATIENCE: Duration = Duration::from_secs(60);

    #[derive(Resource)]
    struct Soak {
        began: Instant,
        lasts: Duration,
        frames: u64,
        samples: Vec<Sample>,
        saves_to: std::path::PathBuf,
        /// When the run was asked to be saved.
        saved: Option<Instant>,
        error_notices: Vec<String>,
    }

    /// What the app knew at its end.
    #[derive(Resource, Clone, Default)]
    struct End(Arc<Mutex<Option<Known>>>);

    struct Known {
        samples: Vec<Sample>,
        /// Control steps, env steps, episodes, gradient steps.
        counts: [u64; 4],
        error_notices: Vec<String>,
    }

    /// An hour of training in the window, with what most people look at drawn over the world.
    pub fn soak(minutes: u64) -> Result<bool, Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let start = StartOptions { pace: Pace::Full, ..StartOptions::default() };
        let preset = wayfield::run::shipped::preset(&start.preset)?;
        let overlays = Overlays { beams: true, path: true, trails: true, value: true, ..Default::default() };
        let opening = WindowOptions {
            start,
            overlays: Some(overlays),
            size: Some((1000.0, 640.0)),
            ..WindowOptions::default()
        };
        let end = End::default();
        let saves_to = folder.path().join("run");
        let began = Instant::now();
        app(opening)
            .insert_resource(end.clone())
            .insert_resource(Soak {
                began,
                lasts: Duration::from_secs(60 * minutes),
                frames: 0,
                samples: Vec::new(),
                saves_to: saves_to.clone(),
                saved: None,
                error_notices: Vec::new(),
            })
            .add_systems(Last, watch)
            .run();
        let known = end.0.lock().expect("nobody panics while holding it").take();
        let known = known.ok_or("the window was closed too early")?;
        let mut good = report(&known.samples);
        let [steps, env_steps, episodes, gradient_steps] = known.counts;
        good &= agrees("env steps, of so many control steps", env_steps, steps * preset.arenas as u64);
        good &= agrees("gradient steps", gradient_steps, due(&preset.learning, env_steps));
        for complaint in &known.error_notices {
            println!("told the user: {complaint}");
        }
        let rows = std::fs::read_to_string(saves_to.join("episodes.csv"))?.lines().count() as u64 - 1;
        good &= agrees("episodes, and the rows of the curves", episodes, rows);
        Ok(good && known.error_notices.is_empty())
    }

    /// A sample a minute; when the time is over, the run is saved, and the window closed a few frames later.
    fn watch(
        mut soak: ResMut<Soak>,
        shown: Res<Snapshot>,
        journal: Option<Res<Journal>>,
        trainer: Option<Res<ActiveLearner>>,
        end: Res<End>,
        mut commands: MessageWriter<Command>,
        mut exit: MessageWriter<AppExit>,
    ) {
        let (Some(journal), Some(trainer), Some((_, status))) = (journal, trainer, &shown.now) else {
            return;
        };
        let soak = &mut *soak;
        soak.frames += 1;
        let last = soak.samples.last().map_or(-1.0, |sample| sample.wall_s);
        let due_s = soak.lasts.as_secs_f64() / 60.0;
        if soak.samples.is_empty() || soak.began.elapsed().as_secs_f64() >= last + due_s {
            let sample = Sample::now(soak.began, status.env_steps, soak.frames);
            println!("{sample:?}");
            soak.samples.push(sample);
        }
        // (Only the last few stand at any time.)
        for notice in status.notices.iter().filter(|notice| notice.severity == Severity::Error) {
            if !soak.error_notices.contains(&notice.text) {
                soak.error_notices.push(notice.text.clone());
            }
        }
        if soak.began.elapsed() < soak.lasts {
            return;
        }
        let Some(since) = soak.saved else {
            soak.saved = Some(Instant::now());
            commands.write(Command::Pause(true));
            commands.write(Command::Save(SaveKind::Run, soak.saves_to.clone()));
            return;
        };
        if soak.saves_to.join("checkpoint").exists() || since.elapsed() > PATIENCE {
            let learner = &trainer.0;
            *end.0.lock().expect("nobody panics while holding it") = Some(Known {
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
        Err("this build opens no window: run without --no-default-features".into())
    }
}

/// Prints the ten parts, and says whether the last is as quick as the first and no larger than the second.
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
        "\nlast tenth against first: {speed:.3} times the env steps/s, {per_cpu:.3} times those per CPU second; \
         memory {growth:.3} times that of the second tenth, {:.1} MB at most",
        status_kb("VmHWM:") as f64 / 1024.0
    );
    let good = speed.max(per_cpu) >= 1.0 - SLOWER && growth <= 1.0 + GROWTH;
    println!("{}", if good { "flat" } else { "NOT FLAT" });
    good
}

fn agrees(what: &str, found: u64, expected: u64) -> bool {
    let good = found == expected;
    println!(
        "{what}: {found}{}",
        if good { String::new() } else { format!(", BUT {expected} WERE EXPECTED") }
    );
    good
}

/// Gradient steps that are due after `env_steps`: those of every interval's end once warm-up is over.
fn due(learning: &LearningConfig, env_steps: u64) -> u64 {
    let interval = learning.train_freq;
    let first = learning.replay.learning_starts.max(1).div_ceil(interval);
    (env_steps / interval + 1).saturating_sub(first) * u64::from(learning.gradient_steps)
}
