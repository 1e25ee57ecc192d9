//! The panel on the left: what is chosen waits for its button, and what would be lost is asked about.

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use wayfield::app::commands::{Command, SaveKind};

use super::{click, press, release_event, sent_commands, settle, window};
use crate::screen_fixture::ScreenFixture;

#[test]
fn a_choice_waits_for_the_button() {
    let mut window = window(ScreenFixture::default());
    assert!(window.query_by_label("Go on here with what it has learnt").is_none());
    assert_eq!(click(&mut window, "World"), []);
    assert_eq!(click(&mut window, "Scenario II"), []);
    assert_eq!(click(&mut window, "Learner"), []);
    assert_eq!(click(&mut window, "DQN"), []);
    let go_on = Command::Transfer { scenario: "scenario-2".into(), epsilon: 0.5 };
    assert_eq!(click(&mut window, "Go on here with what it has learnt"), [go_on]);
    let begin = Command::StartTraining { scenario: "scenario-2".into(), preset: "dqn".into(), seed: 7 };
    assert_eq!(click(&mut window, "Start again"), [begin]);
    // It runs now: nothing is pending any more.
    let status = &mut window.state_mut().status;
    (status.scenario_from, status.preset_from, status.seed) = ("scenario-2".into(), "dqn".into(), 7);
    settle(&mut window);
    assert!(window.query_by_label("Go on here with what it has learnt").is_none());
}

#[test]
fn a_training_of_some_worth_is_given_up_only_after_asking_back() {
    let mut window = window(ScreenFixture::default());
    window.state_mut().status.restart_loses_training = true;
    assert_eq!(click(&mut window, "Start again"), []);
    assert!(window.query_by_label("This training of 1,284 episodes will be gone.").is_some());
    assert_eq!(click(&mut window, "Keep it"), []);
    assert!(window.query_by_label("Keep it").is_none());
    assert_eq!(click(&mut window, "Start again"), []);
    let begin = Command::StartTraining { scenario: "scenario-1".into(), preset: "fast".into(), seed: 7 };
    assert_eq!(click(&mut window, "Start again"), [begin]);
    assert!(window.query_by_label("Keep it").is_none(), "answered");
    // A double click is no answer.
    let place = window.get_by_label("Start again").rect().center();
    for _ in 0..2 {
        window.hover_at(place);
        window.drag_at(place);
        window.event(release_event(place));
        assert_eq!(sent_commands(&mut window), []);
    }
    assert!(window.query_by_label("Keep it").is_some());
}

#[test]
fn a_world_changed_by_hand_says_so() {
    let mut window = window(ScreenFixture::default());
    assert!(window.query_by_label("changed by hand").is_none());
    window.state_mut().status.scenario_modified = true;
    settle(&mut window);
    assert!(window.query_by_label("changed by hand").is_some());
    window.get_by_label("Start again").hover();
    window.run_steps(60);
    assert!(window.query_by_label_contains("this world as its file has it").is_some());
    click(&mut window, "World");
    click(&mut window, "Scenario II");
    assert!(window.query_by_label("changed by hand").is_none(), "not the one that is chosen now");
}

#[test]
fn an_opened_policy_can_be_learnt_on_from() {
    let mut window = window(ScreenFixture::default());
    assert!(window.query_by_label("Learn on from it").is_none());
    window.state_mut().status.opened_policy = Some("best.safetensors".into());
    settle(&mut window);
    assert!(window.query_by_label("best.safetensors").is_some());
    assert_eq!(click(&mut window, "Learn on from it"), [Command::TrainFromOpened { epsilon: 0.5 }]);
    window.state_mut().status.restart_loses_training = true;
    assert_eq!(click(&mut window, "Learn on from it"), []);
    let right = window.get_by_label("Keep it").rect().max.x;
    assert!(right < 248.0 - 14.0, "the question is no wider than the panel: {right}");
    assert_eq!(click(&mut window, "Learn on from it"), [Command::TrainFromOpened { epsilon: 0.5 }]);
}

#[test]
fn the_seed_is_typed_or_thrown() {
    let mut window = window(ScreenFixture::default());
    window.get_by_label("Seed").click();
    settle(&mut window);
    window.get_by_label("Seed").type_text("1");
    settle(&mut window);
    // While it is written, keys are text.
    assert_eq!(press(&mut window, Key::Space), []);
    window.key_press(Key::Enter);
    settle(&mut window);
    let seed = |commands: Vec<Command>| match commands.as_slice() {
        [Command::StartTraining { seed, .. }] => *seed,
        _ => panic!("{commands:?}"),
    };
    let typed = seed(click(&mut window, "Start again"));
    assert_ne!(typed, 7);
    assert_eq!(click(&mut window, "New seed"), []);
    assert_ne!(seed(click(&mut window, "Start again")), typed);
}

#[test]
fn files_are_asked_for_by_button_and_by_key() {
    let mut window = window(ScreenFixture::default());
    assert_eq!(click(&mut window, "Open…"), [Command::OpenDialog]);
    for (label, saved) in
        [("Save policy", SaveKind::Policy), ("Save run", SaveKind::Run), ("Save world", SaveKind::Scenario)]
    {
        assert_eq!(click(&mut window, label), [Command::SaveDialog(saved)]);
    }
    window.key_press_modifiers(Modifiers::COMMAND, Key::S);
    assert_eq!(sent_commands(&mut window), [Command::SaveDialog(SaveKind::Policy)]);
    window.key_press_modifiers(Modifiers::COMMAND, Key::O);
    assert_eq!(sent_commands(&mut window), [Command::OpenDialog]);
}

#[test]
fn an_expert_is_one_click_away_by_button_and_by_compare() {
    let mut window = window(ScreenFixture::default());
    assert_eq!(click(&mut window, "Watch an expert"), [Command::OpenExpert]);
    assert_eq!(click(&mut window, "Compare"), [Command::OpenExpert]);
    window.state_mut().status.expert = None;
    settle(&mut window);
    assert!(window.query_by_label("Watch an expert").is_none());
    assert_eq!(click(&mut window, "Compare"), [Command::OpenDialog]);
}

#[test]
fn in_a_browser_no_folder_is_saved_and_the_curves_are_an_svg() {
    let mut window = window(ScreenFixture::default());
    window.state_mut().status.has_disk = false;
    settle(&mut window);
    assert!(window.query_by_label("Save run").is_none());
    assert_eq!(click(&mut window, "Save world"), [Command::SaveDialog(SaveKind::Scenario)]);
    assert_eq!(click(&mut window, "SVG…"), [Command::SaveDialog(SaveKind::Png)]);
}
