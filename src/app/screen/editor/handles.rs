//! The handles of the selected item on the screen: their positions, and which one is hit.

use egui::Pos2;

use crate::app::editor::{Body, Editor, Handle, HandleKind};
use crate::app::screen::arena_view::silhouette::Silhouette;
use crate::app::screen::arena_view::transform::ViewTransform;

/// Distance from the outline of the item to its rotation handle, in points.
pub const ROTATION_HANDLE: f32 = 26.0;
/// Minimum distance of a visible handle from the item's middle, and of a side's handle from a corner's, in points, so that small
/// items can be dragged.
const MIN_DISTANCE: f32 = 11.0;
/// Minimum distance of a visible insert handle from handles that are not insert handles, in points.
const MIN_SPACING: f32 = 17.0;
/// Extra distance of insert handles in a hit test, in points, so that existing points take precedence.
const INSERT_PENALTY: f32 = 3.0;

/// A handle on the screen.
#[derive(Clone, Debug, PartialEq)]
pub struct ScreenHandle {
    /// The handle.
    pub handle: Handle,
    /// The handle's centre on the screen.
    pub at: Pos2,
}

impl ScreenHandle {
    /// The part that the handle changes.
    pub fn kind(&self) -> HandleKind {
        self.handle.kind
    }
}

/// The visible handles of the selected item; later ones are drawn above earlier ones.
pub fn screen_handles(transform: &ViewTransform, editor: &Editor) -> Vec<ScreenHandle> {
    let positioned = editor.handles().into_iter().map(|handle| {
        let at = match handle.kind {
            HandleKind::Rotate => rotation_handle(transform, editor, &handle),
            _ => transform.to_screen(handle.position_m.into()),
        };
        ScreenHandle { handle, at }
    });
    let all: Vec<ScreenHandle> = positioned.filter(|handle| handle.at.is_finite()).collect();
    let dragged = editor.dragged();
    let is_visible = |handle: &&ScreenHandle| dragged == Some(handle.kind()) || has_space(handle, &all);
    all.iter().filter(is_visible).cloned().collect()
}

/// Whether a handle is far enough from the others.
fn has_space(handle: &ScreenHandle, all: &[ScreenHandle]) -> bool {
    let middle = all.iter().find(|other| other.kind() == HandleKind::Middle).map(|other| other.at);
    let is_outer = |handle: &ScreenHandle| middle.is_none_or(|at| at.distance(handle.at) >= MIN_DISTANCE);
    let is_near = |other: &ScreenHandle, min: f32| other.at.distance(handle.at) < min;
    match handle.kind() {
        HandleKind::InsertCorner(_) | HandleKind::InsertWaypoint(_) => {
            !all.iter().any(|other| !other.kind().is_insert() && is_near(other, MIN_SPACING))
        }
        // The middle of a short side, between two corners.
        HandleKind::Side(0, _) | HandleKind::Side(_, 0)
            if all.iter().any(|other| is_rectangle_corner(other.kind()) && is_near(other, MIN_DISTANCE)) =>
        {
            false
        }
        HandleKind::Side(..) | HandleKind::Radius | HandleKind::End(_) => is_outer(handle),
        // One corner may be near the middle; if all are, the item is small.
        HandleKind::Corner(_) => {
            all.iter().any(|other| matches!(other.kind(), HandleKind::Corner(_)) && is_outer(other))
        }
        _ => true,
    }
}

fn is_rectangle_corner(kind: HandleKind) -> bool {
    matches!(kind, HandleKind::Side(x, y) if x != 0 && y != 0)
}

/// The position of the rotation handle: at a fixed distance on the screen from the item, whatever the zoom.
fn rotation_handle(transform: &ViewTransform, editor: &Editor, handle: &Handle) -> Pos2 {
    let at = transform.to_screen(handle.position_m.into());
    let Some((centre_m, _)) = editor.rotation_of() else { return at };
    let centre = transform.to_screen(centre_m.into());
    let reach_m = match editor.selection().body(editor.scenario()) {
        Body::Obstacle(obstacle) => Silhouette::from_obstacle(&obstacle).reach_m(),
        _ => editor.scenario().robot.reach_m(),
    };
    let distance = transform.to_screen_length(reach_m).max(8.0) + ROTATION_HANDLE;
    centre + (at - centre).normalized() * distance
}

