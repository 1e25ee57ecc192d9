//! A frame of a simulation: a map with the robot to scale and its LIDAR beams.

use plotters::prelude::*;

use super::super::layout::draw_no_data;
use super::floor_plan::FloorPlan;
use super::model::{MapRobot, ScenarioMap};
use super::{MARGIN, OUTSIDE, THUMBNAIL};
use crate::style::{Canvas, DrawError, DrawResult, HAIRLINE, INK, STROKE, is_drawable, line, picture};

const BEAM: RGBColor = RGBColor(214, 108, 30);
const BODY: RGBColor = RGBColor(90, 140, 200);

impl ScenarioMap {
    /// The scenario with `robot` in place of the start, without title, legend, numbers, tracks and trajectories, as the text
    /// of an SVG file of 480 x 360 pixels.
    ///
    /// # Errors
    /// The drawing library failed. No input is known to cause this.
    pub fn frame_svg(&self, robot: &MapRobot) -> Result<String, DrawError> {
        let (width, height) = THUMBNAIL;
        picture((width as u32, height as u32), |root| {
            let available = (f64::from(width - 2 * MARGIN), f64::from(height - 2 * MARGIN));
            let Some(plan) = FloorPlan::new(&self.enclosure, (MARGIN, MARGIN), available) else {
                return draw_no_data(root, (MARGIN, width - MARGIN), (MARGIN, height - MARGIN));
            };
            let plan = plan.centred(THUMBNAIL);
            plan.draw_grid(root)?;
            self.draw_contents(root, &plan)?;
            robot.draw(root, &plan)?;
            plan.draw_enclosure(root, &self.enclosure, ((0, 0), THUMBNAIL), OUTSIDE)
        })
    }
}

impl MapRobot {
    fn draw(&self, root: &Canvas, plan: &FloorPlan) -> DrawResult {
        let (x, y, heading) = self.pose;
        if !(is_drawable(x) && is_drawable(y) && is_drawable(heading)) {
            return Ok(());
        }
        let from = plan.pixel(self.lidar);
        for end in plan.pixels(&self.beam_ends) {
            line(root, vec![from, end], BEAM.mix(0.45).stroke_width(HAIRLINE))?;
        }
        plan.draw_disc(root, (x, y, self.radius), BODY.filled(), INK)?;
        let nose = (x + self.radius * heading.cos(), y + self.radius * heading.sin());
        line(root, vec![plan.pixel((x, y)), plan.pixel(nose)], INK.stroke_width(STROKE))
    }
}
