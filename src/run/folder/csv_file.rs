//! The CSV files of a run folder.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::RunFolder;
use crate::run::RunError;
use crate::run::metric_rows::{SetColumns, parse_rows};
use crate::run::write_points::write_point;

impl RunFolder {
    /// The rows of the CSV file `name`. A last row without a line break is left out: a run in progress is still writing it.
    ///
    /// # Errors
    /// The file cannot be read, or a row cannot be parsed as `Row`.
    pub fn rows<Row: DeserializeOwned>(&self, name: &str) -> Result<Vec<Row>, RunError> {
        let lines = self.complete_lines(name, u64::MAX)?;
        let rows: Result<Vec<Row>, csv::Error> =
            csv::Reader::from_reader(&lines[..]).into_deserialize().collect();
        rows.map_err(|error| RunError::failed(&self.path.join(name), error))
    }

    /// Like [`rows`](Self::rows), but of the first `bytes` bytes of the file, and with the further columns of a run over a set
    /// of scenarios. `scenarios` are the names of the scenarios.
    ///
    /// # Errors
    /// As [`rows`](Self::rows).
    pub fn rows_of_set<Row: DeserializeOwned + SetColumns>(
        &self,
        name: &str,
        bytes: u64,
        scenarios: &[String],
    ) -> Result<Vec<Row>, RunError> {
        let rows = parse_rows(&self.complete_lines(name, bytes)?, scenarios);
        rows.map_err(|error| RunError::failed(&self.path.join(name), error))
    }

    /// The first `bytes` bytes of the file `name`, up to their last line break.
    fn complete_lines(&self, name: &str, bytes: u64) -> Result<Vec<u8>, RunError> {
        let path = self.path.join(name);
        let mut lines = fs::read(&path).map_err(|error| RunError::failed(&path, error))?;
        lines.truncate(usize::try_from(bytes).unwrap_or(usize::MAX));
        lines.truncate(lines.iter().rposition(|&byte| byte == b'\n').map_or(0, |last| last + 1));
        Ok(lines)
    }

    /// A writer that appends rows to the CSV file `name` after truncating it to `bytes` bytes. A new file
    /// starts with the header of `Row`, followed by `extra_columns`.
    ///
    /// # Errors
    /// The file cannot be opened, or is missing or shorter than `bytes`.
    pub fn csv<Row: Serialize + Default>(
        &self,
        name: &str,
        bytes: u64,
        extra_columns: &[String],
    ) -> Result<csv::Writer<File>, RunError> {
        let path = self.path.join(name);
        let open = || -> io::Result<File> {
            let mut file = OpenOptions::new().create(bytes == 0).truncate(false).write(true).open(&path)?;
            if file.metadata()?.len() < bytes {
                return Err(io::Error::other(
                    "rows are missing: the file is shorter than the checkpoint says",
                ));
            }
            file.set_len(bytes)?;
            write_point("CSV: truncated");
            file.seek(SeekFrom::End(0))?;
            if bytes == 0 {
                file.write_all(header::<Row>(extra_columns)?.as_bytes())?;
            }
            Ok(file)
        };
        let file = open().map_err(|error| RunError::invalid_input(&path, error))?;
        Ok(csv::WriterBuilder::new().has_headers(false).from_writer(file))
    }
}

/// The header line of a CSV file with rows of type `Row`, followed by `extra_columns`, including the line break.
///
/// # Errors
/// `Row` cannot be serialized.
pub fn header<Row: Serialize + Default>(extra_columns: &[String]) -> io::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.serialize(Row::default()).map_err(io::Error::other)?;
    let bytes = writer.into_inner().map_err(|error| io::Error::other(error.to_string()))?;
    let line = bytes.split_inclusive(|&byte| byte == b'\n').next().unwrap_or_default();
    let extra: String = extra_columns.iter().map(|column| format!(",{column}")).collect();
    Ok(format!("{}{extra}\n", String::from_utf8_lossy(line).trim_end()))
}
