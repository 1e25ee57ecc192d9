//! The figure of a single training run: success rate, return and goals over environment steps.

use crate::DrawError;
use crate::chart::{BandPoint, ChartPanel, CurveChart, CurveLine, EventMarker, RawStyle, ReferenceLine};
use crate::format::number;
use crate::smoothing::moving_mean;
use crate::style::is_drawable;

/// A finished episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EpisodePoint {
    /// Environment steps of the whole run when the episode ended.
    pub env_steps: u64,
    /// The undiscounted sum of the episode's rewards.
    pub total_return: f64,
    /// Goals reached in the episode.
    pub goals: u32,
}

/// An evaluation of the greedy policy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvaluationPoint {
    /// Environment steps of the whole run when the policy was evaluated.
    pub env_steps: u64,
    /// Share of the episodes that succeeded, 0 to 1.
    pub success_rate: f64,
    /// Mean simulated time of the successful episodes, in s; `None` if none succeeded.
    pub mean_time_s: Option<f64>,
    /// Mean time of all episodes, in s, with the time limit for each failure. The best policy has the lowest cost.
    pub mean_cost_s: f64,
}

/// The success rate that the paper reports in its Scenario I, in percent.
const PAPER_PERCENT: f64 = 96.0;
/// The number of episodes in the moving mean.
const WINDOW: usize = 50;

/// The figure of a run, as the text of an SVG file of less than 300 kB.
///
/// Points may be in any order. Non-finite values are left out; without points, the figure is empty. The
/// evaluation marked as the best is the latest whose cost is at most `cost_tolerance` (1 or more) times the lowest.
/// `compare_with_paper` adds the paper's success rate, which applies in its Scenario I only.
///
/// # Errors
/// The drawing library failed. No input is known to cause this.
pub fn learning_curve_svg(
    title: &str,
    episodes: &[EpisodePoint],
    evaluations: &[EvaluationPoint],
    cost_tolerance: f64,
    compare_with_paper: bool,
) -> Result<String, DrawError> {
    let last = episodes.iter().map(|e| e.env_steps).chain(evaluations.iter().map(|e| e.env_steps)).max();
    let success = in_order(evaluations.iter().map(|e| (e.env_steps, percent(e.success_rate))));
    let returns = in_order(episodes.iter().map(|e| (e.env_steps, e.total_return)));
    let goals = in_order(episodes.iter().map(|e| (e.env_steps, f64::from(e.goals))));

    let chart = CurveChart {
        title: title.into(),
        x_label: "environment steps (thousands)".into(),
        include_x: vec![0.0, last.filter(|&steps| steps > 0).map_or(1.0, thousands)],
        mean_label: format!("mean of {WINDOW} episodes"),
        raw_label: "one evaluation or episode".into(),
        panels: vec![
            success_panel(success, compare_with_paper),
            episode_panel("Return per episode", 0, returns, &[0.0]),
            episode_panel("Goals reached per episode", 1, goals, &[0.0, 1.0]),
        ],
        markers: best_marker(evaluations, cost_tolerance).into_iter().collect(),
    };
    chart.svg()
}

/// (x, y) values: thousands of environment steps, and the value measured there.
type Series = Vec<(f64, f64)>;

fn success_panel(success: Series, compare_with_paper: bool) -> ChartPanel {
    let paper = ReferenceLine { value: PAPER_PERCENT, label: format!("paper: {PAPER_PERCENT}%") };
    ChartPanel {
        heading: "Success rate of the greedy policy, by evaluation".into(),
        y_unit: "%".into(),
        lines: vec![CurveLine {
            name: success.last().map_or(String::new(), |last| format!("{}%", number(last.1, 1))),
            colour: 2,
            points: success.iter().copied().map(point).collect(),
            raw: success,
            raw_style: RawStyle::Dots,
        }],
        reference_lines: compare_with_paper.then_some(paper).into_iter().collect(),
        include_y: vec![0.0, 100.0],
    }
}

/// A panel of single episodes and their moving mean.
fn episode_panel(heading: &str, colour: usize, raw: Series, include_y: &[f64]) -> ChartPanel {
    let values: Vec<f64> = raw.iter().map(|point| point.1).collect();
    let means = moving_mean(&values, WINDOW);
    ChartPanel {
        heading: heading.into(),
        lines: vec![CurveLine {
            name: means.last().map_or(String::new(), |&last| number(last, 1)),
            colour,
            points: raw.iter().zip(&means).map(|(&(x, _), &mean)| point((x, mean))).collect(),
            raw,
            raw_style: RawStyle::Dots,
        }],
        include_y: include_y.to_vec(),
        ..ChartPanel::default()
    }
}

fn point((x, mean): (f64, f64)) -> BandPoint {
    BandPoint { x, mean, low: f64::NAN, high: f64::NAN }
}

fn thousands(env_steps: u64) -> f64 {
    env_steps as f64 / 1000.0
}

fn percent(rate: f64) -> f64 {
    rate.clamp(0.0, 1.0) * 100.0
}

/// The finite values, in order of environment steps.
fn in_order(points: impl Iterator<Item = (u64, f64)>) -> Series {
    let mut points: Vec<_> = points.filter(|point| is_drawable(point.1)).collect();
    points.sort_by_key(|point| point.0);
    points.into_iter().map(|(env_steps, value)| (thousands(env_steps), value)).collect()
}

