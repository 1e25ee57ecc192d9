//! Figures, tables, statistics and report pages, made from plain numbers.
//!
//! No function writes a file: figures, tables and pages are returned as text (SVG, HTML, Markdown, CSV) or as PNG or PDF
//! bytes. The same numbers give the same bytes on every machine, except for PNG and PDF figures with characters that the
//! embedded font lacks: those are drawn with an installed font.
//!
//! | module | contents |
//! |---|---|
//! | [`chart`] | figures as SVG: [curves with 95 % bands](chart::CurveChart), [dot plots](chart::DotPlot), [scenario maps](chart::ScenarioMap) |
//! | [`run_figure`] | the figure of a single training run |
//! | [`raster`], [`pdf`](mod@pdf) | the conversion of SVG to PNG and PDF |
//! | [`resized`] | a figure scaled to another size |
//! | [`fonts`] | the system's fonts, for characters that the embedded one lacks |
//! | [`statistics`] | means over seeds and differences of means, with 95 % confidence intervals |
//! | [`rate`] | rates with 95 % confidence intervals |
//! | [`curves`] | the mean of curves whose points differ in x |
//! | [`smoothing`] | the moving mean |
//! | [`table`] | tables, as CSV and Markdown |
//! | [`claim`] | whether the data support a claim: held, not shown or reversed |
//! | [`page`] | a report made of text, figures and tables, as HTML and Markdown |
//! | [`format`](mod@format) | the format of numbers |
//!
//! Non-finite values are left out of figures and displayed as a dash in tables.
//!
//! # Example
//!
//! A chart of one curve with its confidence band:
//!
//! ```
//! use wayfield_report::chart::{BandPoint, ChartPanel, CurveChart, CurveLine};
//!
//! let point = |episode: u32| {
//!     let x = f64::from(episode);
//!     let mean = 100.0 * (1.0 - (-x / 20.0).exp());
//!     BandPoint { x, mean, low: mean - 5.0, high: mean + 5.0 }
//! };
//! let line = CurveLine {
//!     name: "DQN".into(),
//!     points: (1..=100).map(point).collect(),
//!     ..CurveLine::default()
//! };
//! let panel = ChartPanel { heading: "Success rate".into(), y_unit: "%".into(), lines: vec![line], ..ChartPanel::default() };
//! let chart = CurveChart {
//!     title: "A training run".into(),
//!     x_label: "episodes".into(),
//!     mean_label: "smoothed mean".into(),
//!     band_label: "95 % interval".into(),
//!     panels: vec![panel],
//!     ..CurveChart::default()
//! };
//!
//! let svg = chart.svg()?;
//! assert!(svg.starts_with("<svg") && svg.contains("Success rate"));
//! # Ok::<(), wayfield_report::DrawError>(())
//! ```
//!
//! # In the browser
//!
//! On `wasm32` only the curves are compiled: [`chart::CurveChart`], [`run_figure`], [`rate`],
//! [`smoothing`] and [`format`](mod@format).

pub mod chart;
#[cfg(not(target_arch = "wasm32"))]
pub mod claim;
#[cfg(not(target_arch = "wasm32"))]
mod csv_table;
#[cfg(not(target_arch = "wasm32"))]
pub mod curves;
#[cfg(not(target_arch = "wasm32"))]
pub mod fonts;
pub mod format;
#[cfg(not(target_arch = "wasm32"))]
mod html;
#[cfg(not(target_arch = "wasm32"))]
mod markdown;
#[cfg(not(target_arch = "wasm32"))]
pub mod page;
#[cfg(not(target_arch = "wasm32"))]
mod page_text;
#[cfg(not(target_arch = "wasm32"))]
pub mod pdf;
#[cfg(not(target_arch = "wasm32"))]
pub mod raster;
pub mod rate;
#[cfg(not(target_arch = "wasm32"))]
mod resized;
pub mod run_figure;
#[cfg(all(test, not(target_arch = "wasm32")))]
mod samples;
pub mod smoothing;
#[cfg(not(target_arch = "wasm32"))]
pub mod statistics;
#[cfg_attr(
    target_arch = "wasm32",
    allow(dead_code, unused_imports, reason = "dot plots and maps are not compiled for the browser")
)]
mod style;
#[cfg(not(target_arch = "wasm32"))]
mod svg_tree;
#[cfg(not(target_arch = "wasm32"))]
pub mod table;

#[cfg(not(target_arch = "wasm32"))]
pub use resized::resized;
pub use style::DrawError;
