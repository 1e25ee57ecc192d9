//! A figure as pixels.
//!
//! In: the text of an SVG. Out: a PNG of it. The only font is the one in here, so the same figure is the same
//! bytes on every machine.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use super::style::DrawError;

/// Latin, Greek and the signs of figures, as wide as Arial's; `assets/fonts/OFL.txt` is its licence.
const FONT: &[u8] = include_bytes!("../../../assets/fonts/wayfield-sans.ttf");
const FAMILY: &str = "Wayfield Sans";

/// The embedded font alone, under whatever family name a figure asks for.
static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(FONT.to_vec());
    fonts.set_sans_serif_family(FAMILY);
    fonts.set_serif_family(FAMILY);
    fonts.set_monospace_family(FAMILY);
    Arc::new(fonts)
});

/// Draws an SVG on white, `scale` pixels to each of its own, as the bytes of a PNG file.
///
/// # Errors
/// When `svg` is no SVG, or the picture would have no pixel or more than memory can hold.
pub fn png(svg: &str, scale: f32) -> Result<Vec<u8>, DrawError> {
    let options =
        Options { font_family: FAMILY.to_owned(), fontdb: Arc::clone(&FONTS), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(DrawError::new)?;
    let size = tree.size();
    let pixels = |length: f32| (length * scale).round() as u32;
    let (width, height) = (pixels(size.width()), pixels(size.height()));
    let mut picture = Pixmap::new(width, height)
        .ok_or_else(|| DrawError::new(format!("{width} by {height} pixels are no picture")))?;
    picture.fill(Color::WHITE);
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut picture.as_mut());
    picture.encode_png().map_err(DrawError::new)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIGURE: &str = r##"<svg width="120" height="40" viewBox="0 0 240 80" xmlns="http://www.w3.org/2000/svg">
        <text x="10" y="40" font-family="Helvetica, Arial, sans-serif" font-size="32" fill="#222">−±εαβ≥</text></svg>"##;

    #[test]
    fn a_figure_becomes_a_png_of_its_size_with_its_text_on_it() {
        let bytes = png(FIGURE, 2.0).expect("is drawn");
        let picture = Pixmap::decode_png(&bytes).expect("is a PNG");
        assert_eq!((picture.width(), picture.height()), (240, 80));
        let dark = picture.pixels().iter().filter(|p| p.red() < 100).count();
        assert!(dark > 200, "{dark} dark pixels: the text is missing");
        assert_eq!(bytes, png(FIGURE, 2.0).expect("is drawn"), "the same bytes each time");
    }

    #[test]
    fn the_font_has_every_sign_that_figures_use() {
        let drawn = |sign: char| png(&FIGURE.replace("−±εαβ≥", &sign.to_string()), 1.0).expect("is drawn");
        let unknown = drawn('\u{4e00}');
        for sign in "−±εαβγσµμΔ·≥≤≈°%–—…→×²₁‘’“”".chars() {
            assert_ne!(drawn(sign), unknown, "{sign}");
        }
    }

    #[test]
    fn what_cannot_be_drawn_is_an_error() {
        assert!(png("no svg", 1.0).is_err());
        assert!(png(FIGURE, 0.0).is_err());
        assert!(png(FIGURE, f32::NAN).is_err());
        assert!(png(FIGURE, 1e9).is_err());
    }
}
