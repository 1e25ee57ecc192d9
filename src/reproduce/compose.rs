//! The report's page: the claim results, a section for each experiment, the exact settings, and the provenance.

use std::collections::BTreeSet;

use super::claim::Claim;
use super::claim_result::claim_result;
use super::data_note::fewest_seeds;
use super::options::ReproduceOptions;
use super::plan::RunPlan;
use super::provenance::provenance;
use super::records::Windows;
use super::results::Results;
use super::rows::rows;
use super::selected::SelectedExperiment;
use super::{figures, tables};
use crate::report::claim::ClaimResult;
use crate::report::format::counted;
use crate::report::page::{Item, Page, Section, Setting};
use crate::report::statistics::small_sample_note;
use crate::run::RunError;
use crate::scenario::to_ron;

const PAPER: &str = "Li, Yue, Shangguan, Jin: Navigation of Mobile Robots Based on Deep Reinforcement Learning: Reward \
                     Function Optimization and Knowledge Transfer. International Journal of Control, Automation and \
                     Systems 21(2), 2023, 563-574, doi 10.1007/s12555-021-0642-7";

const QUICK_WARNING: &str = "this is a quick report (--quick), with a tenth of the training and tests. Its numbers \
                             say nothing about the claims.";

/// Composes the page of the report.
///
/// # Errors
/// Results are missing, or a figure could not be drawn.
pub fn page(
    results: &Results<'_>,
    selected: &[SelectedExperiment],
    plan: &RunPlan,
    options: &ReproduceOptions,
    jobs: usize,
    wall_s: f64,
) -> Result<Page, RunError> {
    let sections = (0..selected.len())
        .map(|index| section(results, index, &selected[index]))
        .collect::<Result<Vec<_>, _>>()?;
    let (title, lead) = title_and_lead(selected, plan, options);
    Ok(Page {
        title,
        lead: vec![lead],
        warning: warning(results, selected.len(), options.quick),
        claims: unique_claims(&sections),
        sections,
        settings: settings(results, selected, plan)?,
        provenance: provenance(results, plan, options, jobs, wall_s),
    })
}

/// The warning to show before all numbers, if there is one.
fn warning(results: &Results<'_>, experiments: usize, quick: bool) -> Option<String> {
    let fewest = (0..experiments).map(|index| fewest_seeds(results, index)).min();
    let parts = [quick.then(|| QUICK_WARNING.to_string()), fewest.and_then(small_sample_note)];
    let text = parts.into_iter().flatten().collect::<Vec<_>>().join(" ");
    (!text.is_empty()).then_some(text)
}

fn title_and_lead(
    selected: &[SelectedExperiment],
    plan: &RunPlan,
    options: &ReproduceOptions,
) -> (String, String) {
    let made = format!(
        "made by wayfield {} from {}. All policies are tested in episodes that were not used for training. \
         All numbers below come from these runs, except those marked as the paper's, and every claim result is \
         computed from them.",
        env!("CARGO_PKG_VERSION"),
        counted(plan.training_runs.len() as f64, "training run")
    );
    if options.experiments.is_empty() {
        ("The paper, reproduced".to_string(), format!("Figures and tables of {PAPER}; {made}"))
    } else {
        let titles: Vec<&str> = selected.iter().map(|s| s.source.experiment.title.as_str()).collect();
        (titles.join("; "), format!("A report {made}"))
    }
}

/// The claim results of all sections. A result that a figure and a table share is listed once.
fn unique_claims(sections: &[Section]) -> Vec<ClaimResult> {
    let mut claims: Vec<ClaimResult> = Vec::new();
    for claim_result in sections.iter().flat_map(|section| &section.items).flat_map(claim_results) {
        if !claims.contains(claim_result) {
            claims.push(claim_result.clone());
        }
    }
    claims
}

fn claim_results(item: &Item) -> &[ClaimResult] {
    match item {
        Item::Figure { claim_results, .. } | Item::Table { claim_results, .. } => claim_results,
        Item::Text(_) => &[],
    }
}

fn section(results: &Results<'_>, index: usize, selected: &SelectedExperiment) -> Result<Section, RunError> {
    let experiment = &selected.source.experiment;
    let id = selected.source.name();
    let test = |claims: &[Claim], window: Option<usize>| -> Result<Vec<ClaimResult>, RunError> {
        claims.iter().map(|claim| test_claim(results, index, claim, window, &id)).collect()
    };
    let mut items = Vec::new();
    for figure in selected.figures.iter().map(|&i| &experiment.figures[i]) {
        results.progress().begin(&figure.name);
        items.push(Item::Figure {
            name: figure.name.clone(),
            svg: figures::draw(results, index, figure)?,
            caption: figures::caption(results, index, figure)?,
            claim_results: test(&figure.claims, figure.window())?,
        });
    }
    for table in selected.tables.iter().map(|&i| &experiment.tables[i]) {
        results.progress().begin(&table.name);
        items.push(Item::Table {
            table: tables::make(results, index, table)?,
            claim_results: test(&table.claims, None)?,
        });
    }
    Ok(Section { id, heading: experiment.title.clone(), about: experiment.about.clone(), items })
}

/// Tests a claim under the first condition. With a `window`, episodes are averaged over it, as in the figure's curves.
fn test_claim(
    results: &Results<'_>,
    index: usize,
    claim: &Claim,
    window: Option<usize>,
    anchor: &str,
) -> Result<ClaimResult, RunError> {
    let windows = window.map_or_else(Windows::default, Windows::equal);
    let values = |arm: &str| {
        let arm = results.arm_by_name(index, 0, arm);
        results.values(arm, claim.measure, claim.point(), windows)
    };
    Ok(claim_result(claim, &values(&claim.better)?, &values(&claim.than)?, window, anchor))
}

/// The experiments as executed, and the complete configuration of every training run with the first seed.
fn settings(
    results: &Results<'_>,
    selected: &[SelectedExperiment],
    plan: &RunPlan,
) -> Result<Vec<Setting>, RunError> {
    let failed = |error: ron::Error| RunError::Failed(error.to_string());
    let mut settings = Vec::new();
    for selected in selected {
        settings.push(Setting {
            heading: format!("Experiment {}", selected.source.from),
            ron: to_ron(&selected.source.experiment).map_err(failed)?,
        });
    }
    let mut shown = BTreeSet::new();
    for arm in (0..selected.len()).flat_map(|index| rows(results, index)) {
        shown.extend(results.first_run(arm)?.stages.iter().map(|stage| stage.0));
    }
    for (index, run) in shown.into_iter().map(|index| (index, &plan.training_runs[index])) {
        settings.push(Setting {
            heading: format!("Run {}: {}", run.name, used_by(index, selected, plan)),
            ron: to_ron(&run.config).map_err(failed)?,
        });
    }
    Ok(settings)
}

/// The arms, conditions and stages that a training run belongs to.
fn used_by(index: usize, selected: &[SelectedExperiment], plan: &RunPlan) -> String {
    let mut uses = Vec::new();
    for ((experiment, condition, arm, _), arm_run) in &plan.arm_runs {
        let Some(stage) = arm_run.stages.iter().position(|&(run_index, _)| run_index == index) else {
            continue;
        };
        let source = &selected[*experiment].source;
        let mut name = format!("{} / {}", source.name(), source.experiment.arms[*arm].name);
        if let Some(condition) = source.experiment.conditions.get(*condition) {
            name += &format!(" / {}", condition.name);
        }
        if arm_run.stages.len() > 1 {
            name += &format!(" / stage {}", stage + 1);
        }
        uses.push(name);
    }
    uses.join("; ")
}
