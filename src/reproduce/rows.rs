//! The rows of figures and tables: every arm under every condition.

use super::results::Results;

/// Every (condition, arm) of an experiment, by index.
pub fn rows(results: &Results<'_>, experiment: usize) -> Vec<(usize, usize)> {
    let experiment = results.experiment(experiment);
    let arms = experiment.arms.len();
    let conditions = experiment.conditions.len().max(1);
    (0..conditions).flat_map(|condition| (0..arms).map(move |arm| (condition, arm))).collect()
}

/// The name of a row: the arm, the condition, or both if there are several of each.
pub fn row_name(results: &Results<'_>, experiment: usize, (condition, arm): (usize, usize)) -> String {
    let experiment = results.experiment(experiment);
    let arm = &experiment.arms[arm].name;
    match experiment.conditions.get(condition) {
        Some(condition) if experiment.arms.len() > 1 => format!("{}: {arm}", condition.name),
        Some(condition) => condition.name.clone(),
        None => arm.clone(),
    }
}
