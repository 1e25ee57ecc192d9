//! The objects that can be dragged: which one is under the pointer, its outline, and where it may be put.

use bevy::math::{Vec2, vec2};
use egui::Pos2;

use super::silhouette::Silhouette;
use super::transform::ViewTransform;
use crate::app::interaction::DragTarget;
use crate::app::scene::{ArenaScene, Scene};
use crate::scenario::{enclosure_distance, inner_wall_distance, shape_distance};

/// What is under the pointer, with a little slack for small things: the robot before the goal before the obstacles. An
/// obstacle that was drawn for this episode alone can't be taken hold of: the world's file doesn't have it.
#[must_use]
pub fn hit_test(
    transform: &ViewTransform,
    scene: &Scene,
    arena: &ArenaScene,
    at: Pos2,
) -> Option<DragTarget> {
    let scenario = &*scene.scenario;
    let [x, y] = transform.to_world(at);
    let slack_m = 3.0 / transform.scale;
    let from = |px: f32, py: f32| (px - x).hypot(py - y);
    let least_m = 10.0 / transform.scale;
    if from(arena.pose.x_m, arena.pose.y_m) <= (scenario.robot.radius_m + slack_m).max(least_m) {
        return Some(DragTarget::Robot);
    }
    if from(arena.goal.x_m, arena.goal.y_m) <= (scenario.task.goal_radius_m + slack_m).max(least_m) {
        return Some(DragTarget::Goal);
    }
    let solids = scenario.obstacles.iter().zip(&arena.obstacles);
    let solids = solids.map(|(o, &pose)| shape_distance(&o.shape, pose, vec2(x, y)));
    let (index, away) = solids.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
    (away <= slack_m).then_some(DragTarget::Obstacle(index))
}

pub fn middle_of(drag_target: DragTarget, arena: &ArenaScene) -> Option<[f32; 2]> {
    match drag_target {
        DragTarget::Goal => Some([arena.goal.x_m, arena.goal.y_m]),
        DragTarget::Robot => Some([arena.pose.x_m, arena.pose.y_m]),
        DragTarget::Obstacle(index) => arena.obstacles.get(index).map(|pose| [pose.0, pose.1]),
    }
}

/// The outline of `drag_target` where it is, or with its middle at `to_m`.
#[must_use]
pub fn silhouette(arena: &ArenaScene, drag_target: DragTarget, to_m: Option<[f32; 2]>) -> Option<Silhouette> {
    let scenario = &*arena.scenario;
    let at_m = to_m.or_else(|| middle_of(drag_target, arena))?;
    match drag_target {
        DragTarget::Goal => Some(Silhouette::Disc { at_m, radius_m: scenario.task.goal_radius_m }),
        DragTarget::Robot => Some(Silhouette::Disc { at_m, radius_m: scenario.robot.radius_m }),
        DragTarget::Obstacle(index) => {
            let (obstacle, pose) = (scenario.obstacles.get(index)?, arena.obstacles.get(index)?);
            Some(Silhouette::Obstacle { shape: obstacle.shape.clone(), pose: (at_m[0], at_m[1], pose.2) })
        }
    }
}

