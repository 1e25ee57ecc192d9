//! The walls and obstacles around a floor.
//!
//! In: the floor's cells. Out: walls and obstacles that leave the floor free, in m. Holes that are convex within the tolerance
//! become solid polygons, other outlines become thin walls, and the space behind those walls is filled with rectangles, so that
//! no start or goal can be placed there. With a tolerance below half a wall's thickness, rectangles cover the exact cells.

use glam::{DVec2, dvec2};
use wayfield_scenario::limits::{POLYGON_CORNERS, WALL_CORNERS};
use wayfield_scenario::{Obstacle, ObstacleMotion, Shape, Wall};

use crate::contour::{convex_hull, deviation, rings, simplified};
use crate::grid::{Cell, Grid};
use crate::limits::MAX_RING_CORNERS;
use crate::rectangles::{rectangles, whole_blocks};
use crate::round::point;

/// Thickness of the walls that replace outlines, in m.
pub const THICKNESS_M: f64 = 0.02;

/// What surrounds a floor, in the scenario's frame.
#[derive(Clone, Debug, Default)]
pub struct Surroundings {
    /// Walls along outlines.
    pub walls: Vec<Wall>,
    /// Solid obstacles.
    pub obstacles: Vec<Obstacle>,
    /// The largest distance between an outline of the floor and the wall or obstacle that replaces it, in m.
    pub deviation_m: f64,
}

/// The position and scale of a grid of cells.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// Side of a cell in m.
    pub cell_m: f64,
    /// The point, in cells, that becomes (0, 0).
    pub centre: DVec2,
}

impl Scale {
    /// Converts a point of the grid from cells to m.
    pub fn point_m(self, cells: DVec2) -> DVec2 {
        (cells - self.centre) * self.cell_m
    }

    fn rectangle(self, ((left, low), (right, high)): (Cell, Cell)) -> Obstacle {
        let corner = |column: usize, row: usize| self.point_m(dvec2(column as f64, row as f64));
        let (from, to) = (corner(left, low), corner(right, high));
        rectangle(from, to)
    }
}

/// The obstacle that covers a box with sides along x and y.
pub fn rectangle(from: DVec2, to: DVec2) -> Obstacle {
    let size = point(to - from);
    Obstacle {
        shape: Shape::Rectangle { width_m: size.x, height_m: size.y },
        position_m: point((from + to) / 2.0),
        rotation_rad: 0.0,
        motion: ObstacleMotion::Static,
    }
}

/// The rectangles that cover the cells of a set.
pub fn covered(set: &Grid<bool>, scale: Scale) -> Vec<Obstacle> {
    rectangles(set).into_iter().map(|found| scale.rectangle(found)).collect()
}

/// Rectangles in the set, such that no point of it is farther than `clearance_m` from its border or from a rectangle. They
/// can be coarse, because the LIDAR never sees them.
pub fn filled(set: &Grid<bool>, scale: Scale, clearance_m: f64) -> Vec<Obstacle> {
    // The diagonal of a block is shorter than the clearance.
    let side = (0.65 * clearance_m / scale.cell_m).floor().max(1.0) as usize;
    covered(&whole_blocks(set, side), scale)
}

/// The walls and obstacles around `floor`. They deviate from its outlines by up to `tolerance_m`, and no point behind them has a
/// clearance of `clearance_m`.
///
/// # Errors
/// An outline has too many corners.
pub fn surroundings(
    floor: &Grid<bool>,
    scale: Scale,
    tolerance_m: f64,
    clearance_m: f64,
) -> Result<Surroundings, String> {
    let Some(bounds) = floor.bounds() else { return Ok(Surroundings::default()) };
    let inside = |(column, row): Cell| {
        let ((left, low), (right, high)) = bounds;
        (left..right).contains(&column) && (low..high).contains(&row)
    };
    let mut blocked = floor.map(|is_floor| !is_floor);
    blocked.cells().filter(|&cell| !inside(cell)).for_each(|cell| blocked.set(cell, false));
    if tolerance_m < THICKNESS_M / 2.0 {
        return Ok(Surroundings { obstacles: covered(&blocked, scale), ..Surroundings::default() });
    }
    let mut found = Surroundings::default();
    for ring in rings(floor) {
        if ring.len() > MAX_RING_CORNERS {
            return Err(format!("an outline has {} corners, more than {MAX_RING_CORNERS}", ring.len()));
        }
        found.add(&ring, scale, tolerance_m, &mut blocked, bounds);
    }
    // Fills only cells that are farther from the floor than any part of a wall can be.
    let margin = (tolerance_m + THICKNESS_M) / scale.cell_m + 0.5;
    let squared_distances = floor.squared_distances(false);
    let deep = |cell: Cell| f64::from(squared_distances.at(cell)) > margin * margin;
    blocked.cells().for_each(|cell| blocked.set(cell, blocked.at(cell) && deep(cell)));
    found.obstacles.extend(filled(&blocked, scale, clearance_m - tolerance_m - THICKNESS_M - scale.cell_m));
    Ok(found)
}

