//! The unfinished wall or path, or the position to add, with the next point at the pointer.

use bevy::math;
use egui::{Align2, Pos2, Shape, Stroke, Ui, vec2};

use crate::app::editor::{Editor, Selection, Tool};
use crate::app::screen::arena_view::canvas::Canvas;

/// Draws the points so far, and a dashed line to the pointer, labelled with its length. Without points, the label is the
/// position of the next one.
pub fn draw(ui: &Ui, canvas: &Canvas, editor: &Editor, pointer: Option<Pos2>) {
    if *editor.tool() == Tool::Select {
        return;
    }
    let Some(points_m) = points_m(editor) else { return };
    let palette = &canvas.palette;
    let points: Vec<Pos2> = points_m.iter().map(|&point| canvas.to_screen(point.into())).collect();
    canvas.painter.add(Shape::line(points.clone(), Stroke::new(2.5, palette.accent)));
    for &point in &points {
        canvas.painter.circle(point, 3.5, palette.floor, Stroke::new(1.5, palette.accent));
    }
    let Some(pointer) = pointer else { return };
    let free = ui.input(|input| input.modifiers.alt);
    let next_m: math::Vec2 = editor.snapped(canvas.transform.to_world(pointer).into(), free);
    let next = canvas.to_screen(next_m.into());
    let label = match (points.last(), points_m.last()) {
        (Some(&last), Some(&last_m)) => {
            let line = Stroke::new(1.75, palette.accent);
            canvas.dashed_line(&[last, next], line, (6.0, 4.0));
            format!("{:.2} m", next_m.distance(last_m))
        }
        _ => format!("{:.2}, {:.2}", next_m.x, next_m.y),
    };
    canvas.painter.circle_filled(next, 3.5, palette.accent);
    canvas.label(next + vec2(12.0, -10.0), Align2::LEFT_BOTTOM, &label, palette.text);
}

/// The points so far, in m; a path begins at the selected obstacle. `None` if no obstacle is selected for it.
fn points_m(editor: &Editor) -> Option<Vec<math::Vec2>> {
    let mut points_m = editor.tool().points_m().to_vec();
    if let Tool::Path { .. } = editor.tool() {
        let Selection::Obstacle(k) = editor.selection() else { return None };
        if let Some(obstacle) = editor.scenario().obstacles.get(k) {
            points_m.insert(0, obstacle.position_m);
        }
    }
    Some(points_m)
}
