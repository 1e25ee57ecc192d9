//! The report's folder: opening it, the files of the report, and the time spent on it.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::report::page::{Item, Page};
use crate::report::raster;
use crate::run::RunError;

/// PNG pixels per SVG pixel.
const PNG_SCALE: f32 = 2.0;

/// The file with the wall time spent. It also marks the folder as a report folder.
const SPENT: &str = "spent.json";

/// The time spent on a report so far, as stored in `spent.json`.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Spent {
    /// Wall time of all processes, in s.
    wall_s: f64,
}

/// Creates the folder, or continues one that an earlier reproduction created. Returns the wall time spent on it
/// before, in s.
pub fn open(folder: &Path) -> Result<f64, RunError> {
    let file = folder.join(SPENT);
    let foreign = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) && !file.exists();
    if foreign {
        let why = "is not empty and holds no reproduction; help: choose another folder with --out";
        return Err(RunError::invalid_input(folder, why));
    }
    let unwritable = |error: std::io::Error| {
        let why = format!("cannot be written ({error}); help: choose another folder with --out");
        RunError::invalid_input(folder, why)
    };
    fs::create_dir_all(folder.join("runs")).map_err(unwritable)?;
    let text = fs::read_to_string(&file).unwrap_or_default();
    let spent: Spent = serde_json::from_str(&text).unwrap_or_default();
    fs::write(&file, json(spent)?).map_err(unwritable)?;
    Ok(spent.wall_s)
}

/// Writes the wall time spent: `before` this process, and since it `began`. Returns the sum, in s.
pub fn record_time(folder: &Path, before_s: f64, began: Instant) -> Result<f64, RunError> {
    let wall_s = before_s + began.elapsed().as_secs_f64();
    write_file(&folder.join(SPENT), json(Spent { wall_s })?.as_bytes())?;
    Ok(wall_s)
}

/// Writes the report: the page, and a file for each figure and table in each format.
pub fn write(folder: &Path, page: &Page) -> Result<(), RunError> {
    let (figures, tables) = (folder.join("figures"), folder.join("tables"));
    for sub in [&figures, &tables] {
        // Figures and tables of an earlier report would be misleading.
        let _ = fs::remove_dir_all(sub);
        fs::create_dir_all(sub).map_err(|error| RunError::failed(sub, error))?;
    }
    for item in page.sections.iter().flat_map(|section| &section.items) {
        write_item(item, &figures, &tables)?;
    }
    write_file(&folder.join("README.md"), page.to_markdown().as_bytes())?;
    write_file(&folder.join("report.html"), page.to_html().as_bytes())
}

fn write_item(item: &Item, figures: &Path, tables: &Path) -> Result<(), RunError> {
    let named = |folder: &Path, name: &str, extension: &str| -> PathBuf {
        folder.join(format!("{name}.{extension}"))
    };
    match item {
        Item::Figure { name, svg, .. } => {
            let png = raster::png(svg, PNG_SCALE)
                .map_err(|error| RunError::Failed(format!("figure {name}: {error}")))?;
            write_file(&named(figures, name, "svg"), svg.as_bytes())?;
            write_file(&named(figures, name, "png"), &png)
        }
        Item::Table { table, .. } => {
            write_file(&named(tables, &table.name, "csv"), table.to_csv().as_bytes())?;
            write_file(&named(tables, &table.name, "md"), table.to_markdown().as_bytes())
        }
        Item::Text(_) => Ok(()),
    }
}

fn write_file(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    fs::write(path, bytes).map_err(|error| RunError::failed(path, error))
}

fn json(spent: Spent) -> Result<String, RunError> {
    serde_json::to_string(&spent).map_err(|error| RunError::Failed(error.to_string()))
}
