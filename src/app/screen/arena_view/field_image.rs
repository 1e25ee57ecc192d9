//! Field overlays as images: the colours of a field, from low to high values.
//!
//! In: a [`ScalarField`]. Out: an image for a texture, and a bar of the same colours.

use egui::{Color32, ColorImage, Mesh, Rect, pos2};

use crate::app::scene::ScalarField;

/// Seven colours from low to high: violet, which nothing else in the arena uses, in even steps of lightness from
/// that of the floor.
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

/// The colour at `part` of the range, 0 (lowest) to 1 (highest).
fn ramp_color(dark: bool, part: f32) -> Color32 {
    let stops = ramp(dark);
    let position = part.clamp(0.0, 1.0) * (stops.len() - 1) as f32;
    let low = (position as usize).min(stops.len() - 2);
    stops[low].lerp_to_gamma(stops[low + 1], position - low as f32).gamma_multiply(0.88)
}

/// The range of values that the colours cover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ValueRange {
    /// The value of the first colour.
    pub low: f32,
    /// The value of the last colour.
    pub high: f32,
    /// Some values are below `low`.
    pub below: bool,
    /// Some values are above `high`.
    pub above: bool,
}

/// The range of the finite values of `field` without the lowest ones (a fraction of `clipped.0`) and the highest ones (a
/// fraction of `clipped.1`), so that a few extremes do not leave all others in one colour. `None` if no value is finite.
pub(super) fn value_range(field: &ScalarField, clipped: (f32, f32)) -> Option<ValueRange> {
    let mut sorted: Vec<f32> = field.values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_unstable_by(f32::total_cmp);
    let (&min, &max) = (sorted.first()?, sorted.last()?);
    let last = sorted.len() - 1;
    let quantile = |level: f32| sorted[((level * last as f32).round() as usize).min(last)];
    let (low, high) = (quantile(clipped.0), quantile(1.0 - clipped.1));
    // If nearly all values are equal, the few others are what matters.
    let (low, high) = if low < high { (low, high) } else { (min, max) };
    Some(ValueRange { low, high, below: min < low, above: max > high })
}

/// The position of `value` in the range, 0 to 1 within it; 0.5 if the range is a single value.
fn fraction(value: f32, ValueRange { low, high, .. }: ValueRange) -> f32 {
    if high > low { (value - low) / (high - low) } else { 0.5 }
}

/// The image of `field`, at twice its resolution if it is coarse, so that the edges around missing values are smooth.
pub(super) fn field_image(field: &ScalarField, range: ValueRange, dark: bool) -> ColorImage {
    let [width, height] = field.size;
    let upscale = if width.max(height) <= 128 { 2 } else { 1 };
    let colors: Vec<Color32> = (0..=255).map(|k| ramp_color(dark, k as f32 / 255.0)).collect();
    let mut image = ColorImage::filled([width * upscale, height * upscale], Color32::TRANSPARENT);
    let neighbours = |k: usize, count: usize| {
        let at = ((k as f32 + 0.5) / upscale as f32 - 0.5).clamp(0.0, (count - 1) as f32);
        let low = at as usize;
        (low, (low + 1).min(count - 1), at - low as f32)
    };
    let (values, coverage) = fill_gaps(field);
    // The first row is the top one in the image, but the bottom one in the field.
    for (row, line) in image.pixels.chunks_exact_mut(width * upscale).rev().enumerate() {
        let (y0, y1, v) = neighbours(row, height);
        for (column, pixel) in line.iter_mut().enumerate() {
            let (x0, x1, u) = neighbours(column, width);
            let interpolate = |of: &[f32]| {
                let lower = of[y0 * width + x0] * (1.0 - u) + of[y0 * width + x1] * u;
                let upper = of[y1 * width + x0] * (1.0 - u) + of[y1 * width + x1] * u;
                lower * (1.0 - v) + upper * v
            };
            let opacity = ((interpolate(&coverage) - 0.35) / 0.3).clamp(0.0, 1.0);
            if opacity > 0.0 {
                let part = fraction(interpolate(&values), range).clamp(0.0, 1.0);
                *pixel = colors[(part * 255.0).round() as usize].gamma_multiply(opacity);
            }
        }
    }
    image
}

