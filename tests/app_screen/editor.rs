//! The editor's panel: typing, choosing and clicking, and applying or saving the scenario.
#![expect(clippy::approx_constant, reason = "angles are stored with four decimals")]

use std::path::PathBuf;
use std::sync::Arc;

use bevy::math::{Vec2, vec2};
use egui::Key;
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use wayfield::app::commands::{Command, EditorReply};
use wayfield::app::editor::{Editor, PlacementKind, PlacementRole, Selection, Tool};
use wayfield::app::view_state::ViewCamera;
use wayfield::scenario::limits::{COLLISION_RANGE_M, SHAPE_SIZE_M};
use wayfield::scenario::{
    Enclosure, Motion, Obstacle, ObstacleMotion, PlacementRule, Ranged, Scenario, Shape, Wall, WallCells,
};

use super::{Window, click, press, release_event, sent_commands, settle, window, window_with_size};
use crate::screen_fixture::{self, ScreenFixture};

/// A window with the editor on the fixture's scenario: four circles of radius 0.15 m in a square of 4 m.
fn editing() -> Window {
    editing_in(ScreenFixture::default())
}

fn editing_in(mut screen_fixture: ScreenFixture) -> Window {
    open(&mut screen_fixture, "scenario-1");
    window(screen_fixture)
}

fn open(screen_fixture: &mut ScreenFixture, from: &str) {
    let editor = Editor::open(screen_fixture.scene.scenario.clone(), from.into(), true);
    screen_fixture.view_state.editor = Some(Box::new(editor));
}

fn editor(window: &mut Window) -> &mut Editor {
    window.state_mut().view_state.editor.as_deref_mut().expect("the editor is open")
}

fn edited_scenario(window: &mut Window) -> Arc<Scenario> {
    editor(window).scenario().clone()
}

fn select(window: &mut Window, selection: Selection) {
    editor(window).select(selection);
    settle(window);
}

/// Scrolls to a control and clicks it.
fn press_on(window: &mut Window, label: &str) -> Vec<Command> {
    window.get_by_label(label).scroll_to_me();
    window.run_steps(40);
    click(window, label)
}

/// Replaces the text of a field.
fn write(window: &mut Window, label: &str, text: &str) {
    press_on(window, label);
    settle(window);
    window.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
    window.get_by_label(label).type_text(text);
    settle(window);
    window.key_press(Key::Enter);
    settle(window);
}

#[test]
fn typing_a_number_is_one_undo_step() {
    let mut window = editing();
    select(&mut window, Selection::Obstacle(2));
    assert!(window.query_by_label("Obstacle 3 of 4").is_some());
    write(&mut window, "Radius", "0.25");
    write(&mut window, "Position x", "-0.755");
    let obstacle = edited_scenario(&mut window).obstacles[2].clone();
    assert_eq!(obstacle.shape, Shape::Circle { radius_m: 0.25 });
    assert_eq!(obstacle.position_m, vec2(-0.755, -0.6));
    assert_eq!(click(&mut window, "Undo"), []);
    assert_eq!(edited_scenario(&mut window).obstacles[2].position_m, vec2(-0.6, -0.6), "with all digits");
    click(&mut window, "Undo");
    assert_eq!(edited_scenario(&mut window).obstacles[2].shape, Shape::Circle { radius_m: 0.15 });
    click(&mut window, "Redo");
    assert_eq!(edited_scenario(&mut window).obstacles[2].shape, Shape::Circle { radius_m: 0.25 });
}

#[test]
fn angles_are_shown_in_degrees_and_stored_in_radians() {
    let mut window = editing();
    click(&mut window, "Add a box");
    write(&mut window, "Rotation", "30");
    assert_eq!(edited_scenario(&mut window).obstacles[4].rotation_rad, 0.5236);
    write(&mut window, "Size height", "0.2");
    assert_eq!(
        edited_scenario(&mut window).obstacles[4].shape,
        Shape::Rectangle { width_m: 0.4, height_m: 0.2 }
    );
    select(&mut window, Selection::Nothing);
    click(&mut window, "LIDAR");
    write(&mut window, "Field of view", "180");
    assert_eq!(edited_scenario(&mut window).lidar.field_of_view_rad, 3.1416);
    write(&mut window, "Field of view", "360");
    assert_eq!(
        edited_scenario(&mut window).lidar.field_of_view_rad,
        std::f32::consts::TAU,
        "exactly the default"
    );
    write(&mut window, "Dropout", "2.5");
    assert_eq!(edited_scenario(&mut window).lidar.dropout, 0.025.into());
}

