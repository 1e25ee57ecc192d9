//! The colour bar of a field overlay: its title, and the values of its first and last colour.

use egui::{FontId, Rect, Shape, pos2, vec2};

use super::canvas::Canvas;
use super::field_image::{color_bar_mesh, value_range};
use super::field_view::FieldKind;
use crate::app::scene::ScalarField;
use crate::app::screen::numbers::format_value;
use crate::app::screen::theme::SMALL;

/// The key to the colours in the upper right corner of the view, on one line if there is room; gives the space it takes.
pub fn draw(canvas: &Canvas, kind: FieldKind, field: &ScalarField, dark: bool) -> Option<Rect> {
    const BAR: f32 = 110.0;
    let whole = value_range(field, kind.outermost())?;
    let palette = &canvas.palette;
    let font = FontId::proportional(SMALL);
    let text = |words: String, ink| canvas.painter.layout_no_wrap(words, font.clone(), ink);
    let (title, low, high) = (
        text(kind.title().into(), palette.text),
        text(limit(whole.low, whole.below, "≤ "), palette.weak_text),
        text(limit(whole.high, whole.above, "≥ "), palette.weak_text),
    );
    let scale = low.size().x + BAR + high.size().x + 12.0;
    let (one_line, room) = (title.size().x + 14.0 + scale, canvas.transform.rect.width() - 20.0);
    let lines = if one_line + 110.0 <= room { 1.0 } else { 2.0 };
    let width = if lines < 2.0 { one_line } else { scale.max(title.size().x) } + 12.0;
    if width > room || canvas.transform.rect.height() < 160.0 {
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

/// The number at an end of the key, and before it that values go beyond.
fn limit(value: f32, beyond: bool, sign: &str) -> String {
    format!("{}{}", if beyond { sign } else { "" }, format_value(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_key_says_that_values_go_beyond_its_ends() {
        assert_eq!([limit(-3.0, true, "≤ "), limit(4.5, false, "≥ ")], ["≤ \u{2212}3.00", "4.50"]);
    }
}