/// Why `drag_target` cannot be put at `to_m`; none if it can.
pub fn rejection_at(arena: &ArenaScene, drag_target: DragTarget, to_m: [f32; 2]) -> Option<&'static str> {
    let scenario = &*arena.scenario;
    let inside_m = enclosure_distance(&scenario.enclosure, to_m.into());
    let guard_m = scenario.task.collision_range_m;
    let solid_m = || {
        let solids = scenario.obstacles.iter().zip(&arena.obstacles);
        solids.map(|(o, &pose)| shape_distance(&o.shape, pose, to_m.into())).fold(f32::INFINITY, f32::min)
    };
    let wall_m = || {
        let walls = scenario.walls.iter().map(|wall| inner_wall_distance(wall, to_m.into()));
        walls.fold(f32::INFINITY, f32::min)
    };
    match drag_target {
        _ if inside_m.is_nan() || inside_m <= 0.0 => Some("Outside the walls"),
        DragTarget::Goal if solid_m() <= 0.0 => Some("Inside an obstacle"),
        DragTarget::Goal if wall_m() <= 0.0 => Some("Inside a wall"),
        DragTarget::Robot if inside_m <= guard_m || wall_m() <= guard_m => Some("Too near the wall"),
        DragTarget::Robot if solid_m() <= guard_m => Some("Too near an obstacle"),
        DragTarget::Obstacle(index) => {
            let (obstacle, pose) = (scenario.obstacles.get(index)?, arena.obstacles.get(index)?);
            let gap_to = |x_m, y_m| shape_distance(&obstacle.shape, (to_m[0], to_m[1], pose.2), Vec2 { x: x_m, y: y_m });
            if gap_to(arena.pose.x_m, arena.pose.y_m) <= guard_m {
                Some("Too near the robot")
            } else if gap_to(arena.goal.x_m, arena.goal.y_m) <= 0.0 {
                Some("Over the goal")
            } else {
                None
            }
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use egui::{Rect, pos2};

    use super::super::transform::ArenaBounds;
    use super::*;
    use crate::app::scene::DriverLabel;
    use crate::app::view_state::ViewCamera;
    use crate::scenario::{Obstacle, ObstacleMotion, Scenario, Shape, Wall};
    use crate::task::{Goal, Pose};

    fn world() -> (ViewTransform, Scene) {
        let shape = Shape::Rectangle { width_m: 1.0, height_m: 0.2 };
        let turned = std::f32::consts::FRAC_PI_2;
        let obstacle =
            Obstacle { shape, position_m: vec2(1.0, 1.0), rotation_rad: turned, motion: ObstacleMotion::Static };
        let wall = Wall { corners_m: vec![vec2(-2.0, -1.5), vec2(0.0, -1.5)], thickness_m: 0.2 };
        let world = Scenario { obstacles: vec![obstacle], walls: vec![wall], ..Scenario::default() };
        let scenario = Arc::new(world);
        let pose = Pose { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
        let arena = ArenaScene {
            scenario: scenario.clone(),
            pose,
            goal: Goal { x_m: -1.0, y_m: 0.0 },
            obstacles: vec![(1.0, 1.0, turned)],
            ranges_m: vec![],
            scan_pose: pose,
            driver: DriverLabel::Learner,
            action: 0,
            explored: false,
            q_values: vec![],
            path_m: vec![],
            trails: vec![],
            collisions: 0,
            goals_reached: 0,
            inactive: false,
        };
        let view = Rect::from_min_size(pos2(0.0, 0.0), egui::vec2(400.0, 400.0));
        let transform = ViewTransform::new(
            view,
            egui::Vec2::ZERO,
            ViewCamera::default(),
            ArenaBounds::from_enclosure(&scenario.enclosure),
        );
        (transform, Scene { scenario, arenas: vec![arena], potential: None, value: None })
    }

    #[test]
    fn the_pointer_finds_what_is_under_it() {
        let (transform, scene) = world();
        for (point, drag_target) in [
            ([0.05, 0.05], Some(DragTarget::Robot)),
            ([-0.85, 0.0], Some(DragTarget::Goal)),
            ([1.05, 1.45], Some(DragTarget::Obstacle(0))),
            ([1.45, 1.05], None),
            ([0.3, 0.3], None),
        ] {
            assert_eq!(
                hit_test(&transform, &scene, &scene.arenas[0], transform.to_screen(point)),
                drag_target,
                "{point:?}"
            );
        }
    }

    #[test]
    fn nothing_is_put_into_an_obstacle_or_out_of_the_walls() {
        let (_, scene) = world();
        let may = |drag_target, to_m| rejection_at(&scene.arenas[0], drag_target, to_m).is_none();
        assert!(
            may(DragTarget::Goal, [1.2, 1.0])
                && !may(DragTarget::Goal, [1.0, 1.4])
                && !may(DragTarget::Goal, [2.1, 0.0])
        );
        assert!(
            may(DragTarget::Robot, [1.3, 1.0]) && !may(DragTarget::Robot, [1.2, 1.0]),
            "it would collide at once"
        );
        assert!(!may(DragTarget::Robot, [1.9, 0.0]) && !may(DragTarget::Robot, [f32::NAN, 0.0]));
        assert!(may(DragTarget::Obstacle(0), [0.5, 0.0]) && !may(DragTarget::Obstacle(0), [0.2, 0.0]));
        assert!(!may(DragTarget::Obstacle(0), [-1.0, 0.2]), "over the goal");
        assert!(
            !may(DragTarget::Goal, [-1.0, -1.45]) && may(DragTarget::Goal, [-1.0, -1.35]),
            "into the inner wall"
        );
        assert!(!may(DragTarget::Robot, [-1.0, -1.35]) && may(DragTarget::Robot, [-1.0, -1.25]));
    }

    #[test]
    fn what_was_drawn_for_an_episode_alone_stays() {
        let (transform, mut scene) = world();
        let at = transform.to_screen([1.0, 1.0]);
        assert_eq!(hit_test(&transform, &scene, &scene.arenas[0], at), Some(DragTarget::Obstacle(0)));
        scene.scenario = Arc::new(Scenario::default());
        assert_eq!(hit_test(&transform, &scene, &scene.arenas[0], at), None);
    }
}
