//! The list of problems and notes on the edited scenario. A click selects the item, or opens the group of the field.

use egui::{Color32, CursorIcon, Frame, Margin, RichText, Sense, Stroke, Ui, WidgetInfo, WidgetType};

use super::scenario_panel;
use crate::app::editor::{Editor, EditorInteraction, Selection};
use crate::app::screen::theme::{Palette, SMALL};
use crate::app::screen::widgets::text::{section_title_ui, weak_text};
use crate::scenario::Diagnostic;

/// Maximum number of entries shown in each of the two lists.
const MAX_SHOWN: usize = 12;

/// Shows the problems and the notes.
pub fn diagnostics_ui(ui: &mut Ui, editor: &mut Editor, interaction: &mut EditorInteraction) {
    let palette = Palette::from_ui(ui);
    if editor.diagnostics().is_empty() && editor.notes().is_empty() {
        ui.label(RichText::new("No problems").color(palette.success).strong());
        return;
    }
    let problems: Vec<_> = editor.diagnostics().iter().collect();
    let notes: Vec<_> = editor.notes().iter().map(|note| &note.diagnostic).collect();
    let clicked_problem = list_ui(ui, "problem", &problems, palette.error);
    let clicked = list_ui(ui, "note", &notes, palette.warning).or(clicked_problem);
    if let Some(path) = clicked {
        editor.select(Selection::from_field_path(&path));
        interaction.group_to_open = Some(scenario_panel::group_of(&path));
    }
}

/// Shows `entries` under a title such as "3 problems", for the `name` "problem". Returns the path of the clicked entry.
fn list_ui(ui: &mut Ui, name: &str, entries: &[&Diagnostic], color: Color32) -> Option<String> {
    let count = entries.len();
    if count == 0 {
        return None;
    }
    section_title_ui(ui, &format!("{count} {name}{}", if count == 1 { "" } else { "s" }));
    let mut clicked = None;
    for entry in entries.iter().take(MAX_SHOWN) {
        if diagnostic_ui(ui, entry, color) {
            clicked = Some(entry.path.clone());
        }
    }
    if let Some(more @ 1..) = count.checked_sub(MAX_SHOWN) {
        ui.label(weak_text(&format!("and {more} more")));
    }
    clicked
}

/// Shows one problem or note in its colour. Returns whether it was clicked.
fn diagnostic_ui(ui: &mut Ui, diagnostic: &Diagnostic, color: Color32) -> bool {
    let palette = Palette::from_ui(ui);
    let frame = Frame::new()
        .fill(palette.control)
        .stroke(Stroke::new(1.0, palette.border))
        .corner_radius(4.0)
        .inner_margin(Margin::symmetric(8, 5));
    let shown = frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.spacing_mut().item_spacing.y = 1.0;
        ui.label(RichText::new(field_name(&diagnostic.path)).size(SMALL).color(color).strong());
        ui.label(RichText::new(&diagnostic.message).size(SMALL).color(palette.text));
    });
    let response = shown.response.interact(Sense::click()).on_hover_cursor(CursorIcon::PointingHand);
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, diagnostic.to_string()));
    if response.hovered() || response.has_focus() {
        let stroke = Stroke::new(1.0, color);
        ui.painter().rect_stroke(response.rect, 4.0, stroke, egui::StrokeKind::Inside);
    }
    response.clicked()
}

/// The readable name of a field: `obstacles[2].shape.radius_m` is `Obstacle 3, radius`. Units and the word `shape` are
/// left out.
fn field_name(path: &str) -> String {
    let mut words = Vec::new();
    for part in path.split('.') {
        let mut pieces = part.split(['[', ']']).filter(|piece| !piece.is_empty());
        let Some(name) = pieces.next().filter(|&name| name != "shape") else { continue };
        let numbers: Vec<usize> = pieces.filter_map(|piece| piece.parse().ok()).collect();
        let units = ["_m_s2", "_rad_s2", "_m_s", "_rad_s", "_rad_m", "_rad", "_m", "_s"];
        let bare = units.iter().find_map(|unit| name.strip_suffix(unit)).unwrap_or(name);
        let name = bare.replace('_', " ");
        words.push(match numbers[..] {
            [] => name,
            [k, ..] => format!("{} {}", name.strip_suffix('s').unwrap_or(&name), k + 1),
        });
    }
    let text = words.join(", ");
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_path_becomes_a_readable_name() {
        for (path, name) in [
            ("obstacles[2].shape.radius_m", "Obstacle 3, radius"),
            ("walls[0]", "Wall 1"),
            ("starts.clearance_m", "Starts, clearance"),
            ("robot.motions[0].w_rad_s", "Robot, motion 1, w"),
            ("robot.max_acceleration_m_s2", "Robot, max acceleration"),
            ("robot.odometry_drift.heading_drift_rad_m", "Robot, odometry drift, heading drift"),
            ("generators[1].within.min_m[0]", "Generator 2, within, min 1"),
            ("name", "Name"),
            ("", ""),
        ] {
            assert_eq!(field_name(path), name);
        }
    }
}
