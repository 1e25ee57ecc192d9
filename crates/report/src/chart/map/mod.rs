//! Scenario maps: a scenario seen from above, as a figure with trajectories or as a thumbnail.
//!
//! | file | contents |
//! |---|---|
//! | `model.rs` | the data of a map |
//! | `frame.rs` | a frame of a simulation: the robot to scale, and its beams |
//! | `floor_plan.rs` | metres to pixels, and everything drawn to scale |
//! | `tracks.rs` | the tracks of moving obstacles |
//! | `sheet.rs` | a contact sheet of many small maps |
//! | `symbols.rs` | symbols and the legend |

mod floor_plan;
mod frame;
mod model;
mod sheet;
mod symbols;
mod tracks;

use plotters::prelude::*;

use floor_plan::FloorPlan;
pub use model::{MapObstacle, MapObstacleKind, MapRobot, MapShape, MapTrack, MapTrajectory, ScenarioMap};
pub use sheet::contact_sheet_svg;
use symbols::{draw_cross, draw_robot, legend_entries, marked_colour, obstacle_colours};
use tracks::draw_tracks;

use super::layout::{LEFT, WIDTH, draw_no_data};
use crate::style::{
    Canvas, DrawError, DrawResult, GREEN, Legend, Pixel, STROKE, area, colour, draw_marker, draw_svg,
    draw_title, is_drawable, line, pixels_along, thinned, title_height,
};

/// The maximum number of vertices of a trajectory.
const MAX_VERTICES: usize = 1200;
// In drawn pixels.
const RIGHT: i32 = 32;
const FOOT: i32 = 128;
const MAX_HEIGHT: f64 = 1400.0;
/// The width and height of a thumbnail, in drawn pixels.
const THUMBNAIL: (i32, i32) = (960, 720);
/// The margin around the walls in a thumbnail, in drawn pixels.
const MARGIN: i32 = 36;
const OUTSIDE: RGBColor = RGBColor(240, 240, 240);

impl ScenarioMap {
    /// The figure as the text of an SVG file.
    ///
    /// # Errors
    /// The drawing library failed. No input is known to cause this.
    pub fn svg(&self) -> Result<String, DrawError> {
        let width = WIDTH - LEFT - RIGHT;
        let legend = Legend::new(legend_entries(self), width);
        let title_end = title_height(&self.title, width);
        let upper = title_end + legend.height() + 24;
        let plan = FloorPlan::new(&self.enclosure, (LEFT, upper), (f64::from(width), MAX_HEIGHT));
        let lower = plan.as_ref().map_or(upper + 400, |p| p.lower);

        draw_svg((WIDTH as u32, (lower + FOOT) as u32), |root| {
            draw_title(root, &self.title, (LEFT, width))?;
            legend.draw(root, (LEFT, title_end), width)?;
            match plan {
                Some(plan) => self.draw(root, &plan),
                None => draw_no_data(root, (LEFT, WIDTH - RIGHT), (upper, lower)),
            }
        })
    }

    /// The scenario without title, legend, numbers and trajectories, as the text of an SVG file of 480 x 360 pixels.
    /// In a scenario larger than 3 m, the grid lines are at least 1 m apart.
    ///
    /// # Errors
    /// The drawing library failed. No input is known to cause this.
    pub fn thumbnail_svg(&self) -> Result<String, DrawError> {
        self.small_svg(|root, plan| self.draw_start(root, plan))
    }

    /// A figure of a thumbnail's size, with what `draw_on_top` draws over tracks, obstacles and goal.
    fn small_svg(
        &self,
        draw_on_top: impl FnOnce(&Canvas, &FloorPlan) -> DrawResult,
    ) -> Result<String, DrawError> {
        let (width, height) = THUMBNAIL;
        draw_svg((width as u32, height as u32), |root| {
            let available = (f64::from(width - 2 * MARGIN), f64::from(height - 2 * MARGIN));
            let Some(plan) = FloorPlan::new(&self.enclosure, (MARGIN, MARGIN), available) else {
                return draw_no_data(root, (MARGIN, width - MARGIN), (MARGIN, height - MARGIN));
            };
            let plan = plan.centred((width / 2, height / 2));
            plan.draw_grid(root)?;
            self.draw_contents(root, &plan)?;
            draw_on_top(root, &plan)?;
            plan.draw_enclosure(root, &self.enclosure, ((0, 0), THUMBNAIL), OUTSIDE)
        })
    }

    fn draw(&self, root: &Canvas, plan: &FloorPlan) -> DrawResult {
        plan.draw_grid(root)?;
        plan.draw_numbers(root)?;
        self.draw_contents(root, plan)?;
        self.draw_trajectories(root, plan)?;
        self.draw_start(root, plan)?;
        let field = ((plan.left, plan.upper), (plan.right, plan.lower));
        plan.draw_enclosure(root, &self.enclosure, field, WHITE)
    }

    fn draw_trajectories(&self, root: &Canvas, plan: &FloorPlan) -> DrawResult {
        let paths: Vec<Vec<Pixel>> =
            self.trajectories.iter().map(|one| thinned(&plan.pixels(&one.points), MAX_VERTICES)).collect();
        for (trajectory, path) in self.trajectories.iter().zip(&paths) {
            line(root, path.clone(), colour(trajectory.colour).stroke_width(STROKE))?;
        }
        for (i, (trajectory, path)) in self.trajectories.iter().zip(&paths).enumerate() {
            let first = 60.0 + 160.0 * i as f64 / paths.len() as f64;
            for at in pixels_along(path, first, 160.0) {
                draw_marker(root, trajectory.colour, at)?;
            }
        }
        Ok(())
    }

    /// Draws tracks, obstacles, marked areas and the goal.
    fn draw_contents(&self, root: &Canvas, plan: &FloorPlan) -> DrawResult {
        draw_tracks(plan, root, &self.tracks)?;
        for obstacle in &self.obstacles {
            let (fill, edge) = obstacle_colours(obstacle.kind);
            plan.draw_shape(root, &obstacle.outline, fill.filled(), edge)?;
            if let MapObstacleKind::Moving(heading) = obstacle.kind {
                plan.draw_arrow(root, &obstacle.outline, heading, edge)?;
            }
        }
        for corners in &self.marked_areas {
            area(root, plan.pixels(corners), marked_colour().filled())?;
        }
        let Some((x, y, radius)) = self.goal else { return Ok(()) };
        plan.draw_disc(root, (x, y, radius), GREEN.mix(0.25).filled(), GREEN)?;
        if is_drawable(x) && is_drawable(y) {
            draw_cross(root, plan.pixel((x, y)))?;
        }
        Ok(())
    }

    fn draw_start(&self, root: &Canvas, plan: &FloorPlan) -> DrawResult {
        let Some((x, y, heading)) = self.start else { return Ok(()) };
        if is_drawable(x) && is_drawable(y) && is_drawable(heading) {
            draw_robot(root, plan.pixel((x, y)), heading)?;
        }
        Ok(())
    }
}
