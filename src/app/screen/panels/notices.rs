//! Notices: confirmations, warnings and errors, over the bottom of the arena.
//!
//! In: the notices, oldest first. Out: [`Command::DismissNotice`] when one is closed.

use egui::{Align, Align2, Area, Color32, Frame, Id, Layout, Margin, Order, Rect, Stroke, Ui, vec2};

use crate::app::app_status::{Notice, Severity};
use crate::app::commands::Command;
use crate::app::screen::theme::{GAP, Palette};
use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};

/// The maximum number of notices shown. More would hide the arena.
const MAX_SHOWN: usize = 4;
/// Largest width of a notice, in points.
const WIDTH: f32 = 520.0;
/// Width of the coloured left edge of a notice, in points.
const EDGE: f32 = 3.0;

/// Draws the notices over the bottom of `arena`.
pub fn notices_ui(ui: &mut Ui, arena: Rect, notices: &[Notice], commands: &mut Vec<Command>) {
    if notices.is_empty() {
        return;
    }
    let width = WIDTH.min(arena.width() - 4.0 * GAP).max(120.0);
    Area::new(Id::new("notices"))
        .order(Order::Foreground)
        .pivot(Align2::CENTER_BOTTOM)
        .fixed_pos(arena.center_bottom() - vec2(0.0, 2.0 * GAP))
        .constrain_to(arena)
        .show(ui.ctx(), |ui| {
            ui.set_width(width);
            ui.spacing_mut().item_spacing.y = GAP;
            let hidden = notices.len().saturating_sub(MAX_SHOWN);
            for (k, notice) in notices.iter().enumerate().skip(hidden) {
                ui.push_id(k, |ui| notice_ui(ui, notice, commands));
            }
        });
}

fn notice_ui(ui: &mut Ui, notice: &Notice, commands: &mut Vec<Command>) {
    let palette = Palette::from_ui(ui);
    let color = match notice.severity {
        Severity::Info => palette.accent,
        Severity::Warning => palette.warning,
        Severity::Error => palette.error,
    };
    let frame = Frame::new()
        .fill(palette.panel)
        .stroke(Stroke::new(1.0, palette.border))
        .corner_radius(6.0)
        .shadow(ui.visuals().popup_shadow)
        .inner_margin(Margin { left: 14, right: 8, top: 7, bottom: 7 });
    let shown = frame.show(ui, |ui| {
        ui.with_layout(Layout::right_to_left(Align::Min), |ui| {
            if icons::icon_button_ui(ui, Icon::Close, ButtonStyle::Quiet, 22.0, "Dismiss", "Dismiss")
                .clicked()
            {
                commands.push(Command::DismissNotice(notice.clone()));
            }
            ui.with_layout(Layout::left_to_right(Align::Min), |ui| {
                egui::ScrollArea::vertical().max_height(180.0).auto_shrink([false, true]).show(ui, |ui| {
                    ui.add_space(3.0);
                    ui.add(egui::Label::new(&notice.text).wrap().selectable(true));
                });
            });
        });
    });
    let mut mark = shown.response.rect;
    mark.max.x = mark.min.x + EDGE;
    let radius = egui::CornerRadius { nw: 6, sw: 6, ne: 0, se: 0 };
    ui.painter().rect(mark, radius, color, Stroke::new(0.0, Color32::TRANSPARENT), egui::StrokeKind::Inside);
}
