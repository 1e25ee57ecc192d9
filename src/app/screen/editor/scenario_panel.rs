//! The fields of the scenario in collapsible groups.

use egui::{CollapsingHeader, RichText, TextEdit, Ui};

use super::controls::{button_row_ui, choice_ui, set_accessible_name};
use super::fields::FieldRows;
use super::number::NumberSpec;
use super::placement_fields::{benchmark_goal_ui, benchmark_start_ui, rule_ui};
use super::robot_fields::{lidar_ui, robot_ui, task_ui};
use crate::app::editor::{Editor, EditorInteraction, EnclosureKind, PlacementRole, Selection};
use crate::app::screen::theme::BODY;
use crate::app::screen::widgets::text::weak_text;
use crate::scenario::Enclosure;
use crate::scenario::limits::{ENCLOSURE_CORNERS, ENCLOSURE_SIDE_M, MAX_ABOUT_CHARS};

type Contents = fn(&mut Ui, &mut Editor);

/// The groups: their names, their fields in the scenario, and their contents.
const GROUPS: [(&str, &str, Contents); 9] = [
    ("About", "about", about_ui),
    ("Enclosure", "enclosure", enclosure_ui),
    ("Robot", "robot", robot_ui),
    ("LIDAR", "lidar", lidar_ui),
    ("Episodes", "task", task_ui),
    ("Starts", "starts", |ui, editor| rule_ui(ui, editor, PlacementRole::Starts)),
    ("Goals", "goals", |ui, editor| rule_ui(ui, editor, PlacementRole::Goals)),
    ("Benchmark route", "benchmark_route", benchmark_route_ui),
    ("Generators", "generators", generators_ui),
];

/// The group that shows the field at `path`: the first part of the path.
pub fn group_of(path: &str) -> String {
    path.split(['.', '[']).next().unwrap_or_default().to_owned()
}

/// Shows all groups.
pub fn scenario_ui(ui: &mut Ui, editor: &mut Editor, interaction: &mut EditorInteraction) {
    let group_to_open = interaction.group_to_open.take();
    let has_generators = !editor.scenario().generators.is_empty();
    for (name, field, contents) in GROUPS {
        if field == "generators" && !has_generators {
            continue;
        }
        let open = (group_to_open.as_deref() == Some(field)).then_some(true);
        CollapsingHeader::new(RichText::new(name).size(BODY))
            .id_salt(("editor", name))
            .open(open)
            // Two groups may have fields of the same name.
            .show_unindented(ui, |ui| ui.push_id(field, |ui| contents(ui, editor)));
    }
}

fn about_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut text = editor.scenario().about.clone();
    let field = TextEdit::multiline(&mut text).desired_width(f32::INFINITY).desired_rows(3);
    let field = field.char_limit(MAX_ABOUT_CHARS).hint_text("Purpose of the scenario");
    let response = ui.add(field);
    set_accessible_name(&response, "Description");
    if response.changed() {
        editor.edit("about", |scenario| scenario.about = text);
    }
    if response.lost_focus() {
        editor.close_group();
    }
}

/// Shows the fields of the enclosure.
pub fn enclosure_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut enclosure = editor.scenario().enclosure.clone();
    let kinds = [
        (EnclosureKind::Rectangle, "Rectangle", "Centred at (0, 0), sides along x and y"),
        (EnclosureKind::Polygon, "Polygon", "A polygon whose sides do not cross"),
    ];
    if let Some(kind) = choice_ui(ui, "Shape", EnclosureKind::from_enclosure(&enclosure), &kinds) {
        return editor.set_enclosure(kind);
    }
    let mut rows = FieldRows::new(ui);
    match &mut enclosure {
        Enclosure::Rectangle { width_m, height_m } => {
            let size = [("width", width_m), ("height", height_m)];
            rows.pair("Size", "Inner width and height", size, NumberSpec::length(ENCLOSURE_SIDE_M));
        }
        Enclosure::Polygon { corners_m } => rows.positions("Corner", corners_m, *ENCLOSURE_CORNERS.start()),
    }
    rows.commit(editor, "enclosure", |scenario| scenario.enclosure = enclosure);
}

fn benchmark_route_ui(ui: &mut Ui, editor: &mut Editor) {
    if editor.scenario().benchmark_route.is_none() {
        let tip = "A fixed start and goal; wayfield --eval --course measures the time between them";
        if button_row_ui(ui, &[("Add a benchmark route", tip, true)]).is_some() {
            editor.add_benchmark_route();
        }
        return;
    }
    benchmark_start_ui(ui, editor);
    benchmark_goal_ui(ui, editor);
    if button_row_ui(ui, &[("Remove the benchmark route", "Episodes don't need one", true)]).is_some() {
        editor.edit("benchmark_route", |scenario| scenario.benchmark_route = None);
        editor.close_group();
    }
}

/// Lists the generators, because one without a region cannot be selected on the canvas.
fn generators_ui(ui: &mut Ui, editor: &mut Editor) {
    for k in 0..editor.scenario().generators.len() {
        let name = format!("Generator {}", k + 1);
        if ui.button(weak_text(&name)).on_hover_text("Select this generator").clicked() {
            editor.select(Selection::Generator(k));
        }
    }
}
