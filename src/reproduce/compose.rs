//! The page: what is said around figures and tables.
//!
//! In: results. Out: a [`Page`]: claims on top, a section for each experiment, the exact settings, where it all comes
//! from.

use super::claim_result::claim_result;
use super::experiment::Claim;
use super::figures;
use super::plan::{RunPlan, SelectedExperiment};
use super::results::Results;
use super::select::experiment_name;
use super::{ReproduceOptions, tables};
use crate::report::claim::ClaimResult;
use crate::report::format::number;
use crate::report::page::{Item, Page, Section, Setting};
use crate::run::RunError;
use crate::run::preset::Budget;
use crate::scenario::to_ron;

const PAPER: &str = "Li, Yue, Shangguan, Jin: Navigation of Mobile Robots Based on Deep Reinforcement Learning: Reward \
                     Function Optimization and Knowledge Transfer. International Journal of Control, Automation and \
                     Systems 21(2), 2023, 563-574, doi 10.1007/s12555-021-0642-7";

/// The whole page.
///
/// # Errors
/// Results are missing; a drawing failed.
pub fn page(
    results: &Results<'_>,
    selected: &[SelectedExperiment],
    plan: &RunPlan,
    request: &ReproduceOptions,
    jobs: usize,
    wall_s: f64,
) -> Result<Page, RunError> {
    let sections = (0..selected.len())
        .map(|index| section(results, index, &selected[index]))
        .collect::<Result<Vec<_>, _>>()?;
    // A claim that a figure and a table both show counts once.
    let mut claims: Vec<ClaimResult> = Vec::new();
    for claim_result in sections.iter().flat_map(|section| &section.items).flat_map(claim_results) {
        if !claims.contains(claim_result) {
            claims.push(claim_result.clone());
        }
    }
    let runs = plan.trainings.len();
    let made = format!(
        "made by wayfield {} from {runs} trainings, tested on starts and goals that none of them has seen. Every \
         number below comes from these runs; each verdict is computed, not written. The paper's own figures are marked as such.",
        env!("CARGO_PKG_VERSION")
    );
    let (title, lead) = if request.experiments.is_empty() {
        ("The paper, reproduced".to_string(), format!("Figures and tables of {PAPER}; {made}"))
    } else {
        let titles: Vec<&str> = selected.iter().map(|s| s.source.experiment.title.as_str()).collect();
        (titles.join("; "), format!("A report {made}"))
    };
    let warning = request.quick.then(|| {
        "this is a rough report (--quick): a tenth of the episodes and of the tests. Its numbers say nothing about \
         the claims."
            .to_string()
    });
    Ok(Page {
        title,
        lead: vec![lead],
        warning,
        claims,
        sections,
        settings: settings(selected, plan)?,
        provenance: provenance(results, plan, jobs, wall_s),
    })
}

fn claim_results(item: &Item) -> &[ClaimResult] {
    match item {
        Item::Figure { claim_results, .. } | Item::Table { claim_results, .. } => claim_results,
        Item::Text(_) => &[],
    }
}

fn section(results: &Results<'_>, index: usize, selected: &SelectedExperiment) -> Result<Section, RunError> {
    let experiment = &selected.source.experiment;
    let id = experiment_name(&selected.source.from);
    let judge = |claims: &[Claim]| -> Result<Vec<ClaimResult>, RunError> {
        claims.iter().map(|claim| judged(results, index, claim, &id)).collect()
    };
    let mut items = Vec::new();
    for figure in selected.figures.iter().map(|&i| &experiment.figures[i]) {
        items.push(Item::Figure {
            name: figure.name.clone(),
            svg: figures::draw(results, index, figure)?,
            caption: format!("{}. {}", figure.title, figure.caption).trim().to_string(),
            claim_results: judge(&figure.claims)?,
        });
    }
    for table in selected.tables.iter().map(|&i| &experiment.tables[i]) {
        items.push(Item::Table {
            table: tables::make(results, index, table)?,
            claim_results: judge(&table.claims)?,
        });
    }
    Ok(Section { id: id.clone(), heading: experiment.title.clone(), about: experiment.about.clone(), items })
}

