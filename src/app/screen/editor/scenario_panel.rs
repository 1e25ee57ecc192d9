//! The world's own part of the editor's panel: its enclosure, robot, LIDAR and rules, in groups that open.
//!
//! In: the editor. Out: its changes. The rules and the enclosure are shown alone, too, when they are selected.

use bevy::math::Vec2;
use egui::{CollapsingHeader, Context, Id, RichText, TextEdit, Ui};

use super::fields::{FieldRows, NumberSpec, button_row_ui, choice_ui, set_accessible_name};
use crate::app::editor::{Editor, EnclosureKind, PlacementKind, PlacementRole, Selection, Tool};
use crate::app::screen::theme::BODY;
use crate::app::screen::widgets::text::weak_text;
use crate::scenario::{Enclosure, Motion, PlacementRule};

/// A full turn, as the schema's default has it.
const ALL_AROUND: f32 = std::f32::consts::TAU;

const RULES: [(PlacementKind, &str, &str); 4] = [
    (PlacementKind::Random, "Anywhere", "Anywhere that is clear, drawn anew each time"),
    (PlacementKind::Within, "In a region", "Anywhere that is clear within a rectangle"),
    (PlacementKind::Fixed, "One place", "Always the same place"),
    (PlacementKind::OneOf, "Some places", "One of a few places, each as likely as the others"),
];

fn group_to_open() -> Id {
    Id::new("editor group to open")
}

/// Opens the group that the field at `path` is in.
pub fn reveal_field(ctx: &Context, path: &str) {
    let head = path.split(['.', '[']).next().unwrap_or_default().to_owned();
    ctx.data_mut(|data| data.insert_temp(group_to_open(), head));
}

/// All groups.
pub fn scenario_ui(ui: &mut Ui, editor: &mut Editor) {
    let asked: Option<String> = ui.data_mut(|data| data.remove_temp(group_to_open()));
    let group =
        |ui: &mut Ui, editor: &mut Editor, (name, field): (&str, &str), body: fn(&mut Ui, &mut Editor)| {
            let open = asked.as_deref().filter(|&head| head == field).map(|_| true);
            CollapsingHeader::new(RichText::new(name).size(BODY))
                .id_salt(("editor", name))
                .open(open)
                // Two groups may have fields of the same name.
                .show_unindented(ui, |ui| ui.push_id(field, |ui| body(ui, editor)));
        };
    group(ui, editor, ("About", "about"), about_ui);
    group(ui, editor, ("Enclosure", "enclosure"), enclosure_ui);
    group(ui, editor, ("Robot", "robot"), robot_ui);
    group(ui, editor, ("LIDAR", "lidar"), lidar_ui);
    group(ui, editor, ("Episodes", "task"), task_ui);
    group(ui, editor, ("Starts", "starts"), |ui, editor| place_rule_ui(ui, editor, PlacementRole::Starts));
    group(ui, editor, ("Goals", "goals"), |ui, editor| place_rule_ui(ui, editor, PlacementRole::Goals));
    group(ui, editor, ("Benchmark route", "benchmark_route"), |ui, editor| {
        benchmark_start_ui(ui, editor);
        benchmark_goal_ui(ui, editor);
    });
    if !editor.scenario().generators.is_empty() {
        group(ui, editor, ("Random obstacles", "generators"), generators_ui);
    }
}

fn about_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut text = editor.scenario().about.clone();
    let field = TextEdit::multiline(&mut text).desired_width(f32::INFINITY).desired_rows(3).char_limit(2_000);
    let response = ui.add(field.hint_text("What it is for, or what it teaches"));
    set_accessible_name(&response, "About the world");
    if response.changed() {
        editor.edit("about", |scenario| scenario.about = text);
    }
    if response.lost_focus() {
        editor.close_group();
    }
}

