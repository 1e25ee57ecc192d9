//! The progress of all runs together, on stderr.
//!
//! In: the progress of each run ([`OverallProgress::listener`]). Out: one progress bar on a terminal; elsewhere, a plain
//! line every ten seconds.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar};

use super::plan::PlannedRun;
use crate::run::preset::Budget;
use crate::run::progress::{Progress, ProgressListener, bar, print_stderr};
use crate::scenario::printable;

/// Time between two plain lines.
pub const LINE_INTERVAL: Duration = Duration::from_secs(10);
/// Steps of the progress bar.
const BAR_STEPS: u64 = 10_000;

/// The progress of all runs together.
pub struct OverallProgress {
    inner: Mutex<Inner>,
}

struct Inner {
    /// The cost of each run, in expected gradient steps.
    costs: Vec<f64>,
    /// The finished fraction of each run, 0 to 1.
    fractions: Vec<f64>,
    runs_done: usize,
    /// The names of the runs in progress, by index.
    running: BTreeMap<usize, String>,
    started: Instant,
    /// The fraction of each run that was finished before this process started, 0 to 1.
    before: Vec<f64>,
    next_line: Duration,
    bar: Option<ProgressBar>,
}

impl OverallProgress {
    /// The progress of `training_runs`, all at 0.
    #[must_use]
    pub fn new(training_runs: &[PlannedRun]) -> Arc<Self> {
        Arc::new(Self {
            inner: Mutex::new(Inner {
                costs: training_runs.iter().map(|t| gradient_steps(t, t.config.preset.budget)).collect(),
                fractions: vec![0.0; training_runs.len()],
                runs_done: 0,
                running: BTreeMap::new(),
                started: Instant::now(),
                before: vec![0.0; training_runs.len()],
                next_line: Duration::ZERO,
                bar: bar(BAR_STEPS),
            }),
        })
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Records that run `index` has started, and returns the listener for its progress.
    pub fn listener(self: &Arc<Self>, index: usize, training: &PlannedRun) -> ProgressListener {
        let config = &training.config;
        let name = format!("{} in {}, seed {}", config.preset_name(), config.scenario.name, config.seed);
        self.lock().running.insert(index, printable(&name).into_owned());
        let overall = self.clone();
        let training = training.clone();
        let mut is_first = true;
        Box::new(move |progress: &Progress| {
            let budget = training.config.preset.budget;
            let so_far = match budget {
                Budget::Episodes(_) => Budget::Episodes(progress.episodes),
                Budget::EnvSteps(_) => Budget::EnvSteps(progress.env_steps),
            };
            let fraction = gradient_steps(&training, so_far) / gradient_steps(&training, budget);
            let fraction = fraction.clamp(0.0, 1.0);
            let mut inner = overall.lock();
            inner.fractions[index] = fraction;
            // The first call is after one control step: a resumed run starts with the fraction of its checkpoint.
            if std::mem::take(&mut is_first) {
                inner.before[index] = fraction;
            }
            inner.show(false);
        })
    }

    /// Records that run `index` is finished; `was_finished` if it was finished before this process started.
    pub fn finish_run(&self, index: usize, was_finished: bool) {
        let mut inner = self.lock();
        inner.fractions[index] = 1.0;
        inner.runs_done += 1;
        inner.running.remove(&index);
        if was_finished {
            inner.before[index] = 1.0;
        }
        inner.show(false);
    }

    /// Shows the final progress.
    pub fn finish(&self) {
        let mut inner = self.lock();
        inner.show(true);
        if let Some(bar) = &inner.bar {
            bar.abandon();
        }
    }
}

impl Inner {
    /// Updates the bar, or prints a line if the last one is old enough or `now` is set.
    fn show(&mut self, now: bool) {
        let elapsed = self.started.elapsed();
        if self.bar.is_none() && !now && elapsed < self.next_line {
            return;
        }
        self.next_line = elapsed + LINE_INTERVAL;
        let total: f64 = self.costs.iter().sum();
        let fraction = if total > 0.0 { self.cost_of(&self.fractions) / total } else { 1.0 };
        let left =
            self.time_left(elapsed).map_or(String::new(), |left| format!(", {} left", HumanDuration(left)));
        let (runs, all) = (self.runs_done, self.costs.len());
        let prefix = format!("{:>3.0}%  {runs} of {all} runs{left}", (100.0 * fraction).floor());
        let running: Vec<&str> = self.running.values().map(String::as_str).collect();
        match &self.bar {
            Some(bar) => {
                bar.set_prefix(prefix);
                bar.set_message(running.join("; "));
                bar.set_position((fraction * BAR_STEPS as f64) as u64);
                bar.tick();
            }
            None => print_stderr(format!("{prefix}  {}", running.join("; ")).trim_end()),
        }
    }

