//! The editor's world: what the pointer and the keys do to the document.

use std::sync::Arc;

use bevy::math;
use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use wayfield::app::commands::{Command, SessionMode};
use wayfield::app::editor::{Editor, Selection, Tool};
use wayfield::scenario::{Enclosure, ObstacleMotion, PlacementRule, Scenario, Shape, diagnostics};

use super::{Window, click, press, release_event, sent_commands, settle};
use crate::screen_fixture::{self, ScreenFixture};

/// A window of sixty frames a second, so that a double click is one.
fn window_at_60_fps(size: [f32; 2], screen_fixture: ScreenFixture) -> Window {
    let build = Harness::builder().with_size(size).with_step_dt(1.0 / 60.0).with_max_steps(40);
    let mut window = build
        .build_ui_state(|ui, screen_fixture: &mut ScreenFixture| screen_fixture.draw(ui), screen_fixture);
    settle(&mut window);
    window
}

/// The editor on the screen_fixture's own world, four cylinders of 0.15 m in a square of 4 m.
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

/// Where a point of the world is on the screen.
fn screen_pos(window: &Window, math::Vec2 { x: x_m, y: y_m }: math::Vec2) -> Pos2 {
    let view = window.get_by_label("World being edited").rect().expand2(vec2(4.0, 0.0));
    // The enclosure is 4 m by 4 m; around it is room for handles and the hint.
    let scale = ((view.width() - 60.0) / 4.0).min((view.height() - 76.0) / 4.0);
    view.center() + vec2(x_m, -y_m) * scale
}

fn button(pos: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) -> Event {
    Event::PointerButton { pos, button, pressed, modifiers }
}

fn click_at(window: &mut Window, position_m: math::Vec2) {
    let at = screen_pos(window, position_m);
    window.hover_at(at);
    window.step();
    window.drag_at(at);
    window.step();
    window.event(release_event(at));
    // Or the next click would be a double one.
    window.run_steps(40);
}

