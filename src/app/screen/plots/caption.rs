//! What stands above a plot: its title, its values, what its lines are.
//!
//! In: the card, and where the pointer is on the x axis. Out: two lines of text.

use egui::{Align, Color32, FontId, Layout, RichText};

use super::card::{Card, Pen, Shared, Trace};
use crate::app::screen::theme::{BODY, Inks, SMALL};

/// Between two entries of a legend.
const APART: f32 = 12.0;
/// Cards less wide than this have short legends.
const NARROW: f32 = 300.0;

/// The title, and the first line's value.
pub(super) fn heading(ui: &mut egui::Ui, card: &Card<'_>, shared: &Shared<'_>, inks: Inks) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(card.title).size(BODY).color(inks.ink)).on_hover_text(card.about);
        if let Some(first) = card.traces.first().filter(|_| !card.equals)
            && let Some(value) = reading(card, first, shared.hovered)
        {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                ui.label(RichText::new(value).size(BODY).color(first.colour));
            });
        }
    });
}

/// What the lines are, each in its colour, those beside the first with their values; in fewer words where it is narrow.
/// No entry is ever broken in two.
pub(super) fn legend(ui: &mut egui::Ui, card: &Card<'_>, shared: &Shared<'_>, inks: Inks) {
    let entries = |short: bool| -> Vec<_> {
        let traces = card.traces.iter().enumerate().map(|(index, trace)| {
            let value = reading(card, trace, shared.hovered).filter(|_| card.equals || index > 0);
            let name = if short { trace.short } else { trace.name };
            let text = match value.filter(|_| trace.pen != Pen::Spread) {
                Some(value) => format!("{name} {value}"),
                None => name.to_owned(),
            };
            (text, trace.colour)
        });
        traces.chain(card.reference.map(|(_, name)| (format!("– –  {name}"), inks.soft))).collect()
    };
    let width = |entries: &[(String, Color32)]| -> f32 {
        let font = FontId::proportional(SMALL);
        let one = |text: &String| ui.painter().layout_no_wrap(text.clone(), font.clone(), inks.soft).size().x;
        entries.iter().map(|(text, _)| one(text) + APART).sum::<f32>() - APART
    };
    let room = ui.available_width();
    let long = entries(false);
    // Below a certain width all cards are short, so that the same line has the same name on each.
    let shown = if room < NARROW || width(&long) > room { entries(true) } else { long };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = APART;
        for (text, colour) in shown {
            ui.add(egui::Label::new(RichText::new(text).size(SMALL).color(colour)).extend());
        }
    });
}

/// A trace's value at the pointer, or else its latest.
pub(super) fn reading(card: &Card<'_>, trace: &Trace<'_>, hovered: Option<f64>) -> Option<String> {
    let latest = || trace.series.latest().map(|latest| latest.y);
    let value = hovered.map_or_else(latest, |x| trace.series.near(x))?;
    Some(card.scale.value(value, card.digits))
}
