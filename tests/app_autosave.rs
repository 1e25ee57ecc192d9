//! Autosaves: while the app trains, it keeps a copy of the training run. The next session offers the copy, and training
//! resumes from it bit-identically. A failed autosave does not stop the training.
#![cfg(feature = "gui")]

#[path = "support/headless_app.rs"]
mod headless_app;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

use bevy::app::AppExit;
use bevy::ecs::message::Messages;
use bevy::math::vec2;
use bevy::render::error_handler::{ErrorType, RenderError, RenderErrorPolicy};
use tempfile::TempDir;
use wayfield::agent::ActiveLearner;
use wayfield::app::commands::{Command, SaveKind, SessionMode};
use wayfield::app::moves::{Movable, MoveRequest};
use wayfield::app::session::journal::{JOURNAL, ReplayResult, verify};
use wayfield::app::session::{AutosaveOptions, Journal, StartOptions};
use wayfield::app::shutdown::save_after_render_error;
use wayfield::run::preset::Budget;
use wayfield::run::train::{CHECKPOINT_INTERVAL, Job, train};
use wayfield::scenario::read_ron;
use wayfield::simulation::Extensions;

use headless_app::HeadlessApp;

const FRAME: Duration = Duration::from_millis(1);

fn temporary() -> TempDir {
    tempfile::tempdir().expect("temporary folder")
}

/// A paused app that saves its training run in `folder` in every frame, if anything has changed.
fn app(folder: &Path, seed: u64) -> HeadlessApp {
    let autosave = Some(AutosaveOptions { folder: folder.into(), every: Duration::ZERO });
    let mut app = HeadlessApp::new(StartOptions { paused: true, seed, autosave, ..StartOptions::default() });
    app.frame(FRAME);
    app
}

/// The autosaves in `folder`, by name.
fn autosaves(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut found: Vec<PathBuf> = entries.filter(|path| path.join("autosave.ron").exists()).collect();
    // Without those that are being written or deleted.
    found.retain(|path| path.file_name().is_some_and(|name| !name.to_string_lossy().starts_with(".saving-")));
    found.sort();
    found
}

/// Runs frames of the paused app until `done`.
fn wait(app: &mut HeadlessApp, what: &str, mut done: impl FnMut(&mut HeadlessApp) -> bool) {
    let started = Instant::now();
    while !done(app) {
        assert!(started.elapsed().as_secs() < 60, "not within a minute: {what}; {:?}", app.notices());
        app.frame(FRAME);
    }
}

/// Trains until `steps` and waits until that is saved.
fn train_to(app: &mut HeadlessApp, folder: &Path, steps: u64) {
    app.step_to(steps);
    let is_saved = |path: &PathBuf| saved_steps(path) == Some(steps) && is_locked(path);
    wait(app, "the autosave", |_| autosaves(folder).iter().any(is_saved));
}

/// Whether an app holds the lock of the autosave at `path`. On Linux, the kernel's list of locks is read, because trying to take
/// the lock could keep the app from taking it.
fn is_locked(path: &Path) -> bool {
    let lock = path.join("checkpoint/lock");
    #[cfg(target_os = "linux")]
    if let Ok(locks) = fs::read_to_string("/proc/locks") {
        use std::os::unix::fs::MetadataExt;
        return fs::metadata(lock).is_ok_and(|lock| locks.contains(&format!(":{} ", lock.ino())));
    }
    fs::File::options().write(true).open(lock).is_ok_and(|lock| lock.try_lock().is_err())
}

/// Ends `app` as if its process were killed, after its last autosave.
fn kill(app: HeadlessApp, folder: &Path) {
    drop(app);
    autosaves(folder).iter().for_each(|path| wait_until_unlocked(path));
}

/// Waits until the autosave at `path` is unlocked. The task that has written it may still hold the lock after its app has ended.
fn wait_until_unlocked(path: &Path) {
    let started = Instant::now();
    while is_locked(path) {
        assert!(started.elapsed().as_secs() < 60, "{}: still locked after 60 s", path.display());
        std::thread::sleep(FRAME);
    }
}

