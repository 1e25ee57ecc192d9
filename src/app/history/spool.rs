//! The spool: all rows ever, on the disk instead of in memory.
//!
//! In: rows, one at a time. Out: the very CSV that a run without a window writes, or the rows again. The file is
//! temporary and has no name: it is gone with the window, however that ends.

use std::fs::File;
use std::io::{self, BufReader, Seek, SeekFrom, Write};
use std::marker::PhantomData;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::run::folder::header;

/// Rows on the disk. If the disk fails, the first failure is told to whoever asks for the rows, and all else goes on.
pub struct Spool<Row> {
    file: Result<csv::Writer<File>, String>,
    row: PhantomData<fn() -> Row>,
}

impl<Row: Serialize + DeserializeOwned + Default> Spool<Row> {
    /// An empty one.
    #[must_use]
    pub fn new() -> Self {
        let begin = || -> io::Result<_> {
            let mut file = tempfile::tempfile()?;
            file.write_all(header::<Row>()?.as_bytes())?;
            Ok(csv::WriterBuilder::new().has_headers(false).from_writer(file))
        };
        Self { file: begin().map_err(|error| error.to_string()), row: PhantomData }
    }

    /// Adds a row.
    pub fn push(&mut self, row: &Row) {
        if let Ok(writer) = &mut self.file
            && let Err(error) = writer.serialize(row)
        {
            self.file = Err(error.to_string());
        }
    }

    /// Writes all rows as CSV, under their columns' names.
    ///
    /// # Errors
    /// They could not be kept, or cannot be written.
    pub fn copy(&mut self, to: &mut impl Write) -> io::Result<()> {
        self.read(|mut file| io::copy(&mut file, to).map(|_| ()))
    }

    /// Gives every row to `take`, in order.
    ///
    /// # Errors
    /// They could not be kept, or cannot be read.
    pub fn each(&mut self, mut take: impl FnMut(Row)) -> io::Result<()> {
        self.read(|file| {
            let mut reader = csv::Reader::from_reader(BufReader::new(file));
            reader.deserialize().try_for_each(|row| row.map(&mut take)).map_err(io::Error::other)
        })
    }

    /// Reads the file from its start; afterwards rows are added at its end again.
    fn read<T>(&mut self, read: impl FnOnce(&File) -> io::Result<T>) -> io::Result<T> {
        let writer = self.file.as_mut().map_err(|error| {
            io::Error::other(format!("the rows could not be kept in a temporary file: {error}"))
        })?;
        writer.flush()?;
        let mut file = writer.get_ref();
        file.seek(SeekFrom::Start(0))?;
        let result = read(file);
        file.seek(SeekFrom::End(0))?;
        result
    }
}
