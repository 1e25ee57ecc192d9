//! The plan of a world and of ways through it.
//!
//! In: what stands and moves in the world, in metres and radians, and named paths. Out: an SVG seen from above, x to the
//! right and y up, one metre as long in both: a figure with title and key, or a small picture without a word.

mod floor_plan;

use plotters::prelude::*;

use floor_plan::{FloorPlan, closed};

use super::{LEFT, WIDTH, draw_nothing};
use crate::style::{
    Area, At, Axis, DrawError, DrawResult, GREEN, HAIRLINE, INK, Legend, LegendEntry, SOFT_INK, STROKE,
    along, area, bounds, colour, draw_title, is_drawable, line, mark, picture, thinned, title_height,
};

/// A world from above.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScenarioMap {
    /// What the figure is about, on top.
    pub title: String,
    /// The corners of the walls around it, anticlockwise, in m.
    pub enclosure: Vec<(f64, f64)>,
    /// What stands or moves in it; the later lie on the earlier.
    pub obstacles: Vec<MapObstacle>,
    /// Where moving obstacles go.
    pub tracks: Vec<Track>,
    /// Where the robot begins: x and y in m, heading in rad from the x axis, anticlockwise.
    pub start: (f64, f64, f64),
    /// Where it is to go: x, y and the radius that counts as reached, in m.
    pub goal: (f64, f64, f64),
    /// Ways through it.
    pub trajectories: Vec<MapTrajectory>,
}

/// Something to keep clear of.
#[derive(Clone, Debug, PartialEq)]
pub struct MapObstacle {
    /// What it is.
    pub kind: MapObstacleKind,
    /// Its outline.
    pub outline: Silhouette,
}

/// What a solid is, which says how it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MapObstacleKind {
    /// A piece of an inner wall.
    Wall,
    /// An obstacle that stands still.
    Obstacle,
    /// An obstacle that stands still and is drawn anew for every episode.
    Generated,
    /// An obstacle on its way into a direction, in rad from the x axis, anticlockwise.
    Moving(f64),
}

/// The outline of a solid.
#[derive(Clone, Debug, PartialEq)]
pub enum Silhouette {
    /// x, y and radius, in m.
    Disc(f64, f64, f64),
    /// Corners in order, in m.
    Polygon(Vec<(f64, f64)>),
}

/// Where a moving obstacle goes.
#[derive(Clone, Debug, PartialEq)]
pub enum Track {
    /// Straight from place to place, in m.
    Lines(Vec<(f64, f64)>),
    /// Along a circle, or anywhere within it: x, y and radius, in m.
    Ring(f64, f64, f64),
}

/// A way through the world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapTrajectory {
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
/// The small picture, half of it shown, and the rim around its walls.
const SMALL: (i32, i32) = (960, 720);
const RIM: i32 = 36;
const SOLID: RGBColor = RGBColor(190, 190, 190);
const REDRAWN: RGBColor = RGBColor(232, 232, 232);
const MOVING: RGBColor = RGBColor(242, 207, 150);
const MOVING_EDGE: RGBColor = RGBColor(138, 92, 8);
const TRACK: RGBColor = RGBColor(172, 137, 76);
const OUTSIDE: RGBColor = RGBColor(240, 240, 240);

