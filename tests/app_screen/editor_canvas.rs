//! The editor's canvas: editing with the pointer and the keys.

use std::sync::Arc;

use bevy::math::{Vec2, vec2};
use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use wayfield::app::commands::{Command, EditorReply, SessionMode};
use wayfield::app::editor::{Editor, Selection, Tool};
use wayfield::app::view_state::ViewCamera;
use wayfield::scenario::{Enclosure, ObstacleMotion, PlacementRule, Scenario, Shape, diagnostics};

use super::{Window, click, press, release_event, sent_commands, settle};
use crate::screen_fixture::{self, ScreenFixture};

/// A window at 60 frames per second, so that double-clicks are recognized.
fn window_at_60_fps(size: [f32; 2], screen_fixture: ScreenFixture) -> Window {
    let build = Harness::builder().with_size(size).with_step_dt(1.0 / 60.0).with_max_steps(40);
    let mut window = build
        .build_ui_state(|ui, screen_fixture: &mut ScreenFixture| screen_fixture.draw(ui), screen_fixture);
    settle(&mut window);
    window
}

/// The editor on the fixture's scenario: four circles of radius 0.15 m in a square of 4 m.
fn editing() -> Window {
    let mut window = window_at_60_fps([1280.0, 860.0], ScreenFixture::default());
    assert_eq!(click(&mut window, "Edit"), [Command::Pause(true)]);
    window
}

fn editor(window: &mut Window) -> &mut Editor {
    window.state_mut().view_state.editor.as_deref_mut().expect("the editor is open")
}

fn edited_scenario(window: &mut Window) -> Arc<Scenario> {
    editor(window).scenario().clone()
}

/// The screen position of a point in m.
fn screen_pos(window: &Window, Vec2 { x: x_m, y: y_m }: Vec2) -> Pos2 {
    let view = window.get_by_label("Scenario editor").rect().expand2(egui::vec2(4.0, 0.0));
    // The enclosure is 4 m by 4 m, with a margin for handles and the hint line.
    let scale = ((view.width() - 60.0) / 4.0).min((view.height() - 76.0) / 4.0);
    view.center() + egui::vec2(x_m, -y_m) * scale
}

fn button(pos: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) -> Event {
    Event::PointerButton { pos, button, pressed, modifiers }
}

fn click_at(window: &mut Window, position_m: Vec2) {
    let at = screen_pos(window, position_m);
    window.hover_at(at);
    window.step();
    window.drag_at(at);
    window.step();
    window.event(release_event(at));
    // Wait, or the next click would be a double-click.
    window.run_steps(40);
}

fn double_click_at(window: &mut Window, position_m: Vec2) {
    let at = screen_pos(window, position_m);
    window.hover_at(at);
    for _ in 0..2 {
        window.drag_at(at);
        window.step();
        window.event(release_event(at));
        window.step();
    }
    window.run_steps(40);
}

/// Drags from one point to another without releasing.
fn hold(window: &mut Window, from_m: Vec2, to_m: Vec2, held: Modifiers) {
    let (from, to) = (screen_pos(window, from_m), screen_pos(window, to_m));
    window.event(Event::PointerMoved(from));
    window.step();
    window.event(Event::ModifiersChanged(held));
    window.event(button(from, PointerButton::Primary, true, held));
    window.step();
    for part in [0.5, 1.0] {
        window.event(Event::PointerMoved(from.lerp(to, part)));
        window.step();
    }
}

fn let_go(window: &mut Window, position_m: Vec2) {
    let at = screen_pos(window, position_m);
    window.event(release_event(at));
    window.step();
    window.event(Event::ModifiersChanged(Modifiers::NONE));
    window.run_steps(40);
}

fn drag(window: &mut Window, from_m: Vec2, to_m: Vec2) {
    hold(window, from_m, to_m, Modifiers::NONE);
    let_go(window, to_m);
}

fn command(window: &mut Window, key: Key) -> Vec<Command> {
    window.key_press_modifiers(Modifiers::COMMAND, key);
    sent_commands(window)
}

