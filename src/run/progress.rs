//! How a run is getting on, said on stderr.
//!
//! In: a [`Progress`] as often as one likes, and lines worth saying. Out: on a terminal a bar that stays at the
//! foot of the screen; elsewhere (a file, a pipe, a CI log) a plain line every few seconds. stdout, which is for
//! results, is never touched; and a stderr that is closed does not stop the run.

use std::collections::VecDeque;
use std::io::{self, Write};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressStyle};

/// Time between two looks of the bar.
const REDRAW: Duration = Duration::from_millis(100);
/// When the first plain line comes, after the start.
const FIRST_LINE: Duration = Duration::from_millis(500);
/// Time between two plain lines.
const NEXT_LINE: Duration = Duration::from_secs(5);
/// How far back rates and the time left look.
const RATE_WINDOW: Duration = Duration::from_secs(5);

/// What ends the run, as its total (a resumed run counts what was there before).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProgressTotal {
    /// So many ended episodes.
    Episodes(u64),
    /// So many environment steps, over all arenas.
    EnvSteps(u64),
}

/// How far a run is. Counts are totals since the run began, a resumed part included.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Ended episodes.
    pub episodes: u64,
    /// Environment steps, over all arenas.
    pub env_steps: u64,
    /// Gradient steps of the learner.
    pub gradient_steps: u64,
    /// Mean return of the last 100 episodes; none before the first has ended.
    pub mean_return: Option<f64>,
    /// Success rate of the last evaluation, 0 to 1; none before it.
    pub success_rate: Option<f64>,
    /// Exploration: the chance of a random action, 0 to 1.
    pub epsilon: f32,
}

/// Who is told how a run is getting on, every tenth of a second, where no bar of its own is wanted.
pub type ProgressListener = Box<dyn FnMut(&Progress)>;

/// Shows a run's progress on stderr.
pub struct ProgressReporter {
    budget: ProgressTotal,
    started: Instant,
    due: Duration,
    last: Progress,
    rates: Rates,
    face: Face,
}

enum Face {
    Quiet,
    Told(ProgressListener),
    Bar(ProgressBar),
    Lines,
}

impl ProgressReporter {
    /// Starts the clock. With `quiet` nothing is shown but [warnings](Self::warn).
    #[must_use]
    pub fn new(budget: ProgressTotal, quiet: bool) -> Self {
        Self::with(budget, if quiet { Face::Quiet } else { Face::for_stderr(budget) })
    }

    /// Tells `listener` instead of anybody at stderr, who hears [warnings](Self::warn) only.
    #[must_use]
    pub fn with_listener(listener: ProgressListener) -> Self {
        // The goal is the bar's, and there is none.
        Self::with(ProgressTotal::Episodes(0), Face::Told(listener))
    }

    fn with(budget: ProgressTotal, face: Face) -> Self {
        let due = if matches!(face, Face::Lines) { FIRST_LINE } else { Duration::ZERO };
        let rates = Rates::default();
        Self { budget, started: Instant::now(), due, last: Progress::default(), rates, face }
    }

    /// Takes note of how far the run is, and shows it when that is due. Else it costs one look at the clock.
    pub fn update(&mut self, status: &Progress) {
        self.last = *status;
        let now = self.started.elapsed();
        if self.rates.samples.is_empty() {
            self.rates.note(now, status);
        }
        if now >= self.due {
            self.show(now);
        }
    }

    /// Says `text` on a line of its own, above the bar.
    pub fn line(&mut self, text: &str) {
        match &self.face {
            Face::Quiet | Face::Told(_) => {}
            Face::Bar(bar) => bar.println(text),
            Face::Lines => print_stderr(text),
        }
    }

    /// Says `warning: text`, even when quiet.
    pub fn warn(&mut self, text: &str) {
        let text = format!("warning: {text}");
        match &self.face {
            Face::Bar(bar) => bar.println(text),
            Face::Quiet | Face::Told(_) | Face::Lines => print_stderr(&text),
        }
    }