fn double_click_at(window: &mut Window, position_m: math::Vec2) {
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

/// Presses at one point, moves to another, and holds.
fn hold(window: &mut Window, from_m: math::Vec2, to_m: math::Vec2, held: Modifiers) {
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

fn let_go(window: &mut Window, position_m: math::Vec2) {
    let at = screen_pos(window, position_m);
    window.event(release_event(at));
    window.step();
    window.event(Event::ModifiersChanged(Modifiers::NONE));
    window.run_steps(40);
}

fn drag(window: &mut Window, from_m: math::Vec2, to_m: math::Vec2) {
    hold(window, from_m, to_m, Modifiers::NONE);
    let_go(window, to_m);
}

fn command(window: &mut Window, key: Key) -> Vec<Command> {
    window.key_press_modifiers(Modifiers::COMMAND, key);
    sent_commands(window)
}

#[test]
fn an_obstacle_is_dragged_and_it_is_undone_and_done_again() {
    let mut window = editing();
    drag(&mut window, math::vec2(0.6, 0.6), math::vec2(1.08, 0.21));
    assert_eq!(
        edited_scenario(&mut window).obstacles[0].position_m,
        math::vec2(1.1, 0.2),
        "on the grid of 5 cm"
    );
    assert_eq!(editor(&mut window).selection(), Selection::Obstacle(0));
    command(&mut window, Key::Z);
    assert_eq!(edited_scenario(&mut window).obstacles[0].position_m, math::vec2(0.6, 0.6));
    command(&mut window, Key::Y);
    assert_eq!(edited_scenario(&mut window).obstacles[0].position_m, math::vec2(1.1, 0.2));
    command(&mut window, Key::Z);
    window.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    settle(&mut window);
    assert_eq!(edited_scenario(&mut window).obstacles[0].position_m, math::vec2(1.1, 0.2));
    assert_eq!(sent_commands(&mut window), [], "the world that runs is not touched");
}

#[test]
fn with_alt_nothing_snaps_and_escape_gives_a_drag_up() {
    let mut window = editing();
    hold(&mut window, math::vec2(-0.6, -0.6), math::vec2(-1.013, -0.337), Modifiers::ALT);
    let math::Vec2 { x, y } = edited_scenario(&mut window).obstacles[2].position_m;
    assert!((x + 1.013).abs() < 2e-3 && (y + 0.337).abs() < 2e-3 && x != -1.0, "{x} {y}");
    press(&mut window, Key::Escape);
    assert_eq!(edited_scenario(&mut window).obstacles[2].position_m, math::vec2(-0.6, -0.6));
    let before = window.state().view_state.camera;
    let_go(&mut window, math::vec2(-1.5, -0.337));
    assert_eq!(edited_scenario(&mut window).obstacles[2].position_m, math::vec2(-0.6, -0.6));
    assert_eq!(window.state().view_state.camera, before, "and the world is not pushed about instead");
}

#[test]
fn a_handle_resizes_and_a_press_beside_it_does_not() {
    let mut window = editing();
    click_at(&mut window, math::vec2(0.6, 0.6));
    drag(&mut window, math::vec2(0.75, 0.6), math::vec2(0.9, 0.6));
    let world = self::edited_scenario(&mut window);
    assert_eq!(world.obstacles[0].shape, Shape::Circle { radius_m: 0.3 });
    assert_eq!(world.obstacles[0].position_m, math::vec2(0.6, 0.6));
}

#[test]
fn the_enclosure_is_resized_by_its_side_under_a_view_that_stays() {
    let mut window = editing();
    click_at(&mut window, math::vec2(2.0, -1.0));
    // Half a metre further out on either side; the picture is shrunk only when it is let go.
    drag(&mut window, math::vec2(2.0, 0.0), math::vec2(2.5, 0.0));
    assert_eq!(edited_scenario(&mut window).enclosure, Enclosure::Rectangle { width_m: 5.0, height_m: 4.0 });
    assert_eq!(window.state().view_state.camera.centre_m, [0.0, 0.0]);
}

#[test]
fn a_click_selects_and_the_floor_or_escape_selects_nothing() {
    let mut window = editing();
    for (at, selected) in [
        (math::vec2(-0.6, 0.6), Selection::Obstacle(1)),
        (math::vec2(0.05, 0.02), Selection::BenchmarkStart),
        (math::vec2(1.2, 1.2), Selection::BenchmarkGoal),
        (math::vec2(2.0, -1.0), Selection::Enclosure),
        (math::vec2(-1.3, -1.4), Selection::Nothing),
    ] {
        click_at(&mut window, at);
        assert_eq!(editor(&mut window).selection(), selected, "{at:?}");
    }
    click_at(&mut window, math::vec2(-0.6, 0.6));
    press(&mut window, Key::Escape);
    assert_eq!(editor(&mut window).selection(), Selection::Nothing);
}

#[test]
fn keys_delete_double_copy_and_nudge() {
    let mut window = editing();
    click_at(&mut window, math::vec2(-0.6, 0.6));
    command(&mut window, Key::D);
    assert_eq!(edited_scenario(&mut window).obstacles.len(), 5);
    press(&mut window, Key::Delete);
    assert_eq!(edited_scenario(&mut window).obstacles.len(), 4);
    click_at(&mut window, math::vec2(-0.6, 0.6));
    for key in [Key::C, Key::V] {
        command(&mut window, key);
    }
    assert_eq!(edited_scenario(&mut window).obstacles.len(), 5);
    command(&mut window, Key::X);
    assert_eq!(edited_scenario(&mut window).obstacles.len(), 4);
    click_at(&mut window, math::vec2(-0.6, 0.6));
    press(&mut window, Key::ArrowRight);
    window.key_press_modifiers(Modifiers::SHIFT, Key::ArrowDown);
    settle(&mut window);
    let math::Vec2 { x, y } = edited_scenario(&mut window).obstacles[1].position_m;
    assert!((x + 0.55).abs() < 1e-4 && (y - 0.59).abs() < 1e-4, "5 cm to the right, 1 cm down: {x} {y}");
}

#[test]
fn a_wall_is_drawn_by_clicks() {
    let mut window = editing();
    editor(&mut window).set_tool(Tool::Wall { corners_m: Vec::new() });
    for at in [math::vec2(-1.5, -1.0), math::vec2(-1.5, -1.5), math::vec2(0.52, -1.48)] {
        click_at(&mut window, at);
    }
    press(&mut window, Key::Backspace);
    click_at(&mut window, math::vec2(1.01, -1.49));
    assert_eq!(edited_scenario(&mut window).walls, [], "not yet");
    press(&mut window, Key::Enter);
    let corners = edited_scenario(&mut window).walls[0].corners_m.clone();
    assert_eq!(corners, [math::vec2(-1.5, -1.0), math::vec2(-1.5, -1.5), math::vec2(1.0, -1.5)]);
    // Once more, ended by a double click, and given up.
    editor(&mut window).set_tool(Tool::Wall { corners_m: Vec::new() });
    click_at(&mut window, math::vec2(-1.0, 1.5));
    click_at(&mut window, math::vec2(1.0, 1.7));
    double_click_at(&mut window, math::vec2(1.0, 1.7));
    let world = self::edited_scenario(&mut window);
    assert_eq!(world.walls[1].corners_m, [math::vec2(-1.0, 1.5), math::vec2(1.0, 1.7)]);
    assert_eq!(editor(&mut window).tool(), &Tool::Select);
    editor(&mut window).set_tool(Tool::Wall { corners_m: Vec::new() });
    click_at(&mut window, math::vec2(0.0, 0.0));
    press(&mut window, Key::Escape);
    assert_eq!(self::edited_scenario(&mut window).walls.len(), 2);
}

#[test]
fn places_for_targets_are_set_by_clicks_and_the_other_button_ends_it() {
    let mut window = editing();
    editor(&mut window).select(Selection::Goals);
    editor(&mut window).set_tool(Tool::Places);
    click_at(&mut window, math::vec2(1.5, 0.0));
    click_at(&mut window, math::vec2(-1.49, 0.01));
    let expected = PlacementRule::OneOf { positions_m: vec![math::vec2(1.5, 0.0), math::vec2(-1.5, 0.0)] };
    assert_eq!(edited_scenario(&mut window).goals, expected);
    let at = screen_pos(&window, math::vec2(1.0, -1.0));
    for pressed in [true, false] {
        window.event(Event::PointerMoved(at));
        window.event(button(at, PointerButton::Secondary, pressed, Modifiers::NONE));
        window.step();
    }
    assert_eq!(editor(&mut window).tool(), &Tool::Select);
    assert_eq!(edited_scenario(&mut window).goals, expected);
    // One is dragged, and one taken out by a double click.
    drag(&mut window, math::vec2(1.5, 0.0), math::vec2(1.5, -0.5));
    double_click_at(&mut window, math::vec2(-1.5, 0.0));
    assert_eq!(
        edited_scenario(&mut window).goals,
        PlacementRule::OneOf { positions_m: vec![math::vec2(1.5, -0.5)] }
    );
}

#[test]
fn an_obstacles_path_is_drawn_and_its_corners_go_by_double_click() {
    let mut window = editing();
    click_at(&mut window, math::vec2(0.6, 0.6));
    editor(&mut window).set_tool(Tool::Path { waypoints_m: Vec::new() });
    for at in [math::vec2(1.5, 0.6), math::vec2(1.5, 1.5), math::vec2(0.6, 1.5)] {
        click_at(&mut window, at);
    }
    press(&mut window, Key::Enter);
    let waypoints = |window: &mut Window| match &edited_scenario(window).obstacles[0].motion {
        ObstacleMotion::Patrol { waypoints_m, .. } => waypoints_m.clone(),
        other => panic!("{other:?}"),
    };
    assert_eq!(waypoints(&mut window), [math::vec2(1.5, 0.6), math::vec2(1.5, 1.5), math::vec2(0.6, 1.5)]);
    double_click_at(&mut window, math::vec2(1.5, 1.5));
    assert_eq!(waypoints(&mut window), [math::vec2(1.5, 0.6), math::vec2(0.6, 1.5)]);
    // All of it moves by the obstacle, the obstacle alone with Shift.
    drag(&mut window, math::vec2(0.6, 0.6), math::vec2(0.6, 0.4));
    assert_eq!(waypoints(&mut window), [math::vec2(1.5, 0.4), math::vec2(0.6, 1.3)]);
    hold(&mut window, math::vec2(0.6, 0.4), math::vec2(0.2, 0.4), Modifiers::SHIFT);
    let_go(&mut window, math::vec2(0.2, 0.4));
    assert_eq!(waypoints(&mut window), [math::vec2(1.5, 0.4), math::vec2(0.6, 1.3)]);
    assert_eq!(edited_scenario(&mut window).obstacles[0].position_m, math::vec2(0.2, 0.4));
}

#[test]
fn the_floor_pushes_the_view_about_and_the_wheel_zooms() {
    let mut window = editing();
    drag(&mut window, math::vec2(-1.3, -1.4), math::vec2(-1.1, -1.4));
    let [x, y] = window.state().view_state.camera.centre_m;
    assert!((x + 0.2).abs() < 1e-3 && y.abs() < 1e-3, "{x} {y}");
    press(&mut window, Key::F);
    assert_eq!(window.state().view_state.camera.centre_m, [0.0, 0.0]);
    let at = screen_pos(&window, math::vec2(0.0, 0.0));
    window.hover_at(at);
    window.step();
    let delta = vec2(0.0, 120.0);
    let (unit, phase) = (egui::MouseWheelUnit::Point, egui::TouchPhase::Move);
    window.event(Event::MouseWheel { unit, delta, phase, modifiers: Modifiers::NONE });
    window.run_steps(20);
    assert!(window.state().view_state.camera.zoom > 1.3, "{}", window.state().view_state.camera.zoom);
}

#[test]
fn keys_of_the_world_that_runs_do_nothing_in_the_editor() {
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
fn it_is_left_at_once_or_after_asking_and_time_goes_on_as_before() {
    let mut window = editing();
    window.state_mut().status.paused = true;
    assert_eq!(click(&mut window, "Test"), [Command::SetMode(SessionMode::Test), Command::Pause(false)]);
    assert!(window.state().view_state.editor.is_none());
    assert_eq!(press(&mut window, Key::E), [], "time stands still already");
    drag(&mut window, math::vec2(0.6, 0.6), math::vec2(1.0, 0.6));
    assert_eq!(press(&mut window, Key::E), []);
    assert!(window.query_by_label("The changes of this world are not saved.").is_some());
    assert_eq!(click(&mut window, "Go on editing"), []);
    assert_eq!(edited_scenario(&mut window).obstacles[0].position_m, math::vec2(1.0, 0.6));
    assert_eq!(click(&mut window, "Train"), []);
    assert_eq!(click(&mut window, "Leave without them"), [], "it trained before");
    assert!(window.state().view_state.editor.is_none());
}

#[test]
fn a_narrow_window_has_the_panel_below_the_world_though_the_curves_are_open() {
    let mut window = window_at_60_fps([390.0, 844.0], ScreenFixture::default());
    press(&mut window, Key::E);
    let world = window.get_by_label("World being edited").rect();
    let panel = window.get_by_label("Close the editor").rect();
    assert!(world.width() > 370.0 && world.max.y < panel.min.y, "{world} {panel}");
    assert!(window.query_by_label("Learning").is_none());
    click(&mut window, "Plots panel");
    assert!(
        window.query_by_label("Learning").is_some() && window.query_by_label("Close the editor").is_none()
    );
}

#[test]
fn the_world_has_the_keyboards_focus_and_moves_things_by_it() {
    let mut window = editing();
    click_at(&mut window, math::vec2(-0.6, 0.6));
    window.get_by_label("World being edited").focus();
    settle(&mut window);
    for _ in 0..2 {
        press(&mut window, Key::ArrowUp);
    }
    let math::Vec2 { x, y } = edited_scenario(&mut window).obstacles[1].position_m;
    assert!((x + 0.6).abs() < 1e-4 && (y - 0.7).abs() < 1e-4, "{x} {y}");
}

#[test]
fn the_world_is_saved_and_another_opened_by_key() {
    let mut window = editing();
    window.state_mut().status.scenario_from = "scenario-1".into();
    let scenario = edited_scenario(&mut window);
    let saved = Command::SaveScenario { scenario, based_on: "scenario-1".into(), path: None };
    assert_eq!(command(&mut window, Key::S), [saved], "a world that came with the program has no file");
    assert_eq!(command(&mut window, Key::O), [Command::OpenInEditor(None)]);
}

#[test]
fn a_world_of_all_sorts_is_edited_in_any_window_without_a_panic() {
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
            let corners_m = vec![
                math::vec2(0.0, 0.0),
                math::vec2(f32::NAN, 1.0),
                math::vec2(1.0, f32::INFINITY),
                math::vec2(0.0, 1.0),
            ];
            scenario.enclosure = wayfield::scenario::Enclosure::Polygon { corners_m };
            scenario.obstacles[0].position_m.x = f32::NAN;
        });
        assert_eq!(sent_commands(&mut window), []);
    }
}

