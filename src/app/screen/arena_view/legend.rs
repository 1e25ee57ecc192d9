//! The legend: the robot, the goal, the spacing of the grid lines, and the overlays that are on.
//!
//! In: the overlays. Out: a strip along the bottom of the view; at zoom 1, a single line fits below the arena.

use std::sync::Arc;

use egui::{FontId, Galley, Pos2, Rect, Stroke, StrokeKind, pos2, vec2};

use super::beams::beam_color;
use super::canvas::Canvas;
use super::floor::grid_step_m;
use super::trajectories::{outcome_color, outcome_mark};
use crate::app::scene::TrailEnd;
use crate::app::screen::theme::SMALL;
use crate::app::view_state::Overlays;

const ROW: f32 = 20.0;
const SWATCH: f32 = 20.0;
const PAD: f32 = 6.0;
const ENTRY_GAP: f32 = 15.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Entry {
    Robot,
    Goal,
    GridCell,
    Beams,
    Path,
    Trail(TrailEnd),
    Downhill,
}

/// The entries for the overlays that are on.
fn entries(overlays: &Overlays) -> Vec<Entry> {
    let trails = [TrailEnd::Reached, TrailEnd::Collided, TrailEnd::TimedOut].map(Entry::Trail);
    let mut entries = vec![Entry::Robot, Entry::Goal, Entry::GridCell];
    for (on, group) in [
        (overlays.beams, &[Entry::Beams][..]),
        (overlays.path, &[Entry::Path]),
        (overlays.trails, &trails),
        (overlays.potential, &[Entry::Downhill]),
    ] {
        if on {
            entries.extend_from_slice(group);
        }
    }
    entries
}

/// Draws the legend along the bottom of the view, in as many lines as necessary, and returns its rectangle;
/// `None` if the view is too small.
pub fn draw(canvas: &Canvas, overlays: &Overlays) -> Option<Rect> {
    let view = canvas.transform.rect.shrink2(vec2(8.0, 5.0));
    if view.width() < 220.0 || view.height() < 220.0 {
        return None;
    }
    let font = FontId::proportional(SMALL);
    let entries: Vec<(Entry, Arc<Galley>)> = entries(overlays)
        .into_iter()
        .map(|entry| {
            (
                entry,
                canvas.painter.layout_no_wrap(label(canvas, entry), font.clone(), canvas.palette.weak_text),
            )
        })
        .collect();
    let (mut at, mut width_needed, mut positions) = (pos2(PAD, 0.0), 0.0_f32, Vec::new());
    for (entry, galley) in &entries {
        let width = swatch_width(*entry) + 6.0 + galley.size().x;
        if at.x > PAD && at.x + width + PAD > view.width() {
            at = pos2(PAD, at.y + ROW);
        }
        positions.push(at);
        at.x += width + ENTRY_GAP;
        width_needed = width_needed.max(at.x - ENTRY_GAP + PAD);
    }
    let size = vec2(width_needed, at.y + ROW);
    let strip = Rect::from_min_size(view.left_bottom() - vec2(0.0, size.y), size);
    canvas.strip_background(strip);
    for ((entry, galley), position) in entries.into_iter().zip(positions) {
        let left = strip.min + position.to_vec2() + vec2(0.0, ROW / 2.0);
        let width = swatch_width(entry);
        draw_swatch(canvas, entry, Rect::from_min_max(left - vec2(0.0, 5.0), left + vec2(width, 5.0)));
        let text = left + vec2(width + 6.0, -galley.size().y / 2.0);
        canvas.painter.galley(text, galley, canvas.palette.weak_text);
    }
    Some(strip)
}

fn swatch_width(entry: Entry) -> f32 {
    if matches!(entry, Entry::Robot | Entry::Goal | Entry::GridCell) { 10.0 } else { SWATCH }
}

fn label(canvas: &Canvas, entry: Entry) -> String {
    match entry {
        Entry::GridCell => return format!("{} m", format_length(grid_step_m(canvas.transform.scale))),
        Entry::Robot => "Robot",
        Entry::Goal => "Goal",
        Entry::Beams => "LIDAR",
        Entry::Path => "Current path",
        Entry::Trail(TrailEnd::Reached) => "Reached",
        Entry::Trail(TrailEnd::Collided) => "Collided",
        Entry::Trail(TrailEnd::TimedOut) => "Timed out",
        Entry::Downhill => "Downhill",
    }
    .into()
}

fn draw_swatch(canvas: &Canvas, entry: Entry, swatch: Rect) {
    let (painter, palette) = (&canvas.painter, &canvas.palette);
    let (left, right) = (swatch.left_center(), swatch.right_center());
    match entry {
        Entry::Robot => {
            painter.circle_filled(swatch.center(), 5.0, palette.accent);
        }
        Entry::Goal => {
            let fill = palette.success.gamma_multiply(0.18);
            painter.circle(swatch.center(), 5.0, fill, Stroke::new(1.5, palette.success));
            painter.circle_filled(swatch.center(), 1.5, palette.success);
        }
        // A cell of the floor's grid, at a fixed size.
        Entry::GridCell => {
            painter.rect(swatch, 0.0, palette.floor, Stroke::new(1.0, palette.weak_text), StrokeKind::Inside);
        }
        Entry::Beams => {
            gradient(canvas, left, right, 1.5, |part| beam_color(palette, 1.0 - part));
            painter.circle_filled(left, 2.5, palette.error);
        }
        Entry::Path => {
            gradient(canvas, left, right, 2.5, |part| {
                palette.accent.gamma_multiply(0.06 + 0.84 * part * part)
            });
        }
        Entry::Trail(end) => {
            let color = outcome_color(palette, end);
            gradient(canvas, left, right, 1.5, |part| color.gamma_multiply(0.3 + 0.7 * part));
            outcome_mark(painter, right - vec2(3.0, 0.0), end, color);
        }
        Entry::Downhill => {
            let along = vec2(1.0, 0.0);
            painter.line_segment(
                [left + along * 4.0, right - along * 4.0],
                Stroke::new(1.25, palette.weak_text),
            );
            canvas.arrow_head(right, along, 5.0, palette.weak_text);
        }
    }
}

/// Draws a line with the colour gradient `color`.
fn gradient(canvas: &Canvas, left: Pos2, right: Pos2, width: f32, color: impl Fn(f32) -> egui::Color32) {
    let points = [0.0, 0.25, 0.5, 0.75, 1.0].map(|part| canvas.transform.to_world(left.lerp(right, part)));
    canvas.gradient_line(points.into_iter(), width, color);
}

/// A round length in m, without trailing zeros.
fn format_length(metres: f32) -> String {
    if metres >= 1.0 {
        return format!("{metres:.0}");
    }
    let decimals = (-metres.max(1e-6).log10()).ceil().max(1.0) as usize;
    format!("{metres:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_overlays_that_are_on_have_an_entry() {
        let off = Overlays {
            beams: false,
            path: false,
            trails: false,
            potential: false,
            value: false,
            q_values: false,
        };
        assert_eq!(entries(&off), [Entry::Robot, Entry::Goal, Entry::GridCell]);
        assert_eq!(entries(&Overlays { trails: true, ..off }).len(), 6);
    }

    #[test]
    fn lengths_have_no_trailing_zeros() {
        assert_eq!([0.05, 0.2, 0.5, 1.0, 20.0].map(format_length), ["0.05", "0.2", "0.5", "1", "20"]);
    }
}
