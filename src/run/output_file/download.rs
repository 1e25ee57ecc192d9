//! Files that are written in a browser: downloads.

use std::io;
use std::path::Path;

/// The writer that [`write_atomic`] passes to `write`.
pub type Sink = Vec<u8>;

/// Offers the file `path`, written with `write`, as a download in the browser.
///
/// # Errors
/// `write` fails.
pub fn write_atomic(path: &Path, write: impl FnOnce(&mut Sink) -> io::Result<()>) -> io::Result<()> {
    let mut bytes = Vec::new();
    write(&mut bytes)?;
    crate::scenario::virtual_files::add_download(path, bytes);
    Ok(())
}

pub use write_atomic as replace;
