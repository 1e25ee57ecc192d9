//! The symbols of a dot plot: seeds, means with their intervals, the paper's values, and censored values.

use plotters::prelude::*;

use crate::style::{
    BLUE, Canvas, DrawResult, HAIRLINE, INK, Legend, LegendEntry, Pixel, STROKE, VERMILION, area, line,
};

use super::model::DotCell;

/// The distance from the mean down to the seeds' dots, in drawn pixels.
pub(super) const SEED_DROP: i32 = 22;

pub(super) fn draw_seed(root: &Canvas, at: Pixel) -> DrawResult {
    root.draw(&Circle::new(at, 7, BLUE.mix(0.8).stroke_width(HAIRLINE)))?;
    Ok(())
}

/// Draws a mean with its interval. `ends` gives the x of both ends, and whether the interval ends there; otherwise it is cut
/// off there, without an end mark.
pub(super) fn draw_mean(root: &Canvas, (x, y): Pixel, ends: [(i32, bool); 2]) -> DrawResult {
    let [(low, _), (high, _)] = ends;
    line(root, vec![(low, y), (high, y)], BLUE.stroke_width(STROKE))?;
    for (end, _) in ends.into_iter().filter(|(_, is_end)| *is_end && low < high) {
        line(root, vec![(end, y - 8), (end, y + 8)], BLUE.stroke_width(STROKE))?;
    }
    root.draw(&Circle::new((x, y), 10, BLUE.filled()))?;
    Ok(())
}

pub(super) fn draw_paper(root: &Canvas, (x, y): Pixel) -> DrawResult {
    let top = y - 20;
    line(root, vec![(x, top), (x, y + 12)], VERMILION.stroke_width(STROKE))?;
    area(root, vec![(x, top - 10), (x + 10, top), (x, top + 10), (x - 10, top)], VERMILION.filled())
}

/// Draws an arrow to the right; its tip is at the given point.
pub(super) fn draw_arrow(root: &Canvas, (x, y): Pixel) -> DrawResult {
    line(root, vec![(x - 40, y), (x - 12, y)], INK.stroke_width(STROKE))?;
    area(root, vec![(x, y), (x - 18, y - 10), (x - 18, y + 10)], INK.filled())
}

/// The legend of the symbols that occur in the cells.
pub(super) fn legend<'a>(cells: impl Iterator<Item = &'a DotCell> + Clone, width: i32) -> Legend {
    let any = |has: fn(&DotCell) -> bool| cells.clone().any(has);
    let mut entries = Vec::new();
    if any(|c| c.estimate.is_some()) {
        let symbol = |root: &Canvas, (x, y): Pixel| draw_mean(root, (x, y), [(x - 28, true), (x + 28, true)]);
        entries.push(LegendEntry::Symbol(symbol, "mean and 95 % interval".into()));
    }
    if any(|c| !c.values.is_empty()) {
        entries.push(LegendEntry::Symbol(draw_seed, "one seed".into()));
    }
    if any(|c| c.paper.is_some()) {
        let symbol = |root: &Canvas, (x, y): Pixel| draw_paper(root, (x, y + 8));
        entries.push(LegendEntry::Symbol(symbol, "paper".into()));
    }
    if any(|c| c.censored) {
        let symbol = |root: &Canvas, (x, y): Pixel| draw_arrow(root, (x + 20, y));
        entries.push(LegendEntry::Symbol(symbol, "not reached by every seed".into()));
    }
    Legend::new(entries, width)
}
