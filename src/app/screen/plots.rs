//! The plots: how the learning goes, on the right.
//!
//! In: the history, read only. Out: a column of small plots over one axis of env steps, and orders to save what they
//! show. What the user looks at (the part of the axis, the plots that are open) is egui's to remember.

use egui::{Align, Id, Layout, RichText};

use super::plot_card::{Seen, Shared};
use super::plot_list::{epsilon, errors, mean_q, returns, success, targets, terms};
use super::theme::{GAP, Inks, SMALL};
use crate::app::desk::Desk;
use crate::app::history::History;
use crate::app::orders::{Order, Saved};

/// What is known from the last frame.
#[derive(Clone, Copy, Debug, Default)]
struct Remembered {
    seen: Seen,
    reset: bool,
}

/// Shows the plots, in a column that scrolls.
pub fn show(ui: &mut egui::Ui, history: &History, desk: &mut Desk, orders: &mut Vec<Order>) {
    let id = Id::new("wayfield plots");
    let mut before: Remembered = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    header(ui, history, desk, orders, &mut before);
    let shared = Shared {
        range: history.range().map_or((0.0, 1.0), |(first, last)| (first as f64, last.max(first + 1) as f64)),
        hovered: before.seen.hovered,
        zoomed: before.seen.zoomed,
        marks: history.marks(),
        reset: before.reset,
    };
    ui.add_space(GAP);
    let mut seen = Seen::default();
    egui::ScrollArea::vertical().id_salt(id).auto_shrink([false, false]).show(ui, |ui| {
        // A little room to the right, for the scroll bar and the last number of the axis.
        ui.set_max_width(ui.available_width() - 2.0 * GAP);
        ui.spacing_mut().item_spacing.y = 2.0 * GAP;
        let curves = history.curves();
        for (index, card) in [success, returns, targets].into_iter().enumerate() {
            add(&mut seen, card(ui, curves, &shared, index == 0));
        }
        more(ui, |ui| {
            for card in [errors, mean_q, epsilon, terms] {
                add(&mut seen, card(ui, curves, &shared, false));
            }
        });
    });
    if seen.hovered != before.seen.hovered {
        // The other cards read their values in the next frame.
        ui.ctx().request_repaint();
    }
    ui.data_mut(|data| data.insert_temp(id, Remembered { seen, reset: false }));
}

fn add(seen: &mut Seen, card: Seen) {
    seen.hovered = seen.hovered.or(card.hovered);
    seen.zoomed |= card.zoomed;
}

fn header(
    ui: &mut egui::Ui,
    history: &History,
    desk: &mut Desk,
    orders: &mut Vec<Order>,
    before: &mut Remembered,
) {
    let inks = Inks::of(ui);
    ui.horizontal(|ui| {
        let about = "How the training goes, over env steps: the control steps of all arenas together. Ctrl and the \
                     mouse wheel zoom into it, dragging moves along, a double click shows all again.";
        ui.heading("Learning").on_hover_text(about);
        ui.label(RichText::new("by env steps").size(SMALL).color(inks.soft)).on_hover_text(about);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if ui.button("×").on_hover_text("Closes the plots.").clicked() {
                desk.plots_open = false;
            }
            ui.add_enabled_ui(history.range().is_some(), |ui| {
                let png = "Saves the learning curve as a picture: success, return and targets.";
                if ui.button("PNG").on_hover_text(png).clicked() {
                    orders.push(Order::SaveDialog(Saved::Png));
                }
                let csv = "Saves a row of numbers for each episode so far, for a spreadsheet.";
                if ui.button("CSV").on_hover_text(csv).clicked() {
                    orders.push(Order::SaveDialog(Saved::Csv));
                }
                if before.seen.zoomed && ui.button("Show all").clicked() {
                    before.reset = true;
                }
            });
        });
    });
}

