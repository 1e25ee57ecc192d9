//! The writer of TensorBoard event files, for scalars only.
//!
//! In: a run's scalars, each with a tag and a step. Out: a file `events.out.tfevents.*` in the run folder.
//! TensorBoard plots it while the run is in progress.
//!
//! TensorBoard reads the files of a folder in the order of their names, and plots the points in the order in which it reads
//! them. A resumed run therefore first cuts off what a killed process wrote after the last checkpoint ([`cut_back`]), because
//! that will be written again, and then creates a file whose name comes last.
//!
//! | file | contents |
//! |---|---|
//! | `event.rs` | the format |
//! | `cut.rs` | cutting files back to a checkpoint |

mod cut;
mod event;
#[cfg(test)]
mod tests;

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use super::write_points::write_point;

pub use cut::cut_back;

/// The start of an event file's name. The time in s since 1970 and [`SUFFIX`] follow.
const PREFIX: &str = "events.out.tfevents.";
/// The end of the names of this program's event files.
const SUFFIX: &str = ".wayfield";

/// A writer of scalars to one event file. Buffered data reaches the file on [`flush`](Self::flush) or on
/// drop.
#[derive(Debug)]
pub struct EventWriter {
    file: BufWriter<File>,
    /// The wall time of the latest event, in s since 1970.
    latest_s: f64,
}

impl EventWriter {
    /// Creates `events.out.tfevents.<seconds since 1970>.wayfield` in the existing folder `dir`. The name sorts after those of
    /// this program's other event files there, and no event is earlier than `earliest_s`, in s since 1970, even if the clock
    /// was set back.
    ///
    /// # Errors
    /// The file cannot be created or written. The message names it.
    pub fn create(dir: &Path, earliest_s: f64) -> io::Result<Self> {
        let latest = files(dir).iter().filter_map(|file| seconds(file)).max();
        let mut time_s = latest.map_or(0, |seconds| seconds + 1).max(since_1970().as_secs());
        let (path, file) = loop {
            let path = dir.join(format!("{PREFIX}{time_s:010}{SUFFIX}"));
            match File::create_new(&path) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => time_s += 1,
                file => break (path, file),
            }
        };
        let named = |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", path.display()));
        let file = file.map_err(named)?;
        write_point("events: created");

        let mut writer = Self { file: BufWriter::new(file), latest_s: earliest_s };
        let version = event::version(writer.now_s());
        writer.file.write_all(&event::record(&version)).and_then(|()| writer.flush()).map_err(named)?;
        Ok(writer)
    }

    /// Writes the scalar `tag` (slashes make groups: `loss/mean`) with `value` at `step` (at most 2^63 - 1).
    /// Non-finite values are written too; TensorBoard marks them in the curve.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn scalar(&mut self, tag: &str, step: u64, value: f32) -> io::Result<()> {
        let event = event::scalar(self.now_s(), tag, step, value);
        self.file.write_all(&event::record(&event))
    }

    /// Writes all buffered data to the file, where TensorBoard sees it.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }

    /// Like [`flush`](Self::flush), and the data then survives a power cut.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn sync(&mut self) -> io::Result<()> {
        self.flush()?;
        self.file.get_ref().sync_data()
    }

    /// The wall time in s since 1970. It never decreases.
    fn now_s(&mut self) -> f64 {
        self.latest_s = self.latest_s.max(since_1970().as_secs_f64());
        self.latest_s
    }
}

/// This program's event files in `dir`, in the order in which TensorBoard reads them.
fn files(dir: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(dir).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> =
        entries.map(|entry| entry.path()).filter(|path| seconds(path).is_some()).collect();
    files.sort();
    files
}

/// The time in the name of an event file of this program, in s since 1970.
fn seconds(file: &Path) -> Option<u64> {
    let (number, rest) = file.file_name()?.to_str()?.strip_prefix(PREFIX)?.split_once('.')?;
    let is_ours = rest.split('.').next() == Some(&SUFFIX[1..]);
    // At most ten digits, so that the names sort by time.
    number.parse::<u32>().ok().filter(|_| is_ours).map(u64::from)
}

fn since_1970() -> Duration {
    SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default()
}
