//! The list of plots: what each shows, in which words and colours.
//!
//! In: the curves. Out: a card each ([`card`](super::card)).

use super::axis::Scale;
use super::card::{self, Card, Pen, Seen, Shared, Trace};
use crate::app::history::{Curves, Series};
use crate::app::screen::theme::Inks;

/// The paper's success rate of PER-D3QN in Scenario I (table 2), 0 to 1.
const PAPER_SUCCESS: f64 = 0.96;
/// The return per episode at which the paper's PER-D3QN settles in Scenario I (fig. 9), as in
/// `assets/experiments/fig9.ron`.
const PAPER_RETURN: f64 = 2500.0;

/// The share of targets that were reached.
pub fn success(ui: &mut egui::Ui, curves: &Curves, shared: &Shared<'_>, labelled: bool) -> Seen {
    let inks = Inks::of(ui);
    let card = Card {
        title: "Success rate",
        about: "The share of targets that were reached. Greedy: the policy alone, tested now and then on navigations \
                it has never seen. In training: over the last 100 episodes, random actions included; the navigation \
                with which an episode ends counts as failed, even if it was only out of time.",
        scale: Scale::Percent,
        digits: 0,
        traces: &[
            Trace {
                name: "greedy",
                short: "greedy",
                series: &curves.evaluated,
                colour: inks.accent,
                pen: Pen::Dots,
            },
            Trace {
                name: "in training",
                short: "in training",
                series: curves.success.series(),
                colour: inks.soft,
                pen: Pen::Faint,
            },
        ],
        equals: false,
        reference: shared.when.papers_world.then_some((PAPER_SUCCESS, "paper 96%")),
        empty: if shared.when.training { "The first episodes end in a moment" } else { "" },
    };
    card::show(ui, &card, shared, labelled)
}

/// What a [`Pen::Spread`] shows, and in short.
fn spread(series: &Series) -> (&'static str, &'static str) {
    if series.each_row() { ("each episode", "each") } else { ("lowest to highest", "range") }
}

/// The sum of an episode's rewards.
pub fn returns(ui: &mut egui::Ui, curves: &Curves, shared: &Shared<'_>, labelled: bool) -> Seen {
    let inks = Inks::of(ui);
    let card = Card {
        title: "Return per episode",
        about: "The sum of an episode's rewards. The paper's robot settles at 2,500 in Scenario I.",
        scale: Scale::Linear,
        digits: 0,
        traces: &[
            Trace {
                name: "mean of 100 episodes",
                short: "mean of 100",
                series: curves.return_mean.series(),
                colour: inks.accent,
                pen: Pen::Main,
            },
            Trace {
                name: spread(&curves.returns).0,
                short: spread(&curves.returns).1,
                series: &curves.returns,
                colour: inks.soft,
                pen: Pen::Spread,
            },
        ],
        equals: false,
        reference: shared.when.papers_world.then_some((PAPER_RETURN, "paper 2,500")),
        empty: "",
    };
    card::show(ui, &card, shared, labelled)
}

/// Targets reached in an episode.
pub fn targets(ui: &mut egui::Ui, curves: &Curves, shared: &Shared<'_>, labelled: bool) -> Seen {
    let inks = Inks::of(ui);
    let card = Card {
        title: "Targets per episode",
        about: "How many targets are reached before a collision or the time limit.",
        scale: Scale::FromZero,
        digits: 1,
        traces: &[
            Trace {
                name: "mean of 100 episodes",
                short: "mean of 100",
                series: curves.target_mean.series(),
                colour: inks.accent,
                pen: Pen::Main,
            },
            Trace {
                name: spread(&curves.targets).0,
                short: spread(&curves.targets).1,
                series: &curves.targets,
                colour: inks.soft,
                pen: Pen::Spread,
            },
        ],
        equals: false,
        reference: None,
        empty: "",
    };
    card::show(ui, &card, shared, labelled)
}

/// The loss and the TD error.
pub fn errors(ui: &mut egui::Ui, curves: &Curves, shared: &Shared<'_>, labelled: bool) -> Seen {
    let inks = Inks::of(ui);
    let card = Card {
        title: "Loss and error",
        about: "How far the network's predictions are off, on a logarithmic axis: the loss that is minimized, and the \
                mean absolute TD error, in units of reward as they are learnt.",
        scale: Scale::Decades,
        digits: 2,
        traces: &[
            Trace {
                name: "loss",
                short: "loss",
                series: &curves.loss_log,
                colour: inks.accent,
                pen: Pen::Main,
            },
            Trace {
                name: "|TD error|",
                short: "|TD error|",
                series: &curves.td_error_log,
                colour: inks.soft,
                pen: Pen::Main,
            },
        ],
        equals: true,
        reference: None,
        empty: "Learning begins when enough has been seen",
    };
    card::show(ui, &card, shared, labelled)
}

/// What the network expects.
pub fn mean_q(ui: &mut egui::Ui, curves: &Curves, shared: &Shared<'_>, labelled: bool) -> Seen {
    let inks = Inks::of(ui);
    let card = Card {
        title: "Mean Q-value",
        about: "What the network expects of the actions taken, in units of reward as they are learnt.",
        scale: Scale::Linear,
        digits: 2,
        traces: &[Trace {
            name: "of the actions taken",
            short: "actions taken",
            series: &curves.mean_q,
            colour: inks.accent,
            pen: Pen::Main,
        }],
        equals: false,
        reference: None,
        empty: "Learning begins when enough has been seen",
    };
    card::show(ui, &card, shared, labelled)
}

/// How much is explored.
pub fn epsilon(ui: &mut egui::Ui, curves: &Curves, shared: &Shared<'_>, labelled: bool) -> Seen {
    let inks = Inks::of(ui);
    let card = Card {
        title: "Epsilon",
        about: "The chance that an action is a random one, to explore.",
        scale: Scale::Unit,
        digits: 2,
        traces: &[Trace {
            name: "random actions",
            short: "random actions",
            series: &curves.epsilon,
            colour: inks.accent,
            pen: Pen::Main,
        }],
        equals: false,
        reference: None,
        empty: "",
    };
    card::show(ui, &card, shared, labelled)
}

/// What the return is made of.
pub fn terms(ui: &mut egui::Ui, curves: &Curves, shared: &Shared<'_>, labelled: bool) -> Seen {
    let inks = Inks::of(ui);
    let term = |name, short, series, colour| Trace { name, short, series, colour, pen: Pen::Main };
    let card = Card {
        title: "Reward by its terms",
        about: "What an episode's return is made of, as means of 100 episodes: for reaching targets, for the \
                collision, for coming nearer to the target, for coming nearer to obstacles.",
        scale: Scale::Linear,
        digits: 0,
        traces: &[
            term("reached", "reached", curves.reached.series(), inks.good),
            term("collided", "collided", curves.collided.series(), inks.bad),
            term("attraction", "attract.", curves.attraction.series(), inks.accent),
            term("repulsion", "repuls.", curves.repulsion.series(), inks.warn),
        ],
        equals: true,
        reference: None,
        empty: "",
    };
    card::show(ui, &card, shared, labelled)
}
