//! The list of plots: the title, lines and colours of each card.

use super::axis::AxisScale;
use super::card::{Card, Trace, TraceStyle};
use crate::app::history::{DownsampledSeries, History, LearningCurves, MovingAverage};
use crate::app::screen::theme::Palette;
use crate::report::run_figure::{PAPER_RETURN, PAPER_SUCCESS_RATE};

/// The opacity of the curves from before a transfer.
const EARLIER_OPACITY: f32 = 0.6;
/// The text of a card whose values come from gradient steps, before the first one.
const BEFORE_LEARNING: &str = "Learning starts once enough experience is collected";

/// The state of the session that decides which texts and reference lines are shown.
#[derive(Clone, Copy, Debug)]
pub struct PlotContext {
    /// Whether the scenario is the paper's Scenario I, so that the paper's results are shown for comparison.
    pub is_paper_scenario_1: bool,
    /// Whether the mode is Train. In all other modes training is suspended.
    pub is_training: bool,
    /// The best policy so far: env steps and success rate (0 to 1) of its evaluation.
    pub best: Option<(u64, f64)>,
    /// Whether there is a disk. Without one (in a browser) figures are saved as SVG.
    pub has_disk: bool,
}

/// The cards that are always shown; while training on a set, also the success in each of its scenarios.
#[must_use]
pub fn main_cards(history: &History, palette: Palette, context: PlotContext) -> Vec<Card<'_>> {
    let curves = history.curves();
    let mut cards =
        vec![success(curves, palette, context), returns(curves, palette, context), goals(curves, palette)];
    if let Some(earlier) = history.earlier() {
        let behind = [&earlier.evaluated, &earlier.return_mean, &earlier.goal_mean];
        for (card, series) in cards.iter_mut().zip(behind) {
            let (color, style) = (palette.accent.gamma_multiply(EARLIER_OPACITY), TraceStyle::Earlier);
            card.traces.push(Trace { name: "before transfer", short_name: "before", series, color, style });
        }
    }
    if curves.evaluated_in.len() > 1 {
        cards.insert(1, success_by_scenario(curves, palette));
    }
    cards
}

/// The cards under "More".
#[must_use]
pub fn more_cards(curves: &LearningCurves, palette: Palette) -> [Card<'_>; 4] {
    [
        errors(curves, palette),
        mean_q(curves, palette),
        epsilon(curves, palette),
        reward_terms(curves, palette),
    ]
}

fn success(curves: &LearningCurves, palette: Palette, context: PlotContext) -> Card<'_> {
    let line = |name, series, color, style| Trace { name, short_name: name, series, color, style };
    Card {
        title: "Success rate",
        about: "Share of goals reached. Greedy: regular evaluations of the policy without random actions, on starts and \
                goals it has not been trained on. In training: over the last 100 episodes, including random actions; \
                the last goal of each episode counts as missed, even if only the time ran out",
        scale: AxisScale::Percent,
        digits: 0,
        traces: vec![
            line("greedy", &curves.evaluated, palette.accent, TraceStyle::Dots),
            line("in training", curves.success.series(), palette.weak_text, TraceStyle::Faint),
        ],
        no_primary_trace: false,
        reference: context.is_paper_scenario_1.then_some(PAPER_SUCCESS_RATE),
        ring: context.best.map(|(env_steps, rate)| (env_steps as f64, rate)),
        empty_text: if context.is_training { "Waiting for the first episodes" } else { "" },
    }
}

fn success_by_scenario(curves: &LearningCurves, palette: Palette) -> Card<'_> {
    let [_, violet] = palette.field_colors;
    let colors = [
        palette.accent,
        palette.success,
        palette.warning,
        violet,
        palette.error,
        palette.weak_text,
        palette.text,
    ];
    let lines = curves.evaluated_in.iter().zip(colors.into_iter().cycle());
    Card {
        title: "Success by scenario",
        about: "Share of goals that the greedy policy reached in the regular evaluations, in each scenario of the set. The \
                levels of a level generator differ from those in training",
        scale: AxisScale::Percent,
        digits: 0,
        traces: lines.map(|((name, series), color)| main_line(name, name, series, color)).collect(),
        no_primary_trace: true,
        reference: None,
        ring: None,
        empty_text: "Waiting for the first evaluation",
    }
}