    /// Shows the last status, whether due or not, and says `text` under it.
    pub fn finish(&mut self, text: &str) {
        self.show(self.started.elapsed());
        match &self.face {
            Face::Quiet | Face::Told(_) => {}
            Face::Bar(bar) => {
                bar.abandon();
                print_stderr(text);
            }
            Face::Lines => print_stderr(text),
        }
    }

    fn show(&mut self, now: Duration) {
        self.rates.note(now, &self.last);
        let view = View { elapsed: now, budget: self.budget, status: &self.last, rates: &self.rates };
        match &mut self.face {
            Face::Quiet => self.due = Duration::MAX,
            Face::Told(listener) => {
                self.due = now + REDRAW;
                listener(&self.last);
            }
            Face::Bar(bar) => {
                self.due = now + REDRAW;
                bar.set_prefix(view.advance());
                bar.set_message(view.learning());
                bar.set_position(self.budget.done(&self.last));
                bar.tick();
            }
            Face::Lines => {
                self.due = now + NEXT_LINE;
                print_stderr(&format!("{}  {}", view.advance(), view.learning()));
            }
        }
    }
}

impl Face {
    /// A bar if stderr is a terminal that can draw one, else lines.
    fn for_stderr(budget: ProgressTotal) -> Self {
        bar(budget.total()).map_or(Self::Lines, Self::Bar)
    }
}

/// A bar on stderr for `total` parts, with a row below it for a message; None where stderr is no terminal that can
/// draw one.
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

/// Two rows, so that all fits into 80 columns: how far the run is, and how learning goes.
const TEMPLATE: &str = "{wide_bar:.cyan/dim} {prefix}\n{wide_msg}";

impl ProgressTotal {
    fn total(self) -> u64 {
        match self {
            Self::Episodes(n) | Self::EnvSteps(n) => n,
        }
    }

    fn done(self, status: &Progress) -> u64 {
        match self {
            Self::Episodes(_) => status.episodes,
            Self::EnvSteps(_) => status.env_steps,
        }
    }
}

/// Writes to stderr. That it may be closed is no reason to stop a run, and there is nowhere left to say so.
pub fn print_stderr(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Samples of the last few seconds, for rates.
#[derive(Debug, Default)]
struct Rates {
    samples: VecDeque<(Duration, Progress)>,
}

impl Rates {
    /// Notes the status at `now`, and forgets samples that the window no longer needs (it keeps one at its edge).
    fn note(&mut self, now: Duration, status: &Progress) {
        self.samples.push_back((now, *status));
        while self.samples.get(1).is_some_and(|second| now.saturating_sub(second.0) >= RATE_WINDOW) {
            self.samples.pop_front();
        }
    }

    /// How fast `count` grows, per second; none before there is anything to tell it from.
    fn of(&self, count: impl Fn(&Progress) -> u64) -> Option<f64> {
        let ((t0, first), (t1, last)) = self.samples.front().zip(self.samples.back())?;
        let seconds = t1.saturating_sub(*t0).as_secs_f64();
        (seconds > 0.0).then(|| count(last).saturating_sub(count(first)) as f64 / seconds)
    }
}

/// What is to be said at one moment.
struct View<'a> {
    elapsed: Duration,
    budget: ProgressTotal,
    status: &'a Progress,
    rates: &'a Rates,
}

