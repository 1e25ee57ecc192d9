//! `--quick`: the same experiments, done roughly.
//!
//! In: an experiment. Out: one with a tenth of the episodes and of the tests, and two seeds. Its numbers say nothing
//! about the paper; it shows in a minute what the full report will look like, and that everything runs.

use super::experiment::{Experiment, FigureKind, TableKind};
use crate::run::preset::{Budget, EvaluationConfig};

/// How much shorter everything is.
const SHORTER: u64 = 10;

/// How many seeds a rough experiment has.
const SEEDS: u64 = 2;

/// Makes `experiment` a rough one. `budget_of` tells the budget of a preset by its name, for stages that leave it to
/// that.
pub fn make_quick(experiment: &mut Experiment, budget_of: impl Fn(&str) -> Option<Budget>) {
    experiment.seeds = experiment.seeds.min(SEEDS);
    experiment.test.episodes = (experiment.test.episodes / SHORTER as usize).max(1);
    experiment.evaluation = Some(EvaluationConfig { every_env_steps: 10_000, episodes: 20 });
    for stage in experiment.arms.iter_mut().flat_map(|arm| &mut arm.stages) {
        stage.budget = stage.budget.or_else(|| budget_of(&stage.preset)).map(|budget| match budget {
            Budget::Episodes(n) => Budget::Episodes(fewer(n)),
            Budget::EnvSteps(n) => Budget::EnvSteps(fewer(n)),
        });
    }
    let rough = " (rough: a tenth of the episodes)";
    for figure in &mut experiment.figures {
        figure.title += rough;
        match &mut figure.draw {
            FigureKind::LearningCurves { smoothing, .. } => {
                *smoothing = (*smoothing / SHORTER as usize).max(1)
            }
            FigureKind::DotPlot { after, .. } | FigureKind::BenchmarkRoute { after } => {
                *after = fewer(*after)
            }
        }
    }
    for table in &mut experiment.tables {
        table.title += rough;
        match &mut table.show {
            TableKind::Seeds { after, .. }
            | TableKind::Rounds { after, .. }
            | TableKind::Measures { after, .. } => {
                *after = fewer(*after);
            }
            TableKind::Contrast { after, .. } => {
                after.iter_mut().for_each(|after| *after = fewer(*after));
                after.dedup();
            }
        }
    }
    let claims_of_tables = experiment.tables.iter_mut().flat_map(|table| &mut table.claims);
    let claims_of_figures = experiment.figures.iter_mut().flat_map(|figure| &mut figure.claims);
    for claim in claims_of_figures.chain(claims_of_tables) {
        claim.statement += rough;
        claim.after = fewer(claim.after);
    }
}

fn fewer(n: u64) -> u64 {
    (n / SHORTER).max(1)
}
