//! The text of a progress update.

use std::collections::VecDeque;
use std::time::Duration;

use super::{Progress, ProgressTotal};
use crate::report::format::percent;

/// Window over which rates are averaged; the remaining time is estimated from them.
const RATE_WINDOW: Duration = Duration::from_secs(5);

/// Progress samples within [`RATE_WINDOW`].
#[derive(Debug, Default)]
pub struct Rates {
    pub samples: VecDeque<(Duration, Progress)>,
}

impl Rates {
    /// Adds the progress at `now`, and drops samples before the window (one at its edge is kept).
    pub fn add(&mut self, now: Duration, progress: &Progress) {
        self.samples.push_back((now, *progress));
        while self.samples.get(1).is_some_and(|second| now.saturating_sub(second.0) >= RATE_WINDOW) {
            self.samples.pop_front();
        }
    }

    /// The growth of `count` per second; `None` with fewer than two samples.
    fn of(&self, count: impl Fn(&Progress) -> u64) -> Option<f64> {
        let ((t0, first), (t1, last)) = self.samples.front().zip(self.samples.back())?;
        let seconds = t1.saturating_sub(*t0).as_secs_f64();
        (seconds > 0.0).then(|| count(last).saturating_sub(count(first)) as f64 / seconds)
    }
}

/// The text of an update.
pub struct View<'a> {
    pub elapsed: Duration,
    pub budget: ProgressTotal,
    pub progress: &'a Progress,
    pub rates: &'a Rates,
}

impl View<'_> {
    /// The progress of the run, such as ` 41%  412/1000 episodes  1:23, 1:58 left`.
    pub fn completion(&self) -> String {
        let (done, total) = (self.budget.done(self.progress), self.budget.total());
        // Rounded down, so that 100% means the end. A total of zero is complete at once.
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

    /// The state of learning, in at most 80 columns if the return has at most five characters. Values that do not exist yet
    /// are left out.
    pub fn learning(&self) -> String {
        let progress = self.progress;
        let other = match self.budget {
            ProgressTotal::Episodes(_) => format!("{} steps", count(progress.env_steps)),
            ProgressTotal::EnvSteps(_) => format!("{} episodes", count(progress.episodes)),
        };
        let per_second = |rate: Option<f64>, unit| rate.map(|r| format!("{} {unit}/s", short(r)));
        [
            Some(other),
            per_second(self.rates.of(|s| s.env_steps), "steps"),
            per_second(self.rates.of(|s| s.gradient_steps), "grad"),
            progress.mean_return.map(|mean| format!("return {}", decimal(mean))),
            progress.success_rate.map(|rate| format!("success {}", percent(rate))),
            Some(format!("ε {:.2}", progress.epsilon)),
        ]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join("  ")
    }

    /// The estimated remaining time at the current rate; `None` without progress.
    fn left(&self) -> Option<Duration> {
        let rate = self.rates.of(|progress| self.budget.done(progress)).filter(|&rate| rate > 0.0)?;
        let rest = self.budget.total().saturating_sub(self.budget.done(self.progress));
        Duration::try_from_secs_f64(rest as f64 / rate).ok()
    }
}

/// A count: exact up to four digits, otherwise as by [`short`].
fn count(n: u64) -> String {
    if n < 10_000 { n.to_string() } else { short(n as f64) }
}

/// A non-negative number, rounded to three digits or fewer, with an SI prefix: `7.4`, `68.2k`, `1.25M`.
fn short(x: f64) -> String {
    const PREFIXES: [&str; 5] = ["", "k", "M", "G", "T"];
    let (mut x, mut prefix) = (x, 0);
    // 999.5 would round to a fourth digit.
    while x >= 999.5 && prefix + 1 < PREFIXES.len() {
        x /= 1000.0;
        prefix += 1;
    }
    let digits = match x {
        x if x >= 99.95 => 0,
        x if x >= 9.995 || prefix == 0 => 1,
        _ => 2,
    };
    format!("{x:.digits$}{}", PREFIXES[prefix])
}