#[test]
fn a_drag_can_be_undone_and_redone() {
    let mut window = editing();
    drag(&mut window, vec2(0.6, 0.6), vec2(1.08, 0.21));
    assert_eq!(edited_scenario(&mut window).obstacles[0].position_m, vec2(1.1, 0.2), "on the 5 cm grid");
    assert_eq!(editor(&mut window).selection(), Selection::Obstacle(0));
    command(&mut window, Key::Z);
    assert_eq!(edited_scenario(&mut window).obstacles[0].position_m, vec2(0.6, 0.6));
    command(&mut window, Key::Y);
    assert_eq!(edited_scenario(&mut window).obstacles[0].position_m, vec2(1.1, 0.2));
    command(&mut window, Key::Z);
    window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    settle(&mut window);
    assert_eq!(edited_scenario(&mut window).obstacles[0].position_m, vec2(1.1, 0.2));
    assert_eq!(sent_commands(&mut window), [], "the running scenario is not touched");
}

#[test]
fn alt_disables_snapping_and_escape_cancels_a_drag() {
    let mut window = editing();
    hold(&mut window, vec2(-0.6, -0.6), vec2(-1.013, -0.337), Modifiers::ALT);
    let Vec2 { x, y } = edited_scenario(&mut window).obstacles[2].position_m;
    assert!((x + 1.013).abs() < 2e-3 && (y + 0.337).abs() < 2e-3 && x != -1.0, "{x} {y}");
    press(&mut window, Key::Escape);
    assert_eq!(edited_scenario(&mut window).obstacles[2].position_m, vec2(-0.6, -0.6));
    let before = window.state().view_state.camera;
    let_go(&mut window, vec2(-1.5, -0.337));
    assert_eq!(edited_scenario(&mut window).obstacles[2].position_m, vec2(-0.6, -0.6));
    assert_eq!(window.state().view_state.camera, before, "the view is not panned instead");
}

#[test]
fn dragging_a_handle_resizes_and_does_not_move() {
    let mut window = editing();
    click_at(&mut window, vec2(0.6, 0.6));
    drag(&mut window, vec2(0.75, 0.6), vec2(0.9, 0.6));
    let scenario = edited_scenario(&mut window);
    assert_eq!(scenario.obstacles[0].shape, Shape::Circle { radius_m: 0.3 });
    assert_eq!(scenario.obstacles[0].position_m, vec2(0.6, 0.6));
}

#[test]
fn the_view_stays_while_the_enclosure_is_resized() {
    let mut window = editing();
    click_at(&mut window, vec2(2.0, -1.0));
    // Half a metre on either side; the view is fitted only after the drag.
    drag(&mut window, vec2(2.0, 0.0), vec2(2.5, 0.0));
    assert_eq!(edited_scenario(&mut window).enclosure, Enclosure::Rectangle { width_m: 5.0, height_m: 4.0 });
    assert_eq!(window.state().view_state.camera.centre_m, [0.0, 0.0]);
}

#[test]
fn a_click_selects_and_the_floor_or_escape_deselects() {
    let mut window = editing();
    for (at, selected) in [
        (vec2(-0.6, 0.6), Selection::Obstacle(1)),
        (vec2(0.05, 0.02), Selection::BenchmarkStart),
        (vec2(1.2, 1.2), Selection::BenchmarkGoal),
        (vec2(2.0, -1.0), Selection::Enclosure),
        (vec2(-1.3, -1.4), Selection::Nothing),
    ] {
        click_at(&mut window, at);
        assert_eq!(editor(&mut window).selection(), selected, "{at:?}");
    }
    click_at(&mut window, vec2(-0.6, 0.6));
    press(&mut window, Key::Escape);
    assert_eq!(editor(&mut window).selection(), Selection::Nothing);
}

#[test]
fn keys_delete_duplicate_copy_and_nudge() {
    let mut window = editing();
    click_at(&mut window, vec2(-0.6, 0.6));
    command(&mut window, Key::D);
    assert_eq!(edited_scenario(&mut window).obstacles.len(), 5);
    press(&mut window, Key::Delete);
    assert_eq!(edited_scenario(&mut window).obstacles.len(), 4);
    click_at(&mut window, vec2(-0.6, 0.6));
    for key in [Key::C, Key::V] {
        command(&mut window, key);
    }
    assert_eq!(edited_scenario(&mut window).obstacles.len(), 5);
    command(&mut window, Key::X);
    assert_eq!(edited_scenario(&mut window).obstacles.len(), 4);
    click_at(&mut window, vec2(-0.6, 0.6));
    press(&mut window, Key::ArrowRight);
    window.key_press_modifiers(Modifiers::SHIFT, Key::ArrowDown);
    settle(&mut window);
    let Vec2 { x, y } = edited_scenario(&mut window).obstacles[1].position_m;
    assert!((x + 0.55).abs() < 1e-4 && (y - 0.59).abs() < 1e-4, "5 cm to the right, 1 cm down: {x} {y}");
}

