//! The fields of start and goal rules, and of the benchmark route.

use bevy::math::Vec2;
use egui::Ui;

use super::controls::{button_row_ui, choice_ui};
use super::fields::FieldRows;
use super::number::NumberSpec;
use crate::app::editor::{Editor, PlacementKind, PlacementRole, Tool};
use crate::scenario::PlacementRule;
use crate::scenario::limits::{CLEARANCE_M, POSITIONS};

const RULES: [(PlacementKind, &str, &str); 4] = [
    (PlacementKind::Random, "Anywhere", "A random free position"),
    (PlacementKind::Within, "In a region", "A random free position in a rectangle"),
    (PlacementKind::Fixed, "Fixed", "Always the same position"),
    (PlacementKind::OneOf, "List", "One of several positions with equal probability"),
];

const HEADING: &str = "0° points along x; counterclockwise";
const CLEARANCE: NumberSpec = NumberSpec::length(CLEARANCE_M);

/// Shows the fields of the rule for starts or goals.
pub fn rule_ui(ui: &mut Ui, editor: &mut Editor, role: PlacementRole) {
    let mut rule = role.of(editor.scenario()).clone();
    if let Some(kind) = choice_ui(ui, "Placement", PlacementKind::from_rule(&rule), &RULES) {
        return editor.set_rule(role, kind);
    }
    let field = match role {
        PlacementRole::Starts => "starts",
        PlacementRole::Goals => "goals",
    };
    let mut rows = FieldRows::new(ui);
    rule_rows(&mut rows, &mut rule, role);
    rows.commit(editor, field, |scenario| *role.of_mut(scenario) = rule);
    if matches!(role.of(editor.scenario()), PlacementRule::OneOf { .. }) {
        add_positions_ui(ui, editor, role);
    }
}

fn rule_rows(rows: &mut FieldRows<'_>, rule: &mut PlacementRule, role: PlacementRole) {
    let noun = match role {
        PlacementRole::Starts => "Start",
        PlacementRole::Goals => "Goal",
    };
    let tip = "Smallest distance to walls and obstacles";
    match rule {
        PlacementRule::Random { clearance_m } => rows.number("Clearance", tip, clearance_m, CLEARANCE),
        PlacementRule::Within { min_m, max_m, clearance_m } => {
            region_rows(rows, min_m, max_m);
            rows.number("Clearance", tip, clearance_m, CLEARANCE);
        }
        PlacementRule::Fixed { position_m, heading_rad } => {
            rows.position(noun, "", position_m);
            // A goal with a heading is an error: the heading can be removed here.
            if role == PlacementRole::Starts || heading_rad.is_some() {
                heading_rows(rows, heading_rad);
            }
        }
        PlacementRule::OneOf { positions_m } => rows.positions(noun, positions_m, *POSITIONS.start()),
    }
}

fn heading_rows(rows: &mut FieldRows<'_>, heading_rad: &mut Option<f32>) {
    let mut is_fixed = heading_rad.is_some();
    rows.checkbox("Fixed heading", "Otherwise random", &mut is_fixed);
    match heading_rad {
        Some(heading) if is_fixed => rows.number("Heading", HEADING, heading, NumberSpec::ANGLE),
        _ => *heading_rad = is_fixed.then_some(0.0),
    }
}

/// Shows the button that begins and ends adding positions with the pointer.
fn add_positions_ui(ui: &mut Ui, editor: &mut Editor, role: PlacementRole) {
    let adding = *editor.tool() == Tool::Positions;
    let text = if adding { "Finish" } else { "Add positions" };
    if button_row_ui(ui, &[(text, "Each click on the canvas adds a position", true)]) == Some(0) {
        editor.select(role.selection());
        editor.set_tool(if adding { Tool::Select } else { Tool::Positions });
    }
}

/// Shows the corners of a region.
pub fn region_rows(rows: &mut FieldRows<'_>, min_m: &mut Vec2, max_m: &mut Vec2) {
    rows.position("From", "Lower left corner", min_m);
    rows.position("To", "Upper right corner", max_m);
}

/// Shows the fields of the benchmark route's start.
pub fn benchmark_start_ui(ui: &mut Ui, editor: &mut Editor) {
    let Some(mut route) = editor.scenario().benchmark_route else { return };
    let mut rows = FieldRows::new(ui);
    rows.position("Start", "Start of the benchmark route", &mut route.start_m);
    rows.number("Heading", HEADING, &mut route.heading_rad, NumberSpec::ANGLE);
    rows.commit(editor, "benchmark_route", |scenario| scenario.benchmark_route = Some(route));
}

/// Shows the field of the benchmark route's goal.
pub fn benchmark_goal_ui(ui: &mut Ui, editor: &mut Editor) {
    let Some(mut route) = editor.scenario().benchmark_route else { return };
    let mut rows = FieldRows::new(ui);
    rows.position("Goal", "Goal of the benchmark route", &mut route.goal_m);
    rows.commit(editor, "benchmark_route", |scenario| scenario.benchmark_route = Some(route));
}