/// Control steps of the autosave at `path`.
fn saved_steps(path: &Path) -> Option<u64> {
    let metadata = fs::read_to_string(path.join("autosave.ron")).ok()?;
    let env_steps = metadata.split("env_steps:").nth(1)?.split(',').next()?;
    Some(env_steps.trim().parse::<u64>().expect("a number") / 16)
}

fn learner_bytes(app: &mut HeadlessApp) -> Vec<u8> {
    let mut bytes = Vec::new();
    app.world().resource::<ActiveLearner>().0.save(&mut bytes).expect("written to memory");
    bytes
}

fn exits(app: &mut HeadlessApp) -> Vec<AppExit> {
    app.world().resource_mut::<Messages<AppExit>>().drain().collect()
}

#[test]
fn an_autosave_resumes_bit_identically_in_the_next_session_and_is_a_run_folder_for_the_command_line() {
    let folder = temporary();
    let mut first = app(folder.path(), 3);
    train_to(&mut first, folder.path(), 300);
    train_to(&mut first, folder.path(), 700);
    let [saved] = &autosaves(folder.path())[..] else { panic!("one autosave") };
    assert_eq!(saved.file_name().expect("a name"), "scenario-1-fast-3");
    let expected = ReplayResult { steps: 700, interventions: 0, bit_identical: true };
    assert_eq!(verify(saved).expect("a run folder"), expected, "saving has changed nothing");
    // As if the process were killed now.
    let killed = temporary();
    let copy = killed.path().join("scenario-1-fast-3");
    copy_folder(saved, &copy);
    first.step_to(1_000);
    let uninterrupted = learner_bytes(&mut first);
    drop(first);

    let mut next = app(killed.path(), 0);
    let offer = next.shown().1.last_session.clone().expect("the session is offered");
    assert_eq!((offer.scenario.as_str(), offer.preset.as_str(), offer.seed), ("Scenario I", "Fast", 3));
    assert_eq!(offer.env_steps, 16 * 700);
    next.command(Command::ContinueLastSession);
    next.frame(FRAME);
    assert_eq!((next.steps(), next.run().config.seed), (700, 3), "{:?}", next.notices());
    assert_eq!(next.shown().1.last_session, None, "the offer is gone");
    train_to(&mut next, killed.path(), 1_000);
    assert!(learner_bytes(&mut next) == uninterrupted, "training resumes bit-identically");
    assert_eq!(
        autosaves(killed.path()),
        std::slice::from_ref(&copy),
        "the autosave of the session is replaced"
    );
    kill(next, killed.path());

    let budget = Some(Budget::EnvSteps(16 * 1_100));
    let job = Job::Resume { folder: copy.clone(), budget, extensions: Extensions::default() };
    let (_, summary) =
        train(job, CHECKPOINT_INTERVAL, &AtomicBool::new(false), Instant::now(), Some(Box::new(|_| {})))
            .expect("it resumes");
    assert_eq!(summary.env_steps, 16 * 1_100);
    let rows = csv::Reader::from_path(copy.join("episodes.csv")).expect("a table").records().count();
    assert_eq!(rows as u64, summary.episodes, "with the rows of every episode");
}

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a new folder");
    for entry in fs::read_dir(from).expect("a folder").map(|entry| entry.expect("an entry")) {
        let copy = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_folder(&entry.path(), &copy);
        } else {
            fs::copy(entry.path(), copy).expect("a file");
        }
    }
}

