//! The reader of all RON files of the project, with errors that name file, line, column and fix.
//!
//! In: a path, or a text and the path for messages. Out: any deserializable type, or a [`FileError`]. Size and nesting are
//! limited, and no input causes a panic.

use std::ffi::OsStr;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use ron::Options;
use ron::extensions::Extensions;
use ron::ser::PrettyConfig;
use serde::Serialize;
use serde::de::DeserializeOwned;
use wayfield_ron_patch::SourceMap;

use super::check::{diagnostics, diagnostics_of_known, value_diagnostics, value_diagnostics_of_known};
use super::explain::{closest_name, recover};
use super::file_error::{Diagnostic, FileError, overlap};
use super::limits::{MAX_FILE_BYTES, MAX_NESTING};
use super::read_bytes;
use super::schema::Scenario;
use super::text::{printable_path, without_mark};

/// Folders of the project's own RON files, relative to its root.
const SHIPPED: [&str; 3] = ["scenarios", "assets/presets", "assets/experiments"];

impl Scenario {
    /// Reads and checks the scenario in the file at `path`.
    ///
    /// # Errors
    /// [`FileError`] if the file can't be read, is not a scenario, or has diagnostics; it lists all of them.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&read_text(path)?, path)
    }

    /// Parses and checks the scenario in `text`. Errors name `path`.
    ///
    /// # Errors
    /// As [`Scenario::load`].
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, FileError> {
        parse_checked(text, path, diagnostics_of_known, diagnostics)
    }

    /// Reads the scenario in the file at `path` for editing: checks its numbers, but not whether the parts fit together.
    ///
    /// # Errors
    /// As [`Scenario::load`].
    pub fn load_draft(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse_draft(&read_text(path)?, path)
    }

    /// Parses the scenario in `text` for editing. Errors name `path`.
    ///
    /// # Errors
    /// As [`Scenario::load_draft`].
    pub fn parse_draft(text: &str, path: impl AsRef<Path>) -> Result<Self, FileError> {
        parse_checked(text, path, value_diagnostics_of_known, value_diagnostics)
    }
}

/// Parses a `T` from RON text and checks it with `check`. If ron finds problems, `check_known` looks for more in what could be
/// read. It also gets the paths of the fields that could not be read and have arbitrary values; problems at these paths are
/// left out. Errors name `path`.
///
/// # Errors
/// [`FileError`] with all problems.
pub fn parse_checked<T: DeserializeOwned>(
    text: &str,
    path: impl AsRef<Path>,
    check_known: impl FnOnce(&T, &[String]) -> Vec<Diagnostic>,
    check: impl FnOnce(&T) -> Vec<Diagnostic>,
) -> Result<T, FileError> {
    let path = path.as_ref();
    if text.len() as u64 > MAX_FILE_BYTES {
        return Err(too_large(path, MAX_FILE_BYTES));
    }
    parse_any(text, path, check_known, check)
}

/// As [`parse_checked`], for text of any length.
fn parse_any<T: DeserializeOwned>(
    text: &str,
    path: &Path,
    check_known: impl FnOnce(&T, &[String]) -> Vec<Diagnostic>,
    check: impl FnOnce(&T) -> Vec<Diagnostic>,
) -> Result<T, FileError> {
    let text = without_mark(text);
    if text.trim().is_empty() {
        return Err(FileError::for_file(path, "the file is empty"));
    }
    let read = |text: &str| options().from_str::<T>(text);
    let error = match read(text) {
        Ok(value) => {
            let diagnostics = check(&value);
            let is_valid = diagnostics.is_empty();
            return if is_valid {
                Ok(value)
            } else {
                Err(FileError::from_diagnostics(path, text, &diagnostics))
            };
        }
        Err(error) => error,
    };
    let mut recovered = recover(text, error, read);
    let mut problems = std::mem::take(&mut recovered.problems);
    if let Some(value) = &recovered.value {
        let unknown = &recovered.unknown;
        let mut found = check_known(value, unknown);
        found.retain(|found| !unknown.iter().any(|path| overlap(path, &found.path)));
        let located = |found: &Diagnostic| Some((recovered.offset_of(&found.path)?, found.to_string()));
        problems.extend(found.iter().filter_map(located));
    }
    problems.sort_by_key(|(at, _)| *at);
    Err(FileError::at_offsets(path, text, problems))
}

