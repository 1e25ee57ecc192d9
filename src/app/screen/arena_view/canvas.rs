//! The canvas that arenas are drawn on, with drawing functions that egui's painter lacks: lines with a colour
//! gradient, labels that are legible on any background, and arrowheads.

use egui::{
    Align2, Color32, CornerRadius, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, Vec2, pos2, vec2,
};

use super::transform::{ViewTransform, constrain_to};
use crate::app::screen::theme::{Palette, SMALL};

/// Maximum length of a dashed line, in points. For a far longer one, such as a path to a mistyped position, egui would make
/// millions of dashes, or never end.
const MAX_DASHED: f32 = 1e5;

/// A painter with the transform and the palette of a view.
#[derive(Clone)]
pub struct Canvas {
    /// The painter, clipped to the view.
    pub painter: Painter,
    /// The transform from metres to points.
    pub transform: ViewTransform,
    /// The colours.
    pub palette: Palette,
    /// Whether the view is a small cell of the grid, drawn with less detail.
    pub compact: bool,
}

impl Canvas {
    /// The screen position of a point in m.
    #[must_use]
    pub fn to_screen(&self, point_m: [f32; 2]) -> Pos2 {
        self.transform.to_screen(point_m)
    }

    /// Draws a line `width` points wide through points in m; `color_at` maps the position along it, 0 to 1,
    /// to a colour.
    pub fn gradient_line(
        &self,
        points_m: impl Iterator<Item = [f32; 2]>,
        width: f32,
        color_at: impl Fn(f32) -> Color32,
    ) {
        let min_distance = if self.compact { 3.0 } else { 1.2 };
        let points = thinned(points_m.map(|point| self.to_screen(point)), min_distance);
        if let Some(mesh) = line_mesh(&points, width, 1.0 / self.painter.pixels_per_point(), color_at) {
            self.painter.add(Shape::mesh(mesh));
        }
    }

    /// Draws a dashed line through points on the screen; `dashes` are the lengths of a dash and of the gap after it, in points.
    /// A line far longer than the view is solid.
    pub fn dashed_line(&self, points: &[Pos2], stroke: Stroke, dashes: (f32, f32)) {
        self.painter.extend(dashed(points, stroke, dashes));
    }

    /// Draws a small label at `at`, moved into the view if necessary, and returns its rectangle.
    pub fn label(&self, at: Pos2, anchor: Align2, text: &str, color: Color32) -> Rect {
        let galley = self.painter.layout_no_wrap(text.to_owned(), FontId::proportional(SMALL), color);
        let size = galley.size() + vec2(8.0, 3.0);
        let rect = constrain_to(anchor.anchor_size(at, size), self.transform.rect.shrink(3.0));
        let background = self.palette.panel.gamma_multiply(0.9);
        self.painter.rect_filled(rect, CornerRadius::same(4), background);
        self.painter.galley(rect.center() - galley.size() / 2.0, galley, color);
        rect
    }

    /// Draws the background of a card.
    pub fn card_background(&self, rect: Rect) {
        let (radius, border) = (CornerRadius::same(6), Stroke::new(1.0, self.palette.border));
        self.painter.rect(rect, radius, self.palette.panel, border, egui::StrokeKind::Inside);
    }

    /// Draws the background of a line of text. It has the colour that surrounds the arena, so it shows only over the arena.
    pub fn strip_background(&self, rect: Rect) {
        self.painter.rect_filled(rect, CornerRadius::same(4), self.palette.background);
    }

    /// Draws small text and returns its rectangle.
    pub fn small_text(&self, at: Pos2, anchor: Align2, text: &str, color: Color32) -> Rect {
        self.painter.text(at, anchor, text, FontId::proportional(SMALL), color)
    }

    /// Draws an arrowhead of `length` points with its tip at `tip`, pointing along the unit vector `along`.
    pub fn arrow_head(&self, tip: Pos2, along: Vec2, length: f32, color: Color32) {
        let (back, side) = (tip - along * length, along.rot90() * length * 0.55);
        let corners = vec![tip, back + side, back - side];
        self.painter.add(Shape::convex_polygon(corners, color, Stroke::NONE));
    }
}