#[test]
fn a_wall_is_drawn_click_by_click() {
    let mut window = editing();
    editor(&mut window).set_tool(Tool::Wall { corners_m: Vec::new() });
    for at in [vec2(-1.5, -1.0), vec2(-1.5, -1.5), vec2(0.52, -1.48)] {
        click_at(&mut window, at);
    }
    press(&mut window, Key::Backspace);
    click_at(&mut window, vec2(1.01, -1.49));
    assert_eq!(edited_scenario(&mut window).walls, [], "not finished");
    press(&mut window, Key::Enter);
    let corners = edited_scenario(&mut window).walls[0].corners_m.clone();
    assert_eq!(corners, [vec2(-1.5, -1.0), vec2(-1.5, -1.5), vec2(1.0, -1.5)]);
    // Two more walls: one is finished by a double-click, the other is cancelled.
    editor(&mut window).set_tool(Tool::Wall { corners_m: Vec::new() });
    click_at(&mut window, vec2(-1.0, 1.5));
    click_at(&mut window, vec2(1.0, 1.7));
    double_click_at(&mut window, vec2(1.0, 1.7));
    let scenario = edited_scenario(&mut window);
    assert_eq!(scenario.walls[1].corners_m, [vec2(-1.0, 1.5), vec2(1.0, 1.7)]);
    assert_eq!(editor(&mut window).tool(), &Tool::Select);
    editor(&mut window).set_tool(Tool::Wall { corners_m: Vec::new() });
    click_at(&mut window, vec2(0.0, 0.0));
    press(&mut window, Key::Escape);
    assert_eq!(edited_scenario(&mut window).walls.len(), 2);
}

#[test]
fn a_double_click_while_drawing_does_not_fit_the_view() {
    let mut window = editing();
    let zoomed = ViewCamera { zoom: 2.0, ..ViewCamera::default() };
    window.state_mut().view_state.camera = zoomed;
    editor(&mut window).set_tool(Tool::Wall { corners_m: Vec::new() });
    double_click_at(&mut window, vec2(0.6, -0.2));
    assert_eq!(window.state().view_state.camera, zoomed, "too few corners for a wall, so drawing continues");
    editor(&mut window).set_tool(Tool::Select);
    double_click_at(&mut window, vec2(0.6, -0.2));
    assert_eq!(window.state().view_state.camera, ViewCamera::default(), "without a drawing");
}

#[test]
fn goal_positions_are_added_by_clicks_until_a_secondary_click() {
    let mut window = editing();
    editor(&mut window).select(Selection::Goals);
    editor(&mut window).set_tool(Tool::Positions);
    click_at(&mut window, vec2(1.5, 0.0));
    click_at(&mut window, vec2(-1.49, 0.01));
    let expected = PlacementRule::OneOf { positions_m: vec![vec2(1.5, 0.0), vec2(-1.5, 0.0)] };
    assert_eq!(edited_scenario(&mut window).goals, expected);
    let at = screen_pos(&window, vec2(1.0, -1.0));
    for pressed in [true, false] {
        window.event(Event::PointerMoved(at));
        window.event(button(at, PointerButton::Secondary, pressed, Modifiers::NONE));
        window.step();
    }
    assert_eq!(editor(&mut window).tool(), &Tool::Select);
    assert_eq!(edited_scenario(&mut window).goals, expected);
    // One is dragged, the other is removed by a double-click.
    drag(&mut window, vec2(1.5, 0.0), vec2(1.5, -0.5));
    double_click_at(&mut window, vec2(-1.5, 0.0));
    assert_eq!(
        edited_scenario(&mut window).goals,
        PlacementRule::OneOf { positions_m: vec![vec2(1.5, -0.5)] }
    );
}