#[test]
fn both_ends_of_a_range_are_shown_and_edited() {
    let mut window = editing();
    editor(&mut window).edit("range", |scenario| scenario.lidar.dropout = Ranged::Range(0.0, 0.1));
    select(&mut window, Selection::Nothing);
    click(&mut window, "LIDAR");
    write(&mut window, "Dropout highest", "20");
    write(&mut window, "Dropout lowest", "5");
    assert_eq!(edited_scenario(&mut window).lidar.dropout, Ranged::Range(0.05, 0.2));
}

#[test]
fn the_drive_and_the_odometry_of_a_robot_are_edited() {
    let mut window = editing();
    select(&mut window, Selection::Nothing);
    click(&mut window, "Robot");
    press_on(&mut window, "Limit acceleration");
    write(&mut window, "At most", "0.5");
    press_on(&mut window, "Odometry drifts");
    write(&mut window, "Rotation error", "3");
    let robot = edited_scenario(&mut window).robot.clone();
    assert_eq!((robot.max_acceleration_m_s2, robot.max_angular_acceleration_rad_s2), (Some(0.5), None));
    assert_eq!(robot.odometry_drift.map(|drift| drift.rotation_error), Some(0.03.into()));
    press_on(&mut window, "Odometry drifts");
    assert_eq!(edited_scenario(&mut window).robot.odometry_drift, None);
}

#[test]
fn a_number_out_of_range_becomes_the_nearest_allowed_number() {
    let mut window = editing();
    click(&mut window, "Episodes");
    write(&mut window, "Collision range", "0.001");
    assert_eq!(edited_scenario(&mut window).task.collision_range_m, *COLLISION_RANGE_M.start());
    write(&mut window, "Collision range", "1000");
    assert_eq!(edited_scenario(&mut window).task.collision_range_m, *COLLISION_RANGE_M.end());
    click(&mut window, "Add a capsule");
    write(&mut window, "Length", "0");
    let expected = Shape::Capsule { length_m: *SHAPE_SIZE_M.start(), radius_m: 0.1 };
    assert_eq!(edited_scenario(&mut window).obstacles[4].shape, expected);
}

#[test]
fn a_new_item_is_selected_and_can_be_duplicated_and_deleted() {
    let mut window = editing();
    for (label, count) in [
        ("Add a circle", 5),
        ("Add a capsule", 6),
        ("Add a triangle", 7),
        ("Add a hexagon", 8),
        ("Duplicate", 9),
        ("Delete", 8),
    ] {
        assert_eq!(click(&mut window, label), [], "{label}");
        assert_eq!(edited_scenario(&mut window).obstacles.len(), count, "{label}");
    }
    assert_eq!(editor(&mut window).selection(), Selection::Nothing);
    click(&mut window, "Add an obstacle generator");
    assert_eq!(editor(&mut window).selection(), Selection::Generator(0));
    write(&mut window, "Count", "7");
    assert_eq!(editor(&mut window).diagnostics(), []);
    click(&mut window, "Limit to a region");
    let generator = edited_scenario(&mut window).generators[0].clone();
    assert_eq!((generator.count, generator.within.map(|r| r.min_m)), (7, Some(vec2(-1.0, -1.0))));
    // The middle is full.
    let problems =
        editor(&mut window).diagnostics().iter().map(|problem| problem.path.as_str()).collect::<Vec<_>>();
    assert_eq!(problems, ["generators"]);
}

#[test]
fn a_wall_is_drawn_with_the_tool() {
    let mut window = editing();
    click(&mut window, "Draw a wall");
    for at in [vec2(-1.0, 1.2), vec2(1.0, 1.2)] {
        editor(&mut window).click_with_tool(at, false);
    }
    settle(&mut window);
    click(&mut window, "Finish the wall");
    assert_eq!(editor(&mut window).selection(), Selection::Wall(0));
    write(&mut window, "Corner 2 y", "1");
    assert_eq!(edited_scenario(&mut window).walls[0].corners_m, [vec2(-1.0, 1.2), vec2(1.0, 1.0)]);
    assert!(window.query_by_label("Remove corner 1").is_none(), "a wall keeps two corners");
}

#[test]
fn cells_are_edited_as_numbers_and_as_text() {
    let mut screen_fixture = ScreenFixture::default();
    let rows = vec!["##.".to_owned(), "#..".to_owned()];
    let wall = Wall { cells: Some(WallCells::new(rows, 0.25, vec2(1.0, -1.0))), ..Wall::default() };
    let scenario = Scenario { walls: vec![wall], ..Scenario::default() };
    let editor = Editor::open(Arc::new(scenario), "mine.ron".into(), true);
    screen_fixture.view_state.editor = Some(Box::new(editor));
    let mut window = window(screen_fixture);
    select(&mut window, Selection::Wall(0));
    assert!(window.query_by_label("Thickness").is_none());
    write(&mut window, "Cell", "0.3");
    write(&mut window, "Centre x", "0.5");
    window.get_by_label("Cells").click();
    settle(&mut window);
    window.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
    window.get_by_label("Cells").type_text(".#\n#.");
    settle(&mut window);
    let cells = edited_scenario(&mut window).walls[0].cells.clone().expect("cells");
    assert_eq!(
        (cells.rows().join(" "), cells.cell_m(), cells.centre_m()),
        (".# #.".into(), 0.3, vec2(0.5, -1.0))
    );
    // A row that is shorter than the first is an error of this wall.
    window.get_by_label("Cells").type_text("#\n#");
    settle(&mut window);
    assert!(
        self::editor(&mut window).diagnostics().iter().any(|found| found.path == "walls[0].cells.rows[2]")
    );
}