/// Reads a `T` from the RON file at `path`.
///
/// # Errors
/// [`FileError`] if the file can't be read or is not RON for a `T`.
pub fn read_ron<T: DeserializeOwned>(path: impl AsRef<Path>) -> Result<T, FileError> {
    let path = path.as_ref();
    parse_ron(&read_text(path)?, path)
}

/// Reads a `T` from a RON file of up to `max_bytes` at `path`, for files that the program itself wrote.
///
/// # Errors
/// [`FileError`] if the file can't be read or is not RON for a `T`.
pub fn read_ron_with_limit<T: DeserializeOwned>(
    path: impl AsRef<Path>,
    max_bytes: u64,
) -> Result<T, FileError> {
    let path = path.as_ref();
    parse_any(&read_text_with_limit(path, max_bytes)?, path, none_known, unchecked)
}

/// Parses a `T` from RON text. Errors name `path`.
///
/// # Errors
/// [`FileError`] if `text` is not RON for a `T`.
pub fn parse_ron<T: DeserializeOwned>(text: &str, path: impl AsRef<Path>) -> Result<T, FileError> {
    parse_checked(text, path, none_known, unchecked)
}

/// Parses a `T` from RON text of up to `max_bytes`, for files that the program itself wrote. Errors name `path`.
///
/// # Errors
/// [`FileError`] if `text` is not RON for a `T`.
pub fn parse_ron_with_limit<T: DeserializeOwned>(
    text: &str,
    path: impl AsRef<Path>,
    max_bytes: u64,
) -> Result<T, FileError> {
    let path = path.as_ref();
    if text.len() as u64 > max_bytes {
        return Err(too_large(path, max_bytes));
    }
    parse_any(text, path, none_known, unchecked)
}

fn none_known<T>(_: &T, _: &[String]) -> Vec<Diagnostic> {
    Vec::new()
}

fn unchecked<T>(_: &T) -> Vec<Diagnostic> {
    Vec::new()
}

/// The number of top-level fields in a RON text that are fields of the struct `T`, to guess the kind of the file.
/// [`usize::MAX`] if the text begins with `name` and a bracket.
#[must_use]
pub fn resemblance<T: DeserializeOwned>(text: &str, name: &str) -> usize {
    let text = without_mark(text);
    let map = SourceMap::new(text);
    let body = map.start().map_or("", |start| &text[start..]);
    if body.strip_prefix(name).is_some_and(|rest| rest.trim_start().starts_with('(')) {
        return usize::MAX;
    }
    let known = field_names::<T>();
    map.field_names().filter(|field| known.contains(field)).count()
}

/// The names of the fields of the struct `T`, which must reject unknown fields.
#[must_use]
pub fn field_names<T: DeserializeOwned>() -> &'static [&'static str] {
    match options().from_str::<T>("(no_such_field: 0)").map_err(|error| error.code) {
        Err(ron::Error::NoSuchStructField { expected, .. }) => expected,
        _ => &[],
    }
}

/// `value` as RON text for [`parse_ron`], with one field per line.
///
/// # Errors
/// The error of ron for a type that RON can't represent. The project has no such type.
pub fn to_ron<T: Serialize>(value: &T) -> Result<String, ron::Error> {
    options().to_string_pretty(value, PrettyConfig::new().indentor("    "))
}

/// Reads the text of the file at `path`.
///
/// # Errors
/// [`FileError`] if the file is missing (the message lists those in its folder), unreadable, larger than [`MAX_FILE_BYTES`] or
/// not UTF-8.
pub fn read_text(path: impl AsRef<Path>) -> Result<String, FileError> {
    read_text_with_limit(path, MAX_FILE_BYTES)
}