/// The dashes of a line, or the whole line if it is longer than [`MAX_DASHED`]; nothing if its length is not finite.
fn dashed(points: &[Pos2], stroke: Stroke, (dash, gap): (f32, f32)) -> Vec<Shape> {
    let length: f32 = points.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
    if length <= MAX_DASHED {
        Shape::dashed_line(points, stroke, dash, gap)
    } else if length.is_finite() {
        vec![Shape::line(points.to_vec(), stroke)]
    } else {
        Vec::new()
    }
}

/// Drops points within `min_distance` of the last point kept, but always keeps the end of the line.
fn thinned(points: impl Iterator<Item = Pos2>, min_distance: f32) -> Vec<Pos2> {
    let mut kept: Vec<Pos2> = Vec::new();
    let mut skipped = None;
    for point in points.filter(|point| point.is_finite()) {
        if kept.last().is_none_or(|last| last.distance(point) > min_distance) {
            kept.push(point);
            skipped = None;
        } else {
            skipped = Some(point);
        }
    }
    if let (Some(end), Some(last)) = (skipped, kept.last_mut()) {
        *last = end;
    }
    kept
}

/// A line through `points` as a mesh with soft edges one `pixel` wide; `None` for fewer than two points.
fn line_mesh(points: &[Pos2], width: f32, pixel: f32, color_at: impl Fn(f32) -> Color32) -> Option<Mesh> {
    if points.len() < 2 {
        return None;
    }
    let total: f32 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let (inner, outer) = ((width.max(pixel) - pixel) / 2.0, (width.max(pixel) + pixel) / 2.0);
    let mut mesh = Mesh::default();
    mesh.reserve_vertices(points.len() * 4);
    mesh.reserve_triangles((points.len() - 1) * 6);
    let mut so_far = 0.0;
    for (i, &point) in points.iter().enumerate() {
        let before = points[i.saturating_sub(1)];
        let after = points[(i + 1).min(points.len() - 1)];
        so_far += before.distance(point);
        let color = color_at(if total > 0.0 { so_far / total } else { 1.0 });
        let across = (after - before).normalized().rot90();
        for (side, color) in
            [(-outer, Color32::TRANSPARENT), (-inner, color), (inner, color), (outer, Color32::TRANSPARENT)]
        {
            let corner = point + across * side;
            mesh.colored_vertex(pos2(corner.x, corner.y), color);
        }
        if i > 0 {
            let first = 4 * (i as u32 - 1);
            for k in first..first + 3 {
                mesh.add_triangle(k, k + 1, k + 4);
                mesh.add_triangle(k + 1, k + 4, k + 5);
            }
        }
    }
    Some(mesh)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gradient_line_runs_through_its_points_and_has_the_colour_of_each_part() {
        let points = [pos2(0.0, 0.0), pos2(10.0, 0.0), pos2(30.0, 0.0)];
        let mesh =
            line_mesh(&points, 2.0, 0.5, |part| Color32::from_gray((part * 240.0) as u8)).expect("a mesh");
        assert!(mesh.is_valid());
        assert_eq!(mesh.vertices.len(), 12);
        assert_eq!(mesh.vertices[5].color, Color32::from_gray(80), "a third of the way");
        assert_eq!(mesh.calc_bounds(), Rect::from_min_max(pos2(0.0, -1.25), pos2(30.0, 1.25)));
        assert!(line_mesh(&points[..1], 2.0, 0.5, |_| Color32::RED).is_none());
    }

    #[test]
    fn a_line_to_a_place_far_away_is_drawn_without_dashes() {
        let shapes = |x: f32| dashed(&[Pos2::ZERO, pos2(x, 0.0)], Stroke::new(1.0, Color32::RED), (6.0, 4.0));
        assert_eq!(shapes(100.0).len(), 10);
        assert_eq!(shapes(1e12).len(), 1);
        assert!(shapes(f32::INFINITY).is_empty() && shapes(f32::NAN).is_empty());
    }

    #[test]
    fn thinning_keeps_both_ends() {
        let points: Vec<Pos2> = (0..=100).map(|i| pos2(i as f32 * 0.5, 0.0)).collect();
        let kept = thinned(points.iter().copied(), 1.2);
        assert!(kept.len() < 40 && kept.first() == points.first() && kept.last() == points.last());
    }
}