#[test]
fn the_kind_of_motion_and_rule_can_be_chosen() {
    let mut window = editing();
    select(&mut window, Selection::Obstacle(0));
    click(&mut window, "Motion");
    click(&mut window, "Orbit");
    let motion = edited_scenario(&mut window).obstacles[0].motion.clone();
    assert_eq!(motion, ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s: 0.15.into() });
    assert!(window.query_by_label("Radius 0.849 m, 0.127 m/s").is_some());
    click(&mut window, "Motion");
    click(&mut window, "Back and forth");
    write(&mut window, "Speed", "0.3");
    click(&mut window, "Redraw path");
    assert!(matches!(editor(&mut window).tool(), Tool::Path { .. }));
    editor(&mut window).click_with_tool(vec2(0.6, 1.6), false);
    settle(&mut window);
    click(&mut window, "Finish path");
    let expected = ObstacleMotion::BackAndForth { waypoints_m: vec![vec2(0.6, 1.6)], speed_m_s: 0.3.into() };
    assert_eq!(edited_scenario(&mut window).obstacles[0].motion, expected);

    select(&mut window, Selection::Starts);
    click(&mut window, "Placement");
    click(&mut window, "Fixed");
    click(&mut window, "Fixed heading");
    write(&mut window, "Heading", "-90");
    let expected = PlacementRule::Fixed { position_m: vec2(0.0, 0.0), heading_rad: Some(-1.5708) };
    assert_eq!(edited_scenario(&mut window).starts, expected);
    click(&mut window, "Placement");
    click(&mut window, "List");
    click(&mut window, "Add positions");
    editor(&mut window).click_with_tool(vec2(1.5, 0.0), false);
    settle(&mut window);
    click(&mut window, "Finish");
    assert_eq!(
        edited_scenario(&mut window).starts,
        PlacementRule::OneOf { positions_m: vec![vec2(0.0, 0.0), vec2(1.5, 0.0)] }
    );
    click(&mut window, "Remove start 1");
    assert_eq!(
        edited_scenario(&mut window).starts,
        PlacementRule::OneOf { positions_m: vec![vec2(1.5, 0.0)] }
    );
}

#[test]
fn the_settings_of_the_scenario_are_in_groups() {
    let mut window = editing();
    assert!(window.query_by_label("Goal radius").is_none(), "groups are closed at first");
    click(&mut window, "Episodes");
    write(&mut window, "Time limit in steps", "800");
    press_on(&mut window, "Robot");
    write(&mut window, "Motion 3 speed", "0.2");
    press_on(&mut window, "Remove motion 1");
    press_on(&mut window, "Add motion");
    press_on(&mut window, "Enclosure");
    write(&mut window, "Size width", "5");
    let scenario = edited_scenario(&mut window);
    assert_eq!(scenario.task.max_episode_steps, 800);
    assert_eq!(scenario.robot.motions.len(), 5);
    assert_eq!(scenario.robot.motions[1].v_m_s, 0.2, "formerly the third");
    assert_eq!(scenario.enclosure, Enclosure::Rectangle { width_m: 5.0, height_m: 4.0 });
    press_on(&mut window, "Shape");
    click(&mut window, "Polygon");
    assert_eq!(editor(&mut window).selection(), Selection::Enclosure);
    write(&mut window, "Corner 1 x", "-2");
    click(&mut window, "Deselect");
    assert_eq!(editor(&mut window).selection(), Selection::Nothing);
}

#[test]
fn the_name_can_be_edited_and_unsaved_changes_are_marked() {
    let mut window = editing();
    assert!(window.query_by_label("scenario-1").is_some());
    write(&mut window, "Scenario name", "Four posts");
    assert_eq!(edited_scenario(&mut window).name, "Four posts");
    assert!(window.query_by_label("scenario-1 · modified").is_some());
    click(&mut window, "Undo");
    assert_eq!(edited_scenario(&mut window).name, "Scenario I", "typing was one step");
    assert!(window.query_by_label("scenario-1").is_some());
}

