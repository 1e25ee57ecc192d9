//! One panel of a curve chart: axis, reference lines, bands, raw values, means and the labels at their right ends.

use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::clip::{clamped, parts_within};
use super::frame::Frame;
use super::model::{BandPoint, ChartPanel, CurveLine, EventMarker, RawStyle};
use crate::chart::layout::{LEFT, WIDTH, draw_no_data};
use crate::style::{
    Axis, Canvas, DrawResult, GRID, HAIRLINE, INK, LINE_HEIGHT, Pixel, SOFT_INK, STROKE, TEXT, area, colour,
    draw_marker, ellipsized, line, spread, write,
};

/// Distance from the plot's right edge to a label's marker, in drawn pixels.
const LABEL_MARKER: i32 = 44;
/// Distance from the plot's right edge to a label's text, in drawn pixels.
pub(super) const LABEL_TEXT: i32 = 64;
/// Distance between the markers on a line, in drawn pixels.
const MARKER_DISTANCE: f64 = 140.0;

/// The opacity of a faint line, 0 to 1.
const FAINT: f64 = 0.55;

/// A name at the right end of a line.
struct Label<'a> {
    /// The end of the line.
    end: Pixel,
    text: &'a str,
    colour: RGBColor,
    /// The index of its marker, if lines have markers.
    marker: Option<usize>,
}

/// A panel at its position on the drawing.
pub(super) struct PanelDrawing<'a> {
    frame: &'a Frame,
    panel: &'a ChartPanel,
    y: Axis,
    upper: i32,
    lower: i32,
}

impl<'a> PanelDrawing<'a> {
    pub(super) fn new(frame: &'a Frame, panel: &'a ChartPanel, (upper, lower): (i32, i32)) -> Self {
        Self { frame, panel, y: panel.y_axis(), upper, lower }
    }

    pub(super) fn draw(&self, root: &Canvas, event_markers: &[&EventMarker]) -> DrawResult {
        self.draw_y_axis(root)?;
        self.frame.draw_marker_lines(root, event_markers, (self.upper, self.lower))?;
        let mut labels = self.draw_reference_lines(root)?;
        for curve in &self.panel.lines {
            self.draw_band(root, curve)?;
        }
        for curve in &self.panel.lines {
            self.draw_raw(root, curve)?;
        }
        labels.extend(self.draw_means(root)?);
        if self.panel.is_empty() {
            draw_no_data(root, (LEFT, self.frame.right), (self.upper, self.lower))?;
        }
        self.draw_labels(root, &labels)
    }

    fn pixel(&self, x: f64, y: f64) -> Pixel {
        (self.frame.pixel_x(x), self.pixel_y(y))
    }

    fn pixels(&self, points: &[(f64, f64)]) -> Vec<Pixel> {
        points.iter().map(|&(x, y)| self.pixel(x, y)).collect()
    }

    fn pixel_y(&self, y: f64) -> i32 {
        self.y.pixel(y, (self.lower, self.upper))
    }

    fn draw_y_axis(&self, root: &Canvas) -> DrawResult {
        let right = self.frame.right;
        for tick in self.y.ticks() {
            let at = self.pixel_y(tick);
            line(root, vec![(LEFT, at), (right, at)], GRID.stroke_width(HAIRLINE))?;
            let label = ellipsized(&(self.y.label(tick) + &self.panel.y_unit), TEXT, LEFT - 24);
            write(root, &label, (LEFT - 16, at), TEXT, &SOFT_INK, HPos::Right)?;
        }
        line(root, vec![(LEFT, self.lower), (right, self.lower)], SOFT_INK.stroke_width(HAIRLINE))
    }

