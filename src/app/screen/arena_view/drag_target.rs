//! The objects that can be dragged: which one is under the pointer, its outline, and what decides where it
//! may go.

use bevy::math::vec2;
use egui::Pos2;

use super::silhouette::Silhouette;
use super::transform::ViewTransform;
use crate::app::moves::{Movable, MoveContext};
use crate::app::scene::ArenaScene;
use crate::scenario::shape_distance;

/// The object under the pointer, with some tolerance for small ones: the robot first, then the goal, then the
/// obstacles. Generated obstacles are left out, because they are not in the scenario's file. All obstacles are left out if the
/// arena's scenario belongs to a set.
#[must_use]
pub fn hit_test(transform: &ViewTransform, arena: &ArenaScene, at: Pos2) -> Option<Movable> {
    let scenario = &*arena.written;
    let [x, y] = transform.to_world(at);
    let slack_m = 3.0 / transform.scale;
    let distance_to = |px: f32, py: f32| (px - x).hypot(py - y);
    let min_radius_m = 10.0 / transform.scale;
    if distance_to(arena.pose.x_m, arena.pose.y_m) <= (scenario.robot.reach_m() + slack_m).max(min_radius_m) {
        return Some(Movable::Robot);
    }
    if distance_to(arena.goal.x_m, arena.goal.y_m)
        <= (scenario.task.goal_radius_m + slack_m).max(min_radius_m)
    {
        return Some(Movable::Goal);
    }
    if arena.set_member.is_some() {
        return None;
    }
    let obstacles = scenario.obstacles.iter().zip(&arena.obstacles);
    let distances = obstacles.map(|(o, &pose)| shape_distance(&o.shape, pose, vec2(x, y)));
    let (index, distance_m) = distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
    (distance_m <= slack_m).then_some(Movable::Obstacle(index))
}

/// The centre of `object`, in m; `None` if there is no such obstacle.
pub fn centre_of(object: Movable, arena: &ArenaScene) -> Option<[f32; 2]> {
    match object {
        Movable::Goal => Some([arena.goal.x_m, arena.goal.y_m]),
        Movable::Robot => Some([arena.pose.x_m, arena.pose.y_m]),
        Movable::Obstacle(index) => arena.obstacles.get(index).map(|pose| [pose.0, pose.1]),
    }
}

/// The outline of `object` where it is, or with its centre at `to_m`.
#[must_use]
pub fn silhouette(arena: &ArenaScene, object: Movable, to_m: Option<[f32; 2]>) -> Option<Silhouette> {
    let scenario = &*arena.scenario;
    let at_m = to_m.or_else(|| centre_of(object, arena))?;
    match object {
        Movable::Goal => Some(Silhouette::Disc { at_m, radius_m: scenario.task.goal_radius_m }),
        Movable::Robot => {
            let pose = (at_m[0], at_m[1], arena.pose.heading_rad);
            Some(Silhouette::Obstacle { shape: scenario.robot.body(), pose })
        }
        Movable::Obstacle(index) => {
            let (obstacle, pose) = (scenario.obstacles.get(index)?, arena.obstacles.get(index)?);
            Some(Silhouette::Obstacle { shape: obstacle.shape.clone(), pose: (at_m[0], at_m[1], pose.2) })
        }
    }
}

/// The parts of `arena` that decide where an object may go.
pub fn move_context(arena: &ArenaScene) -> MoveContext<'_> {
    MoveContext {
        scenario: &arena.written,
        layout: &arena.scenario,
        obstacles: &arena.obstacles,
        robot_m: vec2(arena.pose.x_m, arena.pose.y_m),
        goal_m: vec2(arena.goal.x_m, arena.goal.y_m),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use egui::{Rect, pos2};

    use super::super::transform::ArenaBounds;
    use super::*;
    use crate::app::scene::{DriverLabel, Scene, Score};
    use crate::app::view_state::ViewCamera;
    use crate::scenario::{Obstacle, ObstacleMotion, Scenario, Shape, Wall};
    use crate::task::{Goal, Pose};

    fn scene() -> (ViewTransform, Scene) {
        let shape = Shape::Rectangle { width_m: 1.0, height_m: 0.2 };
        let quarter_turn = std::f32::consts::FRAC_PI_2;
        let obstacle = Obstacle {
            shape,
            position_m: vec2(1.0, 1.0),
            rotation_rad: quarter_turn,
            motion: ObstacleMotion::Static,
        };
        let wall =
            Wall { corners_m: vec![vec2(-2.0, -1.5), vec2(0.0, -1.5)], thickness_m: 0.2, ..Wall::default() };
        let scenario = Scenario { obstacles: vec![obstacle], walls: vec![wall], ..Scenario::default() };
        let scenario = Arc::new(scenario);
        let pose = Pose { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
        let arena = ArenaScene {
            scenario: scenario.clone(),
            written: scenario.clone(),
            set_member: None,
            pose,
            goal: Goal { x_m: -1.0, y_m: 0.0 },
            obstacles: vec![(1.0, 1.0, quarter_turn)],
            ranges_m: vec![],
            scan_pose: pose,
            driver: DriverLabel::Learner,
            motions: vec![],
            action: 0,
            explored: false,
            q_values: vec![],
            plan: None,
            path_m: vec![],
            trails: vec![],
            score: Score::default(),
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
    fn the_object_under_the_pointer_is_found() {
        let (transform, scene) = scene();
        for (point, expected) in [
            ([0.05, 0.05], Some(Movable::Robot)),
            ([-0.85, 0.0], Some(Movable::Goal)),
            ([1.05, 1.45], Some(Movable::Obstacle(0))),
            ([1.45, 1.05], None),
            ([0.3, 0.3], None),
        ] {
            assert_eq!(
                hit_test(&transform, &scene.arenas[0], transform.to_screen(point)),
                expected,
                "{point:?}"
            );
        }
    }

    #[test]
    fn obstacles_that_are_generated_or_of_a_set_cannot_be_dragged() {
        let (transform, mut scene) = scene();
        let at = transform.to_screen([1.0, 1.0]);
        assert_eq!(hit_test(&transform, &scene.arenas[0], at), Some(Movable::Obstacle(0)));
        scene.arenas[0].set_member = Some("Crossing".into());
        assert_eq!(hit_test(&transform, &scene.arenas[0], at), None, "an obstacle of a set");
        scene.arenas[0].set_member = None;
        scene.arenas[0].written = Arc::new(Scenario::default());
        assert_eq!(hit_test(&transform, &scene.arenas[0], at), None, "a generated obstacle");
    }
}
