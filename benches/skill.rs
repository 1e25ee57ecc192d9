//! Time to skill: how soon a run drives, and how well in the end.
//!
//! `cargo bench --no-default-features --bench skill -- [SEEDS] [PRESET:SCENARIO ...]`, by default 3 seeds of
//! `fast:scenario-1 fast:scenario-2 per_d3qn:scenario-1`. Every seed is a whole run as `--train` makes it; its best
//! policy is then put to 500 navigations that it has never seen. Wall time is counted from the run's begin, with
//! evaluations; env steps do not depend on the machine.

use std::error::Error;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use wayfield::learning::Policy;
use wayfield::run::evaluate::{Evaluation, Evaluator, against_optimum};
use wayfield::run::folder::RunConfig;
use wayfield::run::records::Milestone;
use wayfield::run::shipped;
use wayfield::run::train::{CHECKPOINT_EVERY, Job, train};
use wayfield::task::Places;

/// What one seed came to.
struct Outcome {
    first_96: Option<Milestone>,
    first_99: Option<Milestone>,
    wall_s: f64,
    success_rate: f64,
    time_ratio: f64,
}

/// The binary's.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let (seeds, pairs) = match arguments.split_first() {
        Some((first, rest)) if first.parse::<u64>().is_ok() => (first.parse()?, rest.to_vec()),
        _ => (3, arguments),
    };
    let default = ["fast:scenario-1", "fast:scenario-2", "per_d3qn:scenario-1"].map(String::from).to_vec();
    println!("{seeds} seeds each: median (worst)\n");
    println!(
        "| run | 96 %: env steps | wall s | 99 %: env steps | wall s | whole run s | success of 500 | time / least time |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for pair in if pairs.is_empty() { default } else { pairs } {
        let (preset, scenario) =
            pair.split_once(':').ok_or("give PRESET:SCENARIO, such as fast:scenario-1")?;
        let outcomes = (0..seeds).map(|seed| run(preset, scenario, seed)).collect::<Result<Vec<_>, _>>()?;
        let steps = |m: &Option<Milestone>| m.map_or(f64::INFINITY, |m| m.env_steps as f64);
        let wall = |m: &Option<Milestone>| m.map_or(f64::INFINITY, |m| m.wall_s);
        println!(
            "| {preset}, {scenario} | {} | {} | {} | {} | {} | {} | {} |",
            spread(&outcomes, 0, |o| steps(&o.first_96)),
            spread(&outcomes, 2, |o| wall(&o.first_96)),
            spread(&outcomes, 0, |o| steps(&o.first_99)),
            spread(&outcomes, 2, |o| wall(&o.first_99)),
            spread(&outcomes, 1, |o| o.wall_s),
            // The worst success is the lowest one.
            spread(&outcomes, 3, |o| -o.success_rate).replace('-', ""),
            spread(&outcomes, 3, |o| o.time_ratio),
        );
    }
    Ok(())
}

fn run(preset: &str, scenario: &str, seed: u64) -> Result<Outcome, Box<dyn Error>> {
    let out = tempfile::tempdir()?;
    let config = RunConfig {
        version: env!("CARGO_PKG_VERSION").into(),
        seed,
        scenario_from: scenario.into(),
        preset_from: preset.into(),
        transfer: None,
        keep_after_episodes: Vec::new(),
        scenario: shipped::scenario(scenario)?,
        preset: shipped::preset(preset)?,
    };
    let world = Arc::new(config.scenario.clone());
    let job = Job::New { config: Box::new(config), policy: None, out: Some(out.path().join("run")) };
    let (folder, summary) = train(job, CHECKPOINT_EVERY, &AtomicBool::new(false), Instant::now(), None)?;
    let policy = Policy::from_bytes(&std::fs::read(Path::new(&folder).join("policy.safetensors"))?)?;
    let navigations = Evaluator::new(&world, 500).run(&policy, 1000 + seed, 500, Places::Drawn)?;
    let evaluation = Evaluation::of(&navigations, 100, &world.task, 1000 + seed);
    Ok(Outcome {
        first_96: summary.first_96,
        first_99: summary.first_99,
        wall_s: summary.wall_s,
        success_rate: evaluation.success_rate,
        time_ratio: against_optimum(&world, &navigations).map_or(f64::INFINITY, |a| a.time_ratio),
    })
}

/// The median and the largest of what is looked at.
fn spread(outcomes: &[Outcome], digits: usize, of: impl Fn(&Outcome) -> f64) -> String {
    let mut values: Vec<f64> = outcomes.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    let n = values.len();
    let median = if n == 0 { f64::NAN } else { (values[(n - 1) / 2] + values[n / 2]) / 2.0 };
    let worst = values.last().copied().unwrap_or(f64::NAN);
    format!("{median:.digits$} ({worst:.digits$})")
}