impl Surroundings {
    /// Adds the walls or the polygon that replace a ring, and removes the cells in the polygon from `blocked`. A ring along the
    /// sides of `bounds` needs no walls, because these sides are the enclosure.
    fn add(
        &mut self,
        ring: &[DVec2],
        scale: Scale,
        tolerance_m: f64,
        blocked: &mut Grid<bool>,
        bounds: (Cell, Cell),
    ) {
        let tolerance = tolerance_m / scale.cell_m;
        let (hull, _) = simplified(&convex_hull(ring), tolerance / 2.0);
        let from_hull = deviation(ring, &hull).max(deviation(&hull, ring));
        if !is_counterclockwise(ring)
            && from_hull <= tolerance
            && hull.len() <= *POLYGON_CORNERS.end()
            && hull.len() > 2
        {
            self.deviation_m = self.deviation_m.max(from_hull * scale.cell_m);
            self.obstacles.push(obstacle(&hull, scale));
            remove_inside(blocked, ring);
            return;
        }
        // Half of the wall's thickness lies on the floor.
        let (corners, deviation) = simplified(ring, tolerance - THICKNESS_M / 2.0 / scale.cell_m);
        let ((left, low), (right, high)) = bounds;
        let floor = (dvec2(left as f64, low as f64), dvec2(right as f64, high as f64));
        if as_box(&corners) == Some(floor) {
            self.deviation_m = self.deviation_m.max(deviation * scale.cell_m);
            return;
        }
        self.deviation_m = self.deviation_m.max(deviation * scale.cell_m + THICKNESS_M / 2.0);
        let closed = corners.iter().chain(corners.first().filter(|_| corners.len() > 2));
        let corners_m: Vec<_> = closed.map(|&corner| point(scale.point_m(corner))).collect();
        let mut from = 0;
        while from + 1 < corners_m.len() {
            let to = (from + WALL_CORNERS.end()).min(corners_m.len());
            self.walls.push(Wall {
                corners_m: corners_m[from..to].to_vec(),
                thickness_m: THICKNESS_M as f32,
                ..Wall::default()
            });
            from = to - 1;
        }
    }
}

fn is_counterclockwise(ring: &[DVec2]) -> bool {
    let ends = ring.iter().zip(ring.iter().cycle().skip(1));
    ends.map(|(a, b)| a.perp_dot(*b)).sum::<f64>() > 0.0
}

/// The lower left and upper right corners, if the corners are those of a box with sides along x and y.
fn as_box(corners: &[DVec2]) -> Option<(DVec2, DVec2)> {
    let (from, to) = corners.iter().fold((DVec2::MAX, DVec2::MIN), |(from, to), &c| (from.min(c), to.max(c)));
    let is_corner = |c: &DVec2| (c.x == from.x || c.x == to.x) && (c.y == from.y || c.y == to.y);
    (corners.len() == 4 && corners.iter().all(is_corner)).then_some((from, to))
}

/// The obstacle with these corners: a rectangle if its sides are along x and y, else a polygon. Its position is the mean of the
/// corners.
fn obstacle(corners: &[DVec2], scale: Scale) -> Obstacle {
    if let Some((from, to)) = as_box(corners) {
        return rectangle(scale.point_m(from), scale.point_m(to));
    }
    let middle = corners.iter().copied().sum::<DVec2>() / corners.len() as f64;
    let position_m = point(scale.point_m(middle));
    let own = |&corner: &DVec2| point(scale.point_m(corner) - position_m.as_dvec2());
    Obstacle {
        shape: Shape::Polygon { corners_m: corners.iter().map(own).collect() },
        position_m,
        rotation_rad: 0.0,
        motion: ObstacleMotion::Static,
    }
}

/// Removes from the set the cells inside a ring.
fn remove_inside(set: &mut Grid<bool>, ring: &[DVec2]) {
    let (low, high) = ring.iter().fold((DVec2::MAX, DVec2::MIN), |(low, high), &c| (low.min(c), high.max(c)));
    for row in low.y as usize..high.y as usize {
        let y = row as f64 + 0.5;
        let ends = ring.iter().zip(ring.iter().cycle().skip(1));
        let sides: Vec<f64> = ends.filter(|(a, b)| (a.y > y) != (b.y > y)).map(|(a, _)| a.x).collect();
        for column in low.x as usize..high.x as usize {
            let x = column as f64 + 0.5;
            let crossings = sides.iter().filter(|&&side| side > x).count();
            if crossings % 2 == 1 {
                set.set((column, row), false);
            }
        }
    }
}
