//! Output files: written whole, or not at all.
//!
//! In: a path, and a function that writes the contents. Out: a file that has either its old or its new contents, never a part
//! of them, whatever happens.
//!
//! | file | contents |
//! |---|---|
//! | `atomic.rs` | writing a temporary file and renaming it |
//! | `target.rs` | the file behind a path: links, devices, what must not be overwritten |
//! | `access.rs` | permissions, owner and group |
//! | `temporary.rs` | the names of temporary files, and deleting those of a killed process |
//! | `download.rs` | in a browser: downloads |

#[cfg(not(target_arch = "wasm32"))]
mod access;
#[cfg(not(target_arch = "wasm32"))]
mod atomic;
#[cfg(target_arch = "wasm32")]
mod download;
#[cfg(not(target_arch = "wasm32"))]
mod target;
mod temporary;

#[cfg(not(target_arch = "wasm32"))]
pub use atomic::{Sink, StagedFile, check_writable, replace, write_atomic};
#[cfg(target_arch = "wasm32")]
pub use download::{Sink, replace, write_atomic};
#[cfg(not(target_arch = "wasm32"))]
pub use target::{check_entry, is_stdout, is_stream};
pub use temporary::{is_temporary, remove_temporary_files};
