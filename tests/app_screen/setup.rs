//! The setup panel: choices wait for a button, and discarding a training run needs a confirmation.

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use wayfield::app::app_status::{LastSession, UnsavedEdits};
use wayfield::app::commands::{Command, FigureFormat, PolicySource, SaveKind, SessionMode};
use wayfield::app::screen;

use super::{Window, click, press, release_event, sent_commands, settle, window};
use crate::screen_fixture::ScreenFixture;

#[test]
fn choices_take_effect_when_a_button_is_clicked() {
    let mut window = window(ScreenFixture::default());
    assert!(window.query_by_label_contains("Not running yet").is_none());
    assert!(window.query_by_label("Undo choice").is_none());
    assert_eq!(click(&mut window, "Scenario"), []);
    assert_eq!(click(&mut window, "Scenario II"), []);
    assert!(window.query_by_label("Not running yet: the training run is in Scenario I").is_some());
    assert_eq!(click(&mut window, "Learner"), []);
    assert_eq!(click(&mut window, "DQN"), []);
    assert!(window.query_by_label("Not running yet: the training run uses Fast").is_some());
    type_seed(&mut window, "42000");
    assert!(window.query_by_label("Not running yet: the training run has seed 7").is_some());
    let (scenario, preset, seed) = ("scenario-2".to_owned(), "dqn".to_owned(), 42_000);
    let transfer = Command::Transfer {
        policy: PolicySource::Current,
        scenario: scenario.clone(),
        preset: preset.clone(),
        seed,
        epsilon: 0.5,
    };
    assert_eq!(click(&mut window, "Continue training in Scenario II"), [transfer]);
    click(&mut window, "Continue with the best policy");
    let sent = click(&mut window, "Continue training in Scenario II");
    assert!(
        matches!(sent[..], [Command::Transfer { policy: PolicySource::Best, seed: 42_000, .. }]),
        "{sent:?}"
    );
    let restart = Command::StartTraining { scenario, preset, seed };
    assert_eq!(click(&mut window, "Train from scratch in Scenario II"), [restart]);
    // The chosen run has started: no choice is left to apply.
    let status = &mut window.state_mut().status;
    (status.scenario_from, status.preset_from, status.seed) = ("scenario-2".into(), "dqn".into(), 42_000);
    settle(&mut window);
    assert!(window.query_by_label_contains("Not running yet").is_none());
    assert!(window.query_by_label("Restart training").is_some());
}

#[test]
fn a_choice_can_be_undone_and_its_button_names_what_it_starts() {
    let mut window = window(ScreenFixture::default());
    for (list, choice, button) in [
        ("Scenario", "Scenario II", "Train from scratch in Scenario II"),
        ("Learner", "DQN", "Train from scratch with DQN"),
    ] {
        click(&mut window, list);
        click(&mut window, choice);
        assert!(window.query_by_label(button).is_some());
        assert_eq!(click(&mut window, "Undo choice"), []);
        assert!(
            window.query_by_label(button).is_none() && window.query_by_label("Restart training").is_some()
        );
    }
    type_seed(&mut window, "5");
    let restart = Command::StartTraining { scenario: "scenario-1".into(), preset: "fast".into(), seed: 5 };
    assert_eq!(click(&mut window, "Train from scratch with seed 5"), [restart]);
}

#[test]
fn a_transfer_is_confirmed_and_shows_where_its_policy_comes_from() {
    let mut window = window(ScreenFixture::default());
    window.state_mut().status.restart_loses_training = true;
    click(&mut window, "Scenario");
    click(&mut window, "Scenario II");
    for policy in ["best", "current"] {
        assert_eq!(click(&mut window, "Continue training in Scenario II"), []);
        assert!(window.query_by_label_contains("Its policy continues").is_some());
        click(&mut window, &format!("Continue with the {policy} policy"));
        assert!(window.query_by_label("Cancel").is_none(), "the question was about the other policy");
    }
    assert_eq!(click(&mut window, "Continue training in Scenario II"), []);
    let transfer = Command::Transfer {
        policy: PolicySource::Current,
        scenario: "scenario-2".into(),
        preset: "fast".into(),
        seed: 7,
        epsilon: 0.5,
    };
    assert_eq!(click(&mut window, "Continue"), [transfer]);
    let status = &mut window.state_mut().status;
    (status.scenario_from, status.transfer_from) =
        ("scenario-2".into(), Some("Scenario I, 312,480 steps, seed 7".into()));
    settle(&mut window);
    assert!(window.query_by_label("policy from Scenario I, 312,480 steps, seed 7").is_some());
}

