//! The progress of a report on stderr, after its training runs: figures and tables, and the optimal times that they need.
//!
//! In: the number of figures and tables, and what is being worked on. Out: a progress bar on a terminal; elsewhere, a plain line
//! every ten seconds.

use std::cell::Cell;
use std::time::Instant;

use indicatif::ProgressBar;

use super::progress::LINE_INTERVAL;
use crate::run::progress::{bar, print_stderr};
use crate::scenario::printable;

/// The progress of a report.
pub struct ReportProgress {
    items: u64,
    begun: Cell<u64>,
    last_line: Cell<Instant>,
    bar: Option<ProgressBar>,
}

impl ReportProgress {
    /// The progress of a report with this number of figures and tables. It is shown from the first item on.
    #[must_use]
    pub fn new(items: usize) -> Self {
        let items = items as u64;
        Self { items, begun: Cell::new(0), last_line: Cell::new(Instant::now()), bar: bar(items) }
    }

    /// Begins the figure or table `name`.
    pub fn begin(&self, name: &str) {
        self.begun.set(self.begun.get() + 1);
        self.show(name);
    }

    /// Shows what is being worked on for the current figure or table.
    pub fn show(&self, what: &str) {
        let before = self.begun.get().saturating_sub(1);
        let prefix = format!("{before} of {} figures and tables", self.items);
        let what = printable(what);
        match &self.bar {
            Some(bar) => {
                bar.set_prefix(prefix);
                bar.set_message(what.into_owned());
                bar.set_position(before);
                bar.tick();
            }
            None if self.last_line.get().elapsed() >= LINE_INTERVAL => {
                self.last_line.set(Instant::now());
                print_stderr(&format!("{prefix}  {what}"));
            }
            None => {}
        }
    }

    /// Shows that all is done.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.set_prefix(format!("{0} of {0} figures and tables", self.items));
            bar.set_message("");
            bar.set_position(self.items);
            bar.abandon();
        }
    }
}
