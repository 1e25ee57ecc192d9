//! The progress of a known number of tests on several threads, on stderr.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use indicatif::ProgressBar;

use super::{FIRST_LINE, NEXT_LINE, bar, print_stderr};

/// A display of how many tests are done.
pub struct CountProgress(Mutex<Inner>);

struct Inner {
    bar: Option<ProgressBar>,
    done: usize,
    started: Instant,
    due: Duration,
}

impl CountProgress {
    /// A display of `total` tests, whose clock starts now: a bar on a terminal, elsewhere a line every few seconds.
    #[must_use]
    pub fn new(total: usize) -> Self {
        Self(Mutex::new(Inner { bar: bar(total as u64), done: 0, started: Instant::now(), due: FIRST_LINE }))
    }

    /// Shows that `done` of `total` tests are done.
    pub fn update(&self, done: usize, total: usize) {
        let mut inner = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // Threads may report their counts out of order.
        inner.done = inner.done.max(done);
        let text = format!("{} of {total} tests", inner.done);
        if let Some(bar) = &inner.bar {
            bar.set_position(inner.done as u64);
            bar.set_prefix(text);
        } else if inner.started.elapsed() >= inner.due {
            inner.due = inner.started.elapsed() + NEXT_LINE;
            print_stderr(&text);
        }
    }

    /// Removes the bar.
    pub fn finish(&self) {
        if let Some(bar) = &self.0.lock().unwrap_or_else(PoisonError::into_inner).bar {
            bar.finish_and_clear();
        }
    }
}
