//! The plots: how the learning goes, on the right.
//!
//! In: the history, read only. Out: a column of small plots over one axis of env steps, and orders to save what they
//! show. What the user looks at (the part of the axis, the plots that are open) is egui's to remember.
//!
//! | file | duty |
//! |---|---|
//! | `list.rs` | which plots there are, in which words and colours |
//! | `card.rs` | one of them |
//! | `caption.rs` | what stands above it: title, values, what its lines are |
//! | `axis.rs` | round numbers on the axes, and the words at the marks |
//! | `band.rs` | the area between least and greatest |

mod axis;
mod band;
mod caption;
mod card;
mod list;

use std::f32::consts::FRAC_PI_2;

use egui::collapsing_header::CollapsingState;
use egui::text::{LayoutJob, TextWrapping};
use egui::{Align, Align2, FontId, Id, Layout, RichText, Sense, Vec2, WidgetInfo, WidgetType, pos2, vec2};

use self::card::{CardContext, CardResponse};
use self::list::{epsilon_ui, errors_ui, goals_ui, mean_q_ui, returns_ui, reward_terms_ui, success_ui};
use crate::app::commands::{Command, SaveKind};
use crate::app::history::History;
use crate::app::screen::theme::{BODY, GAP, Palette, SMALL};

/// Under what circumstances the curves are seen.
#[derive(Clone, Copy, Debug)]
pub struct PlotContext {
    /// The world is the paper's, so its levels can be compared with.
    pub is_paper_scenario_1: bool,
    /// Training goes on; if not, it rests while something else is driven.
    pub training: bool,
    /// There is a disk; if not, the browser is given pictures to draw itself.
    pub has_disk: bool,
}

/// What is known from the last frame.
#[derive(Clone, Copy, Debug, Default)]
struct Remembered {
    seen: CardResponse,
    reset: bool,
}

