//! Parsing of SVG figures, with the glyphs of their text.

use std::sync::Arc;

use resvg::usvg::{Options, Tree};

use crate::fonts;
use crate::style::DrawError;

/// The parsed figure `svg`. The embedded font stands in for every font that it names.
///
/// # Errors
/// `svg` is not valid SVG.
pub(crate) fn svg_tree(svg: &str) -> Result<Tree, DrawError> {
    let options = Options {
        font_family: fonts::FAMILY.to_owned(),
        fontdb: Arc::clone(&fonts::FONTS),
        font_resolver: fonts::resolver(),
        ..Options::default()
    };
    Tree::from_str(svg, &options).map_err(DrawError::new)
}