#[test]
fn clicking_a_problem_selects_its_item_or_opens_its_group() {
    let mut window = editing();
    assert!(window.query_by_label("No problems").is_some());
    editor(&mut window).edit("x", |s| s.obstacles[1].position_m = vec2(-1.95, 0.6));
    settle(&mut window);
    assert!(window.query_by_label("No problems").is_none());
    assert!(window.query_by_label("1 problem").is_some());
    window.get_by_label_contains("`obstacles[1]").click();
    assert_eq!(sent_commands(&mut window), []);
    assert_eq!(editor(&mut window).selection(), Selection::Obstacle(1));
    for label in ["Continue here", "Restart here"] {
        assert_eq!(click(&mut window, label), [], "{label} is disabled");
    }
    assert!(window.query_by_label("Fix the problems first").is_some());
    // Clicking the problem of a scenario setting opens the setting's group.
    click(&mut window, "Undo");
    editor(&mut window).edit("limit", |s| s.task.max_episode_steps = 0);
    settle(&mut window);
    window.get_by_label_contains("`task.max_episode_steps`").click();
    settle(&mut window);
    assert!(window.query_by_label("Time limit in steps").is_some());
}

#[test]
fn a_path_through_an_obstacle_is_noted_and_blocks_nothing() {
    let mut window = editing();
    let motion = ObstacleMotion::BackAndForth { waypoints_m: vec![vec2(0.6, 0.6)], speed_m_s: 0.1.into() };
    editor(&mut window).edit("x", |s| s.obstacles[1].motion = motion);
    settle(&mut window);
    assert!(window.query_by_label("No problems").is_none() && window.query_by_label("1 note").is_some());
    window
        .get_by_label_contains("`obstacles[1].motion` crosses obstacle 1 (`obstacles[0]`) at (0.60, 0.60)")
        .click();
    settle(&mut window);
    assert_eq!(editor(&mut window).selection(), Selection::Obstacle(1));
    let place = editor(&mut window).notes()[0].position_m.expect("on the map");
    assert!(place.distance(vec2(0.6, 0.6)) < 0.05, "{place}");
    assert!(!click(&mut window, "Continue here").is_empty(), "training may continue");
}

#[test]
fn training_continues_or_restarts_in_the_edited_scenario() {
    let mut window = editing();
    assert_eq!(click(&mut window, "Continue here"), [], "it is running already");
    assert!(window.query_by_label("This scenario is already running").is_some());
    click(&mut window, "Add a circle");
    let scenario = edited_scenario(&mut window);
    let command = Command::ApplyScenario { scenario, from: "scenario-1".into(), restart: false };
    assert_eq!(click(&mut window, "Continue here"), [command]);
    assert!(window.state().view_state.editor.is_none(), "the editor is closed");

    let mut window = editing();
    window.state_mut().status.restart_loses_training = true;
    settle(&mut window);
    assert_eq!(click(&mut window, "Restart here"), []);
    assert!(window.query_by_label("Discard this training run (1,284 episodes)?").is_some());
    // A double-click does not answer the question.
    let place = window.get_by_label("Restart here").rect().center();
    for _ in 0..2 {
        window.hover_at(place);
        window.drag_at(place);
        window.event(release_event(place));
        assert_eq!(sent_commands(&mut window), []);
    }
    assert_eq!(click(&mut window, "Cancel"), []);
    assert_eq!(click(&mut window, "Restart here"), []);
    let scenario = edited_scenario(&mut window);
    let command = Command::ApplyScenario { scenario, from: "scenario-1".into(), restart: true };
    assert_eq!(click(&mut window, "Discard"), [command]);
    assert!(window.state().view_state.editor.is_none());

    let mut window = editing();
    window.state_mut().status.restart_loses_training = true;
    settle(&mut window);
    click(&mut window, "Restart here");
    let scenario = edited_scenario(&mut window);
    let command = Command::ApplyScenario { scenario, from: "scenario-1".into(), restart: true };
    assert_eq!(click(&mut window, "Save first"), [Command::SaveFirst(Box::new(command))]);
}

#[test]
fn training_cannot_continue_with_another_number_of_beams() {
    let mut window = editing();
    click(&mut window, "LIDAR");
    write(&mut window, "Beams", "36");
    assert!(window.query_by_label_contains("expects 24 beams and 5 motions").is_some());
    assert_eq!(click(&mut window, "Continue here"), []);
    assert!(window.state().view_state.editor.is_some());
    let commands = click(&mut window, "Restart here");
    assert!(matches!(commands[..], [Command::ApplyScenario { restart: true, .. }]), "{commands:?}");
}