impl ScenarioMap {
    /// Draws the figure, as the text of an SVG file.
    ///
    /// # Errors
    /// When the drawing library fails; none of the input is known to bring that about.
    pub fn svg(&self) -> Result<String, DrawError> {
        let width = WIDTH - LEFT - RIGHT;
        let key = Legend::new(self.entries(), width);
        let title_end = title_height(&self.title, width);
        let upper = title_end + key.height() + 24;
        let plan = self.plan((LEFT, upper), (f64::from(width), MAX_HEIGHT));
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

    /// Draws the world alone, without title, key, numbers and paths: 480 x 360 shown, as the text of an SVG file. The
    /// floor's grid is of whole metres in a world of more than 3 m.
    ///
    /// # Errors
    /// When the drawing library fails; none of the input is known to bring that about.
    pub fn thumbnail_svg(&self) -> Result<String, DrawError> {
        let (width, height) = SMALL;
        picture((width as u32, height as u32), |root| {
            let room = (width - 2 * RIM, height - 2 * RIM);
            let Some(plan) = self.plan((RIM, RIM), (f64::from(room.0), f64::from(room.1))) else {
                return draw_nothing(root, (RIM, width - RIM), (RIM, height - RIM));
            };
            let plan = plan.centred(SMALL);
            plan.draw_grid(root)?;
            self.draw_world(root, &plan)?;
            self.draw_start(root, &plan)?;
            plan.draw_enclosure(root, &self.enclosure, ((0, 0), SMALL), OUTSIDE)
        })
    }

    /// Where the enclosure lies on the drawing, as large as there is room; none if it has no size.
    fn plan(&self, (left, upper): At, room: (f64, f64)) -> Option<FloorPlan> {
        if !self.enclosure.iter().all(|corner| is_drawable(corner.0) && is_drawable(corner.1)) {
            return None;
        }
        let (low_x, high_x) = bounds(self.enclosure.iter().map(|corner| corner.0));
        let (low_y, high_y) = bounds(self.enclosure.iter().map(|corner| corner.1));
        let (width_m, height_m) = (high_x - low_x, high_y - low_y);
        if self.enclosure.len() < 3 || width_m.min(height_m) < 1e-6 {
            return None;
        }
        let scale = (room.0 / width_m).min(room.1 / height_m);
        let step = Axis::within([0.0, width_m.max(height_m)].into_iter(), 6.0).step;
        Some(FloorPlan {
            x: Axis { range: low_x..high_x, step },
            y: Axis { range: low_y..high_y, step },
            left,
            right: left + ((width_m * scale).round() as i32).max(1),
            upper,
            lower: upper + ((height_m * scale).round() as i32).max(1),
        })
    }

    fn draw(&self, root: &Area, plan: &FloorPlan) -> DrawResult {
        plan.draw_grid(root)?;
        plan.draw_numbers(root)?;
        self.draw_world(root, plan)?;

        let ways = self.trajectories.iter().map(|path| thinned(&plan.places(&path.points), MAX_CORNERS));
        let ways: Vec<Vec<At>> = ways.collect();
        for (path, way) in self.trajectories.iter().zip(&ways) {
            line(root, way.clone(), colour(path.colour).stroke_width(STROKE))?;
        }
        for (i, (path, way)) in self.trajectories.iter().zip(&ways).enumerate() {
            let first = 60.0 + 160.0 * i as f64 / ways.len() as f64;
            for at in along(way, first, 160.0) {
                mark(root, path.colour, at)?;
            }
        }
        self.draw_start(root, plan)?;
        let field = ((plan.left, plan.upper), (plan.right, plan.lower));
        plan.draw_enclosure(root, &self.enclosure, field, WHITE)
    }

    /// Tracks, solids and the goal.
    fn draw_world(&self, root: &Area, plan: &FloorPlan) -> DrawResult {
        plan.draw_tracks(root, &self.tracks)?;
        for solid in &self.obstacles {
            let (fill, edge) = match solid.kind {
                MapObstacleKind::Wall => (INK, INK),
                MapObstacleKind::Obstacle => (SOLID, SOFT_INK),
                MapObstacleKind::Generated => (REDRAWN, SOFT_INK),
                MapObstacleKind::Moving(_) => (MOVING, MOVING_EDGE),
            };
            match &solid.outline {
                Silhouette::Disc(x, y, radius) => {
                    plan.draw_disc(root, (*x, *y, *radius), fill.filled(), edge)?
                }
                Silhouette::Polygon(corners) => plan.draw_shape(root, corners, fill.filled(), edge)?,
            }
            if let MapObstacleKind::Moving(heading) = solid.kind {
                plan.draw_arrow(root, &solid.outline, heading)?;
            }
        }
        plan.draw_disc(root, self.goal, GREEN.mix(0.25).filled(), GREEN)?;
        if is_drawable(self.goal.0) && is_drawable(self.goal.1) {
            draw_cross(root, plan.place((self.goal.0, self.goal.1)))?;
        }
        Ok(())
    }

    fn draw_start(&self, root: &Area, plan: &FloorPlan) -> DrawResult {
        let (x, y, heading) = self.start;
        if is_drawable(x) && is_drawable(y) && is_drawable(heading) {
            draw_robot(root, plan.place((x, y)), heading)?;
        }
        Ok(())
    }

    fn entries(&self) -> Vec<LegendEntry> {
        let mut entries = vec![
            LegendEntry::Symbol(|root, at| draw_robot(root, at, 0.0), "start"),
            LegendEntry::Symbol(draw_goal, "goal"),
        ];
        let any = |is: fn(MapObstacleKind) -> bool| self.obstacles.iter().any(|solid| is(solid.kind));
        if any(|kind| kind == MapObstacleKind::Obstacle) {
            entries.push(LegendEntry::Symbol(|root, at| draw_block(root, at, SOLID, SOFT_INK), "obstacle"));
        }
        if any(|kind| kind == MapObstacleKind::Generated) {
            entries.push(LegendEntry::Symbol(
                |root, at| draw_block(root, at, REDRAWN, SOFT_INK),
                "obstacle of one episode",
            ));
        }
        if any(|kind| matches!(kind, MapObstacleKind::Moving(_))) {
            entries.push(LegendEntry::Symbol(
                |root, at| draw_block(root, at, MOVING, MOVING_EDGE),
                "moving obstacle",
            ));
        }
        entries
            .extend(self.trajectories.iter().map(|path| LegendEntry::Line(path.colour, path.name.clone())));
        entries
    }
}

/// A dot with a white rim, and where it looks.
fn draw_robot(root: &Area, (x, y): At, heading: f64) -> DrawResult {
    let nose = (x + (34.0 * heading.cos()).round() as i32, y - (34.0 * heading.sin()).round() as i32);
    line(root, vec![(x, y), nose], WHITE.stroke_width(STROKE + 6))?;
    root.draw(&Circle::new((x, y), 16, WHITE.filled()))?;
    line(root, vec![(x, y), nose], INK.stroke_width(STROKE + 1))?;
    root.draw(&Circle::new((x, y), 12, INK.filled()))?;
    Ok(())
}

fn draw_cross(root: &Area, (x, y): At) -> DrawResult {
    line(root, vec![(x - 9, y), (x + 9, y)], INK.stroke_width(STROKE))?;
    line(root, vec![(x, y - 9), (x, y + 9)], INK.stroke_width(STROKE))
}

/// The goal in the key.
fn draw_goal(root: &Area, (x, y): At) -> DrawResult {
    root.draw(&Circle::new((x, y), 16, GREEN.mix(0.25).filled()))?;
    root.draw(&Circle::new((x, y), 16, GREEN.stroke_width(HAIRLINE)))?;
    draw_cross(root, (x, y))
}

/// An obstacle in the key.
fn draw_block(root: &Area, (x, y): At, fill: RGBColor, edge: RGBColor) -> DrawResult {
    let corners = vec![(x - 16, y - 12), (x + 16, y - 12), (x + 16, y + 12), (x - 16, y + 12)];
    area(root, corners.clone(), fill.filled())?;
    line(root, closed(corners), edge.stroke_width(HAIRLINE))
}
