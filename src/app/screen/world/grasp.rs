//! The hand on the world: what the pointer can take hold of, and where it may be put.
//!
//! In: the pointer, one arena. Out: [`Order::Move`] while something is dragged, and what to draw for it. A place inside
//! an obstacle or outside the walls is refused. What was under the pointer when the button went down stays in the hand,
//! though it would drive on meanwhile.

use egui::{Id, Pos2, Response, Ui};

use super::outline::Outline;
use super::plane::Plane;
use crate::app::orders::{Moved, Order};
use crate::app::scene::{ArenaScene, Scene};
use crate::app::screen::View;
use crate::scenario::{inner_wall_distance, shape_distance, wall_distance};

/// What can be taken hold of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grip {
    /// The target.
    Target,
    /// The robot.
    Robot,
    /// An obstacle, by its number in the scenario.
    Obstacle(usize),
}

impl Grip {
    /// What a tooltip says of it.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Target => "The target: drag it to another place",
            Self::Robot => "The robot: drag it to another place",
            Self::Obstacle(_) => "An obstacle: drag it, and it moves in every arena",
        }
    }
}

/// Something in the hand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// In which arena.
    pub arena: usize,
    /// What.
    pub grip: Grip,
    /// Where its middle is to go, in m.
    pub to_m: [f32; 2],
    /// Why it cannot go there.
    pub refused: Option<&'static str>,
    offset_m: [f32; 2],
}

fn hand() -> Id {
    Id::new("wayfield hand")
}

/// Follows the pointer in the view of arena `index`; gives what it holds there.
pub fn follow(
    ui: &Ui,
    response: &Response,
    plane: &Plane,
    view: &View<'_>,
    index: usize,
    orders: &mut Vec<Order>,
) -> Option<Held> {
    let scene = view.scene;
    let arena = scene.arenas.get(index)?;
    if response.is_pointer_button_down_on() && ui.input(|input| input.pointer.any_pressed()) {
        let pressed = ui.input(|input| input.pointer.press_origin());
        let held = pressed.and_then(|at| {
            let grip = under(plane, scene, arena, at)?;
            let (middle, taken) = (middle_of(grip, arena)?, plane.to_world(at));
            let offset_m = [middle[0] - taken[0], middle[1] - taken[1]];
            Some(Held { arena: index, grip, to_m: middle, refused: None, offset_m })
        });
        ui.data_mut(|data| data.insert_temp(hand(), held));
    }
    let mut held = ui.data(|data| data.get_temp::<Option<Held>>(hand())).flatten()?;
    if held.arena != index {
        return None;
    }
    if !response.is_pointer_button_down_on() || middle_of(held.grip, arena).is_none() {
        ui.data_mut(|data| data.insert_temp(hand(), None::<Held>));
        return None;
    }
    // Until it is dragged, it may still be a click.
    let pointer = response.interact_pointer_pos().filter(|_| response.dragged())?;
    let at = plane.to_world(pointer);
    held.to_m = [at[0] + held.offset_m[0], at[1] + held.offset_m[1]];
    held.refused = refusal(arena, held.grip, held.to_m);
    // A robot would drive out of a hand that rests, and a target that it reaches would go elsewhere.
    let slips = !view.status.paused && !matches!(held.grip, Grip::Obstacle(_));
    let moves = ui.input(|input| input.pointer.delta() != egui::Vec2::ZERO);
    if held.refused.is_none() && (moves || slips) {
        let to_m = (held.to_m[0], held.to_m[1]);
        orders.push(Order::Move(match held.grip {
            Grip::Target => Moved::Target { arena: index, to_m },
            Grip::Robot => Moved::Robot { arena: index, to_m },
            Grip::Obstacle(obstacle) => Moved::Obstacle { arena: index, index: obstacle, to_m },
        }));
    }
    ui.data_mut(|data| data.insert_temp(hand(), Some(held)));
    Some(held)
}

