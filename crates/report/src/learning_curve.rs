//! The picture of one run: how the robot's skill grew with its experience.
//!
//! In: a point for each episode and each evaluation. Out: an SVG of three panels over one axis of environment
//! steps: success of the greedy policy, return per episode, goals per episode. Colours are Okabe and Ito's,
//! which colour-blind readers can tell apart; no panel needs colour to be read.

use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::style::{
    Area, Axis, BLUE, DrawError, DrawResult, GREEN, GRID, HAIRLINE, HEADING, INK, SOFT_INK, STROKE, TEXT,
    TITLE, VERMILION, is_drawable, picture, thinned, write,
};
use super::table::number;

/// One ended episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EpisodePoint {
    /// Environment steps of the whole run when the episode ended.
    pub env_steps: u64,
    /// Sum of the episode's rewards, undiscounted.
    pub total_return: f64,
    /// Goals reached in the episode.
    pub goals: u32,
}

/// One evaluation of the greedy policy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvaluationPoint {
    /// Environment steps of the whole run when it was evaluated.
    pub env_steps: u64,
    /// Share of navigations that succeeded, 0 to 1.
    pub success_rate: f64,
    /// Mean simulated time of a successful navigation, seconds; none if none succeeded.
    pub mean_time_s: Option<f64>,
    /// Mean time of all, in s, a failure counted as the time limit: by it the best is told.
    pub mean_cost_s: f64,
}

/// Draws the learning curve of one run, as the text of an SVG file of less than 300 kB.
///
/// Points may come in any order, and none at all is no error. A value that is no finite number is left out.
/// Of very many episodes every n-th is drawn as a point; the moving mean is over all of them. The evaluation named as
/// the best is the latest whose cost is at most `cost_tolerance` (1 or more) times the least.
///
/// # Errors
/// When the drawing library fails; none of the input is known to bring that about.
pub fn learning_curve_svg(
    title: &str,
    episodes: &[EpisodePoint],
    evaluations: &[EvaluationPoint],
    cost_tolerance: f64,
) -> Result<String, DrawError> {
    let last = episodes.iter().map(|e| e.env_steps).chain(evaluations.iter().map(|e| e.env_steps)).max();
    let x = thousands(last.unwrap_or(0));
    let success = tidy(evaluations.iter().map(|e| (e.env_steps, e.success_rate.clamp(0.0, 1.0) * 100.0)));
    let returns = tidy(episodes.iter().map(|e| (e.env_steps, e.total_return)));
    let goals = tidy(episodes.iter().map(|e| (e.env_steps, f64::from(e.goals))));

    let panels = [
        Panel {
            heading: "Success rate of the greedy policy",
            colour: GREEN,
            unit: "%",
            y: Axis { range: 0.0..100.0, step: 25.0 },
            data: Data::Evaluations(success, best(evaluations, cost_tolerance)),
        },
        Panel {
            heading: "Return per episode",
            colour: BLUE,
            unit: "",
            y: Axis::around(returns.iter().map(|p| p.1), 0.0),
            data: Data::Episodes(returns),
        },
        Panel {
            heading: "Goals reached per episode",
            colour: VERMILION,
            unit: "",
            y: Axis::around(goals.iter().map(|p| p.1).chain([0.0, 1.0]), 1.0),
            data: Data::Episodes(goals),
        },
    ];

    picture((WIDTH, HEIGHT), |root| draw(root, title, &x, &panels))
}

/// What the paper reports for its robot, in percent.
const PAPER_PERCENT: f64 = 96.0;
/// Episodes in the moving mean.
const WINDOW: usize = 50;
/// At most so many marks, and so many corners of a line, in a panel.
const MAX_MARKS: usize = 900;

// Sizes in drawn pixels.
const WIDTH: u32 = 1800;
const HEIGHT: u32 = TITLE_HEIGHT as u32 + 3 * PANEL_HEIGHT as u32 + 128;
const TITLE_HEIGHT: i32 = 96;
const PANEL_HEIGHT: i32 = 420;
const HEADING_HEIGHT: i32 = 92;
const LEFT: i32 = 144;
const RIGHT: i32 = 208;

/// A curve's points: thousands of environment steps, and the value there. In order, and finite.
type Curve = Vec<(f64, f64)>;

struct Panel {
    heading: &'static str,
    colour: RGBColor,
    unit: &'static str,
    y: Axis,
    data: Data,
}

enum Data {
    /// Few points, joined; and what is to be said of them.
    Evaluations(Curve, String),
    /// Many noisy points, under their moving mean.
    Episodes(Curve),
}

/// From 0 to `last` environment steps, in thousands.
fn thousands(last: u64) -> Axis {
    let end = if last == 0 { 1.0 } else { last as f64 / 1000.0 };
    Axis::within([0.0, end].into_iter(), 6.0)
}

