//! What stands above a plot: its title, its values, what its lines are.
//!
//! In: the card, and where the pointer is on the x axis. Out: two lines of text.

use egui::{Align, Color32, FontId, Layout, RichText};

use super::card::{Card, CardContext, Trace, TraceStyle};
use crate::app::screen::theme::{BODY, Palette, SMALL};

/// Between two entries of a legend.
const APART: f32 = 12.0;
/// Cards less wide than this have short legends.
const NARROW: f32 = 300.0;

/// The title, and the first line's value.
pub(super) fn heading_ui(ui: &mut egui::Ui, card: &Card<'_>, shared: &CardContext<'_>, palette: Palette) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(card.title).size(BODY).color(palette.text)).on_hover_text(card.about);
        if let Some(first) = card.traces.first().filter(|_| !card.no_primary_trace)
            && let Some(value) = value_at(card, first, shared.hovered)
        {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.label(RichText::new(value).size(BODY).color(first.color));
            });
        }
    });
}

/// What the lines are, each in its colour, those beside the first with their values; in fewer words where it is narrow.
/// No entry is ever broken in two.
pub(super) fn legend_ui(ui: &mut egui::Ui, card: &Card<'_>, shared: &CardContext<'_>, palette: Palette) {
    let entries = |short: bool| -> Vec<_> {
        let traces = card.traces.iter().enumerate().map(|(index, trace)| {
            let value = value_at(card, trace, shared.hovered).filter(|_| card.no_primary_trace || index > 0);
            let name = if short { trace.short_name } else { trace.name };
            let text = match value.filter(|_| trace.style != TraceStyle::Spread) {
                Some(value) => format!("{name} {value}"),
                None => name.to_owned(),
            };
            (text, trace.color)
        });
        traces.chain(card.reference.map(|(_, name)| (format!("– –  {name}"), palette.weak_text))).collect()
    };
    let width = |entries: &[(String, Color32)]| -> f32 {
        let font = FontId::proportional(SMALL);
        let one = |text: &String| {
            ui.painter().layout_no_wrap(text.clone(), font.clone(), palette.weak_text).size().x
        };
        entries.iter().map(|(text, _)| one(text) + APART).sum::<f32>() - APART
    };
    let room = ui.available_width();
    let long = entries(false);
    // Below a certain width all cards are short, so that the same line has the same name on each.
    let shown = if room < NARROW || width(&long) > room { entries(true) } else { long };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = APART;
        for (text, color) in shown {
            ui.add(egui::Label::new(RichText::new(text).size(SMALL).color(color)).extend());
        }
    });
}

/// A trace's value at the pointer, or else its latest.
pub(super) fn value_at(card: &Card<'_>, trace: &Trace<'_>, hovered: Option<f64>) -> Option<String> {
    let latest = || trace.series.latest().map(|latest| latest.y);
    let value = hovered.map_or_else(latest, |x| trace.series.value_near(x))?;
    Some(card.scale.format_value(value, card.digits))
}
