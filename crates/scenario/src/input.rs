//! The bytes of any file that a user may name: regular files, standard input, pipes and devices.
//!
//! In: a path and a limit. Out: bytes. Opening never blocks for long, and what can be read only once is read once: later reads
//! get the same bytes.

use std::fs::{self, File, Metadata};
use std::io::{self, Error, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// The longest time that a file may take to open. A named pipe opens when another program opens its other end.
const OPEN_TIME: Duration = Duration::from_millis(500);

/// The bytes of standard input, pipes and devices that have been read, by path.
static READ_ONCE: Mutex<Vec<(PathBuf, Vec<u8>)>> = Mutex::new(Vec::new());

/// Reads the first `max_bytes` bytes of the file at `path`, or all if it is shorter. `-` is standard input.
///
/// # Errors
/// The file is missing, a folder or unreadable, or it is a named pipe that no program writes to.
pub fn read_bytes(path: &Path, max_bytes: u64) -> io::Result<Vec<u8>> {
    if is_stdin(path) {
        return read_once(path, max_bytes, || Ok(io::stdin()));
    }
    let metadata = fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(ErrorKind::IsADirectory.into());
    }
    if metadata.is_file() {
        return read_up_to(File::open(path)?, max_bytes);
    }
    if let Some(kind) = unreadable_kind(&metadata) {
        return Err(Error::other(format!("it is a {kind}, not a file")));
    }
    read_once(path, max_bytes, || open_soon(path))
}

/// Whether a file or folder exists at `path`. Standard input (`-`) exists.
#[must_use]
pub fn path_exists(path: &Path) -> bool {
    is_stdin(path) || path.exists()
}

/// Whether `path` is a pipe, a device or another file that is not regular, so that it may never end or can be read only once.
#[must_use]
pub fn is_special_file(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
}

fn is_stdin(path: &Path) -> bool {
    path == "-" || (cfg!(unix) && path == "/dev/stdin")
}

fn read_up_to(file: impl Read, max_bytes: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.take(max_bytes).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads up to `max_bytes` bytes: of what an earlier call has read at `path`, or else from the file that `open` opens.
fn read_once<R: Read>(
    path: &Path,
    max_bytes: u64,
    open: impl FnOnce() -> io::Result<R>,
) -> io::Result<Vec<u8>> {
    let mut files = READ_ONCE.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, bytes)) = files.iter().find(|(known, _)| known == path) {
        return read_up_to(bytes.as_slice(), max_bytes);
    }
    let bytes = read_up_to(open()?, max_bytes)?;
    files.push((path.into(), bytes.clone()));
    Ok(bytes)
}

/// Opens the pipe or device at `path` in another thread. If that takes longer than [`OPEN_TIME`], the thread is abandoned.
fn open_soon(path: &Path) -> io::Result<File> {
    let (sender, receiver) = mpsc::channel();
    let path = path.to_owned();
    thread::Builder::new().spawn(move || sender.send(File::open(path)))?;
    let too_late = |_| Err(Error::new(ErrorKind::TimedOut, "it is a named pipe that no program writes to"));
    receiver.recv_timeout(OPEN_TIME).unwrap_or_else(too_late)
}

/// The kind of a file from which nothing sensible can be read.
#[cfg(unix)]
fn unreadable_kind(metadata: &Metadata) -> Option<&'static str> {
    use std::os::unix::fs::FileTypeExt;
    let kind = metadata.file_type();
    if kind.is_socket() {
        Some("socket")
    } else if kind.is_block_device() {
        Some("block device")
    } else {
        None
    }
}

#[cfg(not(unix))]
fn unreadable_kind(_: &Metadata) -> Option<&'static str> {
    None
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn each_read_of_a_device_is_limited() {
        let read = |max_bytes| {
            read_bytes(Path::new("/dev/zero"), max_bytes).expect("a device that can be read").len()
        };
        assert_eq!([read(10), read(4), read(10)], [10, 4, 10]);
    }
}
