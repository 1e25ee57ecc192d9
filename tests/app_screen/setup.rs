//! The setup panel: choices wait for a button, and discarding a training needs a confirmation.

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use wayfield::app::app_snapshot::LastSession;
use wayfield::app::commands::{Command, SaveKind};
use wayfield::app::screen;

use super::{Window, click, press, release_event, sent_commands, settle, window};
use crate::screen_fixture::ScreenFixture;

#[test]
fn choices_take_effect_when_a_button_is_clicked() {
    let mut window = window(ScreenFixture::default());
    assert!(window.query_by_label("Continue here with this policy").is_none());
    assert_eq!(click(&mut window, "Scenario"), []);
    assert_eq!(click(&mut window, "Scenario II"), []);
    assert_eq!(click(&mut window, "Learner"), []);
    assert_eq!(click(&mut window, "DQN"), []);
    let transfer = Command::Transfer { scenario: "scenario-2".into(), epsilon: 0.5 };
    assert_eq!(click(&mut window, "Continue here with this policy"), [transfer]);
    let restart = Command::StartTraining { scenario: "scenario-2".into(), preset: "dqn".into(), seed: 7 };
    assert_eq!(click(&mut window, "Restart training"), [restart]);
    // The chosen training runs now: nothing is left to start.
    let status = &mut window.state_mut().status;
    (status.scenario_from, status.preset_from, status.seed) = ("scenario-2".into(), "dqn".into(), 7);
    settle(&mut window);
    assert!(window.query_by_label("Continue here with this policy").is_none());
}

#[test]
fn a_training_worth_keeping_is_discarded_only_after_a_confirmation() {
    let mut window = window(ScreenFixture::default());
    window.state_mut().status.restart_loses_training = true;
    assert_eq!(click(&mut window, "Restart training"), []);
    assert!(window.query_by_label("Discard this training (1,284 episodes)?").is_some());
    assert_eq!(click(&mut window, "Cancel"), []);
    assert!(window.query_by_label("Cancel").is_none());
    assert_eq!(click(&mut window, "Restart training"), []);
    let restart = Command::StartTraining { scenario: "scenario-1".into(), preset: "fast".into(), seed: 7 };
    assert_eq!(click(&mut window, "Discard"), [restart]);
    assert!(window.query_by_label("Cancel").is_none(), "the question is gone");
    click(&mut window, "Restart training");
    let restart = Command::StartTraining { scenario: "scenario-1".into(), preset: "fast".into(), seed: 7 };
    assert_eq!(click(&mut window, "Save first"), [Command::SaveFirst(Box::new(restart))]);
    // A double click does not answer the question.
    let position = window.get_by_label("Restart training").rect().center();
    for _ in 0..2 {
        window.hover_at(position);
        window.drag_at(position);
        window.event(release_event(position));
        assert_eq!(sent_commands(&mut window), []);
    }
    assert!(window.query_by_label("Cancel").is_some());
}

#[test]
fn a_scenario_changed_by_hand_is_marked() {
    let mut window = window(ScreenFixture::default());
    assert!(window.query_by_label("changed by hand").is_none());
    window.state_mut().status.scenario_modified = true;
    settle(&mut window);
    assert!(window.query_by_label("changed by hand").is_some());
    window.get_by_label("Restart training").hover();
    window.run_steps(60);
    assert!(window.query_by_label_contains("in the scenario as in its file").is_some());
    click(&mut window, "Scenario");
    click(&mut window, "Scenario II");
    assert!(window.query_by_label("changed by hand").is_none(), "another scenario is chosen");
}

#[test]
fn training_can_start_from_an_opened_policy() {
    let mut window = window(ScreenFixture::default());
    assert!(window.query_by_label("Continue training this policy").is_none());
    window.state_mut().status.opened_policy = Some("best.safetensors".into());
    settle(&mut window);
    assert!(window.query_by_label("best.safetensors").is_some());
    assert_eq!(
        click(&mut window, "Continue training this policy"),
        [Command::TrainFromOpened { epsilon: 0.5 }]
    );
    window.state_mut().status.restart_loses_training = true;
    assert_eq!(click(&mut window, "Continue training this policy"), []);
    let right = window.get_by_label("Cancel").rect().max.x;
    assert!(right < 248.0 - 14.0, "the question fits into the panel: {right}");
    assert_eq!(click(&mut window, "Discard"), [Command::TrainFromOpened { epsilon: 0.5 }]);
}

