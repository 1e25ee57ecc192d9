//! The policies of the app: the best one so far can be saved, tested, compared and transferred as well as the current one, and
//! every driver has a label with its origin.
#![cfg(feature = "gui")]

#[path = "support/headless_app.rs"]
mod headless_app;

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::math::vec2;

use wayfield::agent::ActiveLearner;
use wayfield::app::commands::{Command, Pace, PolicySource, SaveKind, SessionMode};
use wayfield::app::moves::{Movable, MoveRequest};
use wayfield::app::scene::DriverLabel;
use wayfield::app::session::StartOptions;
use wayfield::app::session::journal::{ReplayResult, verify};
use wayfield::policy::Policy;
use wayfield::run::shipped::{self, ShippedPolicy};
use wayfield::scenario::{Motion, Scenario};
use wayfield::task::CommandedMotions;

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

/// The app after its first evaluation, paused.
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
    // The run is saved first: saving it waits for any evaluation in progress, which may change the best policy.
    app.command(Command::Save(SaveKind::Run, run.clone()));
    app.command(Command::Save(SaveKind::BestPolicy, best.clone()));
    app.command(Command::Save(SaveKind::Policy, current.clone()));
    frame(&mut app);
    let read = |path: &Path| std::fs::read(path).expect("the file was saved");
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

    // As if a driver with its own motions, such as the user, were driving when the run is replaced.
    app.world().resource_mut::<CommandedMotions>().0 = vec![Some(Motion { v_m_s: 0.1, w_rad_s: 0.0 })];
    app.command(Command::Transfer {
        policy: PolicySource::Best,
        scenario: "doorway".into(),
        preset: "fast".into(),
        seed: 12,
        epsilon: 0.5,
    });
    // Before the first step.
    app.command(Command::Pause(true));
    frame(&mut app);
    assert_eq!(app.steps(), 0);
    assert!(app.world().resource::<CommandedMotions>().0.is_empty(), "the learner drives");
    let policy = Policy::from_bytes(&read(&best)).expect("a policy");
    let learner = &app.world().resource::<ActiveLearner>().0;
    assert!(learner.network().parameters() == policy.parameters(), "the weights of the best policy");
    let from =
        format!("Empty, {} steps, seed 3", wayfield::report::format::number(shown.env_steps as f64, 0));
    assert_eq!(app.shown().1.transfer_from, Some(from));
    assert_eq!((app.run().config.seed, app.shown().1.tested), (12, PolicySource::Current));
}

#[test]
fn the_map_of_values_is_that_of_the_tested_policy_while_time_is_paused() {
    let mut app = evaluated();
    app.view_state().overlays.value = true;
    app.command(Command::SetMode(SessionMode::Test));
    let mut values_of = |source| {
        app.command(Command::SetTested(source));
        // Longer than the interval between two maps.
        for _ in 0..2 {
            app.frame(Duration::from_millis(300));
        }
        let values = &app.shown().0.value.as_ref().expect("a map of values").values;
        values.iter().map(|value| value.to_bits()).collect::<Vec<_>>()
    };
    let current = values_of(PolicySource::Current);
    assert!(values_of(PolicySource::Best) != current, "another policy");
    assert!(values_of(PolicySource::Current) == current, "the first one again");
}

#[test]
fn a_training_run_from_a_policy_runs_even_if_time_was_paused() {
    let start = StartOptions { scenario: "empty".into(), paused: true, ..StartOptions::default() };
    let mut app = HeadlessApp::new(start);
    frame(&mut app);
    assert!(app.shown().1.paused);
    app.command(Command::Transfer {
        policy: PolicySource::Current,
        scenario: "doorway".into(),
        preset: "fast".into(),
        seed: 12,
        epsilon: 0.5,
    });
    frame(&mut app);
    assert_eq!((app.run().config.seed, app.shown().1.paused), (12, false));
    for _ in 0..100 {
        frame(&mut app);
    }
    assert!(app.steps() > 0, "it trains");
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

/// The shipped policy that drives every robot, if there is one.
fn general() -> Option<&'static ShippedPolicy> {
    shipped::policies().iter().find(|policy| policy.is_general())
}