/// A signed number, with one decimal if it is small: `-12.3`, `340`.
fn decimal(x: f64) -> String {
    if x.abs() < 99.95 { format!("{x:.1}") } else { format!("{x:.0}") }
}

/// A duration as `m:ss` or `h:mm:ss`, or in days from two days on.
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

    fn progress(env_steps: u64) -> Progress {
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
    fn numbers_are_rounded_and_have_an_si_prefix() {
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
    }

    #[test]
    fn durations_read_like_a_clock() {
        for (s, text) in [(5, "0:05"), (83, "1:23"), (3599, "59:59"), (3725, "1:02:05"), (200_000, "2 days")]
        {
            assert_eq!(clock(Duration::from_secs(s)), text);
        }
    }

    #[test]
    fn rates_are_averaged_over_the_last_seconds_only() {
        let mut rates = Rates::default();
        assert_eq!(rates.of(|s| s.env_steps), None);
        rates.add(seconds(0.0), &progress(0));
        assert_eq!(rates.of(|s| s.env_steps), None, "one sample gives no rate");
        // 10 s at 1000/s, then 10 s at 4000/s.
        for tenth in 1..=100_u32 {
            rates.add(seconds(f64::from(tenth) / 10.0), &progress(u64::from(tenth) * 100));
        }
        assert_eq!(rates.of(|s| s.env_steps).map(f64::round), Some(1000.0));
        for tenth in 1..=100_u32 {
            rates.add(seconds(10.0 + f64::from(tenth) / 10.0), &progress(10_000 + u64::from(tenth) * 400));
        }
        assert_eq!(
            rates.of(|s| s.env_steps).map(f64::round),
            Some(4000.0),
            "the slow start no longer counts"
        );
        assert!(rates.samples.len() < 60, "old samples are dropped");
    }

    #[test]
    fn an_update_fits_into_80_columns() {
        let mut rates = Rates::default();
        rates.add(seconds(80.0), &progress(1_000_000));
        rates.add(seconds(83.0), &progress(1_204_747));
        let progress = progress(1_204_747);
        let view = View {
            elapsed: seconds(83.0),
            budget: ProgressTotal::EnvSteps(2_000_000),
            progress: &progress,
            rates: &rates,
        };
        assert_eq!(view.completion(), " 60%  1.20M/2.00M steps  1:23, 0:11 left");
        assert_eq!(
            view.learning(),
            "12.0k episodes  68.2k steps/s  3.41k grad/s  return -12.3  success 96.6%  ε 0.05"
        );
        assert!(view.learning().chars().count() <= 80);

        let view = View { budget: ProgressTotal::Episodes(30_000), ..view };
        assert_eq!(view.completion(), " 40%  12.0k/30.0k episodes  1:23, 0:26 left");
        assert!(
            view.learning().starts_with("1.20M steps  68.2k steps/s"),
            "the count of the budget is not repeated"
        );
    }

    #[test]
    fn values_that_do_not_exist_yet_are_left_out() {
        let (progress, rates) = (Progress { epsilon: 1.0, ..Progress::default() }, Rates::default());
        let view = View {
            elapsed: seconds(0.0),
            budget: ProgressTotal::Episodes(1000),
            progress: &progress,
            rates: &rates,
        };
        assert_eq!(view.completion(), "  0%  0/1000 episodes  0:00");
        assert_eq!(view.learning(), "0 steps  ε 1.00");
        let view = View { budget: ProgressTotal::Episodes(0), ..view };
        assert_eq!(view.completion(), "100%  0/0 episodes  0:00", "an empty budget is complete");
    }

    #[test]
    fn percentages_are_rounded_down() {
        let (progress, rates) = (progress(199_999), Rates::default());
        let view = View {
            elapsed: seconds(1.0),
            budget: ProgressTotal::EnvSteps(200_000),
            progress: &progress,
            rates: &rates,
        };
        assert!(view.completion().starts_with(" 99%"), "{}", view.completion());
    }
}
