//! The size checks of an experiment: numbers of entries, lengths of texts, and the number of training runs.

use super::collector::Collector;
use crate::limits::experiment::*;
use crate::reproduce::claim::Claim;
use crate::reproduce::experiment::{Arm, Experiment};
use crate::reproduce::figure_spec::{FigureKind, FigureSpec};
use crate::reproduce::table_spec::{TableKind, TableSpec};

/// Adds a diagnostic for everything in `experiment` that is too large.
pub(super) fn check(found: &mut Collector, experiment: &Experiment) {
    let Experiment { title, about, arms, conditions, figures, tables, .. } = experiment;
    found.text("title", title, MAX_NAME_CHARS);
    found.text("about", about, MAX_TEXT_CHARS);
    found.count("arms", arms.len(), MAX_ENTRIES);
    for (i, arm) in arms.iter().enumerate().take(MAX_ENTRIES) {
        check_arm(found, &format!("arms[{i}]"), arm);
    }
    found.count("overrides", experiment.overrides.0.len(), MAX_ENTRIES);
    found.count("conditions", conditions.len(), MAX_ENTRIES);
    for (i, condition) in conditions.iter().enumerate().take(MAX_ENTRIES) {
        found.text(&format!("conditions[{i}].name"), &condition.name, MAX_NAME_CHARS);
        let scenario = condition.scenario.as_deref().unwrap_or_default();
        found.text(&format!("conditions[{i}].scenario"), scenario, MAX_PATH_CHARS);
        found.count(&format!("conditions[{i}].overrides"), condition.overrides.0.len(), MAX_ENTRIES);
        found.count(&format!("conditions[{i}].only_arms"), condition.only_arms.len(), MAX_ENTRIES);
        found.count(&format!("conditions[{i}].only_scenarios"), condition.only_scenarios.len(), MAX_ENTRIES);
    }
    found.count("figures", figures.len(), MAX_ENTRIES);
    for (i, figure) in figures.iter().enumerate().take(MAX_ENTRIES) {
        check_figure(found, &format!("figures[{i}]"), figure);
    }
    found.count("tables", tables.len(), MAX_ENTRIES);
    for (i, table) in tables.iter().enumerate().take(MAX_ENTRIES) {
        check_table(found, &format!("tables[{i}]"), table);
    }
    check_training_runs(found, experiment);
}

fn check_arm(found: &mut Collector, at: &str, arm: &Arm) {
    found.text(&format!("{at}.name"), &arm.name, MAX_NAME_CHARS);
    found.count(&format!("{at}.runs"), arm.runs.len(), MAX_SEEDS as usize);
    for (k, run) in arm.runs.iter().enumerate().take(MAX_SEEDS as usize) {
        found.text(&format!("{at}.runs[{k}]"), run, MAX_PATH_CHARS);
    }
    found.count(&format!("{at}.stages"), arm.stages.len(), MAX_STAGES);
    for (k, stage) in arm.stages.iter().enumerate().take(MAX_STAGES) {
        let at = format!("{at}.stages[{k}]");
        found.text(&format!("{at}.scenario"), &stage.scenario, MAX_PATH_CHARS);
        found.text(&format!("{at}.preset"), &stage.preset, MAX_PATH_CHARS);
        found.count(&format!("{at}.overrides"), stage.overrides.0.len(), MAX_ENTRIES);
    }
}

