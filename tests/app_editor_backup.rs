//! Backups of the editor: unsaved changes survive the end of the app and are offered at the next start. Their backup is deleted
//! once they are saved or discarded.
#![cfg(feature = "gui")]

#[path = "support/headless_app.rs"]
mod headless_app;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use tempfile::TempDir;
use wayfield::app::commands::Command;
use wayfield::app::editor::Editor;
use wayfield::app::session::{AutosaveOptions, StartOptions};
use wayfield::app::view_state::EditorSource;

use headless_app::HeadlessApp;

const FRAME: Duration = Duration::from_millis(1);

fn temporary() -> TempDir {
    tempfile::tempdir().expect("temporary folder")
}

/// A paused app in `scenario` that writes a backup to `folder` in every frame, if anything has changed.
fn app(folder: &Path, scenario: &str) -> HeadlessApp {
    let autosave = Some(AutosaveOptions { folder: folder.into(), every: Duration::ZERO });
    let scenario = scenario.into();
    let mut app =
        HeadlessApp::new(StartOptions { paused: true, scenario, autosave, ..StartOptions::default() });
    app.frame(FRAME);
    app
}

/// Opens the editor and gives the scenario another name.
fn rename(app: &mut HeadlessApp, name: &str) {
    if app.view_state().editor.is_none() {
        app.view_state().open_editor = Some(EditorSource::RunningScenario);
        app.frame(FRAME);
    }
    editor(app).edit("name", |scenario| scenario.name = name.into());
    app.frame(FRAME);
}

fn editor(app: &mut HeadlessApp) -> &mut Editor {
    app.view_state().editor.as_deref_mut().expect("the editor is open")
}

/// The name of the scenario whose unsaved changes are offered.
fn offer(app: &HeadlessApp) -> Option<String> {
    app.shown().1.unsaved_edits.as_ref().map(|edits| edits.scenario.clone())
}

fn backups(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder.join("editor")).into_iter().flatten().flatten();
    let is_backup = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "ron");
    let mut found: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(is_backup).collect();
    found.sort();
    found
}

#[test]
fn unsaved_changes_of_a_killed_app_are_offered_and_restored_as_they_were() {
    let folder = temporary();
    let mut killed = app(folder.path(), "scenario-1");
    rename(&mut killed, "Mine");
    rename(&mut killed, "Mine, too");
    let edited = editor(&mut killed).scenario().clone();
    drop(killed);
    let mut next = app(folder.path(), "empty");
    assert_eq!(offer(&next).as_deref(), Some("Mine, too"));
    let before = backups(folder.path());
    next.command(Command::RestoreEdits);
    next.frame(FRAME);
    assert_eq!(backups(folder.path()), before, "it is not deleted before the editor opens");
    next.frame(FRAME);
    assert_eq!(offer(&next), None, "the offer is gone");
    let restored = editor(&mut next);
    assert_eq!((restored.scenario(), restored.from()), (&edited, "scenario-1"));
    assert!(restored.is_modified(), "it is still unsaved");
    rename(&mut next, "Mine again");
    assert_eq!(backups(folder.path()).len(), 1, "the next backup replaces it");
    drop(next);
    assert_eq!(offer(&app(folder.path(), "empty")).as_deref(), Some("Mine again"));
}

#[test]
fn restored_changes_are_backed_up_even_if_another_app_has_deleted_their_backup() {
    let folder = temporary();
    let mut killed = app(folder.path(), "scenario-1");
    rename(&mut killed, "Mine");
    drop(killed);
    let mut next = app(folder.path(), "empty");
    fs::remove_file(&backups(folder.path())[0]).expect("the file can be removed");
    next.command(Command::RestoreEdits);
    for _ in 0..3 {
        next.frame(FRAME);
    }
    assert_eq!(editor(&mut next).scenario().name, "Mine");
    assert_eq!(backups(folder.path()).len(), 1);
}

