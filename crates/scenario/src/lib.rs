//! What a world is: its schema in RON, its checks, its loader. Spawns nothing, knows no Bevy.
//!
//! In: a scenario file (`scenarios/*.ron`). Out: a checked [`Scenario`], the pose of its obstacles at any
//! step ([`pose_at`]), and random starts and targets that are clear of them ([`draw_start`],
//! [`draw_target`]). [`read_ron`] also serves every other RON file of the project, so that all report
//! mistakes alike.

mod check;
mod file_error;
mod generate;
mod geometry;
mod load;
mod motion;
mod outline;
mod placement;
pub mod polygon;
mod ron_message;
mod schema;
#[cfg(target_arch = "wasm32")]
pub mod shelf;
mod write;

pub use check::findings;
pub use file_error::{FileError, Finding, Problem};
pub use geometry::{clearance, inner_wall_distance, shape_distance, wall_distance};
pub use load::{
    MOST_BYTES, is_there, parse_ron, read_bytes, read_long_ron, read_long_text, read_ron, read_text, to_ron,
};
pub use motion::pose_at;
pub use placement::{NoFreePlace, draw_navigation, draw_start, draw_target};
pub use ron_message::nearest;
pub use schema::*;
pub use write::to_text;
