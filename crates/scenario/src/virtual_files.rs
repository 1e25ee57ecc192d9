//! Virtual files for the browser, which has no disk.
//!
//! In: the user's uploads, and files that the program writes. Out: uploads by name, and downloads for the page to save.
//! Uploads stay available, so that a scenario can be loaded again. Policies are large, so reading one removes it.

use std::collections::VecDeque;
use std::io::{Error, ErrorKind};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Largest number of uploads.
const MAX_FILES: usize = 64;
/// Largest number of bytes of all uploads; the newest one stays even if it is larger.
const MAX_BYTES: usize = 1 << 27;

/// A file's name and its bytes.
pub type VirtualFile = (String, Vec<u8>);

static UPLOADS: Mutex<VecDeque<VirtualFile>> = Mutex::new(VecDeque::new());
static DOWNLOADS: Mutex<Vec<VirtualFile>> = Mutex::new(Vec::new());

/// Adds an upload. It replaces an older one of the same name. The oldest uploads are removed if there are too many, or if they
/// are too large together.
pub fn add_upload(name: String, bytes: Vec<u8>) {
    let mut files = UPLOADS.lock().unwrap_or_else(PoisonError::into_inner);
    files.retain(|(other, _)| *other != name);
    files.push_back((name, bytes));
    let mut total: usize = files.iter().map(|(_, bytes)| bytes.len()).sum();
    while files.len() > MAX_FILES || (total > MAX_BYTES && files.len() > 1) {
        total -= files.pop_front().map_or(0, |(_, bytes)| bytes.len());
    }
}

/// Reads the first `max_bytes` bytes of the upload at `path`. Reading a policy removes it.
///
/// # Errors
/// `NotFound` if there is no upload of that name.
pub fn read(path: &Path, max_bytes: u64) -> std::io::Result<Vec<u8>> {
    let mut files = UPLOADS.lock().unwrap_or_else(PoisonError::into_inner);
    let found = files.iter().position(|(name, _)| Path::new(name) == path);
    let found = found.ok_or_else(|| Error::from(ErrorKind::NotFound))?;
    let max_bytes = usize::try_from(max_bytes).unwrap_or(usize::MAX);
    if !is_removed_by_reading(&files[found].0) {
        let bytes = &files[found].1;
        return Ok(bytes[..bytes.len().min(max_bytes)].to_vec());
    }
    let mut bytes = files.remove(found).map_or_else(Vec::new, |(_, bytes)| bytes);
    bytes.truncate(max_bytes);
    Ok(bytes)
}

/// Whether there is a device or a pipe at `path`: never, in a browser.
pub const fn is_special_file(_: &Path) -> bool {
    false
}

/// Whether there is an upload at `path`.
pub fn contains(path: &Path) -> bool {
    let files = UPLOADS.lock().unwrap_or_else(PoisonError::into_inner);
    files.iter().any(|(name, _)| Path::new(name) == path)
}

/// Whether reading removes an upload of this name.
fn is_removed_by_reading(name: &str) -> bool {
    name.ends_with(".safetensors")
}

/// Adds a file for the page to save.
pub fn add_download(path: &Path, bytes: Vec<u8>) {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    DOWNLOADS.lock().unwrap_or_else(PoisonError::into_inner).push((name, bytes));
}

/// Removes and returns the files that were added since the last call.
pub fn take_downloads() -> Vec<VirtualFile> {
    std::mem::take(&mut *DOWNLOADS.lock().unwrap_or_else(PoisonError::into_inner))
}
