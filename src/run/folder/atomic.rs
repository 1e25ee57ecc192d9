//! Atomic writes: after a crash, a file has either its old or its new contents, never a part of them.

use std::fs::DirEntry;
#[cfg(not(target_arch = "wasm32"))]
use std::fs::File;
use std::io;
#[cfg(not(target_arch = "wasm32"))]
use std::io::Write;
use std::path::Path;

#[cfg(not(target_arch = "wasm32"))]
use crate::run::write_points::write_point;

/// The prefix of temporary files. [`RunFolder::locked`](super::RunFolder::locked) deletes those that a killed
/// process left.
const TEMPORARY: &str = ".writing-";

/// The writer that [`write_atomic`] passes on.
#[cfg(not(target_arch = "wasm32"))]
pub type Sink<'a> = io::BufWriter<&'a mut File>;
/// The writer that [`write_atomic`] passes on.
#[cfg(target_arch = "wasm32")]
pub type Sink = Vec<u8>;

/// Writes the file `path` with `write`. An old file is replaced only when the new one is complete.
///
/// # Errors
/// `write` fails, or the file cannot be written.
#[cfg(not(target_arch = "wasm32"))]
pub fn write_atomic(path: &Path, write: impl FnOnce(&mut Sink) -> io::Result<()>) -> io::Result<()> {
    let in_folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut temporary = tempfile::Builder::new().prefix(TEMPORARY).tempfile_in(in_folder)?;
    write_point("file: temporary created");
    let mut writer = io::BufWriter::new(temporary.as_file_mut());
    write(&mut writer)?;
    writer.flush()?;
    drop(writer);
    write_point("file: contents written");
    make_readable(temporary.path())?;
    temporary.as_file().sync_all()?;
    temporary.persist(path).map_err(|error| error.error)?;
    write_point("file: replaced");
    // Syncing the folder makes the rename survive a power cut, on file systems that support it.
    if let Ok(folder) = File::open(in_folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// Offers the file `path`, written with `write`, as a download in the browser.
///
/// # Errors
/// `write` fails.
#[cfg(target_arch = "wasm32")]
pub fn write_atomic(path: &Path, write: impl FnOnce(&mut Sink) -> io::Result<()>) -> io::Result<()> {
    let mut bytes = Vec::new();
    write(&mut bytes)?;
    crate::scenario::virtual_files::add_download(path, bytes);
    Ok(())
}

/// Whether `entry` is a temporary file of [`write_atomic`].
pub(super) fn is_temporary(entry: &DirEntry) -> bool {
    entry.file_name().to_string_lossy().starts_with(TEMPORARY)
}

/// Makes a file readable by all users, like a newly created file. (Temporary files are private.)
#[cfg(unix)]
fn make_readable(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    std::fs::set_permissions(path, std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(any(unix, target_arch = "wasm32")))]
fn make_readable(_: &Path) -> io::Result<()> {
    Ok(())
}
