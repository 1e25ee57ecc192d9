//! The score above an arena: the driver and its origin, the success rate, and the outcomes.

use egui::{Align2, Color32, FontId, Id, Rangef, Rect, Sense, Ui, WidgetInfo, WidgetType, pos2, vec2};

use crate::app::scene::{ArenaScene, DriverLabel, Score};
use crate::app::screen::numbers::format_percent;
use crate::app::screen::theme::{BODY, HEADING, Palette, SMALL};
use crate::app::screen::widgets::text::paint_truncated;

/// The height of the score, in points.
pub const HEIGHT: f32 = 46.0;

/// The header is moved down by this many points, so that it is closer to its arena than to the toolbar.
const DOWN: f32 = 12.0;
const COLUMN_GAP: f32 = 14.0;
/// If less width than this, in points, remains for the driver, less important columns are left out.
const MIN_NAME: f32 = 110.0;
/// The number of columns that are never left out.
const MIN_COLUMNS: usize = 3;

/// A number with its caption below.
struct Column {
    value: String,
    caption: String,
    color: Color32,
}

/// Draws the score in `header`. The score is as wide as the arena below it, `width` points, but at least 300 points, or as wide
/// as `header` if that is less.
pub fn draw(ui: &Ui, id: Id, header: Rect, width: f32, arena: &ArenaScene) {
    let width = width.max(header.width().min(300.0));
    let across = Rangef::point(header.center().x).expand(width / 2.0);
    let header = Rect::from_x_y_ranges(across, header.translate(vec2(0.0, DOWN)).y_range());
    let (name, origin) = driver(&arena.driver);
    let columns = columns(arena, Palette::from_ui(ui));
    let left = draw_columns(ui, header, &columns);
    draw_driver(ui, header.with_max_x(left), name, origin);
    let spoken: Vec<_> =
        columns.iter().map(|column| format!("{} {}", column.value, column.caption)).collect();
    let words = format!("{name}: {}", spoken.join(", "));
    let response = ui.interact(header, id, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Label, true, &words));
    response.on_hover_text(if origin.is_empty() { name.to_owned() } else { format!("{name}\n{origin}") });
}

/// The driver's name, and its origin; for the user, a hint in place of the origin.
fn driver(driver: &DriverLabel) -> (&str, &str) {
    match driver {
        DriverLabel::Learner => ("Learner", ""),
        DriverLabel::Policy { name, origin } => (name, origin),
        DriverLabel::User => ("You", "Steer with the arrow keys"),
    }
}

/// The columns, the most important first.
fn columns(arena: &ArenaScene, palette: Palette) -> Vec<Column> {
    let score = &arena.score;
    let column = |value: String, caption: &str, color| Column { value, caption: caption.into(), color };
    let Score { collided, timed_out, .. } = *score;
    let attempts = match score.attempts() {
        1 => "of 1 goal".to_owned(),
        attempts => format!("of {attempts} goals"),
    };
    let rate = score.success_rate().map_or("–".into(), format_percent);
    let seconds = score.mean_time_s();
    vec![
        column(rate, &attempts, palette.success),
        column(collided.to_string(), "collided", palette.error),
        column(timed_out.to_string(), "timed out", palette.text),
        column(seconds.map_or("–".into(), |s| format!("{s:.1} s")), "mean time", palette.text),
    ]
}

/// Draws as many columns as fit, from left to right, at the right end of `header`. Returns the left edge of the first one.
fn draw_columns(ui: &Ui, header: Rect, columns: &[Column]) -> f32 {
    let (painter, weak) = (ui.painter_at(header), Palette::from_ui(ui).weak_text);
    let large = FontId::proportional(HEADING);
    let small = FontId::proportional(SMALL);
    let galleys: Vec<_> = columns
        .iter()
        .map(|column| {
            let value = painter.layout_no_wrap(column.value.clone(), large.clone(), column.color);
            (value, painter.layout_no_wrap(column.caption.clone(), small.clone(), weak))
        })
        .collect();
    let width = |(value, caption): &(_, _)| {
        let width = |galley: &std::sync::Arc<egui::Galley>| galley.size().x;
        width(value).max(width(caption)) + COLUMN_GAP
    };
    let mut count = galleys.len();
    let mut total: f32 = galleys.iter().map(&width).sum();
    while count > MIN_COLUMNS && header.width() - total < MIN_NAME {
        count -= 1;
        total -= width(&galleys[count]);
    }
    let first = header.right() - total;
    let mut left = first;
    for column in galleys.into_iter().take(count) {
        let next = left + width(&column);
        let (value, caption) = column;
        let at = |galley: &egui::Galley, y| pos2(next - galley.size().x, y - galley.size().y);
        painter.galley(at(&value, value_line(header)), value, weak);
        painter.galley(at(&caption, caption_line(header)), caption, weak);
        left = next;
    }
    first
}

/// Draws the driver's name and origin in `area`, shortened where necessary.
fn draw_driver(ui: &Ui, area: Rect, name: &str, origin: &str) {
    let (palette, painter) = (Palette::from_ui(ui), ui.painter_at(area));
    let text = |text: &str, size, color, bottom: f32| {
        let at = (pos2(area.left(), bottom), Align2::LEFT_BOTTOM);
        paint_truncated(&painter, at, text, (size, color), area.width());
    };
    if origin.is_empty() {
        return text(name, HEADING, palette.text, area.center().y + HEADING / 2.0 + 2.0);
    }
    text(name, HEADING.min(BODY + 3.0), palette.text, value_line(area));
    text(origin, SMALL, palette.weak_text, caption_line(area));
}

fn value_line(header: Rect) -> f32 {
    header.top() + 24.0
}

fn caption_line(header: Rect) -> f32 {
    header.top() + 38.0
}
