//! Icon buttons. The icons are drawn with lines and discs, because the typeface has no icons.
//!
//! In: icon, style, size, accessible name, tooltip. Out: the response; screen readers and tests find the
//! button by its name.

use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Response, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo,
};
use egui::{WidgetType, pos2, vec2};

use crate::app::screen::theme::{BODY, Palette};

/// An icon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// A triangle: resume.
    Play,
    /// Two bars: pause.
    Pause,
    /// A triangle and a bar: one step.
    Step,
    /// A sun: light theme.
    Sun,
    /// A moon: dark theme.
    Moon,
    /// A question mark: help.
    Help,
    /// A window with a left panel, and whether that panel is open.
    LeftPanel(bool),
    /// A window with a right panel, and whether that panel is open.
    RightPanel(bool),
    /// A die: random seed.
    Dice,
    /// A cross: close.
    Close,
    /// Four corners: fit to the view.
    Fit,
}

/// The emphasis of a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ButtonStyle {
    /// The icon only, with a frame while hovered.
    Quiet,
    /// A frame, like that of text buttons.
    Framed,
    /// The accent colour, for the suggested next action.
    Primary,
}

/// Draws a square icon button, `side` points wide, with the accessible name `name` and the tooltip `tip`.
pub fn icon_button_ui(
    ui: &mut Ui,
    icon: Icon,
    style: ButtonStyle,
    side: f32,
    name: &str,
    tip: &str,
) -> Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(side), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, ui.is_enabled(), name));
    if ui.is_rect_visible(rect) {
        let palette = Palette::from_ui(ui);
        let visuals = ui.style().interact(&response);
        let lit = response.hovered() || response.has_focus() || response.is_pointer_button_down_on();
        let (fill, stroke, color) = match style {
            ButtonStyle::Quiet if lit => (visuals.weak_bg_fill, visuals.bg_stroke, palette.text),
            ButtonStyle::Quiet => (ui.visuals().panel_fill, Stroke::NONE, palette.weak_text),
            ButtonStyle::Framed => (visuals.weak_bg_fill, visuals.bg_stroke, palette.text),
            ButtonStyle::Primary if lit => {
                (palette.accent.lerp_to_gamma(palette.text, 0.15), Stroke::NONE, palette.on_accent)
            }
            ButtonStyle::Primary => (palette.accent, Stroke::NONE, palette.on_accent),
        };
        if style != ButtonStyle::Quiet || lit {
            ui.painter().rect(rect, visuals.corner_radius, fill, stroke, egui::StrokeKind::Inside);
        }
        let radius = if style == ButtonStyle::Quiet { 7.0 } else { side * 0.22 };
        paint(ui.painter(), icon, rect.center(), radius, color, fill);
    }
    response.on_hover_text(tip)
}

/// Draws `icon` around `centre` with half width `radius`, in `color` on `fill`.
fn paint(painter: &Painter, icon: Icon, centre: Pos2, radius: f32, color: Color32, fill: Color32) {
    let at = |x: f32, y: f32| centre + vec2(x, y) * radius;
    let line = Stroke::new(1.5, color);
    let bar = |x: f32| {
        painter.rect_filled(Rect::from_min_max(at(x - 0.28, -0.95), at(x + 0.28, 0.95)), 1.0, color);
    };
    let arrow = |from: f32, to: f32, half: f32| {
        let corners = vec![at(from, -half), at(to, 0.0), at(from, half)];
        painter.add(Shape::convex_polygon(corners, color, Stroke::NONE));
    };
    match icon {
        Icon::Play => arrow(-0.7, 1.05, 1.0),
        Icon::Pause => [-0.5, 0.5].into_iter().for_each(bar),
        Icon::Step => {
            arrow(-0.95, 0.45, 0.85);
            bar(0.75);
        }
        Icon::Sun => {
            painter.circle_filled(centre, radius * 0.48, color);
            for k in 0..8 {
                let ray = Vec2::angled(k as f32 * std::f32::consts::FRAC_PI_4) * radius;
                painter.line_segment([centre + ray * 0.72, centre + ray * 1.08], line);
            }
        }
        Icon::Moon => {
            painter.circle_filled(centre, radius * 0.92, color);
            painter.circle_filled(at(0.45, -0.35), radius * 0.78, fill);
        }
        Icon::Help => {
            painter.circle_stroke(centre, radius * 1.1, line);
            painter.text(centre, Align2::CENTER_CENTER, "?", FontId::proportional(BODY - 2.0), color);
        }
        Icon::LeftPanel(open) => panel(painter, [at(-1.1, -0.85), at(1.1, 0.85)], [-1.1, -0.35], open, color),
        Icon::RightPanel(open) => panel(painter, [at(-1.1, -0.85), at(1.1, 0.85)], [0.35, 1.1], open, color),
        Icon::Dice => {
            let square = Rect::from_center_size(centre, Vec2::splat(radius * 2.2));
            painter.rect_stroke(square, 2.5, line, egui::StrokeKind::Middle);
            for (x, y) in [(-0.5, -0.5), (0.5, 0.5), (0.0, 0.0), (-0.5, 0.5), (0.5, -0.5)] {
                painter.circle_filled(at(x, y), radius * 0.19, color);
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

/// Draws a window with a side panel from `strip[0]` to `strip[1]`, in units in which the window's half width
/// is 1.1.
fn panel(painter: &Painter, [min, max]: [Pos2; 2], strip: [f32; 2], open: bool, color: Color32) {
    let rect = Rect::from_min_max(min, max);
    painter.rect_stroke(rect, 2.0, Stroke::new(1.2, color), egui::StrokeKind::Middle);
    let [from, to] = strip.map(|x| rect.center().x + x / 2.2 * rect.width());
    let side = Rect::from_min_max(pos2(from, rect.min.y), pos2(to, rect.max.y));
    if open {
        painter.rect_filled(side, 1.0, color);
    } else {
        let x = if strip[0] < 0.0 { side.max.x } else { side.min.x };
        painter.vline(x, side.y_range(), Stroke::new(1.2, color));
    }
}
