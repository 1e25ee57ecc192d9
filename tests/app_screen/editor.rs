//! The editor's panel: what is typed, chosen and pressed there, and what becomes of the world.
#![expect(clippy::approx_constant, reason = "angles as a file has them, to four decimals")]

use std::path::PathBuf;
use std::sync::Arc;

use bevy::math::{Vec2, vec2};
use egui::Key;
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use wayfield::app::commands::{Command, EditorReply};
use wayfield::app::editor::{Editor, PlacementKind, PlacementRole, Selection, Tool};
use wayfield::app::view_state::ViewCamera;
use wayfield::scenario::{Enclosure, Motion, Obstacle, ObstacleMotion, PlacementRule, Scenario, Shape};

use super::{Window, click, release_event, sent_commands, settle, window, window_with_size};
use crate::screen_fixture::{self, ScreenFixture};

/// A window in which the screen_fixture's own world is edited: four cylinders of 0.15 m in a square of 4 m.
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

/// Presses what may have to be scrolled to first.
fn press_on(window: &mut Window, label: &str) -> Vec<Command> {
    window.get_by_label(label).scroll_to_me();
    window.run_steps(40);
    click(window, label)
}

/// Writes `text` in place of what is in the field.
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
fn a_number_that_is_typed_is_one_step() {
    let mut window = editing();
    select(&mut window, Selection::Obstacle(2));
    assert!(window.query_by_label("Obstacle 3 of 4").is_some());
    write(&mut window, "Radius", "0.25");
    write(&mut window, "Position x", "-0.755");
    let obstacle = edited_scenario(&mut window).obstacles[2].clone();
    assert_eq!(obstacle.shape, Shape::Circle { radius_m: 0.25 });
    assert_eq!(obstacle.position_m, vec2(-0.755, -0.6));
    assert_eq!(click(&mut window, "Undo"), []);
    assert_eq!(edited_scenario(&mut window).obstacles[2].position_m, vec2(-0.6, -0.6), "with all its digits");
    click(&mut window, "Undo");
    assert_eq!(edited_scenario(&mut window).obstacles[2].shape, Shape::Circle { radius_m: 0.15 });
    click(&mut window, "Redo");
    assert_eq!(edited_scenario(&mut window).obstacles[2].shape, Shape::Circle { radius_m: 0.25 });
}

#[test]
fn angles_are_degrees_here_and_radians_there() {
    let mut window = editing();
    click(&mut window, "Add a box");
    write(&mut window, "Turned", "30");
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
        "the default, to the bit"
    );
    write(&mut window, "Lost beams", "2.5");
    assert_eq!(edited_scenario(&mut window).lidar.dropout, 0.025);
}

#[test]
fn what_is_added_is_selected_copied_and_deleted() {
    let mut window = editing();
    for (label, count) in [
        ("Add a circle", 5),
        ("Add a rod with round ends", 6),
        ("Add a polygon of three corners", 7),
        ("Add a polygon of six corners", 8),
        ("Duplicate", 9),
        ("Delete", 8),
    ] {
        assert_eq!(click(&mut window, label), [], "{label}");
        assert_eq!(edited_scenario(&mut window).obstacles.len(), count, "{label}");
    }
    assert_eq!(editor(&mut window).selection(), Selection::Nothing);
    click(&mut window, "Add obstacles that are drawn anew for every episode");
    assert_eq!(editor(&mut window).selection(), Selection::Generator(0));
    write(&mut window, "How many", "7");
    assert_eq!(editor(&mut window).diagnostics(), []);
    click(&mut window, "Only in a region");
    let generator = edited_scenario(&mut window).generators[0].clone();
    assert_eq!((generator.count, generator.within.map(|r| r.min_m)), (7, Some(vec2(-1.0, -1.0))));
    // The middle is full by now.
    let told =
        editor(&mut window).diagnostics().iter().map(|finding| finding.path.as_str()).collect::<Vec<_>>();
    assert_eq!(told, ["generators"]);
}

