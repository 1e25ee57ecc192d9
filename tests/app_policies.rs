//! The policies of the app: the best one so far can be saved, tested, compared and transferred as well as the current one, and
//! every driver says where it comes from.
#![cfg(feature = "gui")]

#[path = "support/headless_app.rs"]
mod headless_app;

use std::time::{Duration, Instant};

use wayfield::agent::ActiveLearner;
use wayfield::app::commands::{Command, Pace, PolicySource, SaveKind, SessionMode};
use wayfield::app::scene::DriverLabel;
use wayfield::app::session::StartOptions;
use wayfield::policy::Policy;

use headless_app::HeadlessApp;

fn frame(app: &mut HeadlessApp) {
    app.frame(Duration::from_millis(10));
    assert_eq!(app.error_notices(), Vec::<String>::new());
}

/// Name and origin of the driver of `arena`.
fn driver(app: &HeadlessApp, arena: usize) -> (String, String) {
    match &app.shown().0.arenas[arena].driver {
        DriverLabel::Policy { name, origin } => (name.clone(), origin.clone()),
        other => panic!("no policy drives in arena {arena}: {other:?}"),
    }
}

/// The app after its first evaluations, paused.
fn evaluated() -> HeadlessApp {
    let start =
        StartOptions { scenario: "empty".into(), seed: 3, pace: Pace::Full, ..StartOptions::default() };
    let mut app = HeadlessApp::new(start);
    let began = Instant::now();
    app.frame(Duration::from_millis(20));
    while app.shown().1.best.is_none() {
        assert!(began.elapsed() < Duration::from_secs(120), "no evaluation: {:?}", app.notices());
        app.frame(Duration::from_millis(20));
    }
    app.command(Command::Pause(true));
    frame(&mut app);
    app
}

#[test]
fn the_best_policy_can_be_saved_tested_compared_and_transferred() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut app = evaluated();
    let [best, current, run] =
        ["best.safetensors", "current.safetensors", "run"].map(|name| folder.path().join(name));
    // The run comes first: it waits for an evaluation that is still running.
    app.command(Command::Save(SaveKind::Run, run.clone()));
    app.command(Command::Save(SaveKind::BestPolicy, best.clone()));
    app.command(Command::Save(SaveKind::Policy, current.clone()));
    frame(&mut app);
    let read = |path: &std::path::Path| std::fs::read(path).expect("the file was saved");
    assert!(read(&best) == read(&run.join("policy.safetensors")), "as a run keeps it");
    assert!(read(&current) == read(&run.join("policy-last.safetensors")));
    assert!(read(&current) != read(&best));

    let shown = app.shown().1.best.expect("there is a best policy");
    app.command(Command::SetTested(PolicySource::Best));
    app.command(Command::SetMode(SessionMode::Test));
    frame(&mut app);
    let (name, origin) = driver(&app, 0);
    assert_eq!(name, "Best so far");
    assert!(origin.contains("% after ") && shown.env_steps < app.shown().1.env_steps, "{origin}");
    app.command(Command::SetTested(PolicySource::Current));
    frame(&mut app);
    assert_eq!(driver(&app, 0).0, "Current policy", "the demo starts again with the other policy");
    app.command(Command::OpenBest);
    frame(&mut app);
    assert_eq!(app.shown().1.mode, SessionMode::Compare);
    assert_eq!([driver(&app, 0).0, driver(&app, 1).0], ["Current policy", "Best so far"]);

    app.command(Command::Transfer {
        policy: PolicySource::Best,
        scenario: "doorway".into(),
        preset: "fast".into(),
        seed: 12,
        epsilon: 0.5,
    });
    frame(&mut app);
    let policy = Policy::from_bytes(&read(&best)).expect("a policy");
    let learner = &app.world().resource::<ActiveLearner>().0;
    assert!(learner.network().parameters() == policy.parameters(), "the weights of the best policy");
    let from =
        format!("Empty, {} steps, seed 3", wayfield::report::format::number(shown.env_steps as f64, 0));
    assert_eq!(app.shown().1.transfer_from, Some(from));
    assert_eq!((app.run().config.seed, app.shown().1.tested), (12, PolicySource::Current));
}

