//! The import of a map: an image whose free pixels become floor.

use std::path::Path;

use glam::{DVec2, dvec2};
use wayfield_scenario::{FileError, Scenario, is_file, is_special_file, printable, read_text};

use crate::Imported;
use crate::draft::{self, Source};
use crate::findings::Findings;
use crate::floor::Floor;
use crate::frame::Frame;
use crate::grid::Grid;
use crate::limits::RESOLUTION_M;
use crate::map_file::{MapFile, PixelReading};
use crate::options::ImportOptions;
use crate::pixels::{self, Pixels};
use crate::rectangles::rectangles;
use crate::trace::{Scale, THICKNESS_M, surroundings};

/// A map with its scale and pose.
pub struct Map {
    /// The pixels.
    pub pixels: Pixels,
    /// How to read them.
    pub reading: PixelReading,
    /// Side of a pixel in m.
    pub cell_m: f64,
    /// Pose of the lower left corner in the map's frame: x and y in m, yaw in rad.
    pub origin: [f64; 3],
}

/// The cells of a map that are not free.
#[derive(Clone, Debug, PartialEq)]
pub struct Backdrop {
    /// A few rectangles that cover the cells: the corners of each, counterclockwise, in m in the source's frame.
    pub areas_m: Vec<[DVec2; 4]>,
}

impl Map {
    /// Reads the `map_server` map whose description is at `path`.
    ///
    /// # Errors
    /// The description or its image is missing or invalid.
    pub fn read_yaml(path: &Path) -> Result<Self, FileError> {
        let text = read_text(path)?;
        let file = MapFile::parse(&text, path)?;
        let image = path.parent().unwrap_or(Path::new("")).join(&file.image);
        if !is_file(&image) && !is_special_file(&image) {
            let message = format!(
                "there is no image `{}`; help: put it there, or name another file in `image`",
                printable(&file.image)
            );
            return Err(FileError::at_offset(path, &text, file.image_at, message));
        }
        let pixels = pixels::read(&image)?;
        Ok(Self { pixels, reading: file.reading, cell_m: file.resolution_m, origin: file.origin })
    }

    /// The map with this description and this image. Errors name `path`.
    ///
    /// # Errors
    /// The description or the image is invalid.
    pub fn from_parts(yaml: &str, image: &[u8], path: &Path) -> Result<Self, FileError> {
        let file = MapFile::parse(yaml, path)?;
        let pixels = pixels::decode(image).map_err(|message| FileError::for_file(path, message))?;
        Ok(Self { pixels, reading: file.reading, cell_m: file.resolution_m, origin: file.origin })
    }

    /// Reads the plain image at `path`, with dark walls and pixels of `resolution_m`. The source's frame has its origin in the
    /// lower left corner.
    ///
    /// # Errors
    /// The image or the resolution is missing or invalid.
    pub fn read_image(path: &Path, resolution_m: Option<f64>) -> Result<Self, FileError> {
        let cell_m = scale(path, resolution_m)?;
        Ok(Self::from_image(pixels::read(path)?, cell_m))
    }

    /// Like [`Map::read_image`], with the bytes of the image.
    ///
    /// # Errors
    /// The image is invalid, or the resolution is missing or invalid.
    pub fn parse_image(bytes: &[u8], path: &Path, resolution_m: Option<f64>) -> Result<Self, FileError> {
        let cell_m = scale(path, resolution_m)?;
        let pixels = pixels::decode(bytes).map_err(|message| FileError::for_file(path, message))?;
        Ok(Self::from_image(pixels, cell_m))
    }

    fn from_image(pixels: Pixels, cell_m: f64) -> Self {
        Self { pixels, reading: PixelReading::IMAGE, cell_m, origin: [0.0; 3] }
    }

    /// The cells that are free.
    pub fn free(&self) -> Grid<bool> {
        self.pixels.map(|pixel| pixel.is_some_and(|brightness| self.reading.is_free(brightness)))
    }

    /// The cells that are not free.
    pub fn backdrop(&self) -> Backdrop {
        let frame = self.frame(DVec2::ZERO);
        let corner =
            |column: usize, row: usize| frame.to_source(dvec2(column as f64, row as f64) * self.cell_m);
        let area = |((left, low), (right, high))| {
            [corner(left, low), corner(right, low), corner(right, high), corner(left, high)]
        };
        let blocked = self.free().map(|is_free| !is_free);
        Backdrop { areas_m: rectangles(&blocked).into_iter().map(area).collect() }
    }

    /// The frame of a scenario whose (0, 0) is at `centre`, in pixels from the lower left corner of the image.
    fn frame(&self, centre: DVec2) -> Frame {
        let [x, y, yaw_rad] = self.origin;
        let corner = Frame { origin_m: dvec2(x, y), yaw_rad };
        Frame { origin_m: corner.to_source(centre * self.cell_m), yaw_rad }
    }

