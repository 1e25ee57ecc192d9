//! The tables of an experiment.
//!
//! In: what a table is to show, and the results. Out: a [`Table`], with notes on how its numbers came about.

use super::claim_result::{compare, raw_values};
use super::experiment::{Experiment, TableKind, TableSpec, TestedPolicy};
use super::figures::{row_name, rows};
use super::measure::Measure;
use super::policy_test::BENCHMARK_ROUTE_EPISODES;
use super::results::{MeasuredValue, Results};
use crate::planner::StepBounds;
use crate::report::format::number;
use crate::report::statistics::Estimate;
use crate::report::table::{Cell, Column, ColumnKind, Table};
use crate::run::RunError;
use crate::run::evaluate::period_s;

/// Makes a table of experiment `index`.
///
/// # Errors
/// Results are missing.
pub fn make(results: &Results<'_>, index: usize, spec: &TableSpec) -> Result<Table, RunError> {
    let (columns, rows, mut notes) = match &spec.show {
        TableKind::Seeds { measure, after, paper } => seeds(results, index, *measure, *after, paper)?,
        TableKind::Rounds { after, paper } => rounds(results, index, *after, paper)?,
        TableKind::Measures { measures, after } => measures_of(results, index, measures, *after)?,
        TableKind::Contrast { measures, better, than, after, of_last_stage } => {
            contrast(results, index, measures, (better, than), after, *of_last_stage)?
        }
    };
    let experiment = results.experiment(index);
    notes.extend(notes_on(experiment, spec));
    Ok(Table { name: spec.name.clone(), title: spec.title.clone(), columns, rows, notes })
}

type Parts = (Vec<Column>, Vec<Vec<Cell>>, Vec<String>);

fn text(heading: &str) -> Column {
    Column { heading: heading.into(), unit: String::new(), kind: ColumnKind::Text }
}

fn numbers(heading: impl Into<String>, unit: &str) -> Column {
    Column { heading: heading.into(), unit: unit.into(), kind: ColumnKind::Number }
}

fn seeds(
    results: &Results<'_>,
    index: usize,
    measure: Measure,
    after: u64,
    paper: &[(String, f64)],
) -> Result<Parts, RunError> {
    let experiment = results.experiment(index);
    let (unit, digits) = (measure.unit(), measure.digits());
    let mut columns = vec![text("")];
    columns.extend((1..=experiment.seeds).map(|seed| numbers(format!("Seed {seed}"), "")));
    columns.push(numbers("Mean", unit));
    if !paper.is_empty() {
        columns.push(numbers("Paper", unit));
        columns.push(numbers("Difference", unit));
    }
    let timed = matches!(measure, Measure::BenchmarkRouteTime | Measure::MeanTime);
    if timed {
        columns.push(numbers("Mean / least", ""));
        if !paper.is_empty() {
            columns.push(numbers("Paper / least", ""));
        }
    }
    let mut table_rows = Vec::new();
    let mut notes: Vec<String> = Vec::new();
    for (condition, arm) in rows(results, index) {
        let values = results.values(index, condition, arm, measure, after)?;
        let mean = Estimate::from_values(&raw_values(&values));
        let mut row = vec![Cell::Text(row_name(results, index, condition, arm))];
        row.extend(values.iter().map(|value| cell(value, digits)));
        row.push(estimate(mean, digits));
        let papers = paper.iter().find(|(name, _)| *name == experiment.arms[arm].name).map(|p| p.1);
        if !paper.is_empty() {
            let value = |value| Cell::Number { value, digits: digits.max(decimals(value)) };
            row.push(papers.map_or(Cell::Empty, value));
            row.push(match papers.zip(mean) {
                Some((paper, mean)) => {
                    Cell::Signed { value: mean.mean - paper, half_width: mean.half_width, digits }
                }
                None => Cell::Empty,
            });
        }
        if timed {
            let least = least(results, index, (condition, arm), measure, after)?;
            let ratio = |of: Option<f64>| match of.zip(least) {
                Some((time_s, (plan_s, _))) => Cell::Number { value: time_s / plan_s, digits: 3 },
                None => Cell::Empty,
            };
            row.push(ratio(mean.map(|mean| mean.mean)));
            if !paper.is_empty() {
                row.push(ratio(papers));
            }
            if let Some((plan_s, bound_s)) = least {
                let (training, _) = results.policy(index, condition, arm, 1, after);
                let world = &results.training(training).config.scenario.name;
                let note = format!(
                    "Least time in {world}, mean over the drives: {}\u{a0}s by a planner that knows the world, {}\u{a0}s proven. \
                     (Both keep their distance truly; the judge, by the LIDAR's beams, lets a few millimetres pass. \
                     docs/optimum.md.)",
                    number(plan_s, 2),
                    number(bound_s, 2)
                );
                if !notes.contains(&note) {
                    notes.push(note);
                }
            }
        }
        table_rows.push(row);
    }
    Ok((columns, table_rows, notes))
}

