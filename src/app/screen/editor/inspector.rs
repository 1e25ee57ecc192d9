//! The inspector: the fields of the selected item, or of the scenario.

use egui::{Align, Layout, Ui};

use super::controls::button_row_ui;
use super::{generator_fields, obstacle_fields, placement_fields, scenario_panel};
use crate::app::editor::{Editor, EditorInteraction, PlacementRole, Selection};
use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::text::section_title_ui;

/// Shows the inspector.
pub fn inspector_ui(ui: &mut Ui, editor: &mut Editor, interaction: &mut EditorInteraction) {
    let selection = editor.selection();
    ui.horizontal(|ui| title_ui(ui, editor));
    if editor.can_copy() {
        let buttons = [
            ("Duplicate", "Add a copy next to it  (Ctrl+D)", true),
            ("Delete", "Delete this item  (Delete)", true),
        ];
        match button_row_ui(ui, &buttons) {
            Some(0) => return editor.duplicate(),
            Some(_) => return editor.delete(),
            None => {}
        }
    }
    // Each item has its own ids, so that text being typed for one cannot end up in another.
    ui.push_id(format!("{selection:?}"), |ui| match selection {
        Selection::Nothing => scenario_panel::scenario_ui(ui, editor, interaction),
        Selection::Enclosure => scenario_panel::enclosure_ui(ui, editor),
        Selection::Obstacle(k) => obstacle_fields::obstacle_ui(ui, editor, k),
        Selection::Wall(k) => obstacle_fields::wall_ui(ui, editor, k),
        Selection::Generator(k) => generator_fields::generator_ui(ui, editor, k),
        Selection::Starts => placement_fields::rule_ui(ui, editor, PlacementRole::Starts),
        Selection::Goals => placement_fields::rule_ui(ui, editor, PlacementRole::Goals),
        Selection::BenchmarkStart => placement_fields::benchmark_start_ui(ui, editor),
        Selection::BenchmarkGoal => placement_fields::benchmark_goal_ui(ui, editor),
    });
}

/// Shows the item's name and a button to deselect it.
fn title_ui(ui: &mut Ui, editor: &mut Editor) {
    let selection = editor.selection();
    section_title_ui(ui, &selection.title(editor.scenario()));
    if selection == Selection::Nothing {
        return;
    }
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        let tip = "Show the settings of the scenario";
        if icons::icon_button_ui(ui, Icon::Close, ButtonStyle::Quiet, 18.0, "Deselect", tip).clicked() {
            editor.select(Selection::Nothing);
        }
    });
}
