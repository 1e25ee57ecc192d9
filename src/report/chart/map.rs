//! The plan of a world and of ways through it.
//!
//! In: what stands in the world, in metres and radians, and named paths. Out: an SVG seen from above, x to the
//! right and y up, one metre as long in both.

use std::f64::consts::TAU;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::{LEFT, WIDTH, draw_nothing};
use crate::report::style::{
    Area, At, Axis, DrawError, Drawn, Entry, GREEN, GRID, HAIRLINE, INK, Key, SOFT_INK, STROKE, TEXT, along,
    area, colour, draw_title, line, mark, picture, thinned, title_height, usable, write,
};

/// A world from above. The origin is the enclosure's centre.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    /// What the figure is about, on top.
    pub title: String,
    /// Inner width of the enclosure along x, in m.
    pub width_m: f64,
    /// Inner height of the enclosure along y, in m.
    pub height_m: f64,
    /// Round obstacles: x, y and radius, in m.
    pub circles: Vec<(f64, f64, f64)>,
    /// Rectangular obstacles: their corners in order, in m.
    pub boxes: Vec<[(f64, f64); 4]>,
    /// Where the robot begins: x and y in m, heading in rad from the x axis, anticlockwise.
    pub start: (f64, f64, f64),
    /// Where it is to go: x, y and the radius that counts as reached, in m.
    pub target: (f64, f64, f64),
    /// Ways through it.
    pub paths: Vec<Path>,
}

/// A way through the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Path {
    /// Whose it is, short.
    pub name: String,
    /// Which colour and dashes of the palette; counted round.
    pub colour: usize,
    /// x and y in m, in order of time.
    pub points: Vec<(f64, f64)>,
}

/// At most so many corners of a path.
const MAX_CORNERS: usize = 1200;
// Sizes in drawn pixels.
const RIGHT: i32 = 32;
const FOOT: i32 = 128;
const MAX_HEIGHT: f64 = 1400.0;
const SOLID: RGBColor = RGBColor(190, 190, 190);

impl Map {
    /// Draws the figure, as the text of an SVG file.
    ///
    /// # Errors
    /// When the drawing library fails; none of the input is known to bring that about.
    pub fn svg(&self) -> Result<String, DrawError> {
        let width = WIDTH - LEFT - RIGHT;
        let key = Key::new(self.entries(), width);
        let title_end = title_height(&self.title, width);
        let upper = title_end + key.height() + 24;
        let plan = self.plan((LEFT, upper), f64::from(width));
        let lower = plan.as_ref().map_or(upper + 400, |p| p.lower);

        picture((WIDTH as u32, (lower + FOOT) as u32), |root| {
            draw_title(root, &self.title, (LEFT, width))?;
            key.draw(root, (LEFT, title_end), width)?;
            match plan {
                Some(plan) => self.draw(root, &plan),
                None => draw_nothing(root, (LEFT, WIDTH - RIGHT), (upper, lower)),
            }
        })
    }

    /// Where the enclosure lies on the drawing; none if it has no size.
    fn plan(&self, (left, upper): At, width: f64) -> Option<Plan> {
        let fits = |m: f64| usable(m) && m > 1e-6;
        if !fits(self.width_m) || !fits(self.height_m) {
            return None;
        }
        let scale = (width / self.width_m).min(MAX_HEIGHT / self.height_m);
        let step = Axis::within([0.0, self.width_m.max(self.height_m)].into_iter(), 6.0).step;
        let axis = |size: f64| Axis { range: -size / 2.0..size / 2.0, step };
        Some(Plan {
            x: axis(self.width_m),
            y: axis(self.height_m),
            left,
            right: left + ((self.width_m * scale).round() as i32).max(1),
            upper,
            lower: upper + ((self.height_m * scale).round() as i32).max(1),
        })
    }

    fn draw(&self, root: &Area, plan: &Plan) -> Drawn {
        plan.draw_axes(root)?;
        for &circle in &self.circles {
            plan.draw_disc(root, circle, SOLID.filled(), SOFT_INK)?;
        }
        for corners in &self.boxes {
            plan.draw_shape(root, corners, SOLID.filled(), SOFT_INK)?;
        }
        plan.draw_disc(root, self.target, GREEN.mix(0.25).filled(), GREEN)?;
        if usable(self.target.0) && usable(self.target.1) {
            draw_cross(root, plan.place((self.target.0, self.target.1)))?;
        }

        let ways = self.paths.iter().map(|path| thinned(&plan.places(&path.points), MAX_CORNERS));
        let ways: Vec<Vec<At>> = ways.collect();
        for (path, way) in self.paths.iter().zip(&ways) {
            line(root, way.clone(), colour(path.colour).stroke_width(STROKE))?;
        }
        for (i, (path, way)) in self.paths.iter().zip(&ways).enumerate() {
            let first = 60.0 + 160.0 * i as f64 / ways.len() as f64;
            for at in along(way, first, 160.0) {
                mark(root, path.colour, at)?;
            }
        }
        let (x, y, heading) = self.start;
        if usable(x) && usable(y) && usable(heading) {
            draw_robot(root, plan.place((x, y)), heading)?;
        }
        plan.draw_walls(root)
    }

    fn entries(&self) -> Vec<Entry> {
        let mut entries = vec![
            Entry::Sign(|root, at| draw_robot(root, at, 0.0), "start"),
            Entry::Sign(draw_goal, "target"),
        ];
        if !self.circles.is_empty() || !self.boxes.is_empty() {
            entries.push(Entry::Sign(draw_block, "obstacle"));
        }
        entries.extend(self.paths.iter().map(|path| Entry::Line(path.colour, path.name.clone())));
        entries
    }
}

