//! Tests of the plots: export buttons, reference lines, values at the pointer, non-finite values.

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use super::*;
use crate::app::commands::{FigureFormat, SaveKind};
use crate::run::metric_rows::{EpisodeRow, EvaluationRow};

struct State {
    history: History,
    context: PlotContext,
    more_open: bool,
    commands: Vec<Command>,
    theme_installed: bool,
}

/// The plots of `history` while training in the paper's Scenario I, with "More" open.
fn plots_of(history: History) -> Harness<'static, State> {
    let context = PlotContext { is_paper_scenario_1: true, is_training: true, best: None, has_disk: true };
    let state = State { history, context, more_open: false, commands: Vec::new(), theme_installed: false };
    let draw = |ui: &mut egui::Ui, state: &mut State| {
        if state.theme_installed {
            plots_ui(ui, &state.history, state.context, &mut state.more_open, &mut state.commands);
        } else {
            // Fonts are available from the next frame on.
            crate::app::screen::theme::install(ui.ctx());
            state.theme_installed = true;
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
    EpisodeRow { episode, env_steps, total_return, loss: Some(0.01), mean_q: Some(1.0), ..Default::default() }
}

#[test]
fn the_export_menu_opens_the_save_dialog() {
    let mut history = History::new();
    history.push_episode(&row(1, 3.0));
    let mut harness = plots_of(history);
    for (entry, saved) in [
        ("Figure as PNG…", SaveKind::Figure(FigureFormat::Png)),
        ("Figure as SVG…", SaveKind::Figure(FigureFormat::Svg)),
        ("Episodes as CSV…", SaveKind::Csv),
    ] {
        for label in ["Export", entry] {
            harness.get_by_label(label).click();
            harness.run_steps(3);
        }
        assert_eq!(std::mem::take(&mut harness.state_mut().commands), [Command::SaveDialog(saved)]);
        assert!(harness.query_by_label(entry).is_none(), "the menu closes");
    }
}

#[test]
fn before_the_first_episode_nothing_can_be_exported() {
    let mut harness = plots_of(History::new());
    harness.get_by_label("Export").click();
    harness.run_steps(3);
    assert!(harness.query_by_label("Episodes as CSV…").is_none());
}

#[test]
fn the_papers_results_are_shown_in_the_papers_scenario_only() {
    let mut history = History::new();
    history.push_episode(&row(1, 3.0));
    let mut harness = plots_of(history);
    let results = |harness: &Harness<'_, State>| harness.query_all_by_label_contains("paper ").count();
    assert_eq!(results(&harness), 2);
    harness.state_mut().context.is_paper_scenario_1 = false;
    harness.run_steps(2);
    assert_eq!(results(&harness), 0);
}

#[test]
fn the_best_policy_and_the_curves_before_a_transfer_are_shown() {
    let mut history = History::new();
    for (env_steps, success_rate) in [(200, 0.75), (1000, 0.25)] {
        history.push_evaluation(&EvaluationRow { env_steps, success_rate, ..Default::default() });
    }
    let earlier = history.to_earlier();
    let mut harness = plots_of(history);
    assert!(harness.query_by_label_contains("best").is_none());
    assert!(harness.query_by_label_contains("before transfer").is_none());
    harness.state_mut().context.best = Some((200, 0.75));
    harness.state_mut().history.set_earlier(earlier);
    harness.run_steps(2);
    assert!(harness.query_by_label_contains("75.0%").is_some());
    assert_eq!(harness.query_all_by_label_contains("before").count(), 3, "on the three main plots");
}

#[test]
fn a_note_shows_that_training_is_paused() {
    let mut harness = plots_of(History::new());
    let paused = "Training is paused in this mode";
    assert!(harness.query_by_label(paused).is_none());
    harness.state_mut().context.is_training = false;
    harness.run_steps(2);
    assert!(harness.query_by_label(paused).is_some());
}

#[test]
fn cards_show_the_latest_values_or_those_at_the_pointer() {
    let mut history = History::new();
    for episode in 1..=10 {
        history.push_episode(&row(episode, 50.0 * episode as f64));
    }
    for (env_steps, success_rate) in [(200, 0.25), (1000, 0.75)] {
        history.push_evaluation(&EvaluationRow { env_steps, success_rate, ..Default::default() });
    }
    let mut harness = plots_of(history);
    assert!(harness.query_by_label("75.0%").is_some(), "the latest evaluation");
    assert!(harness.query_by_label("275").is_some(), "the mean return");
    harness.hover_at(egui::pos2(80.0, 130.0));
    harness.run_steps(4);
    assert!(harness.query_by_label("25.0%").is_some(), "the evaluation at the pointer");
    assert!(harness.query_by_label("275").is_none(), "the other cards show the value there too");
}

#[test]
fn non_finite_and_huge_values_are_drawn_without_a_panic() {
    for values in [[f64::NAN; 3], [1e300, -1e300, 0.0], [f64::INFINITY, 5.0, 5.0], [0.0; 3]] {
        let mut history = History::new();
        for (episode, value) in (1..).zip(values) {
            let value_row = EpisodeRow { loss: Some(value), td_error: Some(value), ..row(episode, value) };
            history.push_episode(&EpisodeRow { env_steps: 0, ..value_row });
        }
        history.annotate(0, "at the very beginning".into());
        plots_of(history);
    }
}
