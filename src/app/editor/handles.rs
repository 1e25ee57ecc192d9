//! Handles: what can be dragged of the thing that is selected, and what dragging it does.
//!
//! In: a scenario, the selection. Out: the [`Handle`]s; a scenario in which one of them was dragged, put in or taken
//! out. Where a handle goes is worked from the scenario at the drag's beginning, so that nothing adds up meanwhile.

use super::selection::Selection;
use super::snap::Snap;
use super::{body, corners, obstacle_path, rectangles, start_goal_handles};
use crate::scenario::{Enclosure, PlacementRule, Scenario};
use bevy::math::Vec2;

/// What a handle changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HandleKind {
    /// The whole thing, with its path or the centre of its orbit.
    Middle,
    /// A side or a corner of a rectangle, in its own frame: (1, 0) the right side, (-1, 1) the upper left corner. What
    /// is opposite stays; of the enclosure, the middle.
    Side(i8, i8),
    /// A radius.
    Radius,
    /// An end of a capsule, in its own frame the right one (true) or the left; the other stays.
    CapsuleEnd(bool),
    /// A corner of a polygon or of a wall.
    Corner(usize),
    /// A new corner before corner k.
    InsertCorner(usize),
    /// The rotation, or a start's heading.
    Rotate,
    /// The obstacle alone, where its path begins; the path's other corners stay.
    PathStart,
    /// A further corner of its path.
    Waypoint(usize),
    /// A new waypoint before waypoint k.
    InsertWaypoint(usize),
    /// The centre of its orbit.
    OrbitCentre,
    /// How far a random walk goes.
    WalkReach,
    /// One of a rule's places.
    Place(usize),
}

impl HandleKind {
    /// Whether it makes something new.
    #[must_use]
    pub fn is_insert(self) -> bool {
        matches!(self, Self::InsertCorner(_) | Self::InsertWaypoint(_))
    }
}

/// Something to take hold of.
#[derive(Clone, Debug, PartialEq)]
pub struct Handle {
    /// What it changes.
    pub kind: HandleKind,
    /// Where it is, in m.
    pub position_m: Vec2,
    /// The number that it changes, as it is now.
    pub text: String,
    /// What it does, in a few words.
    pub about: &'static str,
}

impl Handle {
    pub(super) fn new(kind: HandleKind, position_m: Vec2, text: String, about: &'static str) -> Self {
        Self { kind, position_m, text, about }
    }
}

/// Those of what is selected; later ones lie on top.
pub(super) fn of(scenario: &Scenario, selection: Selection) -> Vec<Handle> {
    match selection {
        Selection::Nothing => Vec::new(),
        Selection::Enclosure => match &scenario.enclosure {
            Enclosure::Rectangle { width_m, height_m } => rectangles::of_enclosure(*width_m, *height_m),
            Enclosure::Polygon { corners_m } => corners::handles(corners_m, true, corners::ENCLOSURE.1),
        },
        Selection::Obstacle(k) => scenario.obstacles.get(k).map_or_else(Vec::new, |obstacle| {
            let mut all = obstacle_path::handles(obstacle);
            all.extend(body::handles(obstacle));
            all
        }),
        Selection::Wall(k) => {
            let of = |wall: &crate::scenario::Wall| corners::handles(&wall.corners_m, false, corners::WALL.1);
            scenario.walls.get(k).map_or_else(Vec::new, of)
        }
        Selection::Generator(k) => {
            let region = scenario.generators.get(k).and_then(|generator| generator.within);
            region.map_or_else(Vec::new, rectangles::of_region)
        }
        Selection::Starts => start_goal_handles::of_rule(&scenario.starts),
        Selection::Goals => start_goal_handles::of_rule(&scenario.goals),
        Selection::BenchmarkStart | Selection::BenchmarkGoal => {
            start_goal_handles::of_benchmark_route(&scenario.benchmark_route, selection)
        }
    }
}

/// Where a handle of this kind is; a middle also of what shows none.
pub(super) fn place(scenario: &Scenario, selection: Selection, kind: HandleKind) -> Option<Vec2> {
    if kind == HandleKind::Middle
        && let Selection::Wall(k) = selection
    {
        return scenario.walls.get(k)?.corners_m.first().copied();
    }
    of(scenario, selection).into_iter().find(|handle| handle.kind == kind).map(|handle| handle.position_m)
}

/// Puts the handle at `to`, or where it snaps to near there.
pub(super) fn drag(
    scenario: &mut Scenario,
    selection: Selection,
    kind: HandleKind,
    to: Vec2,
    snap: Snap,
) -> Option<()> {
    let centre = middle_of(scenario);
    let snapped = snap.point(to, centre);
    match selection {
        Selection::Nothing => None,
        Selection::Enclosure => match (&mut scenario.enclosure, kind) {
            (Enclosure::Rectangle { width_m, height_m }, HandleKind::Side(x, y)) => {
                rectangles::drag_enclosure((width_m, height_m), (x, y), to, snap);
                Some(())
            }
            (Enclosure::Polygon { corners_m }, HandleKind::Corner(k)) => {
                *corners_m.get_mut(k)? = snapped;
                Some(())
            }
            _ => None,
        },
        Selection::Obstacle(k) => {
            let obstacle = scenario.obstacles.get_mut(k)?;
            body::drag(obstacle, kind, to, snapped, snap)
                .or_else(|| obstacle_path::drag(obstacle, kind, to, snapped, snap))
        }
        Selection::Wall(k) => corners::drag(&mut scenario.walls.get_mut(k)?.corners_m, kind, snapped),
        Selection::Generator(k) => {
            let region = scenario.generators.get_mut(k)?.within.as_mut()?;
            rectangles::drag_region((&mut region.min_m, &mut region.max_m), kind, to, snap, centre)
        }
        Selection::Starts => start_goal_handles::drag_rule(&mut scenario.starts, kind, to, snap, centre),
        Selection::Goals => start_goal_handles::drag_rule(&mut scenario.goals, kind, to, snap, centre),
        Selection::BenchmarkStart | Selection::BenchmarkGoal => {
            start_goal_handles::drag_benchmark_route(&mut scenario.benchmark_route, selection, kind, snapped)
        }
    }
}