    fn draw_reference_lines(&self, root: &Canvas) -> Result<Vec<Label<'a>>, Box<dyn std::error::Error>> {
        let mut labels = Vec::new();
        for reference in &self.panel.reference_lines {
            let end = (self.frame.right, self.pixel_y(reference.value));
            let ends = [(LEFT, end.1), end];
            root.draw(&DashedPathElement::new(ends, 12, 8, INK.stroke_width(HAIRLINE)))?;
            labels.push(Label { end, text: &reference.label, colour: SOFT_INK, marker: None });
        }
        Ok(labels)
    }

    fn draw_band(&self, root: &Canvas, curve: &CurveLine) -> DrawResult {
        let side = |end: fn(&BandPoint) -> f64| {
            self.pixels(&clamped(curve.band().map(|p| (p.x, end(p))), &self.y.range))
        };
        let mut corners = side(|p| p.high);
        corners.extend(side(|p| p.low).into_iter().rev());
        area(root, corners, colour(curve.colour).mix(0.16).filled())
    }

    fn draw_raw(&self, root: &Canvas, curve: &CurveLine) -> DrawResult {
        let hue = colour(curve.colour);
        match curve.raw_style {
            RawStyle::Line => {
                for part in parts_within(curve.raw.iter().copied(), &self.y.range) {
                    line(root, self.pixels(&part), hue.mix(0.35).stroke_width(1))?;
                }
            }
            RawStyle::Dots => {
                let (radius, opacity) = if curve.raw.len() <= 100 { (6, 0.6) } else { (3, 0.3) };
                for at in self.pixels(&curve.raw) {
                    root.draw(&Circle::new(at, radius, hue.mix(opacity).filled()))?;
                }
            }
        }
        Ok(())
    }

    /// Draws the means, with markers if there are several, and returns their labels.
    fn draw_means(&self, root: &Canvas) -> Result<Vec<Label<'a>>, Box<dyn std::error::Error>> {
        let curves = &self.panel.lines;
        let paths: Vec<Vec<Pixel>> = curves
            .iter()
            .map(|curve| {
                curve.points.iter().filter(|p| p.has_mean()).map(|p| self.pixel(p.x, p.mean)).collect()
            })
            .collect();
        let with_faintness = |faint| curves.iter().zip(&paths).filter(move |(curve, _)| curve.faint == faint);
        for (curve, path) in with_faintness(true) {
            line(root, path.clone(), colour(curve.colour).mix(FAINT).stroke_width(HAIRLINE))?;
        }
        for (curve, path) in with_faintness(false) {
            line(root, path.clone(), colour(curve.colour).stroke_width(STROKE))?;
        }
        let has_markers = with_faintness(false).count() > 1;
        let mut labels = Vec::new();
        for (i, (curve, path)) in curves.iter().zip(&paths).enumerate() {
            let marker = (has_markers && !curve.faint).then_some(curve.colour);
            if let Some(marker) = marker {
                // The markers of each line are offset, so that they lie between those of the other lines.
                let first = f64::from(LEFT) + 40.0 + MARKER_DISTANCE * i as f64 / curves.len() as f64;
                for at in evenly_in_x(path, first, MARKER_DISTANCE) {
                    draw_marker(root, marker, at)?;
                }
            }
            if let Some(&end) = path.last() {
                labels.push(Label { end, text: &curve.name, colour: colour(curve.colour), marker });
            }
        }
        Ok(labels)
    }

    /// Writes each line's name to the right of its end, moved apart where names would overlap.
    fn draw_labels(&self, root: &Canvas, labels: &[Label]) -> DrawResult {
        let right = self.frame.right;
        let ends: Vec<i32> = labels.iter().map(|l| l.end.1).collect();
        for (label, y) in labels.iter().zip(spread(&ends, LINE_HEIGHT, (self.upper, self.lower))) {
            let text = ellipsized(label.text, TEXT, WIDTH - 16 - right - LABEL_TEXT);
            write(root, &text, (right + LABEL_TEXT, y), TEXT, &INK, HPos::Left)?;
            let to = (right + LABEL_MARKER, y);
            let path = vec![label.end, (right + 8, label.end.1), to];
            line(root, path, label.colour.stroke_width(HAIRLINE))?;
            if let Some(index) = label.marker {
                draw_marker(root, index, to)?;
            }
        }
        Ok(())
    }
}

/// Points of a path from left to right, about `distance` apart in x. The first lies at or just after `first`.
fn evenly_in_x(path: &[Pixel], first: f64, distance: f64) -> Vec<Pixel> {
    let mut next = first;
    let mut found = Vec::new();
    for &at in path {
        if f64::from(at.0) >= next {
            found.push(at);
            while next <= f64::from(at.0) {
                next += distance;
            }
        }
    }
    found
}