/// Points in order of their steps, those left out that cannot be drawn.
fn tidy(points: impl Iterator<Item = (u64, f64)>) -> Curve {
    let mut points: Vec<_> = points.filter(|p| is_drawable(p.1)).collect();
    points.sort_by_key(|p| p.0);
    points.into_iter().map(|(steps, value)| (steps as f64 / 1000.0, value)).collect()
}

/// The mean of each point's value and those of the `WINDOW` - 1 before it; none where there are fewer.
fn moving_mean(curve: &Curve) -> Curve {
    curve
        .windows(WINDOW)
        .map(|w| (w[WINDOW - 1].0, w.iter().map(|p| p.1).sum::<f64>() / WINDOW as f64))
        .collect()
}

/// The best evaluation in words: the latest whose cost is at most `cost_tolerance` times the least.
fn best(evaluations: &[EvaluationPoint], cost_tolerance: f64) -> String {
    let known = || evaluations.iter().filter(|e| e.success_rate.is_finite());
    let least = known().map(|e| e.mean_cost_s).fold(f64::INFINITY, f64::min);
    let best = known().filter(|e| e.mean_cost_s <= cost_tolerance * least).max_by_key(|e| e.env_steps);
    let Some(best) = best else {
        return String::new();
    };
    let steps = number(best.env_steps as f64, 0);
    let time = best.mean_time_s.map_or(String::new(), |s| format!(", {s:.1} s a goal"));
    // Rounded down: 100% is said only of a policy that never failed.
    let percent = (best.success_rate.clamp(0.0, 1.0) * 1000.0 + 1e-9).floor() / 10.0;
    format!("best: {percent}% at {steps} steps{time}")
}

fn draw(root: &Area, title: &str, x: &Axis, panels: &[Panel]) -> DrawResult {
    write(root, title, (LEFT, TITLE_HEIGHT / 2 + 8), TITLE, &INK, HPos::Left)?;
    let mut top = TITLE_HEIGHT;
    for panel in panels {
        draw_panel(root, top, x, panel)?;
        top += PANEL_HEIGHT;
    }
    let right = WIDTH as i32 - RIGHT;
    for tick in x.ticks() {
        let at = LEFT + (tick / x.range.end * f64::from(right - LEFT)).round() as i32;
        root.draw(&PathElement::new([(at, top), (at, top + 10)], SOFT_INK.stroke_width(HAIRLINE)))?;
        write(root, &x.label(tick), (at, top + 32), TEXT, &SOFT_INK, HPos::Center)?;
    }
    let name = "environment steps (thousands)";
    write(root, name, ((LEFT + right) / 2, top + 76), TEXT, &SOFT_INK, HPos::Center)?;
    Ok(())
}

fn draw_panel(root: &Area, top: i32, x: &Axis, panel: &Panel) -> DrawResult {
    let (upper, lower, right) = (top + HEADING_HEIGHT, top + PANEL_HEIGHT, WIDTH as i32 - RIGHT);
    let heading = upper - 36;
    write(root, panel.heading, (LEFT, heading), HEADING, &INK, HPos::Left)?;

    let pixels = (LEFT..right, lower..upper);
    let plot = root.apply_coord_spec(Cartesian2d::<RangedCoordf64, RangedCoordf64>::new(
        x.range.clone(),
        panel.y.range.clone(),
        pixels,
    ));
    let height = |value| plot.map_coordinate(&(0.0, value)).1;
    for tick in panel.y.ticks() {
        let colour = if tick == panel.y.range.start { SOFT_INK } else { GRID };
        let at = height(tick);
        root.draw(&PathElement::new([(LEFT, at), (right, at)], colour.stroke_width(HAIRLINE)))?;
        let label = panel.y.label(tick) + panel.unit;
        write(root, &label, (LEFT - 16, at), TEXT, &SOFT_INK, HPos::Right)?;
    }

    let colour = panel.colour;
    let beside = right + 16;
    let (Data::Evaluations(curve, _) | Data::Episodes(curve)) = &panel.data;
    match &panel.data {
        Data::Evaluations(_, remark) => {
            let paper = height(PAPER_PERCENT);
            let line = [(LEFT, paper), (right, paper)];
            root.draw(&DashedPathElement::new(line, 12, 8, INK.stroke_width(HAIRLINE)))?;
            write(root, "paper: 96%", (beside, paper), TEXT, &INK, HPos::Left)?;
            write(root, remark, (right, heading), TEXT, &SOFT_INK, HPos::Right)?;
            let points = thinned(curve, MAX_MARKS);
            plot.draw(&PathElement::new(points.clone(), colour.stroke_width(STROKE)))?;
            let radius = if points.len() <= 80 { 7 } else { 4 };
            for point in points {
                plot.draw(&Circle::new(point, radius, colour.filled()))?;
            }
        }
        Data::Episodes(_) => {
            let points = thinned(curve, MAX_MARKS);
            let (radius, strength) = if points.len() <= 100 { (5, 0.6) } else { (3, 0.3) };
            for point in points {
                plot.draw(&Circle::new(point, radius, colour.mix(strength).filled()))?;
            }
            let mean = moving_mean(curve);
            if let Some(&(_, last)) = mean.last() {
                plot.draw(&PathElement::new(thinned(&mean, MAX_MARKS), colour.stroke_width(STROKE)))?;
                let at = height(last).clamp(upper, lower);
                write(root, &number(last, 1), (beside, at), TEXT, &colour, HPos::Left)?;
            }
            draw_key(root, (right, heading), colour, mean.is_empty())?;
        }
    }
    if curve.is_empty() {
        // Between two lines of the grid.
        let middle = ((LEFT + right) / 2, upper + (lower - upper) * 5 / 8);
        write(root, "nothing yet", middle, TEXT, &SOFT_INK, HPos::Center)?;
    }
    Ok(())
}

