//! The fields of a generator of random obstacles.

use bevy::math::{Vec2, vec2};
use egui::Ui;

use super::controls::choice_ui;
use super::fields::FieldRows;
use super::number::NumberSpec;
use super::placement_fields::region_rows;
use crate::app::editor::Editor;
use crate::app::screen::widgets::text::weak_text;
use crate::scenario::limits::{CLEARANCE_M, GENERATOR_COUNT};
use crate::scenario::{Generator, Quantity, RandomShape, Region};

/// Shows the fields.
pub fn generator_ui(ui: &mut Ui, editor: &mut Editor, index: usize) {
    let Some(mut generator) = editor.scenario().generators.get(index).cloned() else { return };
    ui.label(weak_text("New random obstacles in every episode, so that the policy generalizes."));
    let mut rows = FieldRows::new(ui);
    rows.count("Count", "Fewer if they do not fit", &mut generator.count, GENERATOR_COUNT);
    random_shape_rows(&mut rows, &mut generator);
    let tip = "Smallest distance to walls and other obstacles. The robot fits through a gap of more than twice the \
               collision range.";
    rows.number("Gap", tip, &mut generator.gap_m, NumberSpec::length(CLEARANCE_M));
    let bounds = editor.scenario().enclosure.bounds_m();
    within_rows(&mut rows, &mut generator.within, bounds);
    rows.commit(editor, &format!("generator {index}"), |scenario| {
        if let Some(old) = scenario.generators.get_mut(index) {
            *old = generator;
        }
    });
}

/// Adds the checkbox of the region, and the corners of the region if there is one.
fn within_rows(rows: &mut FieldRows<'_>, within: &mut Option<Region>, bounds: (Vec2, Vec2)) {
    let mut has_region = within.is_some();
    rows.checkbox("Limit to a region", "Otherwise anywhere in the enclosure", &mut has_region);
    match within {
        Some(region) if has_region => region_rows(rows, &mut region.min_m, &mut region.max_m),
        _ => *within = has_region.then(|| middle_half(bounds)),
    }
}

/// The middle of a box, half as wide and half as high, rounded to 1 mm.
fn middle_half((low, high): (Vec2, Vec2)) -> Region {
    let quarter = |a: f32, b: f32| ((a + (b - a) / 4.0) * 1000.0).round() / 1000.0;
    Region {
        min_m: vec2(quarter(low.x, high.x), quarter(low.y, high.y)),
        max_m: vec2(quarter(high.x, low.x), quarter(high.y, low.y)),
    }
}

fn random_shape_rows(rows: &mut FieldRows<'_>, generator: &mut Generator) {
    let boxes = matches!(generator.shape, RandomShape::Rectangle { .. });
    let kinds = [(false, "Circles", "Circular obstacles"), (true, "Boxes", "Boxes at random angles")];
    if let Some(boxes) = choice_ui(rows.ui, "Shape", boxes, &kinds) {
        generator.shape = converted_shape(boxes, &generator.shape);
        rows.mark_changed("shape");
    }
    let mut range = |name: &str, (low, high): &mut (f32, f32)| {
        rows.pair(
            name,
            "Smallest and largest",
            [("min", low), ("max", high)],
            NumberSpec::of(Quantity::Size),
        );
    };
    match &mut generator.shape {
        RandomShape::Circle { radius_m } => range("Radius", radius_m),
        RandomShape::Rectangle { width_m, height_m } => {
            range("Width", width_m);
            range("Height", height_m);
        }
    }
}

/// Turns circles into boxes of the same width and height, or boxes into circles of the same width.
fn converted_shape(boxes: bool, shape: &RandomShape) -> RandomShape {
    match (boxes, shape) {
        (true, RandomShape::Circle { radius_m: (low, high) }) => {
            let sizes = (2.0 * low, 2.0 * high);
            RandomShape::Rectangle { width_m: sizes, height_m: sizes }
        }
        (false, RandomShape::Rectangle { width_m: (low, high), .. }) => {
            RandomShape::Circle { radius_m: (low / 2.0, high / 2.0) }
        }
        (_, same) => same.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_region_is_the_middle_of_the_enclosure() {
        let region = middle_half((vec2(10.0, 0.0), vec2(16.0, 6.0)));
        assert_eq!((region.min_m, region.max_m), (vec2(11.5, 1.5), vec2(14.5, 4.5)));
    }
}
