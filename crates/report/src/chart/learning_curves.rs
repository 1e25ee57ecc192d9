//! Curves over a shared axis, with bands: how several kinds of learner grew.
//!
//! In: for each panel its lines, as smoothed means with an interval and as raw means. Out: an SVG of the panels
//! one below the other. Lines differ by dashes and by a name at their right end, so colour is not needed.

use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::{LEFT, WIDTH, draw_nothing};
use crate::style::{
    Area, At, Axis, DrawError, DrawResult, GRID, HAIRLINE, HEADING, INK, LINE_HEIGHT, Legend, LegendEntry,
    SOFT_INK, STROKE, TEXT, area, bounds, colour, draw_title, ellipsized, is_drawable, line, mark, picture,
    spread, text_width, thinned, title_height, write,
};

/// Panels over one x axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LearningCurves {
    /// What the figure is about, on top.
    pub title: String,
    /// What x is, with its unit.
    pub x_label: String,
    /// From top to bottom.
    pub panels: Vec<ChartPanel>,
    /// Places on the x axis to be marked in every panel.
    pub marks: Vec<EventMarker>,
}

/// A vertical dashed line, such as where the scenario changes.
#[derive(Clone, Debug, PartialEq)]
pub struct EventMarker {
    /// Where, in units of the x axis.
    pub x: f64,
    /// What happens there, in a few words.
    pub label: String,
}

/// One picture of the stack.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChartPanel {
    /// What y is.
    pub heading: String,
    /// Put behind each number of the y axis: "%", " s", or nothing.
    pub y_unit: String,
    /// What is compared. A few; more than six get hard to tell apart.
    pub lines: Vec<CurveLine>,
    /// Values to compare with.
    pub reference_lines: Vec<ReferenceLine>,
    /// A value that the y axis must include, such as 0.
    pub include_y: Option<f64>,
}

/// A horizontal dashed line, such as what the paper reports.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceLine {
    /// Where, in units of the y axis.
    pub value: f64,
    /// What it is, in a few words: "paper: 2500".
    pub label: String,
}

/// One kind of learner.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CurveLine {
    /// What it is, short.
    pub name: String,
    /// Which colour and dashes of the palette; counted round.
    pub colour: usize,
    /// The smoothed mean and its band, in order of x.
    pub points: Vec<BandPoint>,
    /// The unsmoothed mean as x and y, in order of x.
    pub raw: Vec<(f64, f64)>,
}

/// A place on a smoothed line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandPoint {
    /// In units of the x axis.
    pub x: f64,
    /// In units of the y axis.
    pub mean: f64,
    /// Lower end of the 95 % interval; not finite if there is none.
    pub low: f64,
    /// Upper end of the 95 % interval; not finite if there is none.
    pub high: f64,
}

/// At most so many corners in a line or on one side of a band.
const MAX_CORNERS: usize = 320;
// Sizes in drawn pixels.
const HEADING_HEIGHT: i32 = 84;
const PLOT_HEIGHT: i32 = 300;
/// From the plot's right edge to a label's mark, and on to its text.
const LABEL_MARK: i32 = 44;
const LABEL_TEXT: i32 = 64;

