//! The symbols of a map: robot, goal and obstacles, with their legend.

use plotters::prelude::*;

use super::model::{MapObstacleKind, ScenarioMap};
use super::tracks::draw_dots;
use crate::style::{
    Canvas, DrawResult, GREEN, HAIRLINE, INK, LegendEntry, Pixel, SOFT_INK, STROKE, Symbol, area, line,
};

const STATIC: RGBColor = RGBColor(190, 190, 190);
const GENERATED: RGBColor = RGBColor(232, 232, 232);
const MOVING: RGBColor = RGBColor(242, 207, 150);
const MOVING_EDGE: RGBColor = RGBColor(138, 92, 8);

/// The colour of marked areas, through which obstacles can be seen.
pub(super) fn marked_colour() -> RGBAColor {
    RGBColor(214, 108, 30).mix(0.4)
}

/// The fill and the edge colour of an obstacle.
pub(super) fn obstacle_colours(kind: MapObstacleKind) -> (RGBColor, RGBColor) {
    match kind {
        MapObstacleKind::Wall => (INK, INK),
        MapObstacleKind::Obstacle => (STATIC, SOFT_INK),
        MapObstacleKind::Generated => (GENERATED, SOFT_INK),
        MapObstacleKind::Moving(_) => (MOVING, MOVING_EDGE),
    }
}

/// Whether an obstacle is of some kind.
type IsKind = fn(MapObstacleKind) -> bool;

/// The legend's entries: start, goal, the kinds of obstacles on the map, and the trajectories.
pub(super) fn legend_entries(map: &ScenarioMap) -> Vec<LegendEntry> {
    let mut entries = Vec::new();
    if map.start.is_some() {
        entries.push(LegendEntry::Symbol(|root, at| draw_robot(root, at, 0.0), "start".into()));
    }
    if map.goal.is_some() {
        entries.push(LegendEntry::Symbol(draw_goal, "goal".into()));
    }
    let kinds: [(IsKind, Symbol, &str); 4] = [
        (
            |kind| kind == MapObstacleKind::Wall,
            |root, at| draw_block(root, at, MapObstacleKind::Wall),
            "wall",
        ),
        (
            |kind| kind == MapObstacleKind::Obstacle,
            |root, at| draw_block(root, at, MapObstacleKind::Obstacle),
            "obstacle",
        ),
        (
            |kind| kind == MapObstacleKind::Generated,
            |root, at| draw_block(root, at, MapObstacleKind::Generated),
            "generated obstacle",
        ),
        (|kind| matches!(kind, MapObstacleKind::Moving(_)), draw_moving, "moving obstacle on its path"),
    ];
    for (is_kind, symbol, name) in kinds {
        if map.obstacles.iter().any(|obstacle| is_kind(obstacle.kind)) {
            entries.push(LegendEntry::Symbol(symbol, name.into()));
        }
    }
    if !map.marked_areas.is_empty() {
        entries.push(LegendEntry::Symbol(draw_marked, "occupied in the map".into()));
    }
    entries.extend(map.trajectories.iter().map(|path| LegendEntry::Line(path.colour, path.name.clone())));
    entries
}

/// Draws the robot: a dot with a white rim, and a line in the direction of `heading`, in rad.
pub(super) fn draw_robot(root: &Canvas, (x, y): Pixel, heading: f64) -> DrawResult {
    let nose = (x + (34.0 * heading.cos()).round() as i32, y - (34.0 * heading.sin()).round() as i32);
    line(root, vec![(x, y), nose], WHITE.stroke_width(STROKE + 6))?;
    root.draw(&Circle::new((x, y), 16, WHITE.filled()))?;
    line(root, vec![(x, y), nose], INK.stroke_width(STROKE + 1))?;
    root.draw(&Circle::new((x, y), 12, INK.filled()))?;
    Ok(())
}

/// Draws the cross at the goal's centre.
pub(super) fn draw_cross(root: &Canvas, (x, y): Pixel) -> DrawResult {
    line(root, vec![(x - 9, y), (x + 9, y)], INK.stroke_width(STROKE))?;
    line(root, vec![(x, y - 9), (x, y + 9)], INK.stroke_width(STROKE))
}

/// Draws a moving obstacle in the legend.
fn draw_moving(root: &Canvas, (x, y): Pixel) -> DrawResult {
    draw_dots(root, &[(x - 30, y), (x + 30, y)])?;
    draw_block(root, (x, y), MapObstacleKind::Moving(0.0))
}

/// Draws a marked area in the legend.
fn draw_marked(root: &Canvas, (x, y): Pixel) -> DrawResult {
    let corners = vec![(x - 16, y - 12), (x + 16, y - 12), (x + 16, y + 12), (x - 16, y + 12)];
    area(root, corners, marked_colour().filled())
}

/// Draws the goal in the legend.
fn draw_goal(root: &Canvas, (x, y): Pixel) -> DrawResult {
    root.draw(&Circle::new((x, y), 16, GREEN.mix(0.25).filled()))?;
    root.draw(&Circle::new((x, y), 16, GREEN.stroke_width(HAIRLINE)))?;
    draw_cross(root, (x, y))
}

/// Draws an obstacle in the legend.
fn draw_block(root: &Canvas, (x, y): Pixel, kind: MapObstacleKind) -> DrawResult {
    let (fill, edge) = obstacle_colours(kind);
    let corners = [(x - 16, y - 12), (x + 16, y - 12), (x + 16, y + 12), (x - 16, y + 12), (x - 16, y - 12)];
    area(root, corners[..4].to_vec(), fill.filled())?;
    line(root, corners.to_vec(), edge.stroke_width(HAIRLINE))
}