/// The verdict on a claim, under the first condition.
fn judged(results: &Results<'_>, index: usize, claim: &Claim, anchor: &str) -> Result<ClaimResult, RunError> {
    let when = (claim.after, claim.of_last_stage);
    let values = |arm: &str| results.values_by_arm_name(index, 0, arm, claim.measure, when);
    Ok(claim_result(claim, &values(&claim.better)?, &values(&claim.than)?, anchor))
}

/// The experiments as they were carried out, and every scenario and preset with all that was resolved.
fn settings(selected: &[SelectedExperiment], plan: &RunPlan) -> Result<Vec<Setting>, RunError> {
    let ron = |error: ron::Error| RunError::Failed(error.to_string());
    let mut settings = Vec::new();
    for selected in selected {
        settings.push(Setting {
            heading: format!("Experiment {}", selected.source.from),
            ron: to_ron(&selected.source.experiment).map_err(ron)?,
        });
    }
    for (index, training) in plan.trainings.iter().enumerate().filter(|(_, t)| t.config.seed == 1) {
        settings.push(Setting {
            heading: format!("Run {}: {}", training.name, used_by(index, selected, plan)),
            ron: to_ron(&training.config).map_err(ron)?,
        });
    }
    Ok(settings)
}

/// Which arms, under which conditions, a training belongs to.
fn used_by(index: usize, selected: &[SelectedExperiment], plan: &RunPlan) -> String {
    let mut uses = Vec::new();
    for ((experiment, condition, arm, _), chain) in &plan.arm_runs {
        let Some(stage) = chain.stages.iter().position(|&(training, _)| training == index) else { continue };
        let source = &selected[*experiment].source;
        let of = &source.experiment;
        let mut name = format!("{} / {}", experiment_name(&source.from), of.arms[*arm].name);
        if let Some(condition) = of.conditions.get(*condition) {
            name += &format!(" / {}", condition.name);
        }
        if chain.stages.len() > 1 {
            name += &format!(" / stage {}", stage + 1);
        }
        uses.push(name);
    }
    uses.join("; ")
}

fn provenance(results: &Results<'_>, plan: &RunPlan, jobs: usize, wall_s: f64) -> Vec<(String, String)> {
    let seeds = plan.trainings.iter().map(|training| training.config.seed).max().unwrap_or(0);
    let episodes: u64 = plan
        .trainings
        .iter()
        .map(|training| match training.config.preset.budget {
            Budget::Episodes(n) => n,
            Budget::EnvSteps(_) => 0,
        })
        .sum();
    let command: Vec<String> = std::env::args().skip(1).collect();
    [
        ("Version", format!("wayfield {}", env!("CARGO_PKG_VERSION"))),
        ("Command", format!("wayfield {}", command.join(" "))),
        ("Seeds", if seeds == 1 { "1".into() } else { format!("1 to {seeds}") }),
        (
            "Trainings",
            format!(
                "{}: {} episodes in trainings counted by episodes, {} env steps in all",
                plan.trainings.len(),
                number(episodes as f64, 0),
                number(results.env_steps() as f64, 0)
            ),
        ),
        ("Machine", machine()),
        (
            "Time",
            format!(
                "{:.1} minutes, {jobs} runs at a time (the runs' own times add up to {:.1} minutes)",
                wall_s / 60.0,
                results.total_wall_minutes()
            ),
        ),
    ]
    .into_iter()
    .map(|(what, how)| (what.to_string(), how))
    .collect()
}

/// Processor, cores, memory and system, as far as they can be known.
fn machine() -> String {
    let mut parts = Vec::new();
    if let Ok(mut system) = sysinfo::System::new() {
        system.refresh_memory();
        system.refresh_cpu_all();
        let cpus = system.cpus();
        if let Some(cpu) = cpus.first() {
            parts.push(cpu.brand().trim().to_string());
        }
        parts.push(format!("{} cores", cpus.len()));
        parts.push(format!("{:.0} GiB", system.total_memory() as f64 / f64::from(1 << 30)));
    }
    parts.push(sysinfo::System::long_os_version().unwrap_or_else(|_| std::env::consts::OS.into()));
    parts.join(", ")
}
