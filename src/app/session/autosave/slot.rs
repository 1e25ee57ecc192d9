//! The slot of a training run: the folder of its autosave.
//!
//! In: copies of the training run. Out: a folder under the folder of all autosaves, locked by this process. A new copy is
//! written next to it and renamed, so a complete one exists at any moment.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::latest;
use super::sessions::{AutosaveMetadata, METADATA_FILE, TEMPORARY, delete_autosave};
use crate::app::session::run_snapshot::RunSnapshot;
use crate::run::RunError;
use crate::run::folder::RunFolder;
use crate::run::output_file::write_atomic;
use crate::scenario::to_ron;

/// The autosave of a training run.
pub(super) struct Slot {
    /// The folder of all autosaves.
    root: PathBuf,
    /// The autosave; `None` before the first one is written.
    folder: Option<RunFolder>,
    /// Length of `episodes.csv` in the autosave, in bytes; 0 if it must be written in full.
    known_bytes: u64,
}

impl Slot {
    /// A slot without an autosave.
    pub(super) fn new(root: &Path) -> Self {
        Self { root: root.into(), folder: None, known_bytes: 0 }
    }

    /// The slot of the autosave at `path`, locked.
    ///
    /// # Errors
    /// It is not a run folder, or another process has locked it.
    pub(super) fn of_existing(path: &Path) -> Result<Self, RunError> {
        Ok(Self { folder: Some(open_locked(path)?), ..Self::new(path.parent().unwrap_or(path)) })
    }

    /// The path of the autosave, if there is one.
    pub(super) fn path(&self) -> Option<&Path> {
        self.folder.as_ref().map(RunFolder::path)
    }

    /// Number of bytes at the start of `episodes.csv` that the next copy of the training may omit: the autosave has them.
    pub(super) fn known_bytes(&self) -> u64 {
        self.known_bytes
    }

    /// Replaces the autosave.
    ///
    /// # Errors
    /// A file cannot be written; the autosave is then the earlier one.
    pub(super) fn replace(&mut self, snapshot: &RunSnapshot) -> Result<(), RunError> {
        let replaced = self.try_replace(snapshot);
        self.known_bytes = if replaced.is_ok() { snapshot.episodes_bytes() } else { 0 };
        replaced
    }

    fn try_replace(&mut self, snapshot: &RunSnapshot) -> Result<(), RunError> {
        let failed = |error: io::Error| RunError::failed(&self.root, error);
        fs::create_dir_all(&self.root).map_err(failed)?;
        let temporary = tempfile::Builder::new().prefix(TEMPORARY).tempdir_in(&self.root).map_err(failed)?;
        let written = temporary.path().join("run");
        let earlier = self.path().filter(|_| self.known_bytes > 0).map(Path::to_path_buf);
        snapshot.write(&written, earlier)?;
        let metadata =
            to_ron(&AutosaveMetadata::new(snapshot)).map_err(|error| RunError::failed(&written, error))?;
        write_atomic(&written.join(METADATA_FILE), |file| file.write_all(metadata.as_bytes()))
            .map_err(failed)?;
        // Unlocks the earlier one: some systems do not rename a folder with open files.
        let (path, swapped) = match self.folder.take().map(|folder| folder.path().to_path_buf()) {
            Some(path) => {
                let swapped = swap(&written, &path).map_err(|error| RunError::failed(&path, error));
                (path, swapped)
            }
            None => (place(&written, &self.root, &snapshot.config.run_name()).map_err(failed)?, Ok(())),
        };
        // After a failure, this is the earlier autosave, if there was one.
        match open_locked(&path) {
            Ok(folder) => self.folder = Some(folder),
            Err(error) => return swapped.and(Err(error)),
        }
        swapped?;
        latest::set(Some(&path));
        Ok(())
    }

    /// Deletes the autosave, if there is one.
    pub(super) fn delete(&mut self) {
        if let Some(folder) = self.folder.take() {
            let path = folder.path().to_path_buf();
            drop(folder);
            // If it can be neither renamed nor deleted, later sessions offer it until newer autosaves displace it.
            let _ = delete_autosave(&path);
        }
        self.known_bytes = 0;
    }
}

