//! Scenarios from other people's worlds: maps of ROS's `map_server`, plain images, Gazebo's SDF worlds, BARN, and
//! the stages of turtlebot3_drlnav.
//!
//! In: a file. Out: a valid scenario that can be edited, trained in and drawn over its source, and a list of what could not be
//! represented. No input causes a panic, and no small file asks for much memory ([`limits`]).
//!
//! | file | purpose |
//! |---|---|
//! | `options.rs` | the options of an import |
//! | `map_file.rs`, `pixels.rs`, `pnm.rs` | the description of a map; the pixels of its image |
//! | `map.rs` | the import of a map or an image |
//! | `sdf/` | the solids of an SDF world |
//! | `world.rs`, `solid.rs` | the import of a world of solids |
//! | `json.rs` | files with many BARN worlds or stages |
//! | `barn.rs`, `npy.rs` | BARN worlds, with start, goal and path |
//! | `stages.rs` | the stages of turtlebot3_drlnav, with cylinders that move |
//! | `floor.rs` | the part of a map that the robot can reach |
//! | `trace.rs`, `contour.rs`, `rectangles.rs` | walls and obstacles around that part |
//! | `draft.rs`, `frame.rs` | the scenario around them: starts, goals, time limit, description, position in the source |
//! | `findings.rs` | what could not be represented |
//! | `grid.rs` | cells, their connected parts, and distances |
//! | `round.rs` | rounding to tenths of a millimetre |
//!
//! ```no_run
//! use wayfield_import::{ImportOptions, import};
//!
//! let imported = import("map.yaml".as_ref(), &ImportOptions::default())?;
//! imported.findings.iter().for_each(|line| eprintln!("note: {line}"));
//! std::fs::write("room.ron", imported.text())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod barn;
mod contour;
mod draft;
mod findings;
mod floor;
mod frame;
mod grid;
mod json;
pub mod limits;
mod map;
mod map_file;
mod npy;
mod options;
mod pixels;
mod pnm;
mod rectangles;
mod round;
mod sdf;
mod solid;
mod stages;
mod trace;
mod world;

use std::path::Path;

use wayfield_scenario::{FileError, Scenario, to_text};

pub use barn::stated_path_length_m;
pub use frame::Frame;
pub use map::Backdrop;
pub use options::ImportOptions;

/// An imported scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The scenario. It is valid.
    pub scenario: Scenario,
    /// The largest distance, in m, between a wall and the map cells that it replaces. 0 for shapes that were imported exactly.
    pub deviation_m: f64,
    /// The length in m of a shortest path from start to goal, if the source states it, as BARN does.
    pub path_length_m: Option<f64>,
    /// What could not be represented, a line for each kind of thing.
    pub findings: Vec<String>,
}

impl Imported {
    /// The scenario as the text of a RON file, which begins with the findings as comments.
    #[must_use]
    pub fn text(&self) -> String {
        let comments: String =
            self.findings.iter().map(|line| format!("// Not imported: {line}.\n")).collect();
        comments + &to_text(&self.scenario, None)
    }
}

/// The scenario in the file at `path`: a map (`.yaml`, `.yml`), an image (`.png`, `.pgm`, `.pnm`, `.ppm`, `.pbm`), a Gazebo world
/// or model (`.world`, `.sdf`), or one BARN world or stage in a `.json` file.
///
/// # Errors
/// The file or one that it names is missing, invalid or too large; or there is no valid scenario in it. The message names the
/// file, the line and a fix.
pub fn import(path: &Path, options: &ImportOptions) -> Result<Imported, FileError> {
    options.check(path)?;
    match kind(path) {
        Some(Kind::Map) => map::Map::read_yaml(path)?.import(path, options),
        Some(Kind::Image) => map::Map::read_image(path, options.resolution_m)?.import(path, options),
        Some(Kind::Sdf) => import_sdf(path, options),
        Some(Kind::Worlds) if options.world.is_none() => {
            let message =
                "it holds many worlds; help: choose one with --world N, or name a folder with --out";
            Err(FileError::for_file(path, message))
        }
        Some(Kind::Worlds) => Ok(json::import_file(path, options)?.swap_remove(0).1),
        None => Err(FileError::for_file(
            path,
            "not a kind of file that can be imported; help: give a map (.yaml), an image (.png, .pgm), a world (.world, .sdf) \
             or BARN worlds or stages (.json)",
        )),
    }
}