#[test]
fn the_seed_can_be_typed_or_drawn_at_random() {
    let mut window = window(ScreenFixture::default());
    window.get_by_label("Seed").click();
    settle(&mut window);
    window.get_by_label("Seed").type_text("1");
    settle(&mut window);
    // In a text field, keys are text.
    assert_eq!(press(&mut window, Key::Space), []);
    window.key_press(Key::Enter);
    settle(&mut window);
    let seed = |commands: Vec<Command>| match commands.as_slice() {
        [Command::StartTraining { seed, .. }] => *seed,
        _ => panic!("{commands:?}"),
    };
    let typed = seed(click(&mut window, "Restart training"));
    assert_ne!(typed, 7);
    assert_eq!(click(&mut window, "Random seed"), []);
    assert_ne!(seed(click(&mut window, "Restart training")), typed);
}

#[test]
fn buttons_and_keys_open_the_file_dialogs() {
    let mut window = window(ScreenFixture::default());
    assert_eq!(click(&mut window, "Open…"), [Command::OpenDialog]);
    for (label, saved) in [
        ("Save policy…", SaveKind::Policy),
        ("Save run…", SaveKind::Run),
        ("Save scenario…", SaveKind::Scenario),
    ] {
        assert_eq!(click(&mut window, label), [Command::SaveDialog(saved)]);
    }
    window.key_press_modifiers(Modifiers::COMMAND, Key::S);
    assert_eq!(sent_commands(&mut window), [Command::SaveDialog(SaveKind::Policy)]);
    window.key_press_modifiers(Modifiers::COMMAND, Key::O);
    assert_eq!(sent_commands(&mut window), [Command::OpenDialog]);
}

#[test]
fn an_expert_can_be_opened_by_its_button_and_by_compare() {
    let mut window = window(ScreenFixture::default());
    assert_eq!(click(&mut window, "Watch an expert"), [Command::OpenExpert]);
    assert_eq!(click(&mut window, "Compare"), [Command::OpenExpert]);
    window.state_mut().status.expert = None;
    settle(&mut window);
    assert!(window.query_by_label("Watch an expert").is_none());
    assert_eq!(click(&mut window, "Compare"), [Command::OpenDialog]);
}

#[test]
fn without_a_disk_no_run_can_be_saved_and_the_curves_are_an_svg() {
    let mut window = window(ScreenFixture::default());
    window.state_mut().status.has_disk = false;
    settle(&mut window);
    assert!(window.query_by_label("Save run…").is_none());
    assert_eq!(click(&mut window, "Save scenario…"), [Command::SaveDialog(SaveKind::Scenario)]);
    assert_eq!(click(&mut window, "SVG…"), [Command::SaveDialog(SaveKind::Png)]);
}

#[test]
fn the_last_session_is_offered_with_what_it_is() {
    let mut window = window(ScreenFixture::default());
    assert!(window.query_by_label("Continue where you left off?").is_none());
    window.state_mut().status.last_session = Some(LastSession {
        scenario: "Maze".into(),
        preset: "fast".into(),
        seed: 4,
        env_steps: 123_456,
        age_s: 200,
    });
    settle(&mut window);
    assert!(window.query_by_label("Maze, fast, seed 4 · 123,456 steps · 3 min ago").is_some());
    assert_eq!(click(&mut window, "Continue"), [Command::ContinueLastSession]);
    assert_eq!(click(&mut window, "Not now"), [Command::DismissLastSession]);
}

#[test]
fn closing_the_window_asks_about_edits_and_then_about_the_training() {
    let mut window = window(ScreenFixture::default());
    window.state_mut().status.quit_question = true;
    settle(&mut window);
    assert!(window.query_by_label("This training (1,284 episodes) is not saved.").is_some());
    assert_eq!(click(&mut window, "Save run and quit"), [Command::Quit { save: true }]);
    assert_eq!(click(&mut window, "Quit without saving"), [Command::Quit { save: false }]);
    assert_eq!(click(&mut window, "Cancel"), [Command::KeepOpen]);
    assert_eq!(press(&mut window, Key::Escape), [Command::KeepOpen]);
    window.state_mut().status.quit_question = false;

    let request = |window: &mut Window| {
        let ScreenFixture { view_state, commands, .. } = window.state_mut();
        screen::request_close(view_state, commands);
        settle(window);
        sent_commands(window)
    };
    assert_eq!(request(&mut window), [Command::Close]);
    press(&mut window, Key::E);
    click(&mut window, "Add a circle");
    assert_eq!(request(&mut window), [], "the editor asks first");
    assert_eq!(click(&mut window, "Discard changes").first(), Some(&Command::Close));
}
