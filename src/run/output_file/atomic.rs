//! Atomic writes: after a crash, a file has either its old or its new contents, never a part of them.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempPath};

use super::access;
use super::target::{OutputTarget, folder_of};
use super::temporary::PREFIX;
use crate::run::RunError;
use crate::run::write_points::write_point;

/// The writer that [`write_atomic`] passes to its callback.
pub type Sink<'a> = BufWriter<&'a mut File>;

/// Writes the file `path`, which the user chose, with `write`. An old file is replaced only when the new one is complete.
///
/// The new file has the permissions of the old one and, where the system permits it, its owner and group. Links are followed
/// and stay links; a hard link to the old file keeps the old contents. A device or a pipe is written directly.
///
/// # Errors
/// `write` fails, or the file cannot be written: it is read-only, or a folder, for example.
pub fn write_atomic(path: &Path, write: impl FnOnce(&mut Sink) -> io::Result<()>) -> io::Result<()> {
    match OutputTarget::of(path)? {
        OutputTarget::File(target) => replace(&target, write),
        OutputTarget::Stream => write_directly(path, write),
    }
}

/// Like [`write_atomic`], for the entry `path` of a folder that belongs to the program. A link is replaced, not followed: in a
/// folder from an untrusted source, it could lead to any file of the user.
///
/// # Errors
/// `write` fails, or the file cannot be written.
pub fn replace(path: &Path, write: impl FnOnce(&mut Sink) -> io::Result<()>) -> io::Result<()> {
    StagedFile::write(path, write)?.persist()
}

/// Checks that `path` can be written with [`write_atomic`], before work that would be lost otherwise. The file itself stays
/// as it is; a temporary file in its folder is created and deleted.
///
/// # Errors
/// It cannot be written. The message names a fix.
pub fn check_writable(path: &Path) -> Result<(), RunError> {
    let check = || match OutputTarget::of(path)? {
        OutputTarget::File(target) => temporary_file(&target, None).map(drop),
        OutputTarget::Stream => Ok(()),
    };
    check().map_err(|error| {
        let why = error.to_string();
        let help = if why.contains("help: ") { "" } else { "; help: choose another file" };
        RunError::not_writable(path, why + help)
    })
}

/// Writes to a device or a pipe.
fn write_directly(path: &Path, write: impl FnOnce(&mut Sink) -> io::Result<()>) -> io::Result<()> {
    // Standard output may lead to a file that already has contents.
    let mut file = File::options().append(true).open(path)?;
    let mut writer = BufWriter::new(&mut file);
    let written = write(&mut writer).and_then(|()| writer.flush());
    // Discards the unwritten rest, which dropping the writer would try to write again.
    let _ = writer.into_parts();
    match written {
        // A reader that closes the pipe early (`| head`) has read enough.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written,
    }
}

/// A new file that is to replace `target`, in the same folder. It is deleted on drop.
fn temporary_file(target: &Path, replaced: Option<&fs::Metadata>) -> io::Result<NamedTempFile> {
    let folder = folder_of(target);
    let file = tempfile::Builder::new().prefix(PREFIX).make_in(folder, |path| access::create(path, replaced));
    // The target itself may be writable, so the message must name the folder.
    file.map_err(|error| {
        let why = format!("no file can be created in the folder {}: {error}", folder.display());
        io::Error::new(error.kind(), why)
    })
}

/// A complete file that has yet to replace another one. It is deleted on drop.
#[derive(Debug)]
pub struct StagedFile {
    temporary: TempPath,
    target: PathBuf,
}

impl StagedFile {
    /// Writes, with `write`, the file that is to replace `target`; `target` stays as it is. A link is replaced, not followed.
    ///
    /// # Errors
    /// `write` fails, or the file cannot be written.
    pub fn write(target: &Path, write: impl FnOnce(&mut Sink) -> io::Result<()>) -> io::Result<Self> {
        let replaced = fs::symlink_metadata(target).ok().filter(fs::Metadata::is_file);
        let mut file = temporary_file(target, replaced.as_ref())?;
        write_point("file: temporary created");
        let mut writer = BufWriter::new(file.as_file_mut());
        write(&mut writer)?;
        writer.flush()?;
        drop(writer);
        write_point("file: contents written");
        if let Some(replaced) = replaced {
            access::copy(&replaced, file.as_file())?;
        }
        file.as_file().sync_all()?;
        Ok(Self { temporary: file.into_temp_path(), target: target.into() })
    }

    /// Replaces the target.
    ///
    /// # Errors
    /// The target cannot be replaced.
    pub fn persist(self) -> io::Result<()> {
        self.temporary.persist(&self.target).map_err(|error| error.error)?;
        write_point("file: replaced");
        // Syncing the folder makes the rename survive a power cut, on file systems that support it.
        if let Ok(folder) = File::open(folder_of(&self.target)) {
            let _ = folder.sync_all();
        }
        Ok(())
    }
}