/// Shows the plots, in a column that scrolls.
pub fn plots_ui(ui: &mut egui::Ui, history: &History, when: PlotContext, commands: &mut Vec<Command>) {
    let id = Id::new("wayfield plots");
    let mut before: Remembered = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    // Room at the right, in the panel's margin, for the scroll bar.
    let width = ui.available_width() - 2.0 * GAP;
    ui.scope(|ui| {
        ui.set_max_width(width);
        header_ui(ui, history, when.has_disk, commands, &mut before);
        if !when.training {
            let text = RichText::new("Training rests meanwhile.").size(SMALL);
            ui.label(text.color(Palette::from_ui(ui).weak_text));
        }
    });
    let shared = CardContext {
        range: history.range().map_or((0.0, 1.0), |(first, last)| (first as f64, last.max(first + 1) as f64)),
        hovered: before.seen.hovered,
        zoomed: before.seen.zoomed,
        marks: history.annotations(),
        reset: before.reset,
        when,
    };
    ui.add_space(GAP);
    let mut seen = CardResponse::default();
    egui::ScrollArea::vertical().id_salt(id).auto_shrink([false, false]).show(ui, |ui| {
        ui.set_max_width(width);
        ui.spacing_mut().item_spacing.y = 2.0 * GAP;
        let curves = history.curves();
        for (index, card) in [success_ui, returns_ui, goals_ui].into_iter().enumerate() {
            add(&mut seen, card(ui, curves, &shared, index == 0));
        }
        more_ui(ui, |ui| {
            for card in [errors_ui, mean_q_ui, epsilon_ui, reward_terms_ui] {
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

fn add(seen: &mut CardResponse, card: CardResponse) {
    seen.hovered = seen.hovered.or(card.hovered);
    seen.zoomed |= card.zoomed;
}

fn header_ui(
    ui: &mut egui::Ui,
    history: &History,
    has_disk: bool,
    commands: &mut Vec<Command>,
    before: &mut Remembered,
) {
    let palette = Palette::from_ui(ui);
    ui.horizontal(|ui| {
        let about = "How the training goes, over env steps: the control steps of all arenas together. Ctrl and the \
                     mouse wheel zoom into it, dragging moves along, a double click shows all again.";
        ui.heading("Learning").on_hover_text(about);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            ui.add_enabled_ui(history.range().is_some(), |ui| {
                let png = "Saves the learning curve as a picture: success, return and goals.";
                if ui.button(if has_disk { "PNG" } else { "SVG" }).on_hover_text(png).clicked() {
                    commands.push(Command::SaveDialog(SaveKind::Png));
                }
                let csv = "Saves a row of numbers for each episode so far, for a spreadsheet.";
                if ui.button("CSV").on_hover_text(csv).clicked() {
                    commands.push(Command::SaveDialog(SaveKind::Csv));
                }
                if before.seen.zoomed && ui.button("Show all").clicked() {
                    before.reset = true;
                }
            });
            // Between them, if there is room.
            let text = RichText::new("by env steps").size(SMALL).color(palette.weak_text);
            let font = FontId::proportional(SMALL);
            let width = ui.painter().layout_no_wrap(text.text().into(), font, palette.weak_text).size().x;
            if width <= ui.available_width() {
                let between = Layout::left_to_right(Align::Center);
                ui.with_layout(between, |ui| ui.label(text).on_hover_text(about));
            }
        });
    });
}

/// A row that opens and closes what is under it.
fn more_ui(ui: &mut egui::Ui, body: impl FnOnce(&mut egui::Ui)) {
    let id = ui.make_persistent_id("more");
    let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, false);
    let palette = Palette::from_ui(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 26.0), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::CollapsingHeader, ui.is_enabled(), "More"));
    if response.clicked() {
        state.toggle(ui);
    }
    let lit = response.hovered() || response.has_focus();
    if lit {
        ui.painter().rect_filled(rect.expand2(vec2(6.0, 0.0)), 4.0, palette.control);
    }
    // A triangle that turns from the right to below.
    let middle = rect.left_center() + vec2(4.0, 0.0);
    let along = Vec2::angled(state.openness(ui.ctx()) * FRAC_PI_2);
    let corners = [along * 5.0, along.rot90() * 5.0 - along * 3.5, -along.rot90() * 5.0 - along * 3.5];
    let ink = if lit { palette.text } else { palette.weak_text };
    let corners = corners.map(|corner| middle + corner).to_vec();
    ui.painter().add(egui::Shape::convex_polygon(corners, ink, egui::Stroke::NONE));
    // As much of it as has room.
    let word = |x, text: &str, size, ink| {
        let mut job = LayoutJob::simple_singleline(text.into(), FontId::proportional(size), ink);
        job.wrap = TextWrapping::truncate_at_width(rect.right() - x);
        let galley = ui.painter().layout_job(job);
        let place = Align2::LEFT_CENTER.anchor_size(pos2(x, rect.center().y), galley.size());
        ui.painter().galley(place.min, galley, ink);
        place
    };
    let more = word(rect.left() + 16.0, "More", BODY, palette.text);
    word(more.right() + 2.0 * GAP, "loss, Q-values, exploration, reward", SMALL, palette.weak_text);
    response.on_hover_text("Loss, Q-values, exploration, and what the reward is made of.");
    state.show_body_unindented(ui, body);
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    use super::*;
    use crate::run::metric_rows::{EpisodeRow, EvaluationRow};

    struct State {
        history: History,
        when: PlotContext,
        commands: Vec<Command>,
        dressed: bool,
    }

    /// The plots of `history` in training in the paper's world, with More open.
    fn shown(history: History) -> Harness<'static, State> {
        let when = PlotContext { is_paper_scenario_1: true, training: true, has_disk: true };
        let state = State { history, when, commands: Vec::new(), dressed: false };
        let draw = |ui: &mut egui::Ui, state: &mut State| {
            if state.dressed {
                plots_ui(ui, &state.history, state.when, &mut state.commands);
            } else {
                // Fonts are there from the next frame on.
                crate::app::screen::theme::install(ui.ctx());
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
        history.push_episode(&row(1, 3.0));
        let mut harness = shown(history);
        for button in ["CSV", "PNG"] {
            harness.get_by_label(button).click();
            harness.run_steps(2);
        }
        let expected = [Command::SaveDialog(SaveKind::Csv), Command::SaveDialog(SaveKind::Png)];
        assert_eq!(harness.state().commands, expected);
    }

    #[test]
    fn before_any_row_nothing_can_be_saved() {
        let mut harness = shown(History::new());
        harness.get_by_label("CSV").click();
        harness.run_steps(2);
        assert!(harness.state().commands.is_empty());
    }

    #[test]
    fn the_papers_levels_are_for_the_papers_world_alone() {
        let mut history = History::new();
        history.push_episode(&row(1, 3.0));
        let mut harness = shown(history);
        let levels = |harness: &Harness<'_, State>| harness.query_all_by_label_contains("paper ").count();
        assert_eq!(levels(&harness), 2);
        harness.state_mut().when.is_paper_scenario_1 = false;
        harness.run_steps(2);
        assert_eq!(levels(&harness), 0);
    }

    #[test]
    fn no_episode_is_promised_while_training_rests() {
        let mut harness = shown(History::new());
        let rests = "Training rests meanwhile.";
        assert!(harness.query_by_label(rests).is_none());
        harness.state_mut().when.training = false;
        harness.run_steps(2);
        assert!(harness.query_by_label(rests).is_some());
    }

    #[test]
    fn values_are_the_latest_and_those_at_the_pointer() {
        let mut history = History::new();
        for episode in 1..=10 {
            history.push_episode(&row(episode, 50.0 * episode as f64));
        }
        for (env_steps, success_rate) in [(200, 0.25), (1000, 0.75)] {
            history.push_evaluation(&EvaluationRow { env_steps, success_rate, ..Default::default() });
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
                history.push_episode(&EpisodeRow { env_steps: 0, ..value_row });
            }
            history.annotate(0, "at the very beginning".into());
            shown(history);
        }
    }
}