#[test]
fn without_an_evaluation_there_is_no_best_policy() {
    let mut app = HeadlessApp::new(StartOptions { paused: true, ..StartOptions::default() });
    app.frame(Duration::from_millis(10));
    assert_eq!(app.shown().1.best, None);
    app.command(Command::OpenBest);
    app.frame(Duration::from_millis(10));
    assert!(app.error_notices()[0].contains("No policy has been evaluated yet"), "{:?}", app.notices());
    app.command(Command::SetTested(PolicySource::Best));
    app.command(Command::SetMode(SessionMode::Test));
    app.frame(Duration::from_millis(10));
    assert_eq!(driver(&app, 0), ("Current policy".into(), "after 0 env steps".into()));
}

#[test]
fn an_expert_says_where_it_was_trained() {
    for (scenario, origin, is_new_here) in
        [("scenario-2", "Trained in Scenario II", false), ("maze", "Trained in Scenario I, new here", true)]
    {
        let start = StartOptions { scenario: scenario.into(), paused: true, ..StartOptions::default() };
        let mut app = HeadlessApp::new(start);
        frame(&mut app);
        assert_eq!(app.shown().1.expert.as_ref().map(|expert| expert.is_new_here), Some(is_new_here));
        app.command(Command::OpenExpert);
        frame(&mut app);
        assert_eq!(driver(&app, 1).1, origin);
        let notice = &app.notices()[0].text;
        assert_eq!(notice.contains("It was not trained in Maze"), is_new_here, "{notice}");
    }
}

#[test]
fn a_classical_driver_drives_next_to_the_policy_with_its_class_and_the_map_that_it_builds() {
    let start = StartOptions { scenario: "empty".into(), paused: true, ..StartOptions::default() };
    let mut app = HeadlessApp::new(start);
    frame(&mut app);
    app.command(Command::OpenDriver("grid-dwa"));
    for _ in 0..8 {
        app.command(Command::Step);
        frame(&mut app);
    }
    assert_eq!(app.shown().1.mode, SessionMode::Compare);
    let (name, class) = ("A* and DWA on its own map", "Class B: builds a map");
    assert_eq!(driver(&app, 1), (name.into(), class.into()));
    let [policy, classical] = &app.shown().0.arenas[..] else { panic!("two arenas") };
    assert_eq!(policy.goal, classical.goal);
    assert_eq!(policy.plan, None);
    let plan = classical.plan.as_ref().expect("the driver plans");
    let [first, .., last] = &plan.path_m[..] else { panic!("a path: {plan:?}") };
    let goal = &classical.goal;
    assert!((last.x - goal.x_m).hypot(last.y - goal.y_m) < 2.0 * plan.cell_m, "to {last}");
    assert!((first.x - classical.pose.x_m).hypot(first.y - classical.pose.y_m) < 1.0, "from {first}");
    assert!(!plan.occupied_m.is_empty());
    let (min, max) = classical.scenario.enclosure.bounds_m();
    for at in &plan.occupied_m {
        let to_wall = (*at - min).min(max - *at).min_element().abs();
        assert!(to_wall < plan.cell_m, "{at} is {to_wall} m from the walls of an empty room");
    }
    app.command(Command::OpenDriver("orca"));
    frame(&mut app);
    assert_eq!(driver(&app, 1), ("ORCA".into(), "Class C: knows everything".into()));
    app.command(Command::OpenExpert);
    frame(&mut app);
    assert!(driver(&app, 1).0.ends_with(" expert"), "a policy takes the place of the driver");
}

/// Takes `count` control steps.
fn step(app: &mut HeadlessApp, count: usize) {
    for _ in 0..count {
        app.command(Command::Step);
        frame(app);
    }
}