#[test]
fn a_wall_is_drawn_with_the_tool() {
    let mut window = editing();
    click(&mut window, "Draw a wall");
    for at in [vec2(-1.0, 1.2), vec2(1.0, 1.2)] {
        editor(&mut window).click_with_tool(at, false);
    }
    settle(&mut window);
    click(&mut window, "The wall is done");
    assert_eq!(editor(&mut window).selection(), Selection::Wall(0));
    write(&mut window, "Corner 2 y", "1");
    assert_eq!(edited_scenario(&mut window).walls[0].corners_m, [vec2(-1.0, 1.2), vec2(1.0, 1.0)]);
    assert!(window.query_by_label("Remove corner 1").is_none(), "two are left");
}

#[test]
fn motions_and_rules_are_chosen_by_kind() {
    let mut window = editing();
    select(&mut window, Selection::Obstacle(0));
    click(&mut window, "Motion");
    click(&mut window, "Orbit");
    let motion = edited_scenario(&mut window).obstacles[0].motion.clone();
    assert_eq!(motion, ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s: 0.15 });
    assert!(window.query_by_label("0.849 m away: 0.127 m/s").is_some(), "what that means");
    click(&mut window, "Motion");
    click(&mut window, "Back and forth");
    write(&mut window, "Speed", "0.3");
    click(&mut window, "Draw its path anew");
    assert!(matches!(editor(&mut window).tool(), Tool::Path { .. }));
    editor(&mut window).click_with_tool(vec2(0.6, 1.6), false);
    settle(&mut window);
    click(&mut window, "Path is done");
    let expected = ObstacleMotion::BackAndForth { waypoints_m: vec![vec2(0.6, 1.6)], speed_m_s: 0.3 };
    assert_eq!(edited_scenario(&mut window).obstacles[0].motion, expected);

    select(&mut window, Selection::Starts);
    click(&mut window, "Where");
    click(&mut window, "One place");
    click(&mut window, "Looks one way");
    write(&mut window, "Heading", "-90");
    let expected = PlacementRule::Fixed { position_m: vec2(0.0, 0.0), heading_rad: Some(-1.5708) };
    assert_eq!(edited_scenario(&mut window).starts, expected);
    click(&mut window, "Where");
    click(&mut window, "Some places");
    click(&mut window, "Click more places");
    editor(&mut window).click_with_tool(vec2(1.5, 0.0), false);
    settle(&mut window);
    click(&mut window, "Done");
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
fn the_worlds_own_numbers_are_in_groups() {
    let mut window = editing();
    assert!(window.query_by_label("Goal radius").is_none(), "closed to begin with");
    click(&mut window, "Episodes");
    write(&mut window, "Time limit in steps", "800");
    press_on(&mut window, "Robot");
    write(&mut window, "Motion 3 speed", "0.2");
    press_on(&mut window, "Remove motion 1");
    press_on(&mut window, "Add a motion");
    press_on(&mut window, "Enclosure");
    write(&mut window, "Size width", "5");
    let world = edited_scenario(&mut window);
    assert_eq!(world.task.max_episode_steps, 800);
    assert_eq!(world.robot.motions.len(), 5);
    assert_eq!(world.robot.motions[1].v_m_s, 0.2, "the third of before");
    assert_eq!(world.enclosure, Enclosure::Rectangle { width_m: 5.0, height_m: 4.0 });
    press_on(&mut window, "Outline");
    click(&mut window, "Polygon");
    assert_eq!(editor(&mut window).selection(), Selection::Enclosure);
    write(&mut window, "Corner 1 x", "-2");
    click(&mut window, "Select nothing");
    assert_eq!(editor(&mut window).selection(), Selection::Nothing);
}

#[test]
fn the_name_is_written_and_what_changed_is_marked() {
    let mut window = editing();
    assert!(window.query_by_label("scenario-1").is_some());
    write(&mut window, "Name of the world", "Four posts");
    assert_eq!(edited_scenario(&mut window).name, "Four posts");
    assert!(window.query_by_label("scenario-1 · changed").is_some());
    click(&mut window, "Undo");
    assert_eq!(edited_scenario(&mut window).name, "Scenario I", "all of it was one step");
    assert!(window.query_by_label("scenario-1").is_some());
}

