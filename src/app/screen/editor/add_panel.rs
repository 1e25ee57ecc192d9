//! The buttons that add items, and the choice of the snapping grid.

use egui::{Button, Ui, Vec2, vec2};

use super::controls::{choice_ui, set_accessible_name};
use super::framing::view_centre_m;
use crate::app::editor::{Editor, Snap, Tool, format_metres};
use crate::app::screen::widgets::text::section_title_ui;
use crate::app::view_state::ViewCamera;
use crate::scenario::Shape;

/// Number of buttons in a row.
const COLUMNS: usize = 3;
/// Height of a button, in points.
const HEIGHT: f32 = 26.0;

/// Shows the buttons. New obstacles go near the middle of the view.
pub fn add_ui(ui: &mut Ui, editor: &mut Editor, camera: ViewCamera) {
    section_title_ui(ui, "Add");
    let near_m = view_centre_m(ui, editor, camera);
    let gaps = (COLUMNS - 1) as f32 * ui.spacing().item_spacing.x;
    let size = vec2((ui.available_width() - gaps) / COLUMNS as f32, HEIGHT);
    for row in Shape::templates().chunks(COLUMNS) {
        ui.horizontal(|ui| {
            ui.spacing_mut().button_padding.x = 2.0;
            for (text, shape) in row {
                let name = format!("Add a {}", text.to_lowercase());
                if button_ui(ui, Button::new(*text), size, &name, &name) {
                    editor.add_obstacle(shape.clone(), near_m);
                }
            }
            // The last row has a place left.
            if row.len() < COLUMNS {
                wall_button_ui(ui, editor, size);
            }
        });
    }
    let size = vec2(ui.available_width(), HEIGHT);
    let tip = "Add random obstacles, generated again in every episode";
    if button_ui(ui, Button::new("Obstacle generator"), size, "Add an obstacle generator", tip) {
        editor.add_generator();
    }
    grid_choice_ui(ui, editor);
}

/// A button with a name for screen readers. Returns whether it was clicked.
fn button_ui(ui: &mut Ui, button: Button<'_>, size: Vec2, name: &str, tip: &str) -> bool {
    let response = ui.add_sized(size, button).on_hover_text(tip);
    set_accessible_name(&response, name);
    response.clicked()
}

/// The button that begins and finishes a wall.
fn wall_button_ui(ui: &mut Ui, editor: &mut Editor, size: Vec2) {
    let drawing = matches!(editor.tool(), Tool::Wall { .. });
    let (text, name) = if drawing { ("Finish", "Finish the wall") } else { ("Wall", "Draw a wall") };
    let tip = "Click the corners of the wall; double-click or press Enter to finish";
    if button_ui(ui, Button::new(text).selected(drawing), size, name, tip) {
        if drawing {
            editor.finish_tool();
        } else {
            editor.set_tool(Tool::Wall { corners_m: Vec::new() });
        }
    }
}

fn grid_choice_ui(ui: &mut Ui, editor: &mut Editor) {
    let now = editor.snap.on.then_some(editor.snap.step_m);
    let texts = Snap::STEPS_M.map(|step_m| (Some(step_m), format!("{} m", format_metres(step_m))));
    let tip = "Positions and sizes snap to this step, angles to 15°; hold Alt to disable snapping";
    let mut choices: Vec<(Option<f32>, &str, &str)> = vec![(None, "Off", "No snapping")];
    choices.extend(texts.iter().map(|(step, text)| (*step, text.as_str(), tip)));
    if let Some(chosen) = choice_ui(ui, "Grid", now, &choices) {
        editor.snap = Snap { on: chosen.is_some(), step_m: chosen.unwrap_or(editor.snap.step_m) };
    }
}
