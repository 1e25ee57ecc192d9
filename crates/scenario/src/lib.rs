//! Scenarios: RON schema, loader, checks, geometry, obstacle motions, placement of starts and goals, and writer.
//!
//! In: a scenario file (`scenarios/*.ron`). Out: a checked [`Scenario`], the poses of its obstacles at any step
//! ([`pose_at`]), and random starts and goals that are clear of them ([`draw_start`], [`draw_goal`]). [`read_ron`] reads
//! all other RON files of the project, so that all errors have the same form. Points are [`Vec2`]s of glam, in m.
//!
//! ```
//! use wayfield_scenario::{Scenario, clearance, draw_start, pose_at};
//!
//! let text = r#"(
//!     name: "One moving post",
//!     obstacles: [(
//!         shape: Circle(radius_m: 0.2),
//!         position_m: (1.0, 0.0),
//!         motion: Orbit(centre_m: (0.0, 0.0), speed_rad_s: 0.5),
//!     )],
//! )"#;
//! let scenario = Scenario::parse(text, "post.ron").map_err(|error| error.to_string())?;
//! // After 10 control steps of 0.2 s, the post has moved on by 1 rad.
//! let (x, y, _) = pose_at(&scenario.obstacles[0], 10, scenario.task.control_period_s);
//! assert!((x - 1_f32.cos()).abs() < 1e-5 && (y - 1_f32.sin()).abs() < 1e-5);
//! // A start that is clear of the post at that time.
//! let mut stream = wayfield_random::stream(7, "starts", 0);
//! let start = draw_start(&scenario, 10, &mut stream).map_err(|error| error.to_string())?;
//! assert!(clearance(&scenario, glam::vec2(start.0, start.1), 10) > scenario.keep_out_m());
//! # Ok::<(), String>(())
//! ```

mod check;
mod crowd;
mod drive;
mod explain;
mod fields;
mod file_error;
mod footprint;
mod free_cells;
mod generate;
mod geodesic;
mod geometry;
#[cfg(not(target_arch = "wasm32"))]
mod input;
mod key_frames;
mod levels;
pub mod limits;
mod load;
mod motion;
mod motion_fields;
mod nearest_points;
mod note;
mod odometry;
mod outline;
mod placement;
mod placement_rule;
pub mod polygon;
mod ranged;
mod schema;
mod set;
mod setting;
mod shape;
mod shape_fields;
mod spatial_index;
mod steering;
mod suite;
mod text;
mod text_rows;
mod track;
mod uniform_grid;
#[cfg(target_arch = "wasm32")]
pub mod virtual_files;
mod wall_cells;
mod waypoints;
mod write;

pub use check::{convex_distance, diagnostics, diagnostics_of_known, notes, value_diagnostics};
pub use crowd::{Crowd, Pedestrian};
pub use drive::Drive;
pub use explain::with_plain_numbers;
pub use explain::{choose, closest_name, whole_number};
pub use fields::{Field, FieldValue, Quantity};
pub use file_error::{Diagnostic, FileError, LocatedDiagnostic, has_field, locate, overlap, utf8_path};
pub use free_cells::FreeCells;
pub use geodesic::Geodesic;
pub use geometry::{Solid, clearance, enclosure_distance, inner_wall_distance, nearest, shape_distance};
pub use glam::{Vec2, vec2};
#[cfg(not(target_arch = "wasm32"))]
pub use input::{is_file, is_special_file, path_exists, read_bytes};
pub use levels::{
    Clutter, LevelError, LevelGenerator, Route, Traffic, WallLayout, level_generator_diagnostics,
};
pub use limits::MAX_FILE_BYTES;
pub use load::{
    field_names, parse_checked, parse_ron, parse_ron_with_limit, read_ron, read_ron_with_limit, read_text,
    read_text_with_limit, resemblance, to_ron,
};
pub use motion::pose_at;
pub use motion_fields::MotionKind;
pub use nearest_points::nearest_points;
pub use note::{Note, NoteLevel};
pub use outline::Outline;
pub use placement::{NoFreeSpace, draw_goal, draw_start, draw_start_and_goal};
pub use ranged::{RangeNumber, Ranged};
pub use schema::*;
pub use set::{ScenarioSet, ScenarioSetFile, SetEntry, SetFit, SetMember, SetSource, column_name};
pub use setting::with_setting;
pub use shape::RoundedBox;
pub use shape_fields::Sizes;
pub use spatial_index::{IndexedScenario, SpatialIndex};
pub use suite::{
    DEFAULT_SUITE_EPISODES, DEFAULT_SUITE_LEVELS, FIRST_EVALUATION_LEVEL, SuiteFamily, SuiteFile, SuiteScore,
};
pub use text::{is_noncharacter, is_unprintable, printable, printable_lines, printable_path, quoted};
pub use track::{MotionSpeed, Track};
pub use uniform_grid::UniformGrid;
#[cfg(target_arch = "wasm32")]
pub use virtual_files::{contains as is_file, contains as path_exists, is_special_file, read as read_bytes};
pub use wayfield_ron_patch::overlay;
pub use write::to_text;