/// Like [`read_text`], with another size limit, for files that the program itself wrote.
///
/// # Errors
/// As [`read_text`].
pub fn read_text_with_limit(path: impl AsRef<Path>, max_bytes: u64) -> Result<String, FileError> {
    let path = path.as_ref();
    let fail = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => missing(path),
        ErrorKind::IsADirectory => FileError::for_file(
            path,
            format!("this is a folder: name a file in it{}", listing(&ron_files(path))),
        ),
        _ => FileError::for_file(path, format!("can't be read: {error}")),
    };
    let bytes = read_bytes(path, max_bytes + 1).map_err(fail)?;
    if bytes.len() as u64 > max_bytes {
        return Err(too_large(path, max_bytes));
    }
    decoded(bytes, path)
}

/// Decodes the `bytes` of the file at `path` as text.
fn decoded(bytes: Vec<u8>, path: &Path) -> Result<String, FileError> {
    const UTF_16: &str = "the text is encoded as UTF-16: save the file as UTF-8";
    if matches!(
        bytes.as_slice(),
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] | [0, 1..=255, ..] | [1..=255, 0, 1..=255, 0, ..]
    ) {
        return Err(FileError::for_file(path, UTF_16));
    }
    if bytes.contains(&0) {
        return Err(FileError::for_file(
            path,
            "this is not a text file: it contains NUL bytes; give a RON file",
        ));
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(&error.as_bytes()[..good]);
        let text = without_mark(&text);
        let message = "the text is not valid UTF-8 from here on: save the file as UTF-8";
        FileError::at_offset(path, text, text.len(), message)
    })
}

fn options() -> Options {
    let extensions =
        Extensions::IMPLICIT_SOME | Extensions::UNWRAP_NEWTYPES | Extensions::UNWRAP_VARIANT_NEWTYPES;
    Options::default().with_default_extension(extensions).with_recursion_limit(MAX_NESTING)
}

fn too_large(path: &Path, max_bytes: u64) -> FileError {
    let most = max_bytes >> 20;
    FileError::for_file(path, format!("larger than {most} MiB, the limit for this kind of file"))
}

/// The error for a missing file. It lists the RON files of its folder, or else the shipped ones, and suggests the closest name.
fn missing(path: &Path) -> FileError {
    if let Ok(target) = std::fs::read_link(path) {
        let target = printable_path(&target);
        return FileError::for_file(path, format!("this link points to `{target}`, which does not exist"));
    }
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut there = ron_files(folder);
    if there.is_empty() {
        there = SHIPPED.iter().flat_map(|folder| ron_files(Path::new(folder))).collect();
    }
    let name = path.file_stem().and_then(OsStr::to_str).unwrap_or_default();
    let names = there.iter().filter_map(|file| file.file_stem()?.to_str());
    let near = closest_name(name, names)
        .and_then(|near| there.iter().find(|file| file.file_stem() == Some(near.as_ref())));
    let hint = near.map(|file| format!(": did you mean `{}`?", printable_path(file))).unwrap_or_default();
    FileError::for_file(path, format!("no such file{hint}{}", listing(&there)))
}

/// The RON files of a folder that are not hidden, sorted by name. Empty if the folder can't be read.
fn ron_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let shown = entries.filter(|entry| !entry.file_name().as_encoded_bytes().starts_with(b"."));
    let mut files: Vec<_> =
        shown.map(|entry| entry.path()).filter(|p| p.extension() == Some("ron".as_ref())).collect();
    files.sort();
    files
}

/// The text " (files there: ...)" with up to twelve of `files`.
fn listing(files: &[PathBuf]) -> String {
    let names: Vec<_> = files.iter().take(12).map(|file| printable_path(file)).collect();
    match files.len() {
        0 => String::new(),
        n if n > 12 => format!(" (files there: {} and {} more)", names.join(", "), n - 12),
        _ => format!(" (files there: {})", names.join(", ")),
    }
}