/// The scenario in `bytes`: an image, an SDF world, or a file of worlds, as the extension of `path` says. Of a file of worlds
/// without `options.world`, all are imported and the first is returned. Messages name `path`. Models that a world includes are
/// read from files.
///
/// # Errors
/// As for [`import`].
pub fn import_bytes(path: &Path, bytes: &[u8], options: &ImportOptions) -> Result<Imported, FileError> {
    options.check(path)?;
    let text = || std::str::from_utf8(bytes).map_err(|_| FileError::for_file(path, "the text is not UTF-8"));
    match kind(path) {
        Some(Kind::Image) => map::Map::parse_image(bytes, path, options.resolution_m)?.import(path, options),
        Some(Kind::Sdf) => import_solids(path, &sdf::SdfWorld::parse(text()?, path, options)?, options),
        Some(Kind::Worlds) => Ok(json::import_text(text()?, path, options)?.swap_remove(0).1),
        _ => Err(FileError::for_file(path, "not a kind of file that can be imported from memory")),
    }
}

/// The scenario of a `map_server` map, from the text of its YAML file and the bytes of its image. Errors name `path`.
///
/// # Errors
/// As for [`import`].
pub fn import_map(
    yaml: &str,
    image: &[u8],
    path: &Path,
    options: &ImportOptions,
) -> Result<Imported, FileError> {
    options.check(path)?;
    map::Map::from_parts(yaml, image, path)?.import(path, options)
}

/// The scenario whose robot, LIDAR and rules the import of the file at `path` uses without [`ImportOptions::robot_from`].
///
/// # Errors
/// A `.json` file is missing or invalid. The message names the file, the line and a fix.
pub fn implied_robot(path: &Path) -> Result<Scenario, FileError> {
    match kind(path) {
        Some(Kind::Worlds) => json::implied_robot(path),
        Some(Kind::Sdf) if barn::path_file(path).is_some() => Ok(barn::robot()),
        _ => Ok(Scenario::default()),
    }
}

/// The length, in m, of the path from start to goal in `bytes`, the contents of a BARN path file.
///
/// # Errors
/// The bytes are not a path. Errors name `path`.
pub fn barn_path_length_m(bytes: &[u8], path: &Path) -> Result<f64, FileError> {
    barn::path_length_m(bytes, path)
}

/// The scenarios of all BARN worlds or stages in the `.json` file at `path`, each with a name for its file.
///
/// # Errors
/// As for [`import`].
pub fn import_worlds(path: &Path, options: &ImportOptions) -> Result<Vec<(String, Imported)>, FileError> {
    options.check(path)?;
    json::import_file(path, options)
}

/// The backdrop over which to draw a scenario that was imported from the map or image at `path`.
///
/// # Errors
/// As for [`import`].
pub fn backdrop(path: &Path, options: &ImportOptions) -> Result<Backdrop, FileError> {
    options.check(path)?;
    match kind(path) {
        Some(Kind::Map) => Ok(map::Map::read_yaml(path)?.backdrop()),
        Some(Kind::Image) => Ok(map::Map::read_image(path, options.resolution_m)?.backdrop()),
        _ => Err(FileError::for_file(path, "not a map; help: give a map (.yaml) or an image (.png, .pgm)")),
    }
}

fn import_sdf(path: &Path, options: &ImportOptions) -> Result<Imported, FileError> {
    let world = sdf::SdfWorld::read(path, options)?;
    if let Some(file) = barn::path_file(path) {
        return barn::import_world(path, &file, &world.solids, &world.findings, options);
    }
    import_solids(path, &world, options)
}

fn import_solids(path: &Path, world: &sdf::SdfWorld, options: &ImportOptions) -> Result<Imported, FileError> {
    let base = options.robot_from.clone().unwrap_or_default();
    let (count, height_m) = (world.solids.len(), options.lidar_height_m);
    let about = format!("{count} shapes, cut {height_m} m above the ground.");
    let (solids, findings) = (&world.solids, &world.findings);
    let world = world::World { label: map::file_name(path), about, solids, moving: &[], findings };
    world.import(&base).map_err(|message| FileError::for_file(path, message))
}

/// A kind of file.
enum Kind {
    Map,
    Image,
    Sdf,
    Worlds,
}

/// Whether the extension of `path` is that of a ROS map or a Gazebo world, which state their own scale.
#[must_use]
pub fn is_map_or_world(path: &Path) -> bool {
    matches!(kind(path), Some(Kind::Map | Kind::Sdf))
}

/// Whether the extension of `path` is that of an image, which does not state its scale.
#[must_use]
pub fn is_image(path: &Path) -> bool {
    matches!(kind(path), Some(Kind::Image))
}

/// Whether the extension of `path` is that of a file of BARN worlds or stages, which may hold several.
#[must_use]
pub fn is_file_of_worlds(path: &Path) -> bool {
    matches!(kind(path), Some(Kind::Worlds))
}

/// The kind that the extension names.
fn kind(path: &Path) -> Option<Kind> {
    let extension = path.extension()?.to_string_lossy().to_ascii_lowercase();
    match extension.as_str() {
        "yaml" | "yml" => Some(Kind::Map),
        "png" | "pgm" | "pnm" | "ppm" | "pbm" => Some(Kind::Image),
        "world" | "sdf" => Some(Kind::Sdf),
        "json" => Some(Kind::Worlds),
        _ => None,
    }
}