/// What is under the pointer, with a little slack for small things: the robot before the target before the obstacles. An
/// obstacle that was drawn for this episode alone can't be taken hold of: the world's file doesn't have it.
#[must_use]
pub fn under(plane: &Plane, scene: &Scene, arena: &ArenaScene, at: Pos2) -> Option<Grip> {
    let scenario = &*scene.scenario;
    let [x, y] = plane.to_world(at);
    let slack_m = 3.0 / plane.scale;
    let from = |px: f32, py: f32| (px - x).hypot(py - y);
    let least_m = 10.0 / plane.scale;
    if from(arena.pose.x_m, arena.pose.y_m) <= (scenario.robot.radius_m + slack_m).max(least_m) {
        return Some(Grip::Robot);
    }
    if from(arena.target.x_m, arena.target.y_m) <= (scenario.task.goal_radius_m + slack_m).max(least_m) {
        return Some(Grip::Target);
    }
    let solids = scenario.obstacles.iter().zip(&arena.obstacles);
    let solids = solids.map(|(o, &pose)| shape_distance(&o.shape, pose, (x, y)));
    let (index, away) = solids.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))?;
    (away <= slack_m).then_some(Grip::Obstacle(index))
}

fn middle_of(grip: Grip, arena: &ArenaScene) -> Option<[f32; 2]> {
    match grip {
        Grip::Target => Some([arena.target.x_m, arena.target.y_m]),
        Grip::Robot => Some([arena.pose.x_m, arena.pose.y_m]),
        Grip::Obstacle(index) => arena.obstacles.get(index).map(|pose| [pose.0, pose.1]),
    }
}

/// The outline of `grip` where it is, or with its middle at `to_m`.
#[must_use]
pub fn outline(arena: &ArenaScene, grip: Grip, to_m: Option<[f32; 2]>) -> Option<Outline> {
    let scenario = &*arena.room;
    let at_m = to_m.or_else(|| middle_of(grip, arena))?;
    match grip {
        Grip::Target => Some(Outline::Disc { at_m, radius_m: scenario.task.goal_radius_m }),
        Grip::Robot => Some(Outline::Disc { at_m, radius_m: scenario.robot.radius_m }),
        Grip::Obstacle(index) => {
            let (obstacle, pose) = (scenario.obstacles.get(index)?, arena.obstacles.get(index)?);
            Some(Outline::Solid { shape: obstacle.shape.clone(), pose: (at_m[0], at_m[1], pose.2) })
        }
    }
}

