//! The caption above a plot: title and value, and the legend.

use egui::{Align, Color32, FontId, Layout, RichText};

use super::card::{Card, CardContext, Trace, TraceStyle};
use crate::app::screen::theme::{BODY, Palette, SMALL};

/// The gap between two entries of the legend, in points.
const ENTRY_GAP: f32 = 12.0;
/// Cards narrower than this, in points, have short names in the legend.
const NARROW: f32 = 300.0;

/// Draws the title, the value of the first line, and its best value.
pub(super) fn heading_ui(ui: &mut egui::Ui, card: &Card<'_>, shared: &CardContext<'_>, palette: Palette) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(card.title).size(BODY).color(palette.text)).on_hover_text(card.about);
        if let Some(first) = card.traces.first().filter(|_| !card.no_primary_trace)
            && let Some(value) = value_at(card, first, shared.hovered)
        {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.label(RichText::new(value).size(BODY).color(first.color));
                if let Some((_, best)) = card.ring {
                    let best = format!("best {}", card.scale.format_value(best, card.digits));
                    ui.label(RichText::new(best).size(SMALL).color(palette.success));
                }
            });
        }
    });
}

/// Draws the legend: the name of each line in its colour, with its value unless that is next to the title. Spreads and lines
/// from an earlier training run have no value. Short names are used if the full ones do not fit. An entry is never wrapped.
pub(super) fn legend_ui(ui: &mut egui::Ui, card: &Card<'_>, shared: &CardContext<'_>, palette: Palette) {
    let entries = |short: bool| -> Vec<_> {
        let traces = card.traces.iter().enumerate().map(|(index, trace)| {
            let value = value_at(card, trace, shared.hovered).filter(|_| card.no_primary_trace || index > 0);
            let name = if short { trace.short_name } else { trace.name };
            let text =
                match value.filter(|_| !matches!(trace.style, TraceStyle::Spread | TraceStyle::Earlier)) {
                    Some(value) => format!("{name} {value}"),
                    None => name.to_owned(),
                };
            (text, trace.color)
        });
        let reference =
            card.reference.map(|reference| (format!("– –  {}", reference.label), palette.weak_text));
        traces.chain(reference).collect()
    };
    let width = |entries: &[(String, Color32)]| -> f32 {
        let font = FontId::proportional(SMALL);
        let one = |text: &String| {
            ui.painter().layout_no_wrap(text.clone(), font.clone(), palette.weak_text).size().x
        };
        entries.iter().map(|(text, _)| one(text) + ENTRY_GAP).sum::<f32>() - ENTRY_GAP
    };
    let available = ui.available_width();
    let long = entries(false);
    // In narrow windows all cards use short names, so that a line has the same name on each.
    let shown = if available < NARROW || width(&long) > available { entries(true) } else { long };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = ENTRY_GAP;
        for (text, color) in shown {
            ui.add(egui::Label::new(RichText::new(text).size(SMALL).color(color)).extend());
        }
    });
}

/// The value of a line at the pointer, or its latest value if the pointer is on no plot.
pub(super) fn value_at(card: &Card<'_>, trace: &Trace<'_>, hovered: Option<f64>) -> Option<String> {
    let latest = || trace.series.latest().map(|latest| latest.y);
    let value = hovered.map_or_else(latest, |x| trace.series.value_near(x))?;
    Some(card.scale.format_value(value, card.digits))
}
