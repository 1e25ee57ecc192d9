//! Fields over the plane: the potential and the network's value, as colours, as arrows, and their key.
//!
//! In: a [`ScalarField`]. Out: a texture that is made again only when the field's version changes, arrows down its slope, and
//! a bar that says what the colours mean.

use egui::{Color32, Context, Id, Rect, Stroke, TextureHandle, pos2};

use super::canvas::Canvas;
use super::field_image::{field_image, value_range};
use super::transform::screen_direction;
use crate::app::scene::ScalarField;

/// Arrows along the longer side.
const ARROWS: usize = 14;

/// Which field: each has its own texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FieldKind {
    /// U of eq. (4).
    Potential,
    /// V(s) of the network.
    Value,
}

impl FieldKind {
    /// What the key calls it.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Potential => "Potential U, eq. (4)",
            Self::Value => "Value V(s) here, with this heading",
        }
    }

    /// The parts of the least and the greatest values that share a colour: a network's extremes at either end, and of
    /// the potential what is close to an obstacle.
    pub fn outermost(self) -> (f32, f32) {
        match self {
            Self::Potential => (0.0, 0.03),
            Self::Value => (0.02, 0.02),
        }
    }
}

/// Whether the field has as many values as it says.
fn is_whole(field: &ScalarField) -> bool {
    let [width, height] = field.size;
    width > 0 && height > 0 && width.checked_mul(height) == Some(field.values.len())
}

#[derive(Clone)]
struct Cached {
    of: (u64, [usize; 2], bool),
    texture: TextureHandle,
}

fn texture(ctx: &Context, kind: FieldKind, field: &ScalarField, dark: bool) -> Option<TextureHandle> {
    let id = Id::new(("wayfield field", kind));
    let of = (field.version, field.size, dark);
    let cached = ctx.data(|data| data.get_temp::<Cached>(id));
    if let Some(cached) = &cached
        && cached.of == of
    {
        return Some(cached.texture.clone());
    }
    let whole = value_range(field, kind.outermost())?;
    let [width, height] = field.size;
    if 2 * width.max(height) > ctx.input(|input| input.max_texture_side) {
        return None;
    }
    let image = field_image(field, whole, dark);
    // The old one is drawn until the new colours have reached the GPU, which may take a frame: no flicker.
    let options = egui::TextureOptions::LINEAR;
    let texture = match cached {
        Some(Cached { mut texture, .. }) => {
            texture.set(image, options);
            texture
        }
        None => ctx.load_texture(format!("field {kind:?}"), image, options),
    };
    ctx.data_mut(|data| data.insert_temp(id, Cached { of, texture: texture.clone() }));
    Some(texture)
}

/// Draws `field` as colours.
pub fn draw_heatmap(canvas: &Canvas, kind: FieldKind, field: &ScalarField, dark: bool) {
    if !is_whole(field) {
        return;
    }
    if let Some(texture) = texture(canvas.painter.ctx(), kind, field, dark) {
        let place = canvas.transform.to_screen_rect(field.min_m, field.max_m);
        let all = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        canvas.painter.image(texture.id(), place, all, Color32::WHITE);
    }
}

/// Draws which way `field` falls, as arrows on a coarse grid.
pub fn draw_arrows(canvas: &Canvas, field: &ScalarField, ink: Color32) {
    if !is_whole(field) {
        return;
    }
    let [width, height] = field.size;
    let step = (width.max(height) / ARROWS).max(1);
    let cell_m = [0, 1].map(|k| (field.max_m[k] - field.min_m[k]) / field.size[k] as f32);
    let length = (canvas.transform.to_screen_length(cell_m[0].abs() * step as f32) * 0.50).min(26.0);
    if length < 4.0 {
        return;
    }
    let stroke = Stroke::new(1.25, ink);
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
            canvas.arrow_head(tip, along, 5.0, ink);
        }
    }
}

/// The unit vector down the slope of `field` at a cell; none at its edge, where it is flat, or beside what is no number.
fn descent(field: &ScalarField, ix: usize, iy: usize) -> Option<[f32; 2]> {
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

#[cfg(test)]
mod tests {
    use super::super::field_image::tests::bowl;
    use super::*;

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
    }
}