/// A heading that opens and closes what is under it.
fn more(ui: &mut egui::Ui, body: impl FnOnce(&mut egui::Ui)) {
    use egui::collapsing_header::CollapsingState;
    let id = ui.make_persistent_id("more");
    let state = CollapsingState::load_with_default_open(ui.ctx(), id, false);
    let (_, title, _) = state
        .show_header(ui, |ui| {
            let about = "Loss, Q-values, exploration, and what the reward is made of.";
            let label = egui::Label::new("More").selectable(false).sense(egui::Sense::click());
            ui.add(label).on_hover_text(about)
        })
        .body_unindented(body);
    if title.inner.clicked() {
        let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, false);
        state.toggle(ui);
        state.store(ui.ctx());
    }
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;
    use crate::run::records::{EpisodeRow, EvaluationRow};

    struct State {
        history: History,
        desk: Desk,
        orders: Vec<Order>,
        dressed: bool,
    }

    /// The plots of `history`, with More open.
    fn shown(history: History) -> Harness<'static, State> {
        let state = State { history, desk: Desk::default(), orders: Vec::new(), dressed: false };
        let draw = |ui: &mut egui::Ui, state: &mut State| {
            if state.dressed {
                show(ui, &state.history, &mut state.desk, &mut state.orders);
            } else {
                // Fonts are there from the next frame on.
                super::super::theme::install(ui.ctx());
                state.dressed = true;
            }
        };
        let mut harness = Harness::builder().with_size(egui::vec2(360.0, 1300.0)).build_ui_state(draw, state);
        harness.run_steps(3);
        harness.get_by_label("More").click();
        harness.run_steps(10);
        harness
    }

    fn row(episode: u64, total_return: f64) -> EpisodeRow {
        let env_steps = 100 * episode;
        EpisodeRow {
            episode,
            env_steps,
            total_return,
            loss: Some(0.01),
            mean_q: Some(1.0),
            ..Default::default()
        }
    }

    #[test]
    fn the_buttons_order_what_they_say() {
        let mut history = History::new();
        history.episode(&row(1, 3.0));
        let mut harness = shown(history);
        for button in ["CSV", "PNG", "×"] {
            harness.get_by_label(button).click();
            harness.run_steps(2);
        }
        let expected = [Order::SaveDialog(Saved::Csv), Order::SaveDialog(Saved::Png)];
        assert_eq!(harness.state().orders, expected);
        assert!(!harness.state().desk.plots_open);
    }

    #[test]
    fn before_any_row_nothing_can_be_saved() {
        let mut harness = shown(History::new());
        harness.get_by_label("CSV").click();
        harness.run_steps(2);
        assert!(harness.state().orders.is_empty());
    }

    #[test]
    fn values_are_the_latest_and_those_at_the_pointer() {
        let mut history = History::new();
        for episode in 1..=10 {
            history.episode(&row(episode, 50.0 * episode as f64));
        }
        for (env_steps, success_rate) in [(200, 0.25), (1000, 0.75)] {
            history.evaluation(&EvaluationRow { env_steps, success_rate, ..Default::default() });
        }
        let mut harness = shown(history);
        assert!(harness.query_by_label("75.0%").is_some(), "the latest evaluation");
        assert!(harness.query_by_label("275").is_some(), "the mean return");
        harness.hover_at(egui::pos2(80.0, 130.0));
        harness.run_steps(4);
        assert!(harness.query_by_label("25.0%").is_some(), "the evaluation at the pointer");
        assert!(harness.query_by_label("275").is_none(), "the other cards read there, too");
    }

    #[test]
    fn strange_numbers_are_drawn_without_complaint() {
        for values in [[f64::NAN; 3], [1e300, -1e300, 0.0], [f64::INFINITY, 5.0, 5.0], [0.0; 3]] {
            let mut history = History::new();
            for (episode, value) in (1..).zip(values) {
                let value_row =
                    EpisodeRow { loss: Some(value), td_error: Some(value), ..row(episode, value) };
                history.episode(&EpisodeRow { env_steps: 0, ..value_row });
            }
            history.mark(0, "at the very beginning".into());
            shown(history);
        }
    }
}
