//! Cutting event files back to a checkpoint.

use std::fs::{self, File};
use std::io::{self, BufReader};
use std::path::Path;

use super::event::{self, FRAME_BYTES};
use super::files;
use crate::run::write_points::write_point;

/// Cuts each event file in `dir` back at the first point for which `is_kept(tag, step)` is false, or at the first damaged
/// record. A file without remaining points is deleted. Returns the latest wall time of the points that remain, in s since 1970;
/// 0 if there are none.
///
/// # Errors
/// A file cannot be read or written. The message names it.
pub fn cut_back(dir: &Path, is_kept: impl Fn(&str, u64) -> bool) -> io::Result<f64> {
    let mut latest_s = 0.0_f64;
    for path in files(dir) {
        let file_latest_s = cut_file(&path, &is_kept)
            .map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", path.display())))?;
        latest_s = latest_s.max(file_latest_s);
    }
    Ok(latest_s)
}

/// Cuts one file back, and returns the latest wall time of its points.
fn cut_file(path: &Path, is_kept: impl Fn(&str, u64) -> bool) -> io::Result<f64> {
    let mut file = BufReader::new(File::options().read(true).write(true).open(path)?);
    let (mut kept_bytes, mut latest_s) = (0, None);
    while let Some(event) = event::read(&mut file)? {
        match event::point(&event) {
            Some(point) if !is_kept(point.tag, point.step) => break,
            Some(point) => latest_s = Some(latest_s.unwrap_or(0.0_f64).max(point.wall_s)),
            None => {}
        }
        kept_bytes += FRAME_BYTES + event.len() as u64;
    }
    if latest_s.is_none() {
        fs::remove_file(path)?;
    } else if file.get_ref().metadata()?.len() > kept_bytes {
        file.get_ref().set_len(kept_bytes)?;
    }
    write_point("events: cut back");
    Ok(latest_s.unwrap_or_default())
}
