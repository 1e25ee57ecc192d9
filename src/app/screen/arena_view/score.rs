//! The score above an arena: the name of the driver, goals reached, collisions.

use egui::{Align2, FontId, Rangef, Rect, Ui, vec2};

use crate::app::scene::{ArenaScene, DriverLabel};
use crate::app::screen::theme::{BODY, HEADING, Palette};

/// The height of the score, in points.
pub const HEIGHT: f32 = 38.0;

fn name(driver: &DriverLabel) -> &str {
    match driver {
        DriverLabel::Learner => "Learner",
        DriverLabel::Policy(name) => name,
        DriverLabel::User => "You",
    }
}

/// Draws the score in `header`, `width` points wide like the arena below, or wider if that is narrow.
pub fn draw(ui: &Ui, header: Rect, width: f32, arena: &ArenaScene) {
    let width = width.max(header.width().min(300.0));
    let across = Rangef::point(header.center().x).expand(width / 2.0);
    let header = Rect::from_x_y_ranges(across, header.translate(vec2(0.0, 14.0)).y_range());
    let (palette, painter) = (Palette::from_ui(ui), ui.painter_at(header));
    let mut right = header.right_center() + vec2(0.0, 1.0);
    let noun = |count: u32, one: &str, many: &str| format!(" {}", if count == 1 { one } else { many });
    for (count, noun, color) in [
        (arena.collisions, noun(arena.collisions, "collision", "collisions"), palette.error),
        (arena.goals_reached, noun(arena.goals_reached, "goal", "goals"), palette.success),
    ] {
        let plain = FontId::proportional(BODY);
        let label = painter.text(right, Align2::RIGHT_CENTER, noun, plain, palette.weak_text);
        let figure = FontId::proportional(HEADING);
        let at = label.left_center() - vec2(0.0, 1.0);
        let number = painter.text(at, Align2::RIGHT_CENTER, count, figure, color);
        right.x = number.left() - 14.0;
    }
    let name_width = (right.x - header.left()).max(0.0);
    let left = painter.with_clip_rect(Rect::from_min_size(header.min, vec2(name_width, header.height())));
    let font = FontId::proportional(HEADING);
    left.text(header.left_center(), Align2::LEFT_CENTER, name(&arena.driver), font, palette.text);
}
