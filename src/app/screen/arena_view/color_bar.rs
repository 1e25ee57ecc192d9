//! The colour bar of a field overlay: its title, and the values of its first and last colour.

use egui::{FontId, Rect, Shape, pos2, vec2};

use super::canvas::Canvas;
use super::field_image::{color_bar_mesh, value_range};
use super::field_view::FieldKind;
use crate::app::scene::ScalarField;
use crate::app::screen::numbers::format_value;
use crate::app::screen::theme::SMALL;

/// Draws the colour bar in the upper right corner of the view, on one line if that leaves room for the arena's label on the
/// left, and returns its rectangle; `None` if no value is finite or the view is too small.
pub fn draw(canvas: &Canvas, kind: FieldKind, field: &ScalarField, dark: bool) -> Option<Rect> {
    const BAR: f32 = 110.0;
    const ROOM_FOR_LABEL: f32 = 110.0;
    let range = value_range(field, kind.clipped_shares())?;
    let palette = &canvas.palette;
    let font = FontId::proportional(SMALL);
    let text = |words: String, color| canvas.painter.layout_no_wrap(words, font.clone(), color);
    let (title, low, high) = (
        text(kind.title().into(), palette.text),
        text(limit(range.low, range.below, "≤ "), palette.weak_text),
        text(limit(range.high, range.above, "≥ "), palette.weak_text),
    );
    let scale = low.size().x + BAR + high.size().x + 12.0;
    let (one_line, available) = (title.size().x + 14.0 + scale, canvas.transform.rect.width() - 20.0);
    let lines = if one_line + ROOM_FOR_LABEL <= available { 1.0 } else { 2.0 };
    let width = if lines < 2.0 { one_line } else { scale.max(title.size().x) } + 12.0;
    if width > available || canvas.transform.rect.height() < 160.0 {
        return None;
    }
    let corner = canvas.transform.rect.right_top() + vec2(-8.0 - width, 6.0);
    let strip = Rect::from_min_size(corner, vec2(width, 20.0 * lines));
    canvas.strip_background(strip);
    let y = strip.bottom() - 10.0;
    let centred = |x: f32, y: f32, size: egui::Vec2| pos2(x, y - size.y / 2.0);
    canvas.painter.galley(centred(strip.left() + 6.0, strip.top() + 10.0, title.size()), title, palette.text);
    let mut x = strip.right() - 6.0 - high.size().x;
    canvas.painter.galley(centred(x, y, high.size()), high, palette.weak_text);
    x -= 6.0 + BAR;
    let bar = Rect::from_min_size(pos2(x, y - 4.0), vec2(BAR, 8.0));
    canvas.painter.add(Shape::mesh(color_bar_mesh(bar, dark)));
    x -= 6.0 + low.size().x;
    canvas.painter.galley(centred(x, y, low.size()), low, palette.weak_text);
    Some(strip)
}

/// The number at an end of the colour bar, after `sign` if some values are beyond it.
fn limit(value: f32, beyond: bool, sign: &str) -> String {
    format!("{}{}", if beyond { sign } else { "" }, format_value(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_colour_bar_marks_an_end_that_some_values_exceed() {
        assert_eq!([limit(-3.0, true, "≤ "), limit(4.5, false, "≥ ")], ["≤ \u{2212}3.00", "4.50"]);
    }
}