#[test]
fn two_windows_save_into_folders_of_their_own_and_do_not_offer_each_others_session() {
    let folder = temporary();
    let (mut first, mut second) = (app(folder.path(), 3), app(folder.path(), 3));
    train_to(&mut first, folder.path(), 20);
    train_to(&mut second, folder.path(), 30);
    let names: Vec<_> =
        autosaves(folder.path()).iter().map(|path| path.file_name().expect("a name").to_owned()).collect();
    assert_eq!(names, ["scenario-1-fast-3", "scenario-1-fast-3-2"]);
    assert_eq!(app(folder.path(), 4).shown().1.last_session, None, "both sessions are running");
    drop(first);
    wait_until_unlocked(&folder.path().join("scenario-1-fast-3"));
    let mut third = app(folder.path(), 4);
    assert_eq!(third.shown().1.last_session.as_ref().map(|offer| offer.env_steps), Some(320));
    third.command(Command::DismissLastSession);
    third.frame(FRAME);
    assert_eq!(third.shown().1.last_session, None);
    assert_eq!(autosaves(folder.path()).len(), 2, "a dismissed session is not deleted");
}

#[test]
fn training_is_also_saved_during_a_demo() {
    let folder = temporary();
    let mut app = app(folder.path(), 5);
    app.step_to(100);
    app.command(Command::SetMode(SessionMode::Test));
    app.frame(FRAME);
    wait(&mut app, "the autosave", |_| {
        autosaves(folder.path()).iter().any(|path| saved_steps(path) == Some(100))
    });
    let saved = &autosaves(folder.path())[0];
    assert!(verify(saved).expect("a run folder").bit_identical);
    assert_eq!(app.shown().1.mode, SessionMode::Test, "the demo goes on");
}

#[test]
fn a_second_move_of_a_robot_is_saved_although_it_replaces_the_first_in_the_journal() {
    let folder = temporary();
    let mut app = app(folder.path(), 6);
    train_to(&mut app, folder.path(), 10);
    let mut before = app.journal().entries.clone();
    for x_m in [0.05, 0.1] {
        let to_m = vec2(x_m, 0.0);
        app.command(Command::Move(MoveRequest { arena: 0, object: Movable::Robot, to_m }));
        app.frame(FRAME);
        let entries = app.journal().entries.clone();
        assert!(entries.len() == 1 && entries != before, "{entries:?}");
        wait(&mut app, "the autosave", |_| {
            let saved = |path: &PathBuf| read_ron::<Journal>(path.join(JOURNAL));
            autosaves(folder.path()).iter().any(|path| saved(path).is_ok_and(|it| it.entries == entries))
        });
        before = entries;
    }
}

#[test]
fn an_autosave_that_fails_is_reported_once_and_training_continues() {
    let folder = temporary();
    let root = folder.path().join("autosave");
    fs::write(&root, "a file in its place").expect("the file can be written");
    let mut app = app(&root, 0);
    app.step_to(10);
    wait(&mut app, "the notice", |app| {
        app.error_notices().iter().any(|text| text.contains("Autosave failed"))
    });
    assert!(!app.error_notices()[0].contains("--out"), "the help fits the app: {:?}", app.error_notices());
    let notice = app.notices().swap_remove(0);
    app.command(Command::DismissNotice(notice));
    app.step_to(60);
    assert_eq!(app.error_notices(), Vec::<String>::new(), "the same failure is not reported again");
    fs::remove_file(&root).expect("the file can be removed");
    train_to(&mut app, &root, 80);
}

#[test]
fn a_damaged_autosave_is_reported_and_the_new_training_run_goes_on() {
    let folder = temporary();
    let mut first = app(folder.path(), 3);
    train_to(&mut first, folder.path(), 50);
    kill(first, folder.path());
    let saved = &autosaves(folder.path())[0];
    fs::write(saved.join("checkpoint/latest.bin"), "damaged").expect("the file can be written");
    let mut next = app(folder.path(), 1);
    next.step_to(5);
    next.command(Command::ContinueLastSession);
    next.frame(FRAME);
    assert!(next.error_notices()[0].contains("latest.bin"), "{:?}", next.error_notices());
    assert_eq!((next.steps(), next.run().config.seed), (5, 1));
    kill(next, folder.path());
    for path in autosaves(folder.path()) {
        fs::write(path.join("autosave.ron"), "(scenario: 7").expect("the file can be written");
    }
    assert_eq!(
        app(folder.path(), 1).shown().1.last_session,
        None,
        "a session with unreadable metadata is not offered"
    );
}

