//! The position of the Q-value card: next to the robot, where it covers least.

use egui::{Id, Pos2, Rect, Vec2, vec2};

use super::canvas::Canvas;
use super::silhouette::Silhouette;
use super::transform::{constrain_to, screen_direction};
use crate::app::scene::ArenaScene;
use crate::scenario::Scenario;

/// The rectangle of a card of `size` next to the robot, whose radius is `body` points. Of six positions around the robot, the
/// card takes the one where it covers least. It leaves its current position, which is kept under `id`, only for one that is
/// clearly better.
pub fn card_rect(
    canvas: &Canvas,
    scenario: &Scenario,
    arena: &ArenaScene,
    size: Vec2,
    body: f32,
    avoid: &[Rect],
    id: Id,
) -> Rect {
    let view = canvas.transform.rect.shrink(8.0);
    let robot = canvas.to_screen([arena.pose.x_m, arena.pose.y_m]);
    let goal = canvas.to_screen([arena.goal.x_m, arena.goal.y_m]);
    let goal = Rect::from_center_size(
        goal,
        Vec2::splat(2.0 * canvas.transform.to_screen_length(scenario.task.goal_radius_m)),
    );
    let robot_rect = Rect::from_center_size(robot, Vec2::splat(2.0 * body + 16.0));
    let ahead = screen_direction(arena.pose.heading_rad);
    let ctx = canvas.painter.ctx();
    let before = ctx.data(|data| data.get_temp::<usize>(id));
    let path: Vec<Pos2> = arena.path_m.iter().rev().take(60).map(|&point| canvas.to_screen(point)).collect();
    let obstacles: Vec<Rect> = obstacles_near(canvas, arena, robot, 2.0 * size.x + body);
    let sides = [(1.0, -0.6), (1.0, 0.6), (-1.0, -0.6), (-1.0, 0.6), (0.0, -1.0), (0.0, 1.0)];
    let mut best = (f32::INFINITY, 0, Rect::NOTHING);
    for (k, (sx, sy)) in sides.into_iter().enumerate() {
        let reach = vec2(size.x / 2.0 + body + 34.0, size.y / 2.0 + body + 34.0);
        let lean = if sx == 0.0 { 1.0 } else { 0.8 };
        let middle = robot + vec2(sx * reach.x, sy * reach.y * lean);
        let card = constrain_to(Rect::from_center_size(middle, size), view);
        let covers = |other: Rect| overlap_area(card, other) / other.area().max(1.0);
        let mut cost = 12.0 * overlap_area(card, robot_rect).min(1.0) + 5.0 * covers(goal);
        cost += avoid.iter().map(|&other| 6.0 * covers(other)).sum::<f32>();
        cost += obstacles.iter().map(|&obstacle| 1.5 * covers(obstacle)).sum::<f32>();
        let covered = path.iter().filter(|&&point| card.contains(point)).count();
        cost += 0.8 * covered as f32 / path.len().max(1) as f32;
        cost += 0.6 * (card.center() - robot).normalized().dot(ahead).max(0.0);
        cost += 0.002 * card.distance_to_pos(robot);
        cost -= if before == Some(k) { 0.7 } else { 0.0 };
        if cost < best.0 {
            best = (cost, k, card);
        }
    }
    ctx.data_mut(|data| data.insert_temp(id, best.1));
    best.2
}

/// The screen rectangles of the obstacles within `reach` points of the robot.
fn obstacles_near(canvas: &Canvas, arena: &ArenaScene, robot: Pos2, reach: f32) -> Vec<Rect> {
    let rects = arena.scenario.obstacles.iter().zip(&arena.obstacles).map(|(obstacle, &pose)| {
        Silhouette::Obstacle { shape: obstacle.shape.clone(), pose }.screen_rect(canvas)
    });
    rects.filter(|rect| rect.distance_to_pos(robot) < reach).collect()
}

/// The area that two rectangles have in common.
fn overlap_area(a: Rect, b: Rect) -> f32 {
    let both = a.intersect(b);
    if both.is_positive() { both.area() } else { 0.0 }
}
