//! Fields over the plane: the potential and the network's value, as colours, as arrows, and their key.
//!
//! In: a [`Field`]. Out: a texture that is made again only when the field's version changes, arrows down its slope, and
//! a bar that says what the colours mean.

use egui::{Color32, ColorImage, Context, FontId, Id, Mesh, Rect, Shape, Stroke, TextureHandle, pos2, vec2};

use super::canvas::Canvas;
use super::plane::direction;
use super::theme::SMALL;
use crate::app::scene::Field;

/// Arrows along the longer side.
const ARROWS: usize = 14;

/// Which field: each has its own texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// U of eq. (4).
    Potential,
    /// V(s) of the network.
    Value,
}

impl Kind {
    /// What the key calls it.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Potential => "Potential U, eq. (4)",
            Self::Value => "Value V(s) here, with this heading",
        }
    }
}

/// Even steps of lightness in one hue that nothing else here has, from the floor's own lightness away: violet.
fn ramp(dark: bool) -> [Color32; 7] {
    let rgb = Color32::from_rgb;
    if dark {
        [
            rgb(0x22, 0x21, 0x39),
            rgb(0x3d, 0x2f, 0x69),
            rgb(0x5f, 0x3f, 0x93),
            rgb(0x83, 0x53, 0xb3),
            rgb(0xa6, 0x6f, 0xc8),
            rgb(0xc4, 0x90, 0xd3),
            rgb(0xd9, 0xb7, 0xda),
        ]
    } else {
        [
            rgb(0xf6, 0xf6, 0xfc),
            rgb(0xe0, 0xda, 0xf4),
            rgb(0xcd, 0xbf, 0xea),
            rgb(0xbd, 0xa5, 0xde),
            rgb(0xaf, 0x8c, 0xcf),
            rgb(0xa2, 0x73, 0xbe),
            rgb(0x96, 0x5a, 0xac),
        ]
    }
}

/// The colour of `part`, 0 (least) to 1 (most); none of what is not a number.
fn ramp_ink(dark: bool, part: f32) -> Color32 {
    if !part.is_finite() {
        return Color32::TRANSPARENT;
    }
    let stops = ramp(dark);
    let place = part.clamp(0.0, 1.0) * (stops.len() - 1) as f32;
    let low = (place as usize).min(stops.len() - 2);
    stops[low].lerp_to_gamma(stops[low + 1], place - low as f32).gamma_multiply(0.88)
}

/// The least and the greatest of the values that are numbers.
fn span(field: &Field) -> Option<(f32, f32)> {
    let mut numbers = field.values.iter().copied().filter(|value| value.is_finite());
    let first = numbers.next()?;
    Some(numbers.fold((first, first), |(low, high), value| (low.min(value), high.max(value))))
}

fn part_of(value: f32, (low, high): (f32, f32)) -> f32 {
    if high > low || !value.is_finite() { (value - low) / (high - low) } else { 0.5 }
}

/// Whether the field has as many values as it says.
fn is_whole(field: &Field) -> bool {
    let [width, height] = field.size;
    width > 0 && height > 0 && width.checked_mul(height) == Some(field.values.len())
}

#[derive(Clone)]
struct Cached {
    of: (u64, [usize; 2], bool),
    texture: TextureHandle,
}

fn texture(ctx: &Context, kind: Kind, field: &Field, dark: bool) -> Option<TextureHandle> {
    let id = Id::new(("wayfield field", kind));
    let of = (field.version, field.size, dark);
    if let Some(cached) = ctx.data(|data| data.get_temp::<Cached>(id))
        && cached.of == of
    {
        return Some(cached.texture);
    }
    let whole = span(field)?;
    let [width, height] = field.size;
    if 2 * width.max(height) > ctx.input(|input| input.max_texture_side) {
        return None;
    }
    let image = picture(field, whole, dark);
    let texture = ctx.load_texture(format!("field {kind:?}"), image, egui::TextureOptions::LINEAR);
    ctx.data_mut(|data| data.insert_temp(id, Cached { of, texture: texture.clone() }));
    Some(texture)
}