/// What points and line stand for, ending at `right` in the heading's row.
fn draw_key(root: &Area, (right, y): (i32, i32), colour: RGBColor, points_only: bool) -> DrawResult {
    let mut left = right - 104;
    if !points_only {
        let mean = format!("mean of {WINDOW}");
        write(root, &mean, (right, y), TEXT, &SOFT_INK, HPos::Right)?;
        let line = [(right - 224, y), (right - 168, y)];
        root.draw(&PathElement::new(line, colour.stroke_width(STROKE)))?;
        left -= 272;
    }
    for (dx, dy) in [(-34, 5), (-24, -6), (-14, 4)] {
        root.draw(&Circle::new((left + dx, y + dy), 3, colour.mix(0.5).filled()))?;
    }
    write(root, "episode", (left, y), TEXT, &SOFT_INK, HPos::Left)
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
        learning_curve_svg("A run", episodes, evaluations, 1.01).expect("is drawn")
    }

    /// Every coordinate of the marks and lines, to see that nothing leaves the picture.
    fn marks(svg: &str) -> Vec<(f64, f64)> {
        let value = |line: &str, name: &str| {
            let rest = line.split_once(&format!(" {name}=\""))?.1;
            Some(rest.split_once('"')?.0.to_owned())
        };
        let number = |text: &str| text.parse::<f64>().expect("a number");
        let mut found = Vec::new();
        for line in svg.lines() {
            if let (Some(x), Some(y)) = (value(line, "cx"), value(line, "cy")) {
                found.push((number(&x), number(&y)));
            }
            let points = value(line, "points").unwrap_or_default();
            found.extend(points.split_whitespace().map(|pair| {
                let (x, y) = pair.split_once(',').expect("a pair");
                (number(x), number(y))
            }));
        }
        found
    }

    #[test]
    fn any_run_gives_a_picture_that_holds_all_its_marks() {
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
            ("huge and far", vec![odd(9e11), odd(-9e11)], vec![evaluation(u64::MAX, 7.0)]),
        ];
        for (name, episodes, evaluations) in cases {
            let svg = svg(&episodes, &evaluations);
            assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{name}");
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}");
            for (x, y) in marks(&svg) {
                let inside = (0.0..=f64::from(WIDTH)).contains(&x) && (0.0..=f64::from(HEIGHT)).contains(&y);
                assert!(inside, "{name}: a mark at {x}, {y}");
            }
        }
    }

    #[test]
    fn a_long_run_is_a_small_file_and_the_same_one_each_time() {
        let (many, evals) =
            (episodes(100_000), (1..5000).map(|i| evaluation(i * 740, 0.9)).collect::<Vec<_>>());
        let one = svg(&many, &evals);
        assert!(one.len() < 300_000, "{} bytes", one.len());
        assert_eq!(one, svg(&many, &evals));
        let mut shuffled = many;
        shuffled.reverse();
        assert_eq!(one, svg(&shuffled, &evals), "order of points does not matter");
    }

    #[test]
    fn the_best_evaluation_is_said() {
        let evaluations = [evaluation(1000, 0.5), evaluation(12_000, 0.9999), evaluation(13_000, 0.9999)];
        assert_eq!(best(&evaluations, 1.01), "best: 99.9% at 13,000 steps, 5.0 s a goal");
        assert!(svg(&[], &evaluations).contains("best: 99.9%"));
        assert_eq!(best(&[], 1.01), "");
    }

    #[test]
    fn the_title_is_text_not_markup() {
        let svg = learning_curve_svg("a < b & c", &[], &[], 1.01).expect("is drawn");
        assert!(svg.contains("a &lt; b &amp; c"));
    }

    #[test]
    fn means_are_over_whole_windows() {
        let curve: Curve = (0..60).map(|i| (f64::from(i), f64::from(i))).collect();
        let mean = moving_mean(&curve);
        assert_eq!(mean.len(), 11);
        assert_eq!((mean[0], mean[10]), ((49.0, 24.5), (59.0, 34.5)));
        assert!(moving_mean(&curve[..49].to_vec()).is_empty());
    }

    #[test]
    fn steps_are_counted_in_thousands() {
        assert_eq!(thousands(1_000_000).ticks(), [0.0, 200.0, 400.0, 600.0, 800.0, 1000.0]);
    }
}
