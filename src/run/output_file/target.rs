//! The target of an output: the file behind a path that the user chose.

use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Maximum number of links to follow, as in Linux.
const MAX_LINKS: usize = 40;

/// The target of an output.
pub enum OutputTarget {
    /// A regular file that can be replaced, or a name that does not exist yet.
    File(PathBuf),
    /// A device or a pipe, such as `/dev/stdout`, or an open file of a process.
    Stream,
}

impl OutputTarget {
    /// The target behind `path`. Links are followed, even to a file that does not exist yet.
    ///
    /// # Errors
    /// The path is a folder, read-only or invalid, or its folder does not exist.
    pub fn of(path: &Path) -> io::Result<Self> {
        match fs::metadata(path) {
            Ok(found) if !found.is_file() && !found.is_dir() => return Ok(Self::Stream),
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        let target = followed(path)?;
        if holds_descriptors(folder_of(&target)) { Ok(Self::Stream) } else { Self::file(target) }
    }

    fn file(target: PathBuf) -> io::Result<Self> {
        let folder = folder_of(&target);
        if !folder.is_dir() {
            let why = format!("the folder {} does not exist; help: create it first", folder.display());
            return Err(io::Error::new(ErrorKind::NotFound, why));
        }
        check_entry(&target)?;
        if ends_with_separator(&target) {
            let why = "this is the name of a folder; help: give the name of a file";
            return Err(io::Error::new(ErrorKind::IsADirectory, why));
        }
        if target.exists() {
            // Replacing a file needs permissions for its folder only; a file that may not be written must not be replaced either.
            File::options().write(true).open(&target)?;
        }
        Ok(Self::File(target))
    }
}

/// Whether `path` is a device or a pipe.
#[must_use]
pub fn is_stream(path: &Path) -> bool {
    matches!(OutputTarget::of(path), Ok(OutputTarget::Stream))
}

/// Whether `path` is standard output, by one of its names, such as `/dev/stdout` and `/dev/fd/1`, or a link to it.
#[must_use]
pub fn is_stdout(path: &Path) -> bool {
    let is_open_file_1 = |target: PathBuf| {
        let own = Path::new("/dev/fd").canonicalize();
        let folder = folder_of(&target).canonicalize();
        target.file_name() == Some("1".as_ref())
            && own.is_ok_and(|own| folder.is_ok_and(|folder| folder == own))
    };
    path == Path::new("/dev/stdout") || followed(path).is_ok_and(is_open_file_1)
}

/// Follows links from `path` to something else than a link, or to an open file of a process.
fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..MAX_LINKS {
        let folder = folder_of(&target);
        match fs::read_link(&target) {
            Ok(destination) if !holds_descriptors(folder) => target = folder.join(destination),
            _ => return Ok(target),
        }
    }
    Err(io::Error::other("too many levels of symbolic links"))
}

/// Checks that the entry `path` of a folder is a file that may be replaced, or does not exist.
///
/// # Errors
/// It is a folder, or read-only (even for root).
pub fn check_entry(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_dir() => {
            Err(io::Error::new(ErrorKind::IsADirectory, "this is a folder; help: give the name of a file"))
        }
        Ok(found) if found.is_file() && found.permissions().readonly() => {
            let why = "the file is read-only; help: make it writable (chmod u+w) or write elsewhere";
            Err(io::Error::new(ErrorKind::PermissionDenied, why))
        }
        _ => Ok(()),
    }
}

/// Whether `path` is written as a folder: `new/`.
fn ends_with_separator(path: &Path) -> bool {
    let bytes = path.as_os_str().as_encoded_bytes();
    bytes.last().is_some_and(|last| std::path::is_separator(char::from(*last)))
}

/// The folder that contains `path`.
pub(super) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Whether `folder` holds the open files of a process. Its entries look like links, but lead to the open files even if these
/// no longer have a name.
fn holds_descriptors(folder: &Path) -> bool {
    folder.canonicalize().is_ok_and(|folder| {
        folder == Path::new("/dev/fd") || (folder.starts_with("/proc") && folder.ends_with("fd"))
    })
}