/// The field's colours, finer than the field itself where it is coarse, so that the edge of where the robot cannot be is
/// smooth.
fn picture(field: &Field, whole: (f32, f32), dark: bool) -> ColorImage {
    let [width, height] = field.size;
    let finer = if width.max(height) <= 128 { 2 } else { 1 };
    let inks: Vec<Color32> = (0..=255).map(|k| ramp_ink(dark, k as f32 / 255.0)).collect();
    let mut image = ColorImage::filled([width * finer, height * finer], Color32::TRANSPARENT);
    let place = |k: usize, count: usize| {
        let at = ((k as f32 + 0.5) / finer as f32 - 0.5).clamp(0.0, (count - 1) as f32);
        let low = at as usize;
        (low, (low + 1).min(count - 1), at - low as f32)
    };
    let (values, there) = mended(field);
    // The image's first row is the uppermost, the field's the lowest.
    for (row, line) in image.pixels.chunks_exact_mut(width * finer).rev().enumerate() {
        let (y0, y1, v) = place(row, height);
        for (column, pixel) in line.iter_mut().enumerate() {
            let (x0, x1, u) = place(column, width);
            let between = |of: &[f32]| {
                let lower = of[y0 * width + x0] * (1.0 - u) + of[y0 * width + x1] * u;
                let upper = of[y1 * width + x0] * (1.0 - u) + of[y1 * width + x1] * u;
                lower * (1.0 - v) + upper * v
            };
            let clear = ((between(&there) - 0.35) / 0.3).clamp(0.0, 1.0);
            if clear > 0.0 {
                let part = part_of(between(&values), whole).clamp(0.0, 1.0);
                *pixel = inks[(part * 255.0).round() as usize].gamma_multiply(clear);
            }
        }
    }
    image
}

/// The values with those missing taken from their neighbours, and how much of each cell's surroundings is there.
fn mended(field: &Field) -> (Vec<f32>, Vec<f32>) {
    const TENT: [f32; 5] = [1.0, 2.0, 3.0, 2.0, 1.0];
    let [width, height] = field.size;
    let (mut values, mut there) = (field.values.clone(), vec![1.0; field.values.len()]);
    if field.values.iter().all(|value| value.is_finite()) {
        return (values, there);
    }
    let near = |k: usize, by: usize, count: usize| (k + by).saturating_sub(2).min(count - 1);
    for y in 0..height {
        for x in 0..width {
            let (mut sum, mut weight) = (0.0, 0.0);
            for (j, up) in TENT.into_iter().enumerate() {
                for (i, across) in TENT.into_iter().enumerate() {
                    let value = field.values[near(y, j, height) * width + near(x, i, width)];
                    if value.is_finite() {
                        sum += value * up * across;
                        weight += up * across;
                    }
                }
            }
            let at = y * width + x;
            there[at] = weight / 81.0;
            if !values[at].is_finite() {
                values[at] = if weight > 0.0 { sum / weight } else { 0.0 };
            }
        }
    }
    (values, there)
}

/// Draws `field` as colours.
pub fn colours(canvas: &Canvas, kind: Kind, field: &Field, dark: bool) {
    if !is_whole(field) {
        return;
    }
    if let Some(texture) = texture(canvas.painter.ctx(), kind, field, dark) {
        let place = canvas.plane.rect_of(field.min_m, field.max_m);
        let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        canvas.painter.image(texture.id(), place, all, Color32::WHITE);
    }
}