#[test]
fn scenarios_are_saved_and_opened() {
    let mut window = editing();
    click(&mut window, "Add a circle");
    let scenario = edited_scenario(&mut window);
    let save = |path: Option<&str>, based_on: &str| Command::SaveScenario {
        scenario: scenario.clone(),
        based_on: based_on.into(),
        path: path.map(PathBuf::from),
    };
    assert_eq!(click(&mut window, "Save"), [save(None, "scenario-1")], "a built-in scenario has no file");
    let saved = EditorReply::Saved { file: "scenarios/mine.ron".into(), scenario: scenario.clone() };
    window.state_mut().view_state.receive(&saved);
    settle(&mut window);
    assert!(window.query_by_label("mine.ron").is_some(), "not modified any more");
    assert_eq!(click(&mut window, "Save"), [save(Some("scenarios/mine.ron"), "scenarios/mine.ron")]);
    assert_eq!(click(&mut window, "Save as…"), [save(None, "scenarios/mine.ron")]);
    window.state_mut().status.has_disk = false;
    settle(&mut window);
    assert_eq!(
        click(&mut window, "Save"),
        [save(None, "scenarios/mine.ron")],
        "a browser cannot overwrite a file"
    );

    assert_eq!(click(&mut window, "Open…"), [Command::OpenInEditor(None)]);
    let scenarios = &mut window.state_mut().status.scenarios;
    let mut map = scenarios[0].clone();
    (map.from, map.title) = ("office.yaml".into(), "Office".into());
    scenarios.insert(0, map);
    settle(&mut window);
    assert_eq!(click(&mut window, "New from…"), []);
    assert!(window.query_by_label("Office").is_none(), "an imported map is not built-in");
    assert_eq!(click(&mut window, "Scenario II"), [Command::OpenInEditor(Some("scenario-2".into()))]);
    let opened = Scenario { name: "Two".into(), ..Scenario::default() };
    let reply = EditorReply::Opened { from: "scenario-2".into(), scenario: Arc::new(opened.clone()) };
    window.state_mut().view_state.receive(&reply);
    settle(&mut window);
    assert_eq!(*edited_scenario(&mut window), opened);
    click(&mut window, "Undo");
    assert_eq!(edited_scenario(&mut window), scenario, "undo brings the edited scenario back");
}

#[test]
fn closing_asks_about_unsaved_changes() {
    let mut window = editing();
    assert_eq!(click(&mut window, "Close the editor"), []);
    assert!(window.state().view_state.editor.is_none());
    let mut window = editing();
    click(&mut window, "Add a circle");
    click(&mut window, "Close the editor");
    assert!(window.state().view_state.editor.is_some());
    click(&mut window, "Discard changes");
    assert!(window.state().view_state.editor.is_none());
}

#[test]
fn the_grid_can_be_chosen() {
    let mut window = editing();
    click(&mut window, "Grid");
    click(&mut window, "0.25 m");
    assert_eq!((editor(&mut window).snap.on, editor(&mut window).snap.step_m), (true, 0.25));
    click(&mut window, "Grid");
    click(&mut window, "Off");
    assert!(!editor(&mut window).snap.on);
}

/// The rightmost edge of the controls on the panel.
fn widest(window: &Window, panel: f32) -> f32 {
    let on_it = window.get_all_by(|node| {
        let named = node.label().is_some() || node.value().is_some();
        named && node.bounding_box().is_some_and(|at| (at.x0 as f32) < panel - 20.0 && at.y0 > 60.0)
    });
    on_it.map(|node| node.rect().max.x).fold(0.0, f32::max)
}

#[test]
fn nothing_is_wider_than_the_panel() {
    let mut scenario = screen_fixture::mixed_scenario();
    // Long numbers.
    let shape = Shape::Rectangle { width_m: 12.125, height_m: 10.375 };
    let motion =
        ObstacleMotion::Patrol { waypoints_m: vec![vec2(-10.125, -10.125)], speed_m_s: 0.125.into() };
    scenario.obstacles.push(Obstacle {
        shape,
        position_m: vec2(-12.125, -12.125),
        rotation_rad: 2.0,
        motion,
    });
    let obstacles = (0..scenario.obstacles.len()).map(Selection::Obstacle);
    let others = [
        Selection::Nothing,
        Selection::Enclosure,
        Selection::Wall(0),
        Selection::Generator(0),
        Selection::Starts,
        Selection::Goals,
        Selection::BenchmarkStart,
        Selection::BenchmarkGoal,
    ];
    let mut window = editing_in(ScreenFixture::default().with_scenario(scenario.clone()));
    for selection in obstacles.chain(others) {
        select(&mut window, selection);
        let widest = widest(&window, 248.0);
        assert!(widest > 200.0 && widest <= 248.0, "{selection:?}: {widest}");
    }
    for group in ["Robot", "LIDAR", "Episodes", "Enclosure", "Starts", "Goals", "Benchmark route", "About"] {
        select(&mut window, Selection::Nothing);
        press_on(&mut window, group);
        let widest = widest(&window, 248.0);
        assert!(widest <= 248.0, "{group}: {widest}");
        press_on(&mut window, group);
    }
}