impl LearningCurves {
    /// Draws the figure, as the text of an SVG file of less than 400 kB for six lines in three panels.
    ///
    /// # Errors
    /// When the drawing library fails; none of the input is known to bring that about.
    pub fn svg(&self) -> Result<String, DrawError> {
        let mut panels: Vec<ChartPanel> = self.panels.iter().map(ChartPanel::drawable).collect();
        if panels.is_empty() {
            panels.push(ChartPanel::default());
        }
        let marks: Vec<&EventMarker> = self.marks.iter().filter(|m| is_drawable(m.x)).collect();
        let width = WIDTH - LEFT - 32;
        let key = Legend::new(entries(&panels), width);
        let top = title_height(&self.title, width);
        let mark_row = if marks.is_empty() { 0 } else { LINE_HEIGHT };
        let block = HEADING_HEIGHT + PLOT_HEIGHT;
        let height = top + key.height() + mark_row + panels.len() as i32 * block + 128;

        picture((WIDTH as u32, height as u32), |root| {
            draw_title(root, &self.title, (LEFT, width))?;
            key.draw(root, (LEFT, top), width)?;
            let lines = || panels.iter().flat_map(|p| &p.lines);
            let xs = lines().flat_map(|l| l.points.iter().map(|p| p.x).chain(l.raw.iter().map(|p| p.0)));
            let frame = Frame {
                x: Axis::within(xs.chain(marks.iter().map(|m| m.x)), 6.0),
                right: WIDTH
                    - 24
                    - LABEL_TEXT
                    - panels.iter().map(ChartPanel::label_width).max().unwrap_or(0),
            };
            let mut upper = top + key.height() + mark_row + HEADING_HEIGHT;
            frame.draw_mark_names(root, &marks, upper - 16)?;
            let mut raised = mark_row;
            for panel in &panels {
                let heading = ellipsized(&panel.heading, HEADING, frame.right - LEFT);
                write(root, &heading, (LEFT, upper - 32 - raised), HEADING, &INK, HPos::Left)?;
                frame.draw_panel(root, panel, &marks, (upper, upper + PLOT_HEIGHT))?;
                upper += block;
                raised = 0;
            }
            frame.draw_x_axis(root, &self.x_label, height - 128)
        })
    }
}

/// What the panels have in common.
struct Frame {
    x: Axis,
    /// Where the plots end, in drawn pixels; they begin at `LEFT`.
    right: i32,
}

impl Frame {
    fn at_x(&self, x: f64) -> i32 {
        self.x.place(x, (LEFT, self.right))
    }

    fn draw_x_axis(&self, root: &Area, name: &str, top: i32) -> DrawResult {
        for tick in self.x.ticks() {
            let at = self.at_x(tick);
            line(root, vec![(at, top), (at, top + 10)], SOFT_INK.stroke_width(HAIRLINE))?;
            write(root, &self.x.label(tick), (at, top + 32), TEXT, &SOFT_INK, HPos::Center)?;
        }
        let name = ellipsized(name, TEXT, self.right - LEFT);
        write(root, &name, ((LEFT + self.right) / 2, top + 76), TEXT, &SOFT_INK, HPos::Center)
    }

    /// Writes the marks' names over their lines, each as far as the next mark allows.
    fn draw_mark_names(&self, root: &Area, marks: &[&EventMarker], y: i32) -> DrawResult {
        let mut places: Vec<(i32, &str)> = marks.iter().map(|m| (self.at_x(m.x), m.label.as_str())).collect();
        places.sort();
        for (i, &(at, name)) in places.iter().enumerate() {
            let end = places.get(i + 1).map_or(WIDTH - 16, |next| next.0 - 16);
            let before = if i == 0 { LEFT } else { places[i - 1].0 + 16 };
            // To the right of the line, unless all of it fits only to the left, before an unwritten stretch.
            let wide = text_width(name, TEXT);
            if at + wide > end && i + 1 == places.len() && i == 0 && at - wide > before {
                write(root, name, (at, y), TEXT, &SOFT_INK, HPos::Right)?;
            } else {
                write(root, &ellipsized(name, TEXT, end - at), (at, y), TEXT, &SOFT_INK, HPos::Left)?;
            }
        }
        Ok(())
    }

