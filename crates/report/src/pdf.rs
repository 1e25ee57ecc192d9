//! Conversion of SVG figures to PDF, for print.
//!
//! A figure consists of shapes and text in plain colours. Text becomes outlines, so every viewer shows it alike.

use std::io::{self, Write};

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref};
use resvg::tiny_skia::{PathSegment, Point, Transform};
use resvg::usvg::{BlendMode, Color, Fill, FillRule, Group, LineCap, LineJoin, Node, Paint, Path, Stroke};

use crate::style::DrawError;
use crate::svg_tree::svg_tree;

/// The size of an SVG pixel in PDF points: an inch has 96 pixels and 72 points.
const POINTS_PER_PIXEL: f32 = 0.75;

/// The PDF file of an SVG figure: one page of the figure's size, at 96 SVG pixels per inch.
///
/// # Errors
/// `svg` is not valid SVG, or uses images, gradients, patterns, clipping, masks, filters or blend modes.
pub fn pdf(svg: &str) -> Result<Vec<u8>, DrawError> {
    let tree = svg_tree(svg)?;
    let size = tree.size();
    let (width, height) = (size.width() * POINTS_PER_PIXEL, size.height() * POINTS_PER_PIXEL);
    let mut page = PageDrawing { content: Content::new(), opacities: Vec::new() };
    // PDF's y axis points up.
    page.content.transform([POINTS_PER_PIXEL, 0.0, 0.0, -POINTS_PER_PIXEL, 0.0, height]);
    page.draw_group(tree.root(), 1.0)?;
    page.into_file((width, height)).map_err(DrawError::new)
}

/// The drawing on a page.
struct PageDrawing {
    content: Content,
    /// The opacities in use, 0 to 1. PDF refers to them by name.
    opacities: Vec<f32>,
}

impl PageDrawing {
    fn draw_group(&mut self, group: &Group, opacity: f32) -> Result<(), DrawError> {
        let is_plain = group.clip_path().is_none()
            && group.mask().is_none()
            && group.filters().is_empty()
            && group.blend_mode() == BlendMode::Normal;
        if !is_plain {
            return Err(unsupported("clipping, masks, filters and blending"));
        }
        // Exact if the shapes of a translucent group do not overlap. In this crate's figures, such a group has one shape.
        let opacity = opacity * group.opacity().get();
        for node in group.children() {
            match node {
                Node::Group(group) => self.draw_group(group, opacity)?,
                Node::Path(path) if path.is_visible() => self.draw_path(path, opacity)?,
                Node::Path(_) => {}
                Node::Text(text) => self.draw_group(text.flattened(), opacity)?,
                Node::Image(_) => return Err(unsupported("images")),
            }
        }
        Ok(())
    }

    fn draw_path(&mut self, path: &Path, opacity: f32) -> Result<(), DrawError> {
        self.content.save_state();
        let Transform { sx, kx, ky, sy, tx, ty } = path.abs_transform();
        self.content.transform([sx, ky, kx, sy, tx, ty]);
        if let Some(fill) = path.fill() {
            self.fill(path, fill, opacity)?;
        }
        if let Some(stroke) = path.stroke() {
            self.stroke(path, stroke, opacity)?;
        }
        self.content.restore_state();
        Ok(())
    }

    fn fill(&mut self, path: &Path, fill: &Fill, opacity: f32) -> Result<(), DrawError> {
        let [red, green, blue] = colour(fill.paint())?;
        self.set_opacity(opacity * fill.opacity().get());
        self.content.set_fill_rgb(red, green, blue);
        self.outline(path);
        match fill.rule() {
            FillRule::NonZero => self.content.fill_nonzero(),
            FillRule::EvenOdd => self.content.fill_even_odd(),
        };
        Ok(())
    }

    fn stroke(&mut self, path: &Path, stroke: &Stroke, opacity: f32) -> Result<(), DrawError> {
        let [red, green, blue] = colour(stroke.paint())?;
        self.set_opacity(opacity * stroke.opacity().get());
        self.content.set_stroke_rgb(red, green, blue).set_line_width(stroke.width().get());
        self.content.set_miter_limit(stroke.miterlimit().get());
        self.content.set_line_cap(match stroke.linecap() {
            LineCap::Butt => LineCapStyle::ButtCap,
            LineCap::Round => LineCapStyle::RoundCap,
            LineCap::Square => LineCapStyle::ProjectingSquareCap,
        });
        self.content.set_line_join(match stroke.linejoin() {
            LineJoin::Miter | LineJoin::MiterClip => LineJoinStyle::MiterJoin,
            LineJoin::Round => LineJoinStyle::RoundJoin,
            LineJoin::Bevel => LineJoinStyle::BevelJoin,
        });
        if let Some(dashes) = stroke.dasharray() {
            self.content.set_dash_pattern(dashes.iter().copied(), stroke.dashoffset());
        }
        self.outline(path);
        self.content.stroke();
        Ok(())
    }

    fn set_opacity(&mut self, opacity: f32) {
        let known = self.opacities.iter().position(|&other| other == opacity);
        let index = known.unwrap_or_else(|| {
            self.opacities.push(opacity);
            self.opacities.len() - 1
        });
        self.content.set_parameters(Name(opacity_name(index).as_bytes()));
    }

