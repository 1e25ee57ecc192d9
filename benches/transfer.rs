//! Transfer: is a run in Scenario II sooner there from a policy of Scenario I than from scratch?
//!
//! `cargo bench --no-default-features --bench transfer -- [SEEDS]`, by default 3. Each seed runs 20,000 env steps in Scenario I
//! (about what it takes to drive there; they are not counted), then twice 50,000 in Scenario II: from scratch, and from the
//! best policy; all with the default preset. There 500 navigations every 1,000 env steps tell when a rate is first
//! reached. Env steps do not depend on the machine.

#[path = "support/allocator.rs"]
mod allocator;
#[path = "support/runs.rs"]
mod runs;

use std::error::Error;

use runs::{Ran, or_never, spread};

/// Env steps in Scenario I (docs/performance.md compares with others).
const BEFORE: u64 = 20_000;
/// Epsilon when training goes on in the other world: the paper's (section 3.2).
const EPSILON: f32 = 0.5;
/// A run in Scenario II ends after so many env steps.
const ENV_STEPS: u64 = 50_000;
/// Evaluated so often there.
const EVERY: u64 = 1_000;
const PRESET: &str = "fast";
/// To be reached.
const RATES: [f64; 3] = [0.8, 0.9, 0.95];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let seeds: u64 = arguments.first().map_or(Ok(3), |text| text.parse())?;
    let columns = RATES.map(|rate| format!("{:.0} % from scratch | with transfer", 100.0 * rate));
    println!(
        "| seed | success in I | {} |\n|---|---|{}",
        columns.join(" | "),
        "---|---|".repeat(RATES.len())
    );
    let mut all = Vec::new();
    for seed in 0..seeds {
        let simple = Ran::new(runs::until(runs::config(PRESET, "scenario-1", seed)?, BEFORE), None)?;
        let mut config = runs::until(runs::config(PRESET, "scenario-2", seed)?, ENV_STEPS);
        config.preset.evaluation.every_env_steps = EVERY;
        let scratch = Ran::new(config.clone(), None)?;
        let transfer = Ran::new(config, Some((&simple.best, EPSILON)))?;
        let steps = RATES.map(|rate| {
            [&scratch, &transfer].map(|run| or_never(run.reached(rate), |row| row.env_steps as f64))
        });
        println!(
            "| {seed} | {} | {} |",
            simple.summary.best_success_rate.unwrap_or(0.0),
            steps.as_flattened().iter().map(f64::to_string).collect::<Vec<_>>().join(" | ")
        );
        all.push(steps);
    }
    let columns = (0..2 * RATES.len())
        .map(|column| spread(all.iter().map(|steps| steps[column / 2][column % 2]).collect(), 0));
    println!("| median (worst) | | {} |", columns.collect::<Vec<_>>().join(" | "));
    for (index, rate) in RATES.iter().enumerate() {
        let sooner = all.iter().filter(|s| s[index][1] < s[index][0]).count();
        println!("\n{:.0} %: sooner with transfer on {sooner} of {seeds} seeds", 100.0 * rate);
    }
    Ok(())
}