    fn draw_panel(
        &self,
        root: &Area,
        panel: &ChartPanel,
        marks: &[&EventMarker],
        sides: (i32, i32),
    ) -> DrawResult {
        let (upper, lower) = sides;
        let y = panel.axis();
        let at_y = |value| y.place(value, (lower, upper));
        for tick in y.ticks() {
            line(root, vec![(LEFT, at_y(tick)), (self.right, at_y(tick))], GRID.stroke_width(HAIRLINE))?;
            let label = ellipsized(&(y.label(tick) + &panel.y_unit), TEXT, LEFT - 24);
            write(root, &label, (LEFT - 16, at_y(tick)), TEXT, &SOFT_INK, HPos::Right)?;
        }
        line(root, vec![(LEFT, lower), (self.right, lower)], SOFT_INK.stroke_width(HAIRLINE))?;
        for mark in marks {
            let at = self.at_x(mark.x);
            let places = [(at, upper), (at, lower)];
            root.draw(&DashedPathElement::new(places, 8, 8, SOFT_INK.stroke_width(HAIRLINE)))?;
        }

        let mut labels = Vec::new();
        for level in &panel.reference_lines {
            let at = at_y(level.value);
            let places = [(LEFT, at), (self.right, at)];
            root.draw(&DashedPathElement::new(places, 12, 8, INK.stroke_width(HAIRLINE)))?;
            labels.push(Label { end: (self.right, at), text: &level.label, colour: None });
        }
        let place = |x, value| (self.at_x(x), at_y(value));
        for one in &panel.lines {
            let band =
                |end: fn(&BandPoint) -> f64| one.band().map(move |p| place(p.x, end(p))).collect::<Vec<_>>();
            let mut corners = band(|p| p.high);
            corners.extend(band(|p| p.low).into_iter().rev());
            area(root, corners, colour(one.colour).mix(0.16).filled())?;
        }
        for one in &panel.lines {
            let raw: Vec<At> = rough(&one.raw).into_iter().map(|(x, value)| place(x, value)).collect();
            line(root, raw, colour(one.colour).mix(0.35).stroke_width(1))?;
        }
        let ways =
            panel.lines.iter().map(|l| l.points.iter().map(|p| place(p.x, p.mean)).collect::<Vec<_>>());
        let ways: Vec<Vec<At>> = ways.collect();
        for (one, way) in panel.lines.iter().zip(&ways) {
            line(root, way.clone(), colour(one.colour).stroke_width(STROKE))?;
        }
        for (i, (one, way)) in panel.lines.iter().zip(&ways).enumerate() {
            // Evenly from left to right, each line's in the gaps of the others'.
            let first = LEFT as f64 + 40.0 + 140.0 * i as f64 / ways.len() as f64;
            for at in abreast(way, first, 140.0) {
                mark(root, one.colour, at)?;
            }
            if let Some(&end) = way.last() {
                labels.push(Label { end, text: &one.name, colour: Some(one.colour) });
            }
        }
        if panel.lines.iter().all(|l| l.points.is_empty() && l.raw.is_empty()) {
            draw_nothing(root, (LEFT, self.right), sides)?;
        }
        self.draw_labels(root, &labels, sides)
    }

    /// Names each line beside its end; the names are moved apart.
    fn draw_labels(&self, root: &Area, labels: &[Label], (upper, lower): (i32, i32)) -> DrawResult {
        let ends: Vec<i32> = labels.iter().map(|l| l.end.1).collect();
        for (label, y) in labels.iter().zip(spread(&ends, LINE_HEIGHT, (upper, lower))) {
            let text = ellipsized(label.text, TEXT, WIDTH - 16 - self.right - LABEL_TEXT);
            write(root, &text, (self.right + LABEL_TEXT, y), TEXT, &INK, HPos::Left)?;
            let to = (self.right + LABEL_MARK, y);
            let hue = label.colour.map_or(SOFT_INK, colour);
            line(root, vec![label.end, (self.right + 8, label.end.1), to], hue.stroke_width(HAIRLINE))?;
            if let Some(number) = label.colour {
                mark(root, number, to)?;
            }
        }
        Ok(())
    }
}

struct Label<'a> {
    /// Where what it names ends.
    end: At,
    text: &'a str,
    /// A line's; a level has none.
    colour: Option<usize>,
}

