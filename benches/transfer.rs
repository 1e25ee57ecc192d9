//! Transfer: is a run in Scenario II sooner there from a policy of Scenario I than from scratch?
//!
//! `cargo bench --no-default-features --bench transfer -- [SEEDS]`, by default 3. Each seed runs 20,000 env steps in Scenario I
//! (about what it takes to drive there; they are not counted), then twice 50,000 in Scenario II: from scratch, and from the
//! best policy; all with the default preset. There 500 navigations every 1,000 env steps tell when a rate is first
//! reached, and the mean rate up to 20,000 and up to 50,000 (the area under the learning curve). Env steps do not depend on the machine.

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
/// The mean rate is taken over evaluations up to so many env steps.
const UP_TO: [u64; 2] = [20_000, ENV_STEPS];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let seeds: u64 = arguments.first().map_or(Ok(3), |text| text.parse())?;
    let columns: Vec<String> = RATES
        .map(|rate| format!("{:.0} %", 100.0 * rate))
        .into_iter()
        .chain(UP_TO.map(|env_steps| format!("mean % up to {env_steps}")))
        .collect();
    let header = columns.iter().map(|column| format!("{column}: from scratch | with transfer"));
    println!("| seed | success in I | {} |", header.collect::<Vec<_>>().join(" | "));
    println!("|---|---|{}", "---|---|".repeat(columns.len()));
    let mut all = Vec::new();
    for seed in 0..seeds {
        let simple = Ran::new(runs::until(runs::config(PRESET, "scenario-1", seed)?, BEFORE), None)?;
        let mut config = runs::until(runs::config(PRESET, "scenario-2", seed)?, ENV_STEPS);
        config.preset.evaluation.every_env_steps = EVERY;
        let scratch = Ran::new(config.clone(), None)?;
        let transfer = Ran::new(config, Some((&simple.best, EPSILON)))?;
        let reached = RATES.map(|rate| {
            [&scratch, &transfer].map(|run| or_never(run.reached(rate), |row| row.env_steps as f64))
        });
        let means = UP_TO.map(|env_steps| [&scratch, &transfer].map(|run| mean_percent(run, env_steps)));
        let row: Vec<String> = reached
            .as_flattened()
            .iter()
            .map(f64::to_string)
            .chain(means.as_flattened().iter().map(percent))
            .collect();
        println!("| {seed} | {} | {} |", simple.summary.best_success_rate.unwrap_or(0.0), row.join(" | "));
        all.push((reached, means));
    }
    let reached_of =
        |column: usize| all.iter().map(move |(reached, _)| reached[column / 2][column % 2]).collect();
    let reached = (0..2 * RATES.len()).map(|column| spread(reached_of(column), 0));
    // The worst mean is the lowest one.
    let means_of = |column: usize| all.iter().map(move |(_, means)| -means[column / 2][column % 2]).collect();
    let means = (0..2 * UP_TO.len()).map(|column| spread(means_of(column), 1).replace('-', ""));
    println!("| median (worst) | | {} |\n", reached.chain(means).collect::<Vec<_>>().join(" | "));
    for (index, column) in columns.iter().enumerate() {
        let ahead = all.iter().filter(|(reached, means)| match index.checked_sub(RATES.len()) {
            None => reached[index][1] < reached[index][0],
            Some(index) => means[index][1] > means[index][0],
        });
        println!("{column}: ahead with transfer on {} of {seeds} seeds", ahead.count());
    }
    Ok(())
}

/// The mean success rate of the evaluations up to `env_steps`, in %.
fn mean_percent(run: &Ran, env_steps: u64) -> f64 {
    // (A run's env steps come in whole control steps.)
    let rows = run.evaluations.iter().filter(|row| row.env_steps < env_steps + EVERY / 2);
    let (count, sum) = rows.fold((0, 0.0), |(count, sum), row| (count + 1, sum + row.success_rate));
    100.0 * sum / f64::from(count)
}

fn percent(rate: &f64) -> String {
    format!("{rate:.1}")
}
