//! A field as a picture: its colours, from low values to high ones.
//!
//! In: a [`ScalarField`]. Out: an image for a texture, and a bar of the same colours for the key.

use egui::{Color32, ColorImage, Mesh, Rect, pos2};

use crate::app::scene::ScalarField;

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
fn ramp_color(dark: bool, part: f32) -> Color32 {
    if !part.is_finite() {
        return Color32::TRANSPARENT;
    }
    let stops = ramp(dark);
    let place = part.clamp(0.0, 1.0) * (stops.len() - 1) as f32;
    let low = (place as usize).min(stops.len() - 2);
    stops[low].lerp_to_gamma(stops[low + 1], place - low as f32).gamma_multiply(0.88)
}

/// From which value to which the colours go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ValueRange {
    /// The value of the first colour.
    pub low: f32,
    /// The value of the last colour.
    pub high: f32,
    /// Some values are less than the first colour's.
    pub below: bool,
    /// Some values are more than the last colour's.
    pub above: bool,
}

/// The span of the values that are numbers without the outermost parts of them, `parts.0` of the least and `parts.1` of
/// the greatest: a few extremes don't take the colours from all others.
pub(super) fn value_range(field: &ScalarField, parts: (f32, f32)) -> Option<ValueRange> {
    let mut numbers: Vec<f32> = field.values.iter().copied().filter(|value| value.is_finite()).collect();
    numbers.sort_unstable_by(f32::total_cmp);
    let (&least, &most) = (numbers.first()?, numbers.last()?);
    let last = numbers.len() - 1;
    let at = |part: f32| numbers[((part * last as f32).round() as usize).min(last)];
    let (low, high) = (at(parts.0), at(1.0 - parts.1));
    // Where nearly all are alike, the few others are what there is to see.
    let (low, high) = if low < high { (low, high) } else { (least, most) };
    Some(ValueRange { low, high, below: least < low, above: most > high })
}

fn part_of(value: f32, ValueRange { low, high, .. }: ValueRange) -> f32 {
    if high > low || !value.is_finite() { (value - low) / (high - low) } else { 0.5 }
}

/// The field's colours, finer than the field itself where it is coarse, so that the edge of where the robot cannot be is
/// smooth.
pub(super) fn field_image(field: &ScalarField, whole: ValueRange, dark: bool) -> ColorImage {
    let [width, height] = field.size;
    let finer = if width.max(height) <= 128 { 2 } else { 1 };
    let colors: Vec<Color32> = (0..=255).map(|k| ramp_color(dark, k as f32 / 255.0)).collect();
    let mut image = ColorImage::filled([width * finer, height * finer], Color32::TRANSPARENT);
    let place = |k: usize, count: usize| {
        let at = ((k as f32 + 0.5) / finer as f32 - 0.5).clamp(0.0, (count - 1) as f32);
        let low = at as usize;
        (low, (low + 1).min(count - 1), at - low as f32)
    };
    let (values, there) = fill_gaps(field);
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
                *pixel = colors[(part * 255.0).round() as usize].gamma_multiply(clear);
            }
        }
    }
    image
}

/// The values with those missing taken from their neighbours, and how much of each cell's surroundings is there.
fn fill_gaps(field: &ScalarField) -> (Vec<f32>, Vec<f32>) {
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

/// The colours from left to right.
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
    fn the_ramp_spans_the_numbers_only() {
        let mut field = bowl();
        field.values[0] = f32::NAN;
        let whole = value_range(&field, (0.0, 0.0)).expect("numbers");
        let ValueRange { low, high, below, above } = whole;
        assert!(low < 0.01 && high > 11.0 && !below && !above);
        assert_eq!(ramp_color(true, f32::NAN), Color32::TRANSPARENT);
        assert_eq!((part_of(low, whole), part_of(high, whole)), (0.0, 1.0));
        assert_eq!(part_of(3.0, ValueRange { low: 3.0, high: 3.0, ..whole }), 0.5);
        field.values.fill(f32::NAN);
        assert_eq!(value_range(&field, (0.0, 0.0)), None);
    }

    #[test]
    fn extremes_do_not_take_the_colours_from_the_others() {
        let mut field = bowl();
        for (k, value) in field.values.iter_mut().enumerate() {
            *value = k as f32;
        }
        (field.values[3], field.values[1000]) = (-1e6, 1e6);
        let middle = value_range(&field, (0.02, 0.02)).expect("numbers");
        assert_eq!(middle, ValueRange { low: 32.0, high: 1568.0, below: true, above: true });
        let top = value_range(&field, (0.0, 0.03)).expect("numbers");
        assert_eq!((top.low, top.below, top.above), (-1e6, false, true));
        field.values.fill(2.0);
        field.values[7] = 5.0;
        let few = value_range(&field, (0.02, 0.02)).expect("numbers");
        assert_eq!(
            few,
            ValueRange { low: 2.0, high: 5.0, below: false, above: false },
            "all but one are alike"
        );
    }

    #[test]
    fn the_picture_has_the_fields_top_at_its_top_and_holes_where_it_has() {
        let mut field = bowl();
        field.values[36 * 40..].fill(f32::NAN);
        let image =
            field_image(&field, ValueRange { low: 0.0, high: 13.0, below: false, above: false }, false);
        assert_eq!(image.size, [80, 80]);
        assert_eq!(image.pixels[5], Color32::TRANSPARENT, "the uppermost rows are missing");
        assert_eq!(image.pixels[79 * 80 + 60].a(), ramp_color(false, 0.5).a(), "the lowest is there");
    }
}