#[test]
fn a_training_run_worth_keeping_is_discarded_only_after_a_confirmation() {
    let mut window = window(ScreenFixture::default());
    window.state_mut().status.restart_loses_training = true;
    assert_eq!(click(&mut window, "Restart training"), []);
    assert!(window.query_by_label("Discard this training run (1,284 episodes)?").is_some());
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
    assert!(window.query_by_label_contains("in the scenario as it is in its file").is_some());
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
    assert_eq!(click(&mut window, "Continue training this policy"), [from_opened("scenario-1")]);
    window.state_mut().status.restart_loses_training = true;
    assert_eq!(click(&mut window, "Continue training this policy"), []);
    let right = window.get_by_label("Cancel").rect().max.x;
    assert!(right < 248.0 - 14.0, "the question fits into the panel: {right}");
    assert_eq!(click(&mut window, "Discard"), [from_opened("scenario-1")]);
    window.state_mut().status.restart_loses_training = false;
    click(&mut window, "Scenario");
    click(&mut window, "Scenario II");
    assert_eq!(click(&mut window, "Train this policy in Scenario II"), [from_opened("scenario-2")]);
}

fn from_opened(scenario: &str) -> Command {
    Command::Transfer {
        policy: PolicySource::Opened,
        scenario: scenario.into(),
        preset: "fast".into(),
        seed: 7,
        epsilon: 0.5,
    }
}

#[test]
fn the_seed_can_be_typed_or_drawn_at_random() {
    let mut window = window(ScreenFixture::default());
    window.get_by_label("Seed").click();
    settle(&mut window);
    // In a text field, keys are text.
    assert_eq!(press(&mut window, Key::Space), []);
    type_seed(&mut window, "1");
    let seed = |commands: Vec<Command>| match commands.as_slice() {
        [Command::StartTraining { seed, .. }] => *seed,
        _ => panic!("{commands:?}"),
    };
    assert_eq!(seed(click(&mut window, "Train from scratch with seed 1")), 1);
    // A seed is exact even where an f64 would round it. Text that is not a seed is refused with a message.
    type_seed(&mut window, "18446744073709551615");
    assert_eq!(seed(click(&mut window, "Train from scratch with seed 18446744073709551615")), u64::MAX);
    // The seed follows each letter until the text is no longer a seed: here, up to the second-to-last digit.
    for (text, problem) in [
        ("18446744073709551616", "Too large: 18446744073709551616. The seed stays 1844674407370955161"),
        ("x3", "Not a whole number: x3. The seed stays 1844674407370955161"),
        ("-5", "Negative: -5. The seed stays 1844674407370955161"),
        ("", "No number. The seed stays 1844674407370955161"),
    ] {
        type_seed(&mut window, text);
        assert!(window.query_by_label(problem).is_some(), "{problem}");
    }
    type_seed(&mut window, "42e3x");
    assert!(window.query_by_label("Not a whole number: 42e3x. The seed stays 42").is_some());
    assert_eq!(click(&mut window, "Random seed"), []);
    assert!(window.query_by_label_contains("Not a whole number").is_none());
    assert!(window.query_by_label("Train from scratch with seed 42").is_none(), "another seed was drawn");
}

/// Replaces the text of the seed field, letter by letter as on a keyboard, and leaves the field.
fn type_seed(window: &mut Window, text: &str) {
    window.get_by_label("Seed").click();
    settle(window);
    window.key_press_modifiers(Modifiers::COMMAND, Key::A);
    if text.is_empty() {
        window.key_press(Key::Backspace);
        window.step();
    }
    for letter in text.chars() {
        window.get_by_label("Seed").type_text(&letter.to_string());
        window.step();
    }
    window.key_press(Key::Enter);
    settle(window);
}

#[test]
fn buttons_and_keys_open_the_file_dialogs() {
    let mut window = window(ScreenFixture::default());
    assert_eq!(click(&mut window, "Open…"), [Command::OpenDialog]);
    for (label, saved) in [("Save run…", SaveKind::Run), ("Save scenario…", SaveKind::Scenario)] {
        assert_eq!(click(&mut window, label), [Command::SaveDialog(saved)]);
    }
    // There is a choice as soon as there is a best policy.
    for (label, saved) in [
        ("Best so far, 94.6% at 311,040 steps…", SaveKind::BestPolicy),
        ("Current, at 312,480 steps…", SaveKind::Policy),
    ] {
        assert_eq!(click(&mut window, "Save policy…"), []);
        assert_eq!(click(&mut window, label), [Command::SaveDialog(saved)]);
    }
    window.state_mut().status.best = None;
    settle(&mut window);
    assert_eq!(click(&mut window, "Save policy…"), [Command::SaveDialog(SaveKind::Policy)]);
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
    // The button names the scenario if the expert is from another one.
    window.state_mut().status.expert.as_mut().expect("there is one").is_new_here = true;
    settle(&mut window);
    assert_eq!(click(&mut window, "Watch the Scenario I expert"), [Command::OpenExpert]);
    assert!(window.query_by_label("Watch an expert").is_none());
    window.state_mut().status.expert = None;
    settle(&mut window);
    assert!(window.query_by_label_contains("expert").is_none());
    assert_eq!(click(&mut window, "Compare"), [Command::OpenDialog]);
}

