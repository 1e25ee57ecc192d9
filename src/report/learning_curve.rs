//! The picture of one run: how the robot's skill grew with its experience.
//!
//! In: a point for each episode and each evaluation. Out: an SVG of three panels over one axis of environment
//! steps: success of the greedy policy, return per episode, targets per episode. Colours are Okabe and Ito's,
//! which colour-blind readers can tell apart; no panel needs colour to be read.

use std::error::Error;
use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// One ended episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EpisodePoint {
    /// Environment steps of the whole run when the episode ended.
    pub env_steps: u64,
    /// Sum of the episode's rewards, undiscounted.
    pub total_return: f64,
    /// Targets reached in the episode.
    pub targets: u32,
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

/// The figure could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the learning curve could not be drawn: {0}")]
pub struct DrawError(String);

/// Draws the learning curve of one run, as the text of an SVG file of less than 300 kB.
///
/// Points may come in any order, and none at all is no error. A value that is no finite number is left out.
/// Of very many episodes every n-th is drawn as a point; the moving mean is over all of them. The evaluation named as
/// the best is the latest whose cost is at most `as_good` (1 or more) times the least.
///
/// # Errors
/// When the drawing library fails; none of the input is known to bring that about.
pub fn learning_curve_svg(
    title: &str,
    episodes: &[EpisodePoint],
    evaluations: &[EvaluationPoint],
    as_good: f64,
) -> Result<String, DrawError> {
    let last = episodes.iter().map(|e| e.env_steps).chain(evaluations.iter().map(|e| e.env_steps)).max();
    let x = Axis::thousands(last.unwrap_or(0));
    let success = tidy(evaluations.iter().map(|e| (e.env_steps, e.success_rate.clamp(0.0, 1.0) * 100.0)));
    let returns = tidy(episodes.iter().map(|e| (e.env_steps, e.total_return)));
    let targets = tidy(episodes.iter().map(|e| (e.env_steps, f64::from(e.targets))));

    let panels = [
        Panel {
            heading: "Success rate of the greedy policy",
            colour: GREEN,
            unit: "%",
            y: Axis { range: 0.0..100.0, step: 25.0 },
            data: Data::Evaluations(success, best(evaluations, as_good)),
        },
        Panel {
            heading: "Return per episode",
            colour: BLUE,
            unit: "",
            y: Axis::around(&returns, &[], 0.0),
            data: Data::Episodes(returns),
        },
        Panel {
            heading: "Targets reached per episode",
            colour: VERMILION,
            unit: "",
            y: Axis::around(&targets, &[0.0, 1.0], 1.0),
            data: Data::Episodes(targets),
        },
    ];

    let mut svg = String::new();
    draw(&mut svg, title, &x, &panels).map_err(|error| DrawError(error.to_string()))?;
    // plotters knows whole pixels only, so all is drawn at twice its size and shown at half.
    let size = |scale| format!(r#"width="{}" height="{}""#, WIDTH / scale, HEIGHT / scale);
    Ok(svg.replacen(&size(1), &size(SCALE), 1))
}

/// What the paper reports for its robot, in percent.
const PAPER_PERCENT: f64 = 96.0;
/// Episodes in the moving mean.
const WINDOW: usize = 50;
/// At most so many marks, and so many corners of a line, in a panel.
const MAX_MARKS: usize = 900;

// Sizes in drawn pixels: SCALE of them are one pixel shown.
const SCALE: u32 = 2;
const WIDTH: u32 = 1800;
const HEIGHT: u32 = TITLE_HEIGHT as u32 + 3 * PANEL_HEIGHT as u32 + 128;
const TITLE_HEIGHT: i32 = 96;
const PANEL_HEIGHT: i32 = 420;
const HEADING_HEIGHT: i32 = 92;
const LEFT: i32 = 144;
const RIGHT: i32 = 208;
const HAIRLINE: u32 = 2;
const STROKE: u32 = 4;

// One scale of type: title, headings, all else. plotters' SVG divides sizes by 1.24.
const TITLE: f64 = 20.0 * SCALE as f64 * 1.24;
const HEADING: f64 = 15.0 * SCALE as f64 * 1.24;
const TEXT: f64 = 13.0 * SCALE as f64 * 1.24;
const FONT: &str = "Helvetica, Arial, sans-serif";

const GREEN: RGBColor = RGBColor(0, 158, 115);
const BLUE: RGBColor = RGBColor(0, 114, 178);
const VERMILION: RGBColor = RGBColor(213, 94, 0);
const INK: RGBColor = RGBColor(34, 34, 34);
const SOFT_INK: RGBColor = RGBColor(96, 96, 96);
const GRID: RGBColor = RGBColor(226, 226, 226);

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

/// What an axis spans, and the distance of its ticks (which lie at whole multiples of it).
struct Axis {
    range: Range<f64>,
    step: f64,
}

impl Axis {
    /// From 0 to `last` environment steps, in thousands.
    fn thousands(last: u64) -> Self {
        let end = if last == 0 { 1.0 } else { last as f64 / 1000.0 };
        Self { range: 0.0..end, step: tidy_step(end / 6.0) }
    }

    /// Around all values of a curve and those of `also`, from a tick to a tick at least `least_step` apart.
    fn around(curve: &Curve, also: &[f64], least_step: f64) -> Self {
        let values = || curve.iter().map(|p| p.1).chain(also.iter().copied());
        let mut low = values().fold(f64::INFINITY, f64::min);
        let mut high = values().fold(f64::NEG_INFINITY, f64::max);
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        let size = high.abs().max(low.abs());
        if high - low <= size * 1e-6 {
            let room = size.max(1.0) * 0.5;
            (low, high) = (low - room, high + room);
        }
        let step = tidy_step((high - low) / 4.0).max(least_step);
        Self { range: (low / step).floor() * step..(high / step).ceil() * step, step }
    }

    fn ticks(&self) -> Vec<f64> {
        let first = (self.range.start / self.step - 1e-6).ceil();
        let last = (self.range.end / self.step + 1e-6).floor();
        (0..=(last - first) as u32).map(|i| (first + f64::from(i)) * self.step).collect()
    }

    /// A tick's text: as many decimals as the ticks need, a true minus, thousands set apart.
    fn label(&self, tick: f64) -> String {
        let digits = (-self.step.log10().floor()).clamp(0.0, 6.0) as usize;
        let digits = if self.step * 10_f64.powi(digits as i32) % 1.0 > 1e-6 { digits + 1 } else { digits };
        number(tick, digits)
    }
}

/// The smallest of 1, 2, 2.5, 5 times a power of ten that is not under `least`.
fn tidy_step(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 2.5, 5.0].into_iter().map(|m| m * power).find(|&s| s >= least * 0.999).unwrap_or(10.0 * power)
}

