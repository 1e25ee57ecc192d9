//! How the whole work is getting on, said on stderr.
//!
//! In: what each run says of itself ([`OverallProgress::listener`]), and that it is done. Out: on a terminal one bar for all;
//! elsewhere a plain line every few seconds.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar};

use super::plan::Training;
use crate::run::preset::Budget;
use crate::run::progress::{Progress, ProgressListener, bar, print_stderr};

/// Time between two plain lines.
const NEXT_LINE: Duration = Duration::from_secs(10);
/// Parts of the whole that the bar can tell apart.
const PARTS: u64 = 10_000;

/// Shows how far all runs together are.
pub struct OverallProgress {
    inner: Mutex<Inner>,
}

struct Inner {
    /// What each run costs, in expected gradient steps.
    weights: Vec<f64>,
    /// How much of each is done, 0 to 1.
    shares: Vec<f64>,
    runs_done: usize,
    /// Under way, by index: what to call it.
    under_way: BTreeMap<usize, String>,
    started: Instant,
    /// The work that was done before this process.
    done_before: f64,
    next_line: Duration,
    bar: Option<ProgressBar>,
}

impl OverallProgress {
    /// A board for `trainings`.
    #[must_use]
    pub fn new(trainings: &[Training]) -> Arc<Self> {
        Arc::new(Self {
            inner: Mutex::new(Inner {
                weights: trainings.iter().map(|t| gradient_steps(t, t.config.preset.budget)).collect(),
                shares: vec![0.0; trainings.len()],
                runs_done: 0,
                under_way: BTreeMap::new(),
                started: Instant::now(),
                done_before: 0.0,
                next_line: Duration::ZERO,
                bar: bar(PARTS),
            }),
        })
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Run `index` is under way; gives whom it may tell.
    pub fn listener(self: &Arc<Self>, index: usize, training: &Training) -> ProgressListener {
        let config = &training.config;
        let name = format!("{} in {}, seed {}", config.preset_name(), config.scenario.name, config.seed);
        self.lock().under_way.insert(index, name);
        let board = self.clone();
        let training = training.clone();
        Box::new(move |status: &Progress| {
            let budget = training.config.preset.budget;
            let so_far = match budget {
                Budget::Episodes(_) => Budget::Episodes(status.episodes),
                Budget::EnvSteps(_) => Budget::EnvSteps(status.env_steps),
            };
            let share = gradient_steps(&training, so_far) / gradient_steps(&training, budget);
            let mut inner = board.lock();
            inner.shares[index] = share.clamp(0.0, 1.0);
            inner.show(false);
        })
    }

    /// Run `index` is done; `before` if it was so before this process began.
    pub fn done(&self, index: usize, before: bool) {
        let mut inner = self.lock();
        inner.shares[index] = 1.0;
        inner.runs_done += 1;
        inner.under_way.remove(&index);
        if before {
            inner.done_before += inner.weights[index];
        }
        inner.show(false);
    }

    /// Shows how far all is, and leaves it at that.
    pub fn finish(&self) {
        let mut inner = self.lock();
        inner.show(true);
        if let Some(bar) = &inner.bar {
            bar.abandon();
        }
    }
}

impl Inner {
    fn show(&mut self, now: bool) {
        let elapsed = self.started.elapsed();
        if self.bar.is_none() && !now && elapsed < self.next_line {
            return;
        }
        self.next_line = elapsed + NEXT_LINE;
        let total: f64 = self.weights.iter().sum();
        let done: f64 = self.weights.iter().zip(&self.shares).map(|(weight, share)| weight * share).sum();
        let share = if total > 0.0 { done / total } else { 1.0 };
        let here = done - self.done_before;
        let left = if share < 1.0 && here > 0.0 && elapsed.as_secs() >= 5 {
            let left = elapsed.mul_f64(((total - done) / here).clamp(0.0, 1e6));
            format!(", {} left", HumanDuration(left))
        } else {
            String::new()
        };
        let (runs, all) = (self.runs_done, self.weights.len());
        let advance = format!("{:>3.0}%  {runs} of {all} runs{left}", (100.0 * share).floor());
        let under_way: Vec<&str> = self.under_way.values().map(String::as_str).collect();
        match &self.bar {
            Some(bar) => {
                bar.set_prefix(advance);
                bar.set_message(under_way.join("; "));
                bar.set_position((share * PARTS as f64) as u64);
                bar.tick();
            }
            None => print_stderr(format!("{advance}  {}", under_way.join("; ")).trim_end()),
        }
    }
}

/// About how many gradient steps a training takes for `budget`: what its time goes with.
fn gradient_steps(training: &Training, budget: Budget) -> f64 {
    let learning = &training.config.preset.learning;
    let env_steps = match budget {
        // The first episodes end soon, in a collision; in the end nearly all last for the time limit.
        Budget::Episodes(n) => {
            let n = n as f64;
            f64::from(training.config.scenario.task.max_episode_steps) * n * n / (n + 200.0)
        }
        Budget::EnvSteps(n) => n as f64,
    };
    let per_step = f64::from(learning.gradient_steps) / learning.train_freq as f64;
    // An env step without learning costs a tenth of a gradient step in one arena, a thirtieth in sixteen.
    env_steps * (per_step + 0.1) + 1.0
}
