//! Curves with bands, in panels that share one x axis.
//!
//! | file | contents |
//! |---|---|
//! | `model.rs` | what is drawn |
//! | `frame.rs` | the shared x axis and the event markers |
//! | `panel.rs` | one panel |
//! | `clip.rs` | lines and bands that leave the plot |

mod clip;
mod frame;
mod model;
mod panel;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use frame::Frame;
pub(crate) use model::MAX_VERTICES;
pub use model::{BandPoint, ChartPanel, CurveChart, CurveLine, EventMarker, RawStyle, ReferenceLine};
use panel::{LABEL_TEXT, PanelDrawing};

use super::layout::{LEFT, WIDTH};
use crate::style::{
    Axis, Canvas, DrawError, DrawResult, HAIRLINE, HEADING, INK, LINE_HEIGHT, Legend, LegendEntry, Pixel,
    SOFT_INK, STROKE, area, draw_svg, draw_title, ellipsized, is_drawable, line, title_height, write,
};

// In drawn pixels.
const HEADING_HEIGHT: i32 = 84;
const PLOT_HEIGHT: i32 = 300;
const PANEL_HEIGHT: i32 = HEADING_HEIGHT + PLOT_HEIGHT;
const X_AXIS_HEIGHT: i32 = 128;

impl CurveChart {
    /// The figure as the text of an SVG file; less than 400 kB for six curves with raw lines in each of three panels.
    ///
    /// # Errors
    /// The drawing library failed. No input is known to cause this.
    pub fn svg(&self) -> Result<String, DrawError> {
        let mut panels: Vec<ChartPanel> = self.panels.iter().map(ChartPanel::drawable).collect();
        if panels.is_empty() {
            panels.push(ChartPanel::default());
        }
        let markers: Vec<&EventMarker> = self.markers.iter().filter(|m| is_drawable(m.x)).collect();
        let width = WIDTH - LEFT - 32;
        let legend = Legend::new(self.legend_entries(&panels), width);
        let title_end = title_height(&self.title, width);
        let label_width = panels.iter().map(ChartPanel::label_width).max().unwrap_or(0);
        let frame = Frame { x: self.x_axis(&panels, &markers), right: WIDTH - 24 - LABEL_TEXT - label_width };
        let marker_rows = frame.marker_rows(&markers);
        let marker_height = marker_rows.len() as i32 * LINE_HEIGHT;
        let top = title_end + legend.height() + marker_height;
        let height = top + panels.len() as i32 * PANEL_HEIGHT + X_AXIS_HEIGHT;

        draw_svg((WIDTH as u32, height as u32), |root| {
            draw_title(root, &self.title, (LEFT, width))?;
            legend.draw(root, (LEFT, title_end), width)?;
            for (i, labels) in (0..).zip(&marker_rows) {
                frame.draw_marker_labels(root, labels, top + HEADING_HEIGHT - 16 - i * LINE_HEIGHT)?;
            }
            for (i, panel) in (0..).zip(&panels) {
                let upper = top + i * PANEL_HEIGHT + HEADING_HEIGHT;
                // The first panel's heading is above the labels of the markers.
                let raised = if i == 0 { marker_height } else { 0 };
                let heading = ellipsized(&panel.heading, HEADING, frame.right - LEFT);
                write(root, &heading, (LEFT, upper - 32 - raised), HEADING, &INK, HPos::Left)?;
                PanelDrawing::new(&frame, panel, (upper, upper + PLOT_HEIGHT)).draw(root, &markers)?;
            }
            frame.draw_x_axis(root, &self.x_label, height - X_AXIS_HEIGHT)
        })
    }

    fn x_axis(&self, panels: &[ChartPanel], markers: &[&EventMarker]) -> Axis {
        let lines = panels.iter().flat_map(|p| &p.lines);
        let values = lines.flat_map(|l| l.points.iter().map(|p| p.x).chain(l.raw.iter().map(|p| p.0)));
        let included = self.include_x.iter().copied().filter(|&x| is_drawable(x));
        Axis::within(values.chain(included).chain(markers.iter().map(|m| m.x)), 6.0)
    }

    /// The legend's entries, only for what the panels contain.
    fn legend_entries(&self, panels: &[ChartPanel]) -> Vec<LegendEntry> {
        let any = |has: fn(&CurveLine) -> bool| panels.iter().flat_map(|p| &p.lines).any(has);
        let mut entries = Vec::new();
        if any(|l| !l.points.is_empty()) && !self.mean_label.is_empty() {
            entries.push(LegendEntry::Symbol(mean_symbol, self.mean_label.clone()));
        }
        if any(|l| l.band().next().is_some()) {
            let cut = if panels.iter().any(ChartPanel::cuts_a_band) { ", cut off at the frame" } else { "" };
            entries.push(LegendEntry::Symbol(band_symbol, format!("{}{cut}", self.band_label)));
        }
        if any(|l| !l.raw.is_empty()) && !self.raw_label.is_empty() {
            let dots = any(|l| !l.raw.is_empty() && l.raw_style == RawStyle::Dots);
            let symbol = if dots { dots_symbol } else { raw_symbol };
            entries.push(LegendEntry::Symbol(symbol, self.raw_label.clone()));
        }
        entries
    }
}

fn mean_symbol(root: &Canvas, (x, y): Pixel) -> DrawResult {
    line(root, vec![(x - 28, y), (x + 28, y)], SOFT_INK.stroke_width(STROKE))
}

fn band_symbol(root: &Canvas, (x, y): Pixel) -> DrawResult {
    let corners = vec![(x - 28, y - 11), (x + 28, y - 11), (x + 28, y + 11), (x - 28, y + 11)];
    area(root, corners, SOFT_INK.mix(0.25).filled())
}

fn raw_symbol(root: &Canvas, (x, y): Pixel) -> DrawResult {
    let zigzag = [(-28, 4), (-20, -7), (-12, 8), (-4, -3), (4, 6), (12, -8), (20, 3), (28, -4)];
    let points = zigzag.into_iter().map(|(dx, dy)| (x + dx, y + dy)).collect();
    line(root, points, SOFT_INK.mix(0.6).stroke_width(HAIRLINE))
}

fn dots_symbol(root: &Canvas, (x, y): Pixel) -> DrawResult {
    for (dx, dy) in [(-20, 5), (0, -6), (20, 4)] {
        root.draw(&Circle::new((x + dx, y + dy), 5, SOFT_INK.mix(0.6).filled()))?;
    }
    Ok(())
}
