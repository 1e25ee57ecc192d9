//! The header of the plots: title, unit of the x axis, and the export menu.

use egui::{Align, FontId, Layout, RichText};

use crate::app::commands::{Command, FigureFormat, SaveKind};
use crate::app::screen::theme::{Palette, SMALL};

const ABOUT: &str = "Learning curves over env steps: the control steps of all arenas together. Ctrl+scroll to zoom, drag to \
                     pan, double-click to show everything";

/// Draws the header; returns whether the whole x axis is to be shown again. `can_save` is whether there is
/// data to export. PNG figures are offered only if `has_disk` (not in a browser).
pub(super) fn header_ui(
    ui: &mut egui::Ui,
    can_save: bool,
    has_disk: bool,
    zoomed: bool,
    commands: &mut Vec<Command>,
) -> bool {
    let mut reset = false;
    ui.horizontal(|ui| {
        ui.heading("Learning").on_hover_text(ABOUT);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.add_enabled_ui(can_save, |ui| {
                export_menu_ui(ui, has_disk, commands);
                reset = zoomed && ui.button("Show all").clicked();
            });
            unit_ui(ui);
        });
    });
    reset
}

fn export_menu_ui(ui: &mut egui::Ui, has_disk: bool, commands: &mut Vec<Command>) {
    let png = ("Figure as PNG…", "The success rate, return and goals as pixels, large enough for print");
    let svg = ("Figure as SVG…", "The success rate, return and goals as vectors, for papers and slides");
    let table = ("Episodes as CSV…", "One row per episode");
    let menu = ui.menu_button("Export", |ui| {
        for ((text, about), saved) in [
            (png, SaveKind::Figure(FigureFormat::Png)),
            (svg, SaveKind::Figure(FigureFormat::Svg)),
            (table, SaveKind::Csv),
        ] {
            let is_offered = has_disk || saved != SaveKind::Figure(FigureFormat::Png);
            if is_offered && ui.button(text).on_hover_text(about).clicked() {
                commands.push(Command::SaveDialog(saved));
            }
        }
    });
    menu.response.on_hover_text("Save the learning curves");
}

/// Shows the unit of the x axis, between title and buttons; left out where it does not fit.
fn unit_ui(ui: &mut egui::Ui) {
    let color = Palette::from_ui(ui).weak_text;
    let text = RichText::new("by env steps").size(SMALL).color(color);
    let font = FontId::proportional(SMALL);
    let width = ui.painter().layout_no_wrap(text.text().into(), font, color).size().x;
    if width <= ui.available_width() {
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| ui.label(text).on_hover_text(ABOUT));
    }
}