/// A marker at the best evaluation: the latest whose cost is at most `cost_tolerance` times the lowest.
fn best_marker(evaluations: &[EvaluationPoint], cost_tolerance: f64) -> Option<EventMarker> {
    let known = || evaluations.iter().filter(|e| e.success_rate.is_finite());
    let lowest = known().map(|e| e.mean_cost_s).fold(f64::INFINITY, f64::min);
    let best = known().filter(|e| e.mean_cost_s <= cost_tolerance * lowest).max_by_key(|e| e.env_steps)?;
    let steps = number(best.env_steps as f64, 0);
    let time = best.mean_time_s.map_or(String::new(), |s| format!(", {s:.1} s per goal"));
    // The rate is rounded down, so that only a policy without a failure has 100%.
    let percent = (best.success_rate.clamp(0.0, 1.0) * 1000.0 + 1e-9).floor() / 10.0;
    let label = format!("best: {percent}% at {steps} steps{time}");
    Some(EventMarker { x: thousands(best.env_steps), label })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn episodes(n: u64) -> Vec<EpisodePoint> {
        let one = |i| EpisodePoint {
            env_steps: i * 37,
            total_return: (i * 7919 % 101) as f64 - 60.0,
            goals: (i % 13) as u32,
        };
        (1..=n).map(one).collect()
    }

    fn evaluation(env_steps: u64, success_rate: f64) -> EvaluationPoint {
        EvaluationPoint {
            env_steps,
            success_rate,
            mean_time_s: Some(5.04),
            mean_cost_s: 100.0 - 95.0 * success_rate,
        }
    }

    fn svg(episodes: &[EpisodePoint], evaluations: &[EvaluationPoint]) -> String {
        learning_curve_svg("A run", episodes, evaluations, 1.01, true).expect("the figure is drawn")
    }

    #[test]
    fn every_run_has_a_figure_that_holds_all_its_points() {
        let odd = |total_return| EpisodePoint { env_steps: 500, total_return, goals: 1 };
        let cases: [(&str, Vec<EpisodePoint>, Vec<EvaluationPoint>); 6] = [
            ("empty", vec![], vec![]),
            ("one of each", episodes(1), vec![evaluation(37, 0.5)]),
            ("all at step 0", vec![EpisodePoint { env_steps: 0, total_return: 0.0, goals: 0 }], vec![]),
            ("constant", vec![odd(-7.5); 80], vec![evaluation(10, 1.0), evaluation(20, 1.0)]),
            (
                "not finite",
                vec![odd(f64::NAN), odd(f64::INFINITY), odd(1e300)],
                vec![evaluation(1, f64::NAN)],
            ),
            ("huge values", vec![odd(9e11), odd(-9e11)], vec![evaluation(u64::MAX, 7.0)]),
        ];
        for (name, episodes, evaluations) in cases {
            crate::chart::svg_check::check(name, &svg(&episodes, &evaluations));
        }
        assert!(svg(&[], &[]).contains("no data yet"));
    }

    #[test]
    fn a_long_run_gives_a_small_file_whatever_the_order_of_its_points() {
        let evaluations: Vec<_> = (1..5000).map(|i| evaluation(i * 740, 0.9)).collect();
        let mut many = episodes(100_000);
        let one = svg(&many, &evaluations);
        assert!(one.len() < 300_000, "{} bytes", one.len());
        many.reverse();
        assert_eq!(one, svg(&many, &evaluations), "the order of the points does not matter");
    }

    #[test]
    fn the_best_evaluation_is_marked() {
        let evaluations = [evaluation(1000, 0.5), evaluation(12_000, 0.9999), evaluation(13_000, 0.9999)];
        let marker = best_marker(&evaluations, 1.01).expect("one is the best");
        assert_eq!((marker.x, marker.label.as_str()), (13.0, "best: 99.9% at 13,000 steps, 5.0 s per goal"));
        assert!(svg(&[], &evaluations).contains("best: 99.9%"));
        assert_eq!(best_marker(&[], 1.01), None);
    }

    #[test]
    fn the_figure_shows_the_paper_and_the_latest_values() {
        let svg = svg(&episodes(60), &[evaluation(1000, 0.5), evaluation(2000, 0.875)]);
        let (of_50, goals) =
            ("mean of 50 episodes", (11..=60).map(|i| f64::from(i % 13)).sum::<f64>() / 50.0);
        for text in ["paper: 96%", "87.5%", of_50, "one evaluation or episode", &number(goals, 1)] {
            assert!(svg.contains(text), "{text} is missing");
        }
        let elsewhere = learning_curve_svg("A run", &[], &[evaluation(1000, 0.5)], 1.01, false);
        assert!(!elsewhere.expect("the figure is drawn").contains("paper"), "the paper has no result there");
    }

    #[test]
    fn markup_in_the_title_is_escaped() {
        let svg = learning_curve_svg("a < b & c", &[], &[], 1.01, true).expect("the figure is drawn");
        assert!(svg.contains("a &lt; b &amp; c"));
    }
}
