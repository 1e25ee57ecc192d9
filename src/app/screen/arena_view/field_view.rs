//! Field overlays: the potential or the state value as colours, and the potential's descent as arrows.
//!
//! In: a [`ScalarField`]. Out: a texture, made again only when the field or the theme changes, and arrows downhill.

use egui::{Color32, Context, Id, Rect, Stroke, TextureHandle, pos2};

use super::canvas::Canvas;
use super::field_image::{field_image, value_range};
use super::transform::screen_direction;
use crate::app::scene::ScalarField;

/// Number of arrows along the longer side of the field.
const ARROWS: usize = 14;

/// The kind of a field; each has its own texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FieldKind {
    /// The potential U of the paper's eq. (4).
    Potential,
    /// The state value V(s) of the network.
    Value,
}

impl FieldKind {
    /// The title of the colour bar.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Potential => "Potential U (eq. 4)",
            Self::Value => "State value V(s), current heading",
        }
    }

    /// The fractions of the lowest and of the highest values that the colours do not cover: for the potential, the high
    /// values close to obstacles; for a network, the extremes at both ends.
    pub fn clipped_shares(self) -> (f32, f32) {
        match self {
            Self::Potential => (0.0, 0.03),
            Self::Value => (0.02, 0.02),
        }
    }
}

/// Whether the number of values matches the size of the field.
fn is_complete(field: &ScalarField) -> bool {
    let [width, height] = field.size;
    width > 0 && height > 0 && width.checked_mul(height) == Some(field.values.len())
}

/// A texture in egui's memory; `key` is the version and size of the field it was made for, and whether the theme is dark.
#[derive(Clone)]
struct Cached {
    key: (u64, [usize; 2], bool),
    texture: TextureHandle,
}

/// The texture of `field`, from the cache if it is up to date; `None` if no value is finite or the field is too large.
fn texture(ctx: &Context, kind: FieldKind, field: &ScalarField, dark: bool) -> Option<TextureHandle> {
    let id = Id::new(("wayfield field", kind));
    let key = (field.version, field.size, dark);
    let cached = ctx.data(|data| data.get_temp::<Cached>(id));
    if let Some(cached) = &cached
        && cached.key == key
    {
        return Some(cached.texture.clone());
    }
    let range = value_range(field, kind.clipped_shares())?;
    let [width, height] = field.size;
    if 2 * width.max(height) > ctx.input(|input| input.max_texture_side) {
        return None;
    }
    let image = field_image(field, range, dark);
    // Setting the old texture avoids flicker: it is drawn until the new image has reached the GPU.
    let options = egui::TextureOptions::LINEAR;
    let texture = match cached {
        Some(Cached { mut texture, .. }) => {
            texture.set(image, options);
            texture
        }
        None => ctx.load_texture(format!("field {kind:?}"), image, options),
    };
    ctx.data_mut(|data| data.insert_temp(id, Cached { key, texture: texture.clone() }));
    Some(texture)
}

/// Draws `field` as a heat map.
pub fn draw_heatmap(canvas: &Canvas, kind: FieldKind, field: &ScalarField, dark: bool) {
    if !is_complete(field) {
        return;
    }
    if let Some(texture) = texture(canvas.painter.ctx(), kind, field, dark) {
        let target = canvas.transform.to_screen_rect(field.min_m, field.max_m);
        let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        canvas.painter.image(texture.id(), target, all, Color32::WHITE);
    }
}

/// Draws arrows downhill on a coarse grid.
pub fn draw_arrows(canvas: &Canvas, field: &ScalarField, color: Color32) {
    if !is_complete(field) {
        return;
    }
    let [width, height] = field.size;
    let step = (width.max(height) / ARROWS).max(1);
    let cell_m = [0, 1].map(|k| (field.max_m[k] - field.min_m[k]) / field.size[k] as f32);
    let length = (canvas.transform.to_screen_length(cell_m[0].abs() * step as f32) * 0.50).min(26.0);
    if length < 4.0 {
        return;
    }
    let stroke = Stroke::new(1.25, color);
    for iy in (step / 2..height).step_by(step) {
        for ix in (step / 2..width).step_by(step) {
            let Some([dx, dy]) = descent(field, ix, iy) else { continue };
            let x_m = field.min_m[0] + (ix as f32 + 0.5) * cell_m[0];
            let y_m = field.min_m[1] + (iy as f32 + 0.5) * cell_m[1];
            let (middle, along) = (canvas.to_screen([x_m, y_m]), screen_direction(dy.atan2(dx)));
            if !canvas.transform.rect.contains(middle) {
                continue;
            }
            let tip = middle + along * length / 2.0;
            canvas.painter.line_segment([tip - along * length, tip - along * 4.9], stroke);
            canvas.arrow_head(tip, along, 5.0, color);
        }
    }
}

/// The unit vector downhill at a cell; `None` if the cell is at the edge of the field, flat, or next to a non-finite value.
fn descent(field: &ScalarField, ix: usize, iy: usize) -> Option<[f32; 2]> {
    let [width, height] = field.size;
    if ix == 0 || iy == 0 || ix + 1 >= width || iy + 1 >= height {
        return None;
    }
    let value = |x: usize, y: usize| field.values.get(y * width + x).copied().unwrap_or(f32::NAN);
    let cell_m = [0, 1].map(|k| (field.max_m[k] - field.min_m[k]) / field.size[k] as f32);
    let dx = (value(ix - 1, iy) - value(ix + 1, iy)) / cell_m[0];
    let dy = (value(ix, iy - 1) - value(ix, iy + 1)) / cell_m[1];
    let slope = dx.hypot(dy);
    (slope.is_finite() && slope > 1e-6).then(|| [dx / slope, dy / slope])
}

#[cfg(test)]
mod tests {
    use super::super::field_image::tests::bowl;
    use super::*;

    #[test]
    fn arrows_point_downhill() {
        let field = bowl();
        let [dx, dy] = descent(&field, 10, 35).expect("a slope");
        let (x, y) = (-2.0 + 10.5 * 0.1, -2.0 + 35.5 * 0.1);
        let to: [f32; 2] = [1.0 - x, -y];
        let far = to[0].hypot(to[1]);
        assert!((dx - to[0] / far).abs() < 1e-3 && (dy - to[1] / far).abs() < 1e-3, "{dx} {dy}");
        assert_eq!(descent(&field, 0, 5), None);
    }

    #[test]
    fn there_is_no_arrow_next_to_a_missing_value() {
        let mut field = bowl();
        field.values[20 * 40 + 21] = f32::NAN;
        assert_eq!(descent(&field, 20, 20), None);
        assert!(descent(&field, 10, 10).is_some());
    }
}
