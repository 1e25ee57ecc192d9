//! The picture of one run: how the robot's skill grew with its experience.
//!
//! In: a point for each episode and each evaluation. Out: an SVG of three panels over one axis of environment
//! steps: success of the greedy policy, return per episode, targets per episode. Colours are Okabe and Ito's,
//! which colour-blind readers can tell apart; no panel needs colour to be read.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use thiserror::Error;

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
}

/// The figure could not be drawn.
#[derive(Debug, Error)]
#[error("the learning curve could not be drawn: {0}")]
pub struct DrawError(String);

/// Draws the learning curve of one run, as the text of an SVG file of at most about 200 kB.
///
/// Points may come in any order, and none at all is no error. A value that is no finite number is left out.
/// Of very many episodes every n-th is drawn as a point; the moving mean is over all of them.
///
/// # Errors
/// When the drawing library fails; none of the input is known to bring that about.
pub fn learning_curve_svg(
    title: &str,
    episodes: &[EpisodePoint],
    evaluations: &[EvaluationPoint],
) -> Result<String, DrawError> {
    let last = episodes.iter().map(|e| e.env_steps).chain(evaluations.iter().map(|e| e.env_steps)).max();
    let x = Axis::thousands(last.unwrap_or(0));
    let success = tidy(evaluations.iter().map(|e| (e.env_steps, e.success_rate.clamp(0.0, 1.0) * 100.0)));
    let returns = tidy(episodes.iter().map(|e| (e.env_steps, e.total_return)));
    let targets = tidy(episodes.iter().map(|e| (e.env_steps, f64::from(e.targets))));

    let panels = [
        Panel {
            heading: "Success rate of the greedy policy",
            remark: best(evaluations),
            colour: GREEN,
            unit: "%",
            y: Axis { range: 0.0..100.0, step: 25.0 },
            reference: Some((PAPER_PERCENT, "paper: 96%")),
            data: Data::Evaluations(success),
        },
        Panel {
            heading: "Return per episode",
            remark: String::new(),
            colour: BLUE,
            unit: "",
            y: Axis::around(&returns, None),
            reference: None,
            data: Data::Episodes(returns),
        },
        Panel {
            heading: "Targets reached per episode",
            remark: String::new(),
            colour: VERMILION,
            unit: "",
            y: Axis::around(&targets, Some(0.0)),
            reference: None,
            data: Data::Episodes(targets),
        },
    ];

    let mut svg = String::new();
    draw(&mut svg, title, &x, &panels).map_err(|error| DrawError(error.to_string()))?;
    // plotters knows whole pixels only, so all is drawn at twice its size and shown at half.
    let size = |scale| format!(r#"width="{}" height="{}""#, WIDTH / scale, HEIGHT / scale);
    Ok(svg.replacen(&size(1), &size(SCALE as u32), 1))
}

/// What the paper reports for its robot, in percent.
const PAPER_PERCENT: f64 = 96.0;
/// Episodes in the moving mean.
const WINDOW: usize = 50;
/// At most so many marks, and so many corners of a line, in a panel.
const MAX_MARKS: usize = 900;

// Sizes in drawn pixels: SCALE of them are one pixel shown.
const SCALE: i32 = 2;
const WIDTH: u32 = 1800;
const HEIGHT: u32 = 1480;
const TITLE_HEIGHT: i32 = 104;
const HEADING_HEIGHT: i32 = 72;
const PLOT_HEIGHT: i32 = 336;
const LEFT: i32 = 136;
const RIGHT: i32 = 184;

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
    /// Said at the right of the heading; may be empty.
    remark: String,
    colour: RGBColor,
    unit: &'static str,
    y: Axis,
    reference: Option<(f64, &'static str)>,
    data: Data,
}

enum Data {
    /// Few points, joined.
    Evaluations(Curve),
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

    /// Around all values of a curve (and `also`), from a tick to a tick.
    fn around(curve: &Curve, also: Option<f64>) -> Self {
        let values = || curve.iter().map(|p| p.1).chain(also);
        let (mut low, mut high) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        if high - low <= high.abs().max(low.abs()) * 1e-6 {
            // One value only: give it room, and keep a bound that was asked for.
            let room = high.abs().max(1.0) * 0.5;
            (low, high) = (if also.is_some() { low } else { low - room }, high + room);
        }
        let step = tidy_step((high - low) / 4.0);
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

/// The best evaluation in words; of equals the earliest.
fn best(evaluations: &[EvaluationPoint]) -> String {
    let best = evaluations
        .iter()
        .filter(|e| e.success_rate.is_finite())
        .max_by(|a, b| a.success_rate.total_cmp(&b.success_rate).then(b.env_steps.cmp(&a.env_steps)));
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
type Drawn = Result<(), Box<dyn std::error::Error>>;

fn text(size: f64, colour: RGBColor, h: HPos, v: VPos) -> TextStyle<'static> {
    (FONT, size).into_text_style(&(WIDTH, HEIGHT)).color(&colour).pos(Pos::new(h, v))
}

fn draw(svg: &mut String, title: &str, x: &Axis, panels: &[Panel]) -> Drawn {
    let root = SVGBackend::with_string(svg, (WIDTH, HEIGHT)).into_drawing_area();
    root.fill(&WHITE)?;
    let style = text(TITLE, INK, HPos::Left, VPos::Center).transform(FontTransform::None);
    root.draw(&Text::new(title.to_owned(), (LEFT, TITLE_HEIGHT / 2 + 8), style))?;

    let mut top = TITLE_HEIGHT;
    for (i, panel) in panels.iter().enumerate() {
        draw_panel(&root, top, x, panel, i + 1 == panels.len())?;
        top += HEADING_HEIGHT + PLOT_HEIGHT;
    }
    let middle = LEFT + (WIDTH as i32 - LEFT - RIGHT) / 2;
    let style = text(TEXT, SOFT_INK, HPos::Center, VPos::Center);
    root.draw(&Text::new("environment steps (thousands)", (middle, top + 88), style))?;
    root.present()?;
    Ok(())
}

fn draw_panel(root: &Area, top: i32, x: &Axis, panel: &Panel, with_x_labels: bool) -> Drawn {
    let right = WIDTH as i32 - RIGHT;
    let heading = top + HEADING_HEIGHT / 2;
    root.draw(&Text::new(panel.heading, (LEFT, heading), text(HEADING, INK, HPos::Left, VPos::Center)))?;
    let small = |colour, h| text(TEXT, colour, h, VPos::Center);
    root.draw(&Text::new(panel.remark.clone(), (right, heading), small(SOFT_INK, HPos::Right)))?;

    let below = if with_x_labels { 52 } else { 0 };
    let area = root
        .clone()
        .shrink((0, top + HEADING_HEIGHT - 12), (right, PLOT_HEIGHT - 24 + below));
    let mut chart = ChartBuilder::on(&area)
        .y_label_area_size(LEFT)
        .x_label_area_size(below)
        .build_cartesian_2d(
            x.range.clone().with_key_points(x.ticks()),
            panel.y.range.clone().with_key_points(panel.y.ticks()),
        )?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .bold_line_style(GRID.stroke_width(SCALE as u32))
        .light_line_style(TRANSPARENT)
        .axis_style(TRANSPARENT)
        .set_all_tick_mark_size(8)
        .label_style(small(SOFT_INK, HPos::Center))
        .x_label_formatter(&|&tick| x.label(tick))
        .y_label_formatter(&|&tick| panel.y.label(tick) + panel.unit)
        .draw()?;
    Ok(())
}
