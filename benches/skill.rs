//! The time and env steps that a training run needs to reach 96 % and 99 % success, and its final success rate.
//!
//! `cargo bench --no-default-features --bench skill -- [SEEDS] [PRESET:SCENARIO ...]`, by default 2 seeds of
//! `fast:scenario-1 fast:scenario-2 per_d3qn:scenario-1`. Every seed is a complete run as with `--train`, with 500 episodes
//! per evaluation. Its best policy is then tested in 500 new episodes. Wall time starts with the run and includes
//! evaluations. Env steps do not depend on the machine. CPU time is measured in a second run that stops where the first one
//! reached 96 %; it includes the evaluations, which have a thread of their own, and the final test of that run.

#[path = "support/allocator.rs"]
mod allocator;
#[path = "support/process.rs"]
mod process;
#[path = "support/runs.rs"]
mod runs;

use std::error::Error;
use std::sync::Arc;

use runs::{EVAL_EPISODES, FinishedRun, median_and_worst, or_infinity};
use wayfield::policy::Policy;
use wayfield::run::evaluate::{Evaluation, Evaluator, compare_with_optimum};
use wayfield::run::metric_rows::EvaluationRow;
use wayfield::task::EpisodeSetup;

/// The result of one seed.
struct SeedResult {
    run: FinishedRun,
    cpu_to_96_s: f64,
    success_rate: f64,
    time_ratio: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let (seeds, pairs) = match arguments.split_first() {
        Some((first, rest)) if first.parse::<u64>().is_ok() => (first.parse()?, rest.to_vec()),
        _ => (2, arguments),
    };
    let default = ["fast:scenario-1", "fast:scenario-2", "per_d3qn:scenario-1"].map(String::from).to_vec();
    println!("{seeds} seeds each: median (worst)\n");
    println!(
        "| run | 96 %: env steps | wall s | CPU s | 99 %: env steps | wall s | complete run s | success | time / optimal time |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for pair in if pairs.is_empty() { default } else { pairs } {
        let (preset, scenario) =
            pair.split_once(':').ok_or("give PRESET:SCENARIO, such as fast:scenario-1")?;
        let results =
            (0..seeds).map(|seed| test_seed(preset, scenario, seed)).collect::<Result<Vec<_>, _>>()?;
        let over = |digits, of: &dyn Fn(&SeedResult) -> f64| {
            median_and_worst(results.iter().map(of).collect(), digits)
        };
        let at = |digits, rate, of: fn(&EvaluationRow) -> f64| {
            over(digits, &|r: &SeedResult| or_infinity(r.run.reached(rate), of))
        };
        println!(
            "| {preset}, {scenario} | {} | {} | {} | {} | {} | {} | {} | {} |",
            at(0, 0.96, |row| row.env_steps as f64),
            at(2, 0.96, |row| row.wall_s),
            over(2, &|r| r.cpu_to_96_s),
            at(0, 0.99, |row| row.env_steps as f64),
            at(2, 0.99, |row| row.wall_s),
            over(1, &|r| r.run.summary.wall_s),
            // Negated, because the worst success rate is the lowest.
            over(3, &|r| -r.success_rate).replace('-', ""),
            over(3, &|r| r.time_ratio),
        );
    }
    Ok(())
}

/// Trains with `seed`, and tests the best policy.
fn test_seed(preset: &str, scenario: &str, seed: u64) -> Result<SeedResult, Box<dyn Error>> {
    let config = runs::config(preset, scenario, seed)?;
    let run = FinishedRun::new(config.clone(), None)?;
    let cpu_to_96_s = match run.reached(0.96) {
        Some(row) => {
            let before = process::cpu_s();
            FinishedRun::new(runs::with_env_steps(config.clone(), row.env_steps), None)?;
            process::cpu_s() - before
        }
        None => f64::INFINITY,
    };
    let scenario = Arc::new(config.scenario);
    let policy = Policy::from_bytes(&run.best)?;
    let episodes = Evaluator::new(&scenario, EVAL_EPISODES).run(
        &policy,
        1000 + seed,
        EVAL_EPISODES,
        EpisodeSetup::Random,
    )?;
    let evaluation = Evaluation::from_episodes(&episodes, 100, &scenario.task, 1000 + seed);
    let time_ratio = compare_with_optimum(&scenario, &episodes).map_or(f64::INFINITY, |a| a.time_ratio);
    Ok(SeedResult { run, cpu_to_96_s, success_rate: evaluation.success_rate, time_ratio })
}
