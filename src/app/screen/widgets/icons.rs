//! Icons, and the buttons that bear them: drawn with lines and discs, since the typeface has none.
//!
//! In: which, how large, what it does in words. Out: a button that a screen reader and a test find by those words.

use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo,
};
use egui::{WidgetType, pos2, vec2};

use crate::app::screen::theme::{BODY, Palette};

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// Time goes on.
    Play,
    /// Time stands still.
    Pause,
    /// One step.
    Step,
    /// Go light.
    Sun,
    /// Go dark.
    Moon,
    /// A question mark.
    Help,
    /// The panel on the left; whether it is open.
    LeftPanel(bool),
    /// The panel on the right; whether it is open.
    RightPanel(bool),
    /// Another seed.
    Dice,
    /// Away with it.
    Close,
    /// The whole of it.
    Fit,
}

/// How loud a button is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ButtonStyle {
    /// The icon alone, framed under the pointer.
    Quiet,
    /// Framed, as other buttons are.
    Framed,
    /// In the accent: what to press next.
    Primary,
}

/// A square button with an icon; `name` is what it does, in a word or two, and `tip` says more.
pub fn icon_button_ui(
    ui: &mut Ui,
    icon: Icon,
    tone: ButtonStyle,
    side: f32,
    name: &str,
    tip: &str,
) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, ui.is_enabled(), name));
    if ui.is_rect_visible(rect) {
        let palette = Palette::from_ui(ui);
        let look = ui.style().interact(&response);
        let lit = response.hovered() || response.has_focus() || response.is_pointer_button_down_on();
        let (fill, stroke, ink) = match tone {
            ButtonStyle::Quiet if lit => (look.weak_bg_fill, look.bg_stroke, palette.text),
            ButtonStyle::Quiet => (ui.visuals().panel_fill, Stroke::NONE, palette.weak_text),
            ButtonStyle::Framed => (look.weak_bg_fill, look.bg_stroke, palette.text),
            ButtonStyle::Primary if lit => {
                (palette.accent.lerp_to_gamma(palette.text, 0.15), Stroke::NONE, palette.on_accent)
            }
            ButtonStyle::Primary => (palette.accent, Stroke::NONE, palette.on_accent),
        };
        if tone != ButtonStyle::Quiet || lit {
            ui.painter().rect(rect, look.corner_radius, fill, stroke, egui::StrokeKind::Inside);
        }
        let radius = if tone == ButtonStyle::Quiet { 7.0 } else { side * 0.22 };
        paint(ui.painter(), icon, rect.center(), radius, ink, fill);
    }
    response.on_hover_text(tip)
}

/// Draws `icon` about `centre`, `radius` to each side, in `ink` on `fill`.
fn paint(painter: &Painter, icon: Icon, centre: Pos2, radius: f32, ink: Color32, fill: Color32) {
    let at = |x: f32, y: f32| centre + vec2(x, y) * radius;
    let line = Stroke::new(1.5, ink);
    let bar = |x: f32| {
        painter.rect_filled(Rect::from_min_max(at(x - 0.28, -0.95), at(x + 0.28, 0.95)), 1.0, ink);
    };
    let arrow = |from: f32, to: f32, half: f32| {
        let corners = vec![at(from, -half), at(to, 0.0), at(from, half)];
        painter.add(Shape::convex_polygon(corners, ink, Stroke::NONE));
    };
    match icon {
        Icon::Play => arrow(-0.7, 1.05, 1.0),
        Icon::Pause => [-0.5, 0.5].into_iter().for_each(bar),
        Icon::Step => {
            arrow(-0.95, 0.45, 0.85);
            bar(0.75);
        }
        Icon::Sun => {
            painter.circle_filled(centre, radius * 0.48, ink);
            for k in 0..8 {
                let way = Vec2::angled(k as f32 * std::f32::consts::FRAC_PI_4) * radius;
                painter.line_segment([centre + way * 0.72, centre + way * 1.08], line);
            }
        }
        Icon::Moon => {
            painter.circle_filled(centre, radius * 0.92, ink);
            painter.circle_filled(at(0.45, -0.35), radius * 0.78, fill);
        }
        Icon::Help => {
            painter.circle_stroke(centre, radius * 1.1, line);
            painter.text(centre, Align2::CENTER_CENTER, "?", FontId::proportional(BODY - 2.0), ink);
        }
        Icon::LeftPanel(open) => panel(painter, [at(-1.1, -0.85), at(1.1, 0.85)], [-1.1, -0.35], open, ink),
        Icon::RightPanel(open) => panel(painter, [at(-1.1, -0.85), at(1.1, 0.85)], [0.35, 1.1], open, ink),
        Icon::Dice => {
            let square = Rect::from_center_size(centre, Vec2::splat(radius * 2.2));
            painter.rect_stroke(square, 2.5, line, egui::StrokeKind::Middle);
            for (x, y) in [(-0.5, -0.5), (0.5, 0.5), (0.0, 0.0), (-0.5, 0.5), (0.5, -0.5)] {
                painter.circle_filled(at(x, y), radius * 0.19, ink);
            }
        }
        Icon::Close => {
            painter.line_segment([at(-0.6, -0.6), at(0.6, 0.6)], line);
            painter.line_segment([at(-0.6, 0.6), at(0.6, -0.6)], line);
        }
        Icon::Fit => {
            for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let corner = [at(x * 0.3, y), at(x, y), at(x, y * 0.3)];
                painter.add(Shape::line(corner.into(), line));
            }
        }
    }
}

/// A window's outline with one side marked, `strip` from and to of its half width 1.1.
fn panel(painter: &Painter, [min, max]: [Pos2; 2], strip: [f32; 2], open: bool, ink: Color32) {
    let rect = Rect::from_min_max(min, max);
    painter.rect_stroke(rect, 2.0, Stroke::new(1.2, ink), egui::StrokeKind::Middle);
    let [from, to] = strip.map(|x| rect.center().x + x / 2.2 * rect.width());
    let side = Rect::from_min_max(pos2(from, rect.min.y), pos2(to, rect.max.y));
    if open {
        painter.rect_filled(side, 1.0, ink);
    } else {
        let x = if strip[0] < 0.0 { side.max.x } else { side.min.x };
        painter.vline(x, side.y_range(), Stroke::new(1.2, ink));
    }
}
