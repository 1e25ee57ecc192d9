//! The plots on the right: learning curves.
//!
//! In: the history, read only. Out: a column of plots over a shared axis of env steps, and commands to export
//! them. egui remembers which part of the axis is shown.
//!
//! | file | purpose |
//! |---|---|
//! | `list.rs` | the plots: titles, lines, colours |
//! | `card.rs`, `card_view.rs` | one plot: its data, its drawing |
//! | `caption.rs` | title, values and legend above a plot |
//! | `axis.rs`, `marks.rs` | grid lines and tick labels; labels of the vertical marks |
//! | `band.rs` | the area between minimum and maximum |
//! | `header.rs`, `more.rs` | the title with the export buttons; the row that shows more plots |

mod axis;
mod band;
mod caption;
mod card;
mod card_view;
mod header;
mod list;
mod marks;
mod more;
#[cfg(test)]
mod tests;

use egui::{Id, RichText};

use self::card::{CardContext, CardResponse};
use self::card_view::card_ui;
pub use self::list::PlotContext;
use self::list::{main_cards, more_cards};
use crate::app::commands::Command;
use crate::app::history::History;
use crate::app::screen::theme::{GAP, Palette, SMALL};

/// Draws the plots in a column that scrolls; `more_open` is whether those under "More" are shown.
pub fn plots_ui(
    ui: &mut egui::Ui,
    history: &History,
    context: PlotContext,
    more_open: &mut bool,
    commands: &mut Vec<Command>,
) {
    let id = Id::new("wayfield plots");
    // If the pointer was over a card in the last frame, all cards show their values at that x position.
    let before: CardResponse = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    // The scroll bar is in the panel's right margin.
    let width = ui.available_width() - 2.0 * GAP;
    let reset = ui.scope(|ui| {
        ui.set_max_width(width);
        let can_save = history.range().is_some();
        let reset = header::header_ui(ui, can_save, context.has_disk, before.zoomed, commands);
        if !context.is_training {
            paused_note_ui(ui);
        }
        reset
    });
    let shared = CardContext {
        range: history.range().map_or((0.0, 1.0), |(first, last)| (first as f64, last.max(first + 1) as f64)),
        hovered: before.hovered,
        zoomed: before.zoomed,
        marks: history.annotations(),
        reset: reset.inner,
    };
    ui.add_space(GAP);
    let palette = Palette::from_ui(ui);
    let mut seen = CardResponse::default();
    egui::ScrollArea::vertical().id_salt(id).auto_shrink([false, false]).show(ui, |ui| {
        ui.set_max_width(width);
        ui.spacing_mut().item_spacing.y = 2.0 * GAP;
        for (index, card) in main_cards(history, palette, context).iter().enumerate() {
            merge(&mut seen, card_ui(ui, card, &shared, index == 0));
        }
        more::more_ui(ui, more_open, |ui| {
            for card in &more_cards(history.curves(), palette) {
                merge(&mut seen, card_ui(ui, card, &shared, false));
            }
        });
    });
    if seen.hovered != before.hovered {
        ui.ctx().request_repaint();
    }
    ui.data_mut(|data| data.insert_temp(id, seen));
}

fn paused_note_ui(ui: &mut egui::Ui) {
    let text = RichText::new("Training is paused in this mode").size(SMALL);
    ui.label(text.color(Palette::from_ui(ui).weak_text));
}

fn merge(seen: &mut CardResponse, card: CardResponse) {
    seen.hovered = seen.hovered.or(card.hovered);
    seen.zoomed |= card.zoomed;
}