/// A number with so many decimals, a true minus, and thousands set apart by commas.
fn number(x: f64, digits: usize) -> String {
    let plain = format!("{:.digits$}", x.abs());
    let whole = plain.find('.').unwrap_or(plain.len());
    let mut text = String::new();
    if x < 0.0 && plain.bytes().any(|b| (b'1'..=b'9').contains(&b)) {
        text.push('\u{2212}');
    }
    for (i, c) in plain.chars().enumerate() {
        if i > 0 && i < whole && (whole - i) % 3 == 0 {
            text.push(',');
        }
        text.push(c);
    }
    text
}

/// Points in order of their steps, those left out that cannot be drawn.
fn tidy(points: impl Iterator<Item = (u64, f64)>) -> Curve {
    let mut points: Vec<_> = points.filter(|p| p.1.abs() < 1e12).collect();
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

/// At most `MAX_MARKS` of the points, evenly taken, the first and the last among them.
fn thinned(curve: &Curve) -> Curve {
    if curve.len() <= MAX_MARKS {
        return curve.clone();
    }
    (0..MAX_MARKS).map(|i| curve[i * (curve.len() - 1) / (MAX_MARKS - 1)]).collect()
}

/// The best evaluation in words: the latest whose cost is at most `as_good` times the least.
fn best(evaluations: &[EvaluationPoint], as_good: f64) -> String {
    let known = || evaluations.iter().filter(|e| e.success_rate.is_finite());
    let least = known().map(|e| e.mean_cost_s).fold(f64::INFINITY, f64::min);
    let best = known().filter(|e| e.mean_cost_s <= as_good * least).max_by_key(|e| e.env_steps);
    let Some(best) = best else {
        return String::new();
    };
    let steps = number(best.env_steps as f64, 0);
    let time = best.mean_time_s.map_or(String::new(), |s| format!(", {s:.1} s a target"));
    // Rounded down: 100% is said only of a policy that never failed.
    let percent = (best.success_rate.clamp(0.0, 1.0) * 1000.0 + 1e-9).floor() / 10.0;
    format!("best: {percent}% at {steps} steps{time}")
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), Box<dyn Error>>;

fn draw(svg: &mut String, title: &str, x: &Axis, panels: &[Panel]) -> Drawn {
    let root = SVGBackend::with_string(svg, (WIDTH, HEIGHT)).into_drawing_area();
    root.fill(&WHITE)?;
    write(&root, title, (LEFT, TITLE_HEIGHT / 2 + 8), TITLE, &INK, HPos::Left)?;
    let mut top = TITLE_HEIGHT;
    for panel in panels {
        draw_panel(&root, top, x, panel)?;
        top += PANEL_HEIGHT;
    }
    let right = WIDTH as i32 - RIGHT;
    for tick in x.ticks() {
        let at = LEFT + (tick / x.range.end * f64::from(right - LEFT)).round() as i32;
        root.draw(&PathElement::new([(at, top), (at, top + 10)], SOFT_INK.stroke_width(HAIRLINE)))?;
        write(&root, &x.label(tick), (at, top + 32), TEXT, &SOFT_INK, HPos::Center)?;
    }
    let name = "environment steps (thousands)";
    write(&root, name, ((LEFT + right) / 2, top + 76), TEXT, &SOFT_INK, HPos::Center)?;
    root.present()?;
    Ok(())
}

fn draw_panel(root: &Area, top: i32, x: &Axis, panel: &Panel) -> Drawn {
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
            let points = thinned(curve);
            plot.draw(&PathElement::new(points.clone(), colour.stroke_width(STROKE)))?;
            let radius = if points.len() <= 80 { 7 } else { 4 };
            for point in points {
                plot.draw(&Circle::new(point, radius, colour.filled()))?;
            }
        }
        Data::Episodes(_) => {
            let points = thinned(curve);
            let (radius, strength) = if points.len() <= 100 { (5, 0.6) } else { (3, 0.3) };
            for point in points {
                plot.draw(&Circle::new(point, radius, colour.mix(strength).filled()))?;
            }
            let mean = moving_mean(curve);
            if let Some(&(_, last)) = mean.last() {
                plot.draw(&PathElement::new(thinned(&mean), colour.stroke_width(STROKE)))?;
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
fn draw_key(root: &Area, (right, y): (i32, i32), colour: RGBColor, points_only: bool) -> Drawn {
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

/// Writes a line of text, centred on `at` in height.
fn write(root: &Area, text: &str, at: (i32, i32), size: f64, colour: &RGBColor, side: HPos) -> Drawn {
    let style = (FONT, size).into_text_style(root).color(colour).pos(Pos::new(side, VPos::Center));
    root.draw(&Text::new(text, at, style))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn episodes(n: u64) -> Vec<EpisodePoint> {
        let one = |i| EpisodePoint {
            env_steps: i * 37,
            total_return: (i * 7919 % 101) as f64 - 60.0,
            targets: (i % 13) as u32,
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
        let odd = |total_return| EpisodePoint { env_steps: 500, total_return, targets: 1 };
        let cases: [(&str, Vec<EpisodePoint>, Vec<EvaluationPoint>); 6] = [
            ("empty", vec![], vec![]),
            ("one of each", episodes(1), vec![evaluation(37, 0.5)]),
            ("all at step 0", vec![EpisodePoint { env_steps: 0, total_return: 0.0, targets: 0 }], vec![]),
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
        assert_eq!(best(&evaluations, 1.01), "best: 99.9% at 13,000 steps, 5.0 s a target");
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
    fn ticks_are_round_and_enclose_the_values() {
        let axis = Axis::around(&vec![(0.0, -13.0), (1.0, 71.0)], &[], 0.0);
        assert_eq!(axis.ticks(), [-25.0, 0.0, 25.0, 50.0, 75.0]);
        let axis = Axis::around(&vec![(0.0, 2.0)], &[0.0, 1.0], 1.0);
        assert_eq!(axis.ticks(), [0.0, 1.0, 2.0], "counts have whole ticks");
        assert!(Axis::around(&vec![(0.0, -7.5)], &[], 0.0).ticks().len() >= 3, "a constant has room");
        let labels = |axis: Axis| axis.ticks().into_iter().map(|t| axis.label(t)).collect::<Vec<_>>();
        assert_eq!(labels(Axis { range: 0.0..0.5, step: 0.25 }), ["0.00", "0.25", "0.50"]);
        assert_eq!(labels(Axis { range: -2500.0..0.0, step: 2500.0 }), ["\u{2212}2,500", "0"]);
        assert_eq!(Axis::thousands(1_000_000).ticks(), [0.0, 200.0, 400.0, 600.0, 800.0, 1000.0]);
    }
}
