//! The files of a test: episodes as CSV, and a trace of every control step as JSON lines.
//!
//! A file appears when the whole test is done, or not at all. It is written as the test runs, so it may be larger than
//! memory.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::run::RunError;
use crate::run::evaluate::TraceStep;
use crate::run::output_file::{check_writable, is_stdout, is_stream, write_atomic};
use crate::run::progress::print_stderr;
use crate::scenario::printable_path;

/// The files that a test writes.
pub struct TestFiles {
    csv: Option<PathBuf>,
    trace: Option<PathBuf>,
}

/// An open file of a test.
pub struct TestFile<'a> {
    path: &'a Path,
    writer: &'a mut dyn Write,
}

/// The reason why a test ended early.
pub enum TestEnd {
    /// The reader of a pipe has read enough (`| head`).
    ReaderClosed,
    /// An error.
    Error(RunError),
}

impl From<RunError> for TestEnd {
    fn from(error: RunError) -> Self {
        Self::Error(error)
    }
}

/// Standard output as a file.
const STDOUT: &str = "/dev/stdout";

impl TestFiles {
    /// Checks that the files `csv` and `trace` can be written. `-` is standard output.
    ///
    /// # Errors
    /// A file cannot be written, both files are the same, or standard output is also needed for JSON.
    pub fn new(csv: Option<&Path>, trace: Option<&Path>, json: bool) -> Result<Self, RunError> {
        let target = |path: &Path| {
            if path == Path::new("-") || is_stdout(path) { STDOUT.into() } else { path.to_owned() }
        };
        let files = Self { csv: csv.map(target), trace: trace.map(target) };
        if files.csv.is_some() && files.csv.as_deref().map(located) == files.trace.as_deref().map(located) {
            return Err(RunError::InvalidInput(
                "--csv and --trace name the same file; help: give each a file of its own".into(),
            ));
        }
        if json && files.use_stdout() {
            return Err(RunError::InvalidInput(
                "--json and a file of the test would both go to standard output; help: give --csv or --trace a file".into(),
            ));
        }
        for path in [&files.csv, &files.trace].into_iter().flatten() {
            check_writable(path)?;
        }
        Ok(files)
    }

    /// Whether one of the files is standard output.
    pub fn use_stdout(&self) -> bool {
        [&self.csv, &self.trace].into_iter().flatten().any(|path| path == Path::new(STDOUT))
    }

    /// Prints which files are not written, after the reader of standard output has closed it.
    pub fn print_reader_closed(&self) {
        for path in [&self.csv, &self.trace].into_iter().flatten().filter(|path| !is_stream(path)) {
            let path = printable_path(path);
            print_stderr(&format!(
                "note: {path}: not written, because the reader of the other file has closed it"
            ));
        }
    }

    /// Runs `test`, which writes episodes to the first file and steps to the second. If it fails, existing files are kept.
    pub fn write<T>(
        &self,
        test: impl FnOnce(Option<&mut TestFile>, Option<&mut TestFile>) -> Result<T, TestEnd>,
    ) -> Result<T, TestEnd> {
        write(self.csv.as_deref(), |csv| write(self.trace.as_deref(), |trace| test(csv, trace)))
    }
}

/// `path` with the canonical path of its folder, to compare it with others.
fn located(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let folder = path.parent().and_then(|folder| folder.canonicalize().ok());
    folder.zip(path.file_name()).map_or_else(|| path.clone(), |(folder, name)| folder.join(name))
}

/// Runs `work`, which writes the contents of the file at `path`, if a path is given.
fn write<T>(
    path: Option<&Path>,
    work: impl FnOnce(Option<&mut TestFile>) -> Result<T, TestEnd>,
) -> Result<T, TestEnd> {
    let Some(path) = path else { return work(None) };
    let mut done = None;
    let written = write_atomic(path, |sink| {
        let result = done.insert(work(Some(&mut TestFile { path, writer: sink })));
        // The error that matters is in `done`; this one keeps the old file.
        if result.is_ok() { Ok(()) } else { Err(io::Error::other("the test has failed")) }
    });
    match (written, done) {
        (Err(error), Some(Ok(_)) | None) => Err(failed(path, &error)),
        (_, Some(result)) => result,
        (Ok(()), None) => Err(TestEnd::ReaderClosed),
    }
}

impl TestFile<'_> {
    /// Adds rows of episodes, with a header if they are the first rows of the file.
    pub fn rows(
        &mut self,
        mut records: impl Iterator<Item = impl Serialize>,
        is_first: bool,
    ) -> Result<(), TestEnd> {
        let mut writer = csv::WriterBuilder::new().has_headers(is_first).from_writer(&mut *self.writer);
        let written = records.try_for_each(|record| writer.serialize(record));
        let written = written.map_err(io_error).and_then(|()| writer.flush());
        drop(writer);
        written.map_err(|error| failed(self.path, &error))
    }

    /// Adds the line of a control step of `policy`.
    pub fn step(&mut self, policy: &str, step: &TraceStep) -> Result<(), TestEnd> {
        let written = step.write_line(policy, &mut *self.writer);
        written.map_err(|error| failed(self.path, &error))
    }
}

/// `error` with the kind of its cause, which `io::Error::from` would lose.
fn io_error(error: csv::Error) -> io::Error {
    let kind = match error.kind() {
        csv::ErrorKind::Io(cause) => cause.kind(),
        _ => io::ErrorKind::Other,
    };
    io::Error::new(kind, error)
}

fn failed(path: &Path, error: &io::Error) -> TestEnd {
    match error.kind() {
        io::ErrorKind::BrokenPipe => TestEnd::ReaderClosed,
        _ => TestEnd::Error(RunError::not_written(path, error)),
    }
}
