//! The shelf: files in a browser, where there is no disk.
//!
//! In: what the user handed to the page, by name; what the program writes. Out: the former to whoever reads a file of
//! that name, the latter to the page, which saves it. What was handed in stays, so that a scenario can be begun anew, but
//! for policies: who reads one, takes it.

use std::collections::VecDeque;
use std::io::{Error, ErrorKind};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// So many files are kept, of which none is longer than [`LONGEST`].
const MOST: usize = 64;
/// Of a file that stays, no more bytes are kept: enough to see that it is too long.
const LONGEST: usize = crate::limits::MAX_FILE_BYTES as usize + 1;

/// A file's name and its bytes.
pub type VirtualFile = (String, Vec<u8>);

static HANDED_IN: Mutex<VecDeque<VirtualFile>> = Mutex::new(VecDeque::new());
static HANDED_OUT: Mutex<Vec<VirtualFile>> = Mutex::new(Vec::new());

/// Puts a file of the user's on the shelf; an older one of that name is replaced.
pub fn add_upload(name: String, mut bytes: Vec<u8>) {
    if !is_taken(&name) {
        bytes.truncate(LONGEST);
        bytes.shrink_to_fit();
    }
    let mut files = HANDED_IN.lock().unwrap_or_else(PoisonError::into_inner);
    files.retain(|(other, _)| *other != name);
    files.push_back((name, bytes));
    if files.len() > MOST {
        files.pop_front();
    }
}

/// The user's file of that name, of which no more than `most` bytes are wanted.
///
/// # Errors
/// There is none.
pub fn read(path: &Path, most: u64) -> std::io::Result<Vec<u8>> {
    let mut files = HANDED_IN.lock().unwrap_or_else(PoisonError::into_inner);
    let found = files.iter().position(|(name, _)| Path::new(name) == path);
    let found = found.ok_or_else(|| Error::from(ErrorKind::NotFound))?;
    let mut bytes = if is_taken(&files[found].0) {
        files.remove(found).map_or_else(Vec::new, |(_, bytes)| bytes)
    } else {
        files[found].1.clone()
    };
    bytes.truncate(usize::try_from(most).unwrap_or(usize::MAX));
    Ok(bytes)
}

/// Whether there is a file of the user's of that name.
pub fn contains(path: &Path) -> bool {
    let files = HANDED_IN.lock().unwrap_or_else(PoisonError::into_inner);
    files.iter().any(|(name, _)| Path::new(name) == path)
}

/// Whether a file of this name is taken from the shelf by who reads it.
fn is_taken(name: &str) -> bool {
    name.ends_with(".safetensors")
}

/// Puts a file of the program's on the shelf.
pub fn add_download(path: &Path, bytes: Vec<u8>) {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    HANDED_OUT.lock().unwrap_or_else(PoisonError::into_inner).push((name, bytes));
}

/// Takes what the program has put there since the last time.
pub fn take_downloads() -> Vec<VirtualFile> {
    std::mem::take(&mut *HANDED_OUT.lock().unwrap_or_else(PoisonError::into_inner))
}