#[test]
fn a_low_panel_scrolls_as_a_whole() {
    let mut screen_fixture = ScreenFixture::default();
    (screen_fixture.view_state.plots_open, screen_fixture.view_state.setup_open) = (false, true);
    open(&mut screen_fixture, "scenario-1");
    let mut window = window_with_size(screen_fixture, [420.0, 800.0]);
    click(&mut window, "Add a circle");
    select(&mut window, Selection::Obstacle(4));
    let add = window.get_by_label("Add a circle").rect();
    window.get_by_label("Save as…").scroll_to_me();
    settle(&mut window);
    assert!(window.get_by_label("Add a circle").rect().min.y < add.min.y);
    let commands = click(&mut window, "Save as…");
    assert!(matches!(commands[..], [Command::SaveScenario { path: None, .. }]), "{commands:?}");
}

#[test]
fn rules_without_positions_are_edited_in_their_groups() {
    let mut window = editing();
    click(&mut window, "Goals");
    write(&mut window, "Clearance", "0.4");
    assert_eq!(edited_scenario(&mut window).goals, PlacementRule::Random { clearance_m: 0.4 });
    editor(&mut window).set_rule(PlacementRole::Goals, PlacementKind::Within);
    settle(&mut window);
    write(&mut window, "From x", "-1.5");
    let (min_m, max_m) = (vec2(-1.5, -1.0), vec2(1.0, 1.0));
    assert_eq!(edited_scenario(&mut window).goals, PlacementRule::Within { min_m, max_m, clearance_m: 0.4 });
}

#[test]
fn unfinished_typing_stays_with_its_item() {
    let mut window = editing();
    select(&mut window, Selection::Obstacle(0));
    press_on(&mut window, "Radius");
    window.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
    window.get_by_label("Radius").type_text("0.3");
    settle(&mut window);
    select(&mut window, Selection::Obstacle(1));
    let focused = window.ctx.memory(egui::Memory::focused);
    assert_eq!(focused, None, "the fields of another item do not get the focus");
    window.key_press(Key::Enter);
    settle(&mut window);
    let radii: Vec<_> = edited_scenario(&mut window).obstacles.iter().map(|o| o.shape.clone()).collect();
    let circle = |radius_m| Shape::Circle { radius_m };
    assert_eq!(radii, [circle(0.3), circle(0.15), circle(0.15), circle(0.15)]);
}

/// Presses Tab from the scenario name through the whole panel. Returns the number of stops.
fn tab_through(window: &mut Window) -> usize {
    press_on(window, "Scenario name");
    let mut seen = Vec::new();
    while let Some(focused) = window.ctx.memory(egui::Memory::focused) {
        if seen.contains(&focused) || seen.len() > 300 {
            break;
        }
        seen.push(focused);
        window.key_press(Key::Tab);
        window.run_steps(2);
    }
    seen.len()
}

#[test]
fn visiting_a_field_changes_nothing() {
    let mut odd = screen_fixture::mixed_scenario();
    odd.robot.motions[0] = Motion { v_m_s: 0.6127, w_rad_s: 1.5 };
    odd.robot.radius_m = 0.06127;
    odd.lidar.field_of_view_rad = 0.4;
    odd.lidar.dropout = 0.012345.into();
    odd.task.collision_range_m = 0.10004;
    odd.benchmark_route.get_or_insert_default().heading_rad = 0.4;
    odd.starts = PlacementRule::Fixed { position_m: vec2(0.6127, 0.00004), heading_rad: Some(0.4) };
    odd.obstacles = vec![Obstacle {
        shape: Shape::Rectangle { width_m: 0.61274, height_m: 0.12345 },
        position_m: vec2(0.61274, 1.00004),
        // More than a full turn, which a file may have.
        rotation_rad: 7.0,
        motion: ObstacleMotion::Orbit { centre_m: vec2(0.61274, 0.1), speed_rad_s: 1.5.into() },
    }];
    let mut window = editing_in(ScreenFixture::default().with_scenario(odd.clone()));
    let groups = ["About", "Enclosure", "Robot", "LIDAR", "Episodes", "Starts", "Goals", "Benchmark route"];
    for group in groups {
        press_on(&mut window, group);
    }
    let stops = tab_through(&mut window);
    assert!(stops > 60, "{stops}");
    select(&mut window, Selection::Obstacle(0));
    let stops = tab_through(&mut window);
    assert!(stops > 20, "{stops}");
    assert_eq!(*edited_scenario(&mut window), odd);
    assert!(!editor(&mut window).can_undo() && !editor(&mut window).is_modified());
    // Clicking a number and leaving it changes nothing, either.
    press_on(&mut window, "Rotation");
    window.key_press(Key::Enter);
    settle(&mut window);
    assert!(!editor(&mut window).can_undo());
    write(&mut window, "Rotation", "90");
    assert_eq!(edited_scenario(&mut window).obstacles[0].rotation_rad, 1.5708);
}