/// The values, with gaps filled by a weighted mean of their neighbours, and for each cell the weighted fraction of finite
/// values around it, 0 to 1.
fn fill_gaps(field: &ScalarField) -> (Vec<f32>, Vec<f32>) {
    const TENT: [f32; 5] = [1.0, 2.0, 3.0, 2.0, 1.0];
    let [width, height] = field.size;
    let (mut values, mut coverage) = (field.values.clone(), vec![1.0; field.values.len()]);
    if field.values.iter().all(|value| value.is_finite()) {
        return (values, coverage);
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
            coverage[at] = weight / 81.0;
            if !values[at].is_finite() {
                values[at] = if weight > 0.0 { sum / weight } else { 0.0 };
            }
        }
    }
    (values, coverage)
}

/// A mesh of the colours, from left to right.
pub(super) fn color_bar_mesh(bar: Rect, dark: bool) -> Mesh {
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

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// f = (x - 1)^2 + y^2 over 4 m x 4 m.
    pub fn bowl() -> ScalarField {
        let middle = |k: usize| -2.0 + (k as f32 + 0.5) * 0.1;
        let values = (0..1600).map(|k| (middle(k % 40) - 1.0).powi(2) + middle(k / 40).powi(2)).collect();
        ScalarField { size: [40, 40], min_m: [-2.0; 2], max_m: [2.0; 2], values, version: 1 }
    }

    #[test]
    fn the_range_ignores_non_finite_values() {
        let mut field = bowl();
        field.values[0] = f32::NAN;
        let range = value_range(&field, (0.0, 0.0)).expect("finite values");
        let ValueRange { low, high, below, above } = range;
        assert!(low < 0.01 && high > 11.0 && !below && !above);
        assert_eq!((fraction(low, range), fraction(high, range)), (0.0, 1.0));
        assert_eq!(fraction(3.0, ValueRange { low: 3.0, high: 3.0, ..range }), 0.5);
        field.values.fill(f32::NAN);
        assert_eq!(value_range(&field, (0.0, 0.0)), None);
    }

    #[test]
    fn a_few_extremes_do_not_stretch_the_range() {
        let mut field = bowl();
        for (k, value) in field.values.iter_mut().enumerate() {
            *value = k as f32;
        }
        (field.values[3], field.values[1000]) = (-1e6, 1e6);
        let middle = value_range(&field, (0.02, 0.02)).expect("finite values");
        assert_eq!(middle, ValueRange { low: 32.0, high: 1568.0, below: true, above: true });
        let top = value_range(&field, (0.0, 0.03)).expect("finite values");
        assert_eq!((top.low, top.below, top.above), (-1e6, false, true));
        field.values.fill(2.0);
        field.values[7] = 5.0;
        let few = value_range(&field, (0.02, 0.02)).expect("finite values");
        assert_eq!(
            few,
            ValueRange { low: 2.0, high: 5.0, below: false, above: false },
            "all but one are equal"
        );
    }

    #[test]
    fn the_image_has_the_fields_top_row_on_top_and_is_transparent_where_values_are_missing() {
        let mut field = bowl();
        field.values[36 * 40..].fill(f32::NAN);
        let image =
            field_image(&field, ValueRange { low: 0.0, high: 13.0, below: false, above: false }, false);
        assert_eq!(image.size, [80, 80]);
        assert_eq!(image.pixels[5], Color32::TRANSPARENT, "the top rows are missing");
        assert_eq!(image.pixels[79 * 80 + 60].a(), ramp_color(false, 0.5).a(), "the bottom row is there");
    }
}
