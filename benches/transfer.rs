//! Transfer: is a run in Scenario II sooner there from a policy of Scenario I than from scratch?
//!
//! `cargo bench --no-default-features --bench transfer -- [SEEDS]`, by default 3. Each seed runs 20,000 env steps in Scenario I
//! (about what it takes to drive there; they are not counted), then twice 50,000 in Scenario II: from scratch, and from the
//! best policy; all with the default preset. There 500 episodes every 1,000 env steps tell when a rate is first
//! reached, and the mean share of failures up to 20,000 and up to 50,000 (the area above the learning curve). Env steps do not
//! depend on the machine; seconds do, and hold the evaluations.

#[path = "support/allocator.rs"]
mod allocator;
#[path = "support/runs.rs"]
mod runs;

use std::error::Error;

use runs::{FinishedRun, median_and_worst, or_infinity};

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
/// The seconds until then are told of this one.
const TIMED: f64 = 0.95;
/// The mean is taken over evaluations up to so many env steps.
const UP_TO: [u64; 2] = [20_000, ENV_STEPS];

/// What is compared: a run's figure, of which less is better.
struct Measure {
    name: String,
    decimals: usize,
    of: Box<dyn Fn(&FinishedRun) -> f64>,
}

impl Measure {
    fn new(name: String, decimals: usize, of: impl Fn(&FinishedRun) -> f64 + 'static) -> Self {
        Self { name, decimals, of: Box::new(of) }
    }
}

fn measures() -> Vec<Measure> {
    let sooner = RATES.map(|rate| {
        let name = format!("env steps to {:.0} %", 100.0 * rate);
        Measure::new(name, 0, move |run| or_infinity(run.reached(rate), |row| row.env_steps as f64))
    });
    let seconds = Measure::new(format!("s to {:.0} %", 100.0 * TIMED), 2, |run| {
        or_infinity(run.reached(TIMED), |row| row.wall_s)
    });
    let failures = UP_TO.map(|env_steps| {
        Measure::new(format!("mean failures in % up to {env_steps}"), 1, move |run| failures(run, env_steps))
    });
    sooner.into_iter().chain([seconds]).chain(failures).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let seeds: u64 = arguments.first().map_or(Ok(3), |text| text.parse())?;
    let measures = measures();
    let header = measures.iter().map(|m| format!("{}: from scratch | with transfer", m.name));
    println!("| seed | success in I | {} |", header.collect::<Vec<_>>().join(" | "));
    println!("|---|---|{}", "---|---|".repeat(measures.len()));
    // By measure: every seed's figures, from scratch and with transfer.
    let mut figures = vec![Vec::new(); measures.len()];
    for seed in 0..seeds {
        let simple =
            FinishedRun::new(runs::with_env_steps(runs::config(PRESET, "scenario-1", seed)?, BEFORE), None)?;
        let mut config = runs::with_env_steps(runs::config(PRESET, "scenario-2", seed)?, ENV_STEPS);
        config.preset.evaluation.every_env_steps = EVERY;
        let scratch = FinishedRun::new(config.clone(), None)?;
        let transfer = FinishedRun::new(config, Some((&simple.best, EPSILON)))?;
        let mut row = vec![simple.summary.best_success_rate.unwrap_or(0.0).to_string()];
        for (measure, figures) in measures.iter().zip(&mut figures) {
            let pair = [&scratch, &transfer].map(|run| (measure.of)(run));
            row.extend(pair.map(|figure| format!("{figure:.*}", measure.decimals)));
            figures.push(pair);
        }
        println!("| {seed} | {} |", row.join(" | "));
    }
    let spreads = measures.iter().zip(&figures).flat_map(|(measure, figures)| {
        [0, 1].map(|run| median_and_worst(figures.iter().map(|pair| pair[run]).collect(), measure.decimals))
    });
    println!("| median (worst) | | {} |\n", spreads.collect::<Vec<_>>().join(" | "));
    for (measure, figures) in measures.iter().zip(&figures) {
        let ahead = figures.iter().filter(|[scratch, transfer]| transfer < scratch).count();
        println!("{}: less with transfer on {ahead} of {seeds} seeds", measure.name);
    }
    Ok(())
}

/// The mean share of failures, in %, in the evaluations up to `env_steps`.
fn failures(run: &FinishedRun, env_steps: u64) -> f64 {
    // (A run's env steps come in whole control steps.)
    let rows = run.evaluations.iter().filter(|row| row.env_steps < env_steps + EVERY / 2);
    let (count, sum) = rows.fold((0, 0.0), |(count, sum), row| (count + 1, sum + 1.0 - row.success_rate));
    100.0 * sum / f64::from(count)
}
