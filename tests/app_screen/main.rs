//! The screen asks for what is pressed, and for nothing else. `setup.rs`: the panel on the left; `room.rs`: what has room
//! in which window; `hand.rs`: what is dragged in the world; `narrow.rs`: a phone's window.

#![cfg(feature = "window")]

#[path = "../support/fake.rs"]
mod fake;

mod editor;
mod editor_canvas;
mod hand;
mod narrow;
mod room;
mod setup;

use std::path::Path;

use egui::{Key, Modifiers, Rect};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use fake::Fake;
use wayfield::app::desk::{Camera, Look};
use wayfield::app::orders::{Mode, Order, Pace};
use wayfield::app::status::Weight;

type Window = Harness<'static, Fake>;

/// A window of the usual size, drawn often enough to be at rest.
fn window(fake: Fake) -> Window {
    window_of(fake, [1280.0, 860.0])
}

fn window_of(fake: Fake, size: [f32; 2]) -> Window {
    let build = Harness::builder().with_size(size).with_max_steps(40);
    let mut window = build.build_ui_state(|ui, fake: &mut Fake| fake.draw(ui), fake);
    settle(&mut window);
    window
}

fn settle(window: &mut Window) {
    window.run_steps(6);
}

/// What was ordered since the last time.
fn ordered(window: &mut Window) -> Vec<Order> {
    settle(window);
    std::mem::take(&mut window.state_mut().orders)
}

fn click(window: &mut Window, label: &str) -> Vec<Order> {
    window.get_by_label(label).click();
    ordered(window)
}

fn press(window: &mut Window, key: Key) -> Vec<Order> {
    window.key_press(key);
    ordered(window)
}

/// Where the bar's controls stand, as many as there are.
fn controls_in_the_bar(window: &Window) -> Vec<Rect> {
    let words = [
        "Setup panel",
        "Run",
        "Pause",
        "Step",
        "1×",
        "Full",
        "Train",
        "Compare",
        "Edit",
        "Dark",
        "Light",
        "Help",
        "Plots panel",
    ];
    words.iter().filter_map(|word| window.query_by_label(word).map(|n| n.rect())).collect()
}

/// Asserts that `rects` lie in a window of this width, and none over another.
fn assert_apart(rects: &[Rect], width: f32) {
    for (k, a) in rects.iter().enumerate() {
        assert!(a.min.x >= 0.0 && a.max.x <= width, "{a:?} is outside at {width}");
        for b in &rects[k + 1..] {
            assert!(!a.shrink(0.5).intersects(b.shrink(0.5)), "{a:?} and {b:?} at {width}");
        }
    }
}

fn released(pos: egui::Pos2) -> egui::Event {
    let (button, modifiers) = (egui::PointerButton::Primary, Modifiers::NONE);
    egui::Event::PointerButton { pos, button, pressed: false, modifiers }
}

#[test]
fn looking_orders_nothing() {
    let mut window = window(Fake::default().with_notices());
    assert_eq!(ordered(&mut window), []);
    for label in
        ["Setup panel", "Plots panel", "Plots panel", "Setup panel", "All arenas", "One arena", "Fit", "Help"]
    {
        assert_eq!(click(&mut window, label), [], "{label}");
    }
    for key in [Key::G, Key::Tab, Key::F, Key::B, Key::P, Key::V, Key::Q, Key::T, Key::W, Key::L, Key::H] {
        assert_eq!(press(&mut window, key), [], "{key:?}");
    }
}

#[test]
fn time_is_in_the_users_hand() {
    let mut window = window(Fake::default());
    assert_eq!(click(&mut window, "Pause"), [Order::Pause(true)]);
    assert_eq!(press(&mut window, Key::Space), [Order::Pause(true)]);
    window.state_mut().status.paused = true;
    settle(&mut window);
    assert_eq!(click(&mut window, "Run"), [Order::Pause(false)]);
    assert_eq!(press(&mut window, Key::Space), [Order::Pause(false)]);
    assert_eq!(click(&mut window, "Step"), [Order::Step]);
    assert_eq!(press(&mut window, Key::Period), [Order::Step]);
    assert_eq!(click(&mut window, "100×"), [Order::SetPace(Pace::Times(100.0))]);
    assert_eq!(click(&mut window, "Full"), [Order::SetPace(Pace::Full)]);
    assert_eq!(press(&mut window, Key::Num2), [Order::SetPace(Pace::Times(5.0))]);
}

#[test]
fn a_key_held_down_counts_once_but_for_the_step() {
    let mut window = window(Fake::default());
    let held = |key| egui::Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::NONE,
    };
    for (key, times) in [(Key::Space, 1), (Key::Period, 3)] {
        for _ in 0..3 {
            window.event(held(key));
            window.step();
        }
        window.key_up(key);
        assert_eq!(ordered(&mut window).len(), times, "{key:?}");
    }
}

#[test]
fn a_first_time_user_is_called_to_start() {
    let mut window = window(Fake::fresh());
    assert_eq!(click(&mut window, "Start learning"), [Order::Pause(false)]);
    window.state_mut().status.paused = false;
    settle(&mut window);
    assert!(window.query_by_label("Start learning").is_none(), "the call goes when learning does");
    let mut fake = Fake::fresh();
    fake.status.transfer_from = Some("best.safetensors".into());
    let window = self::window(fake);
    assert!(window.query_by_label("Start learning").is_none(), "it knows something already");
}

