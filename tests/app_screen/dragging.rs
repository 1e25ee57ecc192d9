//! Dragging objects in an arena, and clicking on its floor: which commands are sent, and for which arena.

use bevy::math;
use egui::{Event, PointerButton, Pos2, pos2, vec2};
use egui_kittest::kittest::Queryable;
use wayfield::app::commands::Command;
use wayfield::app::moves::{Movable, MoveRequest};

use super::{Window, release_event, sent_commands, settle, window};
use crate::screen_fixture::ScreenFixture;

/// The screen position of a point in the followed arena.
fn screen_pos(window: &Window, math::Vec2 { x: x_m, y: y_m }: math::Vec2) -> Pos2 {
    let followed = format!("Arena {}", window.state().view_state.followed + 1);
    let view = window.get_by_label(&followed).rect().expand2(vec2(4.0, 0.0));
    // The enclosure is 4 m by 4 m, with a margin for the legend.
    let scale = ((view.width() - 36.0) / 4.0).min((view.height() - 68.0) / 4.0);
    view.center() + vec2(x_m, -y_m) * scale
}

/// Drags the object at `at_m` a little; returns the commands sent while the pointer moves and while it rests.
fn drag(window: &mut Window, at_m: math::Vec2) -> (Vec<Command>, Vec<Command>) {
    let at = screen_pos(window, at_m);
    window.hover_at(at);
    settle(window);
    window.event(Event::PointerButton {
        pos: at,
        button: PointerButton::Primary,
        pressed: true,
        modifiers: egui::Modifiers::NONE,
    });
    window.step();
    assert_eq!(window.state().commands, [], "it may still be a click");
    let to = at + vec2(0.0, 14.0);
    window.hover_at(to);
    window.step();
    window.step();
    let moved = std::mem::take(&mut window.state_mut().commands);
    let rested = sent_commands(window);
    window.event(release_event(to));
    settle(window);
    window.state_mut().commands.clear();
    assert_eq!(sent_commands(window), [], "nothing is sent after the release");
    (moved, rested)
}

fn robot(window: &Window) -> math::Vec2 {
    let arena = &window.state().scene.arenas[window.state().view_state.followed];
    math::vec2(arena.pose.x_m, arena.pose.y_m)
}

fn goal(window: &Window) -> math::Vec2 {
    let arena = &window.state().scene.arenas[window.state().view_state.followed];
    math::vec2(arena.goal.x_m, arena.goal.y_m)
}

#[test]
fn a_dragged_robot_or_goal_stays_at_a_resting_pointer() {
    for drag_target in [robot, goal] {
        let mut window = window(ScreenFixture::default());
        let at_m = drag_target(&window);
        let (moved, rested) = drag(&mut window, at_m);
        assert!(!moved.is_empty());
        assert_eq!(rested.len(), 6, "one command per frame");
        assert!(rested.iter().all(|command| Some(command) == moved.last()), "{moved:?} {rested:?}");
        window.state_mut().status.paused = true;
        settle(&mut window);
        let (moved, rested) = drag(&mut window, at_m);
        assert!(!moved.is_empty() && rested.is_empty(), "while paused, a resting pointer sends nothing");
    }
}

#[test]
fn an_obstacle_is_moved_in_the_followed_arena_and_only_with_the_pointer() {
    let mut screen_fixture = ScreenFixture::default();
    screen_fixture.view_state.followed = 2;
    let mut window = window(screen_fixture);
    let (moved, rested) = drag(&mut window, math::vec2(-0.6, -0.6));
    let [Command::Move(MoveRequest { arena: 2, object: Movable::Obstacle(2), to_m })] = moved[..] else {
        panic!("{moved:?}")
    };
    assert!((to_m.x + 0.6).abs() < 1e-3 && to_m.y < -0.6, "{to_m:?}");
    assert_eq!(rested, []);
}

#[test]
fn the_object_pressed_is_dragged_even_if_it_has_moved_on() {
    let mut window = window(ScreenFixture::default());
    let at = screen_pos(&window, robot(&window));
    window.hover_at(at);
    settle(&mut window);
    window.drag_at(at);
    window.step();
    window.state_mut().scene.arenas[0].pose.x_m += 0.5;
    settle(&mut window);
    window.hover_at(pos2(at.x, at.y + 14.0));
    let moved = sent_commands(&mut window);
    assert!(
        matches!(moved.first(), Some(Command::Move(MoveRequest { arena: 0, object: Movable::Robot, .. }))),
        "{moved:?}"
    );
}

/// The commands that a click at a point of the followed arena sends.
fn click_at(window: &mut Window, at_m: math::Vec2) -> Vec<Command> {
    let at = screen_pos(window, at_m);
    window.hover_at(at);
    settle(window);
    let (button, modifiers) = (PointerButton::Primary, egui::Modifiers::NONE);
    window.event(Event::PointerButton { pos: at, button, pressed: true, modifiers });
    window.step();
    window.event(release_event(at));
    sent_commands(window)
}

#[test]
fn a_click_on_free_floor_sets_the_goal_while_a_policy_is_watched() {
    let free = math::vec2(0.9, -1.5);
    let mut training = window(ScreenFixture::default());
    assert_eq!(click_at(&mut training, free), [], "not in training");
    let mut window = window(ScreenFixture::default().with_single_policy());
    let sent = click_at(&mut window, free);
    let [Command::SetGoal(MoveRequest { arena: 0, object: Movable::Goal, to_m })] = sent[..] else {
        panic!("{sent:?}")
    };
    assert!(to_m.distance(free) < 1e-3, "{to_m:?}");
    window.ctx.options_mut(|options| options.input_options.max_double_click_delay = 60.0);
    assert_eq!(click_at(&mut window, free), [], "the second click of a double-click fits the view");
    assert_eq!(click_at(&mut window, free), [], "the third click has no effect");
    assert_eq!(click_at(&mut window, math::vec2(-0.6, -0.6)), [], "an obstacle is there");
    let robot = robot(&window);
    assert_eq!(click_at(&mut window, robot), [], "the robot is there");
}
