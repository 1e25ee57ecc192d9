//! The list of plots: what each shows, in which words and colours.
//!
//! In: the curves. Out: a card each ([`card`](super::card)).

use super::axis::AxisScale;
use super::card::{self, Card, CardContext, CardResponse, Trace, TraceStyle};
use crate::app::history::{DownsampledSeries, LearningCurves};
use crate::app::screen::theme::Palette;

/// The paper's success rate of PER-D3QN in Scenario I (table 2), 0 to 1.
const PAPER_SUCCESS: f64 = 0.96;
/// The return per episode at which the paper's PER-D3QN settles in Scenario I (fig. 9), as in
/// `assets/experiments/fig9.ron`.
const PAPER_RETURN: f64 = 2500.0;

/// The share of goals that were reached.
pub fn success_ui(
    ui: &mut egui::Ui,
    curves: &LearningCurves,
    shared: &CardContext<'_>,
    labelled: bool,
) -> CardResponse {
    let palette = Palette::from_ui(ui);
    let card = Card {
        title: "Success rate",
        about: "The share of goals that were reached. Greedy: the policy alone, tested now and then on navigations \
                it has never seen. In training: over the last 100 episodes, random actions included; the navigation \
                with which an episode ends counts as failed, even if it was only out of time.",
        scale: AxisScale::Percent,
        digits: 0,
        traces: &[
            Trace {
                name: "greedy",
                short_name: "greedy",
                series: &curves.evaluated,
                color: palette.accent,
                style: TraceStyle::Dots,
            },
            Trace {
                name: "in training",
                short_name: "in training",
                series: curves.success.series(),
                color: palette.weak_text,
                style: TraceStyle::Faint,
            },
        ],
        no_primary_trace: false,
        reference: shared.when.is_paper_scenario_1.then_some((PAPER_SUCCESS, "paper 96%")),
        empty_text: if shared.when.training { "The first episodes end in a moment" } else { "" },
    };
    card::card_ui(ui, &card, shared, labelled)
}

/// What a [`TraceStyle::Spread`] shows, and in short.
fn spread(series: &DownsampledSeries) -> (&'static str, &'static str) {
    if series.is_full_resolution() { ("each episode", "each") } else { ("lowest to highest", "range") }
}

/// The sum of an episode's rewards.
pub fn returns_ui(
    ui: &mut egui::Ui,
    curves: &LearningCurves,
    shared: &CardContext<'_>,
    labelled: bool,
) -> CardResponse {
    let palette = Palette::from_ui(ui);
    let card = Card {
        title: "Return per episode",
        about: "The sum of an episode's rewards. The paper's robot settles at 2,500 in Scenario I.",
        scale: AxisScale::Linear,
        digits: 0,
        traces: &[
            Trace {
                name: "mean of 100 episodes",
                short_name: "mean of 100",
                series: curves.return_mean.series(),
                color: palette.accent,
                style: TraceStyle::Main,
            },
            Trace {
                name: spread(&curves.returns).0,
                short_name: spread(&curves.returns).1,
                series: &curves.returns,
                color: palette.weak_text,
                style: TraceStyle::Spread,
            },
        ],
        no_primary_trace: false,
        reference: shared.when.is_paper_scenario_1.then_some((PAPER_RETURN, "paper 2,500")),
        empty_text: "",
    };
    card::card_ui(ui, &card, shared, labelled)
}

/// Targets reached in an episode.
pub fn goals_ui(
    ui: &mut egui::Ui,
    curves: &LearningCurves,
    shared: &CardContext<'_>,
    labelled: bool,
) -> CardResponse {
    let palette = Palette::from_ui(ui);
    let card = Card {
        title: "Targets per episode",
        about: "How many goals are reached before a collision or the time limit.",
        scale: AxisScale::FromZero,
        digits: 1,
        traces: &[
            Trace {
                name: "mean of 100 episodes",
                short_name: "mean of 100",
                series: curves.goal_mean.series(),
                color: palette.accent,
                style: TraceStyle::Main,
            },
            Trace {
                name: spread(&curves.goals).0,
                short_name: spread(&curves.goals).1,
                series: &curves.goals,
                color: palette.weak_text,
                style: TraceStyle::Spread,
            },
        ],
        no_primary_trace: false,
        reference: None,
        empty_text: "",
    };
    card::card_ui(ui, &card, shared, labelled)
}

