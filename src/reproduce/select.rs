//! Selection: the experiments, figures and tables that the user asked for.

use std::collections::{BTreeMap, BTreeSet};

use super::check::training_runs;
use super::experiment::Experiment;
use super::options::ReproduceOptions;
use super::quick::make_quick;
use super::selected::{ExperimentSource, SelectedExperiment};
use crate::limits::experiment::MAX_TRAINING_RUNS;
use crate::run::{RunError, shipped};
use crate::scenario::closest_name;

/// The experiments that `options` ask for, with `--set`, `--quick` and `--seeds` applied to them.
///
/// # Errors
/// A file is invalid, a name is used twice, a name after `--only` does not exist, `--set` or `--quick` is given for an
/// experiment with finished runs, `--seeds` is given for an experiment without training runs, or an experiment has too many
/// training runs with the seeds of `--seeds`.
pub fn select(options: &ReproduceOptions) -> Result<Vec<SelectedExperiment>, RunError> {
    let sources = sources(options)?;
    check_wanted(&options.only, &names(&sources)?)?;
    let items: BTreeSet<String> =
        sources.iter().flat_map(|source| items(&source.experiment)).cloned().collect();
    let asked = |name: &str| options.only.iter().any(|only| only == name);
    let mut selected = Vec::new();
    for mut source in sources {
        let name = source.name();
        // The name of an experiment selects all of it, unless it is also the name of a figure or table.
        let all = options.only.is_empty() || (asked(&name) && !items.contains(&name));
        let experiment = &mut source.experiment;
        let figures = indices(&experiment.figures, |figure| all || asked(&figure.name));
        let tables = indices(&experiment.tables, |table| {
            all || asked(&table.name) || table.aliases.iter().any(|name| asked(name))
        });
        if figures.is_empty() && tables.is_empty() {
            continue;
        }
        if !options.settings.is_empty() {
            check_trains(&source.from, experiment, "--set changes")?;
            experiment.overrides.0.extend(options.settings.0.iter().cloned());
        }
        if options.quick {
            check_trains(&source.from, experiment, "--quick shortens")?;
            make_quick(experiment);
        }
        if let Some(seeds) = &options.seeds {
            if experiment.arms.iter().all(|arm| !arm.runs.is_empty()) {
                let why = format!(
                    "{}: --seeds chooses the seeds of training runs, but all arms have finished runs; help: leave the option out",
                    source.from
                );
                return Err(RunError::InvalidInput(why));
            }
            experiment.seeds = seeds.clone();
            let runs = training_runs(experiment);
            if runs > MAX_TRAINING_RUNS {
                let why = format!(
                    "--seeds: with {} seeds, {} has {runs} training runs; help: give fewer seeds, for at most {MAX_TRAINING_RUNS}",
                    seeds.count(),
                    source.from
                );
                return Err(RunError::InvalidInput(why));
            }
        }
        selected.push(SelectedExperiment { source, figures, tables });
    }
    Ok(selected)
}

/// Checks that all arms are trained here: `option` (such as "--quick shortens") has no effect on finished runs.
fn check_trains(from: &str, experiment: &Experiment, option: &str) -> Result<(), RunError> {
    let Some(arm) = experiment.arms.iter().find(|arm| !arm.runs.is_empty()) else { return Ok(()) };
    let why = format!(
        "{from}: {option} training runs, but arm \"{}\" has finished runs; help: leave the option out",
        arm.name
    );
    Err(RunError::InvalidInput(why))
}

/// The user's experiments, or the shipped ones.
fn sources(options: &ReproduceOptions) -> Result<Vec<ExperimentSource>, RunError> {
    let mut sources = Vec::new();
    if options.experiments.is_empty() {
        for (from, text) in shipped::experiments() {
            sources.push(ExperimentSource { from: from.into(), experiment: Experiment::parse(text, from)? });
        }
    }
    for from in &options.experiments {
        let experiment = Experiment::load(from)?;
        sources.push(ExperimentSource { from: from.display().to_string(), experiment });
    }
    Ok(sources)
}

fn indices<T>(entries: &[T], wanted: impl Fn(&T) -> bool) -> Vec<usize> {
    (0..entries.len()).filter(|&i| wanted(&entries[i])).collect()
}

/// Checks that every name after `--only` exists.
fn check_wanted(only: &[String], names: &BTreeMap<String, String>) -> Result<(), RunError> {
    let Some(unknown) = only.iter().find(|name| !names.contains_key(*name)) else { return Ok(()) };
    let all: Vec<&str> = names.keys().map(String::as_str).collect();
    let hint = match closest_name(unknown, all.iter().copied()) {
        Some(near) => format!("did you mean `{near}`? "),
        None => String::new(),
    };
    let why = format!("--only: there is no `{unknown}`; help: {hint}The names are: {}", all.join(", "));
    Err(RunError::InvalidInput(why))
}

/// Every name that `--only` accepts, with the file of its experiment.
fn names(sources: &[ExperimentSource]) -> Result<BTreeMap<String, String>, RunError> {
    let mut names: BTreeMap<String, String> = BTreeMap::new();
    for source in sources {
        for name in items(&source.experiment) {
            if let Some(other) = names.insert(name.clone(), source.from.clone()) {
                let why =
                    format!("{}: `{name}` is also a name in {other}; help: rename one of them", source.from);
                return Err(RunError::InvalidInput(why));
            }
        }
    }
    // The report has sections with these names.
    let mut sections = BTreeSet::from(["settings".to_string(), "provenance".to_string()]);
    for source in sources {
        let name = source.name();
        if !sections.insert(name.clone()) {
            let why = format!(
                "{}: the report already has a section called `{name}`; help: rename the file",
                source.from
            );
            return Err(RunError::InvalidInput(why));
        }
        names.entry(name).or_insert_with(|| source.from.clone());
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