fn check_figure(found: &mut Collector, at: &str, figure: &FigureSpec) {
    found.text(&format!("{at}.title"), &figure.title, MAX_NAME_CHARS);
    found.text(&format!("{at}.caption"), &figure.caption, MAX_TEXT_CHARS);
    check_claims(found, at, &figure.claims);
    match &figure.draw {
        FigureKind::LearningCurves { series, reference_lines, .. } => {
            found.count(&format!("{at}.draw.series"), series.len(), MAX_SERIES);
            found.count(&format!("{at}.draw.reference_lines"), reference_lines.len(), MAX_ENTRIES);
            for (k, line) in reference_lines.iter().enumerate().take(MAX_ENTRIES) {
                let at = format!("{at}.draw.reference_lines[{k}]");
                found.value(&format!("{at}.value"), line.value);
                found.text(&format!("{at}.label"), &line.label, MAX_NAME_CHARS);
            }
        }
        FigureKind::DotPlot { measures, .. } => {
            found.count(&format!("{at}.draw.measures"), measures.len(), MAX_MEASURES);
        }
        FigureKind::BenchmarkRoute { .. } => {}
    }
}

fn check_table(found: &mut Collector, at: &str, table: &TableSpec) {
    found.text(&format!("{at}.title"), &table.title, MAX_NAME_CHARS);
    found.count(&format!("{at}.aliases"), table.aliases.len(), MAX_ENTRIES);
    for (k, name) in table.aliases.iter().enumerate().take(MAX_ENTRIES) {
        found.text(&format!("{at}.aliases[{k}]"), name, MAX_NAME_CHARS);
    }
    check_claims(found, at, &table.claims);
    let at = format!("{at}.show");
    match &table.show {
        TableKind::Seeds { paper, .. } => {
            found.count(&format!("{at}.paper"), paper.len(), MAX_ENTRIES);
            for (k, (_, value)) in paper.iter().enumerate().take(MAX_ENTRIES) {
                found.value(&format!("{at}.paper[{k}][1]"), *value);
            }
        }
        TableKind::Rounds { paper, .. } => {
            found.count(&format!("{at}.paper"), paper.len(), MAX_ENTRIES);
            for (k, (_, rounds)) in paper.iter().enumerate().take(MAX_ENTRIES) {
                found.count(&format!("{at}.paper[{k}][1]"), rounds.len(), MAX_ROUNDS);
                for (j, value) in rounds.iter().enumerate().take(MAX_ROUNDS) {
                    found.value(&format!("{at}.paper[{k}][1][{j}]"), *value);
                }
            }
        }
        TableKind::Measures { measures, .. } => {
            found.count(&format!("{at}.measures"), measures.len(), MAX_MEASURES);
        }
        TableKind::Contrast { measures, after, .. } => {
            found.count(&format!("{at}.measures"), measures.len(), MAX_MEASURES);
            found.count(&format!("{at}.after"), after.len(), MAX_ENTRIES);
        }
    }
}

fn check_claims(found: &mut Collector, at: &str, claims: &[Claim]) {
    found.count(&format!("{at}.claims"), claims.len(), MAX_ENTRIES);
    for (k, claim) in claims.iter().enumerate().take(MAX_ENTRIES) {
        found.text(&format!("{at}.claims[{k}].statement"), &claim.statement, MAX_TEXT_CHARS);
    }
}

/// The number of training runs: one for each seed, stage of an arm, and condition.
pub fn training_runs(experiment: &Experiment) -> u64 {
    experiment.seeds.count().saturating_mul(training_runs_per_seed(experiment))
}

/// The number of training runs with one seed.
pub fn training_runs_per_seed(experiment: &Experiment) -> u64 {
    let stages: u64 = experiment.arms.iter().map(|arm| arm.stages.len() as u64).sum();
    stages.saturating_mul(experiment.conditions.len().max(1) as u64)
}

fn check_training_runs(found: &mut Collector, experiment: &Experiment) {
    let (seeds, training_runs) = (experiment.seeds.count(), training_runs(experiment));
    // A number of seeds that is itself out of range has its own diagnostic.
    if training_runs > MAX_TRAINING_RUNS && seeds <= MAX_SEEDS {
        let message = format!(
            "is {seeds}, which makes {training_runs} training runs with these arms and conditions; help: give fewer seeds, for at \
             most {MAX_TRAINING_RUNS} training runs"
        );
        found.add("seeds", message);
    }
}
