//! The files of a report: a page in two formats, and each figure and table in two formats.
//!
//! An earlier report is replaced only when all files of the new one are complete.

use std::ffi::OsStr;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::report::page::{Item, Page};
use crate::report::raster;
use crate::run::RunError;
use crate::run::output_file::{StagedFile, check_entry, remove_temporary_files};

/// PNG pixels per SVG pixel.
const PNG_SCALE: f32 = 2.0;

/// The files of the page.
const PAGES: [&str; 2] = ["README.md", "report.html"];
/// The folders of the figures and of the tables.
const FIGURES: &str = "figures";
const TABLES: &str = "tables";
/// The extensions of the two files of a figure, and of a table.
const FIGURE: [&str; 2] = ["svg", "png"];
const TABLE: [&str; 2] = ["csv", "md"];

/// Checks that [`write`] can replace the report in `folder`, and deletes the temporary files of a killed process.
///
/// # Errors
/// A file of the report is read-only, or something else has its name.
pub fn prepare(folder: &Path) -> Result<(), RunError> {
    remove_temporary_files(folder);
    for sub in [folder.join(FIGURES), folder.join(TABLES)] {
        // A link is refused, because outdated files in its target would be deleted.
        if fs::symlink_metadata(&sub).is_ok_and(|found| !found.is_dir()) {
            let why = "is not a folder, but must be one; help: move it, or choose another folder";
            return Err(RunError::invalid_input(&sub, why));
        }
        remove_temporary_files(&sub);
    }
    for path in PAGES.iter().map(|name| folder.join(name)).chain(figures_and_tables(folder)) {
        check_entry(&path).map_err(|error| RunError::not_writable(&path, error))?;
    }
    Ok(())
}

/// Writes the report `page` to `folder`, and deletes the figures and tables that only an earlier report had. A user's own files
/// stay.
///
/// # Errors
/// A figure cannot be drawn, or a file cannot be written. An earlier report is then unchanged, unless the failure was in the
/// last step, in which the complete new files replace the earlier ones.
pub fn write(folder: &Path, page: &Page) -> Result<(), RunError> {
    for sub in [folder.join(FIGURES), folder.join(TABLES)] {
        fs::create_dir_all(&sub).map_err(|error| RunError::not_written(&sub, error))?;
    }
    let mut files = Vec::new();
    for item in page.sections.iter().flat_map(|section| &section.items) {
        stage_item(folder, item, &mut files)?;
    }
    let [markdown, html] = PAGES.map(|name| folder.join(name));
    stage(markdown, page.to_markdown().as_bytes(), &mut files)?;
    stage(html, page.to_html().as_bytes(), &mut files)?;
    let mut written = Vec::new();
    for (path, file) in files {
        file.persist().map_err(|error| RunError::not_written(&path, error))?;
        written.push(path);
    }
    // All pairs are found before any file is deleted. A single file is a user's own.
    let paired = |path: &PathBuf| {
        let has_all = |extensions: [&str; 2]| extensions.iter().all(|end| path.with_extension(end).is_file());
        has_all(FIGURE) || has_all(TABLE)
    };
    let earlier: Vec<PathBuf> = figures_and_tables(folder).filter(paired).collect();
    for outdated in earlier.iter().filter(|path| !written.contains(path)) {
        // A file that cannot be deleted does no harm: the page does not show it.
        let _ = fs::remove_file(outdated);
    }
    Ok(())
}

fn stage_item(folder: &Path, item: &Item, files: &mut Vec<(PathBuf, StagedFile)>) -> Result<(), RunError> {
    let path = |sub: &str, name: &str, extension: &str| folder.join(sub).join(format!("{name}.{extension}"));
    match item {
        Item::Figure { name, svg, .. } => {
            let png = raster::png(svg, PNG_SCALE)
                .map_err(|error| RunError::Failed(format!("figure {name}: {error}")))?;
            stage(path(FIGURES, name, "svg"), svg.as_bytes(), files)?;
            stage(path(FIGURES, name, "png"), &png, files)
        }
        Item::Table { table, .. } => {
            stage(path(TABLES, &table.name, "csv"), table.to_csv().as_bytes(), files)?;
            stage(path(TABLES, &table.name, "md"), table.to_markdown().as_bytes(), files)
        }
        Item::Text(_) => Ok(()),
    }
}

/// Writes a temporary file that is to replace `path`, and adds it to `files`.
fn stage(path: PathBuf, bytes: &[u8], files: &mut Vec<(PathBuf, StagedFile)>) -> Result<(), RunError> {
    let file = StagedFile::write(&path, |file| file.write_all(bytes));
    let file = file.map_err(|error| RunError::not_written(&path, error))?;
    files.push((path, file));
    Ok(())
}

/// The files in the folder of a report whose names are those of a report's figures and tables.
fn figures_and_tables(folder: &Path) -> impl Iterator<Item = PathBuf> {
    let folders = [(folder.join(FIGURES), FIGURE), (folder.join(TABLES), TABLE)];
    folders.into_iter().flat_map(|(folder, extensions)| {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).filter(move |path| is_of_report(path, extensions))
    })
}

/// Whether a report can have written a file with this name: `a-z`, `0-9` and `-`, as in the names of an experiment's figures and
/// tables, and one of the extensions.
fn is_of_report(path: &Path, extensions: [&str; 2]) -> bool {
    let fits = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    let text = |part: Option<&OsStr>| part.and_then(OsStr::to_str).unwrap_or_default().to_owned();
    text(path.file_stem()).chars().all(fits) && extensions.contains(&text(path.extension()).as_str())
}
