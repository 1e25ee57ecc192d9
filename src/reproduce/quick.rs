//! The option `--quick`: a short version of an experiment, with a tenth of the training and tests, and at most two seeds.
//!
//! The results do not test the paper's claims. They show within a minute what the full report looks like, and that every
//! step works.

use super::experiment::Experiment;
use super::figure_spec::FigureKind;
use super::table_spec::TableKind;
use crate::run::preset::{Budget, EvaluationConfig, Preset};

/// The divisor of budgets and of the number of test episodes.
const DIVISOR: u64 = 10;

/// The maximum number of seeds.
const MAX_SEEDS: u64 = 2;

/// The maximum number of episodes of an evaluation during training.
const MAX_EVALUATION_EPISODES: usize = 20;

/// The interval of evaluations if the experiment does not set one, in env steps of the full training.
const DEFAULT_EVALUATION_STEPS: u64 = 100_000;

/// Shortens `experiment`, except for its training runs, which [`shorten_training`] shortens when they are planned.
pub fn make_quick(experiment: &mut Experiment) {
    experiment.is_quick = true;
    experiment.seeds = experiment.seeds.at_most(MAX_SEEDS);
    experiment.test.episodes = (experiment.test.episodes / DIVISOR as usize).max(1);
    experiment.evaluation.get_or_insert(EvaluationConfig {
        every_env_steps: DEFAULT_EVALUATION_STEPS,
        ..EvaluationConfig::default()
    });
    let suffix = " (quick: a tenth of the training)";
    for figure in &mut experiment.figures {
        figure.title += suffix;
        match &mut figure.draw {
            FigureKind::LearningCurves { smoothing, .. } => {
                *smoothing = (*smoothing / DIVISOR as usize).max(1);
            }
            FigureKind::DotPlot { after, .. } | FigureKind::BenchmarkRoute { after } => {
                *after = after.map(shortened);
            }
        }
    }
    for table in &mut experiment.tables {
        table.title += suffix;
        match &mut table.show {
            TableKind::Seeds { after, .. }
            | TableKind::Rounds { after, .. }
            | TableKind::Measures { after, .. } => {
                *after = after.map(shortened);
            }
            TableKind::Contrast { after, .. } => {
                after.iter_mut().for_each(|after| *after = shortened(*after));
                after.dedup();
            }
        }
    }
    let claims_of_tables = experiment.tables.iter_mut().flat_map(|table| &mut table.claims);
    let claims_of_figures = experiment.figures.iter_mut().flat_map(|figure| &mut figure.claims);
    for claim in claims_of_figures.chain(claims_of_tables) {
        claim.statement += suffix;
        claim.after = claim.after.map(shortened);
    }
}

/// Shortens a training run with all its overrides: a tenth of the budget, with the same number of evaluations of at most
/// [`MAX_EVALUATION_EPISODES`] episodes each.
pub fn shorten_training(preset: &mut Preset) {
    preset.budget = shortened(preset.budget);
    let evaluation = &mut preset.evaluation;
    evaluation.every_env_steps = evaluation.every_env_steps.div_ceil(DIVISOR);
    evaluation.episodes = evaluation.episodes.min(MAX_EVALUATION_EPISODES);
}

/// A tenth of `length`, rounded up. Rounding up makes the shortened stages together at least as long as the shortened total of
/// all stages, at which a table or figure may test an arm.
fn shortened(length: Budget) -> Budget {
    match length {
        Budget::Episodes(n) => Budget::Episodes(n.div_ceil(DIVISOR)),
        Budget::EnvSteps(n) => Budget::EnvSteps(n.div_ceil(DIVISOR)),
    }
}
