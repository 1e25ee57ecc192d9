//! The spool: all rows of a training run, in a temporary file instead of in memory.
//!
//! In: rows, one at a time. Out: the same CSV as a headless run writes, or the rows again. The file has no
//! name, so it disappears when the process exits or crashes. In a browser the rows are in memory.

#[cfg(not(target_arch = "wasm32"))]
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::marker::PhantomData;

use serde::Serialize;
use serde::de::DeserializeOwned;

#[cfg(target_arch = "wasm32")]
use self::memory::File;
use crate::run::folder::header;
use crate::run::metric_rows::SetColumns;

/// Rows in a temporary file. The first write error is kept and returned when the rows are read; adding rows
/// never fails.
pub struct Spool<Row> {
    file: Result<csv::Writer<File>, String>,
    /// The names of the scenarios of the run's set; none without a set.
    scenarios: Vec<String>,
    row: PhantomData<fn() -> Row>,
}

impl<Row: Serialize + DeserializeOwned + Default + SetColumns> Spool<Row> {
    /// An empty spool. `scenarios` are the names of the scenarios of the run's set; none without a set.
    #[must_use]
    pub fn new(scenarios: &[String]) -> Self {
        let open = || -> io::Result<_> {
            let mut file = temporary()?;
            file.write_all(header::<Row>(&Row::set_columns(scenarios))?.as_bytes())?;
            Ok(csv::WriterBuilder::new().has_headers(false).from_writer(file))
        };
        let file = open().map_err(|error| error.to_string());
        Self { file, scenarios: scenarios.to_vec(), row: PhantomData }
    }

    /// Adds a row.
    pub fn push(&mut self, row: &Row) {
        if let Ok(writer) = &mut self.file
            && let Err(error) = writer.serialize((row, row.set_values(&self.scenarios)))
        {
            self.file = Err(error.to_string());
        }
    }

    /// Writes all rows as CSV, with a header.
    ///
    /// # Errors
    /// A row could not be stored, or `to` cannot be written.
    pub fn write_csv_to(&mut self, to: &mut impl Write) -> io::Result<()> {
        self.read(|mut file| io::copy(&mut file, to).map(|_| ()))
    }

    /// Reads the CSV after its first `offset` bytes.
    ///
    /// # Errors
    /// A row could not be stored, or cannot be read back.
    pub fn csv_from(&mut self, offset: u64) -> io::Result<Vec<u8>> {
        self.read(|mut file| {
            let mut bytes = Vec::new();
            file.seek(SeekFrom::Start(offset))?;
            file.read_to_end(&mut bytes)?;
            Ok(bytes)
        })
    }

    /// Calls `visit` with each row, in order. The rows lack the values of their set columns.
    ///
    /// # Errors
    /// A row could not be stored, or cannot be read back.
    pub fn for_each(&mut self, mut visit: impl FnMut(Row)) -> io::Result<()> {
        self.read(|file| {
            let mut reader = csv::Reader::from_reader(BufReader::new(file));
            reader.deserialize().try_for_each(|row| row.map(&mut visit)).map_err(io::Error::other)
        })
    }

    /// Calls `read` with the file at its start, then returns to its end.
    fn read<T>(&mut self, read: impl FnOnce(&File) -> io::Result<T>) -> io::Result<T> {
        let writer = self.file.as_mut().map_err(|error| {
            io::Error::other(format!("could not store the rows in a temporary file: {error}"))
        })?;
        writer.flush()?;
        let mut file = writer.get_ref();
        file.seek(SeekFrom::Start(0))?;
        let result = read(file);
        file.seek(SeekFrom::End(0))?;
        result
    }
}

/// Opens a temporary file without a name.
#[cfg(not(target_arch = "wasm32"))]
fn temporary() -> io::Result<File> {
    tempfile::tempfile()
}

#[cfg(target_arch = "wasm32")]
fn temporary() -> io::Result<File> {
    Ok(File::default())
}

#[cfg(target_arch = "wasm32")]
mod memory {
    //! The temporary file of a platform without a disk.

    use std::io::{Cursor, Read, Result, Seek, SeekFrom, Write};
    use std::sync::{Mutex, MutexGuard, PoisonError};

    /// A file in memory. Like a real file, it can be read and repositioned through a shared reference.
    #[derive(Default)]
    pub struct File(Mutex<Cursor<Vec<u8>>>);

    impl File {
        fn cursor(&self) -> MutexGuard<'_, Cursor<Vec<u8>>> {
            self.0.lock().unwrap_or_else(PoisonError::into_inner)
        }
    }

    impl Write for File {
        fn write(&mut self, bytes: &[u8]) -> Result<usize> {
            self.cursor().write(bytes)
        }

        fn flush(&mut self) -> Result<()> {
            Ok(())
        }
    }

    impl Read for &File {
        fn read(&mut self, into: &mut [u8]) -> Result<usize> {
            self.cursor().read(into)
        }
    }

    impl Seek for &File {
        fn seek(&mut self, to: SeekFrom) -> Result<u64> {
            self.cursor().seek(to)
        }
    }
}