#[test]
fn a_classical_driver_is_chosen_from_a_menu_that_names_the_classes() {
    let mut window = window(ScreenFixture::default());
    for (title, name) in [("Potential field", "field"), ("ORCA", "orca")] {
        assert_eq!(click(&mut window, "Watch a classical driver"), []);
        assert!(window.query_by_label("Class B: builds a map").is_some());
        assert_eq!(click(&mut window, title), [Command::OpenDriver(name)]);
    }
    window.state_mut().status.opened_driver = Some("ORCA".into());
    settle(&mut window);
    assert_eq!(click(&mut window, "Compare"), [Command::SetMode(SessionMode::Compare)]);
}

#[test]
fn the_best_policy_can_be_tested_and_compared() {
    let mut window = window(ScreenFixture::default());
    assert!(window.query_by_label("Best policy").is_none(), "not while training");
    window.state_mut().status.mode = SessionMode::Test;
    settle(&mut window);
    assert_eq!(click(&mut window, "Best policy"), [Command::SetTested(PolicySource::Best)]);
    assert_eq!(click(&mut window, "Current policy"), [Command::SetTested(PolicySource::Current)]);
    assert!(window.query_by_label("Compare both").is_none());
    window.state_mut().status.mode = SessionMode::Compare;
    settle(&mut window);
    assert_eq!(click(&mut window, "Compare both"), [Command::OpenBest]);
    window.state_mut().status.best = None;
    settle(&mut window);
    assert!(window.query_by_label("Best policy").is_none(), "before the first evaluation");
}

#[test]
fn without_a_disk_no_run_can_be_saved_and_the_curves_are_an_svg() {
    let mut window = window(ScreenFixture::default());
    window.state_mut().status.has_disk = false;
    settle(&mut window);
    assert!(window.query_by_label("Save run…").is_none());
    assert_eq!(click(&mut window, "Save scenario…"), [Command::SaveDialog(SaveKind::Scenario)]);
    assert_eq!(click(&mut window, "Export"), []);
    assert!(window.query_by_label("Figure as PNG…").is_none());
    let svg = SaveKind::Figure(FigureFormat::Svg);
    assert_eq!(click(&mut window, "Figure as SVG…"), [Command::SaveDialog(svg)]);
}

#[test]
fn the_last_session_is_offered_with_a_description() {
    let mut window = window(ScreenFixture::default());
    assert!(window.query_by_label("Continue where you left off?").is_none());
    window.state_mut().status.last_session = Some(last_session());
    settle(&mut window);
    assert!(window.query_by_label("Maze, fast, seed 4 · 123,456 steps · 3 min ago").is_some());
    assert_eq!(click(&mut window, "Continue"), [Command::ContinueLastSession]);
    assert_eq!(click(&mut window, "Not now"), [Command::DismissLastSession]);
}

fn last_session() -> LastSession {
    LastSession { scenario: "Maze".into(), preset: "fast".into(), seed: 4, env_steps: 123_456, age_s: 200 }
}

#[test]
fn unsaved_changes_of_an_earlier_session_are_offered_before_its_training() {
    let mut window = window(ScreenFixture::default());
    let status = &mut window.state_mut().status;
    status.unsaved_edits = Some(UnsavedEdits { scenario: "Maze".into(), age_s: 7_300 });
    status.last_session = Some(last_session());
    settle(&mut window);
    assert!(window.query_by_label("Maze · 2 h ago").is_some());
    assert!(window.query_by_label("Continue where you left off?").is_none());
    assert_eq!(click(&mut window, "Restore"), [Command::RestoreEdits]);
    assert_eq!(click(&mut window, "Not now"), [Command::DismissEdits]);
    window.state_mut().status.unsaved_edits = None;
    settle(&mut window);
    assert!(window.query_by_label("Continue where you left off?").is_some());
}

#[test]
fn closing_the_window_asks_about_edits_and_then_about_the_training() {
    let mut window = window(ScreenFixture::default());
    window.state_mut().status.quit_question = true;
    settle(&mut window);
    assert!(window.query_by_label("This training run (1,284 episodes) is not saved.").is_some());
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