    /// The cost of these fractions of the runs.
    fn cost_of(&self, fractions: &[f64]) -> f64 {
        self.costs.iter().zip(fractions).map(|(cost, fraction)| cost * fraction).sum()
    }

    /// The estimated time until all runs are finished, from what this process has done in the time `elapsed`. `None` in the
    /// first 5 s, if the process has done nothing yet, or if nothing is left to do.
    fn time_left(&self, elapsed: Duration) -> Option<Duration> {
        let done = self.cost_of(&self.fractions);
        let left = self.costs.iter().sum::<f64>() - done;
        let here = done - self.cost_of(&self.before);
        let is_known = left > 0.0 && here > 0.0 && elapsed.as_secs() >= 5;
        is_known.then(|| elapsed.mul_f64((left / here).clamp(0.0, 1e6)))
    }
}

/// The approximate cost of a training run in gradient steps, to which its time is proportional.
pub fn gradient_steps(training: &PlannedRun, budget: Budget) -> f64 {
    let learning = &training.config.preset.learning;
    let env_steps = match budget {
        // Early episodes soon end in a collision; late episodes last until the time limit.
        Budget::Episodes(n) => {
            let n = n as f64;
            f64::from(training.config.scenario.task.max_episode_steps) * n * n / (n + 200.0)
        }
        Budget::EnvSteps(n) => n as f64,
    };
    let per_step = f64::from(learning.gradient_steps) / learning.train_freq as f64;
    // An env step without learning costs at most a tenth of a gradient step: a tenth with one arena, a thirtieth with sixteen.
    env_steps * (per_step + 0.1) + 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::ReproduceOptions;
    use crate::reproduce::plan::RunPlan;
    use crate::reproduce::select::select;

    #[test]
    fn the_time_left_follows_from_the_work_of_this_process_alone() {
        let options = ReproduceOptions { only: vec!["fig8".into()], ..ReproduceOptions::default() };
        let plan = RunPlan::new(&select(&options).expect("the selection works")).expect("the plan works");
        let runs = &plan.training_runs[..2];
        let Budget::Episodes(episodes) = runs[1].config.preset.budget else {
            panic!("figure 8 counts episodes")
        };
        let progress = OverallProgress::new(runs);
        progress.lock().next_line = Duration::MAX;
        let minute = Duration::from_secs(60);
        let left = || progress.lock().time_left(minute);
        progress.finish_run(0, true);
        assert_eq!(left(), None, "a run that was finished before says nothing about the speed");
        let mut listener = progress.listener(1, &runs[1]);
        let mut report = |episodes| listener(&Progress { episodes, ..Progress::default() });
        report(episodes / 2);
        assert_eq!(left(), None, "the checkpoint of a resumed run says nothing about the speed either");
        report(episodes * 3 / 4);
        let cost = |episodes| gradient_steps(&runs[1], Budget::Episodes(episodes));
        let here = cost(episodes * 3 / 4) - cost(episodes / 2);
        let expected_s = 60.0 * (cost(episodes) - cost(episodes * 3 / 4)) / here;
        let left_s = left().expect("a part of a run is done").as_secs_f64();
        assert!((left_s / expected_s - 1.0).abs() < 1e-6, "{left_s} s, not {expected_s} s");
        report(episodes);
        progress.finish_run(1, false);
        assert_eq!(left(), None, "nothing is left");
    }
}
