//! Tests of the screen: which commands its widgets and keys send, and that nothing else sends any.
//!
//! | file | about |
//! |---|---|
//! | `setup.rs` | the setup panel |
//! | `layout.rs`, `narrow.rs` | the layout in windows of different sizes, and on a phone |
//! | `dragging.rs` | dragging objects in an arena |
//! | `editor.rs`, `editor_canvas.rs` | the scenario editor: its panel, its drawing |

#![cfg(feature = "gui")]

#[path = "../support/screen_fixture.rs"]
mod screen_fixture;

mod dragging;
mod editor;
mod editor_canvas;
mod layout;
mod narrow;
mod setup;

use std::path::Path;

use egui::{Key, Modifiers, Rect};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use screen_fixture::ScreenFixture;
use wayfield::app::app_status::Severity;
use wayfield::app::commands::{Command, Pace, SessionMode};
use wayfield::app::view_state::{ThemeChoice, ViewCamera};

type Window = Harness<'static, ScreenFixture>;

/// A window of the usual size, after enough frames for the layout to settle.
fn window(screen_fixture: ScreenFixture) -> Window {
    window_with_size(screen_fixture, [1280.0, 860.0])
}

fn window_with_size(screen_fixture: ScreenFixture, size: [f32; 2]) -> Window {
    let build = Harness::builder().with_size(size).with_max_steps(40);
    let mut window = build
        .build_ui_state(|ui, screen_fixture: &mut ScreenFixture| screen_fixture.draw(ui), screen_fixture);
    settle(&mut window);
    window
}

fn settle(window: &mut Window) {
    window.run_steps(6);
}

/// The commands sent since the last call.
fn sent_commands(window: &mut Window) -> Vec<Command> {
    settle(window);
    std::mem::take(&mut window.state_mut().commands)
}

fn click(window: &mut Window, label: &str) -> Vec<Command> {
    window.get_by_label(label).click();
    sent_commands(window)
}

fn press(window: &mut Window, key: Key) -> Vec<Command> {
    window.key_press(key);
    sent_commands(window)
}

