//! The world that is edited, as it is drawn: floor and grid, solids and where they go, what is selected, what is wrong,
//! and what is being drawn corner by corner.
//!
//! In: the [`Editor`]. Out: shapes on a [`Canvas`]. Starts and targets are in `marks.rs`, what can be dragged in
//! `handles.rs`.

use std::sync::Arc;

use egui::{Align2, Color32, FontId, Id, Pos2, Rect, Shape, Stroke, Ui, pos2, vec2};

use super::marks;
use super::pointer::Under;
use crate::app::editor::{Editor, Selection, Tool};
use crate::app::screen::theme::SMALL;
use crate::app::screen::world::arena;
use crate::app::screen::world::canvas::Canvas;
use crate::app::screen::world::motions;
use crate::app::screen::world::outline::{self, Outline};
use crate::app::screen::world::plane::pushed_into;
use crate::scenario::{Obstacle, ObstacleMotion, Scenario, Wall, pose_at};

/// The grid that things snap to is drawn when its lines are at least so many points apart.
const GRID: f32 = 9.0;
/// Later places of a moving obstacle that are shown.
const GHOSTS: u64 = 7;
/// How wide a note of what is wrong may be, in points.
const NOTE: f32 = 250.0;

/// Draws the world.
pub fn draw(ui: &Ui, canvas: &Canvas, id: Id, editor: &Editor, under: Under) {
    let (scenario, inks) = (&**editor.scenario(), &canvas.inks);
    arena::ground(canvas, &scenario.enclosure);
    let (corners, seen) = (scenario.enclosure.corners_m(), canvas.painter.clip_rect());
    if editor.snap.on && canvas.plane.length(editor.snap.step_m) >= GRID {
        arena::lines(canvas, seen, &corners, editor.snap.step_m, Stroke::new(1.0, inks.grid));
    }
    let round = Stroke::new(1.0, inks.line.gamma_multiply(0.8));
    arena::lines(canvas, seen, &corners, arena::grid_step_m(canvas.plane.scale), round);
    marks::regions(canvas, editor);
    drawn_anew(ui, canvas, id, editor);
    let selected = editor.selection();
    let poses: Vec<_> =
        scenario.obstacles.iter().map(|o| (o.position_m.0, o.position_m.1, o.rotation_rad)).collect();
    arena::solids(canvas, scenario, &poses);
    if let Selection::Wall(k) = selected
        && let Some(wall) = scenario.walls.get(k)
    {
        haloed(canvas, wall, inks.accent);
    }
    wrong(canvas, editor);
    for (k, obstacle) in scenario.obstacles.iter().enumerate() {
        if selected == Selection::Obstacle(k) {
            later(canvas, scenario, obstacle);
            motions::draw(canvas, obstacle, inks.accent);
        } else {
            motions::draw(canvas, obstacle, inks.soft.gamma_multiply(0.7));
        }
    }
    marks::places(canvas, editor);
    if let Under::Body(hovered) = under
        && hovered != selected
    {
        ring(canvas, scenario, hovered, Stroke::new(1.5, inks.ink.gamma_multiply(0.7)));
    }
    ring(canvas, scenario, selected, Stroke::new(2.0, inks.accent));
    note(canvas, editor);
}

/// Draws around a thing.
fn ring(canvas: &Canvas, scenario: &Scenario, selection: Selection, stroke: Stroke) {
    let clear = Color32::TRANSPARENT;
    match selection {
        Selection::Obstacle(k) => {
            if let Some(obstacle) = scenario.obstacles.get(k) {
                let around = Outline::of(obstacle).grown(3.0 / canvas.plane.scale);
                outline::draw(canvas, &around, clear, stroke);
            }
        }
        // A selected wall has its halo; one under the pointer has each piece framed.
        Selection::Wall(k) if stroke.color != canvas.inks.accent => {
            for piece in scenario.walls.get(k).into_iter().flat_map(Wall::pieces) {
                let around = Outline::of(&piece).grown(2.0 / canvas.plane.scale);
                outline::draw(canvas, &around, clear, stroke);
            }
        }
        Selection::Enclosure => outline::around(canvas, &scenario.enclosure.corners_m(), 4.0, stroke.color),
        _ => marks::ring(canvas, scenario, selection, stroke),
    }
}

/// A wall with a rim around all its pieces together.
fn haloed(canvas: &Canvas, wall: &Wall, ink: Color32) {
    for (by, ink) in [(5.0, ink), (3.0, canvas.inks.floor), (0.0, canvas.inks.solid)] {
        for piece in wall.pieces() {
            let around = Outline::of(&piece).grown(by / canvas.plane.scale);
            outline::draw(canvas, &around, ink, Stroke::NONE);
        }
    }
}

/// Fills what something is wrong with.
fn wrong(canvas: &Canvas, editor: &Editor) {
    let (scenario, bad) = (editor.scenario(), canvas.inks.bad);
    let mut done = Vec::new();
    for finding in editor.findings() {
        let about = Selection::of_path(&finding.path);
        if done.contains(&about) {
            continue;
        }
        done.push(about);
        let fill = |obstacle: &Obstacle| {
            outline::draw(canvas, &Outline::of(obstacle), bad.gamma_multiply(0.45), Stroke::new(2.0, bad));
        };
        match about {
            Selection::Obstacle(k) => scenario.obstacles.get(k).into_iter().for_each(fill),
            Selection::Wall(k) => {
                for piece in scenario.walls.get(k).into_iter().flat_map(Wall::pieces) {
                    outline::draw(canvas, &Outline::of(&piece), bad.gamma_multiply(0.6), Stroke::NONE);
                }
            }
            Selection::Enclosure => outline::around(canvas, &scenario.enclosure.corners_m(), 4.0, bad),
            _ => {}
        }
    }
}