impl View<'_> {
    /// How far the run is: ` 41%  412/1000 episodes  1:23, 1:58 left`.
    fn advance(&self) -> String {
        let (done, total) = (self.budget.done(self.status), self.budget.total());
        // Rounded down, so that 100% means the end; a goal of nothing is reached at once.
        let percent = (u128::from(done) * 100).checked_div(u128::from(total)).unwrap_or(100).min(100);
        let unit = match self.budget {
            ProgressTotal::Episodes(_) => "episodes",
            ProgressTotal::EnvSteps(_) => "steps",
        };
        let mut text =
            format!("{percent:>3}%  {}/{} {unit}  {}", count(done), count(total), clock(self.elapsed));
        if let Some(left) = self.left().filter(|_| done < total) {
            text += &format!(", {} left", clock(left));
        }
        text
    }

    /// How learning goes, in at most 80 columns; measures that do not exist yet are left out.
    fn learning(&self) -> String {
        let status = self.status;
        let other = match self.budget {
            ProgressTotal::Episodes(_) => format!("{} steps", count(status.env_steps)),
            ProgressTotal::EnvSteps(_) => format!("{} episodes", count(status.episodes)),
        };
        let per_second = |rate: Option<f64>, unit| rate.map(|r| format!("{} {unit}/s", short(r)));
        [
            Some(other),
            per_second(self.rates.of(|s| s.env_steps), "steps"),
            per_second(self.rates.of(|s| s.gradient_steps), "grad"),
            status.mean_return.map(|mean| format!("return {}", decimal(mean))),
            status.success_rate.map(|rate| format!("success {}", percent(rate))),
            Some(format!("ε {:.2}", status.epsilon)),
        ]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join("  ")
    }

    /// The time the rest takes at the present rate; none while nothing moves.
    fn left(&self) -> Option<Duration> {
        let rate = self.rates.of(|status| self.budget.done(status)).filter(|&rate| rate > 0.0)?;
        let rest = self.budget.total().saturating_sub(self.budget.done(self.status));
        Duration::try_from_secs_f64(rest as f64 / rate).ok()
    }
}

/// A count: exact to four digits, then short.
fn count(n: u64) -> String {
    if n < 10_000 { n.to_string() } else { short(n as f64) }
}

/// A number that is not negative, with three digits and a unit: `7.4`, `68.2k`, `1.25M`.
fn short(x: f64) -> String {
    const UNITS: [&str; 5] = ["", "k", "M", "G", "T"];
    let (mut x, mut unit) = (x, 0);
    // 999.5 would round to a fourth digit.
    while x >= 999.5 && unit + 1 < UNITS.len() {
        x /= 1000.0;
        unit += 1;
    }
    let digits = match x {
        x if x >= 99.95 => 0,
        x if x >= 9.995 || unit == 0 => 1,
        _ => 2,
    };
    format!("{x:.digits$}{}", UNITS[unit])
}

/// A signed number with one decimal while it is small: `-12.3`, `340`.
fn decimal(x: f64) -> String {
    if x.abs() < 99.95 { format!("{x:.1}") } else { format!("{x:.0}") }
}

/// A rate from 0 to 1 in percent. Never rounded up to 100.
fn percent(rate: f64) -> String {
    let tenths = (rate * 1000.0 + 1e-9).floor();
    if tenths >= 1000.0 { "100%".to_owned() } else { format!("{:.1}%", tenths / 10.0) }
}