#[test]
fn a_policy_drives_next_to_itself_with_a_map_that_is_shown() {
    let start = StartOptions { scenario: "u-trap".into(), paused: true, ..StartOptions::default() };
    let mut app = HeadlessApp::new(start);
    frame(&mut app);
    let class = "Class B: builds a map";
    for (command, name) in [
        (Command::OpenWithMap, "Current policy with a map"),
        (Command::OpenExpertWithMap, "Scenario I expert with a map"),
    ] {
        app.command(command);
        step(&mut app, 3);
        assert_eq!(app.shown().1.mode, SessionMode::Compare);
        assert_eq!(driver(&app, 1), (name.into(), class.into()));
        let plan = app.shown().0.arenas[1].plan.as_ref().expect("it builds a map");
        assert!(!plan.occupied_m.is_empty(), "walls are in sight: {plan:?}");
    }
    let folder = tempfile::tempdir().expect("temporary folder");
    let path = folder.path().join("mine.safetensors");
    app.command(Command::Save(SaveKind::Policy, path));
    frame(&mut app);
    app.command(Command::Open(folder.path().join("mine.safetensors+map")));
    step(&mut app, 1);
    assert_eq!(driver(&app, 1), ("mine.safetensors+map".into(), class.into()));
}

#[test]
fn a_policy_with_other_observations_and_actions_drives_next_to_the_current_one() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let [preset, path] = ["sectors.ron", "sectors.safetensors"].map(|name| folder.path().join(name));
    // It only turns in place to the left, because a network that has learned nothing chooses one of equal motions.
    let left = "(speed: 0, turn: 1)";
    let text =
        format!("(budget: EnvSteps(1000), observation: Sectors(), actions: Relative([{left}, {left}]))");
    std::fs::write(&preset, text).expect("a writable folder");
    let preset = preset.display().to_string();
    let scenario = "empty".to_string();
    let start = StartOptions { scenario: scenario.clone(), preset, paused: true, ..StartOptions::default() };
    let mut app = HeadlessApp::new(start);
    frame(&mut app);
    app.command(Command::Save(SaveKind::Policy, path.clone()));
    frame(&mut app);
    let mut app = HeadlessApp::new(StartOptions { scenario, paused: true, ..StartOptions::default() });
    frame(&mut app);
    app.command(Command::Open(path));
    step(&mut app, 1);
    let before = app.shown().0.arenas[1].pose;
    step(&mut app, 4);
    let after = app.shown().0.arenas[1].pose;
    assert_eq!((before.x_m, before.y_m), (after.x_m, after.y_m), "it turns in place");
    assert_ne!(before.heading_rad, after.heading_rad);
    let ours = app.shown().0.arenas[0].clone();
    assert_eq!(ours.q_values.len(), 5, "the current policy has the motions of the robot");
    app.command(Command::SetMode(SessionMode::Train));
    step(&mut app, 2);
}

#[test]
fn a_classical_drivers_file_is_opened_like_a_policy() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let path = folder.path().join("careful.ron");
    std::fs::write(&path, "Dwa(margin: 11.0)").expect("a writable folder");
    let mut app = HeadlessApp::new(StartOptions { paused: true, ..StartOptions::default() });
    app.frame(Duration::from_millis(10));
    app.command(Command::Open(path.clone()));
    app.frame(Duration::from_millis(10));
    let error = &app.error_notices()[0];
    assert!(error.contains("careful.ron:1:13: ") && error.contains("give 0 to 10"), "{error}");
    assert_eq!(app.shown().1.mode, SessionMode::Train);
    std::fs::write(&path, "Dwa(margin: 0.5)").expect("a writable folder");
    app.command(Command::Open(path));
    app.frame(Duration::from_millis(10));
    assert_eq!(app.shown().1.mode, SessionMode::Compare);
    assert_eq!(driver(&app, 1), ("DWA, careful.ron".into(), "Class A: sees what a policy sees".into()));
    app.command(Command::Open("astar".into()));
    app.frame(Duration::from_millis(10));
    assert_eq!(driver(&app, 1).0, "A* and pure pursuit", "a driver is also opened by its name");
}