/// Why `grip` cannot be put at `to_m`; none if it can.
fn refusal(arena: &ArenaScene, grip: Grip, to_m: [f32; 2]) -> Option<&'static str> {
    let scenario = &*arena.room;
    let inside_m = wall_distance(&scenario.enclosure, to_m.into());
    let guard_m = scenario.task.collision_range_m;
    let solid_m = || {
        let solids = scenario.obstacles.iter().zip(&arena.obstacles);
        solids.map(|(o, &pose)| shape_distance(&o.shape, pose, to_m.into())).fold(f32::INFINITY, f32::min)
    };
    let wall_m = || {
        let walls = scenario.walls.iter().map(|wall| inner_wall_distance(wall, to_m.into()));
        walls.fold(f32::INFINITY, f32::min)
    };
    match grip {
        _ if inside_m.is_nan() || inside_m <= 0.0 => Some("Outside the walls"),
        Grip::Target if solid_m() <= 0.0 => Some("Inside an obstacle"),
        Grip::Target if wall_m() <= 0.0 => Some("Inside a wall"),
        Grip::Robot if inside_m <= guard_m || wall_m() <= guard_m => Some("Too near the wall"),
        Grip::Robot if solid_m() <= guard_m => Some("Too near an obstacle"),
        Grip::Obstacle(index) => {
            let (obstacle, pose) = (scenario.obstacles.get(index)?, arena.obstacles.get(index)?);
            let gap_to = |x_m, y_m| shape_distance(&obstacle.shape, (to_m[0], to_m[1], pose.2), (x_m, y_m));
            if gap_to(arena.pose.x_m, arena.pose.y_m) <= guard_m {
                Some("Too near the robot")
            } else if gap_to(arena.target.x_m, arena.target.y_m) <= 0.0 {
                Some("Over the target")
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

    use super::super::plane::Bounds;
    use super::*;
    use crate::app::desk::Camera;
    use crate::app::scene::Driver;
    use crate::scenario::{Obstacle, ObstacleMotion, Scenario, Shape, Wall};
    use crate::task::{Pose, Target};

    fn world() -> (Plane, Scene) {
        let shape = Shape::Rectangle { width_m: 1.0, height_m: 0.2 };
        let turned = std::f32::consts::FRAC_PI_2;
        let obstacle =
            Obstacle { shape, position_m: (1.0, 1.0), rotation_rad: turned, motion: ObstacleMotion::Still };
        let wall = Wall { corners_m: vec![(-2.0, -1.5), (0.0, -1.5)], thickness_m: 0.2 };
        let world = Scenario { obstacles: vec![obstacle], walls: vec![wall], ..Scenario::default() };
        let scenario = Arc::new(world);
        let pose = Pose { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
        let arena = ArenaScene {
            room: scenario.clone(),
            pose,
            target: Target { x_m: -1.0, y_m: 0.0 },
            obstacles: vec![(1.0, 1.0, turned)],
            ranges_m: vec![],
            scan_pose: pose,
            driver: Driver::Learner,
            action: 0,
            explored: false,
            q_values: vec![],
            path_m: vec![],
            trails: vec![],
            collisions: 0,
            targets_in_all: 0,
            parked: false,
        };
        let view = Rect::from_min_size(pos2(0.0, 0.0), egui::vec2(400.0, 400.0));
        let plane = Plane::new(view, egui::Vec2::ZERO, Camera::default(), Bounds::of(&scenario.enclosure));
        (plane, Scene { scenario, arenas: vec![arena], potential: None, value: None })
    }

    #[test]
    fn the_pointer_finds_what_is_under_it() {
        let (plane, scene) = world();
        for (point, grip) in [
            ([0.05, 0.05], Some(Grip::Robot)),
            ([-0.85, 0.0], Some(Grip::Target)),
            ([1.05, 1.45], Some(Grip::Obstacle(0))),
            ([1.45, 1.05], None),
            ([0.3, 0.3], None),
        ] {
            assert_eq!(under(&plane, &scene, &scene.arenas[0], plane.to_screen(point)), grip, "{point:?}");
        }
    }

    #[test]
    fn nothing_is_put_into_an_obstacle_or_out_of_the_walls() {
        let (_, scene) = world();
        let may = |grip, to_m| refusal(&scene.arenas[0], grip, to_m).is_none();
        assert!(
            may(Grip::Target, [1.2, 1.0]) && !may(Grip::Target, [1.0, 1.4]) && !may(Grip::Target, [2.1, 0.0])
        );
        assert!(may(Grip::Robot, [1.3, 1.0]) && !may(Grip::Robot, [1.2, 1.0]), "it would collide at once");
        assert!(!may(Grip::Robot, [1.9, 0.0]) && !may(Grip::Robot, [f32::NAN, 0.0]));
        assert!(may(Grip::Obstacle(0), [0.5, 0.0]) && !may(Grip::Obstacle(0), [0.2, 0.0]));
        assert!(!may(Grip::Obstacle(0), [-1.0, 0.2]), "over the target");
        assert!(!may(Grip::Target, [-1.0, -1.45]) && may(Grip::Target, [-1.0, -1.35]), "into the inner wall");
        assert!(!may(Grip::Robot, [-1.0, -1.35]) && may(Grip::Robot, [-1.0, -1.25]));
    }

    #[test]
    fn what_was_drawn_for_an_episode_alone_stays() {
        let (plane, mut scene) = world();
        let at = plane.to_screen([1.0, 1.0]);
        assert_eq!(under(&plane, &scene, &scene.arenas[0], at), Some(Grip::Obstacle(0)));
        scene.scenario = Arc::new(Scenario::default());
        assert_eq!(under(&plane, &scene, &scene.arenas[0], at), None);
    }
}