#[test]
fn the_mode_is_chosen_and_compare_asks_for_a_second_policy() {
    let mut window = window(Fake::default());
    window.state_mut().status.expert = None;
    assert_eq!(click(&mut window, "Test"), [Order::SetMode(Mode::Test)]);
    assert_eq!(click(&mut window, "Drive"), [Order::SetMode(Mode::Drive)]);
    assert_eq!(click(&mut window, "Compare"), [Order::OpenDialog]);
    window.state_mut().status.opened = Some("best".into());
    settle(&mut window);
    assert_eq!(click(&mut window, "Compare"), [Order::SetMode(Mode::Compare)]);
}

#[test]
fn while_training_rests_it_is_said_and_there_is_nothing_to_choose_between() {
    let mut window = window(Fake::default().driven_alone());
    assert!(window.query_by_label("Training rests meanwhile.").is_some());
    assert!(window.query_by_label("All arenas").is_none() && window.query_by_label("Fit").is_some());
    window.state_mut().status.mode = Mode::Train;
    settle(&mut window);
    assert!(window.query_by_label("Training rests meanwhile.").is_none());
    assert!(window.query_by_label("All arenas").is_some());
}

#[test]
fn when_time_stands_still_the_bar_says_how_much_has_passed() {
    let mut fake = Fake::default();
    fake.status.paused = true;
    for (simulated_s, words) in
        [(42.0, "42 s"), (200.0, "3 min"), (7_812.0, "2.2 h"), (7.2e6, "2,000 h"), (f64::NAN, "0 s")]
    {
        fake.status.simulated_s = simulated_s;
        let label = format!("{words} simulated paused");
        let window = self::window(fake);
        assert!(window.query_by_label(&label).is_some(), "{label}");
        fake = Fake::default();
        fake.status.paused = true;
    }
}

#[test]
fn arrows_steer_in_drive_mode_alone_and_are_said_once() {
    let mut window = window(Fake::default());
    assert_eq!(press(&mut window, Key::ArrowLeft), []);
    window.state_mut().status.mode = Mode::Drive;
    assert_eq!(ordered(&mut window), [Order::Steer(2)], "straight on to begin with");
    window.key_down(Key::ArrowLeft);
    assert_eq!(ordered(&mut window), [Order::Steer(0)], "a sharp turn, ordered once however long it is held");
    window.key_down(Key::ArrowUp);
    assert_eq!(ordered(&mut window), [Order::Steer(1)]);
    window.key_up(Key::ArrowLeft);
    assert_eq!(ordered(&mut window), [Order::Steer(2)]);
    window.key_down(Key::ArrowRight);
    assert_eq!(ordered(&mut window), [Order::Steer(3)]);
    window.key_up(Key::ArrowUp);
    assert_eq!(ordered(&mut window), [Order::Steer(4)]);
}

#[test]
fn keys_and_switches_change_the_desk_alike() {
    let mut window = window(Fake::default());
    assert!(!window.state().desk.overlays.trails);
    click(&mut window, "Trails");
    assert!(window.state().desk.overlays.trails);
    press(&mut window, Key::T);
    assert!(!window.state().desk.overlays.trails);
    press(&mut window, Key::G);
    assert!(window.state().desk.grid);
    click(&mut window, "One arena");
    assert!(!window.state().desk.grid);
    press(&mut window, Key::Tab);
    press(&mut window, Key::Tab);
    assert_eq!(window.state().desk.followed, 2);
    window.state_mut().desk.camera.zoom = 3.0;
    click(&mut window, "Fit");
    assert_eq!(window.state().desk.camera, Camera::default());
    window.state_mut().desk.look = Look::Dark;
    settle(&mut window);
    press(&mut window, Key::L);
    assert_eq!(window.state().desk.look, Look::Light);
    click(&mut window, "Dark");
    assert_eq!(window.state().desk.look, Look::Dark);
}

#[test]
fn help_opens_lists_the_keys_and_closes() {
    let mut window = window(Fake::default());
    click(&mut window, "Help");
    assert!(window.query_by_label("Follow the next arena").is_some());
    press(&mut window, Key::Escape);
    assert!(!window.state().desk.help_open);
    window.key_press_modifiers(Modifiers::SHIFT, Key::Questionmark);
    settle(&mut window);
    assert!(window.state().desk.help_open);
}

#[test]
fn a_notice_stands_until_it_is_read() {
    let mut window = window(Fake::default().with_notices());
    let text = window.state().status.notices[1].text.clone();
    assert_eq!(window.state().status.notices[1].weight, Weight::Failed);
    assert!(window.query_by_label(&text).is_some(), "all its lines are there");
    for index in 0..2 {
        window.get_all_by_label("Dismiss").nth(index).expect("each can be closed").click();
        assert_eq!(ordered(&mut window), [Order::Dismiss(index)]);
    }
}

#[test]
fn an_unknown_scenario_and_odd_numbers_are_drawn_without_a_panic() {
    let mut fake = Fake::default();
    let s = &mut fake.status;
    s.scenario_from = Path::new("elsewhere").join("mine.ron").display().to_string();
    (s.pace, s.success_rate, s.env_steps_per_s, s.times_real) =
        (Pace::Times(3.5), Some(f64::NAN), f64::INFINITY, f64::NAN);
    (s.simulated_s, s.frames_per_s) = (-1.0, 0.0);
    fake.desk.followed = 99;
    let mut window = window(fake);
    assert_eq!(ordered(&mut window), []);
    assert_eq!(window.state().desk.followed, 7);
}