/// The loss and the TD error.
pub fn errors_ui(
    ui: &mut egui::Ui,
    curves: &LearningCurves,
    shared: &CardContext<'_>,
    labelled: bool,
) -> CardResponse {
    let palette = Palette::from_ui(ui);
    let card = Card {
        title: "Loss and error",
        about: "How far the network's predictions are off, on a logarithmic axis: the loss that is minimized, and the \
                mean absolute TD error, in units of reward as they are learnt.",
        scale: AxisScale::Log10,
        digits: 2,
        traces: &[
            Trace {
                name: "loss",
                short_name: "loss",
                series: &curves.loss_log,
                color: palette.accent,
                style: TraceStyle::Main,
            },
            Trace {
                name: "|TD error|",
                short_name: "|TD error|",
                series: &curves.td_error_log,
                color: palette.weak_text,
                style: TraceStyle::Main,
            },
        ],
        no_primary_trace: true,
        reference: None,
        empty_text: "Learning begins when enough has been seen",
    };
    card::card_ui(ui, &card, shared, labelled)
}

/// What the network expects.
pub fn mean_q_ui(
    ui: &mut egui::Ui,
    curves: &LearningCurves,
    shared: &CardContext<'_>,
    labelled: bool,
) -> CardResponse {
    let palette = Palette::from_ui(ui);
    let card = Card {
        title: "Mean Q-value",
        about: "What the network expects of the actions taken, in units of reward as they are learnt.",
        scale: AxisScale::Linear,
        digits: 2,
        traces: &[Trace {
            name: "of the actions taken",
            short_name: "actions taken",
            series: &curves.mean_q,
            color: palette.accent,
            style: TraceStyle::Main,
        }],
        no_primary_trace: false,
        reference: None,
        empty_text: "Learning begins when enough has been seen",
    };
    card::card_ui(ui, &card, shared, labelled)
}

/// How much is explored.
pub fn epsilon_ui(
    ui: &mut egui::Ui,
    curves: &LearningCurves,
    shared: &CardContext<'_>,
    labelled: bool,
) -> CardResponse {
    let palette = Palette::from_ui(ui);
    let card = Card {
        title: "Epsilon",
        about: "The chance that an action is a random one, to explore.",
        scale: AxisScale::Unit,
        digits: 2,
        traces: &[Trace {
            name: "random actions",
            short_name: "random actions",
            series: &curves.epsilon,
            color: palette.accent,
            style: TraceStyle::Main,
        }],
        no_primary_trace: false,
        reference: None,
        empty_text: "",
    };
    card::card_ui(ui, &card, shared, labelled)
}

/// What the return is made of.
pub fn reward_terms_ui(
    ui: &mut egui::Ui,
    curves: &LearningCurves,
    shared: &CardContext<'_>,
    labelled: bool,
) -> CardResponse {
    let palette = Palette::from_ui(ui);
    let term =
        |name, short_name, series, color| Trace { name, short_name, series, color, style: TraceStyle::Main };
    let card = Card {
        title: "Reward by its terms",
        about: "What an episode's return is made of, as means of 100 episodes: for reaching goals, for the \
                collision, for coming nearer to the goal, for coming nearer to obstacles.",
        scale: AxisScale::Linear,
        digits: 0,
        traces: &[
            term("reached", "reached", curves.reached.series(), palette.success),
            term("collided", "collided", curves.collided.series(), palette.error),
            term("attraction", "attract.", curves.attraction.series(), palette.accent),
            term("repulsion", "repuls.", curves.repulsion.series(), palette.warning),
        ],
        no_primary_trace: true,
        reference: None,
        empty_text: "",
    };
    card::card_ui(ui, &card, shared, labelled)
}