#[test]
fn a_backup_is_deleted_once_the_changes_are_saved_or_discarded() {
    let folder = temporary();
    let file = folder.path().join("mine.ron");
    fs::write(&file, "(name: \"Mine\")").expect("the file can be written");
    let mut app = app(folder.path(), file.to_str().expect("UTF-8"));
    rename(&mut app, "Saved");
    assert_eq!(backups(folder.path()).len(), 1);
    let (scenario, based_on) = (editor(&mut app).scenario().clone(), editor(&mut app).from().to_owned());
    app.command(Command::SaveScenario { scenario, based_on, path: Some(file.clone()) });
    app.frame(FRAME);
    app.frame(FRAME);
    assert_eq!(backups(folder.path()), Vec::<PathBuf>::new(), "{:?}", app.notices());
    rename(&mut app, "Discarded");
    assert_eq!(backups(folder.path()).len(), 1);
    app.view_state().editor = None;
    app.frame(FRAME);
    assert_eq!(backups(folder.path()), Vec::<PathBuf>::new());
}

#[test]
fn a_window_does_not_offer_what_another_one_edits_and_a_dismissed_backup_stays() {
    let folder = temporary();
    let (mut first, mut second) = (app(folder.path(), "empty"), app(folder.path(), "empty"));
    rename(&mut first, "First");
    rename(&mut second, "Second");
    assert_eq!(backups(folder.path()).len(), 2);
    assert_eq!(offer(&app(folder.path(), "empty")), None, "both are being edited");
    drop(first);
    let mut third = app(folder.path(), "empty");
    assert_eq!(offer(&third).as_deref(), Some("First"));
    third.command(Command::DismissEdits);
    third.frame(FRAME);
    assert_eq!((offer(&third), backups(folder.path()).len()), (None, 2));
    drop((second, third));
    for name in ["a", "b", "c"] {
        rename(&mut app(folder.path(), "empty"), name);
    }
    drop(app(folder.path(), "empty"));
    let kept: String =
        backups(folder.path()).iter().map(|path| fs::read_to_string(path).expect("a backup")).collect();
    assert_eq!(backups(folder.path()).len(), 3);
    for name in ["a", "b", "c"] {
        assert!(kept.contains(&format!("name: \"{name}\"")), "the newest three are kept: {kept}");
    }
}

#[test]
fn restored_changes_do_not_overwrite_a_file_that_has_changed_since() {
    let folder = temporary();
    let file = folder.path().join("mine.ron");
    fs::write(&file, "(name: \"Mine\")").expect("the file can be written");
    let mut killed = app(folder.path(), file.to_str().expect("UTF-8"));
    rename(&mut killed, "Mine, edited");
    drop(killed);
    fs::write(&file, "(name: \"Somebody else's\")").expect("the file can be written");
    let mut next = app(folder.path(), "empty");
    next.command(Command::RestoreEdits);
    next.frame(FRAME);
    next.frame(FRAME);
    let (scenario, based_on) = (editor(&mut next).scenario().clone(), editor(&mut next).from().to_owned());
    next.command(Command::SaveScenario { scenario, based_on, path: Some(file.clone()) });
    next.frame(FRAME);
    assert!(
        next.error_notices()[0].contains("another program has changed this file"),
        "{:?}",
        next.notices()
    );
    assert!(fs::read_to_string(&file).expect("the file is there").contains("Somebody else's"));
}

#[test]
fn a_damaged_backup_is_not_offered_and_a_folder_that_cannot_be_written_is_reported_once() {
    let folder = temporary();
    rename(&mut app(folder.path(), "empty"), "Mine");
    fs::write(&backups(folder.path())[0], "(from: 7").expect("the file can be written");
    assert_eq!(offer(&app(folder.path(), "empty")), None);
    let blocked = temporary();
    fs::write(blocked.path().join("editor"), "a file in its place").expect("the file can be written");
    let mut app = app(blocked.path(), "empty");
    let reports = |app: &HeadlessApp| {
        let mut notices = app.notices();
        notices.retain(|notice| notice.text.contains("cannot be backed up"));
        notices
    };
    rename(&mut app, "one");
    assert_eq!(reports(&app).len(), 1, "{:?}", app.notices());
    // Equal notices replace each other, so the first one is dismissed before the next attempts.
    let dismissed = reports(&app).remove(0);
    app.command(Command::DismissNotice(dismissed));
    for name in ["two", "three"] {
        rename(&mut app, name);
    }
    assert!(reports(&app).is_empty(), "it is not reported again");
}