#[test]
fn escape_closes_an_open_list_and_nothing_more() {
    let mut window = editing();
    click_at(&mut window, math::vec2(0.6, 0.6));
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
fn a_corner_near_the_middle_is_dragged_like_the_others() {
    let mut window = editing();
    editor(&mut window).edit("shape", |scenario| {
        let corners_m = vec![
            math::vec2(0.5, -0.4),
            math::vec2(0.02, 0.02),
            math::vec2(-0.4, 0.5),
            math::vec2(-0.4, -0.4),
        ];
        scenario.obstacles[0].shape = Shape::Polygon { corners_m };
    });
    settle(&mut window);
    click_at(&mut window, math::vec2(0.3, 0.3));
    assert_eq!(editor(&mut window).selection(), Selection::Obstacle(0));
    // 2.8 cm from the middle are some five points.
    drag(&mut window, math::vec2(0.62, 0.62), math::vec2(0.75, 0.7));
    let obstacle = edited_scenario(&mut window).obstacles[0].clone();
    assert_eq!(obstacle.position_m, math::vec2(0.6, 0.6), "it stays");
    let Shape::Polygon { corners_m } = obstacle.shape else { panic!("{:?}", obstacle.shape) };
    assert!((corners_m[1].x - 0.15).hypot(corners_m[1].y - 0.1) < 0.001, "{corners_m:?}");
}

#[test]
fn the_example_of_what_is_drawn_anew_is_of_this_world() {
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
    assert_eq!(drawn(&window), drawn(&fresh), "one is drawn, and not the three of before");
    assert_eq!(before - drawn(&window), 2);
}
