//! Limits and default values of the editor.

use super::points::to_mm;
use crate::scenario::limits::ENCLOSURE_SIDE_M;
pub(super) use crate::scenario::limits::{
    ENCLOSURE_CORNERS, MAX_SPEED_M_S, POLYGON_CORNERS, WALL_CORNERS, WAYPOINTS,
};
use crate::scenario::{Obstacle, ObstacleMotion, Scenario, Wall};

/// Maximum number of points of a path, and of positions of a start or goal rule.
pub(super) const MAX_POINTS: usize = *WAYPOINTS.end();

/// Smallest size that a drag leaves, in m.
pub(super) const MIN_SIZE_M: f32 = 0.01;
/// Smallest width and height of an enclosure, in m.
pub(super) const MIN_ENCLOSURE_M: f32 = *ENCLOSURE_SIDE_M.start();

/// Thickness of a new wall, in m.
pub(super) const NEW_WALL_THICKNESS_M: f32 = 0.1;
/// Speed of an obstacle on a new path, in m/s.
pub(super) const NEW_SPEED_M_S: f32 = 0.1;
/// Angular velocity of a new orbit, in rad/s; about that of the paper's Scenario II.
pub(super) const NEW_ORBIT_SPEED_RAD_S: f32 = 0.15;
/// Clearance of a new start or goal rule, in m; the schema's default.
const NEW_CLEARANCE_M: f32 = 0.35;
/// The same for a large robot, beyond [`Scenario::keep_out_m`].
const NEW_MARGIN_M: f32 = 0.02;

/// Scenarios with more items than this are not checked during a drag, only at its end.
pub(super) const MAX_ITEMS_CHECKED_WHILE_DRAGGING: usize = 1_000;
/// Maximum number of undo steps.
pub(super) const MAX_UNDO_STEPS: usize = 500;
/// Maximum total number of items in the undo snapshots. Beyond it, old steps are dropped, down to a minimum number of steps:
/// very large scenarios have fewer undo steps.
pub(super) const MAX_SNAPSHOT_ITEMS: usize = 1_000_000;

/// Clearance of a new start or goal rule, in m, with room for the robot.
pub(super) fn new_clearance_m(scenario: &Scenario) -> f32 {
    NEW_CLEARANCE_M.max(to_mm(scenario.keep_out_m() + NEW_MARGIN_M))
}

/// Number of obstacles, wall corners, rows and rectangles of cells, and key frames in a scenario.
pub(super) fn item_count(scenario: &Scenario) -> usize {
    let cells = |wall: &Wall| wall.cells.as_ref().map_or(0, |cells| cells.rows().len()) + wall.piece_count();
    let corners = scenario.walls.iter().map(|wall| wall.corners_m.len().max(cells(wall))).sum::<usize>();
    let frames = |obstacle: &Obstacle| match &obstacle.motion {
        ObstacleMotion::KeyFrames { frames, .. } => frames.len(),
        _ => 0,
    };
    scenario.obstacles.len() + scenario.obstacles.iter().map(frames).sum::<usize>() + corners
}