/// Draws which way `field` falls, as arrows on a coarse grid.
pub fn arrows(canvas: &Canvas, field: &Field, ink: Color32) {
    if !is_whole(field) {
        return;
    }
    let [width, height] = field.size;
    let step = (width.max(height) / ARROWS).max(1);
    let cell_m = [0, 1].map(|k| (field.max_m[k] - field.min_m[k]) / field.size[k] as f32);
    let length = (canvas.plane.length(cell_m[0].abs() * step as f32) * 0.50).min(26.0);
    if length < 4.0 {
        return;
    }
    let stroke = Stroke::new(1.25, ink);
    for iy in (step / 2..height).step_by(step) {
        for ix in (step / 2..width).step_by(step) {
            let Some([dx, dy]) = descent(field, ix, iy) else { continue };
            let x_m = field.min_m[0] + (ix as f32 + 0.5) * cell_m[0];
            let y_m = field.min_m[1] + (iy as f32 + 0.5) * cell_m[1];
            let (middle, along) = (canvas.at([x_m, y_m]), direction(dy.atan2(dx)));
            if !canvas.plane.rect.contains(middle) {
                continue;
            }
            let tip = middle + along * length / 2.0;
            canvas.painter.line_segment([tip - along * length, tip - along * 3.0], stroke);
            canvas.arrow_head(tip, along, 5.0, ink);
        }
    }
}

/// The unit vector down the slope of `field` at a cell; none at its edge, where it is flat, or beside what is no number.
fn descent(field: &Field, ix: usize, iy: usize) -> Option<[f32; 2]> {
    let [width, height] = field.size;
    if ix == 0 || iy == 0 || ix + 1 >= width || iy + 1 >= height {
        return None;
    }
    let value = |x: usize, y: usize| field.values.get(y * width + x).copied().unwrap_or(f32::NAN);
    let cell_m = [0, 1].map(|k| (field.max_m[k] - field.min_m[k]) / field.size[k] as f32);
    let dx = (value(ix - 1, iy) - value(ix + 1, iy)) / cell_m[0];
    let dy = (value(ix, iy - 1) - value(ix, iy + 1)) / cell_m[1];
    let steep = dx.hypot(dy);
    (steep.is_finite() && steep > 1e-6).then(|| [dx / steep, dy / steep])
}

/// The key to the colours in the upper right corner of the view, on one line if there is room; gives the space it takes.
pub fn key(canvas: &Canvas, kind: Kind, field: &Field, dark: bool) -> Option<Rect> {
    const BAR: f32 = 110.0;
    let whole = span(field)?;
    let inks = &canvas.inks;
    let font = FontId::proportional(SMALL);
    let text = |words: String, ink| canvas.painter.layout_no_wrap(words, font.clone(), ink);
    let (title, low, high) = (
        text(kind.title().into(), inks.ink),
        text(number(whole.0), inks.soft),
        text(number(whole.1), inks.soft),
    );
    let scale = low.size().x + BAR + high.size().x + 12.0;
    let (one_line, room) = (title.size().x + 14.0 + scale, canvas.plane.rect.width() - 20.0);
    let lines = if one_line + 110.0 <= room { 1.0 } else { 2.0 };
    let width = if lines < 2.0 { one_line } else { scale.max(title.size().x) } + 12.0;
    if width > room || canvas.plane.rect.height() < 160.0 {
        return None;
    }
    let corner = canvas.plane.rect.right_top() + vec2(-8.0 - width, 6.0);
    let strip = Rect::from_min_size(corner, vec2(width, 20.0 * lines));
    canvas.strip(strip);
    let y = strip.bottom() - 10.0;
    let centred = |x: f32, y: f32, size: egui::Vec2| pos2(x, y - size.y / 2.0);
    canvas.painter.galley(centred(strip.left() + 6.0, strip.top() + 10.0, title.size()), title, inks.ink);
    let mut x = strip.right() - 6.0 - high.size().x;
    canvas.painter.galley(centred(x, y, high.size()), high, inks.soft);
    x -= 6.0 + BAR;
    let bar = Rect::from_min_size(pos2(x, y - 4.0), vec2(BAR, 8.0));
    canvas.painter.add(Shape::mesh(bar_mesh(bar, dark)));
    x -= 6.0 + low.size().x;
    canvas.painter.galley(centred(x, y, low.size()), low, inks.soft);
    Some(strip)
}

