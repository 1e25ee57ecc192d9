//! Which experiments are to be done, and which of their figures and tables are wanted.
//!
//! In: what the user asked for. Out: [`SelectedExperiment`] experiments, with the seeds and the roughness asked for.

use std::collections::{BTreeMap, BTreeSet};

use super::ReproduceOptions;
use super::experiment::Experiment;
use super::plan::{ExperimentSource, SelectedExperiment};
use super::quick::make_quick;
use crate::run::{RunError, shipped};
use crate::scenario::closest_name;

/// The experiments that `request` asks for.
///
/// # Errors
/// A file cannot be used; a name stands for two things; nothing is called what `--only` names.
pub fn select(request: &ReproduceOptions) -> Result<Vec<SelectedExperiment>, RunError> {
    let mut sources = Vec::new();
    if request.experiments.is_empty() {
        for (from, text) in shipped::experiments() {
            sources.push(ExperimentSource { from: from.into(), experiment: Experiment::parse(text, from)? });
        }
    }
    for from in &request.experiments {
        sources
            .push(ExperimentSource { from: from.display().to_string(), experiment: Experiment::load(from)? });
    }
    let names = names(&sources)?;
    for wanted in &request.only {
        if !names.contains_key(wanted) {
            let all: Vec<&str> = names.keys().map(String::as_str).collect();
            let mend = match closest_name(wanted, all.iter().copied()) {
                Some(near) => format!("did you mean `{near}`? "),
                None => String::new(),
            };
            let all = all.join(", ");
            let why = format!("--only: nothing is called `{wanted}`; {mend}There are: {all}");
            return Err(RunError::InvalidInput(why));
        }
    }
    let asked = |name: &str| request.only.iter().any(|only| only == name);
    let items: BTreeSet<String> =
        sources.iter().flat_map(|source| items(&source.experiment)).cloned().collect();
    let wanted = |item: &str, also: &[String], of: &str| {
        // An experiment's own name stands for all of it, unless a figure or table has it.
        let whole = request.only.is_empty() || (asked(of) && !items.contains(of));
        whole || asked(item) || also.iter().any(|name| asked(name))
    };
    let mut selected = Vec::new();
    for mut source in sources {
        let experiment_name = experiment_name(&source.from);
        let experiment = &mut source.experiment;
        if request.quick {
            make_quick(experiment, |preset| shipped::preset(preset).ok().map(|preset| preset.budget));
        }
        experiment.seeds = request.seeds.unwrap_or(experiment.seeds);
        let picked = |n: usize, wanted: &dyn Fn(usize) -> bool| (0..n).filter(|&i| wanted(i)).collect();
        let figures: Vec<usize> =
            picked(experiment.figures.len(), &|i| wanted(&experiment.figures[i].name, &[], &experiment_name));
        let tables: Vec<usize> = picked(experiment.tables.len(), &|i| {
            wanted(&experiment.tables[i].name, &experiment.tables[i].aliases, &experiment_name)
        });
        if !figures.is_empty() || !tables.is_empty() {
            selected.push(SelectedExperiment { source, figures, tables });
        }
    }
    Ok(selected)
}

/// Every name under which `--only` finds something, each with the experiment that it belongs to.
fn names(sources: &[ExperimentSource]) -> Result<BTreeMap<String, String>, RunError> {
    let mut names: BTreeMap<String, String> = BTreeMap::new();
    for source in sources {
        let experiment = &source.experiment;
        for name in items(experiment) {
            if let Some(other) = names.insert(name.clone(), source.from.clone()) {
                let from = &source.from;
                let why =
                    format!("{from}: `{name}` is also the name of something in {other}; give it another");
                return Err(RunError::InvalidInput(why));
            }
        }
    }
    let mut stems = BTreeSet::from(["settings".to_string(), "provenance".to_string()]);
    for source in sources {
        let experiment_name = experiment_name(&source.from);
        if !stems.insert(experiment_name.clone()) {
            let why = format!(
                "{}: another section of the report is called `{experiment_name}`: rename the file",
                source.from
            );
            return Err(RunError::InvalidInput(why));
        }
        names.entry(experiment_name).or_insert_with(|| source.from.clone());
    }
    Ok(names)
}

/// The names of all figures and tables of an experiment.
fn items(experiment: &Experiment) -> impl Iterator<Item = &String> {
    let figures = experiment.figures.iter().map(|figure| &figure.name);
    let tables =
        experiment.tables.iter().flat_map(|table| std::iter::once(&table.name).chain(&table.aliases));
    figures.chain(tables)
}

/// An experiment's name: its file's, without folder and ending.
#[must_use]
pub fn experiment_name(from: &str) -> String {
    std::path::Path::new(from).file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
