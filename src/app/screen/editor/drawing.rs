//! The drawing of the edited scenario: floor, grid, solid items, paths, starts and goals, outlines.

use std::sync::Arc;

use egui::{Id, Stroke, Ui};

use super::{marks, outlines, problem_note};
use crate::app::editor::{Body, Editor, PointerHit, Selection};
use crate::app::screen::arena_view::arena;
use crate::app::screen::arena_view::canvas::Canvas;
use crate::app::screen::arena_view::floor;
use crate::app::screen::arena_view::obstacle_paths;
use crate::app::screen::arena_view::silhouette::{self, Silhouette};
use crate::scenario::{Obstacle, Scenario, pose_at};

/// Smallest line spacing at which the snap grid is drawn, in points.
const MIN_GRID_SPACING: f32 = 9.0;
/// Number of later positions shown for the selected obstacle, if it moves.
const GHOSTS: u64 = 7;

/// Draws the scenario.
pub fn draw(ui: &Ui, canvas: &Canvas, id: Id, editor: &Editor, hit: PointerHit) {
    let (scenario, palette) = (&**editor.scenario(), &canvas.palette);
    let selected = editor.selection();
    floor::draw_floor(canvas, &scenario.enclosure);
    draw_grids(canvas, editor);
    marks::draw_regions(canvas, editor);
    draw_generated_example(ui, canvas, id, editor);
    let poses: Vec<_> =
        scenario.obstacles.iter().map(|o| (o.position_m.x, o.position_m.y, o.rotation_rad)).collect();
    arena::draw_solids(canvas, scenario, &poses);
    if let Body::Wall(wall) = selected.body(scenario) {
        outlines::draw_selected_wall(canvas, &wall);
    }
    outlines::draw_errors(canvas, editor);
    draw_paths(canvas, scenario, selected);
    marks::draw_starts_and_goals(canvas, editor);
    if let PointerHit::Body(hovered) = hit
        && hovered != selected
    {
        let stroke = Stroke::new(1.5, palette.text.gamma_multiply(0.7));
        outlines::draw_outline(canvas, scenario, hovered, stroke);
    }
    if !matches!(selected, Selection::Wall(_)) {
        outlines::draw_outline(canvas, scenario, selected, Stroke::new(2.0, palette.accent));
    }
    outlines::draw_notes(canvas, editor);
    problem_note::draw(canvas, editor);
}

/// Draws the grid that positions snap to, and a coarser one.
fn draw_grids(canvas: &Canvas, editor: &Editor) {
    let (corners, visible) = (editor.scenario().enclosure.corners_m(), canvas.painter.clip_rect());
    let palette = &canvas.palette;
    let snap = editor.snap;
    if snap.on && canvas.transform.to_screen_length(snap.step_m) >= MIN_GRID_SPACING {
        floor::draw_grid_lines(canvas, visible, &corners, snap.step_m, Stroke::new(1.0, palette.grid));
    }
    let coarse = Stroke::new(1.0, palette.border.gamma_multiply(0.8));
    floor::draw_grid_lines(canvas, visible, &corners, floor::grid_step_m(canvas.transform.scale), coarse);
}

/// Draws the paths of all obstacles, and the later positions of the selected one.
fn draw_paths(canvas: &Canvas, scenario: &Scenario, selected: Selection) {
    for (k, obstacle) in scenario.obstacles.iter().enumerate() {
        if selected == Selection::Obstacle(k) {
            draw_ghosts(canvas, scenario, obstacle);
            obstacle_paths::draw(canvas, obstacle, canvas.palette.accent);
        } else {
            obstacle_paths::draw(canvas, obstacle, canvas.palette.weak_text.gamma_multiply(0.7));
        }
    }
}

/// Draws later positions of a moving obstacle, fainter and fainter. A pedestrian has none: its motion depends on others.
fn draw_ghosts(canvas: &Canvas, scenario: &Scenario, obstacle: &Obstacle) {
    // Far enough apart that the ghosts can be distinguished.
    let spacing_m = 1.3 * Silhouette::from_obstacle(obstacle).reach_m();
    let period_s = scenario.task.control_period_s;
    let steps = spacing_m / (obstacle.origin_speed_m_s() * period_s);
    if obstacle.motion.is_pedestrian() || !(steps.is_finite() && steps < 1e6) {
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

/// Draws an example of the obstacles that the generators make.
fn draw_generated_example(ui: &Ui, canvas: &Canvas, id: Id, editor: &Editor) {
    if editor.scenario().generators.is_empty() {
        return;
    }
    let edge = Stroke::new(1.0, canvas.palette.weak_text.gamma_multiply(0.8));
    let fill = canvas.palette.obstacle.gamma_multiply(0.25);
    for obstacle in generated_example(ui, id.with("example"), editor).iter() {
        silhouette::draw(canvas, &Silhouette::from_obstacle(obstacle), fill, edge);
    }
}

/// The obstacles of the example, cached for one scenario. During a drag the example stays as it was.
fn generated_example(ui: &Ui, id: Id, editor: &Editor) -> Arc<Vec<Obstacle>> {
    type Example = (Arc<Scenario>, Arc<Vec<Obstacle>>);
    let scenario = editor.scenario();
    let cached = ui.data(|data| data.get_temp::<Example>(id));
    let is_current = |of: &Arc<Scenario>| Arc::ptr_eq(of, scenario) || editor.dragged().is_some();
    if let Some((_, example)) = cached.filter(|(of, _)| is_current(of)) {
        return example;
    }
    let mut generated = Vec::new();
    // Generation needs a valid scenario.
    if editor.diagnostics().is_empty() {
        generated = scenario.with_generated_obstacles(1).obstacles;
        generated.drain(..scenario.obstacles.len().min(generated.len()));
    }
    let example = Arc::new(generated);
    ui.data_mut(|data| data.insert_temp(id, (Arc::clone(scenario), Arc::clone(&example))));
    example
}
