//! The bytes of any file that a user may name: regular files, standard input, pipes and devices.
//!
//! In: a path and a limit. Out: bytes. Opening never blocks for long. A stream can be read only once, so its bytes are kept:
//! later reads get the same bytes, and more if their limit is larger.

use std::fs::{self, File, Metadata};
use std::io::{self, Error, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// The longest time that a file may take to open. A named pipe opens when another program opens its other end.
const OPEN_TIME: Duration = Duration::from_millis(500);

/// Standard input, pipes and devices that have been read.
static STREAMS: Mutex<Vec<Stream>> = Mutex::new(Vec::new());

/// A file that can be read only once.
struct Stream {
    /// `-` for standard input.
    path: PathBuf,
    /// The bytes read so far.
    bytes: Vec<u8>,
    /// The rest; `None` after its end.
    rest: Option<Box<dyn Read + Send>>,
}

impl Stream {
    /// The first `max_bytes` bytes, or all if there are fewer.
    fn read_up_to(&mut self, max_bytes: u64) -> io::Result<Vec<u8>> {
        let missing = max_bytes.saturating_sub(self.bytes.len() as u64);
        if let Some(rest) = self.rest.as_mut().filter(|_| missing > 0) {
            let read = rest.take(missing).read_to_end(&mut self.bytes)?;
            if (read as u64) < missing {
                self.rest = None;
            }
        }
        read_up_to(self.bytes.as_slice(), max_bytes)
    }
}

/// Reads the first `max_bytes` bytes of the file at `path`, or all if it is shorter. `-` is standard input.
///
/// # Errors
/// The file is missing, a folder or unreadable, or it is a named pipe that no program writes to.
pub fn read_bytes(path: &Path, max_bytes: u64) -> io::Result<Vec<u8>> {
    if is_stdin(path) {
        return read_once(Path::new("-"), max_bytes, || Ok(Box::new(io::stdin())));
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
    read_once(path, max_bytes, || Ok(Box::new(open_soon(path)?)))
}

/// Whether a file or folder exists at `path`. Standard input (`-`) exists.
#[must_use]
pub fn path_exists(path: &Path) -> bool {
    is_stdin(path) || path.exists()
}

/// Whether a regular file exists at `path`.
#[must_use]
pub fn is_file(path: &Path) -> bool {
    path.is_file()
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

/// Reads up to `max_bytes` bytes of the stream at `path`, which `open` opens the first time.
fn read_once(
    path: &Path,
    max_bytes: u64,
    open: impl FnOnce() -> io::Result<Box<dyn Read + Send>>,
) -> io::Result<Vec<u8>> {
    let mut streams = STREAMS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(stream) = streams.iter_mut().find(|stream| stream.path == path) {
        return stream.read_up_to(max_bytes);
    }
    let mut stream = Stream { path: path.into(), bytes: Vec::new(), rest: Some(open()?) };
    let bytes = stream.read_up_to(max_bytes)?;
    streams.push(stream);
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

    #[test]
    fn a_larger_limit_continues_a_stream_that_a_smaller_one_has_cut() {
        let read = |max_bytes| {
            let open = || Ok(Box::new(&b"abcdef"[..]) as Box<dyn Read + Send>);
            read_once(Path::new("a stream"), max_bytes, open).expect("a stream that can be read")
        };
        assert_eq!([read(2), read(4), read(3), read(9)], [&b"ab"[..], b"abcd", b"abc", b"abcdef"]);
    }
}