impl ChartPanel {
    /// What of it can be drawn, thinned to what can be seen.
    fn drawable(&self) -> Self {
        let lines = self.lines.iter().map(|one| {
            let points = one.points.iter().filter(|p| is_drawable(p.x) && is_drawable(p.mean)).copied();
            let mut points: Vec<BandPoint> = points.collect();
            points.sort_by(|a, b| a.x.total_cmp(&b.x));
            let mut raw: Vec<_> =
                one.raw.iter().filter(|p| is_drawable(p.0) && is_drawable(p.1)).copied().collect();
            raw.sort_by(|a, b| a.0.total_cmp(&b.0));
            CurveLine { points: thinned(&points, MAX_CORNERS), raw, ..one.clone() }
        });
        let reference_lines = self.reference_lines.iter().filter(|l| is_drawable(l.value)).cloned();
        Self {
            lines: lines.collect(),
            reference_lines: reference_lines.collect(),
            include_y: self.include_y.filter(|&y| is_drawable(y)),
            ..self.clone()
        }
    }

    /// Around the means; raw values and bands are cut off where they would more than double it.
    fn axis(&self) -> Axis {
        let means = self.lines.iter().flat_map(|l| l.points.iter().map(|p| p.mean));
        let shown = means.chain(self.reference_lines.iter().map(|l| l.value)).chain(self.include_y);
        let raw = || self.lines.iter().flat_map(|l| l.raw.iter().map(|p| p.1));
        let mut shown: Vec<f64> = shown.collect();
        if shown.is_empty() {
            shown.extend(raw());
        }
        let (low, high) = bounds(shown.iter().copied());
        let room = (high - low) / 2.0;
        let bands = self.lines.iter().flat_map(|l| l.band().flat_map(|p| [p.low, p.high]));
        let rest = raw().chain(bands).map(|y| y.clamp(low - room, high + room));
        Axis::within(shown.iter().copied().chain(rest), 5.0)
    }

    /// The room its labels want, in drawn pixels; a third of the figure at most.
    fn label_width(&self) -> i32 {
        let names = self.lines.iter().map(|l| &l.name).chain(self.reference_lines.iter().map(|l| &l.label));
        names.map(|name| text_width(name, TEXT)).max().unwrap_or(0).min(WIDTH / 3)
    }
}

impl CurveLine {
    /// The points that have an interval.
    fn band(&self) -> impl Iterator<Item = &BandPoint> {
        self.points.iter().filter(|p| is_drawable(p.low) && is_drawable(p.high))
    }
}

/// The key's entries: only of what there is.
fn entries(panels: &[ChartPanel]) -> Vec<LegendEntry> {
    let lines = || panels.iter().flat_map(|p| &p.lines);
    let mut entries = Vec::new();
    if lines().any(|l| !l.points.is_empty()) {
        entries.push(LegendEntry::Symbol(Legend::smooth, "smoothed mean"));
    }
    if lines().any(|l| l.band().next().is_some()) {
        entries.push(LegendEntry::Symbol(Legend::band, "95 % interval"));
    }
    if lines().any(|l| !l.raw.is_empty()) {
        entries.push(LegendEntry::Symbol(Legend::raw, "mean of each episode"));
    }
    entries
}

/// Many noisy points thinned without smoothing them: of each stretch the least and the greatest.
fn rough(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= MAX_CORNERS {
        return points.to_vec();
    }
    let stretch = points.len().div_ceil(MAX_CORNERS / 2);
    let ends = |part: &[(f64, f64)]| {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let ends = part.iter().min_by(by_value).zip(part.iter().max_by(by_value));
        let (a, b) = ends.map_or(([0.0; 2].into(), [0.0; 2].into()), |(a, b)| (*a, *b));
        if a.0 <= b.0 { [a, b] } else { [b, a] }
    };
    points.chunks(stretch).flat_map(ends).collect()
}

/// Places on a line that runs from left to right, evenly apart in x, the first at `first`.
fn abreast(way: &[At], first: f64, distance: f64) -> Vec<At> {
    let mut next = first;
    let mut found = Vec::new();
    for &at in way {
        if f64::from(at.0) >= next {
            found.push(at);
            while next <= f64::from(at.0) {
                next += distance;
            }
        }
    }
    found
}