#[test]
fn what_is_wrong_is_listed_and_leads_to_the_thing() {
    let mut window = editing();
    assert!(window.query_by_label("No problems").is_some());
    editor(&mut window).edit("x", |s| s.obstacles[1].position_m = vec2(-1.95, 0.6));
    settle(&mut window);
    assert!(window.query_by_label("No problems").is_none());
    assert!(window.query_by_label("1 problem").is_some());
    window.get_by_label_contains("`obstacles[1]").click();
    assert_eq!(sent_commands(&mut window), []);
    assert_eq!(editor(&mut window).selection(), Selection::Obstacle(1));
    for label in ["Go on here", "Start again here"] {
        assert_eq!(click(&mut window, label), [], "{label}: not in a world that can't be");
    }
    assert!(window.query_by_label("First mend what is wrong.").is_some());
    // What belongs to nothing in the world opens its group.
    click(&mut window, "Undo");
    editor(&mut window).edit("limit", |s| s.task.max_episode_steps = 0);
    settle(&mut window);
    window.get_by_label_contains("`task.max_episode_steps`").click();
    settle(&mut window);
    assert!(window.query_by_label("Time limit in steps").is_some());
}

#[test]
fn training_goes_on_or_begins_again_in_the_changed_world() {
    let mut window = editing();
    assert_eq!(click(&mut window, "Go on here"), [], "it runs there already");
    assert!(window.query_by_label("This is the world that runs.").is_some());
    click(&mut window, "Add a circle");
    let scenario = edited_scenario(&mut window);
    let go_on = Command::ApplyScenario { scenario, from: "scenario-1".into(), restart: false };
    assert_eq!(click(&mut window, "Go on here"), [go_on]);
    assert!(window.state().view_state.editor.is_none(), "and the world itself is seen again");

    let mut window = editing();
    window.state_mut().status.restart_loses_training = true;
    settle(&mut window);
    assert_eq!(click(&mut window, "Start again here"), []);
    assert!(window.query_by_label("This training of 1,284 episodes will be gone.").is_some());
    // A second click in the same place is no answer.
    let place = window.get_by_label("Start again here").rect().center();
    for _ in 0..2 {
        window.hover_at(place);
        window.drag_at(place);
        window.event(release_event(place));
        assert_eq!(sent_commands(&mut window), []);
    }
    assert_eq!(click(&mut window, "Keep it"), []);
    assert_eq!(click(&mut window, "Start again here"), []);
    let scenario = edited_scenario(&mut window);
    let again = Command::ApplyScenario { scenario, from: "scenario-1".into(), restart: true };
    assert_eq!(click(&mut window, "Start again"), [again]);
    assert!(window.state().view_state.editor.is_none());
}

#[test]
fn a_network_made_for_other_beams_does_not_go_on() {
    let mut window = editing();
    click(&mut window, "LIDAR");
    write(&mut window, "Beams", "36");
    assert!(window.query_by_label_contains("made for 24 beams and 5 motions").is_some());
    assert_eq!(click(&mut window, "Go on here"), []);
    assert!(window.state().view_state.editor.is_some());
    let commands = click(&mut window, "Start again here");
    assert!(matches!(commands[..], [Command::ApplyScenario { restart: true, .. }]), "{commands:?}");
}

#[test]
fn worlds_are_saved_and_opened() {
    let mut window = editing();
    click(&mut window, "Add a circle");
    let scenario = edited_scenario(&mut window);
    let save = |path: Option<&str>, based_on: &str| Command::SaveScenario {
        scenario: scenario.clone(),
        based_on: based_on.into(),
        path: path.map(PathBuf::from),
    };
    assert_eq!(
        click(&mut window, "Save"),
        [save(None, "scenario-1")],
        "what came with the program has no file"
    );
    let saved = EditorReply::Saved { file: "worlds/mine.ron".into(), scenario: scenario.clone() };
    window.state_mut().view_state.receive(&saved);
    settle(&mut window);
    assert!(window.query_by_label("mine.ron").is_some(), "not changed any more");
    assert_eq!(click(&mut window, "Save"), [save(Some("worlds/mine.ron"), "worlds/mine.ron")]);
    assert_eq!(click(&mut window, "Save as…"), [save(None, "worlds/mine.ron")]);
    window.state_mut().status.has_disk = false;
    settle(&mut window);
    assert_eq!(click(&mut window, "Save"), [save(None, "worlds/mine.ron")], "a browser has no files");

    assert_eq!(click(&mut window, "Open…"), [Command::OpenInEditor(None)]);
    assert_eq!(click(&mut window, "New from…"), []);
    assert_eq!(click(&mut window, "Scenario II"), [Command::OpenInEditor(Some("scenario-2".into()))]);
    let opened = Scenario { name: "Two".into(), ..Scenario::default() };
    let reply = EditorReply::Opened { from: "scenario-2".into(), scenario: Arc::new(opened.clone()) };
    window.state_mut().view_state.receive(&reply);
    settle(&mut window);
    assert_eq!(*edited_scenario(&mut window), opened);
    click(&mut window, "Undo");
    assert_eq!(edited_scenario(&mut window), scenario, "what was edited before is not lost");
}