fn open_locked(path: &Path) -> Result<RunFolder, RunError> {
    RunFolder::open(path)?.0.locked()
}

/// Moves the folder `written` to `path`, and deletes the folder that was there. After an error, that one is still there.
fn swap(written: &Path, path: &Path) -> io::Result<()> {
    let folder = path.parent().unwrap_or(path);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    // An unused name: a process that was killed during this function may have left a folder.
    let previous = unused_path(folder, &format!("{name}-previous"));
    let has_earlier = match fs::rename(path, &previous) {
        Ok(()) => true,
        Err(error) if error.kind() == ErrorKind::NotFound => false,
        Err(error) => return Err(error),
    };
    let swapped = fs::rename(written, path);
    if has_earlier {
        // If the previous one can be neither renamed nor deleted, later sessions offer it until newer autosaves displace it.
        let _ = if swapped.is_ok() { delete_autosave(&previous) } else { fs::rename(&previous, path) };
    }
    swapped
}

/// Moves the folder `written` to an unused path in `folder`, made from `name` and if necessary a number. Returns the path.
fn place(written: &Path, folder: &Path, name: &str) -> io::Result<PathBuf> {
    // Another process may use a path at any moment: a folder that is not empty cannot be replaced.
    let place_at = |path: PathBuf| match fs::rename(written, &path) {
        Ok(()) => Some(Ok(path)),
        Err(_) if path.exists() => None,
        Err(error) => Some(Err(error)),
    };
    numbered_paths(folder, name).find_map(place_at).unwrap_or_else(|| Err(ErrorKind::AlreadyExists.into()))
}

/// A path in `folder` that is not used yet, made from `name` and if necessary a number.
fn unused_path(folder: &Path, name: &str) -> PathBuf {
    numbered_paths(folder, name).find(|path| !path.exists()).unwrap_or_default()
}

fn numbered_paths(folder: &Path, name: &str) -> impl Iterator<Item = PathBuf> {
    let numbered = (2..).map(move |number| folder.join(format!("{name}-{number}")));
    std::iter::once(folder.join(name)).chain(numbered)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder_with(path: &Path, text: &str) {
        fs::create_dir(path).expect("a new folder");
        fs::write(path.join("file"), text).expect("a writable file");
    }

    fn text_in(path: &Path) -> String {
        fs::read_to_string(path.join("file")).expect("a readable file")
    }

    #[test]
    fn a_folder_left_by_a_killed_process_stays_and_does_not_stop_later_autosaves() {
        let root = tempfile::tempdir().expect("a temporary folder");
        let [path, written, left] = ["run", "written", "run-previous"].map(|name| root.path().join(name));
        folder_with(&left, "left");
        folder_with(&path, "first");
        folder_with(&written, "second");
        swap(&written, &path).expect("swapped");
        assert_eq!((text_in(&path), text_in(&left)), ("second".into(), "left".into()));
        assert_eq!(fs::read_dir(root.path()).expect("a folder").count(), 2, "the first one is deleted");
    }

    #[test]
    fn a_first_autosave_replaces_no_other() {
        let root = tempfile::tempdir().expect("a temporary folder");
        let texts = ["first", "second", "third"];
        let paths = texts.map(|text| {
            let written = root.path().join("written");
            folder_with(&written, text);
            place(&written, root.path(), "run").expect("placed")
        });
        assert_eq!(paths, ["run", "run-2", "run-3"].map(|name| root.path().join(name)));
        assert_eq!(paths.map(|path| text_in(&path)), texts);
        let missing = place(&root.path().join("missing"), root.path(), "new").expect_err("nothing to move");
        assert_eq!(missing.kind(), ErrorKind::NotFound);
    }

    #[test]
    fn an_autosave_that_cannot_be_moved_into_place_leaves_the_earlier_one_there() {
        let root = tempfile::tempdir().expect("a temporary folder");
        let path = root.path().join("run");
        folder_with(&path, "first");
        swap(&root.path().join("missing"), &path).expect_err("there is nothing to move");
        assert_eq!(text_in(&path), "first");
    }
}