/// What turns about what, and how it is turned.
pub(super) fn rotation_of(scenario: &Scenario, selection: Selection) -> Option<(Vec2, f32)> {
    match selection {
        Selection::Obstacle(k) => {
            let obstacle = scenario.obstacles.get(k)?;
            body::turns(&obstacle.shape).then_some((obstacle.position_m, obstacle.rotation_rad))
        }
        Selection::Starts => match scenario.starts {
            PlacementRule::Fixed { position_m, heading_rad: Some(heading) } => Some((position_m, heading)),
            _ => None,
        },
        Selection::BenchmarkStart => {
            Some((scenario.benchmark_route.start_m, scenario.benchmark_route.heading_rad))
        }
        _ => None,
    }
}

/// Turns what [`rotation_of`] tells of.
pub(super) fn turn(scenario: &mut Scenario, selection: Selection, angle_rad: f32) -> Option<()> {
    match selection {
        Selection::Obstacle(k) => scenario.obstacles.get_mut(k)?.rotation_rad = angle_rad,
        Selection::Starts => match &mut scenario.starts {
            PlacementRule::Fixed { heading_rad, .. } => *heading_rad = Some(angle_rad),
            _ => return None,
        },
        Selection::BenchmarkStart => scenario.benchmark_route.heading_rad = angle_rad,
        _ => return None,
    }
    Some(())
}

/// Makes what an inserting handle stands for; answers with the handle of it.
pub(super) fn insert(
    scenario: &mut Scenario,
    selection: Selection,
    kind: HandleKind,
    at: Vec2,
) -> Option<HandleKind> {
    let at = super::points::point_to_mm(at);
    match (selection, kind) {
        (Selection::Enclosure, HandleKind::InsertCorner(k)) => match &mut scenario.enclosure {
            Enclosure::Polygon { corners_m } => corners::insert(corners_m, k, at),
            Enclosure::Rectangle { .. } => None,
        },
        (Selection::Wall(wall), HandleKind::InsertCorner(k)) => {
            corners::insert(&mut scenario.walls.get_mut(wall)?.corners_m, k, at)
        }
        (Selection::Obstacle(obstacle), _) => {
            let obstacle = scenario.obstacles.get_mut(obstacle)?;
            body::insert(obstacle, kind, at).or_else(|| obstacle_path::insert(obstacle, kind, at))
        }
        _ => None,
    }
}

/// Takes out the corner, waypoint or place that a handle is of; none if too few would be left.
pub(super) fn remove(scenario: &mut Scenario, selection: Selection, kind: HandleKind) -> Option<()> {
    match (selection, kind) {
        (Selection::Enclosure, HandleKind::Corner(k)) => match &mut scenario.enclosure {
            Enclosure::Polygon { corners_m } => corners::remove(corners_m, k, corners::ENCLOSURE.0),
            Enclosure::Rectangle { .. } => None,
        },
        (Selection::Wall(wall), HandleKind::Corner(k)) => {
            corners::remove(&mut scenario.walls.get_mut(wall)?.corners_m, k, corners::WALL.0)
        }
        (Selection::Obstacle(obstacle), _) => {
            let obstacle = scenario.obstacles.get_mut(obstacle)?;
            body::remove(obstacle, kind).or_else(|| obstacle_path::remove(obstacle, kind))
        }
        (Selection::Starts, HandleKind::Place(k)) => start_goal_handles::remove(&mut scenario.starts, k),
        (Selection::Goals, HandleKind::Place(k)) => start_goal_handles::remove(&mut scenario.goals, k),
        _ => None,
    }
}

/// Moves the whole of what is selected.
pub(super) fn shift(scenario: &mut Scenario, selection: Selection, by: Vec2) -> Option<()> {
    match selection {
        Selection::Nothing | Selection::Enclosure => return None,
        Selection::Obstacle(k) => obstacle_path::shift(scenario.obstacles.get_mut(k)?, by),
        Selection::Wall(k) => corners::shift(&mut scenario.walls.get_mut(k)?.corners_m, by),
        Selection::Generator(k) => {
            let region = scenario.generators.get_mut(k)?.within.as_mut()?;
            corners::shift([&mut region.min_m, &mut region.max_m], by);
        }
        Selection::Starts => corners::shift(start_goal_handles::points(&mut scenario.starts), by),
        Selection::Goals => corners::shift(start_goal_handles::points(&mut scenario.goals), by),
        Selection::BenchmarkStart => corners::shift([&mut scenario.benchmark_route.start_m], by),
        Selection::BenchmarkGoal => corners::shift([&mut scenario.benchmark_route.goal_m], by),
    }
    Some(())
}

/// The middle of the world.
pub(super) fn middle_of(scenario: &Scenario) -> Vec2 {
    let (low, high) = scenario.enclosure.bounds_m();
    super::points::middle(low, high)
}
