//! The data of a plot card (title, lines and axis), and the state that all cards share.

use egui::Color32;

use super::axis::AxisScale;
use crate::app::history::{Annotation, DownsampledSeries};
use crate::report::run_figure::PaperResult;

/// The style of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TraceStyle {
    /// The main line of the card.
    Main,
    /// A secondary line.
    Faint,
    /// A line in the background, from an earlier training run.
    Earlier,
    /// A line with a dot at each point, as long as there are few points.
    Dots,
    /// A dot for each episode, or the area from minimum to maximum when there are too many.
    Spread,
}

/// One line of a card.
#[derive(Clone, Copy)]
pub struct Trace<'a> {
    /// The line's name in the legend.
    pub name: &'a str,
    /// A shorter name, for narrow cards.
    pub short_name: &'a str,
    /// The line's values.
    pub series: &'a DownsampledSeries,
    /// The line's colour.
    pub color: Color32,
    /// The line's style.
    pub style: TraceStyle,
}

/// A plot card.
pub struct Card<'a> {
    /// The card's title.
    pub title: &'static str,
    /// The tooltip of the title.
    pub about: &'static str,
    /// The y axis.
    pub scale: AxisScale,
    /// Decimals of the values that are shown as numbers (on a log axis: significant digits).
    pub digits: usize,
    /// The card's lines. The first one is drawn on top, and its value is next to the title.
    pub traces: Vec<Trace<'a>>,
    /// Whether all lines are equally important, so that no value is next to the title.
    pub no_primary_trace: bool,
    /// A dashed horizontal line to compare with.
    pub reference: Option<PaperResult>,
    /// A ring around the best point, as (x, y).
    pub ring: Option<(f64, f64)>,
    /// The text shown while there is no data.
    pub empty_text: &'static str,
}

/// The state that all cards share in a frame.
#[derive(Clone, Copy)]
pub struct CardContext<'a> {
    /// The ends of the whole x axis, in env steps.
    pub range: (f64, f64),
    /// The pointer's position in the last frame, in env steps.
    pub hovered: Option<f64>,
    /// Whether only a part of the x axis was shown in the last frame.
    pub zoomed: bool,
    /// A labelled vertical line for each change made by the user.
    pub marks: &'a [Annotation],
    /// Whether to show the whole x axis again.
    pub reset: bool,
}

/// The result of drawing a card.
#[derive(Clone, Copy, Debug, Default)]
pub struct CardResponse {
    /// The pointer's position, in env steps.
    pub hovered: Option<f64>,
    /// Whether only a part of the x axis is shown.
    pub zoomed: bool,
}
