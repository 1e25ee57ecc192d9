//! A frame of a simulation: a map with the robot to scale and its LIDAR beams.

use plotters::prelude::*;

use super::floor_plan::FloorPlan;
use super::model::{MapRobot, ScenarioMap};
use crate::style::{Canvas, DrawError, DrawResult, HAIRLINE, INK, STROKE, is_drawable, line};

const BEAM: RGBColor = RGBColor(214, 108, 30);
const BODY: RGBColor = RGBColor(90, 140, 200);

impl ScenarioMap {
    /// The scenario with `robot` in place of the start, without title, legend and numbers, as the text of an SVG file of
    /// 480 x 360 pixels.
    ///
    /// # Errors
    /// The drawing library failed. No input is known to cause this.
    pub fn frame_svg(&self, robot: &MapRobot) -> Result<String, DrawError> {
        self.small_svg(|root, plan| {
            self.draw_trajectories(root, plan)?;
            robot.draw(root, plan)
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
        plan.draw_shape(root, &self.body, BODY.filled(), INK)?;
        let nose = (x + self.nose * heading.cos(), y + self.nose * heading.sin());
        line(root, vec![plan.pixel((x, y)), plan.pixel(nose)], INK.stroke_width(STROKE))
    }
}