#[test]
fn two_open_groups_have_separate_choices() {
    let mut window = editing();
    press_on(&mut window, "Starts");
    press_on(&mut window, "Goals");
    for (k, which) in [PlacementRole::Starts, PlacementRole::Goals].into_iter().enumerate() {
        select(&mut window, Selection::Nothing);
        let list = |window: &Window| {
            let all: Vec<_> = window.get_all_by_role_and_label(Role::ComboBox, "Placement").collect();
            assert_eq!(all.len(), 2);
            all[k].scroll_to_me();
            all[k].rect()
        };
        list(&window);
        window.run_steps(40);
        let at = list(&window).center();
        window.hover_at(at);
        window.drag_at(at);
        window.event(release_event(at));
        settle(&mut window);
        click(&mut window, "In a region");
        assert_eq!(
            PlacementKind::from_rule(which.of(&edited_scenario(&mut window))),
            PlacementKind::Within,
            "{which:?}"
        );
    }
}

#[test]
fn a_useless_heading_of_a_goal_can_be_removed() {
    let mut scenario = Scenario::clone(&ScreenFixture::default().scene.scenario);
    scenario.goals = PlacementRule::Fixed { position_m: vec2(1.0, 0.0), heading_rad: Some(0.4) };
    let mut window = editing_in(ScreenFixture::default().with_scenario(scenario));
    select(&mut window, Selection::Goals);
    click(&mut window, "Fixed heading");
    assert_eq!(
        edited_scenario(&mut window).goals,
        PlacementRule::Fixed { position_m: vec2(1.0, 0.0), heading_rad: None }
    );
    assert!(window.query_by_label("Fixed heading").is_none());
}

#[test]
fn the_restart_question_is_gone_when_the_editor_is_opened_again() {
    let mut window = editing();
    window.state_mut().status.restart_loses_training = true;
    settle(&mut window);
    click(&mut window, "Restart here");
    assert!(window.query_by_label_contains("Discard this training run").is_some());
    click(&mut window, "Close the editor");
    settle(&mut window);
    click(&mut window, "Edit");
    assert!(window.query_by_label("Close the editor").is_some());
    assert!(window.query_by_label_contains("Discard this training run").is_none());
    // Also if the editor is closed by its key.
    click(&mut window, "Restart here");
    assert!(window.query_by_label_contains("Discard this training run").is_some());
    window.key_press(Key::E);
    settle(&mut window);
    assert!(window.state().view_state.editor.is_none());
    click(&mut window, "Edit");
    assert!(window.query_by_label_contains("Discard this training run").is_none());
}

#[test]
fn a_new_item_is_placed_in_the_middle_of_the_view() {
    let mut window = editing();
    window.state_mut().view_state.camera = ViewCamera { centre_m: [1.0, 0.0], zoom: 4.0 };
    settle(&mut window);
    editor(&mut window).edit("enclosure", |scenario| {
        let corners_m = vec![vec2(-2.0, -2.0), vec2(8.0, -2.0), vec2(8.0, 2.0), vec2(-2.0, 2.0)];
        scenario.enclosure = Enclosure::Polygon { corners_m };
    });
    settle(&mut window);
    click(&mut window, "Add a circle");
    // The view stays at (1, 0); it does not follow the new centre.
    let Vec2 { x, y } = edited_scenario(&mut window).obstacles[4].position_m;
    assert!((x - 1.0).hypot(y) < 0.6, "{x}, {y}");
}

#[test]
fn the_editor_opens_a_saved_version_that_was_not_applied() {
    let mut screen_fixture = ScreenFixture::default();
    let mut newer = Scenario::clone(&screen_fixture.scene.scenario);
    newer.task.max_episode_steps = 77;
    let newer = Arc::new(newer);
    (screen_fixture.status.scenario_from, screen_fixture.status.scenario_modified) =
        ("scenarios/mine.ron".into(), true);
    screen_fixture.status.saved_scenario = Some(("scenarios/mine.ron".into(), newer.clone()));
    let mut window = window(screen_fixture);
    click(&mut window, "Edit");
    assert_eq!(edited_scenario(&mut window), newer);
    assert!(!editor(&mut window).is_modified());
    // Neither a version saved to another file nor an outdated one is opened.
    for (path, changed) in [("scenarios/other.ron", true), ("scenarios/mine.ron", false)] {
        let mut screen_fixture = ScreenFixture::default();
        (screen_fixture.status.scenario_from, screen_fixture.status.scenario_modified) =
            ("scenarios/mine.ron".into(), changed);
        screen_fixture.status.saved_scenario = Some((path.into(), newer.clone()));
        let running = screen_fixture.scene.scenario.clone();
        let mut window = self::window(screen_fixture);
        click(&mut window, "Edit");
        assert_eq!(edited_scenario(&mut window), running, "{path}");
        assert_eq!(editor(&mut window).is_modified(), changed);
    }
}

