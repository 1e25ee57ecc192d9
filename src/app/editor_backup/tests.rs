//! Backups that cannot be written or restored.

use std::fs;
use std::sync::Arc;
use std::time::Duration;

use bevy::prelude::World;

use super::store::{self, Store};
use super::{Backup, EditorBackup, back_up, save_now};
use crate::app::CurrentViewState;
use crate::app::editor::Editor;
use crate::app::session::AutosaveOptions;
use crate::app::view_state::ViewState;
use crate::run::shipped;
use crate::scenario::{Scenario, to_ron};

#[test]
fn a_failed_backup_is_not_reported_as_saved_and_is_retried() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // A file where the folder of the backups should be.
    let obstruction = folder.path().join("editor");
    fs::write(&obstruction, "").expect("written");
    let options = AutosaveOptions { folder: folder.path().into(), every: Duration::ZERO };
    let scenario = Arc::new(shipped::scenario("scenario-1").expect("a shipped scenario"));
    let editor = Editor::open(scenario, "scenario-1".into(), false);
    let mut world = World::new();
    world.insert_resource(EditorBackup::new(Some(&options)));
    world.insert_resource(CurrentViewState(ViewState {
        editor: Some(Box::new(editor)),
        ..ViewState::default()
    }));
    for _ in 0..2 {
        save_now(&mut world).expect_err("the folder cannot be created");
    }

    fs::remove_file(&obstruction).expect("deleted");
    // Retried, but not before the interval has passed.
    back_up(&mut world, Duration::MAX).expect("nothing to do yet");
    assert!(!obstruction.exists(), "written too early");
    back_up(&mut world, Duration::ZERO).expect("written");
    let path = save_now(&mut world).expect("written").expect("unsaved changes");
    let text = fs::read_to_string(path).expect("a backup");
    assert!(text.contains("Scenario I"), "{text}");
}

#[test]
fn a_backup_that_another_process_has_restored_is_in_use() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let backup = Backup { from: "scenario-1".into(), edited: Scenario::default(), in_file: None };
    fs::write(folder.path().join("1.ron"), to_ron(&backup).expect("it is RON")).expect("written");
    let find = || store::find(folder.path()).expect("a backup");
    let (first, second) = (find(), find());
    let _restored = Store::of(first).expect("no process uses it");
    let error = Store::of(second).err().expect("it is in use").to_string();
    assert!(
        error.ends_with("1.ron: another wayfield process uses this backup, or it can't be locked"),
        "{error}"
    );
}