/// The walls around.
pub fn enclosure_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut enclosure = editor.scenario().enclosure.clone();
    let kinds = [
        (EnclosureKind::Rectangle, "Rectangle", "About the middle of the world, its sides along x and y"),
        (EnclosureKind::Polygon, "Polygon", "Any outline, such as an L"),
    ];
    if let Some(kind) = choice_ui(ui, "Outline", EnclosureKind::from_enclosure(&enclosure), &kinds) {
        return editor.set_enclosure(kind);
    }
    let mut rows = FieldRows::new(ui);
    match &mut enclosure {
        Enclosure::Rectangle { width_m, height_m } => {
            let both = [("width", width_m), ("height", height_m)];
            rows.pair("Size", "Inner extent along x and y", both, NumberSpec::format_metres(0.5, 1000.0));
        }
        Enclosure::Polygon { corners_m } => rows.positions("Corner", corners_m, 3),
    }
    rows.commit(editor, "enclosure", |scenario| scenario.enclosure = enclosure);
}

fn robot_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut robot = editor.scenario().robot.clone();
    let mut rows = FieldRows::new(ui);
    rows.number("Radius", "Of the robot's disc", &mut robot.radius_m, NumberSpec::format_metres(0.01, 10.0));
    let tip = "Time constant of the drive: how slowly it follows the motion that was chosen";
    rows.number("Drive's lag", tip, &mut robot.actuator_lag_s, NumberSpec::seconds(0.0, 10.0));
    let units = [NumberSpec::SPEED.with_range(-5.0, 5.0), NumberSpec::ANGULAR_VELOCITY];
    rows.list("Motion", &mut robot.motions, 1, "edit them in the file", units, |motion| {
        [("speed", &mut motion.v_m_s), ("turning", &mut motion.w_rad_s)]
    });
    if robot.motions.len() < 64
        && button_row_ui(rows.ui, &[("Add a motion", "One more for the policy to choose", true)]) == Some(0)
    {
        robot.motions.push(Motion { v_m_s: 0.15, w_rad_s: 0.0 });
        rows.mark_changed("motion added");
    }
    rows.commit(editor, "robot", |scenario| scenario.robot = robot);
}

fn lidar_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut lidar = editor.scenario().lidar.clone();
    let mut rows = FieldRows::new(ui);
    rows.count("Beams", "Spread evenly over what it sees", &mut lidar.beams, 1..=4096);
    let tip = "How wide it sees; a narrower one looks ahead";
    let view = NumberSpec::ANGLE.with_range(0.01, f64::from(ALL_AROUND));
    rows.number("Field of view", tip, &mut lidar.field_of_view_rad, view);
    if lidar.is_all_around() {
        lidar.field_of_view_rad = ALL_AROUND;
    }
    let tip = "What a beam reports when it meets nothing nearer";
    rows.number("Range", tip, &mut lidar.max_range_m, NumberSpec::format_metres(0.01, 1000.0));
    let tip = "Standard deviation of the Gaussian noise on each range";
    rows.number("Noise", tip, &mut lidar.noise_std_m, NumberSpec::format_metres(0.0, 10.0));
    rows.number("Lost beams", "They report the whole range", &mut lidar.dropout, NumberSpec::FRACTION);
    rows.count(
        "Latency in steps",
        "How old a scan is when the policy sees it",
        &mut lidar.latency_steps,
        0..=50,
    );
    rows.commit(editor, "lidar", |scenario| scenario.lidar = lidar);
}

fn task_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut task = editor.scenario().task.clone();
    let mut rows = FieldRows::new(ui);
    let tip = "The goal is reached when the robot is nearer than this";
    rows.number("Goal radius", tip, &mut task.goal_radius_m, NumberSpec::format_metres(0.001, 100.0));
    let tip = "It is a collision when anything is nearer to the robot's middle; more than its radius";
    rows.number("Collision range", tip, &mut task.collision_range_m, NumberSpec::format_metres(0.001, 100.0));
    let tip = "How far a new goal is from the robot at least";
    rows.number(
        "New goal's distance",
        tip,
        &mut task.min_goal_distance_m,
        NumberSpec::format_metres(0.001, 1000.0),
    );
    rows.count(
        "Time limit in steps",
        "Until an episode is cut off",
        &mut task.max_episode_steps,
        1..=1_000_000,
    );
    let tip = "Simulated time of one step";
    rows.number("A step lasts", tip, &mut task.control_period_s, NumberSpec::seconds(0.001, 10.0));
    rows.commit(editor, "task", |scenario| scenario.task = task);
}

