//! A short training run in Scenario I with the default preset. It writes a run folder.
//!
//! `cargo run --release --no-default-features --example train_headless -- [FOLDER]`

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use wayfield::run::folder::RunConfig;
use wayfield::run::preset::Budget;
use wayfield::run::train::{CHECKPOINT_INTERVAL, Job, train};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(|| "runs/example".into(), PathBuf::from);
    let mut config = RunConfig::resolve("scenario-1", "fast", 7)?;
    config.preset.budget = Budget::EnvSteps(40_000);
    let job = Job::New { config: Box::new(config), policy: None, out: Some(folder) };
    let (folder, summary) = train(job, CHECKPOINT_INTERVAL, &AtomicBool::new(false), Instant::now(), None)?;
    println!(
        "{} episodes, {} gradient steps, best success rate {:.1} %, in {}",
        summary.episodes,
        summary.gradient_steps,
        100.0 * summary.best_success_rate.unwrap_or(0.0),
        folder.display()
    );
    Ok(())
}
