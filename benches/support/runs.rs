//! Complete training runs as with `--train`, with 500 episodes per evaluation for precise success rates.
#![allow(dead_code, reason = "each program uses part of this module")]

use std::error::Error;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use wayfield::policy::Policy;
use wayfield::run::folder::{RunConfig, Transfer};
use wayfield::run::metric_rows::{EvaluationRow, Summary};
use wayfield::run::preset::Budget;
use wayfield::run::train::{CHECKPOINT_INTERVAL, Job, train};

/// The number of episodes of each evaluation during a run.
pub const EVAL_EPISODES: usize = 500;

/// The configuration of a run with a shipped preset and a shipped scenario.
pub fn config(preset: &str, scenario: &str, seed: u64) -> Result<RunConfig, Box<dyn Error>> {
    let mut config = RunConfig::resolve(scenario, preset, seed)?;
    config.preset.evaluation.episodes = EVAL_EPISODES;
    Ok(config)
}

/// The results of a run.
pub struct FinishedRun {
    pub summary: Summary,
    pub evaluations: Vec<EvaluationRow>,
    /// The policy file of the best policy.
    pub best: Vec<u8>,
}

impl FinishedRun {
    /// Runs `config`. With `policy`, training starts from this policy file and with this epsilon.
    pub fn new(mut config: RunConfig, policy: Option<(&[u8], f32)>) -> Result<Self, Box<dyn Error>> {
        let scratch = tempfile::tempdir()?;
        let policy = match policy {
            Some((bytes, epsilon)) => {
                config.transfer = Some(Transfer { policy: "the policy".into(), epsilon: Some(epsilon) });
                Some(Policy::from_bytes(bytes)?)
            }
            None => None,
        };
        let job = Job::New { config: Box::new(config), policy, out: Some(scratch.path().join("run")) };
        let (folder, summary) =
            train(job, CHECKPOINT_INTERVAL, &AtomicBool::new(false), Instant::now(), None)?;
        let mut rows = csv::Reader::from_path(folder.join("evaluations.csv"))?;
        let evaluations = rows.deserialize().collect::<Result<_, _>>()?;
        let best = std::fs::read(folder.join("policy.safetensors"))?;
        Ok(Self { summary, evaluations, best })
    }

    /// The first evaluation with a success rate of at least `rate`.
    pub fn reached(&self, rate: f64) -> Option<&EvaluationRow> {
        self.evaluations.iter().find(|row| row.success_rate >= rate)
    }
}

/// The value of a row, or infinity without a row.
pub fn or_infinity(row: Option<&EvaluationRow>, of: impl Fn(&EvaluationRow) -> f64) -> f64 {
    row.map_or(f64::INFINITY, of)
}

/// The configuration with a budget of `env_steps`.
pub fn with_env_steps(mut config: RunConfig, env_steps: u64) -> RunConfig {
    config.preset.budget = Budget::EnvSteps(env_steps);
    config
}

/// The median, followed by the largest value in brackets.
pub fn median_and_worst(mut values: Vec<f64>, digits: usize) -> String {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    let median = if n == 0 { f64::NAN } else { (values[(n - 1) / 2] + values[n / 2]) / 2.0 };
    let worst = values.last().copied().unwrap_or(f64::NAN);
    format!("{median:.digits$} ({worst:.digits$})")
}