#[test]
fn the_label_of_an_expert_names_where_it_was_trained() {
    let in_maze = format!("Trained in {}, new here", general().map_or("Scenario I", |it| &it.trained_in));
    for (scenario, origin, is_new_here) in
        [("scenario-2", "Trained in Scenario II", false), ("maze", in_maze.as_str(), true)]
    {
        let start = StartOptions { scenario: scenario.into(), paused: true, ..StartOptions::default() };
        let mut app = HeadlessApp::new(start);
        frame(&mut app);
        assert_eq!(app.shown().1.expert.as_ref().map(|expert| expert.is_new_here), Some(is_new_here));
        app.command(Command::OpenExpert);
        frame(&mut app);
        assert_eq!(driver(&app, 1).1, origin);
        let notices = app.notices();
        let says_so = notices.iter().any(|notice| notice.text.contains("It was not trained in Maze"));
        assert_eq!(says_so, is_new_here, "{notices:?}");
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
    assert!(classical.q_values.is_empty(), "it has no network");
    let plan = classical.plan.as_ref().expect("the driver plans");
    let [first, .., last] = &plan.path_m[..] else { panic!("a path: {plan:?}") };
    let goal = &classical.goal;
    assert!((last.x - goal.x_m).hypot(last.y - goal.y_m) < 2.0 * plan.cell_m, "to {last}");
    assert!((first.x - classical.pose.x_m).hypot(first.y - classical.pose.y_m) < 1.0, "from {first}");
    assert!(!plan.occupied_m.is_empty());
    let (min, max) = classical.scenario.enclosure.bounds_m();
    for at in &plan.occupied_m {
        let to_wall = (*at - min).min(max - *at).min_element().abs();
        assert!(to_wall < plan.cell_m, "{at} is {to_wall} m from the walls of an empty arena");
    }
    app.command(Command::OpenDriver("orca"));
    frame(&mut app);
    assert_eq!(driver(&app, 1), ("ORCA".into(), "Class C: knows everything".into()));
    app.command(Command::OpenExpert);
    frame(&mut app);
    assert_ne!(driver(&app, 1).0, "ORCA", "a policy takes the place of the driver");
}

/// Asserts that each motion of `arena`'s driver is shown with a Q-value, and returns the motions.
fn motions_with_q_values(app: &HeadlessApp, arena: usize) -> Vec<Motion> {
    let arena = &app.shown().0.arenas[arena];
    assert_eq!(arena.q_values.len(), arena.motions.len(), "{:?}", arena.q_values);
    assert!(arena.action < arena.motions.len());
    arena.motions.clone()
}

/// Takes `count` control steps.
fn step(app: &mut HeadlessApp, count: usize) {
    for _ in 0..count {
        app.command(Command::Step);
        frame(app);
    }
}

#[test]
fn the_users_robot_keeps_its_motion_when_its_demo_starts_again() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let mut app = HeadlessApp::new(StartOptions { paused: true, ..StartOptions::default() });
    frame(&mut app);
    app.step_to(40);
    app.command(Command::SetMode(SessionMode::Drive));
    step(&mut app, 2);
    assert_eq!(app.shown().0.arenas[0].action, 2, "straight ahead");
    app.command(Command::Steer(0));
    step(&mut app, 1);
    for restart in
        [Command::SetTested(PolicySource::Current), Command::Save(SaveKind::Run, folder.path().join("run"))]
    {
        app.command(restart);
        step(&mut app, 2);
        assert_eq!(app.shown().1.mode, SessionMode::Drive);
        assert_eq!(app.shown().0.arenas[0].action, 0, "the motion is kept without being sent again");
    }
}

