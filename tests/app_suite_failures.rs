//! A failed episode in an evaluation's report can be repeated exactly in the app, even with moving obstacles and noise.
#![cfg(feature = "gui")]

mod cli_support;
#[path = "support/headless_app.rs"]
mod headless_app;

use std::collections::BTreeMap;
use std::time::Duration;

use cli_support::{SCENARIO_2, Workspace, noisy};
use headless_app::HeadlessApp;
use wayfield::app::commands::{Command, SessionMode};
use wayfield::app::session::StartOptions;
use wayfield::task::{Arena, Clock, Episode, StepOutcomes};

/// The app's start options in `command`, whose paths are relative to the workspace.
fn start(workspace: &Workspace, command: &str) -> StartOptions {
    let words: Vec<&str> = command.split_whitespace().collect();
    let value = |flag: &str| {
        let at = words.iter().position(|word| *word == flag).unwrap_or_else(|| panic!("{flag} in {command}"));
        words[at + 1]
    };
    assert_eq!((words[0], words.len()), ("wayfield", 9), "{command}");
    StartOptions {
        scenario: workspace.path(value("--scenario")).display().to_string(),
        seed: value("--seed").parse().expect("a seed"),
        episode: value("--episode").parse::<u64>().expect("a number") - 1,
        open: Some(workspace.path(value("--open"))),
        paused: true,
        ..StartOptions::default()
    }
}

/// The clock and the episode of the second arena, in which the opened driver drives.
fn second(app: &mut HeadlessApp) -> (u64, Episode) {
    let world = app.world();
    let mut arenas = world.query::<(&Arena, &Clock, &Episode)>();
    let found = arenas.iter(world).find(|(arena, ..)| arena.0 == 1);
    found.map(|(_, clock, episode)| (clock.0, episode.clone())).expect("two arenas")
}

/// Drives the episode to its end. Returns its number of steps, how it ended, and the clock at its start.
fn replayed(start: StartOptions) -> (u32, &'static str, u64) {
    let mut app = HeadlessApp::new(start);
    app.frame(Duration::from_millis(1));
    app.frame(Duration::from_millis(1));
    assert_eq!((app.shown().1.mode, app.error_notices()), (SessionMode::Compare, Vec::new()));
    let clock = second(&mut app).0;
    for _ in 0..10_000 {
        app.command(Command::Step);
        app.frame(Duration::from_millis(1));
        let (_, episode) = second(&mut app);
        if episode.inactive {
            let outcome = &app.world().resource::<StepOutcomes>().0[1];
            let end = match (outcome.reached, outcome.collided) {
                (true, _) => "success",
                (_, true) => "collision",
                _ => "timeout",
            };
            return (episode.steps, end, clock);
        }
    }
    panic!("the episode does not end: {:?}", app.notices());
}

#[test]
fn the_command_of_a_failure_repeats_it_exactly_in_the_app() {
    let workspace = Workspace::new();
    workspace.write("moving.ron", noisy(SCENARIO_2).replace("speed_rad_s: 0.15", "speed_rad_s: 0.4"));
    workspace.run_ok(
        "--eval field --scenario moving.ron --episodes 30 --seed 5 --report report --csv episodes.csv",
    );
    let page = workspace.text("report/README.md");
    let rows = csv::Reader::from_path(workspace.path("episodes.csv")).expect("rows").into_deserialize();
    let rows: Vec<BTreeMap<String, String>> = rows.map(|row| row.expect("a row")).collect();
    let failed: Vec<_> = rows.into_iter().filter(|row| row["outcome"] != "success").collect();
    assert!(failed.len() > 2, "{} failed", failed.len());
    // The links to the image files follow the command, in parentheses.
    let command = |line| str::split_once(line, "To repeat it: ")?.1.split(" (").next();
    let commands: Vec<&str> = page.lines().filter_map(command).collect();
    assert_eq!(commands.len(), failed.len(), "{page}");
    for (row, command) in failed.iter().zip(commands).take(4) {
        assert!(command.contains(&format!("--episode {} ", row["episode"])), "{command}");
        let (steps, end, clock) = replayed(start(&workspace, command));
        assert_eq!((steps.to_string(), end), (row["steps"].clone(), row["outcome"].as_str()), "{command}");
        assert_eq!(clock.to_string(), row["clock_steps"], "the obstacles start where they did: {command}");
    }
}
