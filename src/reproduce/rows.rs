//! The rows of figures and tables: every arm under every condition.

use super::results::{ArmIndex, Results};

/// Every arm under every condition of an experiment.
pub fn rows(results: &Results<'_>, experiment: usize) -> Vec<ArmIndex> {
    let of = results.experiment(experiment);
    let row = |condition| (0..of.arms.len()).map(move |arm| ArmIndex { experiment, condition, arm });
    (0..of.conditions.len().max(1)).flat_map(row).collect()
}

/// The rows of the arms that are trained: those that a selected figure, table or claim is about.
pub fn trained_rows(results: &Results<'_>, experiment: usize) -> Vec<ArmIndex> {
    let is_trained = |row: &ArmIndex| results.arm_runs(*row).any(|(_, run)| !run.stages.is_empty());
    rows(results, experiment).into_iter().filter(is_trained).collect()
}

/// The name of a row: the arm if there are no conditions, the condition if there is only one arm, otherwise both.
pub fn row_name(results: &Results<'_>, row: ArmIndex) -> String {
    let experiment = results.experiment(row.experiment);
    let arm = &experiment.arms[row.arm].name;
    match experiment.conditions.get(row.condition) {
        Some(condition) if experiment.arms.len() > 1 => format!("{}: {arm}", condition.name),
        Some(condition) => condition.name.clone(),
        None => arm.clone(),
    }
}

/// The seeds of all trained arms of an experiment, in increasing order.
pub fn seeds(results: &Results<'_>, experiment: usize) -> Vec<u64> {
    let runs = trained_rows(results, experiment).into_iter().flat_map(|row| results.arm_runs(row));
    let mut seeds: Vec<u64> = runs.map(|(seed, _)| seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    seeds
}