    /// Converts the map to a scenario.
    ///
    /// # Errors
    /// The robot fits nowhere, or the scenario would be invalid or too large.
    pub fn import(&self, path: &Path, options: &ImportOptions) -> Result<Imported, FileError> {
        let fail = |message: String| FileError::for_file(path, message);
        let base = options.robot_from.clone().unwrap_or_default();
        let (free, dropped) = without_specks(self.free(), options.speck_cells);
        let margins = draft::margins(&base, self.cell_m);
        let floor = Floor::new(&free, margins, free.corners()).ok_or_else(|| fail(self.no_floor(&base)))?;
        let Some(((left, low), (right, high))) = floor.cells.bounds() else {
            return Err(fail(self.no_floor(&base)));
        };
        let size = dvec2((right - left) as f64, (high - low) as f64);
        let centre = dvec2(left as f64, low as f64) + size / 2.0;
        let scale = Scale { cell_m: self.cell_m, centre };
        let asked_m = options.tolerance_m.unwrap_or(self.cell_m + THICKNESS_M / 2.0);
        let clearance_m = floor.clearance * self.cell_m;
        let mut problem = String::new();
        // Simplified walls may close a gap. Then smaller tolerances are tried, and finally the cells themselves.
        // With a tolerance below half a wall's thickness, the walls are the cells already.
        let attempts = if asked_m < THICKNESS_M / 2.0 { 1 } else { 4 };
        for tolerance_m in [asked_m, asked_m / 2.0, asked_m / 4.0, 0.0].into_iter().take(attempts) {
            let checked = surroundings(&floor.cells, scale, tolerance_m, clearance_m).and_then(|found| {
                let about = self.about(found.deviation_m, dropped);
                let source = Source { file: file_name(path), about, frame: self.frame(centre) };
                let scenario = draft::scenario(&base, &source, size * self.cell_m, &floor, scale, &found);
                draft::check(&scenario).map(|()| (scenario, found.deviation_m))
            });
            match checked {
                Ok((scenario, deviation_m)) => {
                    let mut findings = Findings::default();
                    if tolerance_m < asked_m {
                        let than = if options.tolerance_m.is_some() { "requested" } else { "by default" };
                        let what = format!(
                            "a gap would have closed, so the walls follow the map more closely than {than}"
                        );
                        findings.add(&what, &format!("{tolerance_m} m"));
                    }
                    let findings = findings.lines();
                    return Ok(Imported { scenario, deviation_m, path_length_m: None, findings });
                }
                Err(message) if problem.is_empty() => problem = message,
                Err(_) => {}
            }
        }
        Err(fail(format!("{problem}; help: try a larger --tolerance, --specks, or another robot (--robot)")))
    }

    fn no_floor(&self, base: &Scenario) -> String {
        format!(
            "the robot fits nowhere on this map: it needs more than {:.3} m of free cells to each side; help: check \
             the resolution, the thresholds and `negate`, or use a smaller robot (--robot)",
            draft::needed_m(base)
        )
    }

    fn about(&self, deviation_m: f64, dropped: usize) -> String {
        let specks = match dropped {
            0 => String::new(),
            1 => " 1 speck became floor.".into(),
            n => format!(" {n} specks became floor."),
        };
        format!(
            "{} x {} cells of {} m; walls deviate from them by at most {:.3} m.{specks}",
            self.pixels.columns, self.pixels.rows, self.cell_m, deviation_m
        )
    }
}

/// The side of a pixel of the image at `path`, in m: `resolution_m`, which must be given.
fn scale(path: &Path, resolution_m: Option<f64>) -> Result<f64, FileError> {
    resolution_m.filter(|side| RESOLUTION_M.contains(side)).ok_or_else(|| {
        let message = "an image has no scale; help: give the side of a pixel in m, such as --resolution 0.05";
        FileError::for_file(path, message)
    })
}

/// `free` together with the specks (connected groups of at most `max_cells` blocked cells), and the number of specks.
fn without_specks(free: Grid<bool>, max_cells: usize) -> (Grid<bool>, usize) {
    if max_cells == 0 {
        return (free, 0);
    }
    let blocked = free.map(|is_free| !is_free);
    let (labels, sizes) = blocked.components();
    let is_speck = |label: u32| sizes.get(label as usize).is_some_and(|&size| size <= max_cells);
    let mut cleaned = free;
    blocked.members().filter(|&cell| is_speck(labels.at(cell))).for_each(|cell| cleaned.set(cell, true));
    (cleaned, sizes.iter().filter(|&&size| size <= max_cells).count())
}

/// The name of a file without its folder.
pub fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}
