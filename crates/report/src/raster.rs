//! Conversion of SVG figures to PNG.
//!
//! A PNG has the same bytes on every machine if the embedded font covers the figure's text. Other characters, such as those of
//! a Japanese scenario name, are drawn with a system font, if there is one.

use resvg::tiny_skia::{Color, Pixmap, Transform};

use crate::style::DrawError;
use crate::svg_tree::svg_tree;

/// The PNG file of an SVG figure on a white background, with `scale` pixels per SVG pixel.
///
/// # Errors
/// `svg` is not valid SVG, or the image would have no pixels or more than can be addressed. An image that does not fit into
/// memory aborts the program, so the caller must limit the size.
pub fn png(svg: &str, scale: f32) -> Result<Vec<u8>, DrawError> {
    render(svg, scale)?.encode_png().map_err(DrawError::new)
}

/// An image in memory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RgbImage {
    /// The width in pixels.
    pub width: usize,
    /// The height in pixels.
    pub height: usize,
    /// Red, green and blue of every pixel, row by row from the top: height x width x 3 bytes.
    pub bytes: Vec<u8>,
}

/// The pixels of an SVG figure on a white background, with `scale` pixels per SVG pixel.
///
/// # Errors
/// As for [`png`].
pub fn rgb(svg: &str, scale: f32) -> Result<RgbImage, DrawError> {
    let image = render(svg, scale)?;
    // The background is opaque, so no pixel is transparent.
    let bytes = image.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
    Ok(RgbImage { width: image.width() as usize, height: image.height() as usize, bytes })
}

fn render(svg: &str, scale: f32) -> Result<Pixmap, DrawError> {
    let tree = svg_tree(svg)?;
    let size = tree.size();
    let pixels = |length: f32| (length * scale).round() as u32;
    let (width, height) = (pixels(size.width()), pixels(size.height()));
    let mut image = Pixmap::new(width, height)
        .ok_or_else(|| DrawError::new(format!("cannot create an image of {width} x {height} pixels")))?;
    image.fill(Color::WHITE);
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut image.as_mut());
    Ok(image)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fonts;

    const FIGURE: &str = r##"<svg width="120" height="40" viewBox="0 0 240 80" xmlns="http://www.w3.org/2000/svg">
        <text x="10" y="40" font-family="Helvetica, Arial, sans-serif" font-size="32" fill="#222">−±εαβ≥</text></svg>"##;

    #[test]
    fn a_png_has_the_figures_size_and_its_text() {
        let bytes = png(FIGURE, 2.0).expect("the figure is drawn");
        let image = Pixmap::decode_png(&bytes).expect("a valid PNG");
        assert_eq!((image.width(), image.height()), (240, 80));
        let dark = image.pixels().iter().filter(|p| p.red() < 100).count();
        assert!(dark > 200, "{dark} dark pixels: the text is missing");
        assert_eq!(bytes, png(FIGURE, 2.0).expect("the figure is drawn"), "the bytes are reproducible");
    }

    #[test]
    fn a_character_that_only_the_system_has_is_drawn_with_its_font() {
        if fonts::system_fonts_with(&['迷']).is_empty() {
            return; // Nothing to draw it with.
        }
        let png_of = |text: &str| png(&FIGURE.replace("−±εαβ≥", text), 1.0).expect("the figure is drawn");
        assert_ne!(png_of("迷"), png_of("路"), "two characters look different");
        assert_ne!(png_of("迷"), png_of("\u{10fffd}"), "it is not the sign for a missing glyph");
    }

    #[test]
    fn invalid_svg_and_impossible_sizes_are_errors() {
        assert!(png("not an SVG", 1.0).is_err());
        assert!(png(FIGURE, 0.0).is_err());
        assert!(png(FIGURE, f32::NAN).is_err());
        assert!(png(FIGURE, 1e9).is_err());
    }
}