/// Begins a wall with two corners.
fn draw_half_a_wall(window: &mut Window) {
    click(window, "Draw a wall");
    for at in [vec2(-1.0, 1.2), vec2(1.0, 1.2)] {
        editor(window).click_with_tool(at, false);
    }
    settle(window);
}

#[test]
fn an_unfinished_wall_is_not_lost() {
    let mut window = editing();
    draw_half_a_wall(&mut window);
    click(&mut window, "Close the editor");
    let question = "The unfinished wall and all unsaved changes will be lost.";
    assert!(window.query_by_label(question).is_some());
    click(&mut window, "Keep editing");
    assert!(window.query_by_label(question).is_none());
    let saved = |commands: Vec<Command>| match &commands[..] {
        [Command::SaveScenario { scenario, .. } | Command::ApplyScenario { scenario, .. }] => {
            scenario.walls.len()
        }
        _ => panic!("{commands:?}"),
    };
    assert_eq!(saved(click(&mut window, "Save")), 1);
    assert_eq!(*editor(&mut window).tool(), Tool::Select);
    for label in ["Save as…", "Continue here", "Restart here"] {
        let mut window = editing();
        draw_half_a_wall(&mut window);
        assert_eq!(saved(click(&mut window, label)), 1, "{label}");
    }
    let mut window = editing();
    draw_half_a_wall(&mut window);
    window.key_press_modifiers(egui::Modifiers::COMMAND, Key::S);
    assert_eq!(saved(sent_commands(&mut window)), 1);
    // An invalid wall is not applied.
    let mut window = editing();
    click(&mut window, "Draw a wall");
    for at in [vec2(-1.0, 0.6), vec2(1.0, 5.0)] {
        editor(&mut window).click_with_tool(at, false);
    }
    settle(&mut window);
    assert_eq!(click(&mut window, "Continue here"), []);
    assert_eq!(
        (edited_scenario(&mut window).walls.len(), editor(&mut window).diagnostics().is_empty()),
        (1, false)
    );
}

#[test]
fn a_long_list_says_where_the_rest_can_be_edited() {
    let mut long = Scenario::clone(&ScreenFixture::default().scene.scenario);
    long.robot.motions = vec![Motion { v_m_s: 0.1, w_rad_s: 0.0 }; 40];
    let mut window = editing_in(ScreenFixture::default().with_scenario(long));
    press_on(&mut window, "Robot");
    assert!(window.query_by_label("and 8 more: edit them in the file").is_some());
}

#[test]
fn a_static_obstacle_can_be_given_a_path() {
    let mut window = editing();
    select(&mut window, Selection::Obstacle(0));
    click(&mut window, "Draw path");
    editor(&mut window).click_with_tool(vec2(0.6, 1.6), false);
    settle(&mut window);
    click(&mut window, "Finish path");
    let motion = edited_scenario(&mut window).obstacles[0].motion.clone();
    assert_eq!(motion, ObstacleMotion::Patrol { waypoints_m: vec![vec2(0.6, 1.6)], speed_m_s: 0.1.into() });
    assert!(window.query_by_label("Redraw path").is_some());
}

#[test]
fn when_training_over_a_set_a_copy_of_the_shown_scenario_can_be_edited() {
    let mut window = window(ScreenFixture::default());
    let ScreenFixture { scene, status, .. } = window.state_mut();
    status.is_set = true;
    scene.arenas.iter_mut().for_each(|arena| arena.set_member = Some("Clutter, level 17".into()));
    settle(&mut window);
    assert!(window.query_by_label("Save scenario…").is_none(), "the app does not write sets");
    press(&mut window, Key::E);
    assert!(window.query_by_label_contains("A set of scenarios cannot be edited here").is_some());
    assert!(window.state().view_state.editor.is_none());
    click(&mut window, "Cancel");
    assert!(window.query_by_label_contains("A set of scenarios cannot be edited here").is_none());
    press(&mut window, Key::E);
    click(&mut window, "Edit a copy of Clutter, level 17");
    let editor = window.state().view_state.editor.as_ref().expect("the editor is open");
    assert_eq!(**editor.scenario(), *window.state().scene.arenas[0].written);
    assert_eq!(editor.file(), None, "the copy is a file of its own once it is saved");
    assert!(window.query_by_label_contains("Restart to train in this scenario").is_some());
}