fn returns(curves: &LearningCurves, palette: Palette, context: PlotContext) -> Card<'_> {
    Card {
        title: "Return per episode",
        about: if context.is_paper_scenario_1 {
            "Sum of the rewards of an episode. The paper's robot settles at 2,500 in Scenario I"
        } else {
            "Sum of the rewards of an episode"
        },
        scale: AxisScale::Linear,
        digits: 0,
        traces: mean_and_spread(&curves.return_mean, &curves.returns, palette),
        no_primary_trace: false,
        reference: context.is_paper_scenario_1.then_some(PAPER_RETURN),
        ring: None,
        empty_text: "",
    }
}

fn goals(curves: &LearningCurves, palette: Palette) -> Card<'_> {
    Card {
        title: "Goals per episode",
        about: "Goals reached before a collision or the time limit",
        scale: AxisScale::FromZero,
        digits: 1,
        traces: mean_and_spread(&curves.goal_mean, &curves.goals, palette),
        no_primary_trace: false,
        reference: None,
        ring: None,
        empty_text: "",
    }
}

fn errors(curves: &LearningCurves, palette: Palette) -> Card<'_> {
    Card {
        title: "Loss and TD error",
        about: "Error of the network's predictions on a logarithmic axis: the loss, and the mean absolute TD error in \
                units of the scaled reward",
        scale: AxisScale::Log10,
        digits: 2,
        traces: vec![
            main_line("loss", "loss", &curves.loss_log, palette.accent),
            main_line("|TD error|", "|TD error|", &curves.td_error_log, palette.weak_text),
        ],
        no_primary_trace: true,
        reference: None,
        ring: None,
        empty_text: BEFORE_LEARNING,
    }
}

fn mean_q(curves: &LearningCurves, palette: Palette) -> Card<'_> {
    Card {
        title: "Mean Q-value",
        about: "Mean Q-value of the actions taken, in units of the scaled reward",
        scale: AxisScale::Linear,
        digits: 2,
        traces: vec![main_line("of the actions taken", "actions taken", &curves.mean_q, palette.accent)],
        no_primary_trace: false,
        reference: None,
        ring: None,
        empty_text: BEFORE_LEARNING,
    }
}

fn epsilon(curves: &LearningCurves, palette: Palette) -> Card<'_> {
    Card {
        title: "Epsilon",
        about: "Probability of a random action (exploration)",
        scale: AxisScale::Unit,
        digits: 2,
        traces: vec![main_line("random actions", "random actions", &curves.epsilon, palette.accent)],
        no_primary_trace: false,
        reference: None,
        ring: None,
        empty_text: "",
    }
}

fn reward_terms(curves: &LearningCurves, palette: Palette) -> Card<'_> {
    Card {
        title: "Reward terms",
        about: "The terms that add up to the return, averaged over 100 episodes: goals reached, collisions, progress \
                towards the goal, and approaching obstacles",
        scale: AxisScale::Linear,
        digits: 0,
        traces: vec![
            main_line("reached", "reached", curves.reached.series(), palette.success),
            main_line("collided", "collided", curves.collided.series(), palette.error),
            main_line("attraction", "attract.", curves.attraction.series(), palette.accent),
            main_line("repulsion", "repuls.", curves.repulsion.series(), palette.warning),
        ],
        no_primary_trace: true,
        reference: None,
        ring: None,
        empty_text: "",
    }
}

fn main_line<'a>(
    name: &'a str,
    short_name: &'a str,
    series: &'a DownsampledSeries,
    color: egui::Color32,
) -> Trace<'a> {
    Trace { name, short_name, series, color, style: TraceStyle::Main }
}

/// The moving average of a value per episode, and the values themselves behind it.
fn mean_and_spread<'a>(
    mean: &'a MovingAverage,
    each: &'a DownsampledSeries,
    palette: Palette,
) -> Vec<Trace<'a>> {
    let (name, short_name) =
        if each.is_full_resolution() { ("each episode", "each") } else { ("min–max", "range") };
    let (color, style) = (palette.weak_text, TraceStyle::Spread);
    vec![
        main_line("mean of 100 episodes", "mean of 100", mean.series(), palette.accent),
        Trace { name, short_name, series: each, color, style },
    ]
}