fn rounds(
    results: &Results<'_>,
    index: usize,
    after: u64,
    paper: &[(String, Vec<f64>)],
) -> Result<Parts, RunError> {
    let experiment = results.experiment(index);
    let mut columns = vec![text("")];
    columns.extend((1..=experiment.test.rounds).map(|round| numbers(format!("Round {round}"), "%")));
    columns.push(numbers("Mean", "%"));
    let row = |name: String, rounds: &[f64]| {
        let mut row = vec![Cell::Text(name)];
        // The paper's rounds may be more or fewer than ours.
        let cell = |round: usize| match rounds.get(round) {
            Some(&value) => Cell::Number { value, digits: 0 },
            None => Cell::Empty,
        };
        row.extend((0..experiment.test.rounds).map(cell));
        row.push(
            Estimate::from_values(rounds).map_or(Cell::Empty, |e| Cell::Number { value: e.mean, digits: 1 }),
        );
        row
    };
    let mut table_rows = Vec::new();
    for (condition, arm) in rows(results, index) {
        let name = row_name(results, index, condition, arm);
        if let Some((_, rounds)) = paper.iter().find(|(of, _)| *of == experiment.arms[arm].name) {
            table_rows.push(row(format!("{name}: the paper"), rounds));
        }
        for seed in 1..=experiment.seeds {
            let rounds = results.rounds(index, condition, arm, seed, after)?;
            table_rows.push(row(format!("{name}: seed {seed}"), &rounds));
        }
    }
    Ok((columns, table_rows, Vec::new()))
}

/// Mean least time, and mean proven lower bound, in s, of the benchmark route or of the test's episodes.
fn least(
    results: &Results<'_>,
    index: usize,
    (condition, arm): (usize, usize),
    measure: Measure,
    after: u64,
) -> Result<Option<(f64, f64)>, RunError> {
    let (training, which) = results.policy(index, condition, arm, 1, after);
    let least = results.optimal_times(training, which, results.experiment(index).test)?;
    let bounds =
        if measure == Measure::BenchmarkRouteTime { &least.benchmark_route } else { &least.episodes };
    let period_s = period_s(results.training(training).config.scenario.task.control_period_s);
    let known: Option<Vec<(u32, u32)>> = bounds
        .iter()
        .map(|&StepBounds { lower_steps, plan_steps }| Some((plan_steps?, lower_steps)))
        .collect();
    Ok(known.filter(|known| !known.is_empty()).map(|known| {
        let mean = |of: fn(&(u32, u32)) -> u32| {
            known.iter().map(|pair| f64::from(of(pair))).sum::<f64>() / known.len() as f64 * period_s
        };
        (mean(|pair| pair.0), mean(|pair| pair.1))
    }))
}

fn measures_of(
    results: &Results<'_>,
    index: usize,
    measures: &[Measure],
    after: u64,
) -> Result<Parts, RunError> {
    let mut columns = vec![text("")];
    columns.extend(measures.iter().map(|measure| numbers(measure.heading(), measure.unit())));
    let row = |(condition, arm): (usize, usize)| {
        let mut row = vec![Cell::Text(row_name(results, index, condition, arm))];
        for &measure in measures {
            let values = results.values(index, condition, arm, measure, after)?;
            row.push(mean(&values, measure));
        }
        Ok(row)
    };
    let table_rows = rows(results, index).into_iter().map(row).collect::<Result<_, RunError>>()?;
    Ok((columns, table_rows, Vec::new()))
}

fn contrast(
    results: &Results<'_>,
    index: usize,
    measures: &[Measure],
    (better, than): (&str, &str),
    afters: &[u64],
    of_last_stage: bool,
) -> Result<Parts, RunError> {
    let experiment = results.experiment(index);
    let mut columns = vec![text("Condition")];
    if afters.len() > 1 {
        columns.push(numbers(if of_last_stage { "Episodes of the last stage" } else { "Episodes" }, ""));
    }
    for measure in measures {
        let named = |what: &str| format!("{}: {what}", measure.heading());
        columns.push(numbers(named(better), measure.unit()));
        columns.push(numbers(named(than), measure.unit()));
        columns.push(numbers(named("difference"), measure.unit()));
        columns.push(text(&named(&format!("{better} ahead"))));
    }
    let mut table_rows = Vec::new();
    for condition in 0..experiment.conditions.len().max(1) {
        for &after in afters {
            let name = experiment.conditions.get(condition).map_or("as it is", |c| c.name.as_str());
            let mut row = vec![Cell::Text(name.into())];
            if afters.len() > 1 {
                row.push(Cell::Number { value: after as f64, digits: 0 });
            }
            for &measure in measures {
                let values =
                    |arm| results.values_by_arm_name(index, condition, arm, measure, (after, of_last_stage));
                let (one, other) = (values(better)?, values(than)?);
                let compared = compare(measure, &one, &other);
                row.extend([mean(&one, measure), mean(&other, measure)]);
                row.push(compared.difference.map_or(Cell::Empty, |difference| Cell::Signed {
                    value: difference.mean,
                    half_width: difference.half_width,
                    digits: measure.digits(),
                }));
                row.push(Cell::Outcome(compared.outcome));
            }
            table_rows.push(row);
        }
    }
    let note = format!(
        "\"held\": the 95 % interval of the difference lies wholly on the side where {better} is ahead; \"reversed\": on \
         the other side; \"not shown\": it holds 0. Of many such comparisons about one in twenty is held or reversed by \
         chance alone."
    );
    Ok((columns, table_rows, vec![note]))
}