#[test]
fn a_path_is_drawn_by_clicks_and_a_double_click_removes_a_waypoint() {
    let mut window = editing();
    click_at(&mut window, vec2(0.6, 0.6));
    editor(&mut window).set_tool(Tool::Path { waypoints_m: Vec::new() });
    for at in [vec2(1.5, 0.6), vec2(1.5, 1.5), vec2(0.6, 1.5)] {
        click_at(&mut window, at);
    }
    press(&mut window, Key::Enter);
    let waypoints = |window: &mut Window| match &edited_scenario(window).obstacles[0].motion {
        ObstacleMotion::Patrol { waypoints_m, .. } => waypoints_m.clone(),
        other => panic!("{other:?}"),
    };
    assert_eq!(waypoints(&mut window), [vec2(1.5, 0.6), vec2(1.5, 1.5), vec2(0.6, 1.5)]);
    double_click_at(&mut window, vec2(1.5, 1.5));
    assert_eq!(waypoints(&mut window), [vec2(1.5, 0.6), vec2(0.6, 1.5)]);
    // The path moves with the obstacle; with Shift, the obstacle moves alone.
    drag(&mut window, vec2(0.6, 0.6), vec2(0.6, 0.4));
    assert_eq!(waypoints(&mut window), [vec2(1.5, 0.4), vec2(0.6, 1.3)]);
    hold(&mut window, vec2(0.6, 0.4), vec2(0.2, 0.4), Modifiers::SHIFT);
    let_go(&mut window, vec2(0.2, 0.4));
    assert_eq!(waypoints(&mut window), [vec2(1.5, 0.4), vec2(0.6, 1.3)]);
    assert_eq!(edited_scenario(&mut window).obstacles[0].position_m, vec2(0.2, 0.4));
}

#[test]
fn dragging_the_floor_pans_and_the_wheel_zooms() {
    let mut window = editing();
    drag(&mut window, vec2(-1.3, -1.4), vec2(-1.1, -1.4));
    let [x, y] = window.state().view_state.camera.centre_m;
    assert!((x + 0.2).abs() < 1e-3 && y.abs() < 1e-3, "{x} {y}");
    press(&mut window, Key::F);
    assert_eq!(window.state().view_state.camera.centre_m, [0.0, 0.0]);
    let at = screen_pos(&window, vec2(0.0, 0.0));
    window.hover_at(at);
    window.step();
    let delta = egui::vec2(0.0, 120.0);
    let (unit, phase) = (egui::MouseWheelUnit::Point, egui::TouchPhase::Move);
    window.event(Event::MouseWheel { unit, delta, phase, modifiers: Modifiers::NONE });
    window.run_steps(20);
    assert!(window.state().view_state.camera.zoom > 1.3, "{}", window.state().view_state.camera.zoom);
}

#[test]
fn a_view_that_is_dragged_and_zoomed_at_once_keeps_the_point_under_the_pointer() {
    let mut window = editing();
    let centre = screen_pos(&window, Vec2::ZERO);
    let scale = screen_pos(&window, vec2(1.0, 0.0)).x - centre.x;
    let point_at = |window: &Window, pointer: Pos2| {
        let ViewCamera { centre_m: [x, y], zoom } = window.state().view_state.camera;
        let away = (pointer - centre) / (scale * zoom);
        vec2(x + away.x, y - away.y)
    };
    let held_to = vec2(-1.1, -1.4);
    hold(&mut window, vec2(-1.3, -1.4), held_to, Modifiers::NONE);
    let mut pointer = screen_pos(&window, held_to);
    let held = point_at(&window, pointer);
    let delta = egui::vec2(0.0, 120.0);
    let (unit, phase) = (egui::MouseWheelUnit::Point, egui::TouchPhase::Move);
    // egui spreads the turn of the wheel over several frames.
    window.event(Event::MouseWheel { unit, delta, phase, modifiers: Modifiers::NONE });
    for _ in 0..20 {
        pointer.x += 4.0;
        window.event(Event::PointerMoved(pointer));
        window.step();
    }
    assert!(window.state().view_state.camera.zoom > 1.3, "{}", window.state().view_state.camera.zoom);
    let now = point_at(&window, pointer);
    assert!(now.distance(held) < 1e-3, "{held} -> {now}");
}

