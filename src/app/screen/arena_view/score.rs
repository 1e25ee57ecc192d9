//! The score: who drives an arena, and how well so far, in a line above it.
//!
//! In: an [`ArenaScene`]. Out: the driver's name, the goals reached and the collisions.

use egui::{Align2, FontId, Rangef, Rect, Ui, vec2};

use crate::app::scene::{ArenaScene, DriverLabel};
use crate::app::screen::theme::{BODY, HEADING, Palette};

/// How much room is left for it above the arena's view.
pub const HEIGHT: f32 = 38.0;

fn name(driver: &DriverLabel) -> &str {
    match driver {
        DriverLabel::Learner => "The learner",
        DriverLabel::Policy(name) => name,
        DriverLabel::User => "You",
    }
}

/// Draws it in `header`, as wide as the arena below, or a little wider if that is narrow.
pub fn draw(ui: &Ui, header: Rect, width: f32, arena: &ArenaScene) {
    let width = width.max(header.width().min(300.0));
    let across = Rangef::point(header.center().x).expand(width / 2.0);
    let header = Rect::from_x_y_ranges(across, header.translate(vec2(0.0, 14.0)).y_range());
    let (palette, painter) = (Palette::from_ui(ui), ui.painter_at(header));
    let mut right = header.right_center() + vec2(0.0, 1.0);
    let words = |count: u32, one: &str, many: &str| format!(" {}", if count == 1 { one } else { many });
    for (count, what, ink) in [
        (arena.collisions, words(arena.collisions, "collision", "collisions"), palette.error),
        (arena.goals_reached, words(arena.goals_reached, "goal", "goals"), palette.success),
    ] {
        let plain = FontId::proportional(BODY);
        let label = painter.text(right, Align2::RIGHT_CENTER, what, plain, palette.weak_text);
        let figure = FontId::proportional(HEADING);
        let at = label.left_center() - vec2(0.0, 1.0);
        let number = painter.text(at, Align2::RIGHT_CENTER, count, figure, ink);
        right.x = number.left() - 14.0;
    }
    let room = (right.x - header.left()).max(0.0);
    let left = painter.with_clip_rect(Rect::from_min_size(header.min, vec2(room, header.height())));
    let font = FontId::proportional(HEADING);
    left.text(header.left_center(), Align2::LEFT_CENTER, name(&arena.driver), font, palette.text);
}