fn cell(value: &MeasuredValue, digits: usize) -> Cell {
    match *value {
        MeasuredValue { value, is_lower_bound: true } => Cell::AtLeast { value, digits },
        MeasuredValue { value, is_lower_bound: false } => Cell::Number { value, digits },
    }
}

fn estimate(estimate: Option<Estimate>, digits: usize) -> Cell {
    estimate.map_or(Cell::Empty, |e| Cell::Estimate { mean: e.mean, half_width: e.half_width, digits })
}

/// The mean over the seeds with its interval; a lower bound where some never got there.
fn mean(values: &[MeasuredValue], measure: Measure) -> Cell {
    let digits = measure.digits();
    let mean = Estimate::from_values(&raw_values(values));
    match mean {
        Some(mean) if values.iter().any(|value| value.is_lower_bound) => {
            Cell::AtLeast { value: mean.mean, digits }
        }
        mean => estimate(mean, digits),
    }
}

/// Decimals that a number of the paper is given with.
fn decimals(value: f64) -> usize {
    (0..3).find(|&digits| (value * 10_f64.powi(digits)).fract().abs() < 1e-6).unwrap_or(3) as usize
}

/// What one must know to read the numbers.
fn notes_on(experiment: &Experiment, spec: &TableSpec) -> Vec<String> {
    let measures: &[Measure] = match &spec.show {
        TableKind::Seeds { measure, .. } => std::slice::from_ref(measure),
        TableKind::Rounds { .. } => &[Measure::Success],
        TableKind::Measures { measures, .. } | TableKind::Contrast { measures, .. } => measures,
    };
    let mut notes = Vec::new();
    let after = match &spec.show {
        TableKind::Seeds { after, .. }
        | TableKind::Rounds { after, .. }
        | TableKind::Measures { after, .. } => Some(after),
        TableKind::Contrast { .. } => None,
    };
    let as_it_stands = experiment.arms.iter().any(|arm| arm.policy == TestedPolicy::AtEpisode);
    let mut when = match after.filter(|_| as_it_stands) {
        Some(after) => format!("Tested after {} episodes, greedily", number(*after as f64, 0)),
        None => "Tested greedily".into(),
    };
    let seeds = experiment.seeds;
    when += &format!(", over {seeds} seed{}", if seeds == 1 { "" } else { "s" });
    if !matches!(spec.show, TableKind::Rounds { .. }) {
        when += "; ± is the 95 % interval of the mean over the seeds (Student's t)";
    }
    let of_paper = matches!(&spec.show, TableKind::Seeds { paper, .. } if !paper.is_empty());
    when += if of_paper { ", the paper's figure taken as exact." } else { "." };
    notes.push(when);
    for arm in experiment.arms.iter().filter(|arm| arm.policy == TestedPolicy::Best) {
        notes.push(format!("{}: the best policy of its training, by evaluations of its own.", arm.name));
    }
    let test = &experiment.test;
    if measures.contains(&Measure::Success) {
        notes.push(format!(
            "Success: each seed's policy drives {} rounds of {} episodes that it has never seen.",
            test.rounds, test.episodes
        ));
    }
    if measures.contains(&Measure::BenchmarkRouteTime) {
        notes.push(format!(
            "Course: mean of {BENCHMARK_ROUTE_EPISODES} drives of each seed's policy; a drive that fails counts as the time limit. \
             Where nothing moves and nothing is noisy, all drives of a policy are the same."
        ));
    }
    if measures.contains(&Measure::MeanTime) {
        notes.push("Mean time: over all test episodes; one that fails counts as the time limit.".into());
    }
    if measures.contains(&Measure::TimeRatio) {
        notes.push(
            "Time / least: total time of the successful test episodes over the planner's for the same ones. Of a policy \
             that often fails those are the easy ones."
                .into(),
        );
    }
    if measures.contains(&Measure::BoundRatio) {
        notes.push("Time / bound: the same over the proven lower bounds.".into());
    }
    if measures.iter().any(|m| matches!(m, Measure::Return | Measure::Goals)) {
        notes.push("Return, goals: mean of the last 100 episodes of training, while still exploring.".into());
    }
    if measures.iter().any(|m| matches!(m, Measure::EpisodesTo(_) | Measure::StepsTo(_))) {
        notes.push(
            "Episodes (steps) to a level: of the last stage, until the mean of 50 episodes reaches it while still exploring; \
             \"> n\": some seeds never did, and count with the length of their run."
                .into(),
        );
    }
    notes
}