fn bar_mesh(bar: Rect, dark: bool) -> Mesh {
    let stops = ramp(dark);
    let mut mesh = Mesh::default();
    for (k, stop) in (0u32..).zip(stops) {
        let x = bar.left() + bar.width() * k as f32 / (stops.len() - 1) as f32;
        mesh.colored_vertex(pos2(x, bar.top()), stop);
        mesh.colored_vertex(pos2(x, bar.bottom()), stop);
        if k > 0 {
            let first = 2 * (k - 1);
            mesh.add_triangle(first, first + 1, first + 2);
            mesh.add_triangle(first + 1, first + 2, first + 3);
        }
    }
    mesh
}

/// A number in about three figures, with a true minus sign.
#[must_use]
pub fn number(value: f32) -> String {
    figures(value, decimals_for(value))
}

/// Decimals that give a number of the size of `value` about three figures.
#[must_use]
pub fn decimals_for(value: f32) -> usize {
    match value.abs() {
        size if size >= 99.95 => 0,
        size if size >= 9.995 => 1,
        _ => 2,
    }
}

/// A number with so many decimals and a true minus sign.
#[must_use]
pub fn figures(value: f32, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.to_owned(),
        Some(rest) => format!("\u{2212}{rest}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f = (x - 1)^2 + y^2 over 4 m x 4 m.
    fn bowl() -> Field {
        let middle = |k: usize| -2.0 + (k as f32 + 0.5) * 0.1;
        let values = (0..1600).map(|k| (middle(k % 40) - 1.0).powi(2) + middle(k / 40).powi(2)).collect();
        Field { size: [40, 40], min_m: [-2.0; 2], max_m: [2.0; 2], values, version: 1 }
    }

    #[test]
    fn the_arrows_lead_downhill() {
        let field = bowl();
        let [dx, dy] = descent(&field, 10, 35).expect("a slope");
        let (x, y) = (-2.0 + 10.5 * 0.1, -2.0 + 35.5 * 0.1);
        let to: [f32; 2] = [1.0 - x, -y];
        let far = to[0].hypot(to[1]);
        assert!((dx - to[0] / far).abs() < 1e-3 && (dy - to[1] / far).abs() < 1e-3, "{dx} {dy}");
        assert_eq!(descent(&field, 0, 5), None);
    }

    #[test]
    fn beside_nothing_there_is_no_slope() {
        let mut field = bowl();
        field.values[20 * 40 + 21] = f32::NAN;
        assert_eq!(descent(&field, 20, 20), None);
        assert!(descent(&field, 10, 10).is_some());
        assert_eq!(ramp_ink(true, f32::NAN), Color32::TRANSPARENT);
    }

    #[test]
    fn the_ramp_spans_the_numbers_only() {
        let mut field = bowl();
        field.values[0] = f32::NAN;
        let (low, high) = span(&field).expect("numbers");
        assert!(low < 0.01 && high > 11.0);
        assert_eq!((part_of(low, (low, high)), part_of(high, (low, high))), (0.0, 1.0));
        assert_eq!(part_of(3.0, (3.0, 3.0)), 0.5);
    }

    #[test]
    fn the_picture_has_the_fields_top_at_its_top_and_holes_where_it_has() {
        let mut field = bowl();
        field.values[36 * 40..].fill(f32::NAN);
        let image = picture(&field, (0.0, 13.0), false);
        assert_eq!(image.size, [80, 80]);
        assert_eq!(image.pixels[5], Color32::TRANSPARENT, "the uppermost rows are missing");
        assert_eq!(image.pixels[79 * 80 + 60].a(), ramp_ink(false, 0.5).a(), "the lowest is there");
    }

    #[test]
    fn numbers_have_about_three_figures() {
        assert_eq!(["0.00", "\u{2212}1.25", "12.3", "100"], [-0.001, -1.25, 12.34, 99.96].map(number)[..]);
    }
}
