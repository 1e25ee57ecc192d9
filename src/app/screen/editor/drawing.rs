//! The world that is edited, as it is drawn: floor and grid, solids and where they go, what is selected, what is wrong,
//! and what is being drawn corner by corner.
//!
//! In: the [`Editor`]. Out: shapes on a [`Canvas`]. Starts and goals are in `marks.rs`, what can be dragged in
//! `handles.rs`.

use std::sync::Arc;

use bevy::math;
use egui::{Align2, Color32, FontId, Id, Pos2, Rect, Shape, Stroke, Ui, pos2, vec2};

use super::marks;
use super::pointer::PointerHit;
use crate::app::editor::{Editor, Selection, Tool};
use crate::app::screen::arena_view::arena;
use crate::app::screen::arena_view::canvas::Canvas;
use crate::app::screen::arena_view::floor;
use crate::app::screen::arena_view::obstacle_paths;
use crate::app::screen::arena_view::silhouette::{self, Silhouette};
use crate::app::screen::arena_view::transform::constrain_to;
use crate::app::screen::theme::SMALL;
use crate::scenario::{Obstacle, ObstacleMotion, Scenario, Wall, pose_at};

/// The grid that things snap to is drawn when its lines are at least so many points apart.
const GRID: f32 = 9.0;
/// Later places of a moving obstacle that are shown.
const GHOSTS: u64 = 7;
/// How wide a note of what is wrong may be, in points.
const NOTE: f32 = 250.0;

/// Draws the world.
pub fn draw(ui: &Ui, canvas: &Canvas, id: Id, editor: &Editor, under: PointerHit) {
    let (scenario, palette) = (&**editor.scenario(), &canvas.palette);
    floor::draw_floor(canvas, &scenario.enclosure);
    let (corners, seen) = (scenario.enclosure.corners_m(), canvas.painter.clip_rect());
    if editor.snap.on && canvas.transform.to_screen_length(editor.snap.step_m) >= GRID {
        floor::draw_grid_lines(canvas, seen, &corners, editor.snap.step_m, Stroke::new(1.0, palette.grid));
    }
    let round = Stroke::new(1.0, palette.border.gamma_multiply(0.8));
    floor::draw_grid_lines(canvas, seen, &corners, floor::grid_step_m(canvas.transform.scale), round);
    marks::draw_regions(canvas, editor);
    drawn_anew(ui, canvas, id, editor);
    let selected = editor.selection();
    let poses: Vec<_> =
        scenario.obstacles.iter().map(|o| (o.position_m.x, o.position_m.y, o.rotation_rad)).collect();
    arena::draw_solids(canvas, scenario, &poses);
    if let Selection::Wall(k) = selected
        && let Some(wall) = scenario.walls.get(k)
    {
        haloed(canvas, wall, palette.accent);
    }
    wrong(canvas, editor);
    for (k, obstacle) in scenario.obstacles.iter().enumerate() {
        if selected == Selection::Obstacle(k) {
            later(canvas, scenario, obstacle);
            obstacle_paths::draw(canvas, obstacle, palette.accent);
        } else {
            obstacle_paths::draw(canvas, obstacle, palette.weak_text.gamma_multiply(0.7));
        }
    }
    marks::draw_places(canvas, editor);
    if let PointerHit::Body(hovered) = under
        && hovered != selected
    {
        ring(canvas, scenario, hovered, Stroke::new(1.5, palette.text.gamma_multiply(0.7)));
    }
    ring(canvas, scenario, selected, Stroke::new(2.0, palette.accent));
    note(canvas, editor);
}

/// Draws around a thing.
fn ring(canvas: &Canvas, scenario: &Scenario, selection: Selection, stroke: Stroke) {
    let clear = Color32::TRANSPARENT;
    match selection {
        Selection::Obstacle(k) => {
            if let Some(obstacle) = scenario.obstacles.get(k) {
                let around = Silhouette::from_obstacle(obstacle).inflated(3.0 / canvas.transform.scale);
                silhouette::draw(canvas, &around, clear, stroke);
            }
        }
        // A selected wall has its halo; one under the pointer has each piece framed.
        Selection::Wall(k) if stroke.color != canvas.palette.accent => {
            for piece in scenario.walls.get(k).into_iter().flat_map(Wall::segments) {
                let around = Silhouette::from_obstacle(&piece).inflated(2.0 / canvas.transform.scale);
                silhouette::draw(canvas, &around, clear, stroke);
            }
        }
        Selection::Enclosure => {
            silhouette::draw_closed_line(canvas, &scenario.enclosure.corners_m(), 4.0, stroke.color)
        }
        _ => marks::draw_highlight(canvas, scenario, selection, stroke),
    }
}