    fn outline(&mut self, path: &Path) {
        let mut last = Point::zero();
        for segment in path.data().segments() {
            match segment {
                PathSegment::MoveTo(to) => self.content.move_to(to.x, to.y),
                PathSegment::LineTo(to) => self.content.line_to(to.x, to.y),
                PathSegment::QuadTo(control, to) => {
                    // The same curve as a cubic one.
                    let near = |end: Point| {
                        (end.x + (control.x - end.x) * 2.0 / 3.0, end.y + (control.y - end.y) * 2.0 / 3.0)
                    };
                    let ((x1, y1), (x2, y2)) = (near(last), near(to));
                    self.content.cubic_to(x1, y1, x2, y2, to.x, to.y)
                }
                PathSegment::CubicTo(one, two, to) => {
                    self.content.cubic_to(one.x, one.y, two.x, two.y, to.x, to.y)
                }
                PathSegment::Close => self.content.close_path(),
            };
            if let PathSegment::MoveTo(to)
            | PathSegment::LineTo(to)
            | PathSegment::QuadTo(_, to)
            | PathSegment::CubicTo(_, _, to) = segment
            {
                last = to;
            }
        }
    }

    /// The file with this drawing on a page of the given width and height, in points.
    fn into_file(self, (width, height): (f32, f32)) -> io::Result<Vec<u8>> {
        let [catalog, pages, page, content] = [1, 2, 3, 4].map(Ref::new);
        let mut file = Pdf::new();
        file.catalog(catalog).pages(pages);
        file.pages(pages).kids([page]).count(1);
        let mut sheet = file.page(page);
        sheet.parent(pages).media_box(Rect::new(0.0, 0.0, width, height)).contents(content);
        let mut resources = sheet.resources();
        let mut states = resources.ext_g_states();
        for (index, &opacity) in self.opacities.iter().enumerate() {
            let mut state = states
                .insert(Name(opacity_name(index).as_bytes()))
                .start::<pdf_writer::writers::ExtGraphicsState>();
            state.non_stroking_alpha(opacity).stroking_alpha(opacity);
        }
        states.finish();
        resources.finish();
        sheet.finish();
        let mut compressed = ZlibEncoder::new(Vec::new(), Compression::best());
        compressed.write_all(&self.content.finish())?;
        file.stream(content, &compressed.finish()?).filter(Filter::FlateDecode);
        Ok(file.finish())
    }
}

fn opacity_name(index: usize) -> String {
    format!("opacity{index}")
}

fn colour(paint: &Paint) -> Result<[f32; 3], DrawError> {
    match paint {
        Paint::Color(Color { red, green, blue }) => {
            Ok([*red, *green, *blue].map(|part| f32::from(part) / 255.0))
        }
        _ => Err(unsupported("gradients and patterns")),
    }
}

fn unsupported(what: &str) -> DrawError {
    DrawError::new(format!("{what} cannot be converted to PDF"))
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use flate2::read::ZlibDecoder;

    use super::*;

    fn figure(contents: &str) -> String {
        format!(
            r#"<svg width="120" height="40" viewBox="0 0 240 80" xmlns="http://www.w3.org/2000/svg">{contents}</svg>"#
        )
    }

    /// The PDF of a figure with these contents, and the operators on its page.
    fn convert(contents: &str) -> (String, String) {
        let bytes = pdf(&figure(contents)).expect("the figure is converted");
        assert_eq!(
            bytes,
            pdf(&figure(contents)).expect("the figure is converted"),
            "the bytes are reproducible"
        );
        let start = bytes.windows(7).position(|window| window == b"stream\n").expect("a stream") + 7;
        let mut operators = String::new();
        ZlibDecoder::new(&bytes[start..]).read_to_string(&mut operators).expect("a compressed stream");
        (String::from_utf8_lossy(&bytes).into_owned(), operators)
    }

    #[test]
    fn a_page_has_the_figures_size_shapes_and_colours() {
        let (file, operators) = convert(
            r##"<polygon points="0,0 240,0 240,80" fill="#00FF00" opacity="0.25"/>
            <polyline points="10,10 20,30" fill="none" stroke="#FF0000" stroke-width="4" opacity="0.5"/>"##,
        );
        assert!(file.starts_with("%PDF-") && file.trim_end().ends_with("%%EOF"));
        assert!(file.contains("/MediaBox [0 0 90 30]"), "{file}");
        assert!(file.contains("/ca 0.25") && file.contains("/CA 0.5"), "{file}");
        assert!(operators.starts_with("0.75 0 0 -0.75 0 30 cm\n"), "{operators}");
        let lines: Vec<&str> = operators.lines().collect();
        let position = |line: &str| {
            lines.iter().position(|other| *other == line).unwrap_or_else(|| panic!("{line}: {operators}"))
        };
        assert!(position("0 1 0 rg") < position("240 80 l") && position("240 80 l") < position("f"));
        assert!(position("1 0 0 RG") < position("20 30 l") && position("20 30 l") < position("S"));
        assert!(position("4 w") < position("S") && position("f") < position("1 0 0 RG"));
    }

    #[test]
    fn text_becomes_outlines() {
        let text = r##"<text x="10" y="40" font-family="Arial" font-size="32" fill="#222">So</text>"##;
        let (_, operators) = convert(text);
        assert!(operators.lines().filter(|line| line.ends_with(" c")).count() > 10, "{operators}");
        assert!(!operators.contains("BT"));
    }

    #[test]
    fn gradients_clipping_and_invalid_svg_are_refused() {
        let gradient = r##"<linearGradient id="g"><stop offset="0" stop-color="#fff"/><stop offset="1" stop-color="#000"/>
            </linearGradient><rect width="9" height="9" fill="url(#g)"/>"##;
        let clip = r##"<clipPath id="c"><rect width="4" height="4"/></clipPath><rect width="9" height="9" clip-path="url(#c)"/>"##;
        for contents in [gradient, clip] {
            let error = pdf(&figure(contents)).expect_err("not converted");
            assert!(error.to_string().contains("cannot be converted to PDF"), "{error}");
        }
        assert!(pdf("not an SVG").is_err());
    }
}