#[test]
fn a_short_training_run_leaves_nothing_behind_and_old_autosaves_are_deleted() {
    let folder = temporary();
    let mut short = app(folder.path(), 9);
    train_to(&mut short, folder.path(), 20);
    short.command(Command::Close);
    short.frame(FRAME);
    assert_eq!(exits(&mut short), [AppExit::Success], "no question for a few seconds of training");
    assert_eq!(autosaves(folder.path()), Vec::<PathBuf>::new());
    drop(short);
    for seed in 1..=5 {
        let mut app = app(folder.path(), seed);
        train_to(&mut app, folder.path(), 10);
        kill(app, folder.path());
    }
    drop(app(folder.path(), 0));
    assert_eq!(autosaves(folder.path()).len(), 3, "three of the five are kept");
}

#[test]
fn closing_asks_before_a_long_training_run_is_lost() {
    let folder = temporary();
    let mut app = app(folder.path(), 0);
    app.step_to(1_260);
    app.command(Command::Close);
    app.frame(FRAME);
    app.frame(FRAME);
    assert!(app.shown().1.quit_question, "20,160 env steps are worth a question");
    assert_eq!(exits(&mut app), []);
    app.command(Command::KeepOpen);
    app.frame(FRAME);
    assert!(!app.shown().1.quit_question);
    app.command(Command::Quit { save: false });
    app.frame(FRAME);
    assert_eq!(exits(&mut app), [AppExit::Success]);
    assert_eq!(autosaves(folder.path()), Vec::<PathBuf>::new(), "not saved, as requested");
}

#[test]
fn opening_a_file_asks_before_long_training_is_lost_and_again_after_a_save() {
    let folder = temporary();
    let (file, no_run) = (folder.path().join("mine.ron"), folder.path().join("no-run"));
    fs::write(&file, "(name: \"Mine\")").expect("a writable folder");
    fs::create_dir(&no_run).expect("a writable folder");
    let mut app = HeadlessApp::new(StartOptions { paused: true, ..StartOptions::default() });
    let open = |app: &mut HeadlessApp, path: &Path| {
        app.command(Command::Open(path.into()));
        app.frame(FRAME);
        let error = app.error_notices().pop().unwrap_or_default();
        (app.run().config.scenario.name.clone(), error)
    };
    app.step_to(1_260);
    let (_, error) = open(&mut app, &no_run);
    assert!(!error.is_empty() && !error.contains("would be lost"), "there is no run to open: {error}");
    let (name, error) = open(&mut app, &file);
    assert!(name == "Scenario I" && error.contains("would be lost"), "{name}: {error}");
    app.command(Command::Save(SaveKind::Run, folder.path().join("run")));
    app.frame(FRAME);
    app.step_to(2_520);
    let (name, _) = open(&mut app, &file);
    assert_eq!(name, "Scenario I", "the training since the save would be lost");
    let (name, _) = open(&mut app, &file);
    assert_eq!(name, "Mine", "the user has opened the file twice");
}

#[test]
fn a_lost_gpu_ends_the_app_with_everything_saved() {
    let folder = temporary();
    let mut app = app(folder.path(), 0);
    app.step_to(40);
    let lost = RenderError { ty: ErrorType::DeviceLost, description: "gone".into(), source: None };
    let policy = save_after_render_error(&lost, app.world(), &mut bevy::prelude::World::new());
    assert!(matches!(policy, RenderErrorPolicy::StopRendering));
    assert_eq!(saved_steps(&autosaves(folder.path())[0]), Some(40));
    assert_eq!(exits(&mut app), [AppExit::error()], "exit status 1");
}
