//! Dragging objects in an arena: which object is under the pointer, and where it may go.
//!
//! In: the pointer, one arena. Out: [`Command::Move`] while an object is dragged, and what to draw for it. The object under
//! the pointer when the button went down stays grabbed, although it may drive away from the pointer meanwhile.

use egui::{Id, Pos2, Response, Ui};

use super::silhouette::Silhouette;
use super::transform::ViewTransform;
use crate::app::commands::Command;
use crate::app::moves::{ArenaView, Movable, MoveRejection, MoveRequest, check_move};
use crate::app::scene::{ArenaScene, Scene};
use crate::app::screen::ScreenInput;
use crate::scenario::shape_distance;

/// Text of the tooltip over `object`.
#[must_use]
pub fn tooltip(object: Movable) -> &'static str {
    match object {
        Movable::Goal => "Goal: drag to move it",
        Movable::Robot => "Robot: drag to move it",
        Movable::Obstacle(_) => "Obstacle: drag to move it in every arena",
    }
}

/// An object that is being dragged.
#[derive(Clone, Debug, PartialEq)]
pub struct ActiveDrag {
    /// Index of the arena.
    pub arena: usize,
    /// The object.
    pub object: Movable,
    /// Requested position of its centre, in m.
    pub to_m: [f32; 2],
    /// Why it cannot go there, if it cannot.
    pub rejection: Option<MoveRejection>,
    offset_m: [f32; 2],
}

fn hand() -> Id {
    Id::new("wayfield hand")
}

/// Follows the pointer in the view of arena `index`. Returns the drag in progress there, if any.
pub fn update(
    ui: &Ui,
    response: &Response,
    transform: &ViewTransform,
    view: &ScreenInput<'_>,
    index: usize,
    commands: &mut Vec<Command>,
) -> Option<ActiveDrag> {
    let scene = view.scene;
    let arena = scene.arenas.get(index)?;
    if response.is_pointer_button_down_on() && ui.input(|input| input.pointer.any_pressed()) {
        let pressed = ui.input(|input| input.pointer.press_origin());
        let drag = pressed.and_then(|at| {
            let object = hit_test(transform, scene, arena, at)?;
            let (centre, grabbed) = (centre_of(object, arena)?, transform.to_world(at));
            let offset_m = [centre[0] - grabbed[0], centre[1] - grabbed[1]];
            Some(ActiveDrag { arena: index, object, to_m: centre, rejection: None, offset_m })
        });
        ui.data_mut(|data| data.insert_temp(hand(), drag));
    }
    let mut drag = ui.data(|data| data.get_temp::<Option<ActiveDrag>>(hand())).flatten()?;
    if drag.arena != index {
        return None;
    }
    if !response.is_pointer_button_down_on() || centre_of(drag.object, arena).is_none() {
        ui.data_mut(|data| data.insert_temp(hand(), None::<ActiveDrag>));
        return None;
    }
    // Before the pointer has moved, it may still be a click.
    let pointer = response.interact_pointer_pos().filter(|_| response.dragged())?;
    let at = transform.to_world(pointer);
    drag.to_m = [at[0] + drag.offset_m[0], at[1] + drag.offset_m[1]];
    drag.rejection = check_move(&arena_view(scene, arena), drag.object, drag.to_m.into()).err();
    // While time runs, the robot drives away from a pointer at rest, and a goal that is reached is drawn elsewhere.
    let drifts = !view.status.paused && !matches!(drag.object, Movable::Obstacle(_));
    let moves = ui.input(|input| input.pointer.delta() != egui::Vec2::ZERO);
    if drag.rejection.is_none() && (moves || drifts) {
        let request = MoveRequest { arena: index, object: drag.object, to_m: drag.to_m.into() };
        commands.push(Command::Move(request));
    }
    ui.data_mut(|data| data.insert_temp(hand(), Some(drag.clone())));
    Some(drag)
}

fn arena_view<'a>(scene: &'a Scene, arena: &'a ArenaScene) -> ArenaView<'a> {
    ArenaView {
        scenario: &scene.scenario,
        layout: &arena.scenario,
        obstacles: &arena.obstacles,
        robot_m: (arena.pose.x_m, arena.pose.y_m),
        goal_m: (arena.goal.x_m, arena.goal.y_m),
    }
}

/// The object under the pointer, with some tolerance for small ones: the robot first, then the goal, then the obstacles.
/// Generated obstacles are not among them, because they are not in the scenario's file.
#[must_use]
pub fn hit_test(transform: &ViewTransform, scene: &Scene, arena: &ArenaScene, at: Pos2) -> Option<Movable> {
    let scenario = &*scene.scenario;
    let [x, y] = transform.to_world(at);
    let slack_m = 3.0 / transform.scale;
    let from = |px: f32, py: f32| (px - x).hypot(py - y);
    let least_m = 10.0 / transform.scale;
    if from(arena.pose.x_m, arena.pose.y_m) <= (scenario.robot.radius_m + slack_m).max(least_m) {
        return Some(Movable::Robot);
    }
    if from(arena.goal.x_m, arena.goal.y_m) <= (scenario.task.goal_radius_m + slack_m).max(least_m) {
        return Some(Movable::Goal);
    }
    let solids = scenario.obstacles.iter().zip(&arena.obstacles);
    let solids = solids.map(|(o, &pose)| shape_distance(&o.shape, pose, (x, y)));
    let (index, away) = solids.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
    (away <= slack_m).then_some(Movable::Obstacle(index))
}

fn centre_of(object: Movable, arena: &ArenaScene) -> Option<[f32; 2]> {
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
        Movable::Robot => Some(Silhouette::Disc { at_m, radius_m: scenario.robot.radius_m }),
        Movable::Obstacle(index) => {
            let (obstacle, pose) = (scenario.obstacles.get(index)?, arena.obstacles.get(index)?);
            Some(Silhouette::Obstacle { shape: obstacle.shape.clone(), pose: (at_m[0], at_m[1], pose.2) })
        }
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
            Obstacle { shape, position_m: (1.0, 1.0), rotation_rad: turned, motion: ObstacleMotion::Static };
        let wall = Wall { corners_m: vec![(-2.0, -1.5), (0.0, -1.5)], thickness_m: 0.2 };
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
    fn the_object_under_the_pointer_is_found() {
        let (transform, scene) = world();
        for (point, expected) in [
            ([0.05, 0.05], Some(Movable::Robot)),
            ([-0.85, 0.0], Some(Movable::Goal)),
            ([1.05, 1.45], Some(Movable::Obstacle(0))),
            ([1.45, 1.05], None),
            ([0.3, 0.3], None),
        ] {
            assert_eq!(
                hit_test(&transform, &scene, &scene.arenas[0], transform.to_screen(point)),
                expected,
                "{point:?}"
            );
        }
    }

    #[test]
    fn a_generated_obstacle_cannot_be_dragged() {
        let (transform, mut scene) = world();
        let at = transform.to_screen([1.0, 1.0]);
        assert_eq!(hit_test(&transform, &scene, &scene.arenas[0], at), Some(Movable::Obstacle(0)));
        scene.scenario = Arc::new(Scenario::default());
        assert_eq!(hit_test(&transform, &scene, &scene.arenas[0], at), None);
    }
}