/// A wall with a rim around all its pieces together.
fn haloed(canvas: &Canvas, wall: &Wall, ink: Color32) {
    for (by, ink) in [(5.0, ink), (3.0, canvas.palette.floor), (0.0, canvas.palette.obstacle)] {
        for piece in wall.segments() {
            let around = Silhouette::from_obstacle(&piece).inflated(by / canvas.transform.scale);
            silhouette::draw(canvas, &around, ink, Stroke::NONE);
        }
    }
}

/// Fills what something is wrong with.
fn wrong(canvas: &Canvas, editor: &Editor) {
    let (scenario, bad) = (editor.scenario(), canvas.palette.error);
    let mut done = Vec::new();
    for finding in editor.diagnostics() {
        let about = Selection::from_field_path(&finding.path);
        if done.contains(&about) {
            continue;
        }
        done.push(about);
        let fill = |obstacle: &Obstacle| {
            silhouette::draw(
                canvas,
                &Silhouette::from_obstacle(obstacle),
                bad.gamma_multiply(0.45),
                Stroke::new(2.0, bad),
            );
        };
        match about {
            Selection::Obstacle(k) => scenario.obstacles.get(k).into_iter().for_each(fill),
            Selection::Wall(k) => {
                for piece in scenario.walls.get(k).into_iter().flat_map(Wall::segments) {
                    silhouette::draw(
                        canvas,
                        &Silhouette::from_obstacle(&piece),
                        bad.gamma_multiply(0.6),
                        Stroke::NONE,
                    );
                }
            }
            Selection::Enclosure => {
                silhouette::draw_closed_line(canvas, &scenario.enclosure.corners_m(), 4.0, bad)
            }
            _ => {}
        }
    }
}

/// Where a moving obstacle is later, fading.
fn later(canvas: &Canvas, scenario: &Scenario, obstacle: &Obstacle) {
    let math::Vec2 { x, y } = obstacle.position_m;
    let speed_m_s = match &obstacle.motion {
        ObstacleMotion::Static => return,
        ObstacleMotion::Orbit { centre_m, speed_rad_s } => {
            speed_rad_s.abs() * (x - centre_m.x).hypot(y - centre_m.y)
        }
        ObstacleMotion::Patrol { speed_m_s, .. }
        | ObstacleMotion::BackAndForth { speed_m_s, .. }
        | ObstacleMotion::RandomWalk { speed_m_s, .. } => speed_m_s.abs(),
    };
    // So far apart that they don't cover each other.
    let apart_m = 1.3 * Silhouette::from_obstacle(obstacle).reach_m();
    let period_s = scenario.task.control_period_s;
    let steps = apart_m / (speed_m_s * period_s);
    if !(steps.is_finite() && steps < 1e6) {
        return;
    }
    let steps = steps.ceil().max(1.0) as u64;
    for k in 1..=GHOSTS {
        let pose = pose_at(obstacle, k * steps, period_s);
        let strength = 0.55 * (1.0 - k as f32 / (GHOSTS + 1) as f32);
        let ghost = Silhouette::Obstacle { shape: obstacle.shape.clone(), pose };
        let edge = Stroke::new(1.0, canvas.palette.weak_text.gamma_multiply(strength + 0.1));
        silhouette::draw(canvas, &ghost, canvas.palette.obstacle.gamma_multiply(strength * 0.5), edge);
    }
}

/// An example of what the generators may make, in outlines. In the middle of a drag it stays as it was.
fn drawn_anew(ui: &Ui, canvas: &Canvas, id: Id, editor: &Editor) {
    let scenario = editor.scenario();
    if scenario.generators.is_empty() {
        return;
    }
    // With the world that it is of: of another one, the same number of changes old, it would be wrong.
    type Example = (Arc<Scenario>, Arc<Vec<Obstacle>>);
    let id = id.with("example");
    let known = ui.data(|data| data.get_temp::<Example>(id));
    let known = known.filter(|(of, _)| Arc::ptr_eq(of, scenario) || editor.dragged().is_some());
    let (_, example) = known.unwrap_or_else(|| {
        let mut room = if editor.diagnostics().is_empty() {
            scenario.with_generated_obstacles(1)
        } else {
            Scenario::default()
        };
        let made = room.obstacles.split_off(scenario.obstacles.len().min(room.obstacles.len()));
        let example = (Arc::clone(scenario), Arc::new(made));
        ui.data_mut(|data| data.insert_temp(id, example.clone()));
        example
    });
    let edge = Stroke::new(1.0, canvas.palette.weak_text.gamma_multiply(0.8));
    for obstacle in example.iter() {
        silhouette::draw(
            canvas,
            &Silhouette::from_obstacle(obstacle),
            canvas.palette.obstacle.gamma_multiply(0.25),
            edge,
        );
    }
}