#[test]
fn the_keys_of_the_simulation_do_nothing_in_the_editor() {
    let mut window = editing();
    window.state_mut().status.mode = SessionMode::Drive;
    let before = window.state().view_state.overlays;
    for key in [Key::Space, Key::Period, Key::Num1, Key::ArrowLeft, Key::B, Key::G, Key::Tab] {
        assert_eq!(press(&mut window, key), [], "{key:?}");
    }
    assert_eq!(window.state().view_state.overlays, before);
    assert!(!window.state().view_state.grid && window.state().view_state.followed == 0);
}

#[test]
fn leaving_asks_about_unsaved_changes_and_resumes_the_simulation() {
    let mut window = editing();
    window.state_mut().status.paused = true;
    assert_eq!(click(&mut window, "Test"), [Command::SetMode(SessionMode::Test), Command::Pause(false)]);
    assert!(window.state().view_state.editor.is_none());
    assert_eq!(press(&mut window, Key::E), [], "the simulation is paused already");
    drag(&mut window, vec2(0.6, 0.6), vec2(1.0, 0.6));
    assert_eq!(press(&mut window, Key::E), []);
    assert!(window.query_by_label("Unsaved changes will be lost.").is_some());
    assert_eq!(click(&mut window, "Keep editing"), []);
    assert_eq!(edited_scenario(&mut window).obstacles[0].position_m, vec2(1.0, 0.6));
    assert_eq!(click(&mut window, "Train"), []);
    assert_eq!(click(&mut window, "Discard changes"), [], "it was training before");
    assert!(window.state().view_state.editor.is_none());
}

#[test]
fn leaving_can_save_the_changes_first() {
    let mut window = editing();
    drag(&mut window, vec2(0.6, 0.6), vec2(1.0, 0.6));
    assert_eq!(click(&mut window, "Test"), []);
    let sent = click(&mut window, "Save and leave");
    let [Command::SaveScenario { scenario, path: None, .. }] = &sent[..] else { panic!("{sent:?}") };
    assert_eq!(scenario.obstacles[0].position_m, vec2(1.0, 0.6));
    assert_eq!(sent_commands(&mut window), [], "not before it is saved");
    assert!(window.state().view_state.editor.is_some());
    let reply = EditorReply::Saved { file: "mine.ron".into(), scenario: scenario.clone() };
    window.state_mut().view_state.receive(&reply);
    assert!(sent_commands(&mut window).contains(&Command::SetMode(SessionMode::Test)));
    assert!(window.state().view_state.editor.is_none());
}

#[test]
fn a_narrow_window_shows_the_panel_below_the_canvas_instead_of_the_plots() {
    let mut window = window_at_60_fps([390.0, 844.0], ScreenFixture::default());
    press(&mut window, Key::E);
    let canvas = window.get_by_label("Scenario editor").rect();
    let panel = window.get_by_label("Close the editor").rect();
    assert!(canvas.width() > 370.0 && canvas.max.y < panel.min.y, "{canvas} {panel}");
    assert!(window.query_by_label("Learning").is_none());
    click(&mut window, "Plots panel");
    assert!(
        window.query_by_label("Learning").is_some() && window.query_by_label("Close the editor").is_none()
    );
}

#[test]
fn arrow_keys_move_the_item_while_the_canvas_has_the_focus() {
    let mut window = editing();
    click_at(&mut window, vec2(-0.6, 0.6));
    window.get_by_label("Scenario editor").focus();
    settle(&mut window);
    for _ in 0..2 {
        press(&mut window, Key::ArrowUp);
    }
    let Vec2 { x, y } = edited_scenario(&mut window).obstacles[1].position_m;
    assert!((x + 0.6).abs() < 1e-4 && (y - 0.7).abs() < 1e-4, "{x} {y}");
}

#[test]
fn scenarios_are_saved_and_opened_by_key() {
    let mut window = editing();
    window.state_mut().status.scenario_from = "scenario-1".into();
    let scenario = edited_scenario(&mut window);
    let saved = Command::SaveScenario { scenario, based_on: "scenario-1".into(), path: None };
    assert_eq!(command(&mut window, Key::S), [saved], "a built-in scenario has no file");
    assert_eq!(command(&mut window, Key::O), [Command::OpenInEditor(None)]);
}

