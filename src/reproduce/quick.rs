//! The option `--quick`: a short version of an experiment, with a tenth of the training and tests, and at most two seeds.
//!
//! The results do not test the paper's claims. They show within a minute what the full report looks like, and that every
//! step works.

use super::experiment::Experiment;
use super::figure_spec::FigureKind;
use super::table_spec::TableKind;
use crate::run::preset::{Budget, EvaluationConfig};

/// The divisor of budgets and of the number of test episodes.
const DIVISOR: u64 = 10;

/// The maximum number of seeds.
const MAX_SEEDS: u64 = 2;

/// The maximum number of episodes of an evaluation during training.
const MAX_EVALUATION_EPISODES: usize = 20;

/// Shortens `experiment`. `budget_of` returns a preset's budget by the preset's name, for stages without their own.
pub fn make_quick(experiment: &mut Experiment, budget_of: impl Fn(&str) -> Option<Budget>) {
    experiment.seeds = experiment.seeds.at_most(MAX_SEEDS);
    experiment.test.episodes = (experiment.test.episodes / DIVISOR as usize).max(1);
    experiment.evaluation = Some(experiment.evaluation.map_or_else(default_evaluation, quick_evaluation));
    for stage in experiment.arms.iter_mut().flat_map(|arm| &mut arm.stages) {
        stage.budget = stage.budget.or_else(|| budget_of(&stage.preset)).map(shortened_budget);
    }
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

/// The evaluation of an experiment that does not set one.
fn default_evaluation() -> EvaluationConfig {
    EvaluationConfig {
        every_env_steps: 10_000,
        episodes: MAX_EVALUATION_EPISODES,
        ..EvaluationConfig::default()
    }
}

/// The experiment's own evaluation, the same number of times in the shorter training, with at most
/// [`MAX_EVALUATION_EPISODES`] episodes each time. `final_episodes` stays the same.
fn quick_evaluation(own: EvaluationConfig) -> EvaluationConfig {
    let every_env_steps = (own.every_env_steps / DIVISOR).max(1);
    EvaluationConfig { every_env_steps, episodes: own.episodes.min(MAX_EVALUATION_EPISODES), ..own }
}

/// A tenth of a stage's budget, rounded up, so that an arm's stages together still reach every point at which it is tested.
fn shortened_budget(budget: Budget) -> Budget {
    match budget {
        Budget::Episodes(n) => Budget::Episodes(n.div_ceil(DIVISOR)),
        Budget::EnvSteps(n) => Budget::EnvSteps(n.div_ceil(DIVISOR)),
    }
}

/// A tenth of the training up to a point, rounded down: 0 stays 0, and anything longer stays at least 1.
fn shortened(length: Budget) -> Budget {
    let shortened = |n: u64| (n / DIVISOR).max(n.min(1));
    match length {
        Budget::Episodes(n) => Budget::Episodes(shortened(n)),
        Budget::EnvSteps(n) => Budget::EnvSteps(shortened(n)),
    }
}
