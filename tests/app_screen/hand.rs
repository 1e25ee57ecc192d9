//! The hand on the world: what is held stays where it is held, and says in which arena.

use egui::{Event, PointerButton, Pos2, pos2, vec2};
use egui_kittest::kittest::Queryable;
use wayfield::app::orders::{Moved, Order};

use super::{Window, ordered, released, settle, window};
use crate::fake::Fake;

/// Where a point of the followed arena is on the screen.
fn place(window: &Window, (x_m, y_m): (f32, f32)) -> Pos2 {
    let followed = format!("Arena {}", window.state().desk.followed + 1);
    let view = window.get_by_label(&followed).rect().expand2(vec2(4.0, 0.0));
    // The enclosure is 4 m by 4 m; around it is room for the legend.
    let scale = ((view.width() - 36.0) / 4.0).min((view.height() - 68.0) / 4.0);
    view.center() + vec2(x_m, -y_m) * scale
}

/// Takes hold of what is at `at_m` and drags it a little; gives what was ordered, and what is while the pointer rests.
fn dragged(window: &mut Window, at_m: (f32, f32)) -> (Vec<Order>, Vec<Order>) {
    let at = place(window, at_m);
    window.hover_at(at);
    settle(window);
    window.event(Event::PointerButton {
        pos: at,
        button: PointerButton::Primary,
        pressed: true,
        modifiers: egui::Modifiers::NONE,
    });
    window.step();
    assert_eq!(window.state().orders, [], "it may still be a click");
    let to = at + vec2(0.0, 14.0);
    window.hover_at(to);
    window.step();
    window.step();
    let moved = std::mem::take(&mut window.state_mut().orders);
    let rested = ordered(window);
    window.event(released(to));
    settle(window);
    window.state_mut().orders.clear();
    assert_eq!(ordered(window), [], "let go");
    (moved, rested)
}

fn robot(window: &Window) -> (f32, f32) {
    let arena = &window.state().scene.arenas[window.state().desk.followed];
    (arena.pose.x_m, arena.pose.y_m)
}

fn target(window: &Window) -> (f32, f32) {
    let arena = &window.state().scene.arenas[window.state().desk.followed];
    (arena.target.x_m, arena.target.y_m)
}

#[test]
fn a_robot_or_a_target_does_not_leave_a_hand_that_rests() {
    for grip in [robot, target] {
        let mut window = window(Fake::default());
        let at_m = grip(&window);
        let (moved, rested) = dragged(&mut window, at_m);
        assert!(!moved.is_empty());
        assert_eq!(rested.len(), 6, "in each frame");
        assert!(rested.iter().all(|order| Some(order) == moved.last()), "{moved:?} {rested:?}");
        window.state_mut().status.paused = true;
        settle(&mut window);
        let (moved, rested) = dragged(&mut window, at_m);
        assert!(!moved.is_empty() && rested.is_empty(), "nothing drives when time stands still");
    }
}

#[test]
fn an_obstacle_moves_with_the_pointer_alone_and_says_in_which_arena() {
    let mut fake = Fake::default();
    fake.desk.followed = 2;
    let mut window = window(fake);
    let (moved, rested) = dragged(&mut window, (-0.6, -0.6));
    let [Order::Move(Moved::Obstacle { arena: 2, index: 2, to_m })] = moved[..] else { panic!("{moved:?}") };
    assert!((to_m.0 + 0.6).abs() < 1e-3 && to_m.1 < -0.6, "{to_m:?}");
    assert_eq!(rested, []);
}

#[test]
fn what_was_pressed_is_held_though_it_drove_on() {
    let mut window = window(Fake::default());
    let at = place(&window, robot(&window));
    window.hover_at(at);
    settle(&mut window);
    window.drag_at(at);
    window.step();
    window.state_mut().scene.arenas[0].pose.x_m += 0.5;
    settle(&mut window);
    window.hover_at(pos2(at.x, at.y + 14.0));
    let moved = ordered(&mut window);
    assert!(matches!(moved.first(), Some(Order::Move(Moved::Robot { arena: 0, .. }))), "{moved:?}");
}