#[test]
fn a_policy_with_a_map_drives_next_to_the_current_one_and_its_map_is_shown() {
    let start = StartOptions { scenario: "u-trap".into(), paused: true, ..StartOptions::default() };
    let mut app = HeadlessApp::new(start);
    frame(&mut app);
    let class = "Class B: builds a map";
    let expert = general().map_or("Scenario I expert with a map", |_| "General policy with a map");
    for (command, name) in
        [(Command::OpenWithMap, "Current policy with a map"), (Command::OpenExpertWithMap, expert)]
    {
        app.command(command);
        step(&mut app, 3);
        assert_eq!(app.shown().1.mode, SessionMode::Compare);
        assert_eq!(driver(&app, 1), (name.into(), class.into()));
        let plan = app.shown().0.arenas[1].plan.as_ref().expect("it builds a map");
        assert!(!plan.occupied_m.is_empty(), "walls are in sight: {plan:?}");
        motions_with_q_values(&app, 1);
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
    // It turns in place to the left, whatever the network chooses: its two motions are equal.
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
    let [ours, other] = [0, 1].map(|arena| motions_with_q_values(&app, arena));
    assert_eq!(ours.len(), 5, "the current policy has the motions of the robot");
    assert_eq!(other.len(), 2);
    assert!(other.iter().all(|motion| motion.v_m_s == 0.0 && motion.w_rad_s > 0.0), "{other:?}");
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

#[test]
fn a_shipped_policy_is_opened_by_its_name_with_and_without_a_map() {
    let mut app = HeadlessApp::new(StartOptions { paused: true, ..StartOptions::default() });
    frame(&mut app);
    for (name, class) in
        [("general", "Trained in General, new here"), ("general+map", "Class B: builds a map")]
    {
        app.command(Command::Open(name.into()));
        frame(&mut app);
        assert_eq!(app.error_notices(), Vec::<String>::new());
        assert_eq!(driver(&app, 1), (name.into(), class.into()));
    }
}

/// Writes a preset with observations by sectors and relative actions. Returns its path.
fn write_general_preset(folder: &Path) -> String {
    let path = folder.join("general.ron");
    let text = "(based_on: \"fast\", arenas: 4, observation: Sectors(count: 12, earlier_steps: 2), \
                actions: Relative([(speed: 1, turn: 1), (speed: 1, turn: 0), (speed: 1, turn: -1), (speed: 0.5, turn: 0), \
                (speed: 0, turn: 1), (speed: 0, turn: -1), (speed: 0, turn: 0)]))";
    std::fs::write(&path, text).expect("a writable folder");
    path.display().to_string()
}

/// Writes a set of two scenarios with different robots and LIDARs. Returns its path.
fn write_set_of_robots(folder: &Path) -> String {
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).expect("a writable folder");
    write("own.ron", "(name: \"Own\", task: (max_episode_steps: 40))");
    write(
        "fast.ron",
        "(name: \"Quick\", lidar: (beams: 40, field_of_view_rad: 4.0), robot: (motions: [(v_m_s: 0.5, w_rad_s: 1.0), \
         (v_m_s: 0.5, w_rad_s: -1.0)]), task: (max_episode_steps: 40))",
    );
    write("robots.ron", "(name: \"Robots\", scenarios: [(scenario: \"own.ron\"), (scenario: \"fast.ron\")])");
    folder.join("robots.ron").display().to_string()
}

#[test]
fn one_policy_is_trained_and_shown_with_different_robots() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let (preset, scenario) = (write_general_preset(folder.path()), write_set_of_robots(folder.path()));
    let mut app =
        HeadlessApp::new(StartOptions { scenario, preset, paused: true, ..StartOptions::default() });
    frame(&mut app);
    let mut seen = [false; 2];
    for _ in 0..100 {
        step(&mut app, 1);
        for arena in &app.shown().0.arenas {
            let is_quick = arena.written.name == "Quick";
            let fastest = if is_quick { 0.5 } else { 0.15 };
            assert_eq!((arena.motions.len(), arena.q_values.len()), (7, 7), "a value for each motion");
            assert_eq!(arena.motions[1], Motion { v_m_s: fastest, w_rad_s: 0.0 }, "of this arena's robot");
            seen[usize::from(is_quick)] = true;
        }
    }
    assert_eq!(seen, [true; 2]);
    // In drive mode, the keys choose among the robot's own motions, which have no Q-values here.
    for (mode, with_values) in [(SessionMode::Test, [true].as_slice()), (SessionMode::Drive, &[false, true])]
    {
        app.command(Command::SetMode(mode));
        step(&mut app, 60);
        let arenas = &app.shown().0.arenas;
        assert_eq!(arenas.iter().map(|arena| !arena.q_values.is_empty()).collect::<Vec<_>>(), with_values);
    }
    app.command(Command::OpenWithMap);
    step(&mut app, 3);
    assert!(app.shown().0.arenas[1].plan.is_some(), "the map is shown");
}

