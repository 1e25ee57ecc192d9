//! The progress display of a run, on stderr.
//!
//! In: a [`Progress`] as often as the caller likes, and messages. Out: on a terminal, a progress bar that stays at the bottom;
//! elsewhere (a file, a pipe, a CI log), a plain line every few seconds. Nothing goes to stdout, which is for
//! results. A closed stderr does not stop the run.

mod count;
mod view;

use std::io::{self, Write};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressStyle};

pub use count::CountProgress;
use view::{Rates, View};

use crate::scenario::printable_lines;

/// Interval between updates of the bar.
const REDRAW: Duration = Duration::from_millis(100);
/// Time from the start to the first plain line.
const FIRST_LINE: Duration = Duration::from_millis(500);
/// Interval between plain lines.
const NEXT_LINE: Duration = Duration::from_secs(5);

/// The total count at which the run ends, including the part before a resume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgressTotal {
    /// Number of finished episodes.
    Episodes(u64),
    /// Number of env steps over all arenas.
    EnvSteps(u64),
}

/// The progress of a run. Counts start at the beginning of the run, including the part before a resume.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Finished episodes.
    pub episodes: u64,
    /// Env steps over all arenas.
    pub env_steps: u64,
    /// Gradient steps of the learner.
    pub gradient_steps: u64,
    /// Mean return of the last 100 episodes; `None` before the first has ended.
    pub mean_return: Option<f64>,
    /// Success rate of the last evaluation, 0 to 1; `None` before the first.
    pub success_rate: Option<f64>,
    /// Probability of a random action, 0 to 1.
    pub epsilon: f32,
}

/// A callback that receives the progress in place of a bar: at most once every 0.1 s, and at the end.
pub type ProgressListener = Box<dyn FnMut(&Progress)>;

/// A display of a run's progress.
pub struct ProgressReporter {
    budget: ProgressTotal,
    started: Instant,
    due: Duration,
    last: Progress,
    rates: Rates,
    display: Display,
}

enum Display {
    Quiet,
    Listener(ProgressListener),
    Bar(ProgressBar),
    Lines,
}

impl ProgressReporter {
    /// A display on stderr, whose clock starts now. With `quiet` it shows only [warnings](Self::warn).
    #[must_use]
    pub fn new(budget: ProgressTotal, quiet: bool) -> Self {
        Self::with(budget, if quiet { Display::Quiet } else { Display::for_stderr(budget) })
    }

    /// Passes the progress to `listener`; stderr gets only [warnings](Self::warn).
    #[must_use]
    pub fn with_listener(listener: ProgressListener) -> Self {
        // A listener does not use the total.
        Self::with(ProgressTotal::Episodes(0), Display::Listener(listener))
    }

    fn with(budget: ProgressTotal, display: Display) -> Self {
        let due = if matches!(display, Display::Lines) { FIRST_LINE } else { Duration::ZERO };
        let rates = Rates::default();
        Self { budget, started: Instant::now(), due, last: Progress::default(), rates, display }
    }

    /// Records the progress, and shows it if an update is due. Otherwise it only reads the clock.
    pub fn update(&mut self, progress: &Progress) {
        self.last = *progress;
        let now = self.started.elapsed();
        if self.rates.samples.is_empty() {
            self.rates.add(now, progress);
        }
        if now >= self.due {
            self.show(now);
        }
    }

    /// Prints the line `text`, above the bar.
    pub fn line(&mut self, text: &str) {
        match &self.display {
            Display::Quiet | Display::Listener(_) => {}
            Display::Bar(bar) => bar.println(printable_lines(text)),
            Display::Lines => print_stderr(text),
        }
    }

    /// Prints the line `warning: text`, even if quiet.
    pub fn warn(&mut self, text: &str) {
        let text = format!("warning: {text}");
        match &self.display {
            Display::Bar(bar) => bar.println(printable_lines(&text)),
            Display::Quiet | Display::Listener(_) | Display::Lines => print_stderr(&text),
        }
    }

    /// Shows the last progress at once, and prints `text` below it.
    pub fn finish(&mut self, text: &str) {
        self.show(self.started.elapsed());
        match &self.display {
            Display::Quiet | Display::Listener(_) => {}
            Display::Bar(bar) => {
                bar.abandon();
                print_stderr(text);
            }
            Display::Lines => print_stderr(text),
        }
    }

    fn show(&mut self, now: Duration) {
        self.rates.add(now, &self.last);
        let view = View { elapsed: now, budget: self.budget, progress: &self.last, rates: &self.rates };
        match &mut self.display {
            Display::Quiet => self.due = Duration::MAX,
            Display::Listener(listener) => {
                self.due = now + REDRAW;
                listener(&self.last);
            }
            Display::Bar(bar) => {
                self.due = now + REDRAW;
                bar.set_prefix(view.completion());
                bar.set_message(view.learning());
                bar.set_position(self.budget.done(&self.last));
                bar.tick();
            }
            Display::Lines => {
                self.due = now + NEXT_LINE;
                print_stderr(&format!("{}  {}", view.completion(), view.learning()));
            }
        }
    }
}

impl Display {
    /// A bar if stderr is a terminal that supports it, else lines.
    fn for_stderr(budget: ProgressTotal) -> Self {
        bar(budget.total()).map_or(Self::Lines, Self::Bar)
    }
}

/// A progress bar on stderr with `total` steps and a message line below; `None` if stderr is not a terminal
/// that supports it.
#[must_use]
pub fn bar(total: u64) -> Option<ProgressBar> {
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
    if bar.is_hidden() {
        return None;
    }
    let style = ProgressStyle::with_template(TEMPLATE)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .progress_chars("━╸─");
    Some(bar.with_style(style).with_finish(ProgressFinish::Abandon))
}

/// Two lines as wide as the terminal: the bar, and the state of learning. Their texts fit into 80 columns.
const TEMPLATE: &str = "{wide_bar:.cyan/dim} {prefix}\n{wide_msg}";

impl ProgressTotal {
    fn total(self) -> u64 {
        match self {
            Self::Episodes(n) | Self::EnvSteps(n) => n,
        }
    }

    fn done(self, progress: &Progress) -> u64 {
        match self {
            Self::Episodes(_) => progress.episodes,
            Self::EnvSteps(_) => progress.env_steps,
        }
    }
}

/// Prints a line to stderr. Text from files can't control the terminal: it is made [printable](printable_lines). Errors are
/// ignored: a closed stderr must not stop a run, and there is no other place to report it.
pub fn print_stderr(text: &str) {
    let _ = writeln!(io::stderr(), "{}", printable_lines(text));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_template_is_valid() {
        assert!(ProgressStyle::with_template(TEMPLATE).is_ok());
    }
}