/// A duration as `m:ss`, `h:mm:ss`, or in days once it is two of them.
fn clock(time: Duration) -> String {
    let s = time.as_secs();
    match (s / 3600, s / 60 % 60, s % 60) {
        (0, m, s) => format!("{m}:{s:02}"),
        (h, ..) if h >= 48 => format!("{} days", h / 24),
        (h, m, s) => format!("{h}:{m:02}:{s:02}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(env_steps: u64) -> Progress {
        Progress {
            episodes: env_steps / 100,
            env_steps,
            gradient_steps: env_steps / 20,
            mean_return: Some(-12.34),
            success_rate: Some(0.9666),
            epsilon: 0.05,
        }
    }

    fn seconds(s: f64) -> Duration {
        Duration::from_secs_f64(s)
    }

    #[test]
    fn numbers_are_short() {
        let cases = [
            (0.0, "0.0"),
            (7.44, "7.4"),
            (99.96, "100"),
            (999.4, "999"),
            (999.6, "1.00k"),
            (68_249.0, "68.2k"),
            (999_600.0, "1.00M"),
            (12_345_678.0, "12.3M"),
            (5e15, "5000T"),
        ];
        for (x, text) in cases {
            assert_eq!(short(x), text, "{x}");
        }
        assert_eq!([count(0), count(9999), count(12_345)], ["0", "9999", "12.3k"]);
        assert_eq!([decimal(-12.34), decimal(0.0), decimal(-1234.5)], ["-12.3", "0.0", "-1234"]);
        assert_eq!(
            [percent(0.96), percent(0.9999), percent(1.0), percent(0.0)],
            ["96.0%", "99.9%", "100%", "0.0%"]
        );
    }

    #[test]
    fn times_are_read_as_on_a_clock() {
        for (s, text) in [(5, "0:05"), (83, "1:23"), (3599, "59:59"), (3725, "1:02:05"), (200_000, "2 days")]
        {
            assert_eq!(clock(Duration::from_secs(s)), text);
        }
    }

    #[test]
    fn rates_look_back_a_few_seconds_only() {
        let mut rates = Rates::default();
        assert_eq!(rates.of(|s| s.env_steps), None);
        rates.note(seconds(0.0), &status(0));
        assert_eq!(rates.of(|s| s.env_steps), None, "one sample tells no rate");
        // Ten seconds at 1000/s, then ten at 4000/s.
        for tenth in 1..=100 {
            rates.note(seconds(f64::from(tenth) / 10.0), &status(u64::from(tenth as u32) * 100));
        }
        assert_eq!(rates.of(|s| s.env_steps).map(f64::round), Some(1000.0));
        for tenth in 1..=100 {
            rates.note(
                seconds(10.0 + f64::from(tenth) / 10.0),
                &status(10_000 + u64::from(tenth as u32) * 400),
            );
        }
        assert_eq!(rates.of(|s| s.env_steps).map(f64::round), Some(4000.0), "the slow start is forgotten");
        assert!(rates.samples.len() < 60, "and takes no room");
    }

    #[test]
    fn a_view_says_all_in_80_columns() {
        let mut rates = Rates::default();
        rates.note(seconds(80.0), &status(1_000_000));
        rates.note(seconds(83.0), &status(1_204_747));
        let status = status(1_204_747);
        let view = View {
            elapsed: seconds(83.0),
            budget: ProgressTotal::EnvSteps(2_000_000),
            status: &status,
            rates: &rates,
        };
        assert_eq!(view.advance(), " 60%  1.20M/2.00M steps  1:23, 0:11 left");
        assert_eq!(
            view.learning(),
            "12.0k episodes  68.2k steps/s  3.41k grad/s  return -12.3  success 96.6%  ε 0.05"
        );
        assert!(view.learning().chars().count() <= 80);

        let view = View { budget: ProgressTotal::Episodes(30_000), ..view };
        assert_eq!(view.advance(), " 40%  12.0k/30.0k episodes  1:23, 0:26 left");
        assert!(
            view.learning().starts_with("1.20M steps  68.2k steps/s"),
            "the bar's own count is not said twice"
        );
    }

    #[test]
    fn what_is_not_known_is_left_out() {
        let (status, rates) = (Progress { epsilon: 1.0, ..Progress::default() }, Rates::default());
        let view = View {
            elapsed: seconds(0.0),
            budget: ProgressTotal::Episodes(1000),
            status: &status,
            rates: &rates,
        };
        assert_eq!(view.advance(), "  0%  0/1000 episodes  0:00");
        assert_eq!(view.learning(), "0 steps  ε 1.00");
        let view = View { budget: ProgressTotal::Episodes(0), ..view };
        assert_eq!(view.advance(), "100%  0/0 episodes  0:00", "nothing to do is done");
    }

    #[test]
    fn a_goal_nearly_reached_is_not_called_reached() {
        let (status, rates) = (status(199_999), Rates::default());
        let view = View {
            elapsed: seconds(1.0),
            budget: ProgressTotal::EnvSteps(200_000),
            status: &status,
            rates: &rates,
        };
        assert!(view.advance().starts_with(" 99%"), "{}", view.advance());
    }

    #[test]
    fn the_template_is_one_indicatif_knows() {
        assert!(ProgressStyle::with_template(TEMPLATE).is_ok());
    }
}
