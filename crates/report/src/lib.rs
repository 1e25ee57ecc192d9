//! Figures and tables from run folders, as files.
//!
//! In: the records a run leaves behind. Out: text in a file's format, the same for the same records: nothing
//! here looks at a clock or at the machine's fonts, so a figure changes only when its numbers do.
//!
//! | module | what it gives |
//! |---|---|
//! | [`learning_curve`] | the picture of one run: success, return and goals over its environment steps |
//! | [`chart`] | the figures of a comparison: curves with bands, rows of dots, maps of a world |
//! | [`raster`] | a figure as PNG |
//! | [`statistics`] | means over seeds with their intervals |
//! | [`table`] | tables |
//! | [`page`], [`markdown`] | the report they make up |

#[cfg(not(target_arch = "wasm32"))]
pub mod chart;
pub mod learning_curve;
#[cfg(not(target_arch = "wasm32"))]
pub mod markdown;
#[cfg(not(target_arch = "wasm32"))]
pub mod page;
#[cfg(not(target_arch = "wasm32"))]
pub mod raster;
#[cfg(not(target_arch = "wasm32"))]
pub mod statistics;
#[cfg_attr(
    target_arch = "wasm32",
    allow(dead_code, unused_imports, reason = "the charts are left out there")
)]
mod style;
pub mod table;

pub use style::DrawError;