#[test]
fn closing_asks_about_what_is_not_saved() {
    let mut window = editing();
    assert_eq!(click(&mut window, "Close the editor"), []);
    assert!(window.state().view_state.editor.is_none());
    let mut window = editing();
    click(&mut window, "Add a circle");
    click(&mut window, "Close the editor");
    assert!(window.state().view_state.editor.is_some());
    click(&mut window, "Leave without them");
    assert!(window.state().view_state.editor.is_none());
}

#[test]
fn the_grid_is_chosen() {
    let mut window = editing();
    click(&mut window, "Grid");
    click(&mut window, "0.25 m");
    assert_eq!((editor(&mut window).snap.on, editor(&mut window).snap.step_m), (true, 0.25));
    click(&mut window, "Grid");
    click(&mut window, "Off");
    assert!(!editor(&mut window).snap.on);
}

/// The right edges of all that stands on the panel.
fn widest(window: &Window, panel: f32) -> f32 {
    let on_it = window.get_all_by(|node| {
        let named = node.label().is_some() || node.value().is_some();
        named && node.bounding_box().is_some_and(|at| (at.x0 as f32) < panel - 20.0 && at.y0 > 60.0)
    });
    on_it.map(|node| node.rect().max.x).fold(0.0, f32::max)
}

#[test]
fn nothing_is_wider_than_the_panel() {
    let mut world = screen_fixture::mixed_scenario();
    // The longest numbers that are likely.
    let shape = Shape::Rectangle { width_m: 12.125, height_m: 10.375 };
    let motion = ObstacleMotion::Patrol { waypoints_m: vec![vec2(-10.125, -10.125)], speed_m_s: 0.125 };
    world.obstacles.push(Obstacle { shape, position_m: vec2(-12.125, -12.125), rotation_rad: 2.0, motion });
    let obstacles = (0..world.obstacles.len()).map(Selection::Obstacle);
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
    let mut window = editing_in(ScreenFixture::default().with_scenario(world.clone()));
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
fn in_a_low_panel_everything_scrolls() {
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
fn rules_that_are_nowhere_in_the_world_are_changed_in_their_groups() {
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
fn what_is_being_written_stays_with_its_thing() {
    let mut window = editing();
    select(&mut window, Selection::Obstacle(0));
    press_on(&mut window, "Radius");
    window.key_press_modifiers(egui::Modifiers::COMMAND, Key::A);
    window.get_by_label("Radius").type_text("0.3");
    settle(&mut window);
    select(&mut window, Selection::Obstacle(1));
    let focused = window.ctx.memory(|memory| memory.focused());
    assert_eq!(focused, None, "nothing is being written in the fields of another thing");
    window.key_press(Key::Enter);
    settle(&mut window);
    let radii: Vec<_> = edited_scenario(&mut window).obstacles.iter().map(|o| o.shape.clone()).collect();
    let circle = |radius_m| Shape::Circle { radius_m };
    assert_eq!(radii, [circle(0.3), circle(0.15), circle(0.15), circle(0.15)]);
}

/// Goes with Tab from the name of the world through all that is on the panel; how many stops there are.
fn tab_through(window: &mut Window) -> usize {
    press_on(window, "Name of the world");
    let mut seen = Vec::new();
    while let Some(focused) = window.ctx.memory(|memory| memory.focused()) {
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
fn a_field_that_is_only_visited_changes_nothing() {
    let mut odd = screen_fixture::mixed_scenario();
    odd.robot.motions[0] = Motion { v_m_s: 0.6127, w_rad_s: 1.5 };
    odd.robot.radius_m = 0.06127;
    odd.lidar.field_of_view_rad = 0.4;
    odd.lidar.dropout = 0.012345;
    odd.task.collision_range_m = 0.10004;
    odd.benchmark_route.heading_rad = 0.4;
    odd.starts = PlacementRule::Fixed { position_m: vec2(0.6127, 0.00004), heading_rad: Some(0.4) };
    odd.obstacles = vec![Obstacle {
        shape: Shape::Rectangle { width_m: 0.61274, height_m: 0.12345 },
        position_m: vec2(0.61274, 1.00004),
        // More than a full turn, which a file may say.
        rotation_rad: 7.0,
        motion: ObstacleMotion::Orbit { centre_m: vec2(0.61274, 0.1), speed_rad_s: 1.5 },
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
    // A number that is clicked and left is as it was, too.
    press_on(&mut window, "Turned");
    window.key_press(Key::Enter);
    settle(&mut window);
    assert!(!editor(&mut window).can_undo());
    write(&mut window, "Turned", "90");
    assert_eq!(edited_scenario(&mut window).obstacles[0].rotation_rad, 1.5708);
}

#[test]
fn of_two_open_groups_each_has_its_own_list() {
    let mut window = editing();
    press_on(&mut window, "Starts");
    press_on(&mut window, "Goals");
    for (k, which) in [PlacementRole::Starts, PlacementRole::Goals].into_iter().enumerate() {
        select(&mut window, Selection::Nothing);
        let list = |window: &Window| {
            let all: Vec<_> = window.get_all_by_role_and_label(Role::ComboBox, "Where").collect();
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
fn a_heading_that_a_target_has_for_nothing_is_taken_out() {
    let mut world_m = Scenario::clone(&ScreenFixture::default().scene.scenario);
    world_m.goals = PlacementRule::Fixed { position_m: vec2(1.0, 0.0), heading_rad: Some(0.4) };
    let mut window = editing_in(ScreenFixture::default().with_scenario(world_m));
    select(&mut window, Selection::Goals);
    click(&mut window, "Looks one way");
    assert_eq!(
        edited_scenario(&mut window).goals,
        PlacementRule::Fixed { position_m: vec2(1.0, 0.0), heading_rad: None }
    );
    assert!(window.query_by_label("Looks one way").is_none());
}

#[test]
fn the_question_about_the_training_is_not_left_behind() {
    let mut window = editing();
    window.state_mut().status.restart_loses_training = true;
    settle(&mut window);
    click(&mut window, "Start again here");
    assert!(window.query_by_label_contains("will be gone").is_some());
    click(&mut window, "Close the editor");
    settle(&mut window);
    click(&mut window, "Edit");
    assert!(window.query_by_label("Close the editor").is_some());
    assert!(window.query_by_label_contains("will be gone").is_none());
    // By the key, too, which asks nobody on the panel.
    click(&mut window, "Start again here");
    assert!(window.query_by_label_contains("will be gone").is_some());
    window.key_press(Key::E);
    settle(&mut window);
    assert!(window.state().view_state.editor.is_none());
    click(&mut window, "Edit");
    assert!(window.query_by_label_contains("will be gone").is_none());
}

#[test]
fn what_is_added_stands_in_the_middle_of_the_view() {
    let mut window = editing();
    window.state_mut().view_state.camera = ViewCamera { centre_m: [1.0, 0.0], zoom: 4.0 };
    settle(&mut window);
    editor(&mut window).edit("enclosure", |scenario| {
        let corners_m = vec![vec2(-2.0, -2.0), vec2(8.0, -2.0), vec2(8.0, 2.0), vec2(-2.0, 2.0)];
        scenario.enclosure = Enclosure::Polygon { corners_m };
    });
    settle(&mut window);
    click(&mut window, "Add a circle");
    // The view stays where it was: (1, 0), and not 1 m beside the new middle, (4, 0).
    let Vec2 { x, y } = edited_scenario(&mut window).obstacles[4].position_m;
    assert!((x - 1.0).hypot(y) < 0.6, "{x}, {y}");
}

#[test]
fn a_world_that_was_saved_and_not_taken_is_opened_again() {
    let mut screen_fixture = ScreenFixture::default();
    let mut newer = Scenario::clone(&screen_fixture.scene.scenario);
    newer.task.max_episode_steps = 77;
    let newer = Arc::new(newer);
    (screen_fixture.status.scenario_from, screen_fixture.status.scenario_modified) =
        ("worlds/mine.ron".into(), true);
    screen_fixture.status.saved_scenario = Some(("worlds/mine.ron".into(), newer.clone()));
    let mut window = window(screen_fixture);
    click(&mut window, "Edit");
    assert_eq!(edited_scenario(&mut window), newer);
    assert!(!editor(&mut window).is_modified());
    // What was saved elsewhere, or is older than what is in the file now, is none of it.
    for (path, changed) in [("worlds/other.ron", true), ("worlds/mine.ron", false)] {
        let mut screen_fixture = ScreenFixture::default();
        (screen_fixture.status.scenario_from, screen_fixture.status.scenario_modified) =
            ("worlds/mine.ron".into(), changed);
        screen_fixture.status.saved_scenario = Some((path.into(), newer.clone()));
        let running = screen_fixture.scene.scenario.clone();
        let mut window = self::window(screen_fixture);
        click(&mut window, "Edit");
        assert_eq!(edited_scenario(&mut window), running, "{path}");
        assert_eq!(editor(&mut window).is_modified(), changed);
    }
}

/// Begins a wall, of two corners so far.
fn half_a_wall(window: &mut Window) {
    click(window, "Draw a wall");
    for at in [vec2(-1.0, 1.2), vec2(1.0, 1.2)] {
        editor(window).click_with_tool(at, false);
    }
    settle(window);
}

#[test]
fn a_wall_that_is_half_drawn_is_not_lost() {
    let mut window = editing();
    half_a_wall(&mut window);
    click(&mut window, "Close the editor");
    let asked = "The wall that is being drawn would be lost, and all else that is not saved.";
    assert!(window.query_by_label(asked).is_some());
    click(&mut window, "Go on editing");
    assert!(window.query_by_label(asked).is_none());
    let saved = |commands: Vec<Command>| match &commands[..] {
        [Command::SaveScenario { scenario, .. } | Command::ApplyScenario { scenario, .. }] => {
            scenario.walls.len()
        }
        _ => panic!("{commands:?}"),
    };
    assert_eq!(saved(click(&mut window, "Save")), 1);
    assert_eq!(*editor(&mut window).tool(), Tool::Select);
    for label in ["Save as…", "Go on here", "Start again here"] {
        let mut window = editing();
        half_a_wall(&mut window);
        assert_eq!(saved(click(&mut window, label)), 1, "{label}");
    }
    let mut window = editing();
    half_a_wall(&mut window);
    window.key_press_modifiers(egui::Modifiers::COMMAND, Key::S);
    assert_eq!(saved(sent_commands(&mut window)), 1);
    // One that can't be there is not taken.
    let mut window = editing();
    click(&mut window, "Draw a wall");
    for at in [vec2(-1.0, 0.6), vec2(1.0, 5.0)] {
        editor(&mut window).click_with_tool(at, false);
    }
    settle(&mut window);
    assert_eq!(click(&mut window, "Go on here"), []);
    assert_eq!(
        (edited_scenario(&mut window).walls.len(), editor(&mut window).diagnostics().is_empty()),
        (1, false)
    );
}

#[test]
fn the_rest_of_a_long_list_is_said_to_be_elsewhere() {
    let mut long = Scenario::clone(&ScreenFixture::default().scene.scenario);
    long.robot.motions = vec![Motion { v_m_s: 0.1, w_rad_s: 0.0 }; 40];
    let mut window = editing_in(ScreenFixture::default().with_scenario(long));
    press_on(&mut window, "Robot");
    assert!(window.query_by_label("and 8 more: edit them in the file").is_some());
}

#[test]
fn what_stands_still_is_given_a_path() {
    let mut window = editing();
    select(&mut window, Selection::Obstacle(0));
    click(&mut window, "Draw its path");
    editor(&mut window).click_with_tool(vec2(0.6, 1.6), false);
    settle(&mut window);
    click(&mut window, "Path is done");
    let motion = edited_scenario(&mut window).obstacles[0].motion.clone();
    assert_eq!(motion, ObstacleMotion::Patrol { waypoints_m: vec![vec2(0.6, 1.6)], speed_m_s: 0.1 });
    assert!(window.query_by_label("Draw its path anew").is_some());
}