/// The rectangles of the toolbar's controls that are shown.
fn toolbar_control_rects(window: &Window) -> Vec<Rect> {
    let labels = [
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
    labels.iter().filter_map(|label| window.query_by_label(label).map(|n| n.rect())).collect()
}

/// Asserts that `rects` are inside a window of this width and do not overlap.
fn assert_no_overlap(rects: &[Rect], width: f32) {
    for (k, a) in rects.iter().enumerate() {
        assert!(a.min.x >= 0.0 && a.max.x <= width, "{a:?} is outside at {width}");
        for b in &rects[k + 1..] {
            assert!(!a.shrink(0.5).intersects(b.shrink(0.5)), "{a:?} and {b:?} at {width}");
        }
    }
}

fn release_event(pos: egui::Pos2) -> egui::Event {
    let (button, modifiers) = (egui::PointerButton::Primary, Modifiers::NONE);
    egui::Event::PointerButton { pos, button, pressed: false, modifiers }
}

#[test]
fn changing_the_view_sends_no_command() {
    let mut window = window(ScreenFixture::default().with_notices());
    assert_eq!(sent_commands(&mut window), []);
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
fn buttons_and_keys_control_the_pace() {
    let mut window = window(ScreenFixture::default());
    assert_eq!(click(&mut window, "Pause"), [Command::Pause(true)]);
    assert_eq!(press(&mut window, Key::Space), [Command::Pause(true)]);
    window.state_mut().status.paused = true;
    settle(&mut window);
    assert_eq!(click(&mut window, "Run"), [Command::Pause(false)]);
    assert_eq!(press(&mut window, Key::Space), [Command::Pause(false)]);
    assert_eq!(click(&mut window, "Step"), [Command::Step]);
    assert_eq!(press(&mut window, Key::Period), [Command::Step]);
    window.key_press_modifiers(Modifiers::SHIFT, Key::Period);
    assert_eq!(sent_commands(&mut window), [Command::Step], "a full stop needs Shift on French keyboards");
    assert_eq!(click(&mut window, "100×"), [Command::SetPace(Pace::Times(100.0))]);
    assert_eq!(click(&mut window, "Full"), [Command::SetPace(Pace::Full)]);
    assert_eq!(press(&mut window, Key::Num2), [Command::SetPace(Pace::Times(5.0))]);
}

#[test]
fn a_key_held_down_acts_once_except_the_step_key() {
    let mut window = window(ScreenFixture::default());
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
        assert_eq!(sent_commands(&mut window).len(), times, "{key:?}");
    }
}

#[test]
fn the_start_button_is_shown_only_before_training_has_begun() {
    let mut window = window(ScreenFixture::untrained());
    assert_eq!(click(&mut window, "Start learning"), [Command::Pause(false)]);
    window.state_mut().status.paused = false;
    settle(&mut window);
    assert!(window.query_by_label("Start learning").is_none(), "the button disappears when training runs");
    let mut screen_fixture = ScreenFixture::untrained();
    screen_fixture.status.transfer_from = Some("best.safetensors".into());
    let window = self::window(screen_fixture);
    assert!(window.query_by_label("Start learning").is_none(), "the policy has been trained before");
}

#[test]
fn the_modes_can_be_chosen_and_compare_needs_a_second_policy() {
    let mut window = window(ScreenFixture::default());
    window.state_mut().status.expert = None;
    assert_eq!(click(&mut window, "Test"), [Command::SetMode(SessionMode::Test)]);
    assert_eq!(click(&mut window, "Drive"), [Command::SetMode(SessionMode::Drive)]);
    assert_eq!(click(&mut window, "Compare"), [Command::OpenDialog]);
    window.state_mut().status.opened_policy = Some("best".into());
    settle(&mut window);
    assert_eq!(click(&mut window, "Compare"), [Command::SetMode(SessionMode::Compare)]);
}

#[test]
fn in_test_mode_a_note_says_that_training_is_paused_and_the_grid_is_not_offered() {
    let mut window = window(ScreenFixture::default().with_single_policy());
    assert!(window.query_by_label("Training is paused in this mode").is_some());
    assert!(window.query_by_label("All arenas").is_none() && window.query_by_label("Fit").is_some());
    window.state_mut().status.mode = SessionMode::Train;
    settle(&mut window);
    assert!(window.query_by_label("Training is paused in this mode").is_none());
    assert!(window.query_by_label("All arenas").is_some());
}

#[test]
fn while_paused_the_toolbar_shows_the_simulated_time() {
    for (simulated_s, time) in
        [(42.0, "42 s"), (200.0, "3 min"), (7_812.0, "2.2 h"), (7.2e6, "2,000 h"), (f64::NAN, "0 s")]
    {
        let mut screen_fixture = ScreenFixture::default();
        (screen_fixture.status.paused, screen_fixture.status.simulated_s) = (true, simulated_s);
        let label = format!("{time} simulated paused");
        let window = window(screen_fixture);
        assert!(window.query_by_label(&label).is_some(), "{label}");
    }
}

#[test]
fn arrow_keys_steer_in_drive_mode_only_and_send_each_motion_once() {
    let mut window = window(ScreenFixture::default());
    assert_eq!(press(&mut window, Key::ArrowLeft), []);
    window.state_mut().status.mode = SessionMode::Drive;
    assert_eq!(sent_commands(&mut window), [Command::Steer(2)], "straight ahead at first");
    window.key_down(Key::ArrowLeft);
    assert_eq!(
        sent_commands(&mut window),
        [Command::Steer(0)],
        "a sharp turn, sent once however long the key is held"
    );
    window.key_down(Key::ArrowUp);
    assert_eq!(sent_commands(&mut window), [Command::Steer(1)]);
    window.key_up(Key::ArrowLeft);
    assert_eq!(sent_commands(&mut window), [Command::Steer(2)]);
    window.key_down(Key::ArrowRight);
    assert_eq!(sent_commands(&mut window), [Command::Steer(3)]);
    window.key_up(Key::ArrowUp);
    assert_eq!(sent_commands(&mut window), [Command::Steer(4)]);
}

#[test]
fn no_key_acts_behind_an_open_question() {
    let keys = [Key::Space, Key::Period, Key::Num2, Key::G, Key::T, Key::E, Key::L, Key::H, Key::Tab];
    let ignores_keys = |window: &mut Window| {
        let before = window.state().view_state.clone();
        for key in keys {
            assert_eq!(press(window, key), [], "{key:?}");
        }
        for key in [Key::S, Key::O] {
            window.key_press_modifiers(Modifiers::COMMAND, key);
            assert_eq!(sent_commands(window), [], "Ctrl+{key:?}");
        }
        assert_eq!(window.state().view_state, before, "the view is as it was");
    };
    let mut window = window(ScreenFixture::default());
    window.state_mut().status.quit_question = true;
    settle(&mut window);
    ignores_keys(&mut window);
    assert_eq!(press(&mut window, Key::Escape), [Command::KeepOpen]);
    window.state_mut().status.mode = SessionMode::Drive;
    window.key_down(Key::ArrowLeft);
    assert_eq!(sent_commands(&mut window), [Command::Steer(2)], "straight ahead");
    window.state_mut().status.quit_question = false;
    assert_eq!(sent_commands(&mut window), [Command::Steer(0)], "the key is held down");

    // A set of scenarios cannot be edited: a question opens in place of the editor.
    let mut window = self::window(ScreenFixture::default());
    let ScreenFixture { scene, status, .. } = window.state_mut();
    status.is_set = true;
    scene.arenas.iter_mut().for_each(|arena| arena.set_member = Some("Clutter, level 17".into()));
    settle(&mut window);
    press(&mut window, Key::E);
    ignores_keys(&mut window);
    press(&mut window, Key::Escape);
    assert!(window.query_by_label_contains("A set of scenarios cannot be edited here").is_none());
    assert_eq!(press(&mut window, Key::Num2), [Command::SetPace(Pace::Times(5.0))], "keys act again");
}

#[test]
fn keys_and_switches_change_the_same_settings() {
    let mut window = window(ScreenFixture::default());
    assert!(!window.state().view_state.overlays.trails);
    click(&mut window, "Past paths");
    assert!(window.state().view_state.overlays.trails);
    press(&mut window, Key::T);
    assert!(!window.state().view_state.overlays.trails);
    press(&mut window, Key::G);
    assert!(window.state().view_state.grid);
    click(&mut window, "One arena");
    assert!(!window.state().view_state.grid);
    press(&mut window, Key::Tab);
    press(&mut window, Key::Tab);
    assert_eq!(window.state().view_state.followed, 2);
    window.state_mut().view_state.camera.zoom = 3.0;
    click(&mut window, "Fit");
    assert_eq!(window.state().view_state.camera, ViewCamera::default());
    window.state_mut().view_state.theme = ThemeChoice::Dark;
    settle(&mut window);
    press(&mut window, Key::L);
    assert_eq!(window.state().view_state.theme, ThemeChoice::Light);
    click(&mut window, "Dark");
    assert_eq!(window.state().view_state.theme, ThemeChoice::Dark);
}

#[test]
fn the_help_window_opens_lists_the_shortcuts_and_closes() {
    let mut window = window(ScreenFixture::default());
    click(&mut window, "Help");
    assert!(window.query_by_label("Follow the next arena").is_some());
    let [first, last] = ["Move the robot, the goal or an obstacle", "Larger or smaller text and controls"]
        .map(|label| window.get_by_label(label).rect());
    assert!(first.min.y > 0.0 && last.max.y < 860.0, "all of it is visible: {first} {last}");
    press(&mut window, Key::Escape);
    assert!(!window.state().view_state.help_open);
    window.key_press_modifiers(Modifiers::SHIFT, Key::Questionmark);
    settle(&mut window);
    assert!(window.state().view_state.help_open);
}

#[test]
fn every_notice_is_shown_in_full_and_can_be_dismissed() {
    let mut window = window(ScreenFixture::default().with_notices());
    let text = window.state().status.notices[1].text.clone();
    assert_eq!(window.state().status.notices[1].severity, Severity::Error);
    assert!(window.query_by_label(&text).is_some(), "all lines are shown");
    for index in 0..2 {
        window.get_all_by_label("Dismiss").nth(index).expect("each notice has a button").click();
        let notice = window.state().status.notices[index].clone();
        assert_eq!(sent_commands(&mut window), [Command::DismissNotice(notice)]);
    }
}

#[test]
fn an_unknown_scenario_and_non_finite_numbers_are_drawn_without_a_panic() {
    let mut screen_fixture = ScreenFixture::default();
    let s = &mut screen_fixture.status;
    s.scenario_from = Path::new("elsewhere").join("mine.ron").display().to_string();
    (s.pace, s.success_rate, s.env_steps_per_s, s.real_time_factor) =
        (Pace::Times(3.5), Some(f64::NAN), f64::INFINITY, f64::NAN);
    (s.simulated_s, s.frames_per_s) = (-1.0, 0.0);
    screen_fixture.view_state.followed = 99;
    let mut window = window(screen_fixture);
    assert_eq!(sent_commands(&mut window), []);
    assert_eq!(window.state().view_state.followed, 7);
}