/// The point on the screen from which the size of the selected item is measured, if it has one.
pub fn center(transform: &ViewTransform, editor: &Editor) -> Option<Pos2> {
    let centre_m = match editor.selection().body(editor.scenario()) {
        Body::Obstacle(obstacle) => obstacle.position_m,
        Body::Outline(_) => {
            let (low, high) = editor.scenario().enclosure.bounds_m();
            low.midpoint(high)
        }
        Body::Region(region) => region.min_m.midpoint(region.max_m),
        _ => return None,
    };
    Some(transform.to_screen(centre_m.into()))
}

/// The nearest handle within `reach` points of `at`. At the start of a path, this is the handle that moves the obstacle with
/// its path; with `shift`, the one that moves the obstacle alone.
pub fn hit_test(handles: &[ScreenHandle], at: Pos2, reach: f32, shift: bool) -> Option<HandleKind> {
    let has_start = handles.iter().any(|handle| handle.kind() == HandleKind::PathStart);
    let hidden = if shift && has_start { HandleKind::Middle } else { HandleKind::PathStart };
    let distance = |handle: &ScreenHandle| {
        handle.at.distance(at) + if handle.kind().is_insert() { INSERT_PENALTY } else { 0.0 }
    };
    let hit = handles.iter().rev().filter(|handle| handle.kind() != hidden && distance(handle) <= reach);
    hit.min_by(|a, b| distance(a).total_cmp(&distance(b))).map(ScreenHandle::kind)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use bevy::math;
    use egui::{Rect, Vec2};

    use super::*;
    use crate::app::editor::Selection;
    use crate::app::screen::arena_view::transform::ArenaBounds;
    use crate::app::view_state::ViewCamera;
    use crate::scenario::{Obstacle, ObstacleMotion, Scenario, Shape};

    fn handle(kind: HandleKind, x: f32) -> ScreenHandle {
        let handle = Handle { kind, position_m: math::Vec2::ZERO, text: String::new(), about: "" };
        ScreenHandle { handle, at: Pos2::new(x, 0.0) }
    }

    #[test]
    fn the_nearest_handle_is_hit_and_existing_points_take_precedence() {
        let handles = [
            handle(HandleKind::InsertCorner(1), 6.0),
            handle(HandleKind::Corner(0), 0.0),
            handle(HandleKind::Corner(1), 40.0),
        ];
        let hit = |x: f32| super::hit_test(&handles, Pos2::new(x, 0.0), 9.0, false);
        assert_eq!(hit(1.0), Some(HandleKind::Corner(0)));
        assert_eq!(hit(4.0), Some(HandleKind::Corner(0)), "the insert handle is nearer, but the corner wins");
        assert_eq!(hit(7.0), Some(HandleKind::InsertCorner(1)));
        assert_eq!(hit(49.5), None);
    }

    #[test]
    fn a_small_box_shows_only_corner_handles_and_a_tiny_one_not_even_those() {
        let block = Obstacle {
            shape: Shape::Rectangle { width_m: 0.2, height_m: 0.2 },
            position_m: math::vec2(0.5, 0.5),
            rotation_rad: 0.0,
            motion: ObstacleMotion::Static,
        };
        let scenario = Scenario { obstacles: vec![block], ..Scenario::default() };
        let bounds = ArenaBounds::from_enclosure(&scenario.enclosure);
        let mut editor = Editor::open(Arc::new(scenario), "mine.ron".into(), true);
        editor.select(Selection::Obstacle(0));
        // The enclosure is 4 m wide; the box measures 30, 18 or 8 points.
        for (side, shown) in [(600.0, 8), (360.0, 4), (160.0, 0)] {
            let view = Rect::from_min_size(Pos2::ZERO, Vec2::splat(side));
            let transform = ViewTransform::new(view, Vec2::ZERO, ViewCamera::default(), bounds);
            let all = screen_handles(&transform, &editor);
            let sides = all.iter().filter(|handle| matches!(handle.kind(), HandleKind::Side(..)));
            assert_eq!(sides.count(), shown, "{side}");
            assert!(all.iter().any(|handle| handle.kind() == HandleKind::Middle), "it can be moved");
        }
    }

    #[test]
    fn shift_at_the_start_of_a_path_hits_the_obstacle_alone() {
        let handles = [handle(HandleKind::PathStart, 0.0), handle(HandleKind::Middle, 0.0)];
        let hit = |shift| super::hit_test(&handles, Pos2::new(0.0, 0.0), 9.0, shift);
        assert_eq!([hit(false), hit(true)], [Some(HandleKind::Middle), Some(HandleKind::PathStart)]);
        assert_eq!(super::hit_test(&handles[1..], Pos2::new(0.0, 0.0), 9.0, true), Some(HandleKind::Middle));
    }
}
