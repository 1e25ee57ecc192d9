//! Transfer: the training time in Scenario II, from scratch and from a policy of Scenario I.
//!
//! `cargo bench --no-default-features --bench transfer -- [SEEDS]`, by default 3 seeds. All runs use the default preset. Each
//! seed trains for 20,000 env steps in Scenario I (about enough to succeed there; they are not counted). Then it trains
//! twice for 50,000 env steps in Scenario II: from scratch, and from the best policy of Scenario I. An evaluation of 500
//! episodes every 1,000 env steps measures when a success rate is first reached, and the mean failure rate up to 20,000 and
//! 50,000 env steps (the area above the learning curve). Env steps do not depend on the machine. Seconds do, and include the
//! evaluations.

#[path = "support/allocator.rs"]
mod allocator;
#[path = "support/runs.rs"]
mod runs;

use std::error::Error;

use runs::{FinishedRun, median_and_worst, or_infinity};
use wayfield::run::folder::PAPER_TRANSFER_EPSILON;

/// Env steps in Scenario I. For the effect of other values, see docs/performance.md.
const SCENARIO_1_ENV_STEPS: u64 = 20_000;
/// Env steps of a run in Scenario II.
const ENV_STEPS: u64 = 50_000;
/// Env steps between evaluations in Scenario II.
const EVAL_INTERVAL: u64 = 1_000;
const PRESET: &str = "fast";
/// The success rates for which the env steps to reach them are reported.
const RATES: [f64; 3] = [0.8, 0.9, 0.95];
/// The success rate for which the wall time to reach it is reported.
const TIMED_RATE: f64 = 0.95;
/// The mean failure rate is taken over the evaluations up to these env steps.
const FAILURE_HORIZONS: [u64; 2] = [20_000, ENV_STEPS];

/// A measure of a run. Lower is better.
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
    let env_steps = RATES.map(|rate| {
        let name = format!("env steps to {:.0} %", 100.0 * rate);
        Measure::new(name, 0, move |run| or_infinity(run.reached(rate), |row| row.env_steps as f64))
    });
    let seconds = Measure::new(format!("s to {:.0} %", 100.0 * TIMED_RATE), 2, |run| {
        or_infinity(run.reached(TIMED_RATE), |row| row.wall_s)
    });
    let failures = FAILURE_HORIZONS.map(|env_steps| {
        Measure::new(format!("mean failure rate in % up to {env_steps} env steps"), 1, move |run| {
            mean_failure_percent(run, env_steps)
        })
    });
    env_steps.into_iter().chain([seconds]).chain(failures).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let seeds: u64 = arguments.first().map_or(Ok(3), |text| text.parse())?;
    let measures = measures();
    let header = measures.iter().map(|m| format!("{}: from scratch | with transfer", m.name));
    println!("| seed | success in I | {} |", header.collect::<Vec<_>>().join(" | "));
    println!("|---|---|{}", "---|---|".repeat(measures.len()));
    // By measure and seed: the values from scratch and with transfer.
    let mut values = vec![Vec::new(); measures.len()];
    for seed in 0..seeds {
        let source = FinishedRun::new(
            runs::with_env_steps(runs::config(PRESET, "scenario-1", seed)?, SCENARIO_1_ENV_STEPS),
            None,
        )?;
        let mut config = runs::with_env_steps(runs::config(PRESET, "scenario-2", seed)?, ENV_STEPS);
        config.preset.evaluation.every_env_steps = EVAL_INTERVAL;
        let scratch = FinishedRun::new(config.clone(), None)?;
        let transfer = FinishedRun::new(config, Some((&source.best, PAPER_TRANSFER_EPSILON)))?;
        let mut row = vec![source.summary.best_success_rate.unwrap_or(0.0).to_string()];
        for (measure, values) in measures.iter().zip(&mut values) {
            let pair = [&scratch, &transfer].map(|run| (measure.of)(run));
            row.extend(pair.map(|value| format!("{value:.*}", measure.decimals)));
            values.push(pair);
        }
        println!("| {seed} | {} |", row.join(" | "));
    }
    let summaries = measures.iter().zip(&values).flat_map(|(measure, values)| {
        [0, 1].map(|run| median_and_worst(values.iter().map(|pair| pair[run]).collect(), measure.decimals))
    });
    println!("| median (worst) | | {} |\n", summaries.collect::<Vec<_>>().join(" | "));
    for (measure, values) in measures.iter().zip(&values) {
        let better = values.iter().filter(|[scratch, transfer]| transfer < scratch).count();
        println!("{}: better with transfer for {better} of {seeds} seeds", measure.name);
    }
    Ok(())
}

/// The mean failure rate of the evaluations up to `env_steps`, in %.
fn mean_failure_percent(run: &FinishedRun, env_steps: u64) -> f64 {
    // Evaluations are at multiples of EVAL_INTERVAL, rounded to complete control steps. The first, of the initial policy, is
    // skipped.
    let rows = run.evaluations.iter().skip(1).filter(|row| row.env_steps < env_steps + EVAL_INTERVAL / 2);
    let (count, sum) = rows.fold((0, 0.0), |(count, sum), row| (count + 1, sum + 1.0 - row.success_rate));
    100.0 * sum / f64::from(count)
}
