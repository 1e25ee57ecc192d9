//! A report: text, claim results, figures and tables, written as one HTML file or as Markdown.
//!
//! The HTML file contains its style and its figures, runs no script and fetches nothing, so it opens offline. The
//! Markdown is meant for a repository and links to the figures. Both link to the files in `figures/` (SVG, PNG) and
//! `tables/` (CSV, Markdown), which the caller writes into the same folder.

use crate::claim::ClaimResult;
use crate::table::Table;

/// A report. All text is plain: markup in it is escaped.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// The title.
    pub title: String,
    /// The introduction, in paragraphs.
    pub lead: Vec<String>,
    /// A warning shown above everything else.
    pub warning: Option<String>,
    /// The results of all claims, as the summary.
    pub claims: Vec<ClaimResult>,
    /// The body.
    pub sections: Vec<Section>,
    /// The exact settings that were used.
    pub settings: Vec<Setting>,
    /// The provenance of the report, as names and values: version, machine, seeds, command.
    pub provenance: Vec<(String, String)>,
}

/// A section of the body.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// The target of links to the section; unique, and not `settings` or `provenance`.
    pub id: String,
    /// The heading.
    pub heading: String,
    /// The introduction; a blank line separates paragraphs.
    pub about: String,
    /// The contents, in order.
    pub items: Vec<Item>,
}

/// A text, a figure or a table of a section.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// Text; a blank line separates paragraphs.
    Text(String),
    /// A figure, which is also in `figures/` as `.svg` and `.png`.
    Figure {
        /// The stem of the figure's file names, such as `fig9`.
        name: String,
        /// The figure as SVG. It is trusted and inserted without escaping.
        svg: String,
        /// The caption.
        caption: String,
        /// The results of the claims that the figure is about.
        claim_results: Vec<ClaimResult>,
    },
    /// A table, which is also in `tables/` as `.csv` and `.md`.
    Table {
        /// The table.
        table: Table,
        /// The results of the claims that the table is about.
        claim_results: Vec<ClaimResult>,
    },
}

/// The exact text of a settings file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// The heading.
    pub heading: String,
    /// The text, in RON, shown unchanged.
    pub ron: String,
}