#[test]
fn a_mixed_scenario_is_edited_in_any_window_without_a_panic() {
    assert_eq!(diagnostics(&screen_fixture::mixed_scenario()), []);
    for size in [[1280.0, 860.0], [390.0, 844.0], [200.0, 200.0]] {
        let mut window =
            window_at_60_fps(size, ScreenFixture::default().with_scenario(screen_fixture::mixed_scenario()));
        press(&mut window, Key::E);
        for selection in [
            Selection::Obstacle(2),
            Selection::Obstacle(3),
            Selection::Obstacle(4),
            Selection::Obstacle(7),
            Selection::Wall(0),
            Selection::Generator(0),
            Selection::Starts,
            Selection::Goals,
            Selection::Enclosure,
        ] {
            editor(&mut window).select(selection);
            settle(&mut window);
        }
        editor(&mut window).edit("enclosure", |scenario| {
            let corners_m =
                vec![vec2(0.0, 0.0), vec2(f32::NAN, 1.0), vec2(1.0, f32::INFINITY), vec2(0.0, 1.0)];
            scenario.enclosure = Enclosure::Polygon { corners_m };
            scenario.obstacles[0].position_m.x = f32::NAN;
        });
        assert_eq!(sent_commands(&mut window), []);
    }
}

#[test]
fn escape_closes_an_open_list_and_does_nothing_else() {
    let mut window = editing();
    click_at(&mut window, vec2(0.6, 0.6));
    assert_eq!(editor(&mut window).selection(), Selection::Obstacle(0));
    click(&mut window, "Motion");
    assert!(window.query_by_label("Orbit").is_some());
    window.ctx.memory_mut(|memory| {
        if let Some(id) = memory.focused() {
            memory.surrender_focus(id);
        }
    });
    press(&mut window, Key::Escape);
    assert!(window.query_by_label("Orbit").is_none());
    assert_eq!(editor(&mut window).selection(), Selection::Obstacle(0));
    press(&mut window, Key::Escape);
    assert_eq!(editor(&mut window).selection(), Selection::Nothing);
}

#[test]
fn a_corner_near_the_middle_can_be_dragged() {
    let mut window = editing();
    editor(&mut window).edit("shape", |scenario| {
        let corners_m = vec![vec2(0.5, -0.4), vec2(0.02, 0.02), vec2(-0.4, 0.5), vec2(-0.4, -0.4)];
        scenario.obstacles[0].shape = Shape::Polygon { corners_m };
    });
    settle(&mut window);
    click_at(&mut window, vec2(0.3, 0.3));
    assert_eq!(editor(&mut window).selection(), Selection::Obstacle(0));
    // The corner is 2.8 cm from the middle, about five points on the screen.
    drag(&mut window, vec2(0.62, 0.62), vec2(0.75, 0.7));
    let obstacle = edited_scenario(&mut window).obstacles[0].clone();
    assert_eq!(obstacle.position_m, vec2(0.6, 0.6), "the obstacle stays");
    let Shape::Polygon { corners_m } = obstacle.shape else { panic!("{:?}", obstacle.shape) };
    assert!((corners_m[1].x - 0.15).hypot(corners_m[1].y - 0.1) < 0.001, "{corners_m:?}");
}

#[test]
fn the_example_of_generated_obstacles_belongs_to_the_edited_scenario() {
    let drawn = |window: &Window| {
        let shapes = window.output().shapes.iter();
        shapes.filter(|clipped| matches!(clipped.shape, egui::Shape::Circle(_))).count()
    };
    let three = screen_fixture::mixed_scenario();
    let mut one = three.clone();
    one.generators[0].count = 1;
    let other = Arc::new(one);
    let open = |window: &mut Window| {
        let editor = Editor::open(other.clone(), "other".into(), true);
        window.state_mut().view_state.editor = Some(Box::new(editor));
        settle(window);
    };
    let mut fresh = window_at_60_fps([1280.0, 860.0], ScreenFixture::default().with_scenario(three.clone()));
    open(&mut fresh);
    let mut window = window_at_60_fps([1280.0, 860.0], ScreenFixture::default().with_scenario(three));
    click(&mut window, "Edit");
    let before = drawn(&window);
    open(&mut window);
    assert_eq!(drawn(&window), drawn(&fresh), "one is drawn, not the former three");
    assert_eq!(before - drawn(&window), 2);
}