#[test]
fn a_policy_of_another_robot_drives_anywhere_and_to_a_goal_that_is_clicked() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let preset = write_general_preset(folder.path());
    let saved = folder.path().join("general.safetensors");
    let mut app = HeadlessApp::new(StartOptions { preset, paused: true, ..StartOptions::default() });
    frame(&mut app);
    app.command(Command::Save(SaveKind::Policy, saved.clone()));
    frame(&mut app);

    let quick = write_set_of_robots(folder.path()).replace("robots.ron", "fast.ron");
    let map = folder.path().join("map.yaml");
    let text = "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    std::fs::write(&map, text).expect("a writable folder");
    let cell = |k: usize| {
        let (x, y) = (k % 40, k / 40);
        let is_wall = x == 0 || y == 0 || x == 39 || y == 29 || x == 20 && y > 12;
        if is_wall { 0 } else { 254 }
    };
    let image: Vec<u8> = b"P5 40 30 255\n".iter().copied().chain((0..1200).map(cell)).collect();
    std::fs::write(folder.path().join("map.pgm"), image).expect("a writable folder");
    for scenario in ["maze".into(), quick, "clutter".into(), map.display().to_string()] {
        let mut app = HeadlessApp::new(StartOptions { scenario, paused: true, ..StartOptions::default() });
        frame(&mut app);
        app.command(Command::Open(saved.clone()));
        step(&mut app, 5);
        assert_eq!(app.shown().1.mode, SessionMode::Compare);
        assert_eq!(driver(&app, 1).0, "general.safetensors");
        let before = app.shown().0.arenas[0].goal;
        let robot = app.shown().0.arenas[1].pose;
        let to_m = vec2(robot.x_m, robot.y_m);
        app.command(Command::SetGoal(MoveRequest { arena: 1, object: Movable::Goal, to_m }));
        frame(&mut app);
        for arena in &app.shown().0.arenas {
            assert_ne!(arena.goal, before);
            assert_eq!(vec2(arena.goal.x_m, arena.goal.y_m), to_m, "both robots have the same goal");
        }
        step(&mut app, 1);
        assert!(app.shown().0.arenas[1].inactive, "the second has reached it, and waits for the first");
        let outside = MoveRequest { arena: 1, object: Movable::Goal, to_m: vec2(1e3, 0.0) };
        app.command(Command::SetGoal(outside));
        frame(&mut app);
        assert_eq!(app.shown().0.arenas[1].goal.x_m, to_m.x, "no goal outside the walls");
        let back = MoveRequest { arena: 0, object: Movable::Goal, to_m: vec2(before.x_m, before.y_m) };
        app.command(Command::SetGoal(back));
        frame(&mut app);
        assert!(!app.shown().0.arenas[1].inactive, "a new goal sends it on");
        assert_eq!(app.shown().0.arenas[1].goal, before);
        assert!(app.journal().entries.is_empty(), "a demo changes nothing in the training");
    }
}

#[test]
fn training_with_sector_observations_continues_with_another_lidar_and_other_motions() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let run = folder.path().join("run");
    let preset = write_general_preset(folder.path());
    let mut app = HeadlessApp::new(StartOptions { preset, paused: true, ..StartOptions::default() });
    frame(&mut app);
    app.step_to(20);
    let mut edited = Scenario::clone(&app.shown().0.scenario);
    edited.lidar.beams = 36;
    edited.robot.motions.truncate(3);
    let apply = |restart| Command::ApplyScenario {
        scenario: Arc::new(edited.clone()),
        from: "scenario-1".into(),
        restart,
    };
    app.command(apply(false));
    frame(&mut app);
    app.step_to(60);
    assert_eq!(app.shown().0.arenas[0].ranges_m.len(), 36);
    app.command(Command::Save(SaveKind::Run, run.clone()));
    frame(&mut app);
    assert_eq!(verify(&run), Ok(ReplayResult { steps: 60, interventions: 1, bit_identical: true }));
}