/// The rule of starts or goals.
pub fn place_rule_ui(ui: &mut Ui, editor: &mut Editor, which: PlacementRole) {
    let (word, place) = match which {
        PlacementRole::Starts => ("starts", "Start"),
        PlacementRole::Goals => ("goals", "Target"),
    };
    let mut rule = which.of(editor.scenario()).clone();
    if let Some(kind) = choice_ui(ui, "Where", PlacementKind::from_rule(&rule), &RULES) {
        return editor.set_rule(which, kind);
    }
    let mut rows = FieldRows::new(ui);
    let clear = "The least distance to any surface";
    let clearance = NumberSpec::format_metres(0.0, 1000.0);
    match &mut rule {
        PlacementRule::Random { clearance_m } => rows.number("Clearance", clear, clearance_m, clearance),
        PlacementRule::Within { min_m, max_m, clearance_m } => {
            region_rows(&mut rows, min_m, max_m);
            rows.number("Clearance", clear, clearance_m, clearance);
        }
        PlacementRule::Fixed { position_m, heading_rad } => {
            rows.position(place, "", position_m);
            let mut given = heading_rad.is_some();
            // A goal has no use for one, and says so: here it is taken out.
            if which == PlacementRole::Starts || given {
                rows.checkbox("Looks one way", "Or else anywhere", &mut given);
            }
            match (given, &mut *heading_rad) {
                (true, Some(heading)) => rows.number("Heading", HEADING, heading, NumberSpec::ANGLE),
                (true, none) => *none = Some(0.0),
                (false, some) => *some = None,
            }
        }
        PlacementRule::OneOf { positions_m } => rows.positions(place, positions_m, 1),
    }
    rows.commit(editor, word, |scenario| *which.of_mut(scenario) = rule);
    if matches!(which.of(editor.scenario()), PlacementRule::OneOf { .. }) {
        let drawing = *editor.tool() == Tool::Places;
        let text = if drawing { "Done" } else { "Click more places" };
        if button_row_ui(ui, &[(text, "Each click in the world is one more place", true)]) == Some(0) {
            editor.select(which.selection());
            editor.set_tool(if drawing { Tool::Select } else { Tool::Places });
        }
    }
}

const HEADING: &str = "Where it looks: 0° is along x, counterclockwise";

/// The corners of a rectangle.
pub fn region_rows(rows: &mut FieldRows<'_>, min_m: &mut Vec2, max_m: &mut Vec2) {
    rows.position("From", "Its lower left corner", min_m);
    rows.position("To", "Its upper right corner", max_m);
}

/// Where the benchmark route starts.
pub fn benchmark_start_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut benchmark_route = editor.scenario().benchmark_route.clone();
    let mut rows = FieldRows::new(ui);
    rows.position("Start", "Where the robot starts on the benchmark route", &mut benchmark_route.start_m);
    rows.number("Heading", HEADING, &mut benchmark_route.heading_rad, NumberSpec::ANGLE);
    rows.commit(editor, "benchmark_route", |scenario| scenario.benchmark_route = benchmark_route);
}

/// Where it ends.
pub fn benchmark_goal_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut benchmark_route = editor.scenario().benchmark_route.clone();
    let mut rows = FieldRows::new(ui);
    rows.position("Target", "Where it must go on the benchmark route", &mut benchmark_route.goal_m);
    rows.commit(editor, "benchmark_route", |scenario| scenario.benchmark_route = benchmark_route);
}

fn generators_ui(ui: &mut Ui, editor: &mut Editor) {
    for k in 0..editor.scenario().generators.len() {
        let name = format!("Random obstacles {}", k + 1);
        if ui.button(weak_text(&name)).on_hover_text("Show its numbers").clicked() {
            editor.select(Selection::Generator(k));
        }
    }
}