/// What is being drawn corner by corner, with the next corner where the pointer is.
pub fn draw_draft(ui: &Ui, canvas: &Canvas, editor: &Editor, pointer: Option<Pos2>) {
    let (corners, first) = match editor.tool() {
        Tool::Select => return,
        Tool::Places => (&[][..], None),
        Tool::Wall { corners_m } => (&corners_m[..], None),
        Tool::Path { waypoints_m } => {
            let Selection::Obstacle(k) = editor.selection() else { return };
            (&waypoints_m[..], editor.scenario().obstacles.get(k).map(|obstacle| obstacle.position_m))
        }
    };
    let palette = &canvas.palette;
    let free = ui.input(|input| input.modifiers.alt);
    let next = pointer.map(|at| editor.snapped(canvas.transform.to_world(at).into(), free));
    let all: Vec<math::Vec2> = first.into_iter().chain(corners.iter().copied()).collect();
    let points: Vec<Pos2> = all.iter().map(|&corner| canvas.to_screen(corner.into())).collect();
    let line = Stroke::new(2.5, palette.accent);
    canvas.painter.add(Shape::line(points.clone(), line));
    for &point in &points {
        canvas.painter.circle(point, 3.5, palette.floor, Stroke::new(1.5, palette.accent));
    }
    let Some(next) = next else { return };
    let at = canvas.to_screen(next.into());
    let label = match (points.last(), all.last()) {
        (Some(&last), Some(&math::Vec2 { x, y })) => {
            canvas.painter.extend(Shape::dashed_line(
                &[last, at],
                Stroke::new(1.75, palette.accent),
                6.0,
                4.0,
            ));
            format!("{:.2} m", (next.x - x).hypot(next.y - y))
        }
        _ => format!("{:.2}, {:.2}", next.x, next.y),
    };
    canvas.painter.circle_filled(at, 3.5, palette.accent);
    canvas.label(at + vec2(12.0, -10.0), Align2::LEFT_BOTTOM, &label, palette.text);
}

/// The box around a thing on the screen.
fn space(canvas: &Canvas, scenario: &Scenario, selection: Selection) -> Option<Rect> {
    let space = match selection {
        Selection::Obstacle(k) => {
            scenario.obstacles.get(k).map(|obstacle| Silhouette::from_obstacle(obstacle).screen_rect(canvas))
        }
        Selection::Wall(k) => scenario.walls.get(k).map(|wall| {
            let points: Vec<Pos2> =
                wall.corners_m.iter().map(|&corner| canvas.to_screen(corner.into())).collect();
            Rect::from_points(&points)
        }),
        _ => marks::screen_rect(canvas, scenario, selection),
    };
    space.filter(|space| space.is_finite())
}

/// What is wrong with the thing that is selected, below it; or while it is dragged, what is wrong with another.
fn note(canvas: &Canvas, editor: &Editor) {
    let selected = editor.selection();
    if selected == Selection::Nothing {
        return;
    }
    let mut all: Vec<_> = editor
        .diagnostics()
        .iter()
        .map(|finding| (Selection::from_field_path(&finding.path), finding))
        .collect();
    all.retain(|(about, _)| *about == selected || editor.dragged().is_some());
    all.sort_by_key(|(about, _)| *about != selected);
    let placed = |(about, finding)| Some((space(canvas, editor.scenario(), about)?, finding));
    let Some((space, finding)) = all.into_iter().find_map(placed) else { return };
    let (palette, painter) = (&canvas.palette, &canvas.painter);
    let width = NOTE.min(canvas.transform.rect.width() - 40.0).max(80.0);
    let text = painter.layout(finding.message.clone(), FontId::proportional(SMALL), palette.error, width);
    let size = text.size() + vec2(16.0, 10.0);
    let room = canvas.transform.rect.shrink(6.0);
    let below = pos2(space.center().x - size.x / 2.0, space.bottom() + 16.0);
    let above = pos2(below.x, space.top() - 16.0 - size.y);
    let corner = if below.y + size.y > room.bottom() - 24.0 { above } else { below };
    let card = constrain_to(Rect::from_min_size(corner, size), room);
    canvas.card_background(card);
    painter.galley(card.min + vec2(8.0, 5.0), text, palette.error);
}