/// Where a moving obstacle is later, fading.
fn later(canvas: &Canvas, scenario: &Scenario, obstacle: &Obstacle) {
    let (x, y) = obstacle.position_m;
    let speed_m_s = match &obstacle.motion {
        ObstacleMotion::Still => return,
        ObstacleMotion::Orbit { centre_m, speed_rad_s } => {
            speed_rad_s.abs() * (x - centre_m.0).hypot(y - centre_m.1)
        }
        ObstacleMotion::Patrol { speed_m_s, .. }
        | ObstacleMotion::BackAndForth { speed_m_s, .. }
        | ObstacleMotion::RandomWalk { speed_m_s, .. } => speed_m_s.abs(),
    };
    // So far apart that they don't cover each other.
    let apart_m = 1.3 * Outline::of(obstacle).reach_m();
    let period_s = scenario.task.control_period_s;
    let steps = apart_m / (speed_m_s * period_s);
    if !(steps.is_finite() && steps < 1e6) {
        return;
    }
    let steps = steps.ceil().max(1.0) as u64;
    for k in 1..=GHOSTS {
        let pose = pose_at(obstacle, k * steps, period_s);
        let strength = 0.55 * (1.0 - k as f32 / (GHOSTS + 1) as f32);
        let ghost = Outline::Solid { shape: obstacle.shape.clone(), pose };
        let edge = Stroke::new(1.0, canvas.inks.soft.gamma_multiply(strength + 0.1));
        outline::draw(canvas, &ghost, canvas.inks.solid.gamma_multiply(strength * 0.5), edge);
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
        let mut room = if editor.findings().is_empty() { scenario.furnished(1) } else { Scenario::default() };
        let made = room.obstacles.split_off(scenario.obstacles.len().min(room.obstacles.len()));
        let example = (Arc::clone(scenario), Arc::new(made));
        ui.data_mut(|data| data.insert_temp(id, example.clone()));
        example
    });
    let edge = Stroke::new(1.0, canvas.inks.soft.gamma_multiply(0.8));
    for obstacle in example.iter() {
        outline::draw(canvas, &Outline::of(obstacle), canvas.inks.solid.gamma_multiply(0.25), edge);
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
    let inks = &canvas.inks;
    let free = ui.input(|input| input.modifiers.alt);
    let next = pointer.map(|at| editor.snapped(canvas.plane.to_world(at).into(), free));
    let all: Vec<(f32, f32)> = first.into_iter().chain(corners.iter().copied()).collect();
    let points: Vec<Pos2> = all.iter().map(|&corner| canvas.at(corner.into())).collect();
    let line = Stroke::new(2.5, inks.accent);
    canvas.painter.add(Shape::line(points.clone(), line));
    for &point in &points {
        canvas.painter.circle(point, 3.5, inks.floor, Stroke::new(1.5, inks.accent));
    }
    let Some(next) = next else { return };
    let at = canvas.at(next.into());
    let label = match (points.last(), all.last()) {
        (Some(&last), Some(&(x, y))) => {
            canvas.painter.extend(Shape::dashed_line(&[last, at], Stroke::new(1.75, inks.accent), 6.0, 4.0));
            format!("{:.2} m", (next.0 - x).hypot(next.1 - y))
        }
        _ => format!("{:.2}, {:.2}", next.0, next.1),
    };
    canvas.painter.circle_filled(at, 3.5, inks.accent);
    canvas.chip(at + vec2(12.0, -10.0), Align2::LEFT_BOTTOM, &label, inks.ink);
}

/// The box around a thing on the screen.
fn space(canvas: &Canvas, scenario: &Scenario, selection: Selection) -> Option<Rect> {
    let space = match selection {
        Selection::Obstacle(k) => {
            scenario.obstacles.get(k).map(|obstacle| Outline::of(obstacle).space(canvas))
        }
        Selection::Wall(k) => scenario.walls.get(k).map(|wall| {
            let points: Vec<Pos2> = wall.corners_m.iter().map(|&corner| canvas.at(corner.into())).collect();
            Rect::from_points(&points)
        }),
        _ => marks::space(canvas, scenario, selection),
    };
    space.filter(|space| space.is_finite())
}

/// What is wrong with the thing that is selected, below it; or while it is dragged, what is wrong with another.
fn note(canvas: &Canvas, editor: &Editor) {
    let selected = editor.selection();
    if selected == Selection::Nothing {
        return;
    }
    let mut all: Vec<_> =
        editor.findings().iter().map(|finding| (Selection::of_path(&finding.path), finding)).collect();
    all.retain(|(about, _)| *about == selected || editor.dragged().is_some());
    all.sort_by_key(|(about, _)| *about != selected);
    let placed = |(about, finding)| Some((space(canvas, editor.scenario(), about)?, finding));
    let Some((space, finding)) = all.into_iter().find_map(placed) else { return };
    let (inks, painter) = (&canvas.inks, &canvas.painter);
    let width = NOTE.min(canvas.plane.rect.width() - 40.0).max(80.0);
    let text = painter.layout(finding.message.clone(), FontId::proportional(SMALL), inks.bad, width);
    let size = text.size() + vec2(16.0, 10.0);
    let room = canvas.plane.rect.shrink(6.0);
    let below = pos2(space.center().x - size.x / 2.0, space.bottom() + 16.0);
    let above = pos2(below.x, space.top() - 16.0 - size.y);
    let corner = if below.y + size.y > room.bottom() - 24.0 { above } else { below };
    let card = pushed_into(Rect::from_min_size(corner, size), room);
    canvas.card(card);
    painter.galley(card.min + vec2(8.0, 5.0), text, inks.bad);
}
