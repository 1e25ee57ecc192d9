//! A contact sheet: many small maps in one figure.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::ScenarioMap;
use super::floor_plan::FloorPlan;
use crate::chart::layout::draw_no_data;
use crate::style::{
    Canvas, DrawError, DrawResult, INK, Pixel, TEXT, draw_svg, draw_title, ellipsized, title_height, write,
};

/// Number of maps in a row.
const COLUMNS: usize = 4;
// In drawn pixels.
const CELL: i32 = 400;
const GAP: i32 = 40;
const LABEL: i32 = 48;

/// The figure of `maps`, in rows of four, each with its title, as the text of an SVG file.
///
/// # Errors
/// The drawing library failed. No input is known to cause this.
pub fn contact_sheet_svg(title: &str, maps: &[ScenarioMap]) -> Result<String, DrawError> {
    let columns = maps.len().clamp(1, COLUMNS) as i32;
    let rows = maps.len().div_ceil(COLUMNS).max(1) as i32;
    let width = columns * CELL + (columns - 1) * GAP;
    let upper = title_height(title, width) + GAP / 2;
    let height = upper + rows * (LABEL + CELL + GAP);
    draw_svg(((width + 2 * GAP) as u32, height as u32), |root| {
        draw_title(root, title, (GAP, width))?;
        for (k, map) in maps.iter().enumerate() {
            let (row, column) = ((k / COLUMNS) as i32, (k % COLUMNS) as i32);
            let corner = (GAP + column * (CELL + GAP), upper + row * (LABEL + CELL + GAP));
            map.draw_small(root, corner)?;
        }
        if maps.is_empty() { draw_no_data(root, (GAP, GAP + width), (upper, height)) } else { Ok(()) }
    })
}

impl ScenarioMap {
    /// Draws the map below its title into a cell of a contact sheet.
    fn draw_small(&self, root: &Canvas, (left, upper): Pixel) -> DrawResult {
        let label = ellipsized(&self.title, TEXT, CELL);
        write(root, &label, (left + CELL / 2, upper + LABEL / 2), TEXT, &INK, HPos::Center)?;
        let upper = upper + LABEL;
        let cell = f64::from(CELL);
        let Some(plan) = FloorPlan::new(&self.enclosure, (left, upper), (cell, cell)) else {
            return draw_no_data(root, (left, left + CELL), (upper, upper + CELL));
        };
        let plan = plan.centred((left + CELL / 2, upper + CELL / 2));
        plan.draw_grid(root)?;
        self.draw_contents(root, &plan)?;
        self.draw_start(root, &plan)?;
        let field = ((plan.left, plan.upper), (plan.right, plan.lower));
        plan.draw_enclosure(root, &self.enclosure, field, WHITE)
    }
}