/// The enclosure on the drawing.
struct Plan {
    x: Axis,
    y: Axis,
    left: i32,
    right: i32,
    upper: i32,
    lower: i32,
}

impl Plan {
    /// Of a place in m; one outside the walls lies on them.
    fn place(&self, (x, y): (f64, f64)) -> At {
        (self.x.place(x, (self.left, self.right)), self.y.place(y, (self.lower, self.upper)))
    }

    fn places(&self, points: &[(f64, f64)]) -> Vec<At> {
        points.iter().filter(|p| usable(p.0) && usable(p.1)).map(|&p| self.place(p)).collect()
    }

    fn draw_axes(&self, root: &Area) -> Drawn {
        for tick in self.x.ticks() {
            let at = self.place((tick, 0.0)).0;
            line(root, vec![(at, self.upper), (at, self.lower)], GRID.stroke_width(HAIRLINE))?;
            line(root, vec![(at, self.lower), (at, self.lower + 12)], SOFT_INK.stroke_width(HAIRLINE))?;
            write(root, &self.x.label(tick), (at, self.lower + 36), TEXT, &SOFT_INK, HPos::Center)?;
        }
        for tick in self.y.ticks() {
            let at = self.place((0.0, tick)).1;
            line(root, vec![(self.left, at), (self.right, at)], GRID.stroke_width(HAIRLINE))?;
            write(root, &self.y.label(tick), (self.left - 20, at), TEXT, &SOFT_INK, HPos::Right)?;
        }
        let middle = ((self.left + self.right) / 2, self.lower + 80);
        write(root, "x and y in m", middle, TEXT, &SOFT_INK, HPos::Center)
    }

    /// A shape with an edge; what is beyond the walls is cut off.
    fn draw_shape(&self, root: &Area, corners: &[(f64, f64)], fill: ShapeStyle, edge: RGBColor) -> Drawn {
        let corners = self.places(corners);
        area(root, corners.clone(), fill)?;
        line(root, closed(corners), edge.stroke_width(HAIRLINE))
    }

    fn draw_disc(&self, root: &Area, disc: (f64, f64, f64), fill: ShapeStyle, edge: RGBColor) -> Drawn {
        let (x, y, radius) = disc;
        let within = |axis: &Axis, at: f64| axis.range.start <= at - radius && at + radius <= axis.range.end;
        if !within(&self.x, x) || !within(&self.y, y) {
            return self.draw_shape(root, &ring(disc), fill, edge);
        }
        let pixels_per_m = f64::from(self.right - self.left) / (self.x.range.end - self.x.range.start);
        let pixels = (radius.max(0.0) * pixels_per_m).round() as i32;
        root.draw(&Circle::new(self.place((x, y)), pixels, fill))?;
        root.draw(&Circle::new(self.place((x, y)), pixels, edge.stroke_width(HAIRLINE)))?;
        Ok(())
    }

    fn draw_walls(&self, root: &Area) -> Drawn {
        let walls = [
            (self.left, self.upper),
            (self.right, self.upper),
            (self.right, self.lower),
            (self.left, self.lower),
        ];
        line(root, closed(walls.to_vec()), INK.stroke_width(STROKE + 2))
    }
}

/// A circle's corners: so many that it looks round.
fn ring((x, y, radius): (f64, f64, f64)) -> Vec<(f64, f64)> {
    (0..64).map(|i| f64::from(i) / 64.0 * TAU).map(|a| (x + radius * a.cos(), y + radius * a.sin())).collect()
}

/// Back to where it began.
fn closed(mut corners: Vec<At>) -> Vec<At> {
    corners.extend(corners.first().copied());
    corners
}

/// A dot with a white rim, and where it looks.
fn draw_robot(root: &Area, (x, y): At, heading: f64) -> Drawn {
    let nose = (x + (34.0 * heading.cos()).round() as i32, y - (34.0 * heading.sin()).round() as i32);
    line(root, vec![(x, y), nose], WHITE.stroke_width(STROKE + 6))?;
    root.draw(&Circle::new((x, y), 16, WHITE.filled()))?;
    line(root, vec![(x, y), nose], INK.stroke_width(STROKE + 1))?;
    root.draw(&Circle::new((x, y), 12, INK.filled()))?;
    Ok(())
}

fn draw_cross(root: &Area, (x, y): At) -> Drawn {
    line(root, vec![(x - 9, y), (x + 9, y)], INK.stroke_width(STROKE))?;
    line(root, vec![(x, y - 9), (x, y + 9)], INK.stroke_width(STROKE))
}

/// The target in the key.
fn draw_goal(root: &Area, (x, y): At) -> Drawn {
    root.draw(&Circle::new((x, y), 16, GREEN.mix(0.25).filled()))?;
    root.draw(&Circle::new((x, y), 16, GREEN.stroke_width(HAIRLINE)))?;
    draw_cross(root, (x, y))
}

/// An obstacle in the key.
fn draw_block(root: &Area, (x, y): At) -> Drawn {
    let corners = vec![(x - 16, y - 12), (x + 16, y - 12), (x + 16, y + 12), (x - 16, y + 12)];
    area(root, corners.clone(), SOLID.filled())?;
    line(root, closed(corners), SOFT_INK.stroke_width(HAIRLINE))
}
